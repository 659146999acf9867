// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "potential/bodies.hpp"
#include "softsim/integrator/implicit.hpp"
#include "softsim/integrator/semi_explicit_euler.hpp"
#include "softsim/material/neo_hookean.hpp"
#include "softsim/mesh/selection.hpp"
#include "softsim/potential/dead_load.hpp"
#include "softsim/potential/elastic.hpp"
#include "softsim/system/system.hpp"

// A tenth of a second of a soft cube under gravity, in floats and in doubles. Single precision holds forces
// to about 1e-6 of the stresses, which are ten times larger than what bends the cube.

namespace single_precision_test {

using softsim::Mass, softsim::Motion, softsim::Status;

template <class T>
using System = softsim::System<softsim::ElasticTetrahedra<softsim::NeoHookean, T>, softsim::DeadLoad<T>>;

template <class T>
System<T> cube() {
  const auto mesh = bodies::distorted_cube(3, 1);
  System<T> system(mesh, softsim::elastic<T>(mesh, softsim::NeoHookean::from_young_poisson(100, 0.3)),
                   softsim::gravity<T>(mesh, 1, {0, 0, -10}));
  system.mass = Mass<T>::lumped(mesh, 1);
  system.damping = {.alpha = 0.1, .beta = 1e-4};
  system.prescribed.fix(softsim::nodes_near(mesh, softsim::Side::xmin, 0));
  return system;
}

template <class Integrator, class T>
softsim::Vector<double> after(Integrator integrator, const System<T>& system, double seconds) {
  Motion<T> motion(system.rest().size());
  while (motion.time < seconds - 1e-9) EXPECT_EQ(integrator.step(system, motion).status, Status::converged);
  return motion.q.displacement.template cast<double>();
}

TEST(SinglePrecision, SemiExplicitEulerFollowsDoubles) {
  const auto exact = after(softsim::SemiExplicitEuler<System<double>>({.dt = 1e-3}), cube<double>(), 0.1);
  const auto single = after(softsim::SemiExplicitEuler<System<float>>({.dt = 1e-3}), cube<float>(), 0.1);
  EXPECT_GT(exact.cwiseAbs().maxCoeff(), 0.02);
  EXPECT_LT(bodies::relative_error(single, exact), 1e-4);
}

TEST(SinglePrecision, BackwardEulerFollowsDoubles) {
  for (const bool newton : {false, true}) {
    const auto exact =
        after(softsim::BackwardEuler<System<double>>({.dt = 0.01, .newton = newton, .tolerance = 1e-4}),
              cube<double>(), 0.1);
    const auto single =
        after(softsim::BackwardEuler<System<float>>({.dt = 0.01, .newton = newton, .tolerance = 1e-4}),
              cube<float>(), 0.1);
    EXPECT_GT(exact.cwiseAbs().maxCoeff(), 0.02);
    EXPECT_LT(bodies::relative_error(single, exact), 1e-3);
  }
}

}  // namespace single_precision_test
