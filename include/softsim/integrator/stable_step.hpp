// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <limits>
#include <string>

#include "softsim/core/error.hpp"
#include "softsim/solver/largest_eigenvalue.hpp"
#include "softsim/system/system.hpp"

namespace softsim {

/// An integrator that says by what factor an oscillator's amplitude may grow in a step.
template <class I>
concept HasSpectralRadius = requires(const I& integrator) {
  { integrator.spectral_radius(1.0, 0.0) } -> std::convertible_to<double>;
};

/// Largest step in s up to which an integrator is stable for all frequencies in (0, omega_max]: the spectral
/// radius at (omega h, xi(omega)), xi = alpha/(2 omega) + beta omega/2, is at most 1. 0 if it is stable for
/// no step, infinity if for every step (up to omega_max h = 1e6). Lower frequencies and steps are sampled,
/// for with alpha damping the largest need not be the first to grow. The step of the integrator itself does
/// not matter.
/// @param omega_max largest circular frequency, 1/s
/// @throws std::invalid_argument unless omega_max is positive and finite, and both damping parameters at
/// least 0
template <HasSpectralRadius I>
[[nodiscard]] double stable_step(double omega_max, const Rayleigh& damping, const I& integrator) {
  if (!(omega_max > 0) || !(omega_max <= 1e300))
    invalid(std::string("omega_max ") + to_text(omega_max) + " 1/s: must be positive and finite");
  if (!(damping.alpha >= 0) || !(damping.alpha <= 1e300))
    invalid(std::string("alpha ") + to_text(damping.alpha) + " 1/s: must be at least 0 and finite");
  if (!(damping.beta >= 0) || !(damping.beta <= 1e300))
    invalid(std::string("beta ") + to_text(damping.beta) + " s: must be at least 0 and finite");
  // A hundred thousandth of omega_max is as good as a rigid motion; twelve samples a decade.
  constexpr int samples = 61;
  constexpr double rounding = 1e-14;
  std::array<double, samples> part, xi;
  for (std::size_t k = 0; k < samples; ++k) {
    part[k] = std::pow(10.0, -static_cast<double>(k) / 12);
    const double omega = part[k] * omega_max;
    xi[k] = damping.alpha / (2 * omega) + damping.beta * omega / 2;
  }
  const auto radius = [&](double Omega_max, int k) {
    const auto at = static_cast<std::size_t>(k);
    return integrator.spectral_radius(part[at] * Omega_max, xi[at]);
  };
  // Index of a frequency that grows at this step, or -1; a NaN counts as growth.
  const auto growing = [&](double Omega_max) {
    for (int k = 0; k < samples; ++k)
      if (!(radius(Omega_max, k) <= 1 + rounding)) return k;
    return -1;
  };
  constexpr double least = 1e-6, most = 1e6, ratio = 1.1;
  double low = 0, high = least;
  while (growing(high) < 0) {
    low = high;
    high *= ratio;
    if (high > most) return std::numeric_limits<double>::infinity();
  }
  if (low == 0) return 0;
  while (high - low > 1e-13 * high) {
    const double middle = low + (high - low) / 2;
    if (!(middle > low && middle < high)) break;
    (growing(middle) < 0 ? low : high) = middle;
  }
  // A growth that vanishes with a power of the step (RK2: Omega^4/8) falls below rounding somewhere, where it
  // looks like a small stable step. There is none unless something is damped below it: without damping a
  // limit is a number of the method, and of the order of 1.
  if (low < 0.05 && !(radius(low / 2, growing(high)) < 1 - rounding)) return 0;
  return low / omega_max;
}

/// The same for a system at q: omega_max from `largest_eigenvalue`, estimated from above, damping the
/// system's. Damping forces of terms and an indefinite Hessian are not looked at, and nonlinear systems
/// stiffen: leave a margin. 0 also if the eigenvalue was not found; infinity if nothing is stiff.
/// @throws std::invalid_argument as `largest_eigenvalue` and above
template <class S, HasSpectralRadius I>
[[nodiscard]] double stable_step(const S& system, const State<typename S::Scalar>& q, const I& integrator,
                                 const LargestEigenvalueOptions& options = {}) {
  const EigenvalueReport found = largest_eigenvalue(system, q, options);
  if (found.status != Status::converged) return 0;
  if (found.omega() == 0) return std::numeric_limits<double>::infinity();
  return stable_step(found.omega(), system.damping, integrator);
}

}  // namespace softsim
