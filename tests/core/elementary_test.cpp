// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/core/elementary.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace elementary_test {

using softsim::Batch, softsim::inverse_cbrt, softsim::lane, softsim::lane_count, softsim::log_and_inverse;

template <class B>
class Elementary : public ::testing::Test {
 public:
  using Scalar = decltype(lane(B{}, 0));

  /// Distance to `exact` in units of the last place.
  static double ulps(Scalar x, long double exact) {
    if (exact == 0) return x == 0 ? 0 : HUGE_VAL;
    const Scalar size = std::max(std::abs(static_cast<Scalar>(exact)), std::numeric_limits<Scalar>::min());
    return static_cast<double>(std::abs(static_cast<long double>(x) - exact) /
                               (static_cast<long double>(std::nextafter(size, HUGE_VALF)) - size));
  }
  /// Positive numbers near one, of everyday size and of every exponent, in every lane.
  B sample(int k) {
    std::uniform_real_distribution<double> uniform(-1, 1);
    B b;
    for (int l = 0; l < lane_count<B>; ++l) {
      const double limit = std::numeric_limits<Scalar>::max_exponent10 - 1;
      const double decades[] = {1e-4, 0.2, 3, limit};
      softsim::set_lane(b, l, static_cast<Scalar>(std::pow(10.0, decades[k % 4] * uniform(generator_))));
    }
    return b;
  }

 private:
  std::mt19937 generator_{8};
};
using Batches = ::testing::Types<Batch<double, 2>, Batch<double, 4>, Batch<double, 8>, Batch<float, 4>,
                                 Batch<float, 8>, Batch<float, 16>>;
TYPED_TEST_SUITE(Elementary, Batches);

TYPED_TEST(Elementary, AreRightToTheLastPlaces) {
  using B = TypeParam;
  using T = typename TestFixture::Scalar;
  double worst_log = 0, worst_log1p = 0, worst_inverse = 0, worst_root = 0;
  for (int k = 0; k < 20000; ++k) {
    const B x = this->sample(k), y = x - B(1);
    const B l = log(x), l1 = log1p(y), r = inverse_cbrt(x);
    const auto both = log_and_inverse(x);
    for (int i = 0; i < lane_count<B>; ++i) {
      const long double exact = lane(x, i);
      worst_log = std::max({worst_log, this->ulps(lane(l, i), std::log(exact)),
                            this->ulps(lane(both.log, i), std::log(exact))});
      if (lane(y, i) > T(-1))
        worst_log1p = std::max(worst_log1p, this->ulps(lane(l1, i), std::log1p(static_cast<long double>(lane(y, i)))));
      worst_inverse = std::max(worst_inverse, this->ulps(lane(both.inverse, i), 1 / exact));
      worst_root = std::max(worst_root, this->ulps(lane(r, i), 1 / std::cbrt(exact)));
    }
  }
  EXPECT_LT(worst_log, 1.1);
  EXPECT_LT(worst_log1p, 1.6);
  EXPECT_LT(worst_inverse, 2.6);
  EXPECT_LT(worst_root, 2.6);
}

TYPED_TEST(Elementary, TreatTheEdgesOfTheirDomainsAsTheScalarsDo) {
  using B = TypeParam;
  using T = typename TestFixture::Scalar;
  using Limits = std::numeric_limits<T>;
  const T infinity = Limits::infinity();
  const auto log_of = [](T x) { return lane(log(B(x)), 1); };
  EXPECT_EQ(log_of(0), -infinity);
  EXPECT_EQ(log_of(infinity), infinity);
  EXPECT_EQ(log_of(1), 0);
  EXPECT_TRUE(std::isnan(log_of(-1)));
  EXPECT_TRUE(std::isnan(log_of(-infinity)));
  EXPECT_TRUE(std::isnan(log_of(Limits::quiet_NaN())));
  for (const T x : {Limits::denorm_min(), Limits::min() / 4, Limits::min(), Limits::max()}) {
    EXPECT_LT(this->ulps(log_of(x), std::log(static_cast<long double>(x))), 1.1) << x;
    EXPECT_LT(this->ulps(lane(inverse_cbrt(B(x)), 1), 1 / std::cbrt(static_cast<long double>(x))), 2.6) << x;
    EXPECT_EQ(lane(log_and_inverse(B(x)).log, 1), log_of(x)) << x;
  }
  for (const T x : {T(0), T(-1), infinity, -infinity, Limits::quiet_NaN(), Limits::max(), Limits::denorm_min()}) {
    const T expected = T(1) / x, found = lane(log_and_inverse(B(x)).inverse, 1);
    if (std::isnan(expected))
      EXPECT_TRUE(std::isnan(found));
    else if (std::isinf(expected) || expected == 0)
      EXPECT_EQ(found, expected) << x;
    else
      EXPECT_LT(this->ulps(found, 1 / static_cast<long double>(x)), 2.6) << x;
  }
  EXPECT_EQ(lane(log1p(B(-1)), 1), -infinity);
  EXPECT_EQ(lane(log1p(B(infinity)), 1), infinity);
  EXPECT_TRUE(std::isnan(lane(log1p(B(-2)), 1)));
  EXPECT_EQ(lane(inverse_cbrt(B(0)), 1), infinity);
  EXPECT_EQ(lane(inverse_cbrt(B(infinity)), 1), 0);
  EXPECT_TRUE(std::isnan(lane(inverse_cbrt(B(-8)), 1)));
}

// One lane that is not positive and normal among ordinary ones changes none of their bits.
TYPED_TEST(Elementary, KeepTheBitsOfOrdinaryLanesBesideOthers) {
  using B = TypeParam;
  using T = typename TestFixture::Scalar;
  using Limits = std::numeric_limits<T>;
  const T beyond = 1 / Limits::min(), infinity = Limits::infinity();
  const B ordinary = this->sample(2);
  const auto alone = log_and_inverse(ordinary);
  for (const T x : {T(0), T(-1), infinity, Limits::quiet_NaN(), Limits::min(), Limits::min() / 2, Limits::max(),
                    beyond, std::nextafter(beyond, T(0)), std::nextafter(beyond, infinity)}) {
    for (int odd = 0; odd < lane_count<B>; ++odd) {
      B mixed = ordinary;
      softsim::set_lane(mixed, odd, x);
      const auto both = log_and_inverse(mixed);
      for (int l = 0; l < lane_count<B>; ++l) {
        if (l == odd) continue;
        EXPECT_EQ(lane(both.log, l), lane(alone.log, l)) << x;
        EXPECT_EQ(lane(both.inverse, l), lane(alone.inverse, l)) << x;
      }
      if (!(x > 0 && x < infinity)) {
        EXPECT_FALSE(std::isfinite(lane(both.log, odd))) << x;
        continue;
      }
      EXPECT_LT(this->ulps(lane(both.log, odd), std::log(static_cast<long double>(x))), 1.1) << x;
      const long double inverse = 1 / static_cast<long double>(x);
      if (inverse < static_cast<long double>(Limits::max())) {
        EXPECT_LT(this->ulps(lane(both.inverse, odd), inverse), 2.6) << x;
      }
    }
  }
}

TEST(ElementaryScalars, AreThoseOfTheStandardLibrary) {
  EXPECT_EQ(inverse_cbrt(8.0), 0.5);
  EXPECT_TRUE(std::isnan(inverse_cbrt(-8.0)));
  EXPECT_EQ(log_and_inverse(4.0).log, std::log(4.0));
  EXPECT_EQ(log_and_inverse(4.0).inverse, 0.25);
}

}  // namespace elementary_test
