// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string_view>

#include "softsim/concepts.hpp"
#include "softsim/solver/linear_method.hpp"
#include "softsim/solver/report.hpp"

namespace softsim {

/// Bounds of the eigenvalues of a preconditioned operator B A; both zero if it is not positive definite or
/// not finite.
struct SpectrumBounds {
  double lambda_min = 0;
  double lambda_max = 0;
};

/// Chebyshev's iteration for symmetric positive definite operators: as fast as conjugate gradients at their
/// bound, 2 ((sqrt k - 1)/(sqrt k + 1))^n in the energy norm, and without a single dot product between its
/// residuals, which suits many threads. It wants bounds of the eigenvalues of B A. A lambda_min above the
/// smallest one makes it slower, a lambda_max below the largest makes it diverge.
struct Chebyshev {
  int max_iterations = 10000;
  double tolerance = 1e-6;  ///< on |b - A x| / |b|
  bool fixed = false;       ///< exactly `max_iterations` iterations: for real time
  int check_every = 10;     ///< iterations between two residuals; none are computed if `fixed`
  double lambda_min = 0;    ///< lower bound; both zero: estimated anew at every solve, see `estimate`
  double lambda_max = 0;    ///< upper bound
  int estimate_steps = 20;  ///< of conjugate gradients for the estimate, 64 at most
  double safety = 1.1;      ///< what the estimate is widened by, on both sides

  /// Work vectors; they grow at the first solve.
  template <class T>
  struct Workspace {
    Vector<T> r, z, d, start;
  };

  /// Estimates the bounds for B A, from the tridiagonal matrix that conjugate gradients for a rough
  /// right-hand side make (Saad 2003, section 6.7.3), widened by `safety`. Costs `estimate_steps` iterations:
  /// where the operator changes little, do it once and set lambda_min and lambda_max.
  template <class T, class A, class B>
  requires LinearOperator<A, T> && Preconditioner<B, T> SpectrumBounds estimate(const A& a,
                                                                                const B& preconditioner,
                                                                                std::ptrdiff_t size,
                                                                                Workspace<T>& w)
  const {
    w.r.resize(size);
    w.z.resize(size);
    w.d.resize(size);
    w.start.resize(size);
    // Entries of either sign at random; none where the operator has nothing, that is in prescribed components
    // and in the fourth scalars of the blocks.
    unsigned long long state = 1;
    const auto number = [&] {
      state = state * 6364136223846793005ULL + 1442695040888963407ULL;
      return static_cast<double>(state >> 11) * 0x1p-52 - 1;
    };
    for (std::ptrdiff_t i = 0; i < size; ++i)
      w.d[i] = i % block_stride == 3 ? T(0) : static_cast<T>(number());
    a.apply(w.d, w.r);
    for (std::ptrdiff_t i = 0; i < size; ++i)
      if (w.r[i] != T(0)) w.r[i] = w.d[i];

    const std::size_t most = static_cast<std::size_t>(std::clamp(estimate_steps, 1, 64));
    std::array<double, 64> diagonal{}, square{};  // square[i]: of the entry between i - 1 and i
    std::size_t n = 0;
    double rz = 0, from_before = 0;
    const double first = norm(w.r);
    while (n < most) {
      preconditioner.apply(w.r, w.z);
      const double rz_new = dot(w.r, w.z), beta = n == 0 ? 0 : rz_new / rz;
      if (n == 0)
        w.d = w.z;
      else
        w.d = w.z + static_cast<T>(beta) * w.d;
      a.apply(w.d, w.start);
      const double curvature = dot(w.d, w.start);
      if (!(rz_new > 0) || !(curvature > 0) || !std::isfinite(curvature) || !std::isfinite(rz_new)) return {};
      const double inverse_alpha = curvature / rz_new;
      diagonal[n] = inverse_alpha + beta * from_before;
      square[n] = beta * from_before * from_before;
      from_before = inverse_alpha;
      rz = rz_new;
      ++n;
      w.r -= static_cast<T>(1 / inverse_alpha) * w.start;
      if (norm(w.r) <= 1e-5 * first) break;  // the Krylov space has told all
    }

    // Eigenvalues below t, by Sturm's sequence.
    const auto below = [&](double t) {
      std::size_t count = 0;
      double pivot = 1;
      for (std::size_t i = 0; i < n; ++i) {
        pivot = diagonal[i] - t - (i > 0 ? square[i] / pivot : 0);
        if (pivot == 0) pivot = 1e-300;
        if (pivot < 0) ++count;
      }
      return count;
    };
    const auto bisect = [&](double low, double high, std::size_t count) {
      for (int k = 0; k < 60; ++k) {
        const double middle = (low + high) / 2;
        (below(middle) < count ? low : high) = middle;
      }
      return high;
    };
    double most_possible = 0;  // the matrix is positive definite: its trace
    for (std::size_t i = 0; i < n; ++i) most_possible += diagonal[i];
    return {bisect(0, most_possible, 1) / safety, bisect(0, most_possible, n) * safety};
  }

