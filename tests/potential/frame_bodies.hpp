// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <random>
#include <vector>

#include "softsim/kinematics/frame_body.hpp"
#include "softsim/kinematics/node_shapes.hpp"
#include "softsim/mesh/frame_nodes.hpp"
#include "softsim/mesh/generators.hpp"

// Bodies of frames for tests.

namespace frame_bodies {

using softsim::Mat3;
using softsim::Vec3;
using V = Vec3<double>;

/// Frames on the nodes of a mesh of isoparametric elements, samples at its integration points.
template <int N>
struct OnMesh {
  softsim::FrameNodes nodes;
  softsim::FrameBody<N> body;
};
template <softsim::ShapeFunctions S>
OnMesh<S::nodes> on_mesh(const softsim::IsoparametricMesh<S>& mesh) {
  std::vector<softsim::ShapeValues> shapes;
  std::vector<V> positions;
  std::vector<double> volumes;
  for (std::size_t e = 0; e < mesh.elements().size(); ++e) {
    const auto X = mesh.element_points(e);
    for (const auto& point : S::stiffness_rule) {
      const Mat3<double> J = softsim::jacobian<S>(X, point.xi);
      const auto w = S::values(point.xi);
      const auto dw = S::gradients(point.xi);
      softsim::ShapeValues at;
      V x = V::Zero();
      for (int i = 0; i < S::nodes; ++i) {
        at.nodes.push_back(mesh.elements()[e][static_cast<std::size_t>(i)]);
        at.values.push_back(w[i]);
        at.gradients.push_back(J.inverse().transpose() * dw.row(i).transpose());
        x += w[i] * X[static_cast<std::size_t>(i)];
      }
      shapes.push_back(at);
      positions.push_back(x);
      volumes.push_back(point.weight * J.determinant());
    }
  }
  softsim::FrameNodes nodes(mesh.points());
  return {nodes, {nodes, shapes, positions, volumes}};
}

/// An increment of every component, not larger than `size`.
inline softsim::Vector<double> increment(const softsim::State<double>& q, double size, unsigned seed) {
  std::mt19937 engine(seed);
  softsim::Vector<double> d = softsim::Vector<double>::Zero(q.size());
  for (std::ptrdiff_t k = 0; k < d.size(); ++k)
    if (k % softsim::block_stride != 3) d[k] = size * (2 * static_cast<double>(engine()) / 4294967296.0 - 1);
  return d;
}

}  // namespace frame_bodies
