// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "softsim/core/error.hpp"
#include "softsim/core/tensor.hpp"
#include "softsim/mesh/hexahedral_mesh.hpp"
#include "softsim/mesh/tetrahedral_mesh.hpp"

namespace softsim {

namespace detail {

inline void check_count(const std::string& name, int count) {
  if (count < 1) invalid(name + " " + std::to_string(count) + ": must be at least 1");
}

inline void check_length(const std::string& name, double length) {
  if (!(length > 0 && std::isfinite(length)))
    invalid(name + " " + to_text(length) + ": must be positive and finite");
}

/// Number of node (i, j, k) in a grid of cells[0] x cells[1] x cells[2].
inline std::int32_t grid_node(const std::array<int, 3>& cells, const std::array<int, 3>& ijk) {
  return static_cast<std::int32_t>((ijk[2] * (cells[1] + 1) + ijk[1]) * (cells[0] + 1) + ijk[0]);
}

/// Number of nodes of a grid of nx x ny x nz cells.
/// @throws std::invalid_argument if 32-bit node numbers do not reach that far
inline std::size_t grid_node_count(double nx, double ny, double nz) {
  const double count = (nx + 1) * (ny + 1) * (nz + 1);
  if (count > static_cast<double>(std::numeric_limits<std::int32_t>::max()))
    invalid(std::string("cells ") + to_text(nx) + " x " + to_text(ny) + " x " + to_text(nz) + ": " +
            to_text(count) + " nodes are more than 32-bit numbers can count");
  return static_cast<std::size_t>(count);
}

/// Appends the six Kuhn tetrahedra of one cell: each walks from `corner` to the opposite corner along the
/// three axes in one of the six orders. `step` (+1 or -1 per axis) says on which side of the corner the cell
/// lies.
inline void append_kuhn_cell(const std::array<int, 3>& cells, const std::array<int, 3>& corner,
                             const std::array<int, 3>& step, std::vector<Tetrahedron>& tetrahedra) {
  constexpr std::array<std::array<std::size_t, 3>, 6> orders{
      {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}}};
  const bool mirrored = step[0] * step[1] * step[2] < 0;
  for (std::size_t o = 0; o < orders.size(); ++o) {
    std::array<int, 3> ijk = corner;
    Tetrahedron v;
    v[0] = grid_node(cells, ijk);
    for (std::size_t s = 0; s < 3; ++s) {
      ijk[orders[o][s]] += step[orders[o][s]];
      v[s + 1] = grid_node(cells, ijk);
    }
    const bool odd = o >= 3;
    if (odd != mirrored) std::swap(v[2], v[3]);
    tetrahedra.push_back(v);
  }
}

/// Point of the unit disc for (x, y) in [-1, 1]^2: concentric squares become concentric circles, and equal
/// steps along a square equal arcs (Shirley & Chiu 1997).
inline std::array<double, 2> square_to_disc(double x, double y) {
  const double radius = std::max(std::abs(x), std::abs(y));
  if (radius == 0) return {0, 0};
  const double angle = std::numbers::pi / 4 * std::min(std::abs(x), std::abs(y)) / radius;
  double u = radius * std::cos(angle), v = radius * std::sin(angle);
  if (std::abs(y) > std::abs(x)) std::swap(u, v);
  return {std::copysign(u, x), std::copysign(v, y)};
}

}  // namespace detail

namespace detail {

/// Nodes of a box of equal cells, numbered as `box_mesh` says.
inline std::vector<Vec3<double>> box_points(const std::array<int, 3>& cells, const Vec3<double>& lengths,
                                            const Vec3<double>& origin) {
  for (int a = 0; a < 3; ++a) {
    const std::string axis = std::string("[") + std::to_string(a) + "]";
    check_count(std::string("cells") + axis, cells[static_cast<std::size_t>(a)]);
    check_length(std::string("lengths") + axis, lengths[a]);
    if (!std::isfinite(origin[a]))
      invalid(std::string("origin") + axis + " " + to_text(origin[a]) + ": must be finite");
  }
  std::vector<Vec3<double>> points;
  points.reserve(grid_node_count(cells[0], cells[1], cells[2]));
  for (int k = 0; k <= cells[2]; ++k)
    for (int j = 0; j <= cells[1]; ++j)
      for (int i = 0; i <= cells[0]; ++i) {
        const Vec3<double> fraction(double(i) / cells[0], double(j) / cells[1], double(k) / cells[2]);
        points.push_back(origin + lengths.cwiseProduct(fraction));
      }
  return points;
}

}  // namespace detail

