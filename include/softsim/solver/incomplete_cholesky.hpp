// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "softsim/core/batch.hpp"
#include "softsim/core/state.hpp"

namespace softsim {

/// z = B r with B^-1 = U^T D U close to A: incomplete Cholesky factorisation by 3x3 blocks without fill, the
/// diagonal blocks of U being the identity (Meijerink & van der Vorst 1977). B is symmetric and positive
/// definite whatever A is: where a pivot block loses nearly all of the diagonal block that it came from, the
/// factorisation is repeated with a share of the diagonal blocks added to A (Manteuffel 1980), 1/1024 to 1;
/// in the last attempt such a row is left to its diagonal block alone. U is kept and applied in single
/// precision, which halves what an application has to read; conjugate gradients see to the accuracy. Where
/// there is no fill, as for a chain, B is the inverse of A.
template <class T>
class IncompleteCholesky {
 public:
  /// Factorises A, which offers `matrix`, over the free components (`free` is 1 there, 0 else). Never fails.
  /// Allocates for a new pattern only.
  template <class A>
  void compute(const A& a, const Vector<T>& free) {
    const auto& matrix = a.matrix();
    if (pattern_ != matrix.pattern() || count_ != matrix.rows()) make_pattern(matrix);
    shift_ = 0;
    for (;; shift_ = shift_ > 0 ? 4 * shift_ : 1.0 / 1024) {
      load(matrix, free);
      if (factorise(shift_ >= 1)) return;
    }
  }

  /// Applies it to r, which is zero in prescribed components.
  void apply(const Vector<T>& r, Vector<T>& z) const {
    z.resize(r.size());
    const T largest = r.size() == 0 ? T(0) : r.cwiseAbs().maxCoeff();
    if (!(largest > T(0))) {
      z = r;
      return;
    }
    // Residuals may be larger or smaller than single precision can hold.
    forward(r, 1 / largest);
    backward(largest / unit_, z);
  }

  /// Share of the diagonal blocks that had to be added to A before its factorisation.
  [[nodiscard]] double shift() const { return shift_; }

 private:
  using Four = Batch<T, 4>;
  using Single = Batch<float, 4>;
  static constexpr std::size_t padded = 12;  // scalars of a block: three columns of four

  // Block (row, this one) of U.
  struct Lower {
    std::int32_t block, row;
  };
  // Block `target` of a row below -= (D U_left)^T U_right, left and right being blocks of one row.
  struct Update {
    std::int32_t left, right, target;
  };

  static std::size_t at(std::int32_t i) { return static_cast<std::size_t>(i); }

  template <class Matrix>
  void make_pattern(const Matrix& matrix) {
    pattern_ = matrix.pattern();
    count_ = matrix.rows();
    column_.clear();
    source_.clear();
    updates_.clear();
    lower_.clear();
    start_.assign(1, 0);
    update_start_.assign(1, 0);
    lower_start_.assign(1, 0);
    diagonal_source_.assign(count_, -1);
    std::size_t longest = 0;
    for (std::size_t i = 0; i < count_; ++i) {
      matrix.for_each_in_row(i, [&](std::int32_t j, std::int32_t k, bool transposed) {
        if (transposed) return;
        if (at(j) == i) {
          diagonal_source_[i] = k;
        } else {
          column_.push_back(j);
          source_.push_back(k);
        }
      });
      start_.push_back(static_cast<std::int32_t>(column_.size()));
      longest = std::max(longest, at(start_[i + 1] - start_[i]));
    }
    for (std::size_t i = 0; i < count_; ++i) {
      for (std::int32_t left = start_[i]; left < start_[i + 1]; ++left)
        for (std::int32_t right = left + 1; right < start_[i + 1]; ++right)
          if (const std::int32_t target = find(column_[at(left)], column_[at(right)]); target >= 0)
            updates_.push_back({left, right, target});
      update_start_.push_back(static_cast<std::int32_t>(updates_.size()));
      matrix.for_each_in_row(i, [&](std::int32_t j, std::int32_t, bool transposed) {
        if (transposed) lower_.push_back({find(j, static_cast<std::int32_t>(i)), j});
      });
      lower_start_.push_back(static_cast<std::int32_t>(lower_.size()));
    }
    work_.assign(padded * column_.size(), T(0));
    upper_.assign(padded * column_.size(), 0.0F);
    row_.assign(padded * longest, T(0));
    pivot_.resize(count_);
    base_.resize(count_);
    inverse_.assign(padded * count_, T(0));
    y_.assign(4 * count_, 0.0F);
  }

