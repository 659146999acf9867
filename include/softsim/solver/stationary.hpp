// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>

#include "softsim/concepts.hpp"
#include "softsim/solver/linear_method.hpp"
#include "softsim/solver/report.hpp"

namespace softsim {

/// Stationary iteration x <- x + relaxation B (b - A x), B being the preconditioner. With `Jacobi` or
/// `BlockJacobi` it is Jacobi's method (d'Aulignac 2001, Eq. 3.40), with `GaussSeidel` that of Gauss and
/// Seidel (Eq. 3.45), forward or symmetric, and with its `omega` SOR and SSOR (Eq. 3.46). A preconditioner
/// that offers `sweep(b, x)` sweeps in place, which costs one product an iteration; with others it costs a
/// product and an application.
struct Stationary {
  int max_iterations = 10000;
  double tolerance = 1e-6;  ///< on |b - A x| / |b|
  bool fixed = false;       ///< exactly `max_iterations` iterations: for real time
  int check_every = 1;    ///< iterations between two residuals, where the iteration does not need them itself
  double relaxation = 1;  ///< in (0, 2); 1 where the preconditioner sweeps

  /// Work vectors; they grow at the first solve.
  template <class T>
  struct Workspace {
    Vector<T> r, z, best;
  };

  /// Solves A x = b from the x given. The residual of the report is measured at the end. If the iteration
  /// diverges x is the best one seen where a residual was taken, at worst the one given. A preconditioner in
  /// trouble (a diagonal block that is not positive definite) is not iterated with: its sentence is the
  /// reason.
  template <class T, class A, class B>
  requires LinearOperator<A, T> && Preconditioner<B, T> LinearReport solve(const A& a,
                                                                           const B& preconditioner,
                                                                           const Vector<T>& b, Vector<T>& x,
                                                                           Workspace<T>& w)
  const {
    constexpr bool sweeps = requires { preconditioner.sweep(b, x); };
    LinearReport report;
    if (!(relaxation > 0 && relaxation < 2))
      return detail::ended(report, Status::not_converged, "relaxation: must be in (0, 2)");
    if (const auto trouble = detail::trouble_of(preconditioner); !trouble.empty())
      return detail::ended(report, Status::not_converged, trouble);
    double norm_b = 0;
    if (detail::ends_at_once(*this, a, b, x, norm_b, w.r, report)) return report;
    const double start = report.residual;
    double least = start;
    w.best = x;
    w.z.resize(b.size());
    bool fresh = true;  // r belongs to x
    while (report.iterations < max_iterations) {
      if constexpr (sweeps) {
        preconditioner.sweep(b, x);
      } else {
        if (!fresh) detail::true_residual(a, b, x, norm_b, w.r);
        preconditioner.apply(w.r, w.z);
        x += static_cast<T>(relaxation) * w.z;
      }
      fresh = false;
      ++report.iterations;
      if (fixed || report.iterations % std::max(1, check_every) != 0) continue;
      report.residual = detail::true_residual(a, b, x, norm_b, w.r);
      fresh = true;
      if (report.residual <= tolerance) return detail::ended(report, Status::converged, "");
      if (!(report.residual <= 1e8 * std::max(least, start))) break;
      if (report.residual < least && report.residual > 0) {
        least = report.residual;
        w.best = x;
      }
    }
    report = detail::measured(report, a, b, x, tolerance, norm_b, w.r,
                              "stationary iteration: too many iterations");
    if (report.residual <= std::max(start, 1.0) * 1e4) return report;
    x = w.best;
    report.residual = least;
    return detail::ended(report, Status::not_converged, "the iteration diverges");
  }
};

}  // namespace softsim
