// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "softsim/core/tensor.hpp"
#include "softsim/kinematics/node_shapes.hpp"

namespace softsim {

/// Shape functions whose frames turn what is around them with half the arm: x = sum_i w_i x_i + R_i c_i,
///   c_i = w_i (X - X_i + m) / 2,  m = X - sum_j w_j X_j,
/// instead of c_i = w_i (X - X_i). m is what the weights lack to reproduce X: zero for those of meshes, the
/// part perpendicular to the line for `PolylineShapes`. sum c_i = m, so that rigid motions are reproduced as
/// before.
///
/// Weights that reproduce linear fields then reproduce quadratic ones by sum_i w_i (u_i + grad u_i (X -
/// X_i)/2): from u = X^T A X, the sum is X^T A sum w_i X_i = u. With the whole arm it overshoots by as much
/// as linear interpolation falls short. Frames on meshes answer by turning half as far as the body does: they
/// deform as well under small displacements, but a moment on them bends the body half as much as it should.
/// Where sections are rigid (`PolylineShapes`) frames cannot do that, and bending comes with shear. Half the
/// arm is the linked interpolation of beams (Tessler & Dong 1981) and that of elements with drilling
/// rotations (Allman 1984). Frames only know the rotation in grad u: strains that vary keep the error of the
/// weights.
template <NodeShapes Shapes>
class LinkedShapes {
 public:
  /// @param shapes what gives the weights w_i
  explicit LinkedShapes(Shapes shapes) : shapes_(std::move(shapes)) {}

  /// What they are made of.
  [[nodiscard]] const Shapes& shapes() const { return shapes_; }
  /// Rest positions of the nodes, m.
  [[nodiscard]] const std::vector<Vec3<double>>& nodes() const { return shapes_.nodes(); }
  /// That of the shapes without rotations.
  [[nodiscard]] int consistency() const { return shapes_.consistency(); }
  /// Whether the weights have the Kronecker property.
  [[nodiscard]] bool interpolates() const { return shapes_.interpolates(); }
  /// That of the weights, m.
  [[nodiscard]] double support() const { return shapes_.support(); }

  /// The shape functions at x (m), c_i in `slopes`.
  /// @throws std::invalid_argument where those of `shapes()` do
  [[nodiscard]] ShapeValues at(const Vec3<double>& x) const {
    ShapeValues s = shapes_.at(x);
    const auto node = [&](std::size_t i) -> const Vec3<double>& {
      return nodes()[static_cast<std::size_t>(s.nodes[i])];
    };
    Vec3<double> lack = Vec3<double>::Zero();
    Mat3<double> lack_gradient = Mat3<double>::Identity();
    for (std::size_t i = 0; i < s.nodes.size(); ++i) {
      lack += s.values[i] * (x - node(i));
      lack_gradient -= (node(i) - x) * s.gradients[i].transpose();
    }
    s.slopes.clear();
    s.slope_gradients.clear();
    for (std::size_t i = 0; i < s.nodes.size(); ++i) {
      const Vec3<double> arm = 0.5 * (x - node(i) + lack);
      s.slopes.push_back(s.values[i] * arm);
      s.slope_gradients.push_back(arm * s.gradients[i].transpose() +
                                  0.5 * s.values[i] * (Mat3<double>::Identity() + lack_gradient));
    }
    return s;
  }

 private:
  Shapes shapes_;
};

}  // namespace softsim
