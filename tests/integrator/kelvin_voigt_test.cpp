// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/potential/kelvin_voigt.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "potential/bodies.hpp"
#include "softsim/integrator/implicit.hpp"
#include "softsim/integrator/semi_explicit_euler.hpp"
#include "softsim/material/st_venant_kirchhoff.hpp"
#include "softsim/mesh/selection.hpp"
#include "softsim/potential/dead_load.hpp"
#include "softsim/potential/elastic.hpp"
#include "softsim/system/system.hpp"

namespace kelvin_voigt_test {

using bodies::Matrix, bodies::Vec;
using softsim::BackwardEuler, softsim::Motion, softsim::Side, softsim::State, softsim::Status,
    softsim::System, softsim::Vector;

const auto mesh = bodies::distorted_cube(2, 1);
const std::size_t points = mesh.points().size();
constexpr double phi = 0.7, psi = 0.4;
using Damping = softsim::KelvinVoigtTetrahedra<>;
using Elastic = softsim::ElasticTetrahedra<softsim::StVenantKirchhoff>;
static_assert(softsim::Potential<Damping> && Damping::viscous && !softsim::detail::is_viscous<Elastic>);
static_assert(System<Elastic, Damping>::viscous && !System<Elastic>::viscous);

const Damping damping = softsim::kelvin_voigt(mesh, {phi, psi});

Vector<double> damping_force(const State<double>& q, const Vector<double>& v) {
  Vector<double> y = Vector<double>::Zero(q.size());
  damping.add_damping_product(q, v, y);
  return y;
}
// The velocities x' = A x + b of the points at q.
Vector<double> spatial_velocity(const State<double>& q, const Matrix& A, const Vec& b) {
  Vector<double> v = Vector<double>::Zero(q.size());
  for (std::size_t i = 0; i < points; ++i)
    softsim::block(v, static_cast<std::ptrdiff_t>(i)) = A * bodies::position(mesh, q, i) + b;
  return v;
}
State<double> turned(const State<double>& q, const Matrix& R) {
  State<double> result(points);
  for (std::size_t i = 0; i < points; ++i)
    result.point(static_cast<std::ptrdiff_t>(i)) = R * bodies::position(mesh, q, i) - mesh.points()[i];
  return result;
}

// Power per volume S_v : E' for F' = A F, in a unit cube.
TEST(KelvinVoigt, PowerIsThatOfTheStressInAHomogeneousMotion) {
  bodies::Random random(1);
  const Matrix F = Matrix::Identity() + 0.3 * random.matrix(), A = random.matrix();
  const State<double> q = bodies::affine_state(mesh, F, Vec::Zero());
  const Vector<double> v = spatial_velocity(q, A, random.vec());
  const Matrix E_rate = F.transpose() * (A + A.transpose()) * F / 2;
  const double power = phi * E_rate.trace() * E_rate.trace() + 2 * psi * E_rate.squaredNorm();
  EXPECT_NEAR(v.dot(damping_force(q, v)) / power, 1, 1e-13);
}

TEST(KelvinVoigt, DampsWithASymmetricObjectiveAndDissipativeMatrix) {
  bodies::Random random(2);
  const State<double> q = bodies::random_state(points, 0.08, 3);
  const Vector<double> v = bodies::random_vector(points, 1, 4), w = bodies::random_vector(points, 1, 5);
  const double vDw = v.dot(damping_force(q, w));
  EXPECT_NEAR(vDw, w.dot(damping_force(q, v)), 1e-13 * std::abs(vDw));
  EXPECT_GT(v.dot(damping_force(q, v)), 0);
  // no force in a rigid motion, nor any net force or moment
  Matrix spin = random.matrix();
  spin -= Matrix(spin.transpose());
  EXPECT_LT(damping_force(q, spatial_velocity(q, spin, random.vec())).norm(),
            1e-13 * damping_force(q, v).norm());
  EXPECT_NEAR(spatial_velocity(q, spin, random.vec()).dot(damping_force(q, v)), 0, 1e-12);
  // turned with the body
  const Matrix R = random.rotation();
  Vector<double> Rv = v, f = damping_force(q, v);
  for (std::ptrdiff_t i = 0; i < static_cast<std::ptrdiff_t>(points); ++i) {
    softsim::block(Rv, i) = R * Vec(softsim::block(v, i));
    softsim::block(f, i) = R * Vec(softsim::block(f, i));
  }
  EXPECT_LT(bodies::relative_error(damping_force(turned(q, R), Rv), f), 1e-12);
}

// During an implicit step: derivatives by central differences of 1e-5, the force of a small step that of its
// velocity, and none for a rotation, however large.
TEST(KelvinVoigt, StepsHaveAConsistentObjectivePotential) {
  Damping term = damping;
  const double h = 1e-5;
  const State<double> q_0 = bodies::random_state(points, 0.05, 6), q = bodies::random_state(points, 0.05, 7);
  const Vector<double> d = bodies::random_vector(points, 1, 8);
  term.begin_step(q_0, d, 0.1);
  State<double> plus = q, minus = q;
  softsim::retract(plus, d, h);
  softsim::retract(minus, d, -h);
  const Vector<double> g = bodies::gradient(term, q), K_d = bodies::hessian_product(term, q, d);
  EXPECT_NEAR((term.energy(plus) - term.energy(minus)) / (2 * h) / g.dot(d), 1, 1e-7);
  EXPECT_LT(
      bodies::relative_error(
          K_d, Vector<double>((bodies::gradient(term, plus) - bodies::gradient(term, minus)) / (2 * h))),
      1e-7);
  EXPECT_GT(term.energy(q), 0);
  const State<double> away = turned(q_0, bodies::Random(9).rotation());
  EXPECT_LT(bodies::gradient(term, away).norm(), 1e-12 * g.norm());
  // the first iteration's matrix is D/h
  EXPECT_LT(bodies::relative_error(bodies::hessian_product(term, q_0, d),
                                   Vector<double>(damping_force(q_0, d) / 0.1)),
            1e-13);
  State<double> near = q_0;
  softsim::retract(near, d, 1e-7);
  term.begin_step(q_0, d, 1e-7);
  EXPECT_LT(bodies::relative_error(bodies::gradient(term, near), damping_force(q_0, d)), 1e-5);
  // no viscous force at rest or in statics
  term.begin_static();
  EXPECT_EQ(bodies::gradient(term, q).norm(), 0);
}

// A small-strain uniaxial motion of a bar of unit length with clamped sides: (phi + 2 psi) u' + (lambda + 2
// mu) u = t for the traction t put on at time 0: u = t/(lambda + 2 mu) (1 - exp(-t (lambda + 2 mu)/(phi + 2
// psi))).
TEST(KelvinVoigt, CreepsLikeTheClosedForm) {
  const double lambda = 3, mu = 2, rate = (lambda + 2 * mu) / (phi + 2 * psi), load = 1e-5, end = 0.3;
  const auto error = [&](int steps) {
    softsim::DeadLoad<double> traction(points);
    const auto top = softsim::nodes_near(mesh, Side::xmax, 0);
    System system(mesh, softsim::elastic(mesh, softsim::StVenantKirchhoff::from_lame(lambda, mu)), damping,
                  softsim::DeadLoad<double>(points));
    for (std::size_t i = 0; i < points; ++i)
      for (const int axis : {1, 2}) system.prescribed.set(static_cast<std::int32_t>(i), axis, 0);
    for (const std::int32_t i : softsim::nodes_near(mesh, Side::xmin, 0)) system.prescribed.set(i, 0, 0);
    for (const softsim::Triangle& f : softsim::boundary_triangles(mesh)) {
      const auto X = [&](std::size_t i) { return mesh.points()[static_cast<std::size_t>(f[i])]; };
      if (X(0)[0] + X(1)[0] + X(2)[0] < 3) continue;
      for (const std::int32_t i : f)
        traction.add(i, Vec(load * (X(1) - X(0)).cross(X(2) - X(0)).norm() / 6, 0, 0));
    }
    std::get<2>(system.terms) = traction;
    Motion<double> motion(points);
    BackwardEuler<decltype(system)> integrator({.dt = end / steps, .newton = true, .tolerance = 1e-8});
    for (int n = 0; n < steps; ++n) EXPECT_EQ(integrator.step(system, motion).status, Status::converged);
    return motion.q.point(top[0])[0] * (lambda + 2 * mu) / load / (1 - std::exp(-rate * end)) - 1;
  };
  const double coarse = error(20), fine = error(40);
  EXPECT_LT(std::abs(fine), 0.02);
  EXPECT_NEAR(coarse / fine, 2, 0.06);
}

// A free body in motion loses energy and keeps its momenta with explicit steps; implicit ones agree to first
// order, and Rayleigh's beta leaves the damping force out.
TEST(KelvinVoigt, DampsAFreeBodyInBothIntegrators) {
  const auto make = [&](double beta) {
    System system(mesh, softsim::elastic(mesh, softsim::StVenantKirchhoff::from_young_poisson(10, 0.3)),
                  damping);
    system.mass = softsim::Mass<double>::lumped(mesh, 1);
    system.damping.beta = beta;
    return system;
  };
  Motion<double> start(points);
  start.q = bodies::random_state(points, 0.02, 10);
  start.v = spatial_velocity(start.q, bodies::Random(11).matrix(), Vec(1, 2, 3));
  auto system = make(0);
  const auto energy = [&](const Motion<double>& m) {
    return softsim::elastic(mesh, softsim::StVenantKirchhoff::from_young_poisson(10, 0.3)).energy(m.q) +
           system.kinetic_energy(m.v);
  };
  Motion<double> motion = start;
  softsim::SemiExplicitEuler<decltype(system)> integrator({.dt = 1e-4});
  double last = energy(motion);
  for (int n = 0; n < 20; ++n) {
    for (int k = 0; k < 50; ++k) ASSERT_EQ(integrator.step(system, motion).status, Status::converged);
    EXPECT_LT(energy(motion), last) << n;
    last = energy(motion);
  }
  for (const double beta : {0.0, 0.02})
    for (const bool newton : {false, true}) {
      auto damped = make(beta);
      Motion<double> implicit = start, reference = start;
      BackwardEuler<decltype(damped)> coarse({.dt = 1e-3, .newton = newton, .tolerance = 1e-10});
      softsim::SemiExplicitEuler<decltype(damped)> fine({.dt = 1e-5});
      for (int n = 0; n < 5; ++n) ASSERT_EQ(coarse.step(damped, implicit).status, Status::converged);
      for (int n = 0; n < 500; ++n) ASSERT_EQ(fine.step(damped, reference).status, Status::converged);
      const Vector<double> change = reference.q.displacement - start.q.displacement;
      EXPECT_LT((implicit.q.displacement - reference.q.displacement).norm(), 0.03 * change.norm());
    }
}

TEST(KelvinVoigt, StrainAtTheStartMovesWithTheElementsThatStay) {
  const State<double> q_0 = bodies::random_state(points, 0.05, 12),
                      q = bodies::random_state(points, 0.05, 13);
  const Vector<double> v = bodies::random_vector(points, 1, 14);
  Damping before = damping, after = damping;
  for (Damping* term : {&before, &after}) {
    if (term == &before) term->remove(1);
    term->begin_step(q_0, v, 0.1);
    if (term == &after) term->remove(1);
  }
  EXPECT_EQ(before.size() + 1, damping.size());
  EXPECT_EQ(bodies::gradient(after, q), bodies::gradient(before, q));
}

TEST(KelvinVoigt, RefusesViscositiesThatFeedTheMotion) {
  EXPECT_EQ(bodies::refusal([] {
              return softsim::kelvin_voigt(mesh, {1, -1});
            }),
            "Kelvin-Voigt: psi -1 Pa s must be at least 0 and finite");
  EXPECT_EQ(bodies::refusal([] {
              return softsim::kelvin_voigt(mesh, {-2, 1.5});
            }),
            "Kelvin-Voigt: phi -2 Pa s must be at least -2/3 psi = -1 Pa s and finite");
  EXPECT_NE(bodies::refusal([] { return softsim::kelvin_voigt(mesh, {std::nan(""), 1}); }), "");
  EXPECT_NE(bodies::refusal([] { return softsim::kelvin_voigt(mesh, {1, HUGE_VAL}); }), "");
  EXPECT_EQ(bodies::refusal([] { return softsim::kelvin_voigt(mesh, {-1, 1.5}); }), "");
}

}  // namespace kelvin_voigt_test
