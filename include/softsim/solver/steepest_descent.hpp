// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>

#include "softsim/concepts.hpp"
#include "softsim/solver/linear_method.hpp"
#include "softsim/solver/report.hpp"

namespace softsim {

/// Steepest descent with exact steps along the preconditioned residual, for symmetric positive definite
/// operators. The error in the energy norm falls by (k - 1)/(k + 1) in an iteration at least, k the condition
/// number of the preconditioned operator: slow, but without a memory that an operator changing under way or
/// an inexact preconditioner could spoil.
struct SteepestDescent {
  int max_iterations = 10000;
  double tolerance = 1e-6;  ///< on |b - A x| / |b|
  bool fixed = false;       ///< exactly `max_iterations` iterations, unless x is exact before: for real time

  /// Work vectors; they grow at the first solve.
  template <class T>
  struct Workspace {
    Vector<T> r, z, Az;
  };

  /// Solves A x = b from the x given. Ends early, with the x reached so far and `indefinite` set, at a
  /// direction of negative curvature. The residual of the report is measured at the end.
  template <class T, class A, class B>
  requires LinearOperator<A, T> && Preconditioner<B, T> LinearReport solve(const A& a,
                                                                           const B& preconditioner,
                                                                           const Vector<T>& b, Vector<T>& x,
                                                                           Workspace<T>& w)
  const {
    LinearReport report;
    double norm_b = 0;
    if (detail::ends_at_once(*this, a, b, x, norm_b, w.r, report)) return report;
    w.z.resize(b.size());
    w.Az.resize(b.size());
    while (report.iterations < max_iterations) {
      preconditioner.apply(w.r, w.z);
      a.apply(w.z, w.Az);
      const double rz = dot(w.r, w.z), curvature = dot(w.z, w.Az), alpha = rz / curvature;
      if (rz == 0 && fixed && norm(w.r) == 0) break;
      if (!std::isfinite(rz) || !std::isfinite(curvature)) {
        report = detail::measured(report, a, b, x, tolerance, norm_b, w.r, "");
        return detail::ended(report, Status::not_finite, "the operator or the preconditioner is not finite");
      }
      if (!(rz > 0))
        return detail::measured(report, a, b, x, tolerance, norm_b, w.r,
                                "the preconditioner is not positive definite");
      if (!(curvature > 0) || !std::isfinite(alpha)) {
        report.indefinite = true;
        return detail::measured(report, a, b, x, tolerance, norm_b, w.r,
                                "the operator is not positive definite");
      }
      x += static_cast<T>(alpha) * w.z;
      w.r -= static_cast<T>(alpha) * w.Az;
      ++report.iterations;
      // The recurrence may have drifted: it is only a reason to look.
      if (!fixed && norm(w.r) <= tolerance * norm_b &&
          (report.residual = detail::true_residual(a, b, x, norm_b, w.r)) <= tolerance)
        return detail::ended(report, Status::converged, "");
    }
    return detail::measured(report, a, b, x, tolerance, norm_b, w.r, "steepest descent: too many iterations");
  }
};

}  // namespace softsim
