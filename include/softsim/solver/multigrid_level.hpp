// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "softsim/core/batch.hpp"
#include "softsim/core/tensor.hpp"
#include "softsim/solver/multigrid_cycle.hpp"

namespace softsim::detail {

/// One level of smoothed aggregation: a matrix A of R x R blocks and its way to the next level, whose blocks
/// are 6 x 6. What is set up is set up in double, and rounded for the cycle, which runs on A / unit. What
/// depends on the pattern and on which couplings are strong is kept.
template <int R>
class MultigridLevel : public MultigridCycle<R> {
  using Cycle = MultigridCycle<R>;
  using Cycle::at, Cycle::columns_times, Cycle::inverse_single_, Cycle::p_, Cycle::p_column_, Cycle::p_start_,
      Cycle::less_lower, Cycle::less_upper, Cycle::lower_start_, Cycle::single_, Cycle::times_inverse,
      Cycle::upper_start_;
  using typename Cycle::Lanes_;

 public:
  using Cycle::column, Cycle::diagonal, Cycle::entries, Cycle::lanes, Cycle::r, Cycle::size, Cycle::start,
      Cycle::wide, Cycle::x;

  std::vector<double> values;
  std::vector<double> modes;        ///< rigid modes, R rows of six per node
  std::vector<std::int32_t> group;  ///< aggregate of every node, -1 for none
  std::size_t groups = 0;
  /// Finds the strong couplings, |A_ij|^2 > threshold^2 |A_ii| |A_jj|. True if they are others than before.
  bool find_strong(double threshold) {
    norm_.resize(size());
    for (std::size_t i = 0; i < size(); ++i) norm_[i] = square(diagonal[i]);
    bool changed = strong_.size() != column.size();
    strong_.resize(column.size());
    for (std::size_t i = 0; i < size(); ++i)
      for (std::int32_t k = start[i]; k < start[i + 1]; ++k) {
        const double s = square(k);
        const double limit = threshold * threshold * std::sqrt(norm_[i] * norm_[at(column[at(k)])]);
        const char strong = k != diagonal[i] && s > limit ? 1 : 0;
        changed = changed || strong != strong_[at(k)];
        strong_[at(k)] = strong;
      }
    return changed;
  }

