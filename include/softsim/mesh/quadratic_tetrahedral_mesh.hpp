// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "softsim/mesh/isoparametric_mesh.hpp"
#include "softsim/mesh/shape_functions.hpp"
#include "softsim/mesh/tetrahedral_mesh.hpp"

namespace softsim {

/// Ten node numbers in VTK's order: four corners as in `Tetrahedron`, then the nodes on the edges 01, 12, 20,
/// 03, 13, 23.
using TenNodeTetrahedron = std::array<std::int32_t, 10>;
/// Six node numbers: corners counter-clockwise seen from outside the body, then the nodes on the edges 01,
/// 12, 20.
using Triangle6 = std::array<std::int32_t, 6>;

/// A checked mesh of ten-node tetrahedra; see `QuadraticTetrahedronShape` for the order of the nodes and the
/// integration rules, `boundary_faces` for its six-node triangles.
class QuadraticTetrahedralMesh : public IsoparametricMesh<QuadraticTetrahedronShape> {
 public:
  /// With edge nodes where the caller wants them: sides may be curved. Arguments as for `IsoparametricMesh`.
  using IsoparametricMesh::IsoparametricMesh;

  /// The tetrahedra of `mesh` with a new node in the middle of each edge. Corners keep their numbers, the
  /// edge nodes follow; elements and regions keep their order.
  explicit QuadraticTetrahedralMesh(const TetrahedralMesh& mesh)
      : QuadraticTetrahedralMesh(with_edge_nodes(mesh)) {}

 private:
  struct Parts {
    std::vector<Vec3<double>> points;
    std::vector<TenNodeTetrahedron> elements;
    std::vector<int> region;
  };
  explicit QuadraticTetrahedralMesh(Parts parts)
      : IsoparametricMesh(std::move(parts.points), std::move(parts.elements), std::move(parts.region)) {}

  static Parts with_edge_nodes(const TetrahedralMesh& mesh) {
    Parts parts{mesh.points(), {}, mesh.region()};
    std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> middle;
    for (const Tetrahedron& v : mesh.tetrahedra()) {
      TenNodeTetrahedron element;
      for (std::size_t i = 0; i < 4; ++i) element[i] = v[i];
      for (std::size_t k = 0; k < 6; ++k) {
        const std::int32_t a = v[Shape::edges[k][0]], b = v[Shape::edges[k][1]];
        const auto [entry, is_new] =
            middle.try_emplace(std::minmax(a, b), static_cast<std::int32_t>(parts.points.size()));
        if (is_new) {
          const Vec3<double>&X = mesh.points()[static_cast<std::size_t>(a)],
                &Y = mesh.points()[static_cast<std::size_t>(b)];
          parts.points.push_back(0.5 * (X + Y));
        }
        element[4 + k] = entry->second;
      }
      parts.elements.push_back(element);
    }
    return parts;
  }
};

}  // namespace softsim
