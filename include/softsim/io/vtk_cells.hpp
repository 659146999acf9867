// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "softsim/io/element_list.hpp"
#include "softsim/io/text.hpp"

namespace softsim::detail {

inline constexpr int vtk_tetrahedron = 10;

/// Number of nodes of a VTK cell type where it is fixed and small, else 0.
[[nodiscard]] constexpr std::size_t vtk_node_count(int type) {
  switch (type) {
    case 1:
      return 1;
    case 3:
      return 2;
    case 5:
      return 3;
    case 8:
    case 9:
    case vtk_tetrahedron:
      return 4;
    default:
      return 0;
  }
}

/// Whether a VTK cell type is a point, a line or a surface, which carry no volume.
[[nodiscard]] constexpr bool vtk_is_lower_dimensional(int type) {
  return (type >= 0 && type <= 9) || (type >= 21 && type <= 23) || type == 28 || type == 30 ||
         (type >= 34 && type <= 36) || (type >= 51 && type <= 54) || (type >= 60 && type <= 63) ||
         (type >= 68 && type <= 70) || (type >= 75 && type <= 77);
}

/// What a message calls a VTK cell type that is refused.
[[nodiscard]] constexpr std::string_view vtk_volume_name(int type) {
  switch (type) {
    case 11:
      return "voxel";
    case 12:
      return "hexahedron";
    case 13:
      return "wedge";
    case 14:
      return "pyramid";
    case 24:
      return "ten-node tetrahedron";
    case 25:
      return "20-node hexahedron";
    case 26:
      return "15-node wedge";
    case 27:
      return "13-node pyramid";
    case 29:
      return "27-node hexahedron";
    case 42:
      return "polyhedron";
    case 71:
      return "Lagrange tetrahedron";
    case 72:
      return "Lagrange hexahedron";
    default:
      return "cell";
  }
}

/// The cells of one VTK piece as the file gives them.
struct VtkCells {
  std::vector<std::int32_t> connectivity;  ///< point numbers, one cell after the other
  std::vector<std::size_t> end;            ///< where each cell ends in connectivity
  std::vector<std::size_t> line;           ///< line of the file on which each cell's list stands
  std::vector<int> region;                 ///< one number per cell, or none

  /// Appends cell c of the given type to the list, or counts it as skipped. `type_at` stands on the type.
  /// @param first_point what the piece's point number 0 is called in the list
  void take(std::size_t c, int type, std::int32_t first_point, const Scanner& type_at,
            ElementList& list) const {
    const std::size_t begin = c == 0 ? 0 : end[c - 1];
    if (type != vtk_tetrahedron && !vtk_is_lower_dimensional(type))
      type_at.fail(std::string("cell ") + std::to_string(c) + " is a " + std::string(vtk_volume_name(type)) +
                   " (VTK type " + std::to_string(type) +
                   "), but only four-node tetrahedra are read; mesh the volume with those");
    const std::size_t nodes = vtk_node_count(type);
    if (nodes != 0 && end[c] - begin != nodes)
      type_at.fail(std::string("cell ") + std::to_string(c) + " of VTK type " + std::to_string(type) +
                   " has " + std::to_string(end[c] - begin) + " points, not " + std::to_string(nodes));
    if (type != vtk_tetrahedron) {
      ++list.skipped;
      return;
    }
    Tetrahedron tetrahedron;
    for (std::size_t a = 0; a < 4; ++a) tetrahedron[a] = first_point + connectivity[begin + a];
    list.add(tetrahedron, region.empty() ? 0 : region[c], line[c]);
  }
};

/// Throws because the file has no cell array of the wanted name, and says which it has.
[[noreturn]] inline void refuse_cell_array(const std::string& path, const std::string& wanted,
                                           const std::vector<std::string>& present) {
  std::string names;
  for (const std::string& name : present) names += (names.empty() ? "" : ", ") + in_quotes(name);
  invalid(path + ": cell array " + in_quotes(wanted) + " is not in the file, which has " +
          (names.empty() ? "no cell arrays" : names));
}

}  // namespace softsim::detail
