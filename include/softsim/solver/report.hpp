// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <string_view>

#include "softsim/core/error.hpp"

namespace softsim {

/// How a linear solve ended.
struct [[nodiscard]] LinearReport {
  Status status = Status::not_converged;
  int iterations = 0;
  double residual = 0;      ///< |b - A x| / |b|
  bool indefinite = false;  ///< a direction of negative curvature ended it
};

/// How a step or a static solve ended.
struct [[nodiscard]] StepReport {
  Status status = Status::not_converged;
  int newton_iterations = 0;
  int linear_iterations = 0;
  double residual =
      0;  ///< relative; of the equilibrium for Newton, of the linear solve for a linearised step
  std::string_view reason = "";  ///< why it did not converge; empty if it did
};

}  // namespace softsim
