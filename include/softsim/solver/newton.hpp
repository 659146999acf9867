// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "softsim/core/state.hpp"
#include "softsim/solver/conjugate_gradient.hpp"
#include "softsim/solver/default_preconditioner.hpp"
#include "softsim/solver/preconditioner.hpp"
#include "softsim/solver/report.hpp"
#include "softsim/system/tangent.hpp"

namespace softsim {

/// Options of `Newton` with the given linear method.
template <class Method>
struct NewtonOptionsFor {
  int max_iterations = 200;
  /// On |residual| over the norm that the problem's gradient returns. As good are a full step below the
  /// rounding of the state, and several below that of the body's positions: forces do not get any smaller.
  double tolerance = 1e-6;
  Method linear =
      {};  ///< its tolerance is replaced by a forcing term in every iteration, unless it is `fixed`
  int max_halvings = 30;    ///< of a step, in the line search
  bool line_search = true;  ///< false: every step is taken as it is, if it is finite
  double relaxation = 1;    ///< a step is this part of Newton's (under-relaxation, d'Aulignac 2001, Eq. 3.9)
  int update_every = 1;     ///< iterations with one tangent; 0: one for the whole solve (modified Newton)
  bool frozen = false;      ///< one tangent for all solves, until `refresh`
  bool verify_minimum = false;  ///< look for negative curvature before converged is said
  /// A step that would invert an element of a state without inverted ones is shortened, as laws that are
  /// infinite there make it: for laws that soften in compression (St. Venant-Kirchhoff). Needs line_search.
  bool refuse_inversion = false;
};
/// Options of `Newton` with conjugate gradients.
using NewtonOptions = NewtonOptionsFor<ConjugateGradient>;

/// Newton's method: finds where the gradient of a problem (see `IncrementalPotential`) vanishes, by a linear
/// method with a preconditioner and a backtracking line search. The linear systems are solved only as far as
/// the residual warrants (inexact Newton); a direction of negative curvature ends a linear solve and leaves a
/// descent direction. Where the line search finds no decrease, it is tried along the preconditioned gradient
/// and then along the gradient itself. Prescribed components that are not in place yet move with the
/// linearised system, so that a large prescribed displacement does not crush the elements next to it. Holds
/// its work vectors: after the first solve of a system nothing is allocated.
///
/// Problem: `conservative`, `system()`, `value(q)` in J if conservative, `gradient(q, g)`, which returns the
/// norm that residuals are measured against, `increment(q, d)`, what prescribed components still have to
/// move, and `linearise(q, tangent)`.
template <class S, class Operator = Assembled,
          template <class> class Preconditioner = DefaultPreconditioner<Operator>::template type,
          class Method = ConjugateGradient>
class Newton {
 public:
  using T = typename S::Scalar;
  using Options = NewtonOptionsFor<Method>;

  Options options;
  Preconditioner<T> preconditioner;  ///< public for the sake of its own options
  /// Called with every iterate, the start included, and the report so far: to show a static solve on its way
  /// (quasi-dynamic display, d'Aulignac 2001, section 6.4) or to end it by returning false.
  std::function<bool(const State<T>&, const StepReport&)> on_iteration;

  /// @throws std::invalid_argument for options out of their range
  explicit Newton(const Options& options_ = {}) : options(options_) {
    if (!(options.tolerance > 0))
      invalid(std::string("tolerance ") + to_text(options.tolerance) + ": must be positive");
    if (options.max_iterations < 1)
      invalid(std::string("max_iterations ") + std::to_string(options.max_iterations) +
              ": must be at least 1");
    if (!(options.relaxation > 0 && options.relaxation <= 1))
      invalid(std::string("relaxation ") + to_text(options.relaxation) + ": must be in (0, 1]");
    if (options.update_every < 0)
      invalid(std::string("update_every ") + std::to_string(options.update_every) + ": must not be negative");
  }

