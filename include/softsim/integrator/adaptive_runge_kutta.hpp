// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>

#include "softsim/core/error.hpp"
#include "softsim/core/state.hpp"
#include "softsim/integrator/runge_kutta.hpp"

namespace softsim {

/// Options of `AdaptiveRungeKutta`.
struct AdaptiveRungeKuttaOptions {
  double dt = 0;                     ///< first step to be tried, s
  double position_tolerance = 1e-6;  ///< error of a step in any component, m
  double velocity_tolerance = 1e-6;  ///< the same of a velocity, m/s
  double relative_tolerance = 0;     ///< added: times the step's largest displacement
                                     ///< and the largest velocity, components both
  double dt_min = 1e-12;             ///< s; steps below are not tried again
  double dt_max = 1e300;             ///< s
  double safety = 0.9;               ///< of the step that would just do
  double shrink = 0.1;               ///< the next step is at least this times the last
  double grow = 5;                   ///< and at most this
  bool smooth = true;                ///< PI controller rather than the elementary one
  ButcherTableau tableau = ButcherTableau::dormand_prince();            ///< with embedded weights
  ConjugateGradient linear{.max_iterations = 500, .tolerance = 1e-12};  ///< for a consistent mass matrix only
};

/// How a step of `AdaptiveRungeKutta` ended.
struct [[nodiscard]] AdaptiveStepReport : StepReport {
  double dt = 0;     ///< step taken, s; 0 if none was
  double error = 0;  ///< estimate of the last attempt over the tolerance
  int rejected = 0;  ///< attempts before it
};

/// Explicit Runge-Kutta with the step chosen by an embedded error estimate (d'Aulignac 2001, Sec. 3.4.1;
/// Hairer, Norsett & Wanner 1993, Sec. II.4; PI controller of Gustafsson 1991). One `step` is one accepted
/// step; an attempt whose error is above the tolerance, or which is not finite, is made again with a smaller
/// one.
///
/// Prescribed components keep through all attempts the velocity with which they would reach their targets
/// after `dt()`: after a shorter step they are part of the way there, on the same straight line.
template <class S>
class AdaptiveRungeKutta {
 public:
  using T = typename S::Scalar;

  /// @throws std::invalid_argument unless the tableau has an embedded method of another order, dt, the
  /// absolute tolerances and dt_min are positive, dt_min <= dt <= dt_max, 0 < safety < 1, 0 < shrink < 1 <
  /// grow
  explicit AdaptiveRungeKutta(const AdaptiveRungeKuttaOptions& options)
      : options_(options), dt_(options.dt), stages_(options.tableau, options.linear) {
    detail::check_dt(options.dt);
    const auto require = [](bool holds, const char* name, double value, const char* what) {
      if (!holds) invalid(std::string(name) + " " + to_text(value) + ": must be " + what);
    };
    const auto require_positive = [&](const char* name, double x) {
      require(x > 0 && x <= 1e300, name, x, "positive and finite");
    };
    require_positive("position_tolerance", options.position_tolerance);
    require_positive("velocity_tolerance", options.velocity_tolerance);
    require(options.relative_tolerance >= 0 && options.relative_tolerance <= 1e300, "relative_tolerance",
            options.relative_tolerance, "at least 0 and finite");
    require_positive("dt_min", options.dt_min);
    require(options.dt_min <= options.dt, "dt_min", options.dt_min, "at most dt");
    require(options.dt_max >= options.dt, "dt_max", options.dt_max, "at least dt");
    require(options.safety > 0 && options.safety < 1, "safety", options.safety, "in (0, 1)");
    require(options.shrink > 0 && options.shrink < 1, "shrink", options.shrink, "in (0, 1)");
    require(options.grow > 1 && options.grow <= 1e300, "grow", options.grow, "above 1 and finite");
    const ButcherTableau& t = options.tableau;
    if (!t.has_embedded()) invalid("tableau: must have embedded weights b_hat");
    if (t.order() == t.embedded_order())
      invalid(std::string("tableau: embedded order ") + std::to_string(t.embedded_order()) +
              " must differ from the order");
    exponent_ = 1.0 / (std::min(t.order(), t.embedded_order()) + 1);
  }

