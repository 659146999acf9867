// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "potential/bodies.hpp"
#include "potential/truss.hpp"
#include "softsim/integrator/static_solver.hpp"
#include "softsim/material/neo_hookean.hpp"
#include "softsim/mesh/selection.hpp"
#include "softsim/potential/dead_load.hpp"
#include "softsim/potential/elastic.hpp"
#include "softsim/potential/pressure.hpp"
#include "softsim/system/system.hpp"

namespace newton_variants_test {

using bodies::Vec, bodies::refusal;
using softsim::Side, softsim::State, softsim::StaticSolver, softsim::Status, softsim::StepReport;
using System = softsim::System<softsim::ElasticTetrahedra<softsim::NeoHookean>, softsim::DeadLoad<double>>;
using Solver = StaticSolver<System>;

// A beam of 3 x 1 x 1 held at x = 0 under its weight.
System beam(double g) {
  const auto mesh = softsim::box_mesh({6, 2, 2}, {3, 1, 1});
  System system(mesh, softsim::elastic(mesh, softsim::NeoHookean::from_young_poisson(1000, 0.3)),
                softsim::gravity(mesh, 1, {0, 0, -g}));
  system.prescribed.fix(softsim::nodes_near(mesh, Side::xmin, 0));
  return system;
}

StepReport solve(const System& system, Solver& solver, State<double>& q) {
  q = State<double>(system.rest().size());
  return solver.solve(system, q);
}

TEST(NewtonVariants, ReachTheSameEquilibrium) {
  const System system = beam(6);
  State<double> reference, q;
  Solver full({.tolerance = 1e-8});
  const StepReport newton = solve(system, full, reference);
  ASSERT_EQ(newton.status, Status::converged);
  const auto check = [&](softsim::NewtonOptions options, int least_more) {
    options.tolerance = 1e-8;
    options.max_iterations = 500;
    Solver solver(options);
    const StepReport report = solve(system, solver, q);
    EXPECT_EQ(report.status, Status::converged) << report.reason;
    EXPECT_LT(bodies::relative_error(q.displacement, reference.displacement), 1e-6);
    EXPECT_GE(report.newton_iterations, newton.newton_iterations + least_more);
  };
  check({.update_every = 0}, 5);   // modified Newton
  check({.update_every = 3}, 1);   // every third
  check({.relaxation = 0.5}, 10);  // halves the error in each iteration
  check({.line_search = false}, 0);
  check({.line_search = false, .relaxation = 0.8}, 2);
  check({.frozen = true}, 0);
}

// Quasi-dynamic display: every iterate is shown, from the start to the solution, and the caller may end it.
TEST(NewtonVariants, ShowEveryIterateAndStopOnDemand) {
  const System system = beam(6);
  Solver solver({.tolerance = 1e-8});
  std::vector<double> residuals;
  std::vector<State<double>> states;
  solver.newton.on_iteration = [&](const State<double>& q, const StepReport& report) {
    residuals.push_back(report.residual);
    states.push_back(q);
    return true;
  };
  State<double> q;
  const StepReport report = solve(system, solver, q);
  ASSERT_EQ(report.status, Status::converged);
  ASSERT_EQ(residuals.size(), static_cast<std::size_t>(report.newton_iterations) + 1);
  EXPECT_EQ(states.front().displacement.norm(), 0);
  EXPECT_EQ(states.back().displacement, q.displacement);
  EXPECT_EQ(residuals.back(), report.residual);

  solver.newton.on_iteration = [](const State<double>&, const StepReport& at) {
    return at.newton_iterations < 2;
  };
  const StepReport stopped = solve(system, solver, q);
  EXPECT_EQ(stopped.status, Status::not_converged);
  EXPECT_EQ(stopped.reason, "stopped by the caller");
  EXPECT_EQ(q.displacement, states[2].displacement);
}

// ---------------------------------------------------------------- load steps

TEST(LoadSteps, EndAtTheSameStateAsTheWholeLoadAtOnce) {
  const System system = beam(6);
  State<double> at_once, q(system.rest().size());
  Solver once({.tolerance = 1e-10});
  ASSERT_EQ(solve(system, once, at_once).status, Status::converged);
  EXPECT_EQ(once.load_reached(), 1);
  Solver steps({.tolerance = 1e-10}, {.steps = 5});
  ASSERT_EQ(steps.solve(system, q).status, Status::converged);
  EXPECT_EQ(steps.load_reached(), 1);
  EXPECT_LT(bodies::relative_error(q.displacement, at_once.displacement), 1e-8);
}

// Full steps without a line search turn elements inside out under the whole load, and under a quarter of it;
// cut back they come through.
TEST(LoadSteps, AreCutBackWhereNewtonFails) {
  const System system = beam(40);
  State<double> q;
  const softsim::NewtonOptions bare{.max_iterations = 8, .tolerance = 1e-8, .line_search = false};
  Solver once(bare), steps(bare, {.steps = 2});
  EXPECT_NE(solve(system, once, q).status, Status::converged);
  EXPECT_EQ(once.load_reached(), 0);
  const StepReport report = solve(system, steps, q);
  EXPECT_EQ(report.status, Status::converged) << report.reason << " " << steps.load_reached();
  State<double> reference;
  Solver searching({.tolerance = 1e-10});
  ASSERT_EQ(solve(system, searching, reference).status, Status::converged);
  EXPECT_LT(bodies::relative_error(q.displacement, reference.displacement), 1e-6);
}

// Prescribed displacements grow with the load.
TEST(LoadSteps, MovePrescribedComponentsInParts) {
  System system = beam(0);
  const auto mesh = softsim::box_mesh({6, 2, 2}, {3, 1, 1});
  const auto face = softsim::nodes_near(mesh, Side::xmax, 0);
  for (const auto i : face) system.prescribed.set(i, Vec(1, 0, 0.5));
  std::vector<double> seen;
  Solver solver({.tolerance = 1e-8}, {.steps = 4});
  solver.newton.on_iteration = [&](const State<double>& q, const StepReport&) {
    const double x = q.point(face[0])[0];
    if (seen.empty() || seen.back() != x) seen.push_back(x);
    return true;
  };
  State<double> q(system.rest().size());
  const StepReport report = solver.solve(system, q);
  ASSERT_EQ(report.status, Status::converged) << report.reason;
  ASSERT_EQ(seen.size(), 5u);
  for (std::size_t k = 0; k < 5; ++k) EXPECT_NEAR(seen[k], 0.25 * static_cast<double>(k), 1e-15);
  for (const auto i : face) EXPECT_EQ(Vec(q.point(i)), Vec(1, 0, 0.5));
}

// Pressure that follows the surface counts in part in the tangent too: Newton stays quadratic.
TEST(LoadSteps, CountFollowerPressureInPart) {
  const auto mesh = softsim::box_mesh({3, 3, 3}, {1, 1, 1});
  softsim::System system(mesh, softsim::elastic(mesh, softsim::NeoHookean::from_young_poisson(1000, 0.3)),
                         softsim::pressure(mesh, softsim::boundary_triangles(mesh), 200.0));
  system.prescribed.fix(softsim::nodes_near(mesh, Side::xmin, 0));
  using S = decltype(system);
  State<double> at_once(mesh.points().size()), q(mesh.points().size());
  StaticSolver<S> once({.tolerance = 1e-10});
  ASSERT_EQ(once.solve(system, at_once).status, Status::converged);
  for (const bool matrix_free : {false, true}) {
    q = State<double>(mesh.points().size());
    StepReport report;
    if (matrix_free)
      report = StaticSolver<S, softsim::MatrixFree>({.tolerance = 1e-10}, {.steps = 3}).solve(system, q);
    else
      report = StaticSolver<S>({.tolerance = 1e-10}, {.steps = 3}).solve(system, q);
    EXPECT_EQ(report.status, Status::converged) << report.reason;
    EXPECT_LT(bodies::relative_error(q.displacement, at_once.displacement), 1e-7);
    EXPECT_LE(report.newton_iterations, 18);
  }
}

// A shallow truss snaps through at a known load: what lies beyond has no equilibrium next to it, and the
// solve says how far it came.
TEST(LoadSteps, SayHowMuchOfTheLoadCouldBeCarried) {
  truss::Truss t(0.3, 1.5);  // one and a half times the limit load
  const double limit = 1 / 1.5;
  StaticSolver<truss::System> solver({.max_iterations = 30, .tolerance = 1e-9},
                                     {.steps = 10, .smallest = 1e-4});
  // stop where the apex falls through: Newton's method else finds the far side
  solver.newton.on_iteration = [](const State<double>& q, const StepReport&) { return q.point(2)[2] > -0.3; };
  State<double> q(4);
  const StepReport report = solver.solve(t.system, q);
  EXPECT_EQ(report.status, Status::not_converged);
  EXPECT_FALSE(report.reason.empty());
  EXPECT_GT(solver.load_reached(), 0.99 * limit);
  EXPECT_LE(solver.load_reached(), limit + 1e-9);
  EXPECT_NEAR(t.force(0.3 + q.point(2)[2]), solver.load_reached() * t.load, 1e-8 * t.load);
}

// ---------------------------------------------------------------- minimum or not

// The apex of an unloaded truss exactly between its supports is in equilibrium, at the top of a hill.
TEST(VerifyMinimum, TellsAMaximumFromAMinimum) {
  truss::Truss t(0.3, 0);
  State<double> q(4);
  q.point(2)[2] = -0.3;
  const State<double> flat = q;
  EXPECT_EQ(StaticSolver<truss::System>().solve(t.system, q).status, Status::converged);
  const StepReport report = StaticSolver<truss::System>({.verify_minimum = true}).solve(t.system, q);
  EXPECT_EQ(report.status, Status::stationary_not_minimum);
  EXPECT_EQ(to_string(report.status), "stationary_not_minimum");
  EXPECT_FALSE(report.reason.empty());
  EXPECT_EQ(q.displacement, flat.displacement);

  State<double> rest(4);
  EXPECT_EQ(StaticSolver<truss::System>({.verify_minimum = true}).solve(t.system, rest).status,
            Status::converged);
  const System system = beam(6);
  State<double> bent;
  Solver solver({.tolerance = 1e-8, .verify_minimum = true});
  EXPECT_EQ(solve(system, solver, bent).status, Status::converged);
}

TEST(NewtonVariants, RefuseOptionsByValue) {
  EXPECT_NE(refusal([] { Solver({.relaxation = 0}); }).find("relaxation 0: must be in (0, 1]"),
            std::string::npos);
  EXPECT_NE(refusal([] { Solver({.relaxation = 1.5}); }).find("relaxation 1.5"), std::string::npos);
  EXPECT_NE(refusal([] { Solver({.update_every = -1}); }).find("update_every -1"), std::string::npos);
  EXPECT_NE(refusal([] { Solver({}, {.steps = 0}); }).find("load steps 0"), std::string::npos);
  EXPECT_NE(refusal([] { Solver({}, {.smallest = 0}); }).find("smallest load step 0"), std::string::npos);
}

}  // namespace newton_variants_test
