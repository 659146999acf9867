// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/core/polar.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

namespace polar_test {

using softsim::polar_decomposition, softsim::rotation_factor;
using Mat = softsim::Mat3<double>;
using Vec = softsim::Vec3<double>;

constexpr double eps = std::numeric_limits<double>::epsilon();

struct Sample {
  std::string name;
  Mat F;
};

class PolarTest : public ::testing::Test {
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
  double small() { return std::pow(10, -9 * uniform_(generator_)); }

  /// General, nearly rigid, inverted, flattened and nearly non-unique deformations.
  std::vector<Sample> samples() {
    std::vector<Sample> result;
    for (int i = 0; i < 500; ++i) {
      result.push_back({"random", random()});
      result.push_back({"nearly rigid", rotation() * (Mat::Identity() + 1e-3 * random())});
      result.push_back({"inverted", from_stretches(1.3, 1, -0.7)});
      result.push_back({"rank 2", from_stretches(1, uniform_(generator_), 0)});
      result.push_back({"nearly rank 1", from_stretches(1, small(), 0.3 * small())});
      result.push_back({"nearly singular", from_stretches(1, 0.5, small() * small())});
      const double s = uniform_(generator_);
      result.push_back({"nearly ambiguous", from_stretches(1, s, -s + 1e-2 * small())});
      result.push_back({"nearly isotropic reflection", from_stretches(1, 1 - small(), -1 + 2 * small())});
      result.push_back({"small integers", (2 * random()).array().round()});
    }
    return result;
  }

