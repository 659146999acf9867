// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "softsim/integrator/static_solver.hpp"
#include "softsim/material/neo_hookean.hpp"
#include "softsim/mesh/generators.hpp"
#include "softsim/mesh/selection.hpp"
#include "softsim/potential/dead_load.hpp"
#include "softsim/potential/elastic.hpp"
#include "softsim/potential/nodal_volume.hpp"
#include "softsim/system/system.hpp"

/// Two problems in which linear tetrahedra lock as Poisson's ratio nears 1/2, and the answers that they
/// should give. Neo-Hookean with the logarithm; mu is kept and lambda = 2 mu nu / (1 - 2 nu).
namespace near_incompressible {

using Vec = softsim::Vec3<double>;

/// Answers at one Poisson's ratio: displacement in mm of Cook's membrane, force in N on the bonded block.
struct Answers {
  double nu, cook, block;
};
/// From near_incompressible_reference.py, mixed Q2/P1 elements on graded grids, error below 0.03 %. Cook: 32
/// x 32 elements, 0.01 to 0.03 % above 16 x 16 (an independent displacement method on Q2 elements
/// gives 14.5212 mm at nu = 0.3). Block: 3^3, 4^3 and 6^3 elements, extrapolated by 0.01 to 0.04 % with the
/// order that they show, 2.3 to 2.5; a steeper grading leads to the same within 0.01 %.
inline constexpr std::array<Answers, 6> references{{
    {0.3, 14.5218, 0.30007},
    {0.4, 13.3536, 0.34527},
    {0.45, 12.7047, 0.37414},
    {0.49, 12.1472, 0.40214},
    {0.499, 12.0162, 0.40927},
    {0.4999, 12.0030, 0.41000},
}};

/// A body, how it is held and loaded, and where its answer is read.
struct Problem {
  softsim::TetrahedralMesh mesh;
  softsim::DeadLoad<double> load;
  softsim::Prescribed<double> prescribed;
  std::vector<std::int32_t> measured;  ///< nodes
  double mu;                           ///< shear modulus, N/mm^2 or Pa

  /// First Lame parameter for Poisson's ratio nu.
  [[nodiscard]] double lambda(double nu) const { return 2 * mu * nu / (1 - 2 * nu); }
};

/// Cook's membrane in mm and N: 48 wide, 44 high at the held left side and 16 at the right, plane strain, one
/// layer of cells x cells Kuhn cells split along their short diagonals, dead shear of 1 N/mm on the right
/// side. The answer is the displacement u_y in the middle of that side; `cells` has to be even.
/// (Split along the long diagonals, averaged volumes are still 4 % short of a corner's displacement at 32 x
/// 32 cells and nu = 0.4999; split along the short ones 1 %.)
inline Problem cooks_membrane(int cells) {
  using namespace softsim;
  const double thickness = 44.0 / cells;
  // the box is mirrored along y, which turns its diagonals, and with it the order of two corners
  const TetrahedralMesh box = box_mesh({cells, cells, 1}, {1, 1, thickness});
  std::vector<Vec> points;
  for (const Vec& x : box.points())
    points.emplace_back(48 * x[0], 44 * x[0] + (44 - 28 * x[0]) * (1 - x[1]), x[2]);
  std::vector<Tetrahedron> tetrahedra = box.tetrahedra();
  for (Tetrahedron& v : tetrahedra) std::swap(v[0], v[1]);
  TetrahedralMesh mesh(std::move(points), std::move(tetrahedra));

  const std::vector<std::int32_t> right = nodes_near(mesh, Side::xmax, 0);
  DeadLoad<double> load(mesh.points().size());
  std::vector<std::int32_t> middle;
  for (const Triangle& f : boundary_triangles(mesh)) {
    const auto X = [&](std::size_t i) { return mesh.points()[static_cast<std::size_t>(f[i])]; };
    if (std::min({X(0)[0], X(1)[0], X(2)[0]}) < 48 * (1 - 1e-9)) continue;
    const double area = (X(1) - X(0)).cross(X(2) - X(0)).norm() / 2;
    for (const std::int32_t i : f) load.add(i, Vec(0, area / 16 / 3, 0));
  }
  for (const std::int32_t i : right)
    if (std::abs(mesh.points()[static_cast<std::size_t>(i)][1] - 52) < 1e-9) middle.push_back(i);
  Prescribed<double> prescribed(mesh.points().size());
  for (std::size_t i = 0; i < mesh.points().size(); ++i) prescribed.set(static_cast<std::int32_t>(i), 2, 0);
  prescribed.fix(nodes_near(mesh, Side::xmin, 0));
  return {std::move(mesh), std::move(load), std::move(prescribed), std::move(middle), 0.4225};
}

/// A cube of 1 m between two plates that it is bonded to, pressed together by 0.1 m; an eighth of it, cells^3
/// Kuhn cells that shrink towards the bonded edges. The answer is the force on a plate.
inline Problem bonded_block(int cells) {
  using namespace softsim;
  const TetrahedralMesh box = box_mesh({cells, cells, cells}, {1, 1, 1});
  std::vector<Vec> points;
  for (const Vec& x : box.points()) points.push_back(0.5 * (1 - (1 - x.array()).pow(1.25)));
  TetrahedralMesh mesh(std::move(points), box.tetrahedra());
  Prescribed<double> prescribed(mesh.points().size());
  for (int axis = 0; axis < 3; ++axis)
    for (const std::int32_t i : nodes_near(mesh, static_cast<Side>(2 * axis), 0)) prescribed.set(i, axis, 0);
  std::vector<std::int32_t> plate = nodes_near(mesh, Side::zmax, 0);
  for (const std::int32_t i : plate) prescribed.set(i, Vec(0, 0, -0.05));
  DeadLoad<double> none(mesh.points().size());
  return {std::move(mesh), std::move(none), std::move(prescribed), std::move(plate), 1};
}

/// Moves q to equilibrium with the given elastic terms and returns the answer, NaN if Newton's method does
/// not converge. Nearly incompressible, it takes many steps from rest and few from the equilibrium at a
/// smaller nu.
template <class... Terms>
double solve(const Problem& problem, softsim::State<double>& q, Terms... elastic) {
  using namespace softsim;
  System system(problem.mesh, problem.load, std::move(elastic)...);
  system.prescribed = problem.prescribed;
  if (StaticSolver<decltype(system)>({.tolerance = 1e-5}).solve(system, q).status != Status::converged)
    return std::nan("");
  double answer = 0;
  if (problem.load.force().isZero(0)) {
    Vector<double> g = Vector<double>::Zero(q.size());
    system.add_gradient(q, g);
    for (const std::int32_t i : problem.measured) answer -= 4 * block(g, i)[2];
  } else {
    for (const std::int32_t i : problem.measured)
      answer += q.point(i)[1] / static_cast<double>(problem.measured.size());
  }
  return answer;
}

/// As `solve`, with plain linear tetrahedra.
inline double solve_plain(const Problem& problem, softsim::State<double>& q, double nu) {
  return solve(
      problem, q,
      softsim::elastic(problem.mesh, softsim::NeoHookean::from_lame(problem.lambda(nu), problem.mu)));
}
/// As `solve`, with the volume averaged at the nodes.
inline double solve_nodal(const Problem& problem, softsim::State<double>& q, double nu) {
  return solve(problem, q, softsim::elastic(problem.mesh, softsim::NeoHookean::from_lame(0, problem.mu)),
               softsim::nodal_volume(problem.mesh, softsim::LogarithmicVolume(problem.lambda(nu))));
}

}  // namespace near_incompressible
