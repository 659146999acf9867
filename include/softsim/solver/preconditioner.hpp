// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "softsim/core/batch.hpp"
#include "softsim/core/frame_block.hpp"
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

/// z_i = A_ii^-1 r_i with the 3x3 diagonal blocks A_ii of points, the 6x6 blocks of frames. A block that is
/// not positive definite (a tangent far from a minimum) is replaced by the absolute values of its diagonal.
template <class T>
class BlockJacobi {
 public:
  /// Inverts the diagonal blocks of A, which offers `diagonal_blocks` and, for frames, `frames` and
  /// `frame_blocks`, over the free components.
  template <class A>
  void compute(const A& a, const Vector<T>& free) {
    a.diagonal_blocks(blocks_);
    inverse_.resize(12 * blocks_.size());
    trouble_.clear();
    for (std::size_t i = 0; i < blocks_.size(); ++i) {
      const auto open = block(free, static_cast<std::ptrdiff_t>(i));
      blocks_[i] = open.asDiagonal() * blocks_[i] * open.asDiagonal();
      blocks_[i].diagonal() += Vec3<T>::Ones() - open;
      Mat3<T> inverse;
      if (!invert(blocks_[i], inverse)) {
        refuse(i);
        inverse = absolute_inverse(blocks_[i]);
      }
      store(inverse, &inverse_[12 * i]);
    }
    frame_inverse_.clear();
    if constexpr (requires { a.frame_blocks(couplings_); })
      if (a.frames() > 0) compute_frames(a, free);
  }
  /// Applies it to r.
  void apply(const Vector<T>& r, Vector<T>& z) const {
    const auto frames = static_cast<std::ptrdiff_t>(frame_inverse_.size() / 48),
               points = r.size() / block_stride - 2 * frames;
    for (std::ptrdiff_t i = 0; i < points; ++i)
      apply(i, r.data() + block_stride * i).store(&z[block_stride * i]);
    for (std::ptrdiff_t j = 0; j < frames; ++j) {
      const std::ptrdiff_t at = block_stride * (points + 2 * j);
      const T *p = frame_inverse_.data() + 48 * j, *x = r.data() + at, *y = x + block_stride;
      (product(p, x) + product(p + 12, y)).store(&z[at]);
      (product(p + 24, x) + product(p + 36, y)).store(&z[at + block_stride]);
    }
  }
  /// A_ii^-1 times the three scalars at r, of the 3x3 block i, be it one of a frame.
  [[nodiscard]] Batch<T, 4> apply(std::ptrdiff_t i, const T* r) const {
    return product(inverse_.data() + 12 * i, r);
  }

  /// Names the first node whose block had to be replaced; empty if none had.
  [[nodiscard]] std::string_view trouble() const { return trouble_; }

 private:
  template <class A>
  void compute_frames(const A& a, const Vector<T>& free) {
    a.frame_blocks(couplings_);
    const std::size_t points = blocks_.size() - 2 * couplings_.size();
    frame_inverse_.resize(48 * couplings_.size());
    for (std::size_t j = 0; j < couplings_.size(); ++j) {
      const std::size_t i = points + 2 * j;
      const auto at = static_cast<std::ptrdiff_t>(i);
      const FrameBlock<T> frame =
          restricted<T>({blocks_[i], couplings_[j], blocks_[i + 1]}, block(free, at), block(free, at + 1));
      FrameBlock<T> inverse;
      if (!invert(frame, inverse)) {
        refuse(i);
        inverse = {absolute_inverse(frame.tt), Mat3<T>::Zero(), absolute_inverse(frame.rr)};
      }
      T* p = &frame_inverse_[48 * j];
      store(inverse.tt, p);
      store(inverse.tr, p + 12);
      store(inverse.tr.transpose(), p + 24);
      store(inverse.rr, p + 36);
    }
  }

  static Mat3<T> absolute_inverse(const Mat3<T>& A) {
    Mat3<T> inverse = Mat3<T>::Zero();
    for (int k = 0; k < 3; ++k) inverse(k, k) = std::abs(A(k, k)) > T(0) ? 1 / std::abs(A(k, k)) : T(1);
    return inverse;
  }
  void refuse(std::size_t i) {
    if (trouble_.empty())
      trouble_ = std::string("node ") + std::to_string(i) + ": diagonal block is not positive definite";
  }
  // Three columns of four.
  static void store(const Mat3<T>& A, T* p) {
    for (int k = 0; k < 3; ++k) {
      for (int row = 0; row < 3; ++row) p[4 * k + row] = A(row, k);
      p[4 * k + 3] = T(0);
    }
  }
  static Batch<T, 4> product(const T* p, const T* r) {
    using Four = Batch<T, 4>;
    return Four::load(p) * Four(r[0]) + Four::load(p + 4) * Four(r[1]) + Four::load(p + 8) * Four(r[2]);
  }

  std::vector<Mat3<T>> blocks_, couplings_;
  std::vector<T> inverse_, frame_inverse_;
  std::string trouble_;
};

}  // namespace softsim
