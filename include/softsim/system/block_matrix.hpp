// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/SparseCore>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "softsim/core/batch.hpp"
#include "softsim/core/error.hpp"
#include "softsim/core/state.hpp"

namespace softsim {

/// Symmetric sparse matrix of 3x3 blocks over flat vectors of blocks; blocks on the diagonal have to be
/// symmetric themselves. Of the blocks (i, j) those with i <= j are stored, in compressed rows; the others
/// are their transposes. Half the numbers are half the traffic of an assembly, which waits for memory.
template <class T>
class SymmetricBlockMatrix {
 public:
  SymmetricBlockMatrix() = default;

  /// Zero matrix with room for the given (row, column) blocks and their transposes; repeated ones count once.
  /// @throws std::invalid_argument for 2^30 blocks or more, whose places would not fit into 32 bits
  SymmetricBlockMatrix(std::size_t rows, std::vector<std::pair<std::int32_t, std::int32_t>> blocks)
      : row_start_(rows + 1, 0), lower_start_(rows + 1, 0), pattern_(detail::next_number()) {
    for (auto& [i, j] : blocks)
      if (i > j) std::swap(i, j);
    std::sort(blocks.begin(), blocks.end());
    blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
    if (blocks.size() >= (std::size_t{1} << 30))
      invalid(std::string("matrix: ") + std::to_string(blocks.size()) +
              " blocks, less than 2^30 are possible");
    column_.reserve(blocks.size());
    for (const auto& [i, j] : blocks) {
      ++row_start_[static_cast<std::size_t>(i) + 1];
      if (i != j) ++lower_start_[static_cast<std::size_t>(j) + 1];
      column_.push_back(j);
    }
    for (std::size_t i = 0; i < rows; ++i) {
      row_start_[i + 1] += row_start_[i];
      lower_start_[i + 1] += lower_start_[i];
    }
    std::vector<std::int32_t> next = lower_start_;
    lower_.resize(static_cast<std::size_t>(lower_start_.back()));
    for (std::size_t k = 0; k < blocks.size(); ++k)
      if (const auto [i, j] = blocks[k]; i != j)
        lower_[static_cast<std::size_t>(next[static_cast<std::size_t>(j)]++)] = {static_cast<std::int32_t>(k),
                                                                                 i};
    // The product reads four scalars where a column of a block has three: one more at the very end.
    values_.assign(9 * column_.size() + 1, T(0));
    twins_from_ = rows;
    while (twins_from_ >= 2 && are_twins(twins_from_ - 2)) twins_from_ -= 2;
  }

  /// Number of block rows.
  [[nodiscard]] std::size_t rows() const { return row_start_.empty() ? 0 : row_start_.size() - 1; }
  /// Number of stored blocks.
  [[nodiscard]] std::size_t blocks() const { return column_.size(); }
  /// Place of block (i, j): 2 k if it is stored block k, 2 k + 1 if it is the transpose of that, -1 if the
  /// pattern does not have it.
  [[nodiscard]] std::int32_t place(std::int32_t i, std::int32_t j) const {
    const auto [row, column] = std::minmax(i, j);
    const auto first = column_.begin() + row_start_[static_cast<std::size_t>(row)];
    const auto last = column_.begin() + row_start_[static_cast<std::size_t>(row) + 1];
    const auto found = std::lower_bound(first, last, column);
    if (found == last || *found != column) return -1;
    return 2 * static_cast<std::int32_t>(found - column_.begin()) + (i > j ? 1 : 0);
  }

  /// Nine scalars per stored block, column-major, row after row.
  [[nodiscard]] T* values() { return values_.data(); }
  [[nodiscard]] const T* values() const { return values_.data(); }
  /// Stored block k, writable.
  [[nodiscard]] Eigen::Map<Mat3<T>> block(std::int32_t k) {
    return Eigen::Map<Mat3<T>>(values() + 9 * static_cast<std::ptrdiff_t>(k));
  }
  /// Stored block k.
  [[nodiscard]] Eigen::Map<const Mat3<T>> block(std::int32_t k) const {
    return Eigen::Map<const Mat3<T>>(values() + 9 * static_cast<std::ptrdiff_t>(k));
  }
  /// Sets all values to zero and keeps the pattern.
  void set_zero() { std::fill(values_.begin(), values_.end(), T(0)); }

