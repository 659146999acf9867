// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "softsim/mesh/isoparametric_mesh.hpp"
#include "softsim/mesh/tetrahedral_mesh.hpp"

namespace softsim {

/// Nodes of these faces, ascending, each once.
template <std::size_t n>
[[nodiscard]] std::vector<std::int32_t> nodes_of(const std::vector<std::array<std::int32_t, n>>& faces) {
  std::vector<std::int32_t> nodes;
  for (const auto& face : faces) nodes.insert(nodes.end(), face.begin(), face.end());
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

/// Nodes on the surface of the body, ascending.
[[nodiscard]] inline std::vector<std::int32_t> surface_nodes(const TetrahedralMesh& mesh) {
  return nodes_of(boundary_triangles(mesh));
}
/// Nodes on the surface of the body, ascending; of ten-node tetrahedra those on its edges too.
template <ShapeFunctions S>
[[nodiscard]] std::vector<std::int32_t> surface_nodes(const IsoparametricMesh<S>& mesh) {
  return nodes_of(boundary_faces(mesh));
}

}  // namespace softsim
