// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <ostream>
#include <stdexcept>
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
#include "study.hpp"

// How much energy and angular momentum a free body of frames has after 200 s, 1e5 steps of 2 ms: a brick of
// 1.2 x 0.7 x 0.5 m between two frames, which tumbles about no principal axis, a turn in 2.3 s, while it
// bends and twists. Claims: integrators of second order are off by less than a hundredth in both, and with
// half the step by less than half (the motion is chaotic; over a few turns it is a quarter, see
// tests/integrator/frame_drift_test.cpp).

namespace {

using namespace softsim;
using V = Vec3<double>;

const FrameNodes nodes({V(0.3, 0.3, 0.25), V(0.9, 0.4, 0.2)});
constexpr double density = 100, young = 2e4;

FrameBody<2> brick() {
  std::vector<V> X;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 2; ++j)
      for (int k = 0; k < 2; ++k) X.emplace_back((i + 0.5) * 0.3, (j + 0.5) * 0.35, (k + 0.5) * 0.25);
  return {nodes, Shepard<>(nodes.frames()), X, std::vector<double>(X.size(), 0.42 / 16)};
}
auto tumbling() {
  const FrameBody<2> body = brick();
  System system(nodes, elastic(body, StVenantKirchhoff::from_young_poisson(young, 0.3)));
  system.mass = Mass<double>::lumped(body, density);
  return system;
}
using S = decltype(tumbling());

Motion<double> start(const S& system) {
  Motion<double> motion = system.rest_motion();
  Vector<double> d = Vector<double>::Zero(system.size());
  block(d, 1) = V(0.1, -0.05, 0.08);
  block(d, 2) = V(0.02, 0.01, -0.02);
  retract(motion.q, d);
  const V omega(1, 2, -1.5), centre(0.6, 0.35, 0.25);
  for (std::ptrdiff_t j = 0; j < 2; ++j) {
    const V x = system.rest()[static_cast<std::size_t>(2 * j)] + motion.q.translation(j);
    block(motion.v, 2 * j) = omega.cross(x - centre);
    block(motion.v, 2 * j + 1) = motion.q.rotation(j).transpose() * omega;
  }
  return motion;
}

double energy(const S& system, const Motion<double>& motion) {
  return system.energy(motion.q) + system.kinetic_energy(motion.q, motion.v);
}
// Worst relative errors of energy and angular momentum.
struct Errors {
  double energy = 0, momentum = 0;
};

// A row of the table every hundredth of the time.
template <class I>
Errors run(std::ostream& csv, const char* name, I integrator) {
  const S system = tumbling();
  Motion<double> motion = start(system);
  const double E = energy(system, motion), duration = 200;
  const V L = system.momentum(motion).angular;
  const int steps = static_cast<int>(std::lround(duration / integrator.dt()));
  Errors worst;
  for (int k = 1; k <= steps; ++k) {
    const StepReport report = integrator.step(system, motion);
    if (report.status != Status::converged)
      throw std::runtime_error(std::string(name) + ", step " + std::to_string(k) + ": " +
                               std::string(report.reason));
    if (k % 10 != 0) continue;
    const double off_E = energy(system, motion) / E - 1,
                 off_L = (system.momentum(motion).angular - L).norm() / L.norm();
    worst.energy = std::max(worst.energy, std::abs(off_E));
    worst.momentum = std::max(worst.momentum, off_L);
    if (k % (steps / 100) == 0)
      csv << name << ',' << integrator.dt() << ',' << k << ',' << motion.time << ',' << off_E << ',' << off_L
          << '\n';
  }
  std::printf("%-20s %8g %8d %12.2e %12.2e\n", name, integrator.dt(), steps, worst.energy, worst.momentum);
  return worst;
}

// Runs the steps of `sizes`, the largest first. True if the claims hold, which are those of second order.
template <class Make>
bool second_order(std::ostream& csv, const char* name, const std::vector<double>& sizes, Make make) {
  bool holds = true;
  Errors before;
  for (const double h : sizes) {
    const Errors errors = run(csv, name, make(h));
    if (h <= 0.002)
      holds &= errors.energy < 0.01 && errors.momentum < 0.01 && errors.energy < before.energy / 2 &&
               errors.momentum < before.momentum / 2;
    before = errors;
  }
  return holds;
}
template <class Scheme>
auto implicit(const Scheme& scheme) {
  return [=](double h) {
    return Implicit<Scheme, S, Assembled, BlockJacobi>(
        {.dt = h, .scheme = scheme, .newton = true, .tolerance = 1e-11});
  };
}

}  // namespace

int main(int argc, char** argv) {
  const std::string header = "integrator,dt_s,step,time_s,energy_error,angular_momentum_error";
  return study::run(argc, argv, "frame_dynamics", header, true, [](std::ostream& csv, bool long_form) {
    std::printf("worst relative errors in 200 s\n%-20s %8s %8s %12s %12s\n", "integrator", "dt, s", "steps",
                "energy", "ang. mom.");
    std::vector<double> sizes{0.004, 0.002};
    if (long_form) sizes.push_back(0.001);
    bool holds = true;
    for (const double h : sizes) run(csv, "semi_explicit_euler", SemiExplicitEuler<S>({.dt = h}));
    holds &=
        second_order(csv, "velocity_verlet", sizes, [](double h) { return VelocityVerlet<S>({.dt = h}); });
    holds &= second_order(csv, "implicit_midpoint", sizes, implicit(Midpoint()));
    holds &= second_order(csv, "newmark", sizes, implicit(NewmarkScheme()));
    holds &= second_order(csv, "generalised_alpha", sizes, implicit(GeneralisedAlphaScheme(0.8)));
    return holds;
  });
}
