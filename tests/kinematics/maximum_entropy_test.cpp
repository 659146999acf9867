// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/kinematics/maximum_entropy.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "node_shape_checks.hpp"

namespace maximum_entropy_test {

using namespace node_shape_checks;
using softsim::MaximumEntropy;

static_assert(softsim::NodeShapes<MaximumEntropy<>>);
static_assert(!softsim::NodeShapes<softsim::MaximumEntropyOptions>);

const softsim::Mat3<double> turn = Eigen::AngleAxisd(0.7, Vec(1, -2, 0.5).normalized()).toRotationMatrix();
const Vec shift(0.3, -5, 2);

std::vector<Vec> placed(std::vector<Vec> points) {
  for (Vec& x : points) x = turn * x + shift;
  return points;
}

// The only weights that are a product over the axes and reproduce linear fields: on the corners of a box the
// functions are trilinear, whatever the width of the prior.
TEST(MaximumEntropy, OfTheCornersOfABoxAreTrilinear) {
  for (const double gamma : {0.1, 1.8, 6.0}) {
    const MaximumEntropy shapes(lattice(2, 2, 2), {.spacing = 1, .gamma = gamma, .cutoff = 1e-12});
    EXPECT_TRUE(shapes.interpolates());
    for (const Vec& x : random_points(10, 1)) {
      const auto s = shapes.at(x);
      ASSERT_EQ(s.nodes.size(), 8u);
      for (std::size_t k = 0; k < 8; ++k) {
        Vec along, slope;
        for (int a = 0; a < 3; ++a) {
          along[a] = shapes.nodes()[k][a] == 1 ? x[a] : 1 - x[a];
          slope[a] = shapes.nodes()[k][a] == 1 ? 1 : -1;
        }
        EXPECT_NEAR(s.values[k], along.prod(), 1e-13);
        for (int a = 0; a < 3; ++a)
          EXPECT_NEAR(s.gradients[k][a], slope[a] * along[(a + 1) % 3] * along[(a + 2) % 3], 1e-11);
      }
    }
  }
}

TEST(MaximumEntropy, FormAPartitionOfUnityAndReproduceLinearFields) {
  auto nodes = random_points(300, 2);
  for (const Vec& corner : lattice(2, 2, 2)) nodes.push_back(corner);
  const MaximumEntropy shapes(nodes, {.spacing = 0.2});
  EXPECT_EQ(shapes.consistency(), 1);
  EXPECT_FALSE(shapes.interpolates());
  EXPECT_NEAR(shapes.support(), 0.2 * std::sqrt(std::log(1e6) / 1.8), 1e-15);
  for (const Vec& x : random_points(50, 3, Vec::Constant(0.1), Vec::Constant(0.9))) {
    const auto s = shapes.at(x);
    expect_partition_of_unity(s, 1e-12, 0.2);
    expect_not_negative(s);
    expect_linear_reproduction(shapes, x, 1e-11);
    for (const std::int32_t i : s.nodes)
      EXPECT_LE((nodes[static_cast<std::size_t>(i)] - x).norm(), shapes.support());
  }
}

// h^2/6 times third derivatives, of about gamma^1.5 / (0.2 m)^3.
TEST(MaximumEntropy, GradientsAreTheDerivatives) {
  auto nodes = random_points(150, 4);
  for (const Vec& corner : lattice(2, 2, 2)) nodes.push_back(corner);
  for (const double gamma : {0.6, 1.8, 4.0}) {
    const MaximumEntropy shapes(nodes, {.spacing = 0.2, .gamma = gamma, .cutoff = 1e-16});
    for (const Vec& x : random_points(10, 5, Vec::Constant(0.15), Vec::Constant(0.85)))
      expect_gradients_are_derivatives(shapes, x, 1e-5, 1e-6);
  }
}

TEST(MaximumEntropy, AreTheExponentialsThatArroyoAndOrtizName) {
  const auto nodes = lattice(4, 4, 4);
  const MaximumEntropy shapes(nodes, {.spacing = 1, .gamma = 1.3, .cutoff = 1e-9});
  const Vec x(1.2, 1.7, 1.4);
  const auto s = shapes.at(x);
  // log w_i + beta |x - x_i|^2 is linear in x_i: its four coefficients from four nodes give all others
  const auto rest = [&](std::size_t k) {
    return std::log(s.values[k]) + 1.3 * (nodes[static_cast<std::size_t>(s.nodes[k])] - x).squaredNorm();
  };
  Eigen::MatrixXd basis(s.nodes.size(), 4);
  Eigen::VectorXd logs(s.nodes.size());
  for (std::size_t k = 0; k < s.nodes.size(); ++k) {
    basis.row(static_cast<int>(k)) << 1, nodes[static_cast<std::size_t>(s.nodes[k])].transpose();
    logs[static_cast<int>(k)] = rest(k);
  }
  const Eigen::VectorXd fit = (basis.transpose() * basis).inverse() * (basis.transpose() * logs);
  EXPECT_LT((basis * fit - logs).norm(), 1e-10);
}

TEST(MaximumEntropy, HaveTheSymmetryOfTheNodes) {
  const MaximumEntropy shapes(lattice(4, 4, 4), {.spacing = 1, .cutoff = 1e-12});
  const auto middle = shapes.at(Vec::Constant(1.5));
  for (const auto& [node, value] : values_by_node(middle))
    EXPECT_NEAR(value, values_by_node(middle).at(63 - node), 1e-14);
  const Vec x(1.3, 1.45, 1.2);
  const auto there = values_by_node(shapes.at(Vec(3 - x[0], x[2], x[1])));
  for (const auto& [node, value] : values_by_node(shapes.at(x))) {
    const std::int32_t i = node % 4, j = node / 4 % 4, k = node / 16;
    EXPECT_NEAR(there.at((j * 4 + k) * 4 + 3 - i), value, 1e-13);
  }
}

// A node in the middle is not alone there, and all the less so the wider the prior; the limit of narrow ones
// is linear interpolation.
TEST(MaximumEntropy, AtAnInnerNodeInterpolateInTheLimitOnly) {
  double before = 0;
  for (const double gamma : {0.5, 1.0, 2.0, 4.0, 8.0}) {
    const MaximumEntropy shapes(lattice(5, 5, 5), {.spacing = 1, .gamma = gamma, .cutoff = 1e-14});
    EXPECT_FALSE(shapes.interpolates());
    const double own = value(shapes, Vec(2, 2, 2), 62);
    EXPECT_GT(own, before);
    // by symmetry lambda = 0: a product of normalised Gaussians
    double sum = 1;
    for (int k = 1; k <= 2; ++k) sum += 2 * std::exp(-gamma * k * k);
    EXPECT_NEAR(own, 1 / (sum * sum * sum), 1e-8);
    before = own;
  }
  EXPECT_GT(before, 0.997);
  std::vector<Vec> line;
  for (const double t : {0.0, 1.0, 2.0, 3.0}) line.push_back(Vec(t, 0, 0));
  const MaximumEntropy narrow(line, {.spacing = 1, .gamma = 30, .cutoff = 1e-60});
  EXPECT_NEAR(value(narrow, Vec(1.3, 0, 0), 1), 0.7, 1e-4);
}

TEST(MaximumEntropy, OnTheHullOnlyTheNodesOfTheFaceCount) {
  auto nodes = random_points(100, 6, Vec::Constant(0.1), Vec::Constant(0.9));
  for (const Vec& corner : lattice(2, 2, 2)) nodes.push_back(corner);
  const MaximumEntropy shapes(nodes, {.spacing = 1, .gamma = 1});
  const Vec slope(0.7, -0.4, 0.6);
  const auto field = [&](const Vec& p) { return 0.3 + slope.dot(p); };
  // on a face, an edge, and at a corner: products of the functions along the axes
  for (const Vec& x : {Vec(0.3, 0.6, 0), Vec(0.3, 1, 0), Vec(0, 1, 1), Vec(1, 1, 1)}) {
    const auto s = shapes.at(x);
    for (std::size_t k = 0; k < s.nodes.size(); ++k) {
      const Vec& node = nodes[static_cast<std::size_t>(s.nodes[k])];
      double expected = s.nodes[k] < 100 ? 0 : 1;
      for (int a = 0; a < 3; ++a) expected *= node[a] == 1 ? x[a] : 1 - x[a];
      EXPECT_NEAR(s.values[k], expected, 1e-11) << x.transpose() << " node " << s.nodes[k];
    }
    expect_partition_of_unity(s, 1e-6);
    EXPECT_NEAR(interpolated(shapes, x, field), field(x), 1e-12);
    EXPECT_LT((interpolated_gradient(shapes, x, field) - slope).norm(), 1e-6) << x.transpose();
  }
}

// Slanted faces whose nodes are off their plane, by rounding or more: nodes, and points next to a face. The
// gradients on the surface are those of about 1e-8 further inside, where offsets have 8 digits.
TEST(MaximumEntropy, OnAHullThatIsNotQuiteFlatReproduceLinearFields) {
  const Vec slope(0.7, -0.4, 0.6);
  const auto field = [&](const Vec& p) { return 0.3 + slope.dot(p); };
  for (const double roughness : {0.0, 1e-12, 1e-10, 1e-8, 1e-6, 1e-4}) {
    auto nodes = lattice(4, 4, 4), points = random_points(50, 9, Vec::Zero(), Vec(3, 3, 0));
    const auto moves = random_points(64, 8, Vec::Constant(-roughness), Vec::Constant(roughness));
    for (std::size_t i = 0; i < 64; ++i) nodes[i] += moves[i];
    for (Vec& p : points) p[2] += 2 * roughness;
    points.insert(points.end(), nodes.begin(), nodes.end());
    const MaximumEntropy shapes(placed(nodes), {.spacing = 1});
    for (const Vec& x : placed(points)) {
      EXPECT_NEAR(interpolated(shapes, x, field), field(x), 1e-9) << roughness;
      EXPECT_LT((interpolated_gradient(shapes, x, field) - slope).norm(), 1e-6) << roughness;
      expect_not_negative(shapes.at(x));
    }
  }
}

TEST(MaximumEntropy, OfCoplanarAndCollinearNodesAreThoseWithinTheirHull) {
  const MaximumEntropy square(placed(lattice(2, 2, 1)), {.spacing = 1});
  EXPECT_TRUE(square.interpolates());
  const auto s = square.at(turn * Vec(0.25, 0.4, 0.3) + shift);  // beside the plane
  ASSERT_EQ(s.nodes.size(), 4u);
  const double expected[] = {0.75 * 0.6, 0.25 * 0.6, 0.75 * 0.4, 0.25 * 0.4};
  for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(s.values[k], expected[k], 1e-13);
  EXPECT_LT((s.gradients[3] - turn * Vec(0.4, 0.25, 0)).norm(), 1e-11);

  const MaximumEntropy line(placed({Vec(0, 0, 0), Vec(2, 0, 0)}), {.spacing = 1});
  const auto l = line.at(turn * Vec(0.5, 0, 0) + shift);
  EXPECT_NEAR(l.values[0], 0.75, 1e-13);
  EXPECT_LT((l.gradients[1] - turn.col(0) / 2).norm(), 1e-11);

  const MaximumEntropy sheet(placed(lattice(6, 6, 1)), {.spacing = 1, .cutoff = 1e-16});
  for (const Vec& y : random_points(10, 7, Vec(0.5, 0.5, -1), Vec(4.5, 4.5, 1))) {
    const Vec x = turn * y + shift;
    expect_partition_of_unity(sheet.at(x), 1e-12);
    expect_gradients_are_derivatives(sheet, x, 1e-5, 1e-8);
  }
  const auto one = MaximumEntropy({Vec(1, 2, 3)}, {.spacing = 1}).at(Vec(9, 9, 9));
  EXPECT_EQ(one.values, std::vector<double>{1});
  EXPECT_EQ(one.gradients[0].norm(), 0);
}

TEST(MaximumEntropy, RefuseWhatHasNoWeights) {
  const MaximumEntropy cube(lattice(2, 2, 2), {.spacing = 1});
  for (const double depth : {-0.5, -1e-3, -1e-6, -2e-10})
    expect_refused(
        [&] { (void)cube.at(Vec(0.5, depth, 0.5)); },
        "maximum entropy at (0.5, " + softsim::to_text(depth) +
            ", 0.5) m: the point is not in the convex hull of the 8 nodes within the support radius " +
            softsim::to_text(cube.support()) + " m");
  expect_refused([&] { (void)cube.at(Vec(9, 0, 0)); },
                 "maximum entropy at (9, 0, 0) m: no node is within the support radius 2.77043023 m");
  expect_refused([&] { (void)cube.at(Vec(0, std::nan(""), 0)); },
                 "maximum entropy at (0, nan, 0) m: the point is not finite");
  // a gap: no node on the far side is within the support
  auto nodes = lattice(3, 3, 1);
  nodes.push_back(Vec(1, 1, 9));
  const MaximumEntropy gap(nodes, {.spacing = 1});
  expect_refused([&] { (void)gap.at(Vec(1, 1, 1)); },
                 "maximum entropy at (1, 1, 1) m: the point is not in the convex hull of the 9 nodes within "
                 "the support radius 2.77043023 m");
  expect_refused(
      [&] { (void)gap.at(Vec(1.1, 1, 0)); },
      "maximum entropy at (1.1, 1, 0) m: the 9 nodes within the support radius 2.77043023 m lie in a "
      "plane, across which there is no gradient");
}

TEST(MaximumEntropy, RefuseBadOptions) {
  const auto nodes = lattice(2, 2, 2);
  expect_refused([&] { MaximumEntropy shapes({}, {.spacing = 1}); }, "affine hull: there are no nodes");
  for (const double bad : {0.0, -1.0, std::numeric_limits<double>::infinity()}) {
    expect_refused([&] { MaximumEntropy shapes(nodes, {.spacing = bad}); },
                   "spacing " + softsim::to_text(bad) + " m: must be positive and finite");
    expect_refused([&] { MaximumEntropy shapes(nodes, {.spacing = 1, .gamma = bad}); },
                   "gamma " + softsim::to_text(bad) + ": must be positive and finite");
  }
  expect_refused([&] { MaximumEntropy shapes(nodes, {.spacing = 1, .cutoff = 1}); },
                 "cutoff 1: must lie in (0, 1)");
}

}  // namespace maximum_entropy_test
