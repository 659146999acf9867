// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/solver/newton.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "potential/bodies.hpp"
#include "softsim/integrator/static_solver.hpp"
#include "softsim/material/neo_hookean.hpp"
#include "softsim/material/stable_neo_hookean.hpp"
#include "softsim/mesh/selection.hpp"
#include "softsim/potential/dead_load.hpp"
#include "softsim/potential/elastic.hpp"
#include "softsim/system/element_fields.hpp"
#include "softsim/system/system.hpp"

namespace newton_test {

using bodies::Vec, bodies::refusal;
using softsim::NeoHookean, softsim::Side, softsim::State, softsim::StaticSolver, softsim::Status,
    softsim::StepReport, softsim::Vector;
using System = softsim::System<softsim::ElasticTetrahedra<NeoHookean>, softsim::DeadLoad<double>>;
using Solver = StaticSolver<System>;

const double nan = std::numeric_limits<double>::quiet_NaN();

// A beam of 3 x 1 x 1 held at x = 0 under its weight.
struct Beam {
  softsim::TetrahedralMesh mesh = softsim::box_mesh({6, 2, 2}, {3, 1, 1});
  NeoHookean law = NeoHookean::from_young_poisson(1000, 0.3);
  System system;

  explicit Beam(double g) : system(mesh, softsim::elastic(mesh, law), softsim::gravity(mesh, 1, {0, 0, -g})) {
    system.prescribed.fix(softsim::nodes_near(mesh, Side::xmin, 0));
  }
  State<double> rest() const { return State<double>(mesh.points().size()); }
  double smallest_j(const State<double>& q) const {
    double j = std::numeric_limits<double>::infinity();
    for (const auto& field : softsim::element_fields(mesh, std::vector{law}, {}, q)) j = std::min(j, field.j);
    return j;
  }
  double residual(const State<double>& q) const {
    Vector<double> g = bodies::gradient(system, q), load = std::get<1>(system.terms).force();
    system.prescribed.mask(g);
    system.prescribed.mask(load);
    return g.norm() / load.norm();
  }
};

TEST(Newton, ReachesEquilibriumToTheToleranceItSays) {
  for (const double tolerance : {1e-3, 1e-6, 1e-10}) {
    const Beam beam(10);
    State<double> q = beam.rest();
    const StepReport report = Solver({.tolerance = tolerance}).solve(beam.system, q);
    EXPECT_EQ(report.status, Status::converged);
    EXPECT_EQ(report.reason, "");
    EXPECT_GT(report.linear_iterations, report.newton_iterations);
    EXPECT_LE(report.residual, tolerance);
    EXPECT_NEAR(report.residual, beam.residual(q), 1e-3 * report.residual + 1e-13);
    EXPECT_GT(q.displacement.cwiseAbs().maxCoeff(), 0.3) << "the load has to matter";
  }
}

TEST(Newton, ConvergesQuadratically) {
  const Beam beam(10);
  std::vector<double> residuals;
  for (int k = 1; k <= 12; ++k) {
    State<double> q = beam.rest();
    const StepReport report = Solver({.max_iterations = k, .tolerance = 1e-12}).solve(beam.system, q);
    residuals.push_back(report.residual);
    if (report.status == Status::converged) break;
    EXPECT_EQ(report.newton_iterations, k);
    EXPECT_EQ(report.status, Status::not_converged);
    EXPECT_EQ(report.reason, "Newton: too many iterations");
  }
  // From 1e-2 on the next residual is a constant times the square, down to rounding.
  int seen = 0;
  for (std::size_t k = 0; k + 1 < residuals.size(); ++k) {
    if (residuals[k] > 1e-2 || residuals[k] < 1e-6) continue;
    EXPECT_LT(residuals[k + 1], 30 * residuals[k] * residuals[k] + 1e-12) << k;
    ++seen;
  }
  EXPECT_GE(seen, 1);
  EXPECT_LE(residuals.back(), 1e-12);
  EXPECT_LE(residuals.size(), 9u);
}

TEST(Newton, BothOperatorsAndAllPreconditionersReachTheSameState) {
  const Beam beam(3);
  State<double> reference = beam.rest();
  ASSERT_EQ(Solver({.tolerance = 1e-10}).solve(beam.system, reference).status, Status::converged);
  const auto compare = [&](auto solver) {
    State<double> q = beam.rest();
    EXPECT_EQ(solver.solve(beam.system, q).status, Status::converged);
    EXPECT_LT(bodies::relative_error(q.displacement, reference.displacement), 1e-8);
  };
  compare(StaticSolver<System, softsim::MatrixFree>({.tolerance = 1e-10}));
  compare(StaticSolver<System, softsim::Assembled, softsim::Jacobi>({.tolerance = 1e-10}));
  compare(StaticSolver<System, softsim::MatrixFree, softsim::NoPreconditioner>({.tolerance = 1e-10}));
}

TEST(Newton, DoesNothingWhereNothingIsToDo) {
  const Beam beam(0);
  State<double> q = beam.rest();
  const StepReport report = Solver().solve(beam.system, q);
  EXPECT_EQ(report.status, Status::converged);
  EXPECT_EQ(report.newton_iterations, 0);
  EXPECT_EQ(q.displacement.norm(), 0);

  const Beam loaded(10);
  Solver solver({.tolerance = 1e-9});
  State<double> r = loaded.rest();
  ASSERT_EQ(solver.solve(loaded.system, r).status, Status::converged);
  const State<double> solved = r;
  EXPECT_EQ(solver.solve(loaded.system, r).newton_iterations, 0);
  EXPECT_EQ(r.displacement, solved.displacement);
}

// There is no load to measure the residual against, only the forces inside, which vanish with it.
TEST(Newton, FindsRestFromADeformedStateWithoutLoad) {
  const Beam beam(0);
  State<double> q = beam.rest();
  Vector<double> d = bodies::random_vector(beam.mesh.points().size(), 0.05, 1);
  beam.system.prescribed.mask(d);
  q.displacement = d;
  const StepReport report = Solver().solve(beam.system, q);
  EXPECT_EQ(report.status, Status::converged) << report.reason << ", residual " << report.residual;
  EXPECT_LT(q.displacement.norm(), 1e-4 * d.norm());
}

// The reference of the residual is rounding itself where a solve starts in equilibrium.
TEST(Newton, IsDoneWhereForcesAreRoundingFromTheStart) {
  const auto mesh = softsim::box_mesh({3, 3, 3}, {1, 1, 1});
  const auto law = softsim::StableNeoHookean::from_young_poisson(1, 0.3);
  softsim::System system(mesh, softsim::elastic(mesh, law));
  system.prescribed.fix({0});
  for (const auto& [node, axis] : {std::pair{3, 1}, std::pair{3, 2}, std::pair{12, 2}})
    system.prescribed.set(node, axis, 0);
  for (const bool collapsed : {true, false}) {
    // all points in one, a minimum of this energy, and the rest shape but for rounding
    State<double> q(mesh.points().size());
    const Vector<double> noise = bodies::random_vector(mesh.points().size(), 1e-16, 1);
    for (std::size_t i = 0; i < mesh.points().size(); ++i)
      if (collapsed) q.point(static_cast<std::ptrdiff_t>(i)) = -mesh.points()[i];
    q.displacement += noise;
    system.prescribed.mask(q.displacement);
    const StepReport report =
        StaticSolver<decltype(system)>({.tolerance = 1e-9, .verify_minimum = true}).solve(system, q);
    EXPECT_EQ(report.status, collapsed ? Status::inverted : Status::converged) << report.reason;
    EXPECT_LT(report.newton_iterations, 20);
  }
}

TEST(Newton, VerifiesAStartWithoutForces) {
  const Beam beam(0);
  State<double> q = beam.rest();
  EXPECT_EQ(Solver({.verify_minimum = true}).solve(beam.system, q).status, Status::converged);
}

// Full steps would turn tetrahedra inside out, where the law has no value; the line search steps back.
TEST(Newton, LineSearchKeepsTheLawDefined) {
  for (const double g : {30.0, 100.0, 300.0, 1000.0}) {
    const Beam beam(g);
    State<double> q = beam.rest();
    const StepReport report = Solver().solve(beam.system, q);
    EXPECT_NE(report.status, Status::not_finite);
    EXPECT_EQ(report.status == Status::converged, report.reason.empty());
    ASSERT_TRUE(q.displacement.allFinite()) << g;
    EXPECT_GT(beam.smallest_j(q), 0) << g;
    if (report.status == Status::converged) {
      EXPECT_LE(beam.residual(q), 1.001e-6) << g;
    }
    if (g <= 100) {
      EXPECT_EQ(report.status, Status::converged) << g << ": " << report.reason;
    }
  }
}

// Full steps would be finite with this law, and one of them would go uphill.
TEST(Newton, EnergyFallsWithEveryIteration) {
  const auto mesh = softsim::box_mesh({9, 3, 3}, {3, 1, 1});
  softsim::System system(mesh,
                         softsim::elastic(mesh, softsim::StableNeoHookean::from_young_poisson(1000, 0.3)),
                         softsim::gravity(mesh, 1, {0, 0, -300}));
  system.prescribed.fix(softsim::nodes_near(mesh, Side::xmin, 0));
  double before = 0;  // at rest
  Status status = Status::not_converged;
  for (int k = 1; k <= 30 && status != Status::converged; ++k) {
    State<double> q(mesh.points().size());
    status = StaticSolver<decltype(system)>({.max_iterations = k}).solve(system, q).status;
    const double energy = system.energy(q);
    EXPECT_LE(energy, before + 1e-12 * std::abs(before)) << k;
    before = energy;
  }
  EXPECT_EQ(status, Status::converged);
}

TEST(Newton, ReportsAStartThatHasNoForcesAndLeavesIt) {
  const Beam beam(10);
  State<double> q = beam.rest();
  q.point(20) = Vec(-5, 0, 0);  // inverts its tetrahedra
  const State<double> start = q;
  const StepReport report = Solver().solve(beam.system, q);
  EXPECT_EQ(report.status, Status::not_finite);
  EXPECT_EQ(report.reason, "the residual is not finite");
  EXPECT_EQ(q.displacement, start.displacement);
}

TEST(Newton, ReportsALoadThatIsNotFinite) {
  Beam beam(10);
  beam.system.damping = {};
  std::get<1>(beam.system.terms).add(20, Vec(1e308, 0, 0)).add(20, Vec(1e308, 0, 0));
  State<double> q = beam.rest();
  EXPECT_NE(Solver().solve(beam.system, q).status, Status::converged);
  EXPECT_TRUE(q.displacement.allFinite());
}

TEST(Newton, RefusesOptionsByValue) {
  EXPECT_EQ(refusal([] { return Solver({.tolerance = 0}); }), "tolerance 0: must be positive");
  EXPECT_EQ(refusal([] { return Solver({.tolerance = -1e-6}); }), "tolerance -1e-06: must be positive");
  EXPECT_EQ(refusal([] { return Solver({.tolerance = nan}); }), "tolerance nan: must be positive");
  EXPECT_EQ(refusal([] { return Solver({.max_iterations = 0}); }), "max_iterations 0: must be at least 1");
}

TEST(StaticSolve, RefusesABodyThatNothingHolds) {
  Beam beam(10);
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(beam.mesh.points().size()); ++i)
    beam.system.prescribed.release(i);
  beam.system.prescribed.fix({0, 7});
  State<double> q = beam.rest();
  EXPECT_NE(refusal([&] { return Solver().solve(beam.system, q); }).find("2 of its nodes are held"),
            std::string::npos);
  EXPECT_EQ(q.displacement.norm(), 0);
}

TEST(Newton, SolvesInSinglePrecision) {
  const Beam beam(10);
  State<double> q_double = beam.rest();
  ASSERT_EQ(Solver({.tolerance = 1e-10}).solve(beam.system, q_double).status, Status::converged);
  softsim::System single(beam.mesh, softsim::elastic<float>(beam.mesh, beam.law),
                         softsim::gravity<float>(beam.mesh, 1, {0, 0, -10}));
  single.prescribed.fix(softsim::nodes_near(beam.mesh, Side::xmin, 0));
  State<float> q(beam.mesh.points().size());
  const StepReport report = StaticSolver<decltype(single)>({.tolerance = 1e-4}).solve(single, q);
  EXPECT_EQ(report.status, Status::converged) << report.reason << " " << report.residual;
  EXPECT_LT(bodies::relative_error(q.displacement, q_double.displacement), 1e-3);
}

}  // namespace newton_test