  /// Forms aggregates (Vanek, Mandel & Brezina 1996, algorithm 5.1), an orthonormal basis of the rigid modes
  /// in each, the modes of the next level, and all patterns.
  void make_pattern(MultigridLevel<6>& next) {
    aggregate();
    make_tentative(next);
    // Prolongation: a node follows the aggregates of its neighbours.
    std::vector<std::int32_t> seen(groups, -1);
    p_start_.assign(1, 0);
    p_column_.clear();
    ap_start_.assign(1, 0);
    ap_column_.clear();
    for (std::size_t i = 0; i < size(); ++i) {
      const auto first = static_cast<std::ptrdiff_t>(p_column_.size());
      for (std::int32_t k = start[i]; k < start[i + 1]; ++k)
        add_once(group[at(column[at(k)])], i, seen, p_column_);
      std::sort(p_column_.begin() + first, p_column_.end());
      p_start_.push_back(static_cast<std::int32_t>(p_column_.size()));
    }
    std::fill(seen.begin(), seen.end(), -1);
    for (std::size_t i = 0; i < size(); ++i) {
      const auto first = static_cast<std::ptrdiff_t>(ap_column_.size());
      for (std::int32_t k = start[i]; k < start[i + 1]; ++k)
        for (std::int32_t p = p_start_[at(column[at(k)])]; p < p_start_[at(column[at(k)]) + 1]; ++p)
          add_once(p_column_[at(p)], i, seen, ap_column_);
      std::sort(ap_column_.begin() + first, ap_column_.end());
      ap_start_.push_back(static_cast<std::int32_t>(ap_column_.size()));
    }
    std::vector<std::vector<std::int32_t>> nodes(groups);
    for (std::size_t i = 0; i < size(); ++i)
      for (std::int32_t p = p_start_[i]; p < p_start_[i + 1]; ++p)
        nodes[at(p_column_[at(p)])].push_back(static_cast<std::int32_t>(i));
    // The next matrix.
    std::fill(seen.begin(), seen.end(), -1);
    next.start.assign(1, 0);
    next.column.clear();
    next.diagonal.clear();
    for (std::size_t a = 0; a < groups; ++a) {
      const auto first = static_cast<std::ptrdiff_t>(next.column.size());
      for (const std::int32_t i : nodes[a])
        for (std::int32_t k = ap_start_[at(i)]; k < ap_start_[at(i) + 1]; ++k)
          add_once(ap_column_[at(k)], a, seen, next.column);
      std::sort(next.column.begin() + first, next.column.end());
      next.diagonal.push_back(static_cast<std::int32_t>(
          std::lower_bound(next.column.begin() + first, next.column.end(), static_cast<std::int32_t>(a)) -
          next.column.begin()));
      next.start.push_back(static_cast<std::int32_t>(next.column.size()));
    }
    next.values.assign(36 * next.column.size(), 0.0);
    const auto find = [&](std::int32_t a, std::int32_t b) {
      const auto first = next.column.begin() + next.start[at(a)],
                 last = next.column.begin() + next.start[at(a) + 1];
      return static_cast<std::int32_t>(std::lower_bound(first, last, b) - next.column.begin());
    };
    upper_.clear();
    for (std::size_t a = 0; a < groups; ++a)
      for (std::int32_t k = next.start[a]; k < next.start[a + 1]; ++k)
        upper_.push_back(k < next.diagonal[a] ? find(next.column[at(k)], static_cast<std::int32_t>(a)) : k);
    target_.clear();
    std::int32_t longest = 0;
    for (std::size_t i = 0; i < size(); ++i) {
      longest = std::max(longest, ap_start_[i + 1] - ap_start_[i]);
      for (std::int32_t p = p_start_[i]; p < p_start_[i + 1]; ++p)
        for (std::int32_t k = ap_start_[i + 1]; k-- > ap_start_[i] && ap_column_[at(k)] >= p_column_[at(p)];)
          target_.push_back(find(p_column_[at(p)], ap_column_[at(k)]));
    }
    p_.assign(6 * R * p_column_.size() + wide - 6, 0.0F);
    row_.assign(R * wide * at(longest), 0.0);
    place_.assign(groups, 0);
  }

  /// Copies A / unit for the cycle and inverts its diagonal blocks; one that is not positive definite is
  /// replaced by the absolute values of its diagonal.
  void prepare_smoother(double unit) {
    // The product reads a register where a column has R scalars: some more at the very end.
    single_.resize(entries * (column.size() - size()) + lanes - R, 0.0F);
    inverse_.resize(entries * size());
    inverse_single_.resize(R * lanes * size(), 0.0F);
    r.resize(lanes * size(), 0.0F);
    x.resize(lanes * size(), 0.0F);
    residual_.resize(lanes * size(), 0.0F);
    lower_start_.resize(size());
    upper_start_.resize(size());
    const double per_unit = 1 / unit;
    std::int32_t lower = 0, upper = 0;
    for (std::size_t i = 0; i < size(); ++i) upper += diagonal[i] - start[i];
    const auto copy = [&](std::int32_t first, std::int32_t last, std::int32_t& to) {
      for (std::int32_t k = first; k < last; ++k, ++to)
        for (std::size_t b = 0; b < R; ++b)
          for (std::size_t a = 0; a < R; ++a)
            single_[entries * at(to) + R * b + a] =
                static_cast<float>(values[entries * at(k) + R * a + b] * per_unit);
    };
    for (std::size_t i = 0; i < size(); ++i) {
      lower_start_[i] = lower;
      upper_start_[i] = upper;
      copy(start[i], diagonal[i], lower);
      copy(diagonal[i] + 1, start[i + 1], upper);
    }
    for (std::size_t i = 0; i < size(); ++i) {
      const Block D = Eigen::Map<const Block>(&values[entries * at(diagonal[i])]);
      const Eigen::LLT<Block> llt(D);
      Block inverse;
      if (llt.info() == Eigen::Success) inverse = llt.solve(Block::Identity());
      if (llt.info() != Eigen::Success || !inverse.allFinite())
        inverse = D.diagonal().cwiseAbs().cwiseMax(1e-300).cwiseInverse().asDiagonal();
      Eigen::Map<Block> kept(&inverse_[entries * i]);
      kept = inverse;
      for (std::size_t b = 0; b < R; ++b)
        for (std::size_t a = 0; a < R; ++a)
          inverse_single_[R * lanes * i + lanes * b + a] =
              static_cast<float>(unit * inverse(static_cast<int>(a), static_cast<int>(b)));
    }
  }

