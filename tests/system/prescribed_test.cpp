// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/system/prescribed.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "potential/bodies.hpp"

namespace prescribed_test {

using bodies::Vec, bodies::refusal;
using softsim::Prescribed, softsim::State, softsim::Vector, softsim::block;

TEST(Prescribed, HoldsNothingAtFirst) {
  const Prescribed<double> prescribed(3);
  const Eigen::Vector4d open(1, 1, 1, 0);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(prescribed.free().segment<4>(4 * i), open);
  EXPECT_FALSE(prescribed.contains(0, 0));
  Vector<double> d(12);
  EXPECT_EQ(prescribed.increment(bodies::random_state(3, 1, 1), d), 0);
  EXPECT_EQ(d.norm(), 0);
}

TEST(Prescribed, HoldsSingleComponents) {
  Prescribed<double> prescribed(3);
  prescribed.set(1, 2, 0.25);
  EXPECT_TRUE(prescribed.contains(1, 2));
  EXPECT_FALSE(prescribed.contains(1, 0));
  EXPECT_FALSE(prescribed.contains(2, 2));
  EXPECT_EQ(prescribed.target()[6], 0.25);
}

TEST(Prescribed, FixesSetsMovesAndReleasesPoints) {
  Prescribed<double> prescribed(4);
  prescribed.fix({0, 3});
  prescribed.set(3, Vec(1, 2, 3));
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_TRUE(prescribed.contains(0, axis));
    EXPECT_TRUE(prescribed.contains(3, axis));
    EXPECT_FALSE(prescribed.contains(1, axis));
  }
  EXPECT_EQ(Vec(block(prescribed.target(), 0)), Vec(0, 0, 0));
  EXPECT_EQ(Vec(block(prescribed.target(), 3)), Vec(1, 2, 3));
  prescribed.set(3, Vec(4, 5, 6));
  EXPECT_EQ(Vec(block(prescribed.target(), 3)), Vec(4, 5, 6));
  prescribed.release(3);
  EXPECT_FALSE(prescribed.contains(3, 0) || prescribed.contains(3, 1) || prescribed.contains(3, 2));
  EXPECT_TRUE(prescribed.contains(0, 1));
}

TEST(Prescribed, MasksItsComponentsAndThePadding) {
  Prescribed<double> prescribed(3);
  prescribed.fix({0});
  prescribed.set(2, 1, 5);
  Vector<double> v = Vector<double>::Constant(12, 7);
  prescribed.mask(v);
  Vector<double> expected(12);
  expected << 0, 0, 0, 0, 7, 7, 7, 0, 7, 0, 7, 0;
  EXPECT_EQ(v, expected);
}

TEST(Prescribed, SaysHowFarItsComponentsHaveToGo) {
  Prescribed<double> prescribed(3);
  prescribed.fix({0});
  prescribed.set(2, 1, -5);
  const State<double> q = bodies::random_state(3, 1, 2);
  Vector<double> d = Vector<double>::Constant(12, 99), expected = Vector<double>::Zero(12);
  block(expected, 0) = -q.point(0);
  block(expected, 2)[1] = -5 - q.point(2)[1];
  EXPECT_EQ(prescribed.increment(q, d), expected.cwiseAbs().maxCoeff());
  EXPECT_EQ(d, expected);
}

TEST(Prescribed, RefusesPointsAxesAndValuesThatAreNotThere) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  Prescribed<double> prescribed(3);
  const auto said = [&](auto... arguments) {
    return refusal([&] { return prescribed.set(arguments...), 0; });
  };
  EXPECT_EQ(said(3, Vec(0, 0, 0)), "prescribed node 3: out of range");
  EXPECT_EQ(said(-1, 0, 0.0), "prescribed node -1: out of range");
  EXPECT_EQ(said(1, 3, 0.0), "axis 3: must be 0, 1 or 2");
  EXPECT_EQ(said(1, -1, 0.0), "axis -1: must be 0, 1 or 2");
  EXPECT_EQ(said(2, 1, nan), "node 2: prescribed displacement is not finite");
  EXPECT_EQ(said(2, Vec(0, -inf, 0)), "node 2: prescribed displacement is not finite");
  EXPECT_EQ(refusal([&] { return prescribed.fix({0, 5}), 0; }), "prescribed node 5: out of range");
  EXPECT_EQ(refusal([&] { return prescribed.release(9), 0; }), "prescribed node 9: out of range");
  EXPECT_EQ(refusal([&] { return prescribed.contains(9, 0); }), "prescribed node 9: out of range");
}

}  // namespace prescribed_test
