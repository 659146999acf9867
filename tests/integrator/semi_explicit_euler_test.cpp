// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/integrator/semi_explicit_euler.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "potential/bodies.hpp"
#include "softsim/material/linear_elastic.hpp"
#include "softsim/material/neo_hookean.hpp"
#include "softsim/mesh/selection.hpp"
#include "softsim/potential/dead_load.hpp"
#include "softsim/potential/elastic.hpp"
#include "softsim/system/system.hpp"
#include "softsim/system/tangent.hpp"

namespace semi_explicit_euler_test {

using bodies::Vec, bodies::refusal, bodies::relative_error;
using softsim::Mass, softsim::Motion, softsim::SemiExplicitEuler, softsim::State, softsim::Status,
    softsim::TetrahedralMesh, softsim::Vector, softsim::block;
using System = softsim::System<softsim::ElasticTetrahedra<softsim::NeoHookean>, softsim::DeadLoad<double>>;

static_assert(softsim::Integrator<SemiExplicitEuler<System>, System>);
static_assert(!softsim::Integrator<System, System> &&
              !softsim::Integrator<softsim::ConjugateGradient, System>);

const double nan = std::numeric_limits<double>::quiet_NaN();

// A free cube, E = 1000 Pa, 1 kg, 27 nodes: waves cross it in about 30 ms.
System free_cube(const Vec& g = Vec::Zero(), bool lumped = true) {
  const TetrahedralMesh mesh = bodies::distorted_cube(2, 1);
  System system(mesh, softsim::elastic(mesh, softsim::NeoHookean::from_young_poisson(1000, 0.3)),
                softsim::gravity(mesh, 1, g));
  system.mass = lumped ? Mass<double>::lumped(mesh, 1) : Mass<double>::consistent(mesh, 1);
  return system;
}

Motion<double> random_motion(const System& system) {
  Motion<double> motion(system.rest().size());
  motion.q = bodies::random_state(system.rest().size(), 0.03, 2);
  motion.v = bodies::random_vector(system.rest().size(), 2, 3);
  for (std::size_t i = 0; i < system.rest().size(); ++i)
    block(motion.v, static_cast<std::ptrdiff_t>(i)) += Vec(1, 2, 3) + Vec(0, 3, -1).cross(system.rest()[i]);
  return motion;
}

Vector<double> mass_times(const System& system, const Vector<double>& x) {
  Vector<double> y = Vector<double>::Zero(x.size());
  system.mass.add_product(x, 1, y);
  return y;
}

TEST(SemiExplicitEuler, ConservesMomentumOfAFreeBody) {
  for (const bool lumped : {true, false}) {
    const System system = free_cube(Vec::Zero(), lumped);
    Motion<double> motion = random_motion(system);
    const auto before = system.momentum(motion);
    SemiExplicitEuler<System> euler({.dt = 1e-3, .linear = {.max_iterations = 500, .tolerance = 1e-14}});
    for (int k = 0; k < 1000; ++k) ASSERT_EQ(euler.step(system, motion).status, Status::converged);
    const auto after = system.momentum(motion);
    EXPECT_LT((after.linear - before.linear).norm(), 1e-11 * before.linear.norm());
    // measured with the distance that the body has gone by then
    EXPECT_LT((after.angular - before.angular).norm(),
              1e-11 * (before.angular.norm() + 3 * before.linear.norm()));
  }
}

TEST(SemiExplicitEuler, KeepsTheEnergyInABand) {
  const System system = free_cube();
  Motion<double> motion = random_motion(system);
  SemiExplicitEuler<System> euler({.dt = 1e-3});
  double early = 0, late = 0, lowest = std::numeric_limits<double>::infinity(), highest = 0;
  for (int k = 0; k < 10000; ++k) {
    ASSERT_EQ(euler.step(system, motion).status, Status::converged);
    const double energy = system.energy(motion.q) + system.kinetic_energy(motion.v);
    (k < 1000 ? early : k >= 9000 ? late : highest) += k < 1000 || k >= 9000 ? energy / 1000 : 0;
    lowest = std::min(lowest, energy);
    highest = std::max(highest, energy);
  }
  EXPECT_LT((highest - lowest) / early, 0.1);  // the band grows with the step, here a tenth of the stable one
  EXPECT_NEAR(late / early, 1, 0.01) << "drift";
}

// v = g t and, with the velocity of the end of the step, x = g h^2 n (n + 1)/2, to rounding.
TEST(SemiExplicitEuler, FallsExactly) {
  const Vec g(1, -2, -9.81);
  for (const bool lumped : {true, false}) {
    const System system = free_cube(g, lumped);
    Motion<double> motion(system.rest().size());
    SemiExplicitEuler<System> euler({.dt = 1e-3});
    for (int k = 0; k < 200; ++k) ASSERT_EQ(euler.step(system, motion).status, Status::converged);
    EXPECT_NEAR(motion.time, 0.2, 1e-14);
    for (std::ptrdiff_t i = 0; i < 27; ++i) {
      // lumped: only rounding; consistent: the solve's tolerance of 1e-12
      EXPECT_LT((block(motion.v, i) - 0.2 * g).norm(), 1e-10) << lumped;
      EXPECT_LT((motion.q.point(i) - 0.5e-6 * 200 * 201 * g).norm(), 1e-10) << lumped;
    }
  }
}

// ---------------------------------------------------------------- one step against its formula

Eigen::MatrixXd dense_mass(const System& system) {
  const std::ptrdiff_t n = system.size();
  Eigen::MatrixXd M(n, n);
  for (std::ptrdiff_t k = 0; k < n; ++k) M.col(k) = mass_times(system, Vector<double>::Unit(n, k));
  for (std::ptrdiff_t k = 3; k < n; k += softsim::block_stride) M(k, k) = 1;
  return M;
}

TEST(SemiExplicitEuler, StepIsTheFormulaWithDampingAndEitherMass) {
  constexpr double h = 1e-3, alpha = 3, beta = 0.004;
  for (const bool lumped : {true, false}) {
    System system = free_cube({0, 0, -10}, lumped);
    system.damping = {alpha, beta};
    Motion<double> motion = random_motion(system);
    const Vector<double> f = -bodies::gradient(system, motion.q) - alpha * mass_times(system, motion.v) -
                             beta * bodies::hessian_product(system, motion.q, motion.v);
    const Vector<double> v = motion.v + h * dense_mass(system).llt().solve(f),
                         u = motion.q.displacement + h * v;
    SemiExplicitEuler<System> euler({.dt = h});
    ASSERT_EQ(euler.step(system, motion).status, Status::converged);
    EXPECT_LT(relative_error(motion.v, v), 1e-11);
    EXPECT_LT(relative_error(motion.q.displacement, u), 1e-11);
  }
}

// M_ff a_f = f_f - M_fp a_p: with a consistent mass the motion of held nodes pulls on their neighbours.
TEST(SemiExplicitEuler, PrescribedAccelerationActsThroughTheConsistentMass) {
  constexpr double h = 1e-3;
  System system = free_cube({0, 0, -10}, false);
  Motion<double> motion = random_motion(system);
  for (const std::int32_t i : {0, 5, 13})
    system.prescribed.set(i, Vec(motion.q.point(i)) + Vec(1e-3, -2e-3, 3e-3));
  system.prescribed.set(20, 1, 0.01);
  Vector<double> to_go(system.size());
  (void)system.prescribed.increment(motion.q, to_go);
  const Vector<double> f = -bodies::gradient(system, motion.q);
  Eigen::MatrixXd A = dense_mass(system);
  Vector<double> b = f;
  for (std::ptrdiff_t k = 0; k < b.size(); ++k) {
    if (system.prescribed.free()[k] == 1) continue;
    A.row(k).setZero();
    A(k, k) = 1;
    b[k] = k % 4 == 3 ? 0 : (to_go[k] / h - motion.v[k]) / h;
  }
  const Vector<double> v = motion.v + h * A.partialPivLu().solve(b);
  SemiExplicitEuler<System> euler({.dt = h});
  ASSERT_EQ(euler.step(system, motion).status, Status::converged);
  EXPECT_LT(relative_error(motion.v, v), 1e-10);
}

TEST(SemiExplicitEuler, MovingNodesReachTheirTargetsEveryStep) {
  constexpr double h = 1e-3;
  for (const bool lumped : {true, false}) {
    System system = free_cube({0, 0, -10}, lumped);
    Motion<double> motion(system.rest().size());
    SemiExplicitEuler<System> euler({.dt = h});
    for (int k = 1; k <= 50; ++k) {
      const Vec target(0.1 * std::sin(0.1 * k), 1e-3 * k, 0);
      for (const std::int32_t i : {0, 1, 2}) system.prescribed.set(i, target);
      const Vec before = motion.q.point(1);
      ASSERT_EQ(euler.step(system, motion).status, Status::converged);
      for (std::ptrdiff_t i = 0; i < 3; ++i) EXPECT_LT((motion.q.point(i) - target).norm(), 1e-15);
      EXPECT_LT((block(motion.v, 1) - (target - before) / h).norm(), 1e-12);
    }
  }
}

// ---------------------------------------------------------------- stability

using Linear = softsim::System<softsim::ElasticTetrahedra<softsim::LinearElastic>>;

Linear one_tetrahedron(const std::array<Vec, 4>& X, double poisson) {
  const TetrahedralMesh mesh({X.begin(), X.end()}, {{0, 1, 2, 3}});
  Linear system(mesh, softsim::elastic(mesh, softsim::LinearElastic::from_young_poisson(1, poisson)));
  system.mass = Mass<double>::lumped(mesh, 1);
  return system;
}

// 2/omega_max from the eigenvalues of K and M.
double critical_step(const Linear& system) {
  softsim::AssembledTangent<Linear> tangent;
  tangent.set(system, State<double>(system.rest().size()), {});
  const Eigen::MatrixXd K = tangent.matrix().to_eigen();
  const Eigen::MatrixXd M = softsim::pack(system.mass.diagonal()).asDiagonal();
  return 2 /
         std::sqrt(Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd>(K, M).eigenvalues().maxCoeff());
}

const std::array<Vec, 4> right_angled{Vec(0, 0, 0), Vec(1, 0, 0), Vec(0, 1, 0), Vec(0, 0, 1)};

// Critical steps of one tetrahedron with E = 1 Pa and 1 kg/m^3, to seven digits.
TEST(CriticalStep, OfOneTetrahedronIsThatOfItsEigenvalues) {
  const double h = std::sqrt(3) / 2;
  const std::array<Vec, 4> regular{Vec(0, 0, 0), Vec(1, 0, 0), Vec(0.5, h, 0),
                                   Vec(0.5, h / 3, std::sqrt(2.0 / 3))};
  EXPECT_NEAR(critical_step(one_tetrahedron(regular, 0)), 0.70710678, 1e-7);
  EXPECT_NEAR(critical_step(one_tetrahedron(regular, 0.3)), 0.44721360, 1e-7);
  EXPECT_NEAR(critical_step(one_tetrahedron(regular, 0.49)), 0.1, 1e-7);
  EXPECT_NEAR(critical_step(one_tetrahedron(right_angled, 0.3)), 0.40714503, 1e-7);
}

TEST(SemiExplicitEuler, IsStableBelowTheCriticalStepAndNotAbove) {
  const Linear system = one_tetrahedron(right_angled, 0.3);
  const double critical = critical_step(system);
  for (const double part : {0.98, 1.02}) {
    Motion<double> motion(4);
    motion.q = bodies::random_state(4, 1e-3, 5);
    SemiExplicitEuler<Linear> euler({.dt = part * critical});
    double largest = 0;
    for (int k = 0; k < 20000 && largest < 1e6; ++k) {
      ASSERT_EQ(euler.step(system, motion).status, Status::converged);
      largest = std::max(largest, motion.q.displacement.cwiseAbs().maxCoeff());
    }
    if (part < 1) {
      EXPECT_LT(largest, 0.02);  // the start, 1e-3 in each component, times (1 - 0.98^2)^-1/2 = 5 in a mode
    } else {
      EXPECT_GE(largest, 1e6);
    }
  }
}

// ---------------------------------------------------------------- failures

TEST(SemiExplicitEuler, ReportsAStepThatIsTooLargeAndLeavesTheMotion) {
  const System system = free_cube();
  Motion<double> motion = random_motion(system);
  SemiExplicitEuler<System> euler({.dt = 0.1});
  Status status = Status::converged;
  for (int k = 0; k < 1000 && status == Status::converged; ++k) {
    const Motion<double> before = motion;
    const softsim::StepReport report = euler.step(system, motion);
    status = report.status;
    if (status == Status::converged) continue;
    EXPECT_EQ(status, Status::not_finite);
    EXPECT_NE(report.reason, "");
    EXPECT_EQ(motion.q.displacement, before.q.displacement);
    EXPECT_EQ(motion.v, before.v);
    EXPECT_EQ(motion.time, before.time);
    EXPECT_TRUE(motion.q.displacement.allFinite() && motion.v.allFinite());
  }
  EXPECT_EQ(status, Status::not_finite);
}

TEST(SemiExplicitEuler, ReportsAFreePointWithoutMass) {
  System system = free_cube({0, 0, -10});
  system.mass = Mass<double>(system.rest().size());
  Motion<double> motion(system.rest().size());
  SemiExplicitEuler<System> euler({.dt = 1e-3});
  const softsim::StepReport report = euler.step(system, motion);
  EXPECT_EQ(report.status, Status::not_finite);
  EXPECT_EQ(report.reason, "the velocity is not finite: the step is too large, or a free point has no mass");
  EXPECT_EQ(motion.q.displacement.norm() + motion.v.norm() + motion.time, 0);
}

TEST(SemiExplicitEuler, ReportsAMassSolveThatRunsOut) {
  const System system = free_cube({0, 0, -10}, false);
  Motion<double> motion = random_motion(system);
  SemiExplicitEuler<System> euler({.dt = 1e-3, .linear = {.max_iterations = 2, .tolerance = 1e-12}});
  const softsim::StepReport report = euler.step(system, motion);
  EXPECT_EQ(report.status, Status::not_converged);
  EXPECT_EQ(report.linear_iterations, 2);
  EXPECT_GT(report.residual, 1e-12);
  EXPECT_NE(report.reason, "");
}

TEST(SemiExplicitEuler, RefusesStepsByValue) {
  const double inf = std::numeric_limits<double>::infinity();
  const auto said = [](double dt) { return refusal([=] { return SemiExplicitEuler<System>({.dt = dt}); }); };
  EXPECT_EQ(said(0), "dt 0 s: must be positive and finite");
  EXPECT_EQ(said(-0.01), "dt -0.01 s: must be positive and finite");
  EXPECT_EQ(said(inf), "dt inf s: must be positive and finite");
  EXPECT_EQ(said(nan), "dt nan s: must be positive and finite");
}

}  // namespace semi_explicit_euler_test
