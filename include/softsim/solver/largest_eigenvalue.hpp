// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "softsim/core/error.hpp"
#include "softsim/core/state.hpp"
#include "softsim/solver/conjugate_gradient.hpp"
#include "softsim/solver/mass_solve.hpp"

namespace softsim {

/// Options of `largest_eigenvalue`.
struct LargestEigenvalueOptions {
  int max_iterations = 500;
  double tolerance = 1e-8;  ///< relative change of the value in an iteration; its square root on the residual
  std::uint64_t seed = 1;   ///< of the random vector that it starts from
  ConjugateGradient linear{.max_iterations = 500, .tolerance = 1e-12};  ///< for a consistent mass matrix only
};

/// What `largest_eigenvalue` found.
struct [[nodiscard]] EigenvalueReport {
  Status status = Status::not_converged;
  int iterations = 0;
  double value = 0;     ///< estimate from below, 1/s^2
  double residual = 0;  ///< |M^-1 K x - value x|_M of its vector x, |x|_M = 1: an eigenvalue is that close
  std::string_view reason = "";  ///< why it did not converge; empty if it did

  /// The largest circular frequency, estimated from above, 1/s: sqrt(value + residual), 0 if that is
  /// negative.
  [[nodiscard]] double omega() const { return std::sqrt(std::max(0.0, value + residual)); }
};

namespace detail {

// Symmetric tridiagonal matrix, beta[i] beside alpha[i] and alpha[i + 1].
struct Tridiagonal {
  std::vector<double> alpha, beta, d, x;

