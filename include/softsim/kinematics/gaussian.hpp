// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "softsim/core/error.hpp"
#include "softsim/core/tensor.hpp"
#include "softsim/kinematics/neighbourhood.hpp"
#include "softsim/kinematics/node_shapes.hpp"
#include "softsim/kinematics/radial_weights.hpp"
#include "softsim/mesh/point_grid.hpp"

namespace softsim {

/// Options of `Gaussian`.
struct GaussianOptions {
  double width = 0;  ///< s in m, to be given; about the distance between nodes
  double radius = std::numeric_limits<double>::infinity();  ///< of the support, m
  std::size_t nearest = 0;                                  ///< only so many nearest nodes; 0: no limit
};

/// Normalised Gaussian radial basis functions (Bosman 2015, Sec. 4.1 and Table 4.1): phi_i = w_i / sum w,
/// w = exp(-d^2 / (2 s^2)), less its value at the support radius if there is one (Belytschko, Lu & Gu 1994),
/// so that functions are continuous there, with a small kink. They take nodes in any arrangement, reproduce
/// constants only, and approximate: phi_i(x_i) < 1.
/// With `nearest`, functions jump where the neighbours change; gradients are those with the neighbours fixed.
template <NeighbourSearch Search = PointGrid>
class Gaussian {
 public:
  /// @param nodes rest positions in m
  /// @throws std::invalid_argument if there are no nodes, a coordinate is not finite, the width is not
  ///   positive and finite, the radius is not positive
  Gaussian(std::vector<Vec3<double>> nodes, const GaussianOptions& options)
      : neighbours_(std::move(nodes), options.radius, options.nearest), width_(options.width) {
    if (!(width_ > 0 && std::isfinite(width_)))
      invalid(std::string("width ") + to_text(width_) + " m: must be positive and finite");
  }

  /// Rest positions in m.
  [[nodiscard]] const std::vector<Vec3<double>>& nodes() const { return neighbours_.nodes(); }
  /// Constants are reproduced.
  [[nodiscard]] int consistency() const { return 0; }
  /// They lack the Kronecker property.
  [[nodiscard]] bool interpolates() const { return false; }
  /// The radius in m.
  [[nodiscard]] double support() const { return neighbours_.radius(); }

  /// The shape functions at x (m).
  /// @throws std::invalid_argument if x is not finite or no node is within the radius
  [[nodiscard]] ShapeValues at(const Vec3<double>& x) const {
    const std::vector<Neighbour> near = neighbours_.at(x);
    const std::size_t top = detail::nearest_of(near);
    std::vector<RadialWeight> weights;
    for (const Neighbour& n : near) {
      // relative to the untruncated Gaussian of the nearest node: never all of them underflow
      const double kept = -std::expm1(-half_square_gap(neighbours_.radius(), n.distance));
      weights.push_back({kept * std::exp(-half_square_gap(n.distance, near[top].distance)),
                         n.offset / width_ * (-1 / (width_ * kept))});
    }
    return detail::partition_of_unity(near, weights, top);
  }

 private:
  // (a^2 - b^2) / (2 s^2) without the cancellation
  [[nodiscard]] double half_square_gap(double a, double b) const {
    return (a - b) / width_ * ((a + b) / width_) / 2;
  }

  Neighbourhood<Search> neighbours_;
  double width_;
};

}  // namespace softsim
