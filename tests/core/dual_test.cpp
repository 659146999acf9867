// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/core/dual.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "softsim/core/tensor.hpp"

namespace dual_test {

using softsim::Batch, softsim::Dual, softsim::lane, softsim::select;
using D = Dual<double, 2>;
using Second = Dual<Dual<double, 1>, 1>;

// Every function a law may use, of two variables, smooth around the points below.
struct Everything {
  template <class T>
  T operator()(const T& x, const T& y) const {
    using softsim::inverse_cbrt;
    using std::sqrt, std::log, std::log1p, std::exp, std::expm1, std::pow, std::abs, std::min, std::max;
    T z = sqrt(x * y) + log(x) / y - log1p(x * x) + exp(T(-0.5) * x) * expm1(y / T(3));
    z += pow(x, 1.7) - inverse_cbrt(y + x);
    z -= abs(T(1) - x * y) * max(x, T(0.1)) + min(y, x + T(20)) * T(2);
    z *= y + 0.25 - -x;
    z /= 1 + x * x;
    return select(x > y, z, z * x);
  }
};

constexpr double points[][2] = {{1.3, 2.1}, {0.4, 0.7}, {3, 1.9}};

TEST(Dual, FirstDerivativesAreThoseOfDifferences) {
  const Everything f;
  for (const auto& [x, y] : points) {
    const D z = f(D::variable(x, 0), D::variable(y, 1));
    // cbrt(eps): truncation and rounding both about 1e-10 of terms of size 10
    const double h = 6e-6;
    EXPECT_NEAR(z.value, f(x, y), 1e-14);
    EXPECT_NEAR(z.derivative[0], (f(x + h, y) - f(x - h, y)) / (2 * h), 3e-9);
    EXPECT_NEAR(z.derivative[1], (f(x, y + h) - f(x, y - h)) / (2 * h), 3e-9);
  }
}

TEST(Dual, OfDualsGivesSecondDerivatives) {
  const Everything f;
  using DD = Dual<D, 2>;
  for (const auto& [x, y] : points) {
    const DD z = f(DD::variable(D::variable(x, 0), 0), DD::variable(D::variable(y, 1), 1));
    const auto first = [&](double a, double b) { return f(D::variable(a, 0), D::variable(b, 1)).derivative; };
    const double h = 6e-6;
    for (std::size_t i = 0; i < 2; ++i) {
      const double slope = first(x, y)[i];
      EXPECT_NEAR(z.derivative[i].value, slope, 1e-14 * std::abs(slope));  // fused multiply-adds may differ
      EXPECT_NEAR(z.derivative[i].derivative[0], (first(x + h, y)[i] - first(x - h, y)[i]) / (2 * h), 3e-9);
      EXPECT_NEAR(z.derivative[i].derivative[1], (first(x, y + h)[i] - first(x, y - h)[i]) / (2 * h), 3e-9);
    }
  }
}

TEST(Dual, OfABatchIsTheScalarInEveryLane) {
  using B = Batch<double, 4>;
  using DB = Dual<B, 2>;
  const Everything f;
  B x(1), y(1);
  for (int l = 0; l < 3; ++l) {
    softsim::set_lane(x, l, points[l][0]);
    softsim::set_lane(y, l, points[l][1]);
  }
  const DB z = f(DB::variable(x, 0), DB::variable(y, 1));
  for (int l = 0; l < 3; ++l) {
    const D s = f(D::variable(points[l][0], 0), D::variable(points[l][1], 1));
    EXPECT_NEAR(lane(z.value, l), s.value, 1e-13);
    for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(lane(z.derivative[i], l), s.derivative[i], 1e-13);
  }
}

TEST(Dual, DecidesByTheValueAndDifferentiatesTheBranchTaken) {
  const D a(1, {5, 0}), b(1, {0, 5}), c(2, {1, 1});
  EXPECT_TRUE(a == b && a <= b && a >= b && a < c && c > a && a != c);
  EXPECT_EQ(select(a < c, a, c).derivative[0], 5);
  EXPECT_EQ(select(a > c, a, c).derivative[0], 1);
  EXPECT_EQ(max(a, c).derivative[0], 1);
  EXPECT_EQ(min(a, c).derivative[0], 5);
  EXPECT_EQ(abs(-c).derivative[0], 1);
  // Macaulay's bracket squared, the switch of a fibre: x^2 for x > 0
  for (const double x : {-0.5, 0.5}) {
    const Second s = Second::variable(Dual<double, 1>::variable(x, 0), 0), m = max(s, Second(0)), w = m * m;
    EXPECT_EQ(w.derivative[0].value, x > 0 ? 2 * x : 0);
    EXPECT_EQ(w.derivative[0].derivative[0], x > 0 ? 2 : 0);
  }
}

// What a user's energy writes with Eigen.
TEST(Dual, WorksInsideEigensMatrices) {
  using D9 = Dual<double, 9>;
  Eigen::Matrix3d F;
  F << 1.2, 0.1, -0.2, 0.05, 0.9, 0.3, 0.1, -0.15, 1.1;
  softsim::Mat3<D9> X;
  for (int i = 0; i < 9; ++i) X(i) = D9::variable(F(i), i);
  const D9 det = X.determinant(), squares = X.squaredNorm(), tr = (X.transpose() * X).trace(),
           norm = X.norm();
  const softsim::Mat3<D9> inverse = X.inverse();
  const Eigen::Matrix3d cof = softsim::cofactor<double>(F), back = F.inverse();
  for (int i = 0; i < 9; ++i) {
    const auto k = static_cast<std::size_t>(i);
    EXPECT_NEAR(det.derivative[k], cof(i), 1e-14);
    EXPECT_NEAR(squares.derivative[k], 2 * F(i), 1e-14);
    EXPECT_NEAR(tr.derivative[k], 2 * F(i), 1e-14);
    EXPECT_NEAR(norm.derivative[k], F(i) / F.norm(), 1e-14);
    // d(F^-1) = -F^-1 dF F^-1
    const Eigen::Matrix3d expected = -back.col(i % 3) * back.row(i / 3);
    for (int j = 0; j < 9; ++j) EXPECT_NEAR(inverse(j).derivative[k], expected(j), 1e-14);
  }
}

TEST(BatchExpm1, KeepsItsDigitsAndItsLimits) {
  using B = Batch<double, 4>;
  for (const double x : {-745.0, -30.0, -1.0, -1e-3, -1e-9, -1e-300, 1e-17, 1e-12, 3e-5, 0.2, 2.5, 700.0}) {
    const double y = lane(expm1(B(x)), 1);
    EXPECT_NEAR(y / std::expm1(x), 1, 2e-15) << x;
  }
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(lane(expm1(B(0)), 0), 0);
  EXPECT_EQ(lane(expm1(B(-infinity)), 0), -1);
  EXPECT_EQ(lane(expm1(B(800)), 0), infinity);
  EXPECT_TRUE(std::isnan(lane(expm1(B(std::nan(""))), 0)));
  EXPECT_NEAR(lane(expm1(Batch<float, 8>(1e-4F)), 3) / std::expm1(1e-4F), 1, 5e-7);
}

}  // namespace dual_test
