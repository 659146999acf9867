// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/material/prony.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

namespace prony_test {

using softsim::PronySeries, softsim::PronyTerm, softsim::PronyUpdate;

const std::vector<PronyTerm> two_terms{{0.2, 0.4}, {0.35, 3}};

// f - sum gamma_k at t = steps dt for the input f, from gamma = 0 at t = 0.
double response(const PronySeries& series, const std::function<double(double)>& f, double dt, int steps) {
  double sum = f(dt * steps);
  for (std::size_t k = 0; k < series.terms().size(); ++k) {
    const auto [decay, start, end] = series.coefficients(k, dt);
    double gamma = 0;
    for (int n = 0; n < steps; ++n) gamma = decay * gamma + start * f(dt * n) + end * f(dt * (n + 1));
    sum -= gamma;
  }
  return sum;
}
double one(double) { return 1; }

std::string refusal(std::vector<PronyTerm> terms) {
  try {
    (void)PronySeries(std::move(terms));
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return {};
}

// Reference values to ten digits.
TEST(PronySeries, FollowsThePapersRecursionAfterAStep) {
  const PronySeries paper({{0.3, 0.5}}, PronyUpdate::first_order);
  EXPECT_NEAR(paper.relaxation(1), 0.7406005850, 1e-10);
  EXPECT_NEAR(response(paper, one, 0.01, 100), 0.7414098902, 1e-10);
  EXPECT_NEAR(response(paper, one, 0.001, 1000), 0.7406817591, 1e-10);
}

// gamma = alpha (1 - (1 + x)^-n) lags by alpha exp(-t/tau) t dt/(2 tau^2), at most alpha dt/(2 e tau), at t =
// tau; to which a step of this size adds terms of some dt/tau of it.
TEST(PronySeries, FirstOrderUpdateIsWithinItsBoundAllAlongTheCurve) {
  const double dt = 0.01;
  for (const auto& terms :
       {std::vector<PronyTerm>{{0.3, 0.5}}, std::vector<PronyTerm>{{0.3, 0.6}}, two_terms}) {
    const PronySeries paper(terms, PronyUpdate::first_order);
    double bound = 0, worst = 0;
    for (const PronyTerm& k : terms) bound += k.weight * dt / (2 * k.time) * std::exp(-1.0);
    for (int n = 1; n <= 300; ++n)
      worst = std::max(worst, std::abs(response(paper, one, dt, n) - paper.relaxation(n * dt)));
    EXPECT_LE(worst, 1.03 * bound);
    if (terms[0].time != 0.5) {
      EXPECT_LT(worst, 1e-3);
    }
  }
}

TEST(PronySeries, ExponentialUpdateIsExactForAStepAndARamp) {
  const PronySeries series(two_terms);
  for (const double dt : {1e-6, 0.01, 0.5, 20.0}) {
    const double t = 4 * dt;
    EXPECT_NEAR(response(series, one, dt, 4), series.relaxation(t), 1e-14);
    double ramp = t;  // t - sum alpha (t - tau (1 - exp(-t/tau)))
    for (const auto [weight, time] : two_terms) ramp -= weight * (t + time * std::expm1(-t / time));
    EXPECT_NEAR(response(
                    series, [](double s) { return s; }, dt, 4) /
                    t,
                ramp / t, 1e-10);
  }
}

// f = sin t: tau gamma' + gamma = alpha f has gamma = alpha (sin t - tau cos t + tau exp(-t/tau))/(1 +
// tau^2).
TEST(PronySeries, UpdatesConvergeWithTheirOrders) {
  const auto error = [](PronyUpdate update, int steps) {
    const PronySeries series({{0.4, 0.7}}, update);
    const double tau = 0.7, t = 2;
    const double exact =
        std::sin(t) - 0.4 * (std::sin(t) - tau * std::cos(t) + tau * std::exp(-t / tau)) / (1 + tau * tau);
    return std::abs(response(
                        series, [](double s) { return std::sin(s); }, t / steps, steps) -
                    exact);
  };
  for (const int n : {50, 100}) {
    EXPECT_NEAR(std::log2(error(PronyUpdate::first_order, n) / error(PronyUpdate::first_order, 2 * n)), 1,
                0.03);
    EXPECT_NEAR(std::log2(error(PronyUpdate::exponential, n) / error(PronyUpdate::exponential, 2 * n)), 2,
                0.03);
  }
}

TEST(PronySeries, KeepsWhatAStepOfNoLengthFinds) {
  for (const auto update : {PronyUpdate::first_order, PronyUpdate::exponential}) {
    const PronySeries series(two_terms, update);
    const auto [decay, start, end] = series.coefficients(1, 0);
    EXPECT_EQ(decay, 1);
    EXPECT_EQ(start, 0);
    EXPECT_EQ(end, 0);
    EXPECT_NEAR(series.relaxed(), 0.45, 1e-15);
    EXPECT_EQ(series.relaxation(0), 1);
    EXPECT_NEAR(series.relaxation(1e9), 0.45, 1e-15);
    const auto late = series.coefficients(0, 1e300);  // longer than all memory
    EXPECT_NEAR(late.decay + late.start, 0, 1e-15);
    EXPECT_NEAR(late.end, 0.2, 1e-15);
  }
  EXPECT_EQ(PronySeries().relaxation(3), 1);
}

TEST(PronySeries, RefusesWhatIsNoRelaxation) {
  EXPECT_EQ(refusal({{0.1, 1}, {0.1, 0}}), "Prony term 1: relaxation time 0 s must be positive and finite");
  EXPECT_EQ(refusal({{0.1, -2}}), "Prony term 0: relaxation time -2 s must be positive and finite");
  EXPECT_NE(refusal({{0.1, std::nan("")}}), "");
  EXPECT_NE(refusal({{0.1, HUGE_VAL}}), "");
  EXPECT_EQ(refusal({{-0.1, 1}}), "Prony term 0: weight -0.1 must lie in [0, 1)");
  EXPECT_EQ(refusal({{1, 1}}), "Prony term 0: weight 1 must lie in [0, 1)");
  EXPECT_NE(refusal({{std::nan(""), 1}}), "");
  EXPECT_EQ(refusal({{0.6, 1}, {0.5, 2}}), "Prony series: the sum of its weights 1.1 must be less than 1");
  EXPECT_NE(refusal({{0.5, 1}, {0.5, 2}}), "");
  EXPECT_EQ(refusal({{0.5, 1}, {0.499, 2}}), "");
}

}  // namespace prony_test
