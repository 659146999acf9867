// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

#include "softsim/kinematics/frame_body.hpp"
#include "softsim/kinematics/node_shapes.hpp"
#include "softsim/mesh/frame_nodes.hpp"
#include "softsim/mesh/generators.hpp"
#include "softsim/system/tangent.hpp"

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

/// Checks forces, product and assembled tangent of a system against differences of its energy at q along d:
/// in axes that turn, the gradient's derivative is the product less r x m / 2 for a moment m of the gradient.
template <class S>
void expect_derivatives(const S& system, const softsim::State<double>& q, const softsim::Vector<double>& d) {
  using Vec = softsim::Vector<double>;
  const auto at = [&](double s) {
    softsim::State<double> p = q;
    retract(p, d, s);
    return p;
  };
  const auto energy = [&](double s) { return system.energy(at(s)); };
  const auto gradient = [&](double s) {
    Vec g = Vec::Zero(q.size());
    system.add_gradient(at(s), g);
    return g;
  };
  const double h = 1e-3, e = 1e-5;  // errors h^4 and e^2, beside rounding/h^2 and rounding/e
  const Vec g = gradient(0);
  const double slope = (8 * (energy(h) - energy(-h)) - (energy(2 * h) - energy(-2 * h))) / (12 * h);
  EXPECT_NEAR(g.dot(d), slope, 1e-6 * std::abs(slope));
  Vec Hd = Vec::Zero(q.size());
  system.add_hessian_product(q, d, Hd);
  const double curvature =
      (-energy(2 * h) + 16 * energy(h) - 30 * energy(0) + 16 * energy(-h) - energy(-2 * h)) / (12 * h * h);
  EXPECT_NEAR(d.dot(Hd), curvature, 1e-6 * std::abs(curvature));
  softsim::AssembledTangent<S> tangent;
  tangent.set(system, q, {});
  Vec assembled(q.size());
  tangent.apply(d, assembled);
  EXPECT_LT((assembled - Hd).norm(), 1e-12 * Hd.norm());
  const Vec difference = (gradient(e) - gradient(-e)) / (2 * e);
  for (std::ptrdiff_t j = 0; j < q.frames(); ++j) {
    const std::ptrdiff_t b = q.frame_block(j) + 1;
    const V r = softsim::block(d, b), m = softsim::block(g, b);
    softsim::block(Hd, b) -= 0.5 * r.cross(m);
  }
  EXPECT_LT((Hd - difference).norm(), 1e-6 * difference.norm());
}

/// Checks that rigid motions of the body at q leave its energy, turn its forces with it and its torques not
/// at all (they are in the axes of the bodies), and that forces and torques balance.
template <class S>
void expect_objective(const S& system, const softsim::State<double>& q, int trials) {
  using Vec = softsim::Vector<double>;
  const double energy = system.energy(q);
  Vec g = Vec::Zero(q.size());
  system.add_gradient(q, g);
  std::mt19937 engine(3);
  const auto random = [&](double size) {
    V v;
    for (int a = 0; a < 3; ++a) v[a] = size * (2 * static_cast<double>(engine()) / 4294967296.0 - 1);
    return v;
  };
  for (int trial = 0; trial < trials; ++trial) {
    const V r = random(3), t = random(10);
    const Mat3<double> R = softsim::rotation_exponential(r);
    softsim::State<double> moved = q;
    for (std::ptrdiff_t j = 0; j < q.frames(); ++j) {
      const V& X = system.rest()[static_cast<std::size_t>(q.frame_block(j))];
      moved.translation(j) = R * (X + q.translation(j)) + t - X;
      moved.quaternion(j) =
          softsim::quaternion_product<double>(softsim::quaternion_exponential(r), q.quaternion(j));
    }
    EXPECT_NEAR(system.energy(moved), energy, 1e-10 * energy);
    Vec there = Vec::Zero(q.size());
    system.add_gradient(moved, there);
    V force = V::Zero(), torque = V::Zero();
    double worst = 0;
    for (std::ptrdiff_t j = 0; j < q.frames(); ++j) {
      const std::ptrdiff_t b = q.frame_block(j);
      const V f = softsim::block(there, b), m = softsim::block(there, b + 1);
      worst = std::max({worst, (f - R * softsim::block(g, b)).norm(), (m - softsim::block(g, b + 1)).norm()});
      force += f;
      torque += (system.rest()[static_cast<std::size_t>(b)] + moved.translation(j)).cross(f) +
                moved.rotation(j) * m;
    }
    EXPECT_LT(worst, 1e-11 * g.norm());
    EXPECT_LT(force.norm(), 1e-11 * g.norm());
    EXPECT_LT(torque.norm(), 1e-10 * g.norm());  // at arms of up to 17 m
  }
}

}  // namespace frame_bodies
