// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "potential/frame_bodies.hpp"
#include "softsim/integrator/implicit.hpp"
#include "softsim/integrator/runge_kutta.hpp"
#include "softsim/integrator/semi_explicit_euler.hpp"
#include "softsim/integrator/velocity_verlet.hpp"
#include "softsim/kinematics/shepard.hpp"
#include "softsim/material/st_venant_kirchhoff.hpp"
#include "softsim/potential/frame_elastic.hpp"
#include "softsim/system/system.hpp"

// Bodies of frames that turn and deform freely.

namespace tumbling_test {

using namespace softsim;
using Vec = Vector<double>;
using V = Vec3<double>;
using M = Mat3<double>;

// Two frames in a brick of 1.2 x 0.7 x 0.5 m, of samples on a grid.
struct Brick {
  FrameNodes nodes{{V(0.3, 0.3, 0.25), V(0.9, 0.4, 0.2)}};
  FrameBody<2> body;

  Brick() : body(make(nodes)) {}
  static FrameBody<2> make(const FrameNodes& nodes) {
    std::vector<V> X;
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 2; ++j)
        for (int k = 0; k < 2; ++k) X.emplace_back((i + 0.5) * 0.3, (j + 0.5) * 0.35, (k + 0.5) * 0.25);
    return {nodes, Shepard<>(nodes.frames()), X, std::vector<double>(X.size(), 0.42 / 16)};
  }
};
constexpr double density = 100;

auto tumbling(const Brick& brick, bool consistent, double young = 2e4) {
  System system(brick.nodes, elastic(brick.body, StVenantKirchhoff::from_young_poisson(young, 0.3)));
  system.mass =
      consistent ? Mass<double>::consistent(brick.body, density) : Mass<double>::lumped(brick.body, density);
  return system;
}
using S = decltype(tumbling(Brick(), true));

// Bent, twisted, and turning about no principal axis.
Motion<double> start(const S& system) {
  Motion<double> motion = system.rest_motion();
  Vec d = Vec::Zero(system.size());
  block(d, 1) = V(0.1, -0.05, 0.08);
  block(d, 2) = V(0.02, 0.01, -0.02);
  retract(motion.q, d);
  for (std::ptrdiff_t j = 0; j < 2; ++j) {
    const V omega(1, 2, -1.5), x = system.rest()[static_cast<std::size_t>(2 * j)] + motion.q.translation(j);
    block(motion.v, 2 * j) = omega.cross(x);
    block(motion.v, 2 * j + 1) = motion.q.rotation(j).transpose() * omega;
  }
  return motion;
}

// Kinetic energy and momenta against sums over velocities by differences of positions.
TEST(Tumbling, TheMassMatrixIsThatOfTheSamples) {
  const Brick brick;
  const S system = tumbling(brick, true);
  const Motion<double> motion = start(system);
  const double h = 1e-5;
  State<double> ahead = motion.q, behind = motion.q;
  retract(ahead, motion.v, h);
  retract(behind, motion.v, -h);
  double energy = 0;
  V momentum = V::Zero(), angular = V::Zero();
  for (std::size_t s = 0; s < brick.body.size(); ++s) {
    const double m = density * brick.body.volumes()[s];
    const V v = (brick.body.position(ahead, s) - brick.body.position(behind, s)) / (2 * h);
    energy += m / 2 * v.squaredNorm();
    momentum += m * v;
    angular += m * brick.body.position(motion.q, s).cross(v);
  }
  EXPECT_NEAR(system.kinetic_energy(motion.q, motion.v), energy, 1e-8 * energy);
  const auto [p, L] = system.momentum(motion);
  EXPECT_LT((p - momentum).norm(), 1e-8 * momentum.norm());
  EXPECT_LT((L - angular).norm(), 1e-8 * angular.norm());
  EXPECT_NEAR(system.mass.total(), 42, 1e-12 * 42);
}

// Lumped frames move rigidly with the body's own mass, centre and inertia.
TEST(Tumbling, LumpedMassIsExactForRigidMotions) {
  const Brick brick;
  const S lumped = tumbling(brick, false), consistent = tumbling(brick, true);
  Motion<double> motion = lumped.rest_motion();
  for (std::ptrdiff_t j = 0; j < 2; ++j) {
    const V omega(1, 2, -1.5);
    block(motion.v, 2 * j) = V(3, 4, 5) + omega.cross(brick.nodes.frames()[static_cast<std::size_t>(j)]);
    block(motion.v, 2 * j + 1) = omega;
  }
  const double T = consistent.kinetic_energy(motion.q, motion.v);
  EXPECT_NEAR(lumped.kinetic_energy(motion.q, motion.v), T, 1e-12 * T);
  const auto a = lumped.momentum(motion), b = consistent.momentum(motion);
  EXPECT_LT((a.linear - b.linear).norm(), 1e-12 * b.linear.norm());
  EXPECT_LT((a.angular - b.angular).norm(), 1e-12 * b.angular.norm());
}

