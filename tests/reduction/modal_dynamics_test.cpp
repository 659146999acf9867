// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/reduction/modal_dynamics.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>
#include <string>
#include <unsupported/Eigen/MatrixFunctions>

#include "potential/bodies.hpp"
#include "reduction/reduced_bodies.hpp"
#include "softsim/concepts.hpp"

namespace modal_dynamics_test {

using bodies::Vec, bodies::refusal, bodies::relative_error;
using reduced_bodies::System;
using softsim::ModalDynamics, softsim::Modes, softsim::Motion, softsim::OscillatorStep, softsim::State,
    softsim::Status, softsim::Vector;

static_assert(softsim::Integrator<ModalDynamics<System>, System>);

const double nan = std::numeric_limits<double>::quiet_NaN();

// ---------------------------------------------------------------- one oscillator

// The matrix exponential of (a, v, p) in long double: under-, critically and overdamped, near the borders
// between the forms, rigid, and with a step far beyond the period.
TEST(OscillatorStep, IsTheMatrixExponential) {
  using Three = Eigen::Matrix<long double, 3, 3>;
  for (const double omega : {0.0, 1e-9, 1e-3, 0.1, 0.499, 0.501, 1.0, 3.0, 20.0})
    for (const double c : {0.0, 1e-9, 1e-3, 0.1, 0.999, 1.001, 2 * omega, 2 * omega * (1 - 1e-12),
                           2 * omega * (1 + 1e-12), 2 * omega * (1 + 1e-7), 2 * omega * (1 + 1e-4), 30.0})
      for (const double h : {1.0, 0.01}) {
        const OscillatorStep step(omega, c, h);
        Three A;
        A << 0, 1, 0, -static_cast<long double>(omega) * omega, -c, 1, 0, 0, 0;
        const Three exact = (h * A).exp();
        double a[3] = {1, 0, 0}, v[3] = {0, 1, 0};
        for (int k = 0; k < 3; ++k) {
          step.advance(a[k], v[k], k == 2 ? 1 : 0);
          // 1e-15 of rounding; the phase omega h = 20 and a difference of roots cost some digits
          const double tolerance = 1e-13 * (1 + omega * h);
          EXPECT_NEAR(a[k], static_cast<double>(exact(0, k)),
                      tolerance * (k == 0   ? 1
                                   : k == 1 ? h
                                            : h * h))
              << omega << " " << c << " " << h << " " << k;
          EXPECT_NEAR(v[k], static_cast<double>(exact(1, k)),
                      tolerance * (k == 0   ? omega * omega * h + 1e-300
                                   : k == 1 ? 1
                                            : h))
              << omega << " " << c << " " << h << " " << k;
        }
      }
}

TEST(OscillatorStep, StiffAndHeavilyDampedStayFinite) {
  const OscillatorStep stiff(1e8, 0, 1), damped(1e3, 1e12, 1), free(0, 1e12, 1);
  double a = 1, v = 0;
  stiff.advance(a, v, 0);
  EXPECT_LE(std::abs(a), 1 + 1e-12);
  a = 1, v = 0;
  damped.advance(a, v, 0);
  EXPECT_NEAR(a, std::exp(-1e-6), 1e-15);
  a = 1, v = 0;
  free.advance(a, v, 1);
  EXPECT_NEAR(a, 1, 1e-11);
  EXPECT_NEAR(v, 1e-12, 1e-26);
}

TEST(OscillatorStep, RefusesWhatIsNoOscillator) {
  EXPECT_EQ(refusal([] { return OscillatorStep(-1, 0, 1); }),
            "omega -1 rad/s: must not be negative, and finite");
  EXPECT_EQ(refusal([] { return OscillatorStep(1, -1, 1); }),
            "damping -1 1/s: must not be negative, and finite");
  EXPECT_EQ(refusal([] { return OscillatorStep(1, nan, 1); }),
            "damping nan 1/s: must not be negative, and finite");
  EXPECT_EQ(refusal([] { return OscillatorStep(1, 0, 0); }), "dt 0 s: must be positive and finite");
}

// ---------------------------------------------------------------- a body

System loaded_cube(int n) {
  System cube = reduced_bodies::held_cube(n);
  std::get<1>(cube.terms).add(static_cast<std::int32_t>(cube.rest().size()) - 1, {3, -2, 5});
  std::get<1>(cube.terms).add(1, {-1, 0, 2});
  return cube;
}

// All twelve modes against the exponential of the whole first-order system, load included.
TEST(ModalDynamics, WithAllModesIsTheMatrixExponential) {
  System cube = loaded_cube(1);
  cube.damping = {.alpha = 3, .beta = 0.002};
  const State<double> rest(cube.rest().size());
  const softsim::FreeComponents free(cube.prescribed);
  const std::ptrdiff_t n = free.size();
  const Eigen::MatrixXd K = softsim::stiffness_matrix(cube, rest, free), M = free.matrix(cube.mass),
                        D = 3 * M + 0.002 * K;
  Eigen::VectorXd f(n);
  free.gather(std::get<1>(cube.terms).force(), f);
  const double h = 0.01;
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(2 * n + 1, 2 * n + 1);
  A.block(0, n, n, n).setIdentity();
  A.block(n, 0, n, n) = -M.llt().solve(K);
  A.block(n, n, n, n) = -M.llt().solve(D);
  A.block(n, 2 * n, n, 1) = M.llt().solve(f);
  const Eigen::MatrixXd E = (h * A).exp();

  ModalDynamics<System> modal(cube, rest, reduced_bodies::all_modes(cube), {.dt = h});
  Motion<double> motion(cube.rest().size());
  motion.q = bodies::random_state(cube.rest().size(), 0.1, 5);
  motion.v = bodies::random_vector(cube.rest().size(), 0.1, 6);
  cube.prescribed.mask(motion.q.displacement);
  cube.prescribed.mask(motion.v);
  Eigen::VectorXd y(2 * n + 1), x(n);
  free.gather(motion.q.displacement, x);
  y.head(n) = x;
  free.gather(motion.v, x);
  y.segment(n, n) = x;
  y[2 * n] = 1;
  for (int k = 0; k < 20; ++k) {
    ASSERT_EQ(modal.step(cube, motion).status, Status::converged);
    y = (E * y).eval();
    free.gather(motion.q.displacement, x);
    EXPECT_LT((x - y.head(n)).norm(), 1e-11 * y.head(n).norm()) << k;
    free.gather(motion.v, x);
    EXPECT_LT((x - y.segment(n, n)).norm(), 1e-10 * y.segment(n, n).norm()) << k;
  }
  EXPECT_NEAR(motion.time, 0.2, 1e-12);
}

// Ten thousand steps without damping: rounding is all that changes the energy.
TEST(ModalDynamics, KeepsTheEnergyOfAnUndampedBody) {
  const System cube = reduced_bodies::held_cube(1);
  ModalDynamics<System> modal(cube, State<double>(8), reduced_bodies::all_modes(cube), {.dt = 0.05});
  Motion<double> motion(8);
  motion.v = bodies::random_vector(8, 1, 6);
  cube.prescribed.mask(motion.v);
  const auto energy = [&] {
    return cube.kinetic_energy(motion.v) +
           softsim::dot(motion.q.displacement,
                        bodies::hessian_product(cube, State<double>(8), motion.q.displacement)) /
               2;
  };
  const double start = energy();
  for (int k = 0; k < 10000; ++k) ASSERT_EQ(modal.step(cube, motion).status, Status::converged);
  EXPECT_NEAR(energy() / start, 1, 1e-9);
}

TEST(ModalDynamics, AFreeBodyFalls) {
  const softsim::TetrahedralMesh mesh = bodies::distorted_cube(2, 1);
  System cube = reduced_bodies::body(mesh);
  std::get<1>(cube.terms) = softsim::gravity(mesh, 3, {0, 1, -9.81});
  ModalDynamics<System> modal(cube, State<double>(mesh.points().size()),
                              reduced_bodies::all_modes(cube).first(8), {.dt = 0.1});
  Motion<double> motion(mesh.points().size());
  for (std::ptrdiff_t i = 0; i < 27; ++i) softsim::block(motion.v, i) = Vec(2, 0, 0);
  for (int k = 0; k < 10; ++k) ASSERT_EQ(modal.step(cube, motion).status, Status::converged);
  for (std::ptrdiff_t i = 0; i < 27; ++i)
    EXPECT_LT((motion.q.point(i) - Vec(2, 0.5, -9.81 / 2)).norm(), 1e-9) << i;
}

// Distance from the motion of all modes after a load was switched on, relative; m modes.
double truncation_error(const System& cube, const Modes& all, std::ptrdiff_t m, bool correction) {
  const State<double> rest(cube.rest().size());
  ModalDynamics<System> full(cube, rest, all, {.dt = 0.02}),
      reduced(cube, rest, all.first(m), {.dt = 0.02, .static_correction = correction});
  Motion<double> x(cube.rest().size()), y(cube.rest().size());
  double error = 0, size = 0;
  for (int k = 0; k < 50; ++k) {
    EXPECT_EQ(full.step(cube, x).status, Status::converged);
    EXPECT_EQ(reduced.step(cube, y).status, Status::converged);
    error += (x.q.displacement - y.q.displacement).squaredNorm();
    size += x.q.displacement.squaredNorm();
  }
  return std::sqrt(error / size);
}

TEST(ModalDynamics, TheErrorFallsWithTheNumberOfModes) {
  System cube = loaded_cube(3);
  cube.damping = {.alpha = 1, .beta = 0.005};
  const Modes all = reduced_bodies::all_modes(cube);
  double last = 1, last_corrected = 1;
  for (const std::ptrdiff_t m : {3, 10, 30, 100}) {
    const double error = truncation_error(cube, all, m, false),
                 corrected = truncation_error(cube, all, m, true);
    RecordProperty("error_with_" + std::to_string(m), std::to_string(error));
    RecordProperty("corrected_with_" + std::to_string(m), std::to_string(corrected));
    EXPECT_LT(error, last);
    EXPECT_LT(corrected, last_corrected);
    EXPECT_LT(corrected, 0.5 * error);
    last = error;
    last_corrected = corrected;
  }
  EXPECT_LT(truncation_error(cube, all, all.count(), false), 1e-14);
}

// One mode and the correction come to rest in equilibrium; then the load changes.
TEST(ModalDynamics, WithCorrectionRestsInEquilibrium) {
  System cube = loaded_cube(2);
  const State<double> rest(27);
  ModalDynamics<System> modal(cube, rest, reduced_bodies::all_modes(cube).first(1),
                              {.dt = 10, .damping_ratio = 1, .static_correction = true});
  Motion<double> motion(27);
  for (const double scale : {1.0, -2.0}) {
    std::get<1>(cube.terms).add(9, {0, 0, scale});
    for (int k = 0; k < 5; ++k) ASSERT_EQ(modal.step(cube, motion).status, Status::converged);
    Vector<double> r = bodies::hessian_product(cube, rest, motion.q.displacement);
    r -= std::get<1>(cube.terms).force();
    cube.prescribed.mask(r);
    EXPECT_LT(r.norm(), 1e-11);
  }
}

TEST(ModalDynamics, FailureLeavesTheMotionAlone) {
  System cube = reduced_bodies::held_cube(1), other = reduced_bodies::held_cube(1);
  ModalDynamics<System> modal(cube, State<double>(8), reduced_bodies::all_modes(cube), {.dt = 0.1});
  Motion<double> motion(8);
  motion.v[4] = nan;
  const Vector<double> before = motion.q.displacement;
  EXPECT_EQ(modal.step(cube, motion).status, Status::not_finite);
  EXPECT_EQ(modal.step(other, motion).status, Status::not_converged);
  cube.prescribed.set(0, 1, 0.1);
  const auto report = modal.step(cube, motion);
  EXPECT_EQ(report.status, Status::not_converged);
  EXPECT_EQ(report.reason, "modal: prescribed components must stay where the modes were computed");
  EXPECT_EQ(motion.q.displacement, before);
  EXPECT_EQ(motion.time, 0);
}

TEST(ModalDynamics, RefusesModesOfSomethingElse) {
  System cube = reduced_bodies::held_cube(1);
  const Modes modes = reduced_bodies::all_modes(cube);
  const auto with = [&](const Modes& some, const softsim::ModalOptions& options) {
    return refusal([&] { return ModalDynamics<System>(cube, State<double>(8), some, options); });
  };
  EXPECT_EQ(with(modes, {}), "dt 0 s: must be positive and finite");
  EXPECT_EQ(with(modes, {.dt = 1, .damping_ratio = -1}), "damping_ratio -1: must not be negative");
  EXPECT_EQ(with({}, {.dt = 1}), "modes: shapes are 0 x 0, must be 32 x 0 and at least one");
  Modes wrong = modes;
  wrong.shapes *= 2;
  EXPECT_EQ(with(wrong, {.dt = 1}), "modes: Phi^T M Phi differs from the identity by 3, must not by 1e-4");
  wrong = modes;
  wrong.shapes(0, 2) = 1e-9;
  EXPECT_EQ(with(wrong, {.dt = 1}), "modes: node 0: a shape moves a prescribed component");
  cube.mass = softsim::Mass<double>(8);
  EXPECT_EQ(with(modes, {.dt = 1}), "system: has no mass");
  const System loose = reduced_bodies::body(bodies::distorted_cube(1, 1));
  EXPECT_NE(refusal([&] {
              return ModalDynamics<System>(loose, State<double>(8), reduced_bodies::all_modes(loose),
                                           {.dt = 1, .static_correction = true});
            }).find("must be held"),
            std::string::npos);
}

}  // namespace modal_dynamics_test
