// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>

#include "softsim/solver/newton.hpp"
#include "softsim/system/incremental_potential.hpp"
#include "softsim/system/supports.hpp"
#include "softsim/system/system.hpp"

namespace softsim {

/// How the load of a static solve is put on: in equal parts first, in smaller ones where Newton's method does
/// not converge.
struct LoadSteps {
  int steps = 1;           ///< 1: all at once
  double smallest = 1e-3;  ///< part of the load below which the solve gives up
};

/// Static equilibrium by Newton's method, under the full load at once or in steps that are cut back where it
/// does not converge. An equilibrium with inverted elements, which laws that are finite there have (St.
/// Venant-Kirchhoff under compression), gets the status `inverted`; load steps stay clear of it, and end with
/// `not_converged` where that is not possible. Loads
/// from outside and prescribed displacements grow together, from nothing and from where they are.
template <class S, class Operator = Assembled,
          template <class> class Preconditioner = DefaultPreconditioner<Operator>::template type,
          class Method = ConjugateGradient>
class StaticSolver {
 public:
  using T = typename S::Scalar;

  Newton<S, Operator, Preconditioner, Method> newton;  ///< public for its options and its callback
  LoadSteps load;

  /// @throws std::invalid_argument for options out of their range
  explicit StaticSolver(const NewtonOptionsFor<Method>& options = {}, const LoadSteps& load_ = {})
      : newton(options), load(load_) {
    if (load.steps < 1)
      invalid(std::string("load steps ") + std::to_string(load.steps) + ": must be at least 1");
    if (!(load.smallest > 0 && load.smallest <= 1))
      invalid(std::string("smallest load step ") + to_text(load.smallest) + ": must be in (0, 1]");
  }

  /// Moves q to equilibrium; on failure q is the last finite iterate or, with load steps, the equilibrium
  /// under the largest part of the load that was reached (`load_reached`). Terms with a history take part
  /// with their static response, and their history afterwards is such that a motion may start from q in
  /// equilibrium.
  /// @throws std::invalid_argument, before anything moves, if a piece of the system is not held
  StepReport solve(Stepped<S> system, State<T>& q) {
    require_supports(system);
    if constexpr (S::has_memory) system.begin_static();
    const StepReport report = load.steps == 1 ? at_once(system, q) : in_steps(system, q);
    if constexpr (S::has_memory)
      if (report.status != Status::not_finite) system.end_static(q);
    return report;
  }

  /// Part of the load that the state of the last solve is in equilibrium with.
  [[nodiscard]] double load_reached() const { return reached_; }

 private:
  StepReport at_once(const S& system, State<T>& q) {
    potential_.set_static(system);
    const StepReport report = minimise(system, q);
    reached_ = report.status == Status::converged ? 1 : 0;
    return report;
  }

  StepReport minimise(const S& system, State<T>& q) {
    StepReport report = newton.minimise(potential_, q);
    if (report.status != Status::converged) return report;
    report.inverted = system.inverted(q);
    return report.inverted == 0
               ? report
               : detail::ended(report, Status::inverted, "elements are inverted in equilibrium");
  }

  StepReport in_steps(const S& system, State<T>& q) {
    StepReport total;
    start_ = q;
    reached_ = 0;
    for (double part = 1.0 / load.steps; reached_ < 1;) {
      const double next = reached_ + part > 1 - 1e-9 ? 1 : reached_ + part;
      trial_ = q;
      potential_.set_static(system, start_, next);
      const StepReport report = minimise(system, trial_);
      total.newton_iterations += report.newton_iterations;
      total.linear_iterations += report.linear_iterations;
      total.residual = report.residual;
      if (report.status == Status::converged) {
        q.displacement.swap(trial_.displacement);
        reached_ = next;
        part = std::min(2 * part, 1.0 / load.steps);
      } else if ((part /= 2) < load.smallest) {
        // q is upright, but not in equilibrium with all of the load
        const Status status = report.status == Status::inverted ? Status::not_converged : report.status;
        return detail::ended(total, status, report.reason);
      }
    }
    return detail::ended(total, Status::converged, "");
  }

  IncrementalPotential<S> potential_;
  State<T> start_, trial_;
  double reached_ = 0;
};

}  // namespace softsim
