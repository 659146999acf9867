// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/core/state.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace state_test {

using namespace softsim;
using Vec = Vector<double>;
using V = Vec3<double>;

struct Random {
  std::mt19937 engine{11};
  double operator()() { return 2 * static_cast<double>(engine()) / 4294967296.0 - 1; }
  V vector(double size) {
    const double x = (*this)(), y = (*this)(), z = (*this)();
    return size * V(x, y, z);
  }
};

// Two points, three frames.
Vec increment(Random& random, double translation, double rotation) {
  Vec d = Vec::Zero(block_stride * 8);
  for (std::ptrdiff_t b = 0; b < 8; ++b)
    block(d, b) = random.vector(b >= 2 && (b - 2) % 2 == 1 ? rotation : translation);
  return d;
}
State<double> anywhere(Random& random) {
  State<double> q(2, 3);
  retract(q, increment(random, 1, 1.5));
  return q;
}

TEST(State, HasTheBlocksOfPointsAndThenOfFrames) {
  State<double> q(2, 3);
  EXPECT_EQ(q.size(), block_stride * 8);
  EXPECT_EQ(q.points(), 2);
  EXPECT_EQ(q.frames(), 3);
  EXPECT_EQ(q.frame_block(1), 4);
  EXPECT_EQ(q.rotation(2), Mat3<double>::Identity());
  EXPECT_EQ(norm(q), 0);
  q.point(1) = V(1, 2, 2);
  q.translation(0) = V(0, 0, 4);
  q.quaternion(2) = quaternion_exponential(V(0, 0.5, 0));
  EXPECT_DOUBLE_EQ(norm(q), std::sqrt(9 + 16 + 0.25));
}

TEST(State, RetractAndDifferenceAreInverseAtEveryAngle) {
  Random random;
  for (const double angle : {1e-300, 1e-12, 1e-8, 1e-4, 0.1, 1.0, 1.8}) {
    const State<double> q = anywhere(random);
    const Vec d = increment(random, 1, angle);  // up to sqrt(3) times as much, below pi
    State<double> p = q;
    retract(p, d);
    Vec back;
    difference(q, p, back);
    for (std::ptrdiff_t b = 0; b < 8; ++b) {
      EXPECT_LT((block(back, b) - block(d, b)).norm(), 1e-15 * 20) << angle << " " << b;
      EXPECT_EQ(back[block_stride * b + 3], 0);
    }
    for (std::ptrdiff_t j = 0; j < 3; ++j) EXPECT_NEAR(p.quaternion(j).norm(), 1, 1e-15);
    // R exp([dr]x): from the side of the body
    const V r = block(d, 3);
    EXPECT_LT((p.rotation(0) - q.rotation(0) * rotation_exponential(r)).norm(), 1e-14);
  }
}

TEST(State, TinyRotationsKeepTheirDigits) {
  const V r(1e-12, -2e-12, 3e-12);
  State<double> q(0, 1), p(0, 1);
  Vec d = Vec::Zero(2 * block_stride), back;
  block(d, 1) = r;
  retract(p, d);
  difference(q, p, back);
  EXPECT_LT((block(back, 1) - r).norm(), 1e-15 * r.norm());
  EXPECT_LT((rotation_less_identity<double>(p.quaternion(0)) - skew(r)).norm(), 1e-11 * r.norm());
}

TEST(State, HalfATurnIsTheLargestDifference) {
  const double pi = std::acos(-1.0);
  for (const double angle : {pi - 1e-9, pi + 1e-9, 3 * pi / 2}) {
    State<double> q(0, 1), p(0, 1);
    Vec d = Vec::Zero(2 * block_stride), back;
    block(d, 1) = V(0, angle, 0);
    retract(p, d);
    difference(q, p, back);
    EXPECT_NEAR(block(back, 1)[1], angle < pi ? angle : angle - 2 * pi, 1e-14);
  }
}

// retract(q, u + h w) = retract(retract(q, u), h dexp(u) w) to first order.
TEST(State, DexpIsTheDerivativeOfTheIncrement) {
  Random random;
  for (const double angle : {1e-6, 1e-3, 0.1, 1.0, 1.7}) {
    const State<double> q = anywhere(random);
    const Vec u = increment(random, 1, angle), w = increment(random, 1, 1);
    const double h = 1e-5;
    State<double> ahead = q, behind = q;
    retract<double>(ahead, u + h * w);
    retract<double>(behind, u - h * w);
    Vec change;
    difference(behind, ahead, change);
    change /= 2 * h;
    Vec exact = w;
    dexp(q, u, exact);
    EXPECT_LT((change - exact).norm(), 1e-9 * w.norm()) << angle;
    Vec back = exact;
    dexp_inv(q, u, back);
    EXPECT_LT((back - w).norm(), 1e-13 * w.norm()) << angle;
    // transposes: v . J w = w . J^T v
    const Vec v = increment(random, 1, 1);
    Vec turned = v, turned_back = v, inverse = w;
    dexp_transposed(q, u, turned);
    EXPECT_NEAR(v.dot(exact), w.dot(turned), 1e-13 * v.norm() * w.norm());
    dexp_inv_transposed(q, u, turned_back);
    dexp_inv(q, u, inverse);
    EXPECT_NEAR(v.dot(inverse), w.dot(turned_back), 1e-13 * v.norm() * w.norm());
  }
}

// A torque does work over an increment: over the same turn, seen from space, the same.
TEST(State, GivesTorquesInTheAxesOfSpace) {
  Random random;
  const State<double> q = anywhere(random);
  const Vec torque = increment(random, 1, 1);
  for (std::ptrdiff_t j = 0; j < 3; ++j) {
    const double h = 1e-6;
    Vec d = Vec::Zero(q.size());
    const V turn = random.vector(h);
    block(d, q.frame_block(j) + 1) = turn;
    State<double> p = q;
    retract(p, d);
    const Mat3<double> change = p.rotation(j) * q.rotation(j).transpose();
    const V seen(change(2, 1), change(0, 2), change(1, 0));  // to first order
    EXPECT_NEAR(q.in_space(torque, j).dot(seen), block(torque, q.frame_block(j) + 1).dot(turn), 3 * h * h);
    EXPECT_GT((q.in_space(torque, j) - block(torque, q.frame_block(j) + 1)).norm(), 0.1);
  }
}

TEST(State, SinglePrecisionToo) {
  State<float> q(1, 1);
  Vector<float> d = Vector<float>::Zero(q.size()), back;
  block(d, 0) = Vec3<float>(1, 2, 3);
  block(d, 2) = Vec3<float>(0.3f, -0.2f, 0.5f);
  State<float> p = q;
  retract(p, d);
  difference(q, p, back);
  EXPECT_LT((back - d).norm(), 1e-6f);
}

}  // namespace state_test
