// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>

#include "softsim/integrator/implicit.hpp"
#include "softsim/integrator/static_solver.hpp"
#include "softsim/material/neo_hookean.hpp"
#include "softsim/mesh/generators.hpp"
#include "softsim/mesh/selection.hpp"
#include "softsim/potential/dead_load.hpp"
#include "softsim/potential/elastic.hpp"
#include "softsim/system/system.hpp"

// Answers that other codes give to four digits or more: a cube of 0.1 m, 9^3 cells of six tetrahedra,
// Neo-Hookean with E = 10 kPa and nu = 0.4, 1000 kg/m^3, held at one face, gravity 9.81 m/s^2 across it.

namespace reference_answers_test {

using softsim::Motion, softsim::State, softsim::Status;
using System = softsim::System<softsim::ElasticTetrahedra<softsim::NeoHookean>, softsim::DeadLoad<double>>;

System cube() {
  const auto mesh = softsim::box_mesh({9, 9, 9}, {0.1, 0.1, 0.1});
  System system(mesh, softsim::elastic(mesh, softsim::NeoHookean::from_young_poisson(1e4, 0.4)),
                softsim::gravity(mesh, 1000, {0, 0, -9.81}));
  system.mass = softsim::Mass<double>::lumped(mesh, 1000);
  system.prescribed.fix(softsim::nodes_near(mesh, softsim::Side::xmin, 0));
  return system;
}

void expect_largest(const State<double>& q, double component, double norm) {
  double largest = 0;
  for (std::ptrdiff_t i = 0; i < q.size() / softsim::block_stride; ++i)
    largest = std::max(largest, q.point(i).norm());
  // half a unit of the last digit given
  EXPECT_NEAR(q.displacement.cwiseAbs().maxCoeff(), component, 6e-7);
  EXPECT_NEAR(largest, norm, 6e-7);
}

TEST(ReferenceAnswers, StaticGravityAtOnce) {
  const System system = cube();
  State<double> q(system.rest().size());
  EXPECT_EQ(softsim::StaticSolver<System>({.tolerance = 1e-8}).solve(system, q).status, Status::converged);
  expect_largest(q, 0.028125, 0.028990);
}

void expect_after_twelve_steps(bool newton, double component, double norm) {
  const System system = cube();
  Motion<double> motion(system.rest().size());
  softsim::BackwardEuler<System> euler({.dt = 0.01, .newton = newton});
  for (int k = 0; k < 12; ++k) EXPECT_EQ(euler.step(system, motion).status, Status::converged);
  EXPECT_NEAR(motion.time, 0.12, 1e-15);
  expect_largest(motion.q, component, norm);
}

TEST(ReferenceAnswers, TwelveLinearisedStepsOfBackwardEuler) {
  expect_after_twelve_steps(false, 0.047574, 0.048793);
}

TEST(ReferenceAnswers, TwelveConvergedStepsOfBackwardEuler) {
  expect_after_twelve_steps(true, 0.047745, 0.048962);
}

}  // namespace reference_answers_test
