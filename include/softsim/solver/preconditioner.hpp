// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "softsim/core/batch.hpp"
#include "softsim/core/state.hpp"

namespace softsim {

/// z = r.
template <class T>
class NoPreconditioner {
 public:
  /// Nothing to prepare.
  template <class A>
  void compute(const A&, const Vector<T>&) {}
  /// Applies it to r.
  void apply(const Vector<T>& r, Vector<T>& z) const { z = r; }
};

/// z_i = r_i / |a_ii|.
template <class T>
class Jacobi {
 public:
  /// Reads the diagonal of A, which offers `diagonal_blocks`; `free` is 1 for free components, 0 else.
  template <class A>
  void compute(const A& a, const Vector<T>& free) {
    a.diagonal_blocks(blocks_);
    inverse_.resize(free.size());
    trouble_.clear();
    for (std::size_t i = 0; i < blocks_.size(); ++i)
      for (int c = 0; c < 4; ++c) {
        const std::ptrdiff_t k = block_stride * static_cast<std::ptrdiff_t>(i) + c;
        const T d = c < 3 ? std::abs(blocks_[i](c, c)) : T(0);
        if (free[k] != T(0) && !(blocks_[i](c, c) > T(0)) && trouble_.empty())
          trouble_ = std::string("node ") + std::to_string(i) + ": diagonal entry is not positive";
        inverse_[k] = free[k] == T(0) ? T(0) : d > T(0) ? 1 / d : T(1);
      }
  }
  /// Applies it to r.
  void apply(const Vector<T>& r, Vector<T>& z) const { z.array() = inverse_.array() * r.array(); }

  /// Names the first node with an entry that is not positive; empty if there is none.
  [[nodiscard]] std::string_view trouble() const { return trouble_; }

 private:
  std::vector<Mat3<T>> blocks_;
  Vector<T> inverse_;
  std::string trouble_;
};

/// z_i = A_ii^-1 r_i with the 3x3 diagonal blocks A_ii. A block that is not positive definite (a tangent far
/// from a minimum) is replaced by the absolute values of its diagonal.
template <class T>
class BlockJacobi {
 public:
  /// Inverts the diagonal blocks of A, which offers `diagonal_blocks`, over the free components.
  template <class A>
  void compute(const A& a, const Vector<T>& free) {
    a.diagonal_blocks(blocks_);
    inverse_.resize(12 * blocks_.size());
    trouble_.clear();
    for (std::size_t i = 0; i < blocks_.size(); ++i) {
      const auto open = block(free, static_cast<std::ptrdiff_t>(i));
      Mat3<T> D = open.asDiagonal() * blocks_[i] * open.asDiagonal();
      D.diagonal() += Vec3<T>::Ones() - open;
      const Mat3<T> c = cofactor(D);
      const T det = D.col(0).dot(c.col(0));
      Mat3<T> inverse;
      if (D(0, 0) > T(0) && c(2, 2) > T(0) && det > T(0)) {
        inverse = c.transpose() / det;
      } else {
        if (trouble_.empty())
          trouble_ = std::string("node ") + std::to_string(i) + ": diagonal block is not positive definite";
        inverse.setZero();
        for (int k = 0; k < 3; ++k) inverse(k, k) = std::abs(D(k, k)) > T(0) ? 1 / std::abs(D(k, k)) : T(1);
      }
      for (int k = 0; k < 3; ++k) {
        T* column = &inverse_[12 * i + 4 * static_cast<std::size_t>(k)];
        for (int row = 0; row < 3; ++row) column[row] = inverse(row, k);
        column[3] = T(0);
      }
    }
  }
  /// Applies it to r.
  void apply(const Vector<T>& r, Vector<T>& z) const {
    for (std::ptrdiff_t i = 0; i < r.size() / block_stride; ++i)
      apply(i, r.data() + block_stride * i).store(&z[block_stride * i]);
  }
  /// A_ii^-1 times the three scalars at r.
  [[nodiscard]] Batch<T, 4> apply(std::ptrdiff_t i, const T* r) const {
    using Four = Batch<T, 4>;
    const T* p = inverse_.data() + 12 * i;
    return Four::load(p) * Four(r[0]) + Four::load(p + 4) * Four(r[1]) + Four::load(p + 8) * Four(r[2]);
  }

  /// Names the first node whose block had to be replaced; empty if none had.
  [[nodiscard]] std::string_view trouble() const { return trouble_; }

 private:
  std::vector<Mat3<T>> blocks_;
  std::vector<T> inverse_;  // three columns of four per block
  std::string trouble_;
};

}  // namespace softsim
