// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "softsim/integrator/implicit.hpp"
#include "softsim/integrator/semi_explicit_euler.hpp"
#include "softsim/integrator/velocity_verlet.hpp"
#include "softsim/kinematics/frame_body.hpp"
#include "softsim/kinematics/shepard.hpp"
#include "softsim/material/st_venant_kirchhoff.hpp"
#include "softsim/potential/frame_elastic.hpp"
#include "softsim/system/system.hpp"

// Energy and momenta of bodies of frames that deform while they turn, over two thousand steps. Over 1e5
// steps: bench/studies/frame_dynamics.cpp.

namespace frame_drift_test {

using namespace softsim;
using Vec = Vector<double>;
using V = Vec3<double>;

// Two frames in a brick of 1.2 x 0.7 x 0.5 m.
const FrameNodes nodes({V(0.3, 0.3, 0.25), V(0.9, 0.4, 0.2)});
auto brick() {
  std::vector<V> X;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 2; ++j)
      for (int k = 0; k < 2; ++k) X.emplace_back((i + 0.5) * 0.3, (j + 0.5) * 0.35, (k + 0.5) * 0.25);
  const FrameBody<2> body(nodes, Shepard<>(nodes.frames()), X, std::vector<double>(X.size(), 0.42 / 16));
  System system(nodes, elastic(body, StVenantKirchhoff::from_young_poisson(2e4, 0.3)));
  system.mass = Mass<double>::lumped(body, 100);
  return system;
}
using S = decltype(brick());

double energy(const S& system, const Motion<double>& motion) {
  return system.energy(motion.q) + system.kinetic_energy(motion.q, motion.v);
}
// Takes so many steps of h, and calls `observe` after each.
struct Method {
  std::string name;
  int order;
  std::function<void(const S&, Motion<double>&, double h, int steps, const std::function<void()>& observe)>
      run;
};
template <class Make>
Method method(const std::string& name, int order, Make make) {
  return {name, order,
          [=](const S& system, Motion<double>& motion, double h, int steps,
              const std::function<void()>& observe) {
            auto integrator = make(h);
            for (int k = 0; k < steps; ++k) {
              const StepReport report = integrator.step(system, motion);
              ASSERT_EQ(report.status, Status::converged) << name << ", step " << k << ": " << report.reason;
              observe();
            }
          }};
}
template <class Scheme>
auto implicit(const Scheme& scheme) {
  return [=](double h) {
    return Implicit<Scheme, S, Assembled, BlockJacobi>(
        {.dt = h, .scheme = scheme, .newton = true, .tolerance = 1e-11});
  };
}
const std::vector<Method> methods{
    method("semi-explicit Euler", 1, [](double h) { return SemiExplicitEuler<S>({.dt = h}); }),
    method("velocity Verlet", 2, [](double h) { return VelocityVerlet<S>({.dt = h}); }),
    method("implicit midpoint", 2, implicit(Midpoint())),
    method("generalised-alpha", 2, implicit(GeneralisedAlphaScheme(0.8)))};

// Bent, twisted, and turning about no principal axis; the first frame may be on a hinge.
Motion<double> start(const S& system, bool hinged) {
  Motion<double> motion = system.rest_motion();
  Vec d = Vec::Zero(system.size());
  block(d, hinged ? 3 : 1) = V(0.1, -0.05, 0.08);
  block(d, 2) = V(0.02, 0.01, -0.02);
  retract(motion.q, d);
  const V omega = hinged ? V(0, 4, 0) : V(1, 2, -1.5),
          pivot = hinged ? nodes.frames()[0] : V(0.6, 0.35, 0.25);
  for (std::ptrdiff_t j = 0; j < 2; ++j) {
    const V x = nodes.frames()[static_cast<std::size_t>(j)] + motion.q.translation(j);
    block(motion.v, 2 * j) = omega.cross(x - pivot);
    block(motion.v, 2 * j + 1) = motion.q.rotation(j).transpose() * omega;
  }
  return motion;
}

// In the axes of frames none of these integrators keeps the angular momentum, as it would that of points:
// what is lost of it in a given time, and of energy, is an error of the integrator's order.
TEST(FrameDrift, FreeBody) {
  const S system = brick();
  for (const Method& m : methods) {
    std::array<double, 2> off_E{0, 0}, off_L{0, 0};
    for (std::size_t fine = 0; fine < 2; ++fine) {
      Motion<double> motion = start(system, false);
      const double E = energy(system, motion);
      const V L = system.momentum(motion).angular;
      const int steps = fine == 0 ? 1000 : 2000;
      m.run(system, motion, 2.0 / steps, steps, [&] {
        off_E[fine] = std::max(off_E[fine], std::abs(energy(system, motion) / E - 1));
        off_L[fine] = std::max(off_L[fine], (system.momentum(motion).angular - L).norm() / L.norm());
      });
    }
    EXPECT_NEAR(std::log2(off_E[0] / off_E[1]), m.order, 0.1) << m.name;
    EXPECT_NEAR(std::log2(off_L[0] / off_L[1]), m.order, 0.1) << m.name;
    RecordProperty(m.name, std::to_string(off_E[1]) + ' ' + std::to_string(off_L[1]));
  }
}

// A hinge keeps its frame, and its reactions do no work while the rest of the body swings and deforms.
TEST(FrameDrift, HingedBody) {
  S system = brick();
  system.prescribed.set(0, V::Zero());
  system.prescribed.hold_rotation(0, 0);
  system.prescribed.hold_rotation(0, 2);
  for (const Method& m : methods) {
    std::array<double, 2> off_E{0, 0};
    for (std::size_t fine = 0; fine < 2; ++fine) {
      Motion<double> motion = start(system, true);
      const double E = energy(system, motion);
      double off = 0;
      const int steps = fine == 0 ? 1000 : 2000;
      m.run(system, motion, 2.0 / steps, steps, [&] {
        const auto Q = motion.q.quaternion(0);
        off = std::max({off, std::abs(Q[0]), std::abs(Q[2]), motion.q.translation(0).norm()});
        off_E[fine] = std::max(off_E[fine], std::abs(energy(system, motion) / E - 1));
      });
      EXPECT_LT(off, 1e-15) << m.name;
    }
    EXPECT_NEAR(std::log2(off_E[0] / off_E[1]), m.order, 0.1) << m.name;
  }
}

}  // namespace frame_drift_test
