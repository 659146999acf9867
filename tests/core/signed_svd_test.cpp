// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/core/signed_svd.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace signed_svd_test {

using softsim::signed_svd;
using Mat = softsim::Mat3<double>;
using Vec = softsim::Vec3<double>;
using Long = Eigen::Matrix<long double, 3, 3>;

class SignedSvd : public ::testing::Test {
 protected:
  Mat random() {
    return Mat::NullaryExpr([this] { return normal_(generator_); });
  }
  Mat rotation() {
    return Eigen::Quaterniond(normal_(generator_), normal_(generator_), normal_(generator_),
                              normal_(generator_))
        .normalized()
        .toRotationMatrix();
  }
  Mat from_stretches(double s1, double s2, double s3) {
    return rotation() * Vec(s1, s2, s3).asDiagonal() * rotation();
  }
  double small() { return std::pow(10, -12 * uniform_(generator_)); }

  /// General, nearly rigid, inverted and flattened tensors; coincident, zero and nearly so singular values.
  std::vector<Mat> samples(int count) {
    std::vector<Mat> result{Mat::Zero(), Mat::Identity(), -Mat::Identity(), Mat::Ones()};
    for (int n = 0; n < count; ++n) {
      const double a = small(), b = small(), u = uniform_(generator_);
      result.push_back(random());
      result.push_back(rotation());
      result.push_back(rotation() * (Mat::Identity() + 0.1 * a * random()));
      result.push_back(from_stretches(1.3, 1, -0.7));
      result.push_back(from_stretches(1, u, 0));
      result.push_back(from_stretches(1, 0, 0));
      result.push_back(from_stretches(1, a, a * b));
      result.push_back(from_stretches(1, a, -a));
      result.push_back(from_stretches(1, 1, -a));
      result.push_back(from_stretches(1, 1 - a, -1 + b));
      result.push_back((2 * random()).array().round());
      result.push_back(Vec(random().col(0)).asDiagonal());
      result.push_back(random() * Vec(1, 1e-6, 1e-12).asDiagonal());
    }
    return result;
  }

  std::mt19937 generator_{5};
  std::normal_distribution<double> normal_;
  std::uniform_real_distribution<double> uniform_;
};

// Rounding of fifteen rotations: 3e-15 seen over 10^5 tensors.
template <class T>
void expect_decomposed(const softsim::Mat3<T>& F) {
  const T tolerance = 30 * std::numeric_limits<T>::epsilon();
  const auto [U_, s, V_] = signed_svd<T>(F);
  const Long U = U_.template cast<long double>(), V = V_.template cast<long double>();
  const Eigen::Matrix<long double, 3, 1> d = s.template cast<long double>();
  const T size = F.cwiseAbs().maxCoeff();  // the norm underflows sooner
  EXPECT_LE((U.transpose() * U - Long::Identity()).norm(), tolerance) << "F =\n" << F;
  EXPECT_LE((V.transpose() * V - Long::Identity()).norm(), tolerance) << "F =\n" << F;
  EXPECT_GT(U.determinant(), 0) << "F =\n" << F;
  EXPECT_GT(V.determinant(), 0) << "F =\n" << F;
  EXPECT_LE((U * d.asDiagonal() * V.transpose() - F.template cast<long double>()).norm(), tolerance * size)
      << "F =\n"
      << F;
  EXPECT_GE(s[0], s[1] - tolerance * size) << "F =\n" << F;
  EXPECT_GE(s[1], std::abs(s[2]) - tolerance * size) << "F =\n" << F;
}

TEST_F(SignedSvd, ReproducesTheTensorWithProperRotations) {
  for (const Mat& F : samples(200)) {
    expect_decomposed<double>(F);
    expect_decomposed<double>(1e-200 * F);
    expect_decomposed<double>(1e200 * F);
  }
}

TEST_F(SignedSvd, ReproducesTheTensorInSinglePrecision) {
  for (const Mat& F : samples(200)) expect_decomposed<float>(F.cast<float>());
}

TEST_F(SignedSvd, SingularValuesAreThoseOfExtendedPrecisionSignedLikeTheDeterminant) {
  for (const Mat& F : samples(100)) {
    const Vec s = signed_svd(F).s;
    const Long wide = F.cast<long double>();
    const Eigen::JacobiSVD<Long> oracle(wide);
    for (int i = 0; i < 3; ++i)
      EXPECT_NEAR(std::abs(s[i]), static_cast<double>(oracle.singularValues()[i]), 3e-15 * F.norm()) << F;
    const long double det = wide.determinant();
    if (std::abs(det) > 1e-14L * std::pow(wide.norm(), 3)) {
      EXPECT_EQ(s[2] < 0, det < 0) << F;
    }
  }
}

TEST_F(SignedSvd, KeepsDigitsOfSmallSingularValuesWhereTheColumnsHaveThem) {
  for (int n = 0; n < 100; ++n) {
    const Mat F = rotation() * Vec(1, 1e-7, -1e-14).asDiagonal();
    const Vec s = signed_svd(F).s;
    EXPECT_NEAR(s[1], 1e-7, 1e-7 * 1e-14);
    EXPECT_NEAR(s[2], -1e-14, 1e-14 * 1e-14);
  }
}

TEST_F(SignedSvd, DiagonalTensorsAreExact) {
  EXPECT_EQ(signed_svd<double>(Mat::Zero()).U, Mat::Identity());
  EXPECT_EQ(signed_svd<double>(Mat::Zero()).V, Mat::Identity());
  EXPECT_EQ(signed_svd<double>(Mat::Identity()).s, Vec::Ones());
  EXPECT_EQ(signed_svd<double>(Mat::Identity()).U, Mat::Identity());
  EXPECT_EQ(signed_svd<double>(-Mat::Identity()).s, Vec(1, 1, -1));
  // a hair beyond flat
  EXPECT_EQ(signed_svd<double>(Vec(1, 1, -1e-300).asDiagonal().toDenseMatrix()).s[2], -1e-300);
}

TEST_F(SignedSvd, NotFiniteStaysNotFinite) {
  for (const double x : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
    for (int i = 0; i < 9; ++i) {
      Mat F = Mat::Identity();
      F(i) = x;
      EXPECT_TRUE(signed_svd(F).s.hasNaN() && signed_svd(F).V.hasNaN());
    }
}

TEST_F(SignedSvd, BatchesAreTheScalarsLaneByLane) {
  using B = softsim::Batch<double, 8>;
  const std::vector<Mat> all = samples(40);
  for (std::size_t first = 0; first + 8 <= all.size(); first += 8) {
    softsim::Mat3<B> F;
    for (int l = 0; l < 8; ++l)
      for (int i = 0; i < 9; ++i) softsim::set_lane(F(i), l, all[first + static_cast<std::size_t>(l)](i));
    const auto batch = signed_svd(F);
    for (int l = 0; l < 8; ++l) {
      const Mat& scalar = all[first + static_cast<std::size_t>(l)];
      Mat U, V;
      Vec s;
      for (int i = 0; i < 9; ++i) U(i) = lane(batch.U(i), l);
      for (int i = 0; i < 9; ++i) V(i) = lane(batch.V(i), l);
      for (int i = 0; i < 3; ++i) s[i] = lane(batch.s[i], l);
      EXPECT_LE((U * s.asDiagonal() * V.transpose() - scalar).norm(), 1e-14 * scalar.norm());
      EXPECT_LE((s - signed_svd(scalar).s).norm(), 1e-14 * scalar.norm());
    }
  }
}

}  // namespace signed_svd_test