/// Box of `cells` equal cells along x, y, z, each split into six Kuhn tetrahedra around the diagonal from its
/// lowest to its highest corner; the split is the same in every cell, hence conforming.
/// @param cells number of cells per axis
/// @param lengths edge lengths in m
/// @param origin lowest corner in m
/// Node (i, j, k) has the number (k (ny + 1) + j) (nx + 1) + i. The tetrahedra follow cell by cell (i
/// fastest); their four nodes start at the cell's lowest corner.
/// @throws std::invalid_argument for a count below 1, a length that is not positive and finite, an origin
///   that is not finite, or more nodes than 32-bit numbers can count
[[nodiscard]] inline TetrahedralMesh box_mesh(const std::array<int, 3>& cells, const Vec3<double>& lengths,
                                              const Vec3<double>& origin = Vec3<double>::Zero()) {
  std::vector<Vec3<double>> points = detail::box_points(cells, lengths, origin);
  std::vector<Tetrahedron> tetrahedra;
  for (int k = 0; k < cells[2]; ++k)
    for (int j = 0; j < cells[1]; ++j)
      for (int i = 0; i < cells[0]; ++i) detail::append_kuhn_cell(cells, {i, j, k}, {1, 1, 1}, tetrahedra);
  return TetrahedralMesh(std::move(points), std::move(tetrahedra));
}

/// The same box with one hexahedron per cell: nodes, order and errors as for `box_mesh`.
// A template, so that programs without hexahedra do not compile their mesh.
template <class Mesh = HexahedralMesh>
requires std::same_as<Mesh, HexahedralMesh>
[[nodiscard]] Mesh box_hexahedra(const std::array<int, 3>& cells, const Vec3<double>& lengths,
                                 const Vec3<double>& origin = Vec3<double>::Zero()) {
  std::vector<Vec3<double>> points = detail::box_points(cells, lengths, origin);
  std::vector<Hexahedron> hexahedra;
  for (int k = 0; k < cells[2]; ++k)
    for (int j = 0; j < cells[1]; ++j)
      for (int i = 0; i < cells[0]; ++i) {
        const auto node = [&](int a, int b, int c) {
          return detail::grid_node(cells, {i + a, j + b, k + c});
        };
        hexahedra.push_back({node(0, 0, 0), node(1, 0, 0), node(1, 1, 0), node(0, 1, 0), node(0, 0, 1),
                             node(1, 0, 1), node(1, 1, 1), node(0, 1, 1)});
      }
  return {std::move(points), std::move(hexahedra)};
}

/// Cylinder around the z axis from z = 0 to z = length. A grid of 2 n x 2 n cells (n = radial_cells) over the
/// square is mapped to the disc so that its squares become n rings; the outermost holds 8 n equally spaced
/// nodes on the circle. Node (i, j, k) has the number (k (2 n + 1) + j) (2 n + 1) + i. The cells are Kuhn
/// cells whose diagonals point away from the axis, which keeps the tetrahedra at the four corners of the
/// square in shape.
/// @param radius, length in m
/// @param radial_cells cells between axis and surface
/// @param axial_cells cells along the axis
/// The section is a regular polygon of 8 n corners: the volume is 4 n radius^2 sin(pi / (4 n)) length, which
/// tends to pi radius^2 length with the square of n.
/// @throws std::invalid_argument for a count below 1, a length that is not positive and finite, or more nodes
///   than 32-bit numbers can count
[[nodiscard]] inline TetrahedralMesh cylinder_mesh(double radius, double length, int radial_cells,
                                                   int axial_cells) {
  detail::check_length("radius", radius);
  detail::check_length("length", length);
  detail::check_count("radial_cells", radial_cells);
  detail::check_count("axial_cells", axial_cells);
  const int n = radial_cells;
  const std::size_t node_count = detail::grid_node_count(2.0 * n, 2.0 * n, axial_cells);
  const std::array<int, 3> cells{2 * n, 2 * n, axial_cells};
  std::vector<Vec3<double>> points;
  points.reserve(node_count);
  for (int k = 0; k <= axial_cells; ++k)
    for (int j = -n; j <= n; ++j)
      for (int i = -n; i <= n; ++i) {
        const auto [x, y] = detail::square_to_disc(double(i) / n, double(j) / n);
        points.push_back({radius * x, radius * y, length * (double(k) / axial_cells)});
      }
  std::vector<Tetrahedron> tetrahedra;
  for (int k = 0; k < axial_cells; ++k)
    for (int j = 0; j < 2 * n; ++j)
      for (int i = 0; i < 2 * n; ++i) {
        const bool left = i < n, front = j < n;
        detail::append_kuhn_cell(cells, {left ? i + 1 : i, front ? j + 1 : j, k},
                                 {left ? -1 : 1, front ? -1 : 1, 1}, tetrahedra);
      }
  return TetrahedralMesh(std::move(points), std::move(tetrahedra));
}

}  // namespace softsim
