// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/integrator/stability.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <string>
#include <vector>

#include "potential/bodies.hpp"
#include "softsim/integrator/butcher_tableau.hpp"

namespace stability_test {

using bodies::refusal;
using softsim::ButcherCoefficients, softsim::ButcherTableau;
namespace stability = softsim::stability;
using stability::Complex, stability::Roots, stability::spectral_radius;

const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();

auto function_of(const ButcherTableau& t) {
  return [t](Complex z) { return t.stability_function(z); };
}

std::vector<ButcherTableau> all_tableaus() {
  return {ButcherTableau::explicit_euler(), ButcherTableau::midpoint(), ButcherTableau::heun(),
          ButcherTableau::kutta3(),         ButcherTableau::rk4(),      ButcherTableau::bogacki_shampine(),
          ButcherTableau::dormand_prince()};
}

// ---------------------------------------------------------------- tableaus

TEST(ButcherTableau, KnowsItsOrders) {
  const int order[] = {1, 2, 2, 3, 4, 3, 5}, embedded[] = {0, 0, 0, 0, 0, 2, 4};
  const auto all = all_tableaus();
  for (std::size_t k = 0; k < all.size(); ++k) {
    EXPECT_EQ(all[k].order(), order[k]) << k;
    EXPECT_EQ(all[k].embedded_order(), embedded[k]) << k;
  }
}

// R(z) = exp(z) + O(z^(p+1)): the coefficients of z^k up to the order are 1/k!.
TEST(ButcherTableau, StabilityFunctionIsTheExponentialToItsOrder) {
  for (const ButcherTableau& t : all_tableaus()) {
    const auto error = [&](double size) {
      const Complex z = size * Complex(0.6, 0.8);
      return std::abs(t.stability_function(z) - std::exp(z));
    };
    EXPECT_NEAR(std::log2(error(0.1) / error(0.05)), t.order() + 1, 0.1);
  }
  const Complex z(-0.7, 1.3);
  EXPECT_LT(std::abs(ButcherTableau::rk4().stability_function(z) -
                     (1.0 + z + z * z / 2.0 + z * z * z / 6.0 + z * z * z * z / 24.0)),
            1e-14);
}

// Each of the conditions of order 5 is seen: a method of order 5 and stages whose weights are moved along
// what keeps all but one of them cannot be written down simply, but a random change of one entry breaks some.
TEST(ButcherTableau, AChangedCoefficientLosesTheOrder) {
  const ButcherTableau t = ButcherTableau::dormand_prince();
  for (std::size_t i = 1; i < 7; ++i)
    for (std::size_t j = 0; j < i; ++j) {
      ButcherCoefficients c;
      for (std::size_t r = 0; r < 7; ++r) {
        c.a.emplace_back();
        for (std::size_t k = 0; k < r; ++k) c.a.back().push_back(t.a(r, k));
        c.b.push_back(t.b(r));
        c.c.push_back(t.c(r));
      }
      c.a[i][j] += 1e-3;
      c.c[i] += 1e-3;
      const int order = ButcherTableau(c).order();
      if (i < 6) {
        EXPECT_LT(order, 5) << i << " " << j;
      } else {
        EXPECT_EQ(order, 5);  // the last stage has no weight
      }
    }
}

TEST(ButcherTableau, RefusesByRowAndValue) {
  const auto said = [](const ButcherCoefficients& c) { return refusal([&] { return ButcherTableau(c); }); };
  EXPECT_EQ(said({}), "tableau: b has no entry");
  EXPECT_EQ(said({.a = {{}}, .b = {0.5, 0.5}, .c = {0, 1}}), "tableau: a has 1 rows for 2 stages");
  EXPECT_EQ(said({.a = {{}, {1}}, .b = {0.5, 0.5}, .c = {0}}), "tableau: c has 1 rows for 2 stages");
  EXPECT_EQ(said({.a = {{}, {1}}, .b = {0.5, 0.5}, .c = {0, 1}, .b_hat = {1}}),
            "tableau: b_hat has 1 rows for 2 stages");
  EXPECT_EQ(said({.a = {{0.5}, {0, 0.5}}, .b = {0.5, 0.5}, .c = {0.5, 0.5}}),
            "tableau: row 0 of a: 0.5 at stage 0 must be 0 (explicit)");
  EXPECT_EQ(said({.a = {{}, {1, 0, 0}}, .b = {0.5, 0.5}, .c = {0, 1}}),
            "tableau: row 1 of a: 3 entries for 2 stages");
  EXPECT_EQ(said({.a = {{}, {nan}}, .b = {0.5, 0.5}, .c = {0, 1}}),
            "tableau: row 1 of a: nan must be finite");
  EXPECT_EQ(said({.a = {{}, {1}}, .b = {0.5, 0.5}, .c = {0, inf}}),
            "tableau: row 1 of c: inf must be finite");
  EXPECT_EQ(said({.a = {{}, {1}}, .b = {0.5, 0.5}, .c = {0, 0.9}}),
            "tableau: row 1 of c: 0.9 must be the sum of a's row, 1");
  EXPECT_EQ(said({.a = {{}, {1}}, .b = {0.5, nan}, .c = {0, 1}}), "tableau: row 1 of b: nan must be finite");
  EXPECT_EQ(said({.a = {{}, {1}}, .b = {0.5, 0.4}, .c = {0, 1}}), "tableau: sum of b 0.9 must be 1");
  EXPECT_EQ(said({.a = {{}, {1}}, .b = {0.5, 0.5}, .c = {0, 1}, .b_hat = {1, 1}}),
            "tableau: sum of b_hat 2 must be 1");
}

// ---------------------------------------------------------------- numbers to meet

// The sizes of one step of an undamped oscillator, to the digits that they are given with.
TEST(Stability, SpectralRadiiWithoutDamping) {
  const auto of = [](const auto& R, double Omega) { return spectral_radius(R, Omega, 0); };
  for (const double O : {0.1, 1.0, 3.0}) {
    EXPECT_NEAR(of(function_of(ButcherTableau::explicit_euler()), O), std::sqrt(1 + O * O), 1e-14 * (1 + O));
    EXPECT_NEAR(of(stability::backward_euler, O), 1 / std::sqrt(1 + O * O), 1e-15);
    EXPECT_NEAR(of(stability::trapezoidal, O), 1, 1e-15);
    EXPECT_NEAR(spectral_radius(stability::newmark(0.25, 0.5, O, 0)), 1, 1e-15);
  }
  for (const double O : {1e-6, 0.5, 1.0, 1.999}) {
    EXPECT_EQ(spectral_radius(stability::semi_explicit_euler(O, 0)), 1);
    EXPECT_EQ(spectral_radius(stability::velocity_verlet(O, 0)), 1);
  }
  EXPECT_NEAR(spectral_radius(stability::semi_explicit_euler(2.1, 0)), 1.87733, 1e-5);
  EXPECT_NEAR(of(function_of(ButcherTableau::rk4()), 1), 0.993905, 1e-6);
  EXPECT_NEAR(of(stability::bdf2, 1), 0.933321, 1e-6);
  EXPECT_NEAR(of(stability::bdf2, 10), 0.300750, 1e-6);
  EXPECT_NEAR(spectral_radius(stability::hht(-0.05, 1, 0)), 0.996490, 1e-6);
  EXPECT_NEAR(spectral_radius(stability::hht(-0.05, 1e3, 0)), 0.904763, 1e-6);
  EXPECT_NEAR(spectral_radius(stability::generalised_alpha(0.5, 1, 0)), 0.989313, 1e-6);
  for (const double rho : {0.0, 0.3, 0.5, 0.8, 1.0})
    EXPECT_NEAR(spectral_radius(stability::generalised_alpha(rho, 1e6, 0)), rho, 2e-4) << rho;
}

// Where a method without damping stops to be stable.
TEST(Stability, LimitsOnTheImaginaryAxis) {
  const auto limit = [](const ButcherTableau& t) {
    double low = 0.5, high = 5;
    while (high - low > 1e-9) {
      const double middle = (low + high) / 2;
      (spectral_radius(function_of(t), middle, 0) <= 1 ? low : high) = middle;
    }
    return low;
  };
  EXPECT_NEAR(limit(ButcherTableau::rk4()), 2.8284271, 1e-7);
  EXPECT_NEAR(limit(ButcherTableau::kutta3()), 1.7320508, 1e-7);
  EXPECT_NEAR(limit(ButcherTableau::bogacki_shampine()), 1.7320508, 1e-7);
  EXPECT_GT(spectral_radius(function_of(ButcherTableau::midpoint()), 0.01, 0), 1 + 1e-10);
}

TEST(Stability, PeriodErrorsAndNumericalDamping) {
  constexpr double O = 0.5;
  const auto expect = [&](const Roots& roots, double period, double damping) {
    EXPECT_NEAR(stability::period_error(roots, O), period, 1e-6);
    EXPECT_NEAR(stability::damping_ratio(roots), damping, 1e-6);
  };
  expect(stability::semi_explicit_euler(O, 0), -0.010607, 0);
  expect(stability::velocity_verlet(O, 0), -0.010607, 0);
  expect(stability::roots(stability::trapezoidal, O, 0), 0.020497, 0);
  expect(stability::newmark(0.25, 0.5, O, 0), 0.020497, 0);
  expect(stability::roots(stability::bdf2, O, 0), 0.069350, 0.020628);
  expect(stability::roots(stability::backward_euler, O, 0), 0.078405, 0.240639);
  expect(stability::hht(-0.05, O, 0), 0.023166, 0.000633);
  // exp(z), the exact solution, has neither
  const auto exact = stability::roots([](Complex z) { return std::exp(z); }, O, 0.3);
  EXPECT_NEAR(stability::period_error(exact, O, 0.3), 0, 1e-14);
  EXPECT_NEAR(stability::damping_ratio(exact), 0.3 / std::sqrt(1 - 0.09), 1e-14);
  EXPECT_TRUE(std::isnan(stability::period_error(stability::semi_explicit_euler(3, 0), 3)));
  EXPECT_TRUE(std::isnan(stability::damping_ratio(stability::semi_explicit_euler(3, 0))));
}

TEST(Stability, DampedLimitsOfSemiExplicitAndExplicitEuler) {
  const double xi[] = {0, 0.1, 0.5, 1}, printed[] = {2, 1.809975, 1.236068, 0.828427};
  for (int k = 0; k < 4; ++k) {
    const double Omega = 2 * (std::sqrt(1 + xi[k] * xi[k]) - xi[k]);
    EXPECT_NEAR(Omega, printed[k], 1e-6);
    EXPECT_LE(spectral_radius(stability::semi_explicit_euler(Omega * (1 - 1e-9), xi[k])), 1);
    EXPECT_GT(spectral_radius(stability::semi_explicit_euler(Omega * (1 + 1e-9), xi[k])), 1);
  }
  const auto euler = function_of(ButcherTableau::explicit_euler());
  for (const double x : {0.1, 0.5, 0.9}) {
    EXPECT_LT(spectral_radius(euler, 2 * x * (1 - 1e-9), x), 1);
    EXPECT_GT(spectral_radius(euler, 2 * x * (1 + 1e-9), x), 1);
  }
  EXPECT_LT(spectral_radius(euler, 2 / (2 + std::sqrt(3.0)) * (1 - 1e-9), 2), 1);  // the fast real root
  EXPECT_GT(spectral_radius(euler, 2 / (2 + std::sqrt(3.0)) * (1 + 1e-9), 2), 1);
}

// ---------------------------------------------------------------- formulas against the steps they stand for

// Eigenvalues of a step written as a program, from its action on the unit vectors.
template <int n, class Step>
double radius_of(Step step) {
  Eigen::Matrix<double, n, n> A;
  for (int k = 0; k < n; ++k)
    A.col(k) = step(Eigen::Matrix<double, n, 1>(Eigen::Matrix<double, n, 1>::Unit(k)));
  return A.eigenvalues().cwiseAbs().maxCoeff();
}

TEST(Stability, SecondOrderMethodsAreTheirSteps) {
  using Vector2 = Eigen::Vector2d;
  using Vector3 = Eigen::Vector3d;
  for (const double O : {0.01, 0.3, 1.0, 2.5, 20.0})
    for (const double xi : {0.0, 0.02, 0.5, 1.0, 3.0}) {
      const double d = 2 * xi * O, o = O * O;
      const auto a = [=](double u, double w) { return -o * u - d * w; };
      // Roots are exact to half the digits only where two of them meet: at xi = 1, and at large steps.
      const auto expect = [&](const Roots& roots, double radius) {
        EXPECT_NEAR(spectral_radius(roots), radius, (xi == 1 || O > 10 ? 1e-6 : 1e-11) * (1 + radius))
            << O << " " << xi;
      };
      expect(stability::semi_explicit_euler(O, xi), radius_of<2>([&](const Vector2& s) {
               const double w = s[1] + a(s[0], s[1]);
               return Vector2(s[0] + w, w);
             }));
      expect(stability::velocity_verlet(O, xi), radius_of<2>([&](const Vector2& s) {
               const double start = a(s[0], s[1]), half = s[1] + start / 2, u = s[0] + half;
               return Vector2(u, half + a(u, s[1] + start) / 2);
             }));
      // a_1 from its equation of motion, everything else from Newmark's formulas
      const auto alpha = [&](double alpha_m, double alpha_f, double beta, double gamma) {
        return radius_of<3>([=](const Vector3& s) {
          const auto residual = [&](double a_1) {
            const double u_1 = s[0] + s[1] + (0.5 - beta) * s[2] + beta * a_1;
            const double w_1 = s[1] + (1 - gamma) * s[2] + gamma * a_1;
            return (1 - alpha_m) * a_1 + alpha_m * s[2] -
                   a((1 - alpha_f) * u_1 + alpha_f * s[0], (1 - alpha_f) * w_1 + alpha_f * s[1]);
          };
          const double a_1 = -residual(0) / (residual(1) - residual(0));
          return Vector3(s[0] + s[1] + (0.5 - beta) * s[2] + beta * a_1,
                         s[1] + (1 - gamma) * s[2] + gamma * a_1, a_1);
        });
      };
      expect(stability::newmark(0.25, 0.5, O, xi), alpha(0, 0, 0.25, 0.5));
      expect(stability::newmark(0.3, 0.6, O, xi), alpha(0, 0, 0.3, 0.6));
      expect(stability::hht(-0.2, O, xi), alpha(0, 0.2, 0.36, 0.7));
      for (const double rho : {0.2, 0.8}) {
        const double m = (2 * rho - 1) / (rho + 1), f = rho / (rho + 1);
        expect(stability::generalised_alpha(rho, O, xi),
               alpha(m, f, (1 - m + f) * (1 - m + f) / 4, 0.5 - m + f));
      }
    }
}

TEST(Stability, BDF2IsItsRecurrence) {
  for (const double O : {0.1, 1.0, 10.0})
    for (const double xi : {0.0, 0.5, 2.0})
      for (const Complex z : stability::oscillator(O, xi)) {
        const Complex r = stability::bdf2(z);
        EXPECT_LT(std::abs((1.5 - z) * r * r - 2.0 * r + 0.5), 1e-13 * (1 + O));
        EXPECT_GE(std::abs(r), std::abs(0.5 / (1.5 - z) / r) - 1e-12);  // the other root
      }
}

// Implicit methods do not grow for any step and damping; explicit ones of small steps neither.
TEST(Stability, StableMethodsAreSeenToBe) {
  for (double O = 1e-9; O < 1e6; O *= 3)
    for (const double xi : {0.0, 1e-6, 0.1, 1.0, 10.0}) {
      constexpr double one = 1 + 1e-14;
      EXPECT_LE(spectral_radius(stability::backward_euler, O, xi), one);
      EXPECT_LE(spectral_radius(stability::trapezoidal, O, xi), one);
      EXPECT_LE(spectral_radius(stability::bdf2, O, xi), one) << O << " " << xi;
      EXPECT_LE(spectral_radius(stability::newmark(0.25, 0.5, O, xi)), one) << O << " " << xi;
      EXPECT_LE(spectral_radius(stability::hht(-0.1, O, xi)), one) << O << " " << xi;
      EXPECT_LE(spectral_radius(stability::generalised_alpha(0.5, O, xi)), one) << O << " " << xi;
      if (O * (1 + xi) < 0.1) {
        EXPECT_LE(spectral_radius(stability::semi_explicit_euler(O, xi)), one) << O << " " << xi;
        EXPECT_LE(spectral_radius(stability::velocity_verlet(O, xi)), one) << O << " " << xi;
      }
    }
}

// theta contains the others.
TEST(Stability, ThetaMethod) {
  const Complex z(-0.3, 1.2);
  EXPECT_LT(std::abs(stability::theta(0, z) - (1.0 + z)), 1e-15);
  EXPECT_LT(std::abs(stability::theta(1, z) - stability::backward_euler(z)), 1e-15);
  EXPECT_LT(std::abs(stability::theta(0.5, z) - stability::trapezoidal(z)), 1e-15);
}

}  // namespace stability_test