  /// The step that is tried next, s.
  [[nodiscard]] double dt() const { return dt_; }
  /// Changes it, to meet an end time for instance; it may be below dt_min, but is then not tried again.
  /// @throws std::invalid_argument unless it is positive
  void set_dt(double dt) {
    detail::check_dt(dt);
    dt_ = dt;
  }
  /// The method.
  [[nodiscard]] const ButcherTableau& tableau() const { return stages_.tableau(); }
  /// Growth of an oscillator's amplitude over one step.
  [[nodiscard]] double spectral_radius(double Omega, double xi) const {
    const auto R = [&](stability::Complex z) { return tableau().stability_function(z); };
    return stability::spectral_radius(R, Omega, xi);
  }

  /// Advances the motion by one accepted step of at most dt(), and sets dt() for the next. Where a step of
  /// dt_min does not do either, the motion stays as it was: `not_converged` if its error is too large,
  /// `not_finite` if it is that. dt() is then what it was before the call.
  AdaptiveStepReport step(Stepped<S> system, Motion<T>& motion) {
    AdaptiveStepReport report;
    Acceleration<S>::prescribed_velocity(system, motion.q, static_cast<T>(dt_), p_);
    for (double h = dt_;; ++report.rejected) {
      static_cast<StepReport&>(report) = stages_.advance(system, motion, h, p_, next_, v_);
      report.error = report.status == Status::not_finite ? std::numeric_limits<double>::infinity()
                                                         : relative_error(motion, h);
      if (report.error <= 1) {
        accept(system, motion, h, report);
        return report;
      }
      if (!(h > options_.dt_min)) {
        if (report.status != Status::not_finite) {
          report.status = Status::not_converged;
          report.reason = "the error is above the tolerance with the smallest step";
        }
        return report;
      }
      // An error that is NaN or infinite says nothing about the size that would do.
      const double factor = options_.safety * std::pow(report.error, -exponent_);
      h = std::max(options_.dt_min, h * std::clamp(factor, options_.shrink, options_.safety));
    }
  }

 private:
  void accept(Stepped<S> system, Motion<T>& motion, double h, AdaptiveStepReport& report) {
    motion.q.displacement.swap(next_.displacement);
    motion.v.swap(v_);
    motion.time += h;
    if constexpr (S::has_memory) system.end_step(motion.q, motion.v, h);
    report.dt = h;
    // Estimates of 0, from a body that falls for instance, must not make the power infinite.
    const double error = std::max(report.error, 1e-10);
    const double factor = options_.smooth
                              ? std::pow(error, -0.7 * exponent_) * std::pow(last_error_, 0.4 * exponent_)
                              : std::pow(error, -exponent_);
    last_error_ = error;
    // After a rejection the step does not grow at once: it was too large a moment ago.
    const double most = report.rejected > 0 ? 1 : options_.grow;
    dt_ = std::clamp(h * std::clamp(options_.safety * factor, options_.shrink, most),
                     std::min(options_.dt_min, h), options_.dt_max);
  }

  // Largest component of the estimate over its tolerance.
  double relative_error(const Motion<T>& motion, double h) {
    stages_.error(h, error_u_, error_v_);
    const auto largest = [](const Vector<T>& x) {
      return x.size() == 0 ? 0.0 : static_cast<double>(x.cwiseAbs().maxCoeff());
    };
    const double u = options_.position_tolerance + options_.relative_tolerance * largest(stages_.increment());
    const double v =
        options_.velocity_tolerance + options_.relative_tolerance * std::max(largest(motion.v), largest(v_));
    // maxCoeff may step over a NaN; the norm does not.
    if (!std::isfinite(norm(error_u_)) || !std::isfinite(norm(error_v_)))
      return std::numeric_limits<double>::infinity();
    return std::max(largest(error_u_) / u, largest(error_v_) / v);
  }

  AdaptiveRungeKuttaOptions options_;
  double dt_, exponent_ = 1, last_error_ = 1;
  RungeKuttaStages<S> stages_;
  Vector<T> p_, v_, error_u_, error_v_;
  State<T> next_;
};

}  // namespace softsim
