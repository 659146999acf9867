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
  static constexpr std::size_t wide = 8;                ///< scalars per node of the next level's vectors

  std::vector<std::int32_t> start, column, diagonal;  ///< rows of A, columns ascending, both triangles
  mutable std::vector<float> r, x;                    ///< right-hand side and solution

  /// Number of nodes.
  [[nodiscard]] std::size_t size() const { return diagonal.size(); }

  /// Forward Gauss-Seidel from x = 0, and what is left of r as the right-hand side of the next level.
  void descend(const MultigridCycle<6>& next) const {
    for (std::size_t i = 0; i < size(); ++i) smooth(i, less_lower(i, Lanes_::load(&r[lanes * i])));
    std::fill(next.r.begin(), next.r.end(), 0.0F);
    for (std::size_t i = 0; i < size(); ++i) {
      float residual[lanes];
      less_upper(i, Lanes_(0)).store(residual);
      for (std::int32_t p = p_start_[i]; p < p_start_[i + 1]; ++p) {
        float* to = &next.r[wide * at(p_column_[at(p)])];
        Eight sum = Eight::load(to);
        for (std::size_t c = 0; c < R; ++c) sum += Eight::load(&p_[6 * (R * at(p) + c)]) * Eight(residual[c]);
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
        const auto e = Eight::load(&next.x[wide * at(p_column_[at(p)])]);
        for (std::size_t c = 0; c < R; ++c) dot[c] += Eight::load(&p_[6 * (R * at(p) + c)]) * e;
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
    for (std::size_t i = 0; i < size(); ++i) smooth(i, less_lower(i, Lanes_::load(&r[lanes * i])));
    smooth_backward();
  }

 protected:
  using Eight = Batch<float, 8>;
  using Lanes_ = Batch<float, static_cast<int>(lanes)>;

  static std::size_t at(std::int32_t i) { return static_cast<std::size_t>(i); }

  // s less what the blocks of row i below the diagonal, or above it, give. What is in the lanes after the
  // first R has no meaning, and none is used.
  Lanes_ less_lower(std::size_t i, const Lanes_& s) const {
    return less(s, start[i], diagonal[i], lower_start_[i]);
  }
  Lanes_ less_upper(std::size_t i, const Lanes_& s) const {
    return less(s, diagonal[i] + 1, start[i + 1], upper_start_[i]);
  }
  Lanes_ less(Lanes_ s, std::int32_t first, std::int32_t last, std::int32_t place) const {
    const float* m = single_.data() + entries * at(place);
    for (std::int32_t k = first; k < last; ++k, m += entries)
      s -= columns_times<R>(m, &x[lanes * at(column[at(k)])]);
    return s;
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
    for (std::size_t i = size(); i-- > 0;)
      smooth(i, less_upper(i, less_lower(i, Lanes_::load(&r[lanes * i]))));
  }

  // A / unit without its diagonal, blocks by columns: first those below it, row after row, then those above,
  // because half of a cycle's passes need one half only, and a large matrix waits for memory.
  std::vector<float> single_;
  std::vector<std::int32_t> lower_start_, upper_start_;  // first block of every row there
  std::vector<float> inverse_single_;                    // inverses of the diagonal, by columns
  // P, rows of six: read eight at a time, of which the last two meet zeros or are not used.
  std::vector<float> p_;
  std::vector<std::int32_t> p_start_, p_column_;  // its pattern
};

}  // namespace softsim::detail
