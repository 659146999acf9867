// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/integrator/stable_step.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>

#include "potential/bodies.hpp"
#include "softsim/integrator/adaptive_runge_kutta.hpp"
#include "softsim/integrator/implicit.hpp"
#include "softsim/integrator/runge_kutta.hpp"
#include "softsim/integrator/semi_explicit_euler.hpp"
#include "softsim/integrator/velocity_verlet.hpp"
#include "softsim/material/linear_elastic.hpp"
#include "softsim/mesh/selection.hpp"
#include "softsim/potential/elastic.hpp"
#include "softsim/solver/element_eigenvalue_bound.hpp"
#include "softsim/system/tangent.hpp"

namespace stable_step_test {

using bodies::Vec, bodies::refusal;
using softsim::ButcherTableau, softsim::Mass, softsim::Motion, softsim::Rayleigh, softsim::RungeKutta,
    softsim::State, softsim::Status, softsim::TetrahedralMesh, softsim::Vector, softsim::stable_step;
using System = softsim::System<softsim::ElasticTetrahedra<softsim::LinearElastic>>;
using Euler = softsim::SemiExplicitEuler<System>;
using Verlet = softsim::VelocityVerlet<System>;

const double inf = std::numeric_limits<double>::infinity();

const softsim::ConjugateGradient precise{.max_iterations = 500, .tolerance = 1e-14};

RungeKutta<System> make(const ButcherTableau& tableau, double dt = 1) {
  return RungeKutta<System>({.dt = dt, .tableau = tableau, .linear = precise});
}

System body(const TetrahedralMesh& mesh, double E, double poisson) {
  System system(mesh, softsim::elastic(mesh, softsim::LinearElastic::from_young_poisson(E, poisson)));
  system.mass = Mass<double>::lumped(mesh, 1);
  return system;
}

// ---------------------------------------------------------------- what the members say is what steps do

// A cube held at one face and moving in one mode is one oscillator: a step is a 2x2 matrix, whose eigenvalues
// grow as the integrator says.
TEST(SpectralRadius, IsThatOfAStep) {
  const TetrahedralMesh mesh = bodies::distorted_cube(2, 1);
  for (const bool lumped : {true, false}) {
    System system = body(mesh, 100, 0.3);
    if (!lumped) system.mass = Mass<double>::consistent(mesh, 1);
    softsim::AssembledTangent<System> K, M;
    const State<double> rest(mesh.points().size());
    K.set(system, rest, {});
    M.set(system, rest, {.mass = 1, .stiffness = 0});
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> eigen(K.matrix().to_eigen(),
                                                                          M.matrix().to_eigen());
    const double omega = std::sqrt(eigen.eigenvalues()[20]);
    const Vector<double> mode = softsim::unpack(Vector<double>(eigen.eigenvectors().col(20)));
    const double length = mode.squaredNorm();
    const auto expect = [&](auto integrator, double h) {
      Eigen::Matrix2d A;
      double outside = 0;
      for (int column = 0; column < 2; ++column) {
        Motion<double> motion(mesh.points().size());
        (column == 0 ? motion.q.displacement : motion.v) = column == 0 ? mode : Vector<double>(mode / h);
        if constexpr (requires { integrator.set_dt(h); }) integrator.set_dt(h);  // an adaptive one has grown
        ASSERT_EQ(integrator.step(system, motion).status, Status::converged);
        A(0, column) = motion.q.displacement.dot(mode) / length;
        A(1, column) = h * motion.v.dot(mode) / length;
        outside = std::max(outside, (motion.q.displacement - A(0, column) * mode).norm());
      }
      const double xi = system.damping.alpha / (2 * omega) + system.damping.beta * omega / 2;
      const double measured = A.eigenvalues().cwiseAbs().maxCoeff();
      EXPECT_LT(outside, 1e-9 * mode.norm() * (1 + measured));
      EXPECT_NEAR(integrator.spectral_radius(omega * h, xi), measured, 1e-10 * (1 + measured)) << omega * h;
    };
    for (const double Omega : {0.2, 1.1, 2.9})
      for (const auto& damping :
           {Rayleigh{0, 0}, Rayleigh{0.2 * omega, 0.3 / omega}, Rayleigh{0, 3 / omega}}) {
        system.damping = damping;
        const double h = Omega / omega;
        expect(Euler({.dt = h}), h);
        expect(Verlet({.dt = h}), h);
        expect(softsim::ExplicitEuler<System>({.dt = h}), h);
        for (const auto& t : {ButcherTableau::midpoint(), ButcherTableau::kutta3(), ButcherTableau::rk4(),
                              ButcherTableau::dormand_prince()})
          expect(make(t, h), h);
        expect(softsim::AdaptiveRungeKutta<System>(
                   {.dt = h, .position_tolerance = 1e9, .velocity_tolerance = 1e9, .linear = precise}),
               h);
        expect(softsim::BackwardEuler<System>({.dt = h, .tolerance = 1e-13}), h);
      }
  }
}

// ---------------------------------------------------------------- steps without a system

TEST(StableStep, WithoutDampingIsTheLimitOfTheMethod) {
  const auto limit = [](const auto& integrator) { return 100 * stable_step(100, {}, integrator); };
  EXPECT_NEAR(limit(Euler({.dt = 1})), 2, 1e-9);
  EXPECT_NEAR(limit(Verlet({.dt = 1})), 2, 1e-9);
  EXPECT_NEAR(limit(make(ButcherTableau::rk4())), std::sqrt(8), 1e-9);
  EXPECT_NEAR(limit(make(ButcherTableau::kutta3())), std::sqrt(3), 1e-9);
  EXPECT_NEAR(limit(make(ButcherTableau::bogacki_shampine())), std::sqrt(3), 1e-9);
  EXPECT_GT(limit(make(ButcherTableau::dormand_prince())), 0.5);
  EXPECT_EQ(limit(make(ButcherTableau::explicit_euler())), 0);
  EXPECT_EQ(limit(make(ButcherTableau::midpoint())), 0);
  EXPECT_EQ(limit(make(ButcherTableau::heun())), 0);
  EXPECT_EQ(limit(softsim::BackwardEuler<System>({.dt = 1})), inf);
}

TEST(StableStep, WithDampingHoldsForAllFrequencies) {
  constexpr double omega = 50;
  for (const double xi : {0.001, 0.1, 0.5, 1.0}) {
    const double formula = 2 * (std::sqrt(1 + xi * xi) - xi) / omega;
    EXPECT_NEAR(stable_step(omega, {.alpha = 0, .beta = 2 * xi / omega}, Euler({.dt = 1})), formula,
                1e-9 * formula);
    EXPECT_NEAR(stable_step(omega, {.alpha = 2 * xi * omega, .beta = 0}, Euler({.dt = 1})), formula,
                1e-9 * formula);
    if (xi == 1) continue;
    // explicit Euler: Omega < 2 xi for each frequency, hence h < beta for all of them and, with alpha, h <
    // alpha/omega_max^2
    const auto explicit_euler = make(ButcherTableau::explicit_euler());
    EXPECT_NEAR(stable_step(omega, {.alpha = 0, .beta = 2 * xi / omega}, explicit_euler), 2 * xi / omega,
                1e-6 * xi);
    EXPECT_NEAR(stable_step(omega, {.alpha = 2 * xi * omega, .beta = 0}, explicit_euler), 2 * xi / omega,
                1e-6 * xi);
  }
  // A little damping makes RK2 stable up to about (8 xi)^(1/3).
  const double h = stable_step(omega, {.alpha = 0, .beta = 2e-4 / omega}, make(ButcherTableau::midpoint()));
  EXPECT_NEAR(omega * h, std::cbrt(8e-4), 0.01 * std::cbrt(8e-4));
  // Critical and stronger beta damping with an explicit method: the fast real root of the highest frequency
  // alone would allow 2/(xi + sqrt(xi^2 - 1)), and lower frequencies nothing less.
  EXPECT_NEAR(
      omega * stable_step(omega, {.alpha = 0, .beta = 4 / omega}, make(ButcherTableau::explicit_euler())),
      2 / (2 + std::sqrt(3)), 1e-9);
  EXPECT_EQ(stable_step(omega, {.alpha = 3, .beta = 0.1}, softsim::BackwardEuler<System>({.dt = 1})), inf);
}

// A method that is stable up to the highest frequency but not at half of it is caught there.
TEST(StableStep, LooksAtLowerFrequenciesToo) {
  struct Gap {
    double spectral_radius(double Omega, double xi) const { return xi < 0.02 && Omega > 0.5 ? 1.1 : 1; }
  };
  // xi = beta omega/2: 0.05 at the top, below 0.02 from 0.4 of it down
  const double h = stable_step(10, {.alpha = 0, .beta = 0.01}, Gap{});
  EXPECT_NEAR(10 * h, 0.5 / 0.4, 0.1 * 0.5 / 0.4);
}

TEST(StableStep, RefusesByValue) {
  const auto said = [](double omega, const Rayleigh& damping) {
    return refusal([&] { return stable_step(omega, damping, Euler({.dt = 1})); });
  };
  EXPECT_EQ(said(0, {}), "omega_max 0 1/s: must be positive and finite");
  EXPECT_EQ(said(inf, {}), "omega_max inf 1/s: must be positive and finite");
  EXPECT_EQ(said(1, {-1, 0}), "alpha -1 1/s: must be at least 0 and finite");
  EXPECT_EQ(said(1, {0, -1}), "beta -1 s: must be at least 0 and finite");
}

// ---------------------------------------------------------------- of meshes

// Critical steps of one tetrahedron with E = 1 Pa and 1 kg/m^3, to eight digits.
TEST(StableStep, OfOneTetrahedron) {
  const double r = std::sqrt(3) / 2;
  const std::array<Vec, 4> regular{Vec(0, 0, 0), Vec(1, 0, 0), Vec(0.5, r, 0),
                                   Vec(0.5, r / 3, std::sqrt(2.0 / 3))},
      right_angled{Vec(0, 0, 0), Vec(1, 0, 0), Vec(0, 1, 0), Vec(0, 0, 1)},
      sliver{Vec(0, 0, 0), Vec(1, 0, 0), Vec(0, 1, 0), Vec(1, 1, 0.02)};
  const auto expect = [](const std::array<Vec, 4>& X, double poisson, double step) {
    const TetrahedralMesh mesh({X.begin(), X.end()}, {{0, 1, 2, 3}});
    const System system = body(mesh, 1, poisson);
    const State<double> q(4);
    EXPECT_NEAR(stable_step(system, q, Euler({.dt = 1})), step, 2e-8) << poisson;
    EXPECT_NEAR(2 / std::sqrt(softsim::element_eigenvalue_bound(system, q)), step, 2e-8) << poisson;
  };
  expect(regular, 0, 0.70710678);
  expect(regular, 0.3, 0.44721360);
  expect(regular, 0.45, 0.22360680);
  expect(regular, 0.49, 0.1);
  expect(regular, 0.499, 0.03162278);
  expect(right_angled, 0.3, 0.40714503);
  expect(sliver, 0.3, 0.00861790);
}

// At 0.98 of the stable step a motion stays bounded, at 1.02 it does not.
TEST(StableStep, IsWhereRunsStartToGrow) {
  const TetrahedralMesh mesh = bodies::distorted_cube(2, 1);
  const auto expect_edge = [&](System& system, auto make_one) {
    const double h = stable_step(system, State<double>(mesh.points().size()), make_one(1.0));
    ASSERT_GT(h, 0);
    ASSERT_LT(h, 1);
    for (const double part : {0.98, 1.02}) {
      Motion<double> motion(mesh.points().size());
      motion.q = bodies::random_state(mesh.points().size(), 1e-3, 5);
      system.prescribed.mask(motion.q.displacement);
      auto integrator = make_one(part * h);
      double largest = 0;
      for (int k = 0; k < 2000 && largest < 1e3; ++k) {
        ASSERT_EQ(integrator.step(system, motion).status, Status::converged);
        largest = std::max(largest, motion.q.displacement.cwiseAbs().maxCoeff());
      }
      if (part < 1) {
        EXPECT_LT(largest, 0.05);  // (1 - 0.98^2)^(-1/2) = 5 times the start in a mode
      } else {
        EXPECT_GE(largest, 1e3);
      }
    }
  };
  for (const bool lumped : {true, false})
    for (const auto& damping : {Rayleigh{0, 0}, Rayleigh{2, 0.002}}) {
      System system = body(mesh, 100, 0.3);
      if (!lumped) system.mass = Mass<double>::consistent(mesh, 1);
      system.prescribed.fix(softsim::nodes_near(mesh, softsim::Side::zmin, 0));
      system.damping = damping;
      expect_edge(system, [](double h) { return Euler({.dt = h}); });
      expect_edge(system, [](double h) { return Verlet({.dt = h}); });
      expect_edge(system, [](double h) { return make(ButcherTableau::rk4(), h); });
      if (damping.beta == 0) continue;
      system.damping.beta = 0.02;  // of the order of its step: it then grows by some 1 % a step
      expect_edge(system, [](double h) { return make(ButcherTableau::explicit_euler(), h); });
    }
}

TEST(StableStep, OfASystemWithoutStiffness) {
  const TetrahedralMesh mesh = bodies::distorted_cube(1, 1);
  System system = body(mesh, 100, 0.3);
  for (std::int32_t i = 0; i < 8; ++i) system.prescribed.set(i, Vec::Zero());
  EXPECT_EQ(stable_step(system, State<double>(8), Euler({.dt = 1})), inf);
}

}  // namespace stable_step_test
