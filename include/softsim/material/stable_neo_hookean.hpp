// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include "softsim/material/isotropic.hpp"
#include "softsim/material/lame.hpp"

namespace softsim {

/// Stable Neo-Hookean without its logarithm: w = mu/2 (I1 - 3) - mu (J - 1) + (lambda + mu)/2 (J - 1)^2,
/// after Smith, de Goes, Kim 2018 ("Stable Neo-Hookean Flesh Simulation"), with the coefficients that make
/// lambda and mu the Lame parameters of small strain. Defined for every F, inverted ones included, and cheap:
/// no logarithm, no division.
class StableNeoHookean : public Isotropic<StableNeoHookean>, public LameLaw<StableNeoHookean> {
 public:
  static constexpr bool depends_on_i2 = false, linear_in_i1 = true;

  /// w, J/m^3.
  template <class T>
  [[nodiscard]] T density(const Invariants<T>& i) const {
    return T(mu() / 2) * i.k1 + (T((lambda() + mu()) / 2) * i.kj - T(mu())) * i.kj;
  }
  /// First derivatives of w, Pa.
  template <class T>
  [[nodiscard]] First<T> first(const Invariants<T>& i) const {
    return {T(mu() / 2), T(0), T(lambda() + mu()) * (i.j - T(1)) - T(mu())};
  }
  /// Second derivatives of w, Pa.
  template <class T>
  [[nodiscard]] Second<T> second(const Invariants<T>&) const {
    return {T(0), T(0), T(0), T(0), T(0), T(lambda() + mu())};
  }

 private:
  friend LameLaw<StableNeoHookean>;
  explicit StableNeoHookean(Lame lame) : LameLaw(lame) {}
};

}  // namespace softsim
