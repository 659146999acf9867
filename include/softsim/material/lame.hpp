// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>

#include "softsim/core/error.hpp"

namespace softsim {

/// Lame parameters in Pa, admissible at rest: mu > 0 and bulk modulus lambda + 2 mu/3 > 0.
struct Lame {
  double lambda;
  double mu;

  /// @throws std::invalid_argument with the moduli unless both are finite and the shear and bulk moduli
  /// positive
  [[nodiscard]] static Lame checked(double lambda, double mu) {
    const double bulk = lambda + 2 * mu / 3;
    if (!(mu > 0) || !(mu <= 1e300))
      invalid(std::string("mu ") + to_text(mu) +
              " Pa: the shear modulus must be positive and finite (bulk modulus " + to_text(bulk) + " Pa)");
    if (!(bulk > 0) || !(bulk <= 1e300))
      invalid(std::string("lambda ") + to_text(lambda) +
              " Pa: bulk modulus lambda + 2 mu/3 = " + to_text(bulk) + " Pa must be positive and finite");
    return {lambda, mu};
  }

  /// From Young's modulus E in Pa and Poisson's ratio nu.
  /// @throws std::invalid_argument unless E > 0 and -1 < nu < 0.5
  [[nodiscard]] static Lame from_young_poisson(double E, double nu) {
    if (!(E > 0) || !(E <= 1e300))
      invalid(std::string("young ") + to_text(E) + " Pa: must be positive and finite");
    if (!(nu > -1 && nu < 0.5))
      invalid(std::string("poisson_ratio ") + to_text(nu) + ": must lie in (-1, 0.5)");
    const Lame lame{E * nu / ((1 + nu) * (1 - 2 * nu)), E / (2 * (1 + nu))};
    if (!(std::abs(lame.lambda) <= 1e300 && lame.mu <= 1e300))
      invalid(std::string("young ") + to_text(E) + " Pa, poisson_ratio " + to_text(nu) +
              ": lambda or mu is too large");
    return lame;
  }
};

/// Gives a law its parameters lambda and mu and the two ways to make one. `Law` needs a constructor from
/// `Lame`.
template <class Law>
class LameLaw {
 public:
  /// From Lame's parameters in Pa. @throws std::invalid_argument, see Lame::checked
  [[nodiscard]] static Law from_lame(double lambda, double mu) { return Law(Lame::checked(lambda, mu)); }
  /// From Young's modulus in Pa and Poisson's ratio, both of small strain.
  /// @throws std::invalid_argument, see Lame::from_young_poisson
  [[nodiscard]] static Law from_young_poisson(double E, double nu) {
    return Law(Lame::from_young_poisson(E, nu));
  }

  /// First Lame parameter, Pa.
  [[nodiscard]] double lambda() const { return lame_.lambda; }
  /// Second Lame parameter, the shear modulus, Pa.
  [[nodiscard]] double mu() const { return lame_.mu; }

 private:
  friend Law;
  explicit LameLaw(Lame lame) : lame_(lame) {}
  Lame lame_;
};

}  // namespace softsim
