// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "softsim/core/error.hpp"
#include "softsim/core/tensor.hpp"
#include "softsim/kinematics/neighbourhood.hpp"
#include "softsim/kinematics/node_shapes.hpp"

namespace softsim {

/// The weight w of a neighbour and grad log w = grad w / w (1/m). Common factors of all weights cancel in
/// every shape function, so that w may be relative to whatever keeps it in range.
struct RadialWeight {
  double value;
  Vec3<double> log_gradient;
};

/// Wendland's C2 function (1 - q)^4 (4 q + 1), q = d / radius, for d < radius; 1 if the radius is infinite.
[[nodiscard]] inline RadialWeight wendland_weight(const Neighbour& n, double radius) {
  const double q = n.distance / radius, rest = 1 - q;
  return {rest * rest * rest * rest * (4 * q + 1), n.offset * (-20 / (radius * radius * rest * (4 * q + 1)))};
}

/// w = ((R - d)/(R d))^p (Franke & Little), for d < R; 1/d^p (Bosman 2015, Eq. 4.9) if R is infinite. It has
/// a pole at its node.
struct InverseDistance {
  double power;   ///< p > 0
  double radius;  ///< R in m, or infinite

  /// w(d) / w(reference) for distances d >= reference in m; 0 for a reference of 0 and d > 0.
  [[nodiscard]] double ratio(double d, double reference) const {
    return std::pow(reference / d * ((1 - d / radius) / (1 - reference / radius)), power);
  }
  /// grad log w in 1/m for d > 0.
  [[nodiscard]] Vec3<double> log_gradient(const Neighbour& n) const {
    // the unit vector first: 1/d^2 overflows long before 1/d does
    return Vec3<double>(n.offset / n.distance) * (-power / (n.distance * (1 - n.distance / radius)));
  }
  /// @throws std::invalid_argument if the power is not above `lowest` and finite
  void check(double lowest) const {
    if (!(power > lowest && std::isfinite(power)))
      invalid(std::string("power ") + to_text(power) + ": must exceed " + to_text(lowest) + " and be finite");
  }
};

namespace detail {

// w_i / sum w, with gradients; `top` is the largest weight, whose gradient may be as large as 1/d near a
// pole. It is therefore kept out of the mean, and its own share of it is the rest of the others.
inline ShapeValues partition_of_unity(const std::vector<Neighbour>& near,
                                      const std::vector<RadialWeight>& weights, std::size_t top) {
  double others = 0;
  Vec3<double> mean = Vec3<double>::Zero();
  for (std::size_t i = 0; i < near.size(); ++i)
    if (i != top) {
      others += weights[i].value;
      mean += weights[i].value * weights[i].log_gradient;
    }
  const double sum = weights[top].value + others, share = weights[top].value / sum;
  mean /= sum;
  others /= sum;
  ShapeValues result;
  for (std::size_t i = 0; i < near.size(); ++i) {
    const Vec3<double>& g = weights[i].log_gradient;
    const double value = weights[i].value / sum;
    result.nodes.push_back(near[i].node);
    result.values.push_back(value);
    result.gradients.push_back(i == top
                                   ? Vec3<double>(value * (others * g - mean))
                                   : Vec3<double>(value * (g - share * weights[top].log_gradient - mean)));
  }
  return result;
}

}  // namespace detail

}  // namespace softsim
