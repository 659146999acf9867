// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include "softsim/solver/newton.hpp"
#include "softsim/system/supports.hpp"
#include "softsim/system/system.hpp"

namespace softsim {

/// Static equilibrium under the full load at once, by Newton's method.
template <class S, class Operator = Assembled, template <class> class Preconditioner = BlockJacobi>
class StaticSolver {
 public:
  using T = typename S::Scalar;

  /// @throws std::invalid_argument for a tolerance <= 0 or fewer than one iteration
  explicit StaticSolver(const NewtonOptions& options = {}) : newton_(options) {}

  /// Moves q to equilibrium; on failure q is the last finite iterate. Terms with a history take part with
  /// their static response, and their history afterwards is such that a motion may start from q in
  /// equilibrium.
  /// @throws std::invalid_argument, before anything moves, if a piece of the system is not held
  StepReport solve(Stepped<S> system, State<T>& q) {
    require_supports(system);
    if constexpr (S::has_memory) system.begin_static();
    potential_.set_static(system);
    const StepReport report = newton_.minimise(potential_, q);
    if constexpr (S::has_memory)
      if (report.status != Status::not_finite) system.end_static(q);
    return report;
  }

 private:
  Newton<S, Operator, Preconditioner> newton_;
  IncrementalPotential<S> potential_;
};

}  // namespace softsim