  /// Solves A x = b from the x given. The residual of the report is measured at the end. If the iteration
  /// diverges, x is what it was.
  template <class T, class A, class B>
  requires LinearOperator<A, T> && Preconditioner<B, T> LinearReport solve(const A& a,
                                                                           const B& preconditioner,
                                                                           const Vector<T>& b, Vector<T>& x,
                                                                           Workspace<T>& w)
  const {
    LinearReport report;
    double norm_b = 0;
    if (detail::ends_at_once(*this, a, b, x, norm_b, w.r, report)) return report;
    SpectrumBounds bounds{lambda_min, lambda_max};
    if (lambda_min == 0 && lambda_max == 0) {
      bounds = estimate(a, preconditioner, b.size(), w);
      if (bounds.lambda_max == 0) {
        report.indefinite = true;
        return detail::ended(report, Status::not_converged,
                             "the operator or the preconditioner is not positive definite");
      }
      detail::true_residual(a, b, x, norm_b, w.r);
    }
    if (!(bounds.lambda_min > 0) || !(bounds.lambda_min <= bounds.lambda_max) ||
        !std::isfinite(bounds.lambda_max))
      return detail::ended(report, Status::not_converged,
                           "Chebyshev bounds: must be 0 < lambda_min <= lambda_max");
    const double centre = (bounds.lambda_max + bounds.lambda_min) / 2,
                 radius = (bounds.lambda_max - bounds.lambda_min) / 2, start = report.residual;
    w.start = x;
    w.z.resize(b.size());
    w.d.setZero(b.size());
    // After Saad 2003, algorithm 12.1: rho_k = 1/(2 sigma - rho_{k-1}), rho_0 = 1/sigma, sigma =
    // centre/radius, here as t = rho/radius, which stays finite where the radius is zero.
    double t = 1 / centre;
    while (report.iterations < max_iterations) {
      preconditioner.apply(w.r, w.z);
      if (report.iterations == 0) {
        w.d = static_cast<T>(1 / centre) * w.z;
      } else {
        const double next = 1 / (2 * centre - radius * radius * t);
        w.d = static_cast<T>(radius * radius * next * t) * w.d + static_cast<T>(2 * next) * w.z;
        t = next;
      }
      x += w.d;
      a.apply(w.d, w.z);
      w.r -= w.z;
      ++report.iterations;
      if (fixed || report.iterations % std::max(1, check_every) != 0) continue;
      report.residual = norm(w.r) / norm_b;
      if (!(report.residual <= 1e4 * std::max(1.0, start))) {
        x = w.start;
        report.residual = start;
        return detail::ended(report, Status::not_converged,
                             "the iteration diverges: lambda_max is below the largest eigenvalue");
      }
      if (report.residual <= tolerance &&
          (report.residual = detail::true_residual(a, b, x, norm_b, w.r)) <= tolerance)
        return detail::ended(report, Status::converged, "");
    }
    report = detail::measured(report, a, b, x, tolerance, norm_b, w.r, "Chebyshev: too many iterations");
    if (!(report.residual <= 1e4 * std::max(1.0, start))) {
      x = w.start;
      report.residual = start;
      report = detail::ended(report, Status::not_converged,
                             "the iteration diverges: lambda_max is below the largest eigenvalue");
    }
    return report;
  }
};

}  // namespace softsim
