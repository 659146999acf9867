// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>

#include "softsim/core/error.hpp"
#include "softsim/io/gmsh.hpp"
#include "softsim/io/vtk_legacy.hpp"
#include "softsim/io/vtu.hpp"
#include "softsim/mesh/tetrahedral_mesh.hpp"

namespace softsim {

/// What a mesh reader cannot know from the file.
struct ReadOptions {
  /// Integer-valued cell array of a .vtk or .vtu file that holds the regions; empty means region 0
  /// everywhere. Must be empty for .msh files, whose regions are their physical groups.
  std::string cell_array;
};

/// Reads the tetrahedra of a mesh file, which its extension tells: .msh (`read_gmsh`), .vtk
/// (`read_vtk_legacy`) or .vtu (`read_vtu`), all ASCII. Lengths are taken as m.
/// @throws std::invalid_argument one sentence with the path, the line and the offending value: files that
///   cannot be read, are binary, truncated, contradict themselves or hold volume elements other than
///   four-node tetrahedra
[[nodiscard]] inline TetrahedralMesh read_mesh(const std::string& path, const ReadOptions& options = {}) {
  const std::size_t dot = path.find_last_of("./\\");
  std::string extension = dot == std::string::npos || path[dot] != '.' ? "" : path.substr(dot);
  for (char& c : extension)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  if (extension == ".vtk") return read_vtk_legacy(path, options.cell_array);
  if (extension == ".vtu") return read_vtu(path, options.cell_array);
  if (extension != ".msh") invalid(path + ": extension '" + extension + "' is not .msh, .vtk or .vtu");
  if (!options.cell_array.empty())
    invalid(path + ": cell_array '" + options.cell_array +
            "' does not apply to a .msh file, whose regions are its physical groups");
  return read_gmsh(path);
}

}  // namespace softsim