  /// Row i of A x into the four scalars at y, the last zero.
  void row_product(std::size_t i, const Vector<T>& x, T* y) const {
    upper_product(i, x, y);
    add_lower_product(i, x, y);
  }
  /// What the diagonal and the blocks above it give of row i of A x, into the four scalars at y.
  void upper_product(std::size_t i, const Vector<T>& x, T* y) const {
    using Four = Batch<T, 4>;  // its fourth lane takes in the neighbouring scalar and is dropped
    Four sum(0);
    const T* value = values_.data() + 9 * static_cast<std::ptrdiff_t>(row_start_[i]);
    for (std::int32_t k = row_start_[i]; k < row_start_[i + 1]; ++k, value += 9) {
      const T* xj =
          x.data() + block_stride * static_cast<std::ptrdiff_t>(column_[static_cast<std::size_t>(k)]);
      sum += Four::load(value) * Four(xj[0]) + Four::load(value + 3) * Four(xj[1]) +
             Four::load(value + 6) * Four(xj[2]);
    }
    sum.store(y);
    y[3] = T(0);
  }
  /// Adds what the blocks below the diagonal give.
  void add_lower_product(std::size_t i, const Vector<T>& x, T* y) const {
    using Four = Batch<T, 4>;
    Four dot[3] = {Four(0), Four(0), Four(0)};
    for (std::int32_t k = lower_start_[i]; k < lower_start_[i + 1]; ++k) {
      const Transposed& t = lower_[static_cast<std::size_t>(k)];
      const Four xj = Four::load(x.data() + block_stride * static_cast<std::ptrdiff_t>(t.column));
      const T* column = values_.data() + 9 * static_cast<std::ptrdiff_t>(t.block);
      for (int a = 0; a < 3; ++a) dot[a] += Four::load(column + 3 * a) * xj;
    }
    for (int a = 0; a < 3; ++a) y[a] += lane(dot[a], 0) + lane(dot[a], 1) + lane(dot[a], 2);
  }

  /// y = A x. Every row gathers its transposed blocks from the rows above it, where a good order of the nodes
  /// finds them in the cache; nothing is scattered, so that threads do not change a bit.
  void apply(const Vector<T>& x, Vector<T>& y) const {
    const auto count = static_cast<std::ptrdiff_t>(rows());
    const auto twins_from = static_cast<std::ptrdiff_t>(twins_from_);
#ifdef _OPENMP
#pragma omp parallel for schedule(static) if (count > 1000)
#endif
    for (std::ptrdiff_t i = 0; i < twins_from; ++i)
      row_product(static_cast<std::size_t>(i), x, y.data() + block_stride * i);
#ifdef _OPENMP
#pragma omp parallel for schedule(static) if (count > 1000)
#endif
    for (std::ptrdiff_t i = twins_from; i < count; i += 2)
      twin_product(static_cast<std::size_t>(i), x, y.data() + block_stride * i);
  }

  /// Calls f(j, k, transposed) for every block (i, j) of row i: it is stored block k or the transpose of
  /// that. First those above the diagonal and on it, j ascending from i; then those below, j ascending.
  template <class Function>
  void for_each_in_row(std::size_t i, Function f) const {
    for (std::int32_t k = row_start_[i]; k < row_start_[i + 1]; ++k)
      f(column_[static_cast<std::size_t>(k)], k, false);
    for (std::int32_t k = lower_start_[i]; k < lower_start_[i + 1]; ++k)
      f(lower_[static_cast<std::size_t>(k)].column, lower_[static_cast<std::size_t>(k)].block, true);
  }

  /// Different for every pattern that is made, shared by copies: tells what was worked out for a pattern from
  /// what was not.
  [[nodiscard]] std::uint64_t pattern() const { return pattern_; }

  /// The same matrix with three scalars per block row and both triangles, for Eigen's own solvers; see `pack`
  /// and `unpack`.
  [[nodiscard]] Eigen::SparseMatrix<T> to_eigen() const {
    std::vector<Eigen::Triplet<T>> entries;
    entries.reserve(18 * column_.size());
    for (std::size_t i = 0; i < rows(); ++i)
      for (std::int32_t k = row_start_[i]; k < row_start_[i + 1]; ++k) {
        const int row = 3 * static_cast<int>(i), column = 3 * column_[static_cast<std::size_t>(k)];
        for (int b = 0; b < 3; ++b)
          for (int a = 0; a < 3; ++a) {
            entries.emplace_back(row + a, column + b, block(k)(a, b));
            if (row != column) entries.emplace_back(column + b, row + a, block(k)(a, b));
          }
      }
    Eigen::SparseMatrix<T> A(3 * static_cast<int>(rows()), 3 * static_cast<int>(rows()));
    A.setFromTriplets(entries.begin(), entries.end());
    return A;
  }

