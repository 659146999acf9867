// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "softsim/mesh/tetrahedral_mesh.hpp"

namespace softsim {

/// Two node numbers, the lower one first.
using Edge = std::array<std::int32_t, 2>;

/// The six edges of a tetrahedron as pairs of its corners.
inline constexpr std::array<std::array<std::size_t, 2>, 6> tetrahedron_edges{
    {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};

/// Edges of a mesh, each once and in ascending order: neighbours in the list are neighbours in memory.
struct MeshEdges {
  std::vector<Edge> edges;
  /// Sum of the rest volumes of the tetrahedra around each edge, m^3.
  std::vector<double> volume;
};

/// All edges of `mesh`; between 1.2 and 1.3 for each tetrahedron of a large body.
[[nodiscard]] inline MeshEdges mesh_edges(const TetrahedralMesh& mesh) {
  struct Part {
    Edge edge;
    double volume;
  };
  std::vector<Part> parts;
  parts.reserve(6 * mesh.tetrahedra().size());
  for (std::size_t t = 0; t < mesh.tetrahedra().size(); ++t) {
    const Tetrahedron& v = mesh.tetrahedra()[t];
    const double volume = mesh.volume(t);
    for (const auto& [a, b] : tetrahedron_edges)
      parts.push_back({{std::min(v[a], v[b]), std::max(v[a], v[b])}, volume});
  }
  // stable: the volumes are added in the order of the tetrahedra, whatever the library's sort
  std::stable_sort(parts.begin(), parts.end(), [](const Part& a, const Part& b) { return a.edge < b.edge; });
  MeshEdges result;
  for (const Part& part : parts) {
    if (result.edges.empty() || result.edges.back() != part.edge) {
      result.edges.push_back(part.edge);
      result.volume.push_back(0);
    }
    result.volume.back() += part.volume;
  }
  return result;
}

}  // namespace softsim
