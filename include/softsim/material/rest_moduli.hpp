// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "softsim/concepts.hpp"
#include "softsim/core/error.hpp"
#include "softsim/material/lame.hpp"

namespace softsim {

/// Lame parameters in Pa that a law w(I1, I2, J) has at small strain, from its derivatives at rest:
/// mu = 2 (w1 + w2), lambda = 4 w2 + wJ + 4 w11 + 16 w12 + 16 w22 + 4 w1J + 8 w2J + wJJ, since with the
/// logarithmic strains e_i and t = sum e_i, I1 - 3 = 2 t + 2 sum e_i^2, I2 - 3 = 4 t + 2 t^2 + 2 sum e_i^2
/// and J - 1 = t + t^2/2 up to third order.
template <InvariantLaw Law>
[[nodiscard]] Lame rest_moduli(const Law& law) {
  const Invariants<double> rest{3, 3, 1};
  const First<double> w = law.first(rest);
  const Second<double> s = law.second(rest);
  return {4 * (w.w2 + s.w11 + s.w1j) + 8 * s.w2j + 16 * (s.w12 + s.w22) + w.wj + s.wjj, 2 * (w.w1 + w.w2)};
}

/// Refuses a law that is not stiff at rest; a parameter that is not finite makes a modulus that is not
/// either.
/// @throws std::invalid_argument with `name` and the small-strain moduli unless both are positive and finite
template <InvariantLaw Law>
void require_stiff_at_rest(const Law& law, const std::string& name) {
  const Lame lame = rest_moduli(law);
  const double bulk = lame.lambda + 2 * lame.mu / 3;
  if (!(lame.mu > 0 && lame.mu <= 1e300 && bulk > 0 && bulk <= 1e300))
    invalid(name + ": shear modulus " + to_text(lame.mu) + " Pa and bulk modulus " + to_text(bulk) +
            " Pa of small strain must be positive and finite");
}

}  // namespace softsim
