// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "potential/bodies.hpp"
#include "softsim/mesh/generators.hpp"
#include "softsim/mesh/hexahedral_mesh.hpp"
#include "softsim/mesh/quadratic_tetrahedral_mesh.hpp"

/// Bodies of hexahedra and ten-node tetrahedra that several tests share.
namespace solid_bodies {

using bodies::Matrix, bodies::Vec;

/// True for nodes on the surface of the unit cube.
inline bool on_unit_cube(const Vec& x) { return (x - Vec::Constant(0.5)).cwiseAbs().maxCoeff() > 0.5 - 1e-9; }

/// A unit cube of n^3 cells with distorted elements. Hexahedra: inner nodes moved by up to 0.2 of a cell.
/// Ten-node tetrahedra: corners moved as far, sides straight; then inner nodes by up to `curved` of a quarter
/// of a cell more.
template <class Mesh>
Mesh distorted(int n, std::uint64_t seed, double curved) {
  bodies::Random random(seed + 100);
  const auto moved = [&](const auto& mesh, double by) {
    std::vector<Vec> points = mesh.points();
    for (Vec& x : points)
      if (!on_unit_cube(x)) x += by / n * random.vec();
    return points;
  };
  if constexpr (std::is_same_v<Mesh, softsim::HexahedralMesh>) {
    const Mesh regular = softsim::box_hexahedra({n, n, n}, {1, 1, 1});
    return Mesh(moved(regular, 0.2), regular.elements());
  } else {
    const Mesh straight(bodies::distorted_cube(n, seed));
    return curved == 0 ? straight : Mesh(moved(straight, curved / 4), straight.elements());
  }
}

/// The state x = A X + b.
template <class Mesh>
softsim::State<double> affine_state(const Mesh& mesh, const Matrix& A, const Vec& b) {
  softsim::State<double> q(mesh.points().size());
  for (std::size_t i = 0; i < mesh.points().size(); ++i)
    q.point(static_cast<std::ptrdiff_t>(i)) = A * mesh.points()[i] + b - mesh.points()[i];
  return q;
}

}  // namespace solid_bodies
