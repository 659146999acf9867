// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "potential/bodies.hpp"
#include "softsim/integrator/energy_momentum.hpp"
#include "softsim/integrator/implicit.hpp"
#include "softsim/integrator/runge_kutta.hpp"
#include "softsim/material/neo_hookean.hpp"
#include "softsim/mesh/generators.hpp"
#include "softsim/mesh/hexahedral_mesh.hpp"
#include "softsim/mesh/selection.hpp"
#include "softsim/potential/dead_load.hpp"
#include "softsim/potential/quadrature.hpp"
#include "softsim/system/system.hpp"

// One hexahedron of side 1 m, Neo-Hookean with E = 10 Pa, nu = 0, density 1 kg/m^3, with a consistent mass:
// its top moves as one mass of 1/3 kg on a nonlinear spring whose force is mu (s - 1/s) at the stretch s, mu
// = 5.

namespace one_element_test {

using bodies::Vec;
using softsim::Mass, softsim::Motion, softsim::Status;

template <class Function>
auto with_element(const Vec& body_force, Function f) {
  const auto mesh = softsim::box_hexahedra({1, 1, 1}, {1, 1, 1});
  softsim::System system(mesh, softsim::elastic(mesh, softsim::NeoHookean::from_young_poisson(10, 0)),
                         softsim::gravity(mesh, 1, body_force));
  system.mass = Mass<double>::consistent(mesh, 1);
  std::vector<std::int32_t> top;
  for (std::int32_t i = 0; i < 8; ++i) {
    system.prescribed.set(i, 0, 0.0);
    system.prescribed.set(i, 1, 0.0);
    if (mesh.points()[static_cast<std::size_t>(i)][2] > 0.5)
      top.push_back(i);
    else
      system.prescribed.set(i, 2, 0.0);
  }
  return f(system, top);
}

struct Swing {
  double smallest = 2, period = 0;
};
// From rest at the given stretch until it comes back: the second time that the velocity changes its sign.
template <class Integrator, class System>
Swing swing(const System& system, const std::vector<std::int32_t>& top, Integrator integrator,
            double stretch) {
  Motion<double> motion(8);
  for (const auto i : top) motion.q.point(i)[2] = stretch - 1;
  Swing result;
  double v_before = 0;
  int turns = 0;
  while (turns < 2 && motion.time < 3) {
    const double t_before = motion.time, u_before = 1 + motion.q.point(top[0])[2];
    const auto report = integrator.step(system, motion);
    EXPECT_EQ(report.status, Status::converged) << report.reason;
    const double v = softsim::block(motion.v, top[0])[2], u = 1 + motion.q.point(top[0])[2];
    if (v_before * v < 0) {
      // at the turn the position is a parabola in time: v is linear
      const double part = v_before / (v_before - v), h = motion.time - t_before;
      if (++turns == 1)
        result.smallest = u_before + part * h * v_before / 2;
      else
        result.period = t_before + part * h;
      (void)u;
    }
    v_before = v;
  }
  return result;
}

// Stretches and periods by quadrature of the energy integral.
TEST(OneElement, SwingsAsTheEnergyIntegralSays) {
  with_element(Vec::Zero(), [](const auto& system, const auto& top) {
    using S = std::decay_t<decltype(system)>;
    struct Case {
      double stretch, smallest, period;
    };
    for (const Case c : {Case{1.1, 0.9032321957, 1.14622133}, Case{1.5, 0.5742817686, 1.12629569}}) {
      const auto expect_near = [&](const Swing& got, double tolerance) {
        EXPECT_NEAR(got.smallest / c.smallest, 1, tolerance);
        EXPECT_NEAR(got.period / c.period, 1, tolerance);
      };
      expect_near(swing(system, top, softsim::RungeKutta<S>({.dt = 2e-3}), c.stretch), 1e-5);
      expect_near(
          swing(system, top, softsim::ImplicitMidpoint<S>({.dt = 5e-3, .newton = true, .tolerance = 1e-10}),
                c.stretch),
          1e-3);
      expect_near(swing(system, top, softsim::EnergyMomentum<S>({.dt = 5e-3}), c.stretch), 1e-3);
      expect_near(swing(system, top,
                        softsim::Implicit<softsim::Bdf2, S>({.dt = 2e-3, .newton = true, .tolerance = 1e-10}),
                        c.stretch),
                  1e-3);
    }
  });
}

// FEBio's verification problem dy11: a unit body force downwards from t = 0 on, dt = 0.05 s, an
// energy-conserving scheme; after 4 s the top is at -0.0937535508 m (the trapezoidal rule: -0.0937322).
TEST(OneElement, MovesAsInAnotherCode) {
  with_element(Vec(0, 0, -1), [](const auto& system, const auto& top) {
    using S = std::decay_t<decltype(system)>;
    const auto after = [&](auto integrator) {
      Motion<double> motion(8);
      for (int k = 0; k < 80; ++k) EXPECT_EQ(integrator.step(system, motion).status, Status::converged);
      return motion.q.point(top[0])[2];
    };
    EXPECT_NEAR(after(softsim::EnergyMomentum<S>({.dt = 0.05})), -0.0937535508, 1e-3 * 0.0937535508);
    EXPECT_NEAR(
        after(softsim::Implicit<softsim::Trapezoidal, S>({.dt = 0.05, .newton = true, .tolerance = 1e-10})),
        -0.0937322, 1e-6);
  });
}

}  // namespace one_element_test
