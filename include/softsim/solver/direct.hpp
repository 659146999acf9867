// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "softsim/core/state.hpp"
#include "softsim/system/block_matrix.hpp"

namespace softsim {

/// A direct factorisation as a preconditioner: B = A^-1. With `Stationary` one iteration solves, whatever the
/// signs of the eigenvalues; with `ConjugateGradient` one does if A is positive definite. Factorisation and
/// application are Eigen's, which allocates. Needs an operator with a `matrix()`. Prescribed components get
/// rows of the identity.
template <class T, class Factorisation>
class Direct {
 public:
  /// Factorises A over the free components; fill-reducing order and structure are worked out once per
  /// pattern.
  template <class A>
  void compute(const A& a, const Vector<T>& free) {
    const auto& matrix = a.matrix();
    if (pattern_ != matrix.pattern() || count_ != matrix.rows()) {
      make_pattern(matrix);
      factorisation_->analyzePattern(lower_);
    }
    T* values = lower_.valuePtr();
    for (const Entry& e : entries_) {
      const bool open = free[e.row] != T(0) && free[e.column] != T(0);
      values[e.place] = open ? matrix.values()[e.value] : T(e.row == e.column ? 1 : 0);
    }
    factorisation_->factorize(lower_);
    ok_ = factorisation_->info() == Eigen::Success;
  }

  /// z = A^-1 r; z = r if the factorisation has failed.
  void apply(const Vector<T>& r, Vector<T>& z) const {
    if (!ok_) {
      z = r;
      return;
    }
    packed_ = pack(r);
    solution_ = factorisation_->solve(packed_);
    z = unpack(solution_);
  }

  /// What is wrong; empty if A could be factorised.
  [[nodiscard]] std::string_view trouble() const {
    return ok_ ? "" : "direct solver: the matrix is singular, or not positive definite where it has to be";
  }
  /// Eigen's factorisation, of the matrix with three scalars a node.
  [[nodiscard]] const Factorisation& factorisation() const { return *factorisation_; }

 private:
  struct Entry {
    std::ptrdiff_t place, value;  // in the sparse matrix, in the values of the block matrix
    std::ptrdiff_t row, column;   // in flat vectors
  };

  template <class Matrix>
  void make_pattern(const Matrix& matrix) {
    pattern_ = matrix.pattern();
    count_ = matrix.rows();
    // Column j of the lower triangle is row j of the upper one.
    struct Place {
      int row, column;
      std::ptrdiff_t value;
    };
    std::vector<Eigen::Triplet<T>> triplets;
    std::vector<Place> places;
    for (std::size_t i = 0; i < count_; ++i)
      matrix.for_each_in_row(i, [&](std::int32_t j, std::int32_t k, bool transposed) {
        if (transposed) return;
        for (int b = 0; b < 3; ++b)
          for (int a = 0; a < 3; ++a) {
            const int row = 3 * static_cast<int>(i) + a, column = 3 * j + b;
            if (row > column) continue;  // the diagonal block is symmetric
            triplets.emplace_back(column, row, T(1));
            places.push_back({column, row, 9 * static_cast<std::ptrdiff_t>(k) + 3 * b + a});
          }
      });
    const int n = 3 * static_cast<int>(count_);
    lower_.resize(n, n);
    lower_.setFromTriplets(triplets.begin(), triplets.end());
    lower_.makeCompressed();
    entries_.clear();
    const auto flat = [](int i) { return static_cast<std::ptrdiff_t>(i / 3 * block_stride + i % 3); };
    for (const Place& p : places) {
      const auto* first = lower_.innerIndexPtr() + lower_.outerIndexPtr()[p.column];
      const auto* last = lower_.innerIndexPtr() + lower_.outerIndexPtr()[p.column + 1];
      const std::ptrdiff_t place = std::lower_bound(first, last, p.row) - lower_.innerIndexPtr();
      entries_.push_back({place, p.value, flat(p.row), flat(p.column)});
    }
  }

  Eigen::SparseMatrix<T> lower_;
  // Eigen's cannot be moved.
  std::unique_ptr<Factorisation> factorisation_ = std::make_unique<Factorisation>();
  std::vector<Entry> entries_;
  std::uint64_t pattern_ = 0;
  std::size_t count_ = 0;
  bool ok_ = false;
  mutable Vector<T> packed_, solution_;
};

/// L L^T by Eigen, for positive definite operators.
template <class T>
using Llt = Direct<T, Eigen::SimplicialLLT<Eigen::SparseMatrix<T>, Eigen::Lower>>;
/// L D L^T by Eigen, for symmetric operators, indefinite ones included unless a pivot vanishes.
template <class T>
using Ldlt = Direct<T, Eigen::SimplicialLDLT<Eigen::SparseMatrix<T>, Eigen::Lower>>;

/// Number of negative eigenvalues of what was factorised: 0 at a stable equilibrium.
template <class T>
[[nodiscard]] std::ptrdiff_t negative_pivots(const Ldlt<T>& direct) {
  return (direct.factorisation().vectorD().array() < T(0)).count();
}

}  // namespace softsim
