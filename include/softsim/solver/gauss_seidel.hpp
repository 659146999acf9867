// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <string_view>
#include <vector>

#include "softsim/core/batch.hpp"
#include "softsim/core/state.hpp"
#include "softsim/solver/preconditioner.hpp"
#include "softsim/system/block_matrix.hpp"

namespace softsim {

/// Gauss-Seidel and successive over-relaxation by 3x3 blocks (d'Aulignac 2001, Eqs. 3.45, 3.46): row by row
/// x_i += omega A_ii^-1 (b_i - (A x)_i). As a method by itself: `Stationary` with this as preconditioner. As
/// a preconditioner of conjugate gradients: one sweep forward and one backward from zero, SSOR, which is
/// symmetric and, for omega in (0, 2) and a positive definite A, positive definite. Needs an operator with a
/// `matrix()`, to which it refers.
///
/// Options are public members; solvers show theirs as `preconditioner`: newton.preconditioner.omega = 1.5.
template <class T>
class GaussSeidel {
 public:
  double omega = 1;        ///< over-relaxation, in (0, 2)
  bool symmetric = false;  ///< a sweep goes forward and back, else forward only
  bool coloured = false;  ///< rows that are not coupled side by side, with OpenMP in parallel: other iterates

  /// Reads A, which has to stay as it is until the next call, as has `free`: 1 for free components, 0 else.
  template <class A>
  void compute(const A& a, const Vector<T>& free) {
    diagonal_.compute(a, free);
    matrix_ = &a.matrix();
    free_ = &free;
    if (pattern_ == matrix_->pattern() && was_coloured_ == coloured && order_.size() == matrix_->rows())
      return;
    pattern_ = matrix_->pattern();
    was_coloured_ = coloured;
    make_order();
  }

  /// One sweep: improves x towards A x = b. Both are zero in prescribed components.
  void sweep(const Vector<T>& b, Vector<T>& x) const {
    for (std::size_t c = 0; c + 1 < colour_start_.size(); ++c) rows(c, b, x);
    if (symmetric)
      for (std::size_t c = colour_start_.size() - 1; c-- > 0;) rows(c, b, x, true);
  }

  /// z = B r, SSOR with this omega.
  void apply(const Vector<T>& r, Vector<T>& z) const {
    z.setZero(r.size());
    for (std::size_t c = 0; c + 1 < colour_start_.size(); ++c) rows(c, r, z);
    for (std::size_t c = colour_start_.size() - 1; c-- > 0;) rows(c, r, z, true);
  }

  /// What is wrong: an omega that cannot converge, a diagonal block that is not positive definite; empty if
  /// nothing.
  [[nodiscard]] std::string_view trouble() const {
    if (!(omega > 0 && omega < 2)) return "omega: must be in (0, 2)";
    return diagonal_.trouble();
  }

 private:
  void row(std::size_t i, const Vector<T>& b, Vector<T>& x) const {
    T residual[4];
    matrix_->row_product(i, x, residual);
    const std::ptrdiff_t first = block_stride * static_cast<std::ptrdiff_t>(i);
    for (int c = 0; c < 3; ++c) residual[c] = (*free_)[first + c] * (b[first + c] - residual[c]);
    T* xi = x.data() + first;
    const Batch<T, 4> step = diagonal_.apply(static_cast<std::ptrdiff_t>(i), residual);
    (Batch<T, 4>::load(xi) + Batch<T, 4>(static_cast<T>(omega)) * step).store(xi);
  }
  void rows(std::size_t colour, const Vector<T>& b, Vector<T>& x, bool backward = false) const {
    const std::ptrdiff_t begin = colour_start_[colour], end = colour_start_[colour + 1];
    if (!was_coloured_) {
      for (std::ptrdiff_t k = 0; k < end - begin; ++k)
        row(static_cast<std::size_t>(backward ? end - 1 - k : begin + k), b, x);
      return;
    }
#ifdef _OPENMP
#pragma omp parallel for schedule(static) if (end - begin > 500)
#endif
    for (std::ptrdiff_t k = begin; k < end; ++k)
      row(static_cast<std::size_t>(order_[static_cast<std::size_t>(k)]), b, x);
  }

  // Every row gets the first colour that no row coupled to it has.
  void make_order() {
    const std::size_t n = matrix_->rows();
    order_.resize(n);
    std::iota(order_.begin(), order_.end(), 0);
    colour_start_.assign({0, static_cast<std::ptrdiff_t>(n)});
    if (!coloured) return;
    std::vector<int> colour(n, -1);
    std::vector<std::size_t> taken;  // by which row
    for (std::size_t i = 0; i < n; ++i) {
      matrix_->for_each_in_row(i, [&](std::int32_t j, std::int32_t, bool) {
        const int c = colour[static_cast<std::size_t>(j)];
        if (c >= 0) taken[static_cast<std::size_t>(c)] = i;
      });
      std::size_t c = 0;
      while (c < taken.size() && taken[c] == i) ++c;
      if (c == taken.size()) taken.push_back(n);
      colour[i] = static_cast<int>(c);
    }
    std::stable_sort(order_.begin(), order_.end(), [&](std::int32_t a, std::int32_t b) {
      return colour[static_cast<std::size_t>(a)] < colour[static_cast<std::size_t>(b)];
    });
    colour_start_.assign(taken.size() + 1, 0);
    for (const int c : colour) ++colour_start_[static_cast<std::size_t>(c) + 1];
    for (std::size_t c = 1; c < colour_start_.size(); ++c) colour_start_[c] += colour_start_[c - 1];
  }

  const SymmetricBlockMatrix<T>* matrix_ = nullptr;
  const Vector<T>* free_ = nullptr;
  BlockJacobi<T> diagonal_;
  std::uint64_t pattern_ = 0;
  bool was_coloured_ = false;
  std::vector<std::int32_t> order_;
  std::vector<std::ptrdiff_t> colour_start_;
};

/// The omega with which SOR converges fastest, 2/(1 + sqrt(1 - rho^2)), from the spectral radius rho < 1 of
/// Jacobi's iteration (Young 1971; d'Aulignac 2001, Eq. 3.47): exact for consistently ordered matrices, a
/// good guess for others.
[[nodiscard]] inline double optimal_relaxation(double rho) {
  return 2 / (1 + std::sqrt(1 - std::min(1.0, rho * rho)));
}

/// Spectral radius of the iteration I - B A, by `iterations` steps of the power method: B = `Jacobi` or
/// `BlockJacobi` gives the rho of `optimal_relaxation`. An estimate from below.
template <class T, class A, class B>
[[nodiscard]] double iteration_radius(const A& a, const B& preconditioner, const Vector<T>& free,
                                      int iterations = 50) {
  Vector<T> x(free.size()), y(free.size()), z(free.size());
  for (std::ptrdiff_t k = 0; k < x.size(); ++k)
    x[k] = free[k] * static_cast<T>(std::sin(1.0 + static_cast<double>(k) * static_cast<double>(k)));
  double radius = 0, before = norm(x);
  if (before == 0) return 0;
  x /= static_cast<T>(before);
  // two steps at a time: eigenvalues of both signs make single ones alternate
  for (int k = 0; k < iterations; ++k) {
    for (int half = 0; half < 2; ++half) {
      a.apply(x, y);
      preconditioner.apply(y, z);
      x -= z;
    }
    const double growth = norm(x);
    if (!(growth > 0) || !std::isfinite(growth)) return growth > 0 ? growth : 0;
    radius = std::sqrt(growth);
    x /= static_cast<T>(growth);
  }
  return radius;
}

}  // namespace softsim
