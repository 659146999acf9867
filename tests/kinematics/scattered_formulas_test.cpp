// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
// Scattered shape functions against their formulas as printed, closed forms, limits and refusals.
#include <gtest/gtest.h>

#include <Eigen/LU>
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
#include "softsim/kinematics/shepard.hpp"

namespace scattered_formulas_test {

using namespace scattered_nodes;
using softsim::Shepard, softsim::Gaussian, softsim::MovingLeastSquares,
    softsim::InterpolatingMovingLeastSquares, softsim::GeneralisedMovingLeastSquares;

constexpr double infinity = std::numeric_limits<double>::infinity();

// Eqs. 4.5-4.7 with p(x_i) p(x_i)^T: p(x)^T M^-1 w_i p(x_i), the moment matrix formed and inverted.
template <class Weight>
Eigen::VectorXd by_the_moment_matrix(int order, const std::vector<Vec>& nodes, const Vec& x, double radius,
                                     const Weight& weight) {
  const auto p = [&](const Vec& y) {
    Eigen::VectorXd basis(10);
    basis << 1, y[0], y[1], y[2], y[0] * y[0], y[0] * y[1], y[0] * y[2], y[1] * y[1], y[1] * y[2],
        y[2] * y[2];
    return Eigen::VectorXd(basis.head(order == 0 ? 1 : order == 1 ? 4 : 10));
  };
  const Eigen::Index terms = p(x).size();
  Eigen::MatrixXd M = Eigen::MatrixXd::Zero(terms, terms),
                  B = Eigen::MatrixXd::Zero(terms, static_cast<Eigen::Index>(nodes.size()));
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const double d = (x - nodes[i]).norm(), w = d < radius ? weight(d) : 0;
    M += w * p(nodes[i]) * p(nodes[i]).transpose();
    B.col(static_cast<Eigen::Index>(i)) = w * p(nodes[i]);
  }
  return B.transpose() * M.inverse() * p(x);
}

TEST(MovingLeastSquares, AreEquation45) {
  const std::vector<Vec> nodes = in_a_cube();
  constexpr double R = 0.75;
  const auto wendland = [](double d) { return std::pow(1 - d / R, 4) * (4 * d / R + 1); };
  const auto pole = [](double d) { return std::pow((R - d) / (R * d), 3); };
  for (const int order : {0, 1, 2}) {
    const MovingLeastSquares fitted(nodes, {.order = order, .radius = R});
    const InterpolatingMovingLeastSquares through(nodes, {.order = order, .power = 3, .radius = R});
    for (const Vec& x : places_in_a_cube(20)) {
      const auto n = static_cast<Eigen::Index>(nodes.size());
      EXPECT_LT((all_values(fitted.at(x), nodes.size()).head(n) -
                 by_the_moment_matrix(order, nodes, x, R, wendland))
                    .norm(),
                1e-9);
      EXPECT_LT(
          (all_values(through.at(x), nodes.size()).head(n) - by_the_moment_matrix(order, nodes, x, R, pole))
              .norm(),
          1e-9);
    }
  }
}

TEST(MovingLeastSquares, OfFourNodesAreBarycentricCoordinatesWhateverTheWeights) {
  const std::vector<Vec> corners{Vec(0, 0, 0), Vec(1, 0, 0), Vec(0, 2, 0), Vec(0, 0, 3)};
  const Vec x(0.2, 0.5, 0.6);
  const std::vector<double> expected{1 - 0.2 - 0.25 - 0.2, 0.2, 0.25, 0.2};
  const MovingLeastSquares fitted(corners, {.order = 1, .radius = 4});
  const InterpolatingMovingLeastSquares through(corners, {.order = 1, .radius = 4});
  for (const ShapeValues& at : {fitted.at(x), through.at(x)})
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_NEAR(at.values[i], expected[i], 1e-13);
      const Vec gradient = i == 0 ? Vec(-1, -0.5, -1.0 / 3)
                                  : Vec(Vec::Unit(static_cast<Eigen::Index>(i) - 1) / static_cast<double>(i));
      EXPECT_LT((at.gradients[i] - gradient).norm(), 1e-12);
    }
}

