// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <concepts>
#include <cstddef>

#include "softsim/core/tensor.hpp"
#include "softsim/mesh/element_mesh.hpp"

namespace softsim {

/// Reference coordinates and weight of one integration point.
template <std::size_t dimension>
struct IntegrationPoint {
  std::array<double, dimension> xi;
  double weight;
};

/// Shape functions N_i(xi) of an element on its reference shape, with sum N_i = 1, and the rules that
/// integrate over it: `stiffness_rule` the energy, `mass_rule` volumes, weights and products N_i N_j.
/// `gradients` has one row per node. `row_sum_lumping` says that all int N_i dV are positive.
template <class S>
concept ShapeFunctions = requires(const std::array<double, 3>& xi) {
  { S::values(xi) } -> std::convertible_to<Eigen::Matrix<double, S::nodes, 1>>;
  { S::gradients(xi) } -> std::convertible_to<Eigen::Matrix<double, S::nodes, 3>>;
  { S::stiffness_rule[0] } -> std::convertible_to<IntegrationPoint<3>>;
  { S::mass_rule[0] } -> std::convertible_to<IntegrationPoint<3>>;
  { S::row_sum_lumping } -> std::convertible_to<bool>;
  { S::name } -> std::convertible_to<ElementName>;
  S::faces[0][0];
};

/// dX/dxi = sum X_i grad N_i^T at the reference point xi of the element with nodes X, m.
template <class S>
[[nodiscard]] Mat3<double> jacobian(const std::array<Vec3<double>, static_cast<std::size_t>(S::nodes)>& X,
                                    const std::array<double, 3>& xi) {
  const Eigen::Matrix<double, S::nodes, 3> dN = S::gradients(xi);
  Mat3<double> J = Mat3<double>::Zero();
  for (int i = 0; i < S::nodes; ++i) J += X[static_cast<std::size_t>(i)] * dN.row(i);
  return J;
}

namespace detail {

/// Tensor product of a rule on [-1, 1], first coordinate fastest.
template <std::size_t d, std::size_t n>
constexpr auto tensor_rule(const std::array<IntegrationPoint<1>, n>& line) {
  constexpr std::size_t count = d == 2 ? n * n : n * n * n;
  std::array<IntegrationPoint<d>, count> rule{};
  for (std::size_t q = 0; q < count; ++q) {
    rule[q].weight = 1;
    for (std::size_t a = 0, rest = q; a < d; ++a, rest /= n) {
      rule[q].xi[a] = line[rest % n].xi[0];
      rule[q].weight *= line[rest % n].weight;
    }
  }
  return rule;
}

inline constexpr std::array<IntegrationPoint<1>, 2> gauss_2{
    {{{-0.57735026918962576451}, 1}, {{0.57735026918962576451}, 1}}};
inline constexpr std::array<IntegrationPoint<1>, 3> gauss_3{
    {{{-0.77459666924148337704}, 5.0 / 9}, {{0}, 8.0 / 9}, {{0.77459666924148337704}, 5.0 / 9}}};

}  // namespace detail

/// Bilinear face of four nodes, counter-clockwise in (xi, eta) in [-1, 1]^2. The 2x2 Gauss rule integrates
/// N_i times the area vector exactly.
struct BilinearQuadrilateral {
  static constexpr int nodes = 4;
  static constexpr auto rule = detail::tensor_rule<2>(detail::gauss_2);

  [[nodiscard]] static Eigen::Matrix<double, 4, 1> values(const std::array<double, 2>& xi) {
    Eigen::Matrix<double, 4, 1> N;
    for (int i = 0; i < 4; ++i) N[i] = (1 + sign(i, 0) * xi[0]) * (1 + sign(i, 1) * xi[1]) / 4;
    return N;
  }
  [[nodiscard]] static Eigen::Matrix<double, 4, 2> gradients(const std::array<double, 2>& xi) {
    Eigen::Matrix<double, 4, 2> dN;
    for (int i = 0; i < 4; ++i) {
      dN(i, 0) = sign(i, 0) * (1 + sign(i, 1) * xi[1]) / 4;
      dN(i, 1) = sign(i, 1) * (1 + sign(i, 0) * xi[0]) / 4;
    }
    return dN;
  }

