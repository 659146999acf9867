// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/core/rotation.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

namespace rotation_test {

using softsim::rotation_exponential, softsim::rotation_logarithm;

template <class T>
class RotationTest : public ::testing::Test {
 public:
  static constexpr T eps = std::numeric_limits<T>::epsilon();
  static constexpr T pi = std::numbers::pi_v<T>;

  softsim::Vec3<T> random_axis() {
    softsim::Vec3<double> v(normal_(generator_), normal_(generator_), normal_(generator_));
    return v.normalized().template cast<T>();
  }
  /// Angles from 1e-12 to pi, dense where the series begins and at both ends.
  static std::vector<T> angles() {
    std::vector<T> result{0, pi / 2, 1, 2, 3};
    for (int i = -48; i <= 0; ++i) {
      result.push_back(std::pow(T(10), static_cast<T>(i) / 4));
      result.push_back(pi - std::pow(T(10), static_cast<T>(i) / 4));
    }
    return result;
  }

 private:
  std::mt19937 generator_{5};
  std::normal_distribution<double> normal_;
};

using Scalars = ::testing::Types<float, double>;
TYPED_TEST_SUITE(RotationTest, Scalars);

TYPED_TEST(RotationTest, ExponentialAgreesWithAnIndependentRotation) {
  using T = TypeParam;
  for (const T angle : this->angles()) {
    const softsim::Vec3<T> axis = this->random_axis();
    const softsim::Mat3<double> expected =
        Eigen::AngleAxisd(double(angle), axis.template cast<double>().normalized()).toRotationMatrix();
    const softsim::Mat3<T> R = rotation_exponential<T>(angle * axis);
    EXPECT_LT((R.template cast<double>() - expected).norm(), 8 * double(this->eps)) << angle;
  }
}

// Towards pi the second-order term has entries of size 2, each with a few roundings; nine of them add up.
TYPED_TEST(RotationTest, ExponentialIsOrthogonalWithDeterminantOne) {
  using T = TypeParam;
  for (const T angle : this->angles()) {
    const softsim::Mat3<T> R = rotation_exponential<T>(angle * this->random_axis());
    EXPECT_LT((R.transpose() * R - softsim::Mat3<T>::Identity()).norm(), 16 * this->eps) << angle;
    EXPECT_NEAR(softsim::determinant(R), T(1), 16 * this->eps) << angle;
  }
}

TYPED_TEST(RotationTest, ExponentialOfTinyVectorsKeepsRelativeDigits) {
  using T = TypeParam;
  for (const T angle : {T(1e-12), T(1e-6), T(1e-3)}) {
    const softsim::Vec3<T> r = angle * this->random_axis();
    // The skew part of exp is sin(angle)/angle r; halves are exact, sums of R's entries of size angle are
    // not.
    const softsim::Vec3<T> skew_part = T(0.5) * softsim::axial(rotation_exponential(r));
    EXPECT_LT((skew_part - std::sin(angle) / angle * r).norm(), 4 * this->eps * angle);
  }
  EXPECT_EQ(rotation_exponential<T>(softsim::Vec3<T>::Zero()), (softsim::Mat3<T>::Identity()));
}

TYPED_TEST(RotationTest, LogarithmInvertsTheExponentialUpToPi) {
  using T = TypeParam;
  for (const T angle : this->angles())
    for (int trial = 0; trial < 20; ++trial) {
      const softsim::Vec3<T> r = angle * this->random_axis();
      const softsim::Vec3<T> s = rotation_logarithm(rotation_exponential(r));
      // Close to pi rounding may carry the rotation across, to the opposite vector.
      const bool crossed = angle > this->pi - 16 * this->eps && s.dot(r) < 0;
      // The rotation holds the angle to its rounding; a tiny angle even to relative accuracy.
      const softsim::Vec3<T> error = crossed ? softsim::Vec3<T>(s + r) : softsim::Vec3<T>(s - r);
      EXPECT_LT(error.norm(), 16 * this->eps * std::max(angle, T(1e-12))) << angle;
      EXPECT_LE(s.norm(), this->pi * (1 + 2 * this->eps));
    }
}

TYPED_TEST(RotationTest, LogarithmOfExactHalfTurnsHasLengthPi) {
  using T = TypeParam;
  for (int trial = 0; trial < 50; ++trial) {
    const softsim::Vec3<T> n = this->random_axis();
    const softsim::Mat3<T> R = T(2) * n * n.transpose() - softsim::Mat3<T>::Identity();
    const softsim::Vec3<T> r = rotation_logarithm(R);
    EXPECT_NEAR(r.norm(), this->pi, 8 * this->eps);
    EXPECT_LT(r.cross(n).norm(), 16 * this->eps);
  }
  const softsim::Vec3<T> about_y = rotation_logarithm<T>(softsim::Vec3<T>(-1, 1, -1).asDiagonal());
  EXPECT_NEAR(std::abs(about_y[1]), this->pi, 2 * this->eps);
  EXPECT_EQ(rotation_logarithm<T>(softsim::Mat3<T>::Identity()).norm(), 0);
}

TYPED_TEST(RotationTest, SubnormalVectorsComeBack) {
  using T = TypeParam;
  // The norm of such a vector has no digits left; a factor of two does not round it.
  const softsim::Vec3<T> r = std::numeric_limits<T>::min() * softsim::Vec3<T>(0.125, -0.25, 0.0625);
  EXPECT_EQ(rotation_logarithm(rotation_exponential(r)), r);
}

TYPED_TEST(RotationTest, VectorsBeyondPiComeBackAsTheShortWayRound) {
  using T = TypeParam;
  const softsim::Vec3<T> axis = this->random_axis(), r = T(4) * axis;
  const softsim::Vec3<T> s = rotation_logarithm(rotation_exponential(r));
  EXPECT_LT((s - (T(4) - 2 * this->pi) * axis).norm(), 32 * this->eps);
}

TEST(RotationExponential, TurnsTheBodyFromItsOwnSide) {
  const softsim::Mat3<double> R = rotation_exponential<double>({0, 0, std::numbers::pi / 2});
  const softsim::Mat3<double> turned = R * rotation_exponential<double>({std::numbers::pi / 2, 0, 0});
  // The increment is about the body's x axis, which lies along the world's y: that axis stays where it is.
  EXPECT_LT((turned * softsim::Vec3<double>::UnitX() - softsim::Vec3<double>::UnitY()).norm(), 1e-15);
  EXPECT_LT((turned * softsim::Vec3<double>::UnitY() - softsim::Vec3<double>::UnitZ()).norm(), 1e-15);
}

}  // namespace rotation_test