  /// P = (I - omega D^-1 A) P_0, rounded to single precision, and the next matrix P^T A P; where that has no
  /// stiffness at all (a mode that an aggregate does not have), its diagonal is `unit`.
  void project(MultigridLevel<6>& next, double unit) {
    smooth_prolongation(4 / (3 * largest_eigenvalue()));
    sum_.assign(6 * wide * next.column.size(), 0.0);
    const std::int32_t* target = target_.data();
    for (std::size_t i = 0; i < size(); ++i) {
      const std::int32_t first = ap_start_[i], last = ap_start_[i + 1];
      for (std::int32_t k = first; k < last; ++k) place_[at(ap_column_[at(k)])] = k - first;
      std::fill(row_.begin(), row_.begin() + static_cast<std::ptrdiff_t>(R * wide) * (last - first), 0.0);
      for (std::int32_t k = start[i]; k < start[i + 1]; ++k)
        for (std::int32_t p = p_start_[at(column[at(k)])]; p < p_start_[at(column[at(k)]) + 1]; ++p)
          add_product(&values[entries * at(k)], &p_[6 * R * at(p)],
                      &row_[R * wide * at(place_[at(p_column_[at(p)])])]);
      for (std::int32_t p = p_start_[i]; p < p_start_[i + 1]; ++p) {
        const float* P = &p_[6 * R * at(p)];
        // Columns ascend: those of the upper triangle come last.
        for (std::int32_t k = last; k-- > first && ap_column_[at(k)] >= p_column_[at(p)];) {
          double* to = &sum_[6 * wide * at(*target++)];
          Row ap[R];
          for (std::size_t b = 0; b < R; ++b) ap[b] = Row::load(&row_[R * wide * at(k - first) + wide * b]);
          for (std::size_t c = 0; c < 6; ++c) {
            Row s = Row::load(to + wide * c);
            for (std::size_t b = 0; b < R; ++b) s += Row(static_cast<double>(P[6 * b + c])) * ap[b];
            s.store(to + wide * c);
          }
        }
      }
    }
    for (std::size_t a = 0; a < groups; ++a)
      for (std::int32_t k = next.start[a]; k < next.start[a + 1]; ++k) {
        double* to = &next.values[36 * at(k)];
        const double* from = &sum_[6 * wide * at(upper_[at(k)])];
        const bool transposed = upper_[at(k)] != k;
        for (std::size_t c = 0; c < 6; ++c)
          for (std::size_t d = 0; d < 6; ++d)
            to[6 * c + d] = transposed ? from[wide * d + c] : from[wide * c + d];
        if (k == next.diagonal[a])
          for (std::size_t c = 0; c < 6; ++c) {
            for (std::size_t d = 0; d < c; ++d) to[6 * c + d] = to[6 * d + c];
            if (to[7 * c] == 0) to[7 * c] = unit;
          }
      }
  }

  /// The prolongation before its smoothing, R rows of eight (the last two zero) per node; for tests.
  [[nodiscard]] const std::vector<double>& tentative() const { return tentative_; }

 private:
  using Block = Eigen::Matrix<double, R, R, Eigen::RowMajor>;
  using Row = Batch<double, 8>;

  double square(std::int32_t k) const {
    double s = 0;
    for (std::size_t e = 0; e < entries; ++e) {
      const double v = values[entries * at(k) + e];
      s += v * v;
    }
    return s;
  }

