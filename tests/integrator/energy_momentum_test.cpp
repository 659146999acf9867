// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/integrator/energy_momentum.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <tuple>

#include "potential/bodies.hpp"
#include "softsim/integrator/implicit.hpp"
#include "softsim/softsim.hpp"

namespace energy_momentum_test {

using bodies::Matrix, bodies::Vec;
using softsim::Mass, softsim::Motion, softsim::State, softsim::Status, softsim::Vector;
template <class Law>
using Body = softsim::System<softsim::ElasticTetrahedra<Law>, softsim::DeadLoad<double>>;

template <class Law>
Body<Law> free_cube(const Law& law, const Vec& g = Vec::Zero()) {
  const auto mesh = bodies::distorted_cube(2, 1);
  Body<Law> system(mesh, softsim::elastic(mesh, law), softsim::gravity(mesh, 1, g));
  system.mass = Mass<double>::lumped(mesh, 1);
  return system;
}

template <class System>
Motion<double> tumbling(const System& system) {
  Motion<double> motion(system.rest().size());
  motion.q = bodies::random_state(system.rest().size(), 0.03, 2);
  motion.v = bodies::random_vector(system.rest().size(), 0.5, 3);
  for (std::size_t i = 0; i < system.rest().size(); ++i)
    softsim::block(motion.v, static_cast<std::ptrdiff_t>(i)) +=
        Vec(1, 2, 3) + Vec(0, 3, -1).cross(system.rest()[i]);
  return motion;
}

// ---------------------------------------------------------------- the discrete gradient of one element

template <class Law>
void expect_discrete_stress(const Law& law, double objective_tolerance) {
  bodies::Random random(5);
  for (const double size : {0.2, 1e-3, 1e-5}) {
    const Matrix F_0 = Matrix::Identity() + 0.2 * random.matrix(), F_1 = F_0 + size * random.matrix();
    const Matrix P = softsim::discrete_stress(law, F_0, F_1), dF = F_1 - F_0;
    const double change = law.energy_density(F_1) - law.energy_density(F_0);
    EXPECT_NEAR(softsim::double_dot(P, dF), change, 1e-14 * law.energy_density(F_0) + 1e-15);
    const Matrix R = random.rotation(),
                 turned = softsim::discrete_stress(law, Matrix(R * F_0), Matrix(R * F_1));
    // the correction divides the rounding of the energies by |dE|
    const double tolerance = objective_tolerance + 1e-15 / size;
    EXPECT_LT((turned - R * P).norm(), tolerance * P.norm());
    const Matrix F_m = 0.5 * (F_0 + F_1), S = F_m.inverse() * P;
    EXPECT_LT((S - S.transpose()).norm(), tolerance * S.norm());
    // second order: the stress at the middle
    EXPECT_LT((P - law.first_piola(F_m)).norm(),
              3 * size * size * law.first_piola_differential(F_m, Matrix::Identity().eval()).norm());
  }
  // A rotation does no work and has no stress, however large.
  const Matrix R = random.rotation();
  EXPECT_LT(softsim::discrete_stress(law, Matrix(Matrix::Identity()), R).norm(), objective_tolerance * 100);
}

TEST(DiscreteStress, DoesTheWorkOfTheEnergyAndTurnsWithTheBody) {
  expect_discrete_stress(softsim::NeoHookean::from_young_poisson(10, 0.3), 1e-12);
  expect_discrete_stress(softsim::StVenantKirchhoff::from_young_poisson(10, 0.3), 1e-12);
  expect_discrete_stress(softsim::MooneyRivlin::from_young_poisson(10, 0.3, 0.5), 1e-12);
}

TEST(DiscreteStress, OfALawThatIsNotObjectiveDoesItsWorkToo) {
  const auto law = softsim::LinearElastic::from_young_poisson(10, 0.3);
  bodies::Random random(6);
  const Matrix F_0 = Matrix::Identity() + 0.2 * random.matrix(), F_1 = F_0 + 0.1 * random.matrix();
  EXPECT_NEAR(softsim::double_dot(softsim::discrete_stress(law, F_0, F_1), Matrix(F_1 - F_0)),
              law.energy_density(F_1) - law.energy_density(F_0), 1e-14);
}

TEST(DiscreteStress, OfSpringsDoesTheWorkOfTheirEnergy) {
  const auto check = [](const auto& spring) {
    const auto data = softsim::SpringLink::make(Vec(0, 0, 0), Vec(1, 0.2, 0), 7);
    const softsim::Local<double, 2> u_0{{Vec(0, 0, 0), Vec(0.1, 0.2, 0.3)}},
        u_1{{Vec(0.1, 0, 0), Vec(-0.3, 0.2, 0.4)}};
    const auto f = spring.discrete_gradient(data, u_0, u_1);
    double work = 0;
    for (int i = 0; i < 2; ++i)
      work += f.template segment<3>(3 * i).dot(u_1.points[static_cast<std::size_t>(i)] -
                                               u_0.points[static_cast<std::size_t>(i)]);
    EXPECT_NEAR(work, spring.energy(data, u_1) - spring.energy(data, u_0), 1e-15);
    const auto at = spring.discrete_gradient(data, u_0, u_0);
    EXPECT_LT((at - spring.gradient(data, u_0)).norm(), 1e-15);
  };
  check(softsim::Spring());
  check(softsim::SquaredLengthSpring());
}

// ---------------------------------------------------------------- what the scheme keeps

template <class Law>
void expect_conserved(const Law& law, double dt, int steps) {
  const auto system = free_cube(law);
  Motion<double> motion = tumbling(system);
  const auto energy = [&] { return system.energy(motion.q) + system.kinetic_energy(motion.v); };
  const double before = energy();
  const auto start = system.momentum(motion);
  softsim::EnergyMomentum<Body<Law>> integrator({.dt = dt, .tolerance = 1e-12});
  for (int k = 0; k < steps; ++k) {
    const auto report = integrator.step(system, motion);
    ASSERT_EQ(report.status, Status::converged) << k << " " << report.reason << " " << report.residual;
  }
  const auto end = system.momentum(motion);
  // what Newton's method leaves of every step, added up in the worst case
  EXPECT_NEAR(energy() / before, 1, 1e-12 * steps);
  EXPECT_LT((end.linear - start.linear).norm(), 1e-12 * steps * start.linear.norm());
  EXPECT_LT((end.angular - start.angular).norm(),
            1e-12 * steps * (start.angular.norm() + start.linear.norm()));
}

// The cube turns by a tenth of a radian in a step; its fastest wave takes half a step through an element.
TEST(EnergyMomentum, KeepsEnergyAndMomentaWithLargeSteps) {
  expect_conserved(softsim::NeoHookean::from_young_poisson(100, 0.3), 0.03, 1000);
  expect_conserved(softsim::StVenantKirchhoff::from_young_poisson(100, 0.3), 0.03, 300);
}

// The implicit midpoint rule, which differs by the correction alone, keeps the momenta but not the energy.
TEST(EnergyMomentum, KeepsWhatTheMidpointRuleLoses) {
  const auto law = softsim::NeoHookean::from_young_poisson(100, 0.3);
  const auto system = free_cube(law);
  Motion<double> motion = tumbling(system);
  const double before = system.energy(motion.q) + system.kinetic_energy(motion.v);
  softsim::ImplicitMidpoint<Body<softsim::NeoHookean>> midpoint(
      {.dt = 0.03, .newton = true, .tolerance = 1e-12});
  double worst = 0;
  for (int k = 0; k < 100; ++k) {
    ASSERT_NE(midpoint.step(system, motion).status, Status::not_finite);
    worst = std::max(worst,
                     std::abs(system.energy(motion.q) + system.kinetic_energy(motion.v) - before) / before);
  }
  EXPECT_GT(worst, 1e-4);
}

// With gravity and a held face: the sum of kinetic, elastic and gravity's energy.
TEST(EnergyMomentum, KeepsTheEnergyOfAHeldBodyUnderGravity) {
  auto system = free_cube(softsim::NeoHookean::from_young_poisson(100, 0.3), Vec(0, 0, -9.81));
  for (std::size_t i = 0; i < system.rest().size(); ++i)
    if (system.rest()[i][0] < 1e-9) system.prescribed.set(static_cast<std::int32_t>(i), Vec::Zero());
  Motion<double> motion(system.rest().size());
  softsim::EnergyMomentum<Body<softsim::NeoHookean>> integrator({.dt = 0.02, .tolerance = 1e-12});
  double largest = 0;
  for (int k = 0; k < 300; ++k) {
    const auto report = integrator.step(system, motion);
    ASSERT_EQ(report.status, Status::converged) << report.reason;
    const double kinetic = system.kinetic_energy(motion.v);
    largest = std::max(largest, kinetic);
    EXPECT_NEAR(system.energy(motion.q) + kinetic, 0, 1e-10 * largest) << k;
  }
}

TEST(EnergyMomentum, IsOfSecondOrder) {
  const auto system = free_cube(softsim::NeoHookean::from_young_poisson(100, 0.3));
  const auto after = [&](int steps) {
    Motion<double> motion = tumbling(system);
    softsim::EnergyMomentum<Body<softsim::NeoHookean>> integrator({.dt = 0.1 / steps, .tolerance = 1e-12});
    for (int k = 0; k < steps; ++k) EXPECT_EQ(integrator.step(system, motion).status, Status::converged);
    return motion.q.displacement;
  };
  const Vector<double> a = after(80), b = after(160), c = after(320);
  EXPECT_NEAR(std::log2((a - b).norm() / (b - c).norm()), 2, 0.1);
}

TEST(EnergyMomentum, LeavesTheMotionIfItIsNotFinite) {
  const auto system = free_cube(softsim::NeoHookean::from_young_poisson(100, 0.3));
  Motion<double> motion = tumbling(system);
  motion.v[5] = std::nan("");
  const Vector<double> before = motion.q.displacement;
  softsim::EnergyMomentum<Body<softsim::NeoHookean>> integrator({.dt = 0.01});
  const auto report = integrator.step(system, motion);
  EXPECT_EQ(report.status, Status::not_finite);
  EXPECT_EQ(motion.q.displacement, before);
  EXPECT_NE(
      bodies::refusal([] { softsim::EnergyMomentum<Body<softsim::NeoHookean>>({.dt = -1}); }).find("dt -1 s"),
      std::string::npos);
}

}  // namespace energy_momentum_test
