// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string_view>

#include "softsim/core/error.hpp"

namespace softsim {

/// How a linear solve ended.
struct [[nodiscard]] LinearReport {
  Status status = Status::not_converged;
  int iterations = 0;
  double residual = 0;           ///< |b - A x| / |b|
  bool indefinite = false;       ///< a direction of negative curvature ended it
  std::string_view reason = "";  ///< why it did not converge; empty if it did
};

/// How a step or a static solve ended.
struct [[nodiscard]] StepReport {
  Status status = Status::not_converged;
  int newton_iterations = 0;
  int linear_iterations = 0;
  double residual =
      0;  ///< relative; of the equilibrium for Newton, of the linear solve for a linearised step
  std::string_view reason = "";  ///< why it did not converge; empty if it did
  std::size_t inverted = 0;      ///< elements inside out or flat after a static solve; others do not count
};

namespace detail {
// The report of something that ends now; the reason is dropped if it converged.
template <class Report>
Report ended(Report report, Status status, std::string_view reason) {
  report.status = status;
  report.reason = status == Status::converged ? "" : reason;
  return report;
}
}  // namespace detail

}  // namespace softsim
