// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/SparseCore>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "softsim/core/state.hpp"
#include "softsim/system/block_matrix.hpp"
#include "softsim/system/mass.hpp"
#include "softsim/system/prescribed.hpp"

namespace softsim {

/// The components of a flat vector that are not prescribed, numbered one after the other: what a direct
/// solver or an eigensolver of a library works on. Matrices and vectors of that numbering are in double.
class FreeComponents {
 public:
  FreeComponents() = default;
  template <class T>
  explicit FreeComponents(const Prescribed<T>& prescribed)
      : number_(static_cast<std::size_t>(prescribed.free().size()), -1) {
    for (std::ptrdiff_t k = 0; k < prescribed.free().size(); ++k)
      if (prescribed.free()[k] != T(0)) {
        number_[static_cast<std::size_t>(k)] = static_cast<std::int32_t>(flat_.size());
        flat_.push_back(k);
      }
  }

  /// How many there are.
  [[nodiscard]] std::ptrdiff_t size() const { return static_cast<std::ptrdiff_t>(flat_.size()); }
  /// Scalars in a flat vector.
  [[nodiscard]] std::ptrdiff_t flat_size() const { return static_cast<std::ptrdiff_t>(number_.size()); }
  /// Place of free component k in a flat vector.
  [[nodiscard]] std::ptrdiff_t flat(std::ptrdiff_t k) const { return flat_[static_cast<std::size_t>(k)]; }
  /// Number of component `axis` of a point, -1 if it is prescribed.
  [[nodiscard]] std::int32_t number(std::int32_t point, int axis) const {
    return number_[static_cast<std::size_t>(block_stride) * static_cast<std::size_t>(point) +
                   static_cast<std::size_t>(axis)];
  }

  /// x = the free components of the flat vector v.
  template <class Flat, class Free>
  void gather(const Flat& v, Free&& x) const {
    for (std::ptrdiff_t k = 0; k < size(); ++k) x[k] = static_cast<double>(v[flat(k)]);
  }
  /// v = the flat vector with the free components x and zeros elsewhere.
  template <class Free, class Flat>
  void scatter(const Free& x, Flat&& v) const {
    using T = typename std::decay_t<Flat>::Scalar;
    v.setZero();
    for (std::ptrdiff_t k = 0; k < size(); ++k) v[flat(k)] = static_cast<T>(x[k]);
  }

  /// Rows and columns of A of the free components, both triangles.
  template <class T>
  [[nodiscard]] Eigen::SparseMatrix<double> matrix(const SymmetricBlockMatrix<T>& A) const {
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(18 * A.blocks());
    for (std::size_t i = 0; i < A.rows(); ++i)
      A.for_each_in_row(i, [&](std::int32_t j, std::int32_t k, bool transposed) {
        const auto block = A.block(k);
        for (int a = 0; a < 3; ++a)
          for (int b = 0; b < 3; ++b) {
            const std::int32_t row = number(static_cast<std::int32_t>(i), a), column = number(j, b);
            if (row >= 0 && column >= 0)
              entries.emplace_back(row, column, static_cast<double>(transposed ? block(b, a) : block(a, b)));
          }
      });
    return made_of(entries);
  }
  /// Rows and columns of a mass matrix of the free components, both triangles, with frames as they are at
  /// rest.
  template <class T>
  [[nodiscard]] Eigen::SparseMatrix<double> matrix(const Mass<T>& mass) const {
    std::vector<Eigen::Triplet<double>> entries;
    const State<T> rest = mass.rest_state();
    for (std::ptrdiff_t k = 0; k < size() && flat(k) < block_stride * rest.points(); ++k)
      entries.emplace_back(static_cast<int>(k), static_cast<int>(k),
                           static_cast<double>(mass.diagonal()[flat(k)]));
    mass.for_each_coupling([&](std::int32_t i, std::int32_t j, T m) {
      for (int axis = 0; axis < 3; ++axis)
        if (number(i, axis) >= 0 && number(j, axis) >= 0)
          entries.emplace_back(number(i, axis), number(j, axis), static_cast<double>(m));
    });
    mass.frames().for_each_block(rest, [&](std::int32_t i, std::int32_t j, const Mat3<T>& m) {
      for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b) {
          const std::int32_t row = number(i, a), column = number(j, b);
          if (row < 0 || column < 0) continue;
          entries.emplace_back(row, column, static_cast<double>(m(a, b)));
          if (i != j) entries.emplace_back(column, row, static_cast<double>(m(a, b)));
        }
    });
    return made_of(entries);
  }

 private:
  [[nodiscard]] Eigen::SparseMatrix<double> made_of(
      const std::vector<Eigen::Triplet<double>>& entries) const {
    Eigen::SparseMatrix<double> A(size(), size());
    A.setFromTriplets(entries.begin(), entries.end());
    return A;
  }

  std::vector<std::int32_t> number_;
  std::vector<std::ptrdiff_t> flat_;
};

}  // namespace softsim
