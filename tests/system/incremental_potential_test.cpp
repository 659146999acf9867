// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/system/incremental_potential.hpp"

#include <gtest/gtest.h>

#include <cstddef>

#include "potential/bodies.hpp"
#include "softsim/material/neo_hookean.hpp"
#include "softsim/potential/dead_load.hpp"
#include "softsim/potential/elastic.hpp"
#include "softsim/system/system.hpp"

namespace incremental_potential_test {

using bodies::Vec, bodies::relative_error;
using softsim::IncrementalPotential, softsim::Mass, softsim::State, softsim::Vector;
using System = softsim::System<softsim::ElasticTetrahedra<softsim::NeoHookean>, softsim::DeadLoad<double>>;

class Increment : public ::testing::TestWithParam<bool> {
 protected:
  softsim::TetrahedralMesh mesh = bodies::distorted_cube(2, 1);
  std::size_t nodes = mesh.points().size();
  System system{mesh, softsim::elastic(mesh, softsim::NeoHookean::from_young_poisson(10, 0.3)),
                softsim::gravity(mesh, 3, Vec(0.1, 0.2, -0.3))};
  State<double> q_0 = bodies::random_state(nodes, 0.04, 2), q = bodies::random_state(nodes, 0.05, 3);
  Vector<double> v_0 = bodies::random_vector(nodes, 1, 4);
  static constexpr double h = 0.1;
  softsim::StepTerms<double> terms{.mass = 1 / (h * h), .damping = 1 / h, .inertia = v_0 / h};

