// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include "softsim/concepts.hpp"
#include "softsim/solver/linear_method.hpp"
#include "softsim/solver/report.hpp"

namespace softsim {

/// Minimal residuals (Paige & Saunders 1975) for symmetric operators, indefinite and singular ones included,
/// with a positive definite preconditioner B. Every iterate has the least r . B r in its Krylov space, which
/// never grows; the tolerance is on the Euclidean norm like everywhere, so that without a preconditioner the
/// reported residual never grows either. A singular system with a right-hand side in the operator's range is
/// solved; with another one the solve ends with a least-squares solution and says so.
struct Minres {
  int max_iterations = 10000;
  double tolerance = 1e-6;  ///< on |b - A x| / |b|
  bool fixed = false;       ///< exactly `max_iterations` iterations, unless the Krylov space ends before

  /// Work vectors; they grow at the first solve.
  template <class T>
  struct Workspace {
    Vector<T> r, v, v_old, Az, z, Bv, w, w_old, start;
  };

  /// Solves A x = b from the x given. The residual of the report is measured at the end; where rounding has
  /// made the recurrence say less, iterations begin anew from the x reached.
  template <class T, class A, class B>
  requires LinearOperator<A, T> && Preconditioner<B, T> LinearReport solve(const A& a,
                                                                           const B& preconditioner,
                                                                           const Vector<T>& b, Vector<T>& x,
                                                                           Workspace<T>& w)
  const {
    LinearReport report;
    double norm_b = 0, size = 0;
    if (detail::ends_at_once(*this, a, b, x, norm_b, w.r, report)) return report;
    w.Az.resize(b.size());
    w.Bv.resize(b.size());
    w.z.resize(b.size());
    while (true) {
      const double start = report.residual;
      w.start = x;
      const End end = iterate(a, preconditioner, x, norm_b, w, size, report.iterations);
      report = detail::measured(report, a, b, x, tolerance, norm_b, w.r, end.reason);
      if (!(report.residual <= 1e8 * start)) {  // never in exact arithmetic
        x = w.start;
        report.residual = start;
        return detail::ended(report, Status::not_converged, "MINRES: rounding errors have grown");
      }
      if (end.not_finite) return detail::ended(report, Status::not_finite, end.reason);
      if (report.status != Status::not_converged || !end.reason.empty()) return report;
      if (fixed || !(report.residual <= 0.5 * start))
        return detail::ended(report, Status::not_converged,
                             "MINRES: the residual falls no further: rounding, or a singular operator");
    }
  }

 private:
  struct End {
    std::string_view reason;  // empty: the recurrence is at its goal, or the Krylov space has ended
    bool not_finite = false;
  };

  // One Lanczos process from r = b - A x. Symbols as in Paige & Saunders: the tridiagonal matrix has delta on
  // and gamma beside its diagonal, `size` is the largest of these; c and s are the rotations that make it
  // triangular; |eta| = sqrt(r . B r).
  template <class A, class B, class T>
  End iterate(const A& a, const B& preconditioner, Vector<T>& x, double norm_b, Workspace<T>& w, double& size,
              int& iterations) const {
    const double eps = 16 * static_cast<double>(std::numeric_limits<T>::epsilon()), root = std::sqrt(eps);
    preconditioner.apply(w.r, w.z);
    const double rz = dot(w.r, w.z);
    if (!std::isfinite(rz)) return {"the preconditioner is not finite", true};
    if (!(rz > 0)) return {"the preconditioner is not positive definite"};
    double gamma = std::sqrt(rz), eta = gamma, c = 1, c_old = 1, s = 0, s_old = 0;
    w.v = w.r / static_cast<T>(gamma);
    w.z /= static_cast<T>(gamma);
    w.v_old.setZero(x.size());
    w.w.setZero(x.size());
    w.w_old.setZero(x.size());
    while (iterations < max_iterations) {
      a.apply(w.z, w.Az);
      const double delta = dot(w.z, w.Az);
      w.Az -= static_cast<T>(delta) * w.v + static_cast<T>(gamma) * w.v_old;
      preconditioner.apply(w.Az, w.Bv);
      const double square = dot(w.Az, w.Bv);
      if (!std::isfinite(delta) || !std::isfinite(square))
        return {"the operator or the preconditioner is not finite", true};
      size = std::max({size, std::abs(delta), std::sqrt(std::abs(square))});
      const bool ends = std::abs(square) <= eps * size * eps * size;
      if (square < 0 && !ends) return {"the preconditioner is not positive definite"};
      const double gamma_new = ends ? 0 : std::sqrt(square);

      const double pivot = c * delta - c_old * s * gamma, rho = std::hypot(pivot, gamma_new);
      const double of_Ar = std::hypot(pivot, c * gamma_new);  // |A r| / |r|, in the norms of B
      if (of_Ar <= eps * size) return {"the operator is singular and the right-hand side not in its range"};
      // A least-squares solution, if rounding hides it; the next step would then leave it for anywhere. One
      // has to look anew from here.
      if (of_Ar <= root * size && rho <= 100 * root * size) return {};
      w.w_old = (w.z - static_cast<T>(s_old * gamma) * w.w_old -
                 static_cast<T>(s * delta + c_old * c * gamma) * w.w) /
                static_cast<T>(rho);
      w.w.swap(w.w_old);
      c_old = c;
      s_old = s;
      c = pivot / rho;
      s = gamma_new / rho;
      x += static_cast<T>(c * eta) * w.w;
      eta *= -s;
      ++iterations;
      if (ends) return {};
      w.v_old.swap(w.v);
      w.v = w.Az / static_cast<T>(gamma_new);
      w.z = w.Bv / static_cast<T>(gamma_new);
      gamma = gamma_new;
      if (!fixed) {
        w.r = static_cast<T>(s * s) * w.r + static_cast<T>(c * eta) * w.v;
        if (norm(w.r) <= tolerance * norm_b) return {};
      }
    }
    return {"MINRES: too many iterations"};
  }
};

}  // namespace softsim
