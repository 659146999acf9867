// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <string>

#include "softsim/core/error.hpp"
#include "softsim/material/coupled.hpp"
#include "softsim/material/isochoric.hpp"
#include "softsim/material/lame.hpp"
#include "softsim/material/volume_law.hpp"

namespace softsim {

/// W = C1 (I1 - 3) + C2 (I2 - 3), the energy of distortion of both Mooney-Rivlin laws.
struct MooneyRivlinEnergy {
  static constexpr const char* name = "Mooney-Rivlin";
  static constexpr bool depends_on_i2 = true, depends_on_j = false, linear_in_i1 = true, linear = true;

  double c1, c2;  ///< Pa

  /// With the shear modulus mu = 2 (C1 + C2) of small strain.
  /// @throws std::invalid_argument unless the ratio C2/C1 is finite and above -1
  [[nodiscard]] static MooneyRivlinEnergy from_shear_modulus(double mu, double c2_over_c1) {
    if (!(c2_over_c1 > -1 && c2_over_c1 <= 1e300))
      invalid(std::string("c2_over_c1 ") + to_text(c2_over_c1) + ": must be finite and greater than -1");
    const double c1 = mu / (2 * (1 + c2_over_c1));
    return {c1, c2_over_c1 * c1};
  }

  /// W, J/m^3.
  template <class T>
  [[nodiscard]] T density(const Invariants<T>& i) const {
    return T(c1) * i.k1 + T(c2) * i.k2;
  }
  /// First derivatives of W, Pa.
  template <class T>
  [[nodiscard]] First<T> first(const Invariants<T>&) const {
    return {T(c1), T(c2), T(0)};
  }
  /// Second derivatives of W, Pa.
  template <class T>
  [[nodiscard]] Second<T> second(const Invariants<T>&) const {
    return {T(0), T(0), T(0), T(0), T(0), T(0)};
  }
};

/// Mooney-Rivlin, compressible: w = C1 (I1 J^-2/3 - 3) + C2 (I2 J^-4/3 - 3) + bulk/2 (J - 1)^2 (Goulette &
/// Chen 2015, Eqs. 21-25 and Table 3). Defined for J > 0; see `Continued`. For another volume law take
/// `Isochoric<MooneyRivlinEnergy, ...>`. Admissible are C1 + C2 > 0 and bulk > 0. With C2 < 0 (or C1 < 0) the
/// energy is not bounded from below: the law gives way at large equibiaxial (uniaxial) stretch.
class MooneyRivlin : public Isochoric<MooneyRivlinEnergy, QuadraticVolume> {
 public:
  /// @param c1,c2,bulk Pa
  /// @throws std::invalid_argument unless the small-strain shear modulus 2 (C1 + C2) and bulk are positive
  MooneyRivlin(double c1, double c2, double bulk) : Isochoric({c1, c2}, QuadraticVolume(bulk)) {}
  /// From the moduli of small strain in Pa and the ratio C2/C1.
  /// @throws std::invalid_argument, see Lame::from_young_poisson; also unless c2_over_c1 > -1
  [[nodiscard]] static MooneyRivlin from_young_poisson(double E, double nu, double c2_over_c1 = 0) {
    return MooneyRivlin(Lame::from_young_poisson(E, nu), c2_over_c1);
  }
  /// From Lame's parameters of small strain in Pa and the ratio C2/C1.
  /// @throws std::invalid_argument, see Lame::checked; also unless c2_over_c1 > -1
  [[nodiscard]] static MooneyRivlin from_lame(double lambda, double mu, double c2_over_c1 = 0) {
    return MooneyRivlin(Lame::checked(lambda, mu), c2_over_c1);
  }

 private:
  MooneyRivlin(Lame lame, double c2_over_c1)
      : Isochoric(MooneyRivlinEnergy::from_shear_modulus(lame.mu, c2_over_c1),
                  QuadraticVolume(lame.lambda + 2 * lame.mu / 3)) {}
};

/// Mooney-Rivlin in the plain invariants, close to incompressible by a penalty on ln J:
/// w = C1 (I1 - 3) + C2 (I2 - 3) - 2 (C1 + 2 C2) ln J + penalty/2 (ln J)^2 (Goulette & Chen 2015, Table 3 and
/// Eq. 26; the second logarithm makes the rest shape free of stress). For C2 = 0 it is `NeoHookean`. Defined
/// for J > 0; see `Continued`. With C2 < 0 (or C1 < 0) the energy is not bounded from below, see
/// `MooneyRivlin`.
class CoupledMooneyRivlin : public Coupled<MooneyRivlinEnergy, LogarithmicVolume> {
 public:
  /// @param c1,c2,penalty Pa; at small strain mu = 2 (C1 + C2) and lambda = penalty + 4 C2
  /// @throws std::invalid_argument unless the small-strain moduli and the penalty are positive
  CoupledMooneyRivlin(double c1, double c2, double penalty) : Coupled({c1, c2}, LogarithmicVolume(penalty)) {}
  /// From the moduli of small strain in Pa and the ratio C2/C1.
  /// @throws std::invalid_argument, see Lame::from_young_poisson; also unless c2_over_c1 > -1 and the penalty
  /// that remains, lambda - 4 C2, is positive
  [[nodiscard]] static CoupledMooneyRivlin from_young_poisson(double E, double nu, double c2_over_c1 = 0) {
    const Lame lame = Lame::from_young_poisson(E, nu);
    const auto energy = MooneyRivlinEnergy::from_shear_modulus(lame.mu, c2_over_c1);
    return {energy.c1, energy.c2, lame.lambda - 4 * energy.c2};
  }
};

}  // namespace softsim
