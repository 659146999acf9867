// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "softsim/core/state.hpp"
#include "softsim/solver/multigrid_level.hpp"

namespace softsim {

/// z = B r by one V-cycle of smoothed-aggregation multigrid (Vanek, Mandel & Brezina 1996): aggregates of
/// nodes that are strongly coupled move as rigid bodies, smoothed by one step of block Jacobi; block
/// Gauss-Seidel goes forward on the way down and backward on the way up, so that B is symmetric; it is
/// positive definite if A is. The preconditioner for static problems and long time steps: its iterations
/// hardly grow with the mesh. Set up in double, applied in single precision; conjugate gradients see to the
/// accuracy.
template <class T>
class Multigrid {
 public:
  /// Prepares for A, which offers `matrix` and `rest`, over the free components (`free` is 1 there, 0 else).
  /// Aggregates and patterns are kept while the pattern of A, the prescribed components and the strong
  /// couplings stay the same; only the dense factorisation of the coarsest level allocates then.
  template <class A>
  void compute(const A& a, const Vector<T>& free) {
    const auto& matrix = a.matrix();
    bool fresh = pattern_ != matrix.pattern() || free_.size() != free.size() || free_ != free;
    if (fresh) make_pattern(a, free);
    load(matrix, free);
    double threshold = 0.04;
    fresh = finest_.find_strong(threshold) || fresh;
    finest_.prepare_smoother(unit_);
    if (coarse_.empty()) coarse_.resize(1);
    if (fresh) finest_.make_pattern(coarse_[0]);
    depth_ = 0;
    if (finest_.groups == 0) return;
    // Nodes of a level that is solved directly: its inverse must not cost more than the rest.
    const std::size_t coarsest = std::clamp<std::size_t>(finest_.size() / 200, 20, 64);
    finest_.project(coarse_[0], unit_);
    for (depth_ = 1; coarse_[depth_ - 1].size() > coarsest && depth_ < 20; ++depth_) {
      detail::MultigridLevel<6>& level = coarse_[depth_ - 1];
      level.prepare_smoother(unit_);
      threshold /= 2;
      fresh = level.find_strong(threshold) || fresh;
      if (coarse_.size() == depth_) {
        coarse_.emplace_back();
        fresh = true;
      }
      detail::MultigridLevel<6>&here = coarse_[depth_ - 1], &next = coarse_[depth_];
      if (fresh) here.make_pattern(next);
      if (here.groups == 0 || here.groups >= here.size()) break;
      here.project(next, unit_);
    }
    direct_ = coarse_[depth_ - 1].size() <= 2 * coarsest;
    if (direct_) factorise();
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
    using Single = Eigen::Map<Eigen::VectorXf>;
    Single(finest_.r.data(), r.size()) = (r * (1 / largest)).template cast<float>();
    if (depth_ == 0) {
      finest_.smooth_alone();
    } else {
      finest_.descend(coarse_[0]);
      for (std::size_t l = 0; l + 1 < depth_; ++l) coarse_[l].descend(coarse_[l + 1]);
      if (direct_)
        solve_coarsest();
      else
        coarse_[depth_ - 1].smooth_alone();
      for (std::size_t l = depth_ - 1; l-- > 0;) coarse_[l].ascend(coarse_[l + 1]);
      finest_.ascend(coarse_[0]);
    }
    z = (largest / static_cast<T>(unit_)) * Single(finest_.x.data(), r.size()).template cast<T>();
  }

  /// Levels of the last `compute`.
  [[nodiscard]] std::size_t levels() const { return depth_ + 1; }
  /// The finest level, for tests.
  [[nodiscard]] const detail::MultigridLevel<3>& finest() const { return finest_; }
  /// The level below that, for tests.
  [[nodiscard]] const detail::MultigridLevel<6>& second() const { return coarse_.front(); }

 private:
  static std::size_t at(std::int32_t i) { return static_cast<std::size_t>(i); }

  template <class A>
  void make_pattern(const A& a, const Vector<T>& free) {
    const auto& matrix = a.matrix();
    pattern_ = matrix.pattern();
    free_ = free;
    const std::size_t n = matrix.rows();
    auto &start = finest_.start, &column = finest_.column, &diagonal = finest_.diagonal;
    start.assign(1, 0);
    column.clear();
    diagonal.clear();
    source_.clear();
    std::vector<Source> row;
    for (std::size_t i = 0; i < n; ++i) {
      row.clear();
      matrix.for_each_in_row(i, [&](std::int32_t j, std::int32_t k, bool transposed) {
        row.push_back({j, k, transposed});
      });
      std::sort(row.begin(), row.end(), [](const Source& s, const Source& t) { return s.column < t.column; });
      for (const Source& s : row) {
        if (at(s.column) == i) diagonal.push_back(static_cast<std::int32_t>(column.size()));
        column.push_back(s.column);
        source_.push_back(s);
      }
      start.push_back(static_cast<std::int32_t>(column.size()));
    }
    finest_.values.assign(9 * finest_.column.size(), 0.0);
    // Rigid modes of the free components about the centre, rotations in units of the body's size.
    Vec3<double> centre = Vec3<double>::Zero();
    for (const Vec3<double>& X : a.rest()) centre += X / static_cast<double>(n);
    double radius = 0;
    for (const Vec3<double>& X : a.rest()) radius = std::max(radius, (X - centre).norm());
    finest_.modes.assign(18 * n, 0.0);
    const double scale = radius > 0 ? radius : 1.0;
    std::size_t points = n;  // a matrix from elsewhere has no frames
    if constexpr (requires { a.frames(); }) points -= 2 * a.frames();
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3<double> X = (a.rest()[i] - centre) / scale;
      Eigen::Map<Eigen::Matrix<double, 3, 6, Eigen::RowMajor>> modes(&finest_.modes[18 * i]);
      if (i < points || (i - points) % 2 == 0) {
        modes.leftCols<3>().setIdentity();
        modes.rightCols<3>() << 0, X[2], -X[1], -X[2], 0, X[0], X[1], -X[0], 0;
      } else {  // rotations of frames
        modes.rightCols<3>() = Mat3<double>::Identity() / scale;
      }
      modes = block(free, static_cast<std::ptrdiff_t>(i)).template cast<double>().asDiagonal() * modes.eval();
    }
  }

