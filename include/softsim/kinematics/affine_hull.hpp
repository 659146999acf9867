// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "softsim/core/error.hpp"
#include "softsim/core/tensor.hpp"

namespace softsim {

/// The smallest affine space that holds all nodes: a point, line, plane or all of R^3 (dimension 0 to 3),
/// with coordinates of its own. Shape functions of collinear or coplanar nodes are worked out within it. The
/// nodes may stray from it by 1e-9 of their extent.
class AffineHull {
 public:
  /// @param nodes at least one, with finite coordinates, m
  /// @throws std::invalid_argument if there are no nodes or a coordinate is not finite
  explicit AffineHull(const std::vector<Vec3<double>>& nodes) {
    if (nodes.empty()) invalid("affine hull: there are no nodes");
    for (std::size_t i = 0; i < nodes.size(); ++i)
      if (!nodes[i].allFinite())
        invalid(std::string("node ") + std::to_string(i) + ": a coordinate is not a finite number");
    origin_ = nodes.front();
    find_axes(nodes);
  }

  /// 0 to 3.
  [[nodiscard]] int dimension() const { return dimension_; }
  /// Distance in m of the node farthest from the first: at least half the diameter of the nodes.
  [[nodiscard]] double extent() const { return extent_; }

  /// Coordinates in the hull of the projection of x (m) onto it, those beyond its dimension being 0.
  [[nodiscard]] Vec3<double> local(const Vec3<double>& x) const {
    Vec3<double> y = axes_.transpose() * (x - origin_);
    for (int a = dimension_; a < 3; ++a) y[a] = 0;
    return y;
  }
  /// The same of all nodes.
  [[nodiscard]] std::vector<Vec3<double>> local(const std::vector<Vec3<double>>& nodes) const {
    std::vector<Vec3<double>> result;
    for (const Vec3<double>& x : nodes) result.push_back(local(x));
    return result;
  }
  /// A vector given in the hull's coordinates, in those of space.
  [[nodiscard]] Vec3<double> direction(const Vec3<double>& y) const { return axes_ * y; }

 private:
  // Gram-Schmidt: each axis points to the node that is farthest from the hull of the axes before it.
  void find_axes(const std::vector<Vec3<double>>& nodes) {
    Mat3<double> beside = Mat3<double>::Identity();  // projects onto what the axes do not span yet
    double largest = 0;
    for (const Vec3<double>& x : nodes) largest = std::max(largest, x.cwiseAbs().maxCoeff());
    while (dimension_ < 3) {
      Vec3<double> farthest = Vec3<double>::Zero();
      for (const Vec3<double>& x : nodes)
        if (const Vec3<double> v = beside * (x - origin_); v.norm() > farthest.norm()) farthest = v;
      const double distance = farthest.norm();
      if (dimension_ == 0) extent_ = distance;
      // the second bound: what the coordinates' own rounding may do, far from the origin
      if (!(distance > std::max(1e-9 * extent_, 1e-15 * largest))) break;
      axes_.col(dimension_++) = farthest / distance;
      beside -= farthest * farthest.transpose() / (distance * distance);
    }
    if (dimension_ == 3) axes_.setIdentity();  // no need to turn
  }

  Vec3<double> origin_ = Vec3<double>::Zero();
  Mat3<double> axes_ = Mat3<double>::Identity();
  int dimension_ = 0;
  double extent_ = 0;
};

}  // namespace softsim
