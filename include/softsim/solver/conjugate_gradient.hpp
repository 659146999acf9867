// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>

#include "softsim/concepts.hpp"
#include "softsim/solver/report.hpp"

namespace softsim {

/// Work vectors of `ConjugateGradient`; they grow at the first solve.
template <class T>
struct ConjugateGradientWorkspace {
  Vector<T> r, z, p, Ap;
};

/// Preconditioned conjugate gradients for symmetric positive definite operators.
struct ConjugateGradient {
  int max_iterations = 10000;
  double tolerance = 1e-6;  ///< on |b - A x| / |b|

  /// Solves A x = b from the x given. Ends early, with the x reached so far and `indefinite` set, at a
  /// direction p with p . A p <= 0: x is then still a descent direction of x . A x / 2 - b . x.
  template <class T, class A, class B>
  requires LinearOperator<A, T> && Preconditioner<B, T> LinearReport solve(const A& a,
                                                                           const B& preconditioner,
                                                                           const Vector<T>& b, Vector<T>& x,
                                                                           ConjugateGradientWorkspace<T>& w)
  const {
    LinearReport report;
    w.r.resize(b.size());
    w.z.resize(b.size());
    w.p.resize(b.size());
    w.Ap.resize(b.size());
    const double norm_b = norm(b);
    if (norm_b == 0) {
      x.setZero();
      report.status = Status::converged;
      return report;
    }
    a.apply(x, w.Ap);
    w.r = b - w.Ap;
    double rz = 0;
    for (;; ++report.iterations) {
      report.residual = norm(w.r) / norm_b;
      if (!std::isfinite(report.residual)) {
        report.status = Status::not_finite;
        return report;
      }
      if (report.residual <= tolerance) {
        report.status = Status::converged;
        return report;
      }
      if (report.iterations == max_iterations) return report;
      preconditioner.apply(w.r, w.z);
      const double rz_new = dot(w.r, w.z);
      if (report.iterations == 0) {
        w.p = w.z;
      } else {
        w.p = w.z + static_cast<T>(rz_new / rz) * w.p;
      }
      rz = rz_new;
      a.apply(w.p, w.Ap);
      const double curvature = dot(w.p, w.Ap);
      if (!(curvature > 0)) {
        report.indefinite = std::isfinite(curvature);
        report.status = report.indefinite ? Status::not_converged : Status::not_finite;
        return report;
      }
      const T alpha = static_cast<T>(rz / curvature);
      x += alpha * w.p;
      w.r -= alpha * w.Ap;
    }
  }
};

}  // namespace softsim
