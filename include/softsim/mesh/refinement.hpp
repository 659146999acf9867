// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "softsim/mesh/quadratic_tetrahedral_mesh.hpp"
#include "softsim/mesh/tetrahedral_mesh.hpp"

namespace softsim {

/// The same body with each tetrahedron cut into eight of an eighth of its volume, at the middles of its
/// edges: four at the corners, and four around the shortest diagonal of what is left (Bey 1995). Nodes keep
/// their numbers, those in the middles of edges follow as in `QuadraticTetrahedralMesh`; the parts of one
/// tetrahedron follow each other and keep its region.
[[nodiscard]] inline TetrahedralMesh refined(const TetrahedralMesh& mesh) {
  const QuadraticTetrahedralMesh halved(mesh);
  // two opposite edges' middles, and the other four around that diagonal
  constexpr std::array<std::array<std::size_t, 6>, 3> diagonals{
      {{4, 9, 5, 6, 7, 8}, {5, 7, 4, 6, 9, 8}, {6, 8, 4, 5, 9, 7}}};
  std::vector<Tetrahedron> parts;
  std::vector<int> region;
  for (std::size_t e = 0; e < halved.elements().size(); ++e) {
    const TenNodeTetrahedron& v = halved.elements()[e];
    const auto X = [&](std::size_t i) -> const Vec3<double>& {
      return halved.points()[static_cast<std::size_t>(v[i])];
    };
    const auto add = [&](std::size_t a, std::size_t b, std::size_t c, std::size_t d) {
      if ((X(b) - X(a)).cross(X(c) - X(a)).dot(X(d) - X(a)) < 0) std::swap(c, d);
      parts.push_back({v[a], v[b], v[c], v[d]});
      region.push_back(mesh.region()[e]);
    };
    add(0, 4, 6, 7);
    add(4, 1, 5, 8);
    add(6, 5, 2, 9);
    add(7, 8, 9, 3);
    std::size_t shortest = 0;
    const auto length = [&](std::size_t k) { return (X(diagonals[k][0]) - X(diagonals[k][1])).norm(); };
    for (std::size_t k = 1; k < 3; ++k)
      if (length(k) < length(shortest)) shortest = k;
    const auto& [a, b, c, d, f, g] = diagonals[shortest];
    add(a, b, c, d);
    add(a, b, d, f);
    add(a, b, f, g);
    add(a, b, g, c);
  }
  return {halved.points(), std::move(parts), std::move(region)};
}

}  // namespace softsim