  std::mt19937 generator_{17};
  std::normal_distribution<double> normal_;
  std::uniform_real_distribution<double> uniform_;
};

/// Nearest rotation by a singular value decomposition in extended precision.
struct Oracle {
  Mat R;
  Vec s;  ///< singular values, the last one signed
  explicit Oracle(const Mat& F) {
    using Long = Eigen::Matrix<long double, 3, 3>;
    Eigen::JacobiSVD<Long> svd(F.cast<long double>(), Eigen::ComputeFullU | Eigen::ComputeFullV);
    const Long U = svd.matrixU(), V = svd.matrixV();
    const long double sign = U.determinant() * V.determinant() < 0 ? -1 : 1;
    const Eigen::Matrix<long double, 3, 1> signs(1, 1, sign);
    R = (U * signs.asDiagonal() * V.transpose()).cast<double>();
    s = svd.singularValues().cwiseProduct(signs).cast<double>();
  }
};

double rotation_error(const Mat& R) { return (R.transpose() * R - Mat::Identity()).norm(); }

TEST_F(PolarTest, ResultIsAlwaysARotation) {
  for (const auto& [name, F] : samples()) {
    const Mat R = rotation_factor(F);
    ASSERT_LE(rotation_error(R), 1e-14) << name << "\n" << F;
    ASSERT_NEAR(R.determinant(), 1, 1e-14) << name << "\n" << F;
  }
}

// 100 eps s1 / (s2 + s3), as documented; the factor s1 / (s2 + s3) is the condition number of the problem.
TEST_F(PolarTest, ResultIsTheNearestRotation) {
  for (const auto& [name, F] : samples()) {
    const Oracle oracle(F);
    if (!(oracle.s[1] + oracle.s[2] > 1e-14 * oracle.s[0])) continue;
    const double condition = oracle.s[0] / (oracle.s[1] + oracle.s[2]);
    ASSERT_LE((rotation_factor(F) - oracle.R).norm(), 100 * eps * condition) << name << "\n" << F;
  }
}

// The maximum itself is well conditioned, also where the rotation is not; the tie-breaker gives away at most
// 128 eps.
TEST_F(PolarTest, ResultMaximisesTheTraceHoweverIllConditioned) {
  for (const auto& [name, F] : samples()) {
    const Oracle oracle(F);
    const double attained = (rotation_factor(F).transpose() * F).trace();
    ASSERT_NEAR(attained, oracle.s.sum(), 150 * eps * F.norm()) << name << "\n" << F;
  }
}

TEST_F(PolarTest, OrdinaryDeformationsAreFreeOfTheTieBreaker) {
  for (int i = 0; i < 2000; ++i) {
    const Mat F = from_stretches(1.5, 1 + 0.5 * uniform_(generator_), 0.7);
    ASSERT_LE((rotation_factor(F) - Oracle(F).R).norm(), 4e-15);
    const Mat R = rotation();
    ASSERT_LE((rotation_factor(R) - R).norm(), 4e-15);
  }
}

TEST_F(PolarTest, TheSizeOfFDoesNotMatter) {
  for (int i = 0; i < 200; ++i) {
    const Mat F = random();
    const Mat R = rotation_factor(F);
    for (const double scale : {1e-300, 1e-150, 1e-20, 1e20, 1e150, 1e300}) {
      const double condition = Oracle(F).s[0] / (Oracle(F).s[1] + Oracle(F).s[2]);
      ASSERT_LE((rotation_factor<double>(scale * F) - R).norm(), 1e-14 * condition) << scale;
    }
    // A power of two changes no digit, as long as the steps are the same.
    ASSERT_EQ(rotation_factor<double>(0x1p-12 * F), R);
  }
}

TEST_F(PolarTest, ZeroAndReflectionsThatTieGiveValidRotations) {
  EXPECT_EQ(rotation_factor<double>(Mat::Zero()), Mat::Identity());
  EXPECT_LE((rotation_factor<double>(Mat::Identity()) - Mat::Identity()).norm(), 1e-15);
  // Every half turn is nearest to -I; one of them comes out.
  const Mat half_turn = rotation_factor<double>(-Mat::Identity());
  EXPECT_LE(rotation_error(half_turn), 1e-15);
  EXPECT_NEAR(half_turn.trace(), -1, 1e-15);
  // diag(1, 1, -1): trace 1 is attained by I, and the tie is settled for it.
  EXPECT_LE((rotation_factor<double>(Vec(1, 1, -1).asDiagonal()) - Mat::Identity()).norm(), 1e-14);
  EXPECT_LE(rotation_error(rotation_factor<double>(Mat::Constant(std::numeric_limits<double>::denorm_min()))),
            1e-14);
}

TEST_F(PolarTest, RankOneGivesTheRotationThatTurnsLeast) {
  for (int i = 0; i < 500; ++i) {
    const Vec u = rotation().col(0), v = rotation().col(0);
    const Mat R = rotation_factor<double>(u * v.transpose());
    ASSERT_LE(rotation_error(R), 1e-14);
    ASSERT_LE((R * v - u).norm(), 1e-7);  // the maximum is flat: a loss of eps is an angle of sqrt(eps)
    // The tie-breaker outweighs rounding by one or two orders as long as u and v are not nearly opposite.
    const double angle = Eigen::AngleAxisd(R).angle(), least = std::acos(u.dot(v));
    if (least > 2) continue;
    ASSERT_LE(angle, least + 0.05) << least;
  }
}

TEST_F(PolarTest, NotANumberStaysVisible) {
  Mat F = Mat::Identity();
  F(1, 2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(rotation_factor(F).hasNaN());
  F(1, 2) = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(rotation_factor(F).hasNaN());
}

TEST_F(PolarTest, FloatReachesItsOwnAccuracy) {
  constexpr float float_eps = std::numeric_limits<float>::epsilon();
  for (const auto& [name, F] : samples()) {
    const softsim::Mat3<float> f = F.cast<float>(), R = rotation_factor(f);
    const Oracle oracle(f.cast<double>());
    ASSERT_LE((R.transpose() * R - softsim::Mat3<float>::Identity()).norm(), 40 * float_eps) << name;
    const double attained = (R.cast<double>().transpose() * f.cast<double>()).trace();
    ASSERT_NEAR(attained, oracle.s.sum(), 150 * float_eps * F.norm()) << name;
    const double condition = oracle.s[0] / (oracle.s[1] + oracle.s[2]);
    if (!(condition > 0 && condition < 1e5)) continue;
    ASSERT_LE((R.cast<double>() - oracle.R).norm(), 100 * float_eps * condition) << name << "\n" << F;
  }
}

TEST_F(PolarTest, FactorsMultiplyToFWithASymmetricStretch) {
  for (const auto& [name, F] : samples()) {
    const auto [R, S] = polar_decomposition(F);
    ASSERT_EQ(S, Mat(S.transpose()));
    ASSERT_LE((R * S - F).norm(), 1e-13 * F.norm()) << name << "\n" << F;
    if (F.determinant() < 1e-6) continue;
    ASSERT_GT(S.determinant(), 0) << name;
  }
}

template <class B>
class PolarBatchTest : public ::testing::Test {};
using Batches = ::testing::Types<softsim::Batch<double, 4>, softsim::Batch<double, 8>,
                                 softsim::Batch<float, 8>, softsim::Batch<float, 16>>;
TYPED_TEST_SUITE(PolarBatchTest, Batches);

TYPED_TEST(PolarBatchTest, EveryLaneEqualsTheScalarResult) {
  using B = TypeParam;
  using T = decltype(softsim::lane(B{}, 0));
  std::mt19937 generator(3);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 100; ++trial) {
    softsim::Mat3<B> F;
    for (int i = 0; i < 9; ++i)
      for (int l = 0; l < softsim::lane_count<B>; ++l)
        softsim::set_lane(F(i), l, static_cast<T>((i % 4 == 0) + 0.5 * normal(generator)));
    F(4) = F(4) * B(trial % 2 == 0 ? 1 : -1);
    const softsim::Mat3<B> R = rotation_factor(F);
    for (int l = 0; l < softsim::lane_count<B>; ++l) {
      const softsim::Mat3<T> f = F.unaryExpr([l](const B& b) { return softsim::lane(b, l); });
      const softsim::Mat3<T> r = rotation_factor(f);
      const Oracle oracle(f.template cast<double>());
      const double tolerance =
          100 * double(std::numeric_limits<T>::epsilon()) * oracle.s[0] / (oracle.s[1] + oracle.s[2]);
      for (int i = 0; i < 9; ++i) ASSERT_NEAR(softsim::lane(R(i), l), r(i), tolerance) << f;
    }
  }
}

TYPED_TEST(PolarBatchTest, ZeroInOneLaneGivesTheIdentityThere) {
  using B = TypeParam;
  using T = decltype(softsim::lane(B{}, 0));
  softsim::Mat3<B> F = softsim::Mat3<B>::Identity();
  for (int i = 0; i < 9; ++i) softsim::set_lane(F(i), 1, T(0));
  const softsim::Mat3<B> R = rotation_factor(F);
  for (int i = 0; i < 9; ++i)
    for (int l = 0; l < softsim::lane_count<B>; ++l)
      EXPECT_NEAR(softsim::lane(R(i), l), i % 4 == 0 ? 1 : 0, std::numeric_limits<T>::epsilon());
}

}  // namespace polar_test
