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

/// W = C1 (exp(C2 (I1 - 3)) - 1) - C1 C2/2 (I2 - 3).
struct VerondaWestmannEnergy {
  static constexpr const char* name = "Veronda-Westmann";
  static constexpr bool depends_on_i2 = true, depends_on_j = false, linear_in_i1 = false;

  double c1;  ///< Pa
  double c2;

  /// W, J/m^3.
  template <class T>
  [[nodiscard]] T density(const Invariants<T>& i) const {
    using std::expm1;
    return T(c1) * expm1(T(T(c2) * i.k1)) - T(c1 * c2 / 2) * i.k2;
  }
  /// First derivatives of W, Pa.
  template <class T>
  [[nodiscard]] First<T> first(const Invariants<T>& i) const {
    using std::exp;
    return {T(c1 * c2) * exp(T(c2) * i.k1), T(-c1 * c2 / 2), T(0)};
  }
  /// Second derivatives of W, Pa.
  template <class T>
  [[nodiscard]] Second<T> second(const Invariants<T>& i) const {
    using std::exp;
    return {T(c1 * c2 * c2) * exp(T(c2) * i.k1), T(0), T(0), T(0), T(0), T(0)};
  }
};

/// Veronda and Westmann's law of skin: w = C1 (exp(C2 (I1 J^-2/3 - 3)) - 1) - C1 C2/2 (I2 J^-4/3 - 3) +
/// bulk/2 (J - 1)^2 (Veronda & Westmann 1970), with the small-strain shear modulus C1 C2. Defined for J > 0;
/// see `Continued`. Not finite where the exponent exceeds about 700 (88 in float). The second term takes
/// stiffness away: with C2 below 0.36 the law no longer resists a change of shape across a large stretch l,
/// where l^2 > 2 exp(C2 (I1 - 3)).
class VerondaWestmann : public Isochoric<VerondaWestmannEnergy, QuadraticVolume> {
 public:
  /// @param c1 Pa
  /// @param c2 how fast the law stiffens, 1
  /// @param bulk Pa
  /// @throws std::invalid_argument unless C1, C2 and bulk are positive and finite
  VerondaWestmann(double c1, double c2, double bulk)
      : Isochoric({c1, checked_exponent(c2)}, QuadraticVolume(bulk)) {}
  /// From the moduli of small strain in Pa and C2.
  /// @throws std::invalid_argument, see Lame::from_young_poisson; also unless C2 is positive and finite
  [[nodiscard]] static VerondaWestmann from_young_poisson(double E, double nu, double c2) {
    const Lame lame = Lame::from_young_poisson(E, nu);
    return {lame.mu / c2, c2, lame.lambda + 2 * lame.mu / 3};
  }

 private:
  static double checked_exponent(double c2) {
    if (!(c2 > 0 && c2 <= 1e300))
      invalid(std::string("Veronda-Westmann: exponent C2 ") + to_text(c2) + " must be positive and finite");
    return c2;
  }
};

}  // namespace softsim
