// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <gtest/gtest.h>

#include <cstddef>

#include "potential/bodies.hpp"
#include "softsim/material/neo_hookean.hpp"
#include "softsim/potential/dead_load.hpp"
#include "softsim/potential/elastic.hpp"
#include "softsim/solver/report.hpp"
#include "softsim/system/system.hpp"

/// Bodies and measures that the tests of explicit integrators share.
namespace moving_bodies {

using bodies::Vec;
using softsim::Mass, softsim::Motion, softsim::Status, softsim::Vector, softsim::block;
template <class T>
using SystemOf = softsim::System<softsim::ElasticTetrahedra<softsim::NeoHookean, T>, softsim::DeadLoad<T>>;
using System = SystemOf<double>;

/// A free cube of 1 m, E = 1000 Pa, 1 kg, 27 nodes: waves cross it in about 30 ms.
template <class T = double>
SystemOf<T> free_cube(const Vec& g = Vec::Zero(), bool lumped = true) {
  const softsim::TetrahedralMesh mesh = bodies::distorted_cube(2, 1);
  SystemOf<T> system(mesh, softsim::elastic<T>(mesh, softsim::NeoHookean::from_young_poisson(1000, 0.3)),
                     softsim::gravity<T>(mesh, 1, g));
  system.mass = lumped ? Mass<T>::lumped(mesh, 1) : Mass<T>::consistent(mesh, 1);
  return system;
}

/// A cube in flight, turning and deformed.
template <class T>
Motion<T> random_motion(const SystemOf<T>& system) {
  Motion<T> motion(system.rest().size());
  motion.q = bodies::random_state<T>(system.rest().size(), 0.03, 2);
  motion.v = bodies::random_vector<T>(system.rest().size(), 2, 3);
  for (std::size_t i = 0; i < system.rest().size(); ++i)
    block(motion.v, static_cast<std::ptrdiff_t>(i)) +=
        (Vec(1, 2, 3) + Vec(0, 3, -1).cross(system.rest()[i])).template cast<T>();
  return motion;
}

/// q and v after `steps` steps, velocities scaled by 1/100 s, one vector.
template <class Integrator, class S>
Vector<double> after(Integrator integrator, S& system, Motion<double> motion, int steps) {
  for (int k = 0; k < steps; ++k) EXPECT_EQ(integrator.step(system, motion).status, Status::converged);
  Vector<double> both(2 * motion.v.size());
  both << motion.q.displacement, 0.01 * motion.v;
  return both;
}

/// Steps until one fails; that one has to leave the motion as it was.
template <class Integrator, class S>
void expect_failure_without_loss(Integrator integrator, S& system, Motion<double> motion) {
  Status status = Status::converged;
  for (int k = 0; k < 1000 && status == Status::converged; ++k) {
    const Motion<double> before = motion;
    const softsim::StepReport report = integrator.step(system, motion);
    status = report.status;
    if (status == Status::converged) continue;
    EXPECT_EQ(status, Status::not_finite);
    EXPECT_NE(report.reason, "");
    EXPECT_EQ(motion.q.displacement, before.q.displacement);
    EXPECT_EQ(motion.v, before.v);
    EXPECT_EQ(motion.time, before.time);
  }
  EXPECT_EQ(status, Status::not_finite);
}

}  // namespace moving_bodies
