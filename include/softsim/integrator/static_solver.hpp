// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include "softsim/solver/newton.hpp"
#include "softsim/system/supports.hpp"

namespace softsim {

/// Static equilibrium under the full load at once, by Newton's method.
template <class S, class Operator = Assembled, template <class> class Preconditioner = BlockJacobi>
class StaticSolver {
 public:
  using T = typename S::Scalar;

  /// @throws std::invalid_argument for a tolerance <= 0 or fewer than one iteration
  explicit StaticSolver(const NewtonOptions& options = {}) : newton_(options) {}

  /// Moves q to equilibrium; on failure q is the last finite iterate.
  /// @throws std::invalid_argument, before anything moves, if a piece of the system is not held
  StepReport solve(const S& system, State<T>& q) {
    require_supports(system);
    potential_.set_static(system);
    return newton_.minimise(potential_, q);
  }

 private:
  Newton<S, Operator, Preconditioner> newton_;
  IncrementalPotential<S> potential_;
};

}  // namespace softsim