TEST(MovingLeastSquares, OfOrderZeroWithPolesAreShepards) {
  const std::vector<Vec> nodes = in_a_cube();
  const Shepard shepard(nodes, {.power = 3, .radius = 0.6});
  const InterpolatingMovingLeastSquares through(nodes, {.order = 0, .power = 3, .radius = 0.6});
  std::vector<Vec> places = places_in_a_cube(20);
  places.push_back(nodes[7]);
  places.push_back(nodes[7] + Vec(1e-9, 0, 0));
  for (const Vec& x : places) {
    const ShapeValues a = shepard.at(x), b = through.at(x);
    EXPECT_LT((all_values(a, nodes.size()) - all_values(b, nodes.size())).norm(), 1e-13);
    EXPECT_LT((all_gradients(a, nodes.size()) - all_gradients(b, nodes.size())).norm(), 1e-12);
  }
}

TEST(MovingLeastSquares, RefuseTooFewOrBadlyPlacedNodes) {
  const std::vector<Vec> cube = in_a_cube();
  // nine nodes in space for ten coefficients
  const std::vector<Vec> nine(cube.begin() + 20, cube.begin() + 29);
  EXPECT_EQ(refusal([&] { MovingLeastSquares(nine, {.order = 2}); }),
            "moving least squares of order 2: the nodes (9 in all) are too few or too badly placed for 10 "
            "coefficients; use Shepard or GeneralisedMovingLeastSquares");
  // many nodes on a sphere, where x^2 + y^2 + z^2 - 1 vanishes
  std::vector<Vec> sphere;
  for (const Vec& x : places_in_a_cube(50)) sphere.push_back((x - Vec(0.5, 0.5, 0.5)).normalized());
  EXPECT_NE(refusal([&] { MovingLeastSquares(sphere, {.order = 2}); }).find("too badly placed"),
            std::string::npos);
  EXPECT_NO_THROW(MovingLeastSquares(sphere, {.order = 1}));
  EXPECT_NE(refusal([&] { MovingLeastSquares({Vec(1, 2, 3)}, {.order = 1}); }).find("coincident"),
            std::string::npos);
  // order 1 near x with three nodes
  const MovingLeastSquares few(cube, {.order = 1, .radius = 2, .nearest = 3});
  EXPECT_NE(refusal([&] {
              (void)few.at(Vec(0.5, 0.5, 0.5));
            }).find("order 1 at (0.5, 0.5, 0.5): the nodes near it (3) are coplanar"),
            std::string::npos);
  const MovingLeastSquares two(cube, {.order = 1, .radius = 2, .nearest = 2});
  EXPECT_NE(refusal([&] { (void)two.at(Vec(0.5, 0.5, 0.5)); }).find("(2) are collinear"), std::string::npos);
}

TEST(MovingLeastSquares, RefuseNodesThatAreAlmostInAPlane) {
  std::vector<Vec> nodes = in_a_plane();
  const Vec normal = (nodes[1] - nodes[0]).cross(nodes[5] - nodes[0]).normalized();
  for (const double height : {1e-9, 1e-3}) {
    std::vector<Vec> bent = nodes;
    for (std::size_t i = 0; i < bent.size(); ++i) bent[i] += (i % 3 == 0 ? height : 0) * normal;
    const MovingLeastSquares shapes(bent, {.order = 1, .radius = 0.6});
    const Vec x = nodes[12] + 0.02 * (nodes[1] - nodes[0]);
    if (height < 1e-6) {
      EXPECT_NE(refusal([&] { (void)shapes.at(x); }).find("are coplanar"), std::string::npos);
    } else {
      for (const Monomial& u : monomials(1))
        EXPECT_NEAR(interpolated(shapes.at(x), bent, u).gradient.dot(normal), u.gradient(x).dot(normal),
                    1e-9);
    }
  }
}