  static void add_once(std::int32_t a, std::size_t row, std::vector<std::int32_t>& seen,
                       std::vector<std::int32_t>& list) {
    if (a < 0 || seen[at(a)] == static_cast<std::int32_t>(row)) return;
    seen[at(a)] = static_cast<std::int32_t>(row);
    list.push_back(a);
  }

  template <class Function>
  void for_each_strong(std::size_t i, Function f) const {
    for (std::int32_t k = start[i]; k < start[i + 1]; ++k)
      if (strong_[at(k)] != 0) f(at(column[at(k)]));
  }

  void aggregate() {
    constexpr std::int32_t open = -2;
    group.assign(size(), -1);
    for (std::size_t i = 0; i < size(); ++i) for_each_strong(i, [&](std::size_t) { group[i] = open; });
    groups = 0;
    const auto gather = [&](std::size_t i) {
      group[i] = static_cast<std::int32_t>(groups);
      for_each_strong(i, [&](std::size_t j) {
        if (group[j] == open) group[j] = group[i];
      });
      ++groups;
    };
    for (std::size_t i = 0; i < size(); ++i) {
      bool alone = group[i] == open;
      for_each_strong(i, [&](std::size_t j) { alone = alone && group[j] == open; });
      if (alone) gather(i);
    }
    const std::vector<std::int32_t> cores = group;
    for (std::size_t i = 0; i < size(); ++i)
      if (group[i] == open)
        for_each_strong(i, [&](std::size_t j) {
          if (group[i] == open && cores[j] >= 0) group[i] = cores[j];
        });
    for (std::size_t i = 0; i < size(); ++i)
      if (group[i] == open) gather(i);
  }

  // Gram-Schmidt, twice, on the modes of every aggregate; a mode that depends on those before it is dropped.
  void make_tentative(MultigridLevel<6>& next) {
    std::vector<std::vector<std::size_t>> members(groups);
    for (std::size_t i = 0; i < size(); ++i)
      if (group[i] >= 0) members[at(group[i])].push_back(i);
    tentative_.assign(R * wide * size(), 0.0);
    next.modes.assign(36 * groups, 0.0);
    Eigen::Matrix<double, Eigen::Dynamic, 6> Q;
    for (std::size_t a = 0; a < groups; ++a) {
      Q.resize(R * static_cast<int>(members[a].size()), 6);
      for (int m = 0; m < static_cast<int>(members[a].size()); ++m)
        Q.template middleRows<R>(R * m) = Eigen::Map<const Eigen::Matrix<double, R, 6, Eigen::RowMajor>>(
            &modes[6 * R * members[a][static_cast<std::size_t>(m)]]);
      Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>> coarse(&next.modes[36 * a]);
      for (int c = 0; c < 6; ++c) {
        const double before = Q.col(c).norm();
        for (int pass = 0; pass < 2; ++pass)
          for (int d = 0; d < c; ++d) {
            const double s = Q.col(d).dot(Q.col(c));
            coarse(d, c) += s;
            Q.col(c) -= s * Q.col(d);
          }
        const double left = Q.col(c).norm();
        if (left > 1e-9 * before) {
          coarse(c, c) = left;
          Q.col(c) /= left;
        } else {
          Q.col(c).setZero();
        }
      }
      for (int m = 0; m < static_cast<int>(members[a].size()); ++m)
        for (int c = 0; c < R; ++c)
          for (int d = 0; d < 6; ++d)
            tentative_[R * wide * members[a][static_cast<std::size_t>(m)] +
                       static_cast<std::size_t>(8 * c + d)] = Q(R * m + c, d);
    }
  }