 private:
  static double sign(int node, int axis) {
    return axis == 0 ? (node % 3 == 0 ? -1 : 1) : (node < 2 ? -1 : 1);
  }
};

/// Quadratic face of six nodes: corners, then the middles of the edges 01, 12, 20. The six-point rule of
/// degree 4 (Cowper 1973) integrates N_i times the area vector exactly, on curved faces too.
struct QuadraticTriangle {
  static constexpr int nodes = 6;
  static constexpr std::array<IntegrationPoint<2>, 6> rule = [] {
    constexpr double a[] = {0.44594849091596488632, 0.091576213509770743460};
    constexpr double w[] = {0.22338158967801146570 / 2, 0.10995174365532186764 / 2};
    std::array<IntegrationPoint<2>, 6> points{};
    for (std::size_t k = 0; k < 2; ++k) {
      points[3 * k] = {{a[k], a[k]}, w[k]};
      points[3 * k + 1] = {{1 - 2 * a[k], a[k]}, w[k]};
      points[3 * k + 2] = {{a[k], 1 - 2 * a[k]}, w[k]};
    }
    return points;
  }();

  [[nodiscard]] static Eigen::Matrix<double, 6, 1> values(const std::array<double, 2>& xi) {
    const double L[] = {1 - xi[0] - xi[1], xi[0], xi[1]};
    Eigen::Matrix<double, 6, 1> N;
    for (int i = 0; i < 3; ++i) {
      N[i] = L[i] * (2 * L[i] - 1);
      N[3 + i] = 4 * L[i] * L[(i + 1) % 3];
    }
    return N;
  }
  [[nodiscard]] static Eigen::Matrix<double, 6, 2> gradients(const std::array<double, 2>& xi) {
    const double L[] = {1 - xi[0] - xi[1], xi[0], xi[1]};
    constexpr double dL[3][2] = {{-1, -1}, {1, 0}, {0, 1}};
    Eigen::Matrix<double, 6, 2> dN;
    for (int i = 0; i < 3; ++i)
      for (int a = 0; a < 2; ++a) {
        const int j = (i + 1) % 3;
        dN(i, a) = (4 * L[i] - 1) * dL[i][a];
        dN(3 + i, a) = 4 * (L[i] * dL[j][a] + L[j] * dL[i][a]);
      }
    return dN;
  }
};

/// Trilinear hexahedron on [-1, 1]^3. Nodes as VTK numbers them (VTK_HEXAHEDRON): 0 to 3 around the bottom
/// zeta = -1, counter-clockwise seen from above, 4 to 7 above them. `stiffness_rule` is 2x2x2 Gauss: volume,
/// int N_i dV and int grad N_i dV are exact for any trilinear shape (each is of degree 3 or less along each
/// axis), so that distorted elements pass the patch test. `mass_rule` is 3x3x3 Gauss, exact for N_i N_j.
struct TrilinearHexahedronShape {
  static constexpr int nodes = 8;
  static constexpr ElementName name{"hexahedron", "hexahedra"};
  static constexpr auto stiffness_rule = detail::tensor_rule<3>(detail::gauss_2);
  static constexpr auto mass_rule = detail::tensor_rule<3>(detail::gauss_3);
  static constexpr bool row_sum_lumping = true;
  using Face = BilinearQuadrilateral;
  /// Nodes of each face, counter-clockwise seen from outside.
  static constexpr std::array<std::array<std::size_t, 4>, 6> faces{
      {{0, 4, 7, 3}, {1, 2, 6, 5}, {0, 1, 5, 4}, {3, 7, 6, 2}, {0, 3, 2, 1}, {4, 5, 6, 7}}};

  [[nodiscard]] static Eigen::Matrix<double, 8, 1> values(const std::array<double, 3>& xi) {
    Eigen::Matrix<double, 8, 1> N;
    for (int i = 0; i < 8; ++i) N[i] = factor(i, 0, xi) * factor(i, 1, xi) * factor(i, 2, xi);
    return N;
  }
  [[nodiscard]] static Eigen::Matrix<double, 8, 3> gradients(const std::array<double, 3>& xi) {
    Eigen::Matrix<double, 8, 3> dN;
    for (int i = 0; i < 8; ++i)
      for (int a = 0; a < 3; ++a)
        dN(i, a) = sign(i, a) / 2 * factor(i, (a + 1) % 3, xi) * factor(i, (a + 2) % 3, xi);
    return dN;
  }