TEST(Shepard, IsEquations48And49) {
  const std::vector<Vec> nodes{Vec(0, 0, 0), Vec(1, 0, 0), Vec(0, 2, 0)};
  const Vec x(0.3, 0.4, 0);  // at 0.5, sqrt(0.65) and sqrt(2.65) m
  const ShapeValues at = Shepard(nodes).at(x);
  const double sum = 1 / 0.25 + 1 / 0.65 + 1 / 2.65;
  EXPECT_NEAR(at.values[0], 1 / 0.25 / sum, 1e-15);
  EXPECT_NEAR(at.values[1], 1 / 0.65 / sum, 1e-15);
  EXPECT_NEAR(at.values[2], 1 / 2.65 / sum, 1e-15);
}

TEST(Shepard, OfPowerOneHasGradientsBetweenTheNodesOnly) {
  const Shepard shapes(in_a_cube(), {.power = 1});
  EXPECT_LT(gradient_error(shapes, Vec(0.4, 0.5, 0.6), 1e-6), 1e-8);
  EXPECT_EQ(refusal([&] { (void)shapes.at(Vec(0, 0, 0)); }),
            "power 1: no gradient at node 0, where only a power above 1 has one");
}

TEST(Shepard, OfAHighPowerStaysFinite) {
  const Shepard shapes(in_a_cube(), {.power = 1000});
  for (const Vec& x : places_in_a_cube(10)) {
    const ShapeValues at = shapes.at(x);
    EXPECT_NEAR(all_values(at, 125).sum(), 1, 1e-13);
    EXPECT_TRUE(all_gradients(at, 125).allFinite());
  }
}

TEST(Gaussian, IsTheNormalisedGaussian) {
  const std::vector<Vec> nodes = in_a_cube();
  const Vec x(0.3, 0.7, 0.2);
  const ShapeValues at = Gaussian(nodes, {.width = 0.25}).at(x);
  double sum = 0;
  for (const Vec& X : nodes) sum += std::exp(-(x - X).squaredNorm() / (2 * 0.25 * 0.25));
  for (std::size_t i = 0; i < nodes.size(); ++i)
    EXPECT_NEAR(at.values[i], std::exp(-(x - nodes[i]).squaredNorm() / (2 * 0.25 * 0.25)) / sum, 1e-15);
}

TEST(Gaussian, HoldsFarFromAllNodes) {
  // exp(-d^2 / (2 s^2)) of every node underflows from 39 widths on
  const std::vector<Vec> nodes{Vec(0, 0, 0), Vec(0, 0.01, 0)};
  const Gaussian shapes(nodes, {.width = 0.1});
  const Vec x(1000, 0.005, 0);  // as far from both
  const ShapeValues at = shapes.at(x);
  EXPECT_NEAR(at.values[0], 0.5, 1e-9);  // 1e-13 m of rounding in d are 1e-13 * 1000 / 0.1^2 in the exponent
  // of two nodes: phi_1' = phi_0 phi_1 (x_1 - x_0) / s^2
  EXPECT_NEAR(at.gradients[1][1], 0.25 * 0.01 / 0.01, 1e-9);
  EXPECT_NEAR(shapes.at(Vec(0, 1000, 0)).values[1], 1, 1e-15);
}

TEST(GeneralisedMovingLeastSquares, OfASingleNodeAreItsTangent) {
  const GeneralisedMovingLeastSquares shapes({Vec(1, 2, 3)}, {.radius = 2});
  for (const Vec& offset : {Vec(0.3, -0.2, 0.7), Vec(0, 0, 0), Vec(1e-9, 0, 0), Vec(1.99999, 0, 0)}) {
    const ShapeValues at = shapes.at(Vec(1, 2, 3) + offset);
    EXPECT_NEAR(at.values[0], 1, 1e-14);
    EXPECT_LT(at.gradients[0].norm(), 1e-9);  // its weight grows by 1e5 1/m where it ends
    EXPECT_LT((at.slopes[0] - offset).norm(), 1e-14);
    EXPECT_LT((at.slope_gradients[0] - Eigen::Matrix3d::Identity()).norm(), 1e-9);
  }
}

