// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>

#include "integrator/moving_bodies.hpp"
#include "softsim/integrator/adaptive_runge_kutta.hpp"
#include "softsim/integrator/energy_controlled.hpp"
#include "softsim/integrator/implicit.hpp"
#include "softsim/integrator/semi_explicit_euler.hpp"
#include "softsim/integrator/velocity_verlet.hpp"
#include "softsim/potential/prony.hpp"

namespace step_control_test {

using namespace moving_bodies;
using bodies::refusal, bodies::relative_error;
using softsim::AdaptiveRungeKutta, softsim::AdaptiveRungeKuttaOptions, softsim::AdaptiveStepReport,
    softsim::ButcherTableau, softsim::EnergyControlled, softsim::EnergyControlledOptions,
    softsim::EnergyStepReport, softsim::RungeKutta, softsim::SemiExplicitEuler;
using Euler = SemiExplicitEuler<System>;
using Controlled = EnergyControlled<System, Euler>;

static_assert(softsim::Integrator<AdaptiveRungeKutta<System>, System>);
static_assert(softsim::Integrator<Controlled, System>);
static_assert(softsim::AdjustableIntegrator<Euler, System>);
static_assert(softsim::AdjustableIntegrator<softsim::BackwardEuler<System>, System>);
static_assert(softsim::AdjustableIntegrator<AdaptiveRungeKutta<System>, System>);
static_assert(!softsim::AdjustableIntegrator<System, System>);

const double nan = std::numeric_limits<double>::quiet_NaN();

// ---------------------------------------------------------------- adaptive Runge-Kutta

// Error at 10 ms and steps taken.
struct Outcome {
  double error = 0;
  int steps = 0, rejected = 0;
};
Outcome run(const AdaptiveRungeKuttaOptions& options, const Vector<double>& reference) {
  const System system = free_cube({0, 0, -10});
  AdaptiveRungeKutta<System> adaptive(options);
  Motion<double> motion = random_motion(system);
  Outcome result;
  while (motion.time < 0.01) {
    const double next = adaptive.dt(), left = 0.01 - motion.time;
    if (next > left) adaptive.set_dt(left);
    const AdaptiveStepReport report = adaptive.step(system, motion);
    EXPECT_EQ(report.status, Status::converged);
    EXPECT_GT(report.dt, 0);
    EXPECT_LE(report.error, 1);
    ++result.steps;
    result.rejected += report.rejected;
    if (result.steps > 10000) break;
  }
  result.error = (motion.q.displacement - reference).cwiseAbs().maxCoeff();
  return result;
}

TEST(AdaptiveRungeKutta, KeepsTheErrorNearTheToleranceAndTakesTheStepsThatItsOrderNeeds) {
  const System system = free_cube({0, 0, -10});
  RungeKutta<System> fine({.dt = 1e-5, .tableau = ButcherTableau::dormand_prince()});
  Motion<double> motion = random_motion(system);
  for (int k = 0; k < 1000; ++k) ASSERT_EQ(fine.step(system, motion).status, Status::converged);
  for (const bool smooth : {true, false})
    for (const ButcherTableau& tableau :
         {ButcherTableau::dormand_prince(), ButcherTableau::bogacki_shampine()}) {
      const double order = tableau.order();
      const auto at = [&](double tolerance) {
        return run({.dt = 1e-4,
                    .position_tolerance = tolerance,
                    .velocity_tolerance = 1000 * tolerance,
                    .smooth = smooth,
                    .tableau = tableau},
                   motion.q.displacement);
      };
      const Outcome coarse = at(1e-7), close = at(1e-10);
      // Local errors of at most 1e-7 a step add up to little more in so short a time.
      EXPECT_LT(coarse.error, 1e-7 * coarse.steps);
      EXPECT_LT(close.error, 1e-10 * close.steps);
      EXPECT_GT(coarse.error, close.error);
      // An error a thousand times smaller takes 1000^(1/(embedded order + 1)) times the steps.
      const double ratio = static_cast<double>(close.steps) / coarse.steps;
      EXPECT_NEAR(std::log(ratio) / std::log(1000), 1 / order, 0.3 / order) << coarse.steps;
      EXPECT_LT(coarse.rejected, 2 + coarse.steps / 5);
    }
}

TEST(AdaptiveRungeKutta, FindsItsStepFromOneThatIsFarTooLarge) {
  const System system = free_cube();
  Motion<double> motion = random_motion(system);
  AdaptiveRungeKutta<System> adaptive({.dt = 10, .position_tolerance = 1e-6, .velocity_tolerance = 1e-3});
  const AdaptiveStepReport report = adaptive.step(system, motion);
  ASSERT_EQ(report.status, Status::converged);
  EXPECT_GE(report.rejected, 3);
  EXPECT_LT(report.dt, 0.01);
  EXPECT_EQ(motion.time, report.dt);
  EXPECT_LE(adaptive.dt(), report.dt) << "no growth after a rejection";
}

TEST(AdaptiveRungeKutta, GrowsUpToTheLargestStepInFreeFall) {
  const System system = free_cube({0, 0, -10});
  Motion<double> motion(system.rest().size());
  AdaptiveRungeKutta<System> adaptive({.dt = 1e-3, .dt_max = 0.01});
  for (int k = 0; k < 5; ++k) ASSERT_EQ(adaptive.step(system, motion).status, Status::converged);
  EXPECT_EQ(adaptive.dt(), 0.01);
  EXPECT_NEAR(motion.q.point(3)[2], -5 * motion.time * motion.time, 1e-10);
}

TEST(AdaptiveRungeKutta, EndsAtTheSmallestStepAndLosesNothing) {
  const System system = free_cube();
  Motion<double> motion = random_motion(system);
  const Motion<double> before = motion;
  const auto expect_nothing_lost = [&](const AdaptiveRungeKutta<System>& adaptive, double dt) {
    EXPECT_EQ(motion.q.displacement, before.q.displacement);
    EXPECT_EQ(motion.v, before.v);
    EXPECT_EQ(motion.time, 0);
    EXPECT_EQ(adaptive.dt(), dt);
  };
  AdaptiveRungeKutta<System> strict({.dt = 4e-3, .position_tolerance = 1e-12, .dt_min = 1e-3});
  const AdaptiveStepReport report = strict.step(system, motion);
  EXPECT_EQ(report.status, Status::not_converged);
  EXPECT_EQ(report.reason, "the error is above the tolerance with the smallest step");
  EXPECT_GT(report.error, 1);
  EXPECT_EQ(report.dt, 0);
  EXPECT_GE(report.rejected, 1);
  expect_nothing_lost(strict, 4e-3);
  System massless = system;
  massless.mass = Mass<double>(system.rest().size());
  AdaptiveRungeKutta<System> helpless({.dt = 1, .dt_min = 1e-3});
  EXPECT_EQ(helpless.step(massless, motion).status, Status::not_finite);
  expect_nothing_lost(helpless, 1);
}

// A rejected step goes part of the way, at the velocity that was asked for; the target is reached at the time
// that it was meant for.
TEST(AdaptiveRungeKutta, PrescribedNodesKeepTheirVelocityThroughRejections) {
  System system = free_cube();
  Motion<double> motion = random_motion(system);
  const Vec start = motion.q.point(0), velocity(0.1, 0.2, -0.3);
  AdaptiveRungeKutta<System> adaptive({.dt = 0.05, .position_tolerance = 1e-6, .velocity_tolerance = 1e-3});
  int rejected = 0;
  for (int k = 0; k < 30; ++k) {
    system.prescribed.set(0, start + (motion.time + adaptive.dt()) * velocity);
    const AdaptiveStepReport report = adaptive.step(system, motion);
    ASSERT_EQ(report.status, Status::converged);
    rejected += report.rejected;
    EXPECT_LT((motion.q.point(0) - (start + motion.time * velocity)).norm(), 1e-14);
    EXPECT_LT((block(motion.v, 0) - velocity).norm(), 1e-11);
  }
  EXPECT_GT(rejected, 0);
}

TEST(AdaptiveRungeKutta, RefusesOptionsByValue) {
  const auto said = [](AdaptiveRungeKuttaOptions o) {
    return refusal([&] { return AdaptiveRungeKutta<System>(o); });
  };
  EXPECT_EQ(said({.dt = 0.01}), "");
  EXPECT_EQ(said({}), "dt 0 s: must be positive and finite");
  EXPECT_EQ(said({.dt = nan}), "dt nan s: must be positive and finite");
  EXPECT_EQ(said({.dt = 1, .position_tolerance = 0}), "position_tolerance 0: must be positive and finite");
  EXPECT_EQ(said({.dt = 1, .velocity_tolerance = nan}),
            "velocity_tolerance nan: must be positive and finite");
  EXPECT_EQ(said({.dt = 1, .relative_tolerance = -1}),
            "relative_tolerance -1: must be at least 0 and finite");
  EXPECT_EQ(said({.dt = 1, .dt_min = 0}), "dt_min 0: must be positive and finite");
  EXPECT_EQ(said({.dt = 1, .dt_min = 2}), "dt_min 2: must be at most dt");
  EXPECT_EQ(said({.dt = 1, .dt_max = 0.5}), "dt_max 0.5: must be at least dt");
  EXPECT_EQ(said({.dt = 1, .safety = 1}), "safety 1: must be in (0, 1)");
  EXPECT_EQ(said({.dt = 1, .shrink = 0}), "shrink 0: must be in (0, 1)");
  EXPECT_EQ(said({.dt = 1, .grow = 1}), "grow 1: must be above 1 and finite");
  EXPECT_EQ(said({.dt = 1, .tableau = ButcherTableau::rk4()}), "tableau: must have embedded weights b_hat");
  EXPECT_EQ(
      said({.dt = 1,
            .tableau = ButcherTableau({.a = {{}, {0.5}}, .b = {0, 1}, .c = {0, 0.5}, .b_hat = {0, 1}})}),
      "tableau: embedded order 2 must differ from the order");
  AdaptiveRungeKutta<System> adaptive({.dt = 0.01});
  EXPECT_EQ(refusal([&] { return adaptive.set_dt(0), 0; }), "dt 0 s: must be positive and finite");
}

// ---------------------------------------------------------------- by the energy

double total_energy(const System& system, const Motion<double>& motion) {
  return system.energy(motion.q) + system.kinetic_energy(motion.v);
}

// Semi-explicit Euler blows up at 20 ms, here twice its stable step; under control it does not, and goes on
// at about its stable step.
TEST(EnergyControlled, KeepsAnIntegratorStable) {
  const System system = free_cube();
  Motion<double> motion = random_motion(system);
  const double start = total_energy(system, motion);
  Controlled controlled(Euler({.dt = 0.02}), {.tolerance = 1e-6, .relative_tolerance = 0.05});
  int rejected = 0;
  double largest = 0;
  for (int k = 0; k < 2000; ++k) {
    const double dt = controlled.dt(), time = motion.time, before = total_energy(system, motion);
    const EnergyStepReport report = controlled.step(system, motion);
    ASSERT_EQ(report.status, Status::converged);
    EXPECT_NEAR(motion.time - time, report.dt, 1e-14);
    EXPECT_NEAR(total_energy(system, motion) - before, report.energy_change, 1e-12 * start);
    EXPECT_LE(report.energy_change, 1e-6 + 0.05 * before);
    EXPECT_LE(report.dt, dt);
    rejected += report.rejected;
    if (k > 1000) largest = std::max(largest, report.dt);
    ASSERT_LT(total_energy(system, motion), 3 * start) << k;
  }
  EXPECT_GT(rejected, 0);
  EXPECT_GT(largest, 1e-3);
}

TEST(EnergyControlled, GrowsWhileNothingHappens) {
  const System system = free_cube({0, 0, -10});
  Motion<double> motion(system.rest().size());
  Controlled controlled(Euler({.dt = 1e-3}), {.tolerance = 0.1, .grow = 2, .dt_max = 6e-3});
  for (const double dt : {1e-3, 2e-3, 4e-3, 6e-3, 6e-3}) {
    const EnergyStepReport report = controlled.step(system, motion);
    EXPECT_EQ(report.status, Status::converged);
    EXPECT_DOUBLE_EQ(report.dt, dt);
  }
}

TEST(EnergyControlled, EndsAtTheSmallestStepAndLosesNothing) {
  const System system = free_cube();
  Motion<double> motion = random_motion(system);
  const Motion<double> before = motion;
  const auto expect_nothing_lost = [&](const Controlled& controlled) {
    EXPECT_EQ(motion.q.displacement, before.q.displacement);
    EXPECT_EQ(motion.v, before.v);
    EXPECT_EQ(motion.time, 0);
    EXPECT_EQ(controlled.dt(), 0.02);
  };
  Controlled controlled(Euler({.dt = 0.02}), {.tolerance = 1e-9, .dt_min = 0.01});
  const EnergyStepReport report = controlled.step(system, motion);
  EXPECT_EQ(report.status, Status::not_converged);
  EXPECT_EQ(report.reason, "the energy grows by more than the tolerance with the smallest step");
  EXPECT_EQ(report.rejected, 1);
  EXPECT_EQ(report.dt, 0);
  EXPECT_GT(report.energy_change, 1e-9);
  expect_nothing_lost(controlled);
  // An inverted tetrahedron of this law has no energy.
  Controlled blind(Euler({.dt = 0.02}), {.tolerance = 1e9, .dt_min = 0.02});
  Motion<double> fast = motion;
  fast.v *= 1000;
  const EnergyStepReport inverted = blind.step(system, fast);
  EXPECT_EQ(inverted.status, Status::not_finite);
  EXPECT_EQ(inverted.reason, "the energy is not finite");
  EXPECT_EQ(fast.v, 1000 * motion.v);
  System massless = system;
  massless.mass = Mass<double>(system.rest().size());
  EXPECT_EQ(controlled.step(massless, motion).status, Status::not_finite);
  expect_nothing_lost(controlled);
}

// A step that is undone leaves no trace in a history: the accepted one is, to rounding,
// that of a copy which made no other.
TEST(EnergyControlled, RejectedStepsLeaveNoTraceInAHistory) {
  const auto mesh = bodies::distorted_cube(2, 1);
  const auto law = softsim::NeoHookean::from_young_poisson(1000, 0.3);
  const softsim::PronySeries series({{0.4, 0.003}});
  const auto expect_none = [&](const auto& term) {
    softsim::System system(mesh, term);
    using Relaxing = decltype(system);
    using Inner = softsim::VelocityVerlet<Relaxing>;
    system.mass = Mass<double>::lumped(mesh, 1);
    Motion<double> motion(mesh.points().size());
    motion.q = bodies::random_state(mesh.points().size(), 0.03, 2);
    Inner warm({.dt = 1e-3});
    for (int k = 0; k < 5; ++k) ASSERT_EQ(warm.step(system, motion).status, Status::converged);
    Relaxing copy = system;
    Motion<double> other = motion;
    EnergyControlled<Relaxing, Inner> controlled(Inner({.dt = 0.1}), {.tolerance = 1e-3});
    const EnergyStepReport report = controlled.step(system, motion);
    ASSERT_EQ(report.status, Status::converged);
    ASSERT_GT(report.rejected, 0);
    Inner plain({.dt = report.dt});
    ASSERT_EQ(plain.step(copy, other).status, Status::converged);
    EXPECT_LT(relative_error(motion.q.displacement, other.q.displacement), 1e-12);
    EXPECT_LT(relative_error(motion.v, other.v), 1e-12);
    EXPECT_LT(relative_error(bodies::gradient(system, motion.q), bodies::gradient(copy, other.q)), 1e-12);
    // and attempts of an adaptive step neither
    AdaptiveRungeKutta<Relaxing> adaptive({.dt = 0.1, .velocity_tolerance = 1e-3});
    const AdaptiveStepReport second = adaptive.step(system, motion);
    ASSERT_EQ(second.status, Status::converged);
    ASSERT_GT(second.rejected, 0);
    RungeKutta<Relaxing> rk({.dt = second.dt, .tableau = ButcherTableau::dormand_prince()});
    ASSERT_EQ(rk.step(copy, other).status, Status::converged);
    EXPECT_LT(relative_error(motion.q.displacement, other.q.displacement), 1e-12);
    EXPECT_LT(relative_error(bodies::gradient(system, motion.q), bodies::gradient(copy, other.q)), 1e-12);
  };
  expect_none(softsim::prony_nodes(softsim::elastic(mesh, law), mesh.points().size(), series));
  expect_none(softsim::prony_elements(mesh, law, series));
}

TEST(EnergyControlled, RefusesOptionsByValue) {
  const auto said = [](const EnergyControlledOptions& o) {
    return refusal([&] { return Controlled(Euler({.dt = 0.01}), o); });
  };
  EXPECT_EQ(said({.tolerance = 1}), "");
  EXPECT_EQ(said({}), "tolerance 0: must be positive and finite");
  EXPECT_EQ(said({.tolerance = nan}), "tolerance nan: must be positive and finite");
  EXPECT_EQ(said({.tolerance = 1, .relative_tolerance = -1}),
            "relative_tolerance -1: must be at least 0 and finite");
  EXPECT_EQ(said({.tolerance = 1, .quiet = 0}), "quiet 0: must be in (0, 1]");
  EXPECT_EQ(said({.tolerance = 1, .shrink = 1}), "shrink 1: must be in (0, 1)");
  EXPECT_EQ(said({.tolerance = 1, .grow = 1}), "grow 1: must be above 1 and finite");
  EXPECT_EQ(said({.tolerance = 1, .dt_min = 0.02}), "dt_min 0.02: must be positive and at most dt");
  EXPECT_EQ(said({.tolerance = 1, .dt_max = 0.001}), "dt_max 0.001: must be at least dt");
}

}  // namespace step_control_test
