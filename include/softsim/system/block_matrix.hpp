// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/SparseCore>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "softsim/core/batch.hpp"
#include "softsim/core/state.hpp"

namespace softsim {

/// Sparse matrix of 3x3 blocks in compressed rows, over flat vectors of blocks.
template <class T>
class BlockMatrix {
 public:
  BlockMatrix() = default;

  /// Zero matrix with room for the given (row, column) blocks; repeated ones count once.
  BlockMatrix(std::size_t rows, std::vector<std::pair<std::int32_t, std::int32_t>> blocks)
      : row_start_(rows + 1, 0) {
    std::sort(blocks.begin(), blocks.end());
    blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
    column_.reserve(blocks.size());
    for (const auto& [i, j] : blocks) {
      ++row_start_[static_cast<std::size_t>(i) + 1];
      column_.push_back(j);
    }
    for (std::size_t i = 0; i < rows; ++i) row_start_[i + 1] += row_start_[i];
    // The product reads four scalars where a column of a block has three: one more at the very end.
    values_.assign(9 * column_.size() + 1, T(0));
  }

  /// Number of block rows.
  [[nodiscard]] std::size_t rows() const { return row_start_.empty() ? 0 : row_start_.size() - 1; }
  /// Number of blocks.
  [[nodiscard]] std::size_t blocks() const { return column_.size(); }
  /// Position of block (i, j), or -1 if the pattern has none.
  [[nodiscard]] std::int32_t position(std::int32_t i, std::int32_t j) const {
    const auto first = column_.begin() + row_start_[static_cast<std::size_t>(i)];
    const auto last = column_.begin() + row_start_[static_cast<std::size_t>(i) + 1];
    const auto found = std::lower_bound(first, last, j);
    return found != last && *found == j ? static_cast<std::int32_t>(found - column_.begin()) : -1;
  }

  /// Nine scalars per block, column-major, in the order of the positions.
  [[nodiscard]] T* values() { return values_.data(); }
  [[nodiscard]] const T* values() const { return values_.data(); }
  /// Block at a position, writable.
  [[nodiscard]] Eigen::Map<Mat3<T>> block(std::int32_t position) {
    return Eigen::Map<Mat3<T>>(values() + 9 * static_cast<std::ptrdiff_t>(position));
  }
  /// Block at a position.
  [[nodiscard]] Eigen::Map<const Mat3<T>> block(std::int32_t position) const {
    return Eigen::Map<const Mat3<T>>(values() + 9 * static_cast<std::ptrdiff_t>(position));
  }
  /// Sets all values to zero and keeps the pattern.
  void set_zero() { std::fill(values_.begin(), values_.end(), T(0)); }

  /// y = A x.
  void apply(const Vector<T>& x, Vector<T>& y) const {
    using Four = Batch<T, 4>;
    const auto count = static_cast<std::ptrdiff_t>(rows());
#ifdef _OPENMP
#pragma omp parallel for schedule(static) if (count > 1000)
#endif
    for (std::ptrdiff_t i = 0; i < count; ++i) {
      Four sum(0);  // its fourth lane gathers the neighbouring scalar and is dropped
      const std::int32_t begin = row_start_[static_cast<std::size_t>(i)],
                         end = row_start_[static_cast<std::size_t>(i) + 1];
      const T* value = values_.data() + 9 * static_cast<std::ptrdiff_t>(begin);
      for (std::int32_t k = begin; k < end; ++k, value += 9) {
        const T* xj =
            x.data() + block_stride * static_cast<std::ptrdiff_t>(column_[static_cast<std::size_t>(k)]);
        sum += Four::load(value) * Four(xj[0]) + Four::load(value + 3) * Four(xj[1]) +
               Four::load(value + 6) * Four(xj[2]);
      }
      T* yi = y.data() + block_stride * i;
      sum.store(yi);
      yi[3] = T(0);
    }
  }

  /// The same matrix with three scalars per block row, for Eigen's own solvers; see `pack` and `unpack`.
  [[nodiscard]] Eigen::SparseMatrix<T> to_eigen() const {
    std::vector<Eigen::Triplet<T>> entries;
    entries.reserve(9 * column_.size());
    for (std::size_t i = 0; i < rows(); ++i)
      for (std::int32_t k = row_start_[i]; k < row_start_[i + 1]; ++k)
        for (int b = 0; b < 3; ++b)
          for (int a = 0; a < 3; ++a)
            entries.emplace_back(3 * static_cast<int>(i) + a, 3 * column_[static_cast<std::size_t>(k)] + b,
                                 block(k)(a, b));
    Eigen::SparseMatrix<T> A(3 * static_cast<int>(rows()), 3 * static_cast<int>(rows()));
    A.setFromTriplets(entries.begin(), entries.end());
    return A;
  }

 private:
  std::vector<std::int32_t> row_start_, column_;
  std::vector<T> values_;
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
