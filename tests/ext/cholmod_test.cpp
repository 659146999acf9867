// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/ext/cholmod.hpp"

#include <gtest/gtest.h>

#include "potential/bodies.hpp"
#include "softsim/integrator/static_solver.hpp"
#include "softsim/material/neo_hookean.hpp"
#include "softsim/mesh/selection.hpp"
#include "softsim/potential/dead_load.hpp"
#include "softsim/potential/elastic.hpp"
#include "softsim/solver/stationary.hpp"

namespace cholmod_test {

using softsim::State, softsim::Status;

TEST(Cholmod, SolvesWhatTheOthersSolve) {
  const auto mesh = softsim::box_mesh({6, 2, 2}, {3, 1, 1});
  softsim::System system(mesh, softsim::elastic(mesh, softsim::NeoHookean::from_young_poisson(1000, 0.3)),
                         softsim::gravity(mesh, 1, {0, 0, -10}));
  system.prescribed.fix(softsim::nodes_near(mesh, softsim::Side::xmin, 0));
  using System = decltype(system);
  State<double> q(mesh.points().size()), reference(mesh.points().size());
  ASSERT_EQ(softsim::StaticSolver<System>({.tolerance = 1e-10}).solve(system, reference).status,
            Status::converged);
  softsim::StaticSolver<System, softsim::Assembled, softsim::CholmodLlt, softsim::Stationary> solver(
      {.tolerance = 1e-10});
  const auto report = solver.solve(system, q);
  EXPECT_EQ(report.status, Status::converged) << report.reason;
  EXPECT_EQ(report.linear_iterations, report.newton_iterations) << "one iteration solves";
  EXPECT_LT(bodies::relative_error(q.displacement, reference.displacement), 1e-8);
}

TEST(Cholmod, SaysWhereAMatrixIsNotDefinite) {
  const auto mesh = softsim::box_mesh({2, 2, 2}, {1, 1, 1});
  softsim::System system(mesh, softsim::elastic(mesh, softsim::NeoHookean::from_young_poisson(1000, 0.3)));
  system.mass = softsim::Mass<double>::lumped(mesh, 1);
  softsim::AssembledTangent<decltype(system)> tangent;
  const State<double> q(mesh.points().size());
  tangent.set(system, q, {.mass = -1e6, .stiffness = 1});
  softsim::CholmodLlt<double> direct;
  direct.compute(tangent, system.prescribed.free());
  EXPECT_FALSE(direct.trouble().empty());
}

}  // namespace cholmod_test