  // Number of the block (i, j), i < j, in the rows of U; -1 if the pattern does not have it.
  std::int32_t find(std::int32_t i, std::int32_t j) const {
    const auto first = column_.begin() + start_[at(i)], last = column_.begin() + start_[at(i) + 1],
               found = std::lower_bound(first, last, j);
    return found != last && *found == j ? static_cast<std::int32_t>(found - column_.begin()) : -1;
  }

  // A with an identity on prescribed components, and its shift.
  template <class Matrix>
  void load(const Matrix& matrix, const Vector<T>& free) {
    unit_ = T(0);
    for (std::size_t i = 0; i < count_; ++i) {
      const Vec3<T> open = block(free, static_cast<std::ptrdiff_t>(i));
      Mat3<T> D = Mat3<T>::Zero(), ignored;
      if (diagonal_source_[i] >= 0)
        D = open.asDiagonal() * matrix.block(diagonal_source_[i]) * open.asDiagonal();
      for (int c = 0; c < 3; ++c)
        if (!(std::abs(D(c, c)) > T(0))) D(c, c) = T(1);  // prescribed, or without any stiffness
      unit_ = std::max(unit_, D.diagonal().cwiseAbs().maxCoeff());
      base_[i] = D;
      if (!invert(D, D, ignored)) base_[i] = D.diagonal().cwiseAbs().asDiagonal();
      pivot_[i] = D + static_cast<T>(shift_) * base_[i];
      for (std::int32_t k = start_[i]; k < start_[i + 1]; ++k) {
        const auto open_there = block(free, column_[at(k)]);
        const auto from = matrix.block(source_[at(k)]);
        T* to = &work_[padded * at(k)];
        for (int c = 0; c < 3; ++c)
          for (int d = 0; d < 3; ++d) to[4 * c + d] = open[d] * open_there[c] * from(d, c);
      }
    }
  }

  // D^-1, by D = L diag(d) L^T with a unit triangle. False if a d is not positive beside what it came from.
  static bool invert(const Mat3<T>& D, const Mat3<T>& base, Mat3<T>& inverse) {
    const T least = T(1e-5);
    const T d0 = D(0, 0), l1 = D(1, 0) / d0, l2 = D(2, 0) / d0;
    const T d1 = D(1, 1) - l1 * D(1, 0), e = D(2, 1) - l1 * D(2, 0), l = e / d1;
    const T d2 = D(2, 2) - l2 * D(2, 0) - l * e, m = l1 * l - l2;
    if (!(d0 > least * base(0, 0) && d1 > least * base(1, 1) && d2 > least * base(2, 2))) return false;
    inverse(0, 0) = 1 / d0 + l1 * l1 / d1 + m * m / d2;
    inverse(1, 1) = 1 / d1 + l * l / d2;
    inverse(2, 2) = 1 / d2;
    inverse(0, 1) = inverse(1, 0) = -l1 / d1 - l * m / d2;
    inverse(0, 2) = inverse(2, 0) = m / d2;
    inverse(1, 2) = inverse(2, 1) = -l / d2;
    return std::isfinite(inverse.sum());
  }

  // Row after row, every row updates those below. False at a bad pivot, unless those are to be replaced.
  bool factorise(bool replace) {
    for (std::size_t i = 0; i < count_; ++i) {
      Mat3<T> inverse;
      if (!invert(pivot_[i], base_[i], inverse)) {
        if (!replace) return false;
        if (!invert(base_[i], base_[i], inverse)) inverse.setIdentity();  // A is not finite
        // On its own, or what it passes on might grow from row to row.
        std::fill(work_.begin() + static_cast<std::ptrdiff_t>(padded) * start_[i],
                  work_.begin() + static_cast<std::ptrdiff_t>(padded) * start_[i + 1], T(0));
      }
      for (int c = 0; c < 3; ++c)
        for (int d = 0; d < 3; ++d)
          inverse_[padded * i + static_cast<std::size_t>(4 * c + d)] = inverse(d, c);
      const T* D = &inverse_[padded * i];
      const std::int32_t first = start_[i];
      for (std::int32_t k = first; k < start_[i + 1]; ++k) {
        T* w = &work_[padded * at(k)];
        T* transposed = &row_[padded * at(k - first)];
        for (int c = 0; c < 3; ++c)
          for (int d = 0; d < 3; ++d) transposed[4 * d + c] = w[4 * c + d];
        for (int c = 0; c < 3; ++c) {
          const Four u = product(D, w + 4 * c);
          u.store(w + 4 * c);
          to_single(u).store(&upper_[padded * at(k)] + 4 * c);
        }
        Mat3<T>& pivot = pivot_[at(column_[at(k)])];
        for (int c = 0; c < 3; ++c) {
          const Four u = product(transposed, w + 4 * c);
          for (int d = 0; d < 3; ++d) pivot(d, c) -= lane(u, d);
        }
      }
      for (std::int32_t k = update_start_[i]; k < update_start_[i + 1]; ++k) {
        const Update& update = updates_[at(k)];
        const T* transposed = &row_[padded * at(update.left - first)];
        const T* u = &work_[padded * at(update.right)];
        T* to = &work_[padded * at(update.target)];
        for (int c = 0; c < 3; ++c)
          (Four::load(to + 4 * c) - product(transposed, u + 4 * c)).store(to + 4 * c);
      }
    }
    return true;
  }