// Along a motion of constant velocities in the axes of the bodies.
TEST(Tumbling, GyroscopicForcesAreThoseOfTheSamples) {
  const Brick brick;
  const S system = tumbling(brick, true);
  const Motion<double> motion = start(system);
  Vec g = Vec::Zero(system.size());
  system.mass.add_gyroscopic(motion.q, motion.v, 1, g);
  const double h = 1e-4;
  State<double> ahead = motion.q, behind = motion.q;
  retract(ahead, motion.v, h);  // constant body velocities
  retract(behind, motion.v, -h);
  Vec expected = Vec::Zero(system.size());
  for (std::size_t s = 0; s < brick.body.size(); ++s) {
    const double m = density * brick.body.volumes()[s];
    const V a = (brick.body.position(ahead, s) - 2 * brick.body.position(motion.q, s) +
                 brick.body.position(behind, s)) /
                (h * h);
    for (std::size_t i = 0; i < 2; ++i) {
      const auto& blend = brick.body.blends()[s];
      block(expected, 2 * blend.frames[i]) += m * blend.weights[i] * a;
      block(expected, 2 * blend.frames[i] + 1) +=
          m * blend.arms[i].cross(motion.q.rotation(blend.frames[i]).transpose() * a);
    }
  }
  EXPECT_LT((g - expected).norm(), 1e-6 * expected.norm());
}

// The motion after 0.2 s, in which the body turns by half a radian.
template <class I>
Motion<double> run(const S& system, I integrator, int steps) {
  Motion<double> motion = start(system);
  for (int k = 0; k < steps; ++k) {
    const StepReport report = integrator.step(system, motion);
    EXPECT_EQ(report.status, Status::converged) << report.reason;
    if (report.status != Status::converged) break;
  }
  return motion;
}

// Observed order of convergence from so many steps to twice as many, against RK4 with ten times more.
template <class I>
double order(const std::function<I(double)>& make, bool consistent, int steps) {
  const Brick brick;
  const S system = tumbling(brick, consistent);
  static std::array<Motion<double>, 2> fine;
  Motion<double>& exact = fine[consistent ? 1 : 0];
  if (exact.q.size() == 0) exact = run(system, RungeKutta<S>({.dt = 0.2 / 1600}), 1600);
  std::array<double, 2> error;
  for (std::size_t k = 0; k < 2; ++k) {
    const int n = k == 0 ? steps : 2 * steps;
    const Motion<double> motion = run(system, make(0.2 / n), n);
    Vec d(system.size());
    difference(exact.q, motion.q, d);
    error[k] = d.norm() + (exact.v - motion.v).norm() / 50;
  }
  return std::log2(error[0] / error[1]);
}

TEST(Tumbling, ExplicitIntegratorsKeepTheirOrder) {
  for (const bool consistent : {false, true}) {
    EXPECT_NEAR(order<RungeKutta<S>>([](double h) { return RungeKutta<S>({.dt = h}); }, consistent, 50), 4,
                0.3);
    EXPECT_NEAR(
        order<VelocityVerlet<S>>([](double h) { return VelocityVerlet<S>({.dt = h}); }, consistent, 100), 2,
        0.2);
    EXPECT_NEAR(order<SemiExplicitEuler<S>>([](double h) { return SemiExplicitEuler<S>({.dt = h}); },
                                            consistent, 400),
                1, 0.2);
  }
}

template <class Scheme>
double implicit_order(const Scheme& scheme, bool consistent, int steps, bool newton = true) {
  using I = Implicit<Scheme, S, Assembled, BlockJacobi>;
  return order<I>(
      [&](double dt) { return I({.dt = dt, .scheme = scheme, .newton = newton, .tolerance = 1e-11}); },
      consistent, steps);
}
TEST(Tumbling, ImplicitIntegratorsKeepTheirOrder) {
  for (const bool consistent : {false, true}) {
    EXPECT_NEAR(implicit_order(Theta(), consistent, 800), 1, 0.2);
    EXPECT_NEAR(implicit_order(Midpoint(), consistent, 100), 2, 0.2);
    EXPECT_NEAR(implicit_order(Bdf2(), consistent, 200), 2, 0.3);
    EXPECT_NEAR(implicit_order(NewmarkScheme(), consistent, 100), 2, 0.2);
    EXPECT_NEAR(implicit_order(HhtScheme(-0.05), consistent, 100), 2, 0.2);
    EXPECT_NEAR(implicit_order(GeneralisedAlphaScheme(0.8), consistent, 100), 2, 0.2);
    EXPECT_NEAR(implicit_order(Theta(), consistent, 800, false), 1, 0.2);
  }
}

}  // namespace tumbling_test