 private:
  static double sign(int node, int axis) {
    const int k = node % 4;
    const bool upper = axis == 0 ? (k == 1 || k == 2) : axis == 1 ? k >= 2 : node >= 4;
    return upper ? 1 : -1;
  }
  static double factor(int node, int axis, const std::array<double, 3>& xi) {
    return (1 + sign(node, axis) * xi[static_cast<std::size_t>(axis)]) / 2;
  }
};

/// Ten-node tetrahedron with quadratic shape functions on xi, eta, zeta >= 0, xi + eta + zeta <= 1. Nodes as
/// VTK numbers them (VTK_QUADRATIC_TETRA): four corners, then the middles of the edges 01, 12, 20, 03, 13, 23
/// (Gmsh swaps the last two). `stiffness_rule` has four points and is exact for degree 2: with straight sides
/// and edge nodes in the middle that is int grad N_i dV (so the patch test) and the stiffness of a linear
/// material, all of it. With curved sides int grad N_i dV is of degree 3 and met to the order of the element
/// only. `mass_rule` has 14 points, all weights positive, and is exact for degree 5 (Walkington 2000): N_i
/// N_j with straight sides, volume and int N_i dV with curved ones too.
struct QuadraticTetrahedronShape {
  static constexpr int nodes = 10;
  static constexpr ElementName name{"ten-node tetrahedron", "ten-node tetrahedra"};
  static constexpr std::array<IntegrationPoint<3>, 4> stiffness_rule = [] {
    constexpr double a = 0.1381966011250105151795, w = 1.0 / 24;
    return std::array<IntegrationPoint<3>, 4>{
        {{{a, a, a}, w}, {{1 - 3 * a, a, a}, w}, {{a, 1 - 3 * a, a}, w}, {{a, a, 1 - 3 * a}, w}}};
  }();
  static constexpr std::array<IntegrationPoint<3>, 14> mass_rule = [] {
    constexpr double a[] = {0.31088591926330060980, 0.092735250310891226402};
    constexpr double w[] = {0.11268792571801585080 / 6, 0.073493043116361949544 / 6};
    constexpr double b = 0.045503704125649649492, c = 0.5 - b, v = 0.042546020777081466438 / 6;
    std::array<IntegrationPoint<3>, 14> points{};
    for (std::size_t k = 0; k < 2; ++k) {
      points[4 * k] = {{a[k], a[k], a[k]}, w[k]};
      points[4 * k + 1] = {{1 - 3 * a[k], a[k], a[k]}, w[k]};
      points[4 * k + 2] = {{a[k], 1 - 3 * a[k], a[k]}, w[k]};
      points[4 * k + 3] = {{a[k], a[k], 1 - 3 * a[k]}, w[k]};
    }
    points[8] = {{b, b, c}, v};
    points[9] = {{b, c, b}, v};
    points[10] = {{c, b, b}, v};
    points[11] = {{c, c, b}, v};
    points[12] = {{c, b, c}, v};
    points[13] = {{b, c, c}, v};
    return points;
  }();
  /// int N_i dV of a corner is -V/20 with straight sides; see `IsoparametricMesh::lumped_volumes`.
  static constexpr bool row_sum_lumping = false;
  using Face = QuadraticTriangle;
  /// Corners of each edge, in the order of their middle nodes 4 to 9.
  static constexpr std::array<std::array<std::size_t, 2>, 6> edges{
      {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}};
  /// Nodes of each face: corners counter-clockwise seen from outside, then the middles of their edges.
  static constexpr std::array<std::array<std::size_t, 6>, 4> faces{
      {{1, 2, 3, 5, 9, 8}, {0, 3, 2, 7, 9, 6}, {0, 1, 3, 4, 8, 7}, {0, 2, 1, 6, 5, 4}}};

  [[nodiscard]] static Eigen::Matrix<double, 10, 1> values(const std::array<double, 3>& xi) {
    const std::array<double, 4> L{1 - xi[0] - xi[1] - xi[2], xi[0], xi[1], xi[2]};
    Eigen::Matrix<double, 10, 1> N;
    for (std::size_t i = 0; i < 4; ++i) N[static_cast<int>(i)] = L[i] * (2 * L[i] - 1);
    for (std::size_t k = 0; k < 6; ++k) N[static_cast<int>(4 + k)] = 4 * L[edges[k][0]] * L[edges[k][1]];
    return N;
  }
  [[nodiscard]] static Eigen::Matrix<double, 10, 3> gradients(const std::array<double, 3>& xi) {
    const std::array<double, 4> L{1 - xi[0] - xi[1] - xi[2], xi[0], xi[1], xi[2]};
    constexpr double dL[4][3] = {{-1, -1, -1}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    Eigen::Matrix<double, 10, 3> dN;
    for (int c = 0; c < 3; ++c) {
      for (std::size_t i = 0; i < 4; ++i) dN(static_cast<int>(i), c) = (4 * L[i] - 1) * dL[i][c];
      for (std::size_t k = 0; k < 6; ++k) {
        const auto [a, b] = edges[k];
        dN(static_cast<int>(4 + k), c) = 4 * (L[a] * dL[b][c] + L[b] * dL[a][c]);
      }
    }
    return dN;
  }
};

}  // namespace softsim
