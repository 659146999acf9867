// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "softsim/core/gather.hpp"
#include "softsim/core/tensor.hpp"

// How `Elements` adds the Hessians of a chunk of stencils to a matrix of 3x3 blocks.

namespace softsim::detail {

/// Where the blocks (i, j), i <= j, of `count` stencils side by side go, and the scale that they get.
template <class T, int N, int blocks>
struct BlockPlaces {
  using Value = Lanes<T, N>;
  /// Places per stencil: the upper triangle, row by row.
  static constexpr int stride = blocks * (blocks + 1) / 2;

  T* values;
  const std::int32_t* places;
  int count;
  T scale;

  /// Adds m, which has the scale already, to block (i, j).
  void add(int i, int j, const Mat3<Value>& m) const {
    scatter_add_matrix<T, N>(values, places + i * blocks - i * (i + 1) / 2 + j, stride, m, count);
  }
};

/// Blocks (i, j) with 1 <= i <= j from the closed form of a translation-invariant local force; those of point
/// 0 are minus the sums.
template <class E, class Form, class T, int N, int blocks>
void add_closed_blocks(const E& model, const Form& form, const BlockPlaces<T, N, blocks>& to) {
  using Value = Lanes<T, N>;
  std::array<Mat3<Value>, blocks> first;  // (0, j)
  for (auto& m : first) m.setZero();
  const auto each = [&]<int i, int j>() {
    Mat3<Value> m = model.template hessian_block<i, j>(form);
    m *= Value(to.scale);
    to.add(i, j, m);
    first[j] -= m;
    if constexpr (i != j) first[i] -= m.transpose();
  };
  const auto row = [&]<int i, int... k>(std::integer_sequence<int, k...>) {
    (each.template operator()<i, i + k>(), ...);
  };
  [&]<int... i>(std::integer_sequence<int, i...>) {
    (row.template operator()<i + 1>(std::make_integer_sequence<int, blocks - 1 - i>()), ...);
  }
  (std::make_integer_sequence<int, blocks - 1>());
  for (int j = 1; j < blocks; ++j) {
    const Mat3<Value>& m = first[static_cast<std::size_t>(j)];
    to.add(0, j, m);
    first[0] -= m;
  }
  to.add(0, 0, first[0]);
}

/// Column by column: `product` is the Hessian's, of one direction.
template <bool translation_invariant, class T, int N, int blocks, class Product>
void add_block_columns(const BlockPlaces<T, N, blocks>& to, Product product) {
  using Value = Lanes<T, N>;
  using Column = Eigen::Matrix<Value, 3 * blocks, 1>;
  constexpr int begin = translation_invariant ? 1 : 0;
  Mat3<Value> corner = Mat3<Value>::Zero();  // (0, 0), minus the sum of its row
  for (int j = begin; j < blocks; ++j) {
    std::array<Mat3<Value>, blocks> m;
    for (int a = 0; a < 3; ++a) {
      Column unit = Column::Zero();
      unit[3 * j + a] = Value(to.scale);
      const Column column = product(unit);
      for (int i = begin; i < blocks; ++i)
        m[static_cast<std::size_t>(i)].col(a) = column.template segment<3>(3 * i);
    }
    for (int i = begin; i <= j; ++i) to.add(i, j, m[static_cast<std::size_t>(i)]);
    if constexpr (translation_invariant) {
      Mat3<Value> top = Mat3<Value>::Zero();
      for (int i = begin; i < blocks; ++i) top -= m[static_cast<std::size_t>(i)];
      to.add(0, j, top);
      corner -= top;
    }
  }
  if constexpr (translation_invariant) to.add(0, 0, corner);
}

}  // namespace softsim::detail
