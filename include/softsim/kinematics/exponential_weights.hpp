// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "softsim/core/tensor.hpp"

namespace softsim {

/// Weights w_i = exp(a_i) / Z on offsets y_i, with log Z, the mean of the y_i and their covariance C. For
/// a_i = log prior_i + lambda . y_i mean and C are gradient and Hessian of log Z by lambda.
/// C = P R^T R P^T comes from a QR decomposition of the rows sqrt(w_i) (y_i - mean): where the weights
/// gather on a face of the hull of the offsets C is all but singular, and would lose twice the digits.
class ExponentialWeights {
 public:
  /// @param offsets y_i, at least one, without dimension
  /// @param exponents a_i
  /// @param dimension 0 to 3: along the axes beyond it, where all offsets are 0, the covariance is set to 1
  ExponentialWeights(const std::vector<Vec3<double>>& offsets, std::vector<double> exponents, int dimension)
      : exponents_(std::move(exponents)) {
    const double largest = *std::max_element(exponents_.begin(), exponents_.end());
    double sum = 0;
    for (const double a : exponents_) {
      values_.push_back(std::exp(a - largest));
      sum += values_.back();
    }
    log_sum_ = largest + std::log(sum);
    for (std::size_t k = 0; k < offsets.size(); ++k) {
      values_[k] /= sum;
      mean_ += values_[k] * offsets[k];
      reach_ = std::max(reach_, offsets[k].norm());
    }
    decompose(offsets, dimension);
  }

  [[nodiscard]] const std::vector<double>& exponents() const { return exponents_; }
  [[nodiscard]] const std::vector<double>& values() const { return values_; }
  /// log Z.
  [[nodiscard]] double log_sum() const { return log_sum_; }
  [[nodiscard]] const Vec3<double>& mean() const { return mean_; }
  /// C^-1 v.
  [[nodiscard]] Vec3<double> over_covariance(const Vec3<double>& v) const {
    const auto upper = R_.triangularView<Eigen::Upper>();
    const Vec3<double> half = upper.transpose().solve(P_.transpose() * v);
    return P_ * upper.solve(half);
  }
  /// Whether the weights spread over at least 1e-4 of the farthest offset (or of 1) in every direction.
  [[nodiscard]] bool spread() const { return std::abs(R_(2, 2)) > 1e-4 * std::min(reach_, 1.0); }

 private:
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, 3>;

  void decompose(const std::vector<Vec3<double>>& offsets, int dimension) {
    const auto n = static_cast<Eigen::Index>(offsets.size());
    Rows rows = Rows::Zero(n + 3, 3);
    for (Eigen::Index k = 0; k < n; ++k) {
      const auto i = static_cast<std::size_t>(k);
      rows.row(k) = std::sqrt(values_[i]) * (offsets[i] - mean_).transpose();
    }
    for (int a = dimension; a < 3; ++a) rows(n + a, a) = 1;
    const Eigen::ColPivHouseholderQR<Rows> qr(rows);
    R_ = qr.matrixR().topRows<3>();
    P_ = qr.colsPermutation();
    for (int a = 0; a < 3; ++a)  // offsets in a plane: anything that can be divided by
      R_(a, a) = std::copysign(std::max(std::abs(R_(a, a)), 1e-16), R_(a, a));
  }

  std::vector<double> exponents_, values_;
  double log_sum_ = 0, reach_ = 0;
  Vec3<double> mean_ = Vec3<double>::Zero();
  Mat3<double> R_;  // upper triangle
  Eigen::PermutationMatrix<3> P_;
};

}  // namespace softsim
