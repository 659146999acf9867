// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <string_view>

#include "softsim/concepts.hpp"
#include "softsim/solver/linear_method.hpp"
#include "softsim/solver/report.hpp"

namespace softsim {

/// Preconditioned conjugate gradients for symmetric positive definite operators.
struct ConjugateGradient {
  int max_iterations = 10000;
  double tolerance = 1e-6;  ///< on |b - A x| / |b|
  bool fixed = false;       ///< exactly `max_iterations` iterations, unless x is exact before: for real time

  /// Work vectors; they grow at the first solve.
  template <class T>
  struct Workspace {
    Vector<T> r, z, p, Ap;
  };

  /// Solves A x = b from the x given. The residual of the report is the recurrence's, measured if `fixed`.
  /// Ends early, with the x reached so far and `indefinite` set, at a direction p with p . A p <= 0: x is
  /// then still a descent direction of x . A x / 2 - b . x.
  template <class T, class A, class B>
  requires LinearOperator<A, T> && Preconditioner<B, T> LinearReport solve(const A& a,
                                                                           const B& preconditioner,
                                                                           const Vector<T>& b, Vector<T>& x,
                                                                           Workspace<T>& w)
  const {
    constexpr std::string_view ran_out = "conjugate gradients: too many iterations";
    LinearReport report;
    double norm_b = 0;
    if (detail::ends_at_once(*this, a, b, x, norm_b, w.r, report)) return report;
    w.z.resize(b.size());
    w.p.resize(b.size());
    w.Ap.resize(b.size());
    double rz = 0;
    for (;; ++report.iterations) {
      if (!fixed) {
        report.residual = norm(w.r) / norm_b;
        if (!std::isfinite(report.residual))
          return detail::ended(report, Status::not_finite, "the residual is not finite");
        if (report.residual <= tolerance) return detail::ended(report, Status::converged, "");
      }
      if (report.iterations == max_iterations)
        return fixed ? detail::measured(report, a, b, x, tolerance, norm_b, w.r, ran_out)
                     : detail::ended(report, Status::not_converged, ran_out);
      preconditioner.apply(w.r, w.z);
      const double rz_new = dot(w.r, w.z);
      if (fixed && rz_new == 0) return detail::measured(report, a, b, x, tolerance, norm_b, w.r, ran_out);
      if (report.iterations == 0) {
        w.p = w.z;
      } else {
        w.p = w.z + static_cast<T>(rz_new / rz) * w.p;
      }
      rz = rz_new;
      a.apply(w.p, w.Ap);
      const double curvature = dot(w.p, w.Ap);
      if (!std::isfinite(curvature) || !std::isfinite(rz))
        return detail::ended(report, Status::not_finite, "the operator or the preconditioner is not finite");
      if (!(rz > 0))
        return detail::ended(report, Status::not_converged, "the preconditioner is not positive definite");
      if (!(curvature > 0)) {
        report.indefinite = true;
        return detail::ended(report, Status::not_converged, "the operator is not positive definite");
      }
      const T alpha = static_cast<T>(rz / curvature);
      x += alpha * w.p;
      w.r -= alpha * w.Ap;
    }
  }
};

}  // namespace softsim