  // Padded block times the three scalars at x.
  template <class S>
  static auto product(const S* m, const S* x) {
    using B = Batch<S, 4>;
    return B::load(m) * B(x[0]) + B::load(m + 4) * B(x[1]) + B::load(m + 8) * B(x[2]);
  }

  static Single to_single(const Four& x) {
    if constexpr (std::is_same_v<T, float>)
      return x;
    else if constexpr (simd_detail::is_wide<T, 4>)
      return convert<Single>(x);
    else
      return typename Single::Register(__builtin_convertvector(x.lanes, typename Single::Register));
  }
  static Four from_single(const Single& x) {
    if constexpr (std::is_same_v<T, float>)
      return x;
    else if constexpr (simd_detail::is_wide<T, 4>)
      return convert<Four>(x);
    else
      return typename Four::Register(__builtin_convertvector(x.lanes, typename Four::Register));
  }
  template <class To, class From>
  static To convert(const From& x) {
    To y(0);
    for (int l = 0; l < 4; ++l) set_lane(y, l, static_cast<decltype(lane(y, 0))>(lane(x, l)));
    return y;
  }

  // Lane c is the sum over the lanes of d_c; lane 3 is zero.
  static Single sums(const Single& d0, const Single& d1, const Single& d2) {
    using R = typename Single::Register;
    const R none{};
    const R s = __builtin_shufflevector(d0.lanes, d1.lanes, 0, 4, 1, 5) +
                __builtin_shufflevector(d0.lanes, d1.lanes, 2, 6, 3, 7);
    const R t = __builtin_shufflevector(d2.lanes, none, 0, 4, 1, 5) +
                __builtin_shufflevector(d2.lanes, none, 2, 6, 3, 7);
    return R(__builtin_shufflevector(s, t, 0, 1, 4, 5) + __builtin_shufflevector(s, t, 2, 3, 6, 7));
  }

  // y = U^-T (scale r)
  void forward(const Vector<T>& r, T scale) const {
    for (std::size_t i = 0; i < count_; ++i) {
      Single dot[3] = {Single(0), Single(0), Single(0)};
      for (std::int32_t k = lower_start_[i]; k < lower_start_[i + 1]; ++k) {
        const Lower& lower = lower_[at(k)];
        const Single y = Single::load(&y_[4 * at(lower.row)]);
        const float* u = &upper_[padded * at(lower.block)];
        for (int c = 0; c < 3; ++c) dot[c] += Single::load(u + 4 * c) * y;
      }
      const Four right = Four::load(r.data() + 4 * i) * Four(scale);
      (to_single(right) - sums(dot[0], dot[1], dot[2])).store(&y_[4 * i]);
    }
  }

  // z = scale U^-1 D^-1 y; D^-1 in full precision, so that rounding cannot make it indefinite.
  void backward(T scale, Vector<T>& z) const {
    for (std::size_t i = count_; i-- > 0;) {
      float* y = &y_[4 * i];
      const T right[3] = {static_cast<T>(y[0]), static_cast<T>(y[1]), static_cast<T>(y[2])};
      Single x = to_single(product(&inverse_[padded * i], right) * Four(unit_));
      for (std::int32_t k = start_[i + 1]; k-- > start_[i];)  // the nearest row, just known, comes last
        x -= product(&upper_[padded * at(k)], static_cast<const float*>(&y_[4 * at(column_[at(k)])]));
      x.store(y);
      (from_single(x) * Four(scale)).store(z.data() + 4 * i);
    }
  }

  std::uint64_t pattern_ = 0;
  std::size_t count_ = 0;
  double shift_ = 0;
  T unit_ = 1;  // largest stiffness: what is solved for in single precision is a force
  std::vector<std::int32_t> start_, column_, source_, diagonal_source_, lower_start_, update_start_;
  std::vector<Lower> lower_;
  std::vector<Update> updates_;
  std::vector<Mat3<T>> pivot_, base_;
  std::vector<T> work_, row_, inverse_;  // padded blocks
  std::vector<float> upper_;             // U, padded blocks
  mutable std::vector<float> y_;
};

}  // namespace softsim