  // True if T - shift is negative definite.
  [[nodiscard]] bool below(double shift) {
    d.resize(alpha.size());
    for (std::size_t i = 0; i < alpha.size(); ++i) {
      d[i] = alpha[i] - shift - (i == 0 ? 0 : beta[i - 1] * beta[i - 1] / d[i - 1]);
      if (!(d[i] < 0)) return false;
    }
    return true;
  }
  // Largest eigenvalue, to rounding from above. It is at least `low`, that of a smaller matrix.
  [[nodiscard]] double largest(double low) {
    double high = low;
    for (std::size_t i = 0; i < alpha.size(); ++i)
      high = std::max(high, alpha[i] + (i == 0 ? 0 : std::abs(beta[i - 1])) +
                                (i + 1 == alpha.size() ? 0 : std::abs(beta[i])));
    for (int k = 0; k < 100; ++k) {
      const double middle = low + (high - low) / 2;
      if (!(middle > low && middle < high)) break;
      (below(middle) ? high : low) = middle;
    }
    return high;
  }
  // |last component| of its eigenvector of unit length, by inverse iteration.
  [[nodiscard]] double last_component(double value) {
    const std::size_t n = alpha.size();
    double shift = value;
    for (double step = 1e-15 * std::abs(value) + 1e-300; !below(shift); step *= 2) shift += step;
    x.assign(n, 1);
    for (int sweep = 0; sweep < 4; ++sweep) {
      for (std::size_t i = 1; i < n; ++i) x[i] -= beta[i - 1] / d[i - 1] * x[i - 1];
      for (std::size_t i = n; i-- > 0;) x[i] = (x[i] - (i + 1 == n ? 0 : beta[i] * x[i + 1])) / d[i];
      double sum = 0;
      for (const double c : x) sum += c * c;
      for (double& c : x) c /= std::sqrt(sum);
    }
    return std::abs(x.back());
  }
};

}  // namespace detail

/// Largest eigenvalue of K x = lambda M x on the free components, K the elastic Hessian at q, by the Lanczos
/// method in the inner product of M (Parlett 1980): matrix-free, one Hessian product an iteration and, with a
/// consistent mass, one mass solve. Vectors are not orthogonalised again: that makes copies of eigenvalues
/// found, not wrong ones. Terms whose Hessian is not symmetric count with what they give to solvers. For
/// set-up: it allocates.
/// @throws std::invalid_argument for fewer than one iteration, a tolerance <= 0, or a free component without
/// mass
template <class S>
EigenvalueReport largest_eigenvalue(const S& system, const State<typename S::Scalar>& q,
                                    const LargestEigenvalueOptions& options = {}) {
  using T = typename S::Scalar;
  if (options.max_iterations < 1)
    invalid(std::string("max_iterations ") + std::to_string(options.max_iterations) + ": must be at least 1");
  if (!(options.tolerance > 0) || !(options.tolerance < 1))
    invalid(std::string("tolerance ") + to_text(options.tolerance) + ": must be in (0, 1)");
  const Vector<T>&free = system.prescribed.free(), &m = system.mass.diagonal();
  for (std::ptrdiff_t k = 0; k < free.size(); ++k)
    if (free[k] != T(0) && !(m[k] > T(0)))
      invalid(std::string("node ") + std::to_string(k / block_stride) + ": mass " +
              to_text(static_cast<double>(m[k])) + " kg must be positive where it is free");
  const auto ended = [](EigenvalueReport report, Status status, std::string_view reason) {
    return detail::ended(report, status, reason);
  };
  EigenvalueReport report;
  MassSolve<S> mass(options.linear);
  detail::Tridiagonal t;
  const auto mass_product = [&](const Vector<T>& x, Vector<T>& y) {
    y.setZero(x.size());
    system.mass.add_product(q, x, T(1), y);
    system.prescribed.mask(y);
  };
  Vector<T> v(system.size()), last = Vector<T>::Zero(v.size()), Mv, Kv, w;
  std::mt19937_64 bits(options.seed);
  for (std::ptrdiff_t k = 0; k < v.size(); ++k)
    v[k] = free[k] * static_cast<T>(static_cast<double>(bits() >> 11) * 0x1p-52 - 1);
  mass_product(v, Mv);
  const double length = std::sqrt(dot(v, Mv));
  if (length == 0) return ended(report, Status::converged, "");  // nothing is free
  v /= static_cast<T>(length);
  Mv /= static_cast<T>(length);
  for (double norm_T = 0; report.iterations < options.max_iterations;) {
    Kv.setZero(v.size());
    system.add_elastic_hessian_product(q, v, Kv);
    system.prescribed.mask(Kv);
    const double alpha = dot(v, Kv);
    if (!std::isfinite(alpha) || !std::isfinite(norm(Kv)))
      return ended(report, Status::not_finite, "the Hessian is not finite");
    if (mass.solve(system, q, Kv, w).status != Status::converged)
      return ended(report, Status::not_converged,
                   "conjugate gradients on the mass matrix: too many iterations");
    w -= static_cast<T>(alpha) * v;
    if (!t.beta.empty()) w -= static_cast<T>(t.beta.back()) * last;
    mass_product(w, Mv);
    const double beta = std::sqrt(std::max(0.0, dot(w, Mv)));
    t.alpha.push_back(alpha);
    ++report.iterations;
    norm_T = std::max({norm_T, std::abs(alpha), beta});
    const double before = report.value;
    report.value = t.largest(report.iterations == 1 ? alpha : before);
    report.residual = beta * t.last_component(report.value);
    // An invariant subspace: with the random start it holds the largest eigenvalue's vector.
    const bool complete = beta <= 64 * static_cast<double>(std::numeric_limits<T>::epsilon()) * norm_T;
    if (complete || (report.iterations > 1 &&
                     std::abs(report.value - before) <= options.tolerance * std::abs(report.value) &&
                     report.residual <= std::sqrt(options.tolerance) * std::abs(report.value)))
      return ended(report, Status::converged, "");
    t.beta.push_back(beta);
    last.swap(v);
    v = w / static_cast<T>(beta);
  }
  return ended(report, Status::not_converged, "Lanczos: too many iterations");
}

}  // namespace softsim
