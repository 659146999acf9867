// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "softsim/core/batch.hpp"

namespace softsim::detail {

/// What a level of multigrid, with R x R blocks, needs for its share of the V-cycle, in single precision: its
/// matrix, the inverses of the diagonal blocks, the prolongation from the next level and the vectors.
template <int R>
class MultigridCycle {
 public:
  static constexpr std::size_t lanes = R == 3 ? 4 : 8;  ///< scalars per node of a vector
  static constexpr std::size_t entries = R * R;         ///< scalars per block of A, row-major
  static constexpr std::size_t wide = 8;                ///< scalars per row of a block of the prolongation

  std::vector<std::int32_t> start, column, diagonal;  ///< rows of A, columns ascending, both triangles
  mutable std::vector<float> r, x;                    ///< right-hand side and solution

  /// Number of nodes.
  [[nodiscard]] std::size_t size() const { return diagonal.size(); }

  /// Forward Gauss-Seidel from x = 0, and what is left of r as the right-hand side of the next level.
  void descend(const MultigridCycle<6>& next) const {
    for (std::size_t i = 0; i < size(); ++i) {
      Lanes_ s = Lanes_::load(&r[lanes * i]);
      for (std::int32_t k = start[i]; k < diagonal[i]; ++k) s -= product(k);
      smooth(i, s);
    }
    std::fill(next.r.begin(), next.r.end(), 0.0F);
    for (std::size_t i = 0; i < size(); ++i) {
      Lanes_ s(0);
      for (std::int32_t k = diagonal[i] + 1; k < start[i + 1]; ++k) s -= product(k);
      float residual[lanes];
      s.store(residual);
      for (std::int32_t p = p_start_[i]; p < p_start_[i + 1]; ++p) {
        float* to = &next.r[wide * at(p_column_[at(p)])];
        Eight sum = Eight::load(to);
        for (std::size_t c = 0; c < R; ++c)
          sum += Eight::load(&p_[R * wide * at(p) + wide * c]) * Eight(residual[c]);
        sum.store(to);
      }
    }
  }

  /// Adds the correction of the next level, and backward Gauss-Seidel.
  void ascend(const MultigridCycle<6>& next) const {
    prolong(next);
    smooth_backward();
  }

  /// x += P next.x
  void prolong(const MultigridCycle<6>& next) const {
    for (std::size_t i = 0; i < size(); ++i) {
      Eight dot[R];
      for (std::size_t c = 0; c < R; ++c) dot[c] = Eight(0);
      for (std::int32_t p = p_start_[i]; p < p_start_[i + 1]; ++p) {
        const auto e = Eight::load(&next.x[8 * at(p_column_[at(p)])]);
        for (std::size_t c = 0; c < R; ++c) dot[c] += Eight::load(&p_[R * wide * at(p) + wide * c]) * e;
      }
      for (std::size_t c = 0; c < R; ++c) {
        float s[8];
        dot[c].store(s);
        x[lanes * i + c] += ((s[0] + s[1]) + (s[2] + s[3])) + (s[4] + s[5]);
      }
    }
  }

  /// Symmetric Gauss-Seidel instead, where there is nothing to hand down.
  void smooth_alone() const {
    for (std::size_t i = 0; i < size(); ++i) {
      Lanes_ s = Lanes_::load(&r[lanes * i]);
      for (std::int32_t k = start[i]; k < diagonal[i]; ++k) s -= product(k);
      smooth(i, s);
    }
    smooth_backward();
  }

 protected:
  using Eight = Batch<float, 8>;
  using Lanes_ = Batch<float, static_cast<int>(lanes)>;

  static std::size_t at(std::int32_t i) { return static_cast<std::size_t>(i); }

  // A_k x; what is in the lanes after the first R has no meaning, and none is used.
  Lanes_ product(std::int32_t k) const {
    const float* m = &single_[entries * at(k)];
    const float* v = &x[lanes * at(column[at(k)])];
    return columns_times<R>(m, v);
  }
  template <std::size_t stride>
  static Lanes_ columns_times(const float* m, const float* v) {
    Lanes_ s = Lanes_::load(m) * Lanes_(v[0]);
    for (std::size_t b = 1; b < R; ++b) s += Lanes_::load(m + stride * b) * Lanes_(v[b]);
    return s;
  }
  Lanes_ times_inverse(std::size_t i, const Lanes_& s) const {
    float v[lanes];
    s.store(v);
    return columns_times<lanes>(&inverse_single_[R * lanes * i], v);
  }
  void smooth(std::size_t i, const Lanes_& s) const { times_inverse(i, s).store(&x[lanes * i]); }
  void smooth_backward() const {
    for (std::size_t i = size(); i-- > 0;) {
      Lanes_ s = Lanes_::load(&r[lanes * i]);
      for (std::int32_t k = start[i]; k < diagonal[i]; ++k) s -= product(k);
      for (std::int32_t k = start[i + 1]; --k > diagonal[i];) s -= product(k);
      smooth(i, s);
    }
  }

  std::vector<std::int32_t> p_start_, p_column_;    // pattern of P
  std::vector<float> single_, inverse_single_, p_;  // A / unit and its inverse blocks by columns, P by rows
};

}  // namespace softsim::detail