  /// Moves q to a minimum of the problem. On failure q is the last finite iterate.
  template <class Problem>
  StepReport minimise(const Problem& problem, State<T>& q) {
    using detail::ended;
    StepReport report;
    double reference = problem.gradient(q, g_);
    const double rounding =
        4 * static_cast<double>(std::numeric_limits<T>::epsilon()) * length_of_body(problem.system());
    int tiny = 0;
    for (;; ++report.newton_iterations) {
      const double pending = prepare(problem, q);
      const double residual = norm(r_);
      report.residual = residual == 0 ? 0 : residual / reference;
      if (!std::isfinite(residual)) return ended(report, Status::not_finite, "the residual is not finite");
      if (on_iteration && !on_iteration(q, report))
        return ended(report, Status::not_converged, "stopped by the caller");
      if (pending == 0 && residual <= options.tolerance * reference)
        return options.verify_minimum ? verified(problem, q, report) : ended(report, Status::converged, "");
      if (report.newton_iterations == options.max_iterations)
        return ended(report, Status::not_converged, "Newton: too many iterations");

      Method linear = options.linear;
      if (!linear.fixed) {
        const double relative = reference > 0 ? report.residual : 1;
        linear.tolerance =
            std::clamp(relative, std::min(0.1, 0.3 * options.tolerance / std::max(relative, 1e-300)), 0.1);
      }
      x_.setZero(q.size());
      const bool renew =
          report.newton_iterations == 0
              ? !options.frozen
              : options.update_every > 0 && report.newton_iterations % options.update_every == 0;
      const LinearReport solved = solve(problem, q, pending, renew, linear);
      report.linear_iterations += solved.iterations;
      if (solved.status == Status::not_finite)
        return ended(report, Status::not_finite, "the linear solve is not finite");
      const bool along_gradient = solved.iterations == 0 && solved.status == Status::not_converged;
      if (along_gradient) preconditioner.apply(b_, x_);
      const bool full = pending == 0 && solved.status == Status::converged;
      if (full && norm(x_) <= rounding) ++tiny;
      if ((full && below_rounding(q)) || tiny == most_tiny_steps)
        return options.verify_minimum ? verified(problem, q, report) : ended(report, Status::converged, "");
      if (pending > 0) x_ += delta_;
      if (options.relaxation != 1) x_ *= static_cast<T>(options.relaxation);

      if (!options.line_search) {
        if (full_step(problem, q, reference)) continue;
        return ended(report, Status::not_finite, "Newton: the residual after a full step is not finite");
      }
      if (line_search(problem, q, residual, pending > 0, reference)) continue;
      // A tangent that is singular gives directions without bound; its preconditioner is definite, and the
      // gradient itself does not depend on either.
      if (pending == 0 && !along_gradient && search_along_gradient(problem, q, residual, reference, true))
        continue;
      if (pending == 0 && search_along_gradient(problem, q, residual, reference, false)) continue;
      if (tiny > 0)
        return options.verify_minimum ? verified(problem, q, report) : ended(report, Status::converged, "");
      return ended(report, Status::not_converged,
                   refused_ ? "Newton: every step would invert elements"
                            : "Newton: the line search found no decrease");
    }
  }

  /// One linearised solve from q: the direction x of a full step, warm-started from the x given. Prescribed
  /// increments are included. `tolerance` of the linear options applies.
  template <class Problem>
  LinearReport linear_step(const Problem& problem, const State<T>& q, Vector<T>& x) {
    problem.gradient(q, g_);
    const double pending = prepare(problem, q);
    if (!std::isfinite(norm(r_)))
      return {.status = Status::not_finite, .reason = "the force at the start of the step is not finite"};
    x_ = x;
    problem.system().prescribed.mask(x_);
    const LinearReport report = solve(problem, q, pending, !options.frozen, options.linear);
    x = x_;
    if (pending > 0) x += delta_;
    return report;
  }

  /// The tangent of the last linearisation.
  [[nodiscard]] const auto& tangent() const { return tangent_; }
  /// Makes the next solve renew a frozen tangent.
  void refresh() { linearised_ = false; }

 private:
  // r = free part of the gradient g; delta = what prescribed components still have to move.
  template <class Problem>
  double prepare(const Problem& problem, const State<T>& q) {
    r_ = g_;
    problem.system().prescribed.mask(r_);
    delta_.resize(q.size());
    return problem.increment(q, delta_);
  }

  template <class Problem>
  void linearise(const Problem& problem, const State<T>& q) {
    at_ = q;  // a matrix-free tangent refers to the state that it was made at
    problem.linearise(at_, tangent_);
    preconditioner.compute(tangent_, problem.system().prescribed.free());
    linearised_ = true;
  }

  template <class Problem>
  LinearReport solve(const Problem& problem, const State<T>& q, double pending, bool renew,
                     const Method& linear) {
    if (renew || !linearised_ || at_.size() != q.size()) linearise(problem, q);
    b_ = -r_;
    trial_gradient_.resize(q.size());
    if (pending > 0) {
      tangent_.apply(delta_, trial_gradient_);
      b_ -= trial_gradient_;
    }
    return linear.solve(tangent_, preconditioner, b_, x_, workspace_);
  }

  // Conjugate gradients on the tangent at q with an arbitrary right-hand side meet a direction of negative
  // curvature, if there is one, because their Krylov space finds the lowest eigenvalue before it solves.
  template <class Problem>
  StepReport verified(const Problem& problem, const State<T>& q, const StepReport& report) {
    linearise(problem, q);
    b_.resize(q.size());  // nothing has been solved if q was stationary from the start
    for (std::ptrdiff_t k = 0; k < b_.size(); ++k)
      b_[k] = static_cast<T>(std::sin(1.0 + static_cast<double>(k) * static_cast<double>(k)));
    problem.system().prescribed.mask(b_);
    x_.setZero(q.size());
    typename ConjugateGradient::template Workspace<T> workspace;
    const LinearReport probed = ConjugateGradient{.max_iterations = 1000, .tolerance = 1e-6}.solve(
        tangent_, NoPreconditioner<T>(), b_, x_, workspace);
    return probed.indefinite ? detail::ended(report, Status::stationary_not_minimum,
                                             "the tangent has negative curvature here")
                             : detail::ended(report, Status::converged, "");
  }

