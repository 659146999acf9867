// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/core/tensor.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>

namespace tensor_test {

using Mat = softsim::Mat3<double>;
using Vec = softsim::Vec3<double>;

// Entries of size 1: products of three are exact to a few 1e-16.
constexpr double rounding = 1e-14;

class TensorTest : public ::testing::Test {
 protected:
  void SetUp() override { std::srand(3); }
};

TEST_F(TensorTest, CofactorIsJTimesTheInverseTransposed) {
  for (int trial = 0; trial < 100; ++trial) {
    const Mat F = Mat::Random() + 2 * Mat::Identity();
    const Mat expected = F.determinant() * F.inverse().transpose();
    EXPECT_LT((softsim::cofactor(F) - expected).norm(), 10 * rounding);
    EXPECT_NEAR(softsim::determinant(F), F.determinant(), 10 * rounding);
  }
}

TEST_F(TensorTest, CofactorStaysExactForSingularTensors) {
  const Mat rank_two = Vec(2, 3, 0).asDiagonal();
  Mat expected = Mat::Zero();
  expected(2, 2) = 6;
  EXPECT_EQ(softsim::cofactor(rank_two), expected);
  const Vec u(1, 2, 3), v(-1, 4, 2);
  const Mat rank_one = u * v.transpose();
  EXPECT_EQ(softsim::cofactor(rank_one).norm(), 0);
}

TEST_F(TensorTest, CofactorIsTheDerivativeOfTheDeterminant) {
  const Mat F = Mat::Random(), dF = Mat::Random();
  // J(F + t dF) is cubic in t: the central difference at t = 1 misses the derivative by the cubic term det dF
  // alone.
  const double difference =
      0.5 * (softsim::determinant<double>(F + dF) - softsim::determinant<double>(F - dF));
  EXPECT_NEAR(softsim::double_dot(softsim::cofactor(F), dF), difference - softsim::determinant(dF), rounding);
}

TEST_F(TensorTest, CofactorDifferentialEqualsItsExactPolarisation) {
  for (int trial = 0; trial < 100; ++trial) {
    const Mat F = Mat::Random(), dF = Mat::Random();
    // The cofactor is quadratic: a central difference is exact at any step.
    const Mat polarised = 0.5 * (softsim::cofactor<double>(F + dF) - softsim::cofactor<double>(F - dF));
    EXPECT_LT((softsim::cofactor_differential(F, dF) - polarised).norm(), rounding);
  }
}

TEST_F(TensorTest, CofactorDifferentialMatchesForwardDifferences) {
  const Mat F = Mat::Random(), dF = Mat::Random();
  const double t = 1e-7;
  const Mat difference = (softsim::cofactor<double>(F + t * dF) - softsim::cofactor(F)) / t;
  // The step leaves t |cof dF| of truncation and eps / t of cancellation.
  EXPECT_LT((softsim::cofactor_differential(F, dF) - difference).norm(), 1e-6);
}

TEST_F(TensorTest, CofactorDifferentialIsSymmetricAsSecondDerivative) {
  const Mat F = Mat::Random(), A = Mat::Random(), B = Mat::Random();
  EXPECT_NEAR(softsim::double_dot(softsim::cofactor_differential(F, A), B),
              softsim::double_dot(softsim::cofactor_differential(F, B), A), rounding);
}

TEST_F(TensorTest, SkewTensorIsTheCrossProduct) {
  const Vec v = Vec::Random(), w = Vec::Random();
  EXPECT_LT((softsim::skew(v) * w - v.cross(w)).norm(), rounding);
  EXPECT_EQ(softsim::skew(v), Mat(-softsim::skew(v).transpose()));
}

TEST_F(TensorTest, AxialVectorIsDualToTheSkewTensor) {
  const Mat A = Mat::Random();
  const Vec v = Vec::Random();
  EXPECT_NEAR(softsim::double_dot(A, softsim::skew(v)), softsim::axial(A).dot(v), rounding);
  EXPECT_LT((softsim::axial(softsim::skew(v)) - 2 * v).norm(), rounding);
  EXPECT_EQ(softsim::axial(softsim::symmetric_part(A)).norm(), 0);
}

TEST_F(TensorTest, SymmetricPartAndContractionFollowTheirDefinitions) {
  const Mat A = Mat::Random(), B = Mat::Random();
  EXPECT_LT((softsim::symmetric_part(A) - 0.5 * (A + A.transpose())).norm(), rounding);
  EXPECT_NEAR(softsim::double_dot(A, B), (A.transpose() * B).trace(), rounding);
  EXPECT_NEAR(softsim::trace(A), A.trace(), rounding);
}

}  // namespace tensor_test
