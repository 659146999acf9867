// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "softsim/core/tensor.hpp"
#include "softsim/kinematics/node_shapes.hpp"

// Nodes without a mesh, and what fields do between them.
namespace scattered_nodes {

using softsim::ShapeValues;
using Vec = softsim::Vec3<double>;

// 125 nodes about 0.25 m apart in the unit cube, shaken, but for the first, which is at the origin.
inline std::vector<Vec> in_a_cube() {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> shake(-0.08, 0.08);
  std::vector<Vec> nodes;
  for (int i = 0; i < 125; ++i) {
    const Vec at(Vec(i % 5, i / 5 % 5, i / 25) / 4);
    nodes.push_back(i == 0 ? at : Vec(at + Vec(shake(random), shake(random), shake(random))));
  }
  return nodes;
}

// In a plane and on a line at a slant.
inline std::vector<Vec> in_a_plane() {
  std::vector<Vec> nodes;
  for (int i = 0; i < 25; ++i)
    nodes.push_back(Vec(0.1, 0.2, 0.3) + i % 5 * Vec(0.2, 0.05, 0.1) + i / 5 * Vec(-0.02, 0.2, 0.1));
  return nodes;
}
inline std::vector<Vec> on_a_line() {
  std::vector<Vec> nodes;
  for (int i = 0; i < 9; ++i) nodes.push_back(Vec(0.1, 0.2, 0.3) + i * Vec(0.1, 0.07, -0.05));
  return nodes;
}

inline std::vector<Vec> places_in_a_cube(int count) {
  std::mt19937 random(17);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Vec> places;
  for (int i = 0; i < count; ++i) places.emplace_back(unit(random), unit(random), unit(random));
  return places;
}

// x^a y^b z^c about a place that is nobody's origin, and its gradient.
struct Monomial {
  std::array<int, 3> powers;
  [[nodiscard]] double value(const Vec& x) const {
    double product = 1;
    for (int k = 0; k < 3; ++k) product *= power(x, k, 0);
    return product;
  }
  [[nodiscard]] Vec gradient(const Vec& x) const {
    Vec result;
    for (int j = 0; j < 3; ++j) {
      result[j] = 1;
      for (int k = 0; k < 3; ++k) result[j] *= power(x, k, k == j ? 1 : 0);
    }
    return result;
  }

 private:
  [[nodiscard]] double power(const Vec& x, int axis, int derivative) const {
    const int n = powers[static_cast<std::size_t>(axis)];
    const double y = x[axis] - 0.3 - 0.1 * axis;
    return derivative == 0 ? std::pow(y, n) : n == 0 ? 0.0 : n * std::pow(y, n - 1);
  }
};

inline std::vector<Monomial> monomials(int degree) {
  std::vector<Monomial> result;
  for (int a = 0; a <= degree; ++a)
    for (int b = 0; a + b <= degree; ++b) result.push_back({{a, b, degree - a - b}});
  return result;
}

// Value and gradient at one place of the field with the nodal values, and gradients, of u.
struct Interpolated {
  double value = 0;
  Vec gradient = Vec::Zero();
};
template <class Field>
Interpolated interpolated(const ShapeValues& shapes, const std::vector<Vec>& nodes, const Field& u) {
  Interpolated result;
  for (std::size_t a = 0; a < shapes.nodes.size(); ++a) {
    const Vec& X = nodes[static_cast<std::size_t>(shapes.nodes[a])];
    result.value += u.value(X) * shapes.values[a];
    result.gradient += u.value(X) * shapes.gradients[a];
    if (shapes.slopes.empty()) continue;
    result.value += u.gradient(X).dot(shapes.slopes[a]);
    result.gradient += shapes.slope_gradients[a].transpose() * u.gradient(X);
  }
  return result;
}

// Values of all nodes' shape functions, zeros included; the slopes behind them, if there are any.
inline Eigen::VectorXd all_values(const ShapeValues& shapes, std::size_t nodes) {
  Eigen::VectorXd result = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(4 * nodes));
  for (std::size_t a = 0; a < shapes.nodes.size(); ++a) {
    result[shapes.nodes[a]] = shapes.values[a];
    if (!shapes.slopes.empty())
      result.segment<3>(static_cast<Eigen::Index>(nodes) + 3 * shapes.nodes[a]) = shapes.slopes[a];
  }
  return result;
}
inline Eigen::MatrixX3d all_gradients(const ShapeValues& shapes, std::size_t nodes) {
  Eigen::MatrixX3d result = Eigen::MatrixX3d::Zero(static_cast<Eigen::Index>(4 * nodes), 3);
  for (std::size_t a = 0; a < shapes.nodes.size(); ++a) {
    result.row(shapes.nodes[a]) = shapes.gradients[a];
    if (!shapes.slopes.empty())
      result.middleRows<3>(static_cast<Eigen::Index>(nodes) + 3 * shapes.nodes[a]) =
          shapes.slope_gradients[a];
  }
  return result;
}

// Largest difference between the gradients at x and central differences over 2 h.
template <class Shapes>
double gradient_error(const Shapes& shapes, const Vec& x, double h) {
  const std::size_t n = shapes.nodes().size();
  const Eigen::MatrixX3d gradients = all_gradients(shapes.at(x), n);
  double error = 0;
  for (int k = 0; k < 3; ++k) {
    const Vec step = h * Vec::Unit(k);
    const Eigen::VectorXd difference =
        (all_values(shapes.at(x + step), n) - all_values(shapes.at(x - step), n)) / (2 * h);
    error = std::max(error, (difference - gradients.col(k)).cwiseAbs().maxCoeff());
  }
  return error;
}

// The message of the refusal, or that there was none.
template <class Act>
std::string refusal(const Act& act) {
  try {
    act();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "nothing thrown";
}

}  // namespace scattered_nodes
