// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include "softsim/core/error.hpp"
#include "softsim/solver/direct.hpp"
#include "softsim/solver/report.hpp"
#include "softsim/solver/stationary.hpp"
#include "softsim/system/incremental_potential.hpp"
#include "softsim/system/supports.hpp"
#include "softsim/system/system.hpp"

namespace softsim {

/// Options of `ArcLength` with the given linear method.
template <class Method = Stationary>
struct ArcLengthOptions {
  double length = 0;          ///< of a step: norm of the increments of all displacements, m
  double tolerance = 1e-8;    ///< |residual| over the norm of the full load
  int max_iterations = 25;    ///< of Newton's method, in one step
  int wanted_iterations = 4;  ///< the length follows the number of iterations; 0: it stays
  double smallest = 1e-3;     ///< part of `length` below which a step gives up
  double largest = 1;         ///< part of `length` that a step never exceeds
  Method linear = {};         ///< has to cope with indefinite tangents past a limit point
};

/// Follows the path of equilibria under `load()` times the loads from outside past limit points, where the
/// load falls while the body goes on: snap-through, snap-back. Newton's method with the load factor as one
/// more unknown and the length of the increment given (Riks 1979; Crisfield 1981, cylindrical: "A fast
/// incremental/iterative solution procedure that handles snap-through"). Every step is one equilibrium
/// farther along. Loads from outside must not depend on the state; prescribed components have to be in place.
///
/// Tangents are indefinite on falling branches, which the direct solver does not mind; `Minres` with
/// `BlockJacobi` does without it.
template <class S, class Operator = Assembled, template <class> class Preconditioner = Ldlt,
          class Method = Stationary>
class ArcLength {
 public:
  using T = typename S::Scalar;
  using Options = ArcLengthOptions<Method>;

  Preconditioner<T> preconditioner;  ///< public for the sake of its own options

  /// @throws std::invalid_argument for options out of their range
  explicit ArcLength(const Options& options) : options_(options), part_(options.largest) {
    const auto positive = [](const char* name, double value) {
      if (!(value > 0) || !(value <= 1e300))
        invalid(std::string(name) + " " + to_text(value) + ": must be positive and finite");
    };
    positive("arc length", options.length);
    positive("tolerance", options.tolerance);
    positive("smallest part of the arc length", options.smallest);
    positive("largest part of the arc length", options.largest);
    if (options.max_iterations < 1)
      invalid(std::string("max_iterations ") + std::to_string(options.max_iterations) +
              ": must be at least 1");
  }

  /// Part of the load that the last state is in equilibrium with; the path starts with 0.
  [[nodiscard]] double load() const { return load_; }

  /// Moves q, an equilibrium under `load()` (at first: under no load), to the next one. On failure q and the
  /// load stay.
  /// @throws std::invalid_argument, before anything moves, if a piece of the system is not held or a
  /// prescribed component is not in place
  StepReport step(const S& system, State<T>& q) {
    using detail::ended;
    require_supports(system);
    along_.resize(system.size());
    if (const double left = system.prescribed.increment(q, along_); left > 0)
      invalid(std::string("arc length: a prescribed component still has ") + to_text(left) + " m to go");
    force_.setZero(system.size());
    system.add_external_gradient(q, force_);
    system.prescribed.mask(force_);
    force_ = -force_;
    const double size = norm(force_);
    if (!(size > 0) || !std::isfinite(size))
      invalid(std::string("arc length: the norm of the load is ") + to_text(size) +
              " N; must be positive and finite");
    StepReport total;
    for (;;) {
      const StepReport report = attempt(system, q, part_ * options_.length, size);
      total.newton_iterations += report.newton_iterations;
      total.linear_iterations += report.linear_iterations;
      total.residual = report.residual;
      if (report.status == Status::converged) {
        if (options_.wanted_iterations > 0)
          part_ *= std::clamp(std::sqrt(static_cast<double>(options_.wanted_iterations) /
                                        std::max(1, report.newton_iterations)),
                              0.5, 2.0);
        part_ = std::clamp(part_, options_.smallest, options_.largest);
        return ended(total, Status::converged, "");
      }
      if (part_ <= options_.smallest) return ended(total, report.status, report.reason);
      part_ = std::max(part_ / 2, options_.smallest);
    }
  }

 private:
  // K x = b from zero.
  bool solve(const Vector<T>& b, Vector<T>& x, StepReport& report) {
    x.setZero(b.size());
    Method linear = options_.linear;
    if (!linear.fixed) linear.tolerance = std::min(linear.tolerance, 1e-3);
    const LinearReport solved = linear.solve(tangent_, preconditioner, b, x, workspace_);
    report.linear_iterations += solved.iterations;
    report.reason = solved.reason;
    report.status = solved.status;
    return solved.status == Status::converged;
  }

  StepReport attempt(const S& system, State<T>& q, double length, double size) {
    using detail::ended;
    StepReport report;
    trial_ = q;
    double load = load_;
    total_.setZero(q.size());
    for (;; ++report.newton_iterations) {
      potential_.set_static(system, q, load);
      (void)potential_.gradient(trial_, residual_);
      system.prescribed.mask(residual_);
      report.residual = norm(residual_) / size;
      if (!std::isfinite(report.residual))
        return ended(report, Status::not_finite, "the residual is not finite");
      if (report.newton_iterations > 0 && report.residual <= options_.tolerance) break;
      if (report.newton_iterations == options_.max_iterations)
        return ended(report, Status::not_converged, "arc length: too many iterations");
      potential_.linearise(trial_, tangent_);
      preconditioner.compute(tangent_, system.prescribed.free());
      if (!solve(force_, along_, report)) return report;
      residual_ = -residual_;
      double change = 0;
      if (report.newton_iterations == 0) {
        // forward along the path: as the last increment went, at first with a growing load
        const double forward = last_.size() == along_.size() ? dot(last_, along_) : 1;
        change = (forward < 0 ? -length : length) / norm(along_);
        total_ = static_cast<T>(change) * along_;
      } else {
        if (!solve(residual_, correction_, report)) return report;
        // |total + correction + change along| = length
        correction_ += total_;
        const double a = dot(along_, along_), b = dot(along_, correction_),
                     c = dot(correction_, correction_) - length * length, discriminant = b * b - a * c;
        if (!(discriminant >= 0))
          return ended(report, Status::not_converged, "arc length: no increment of this length");
        // of both the one that turns the increment less
        const double root = std::sqrt(discriminant);
        change = (-b + (dot(total_, along_) >= 0 ? root : -root)) / a;
        total_ = correction_ + static_cast<T>(change) * along_;
      }
      load += change;
      trial_ = q;
      retract(trial_, total_);
    }
    q.displacement.swap(trial_.displacement);
    load_ = load;
    last_ = total_;
    return ended(report, Status::converged, "");
  }

  Options options_;
  double part_, load_ = 0;
  IncrementalPotential<S> potential_;
  typename Operator::template Tangent<S> tangent_;
  typename Method::template Workspace<T> workspace_;
  Vector<T> force_, along_, residual_, correction_, total_, last_;
  State<T> trial_;
};

}  // namespace softsim
