// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT

// What all shape functions of nodes have to do, checked at one point.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "refusal.hpp"
#include "softsim/kinematics/node_shapes.hpp"

namespace node_shape_checks {

using Vec = softsim::Vec3<double>;

inline std::vector<Vec> random_points(int count, unsigned seed, const Vec& lower = Vec::Zero(),
                                      const Vec& upper = Vec::Ones()) {
  std::mt19937 bits(seed);
  std::uniform_real_distribution<double> number(0, 1);
  std::vector<Vec> points;
  for (int i = 0; i < count; ++i) {
    const double x = number(bits), y = number(bits), z = number(bits);
    points.push_back(lower + (upper - lower).cwiseProduct(Vec(x, y, z)));
  }
  return points;
}

// Lattice of count[0] x count[1] x count[2] nodes at distance 1, the first axis fastest.
inline std::vector<Vec> lattice(int nx, int ny, int nz) {
  std::vector<Vec> points;
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i) points.push_back(Vec(i, j, k));
  return points;
}

inline std::map<std::int32_t, double> values_by_node(const softsim::ShapeValues& shapes) {
  std::map<std::int32_t, double> result;
  for (std::size_t k = 0; k < shapes.nodes.size(); ++k) result[shapes.nodes[k]] = shapes.values[k];
  return result;
}

template <class Shapes>
double value(const Shapes& shapes, const Vec& x, std::int32_t node) {
  const auto values = values_by_node(shapes.at(x));
  const auto found = values.find(node);
  return found == values.end() ? 0 : found->second;
}

template <class Shapes, class Field>
double interpolated(const Shapes& shapes, const Vec& x, Field field) {
  const softsim::ShapeValues s = shapes.at(x);
  double sum = 0;
  for (std::size_t k = 0; k < s.nodes.size(); ++k)
    sum += s.values[k] * field(shapes.nodes()[static_cast<std::size_t>(s.nodes[k])]);
  return sum;
}

template <class Shapes, class Field>
Vec interpolated_gradient(const Shapes& shapes, const Vec& x, Field field) {
  const softsim::ShapeValues s = shapes.at(x);
  Vec sum = Vec::Zero();
  for (std::size_t k = 0; k < s.nodes.size(); ++k)
    sum += s.gradients[k] * field(shapes.nodes()[static_cast<std::size_t>(s.nodes[k])]);
  return sum;
}

// Ascending nodes, sum 1, sum of gradients 0, in lists of one length. `size`: distance between nodes in m.
inline void expect_partition_of_unity(const softsim::ShapeValues& s, double tolerance, double size = 1) {
  ASSERT_EQ(s.nodes.size(), s.values.size());
  ASSERT_EQ(s.nodes.size(), s.gradients.size());
  EXPECT_TRUE(s.slopes.empty() && s.slope_gradients.empty());
  for (std::size_t k = 1; k < s.nodes.size(); ++k) EXPECT_LT(s.nodes[k - 1], s.nodes[k]);
  double sum = 0;
  Vec sum_of_gradients = Vec::Zero();
  for (std::size_t k = 0; k < s.nodes.size(); ++k) {
    sum += s.values[k];
    sum_of_gradients += s.gradients[k];
  }
  EXPECT_NEAR(sum, 1, tolerance);
  EXPECT_LT(sum_of_gradients.norm() * size, tolerance);
}

inline void expect_not_negative(const softsim::ShapeValues& s) {
  for (const double value : s.values) EXPECT_GE(value, -1e-15);
}

// Value and gradient of a linear field, of slope 1 about.
template <class Shapes>
void expect_linear_reproduction(const Shapes& shapes, const Vec& x, double tolerance) {
  const Vec slope(0.7, -0.4, 0.6);
  const auto field = [&](const Vec& p) { return 0.3 + slope.dot(p); };
  EXPECT_NEAR(interpolated(shapes, x, field), field(x), tolerance) << x.transpose();
  EXPECT_LT((interpolated_gradient(shapes, x, field) - slope).norm(), tolerance) << x.transpose();
}

// Gradients of all functions at x against central differences of their values.
template <class Shapes>
void expect_gradients_are_derivatives(const Shapes& shapes, const Vec& x, double h, double tolerance) {
  std::map<std::int32_t, Vec> difference;
  for (int a = 0; a < 3; ++a) {
    const Vec step = h * Vec::Unit(a);
    for (const double sign : {-1.0, 1.0})
      for (const auto& [node, value] : values_by_node(shapes.at(x + sign * step))) {
        difference.try_emplace(node, Vec::Zero());
        difference[node][a] += sign * value / (2 * h);
      }
  }
  const softsim::ShapeValues s = shapes.at(x);
  for (std::size_t k = 0; k < s.nodes.size(); ++k) {
    difference.try_emplace(s.nodes[k], Vec::Zero());
    difference[s.nodes[k]] -= s.gradients[k];
  }
  for (const auto& [node, error] : difference)
    EXPECT_LT(error.norm(), tolerance) << node << " at " << x.transpose();
}

using refusals::expect_refused;

}  // namespace node_shape_checks
