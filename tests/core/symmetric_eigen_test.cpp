// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/core/symmetric_eigen.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace symmetric_eigen_test {

using softsim::symmetric_eigen;
using Mat = softsim::Mat3<double>;
using Vec = softsim::Vec3<double>;

std::vector<Mat> samples() {
  std::mt19937 generator(3);
  std::normal_distribution<double> normal;
  const auto random = [&] { return Mat(Mat::NullaryExpr([&] { return normal(generator); })); };
  std::vector<Mat> result{Mat::Zero(), Mat::Identity(), Mat::Ones(), -3 * Mat::Identity()};
  for (int n = 0; n < 500; ++n) {
    const Mat A = random();
    result.push_back(A + A.transpose());
    result.push_back(Mat::Identity() + std::pow(10, -15.0 * n / 500) * (A + A.transpose()));
    result.push_back(std::pow(10, n - 250.0) * A * A.transpose());
    result.push_back(A.col(0) * A.col(0).transpose());
    const Vec graded(1, 1e-5, 1e-9);
    result.push_back(graded.asDiagonal() * (A + A.transpose()) * graded.asDiagonal());
  }
  return result;
}

// Rounding of twelve rotations with a handful of operations each, the same bound for every matrix.
template <class T>
void expect_decomposed(const softsim::Mat3<T>& A) {
  using Long = Eigen::Matrix<long double, 3, 3>;
  const T tolerance = 60 * std::numeric_limits<T>::epsilon();
  const auto [values, V] = symmetric_eigen<T>(A);
  const Long VL = V.template cast<long double>(), AL = A.template cast<long double>();
  const Eigen::Matrix<long double, 3, 1> d = values.template cast<long double>();
  const T size = std::max(A.cwiseAbs().maxCoeff(), std::numeric_limits<T>::min());
  EXPECT_LE((VL.transpose() * VL - Long::Identity()).norm(), tolerance) << "A =\n" << A;
  EXPECT_GT(VL.determinant(), 0) << "A =\n" << A;
  EXPECT_LE((VL * d.asDiagonal() * VL.transpose() - AL).norm(), tolerance * size) << "A =\n" << A;
}

TEST(SymmetricEigen, ReproducesTheMatrix) {
  for (const Mat& A : samples()) expect_decomposed<double>(A);
}

TEST(SymmetricEigen, ReproducesTheMatrixInSinglePrecision) {
  for (const Mat& A : samples())
    if (A.cwiseAbs().maxCoeff() < 1e30 && A.cwiseAbs().maxCoeff() > 1e-30)
      expect_decomposed<float>(A.cast<float>());
}

TEST(SymmetricEigen, ValuesAreThoseOfEigen) {
  for (const Mat& A : samples()) {
    Vec values = symmetric_eigen(A).values;
    std::sort(values.data(), values.data() + 3);
    const Vec expected = Eigen::SelfAdjointEigenSolver<Mat>(A).eigenvalues();
    EXPECT_LE((values - expected).norm(), 1e-14 * A.norm()) << "A =\n" << A;
  }
}

TEST(SymmetricEigen, UsesTheUpperTriangleOnly) {
  Mat A = Vec(1, 2, 3).asDiagonal();
  A(2, 0) = 7;
  A(1, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_LE((symmetric_eigen(A).values - Vec(1, 2, 3)).norm(), 1e-15);
}

TEST(SymmetricEigen, NotFiniteStaysNotFinite) {
  for (const double x : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
    for (int i = 0; i < 3; ++i) {
      Mat A = Mat::Identity();
      A(0, i) = x;
      EXPECT_FALSE(symmetric_eigen(A).values.allFinite());
    }
}

TEST(SymmetricEigen, BatchesAreTheScalarsLaneByLane) {
  using B = softsim::Batch<double, 8>;
  const std::vector<Mat> all = samples();
  for (std::size_t first = 0; first + 8 <= all.size(); first += 200) {
    softsim::Mat3<B> A;
    for (int l = 0; l < 8; ++l)
      for (int i = 0; i < 9; ++i) softsim::set_lane(A(i), l, all[first + static_cast<std::size_t>(l)](i));
    const auto batch = symmetric_eigen(A);
    for (int l = 0; l < 8; ++l) {
      const Mat& scalar = all[first + static_cast<std::size_t>(l)];
      Mat V;
      for (int i = 0; i < 9; ++i) V(i) = lane(batch.V(i), l);
      Vec d;
      for (int i = 0; i < 3; ++i) d[i] = lane(batch.values[i], l);
      EXPECT_LE((V * d.asDiagonal() * V.transpose() - scalar).norm(), 1e-14 * scalar.norm());
      EXPECT_LE((d - symmetric_eigen(scalar).values).norm(), 1e-14 * scalar.norm());
    }
  }
}

}  // namespace symmetric_eigen_test