  template <class Problem>
  bool full_step(const Problem& problem, State<T>& q, double& reference) {
    trial_ = q;
    retract(trial_, x_);
    const double there = problem.gradient(trial_, trial_gradient_);
    if (!std::isfinite(norm(trial_gradient_))) return false;
    take_trial(q, there, reference);
    return true;
  }

  // Full steps below the rounding of the body's positions; tiny loads need two or three to be exact.
  static constexpr int most_tiny_steps = 6;

  // True if the step x_ changes nothing in q but its rounding.
  bool below_rounding(const State<T>& q) const {
    return norm(x_) <= 4 * static_cast<double>(std::numeric_limits<T>::epsilon()) * norm(q);
  }

  // Norm of a displacement of every node by the diagonal of the body's bounding box, m, and of a turn of
  // every frame by a radian: one frame alone has no other size.
  template <class System>
  static double length_of_body(const System& system) {
    Vec3<double> low = Vec3<double>::Zero(), high = low;
    if (!system.rest().empty()) low = high = system.rest().front();
    for (const Vec3<double>& X : system.rest()) {
      low = low.cwiseMin(X);
      high = high.cwiseMax(X);
    }
    return std::hypot((high - low).norm() * std::sqrt(static_cast<double>(system.rest().size())),
                      std::sqrt(static_cast<double>(system.frames())));
  }

  // Along the gradient, preconditioned or as it is, from steps as long as the body down.
  template <class Problem>
  bool search_along_gradient(const Problem& problem, State<T>& q, double residual, double& reference,
                             bool preconditioned) {
    r_ = g_;
    problem.system().prescribed.mask(r_);
    b_ = -r_;
    if (preconditioned)
      preconditioner.apply(b_, x_);
    else
      x_ = static_cast<T>(length_of_body(problem.system()) / residual) * b_;
    return line_search(problem, q, residual, false, reference);
  }

  void take_trial(State<T>& q, double there, double& reference) {
    reference = there;
    std::swap(q.displacement, trial_.displacement);
    g_.swap(trial_gradient_);
  }

  // Moves q along x_ and leaves the gradient there in g_. False if no decrease was found; q is unchanged
  // then.
  template <class Problem>
  bool line_search(const Problem& problem, State<T>& q, double residual, bool prescribed_moves,
                   double& reference) {
    double slope = dot(r_, x_), before = 0;
    bool minimises = false;
    if constexpr (Problem::conservative) minimises = problem.minimises();
    if constexpr (Problem::conservative)
      if (minimises) {
        before = problem.value(q);
        if (slope > 0 &&
            !prescribed_moves) {  // towards a maximum: a direct solve does not see the difference
          x_ = -x_;
          slope = -slope;
        }
      }
    const auto& system = problem.system();
    const bool refuse = options.refuse_inversion && system.inverted(q) == 0;
    T step = T(1);
    for (int k = 0; k <= options.max_halvings; ++k, step /= 2) {
      trial_ = q;
      retract(trial_, x_, step);
      refused_ = refuse && system.inverted(trial_) > 0;
      if (refused_) continue;
      bool accepted = prescribed_moves;
      if constexpr (Problem::conservative)
        if (minimises) {
          const double after = problem.value(trial_);
          if (!std::isfinite(after)) continue;
          if (!accepted && slope < 0) accepted = after <= before + 1e-4 * static_cast<double>(step) * slope;
          // A decrease too small for the values to show is left to the gradient (after Hager & Zhang 2005).
          const bool visible = static_cast<double>(step) * std::abs(slope) >
                               std::sqrt(static_cast<double>(std::numeric_limits<T>::epsilon())) *
                                   std::max(std::abs(before), std::abs(after));
          if (!accepted && visible) continue;
        }
      const double reference_there = problem.gradient(trial_, trial_gradient_);
      r_ = trial_gradient_;
      problem.system().prescribed.mask(r_);
      const double residual_there = norm(r_);
      if (!std::isfinite(residual_there)) continue;
      if (!accepted) accepted = residual_there <= (1 - 1e-4 * static_cast<double>(step)) * residual;
      if constexpr (Problem::conservative)
        if (minimises) accepted = accepted || std::abs(dot(r_, x_)) <= 0.9 * std::abs(slope);
      if (!accepted) continue;
      take_trial(q, reference_there, reference);
      return true;
    }
    return false;
  }

  typename Operator::template Tangent<S> tangent_;
  typename Method::template Workspace<T> workspace_;
  Vector<T> g_, r_, b_, x_, delta_, trial_gradient_;
  State<T> trial_, at_;
  bool linearised_ = false, refused_ = false;  // the last trial would have inverted elements
};

}  // namespace softsim
