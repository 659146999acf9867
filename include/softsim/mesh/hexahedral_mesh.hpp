// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>

#include "softsim/mesh/isoparametric_mesh.hpp"
#include "softsim/mesh/shape_functions.hpp"

namespace softsim {

/// Eight node numbers in VTK's order: four around the bottom, counter-clockwise seen from above, and the four
/// above them.
using Hexahedron = std::array<std::int32_t, 8>;
/// Four node numbers, counter-clockwise seen from outside the body.
using Quadrilateral = std::array<std::int32_t, 4>;

/// A checked mesh of trilinear hexahedra; see `TrilinearHexahedronShape` for the order of the nodes and the
/// integration rules, `boundary_faces` for its quadrilaterals.
using HexahedralMesh = IsoparametricMesh<TrilinearHexahedronShape>;

}  // namespace softsim
