// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "softsim/core/tensor.hpp"
#include "softsim/mesh/shape_functions.hpp"

namespace softsim {

/// Four-node tetrahedron with the barycentric coordinates as shape functions, on xi, eta, zeta >= 0,
/// xi + eta + zeta <= 1.
struct LinearTetrahedronShape {
  static constexpr int nodes = 4;

  [[nodiscard]] static Eigen::Matrix<double, 4, 1> values(const std::array<double, 3>& xi) {
    return {1 - xi[0] - xi[1] - xi[2], xi[0], xi[1], xi[2]};
  }
  [[nodiscard]] static Eigen::Matrix<double, 4, 3> gradients(const std::array<double, 3>&) {
    Eigen::Matrix<double, 4, 3> dN;
    dN << -1, -1, -1, 1, 0, 0, 0, 1, 0, 0, 0, 1;
    return dN;
  }
};

/// A side of a reference shape, the plane offset + normal . xi = 0; positive inside.
struct ReferenceSide {
  double offset;
  std::array<double, 3> normal;

  [[nodiscard]] double height(const Vec3<double>& xi) const { return offset + direction().dot(xi); }
  [[nodiscard]] Vec3<double> direction() const { return {normal[0], normal[1], normal[2]}; }
};

namespace detail {

struct UnitTetrahedron {
  static constexpr std::array<ReferenceSide, 4> sides{
      {{1, {-1, -1, -1}}, {0, {1, 0, 0}}, {0, {0, 1, 0}}, {0, {0, 0, 1}}}};
  static constexpr std::array<double, 3> centre{0.25, 0.25, 0.25};
  static constexpr std::array<std::array<double, 3>, 4> corners{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
};

}  // namespace detail

/// What a search needs to know of the reference shape on which the functions S are defined: its sides,
/// corners and centre; `around(X)`, points whose convex hull holds the element with the nodes X; `degree(X)`
/// up to which that element reproduces polynomials. The Jacobian has to be within the convex hull of those at
/// the corners. Specialise it for elements of your own.
template <class S>
struct ReferenceDomain;

template <>
struct ReferenceDomain<LinearTetrahedronShape> : detail::UnitTetrahedron {
  using Nodes = std::array<Vec3<double>, 4>;
  static Nodes around(const Nodes& X) { return X; }
  static int degree(const Nodes&) { return 1; }
};

template <>
struct ReferenceDomain<TrilinearHexahedronShape> {
  using Nodes = std::array<Vec3<double>, 8>;
  static constexpr std::array<ReferenceSide, 6> sides{
      {{1, {1, 0, 0}}, {1, {-1, 0, 0}}, {1, {0, 1, 0}}, {1, {0, -1, 0}}, {1, {0, 0, 1}}, {1, {0, 0, -1}}}};
  static constexpr std::array<double, 3> centre{0, 0, 0};
  static constexpr std::array<std::array<double, 3>, 8> corners{
      {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}, {-1, -1, 1}, {1, -1, 1}, {1, 1, 1}, {-1, 1, 1}}};
  static Nodes around(const Nodes& X) { return X; }
  static int degree(const Nodes&) { return 1; }
};

template <>
struct ReferenceDomain<QuadraticTetrahedronShape> : detail::UnitTetrahedron {
  using Nodes = std::array<Vec3<double>, 10>;
  // The control points of its Bernstein form: edges may bulge beyond their middle nodes.
  static Nodes around(Nodes X) {
    for (std::size_t k = 0; k < 6; ++k) {
      const auto [a, b] = QuadraticTetrahedronShape::edges[k];
      X[4 + k] = 2 * X[4 + k] - 0.5 * (X[a] + X[b]);
    }
    return X;
  }
  // 2 with straight edges and their nodes in the middle, where x is linear in xi, else 1.
  static int degree(const Nodes& X) {
    for (std::size_t k = 0; k < 6; ++k) {
      const auto [a, b] = QuadraticTetrahedronShape::edges[k];
      if (!((X[4 + k] - 0.5 * (X[a] + X[b])).norm() <= 1e-9 * (X[a] - X[b]).norm())) return 1;
    }
    return 2;
  }
};

}  // namespace softsim
