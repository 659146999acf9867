// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include "softsim/kinematics/isoparametric.hpp"
#include "softsim/mesh/shape_functions.hpp"

namespace softsim {

/// One of the 2x2x2 Gauss points of a trilinear hexahedron; see `TrilinearHexahedronShape` for the order of
/// the nodes (VTK's) and what the rule integrates exactly. Locks in bending when the element is long and thin
/// and near incompressibility, as every trilinear element without enhancement does.
///
/// Forces from squared distances (HEML) carry over: since the gradients g_i sum to zero, F = sum x_i g_i^T
/// gives C = F^T F = -1/2 sum_ij |x_i - x_j|^2 g_i g_j^T, exactly, for any element. A hexahedron needs all 28
/// distances of its 8 nodes, its 12 edges do not fix its shape: a cube of rods folds. And it does not pay:
/// the route costs 28 x 6 products per point each way where F costs 7 x 9 and C from it 18 (a tetrahedron has
/// one point and 6 distances), and det C = J^2 does not see inversion. So it is not offered.
using TrilinearHexahedron = Isoparametric<TrilinearHexahedronShape>;

}  // namespace softsim
