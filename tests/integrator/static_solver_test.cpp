// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/integrator/static_solver.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "potential/bodies.hpp"
#include "potential/solid_bodies.hpp"
#include "softsim/material/st_venant_kirchhoff.hpp"
#include "softsim/material/stable_neo_hookean.hpp"
#include "softsim/mesh/selection.hpp"
#include "softsim/potential/face_loads.hpp"
#include "softsim/potential/heml.hpp"
#include "softsim/potential/quadrature.hpp"

namespace static_solver_test {

using bodies::Vec;
using softsim::State, softsim::StaticSolver, softsim::Status, softsim::StepReport, softsim::StVenantKirchhoff;

// ---------------------------------------------------------------- inverted elements are counted

// One corner pushed through the opposite side of its tetrahedra: as many are inverted as have det F <= 0.
TEST(InvertedElements, AreThoseOfNoPositiveVolume) {
  const softsim::TetrahedralMesh mesh = bodies::distorted_cube(3, 1);
  const auto law = softsim::StableNeoHookean::from_young_poisson(1, 0.3);
  const softsim::System by_gradient(mesh, softsim::elastic(mesh, law));
  const softsim::System by_edges(mesh, softsim::heml(mesh, law));
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const State<double> q = bodies::random_state(mesh.points().size(), 0.1 * static_cast<double>(seed), seed);
    std::size_t expected = 0;
    for (const softsim::Tetrahedron& v : mesh.tetrahedra()) {
      std::array<Vec, 4> x;
      for (std::size_t i = 0; i < 4; ++i)
        x[i] = mesh.points()[static_cast<std::size_t>(v[i])] + q.point(v[i]);
      expected += (x[1] - x[0]).cross(x[2] - x[0]).dot(x[3] - x[0]) <= 0;
    }
    EXPECT_TRUE(seed == 1 || expected > 0);
    EXPECT_EQ(by_gradient.inverted(q), expected);
    EXPECT_EQ(by_edges.inverted(q), expected);
  }
}

// A hexahedron counts once, whatever number of its integration points is inverted; a flat one counts.
TEST(InvertedElements, AreElementsNotPoints) {
  const softsim::HexahedralMesh mesh = softsim::box_hexahedra({2, 2, 2}, {1, 1, 1});
  const softsim::System system(mesh, softsim::elastic(mesh, StVenantKirchhoff::from_young_poisson(1, 0)));
  State<double> q(mesh.points().size());
  EXPECT_EQ(system.inverted(q), 0U);
  for (const std::int32_t i : softsim::nodes_near(mesh, softsim::Side::zmax, 0)) q.point(i)[2] = -0.75;
  EXPECT_EQ(system.inverted(q), 4U);
  for (const std::int32_t i : softsim::nodes_near(mesh, softsim::Side::zmax, 0)) q.point(i)[2] = -0.5;
  EXPECT_EQ(system.inverted(q), 4U);
  for (const std::int32_t i : softsim::nodes_near(mesh, softsim::Side::zmax, 0)) q.point(i)[2] = -0.49;
  EXPECT_EQ(system.inverted(q), 0U);
}

// ---------------------------------------------------------------- St. Venant-Kirchhoff under pressure

// A bar of length 4 and nu = 0 that may shorten along its axis only, pressed by p times Young's modulus. Its
// stretch s obeys (s^3 - s)/2 = -p, which for p > 1/sqrt(27) = 0.19245 has one solution, and that below -1.
struct PressedBar {
  softsim::HexahedralMesh mesh = softsim::box_hexahedra({1, 1, 4}, {1, 1, 4});
  softsim::System<softsim::ElasticBody<softsim::HexahedralMesh, StVenantKirchhoff>, softsim::DeadLoad<double>>
      system;

  explicit PressedBar(double p)
      : system(mesh, softsim::elastic(mesh, StVenantKirchhoff::from_young_poisson(1000, 0)),
               softsim::traction(mesh,
                                 softsim::faces_on(softsim::boundary_faces(mesh),
                                                   softsim::nodes_near(mesh, softsim::Side::zmax, 0)),
                                 Vec(0, 0, -1000 * p))) {
    for (std::int32_t i = 0; i < static_cast<std::int32_t>(mesh.points().size()); ++i)
      for (const int axis : {0, 1}) system.prescribed.set(i, axis, 0);
    system.prescribed.fix(softsim::nodes_near(mesh, softsim::Side::zmin, 0));
  }
  [[nodiscard]] double stretch(const State<double>& q) const {
    return 1 + q.point(softsim::nodes_near(mesh, softsim::Side::zmax, 0).front())[2] / 4;
  }
};
using Solver = StaticSolver<decltype(PressedBar::system)>;

double pressure(double s) { return (s - s * s * s) / 2; }

TEST(StaticSolver, FindsTheShapeBelowTheLimit) {
  const PressedBar bar(0.19);
  State<double> q(bar.mesh.points().size());
  const StepReport report = Solver({.tolerance = 1e-10}).solve(bar.system, q);
  ASSERT_EQ(report.status, Status::converged) << report.reason;
  EXPECT_EQ(report.inverted, 0U);
  EXPECT_NEAR(pressure(bar.stretch(q)), 0.19, 1e-9);
  EXPECT_GT(bar.stretch(q), 1 / std::sqrt(3.0));
}

TEST(StaticSolver, SaysThatAnEquilibriumIsInsideOut) {
  const PressedBar bar(0.25);
  State<double> q(bar.mesh.points().size());
  const StepReport report = Solver({.tolerance = 1e-10}).solve(bar.system, q);
  EXPECT_EQ(report.status, Status::inverted);
  EXPECT_EQ(to_string(report.status), "inverted");
  EXPECT_EQ(report.reason, "elements are inverted in equilibrium");
  EXPECT_EQ(report.inverted, 4U);
  EXPECT_LT(bar.stretch(q), -1);
  EXPECT_NEAR(pressure(bar.stretch(q)), 0.25, 1e-9);  // an equilibrium it is
}

TEST(StaticSolver, LoadStepsStopWhereNoShapeIsLeft) {
  const double limit = 1 / std::sqrt(27.0);
  const PressedBar bar(0.25);
  for (const bool refuse : {false, true}) {
    State<double> q(bar.mesh.points().size());
    Solver solver({.tolerance = 1e-10, .refuse_inversion = refuse}, {.steps = 4, .smallest = 1e-4});
    const StepReport report = solver.solve(bar.system, q);
    EXPECT_EQ(report.status, Status::not_converged);
    EXPECT_EQ(report.reason,
              refuse ? "Newton: every step would invert elements" : "elements are inverted in equilibrium");
    EXPECT_EQ(report.inverted, 0U);
    EXPECT_NEAR(solver.load_reached(), limit / 0.25, 2e-4);
    EXPECT_LT(solver.load_reached(), limit / 0.25);
    EXPECT_EQ(bar.system.inverted(q), 0U);
    EXPECT_NEAR(pressure(bar.stretch(q)), 0.25 * solver.load_reached(), 1e-8);
  }
}

TEST(StaticSolver, CanRefuseInversion) {
  const PressedBar bar(0.25);
  State<double> q(bar.mesh.points().size());
  const StepReport report = Solver({.refuse_inversion = true}).solve(bar.system, q);
  EXPECT_EQ(report.status, Status::not_converged);
  EXPECT_EQ(report.reason, "Newton: every step would invert elements");
  EXPECT_EQ(bar.system.inverted(q), 0U);
  EXPECT_GT(bar.stretch(q), 0);
}

}  // namespace static_solver_test
