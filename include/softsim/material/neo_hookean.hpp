// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>

#include "softsim/core/elementary.hpp"
#include "softsim/material/isotropic.hpp"
#include "softsim/material/lame.hpp"

namespace softsim {

/// Compressible Neo-Hookean: w = mu/2 (I1 - 3) - mu ln J + lambda/2 (ln J)^2 (Goulette & Chen 2015, Eq. 26
/// with C1 = mu/2, without which the rest shape is not free of stress). Defined for J > 0 only and infinitely
/// stiff at J -> 0; for J <= 0 no function returns a finite number, which the line search of Newton's method
/// steps back from and every solver reports.
class NeoHookean : public Isotropic<NeoHookean>, public LameLaw<NeoHookean> {
 public:
  static constexpr bool depends_on_i2 = false, linear_in_i1 = true;

  /// w, J/m^3.
  template <class T>
  [[nodiscard]] T density(const Invariants<T>& i) const {
    using std::log1p;
    const T l = log1p(i.kj);
    return T(mu() / 2) * i.k1 - T(mu()) * l + T(lambda() / 2) * l * l;
  }
  /// First derivatives of w, Pa.
  template <class T>
  [[nodiscard]] First<T> first(const Invariants<T>& i) const {
    const auto [l, r] = log_and_inverse(i.j);
    return {T(mu() / 2), T(0), (T(lambda()) * l - T(mu())) * r};
  }
  /// Second derivatives of w, Pa.
  template <class T>
  [[nodiscard]] Second<T> second(const Invariants<T>& i) const {
    const auto [l, r] = log_and_inverse(i.j);
    return {T(0), T(0), T(0), T(0), T(0), (T(lambda() + mu()) - T(lambda()) * l) * r * r};
  }

 private:
  friend LameLaw<NeoHookean>;
  explicit NeoHookean(Lame lame) : LameLaw(lame) {}
};

}  // namespace softsim