  // A with an identity on prescribed components, in units of A.
  template <class Matrix>
  void load(const Matrix& matrix, const Vector<T>& free) {
    unit_ = 0;
    for (const std::int32_t k : finest_.diagonal) {
      const auto D = matrix.block(source_[at(k)].block);
      unit_ = std::max(unit_, static_cast<double>(D.diagonal().cwiseAbs().maxCoeff()));
    }
    if (!(unit_ > 0 && std::isfinite(unit_))) unit_ = 1;
    for (std::size_t i = 0; i < finest_.size(); ++i) {
      const auto open = block(free, static_cast<std::ptrdiff_t>(i));
      for (std::int32_t k = finest_.start[i]; k < finest_.start[i + 1]; ++k) {
        const Source& source = source_[at(k)];
        const auto from = matrix.block(source.block);
        Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> to(&finest_.values[9 * at(k)]);
        if (source.transposed)
          to = from.transpose().template cast<double>();
        else
          to = from.template cast<double>();
        if (const auto open_there = block(free, source.column);
            open.minCoeff() == T(0) || open_there.minCoeff() == T(0))
          for (int c = 0; c < 3; ++c)
            for (int d = 0; d < 3; ++d) to(c, d) *= static_cast<double>(open[c] * open_there[d]);
        if (k == finest_.diagonal[i])
          for (int c = 0; c < 3; ++c)
            if (to(c, c) == 0) to(c, c) = unit_;
      }
    }
  }

  // The inverse of the coarsest matrix, which is cheaper to apply than its factor.
  void factorise() {
    const detail::MultigridLevel<6>& level = coarse_[depth_ - 1];
    level.r.resize(8 * level.size(), 0.0F);
    level.x.resize(8 * level.size(), 0.0F);
    const int n = 6 * static_cast<int>(level.size());
    Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(n, n);
    for (std::size_t i = 0; i < level.size(); ++i)
      for (std::int32_t k = level.start[i]; k < level.start[i + 1]; ++k)
        dense.block<6, 6>(6 * static_cast<int>(i), 6 * level.column[at(k)]) =
            Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(&level.values[36 * at(k)]);
    const Eigen::VectorXd diagonal = dense.diagonal().cwiseAbs().cwiseMax(1e-300);
    for (double shift = 0;; shift = shift > 0 ? 10 * shift : 1e-12) {
      dense.diagonal() += shift * diagonal;
      const Eigen::LLT<Eigen::MatrixXd> llt(dense);
      if (llt.info() == Eigen::Success) {
        inverse_ = (unit_ * llt.solve(Eigen::MatrixXd::Identity(n, n))).cast<float>();
        if (inverse_.allFinite()) break;
      }
      if (shift > 1e3) {
        inverse_ = (unit_ * diagonal.cwiseInverse()).asDiagonal().toDenseMatrix().cast<float>();
        break;
      }
    }
    right_.resize(n);
    solution_.resize(n);
  }

  void solve_coarsest() const {
    const detail::MultigridLevel<6>& level = coarse_[depth_ - 1];
    for (std::size_t i = 0; i < level.size(); ++i)
      for (std::size_t c = 0; c < 6; ++c) right_[static_cast<int>(6 * i + c)] = level.r[8 * i + c];
    solution_.noalias() = inverse_ * right_;
    for (std::size_t i = 0; i < level.size(); ++i)
      for (std::size_t c = 0; c < 6; ++c) level.x[8 * i + c] = solution_[static_cast<int>(6 * i + c)];
  }

  struct Source {
    std::int32_t column, block;
    bool transposed;
  };
  std::uint64_t pattern_ = 0;
  Vector<T> free_;
  std::vector<Source> source_;
  double unit_ = 1;  // the largest stiffness
  detail::MultigridLevel<3> finest_;
  std::vector<detail::MultigridLevel<6>> coarse_;
  std::size_t depth_ = 0;
  bool direct_ = true;  // else pieces that are not connected, too many for a dense inverse
  Eigen::MatrixXf inverse_;
  mutable Eigen::VectorXf right_, solution_;
};

}  // namespace softsim
