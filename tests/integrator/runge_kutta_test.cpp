// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/integrator/runge_kutta.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "integrator/moving_bodies.hpp"
#include "softsim/integrator/velocity_verlet.hpp"
#include "softsim/potential/kelvin_voigt.hpp"
#include "softsim/potential/prony.hpp"

namespace runge_kutta_test {

using namespace moving_bodies;
using bodies::refusal, bodies::relative_error;
using softsim::ButcherTableau, softsim::ExplicitEuler, softsim::RungeKutta, softsim::State,
    softsim::VelocityVerlet;

static_assert(softsim::Integrator<RungeKutta<System>, System>);
static_assert(softsim::Integrator<ExplicitEuler<System>, System>);
static_assert(softsim::Integrator<VelocityVerlet<System>, System>);

RungeKutta<System> make(double dt, const ButcherTableau& tableau = ButcherTableau::rk4()) {
  return RungeKutta<System>(
      {.dt = dt, .tableau = tableau, .linear = {.max_iterations = 500, .tolerance = 1e-14}});
}

// ---------------------------------------------------------------- order

// A tumbling Neo-Hookean cube with Rayleigh damping and some nodes held, over 10 ms. Its fastest mode turns
// by about 0.5 rad in 2 ms, so that steps of a few tenths of that are where errors go with a power.
struct Case {
  System system;
  Motion<double> start;
  Vector<double> reference;
  explicit Case(bool lumped) : system(free_cube({0, 0, -10}, lumped)), start(random_motion(system)) {
    system.damping = {.alpha = 5, .beta = 2e-4};
    for (const std::int32_t i : {0, 1}) system.prescribed.set(i, Vec(start.q.point(i)));
    start.v.head(8).setZero();
    reference = after(make(0.01 / 800, ButcherTableau::dormand_prince()), system, start, 800);
  }
  // From two runs of n and 2 n steps; make(dt) is the integrator.
  template <class Make>
  double order(int n, Make make_one) const {
    const double coarse = (after(make_one(0.01 / n), system, start, n) - reference).norm();
    const double fine = (after(make_one(0.01 / (2 * n)), system, start, 2 * n) - reference).norm();
    return std::log2(coarse / fine);
  }
};

TEST(RungeKutta, HasTheOrderOfItsTableau) {
  for (const bool lumped : {true, false}) {
    const Case body(lumped);
    const auto order = [&](int n, const ButcherTableau& tableau) {
      return body.order(n, [&](double dt) { return make(dt, tableau); });
    };
    EXPECT_NEAR(order(400, ButcherTableau::explicit_euler()), 1, 0.1);
    EXPECT_NEAR(order(80, ButcherTableau::midpoint()), 2, 0.1);
    EXPECT_NEAR(order(80, ButcherTableau::heun()), 2, 0.1);
    EXPECT_NEAR(order(40, ButcherTableau::kutta3()), 3, 0.1);
    EXPECT_NEAR(order(40, ButcherTableau::bogacki_shampine()), 3, 0.1);
    EXPECT_NEAR(order(40, ButcherTableau::rk4()), 4, 0.1);
    EXPECT_NEAR(order(20, ButcherTableau::dormand_prince()), 5, 0.1);
    EXPECT_NEAR(body.order(80, [](double dt) { return VelocityVerlet<System>({.dt = dt}); }), 2, 0.1);
  }
}

// Damping forces of terms are taken at the velocity of each stage.
TEST(RungeKutta, KeepsItsOrderWithKelvinVoigtDamping) {
  const auto mesh = bodies::distorted_cube(2, 1);
  softsim::System system(mesh, softsim::elastic(mesh, softsim::NeoHookean::from_young_poisson(1000, 0.3)),
                         softsim::kelvin_voigt(mesh, {.phi = 0.1, .psi = 0.2}));
  using Damped = decltype(system);
  system.mass = Mass<double>::lumped(mesh, 1);
  Motion<double> start(mesh.points().size());
  start.q = bodies::random_state(mesh.points().size(), 0.03, 2);
  const auto run = [&](int n) { return after(RungeKutta<Damped>({.dt = 0.01 / n}), system, start, n); };
  const Vector<double> reference = run(1600);
  EXPECT_NEAR(std::log2((run(40) - reference).norm() / (run(80) - reference).norm()), 4, 0.1);
}

// Stages ask for forces at their own time, so that what relaxes during a step is seen: order 2, that of the
// history. With forces of the start it would be 1.
TEST(RungeKutta, HasOrderTwoWithAHistory) {
  const auto mesh = bodies::distorted_cube(2, 1);
  const auto law = softsim::NeoHookean::from_young_poisson(1000, 0.3);
  const softsim::PronySeries series({{0.4, 0.003}});
  const auto expect_two = [&](const auto& term) {
    softsim::System fresh(mesh, term);
    using Relaxing = decltype(fresh);
    fresh.mass = Mass<double>::lumped(mesh, 1);
    Motion<double> start(mesh.points().size());
    start.q = bodies::random_state(mesh.points().size(), 0.03, 2);
    const auto order = [&](auto make_one) {
      const auto run = [&](int n) {
        Relaxing system = fresh;  // without a past
        return after(make_one(0.01 / n), system, start, n);
      };
      const Vector<double> reference = run(2560);
      return std::log2((run(80) - reference).norm() / (run(160) - reference).norm());
    };
    EXPECT_NEAR(order([](double dt) { return RungeKutta<Relaxing>({.dt = dt}); }), 2, 0.1);
    EXPECT_NEAR(order([](double dt) { return VelocityVerlet<Relaxing>({.dt = dt}); }), 2, 0.1);
  };
  expect_two(softsim::prony_nodes(softsim::elastic(mesh, law), mesh.points().size(), series));
  expect_two(softsim::prony_elements(mesh, law, series));
}

// ---------------------------------------------------------------- what it keeps

TEST(RungeKutta, ConservesLinearMomentumAndNearlyTheAngularOne) {
  for (const bool lumped : {true, false}) {
    const System system = free_cube(Vec::Zero(), lumped);
    Motion<double> motion = random_motion(system);
    const auto before = system.momentum(motion);
    auto rk = make(1e-3, ButcherTableau::dormand_prince());
    for (int k = 0; k < 100; ++k) ASSERT_EQ(rk.step(system, motion).status, Status::converged);
    const auto now = system.momentum(motion);
    EXPECT_LT((now.linear - before.linear).norm(), 1e-11 * before.linear.norm());
    EXPECT_LT((now.angular - before.angular).norm(), 1e-4 * before.angular.norm());  // its error, not a law
  }
}

// A parabola is exact from order 2 on; explicit Euler falls h g t/2 too little.
TEST(RungeKutta, FallsExactly) {
  const Vec g(1, -2, -9.81);
  for (const bool lumped : {true, false}) {
    const System system = free_cube(g, lumped);
    const auto fall = [&](auto integrator, double missing) {
      Motion<double> motion(system.rest().size());
      for (int k = 0; k < 200; ++k) ASSERT_EQ(integrator.step(system, motion).status, Status::converged);
      EXPECT_NEAR(motion.time, 0.2, 1e-14);
      for (std::ptrdiff_t i = 0; i < 27; ++i) {
        EXPECT_LT((block(motion.v, i) - 0.2 * g).norm(), 1e-10);
        EXPECT_LT((motion.q.point(i) - (0.02 - missing) * g).norm(), 1e-10);
      }
    };
    fall(make(1e-3), 0);
    fall(make(1e-3, ButcherTableau::midpoint()), 0);
    fall(VelocityVerlet<System>({.dt = 1e-3}), 0);
    fall(ExplicitEuler<System>({.dt = 1e-3}), 1e-4);
  }
}

TEST(RungeKutta, MovingNodesReachTheirTargetsEveryStep) {
  constexpr double h = 1e-3;
  for (const bool lumped : {true, false}) {
    System system = free_cube({0, 0, -10}, lumped);
    system.damping = {.alpha = 5, .beta = 2e-4};
    const auto move = [&](auto integrator) {
      Motion<double> motion(system.rest().size());
      for (int k = 1; k <= 50; ++k) {
        const Vec target(0.1 * std::sin(0.1 * k), 1e-3 * k, 0);
        for (const std::int32_t i : {0, 1, 2}) system.prescribed.set(i, target);
        const Vec before = motion.q.point(1);
        ASSERT_EQ(integrator.step(system, motion).status, Status::converged);
        for (std::ptrdiff_t i = 0; i < 3; ++i) EXPECT_LT((motion.q.point(i) - target).norm(), 1e-15);
        EXPECT_LT((block(motion.v, 1) - (target - before) / h).norm(), 1e-12);
      }
      for (std::ptrdiff_t k = 3; k < system.size(); k += 4)
        EXPECT_EQ(std::abs(motion.q.displacement[k]) + std::abs(motion.v[k]), 0);
    };
    move(make(h));
    move(make(h, ButcherTableau::dormand_prince()));
    move(VelocityVerlet<System>({.dt = h}));
  }
}

// A body whose nodes are all prescribed but one hangs on it by a consistent mass: all its free node feels of
// an acceleration of the others, without stiffness to speak of, is M_fp a_p.
TEST(RungeKutta, PrescribedAccelerationActsThroughTheConsistentMass) {
  const softsim::TetrahedralMesh mesh({Vec(0, 0, 0), Vec(1, 0, 0), Vec(0, 1, 0), Vec(0, 0, 1)},
                                      {{0, 1, 2, 3}});
  System system(mesh, softsim::elastic(mesh, softsim::NeoHookean::from_young_poisson(1e-12, 0.3)),
                softsim::gravity(mesh, 1, Vec::Zero()));
  system.mass = Mass<double>::consistent(mesh, 1);
  const auto follow = [&](auto integrator) {
    Motion<double> motion(4);
    for (int k = 1; k <= 100; ++k) {
      for (const std::int32_t i : {0, 1, 2}) system.prescribed.set(i, Vec(0.5e-4 * k * k, 0, 0));
      ASSERT_EQ(integrator.step(system, motion).status, Status::converged);
    }
    // m (2 a_f + 3 a_p) = 0: the velocities that the prescribed nodes ended with, times -3/2
    EXPECT_NEAR(block(motion.v, 3)[0], -1.5 * block(motion.v, 0)[0], 1e-10);
    EXPECT_NEAR(block(motion.v, 0)[0], 0.5e-4 * (100 * 100 - 99 * 99) / 0.01, 1e-9);
  };
  follow(make(0.01));
  follow(VelocityVerlet<System>({.dt = 0.01}));
}

// ---------------------------------------------------------------- velocity Verlet

// Without damping its positions are those of central differences.
TEST(VelocityVerlet, IsCentralDifferences) {
  constexpr double h = 2e-3;
  const System system = free_cube({0, 0, -10});
  Motion<double> motion = random_motion(system);
  VelocityVerlet<System> verlet({.dt = h});
  std::vector<Vector<double>> u{motion.q.displacement};
  for (int k = 0; k < 20; ++k) {
    ASSERT_EQ(verlet.step(system, motion).status, Status::converged);
    u.push_back(motion.q.displacement);
  }
  for (std::size_t k = 1; k + 1 < u.size(); ++k) {
    State<double> q;
    q.displacement = u[k];
    Vector<double> f = -bodies::gradient(system, q);
    for (std::ptrdiff_t i = 0; i < f.size(); ++i) f[i] = i % 4 == 3 ? 0 : f[i] / system.mass.diagonal()[i];
    EXPECT_LT((u[k + 1] - 2 * u[k] + u[k - 1] - h * h * f).norm(), 1e-14);
  }
}

TEST(VelocityVerlet, ConservesMomentaAndKeepsTheEnergyInABand) {
  for (const bool lumped : {true, false}) {
    const System system = free_cube(Vec::Zero(), lumped);
    Motion<double> motion = random_motion(system);
    const auto before = system.momentum(motion);
    const auto energy = [&] { return system.energy(motion.q) + system.kinetic_energy(motion.v); };
    const double start = energy();
    VelocityVerlet<System> verlet({.dt = 1e-3, .linear = {.max_iterations = 500, .tolerance = 1e-14}});
    double worst = 0;
    for (int k = 0; k < 3000; ++k) {
      ASSERT_EQ(verlet.step(system, motion).status, Status::converged);
      worst = std::max(worst, std::abs(energy() / start - 1));
    }
    const auto now = system.momentum(motion);
    EXPECT_LT((now.linear - before.linear).norm(), 1e-11 * before.linear.norm());
    EXPECT_LT((now.angular - before.angular).norm(),
              1e-11 * (before.angular.norm() + 10 * before.linear.norm()));
    EXPECT_LT(worst, 0.02);  // about (omega h)^2/8 of the fast modes
  }
}

// A term that counts how often it is asked.
struct Counting {
  using Scalar = double;
  static constexpr bool conservative = true, external = false, has_hessian = false;
  int* calls;
  double stiffness = 1;
  double energy(const State<double>& q) const { return stiffness * q.displacement.squaredNorm() / 2; }
  void add_gradient(const State<double>& q, Vector<double>& y) const {
    ++*calls;
    y += stiffness * q.displacement;
  }
  void add_hessian_product(const State<double>&, const Vector<double>& d, Vector<double>& y) const {
    y += stiffness * d;
  }
};

TEST(VelocityVerlet, EvaluatesTheForceOnceAStepAndAnewAfterAChange) {
  const auto mesh = bodies::distorted_cube(1, 1);
  int calls = 0;
  softsim::System<Counting> system(mesh, Counting{&calls});
  system.mass = Mass<double>::lumped(mesh, 1);
  system.damping = {.alpha = 0.1, .beta = 0.01};
  VelocityVerlet<softsim::System<Counting>> verlet({.dt = 0.01});
  Motion<double> motion(mesh.points().size());
  motion.q = bodies::random_state(mesh.points().size(), 0.1, 1);
  const auto calls_of_a_step = [&] {
    calls = 0;
    EXPECT_EQ(verlet.step(system, motion).status, Status::converged);
    return calls;
  };
  EXPECT_EQ(calls_of_a_step(), 2);
  for (int k = 0; k < 5; ++k) EXPECT_EQ(calls_of_a_step(), 1);
  // The next step of an integrator that knows nothing is the same to the last bit.
  {
    Motion<double> same = motion;
    VelocityVerlet<softsim::System<Counting>> other({.dt = 0.01});
    ASSERT_EQ(other.step(system, same).status, Status::converged);
    EXPECT_EQ(calls_of_a_step(), 1);
    EXPECT_EQ(same.q.displacement, motion.q.displacement);
    EXPECT_EQ(same.v, motion.v);
  }
  motion.q.point(2)[1] += 1e-12;
  EXPECT_EQ(calls_of_a_step(), 2);
  motion.v[0] += 1e-12;
  EXPECT_EQ(calls_of_a_step(), 2);
  motion.time += 1;
  EXPECT_EQ(calls_of_a_step(), 2);
  verlet.forget();
  EXPECT_EQ(calls_of_a_step(), 2);
  softsim::System<Counting> another(mesh, Counting{&calls, 2});
  another.mass = system.mass;
  calls = 0;
  ASSERT_EQ(verlet.step(another, motion).status, Status::converged);
  EXPECT_EQ(calls, 2);
  system.mass = Mass<double>(mesh.points().size());  // a step that fails leaves nothing to reuse
  EXPECT_EQ(verlet.step(system, motion).status, Status::not_finite);
  system.mass = another.mass;
  EXPECT_EQ(calls_of_a_step(), 2);
}

// ---------------------------------------------------------------- failures, single precision

TEST(RungeKutta, ReportsAStepThatIsTooLargeAndLeavesTheMotion) {
  const System system = free_cube();
  expect_failure_without_loss(make(0.1), system, random_motion(system));
  expect_failure_without_loss(ExplicitEuler<System>({.dt = 0.1}), system, random_motion(system));
  expect_failure_without_loss(VelocityVerlet<System>({.dt = 0.1}), system, random_motion(system));
}

TEST(RungeKutta, ReportsAFreePointWithoutMassAndAMassSolveThatRunsOut) {
  for (const bool lumped : {true, false}) {
    System system = free_cube({0, 0, -10}, lumped);
    if (lumped) system.mass = Mass<double>(system.rest().size());
    const auto expect = [&](auto integrator, Status status) {
      Motion<double> motion = lumped ? Motion<double>(system.rest().size()) : random_motion(system);
      EXPECT_EQ(integrator.step(system, motion).status, status);
      if (lumped) {
        EXPECT_EQ(motion.q.displacement.norm() + motion.v.norm() + motion.time, 0);
      }
    };
    expect(make(1e-3), lumped ? Status::not_finite : Status::converged);
    expect(VelocityVerlet<System>({.dt = 1e-3}), lumped ? Status::not_finite : Status::converged);
    if (lumped) continue;
    const softsim::ConjugateGradient two{.max_iterations = 2, .tolerance = 1e-12};
    expect(RungeKutta<System>({.dt = 1e-3, .linear = two}), Status::not_converged);
    expect(VelocityVerlet<System>({.dt = 1e-3, .linear = two}), Status::not_converged);
  }
}

TEST(RungeKutta, SinglePrecisionFollowsDoubles) {
  const System exact = free_cube<double>({0, 0, -10});
  const SystemOf<float> single = free_cube<float>({0, 0, -10});
  const auto compare = [&](auto a, auto b) {
    Motion<double> x = random_motion(exact);
    Motion<float> y = random_motion(single);
    for (int k = 0; k < 50; ++k) {
      ASSERT_EQ(a.step(exact, x).status, Status::converged);
      ASSERT_EQ(b.step(single, y).status, Status::converged);
    }
    EXPECT_LT(relative_error(y.q.displacement, x.q.displacement), 1e-4);
  };
  compare(RungeKutta<System>({.dt = 1e-3}), RungeKutta<SystemOf<float>>({.dt = 1e-3}));
  compare(VelocityVerlet<System>({.dt = 1e-3}), VelocityVerlet<SystemOf<float>>({.dt = 1e-3}));
}

TEST(RungeKutta, RefusesStepsByValue) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  for (const auto& [dt, text] :
       std::vector<std::pair<double, std::string>>{{0, "0"}, {-0.01, "-0.01"}, {inf, "inf"}, {nan, "nan"}}) {
    const double h = dt;
    const std::string said = "dt " + text + " s: must be positive and finite";
    EXPECT_EQ(refusal([&] { return make(h); }), said);
    EXPECT_EQ(refusal([&] { return ExplicitEuler<System>({.dt = h}); }), said);
    EXPECT_EQ(refusal([&] { return VelocityVerlet<System>({.dt = h}); }), said);
    auto rk = make(1);
    auto verlet = VelocityVerlet<System>({.dt = 1});
    EXPECT_EQ(refusal([&] { return rk.set_dt(h), 0; }), said);
    EXPECT_EQ(refusal([&] { return verlet.set_dt(h), 0; }), said);
    EXPECT_EQ(rk.dt() + verlet.dt(), 2);
  }
}

// For points the increment moves the state as it is: its Jacobian is the identity.
TEST(RungeKutta, JacobianOfAnIncrementOfPointsIsTheIdentity) {
  const State<double> q = bodies::random_state(5, 1, 1);
  const Vector<double> u = bodies::random_vector(5, 1, 2), w = bodies::random_vector(5, 1, 3);
  Vector<double> x = w;
  softsim::dexp(q, u, x);
  EXPECT_EQ(x, w);
  softsim::dexp_inv(q, u, x);
  EXPECT_EQ(x, w);
}

}  // namespace runge_kutta_test
