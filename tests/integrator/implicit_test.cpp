// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/integrator/implicit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "potential/bodies.hpp"
#include "softsim/material/neo_hookean.hpp"
#include "softsim/mesh/selection.hpp"
#include "softsim/potential/dead_load.hpp"
#include "softsim/potential/elastic.hpp"
#include "softsim/solver/stationary.hpp"
#include "softsim/system/system.hpp"

namespace implicit_test {

using bodies::Vec, bodies::refusal;
using softsim::Mass, softsim::Motion, softsim::Status, softsim::Vector;
using System = softsim::System<softsim::ElasticTetrahedra<softsim::NeoHookean>, softsim::DeadLoad<double>>;
template <class Scheme>
using Implicit = softsim::Implicit<Scheme, System>;

static_assert(softsim::Integrator<Implicit<softsim::Theta>, System>);
static_assert(softsim::Integrator<Implicit<softsim::Bdf2>, System>);
static_assert(softsim::Integrator<Implicit<softsim::GeneralisedAlphaScheme>, System>);

const double nan = std::numeric_limits<double>::quiet_NaN();

// A bar of 1 x 0.3 x 0.3 m that is held at one end and swings sideways by a tenth of its length: first period
// about 4 s.
System bar(bool damped) {
  const auto mesh = softsim::box_mesh({4, 1, 1}, {1, 0.3, 0.3});
  System system(mesh, softsim::elastic(mesh, softsim::NeoHookean::from_young_poisson(150, 0.3)),
                softsim::gravity(mesh, 10, Vec(0, 0, -1)));
  system.mass = Mass<double>::lumped(mesh, 10);
  system.prescribed.fix(softsim::nodes_near(mesh, softsim::Side::xmin, 0));
  if (damped) system.damping = {.alpha = 0.5, .beta = 0.002};
  return system;
}
Motion<double> swinging(const System& system) {
  Motion<double> motion(system.rest().size());
  for (std::size_t i = 0; i < system.rest().size(); ++i) {
    const double x = system.rest()[i][0];
    softsim::block(motion.v, static_cast<std::ptrdiff_t>(i)) = Vec(0.05 * x * x, 0, -0.5 * x * x);
  }
  return motion;
}

template <class Scheme>
Motion<double> after(const System& system, double duration, int steps, Scheme scheme, bool newton) {
  Implicit<Scheme> integrator({.dt = duration / steps,
                               .scheme = scheme,
                               .newton = newton,
                               .tolerance = 1e-9,
                               .linear = {.max_iterations = 2000}});
  Motion<double> motion = swinging(system);
  for (int k = 0; k < steps; ++k) {
    const auto report = integrator.step(system, motion);
    EXPECT_EQ(report.status, Status::converged) << report.reason;
  }
  return motion;
}

double distance(const Motion<double>& a, const Motion<double>& b) {
  return (a.q.displacement - b.q.displacement).norm() + 0.2 * (a.v - b.v).norm();
}

// Errors against a fine solution of another second-order scheme, extrapolated, which all have to meet.
const Motion<double>& reference(bool damped) {
  static Motion<double> kept[2];
  Motion<double>& result = kept[damped ? 1 : 0];
  if (result.q.size() == 0) {
    const System system = bar(damped);
    const Motion<double> coarse = after(system, 0.25, 640, softsim::Midpoint(), true),
                         fine = after(system, 0.25, 1280, softsim::Midpoint(), true);
    result = fine;
    result.q.displacement += (fine.q.displacement - coarse.q.displacement) / 3;
    result.v += (fine.v - coarse.v) / 3;
  }
  return result;
}

template <class Scheme>
void expect_order(double order, Scheme scheme, const std::string& name, int steps = 40) {
  for (const bool damped : {false, true})
    for (const bool newton : {true, false}) {
      const System system = bar(damped);
      const double coarse = distance(after(system, 0.25, steps, scheme, newton), reference(damped)),
                   fine = distance(after(system, 0.25, 2 * steps, scheme, newton), reference(damped));
      EXPECT_NEAR(std::log2(coarse / fine), order, 0.1)
          << name << (newton ? " Newton" : " linearised") << (damped ? " damped " : " ") << coarse << " "
          << fine;
    }
}

TEST(Implicit, OrdersOfAccuracy) {
  expect_order(1, softsim::Theta(), "backward Euler", 160);
  expect_order(1, softsim::Theta{0.7}, "theta 0.7", 160);
  expect_order(2, softsim::Midpoint(), "midpoint");
  expect_order(2, softsim::Trapezoidal(), "trapezoidal");
  expect_order(2, softsim::Bdf2(), "BDF2", 80);
  expect_order(2, softsim::NewmarkScheme(), "Newmark");
  expect_order(1, softsim::NewmarkScheme(0.4, 0.7), "damped Newmark", 160);
  expect_order(2, softsim::HhtScheme(-0.2), "HHT");
  expect_order(2, softsim::GeneralisedAlphaScheme(0.5), "generalised-alpha");
}

// A memory that does not fit the motion any more is not used: a step from a motion that was changed is the
// first step of a new integrator.
TEST(Implicit, BeginsAnewWhereTheMotionWasChanged) {
  const System system = bar(true);
  const auto check = [&](auto scheme) {
    using Scheme = decltype(scheme);
    const typename Implicit<Scheme>::Options options{
        .dt = 0.01, .scheme = scheme, .newton = true, .tolerance = 1e-10};
    Implicit<Scheme> used(options), fresh(options);
    Motion<double> a = swinging(system), b(system.rest().size());
    for (int k = 0; k < 3; ++k) ASSERT_EQ(used.step(system, a).status, Status::converged);
    a.v *= 0.5;
    b = a;
    ASSERT_EQ(used.step(system, a).status, Status::converged);
    ASSERT_EQ(fresh.step(system, b).status, Status::converged);
    EXPECT_EQ(a.q.displacement, b.q.displacement);
    EXPECT_EQ(a.v, b.v);
  };
  check(softsim::Bdf2());
  check(softsim::NewmarkScheme());
  check(softsim::GeneralisedAlphaScheme(0.3));
}

// Prescribed nodes come to their target in every scheme, at a steady velocity, and stay without ringing.
TEST(Implicit, MovesPrescribedNodesSteadily) {
  const auto check = [&](auto scheme) {
    System system = bar(false);
    Implicit<decltype(scheme)> integrator({.dt = 0.01, .scheme = scheme, .newton = true, .tolerance = 1e-8});
    Motion<double> motion(system.rest().size());
    const auto held =
        softsim::nodes_near(softsim::box_mesh({4, 1, 1}, {1, 0.3, 0.3}), softsim::Side::xmin, 0);
    for (int k = 1; k <= 8; ++k) {
      const Vec target(0, std::min(k, 5) * 1e-3, 0);
      for (const auto i : held) system.prescribed.set(i, target);
      const auto report = integrator.step(system, motion);
      ASSERT_EQ(report.status, Status::converged) << report.reason;
      for (const auto i : held) {
        EXPECT_LT((Vec(motion.q.point(i)) - target).norm(), 1e-16);
        EXPECT_LT((Vec(softsim::block(motion.v, i)) - Vec(0, k <= 5 ? 0.1 : 0, 0)).norm(), 1e-13) << k;
      }
    }
    EXPECT_LT(motion.v.norm(), 1);
  };
  check(softsim::Theta{0.6});
  check(softsim::Midpoint());
  check(softsim::Trapezoidal());
  check(softsim::Bdf2());
  check(softsim::NewmarkScheme());
  check(softsim::GeneralisedAlphaScheme(1));
}

TEST(Implicit, LeavesTheMotionIfItIsNotFinite) {
  const System system = bar(false);
  const auto check = [&](auto scheme, bool newton) {
    Implicit<decltype(scheme)> integrator({.dt = 0.01, .scheme = scheme, .newton = newton});
    Motion<double> motion = swinging(system);
    ASSERT_EQ(integrator.step(system, motion).status, Status::converged);
    motion.v[40] = nan;
    const Motion<double> before = motion;
    const auto report = integrator.step(system, motion);
    EXPECT_EQ(report.status, Status::not_finite);
    EXPECT_FALSE(report.reason.empty());
    EXPECT_EQ(motion.q.displacement, before.q.displacement);
    EXPECT_EQ(motion.time, before.time);
    motion.v[40] = 0;
    EXPECT_EQ(integrator.step(system, motion).status, Status::converged);
  };
  for (const bool newton : {false, true}) {
    check(softsim::Midpoint(), newton);
    check(softsim::Trapezoidal(), newton);
    check(softsim::Bdf2(), newton);
    check(softsim::GeneralisedAlphaScheme(0.5), newton);
  }
}

// One tangent for many steps: the motion is a little less exact, as a linear solve with a wrong matrix, and
// exact again where Newton's method goes on until the forces balance.
TEST(Implicit, AFrozenTangentIsCorrectedByNewton) {
  const System system = bar(false);
  const auto run = [&](bool frozen, bool newton) {
    Implicit<softsim::Theta> integrator({.dt = 0.01,
                                         .newton = newton,
                                         .tolerance = 1e-9,
                                         .max_newton_iterations = 200,
                                         .update_every = frozen ? 0 : 1,
                                         .frozen = frozen});
    Motion<double> motion = swinging(system);
    for (int k = 0; k < 25; ++k) {
      const auto report = integrator.step(system, motion);
      EXPECT_EQ(report.status, Status::converged) << report.reason;
    }
    return motion;
  };
  const Motion<double> fresh = run(false, true), frozen = run(true, true), linear = run(true, false);
  EXPECT_LT(distance(fresh, frozen), 1e-6);
  EXPECT_GT(distance(fresh, linear), 1e-4);
  EXPECT_LT(distance(fresh, linear), 0.2);
}

// Debunne et al. 2001: the Jacobian reduced to its diagonal blocks, which are inverted once. Written out: the
// change of position is h v + D^-1 (f - A h v), or D^-1 of the whole right-hand side without a warm start.
TEST(Implicit, ADecoupledJacobianIsOnePreconditioning) {
  using Decoupled = softsim::Implicit<softsim::Theta, System, softsim::MatrixFree, softsim::BlockJacobi,
                                      softsim::Stationary>;
  const System system = bar(false);
  Motion<double> motion = swinging(system);
  const double h = 0.01;
  Decoupled integrator(
      {.dt = h, .linear = {.max_iterations = 1, .fixed = true}, .warm_start = false, .frozen = true});
  softsim::MatrixFreeTangent<System> tangent;
  const softsim::State<double> rest = motion.q;
  tangent.set(system, rest, {.mass = 1 / (h * h), .stiffness = 1});
  softsim::BlockJacobi<double> inverse;
  inverse.compute(tangent, system.prescribed.free());
  for (int k = 0; k < 20; ++k) {
    Vector<double> force = -bodies::gradient(system, motion.q), d(force.size());
    system.mass.add_product(motion.v, 1 / h, force);
    system.prescribed.mask(force);
    inverse.apply(force, d);
    const Vector<double> expected = motion.q.displacement + d;
    const auto report = integrator.step(system, motion);
    EXPECT_EQ(report.linear_iterations, 1);
    EXPECT_GT(report.residual, 0);
    ASSERT_LT((motion.q.displacement - expected).norm(), 1e-12) << k;
  }
}

TEST(Implicit, RefusesOptionsByValue) {
  using softsim::GeneralisedAlphaScheme, softsim::HhtScheme, softsim::NewmarkScheme, softsim::Theta;
  const auto made = [](auto scheme, double dt = 0.01) {
    return refusal([&] { Implicit<decltype(scheme)>({.dt = dt, .scheme = scheme}); });
  };
  EXPECT_NE(made(Theta{0}).find("beta 0: must be in (0, 1]"), std::string::npos);
  EXPECT_NE(made(Theta{1.5}).find("beta 1.5"), std::string::npos);
  EXPECT_NE(made(Theta{nan}).find("beta nan"), std::string::npos);
  EXPECT_NE(made(NewmarkScheme(0, 0.5)).find("Newmark beta 0"), std::string::npos);
  EXPECT_NE(made(NewmarkScheme(0.25, 0.4)).find("gamma 0.4"), std::string::npos);
  EXPECT_NE(refusal([] { GeneralisedAlphaScheme(1.1); }).find("rho_inf 1.1: must be in [0, 1]"),
            std::string::npos);
  EXPECT_NE(refusal([] { GeneralisedAlphaScheme{nan}; }).find("rho_inf nan"), std::string::npos);
  EXPECT_NE(refusal([] { HhtScheme(-0.5); }).find("HHT alpha -0.5"), std::string::npos);
  EXPECT_NE(made(Theta(), 0).find("dt 0 s"), std::string::npos);
  EXPECT_NE(made(Theta(), nan).find("dt nan"), std::string::npos);
}

}  // namespace implicit_test
