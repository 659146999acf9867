// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <string>

#include "softsim/core/elementary.hpp"
#include "softsim/core/error.hpp"
#include "softsim/material/isochoric.hpp"
#include "softsim/material/lame.hpp"
#include "softsim/material/volume_law.hpp"

namespace softsim {

/// W = mu/(2 b) (exp(b (I1 - 3)) - 1).
struct FungEnergy {
  static constexpr const char* name = "Fung";
  static constexpr bool depends_on_i2 = false, depends_on_j = false, linear_in_i1 = false;

  double mu;  ///< Pa
  double b;

  /// W, J/m^3.
  template <class T>
  [[nodiscard]] T density(const Invariants<T>& i) const {
    using std::expm1;
    return T(mu / (2 * b)) * expm1(T(T(b) * i.k1));
  }
  /// First derivatives of W, Pa.
  template <class T>
  [[nodiscard]] First<T> first(const Invariants<T>& i) const {
    using std::exp;
    return {T(mu / 2) * exp(T(b) * i.k1), T(0), T(0)};
  }
  /// Second derivatives of W, Pa.
  template <class T>
  [[nodiscard]] Second<T> second(const Invariants<T>& i) const {
    using std::exp;
    return {T(mu * b / 2) * exp(T(b) * i.k1), T(0), T(0), T(0), T(0), T(0)};
  }
};

/// Fung's exponential law, isotropic: w = mu/(2 b) (exp(b (I1 J^-2/3 - 3)) - 1) + bulk/2 (J - 1)^2 (Fung
/// 1967; Demiray 1972). Defined for J > 0; see `Continued`. Not finite where b (I1 J^-2/3 - 3) exceeds about
/// 700 (88 in float).
class Fung : public Isochoric<FungEnergy, QuadraticVolume> {
 public:
  /// @param mu shear modulus of small strain, Pa
  /// @param b how fast the law stiffens, 1
  /// @param bulk Pa
  /// @throws std::invalid_argument unless mu, bulk and b are positive and finite (with b < 0 the stress would
  /// die away with strain)
  Fung(double mu, double b, double bulk) : Isochoric({mu, checked_exponent(b)}, QuadraticVolume(bulk)) {}
  /// From the moduli of small strain in Pa and b.
  /// @throws std::invalid_argument, see Lame::from_young_poisson; also unless b is positive and finite
  [[nodiscard]] static Fung from_young_poisson(double E, double nu, double b) {
    const Lame lame = Lame::from_young_poisson(E, nu);
    return {lame.mu, b, lame.lambda + 2 * lame.mu / 3};
  }

 private:
  static double checked_exponent(double b) {
    if (!(b > 0 && b <= 1e300))
      invalid(std::string("Fung: exponent ") + to_text(b) + " must be positive and finite");
    return b;
  }
};

}  // namespace softsim
