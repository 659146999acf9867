// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <string>
#include <utility>

#include "../../bench/stability/largest_step.hpp"
#include "../../bench/stability/oscillator.hpp"
#include "softsim/material/neo_hookean.hpp"
#include "softsim/mesh/selection.hpp"

// What the stability atlas claims about time steps, in small.

namespace time_steps_test {

using namespace softsim;
using atlas::Oscillator, atlas::ContractiveBody;

// The step of every integrator is the one that its spectral radius speaks of, everywhere in the left half
// plane.
TEST(TimeSteps, GrowAsTheirStabilityFunctionsSay) {
  Oscillator body;
  int points = 0;
  atlas::for_each_integrator<atlas::LinearSystem>([&](const std::string& name, auto integrator,
                                                      bool is_explicit) {
    for (int i = 0; i < 8; ++i)
      for (int j = 1; j < 8; ++j) {
        const std::complex<double> z = (is_explicit ? 1.0 : 4.0) * std::complex<double>(-0.53 * i, 0.55 * j);
        const double Omega = std::abs(z), xi = -z.real() / Omega;
        const double predicted = integrator.spectral_radius(Omega, xi);
        // 1e-8 off double roots, beside which an error e of the matrix is one of sqrt(e)
        EXPECT_NEAR(atlas::measured_growth(body, integrator, Omega, xi), predicted,
                    1e-6 * std::max(1.0, predicted))
            << name << " at " << z;
        ++points;
      }
  });
  EXPECT_EQ(points, 21 * 56);
}

// Table 3.3 of d'Aulignac 2001: A-stable means that no z in the left half plane grows, L-stable that z = -1e6
// is gone in a step.
TEST(TimeSteps, AreAStableAndLStableAsPromised) {
  Oscillator body;
  atlas::for_each_integrator<atlas::LinearSystem>(
      [&](const std::string& name, auto integrator, bool is_explicit) {
        double most = 0;
        for (int i = 0; i <= 32; ++i)
          for (const double xi : {0.0, 0.01, 0.3, 1.0, 3.0})
            most = std::max(most, integrator.spectral_radius(std::pow(10.0, -2 + i / 4.0), xi));
        const bool a_stable = !is_explicit && name != "theta 0.4";
        EXPECT_EQ(most <= 1 + 1e-12, a_stable) << name << ' ' << most;
        if (is_explicit) return;
        const double far = atlas::measured_growth(body, integrator, 1e6, 1);
        const bool l_stable = name == "backward Euler" || name == "BDF2" || name == "generalised-alpha 0";
        EXPECT_EQ(far < 0.01, l_stable) << name << ' ' << far;
      });
}

// B-stable: over a contractive nonlinear force no two motions move apart; the trapezoidal rule, and one
// linear solve a step, let some.
TEST(TimeSteps, KeepTwoMotionsTogetherWhereTheForceDoes) {
  using S = ContractiveBody::S;
  const ContractiveBody body;
  const auto worst = [&](auto scheme, bool newton) {
    Implicit<decltype(scheme), S> integrator(
        {.dt = 1, .scheme = scheme, .newton = newton, .tolerance = 1e-13});
    return atlas::contraction(body, integrator, 1000).growth;
  };
  EXPECT_LE(worst(Theta(), true), 1 + 1e-6);
  EXPECT_LE(worst(Theta{0.7}, true), 1 + 1e-6);
  EXPECT_LE(worst(Midpoint(), true), 1 + 1e-6);
  EXPECT_GT(worst(Trapezoidal(), true), 1.01);
  EXPECT_GT(worst(Midpoint(), false), 1.01);
}

// At 0.95 of the predicted step a small motion of a body stays bounded, at 1.05 it does not.
TEST(TimeSteps, AreStableUpToTheStableStep) {
  const auto mesh = box_mesh({2, 2, 2}, {1, 1, 1});
  using S = System<ElasticTetrahedra<NeoHookean>>;
  S system(mesh, elastic(mesh, NeoHookean::from_young_poisson(1e4, 0.4)));
  system.mass = Mass<double>::lumped(mesh, 1000);
  system.prescribed.fix(nodes_near(mesh, Side::zmin, 0));
  const State<double> rest(mesh.points().size());
  const double omega = largest_eigenvalue(system, rest).omega();
  const auto check = [&](const std::string& name, auto integrator) {
    const double h = stable_step(system, rest, integrator);
    ASSERT_GT(h, 0) << name;
    EXPECT_TRUE(atlas::stays_bounded(system, integrator, 0.95 * h, omega, 1e-9, 1500)) << name;
    EXPECT_FALSE(atlas::stays_bounded(system, integrator, 1.05 * h, omega, 1e-9, 1500)) << name;
  };
  for (const bool damped : {false, true}) {
    if (damped) system.damping = {omega / 4, 0.4 / omega};
    check("semi-explicit Euler", SemiExplicitEuler<S>({.dt = 1}));
    check("velocity Verlet", VelocityVerlet<S>({.dt = 1}));
    check("RK4", RungeKutta<S>({.dt = 1}));
    check("RK3", RungeKutta<S>({.dt = 1, .tableau = ButcherTableau::kutta3()}));
    if (!damped) continue;
    check("explicit Euler", ExplicitEuler<S>({.dt = 1}));
    check("RK2", RungeKutta<S>({.dt = 1, .tableau = ButcherTableau::midpoint()}));
  }
}

}  // namespace time_steps_test
