// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "softsim/core/state.hpp"
#include "softsim/solver/conjugate_gradient.hpp"
#include "softsim/solver/preconditioner.hpp"
#include "softsim/solver/report.hpp"
#include "softsim/system/incremental_potential.hpp"
#include "softsim/system/tangent.hpp"

namespace softsim {

/// Options of `Newton`.
struct NewtonOptions {
  int max_iterations = 200;
  double tolerance = 1e-6;  ///< on |residual| over the norm that IncrementalPotential::gradient returns
  ConjugateGradient linear =
      {};                 ///< its tolerance is replaced by a forcing term in every iteration but a single one
  int max_halvings = 30;  ///< of the step, in the line search
};

/// Minimises an incremental potential by Newton's method with conjugate gradients and a backtracking line
/// search. The linear systems are solved only as far as the residual warrants (inexact Newton); a direction
/// of negative curvature ends a linear solve and leaves a descent direction. Prescribed components that are
/// not in place yet move with the linearised system, so that a large prescribed displacement does not crush
/// the elements next to it. Holds its work vectors: after the first solve of a system nothing is allocated.
template <class S, class Operator = Assembled, template <class> class Preconditioner = BlockJacobi>
class Newton {
 public:
  using T = typename S::Scalar;

  NewtonOptions options;

  /// @throws std::invalid_argument for a tolerance <= 0 or fewer than one iteration
  explicit Newton(const NewtonOptions& options_ = {}) : options(options_) {
    if (!(options.tolerance > 0))
      invalid(std::string("tolerance ") + to_text(options.tolerance) + ": must be positive");
    if (options.max_iterations < 1)
      invalid(std::string("max_iterations ") + std::to_string(options.max_iterations) +
              ": must be at least 1");
  }

  /// Moves q to a minimum of the potential. On failure q is the last finite iterate.
  StepReport minimise(const IncrementalPotential<S>& potential, State<T>& q) {
    StepReport report;
    double reference = potential.gradient(q, g_);
    for (;; ++report.newton_iterations) {
      const double pending = prepare(potential, q);
      const double residual = norm(r_);
      report.residual = residual == 0 ? 0 : residual / reference;
      if (!std::isfinite(residual)) return ended(report, Status::not_finite, "the residual is not finite");
      if (pending == 0 && residual <= options.tolerance * reference)
        return ended(report, Status::converged, "");
      if (report.newton_iterations == options.max_iterations)
        return ended(report, Status::not_converged, "Newton: too many iterations");

      ConjugateGradient linear = options.linear;
      const double relative = reference > 0 ? report.residual : 1;
      linear.tolerance =
          std::clamp(relative, std::min(0.1, 0.3 * options.tolerance / std::max(relative, 1e-300)), 0.1);
      x_.setZero(q.size());
      const LinearReport solved = solve(potential, q, pending, linear);
      report.linear_iterations += solved.iterations;
      if (solved.status == Status::not_finite)
        return ended(report, Status::not_finite, "the linear solve is not finite");
      if (solved.iterations == 0 && solved.indefinite) preconditioner_.apply(b_, x_);
      if (pending > 0) x_ += delta_;

      if (!line_search(potential, q, residual, pending > 0, reference))
        return ended(report, Status::not_converged, "Newton: the line search found no decrease");
    }
  }

  /// One linearised solve from q: the direction x of a full step, warm-started from the x given. Prescribed
  /// increments are included. `tolerance` of the linear options applies.
  LinearReport linear_step(const IncrementalPotential<S>& potential, const State<T>& q, Vector<T>& x) {
    potential.gradient(q, g_);
    const double pending = prepare(potential, q);
    if (!std::isfinite(norm(r_))) return {.status = Status::not_finite};
    x_ = x;
    potential.system().prescribed.mask(x_);
    const LinearReport report = solve(potential, q, pending, options.linear);
    x = x_;
    if (pending > 0) x += delta_;
    return report;
  }

  /// The tangent of the last linearisation.
  [[nodiscard]] const auto& tangent() const { return tangent_; }

 private:
  static StepReport ended(StepReport report, Status status, std::string_view reason) {
    report.status = status;
    report.reason = reason;
    return report;
  }

  // r = free part of the gradient g; delta = what prescribed components still have to move.
  double prepare(const IncrementalPotential<S>& potential, const State<T>& q) {
    r_ = g_;
    potential.system().prescribed.mask(r_);
    delta_.resize(q.size());
    return potential.system().prescribed.increment(q, delta_);
  }

  LinearReport solve(const IncrementalPotential<S>& potential, const State<T>& q, double pending,
                     const ConjugateGradient& linear) {
    potential.linearise(q, tangent_);
    preconditioner_.compute(tangent_, potential.system().prescribed.free());
    b_ = -r_;
    trial_gradient_.resize(q.size());
    if (pending > 0) {
      tangent_.apply(delta_, trial_gradient_);
      b_ -= trial_gradient_;
    }
    return linear.solve(tangent_, preconditioner_, b_, x_, cg_);
  }

  // Moves q along x_ and leaves the gradient there in g_. False if no decrease was found; q is unchanged
  // then.
  bool line_search(const IncrementalPotential<S>& potential, State<T>& q, double residual,
                   bool prescribed_moves, double& reference) {
    const double slope = dot(r_, x_);
    double before = 0;
    if constexpr (S::conservative) before = potential.value(q);
    T step = T(1);
    for (int k = 0; k <= options.max_halvings; ++k, step /= 2) {
      trial_ = q;
      retract(trial_, x_, step);
      bool accepted = prescribed_moves;
      if constexpr (S::conservative) {
        const double after = potential.value(trial_);
        if (!std::isfinite(after)) continue;
        if (!accepted && slope < 0) accepted = after <= before + 1e-4 * static_cast<double>(step) * slope;
        // A decrease too small for the values to show is left to the gradient (after Hager & Zhang 2005).
        const bool visible = static_cast<double>(step) * std::abs(slope) >
                             std::sqrt(static_cast<double>(std::numeric_limits<T>::epsilon())) *
                                 std::max(std::abs(before), std::abs(after));
        if (!accepted && visible) continue;
      }
      const double reference_there = potential.gradient(trial_, trial_gradient_);
      r_ = trial_gradient_;
      potential.system().prescribed.mask(r_);
      const double residual_there = norm(r_);
      if (!std::isfinite(residual_there)) continue;
      if (!accepted) accepted = residual_there <= (1 - 1e-4 * static_cast<double>(step)) * residual;
      if constexpr (S::conservative) accepted = accepted || std::abs(dot(r_, x_)) <= 0.9 * std::abs(slope);
      if (!accepted) continue;
      reference = reference_there;
      std::swap(q.displacement, trial_.displacement);
      g_.swap(trial_gradient_);
      return true;
    }
    return false;
  }

  typename Operator::template Tangent<S> tangent_;
  Preconditioner<T> preconditioner_;
  ConjugateGradient::Workspace<T> cg_;
  Vector<T> g_, r_, b_, x_, delta_, trial_gradient_;
  State<T> trial_;
};

}  // namespace softsim