  // to += A_k P; rows of eight, of which six count: those of P itself are six
  template <class S>
  static void add_product(const double* A, const S* P, double* to) {
    Row p[R];
    constexpr std::size_t stride = std::is_same_v<S, float> ? 6 : wide;
    for (std::size_t b = 0; b < R; ++b) p[b] = load(P + stride * b);
    for (std::size_t a = 0; a < R; ++a) {
      Row s = Row::load(to + wide * a);
      for (std::size_t b = 0; b < R; ++b) s += Row(A[R * a + b]) * p[b];
      s.store(to + wide * a);
    }
  }
  template <class S>
  static Row load(const S* p) {
    if constexpr (std::is_same_v<S, double>) {
      return Row::load(p);
    } else if constexpr (simd_detail::is_wide<double, 2 * sizeof(S)>) {
      double v[wide];
      for (std::size_t c = 0; c < wide; ++c) v[c] = static_cast<double>(p[c]);
      return Row::load(v);
    } else {
      using Register = typename Batch<double, 2 * sizeof(S)>::Register;
      return Row(Register(__builtin_convertvector(Batch<S, 8>::load(p).lanes, Register)));
    }
  }

  void smooth_prolongation(double omega) {
    for (std::size_t i = 0; i < size(); ++i) {
      const std::int32_t first = p_start_[i], last = p_start_[i + 1];
      for (std::int32_t p = first; p < last; ++p) place_[at(p_column_[at(p)])] = p - first;
      std::fill(row_.begin(), row_.begin() + static_cast<std::ptrdiff_t>(R * wide) * (last - first), 0.0);
      for (std::int32_t k = start[i]; k < start[i + 1]; ++k) {
        const std::int32_t j = column[at(k)];
        if (group[at(j)] >= 0)
          add_product(&values[entries * at(k)], &tentative_[R * wide * at(j)],
                      &row_[R * wide * at(place_[at(group[at(j)])])]);
      }
      for (std::int32_t p = first; p < last; ++p) {
        const double* from = &row_[R * wide * at(p - first)];
        const bool own = p_column_[at(p)] == group[i];
        for (std::size_t a = 0; a < R; ++a) {
          Row s = own ? Row::load(&tentative_[R * wide * i + wide * a]) : Row(0);
          for (std::size_t b = 0; b < R; ++b)
            s -= Row(omega * inverse_[entries * i + R * a + b]) * Row::load(from + wide * b);
          double result[wide];
          s.store(result);
          for (std::size_t c = 0; c < 6; ++c) p_[6 * (R * at(p) + a) + c] = static_cast<float>(result[c]);
        }
      }
    }
  }

  // Of D^-1 A, by some steps of the power method and a margin.
  double largest_eigenvalue() const {
    std::uint32_t bits = 1;
    for (std::size_t i = 0; i < size(); ++i)
      for (std::size_t c = 0; c < R; ++c) {
        bits = 1664525U * bits + 1013904223U;
        x[lanes * i + c] = static_cast<float>(bits >> 8) * 0x1p-23F - 1;
      }
    double growth = 1;
    for (int step = 0; step < 5; ++step) {
      double before = 0, after = 0;
      for (std::size_t i = 0; i < size(); ++i) {
        // D^-1 A = I - D^-1 (D - A)
        const Lanes_ rest = times_inverse(i, less_upper(i, less_lower(i, Lanes_(0))));
        (Lanes_::load(&x[lanes * i]) - rest).store(&residual_[lanes * i]);
      }
      for (std::size_t k = 0; k < x.size(); ++k) {
        before += static_cast<double>(x[k]) * static_cast<double>(x[k]);
        after += static_cast<double>(residual_[k]) * static_cast<double>(residual_[k]);
      }
      if (!(before > 0 && after > 0 && std::isfinite(after))) break;
      growth = std::sqrt(after / before);
      const float scale = static_cast<float>(1 / std::sqrt(after));
      for (std::size_t k = 0; k < x.size(); ++k) x[k] = scale * residual_[k];
    }
    return 1.1 * growth;
  }

  std::vector<double> norm_, inverse_, tentative_, row_, sum_;
  std::vector<char> strong_;
  // Pattern of A P; upper_: where a block of the next matrix is, or its transpose, in the upper
  // triangle; target_: where the products of one row of P and one of A P go, in the order of `project`.
  std::vector<std::int32_t> ap_start_, ap_column_, place_, upper_, target_;
  mutable std::vector<float> residual_;
};

}  // namespace softsim::detail
