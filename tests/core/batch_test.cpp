// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/core/batch.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <random>

#include "softsim/core/tensor.hpp"

namespace batch_test {

using softsim::Batch, softsim::lane, softsim::lane_count, softsim::select, softsim::set_lane;

template <class B>
class BatchTest : public ::testing::Test {
 public:
  using Scalar = decltype(lane(B{}, 0));
  static constexpr int N = lane_count<B>;

  B random(double lower, double upper) {
    std::uniform_real_distribution<double> uniform(lower, upper);
    B b;
    for (int l = 0; l < N; ++l) set_lane(b, l, static_cast<Scalar>(uniform(generator_)));
    return b;
  }

  /// Distance of lane l to `expected` in units of the last place.
  static double ulps(const B& b, int l, Scalar expected) {
    const Scalar size = std::abs(expected);
    const Scalar spacing = std::nextafter(size, std::numeric_limits<Scalar>::infinity()) - size;
    return std::abs(double(lane(b, l)) - double(expected)) / double(spacing);
  }

 private:
  std::mt19937 generator_{20};
};

// One register and two or four of them, whatever the machine has.
using Batches = ::testing::Types<Batch<double, 2>, Batch<double, 4>, Batch<double, 8>, Batch<double, 16>,
                                 Batch<float, 4>, Batch<float, 8>, Batch<float, 16>>;
TYPED_TEST_SUITE(BatchTest, Batches);

TYPED_TEST(BatchTest, ArithmeticEqualsTheScalarInEveryLane) {
  using B = TypeParam;
  using T = typename TestFixture::Scalar;
  const B a = this->random(-2, 2), b = this->random(1, 3);
  B sum = a, difference = a, product = a, quotient = a;
  sum += b;
  difference -= b;
  product *= b;
  quotient /= b;
  for (int l = 0; l < TestFixture::N; ++l) {
    const T x = lane(a, l), y = lane(b, l);
    EXPECT_EQ(lane(a + b, l), x + y);
    EXPECT_EQ(lane(a - b, l), x - y);
    EXPECT_EQ(lane(a * b, l), x * y);
    EXPECT_EQ(lane(a / b, l), x / y);
    EXPECT_EQ(lane(sum, l), x + y);
    EXPECT_EQ(lane(difference, l), x - y);
    EXPECT_EQ(lane(product, l), x * y);
    EXPECT_EQ(lane(quotient, l), x / y);
    EXPECT_EQ(lane(-a, l), -x);
    EXPECT_EQ(lane(2 * a, l), T(2) * x);
    EXPECT_EQ(lane(a - 0.5, l), x - T(0.5));
  }
}

TYPED_TEST(BatchTest, ANumberFillsEveryLaneWithItsSign) {
  using B = TypeParam;
  const B three(3), minus_zero(-0.0);
  for (int l = 0; l < TestFixture::N; ++l) {
    EXPECT_EQ(lane(three, l), 3);
    EXPECT_TRUE(std::signbit(lane(minus_zero, l)));
    EXPECT_TRUE(std::signbit(lane(-B(0), l)));
  }
}

TYPED_TEST(BatchTest, LoadAndStoreKeepTheOrderWithoutAlignment) {
  using B = TypeParam;
  using T = typename TestFixture::Scalar;
  constexpr std::size_t n = static_cast<std::size_t>(TestFixture::N);
  std::array<T, n + 1> in{}, out{};
  for (std::size_t i = 0; i <= n; ++i) in[i] = static_cast<T>(i);
  const B b = B::load(in.data() + 1);
  b.store(out.data() + 1);
  EXPECT_EQ(out, in);
  for (int l = 0; l < TestFixture::N; ++l) EXPECT_EQ(lane(b, l), T(l + 1));
}

TYPED_TEST(BatchTest, ComparisonsSelectLaneByLane) {
  using B = TypeParam;
  using T = typename TestFixture::Scalar;
  B a = this->random(-1, 1), b = this->random(-1, 1);
  set_lane(b, 1, lane(a, 1));
  set_lane(a, 0, T(-2));
  set_lane(a, TestFixture::N - 1, T(2));
  const auto holds = [](const auto& mask, int l) { return lane(select(mask, B(1), B(0)), l) == T(1); };
  for (int l = 0; l < TestFixture::N; ++l) {
    const T x = lane(a, l), y = lane(b, l);
    EXPECT_EQ(holds(a < b, l), x < y);
    EXPECT_EQ(holds(a <= b, l), x <= y);
    EXPECT_EQ(holds(a > b, l), x > y);
    EXPECT_EQ(holds(a >= b, l), x >= y);
    EXPECT_EQ(holds(a == b, l), x == y);
    EXPECT_EQ(holds(a != b, l), x != y);
    EXPECT_EQ(holds((a < b) & (a < B(0)), l), x < y && x < T(0));
    EXPECT_EQ(holds((a < b) | (a < B(0)), l), x < y || x < T(0));
    EXPECT_EQ(lane(select(a < b, a, b), l), x < y ? x : y);
    EXPECT_EQ(lane(min(a, b), l), std::min(x, y));
    EXPECT_EQ(lane(max(a, b), l), std::max(x, y));
    EXPECT_EQ(lane(abs(a), l), std::abs(x));
  }
}

TYPED_TEST(BatchTest, AnyAndAllSeeEverySingleLane) {
  using B = TypeParam;
  using T = typename TestFixture::Scalar;
  EXPECT_FALSE(any(B(0) < B(0)));
  EXPECT_TRUE(all(B(0) <= B(0)));
  for (int l = 0; l < TestFixture::N; ++l) {
    B one_hot(0);
    set_lane(one_hot, l, T(1));
    EXPECT_TRUE(any(one_hot > B(0)));
    EXPECT_FALSE(all(one_hot > B(0)));
    EXPECT_FALSE(all(one_hot == B(0)));
    EXPECT_FALSE(any(one_hot < B(0)));
    EXPECT_TRUE(all(one_hot >= B(0)));
  }
}

TYPED_TEST(BatchTest, ComparisonsWithNaNAreFalseInItsLaneOnly) {
  using B = TypeParam;
  B a(1);
  const int last = TestFixture::N - 1;
  set_lane(a, last, std::numeric_limits<typename TestFixture::Scalar>::quiet_NaN());
  const B equal = select(a == a, B(1), B(0));
  for (int l = 0; l < TestFixture::N; ++l) EXPECT_EQ(lane(equal, l), l == last ? 0 : 1);
  EXPECT_TRUE(any(a != a));
}

// The vectorised functions are not correctly rounded; a few units in the last place are what they promise.
TYPED_TEST(BatchTest, FunctionsAgreeWithTheStandardLibraryToAFewUlps) {
  using B = TypeParam;
  using T = typename TestFixture::Scalar;
  for (int trial = 0; trial < 500; ++trial) {
    const B exponent = this->random(-20, 20), x = exp(exponent);
    for (int l = 0; l < TestFixture::N; ++l) {
      const T e = lane(exponent, l), v = lane(x, l);
      EXPECT_LE(this->ulps(x, l, std::exp(e)), 3) << e;
      EXPECT_LE(this->ulps(sqrt(x), l, std::sqrt(v)), 4) << v;
      EXPECT_LE(this->ulps(log(x), l, std::log(v)), 3) << v;
      // g++ contracts the compensated products inside Eigen's power once fused instructions are on; the
      // exponent p log x then carries its own rounding.
      for (const double p : {0.5, -1.0 / 3, 1.7, 2.0, 3.0})
        EXPECT_LE(this->ulps(pow(x, p), l, std::pow(v, static_cast<T>(p))), 3 + std::abs(p * double(e)))
            << v << "^" << p;
    }
  }
}

TYPED_TEST(BatchTest, LogarithmsNearOneKeepTheirDigits) {
  using B = TypeParam;
  using T = typename TestFixture::Scalar;
  for (int trial = 0; trial < 100; ++trial) {
    const B x = B(1) + this->random(-1, 1) * B(1e-4);
    for (int l = 0; l < TestFixture::N; ++l) {
      const T v = lane(x, l), exact = std::log(v);
      if (exact == 0) continue;
      EXPECT_LE(this->ulps(log(x), l, exact), 4) << v;
    }
  }
}

TYPED_TEST(BatchTest, FunctionsOutsideTheirDomainSayNaN) {
  using B = TypeParam;
  EXPECT_TRUE(all(log(B(-1)) != log(B(-1))));
  EXPECT_TRUE(all(sqrt(B(-1)) != sqrt(B(-1))));
  EXPECT_TRUE(all(pow(B(-1), 0.5) != pow(B(-1), 0.5)));
  EXPECT_TRUE(all(log(B(0)) < B(-1e30)));
  EXPECT_TRUE(all(sqrt(B(0)) == B(0)));
  EXPECT_TRUE(all(exp(B(0)) == B(1)));
}

TYPED_TEST(BatchTest, EigenMatricesOfBatchesEqualMatricesOfScalars) {
  using B = TypeParam;
  using T = typename TestFixture::Scalar;
  softsim::Mat3<B> A, C;
  softsim::Vec3<B> v;
  for (int i = 0; i < 9; ++i) A(i) = this->random(-1, 1), C(i) = this->random(-1, 1);
  for (int i = 0; i < 3; ++i) v[i] = this->random(-1, 1);
  const softsim::Mat3<B> AC = A * C.transpose() + B(2) * softsim::Mat3<B>::Identity();
  const softsim::Vec3<B> Av = A * v;
  const B J = softsim::determinant(A), energy = v.dot(Av);
  // Sums of three products of numbers below 1 may be rounded in another order.
  const double tolerance = 10 * double(std::numeric_limits<T>::epsilon());
  for (int l = 0; l < TestFixture::N; ++l) {
    const auto at = [l](const B& b) { return lane(b, l); };
    const softsim::Mat3<T> a = A.unaryExpr(at), c = C.unaryExpr(at);
    const softsim::Vec3<T> u = v.unaryExpr(at);
    const softsim::Mat3<T> ac = a * c.transpose() + T(2) * softsim::Mat3<T>::Identity();
    for (int i = 0; i < 9; ++i) EXPECT_NEAR(lane(AC(i), l), ac(i), tolerance);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(lane(Av[i], l), (a * u)[i], tolerance);
    EXPECT_NEAR(lane(J, l), softsim::determinant(a), tolerance);
    EXPECT_NEAR(lane(energy, l), u.dot(a * u), tolerance);
  }
}

TEST(PlainScalar, IsABatchOfOneLane) {
  double x = 1;
  set_lane(x, 0, 2.5);
  EXPECT_EQ(lane(x, 0), 2.5);
  EXPECT_EQ(select(true, 1.0, 2.0), 1.0);
  EXPECT_EQ(select(false, 1.0f, 2.0f), 2.0f);
  static_assert(lane_count<double> == 1 && lane_count<Batch<float, 16>> == 16);
  static_assert(softsim::default_lanes<float> == 2 * softsim::default_lanes<double>);
}

}  // namespace batch_test
