// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <cstddef>

#include "potential/bodies.hpp"
#include "softsim/integrator/implicit.hpp"
#include "softsim/integrator/semi_explicit_euler.hpp"
#include "softsim/material/linear_elastic.hpp"
#include "softsim/mesh/selection.hpp"
#include "softsim/potential/dead_load.hpp"
#include "softsim/potential/elastic.hpp"
#include "softsim/system/system.hpp"

// A small-strain body moving in one of its modes is one damped oscillator, u'' + (alpha + beta w^2) u' + w^2
// u = 0, whose discrete motion is known in closed form.

namespace single_mode_test {

using softsim::BackwardEuler, softsim::Mass, softsim::Motion, softsim::SemiExplicitEuler, softsim::Status,
    softsim::Vector;
using System = softsim::System<softsim::ElasticTetrahedra<softsim::LinearElastic>, softsim::DeadLoad<double>>;

class SingleMode : public ::testing::TestWithParam<bool> {
 protected:
  softsim::TetrahedralMesh mesh = bodies::distorted_cube(2, 1);
  System system{mesh, softsim::elastic(mesh, softsim::LinearElastic::from_young_poisson(100, 0.3)),
                softsim::DeadLoad<double>(mesh.points().size())};
  Vector<double> mode;  // largest component 1
  double omega = 0;     // 1/s

  void SetUp() override {
    system.prescribed.fix(softsim::nodes_near(mesh, softsim::Side::zmin, 0));
    system.mass = GetParam() ? Mass<double>::lumped(mesh, 1) : Mass<double>::consistent(mesh, 1);
    softsim::AssembledTangent<System> stiffness, mass;
    const softsim::State<double> rest(mesh.points().size());
    stiffness.set(system, rest, {});
    mass.set(system, rest, {.mass = 1, .stiffness = 0});
    const Vector<double> free = softsim::pack(system.prescribed.free());
    Eigen::MatrixXd K = stiffness.matrix().to_eigen(), M = mass.matrix().to_eigen();
    for (Eigen::Index i = 0; i < free.size(); ++i)
      if (free[i] == 0) {
        K.row(i).setZero();
        K.col(i).setZero();
        M.row(i).setZero();
        M.col(i).setZero();
        K(i, i) = 1e9;  // out of the way
        M(i, i) = 1;
      }
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> eigen(K, M);
    omega = std::sqrt(eigen.eigenvalues()[2]);
    mode = softsim::unpack(Vector<double>(eigen.eigenvectors().col(2)));
    system.prescribed.mask(mode);
    mode /= mode.cwiseAbs().maxCoeff();
  }

