// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/kinematics/polyline_shapes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "kinematics/node_shape_checks.hpp"
#include "softsim/kinematics/frame_sample.hpp"
#include "softsim/kinematics/linked_shapes.hpp"
#include "softsim/kinematics/shepard.hpp"

namespace polyline_shapes_test {

using namespace node_shape_checks;
using softsim::LinkedShapes, softsim::Mat3, softsim::PolylineShapes, softsim::ShapeValues, softsim::Shepard;

static_assert(softsim::NodeShapes<PolylineShapes> && softsim::NodeShapes<LinkedShapes<Shepard<>>>);

// A corner of a right angle, then a slanted segment out of the plane.
const std::vector<Vec> bent{Vec(0, 0, 0), Vec(2, 0, 0), Vec(2, 1, 0), Vec(3, 2, 2)};

TEST(PolylineShapes, AreLinearAlongTheLine) {
  const PolylineShapes shapes(bent);
  for (std::size_t i = 0; i + 1 < bent.size(); ++i)
    for (const double s : {0.25, 0.5, 0.9}) {
      const Vec x = bent[i] + s * (bent[i + 1] - bent[i]);
      const ShapeValues at = shapes.at(x);
      expect_partition_of_unity(at, 1e-15);
      ASSERT_EQ(at.nodes.size(), 2u);
      EXPECT_EQ(at.nodes[0], static_cast<int>(i));
      EXPECT_NEAR(at.values[1], s, 1e-15);
      const auto field = [](const Vec& p) { return p[0] - 2 * p[2]; };
      EXPECT_NEAR(interpolated(shapes, x, field), field(x), 1e-14);
    }
  for (std::size_t i = 0; i < bent.size(); ++i) {
    const ShapeValues at = shapes.at(bent[i]);
    EXPECT_EQ(at.nodes, std::vector<std::int32_t>{static_cast<std::int32_t>(i)});
    EXPECT_EQ(at.values, std::vector<double>{1});
  }
}

// Off the line too, where a point follows its projection: the sections are rigid.
TEST(PolylineShapes, GradientsAreDerivatives) {
  const PolylineShapes shapes(bent);
  for (const Vec& x : {Vec(0.7, 0.2, -0.3), Vec(1.2, -0.4, 0.1), Vec(1.9, 0.6, 0.2), Vec(2.6, 1.4, 1.1)}) {
    expect_gradients_are_derivatives(shapes, x, 1e-5, 1e-9);
    EXPECT_NEAR(value(shapes, x, 0) + value(shapes, x, 1) + value(shapes, x, 2) + value(shapes, x, 3), 1,
                1e-15);
  }
  EXPECT_EQ(value(shapes, Vec(0.7, 0.2, -0.3), 1), 0.35);
}

TEST(PolylineShapes, AreConstantBeyondTheEndsAndOutsideBends) {
  const PolylineShapes shapes(bent);
  for (const auto& [x, node] :
       {std::pair{Vec(-1, 0.3, 0.2), 0}, {Vec(5, 3, 4), 3}, {Vec(2.5, -0.5, 0.1), 1}}) {
    const ShapeValues at = shapes.at(x);
    EXPECT_EQ(at.nodes, std::vector<std::int32_t>{node});
    EXPECT_EQ(at.gradients[0], Vec::Zero().eval());
  }
}

TEST(PolylineShapes, RefuseWhatIsNoLine) {
  expect_refused([] { PolylineShapes({Vec(0, 0, 0)}); }, "curve: 1 points, must be at least 2");
  expect_refused(
      [] {
        PolylineShapes({Vec(0, 0, 0), Vec(1, 0, 0), Vec(1, 0, 0)});
      },
      "curve: segment 1 has no length");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  expect_refused([&] { (void)PolylineShapes(bent).at(Vec(nan, 0, 0)); },
                 "point (nan, 0, 0): a coordinate is not a finite number");
}

// x = sum w_i x_i + R_i c_i of frames at rest: position, gradient and its derivative.
template <class Shapes>
void expect_rest_is_reproduced(const Shapes& shapes, const Vec& x) {
  const auto sum = [&](const Vec& at) {
    const ShapeValues s = shapes.at(at);
    Vec position = Vec::Zero();
    for (std::size_t i = 0; i < s.nodes.size(); ++i)
      position += s.values[i] * shapes.nodes()[static_cast<std::size_t>(s.nodes[i])] + s.slopes[i];
    return position;
  };
  EXPECT_LT((sum(x) - x).norm(), 1e-14);
  const ShapeValues s = shapes.at(x);
  const double h = 1e-5;
  for (std::size_t i = 0; i < s.nodes.size(); ++i)
    for (int axis = 0; axis < 3; ++axis) {
      const Vec step = h * Vec::Unit(axis);
      const Vec slope = (shapes.at(x + step).slopes[i] - shapes.at(x - step).slopes[i]) / (2 * h);
      EXPECT_LT((s.slope_gradients[i].col(axis) - slope).norm(), 1e-8) << i;
    }
}

TEST(LinkedShapes, ReproduceFramesAtRest) {
  const LinkedShapes line{PolylineShapes(bent)};
  for (const Vec& x : {Vec(0.7, 0.2, -0.3), Vec(1.9, 0.6, 0.2), Vec(2.6, 1.4, 1.1)})
    expect_rest_is_reproduced(line, x);
  const LinkedShapes<Shepard<>> scattered{Shepard<>(random_points(7, 3))};
  for (const Vec& x : random_points(5, 4)) expect_rest_is_reproduced(scattered, x);
}

// On a line a quadratic field comes back from its values and gradients at the nodes.
TEST(LinkedShapes, ReproduceQuadraticFieldsOnALine) {
  const LinkedShapes shapes{PolylineShapes({Vec(0, 0, 0), Vec(1, 2, 2), Vec(2, 4, 4)})};
  const auto field = [](const Vec& p) { return 1 + p[0] - 3 * p[1] * p[2] + p[0] * p[0]; };
  const auto gradient = [](const Vec& p) { return Vec(1 + 2 * p[0], -3 * p[2], -3 * p[1]); };
  for (const double s : {0.1, 0.7, 1.3}) {
    const Vec x = s * Vec(1, 2, 2);
    const ShapeValues at = shapes.at(x);
    double sum = 0;
    for (std::size_t i = 0; i < at.nodes.size(); ++i) {
      const Vec& p = shapes.nodes()[static_cast<std::size_t>(at.nodes[i])];
      sum += at.values[i] * field(p) + at.slopes[i].dot(gradient(p));
    }
    EXPECT_NEAR(sum, field(x), 1e-13);
  }
}

// Two frames on a rod that bends by the angle theta: the shear strain of `PolylineShapes`' docstring, of the
// second order in theta, and none of it with half the arm.
TEST(LinkedShapes, BendWithoutShear) {
  const double h = 0.5, theta = 1e-4;
  const std::vector<Vec> nodes{Vec(0, 0, 0), Vec(h, 0, 0)};
  const auto shear = [&](const auto& shapes, double s) {
    const Vec X(s * h, 0, 0);
    const ShapeValues at = shapes.at(X);
    Mat3<double> F = Mat3<double>::Zero();
    for (std::size_t i = 0; i < 2; ++i) {
      const double angle = i == 0 ? -theta / 2 : theta / 2;  // the chord does not turn
      const Mat3<double> R = softsim::rotation_exponential<double>(Vec(0, 0, angle));
      const Vec g = at.gradients[i];
      F += nodes[i] * g.transpose();
      if (at.slopes.empty())
        F += R * ((X - nodes[i]) * g.transpose() + at.values[i] * Mat3<double>::Identity());
      else
        F += R * at.slope_gradients[i];
    }
    return (F.transpose() * F)(0, 1);
  };
  for (const double s : {0.1, 0.25, 0.5, 0.8}) {
    EXPECT_NEAR(shear(PolylineShapes(nodes), s), -(0.5 - s) * theta, 1e-3 * theta * theta);
    EXPECT_NEAR(shear(LinkedShapes(PolylineShapes(nodes)), s), 0, 1e-3 * theta * theta);
  }
}

}  // namespace polyline_shapes_test