  void SetUp() override {
    system.mass = GetParam() ? Mass<double>::lumped(mesh, 3) : Mass<double>::consistent(mesh, 3);
    system.damping = {.alpha = 2, .beta = 0.05};
  }
  Vector<double> mass_times(const Vector<double>& x) const {
    Vector<double> y = Vector<double>::Zero(x.size());
    system.mass.add_product(x, 1, y);
    return y;
  }
};
INSTANTIATE_TEST_SUITE_P(, Increment, ::testing::Bool(),
                         [](const auto& parameter) { return parameter.param ? "Lumped" : "Consistent"; });

// The residual of backward Euler written out: M (v - v_0)/h + dE/dq + (alpha M + beta K_0) v with v = (q -
// q_0)/h.
TEST_P(Increment, GradientIsTheResidualOfBackwardEuler) {
  IncrementalPotential<System> potential;
  potential.set_step(system, q_0, terms);
  Vector<double> g;
  (void)potential.gradient(q, g);
  const Vector<double> v = (q.displacement - q_0.displacement) / h;
  const Vector<double> expected = mass_times(Vector<double>((v - v_0) / h)) + bodies::gradient(system, q) +
                                  2 * mass_times(v) + 0.05 * bodies::hessian_product(system, q_0, v);
  EXPECT_LT(relative_error(g, expected), 1e-13);
}

TEST_P(Increment, GradientIsTheDerivativeOfTheValue) {
  IncrementalPotential<System> potential;
  potential.set_step(system, q_0, terms);
  Vector<double> g, difference = Vector<double>::Zero(q.size());
  (void)potential.gradient(q, g);
  constexpr double step = 6e-6;
  for (std::ptrdiff_t k = 0; k < q.size(); ++k) {
    if (k % softsim::block_stride == 3) continue;
    State<double> plus = q, minus = q;
    plus.displacement[k] += step;
    minus.displacement[k] -= step;
    difference[k] = (potential.value(plus) - potential.value(minus)) / (2 * step);
  }
  EXPECT_LT(relative_error(g, difference), 1e-7);
}

TEST_P(Increment, TangentIsTheDerivativeOfTheGradient) {
  IncrementalPotential<System> potential;
  potential.set_step(system, q_0, terms);
  softsim::AssembledTangent<System> tangent;
  constexpr double step = 6e-6;
  for (const State<double>& at : {q, q_0}) {
    potential.linearise(at, tangent);
    const Vector<double> d = bodies::random_vector(nodes, 1, 5);
    State<double> plus = at, minus = at;
    softsim::retract(plus, d, step);
    softsim::retract(minus, d, -step);
    Vector<double> g_plus, g_minus, Kd(q.size());
    (void)potential.gradient(plus, g_plus);
    (void)potential.gradient(minus, g_minus);
    tangent.apply(d, Kd);
    EXPECT_LT(relative_error(Kd, Vector<double>((g_plus - g_minus) / (2 * step))), 1e-7);
  }
}

TEST_P(Increment, IsTheEnergyAloneInAStaticProblem) {
  IncrementalPotential<System> potential;
  potential.set_static(system);
  Vector<double> g;
  (void)potential.gradient(q, g);
  EXPECT_EQ(potential.value(q), system.energy(q));
  EXPECT_EQ(g, bodies::gradient(system, q));
}

// Residuals are measured against the load on what is free to move.
TEST_P(Increment, ReferenceIsTheExternalLoadOnFreeComponents) {
  IncrementalPotential<System> potential;
  Vector<double> g;
  system.prescribed.fix({0, 1, 2, 3, 4, 5, 6, 7, 8});
  Vector<double> load = std::get<1>(system.terms).force();
  system.prescribed.mask(load);
  potential.set_static(system);
  EXPECT_NEAR(potential.gradient(q, g), load.norm(), 1e-14);
  potential.set_step(system, q_0, terms);
  EXPECT_NEAR(potential.gradient(q, g), load.norm(), 1e-14);
  EXPECT_LT(load.norm(), 0.95 * std::get<1>(system.terms).force().norm());
}

// Every part on its own numbers: M (mass d - inertia) + D (damping d - drift) + constant + dE/dq.
TEST_P(Increment, TakesAnyTermsOfAStep) {
  terms = {.mass = 30,
           .damping = 4,
           .inertia = bodies::random_vector(nodes, 1, 6),
           .drift = bodies::random_vector(nodes, 1, 7),
           .constant = bodies::random_vector(nodes, 1, 8)};
  IncrementalPotential<System> potential;
  potential.set_step(system, q_0, terms);
  Vector<double> g, difference = Vector<double>::Zero(q.size());
  (void)potential.gradient(q, g);
  const Vector<double> d = q.displacement - q_0.displacement, rate = 4 * d - terms.drift;
  const Vector<double> expected = mass_times(Vector<double>(30 * d - terms.inertia)) + 2 * mass_times(rate) +
                                  0.05 * bodies::hessian_product(system, q_0, rate) + terms.constant +
                                  bodies::gradient(system, q);
  EXPECT_LT(relative_error(g, expected), 1e-13);
  constexpr double step = 6e-6;
  for (std::ptrdiff_t k = 0; k < q.size(); k += 5) {
    if (k % softsim::block_stride == 3) continue;
    State<double> plus = q, minus = q;
    plus.displacement[k] += step;
    minus.displacement[k] -= step;
    EXPECT_NEAR(g[k], (potential.value(plus) - potential.value(minus)) / (2 * step),
                1e-7 * g.cwiseAbs().maxCoeff());
  }
}

// A static problem under part of the load: gravity counts that much, in value, gradient and tangent alike,
// and prescribed components have come that part of their way.
TEST_P(Increment, PutsTheLoadOnInPart) {
  IncrementalPotential<System> whole, part;
  system.prescribed.set(3, Vec(0.1, 0.2, 0.3));
  whole.set_static(system);
  part.set_static(system, q_0, 0.25);
  Vector<double> g, g_part;
  (void)whole.gradient(q, g);
  (void)part.gradient(q, g_part);
  const Vector<double> load = std::get<1>(system.terms).force();
  EXPECT_LT((g_part - g - 0.75 * load).norm(), 1e-13 * g.norm());
  EXPECT_NEAR(part.value(q) - whole.value(q), 0.75 * load.dot(q.displacement), 1e-13);
  Vector<double> d(q.size());
  (void)part.increment(q, d);
  const Vec reached = 0.75 * Vec(q_0.point(3)) + 0.25 * Vec(0.1, 0.2, 0.3);
  EXPECT_LT((Vec(q.point(3)) + Vec(softsim::block(d, 3)) - reached).norm(), 1e-15);
}

}  // namespace incremental_potential_test
