// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <string_view>

#include "softsim/concepts.hpp"
#include "softsim/core/state.hpp"
#include "softsim/solver/report.hpp"

namespace softsim {

/// Solves A x = b with the help of a preconditioner, from the x given, and says how it went: an aggregate of
/// options with a workspace, such as `ConjugateGradient`.
template <class M, class A, class B, class T = double>
concept LinearMethod = LinearOperator<A, T> && Preconditioner<B, T> &&
    requires(const M& m, const A& a, const B& preconditioner, const Vector<T>& b, Vector<T>& x,
             typename M::template Workspace<T>& w) {
  {m.solve(a, preconditioner, b, x, w).status};
};

}  // namespace softsim

// What the linear methods have in common.

namespace softsim::detail {

// r = b - A x. Returns |r| / norm_b.
template <class A, class T>
double true_residual(const A& a, const Vector<T>& b, const Vector<T>& x, double norm_b, Vector<T>& r) {
  r.resize(b.size());
  a.apply(x, r);
  r = b - r;
  return norm(r) / norm_b;
}

// How every method begins: r = b - A x and norm_b = |b|. True if there is nothing to iterate for.
template <class Method, class A, class T>
bool ends_at_once(const Method& method, const A& a, const Vector<T>& b, Vector<T>& x, double& norm_b,
                  Vector<T>& r, LinearReport& report) {
  norm_b = norm(b);
  if (!std::isfinite(norm_b)) {
    report = ended(report, Status::not_finite, "the right-hand side is not finite");
    return true;
  }
  if (norm_b == 0) {
    x.setZero();
    report = ended(report, Status::converged, "");
    return true;
  }
  report.residual = true_residual(a, b, x, norm_b, r);
  if (!std::isfinite(report.residual)) {
    report = ended(report, Status::not_finite, "the residual is not finite");
    return true;
  }
  if (report.residual > (method.fixed ? 0 : method.tolerance)) return false;
  report = ended(report, Status::converged, "");
  return true;
}

// How a method ends that measures once more: converged if the residual says so, else for this reason.
template <class A, class T>
LinearReport measured(LinearReport report, const A& a, const Vector<T>& b, const Vector<T>& x,
                      double tolerance, double norm_b, Vector<T>& r, std::string_view reason) {
  report.residual = true_residual(a, b, x, norm_b, r);
  if (!std::isfinite(report.residual)) return ended(report, Status::not_finite, "the residual is not finite");
  return ended(report, report.residual <= tolerance ? Status::converged : Status::not_converged, reason);
}

// What is wrong with a preconditioner that can tell; empty if nothing is.
template <class B>
std::string_view trouble_of(const B& preconditioner) {
  if constexpr (requires { preconditioner.trouble(); })
    return preconditioner.trouble();
  else
    return {};
}

}  // namespace softsim::detail
