// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "model.hpp"
#include "softsim/solver/report.hpp"

namespace chart {

/// Moves a state to equilibrium, from wherever it is.
template <class T>
using Solve = std::function<softsim::StepReport(const Discrete<T>&, softsim::State<T>&)>;

/// A linear solver with its preconditioner, under Newton's method.
struct Solver {
  std::string name, preconditioner;
  /// A solver for one system, which keeps what it has worked out for it.
  std::function<Solve<double>(int load_steps)> in_double;
  std::function<Solve<float>(int load_steps)> in_float;
  bool reduced = false;  ///< few unknowns: the answer is not that of the model
  /// It has seen the load before, so it is told apart from those that any load may be put to.
  bool trained = false;

  template <class T>
  [[nodiscard]] Solve<T> make(int load_steps) const {
    if constexpr (std::is_same_v<T, double>)
      return in_double(load_steps);
    else
      return in_float(load_steps);
  }
};

/// Newton's method on all unknowns, and in few.
std::vector<Solver> solvers(), reductions();

/// Moves a motion by one step.
template <class T>
using Advance = std::function<softsim::StepReport(const AnySystem<T>&, softsim::Motion<T>&)>;

/// An integrator with what solves its equations; "-" where it has none.
struct Integrator {
  std::string name, solver, preconditioner;
  std::function<Advance<double>(double dt)> in_double;
  std::function<Advance<float>(double dt)> in_float;
  bool reduced = false;  ///< few unknowns

  template <class T>
  [[nodiscard]] Advance<T> make(double dt) const {
    if constexpr (std::is_same_v<T, double>)
      return in_double(dt);
    else
      return in_float(dt);
  }
};

/// Steps of all unknowns, and of modes.
std::vector<Integrator> integrators(), modal_integrators();

}  // namespace chart
