// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "softsim/core/error.hpp"

namespace softsim {

/// One term of a Prony series.
struct PronyTerm {
  double weight;  ///< alpha, the share of the response that relaxes
  double time;    ///< tau, its relaxation time, s
};

/// How the history of a Prony series is carried over one step.
enum class PronyUpdate {
  first_order,  ///< gamma_1 = (dt alpha f_1 + tau gamma_0)/(dt + tau) (Goulette & Chen 2015, Eq. 20)
  exponential   ///< exact for a response that is linear over each step, second order for any other
};

/// What a static solve sees of a viscoelastic body.
enum class StaticResponse {
  relaxed,       ///< the load has acted for ever: the elastic response times 1 - sum alpha
  instantaneous  ///< the load has just been put on: the full elastic response
};

/// Relaxation function 1 - sum_k alpha_k (1 - exp(-t/tau_k)) (Goulette & Chen 2015, Eq. 16). The viscoelastic
/// response is f - sum_k gamma_k with tau_k gamma_k' + gamma_k = alpha_k f, which is the convolution of f'
/// with the relaxation function (Eqs. 17 and 18 without their minus sign).
class PronySeries {
 public:
  /// gamma_1 = decay gamma_0 + start f_0 + end f_1 over one step.
  struct Coefficients {
    double decay, start, end;
  };

  /// @throws std::invalid_argument unless every time is positive, every weight in [0, 1) and their sum below
  /// 1
  explicit PronySeries(std::vector<PronyTerm> terms = {}, PronyUpdate update = PronyUpdate::exponential)
      : terms_(std::move(terms)), update_(update) {
    for (std::size_t k = 0; k < terms_.size(); ++k) {
      const auto [weight, time] = terms_[k];
      const std::string term = std::string("Prony term ") + std::to_string(k);
      if (!(time > 0) || !(time <= 1e300))
        invalid(term + ": relaxation time " + to_text(time) + " s must be positive and finite");
      if (!(weight >= 0) || !(weight < 1))
        invalid(term + ": weight " + to_text(weight) + " must lie in [0, 1)");
      relaxed_ -= weight;
    }
    if (!(relaxed_ > 1e-12))  // weights that add up to 1 but for rounding
      invalid(std::string("Prony series: the sum of its weights ") + to_text(1 - relaxed_) +
              " must be less than 1");
  }

  /// The terms.
  [[nodiscard]] const std::vector<PronyTerm>& terms() const { return terms_; }
  /// How the history is carried over a step.
  [[nodiscard]] PronyUpdate update() const { return update_; }
  /// 1 - sum alpha_k, the share of the response that stays for ever.
  [[nodiscard]] double relaxed() const { return relaxed_; }
  /// Relaxation function at the time t >= 0 in s.
  [[nodiscard]] double relaxation(double t) const {
    double sum = 1;
    for (const PronyTerm& k : terms_) sum += k.weight * std::expm1(-t / k.time);
    return sum;
  }
  /// Coefficients of term k over a step of dt >= 0 in s.
  [[nodiscard]] Coefficients coefficients(std::size_t k, double dt) const {
    if (dt == 0) return {1, 0, 0};
    const auto [weight, time] = terms_[k];
    if (update_ == PronyUpdate::first_order) return {time / (dt + time), 0, dt * weight / (dt + time)};
    const double x = dt / time, decay = std::exp(-x),
                 mean = -std::expm1(-x) / x;  // mean of exp over the step
    return {decay, weight * (mean - decay), weight * (1 - mean)};
  }

 private:
  std::vector<PronyTerm> terms_;
  PronyUpdate update_;
  double relaxed_ = 1;
};

/// Coefficients of all terms of a series over the current step. The response at the end of the step is
/// `instant` f_1 - history; for a step of no length that is f - sum gamma_k.
class PronyStep {
 public:
  /// A step of no length.
  explicit PronyStep(const PronySeries& series) : terms(series.terms().size()) { set(series, 0); }

  /// A step of dt >= 0 in s.
  void set(const PronySeries& series, double dt) {
    instant = 1;
    start = 0;
    for (std::size_t k = 0; k < terms.size(); ++k) {
      terms[k] = series.coefficients(k, dt);
      instant -= terms[k].end;
      start += terms[k].start;
    }
  }

  std::vector<PronySeries::Coefficients> terms;
  double instant = 1;  ///< 1 - sum of the terms' `end`
  double start = 0;    ///< sum of the terms' `start`
};

}  // namespace softsim
