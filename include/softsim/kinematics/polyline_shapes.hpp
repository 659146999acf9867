// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "softsim/core/error.hpp"
#include "softsim/core/tensor.hpp"
#include "softsim/kinematics/node_shapes.hpp"
#include "softsim/kinematics/point_text.hpp"
#include "softsim/mesh/curve_samples.hpp"

namespace softsim {

/// Weights of a row of nodes, linear along the polyline through them: x is projected on the nearest segment
/// (of several, the one of the lowest number), and its two nodes share it by the distance along it. Where the
/// nearest point of the polyline is a node (beyond its ends, on the outer side of a bend) that node's weight
/// is 1 and its gradient 0. Values jump where the nearest segment changes other than at a node: on the inner
/// side of a bend, and between parts of the polyline that run side by side.
///
/// Frames in a row carry rigid sections, so that fields are linear along the row alone: `consistency` is 0.
/// For a rod in bending, samples belong in the middle between frames, one section each (`sample_curve` with
/// as many pieces as segments). Two frames at a distance h turned by theta_0 and theta_1 blend, at s in [0,
/// 1] of their gap, to the shear strain (u_1 - u_0)/h - (theta_0 + theta_1)/2 + (1/2 - s) (theta_0 -
/// theta_1). The last part comes with every bending and is zero in the middle alone; elsewhere it makes a rod
/// of height t stiffer by the factor 1 + 12 (k G/E) (h/t)^2 (1/2 - s)^2, with shear factor k = 1.
/// `LinkedShapes` has none of it.
class PolylineShapes {
 public:
  /// @param nodes rest positions in m, in their order along the line
  /// @throws std::invalid_argument for fewer than two nodes, a coordinate that is not finite, or a node at
  ///   the place of the one before
  explicit PolylineShapes(std::vector<Vec3<double>> nodes) : nodes_(std::move(nodes)) {
    detail::check_polyline(nodes_);
  }

  /// Rest positions in m.
  [[nodiscard]] const std::vector<Vec3<double>>& nodes() const { return nodes_; }
  /// Constants are reproduced, and linear fields on the polyline itself only.
  [[nodiscard]] int consistency() const { return 0; }
  /// They have the Kronecker property, unless the polyline runs through a node more than once.
  [[nodiscard]] bool interpolates() const { return true; }
  /// Infinite: it depends on the other nodes.
  [[nodiscard]] double support() const { return std::numeric_limits<double>::infinity(); }

  /// The one or two shape functions at x (m).
  /// @throws std::invalid_argument if x is not finite
  [[nodiscard]] ShapeValues at(const Vec3<double>& x) const {
    if (!x.allFinite()) invalid("point " + detail::point_text(x) + ": a coordinate is not a finite number");
    std::size_t nearest = 0;
    double shortest = std::numeric_limits<double>::infinity(), s = 0;
    for (std::size_t i = 0; i + 1 < nodes_.size(); ++i) {
      const Vec3<double> along = nodes_[i + 1] - nodes_[i];
      const double part = std::clamp((x - nodes_[i]).dot(along) / along.squaredNorm(), 0.0, 1.0);
      const double distance = (x - nodes_[i] - part * along).squaredNorm();
      if (distance < shortest) {
        nearest = i;
        shortest = distance;
        s = part;
      }
    }
    const auto first = static_cast<std::int32_t>(nearest);
    if (s == 0 || s == 1) return {{s == 0 ? first : first + 1}, {1}, {Vec3<double>::Zero()}, {}, {}};
    const Vec3<double> along = nodes_[nearest + 1] - nodes_[nearest], slope = along / along.squaredNorm();
    return {{first, first + 1}, {1 - s, s}, {-slope, slope}, {}, {}};
  }

 private:
  std::vector<Vec3<double>> nodes_;
};

}  // namespace softsim
