// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
// The rows of Table 4.1 of Bosman 2015 (and moving least squares with gradients), checked.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "kinematics/scattered_nodes.hpp"
#include "softsim/kinematics/gaussian.hpp"
#include "softsim/kinematics/generalised_moving_least_squares.hpp"
#include "softsim/kinematics/interpolating_moving_least_squares.hpp"
#include "softsim/kinematics/moving_least_squares.hpp"
#include "softsim/kinematics/node_shapes.hpp"
#include "softsim/kinematics/shepard.hpp"
#include "softsim/mesh/point_grid.hpp"

namespace scattered_shapes_test {

using namespace scattered_nodes;
using softsim::NodeShapes, softsim::Shepard, softsim::Gaussian, softsim::MovingLeastSquares,
    softsim::InterpolatingMovingLeastSquares, softsim::GeneralisedMovingLeastSquares;

constexpr double infinity = std::numeric_limits<double>::infinity();

static_assert(NodeShapes<Shepard<>>);
static_assert(NodeShapes<Gaussian<>>);
static_assert(NodeShapes<MovingLeastSquares<>>);
static_assert(NodeShapes<InterpolatingMovingLeastSquares<>>);
static_assert(NodeShapes<GeneralisedMovingLeastSquares<>>);
static_assert(!NodeShapes<softsim::PointGrid>);
static_assert(!NodeShapes<softsim::Neighbourhood<>>);

// One row of the table: how they are made, and what they promise. `any_arrangement`: collinear and coplanar
// nodes are welcome.
template <int power, bool compact>
struct InverseDistance {
  static constexpr int order = 0;
  static constexpr bool interpolates = true, any_arrangement = true;
  static constexpr double radius = compact ? 0.6 : infinity;
  static auto make(const std::vector<Vec>& nodes, std::size_t nearest = 0) {
    return Shepard(nodes, {.power = power, .radius = radius, .nearest = nearest});
  }
};
template <bool compact>
struct RadialBasis {
  static constexpr int order = 0;
  static constexpr bool interpolates = false, any_arrangement = true;
  static constexpr double radius = compact ? 0.6 : infinity;
  static auto make(const std::vector<Vec>& nodes, std::size_t nearest = 0) {
    return Gaussian(nodes, {.width = 0.2, .radius = radius, .nearest = nearest});
  }
};
template <int n, bool compact = true>
struct LeastSquares {
  static constexpr int order = n;
  static constexpr bool interpolates = false, any_arrangement = n == 0;
  static constexpr double radius = compact ? 0.75 : infinity;
  static auto make(const std::vector<Vec>& nodes, std::size_t nearest = 0) {
    return MovingLeastSquares(nodes, {.order = n, .radius = radius, .nearest = nearest});
  }
};
template <int n, int power = 2, bool compact = true>
struct Interpolating {
  static constexpr int order = n;
  static constexpr bool interpolates = true, any_arrangement = n == 0;
  static constexpr double radius = compact ? 0.75 : infinity;
  static auto make(const std::vector<Vec>& nodes, std::size_t nearest = 0) {
    return InterpolatingMovingLeastSquares(
        nodes, {.order = n, .power = power, .radius = radius, .nearest = nearest});
  }
};
template <int n>
struct Generalised {
  static constexpr int order = n;
  static constexpr bool interpolates = false, any_arrangement = n == 1;
  static constexpr double radius = 0.6;
  static auto make(const std::vector<Vec>& nodes, std::size_t nearest = 0) {
    return GeneralisedMovingLeastSquares(nodes,
                                         {.order = n, .radius = radius, .length = 0.25, .nearest = nearest});
  }
};

template <class Case>
class ScatteredShapes : public testing::Test {
 protected:
  const std::vector<Vec> cube = in_a_cube();
};
using Cases = testing::Types<InverseDistance<2, false>, InverseDistance<3, false>, InverseDistance<2, true>,
                             InverseDistance<4, true>, RadialBasis<false>, RadialBasis<true>, LeastSquares<0>,
                             LeastSquares<1>, LeastSquares<2>, LeastSquares<2, false>, Interpolating<0>,
                             Interpolating<1>, Interpolating<2>, Interpolating<1, 4>,
                             Interpolating<2, 3, false>, Generalised<1>, Generalised<2>>;
TYPED_TEST_SUITE(ScatteredShapes, Cases);

TYPED_TEST(ScatteredShapes, SayWhatTheyAre) {
  const auto shapes = TypeParam::make(this->cube);
  EXPECT_EQ(shapes.nodes(), this->cube);
  EXPECT_EQ(shapes.consistency(), TypeParam::order);
  EXPECT_EQ(shapes.interpolates(), TypeParam::interpolates);
  EXPECT_EQ(shapes.support(), TypeParam::radius);
}

TYPED_TEST(ScatteredShapes, ListAscendingNodesWithinTheRadius) {
  const auto shapes = TypeParam::make(this->cube);
  for (const Vec& x : places_in_a_cube(20)) {
    const ShapeValues at = shapes.at(x);
    std::vector<std::int32_t> expected;
    for (std::size_t i = 0; i < this->cube.size(); ++i)
      if ((x - this->cube[i]).norm() < TypeParam::radius) expected.push_back(static_cast<std::int32_t>(i));
    EXPECT_EQ(at.nodes, expected);
    EXPECT_EQ(at.values.size(), at.nodes.size());
    EXPECT_EQ(at.gradients.size(), at.nodes.size());
    EXPECT_EQ(at.slopes.size(), at.slope_gradients.size());
  }
}

TYPED_TEST(ScatteredShapes, ArePartitionsOfUnity) {
  const auto shapes = TypeParam::make(this->cube);
  for (const Vec& x : places_in_a_cube(50)) {
    const ShapeValues at = shapes.at(x);
    double sum = 0;
    Vec gradients = Vec::Zero();
    for (std::size_t a = 0; a < at.nodes.size(); ++a) {
      sum += at.values[a];
      gradients += at.gradients[a];
    }
    EXPECT_NEAR(sum, 1, 1e-12);
    EXPECT_LT(gradients.norm(), 1e-10);  // they are of size 1 / 0.25 m and more
  }
}

TYPED_TEST(ScatteredShapes, GradientsAreThoseOfTheValues) {
  const auto shapes = TypeParam::make(this->cube);
  // h^2 times third derivatives of up to 1e5, a fraction of the nodal distance cubed, and 1e-15 / h
  for (const Vec& x : places_in_a_cube(50)) EXPECT_LT(gradient_error(shapes, x, 1e-6), 2e-7) << x.transpose();
}

TYPED_TEST(ScatteredShapes, ReproducePolynomialsUpToTheOrderAndNotBeyond) {
  const auto shapes = TypeParam::make(this->cube);
  double beyond = 0;
  for (const Vec& x : places_in_a_cube(30)) {
    const ShapeValues at = shapes.at(x);
    for (int degree = 0; degree <= TypeParam::order + 1; ++degree)
      for (const Monomial& u : monomials(degree)) {
        const Interpolated field = interpolated(at, this->cube, u);
        if (degree > TypeParam::order) {
          beyond = std::max(beyond, std::abs(field.value - u.value(x)));
          continue;
        }
        EXPECT_NEAR(field.value, u.value(x), 1e-12);
        EXPECT_LT((field.gradient - u.gradient(x)).norm(), 1e-10);
      }
  }
  EXPECT_GT(beyond, 1e-3);
}

TYPED_TEST(ScatteredShapes, HaveTheKroneckerPropertyOrNot) {
  const auto shapes = TypeParam::make(this->cube);
  for (std::size_t j = 0; j < this->cube.size(); ++j) {
    const Eigen::VectorXd values = all_values(shapes.at(this->cube[j]), this->cube.size())
                                       .head(static_cast<Eigen::Index>(this->cube.size()));
    const Eigen::VectorXd kronecker = Eigen::VectorXd::Unit(values.size(), static_cast<Eigen::Index>(j));
    if (TypeParam::interpolates) {
      EXPECT_EQ(values, kronecker) << j;
    } else {
      EXPECT_GT((values - kronecker).cwiseAbs().maxCoeff(), 0.01) << j;
    }
  }
}

TYPED_TEST(ScatteredShapes, AreSmoothAtTheNodes) {
  const auto shapes = TypeParam::make(this->cube);
  const std::size_t n = this->cube.size();
  for (const std::size_t j : {std::size_t{0}, std::size_t{31}, std::size_t{62}, std::size_t{124}}) {
    const Vec& X = this->cube[j];
    // those of power 3 have a second derivative that jumps, which costs 1e-6 times it
    EXPECT_LT(gradient_error(shapes, X, 1e-6), 1e-4);
    const Eigen::MatrixX3d at_node = all_gradients(shapes.at(X), n);
    const Vec aside = Vec(2, -1, 2) / 3;
    // second derivatives of Shepard's functions at a node are 2 sum 1/d_i^2, about 700 here
    for (const double d : {1e-3, 1e-4, 1e-6, 1e-9, 1e-12, 1e-100, 1e-158, 1e-170, 5e-324}) {
      const Vec x = X + d * aside;
      EXPECT_LT((all_gradients(shapes.at(x), n) - at_node).cwiseAbs().maxCoeff(), 1e-9 + 1000 * d)
          << j << ", " << d;
      if (d >= 1e-4) {
        EXPECT_LT(gradient_error(shapes, x, d / 100), 1e-4) << j << ", " << d;
      }
    }
  }
}

TYPED_TEST(ScatteredShapes, EndAtTheRadiusWithoutAJump) {
  const auto shapes = TypeParam::make(this->cube);
  if (TypeParam::radius == infinity) {
    EXPECT_EQ(shapes.at(Vec(3, 0, 0)).nodes.size(), this->cube.size());
    return;
  }
  const std::size_t n = this->cube.size();
  for (const std::size_t j : {std::size_t{0}, std::size_t{4}, std::size_t{24}}) {
    const Vec inward = (Vec(0.5, 0.5, 0.5) - this->cube[j]).normalized();
    const auto values = [&](double d) { return all_values(shapes.at(this->cube[j] + d * inward), n); };
    EXPECT_NE(values(0.9 * TypeParam::radius)[static_cast<Eigen::Index>(j)], 0);
    // over 2e-9 radii only slopes of up to 10/radius may show
    EXPECT_LT((values((1 - 1e-9) * TypeParam::radius) - values((1 + 1e-9) * TypeParam::radius))
                  .cwiseAbs()
                  .maxCoeff(),
              2e-8);
    EXPECT_EQ(values((1 + 1e-9) * TypeParam::radius)[static_cast<Eigen::Index>(j)], 0);
  }
}

TYPED_TEST(ScatteredShapes, UseNoMoreThanTheNearestIfAskedTo) {
  const auto shapes = TypeParam::make(this->cube, 17);
  const softsim::PointGrid grid(this->cube);
  for (const Vec& x : places_in_a_cube(20)) {
    const ShapeValues at = shapes.at(x);
    EXPECT_EQ(at.nodes, grid.nearest(x, 17));  // all within the radius here
    for (const Monomial& u : monomials(TypeParam::order)) {
      const Interpolated field = interpolated(at, this->cube, u);
      EXPECT_NEAR(field.value, u.value(x), 1e-11);
      EXPECT_LT((field.gradient - u.gradient(x)).norm(), 1e-9);
    }
    EXPECT_LT(gradient_error(shapes, x, 1e-6), 1e-6);
  }
}

TYPED_TEST(ScatteredShapes, DoNotDependOnOriginAndUnit) {
  const auto shapes = TypeParam::make(this->cube);
  const Vec shift(100, -300, 200);  // coordinates keep 13 digits after the point
  std::vector<Vec> shifted = this->cube;
  for (Vec& X : shifted) X += shift;
  const auto others = TypeParam::make(shifted);
  for (const Vec& x : places_in_a_cube(10)) {
    const ShapeValues a = shapes.at(x), b = others.at(x + shift);
    ASSERT_EQ(a.nodes, b.nodes);
    const std::size_t n = this->cube.size();
    EXPECT_LT((all_values(a, n) - all_values(b, n)).cwiseAbs().maxCoeff(), 1e-10);
    EXPECT_LT((all_gradients(a, n) - all_gradients(b, n)).cwiseAbs().maxCoeff(), 1e-8);
  }
}

TYPED_TEST(ScatteredShapes, TakeNodesInAPlaneAndOnALineOrSayWhyNot) {
  for (const bool line : {false, true}) {
    const std::vector<Vec> flat = line ? on_a_line() : in_a_plane();
    if constexpr (!TypeParam::any_arrangement) {
      const std::string message = refusal([&] { TypeParam::make(flat); });
      EXPECT_NE(
          message.find(std::string("moving least squares of order ") + std::to_string(TypeParam::order) +
                       ": the nodes (" + std::to_string(flat.size()) + " in all) are " +
                       (line ? "collinear" : "coplanar") + "; use "),
          std::string::npos)
          << message;
      EXPECT_NE(message.find("Shepard"), std::string::npos) << message;
    } else {
      const auto shapes = TypeParam::make(flat);
      for (const Vec& offset : {Vec(0, 0, 0), Vec(0.05, -0.03, 0.08)})
        for (std::size_t j = 0; j + 1 < flat.size(); j += 3) {
          const Vec x = 0.3 * flat[j] + 0.7 * flat[j + 1] + offset;
          if ((x - flat[j]).norm() > 0.5) continue;
          const ShapeValues at = shapes.at(x);
          for (int degree = 0; degree <= TypeParam::order; ++degree)
            for (const Monomial& u : monomials(degree)) {
              const Interpolated field = interpolated(at, flat, u);
              EXPECT_NEAR(field.value, u.value(x), 1e-12);
              EXPECT_LT((field.gradient - u.gradient(x)).norm(), 1e-11);
            }
          EXPECT_LT(gradient_error(shapes, x, 1e-6), 2e-7);
        }
    }
  }
}

TYPED_TEST(ScatteredShapes, RefuseNeighboursInAPlaneOrOnALineInTheSameWords) {
  if constexpr (!TypeParam::any_arrangement) {
    std::vector<Vec> nodes = on_a_line();  // 0.13 m apart
    for (const Vec& X : in_a_plane()) nodes.push_back(X + Vec(5, 0, 0));
    for (const Vec& X : in_a_cube()) nodes.push_back(X + Vec(0, 5, 0));
    if (TypeParam::radius == infinity) return;
    const auto shapes = TypeParam::make(nodes);
    for (const bool line : {true, false}) {
      const Vec x = line ? nodes[4] + Vec(0.01, 0, 0) : nodes[9 + 12] + Vec(0.01, 0, 0);
      const std::string message = refusal([&] { (void)shapes.at(x); });
      for (const std::string part :
           {"moving least squares of order ", " at (", "): the nodes near it (",
            line ? "are collinear" : "are coplanar", "; use a larger neighbourhood, ", "Shepard"})
        EXPECT_NE(message.find(part), std::string::npos) << part << " is not in " << message;
    }
    EXPECT_NO_THROW((void)shapes.at(Vec(0.5, 5.5, 0.5)));
  }
}

TYPED_TEST(ScatteredShapes, SayHowFarTheNearestNodeIs) {
  const auto shapes = TypeParam::make(this->cube);
  EXPECT_EQ(refusal([&] { (void)shapes.at(Vec(-6, -6, -7)); }),
            TypeParam::radius == infinity
                ? "nothing thrown"
                : "shape functions at (-6, -6, -7): no node is within the radius " +
                      softsim::to_text(TypeParam::radius) + " m, the nearest, node 0, is 11 m away");
}

TYPED_TEST(ScatteredShapes, RefuseWhatIsNoNodeOrPlace) {
  EXPECT_EQ(refusal([] { TypeParam::make({}); }), "shape functions: there are no nodes");
  std::vector<Vec> nodes = this->cube;
  nodes[3][1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(refusal([&] { TypeParam::make(nodes); }), "node 3: a coordinate is not a finite number");
  const auto shapes = TypeParam::make(this->cube);
  EXPECT_NE(refusal([&] { (void)shapes.at(Vec(infinity, 0, 0)); }).find("not a finite number"),
            std::string::npos);
}

TYPED_TEST(ScatteredShapes, TwoNodesAtOnePlaceAreRefusedWhereTheyWouldInterpolate) {
  std::vector<Vec> nodes = this->cube;
  nodes.push_back(nodes[30]);
  if (TypeParam::interpolates) {
    EXPECT_EQ(refusal([&] { TypeParam::make(nodes); }),
              "nodes 30 and 125 are at the same place: interpolating shape functions need distinct nodes");
  } else {
    const ShapeValues at = TypeParam::make(nodes).at(nodes[30] + Vec(0.1, 0, 0));
    const auto place = std::find(at.nodes.begin(), at.nodes.end(), 30) - at.nodes.begin();
    EXPECT_NEAR(at.values[static_cast<std::size_t>(place)], at.values.back(), 1e-13);
  }
}

}  // namespace scattered_shapes_test
