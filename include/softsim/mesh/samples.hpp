// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include "softsim/core/error.hpp"
#include "softsim/core/tensor.hpp"

namespace softsim {

/// Points in a body with the part of its volume that each stands for: sum_i volumes_i f(positions_i) is the
/// integral of f. Makers: `sample` (sampling.hpp), `sample_curve`, `sample_surface`, `gauss_samples` and
/// `equal_samples`.
struct Samples {
  std::vector<Vec3<double>> positions;  ///< m
  std::vector<double> volumes;          ///< m^3, all positive

  /// Sum of the volumes, m^3, with the rounding of each addition carried on (Kahan): equal shares round
  /// alike, and a million of them would lose five digits.
  [[nodiscard]] double volume() const {
    double sum = 0, lost = 0;
    for (const double v : volumes) {
      const double term = v - lost, next = sum + term;
      lost = (next - sum) - term;
      sum = next;
    }
    return sum;
  }
};

/// One point of a rule on [-1, 1].
struct GaussPoint {
  double x, weight;
};

/// Gauss-Legendre rule with n points, ascending: exact for polynomials of degree 2 n - 1; the weights sum to
/// 2. The points are the roots of the Legendre polynomial, by Newton's method.
/// @throws std::invalid_argument unless 1 <= n <= 64
[[nodiscard]] inline std::vector<GaussPoint> gauss_legendre(int n) {
  if (n < 1 || n > 64) invalid(std::string("Gauss points ") + std::to_string(n) + ": must lie in [1, 64]");
  std::vector<GaussPoint> rule(static_cast<std::size_t>(n));
  for (int i = 0; i < (n + 1) / 2; ++i) {
    double x = 2 * i + 1 == n ? 0 : std::cos(std::numbers::pi * (i + 0.75) / (n + 0.5)), slope = 0;
    for (int iteration = 0; iteration < 8; ++iteration) {  // quadratic from four digits: far more than enough
      double p = x, before = 1;
      for (int k = 2; k <= n; ++k) {
        const double next = ((2 * k - 1) * x * p - (k - 1) * before) / k;
        before = p;
        p = next;
      }
      slope = n * (before - x * p) / (1 - x * x);
      x -= p / slope;
    }
    const double weight = 2 / ((1 - x * x) * slope * slope);
    rule[static_cast<std::size_t>(i)] = {-x, weight};
    rule[static_cast<std::size_t>(n - 1 - i)] = {x, weight};
  }
  return rule;
}

}  // namespace softsim