 private:
  struct Transposed {
    std::int32_t block, column;
  };

  // Whether rows i and i + 1 have each other and the same other blocks, as the two of a frame do.
  [[nodiscard]] bool are_twins(std::size_t i) const {
    const auto upper = [&](std::size_t row) { return column_.begin() + row_start_[row]; };
    const auto lower = [&](std::size_t row) { return lower_.begin() + lower_start_[row]; };
    const auto same = [](const Transposed& a, const Transposed& b) { return a.column == b.column; };
    return upper(i + 1) - upper(i) >= 2 && upper(i + 2) > upper(i + 1) &&
           std::equal(upper(i) + 1, upper(i + 1), upper(i + 1), upper(i + 2)) &&
           static_cast<std::size_t>(*upper(i)) == i && static_cast<std::size_t>(*upper(i + 1)) == i + 1 &&
           std::equal(lower(i), lower(i + 1), lower(i + 1), lower(i + 2) - 1, same);
  }

  // Rows i and i + 1 of A x, twins, into the eight scalars at y: they share what is read of x, and the order.
  void twin_product(std::size_t i, const Vector<T>& x, T* y) const {
    using Four = Batch<T, 4>;
    const auto at = [&](std::int32_t j) { return x.data() + block_stride * static_cast<std::ptrdiff_t>(j); };
    const auto column = [](const T* block, int a) { return Four::load(block + 3 * a); };
    const T *first = values_.data() + 9 * static_cast<std::ptrdiff_t>(row_start_[i]),
            *second = values_.data() + 9 * static_cast<std::ptrdiff_t>(row_start_[i + 1]);
    const T* xi = at(static_cast<std::int32_t>(i));
    const Four whole = Four::load(xi);
    Four sum[6], dot[6];  // by rows of blocks, and by columns of the transposed ones
    for (int a = 0; a < 3; ++a) {
      sum[a] = column(first, a) * Four(xi[a]) + column(first + 9, a) * Four(xi[block_stride + a]);
      sum[3 + a] = column(second, a) * Four(xi[block_stride + a]);
      dot[a] = Four(0);
      dot[3 + a] = column(first + 9, a) * whole;
    }
    first += 18;
    second += 9;
    for (std::int32_t k = row_start_[i] + 2; k < row_start_[i + 1]; ++k, first += 9, second += 9) {
      const T* xj = at(column_[static_cast<std::size_t>(k)]);
      for (int a = 0; a < 3; ++a) {
        sum[a] += column(first, a) * Four(xj[a]);
        sum[3 + a] += column(second, a) * Four(xj[a]);
      }
    }
    for (std::int32_t k = lower_start_[i]; k < lower_start_[i + 1]; ++k) {
      const Transposed& t = lower_[static_cast<std::size_t>(k)];
      const Four xj = Four::load(at(t.column));
      const T* blocks = values_.data() + 9 * static_cast<std::ptrdiff_t>(t.block);  // in columns i and i + 1
      for (int a = 0; a < 6; ++a) dot[a] += column(blocks, a) * xj;
    }
    for (int half = 0; half < 2; ++half) {
      const Four* s = sum + 3 * half;
      const Four* d = dot + 3 * half;
      const Four all = s[0] + s[1] + s[2];
      for (int a = 0; a < 3; ++a)
        y[block_stride * half + a] = lane(all, a) + (lane(d[a], 0) + lane(d[a], 1) + lane(d[a], 2));
      y[block_stride * half + 3] = T(0);
    }
  }

  std::vector<std::int32_t> row_start_, column_, lower_start_;
  std::vector<Transposed> lower_;
  std::vector<T> values_;
  std::size_t twins_from_ = 0;  // rows from here on are twins, two and two: frames come last
  std::uint64_t pattern_ = 0;
};

/// The flat vector v without the fourth scalar of every block.
template <class T>
[[nodiscard]] Vector<T> pack(const Vector<T>& v) {
  Vector<T> packed(v.size() / block_stride * 3);
  for (std::ptrdiff_t i = 0; i < v.size() / block_stride; ++i)
    packed.template segment<3>(3 * i) = block(v, i);
  return packed;
}

/// The flat vector of blocks that `pack` made `packed` of.
template <class T>
[[nodiscard]] Vector<T> unpack(const Vector<T>& packed) {
  Vector<T> v = Vector<T>::Zero(packed.size() / 3 * block_stride);
  for (std::ptrdiff_t i = 0; i < packed.size() / 3; ++i) block(v, i) = packed.template segment<3>(3 * i);
  return v;
}

}  // namespace softsim