TEST(GeneralisedMovingLeastSquares, TakeCoincidentNodes) {
  const std::vector<Vec> nodes(3, Vec(1, 2, 3));
  const ShapeValues at = GeneralisedMovingLeastSquares(nodes, {.radius = 2}).at(Vec(1.5, 2, 3));
  for (const double value : at.values) EXPECT_NEAR(value, 1.0 / 3, 1e-14);
}

TEST(GeneralisedMovingLeastSquares, ASmallLengthLeavesMovingLeastSquares) {
  const std::vector<Vec> nodes = in_a_cube();
  const MovingLeastSquares plain(nodes, {.order = 1, .radius = 0.6});
  const GeneralisedMovingLeastSquares general(nodes, {.order = 1, .radius = 0.6, .length = 1e-5});
  for (const Vec& x : places_in_a_cube(10)) {
    const ShapeValues a = plain.at(x), b = general.at(x);
    for (std::size_t i = 0; i < a.nodes.size(); ++i) {
      EXPECT_NEAR(a.values[i], b.values[i], 1e-7);  // the square of 1e-5 over the nodal distance
      EXPECT_LT(b.slopes[i].norm(), 1e-8);
    }
  }
}

TEST(ScatteredOptions, AreRefusedByNameAndValue) {
  const std::vector<Vec> nodes = in_a_cube();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double radius : {0.0, -1.0, nan}) {
    const std::string expected = "radius " + softsim::to_text(radius) + " m: must be positive";
    EXPECT_EQ(refusal([&] { Shepard(nodes, {.radius = radius}); }), expected);
    EXPECT_EQ(refusal([&] { Gaussian(nodes, {.width = 1, .radius = radius}); }), expected);
    EXPECT_EQ(refusal([&] { MovingLeastSquares(nodes, {.radius = radius}); }), expected);
    EXPECT_EQ(refusal([&] { InterpolatingMovingLeastSquares(nodes, {.radius = radius}); }), expected);
    EXPECT_EQ(refusal([&] { GeneralisedMovingLeastSquares(nodes, {.radius = radius, .length = 1}); }),
              expected);
  }
  for (const double power : {0.0, -2.0, nan, infinity})
    EXPECT_EQ(refusal([&] { Shepard(nodes, {.power = power}); }),
              "power " + softsim::to_text(power) + ": must exceed 0 and be finite");
  EXPECT_EQ(refusal([&] { InterpolatingMovingLeastSquares(nodes, {.power = 1}); }),
            "power 1: must exceed 1 and be finite");
  for (const double width : {0.0, -2.0, nan, infinity})
    EXPECT_EQ(refusal([&] { Gaussian(nodes, {.width = width}); }),
              "width " + softsim::to_text(width) + " m: must be positive and finite");
  for (const int order : {-1, 3}) {
    const std::string expected = "order " + std::to_string(order) + ": must be 0, 1 or 2";
    EXPECT_EQ(refusal([&] { MovingLeastSquares(nodes, {.order = order}); }), expected);
    EXPECT_EQ(refusal([&] { InterpolatingMovingLeastSquares(nodes, {.order = order}); }), expected);
  }
  EXPECT_EQ(refusal([&] { GeneralisedMovingLeastSquares(nodes, {.order = 0, .radius = 1}); }),
            "order 0: must be 1 or 2");
  EXPECT_EQ(refusal([&] { GeneralisedMovingLeastSquares(nodes, {.order = 1}); }),
            "length inf m: must be positive and finite");
  const GeneralisedMovingLeastSquares short_sighted({Vec(0, 0, 0)}, {.radius = 2, .length = 1e-9});
  EXPECT_EQ(refusal([&] { (void)short_sighted.at(Vec(1, 0, 0)); }),
            "length 1e-09 m: below a millionth of 1 m, the distance of a neighbour of (1, 0, 0)");
}

}  // namespace scattered_formulas_test