  // Runs 30 steps from mode * 0.1 at the velocity mode * 0.3 w beside the oscillator that `advance` steps.
  template <class Integrator, class Advance>
  void expect_oscillator(Integrator integrator, double tolerance, Advance advance) const {
    double u = 0.1, v = 0.03 * omega;
    Motion<double> motion(mesh.points().size());
    motion.q.displacement = u * mode;
    motion.v = v * mode;
    for (int k = 0; k < 30; ++k) {
      ASSERT_EQ(integrator.step(system, motion).status, Status::converged);
      advance(u, v);
      ASSERT_LT((motion.q.displacement - u * mode).cwiseAbs().maxCoeff(), tolerance) << k;
      ASSERT_LT((motion.v - v * mode).cwiseAbs().maxCoeff(), 10 * omega * tolerance) << k;
    }
  }
};
INSTANTIATE_TEST_SUITE_P(, SingleMode, ::testing::Bool(), [](const auto& parameter) {
  return parameter.param ? "LumpedMass" : "ConsistentMass";
});

struct Damping {
  double alpha, beta;
};
constexpr Damping dampings[] = {{0, 0}, {2, 0}, {0, 0.02}, {1, 0.01}};

// v_1 = (v_0 - h w^2 u_0)/(1 + h (alpha + beta w^2) + h^2 w^2), u_1 = u_0 + h v_1
TEST_P(SingleMode, OfBackwardEuler) {
  for (const bool newton : {false, true})
    for (const auto [alpha, beta] : dampings) {
      const double h = 0.3 / omega, w2 = omega * omega, a = alpha, b = beta;
      system.damping = {alpha, beta};
      // thirty solves to 1e-11 each
      expect_oscillator(BackwardEuler<System>({.dt = h, .newton = newton, .tolerance = 1e-11}), 1e-9,
                        [=](double& u, double& v) {
                          v = (v - h * w2 * u) / (1 + h * (a + b * w2) + h * h * w2);
                          u += h * v;
                        });
    }
}

// v_1 = v_0 - h (w^2 u_0 + (alpha + beta w^2) v_0), u_1 = u_0 + h v_1. Modes of higher frequency grow from
// rounding unless the step is below their limit: 1/50 of a period of this one is.
TEST_P(SingleMode, OfSemiExplicitEuler) {
  for (const auto [alpha, beta] : dampings) {
    const double h = 0.02 / omega, w2 = omega * omega, a = alpha, b = 0.01 * beta;
    system.damping = {a, b};
    expect_oscillator(
        SemiExplicitEuler<System>({.dt = h, .linear = {.max_iterations = 500, .tolerance = 1e-13}}), 1e-10,
        [=](double& u, double& v) {
          v -= h * (w2 * u + (a + b * w2) * v);
          u += h * v;
        });
  }
}

// Schemes as their textbooks write them for one oscillator of unit mass, damping c and stiffness k.
struct Oscillator {
  double c, k;
  [[nodiscard]] double acceleration(double u, double v) const { return -c * v - k * u; }
};

// Generalised-alpha after Chung & Hulbert 1993: c v + k u at the time 1 - alpha_f, a at 1 - alpha_m.
struct ChungHulbert {
  Oscillator o;
  double h, alpha_m, alpha_f, beta, gamma, a = 0;
  bool started = false;
  void operator()(double& u, double& v) {
    if (!started) a = o.acceleration(u, v);
    started = true;
    // u_1 = u_p + h^2 beta a_1, v_1 = v_p + h gamma a_1
    const double u_p = u + h * v + h * h * (0.5 - beta) * a, v_p = v + h * (1 - gamma) * a;
    const double rest = o.acceleration((1 - alpha_f) * u_p + alpha_f * u, (1 - alpha_f) * v_p + alpha_f * v);
    const double a_1 =
        (rest - alpha_m * a) / (1 - alpha_m + (1 - alpha_f) * (o.c * h * gamma + o.k * h * h * beta));
    a = a_1;
    u = u_p + h * h * beta * a;
    v = v_p + h * gamma * a;
  }
};

template <class Integrator>
Integrator exact(double h, decltype(typename Integrator::Options().scheme) scheme, bool newton) {
  return Integrator({.dt = h, .scheme = scheme, .newton = newton, .tolerance = 1e-11});
}

TEST_P(SingleMode, OfGeneralisedAlphaHhtAndNewmark) {
  for (const bool newton : {false, true})
    for (const auto [alpha, beta] : dampings) {
      const double h = 0.4 / omega;
      system.damping = {alpha, beta};
      const Oscillator o{alpha + beta * omega * omega, omega * omega};
      for (const double rho : {0.0, 0.5, 1.0}) {
        const double m = (2 * rho - 1) / (rho + 1), f = rho / (rho + 1);
        expect_oscillator(
            exact<softsim::GeneralisedAlpha<System>>(h, softsim::GeneralisedAlphaScheme(rho), newton), 1e-8,
            ChungHulbert{o, h, m, f, (1 - m + f) * (1 - m + f) / 4, 0.5 - m + f});
      }
      for (const double a : {-1.0 / 3, -0.05, 0.0})
        expect_oscillator(exact<softsim::Hht<System>>(h, softsim::HhtScheme(a), newton), 1e-8,
                          ChungHulbert{o, h, 0, -a, (1 - a) * (1 - a) / 4, 0.5 - a});
      expect_oscillator(exact<softsim::Newmark<System>>(h, softsim::NewmarkScheme(0.3, 0.6), newton), 1e-8,
                        ChungHulbert{o, h, 0, 0, 0.3, 0.6});
    }
}

// (u, v)_1 - (u, v)_0 = h f at (1 - beta) y_0 + beta y_1, solved as two equations.
TEST_P(SingleMode, OfTheGeneralisedMidpointRule) {
  for (const bool newton : {false, true})
    for (const auto [alpha, beta] : dampings)
      for (const double theta : {0.5, 0.7, 1.0}) {
        const double h = 0.4 / omega;
        system.damping = {alpha, beta};
        const Oscillator o{alpha + beta * omega * omega, omega * omega};
        const auto advance = [=](double& u, double& v) {
          const double dv =
              h * o.acceleration(u + theta * h * v, v) / (1 + h * theta * o.c + h * h * theta * theta * o.k);
          u += h * (v + theta * dv);
          v += dv;
        };
        expect_oscillator(exact<BackwardEuler<System>>(h, softsim::Theta{theta}, newton), 1e-8, advance);
        if (theta == 0.5)
          expect_oscillator(
              softsim::ImplicitMidpoint<System>({.dt = h, .newton = newton, .tolerance = 1e-11}), 1e-8,
              advance);
      }
}

TEST_P(SingleMode, OfTheTrapezoidalRule) {
  for (const bool newton : {false, true})
    for (const auto [alpha, beta] : dampings) {
      const double h = 0.4 / omega;
      system.damping = {alpha, beta};
      const Oscillator o{alpha + beta * omega * omega, omega * omega};
      expect_oscillator(
          softsim::Implicit<softsim::Trapezoidal, System>({.dt = h, .newton = newton, .tolerance = 1e-11}),
          1e-8, [=](double& u, double& v) {
            const double dv = h * o.acceleration(u + h / 2 * v, v) / (1 + h / 2 * o.c + h * h / 4 * o.k);
            u += h * (v + dv / 2);
            v += dv;
          });
    }
}

TEST_P(SingleMode, OfBdf2) {
  for (const bool newton : {false, true})
    for (const auto [alpha, beta] : dampings) {
      const double h = 0.4 / omega;
      system.damping = {alpha, beta};
      const Oscillator o{alpha + beta * omega * omega, omega * omega};
      expect_oscillator(
          softsim::Implicit<softsim::Bdf2, System>({.dt = h, .newton = newton, .tolerance = 1e-11}), 1e-8,
          [=, u_0 = 0.0, v_0 = 0.0, started = false](double& u, double& v) mutable {
            // 3/2 y_1 = b + h f(y_1), the first step y_1 = y_0 + h f(y_1)
            const double w = started ? 1.5 : 1, b_u = started ? 2 * u - u_0 / 2 : u,
                         b_v = started ? 2 * v - v_0 / 2 : v;
            u_0 = u;
            v_0 = v;
            started = true;
            v = (b_v - h * o.k * b_u / w) / (w + h * o.c + h * h * o.k / w);
            u = (b_u + h * v) / w;
          });
    }
}

TEST_P(SingleMode, LinearisedAndConvergedStepsAreOneForALinearBody) {
  system.damping = {0.5, 0.01};
  std::get<1>(system.terms) = softsim::gravity(mesh, 1, {1, 2, -10});
  BackwardEuler<System> linearised({.dt = 0.02, .tolerance = 1e-11}),
      converged({.dt = 0.02, .newton = true, .tolerance = 1e-11});
  Motion<double> a(mesh.points().size()), b(mesh.points().size());
  for (int k = 0; k < 20; ++k) {
    ASSERT_EQ(linearised.step(system, a).status, Status::converged);
    ASSERT_EQ(converged.step(system, b).status, Status::converged);
    ASSERT_LT(bodies::relative_error(a.q.displacement, b.q.displacement), 1e-8) << k;
  }
}

}  // namespace single_mode_test
