// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/integrator/implicit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <string>

#include "potential/bodies.hpp"
#include "softsim/integrator/static_solver.hpp"
#include "softsim/material/neo_hookean.hpp"
#include "softsim/mesh/selection.hpp"
#include "softsim/potential/dead_load.hpp"
#include "softsim/potential/elastic.hpp"
#include "softsim/system/system.hpp"

namespace backward_euler_test {

using bodies::Vec, bodies::refusal, bodies::relative_error;
using softsim::BackwardEuler, softsim::Mass, softsim::Motion, softsim::State, softsim::Status,
    softsim::StepReport, softsim::Vector, softsim::block;
using System = softsim::System<softsim::ElasticTetrahedra<softsim::NeoHookean>, softsim::DeadLoad<double>>;
using Euler = BackwardEuler<System>;

static_assert(softsim::Integrator<Euler, System>);
static_assert(!softsim::Integrator<softsim::StaticSolver<System>, System>);

const double nan = std::numeric_limits<double>::quiet_NaN();

// A cube of 1 kg, E = 100 Pa, held at z = 0 or free.
System cube(const Vec& g, bool held = true) {
  const auto mesh = bodies::distorted_cube(2, 1);
  System system(mesh, softsim::elastic(mesh, softsim::NeoHookean::from_young_poisson(100, 0.3)),
                softsim::gravity(mesh, 1, g));
  system.mass = Mass<double>::lumped(mesh, 1);
  if (held) system.prescribed.fix(softsim::nodes_near(mesh, softsim::Side::zmin, 0));
  return system;
}

Motion<double> random_motion(const System& system, double scale = 1) {
  Motion<double> motion(system.rest().size());
  motion.q = bodies::random_state(system.rest().size(), 0.03 * scale, 2);
  motion.v = bodies::random_vector(system.rest().size(), scale, 3);
  system.prescribed.mask(motion.q.displacement);
  system.prescribed.mask(motion.v);
  return motion;
}

Vector<double> mass_times(const System& system, const Vector<double>& x) {
  Vector<double> y = Vector<double>::Zero(x.size());
  system.mass.add_product(x, 1, y);
  return y;
}

// ---------------------------------------------------------------- one step against its equation

TEST(BackwardEuler, ConvergedStepFulfilsTheEquationOfMotion) {
  constexpr double h = 0.02, alpha = 0.7, beta = 0.01;
  System system = cube({0, 0, -10});
  system.damping = {alpha, beta};
  const Motion<double> start = random_motion(system);
  // one node moves on its way, and its neighbours feel it within the step
  system.prescribed.set(25, Vec(start.q.point(25)) + Vec(0.1, -0.05, 0.2));
  Motion<double> motion = start;
  Euler euler({.dt = h, .newton = true, .tolerance = 1e-11});
  const StepReport report = euler.step(system, motion);
  ASSERT_EQ(report.status, Status::converged);
  EXPECT_GT(report.newton_iterations, 1);
  EXPECT_EQ(motion.time, h);
  EXPECT_LT(relative_error(motion.v, Vector<double>((motion.q.displacement - start.q.displacement) / h)),
            1e-14);
  Vector<double> residual = mass_times(system, Vector<double>((motion.v - start.v) / h + alpha * motion.v)) +
                            bodies::gradient(system, motion.q) +
                            beta * bodies::hessian_product(system, start.q, motion.v);
  system.prescribed.mask(residual);
  EXPECT_LT(residual.norm(), 1e-9);
}

// The same with the forces linearised at the start of the step (Baraff & Witkin).
TEST(BackwardEuler, LinearisedStepFulfilsTheLinearisedEquation) {
  constexpr double h = 0.02, alpha = 0.7, beta = 0.01;
  System system = cube({0, 0, -10});
  system.damping = {alpha, beta};
  const Motion<double> start = random_motion(system);
  // one node moves on its way, and its neighbours feel it within the step
  system.prescribed.set(25, Vec(start.q.point(25)) + Vec(0.1, -0.05, 0.2));
  Motion<double> motion = start;
  Euler euler({.dt = h, .tolerance = 1e-12});
  const StepReport report = euler.step(system, motion);
  ASSERT_EQ(report.status, Status::converged);
  EXPECT_EQ(report.newton_iterations, 1);
  Vector<double> residual = mass_times(system, Vector<double>((motion.v - start.v) / h + alpha * motion.v)) +
                            bodies::gradient(system, start.q) +
                            bodies::hessian_product(system, start.q, Vector<double>((h + beta) * motion.v));
  system.prescribed.mask(residual);
  EXPECT_LT(residual.norm(), 1e-9);
}

TEST(BackwardEuler, ReportsTheLinearIterationsAndResidual) {
  const System system = cube({0, 0, -10});
  Motion<double> motion = random_motion(system);
  const StepReport report = Euler({.dt = 0.02, .tolerance = 1e-5}).step(system, motion);
  EXPECT_EQ(report.status, Status::converged);
  EXPECT_EQ(report.reason, "");
  EXPECT_GT(report.linear_iterations, 1);
  EXPECT_LE(report.residual, 1e-5);
}

// ---------------------------------------------------------------- what it conserves and what it damps

TEST(BackwardEuler, ConservesTheLinearMomentumOfAFreeBody) {
  const System system = cube(Vec::Zero(), false);
  Motion<double> motion = random_motion(system);
  const auto momentum = [&] {
    Vec sum = Vec::Zero();
    const Vector<double> p = mass_times(system, motion.v);
    for (std::ptrdiff_t i = 0; i < 27; ++i) sum += block(p, i);
    return sum;
  };
  for (std::ptrdiff_t i = 0; i < 27; ++i) block(motion.v, i) += Vec(1, 2, 3);
  const Vec before = momentum();
  Euler euler({.dt = 0.02, .newton = true, .tolerance = 1e-10});
  for (int k = 0; k < 50; ++k) ASSERT_EQ(euler.step(system, motion).status, Status::converged);
  EXPECT_LT((momentum() - before).norm(), 1e-8 * before.norm());
}

TEST(BackwardEuler, NeverGainsEnergy) {
  const System system = cube(Vec::Zero());
  Motion<double> motion = random_motion(system);
  Euler euler({.dt = 0.02, .newton = true, .tolerance = 1e-9});
  double energy = system.energy(motion.q) + system.kinetic_energy(motion.v);
  const double start = energy;
  for (int k = 0; k < 100; ++k) {
    ASSERT_EQ(euler.step(system, motion).status, Status::converged) << k;
    const double next = system.energy(motion.q) + system.kinetic_energy(motion.v);
    EXPECT_LE(next, energy * (1 + 1e-8)) << k;
    energy = next;
  }
  EXPECT_LT(energy, 0.05 * start);
}

// Without a load outside there is nothing fixed to measure the residual against; a motion that dies out goes
// through all sizes, and the energies of the smallest are below their own rounding.
TEST(BackwardEuler, ConvergesForMotionsOfEverySize) {
  const System system = cube(Vec::Zero());
  for (const double scale : {1.0, 1e-2, 1e-4, 1e-6, 1e-8}) {
    Motion<double> motion = random_motion(system, scale);
    Euler euler({.dt = 0.02, .newton = true});
    for (int k = 0; k < 20; ++k) {
      const StepReport report = euler.step(system, motion);
      ASSERT_EQ(report.status, Status::converged)
          << scale << " " << k << " " << report.reason << " " << report.residual;
    }
  }
}

TEST(BackwardEuler, ComesToTheSameRestWithAnyStep) {
  System system = cube({0, 3, -10});
  system.damping.alpha = 4;
  State<double> rest(system.rest().size());
  ASSERT_EQ(softsim::StaticSolver<System>({.tolerance = 1e-9}).solve(system, rest).status, Status::converged);
  for (const bool newton : {false, true})
    for (const double dt : {0.02, 0.1}) {
      Motion<double> motion(system.rest().size());
      Euler euler({.dt = dt, .newton = newton, .tolerance = 1e-8});
      while (motion.time < 12) ASSERT_EQ(euler.step(system, motion).status, Status::converged);
      EXPECT_LT(relative_error(motion.q.displacement, rest.displacement), 1e-5) << newton << " " << dt;
    }
}

TEST(BackwardEuler, TakesLargeSteps) {
  System system = cube({0, 0, -10});
  Motion<double> motion(system.rest().size());
  Euler euler({.dt = 100, .newton = true, .tolerance = 1e-9});
  for (int k = 0; k < 3; ++k) ASSERT_EQ(euler.step(system, motion).status, Status::converged);
  State<double> rest(system.rest().size());
  ASSERT_EQ(softsim::StaticSolver<System>({.tolerance = 1e-9}).solve(system, rest).status, Status::converged);
  EXPECT_LT(relative_error(motion.q.displacement, rest.displacement), 1e-6);
}

// ---------------------------------------------------------------- moving nodes

TEST(BackwardEuler, MovingNodesReachTheirTargetsEveryStep) {
  constexpr double h = 0.02;
  for (const bool newton : {false, true}) {
    System system = cube({0, 0, -10});
    Motion<double> motion(system.rest().size());
    Euler euler({.dt = h, .newton = newton});
    for (int k = 1; k <= 30; ++k) {
      const Vec target(0.2 * std::sin(0.1 * k), 0.01 * k, 0);
      for (const std::int32_t i : {24, 25, 26}) system.prescribed.set(i, target);
      system.prescribed.set(18, 0, 0.005 * k);
      const Vec before = motion.q.point(25);
      ASSERT_EQ(euler.step(system, motion).status, Status::converged);
      for (std::ptrdiff_t i = 24; i < 27; ++i) EXPECT_LT((motion.q.point(i) - target).norm(), 1e-14);
      EXPECT_NEAR(motion.q.point(18)[0], 0.005 * k, 1e-14);
      EXPECT_LT((block(motion.v, 25) - (target - before) / h).norm(), 1e-12);
    }
    for (std::ptrdiff_t i = 0; i < 9; ++i) EXPECT_EQ(motion.q.point(i).norm(), 0) << "a fixed node moved";
  }
}

// ---------------------------------------------------------------- failures

TEST(BackwardEuler, LeavesTheMotionIfItIsNotFinite) {
  const System system = cube({0, 0, -10});
  for (const bool newton : {false, true}) {
    Motion<double> motion = random_motion(system);
    motion.v[4 * 20] = nan;
    const State<double> before = motion.q;
    const StepReport report = Euler({.dt = 0.02, .newton = newton}).step(system, motion);
    EXPECT_EQ(report.status, Status::not_finite);
    EXPECT_NE(report.reason, "");
    EXPECT_EQ(motion.q.displacement, before.displacement);
    EXPECT_EQ(motion.time, 0);
  }
}

TEST(BackwardEuler, LeavesAnInvertedStartAlone) {
  const System system = cube({0, 0, -10});
  for (const bool newton : {false, true}) {
    Motion<double> motion(system.rest().size());
    motion.q.point(22) = Vec(0, 0, -5);
    const State<double> before = motion.q;
    EXPECT_EQ(Euler({.dt = 0.02, .newton = newton}).step(system, motion).status, Status::not_finite);
    EXPECT_EQ(motion.q.displacement, before.displacement);
    EXPECT_EQ(motion.v.norm(), 0);
  }
}

TEST(BackwardEuler, SaysWhyItDidNotConverge) {
  const System system = cube({0, 0, -10});
  Motion<double> motion = random_motion(system);
  StepReport report = Euler({.dt = 0.1, .linear = {.max_iterations = 2}}).step(system, motion);
  EXPECT_EQ(report.status, Status::not_converged);
  EXPECT_EQ(report.reason, "conjugate gradients: too many iterations");
  EXPECT_EQ(report.linear_iterations, 2);
  EXPECT_GT(report.residual, 1e-6);
  EXPECT_TRUE(motion.q.displacement.allFinite());

  motion = random_motion(system);
  report =
      Euler({.dt = 0.1, .newton = true, .tolerance = 1e-10, .max_newton_iterations = 1}).step(system, motion);
  EXPECT_EQ(report.status, Status::not_converged);
  EXPECT_EQ(report.reason, "Newton: too many iterations");
  EXPECT_EQ(report.newton_iterations, 1);
  EXPECT_EQ(motion.time, 0.1);
  EXPECT_TRUE(motion.q.displacement.allFinite());
}

TEST(BackwardEuler, RefusesOptionsByValue) {
  EXPECT_EQ(refusal([] { return Euler({.dt = 0}); }), "dt 0 s: must be positive and finite");
  EXPECT_EQ(refusal([] { return Euler({.dt = -1}); }), "dt -1 s: must be positive and finite");
  EXPECT_EQ(refusal([] { return Euler({.dt = nan}); }), "dt nan s: must be positive and finite");
  EXPECT_EQ(refusal([] { return Euler({.dt = 0.1, .tolerance = 0}); }), "tolerance 0: must be positive");
  EXPECT_EQ(refusal([] { return Euler({.dt = 0.1, .tolerance = nan}); }), "tolerance nan: must be positive");
  EXPECT_EQ(refusal([] { return Euler({.dt = 0.1, .max_newton_iterations = 0}); }),
            "max_iterations 0: must be at least 1");
}

}  // namespace backward_euler_test
