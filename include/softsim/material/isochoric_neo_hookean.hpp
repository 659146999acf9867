// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include "softsim/material/isochoric.hpp"
#include "softsim/material/lame.hpp"
#include "softsim/material/volume_law.hpp"

namespace softsim {

/// W = C1 (I1 - 3).
struct NeoHookeanEnergy {
  static constexpr const char* name = "isochoric Neo-Hookean";
  static constexpr bool depends_on_i2 = false, depends_on_j = false, linear_in_i1 = true, linear = true;

  double c1;  ///< Pa

  /// W, J/m^3.
  template <class T>
  [[nodiscard]] T density(const Invariants<T>& i) const {
    return T(c1) * i.k1;
  }
  /// First derivatives of W, Pa.
  template <class T>
  [[nodiscard]] First<T> first(const Invariants<T>&) const {
    return {T(c1), T(0), T(0)};
  }
  /// Second derivatives of W, Pa.
  template <class T>
  [[nodiscard]] Second<T> second(const Invariants<T>&) const {
    return {T(0), T(0), T(0), T(0), T(0), T(0)};
  }
};

/// Neo-Hookean split into distortion and volume: w = C1 (I1 J^-2/3 - 3) + bulk/2 (J - 1)^2 with C1 = mu/2
/// (Goulette & Chen 2015, Eqs. 21-25), `MooneyRivlin` without its second term and cheaper. Defined for J > 0;
/// see `Continued`.
class IsochoricNeoHookean : public Isochoric<NeoHookeanEnergy, QuadraticVolume> {
 public:
  /// @param c1,bulk Pa
  /// @throws std::invalid_argument unless both are positive and finite
  IsochoricNeoHookean(double c1, double bulk) : Isochoric({c1}, QuadraticVolume(bulk)) {}
  /// From the moduli of small strain, Pa. @throws std::invalid_argument, see Lame::from_young_poisson
  [[nodiscard]] static IsochoricNeoHookean from_young_poisson(double E, double nu) {
    return IsochoricNeoHookean(Lame::from_young_poisson(E, nu));
  }
  /// From Lame's parameters of small strain, Pa. @throws std::invalid_argument, see Lame::checked
  [[nodiscard]] static IsochoricNeoHookean from_lame(double lambda, double mu) {
    return IsochoricNeoHookean(Lame::checked(lambda, mu));
  }

 private:
  explicit IsochoricNeoHookean(Lame lame) : IsochoricNeoHookean(lame.mu / 2, lame.lambda + 2 * lame.mu / 3) {}
};

}  // namespace softsim
