// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "softsim/mesh/tetrahedral_mesh.hpp"

namespace softsim::detail {

/// What a reader takes from a file before the mesh checks it.
struct ElementList {
  std::vector<Vec3<double>> points;     ///< node positions in m, in the order of the file
  std::vector<Tetrahedron> tetrahedra;  ///< indices into points
  std::vector<int> region;              ///< one number per tetrahedron
  std::vector<std::size_t> line;        ///< line of the file per tetrahedron
  std::size_t skipped = 0;              ///< points, lines and surface elements that were passed over

  void add(const Tetrahedron& nodes, int region_number, std::size_t line_number) {
    tetrahedra.push_back(nodes);
    region.push_back(region_number);
    line.push_back(line_number);
  }

  /// The checked mesh. The mesh's refusals get the path and the line in front of them.
  /// @throws std::invalid_argument also if there is no tetrahedron, or one is given twice (its mass would
  ///   count twice)
  [[nodiscard]] TetrahedralMesh mesh(const std::string& path) && {
    if (tetrahedra.empty())
      invalid(path + ": no tetrahedra, only " + std::to_string(skipped) +
              " points, lines and surface elements");
    refuse_repeated(path);
    try {
      return TetrahedralMesh(std::move(points), std::move(tetrahedra), std::move(region));
    } catch (const std::invalid_argument& error) {
      std::size_t t = 0;
      const bool known = std::sscanf(error.what(), "tetrahedron %zu:", &t) == 1 && t < line.size();
      invalid(path + (known ? std::string(", line ") + std::to_string(line[t]) : "") + ": " + error.what());
    }
  }

 private:
  void refuse_repeated(const std::string& path) const {
    std::vector<std::pair<Tetrahedron, std::size_t>> sorted(tetrahedra.size());
    for (std::size_t t = 0; t < tetrahedra.size(); ++t) {
      sorted[t] = {tetrahedra[t], t};
      std::sort(sorted[t].first.begin(), sorted[t].first.end());
    }
    std::sort(sorted.begin(), sorted.end());
    const auto twin = std::adjacent_find(sorted.begin(), sorted.end(),
                                         [](const auto& a, const auto& b) { return a.first == b.first; });
    if (twin == sorted.end()) return;
    const std::size_t first = twin->second, second = (twin + 1)->second;
    invalid(path + ", line " + std::to_string(line[second]) + ": tetrahedron " + std::to_string(second) +
            " has the same nodes as tetrahedron " + std::to_string(first) + " in line " +
            std::to_string(line[first]));
  }
};

}  // namespace softsim::detail
