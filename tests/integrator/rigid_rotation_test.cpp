// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/integrator/rigid_rotation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "potential/bodies.hpp"

namespace rigid_rotation_test {

using bodies::refusal;
using softsim::EnergyMomentumRotation, softsim::Mat3, softsim::RigidRotation, softsim::Status;
using Vec = softsim::Vec3<double>;
using Matrix = Mat3<double>;

// Three different moments about axes that are not those of the coordinates.
Matrix inertia() {
  const Matrix V = softsim::rotation_exponential(Vec(0.3, -0.5, 0.8));
  return V * Vec(1, 2, 3.5).asDiagonal() * V.transpose();
}
RigidRotation tumbling() {
  RigidRotation body;
  body.orientation = softsim::rotation_exponential(Vec(1, 0.2, -0.4));
  body.velocity = Vec(1, -2, 1.5);
  return body;
}

TEST(RigidRotation, KeepsEnergyAndMomentumOfATumblingBody) {
  for (const double h : {0.01, 0.3}) {  // 1/250 to 1/8 of a turn
    const EnergyMomentumRotation integrator(inertia(), {.dt = h});
    RigidRotation body = tumbling();
    const double energy = integrator.energy(body);
    const Vec momentum = integrator.momentum(body);
    for (int n = 0; n < 10000; ++n) ASSERT_EQ(integrator.step(body).status, Status::converged) << n;
    // a rounding error a step
    EXPECT_NEAR(integrator.energy(body) / energy, 1, 1e-12) << h;
    EXPECT_LT((integrator.momentum(body) - momentum).norm(), 1e-12 * momentum.norm()) << h;
    EXPECT_LT((body.orientation.transpose() * body.orientation - Matrix::Identity()).norm(), 1e-12);
    EXPECT_NEAR(body.time, 10000 * h, 1e-8);
  }
}

// Under a torque the energy grows by its work over the rotation of every step, and the momentum by it times
// h.
TEST(RigidRotation, TakesInExactlyTheWorkOfATorque) {
  const double h = 0.1;
  const EnergyMomentumRotation integrator(inertia(), {.dt = h});
  RigidRotation body = tumbling();
  for (int n = 0; n < 50; ++n) {
    const Vec torque(std::sin(0.3 * n), 2, -1);
    const RigidRotation before = body;
    ASSERT_EQ(integrator.step(body, torque).status, Status::converged);
    const Vec turned = softsim::rotation_logarithm(Matrix(before.orientation.transpose() * body.orientation));
    EXPECT_NEAR(integrator.energy(body) - integrator.energy(before), torque.dot(before.orientation * turned),
                1e-12 * integrator.energy(body));
    EXPECT_LT((integrator.momentum(body) - integrator.momentum(before) - h * torque).norm(),
              1e-13 * integrator.momentum(body).norm());
  }
}

// A symmetric top precesses about its momentum at |L| / J_1 and turns about its axis at (1/J_3 - 1/J_1) L_3.
TEST(RigidRotation, IsOfSecondOrderOnASymmetricTop) {
  const Matrix J = Vec(2, 2, 1).asDiagonal();
  const Vec start(0.5, 0, 2), L = J * start;
  const double T = 3;
  const Matrix exact = softsim::rotation_exponential(Vec(T / 2 * L)) *
                       softsim::rotation_exponential(Vec(0, 0, (1.0 - 0.5) * L[2] * T));
  const auto error = [&](int steps) {
    const EnergyMomentumRotation integrator(J, {.dt = T / steps});
    RigidRotation body;
    body.velocity = start;
    for (int n = 0; n < steps; ++n) EXPECT_EQ(integrator.step(body).status, Status::converged);
    return (body.orientation - exact).norm();
  };
  const double coarse = error(40), fine = error(80);
  EXPECT_NEAR(std::log2(coarse / fine), 2, 0.05);
  EXPECT_LT(fine, 1e-2);
}

TEST(RigidRotation, RestsWithoutATorque) {
  const EnergyMomentumRotation integrator(inertia(), {.dt = 0.1});
  RigidRotation body;
  ASSERT_EQ(integrator.step(body).status, Status::converged);
  EXPECT_EQ(body.velocity.norm(), 0);
  ASSERT_EQ(integrator.step(body, Vec(1, 2, 3)).status, Status::converged);
  EXPECT_GT(body.velocity.norm(), 0);
}

TEST(RigidRotation, LeavesTheBodyWhereAStepFails) {
  const EnergyMomentumRotation integrator(inertia(), {.dt = 0.1, .max_newton_iterations = 1});
  RigidRotation body = tumbling();
  const RigidRotation before = body;
  EXPECT_EQ(integrator.step(body).status, Status::not_converged);
  EXPECT_EQ(body.velocity, before.velocity);
  EXPECT_EQ(body.orientation, before.orientation);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(integrator.step(body, Vec(nan, 0, 0)).status, Status::not_finite);
  EXPECT_EQ(body.velocity, before.velocity);
  EXPECT_EQ(body.time, 0);
}

TEST(RigidRotation, RefusesBadOptions) {
  EXPECT_EQ(refusal([] { EnergyMomentumRotation(inertia(), {.dt = 0}); }),
            "dt 0 s: must be positive and finite");
  EXPECT_EQ(refusal([] { EnergyMomentumRotation(inertia(), {.dt = 1, .tolerance = 0}); }),
            "tolerance 0: must be positive");
  EXPECT_EQ(refusal([] { EnergyMomentumRotation(-inertia(), {.dt = 1}); }),
            "inertia with the trace -6.5 kg m^2: must be finite, symmetric and positive definite");
}

}  // namespace rigid_rotation_test
