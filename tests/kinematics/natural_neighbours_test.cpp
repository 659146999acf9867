// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/kinematics/natural_neighbours.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <vector>

#include "node_shape_checks.hpp"

namespace natural_neighbours_test {

using namespace node_shape_checks;
using softsim::NaturalNeighbours;

static_assert(softsim::NodeShapes<NaturalNeighbours<>>);
static_assert(!softsim::NodeShapes<softsim::AffineHull> && !softsim::NodeShapes<softsim::ConvexCell>);

// A turned and shifted frame of reference, so that no axis of the hull is one of space.
const softsim::Mat3<double> turn = Eigen::AngleAxisd(0.7, Vec(1, -2, 0.5).normalized()).toRotationMatrix();
const Vec shift(0.3, -5, 2);

std::vector<Vec> placed(std::vector<Vec> points) {
  for (Vec& x : points) x = turn * x + shift;
  return points;
}

TEST(ConvexCell, OfCutsHasTheVolumeAndMomentsOfTheTetrahedron) {
  softsim::ConvexCell cell(1);
  EXPECT_DOUBLE_EQ(cell.volume(), 8);
  for (int axis = 0; axis < 3; ++axis) cell.clip(-Vec::Unit(axis), 0, axis);
  EXPECT_DOUBLE_EQ(cell.volume(), 1);
  cell.clip(Vec::Ones(), 1, 7);
  EXPECT_NEAR(cell.volume(), 1.0 / 6, 1e-15);
  EXPECT_DOUBLE_EQ(cell.radius(3), 1);
  int found = 0;
  for (const auto& facet : cell.facets())
    if (facet.plane == 7) {
      ++found;
      EXPECT_LT((facet.area_vector() - Vec::Constant(0.5)).norm(), 1e-15);
      EXPECT_LT((facet.first_moment() - Vec::Constant(std::sqrt(0.75) / 3)).norm(), 1e-15);
    }
  EXPECT_EQ(found, 1);
  cell.clip(Vec::Ones(), -1, 8);
  EXPECT_EQ(cell.volume(), 0);
}

TEST(ConvexCell, TakesPlanesThroughCornersAndAlongFacets) {
  softsim::ConvexCell cell(1);
  cell.clip(Vec(1, 1, 0), 0, 0);  // through two edges
  EXPECT_NEAR(cell.volume(), 4, 1e-14);
  cell.clip(Vec(1, 1, 0), 0, 1);  // once more
  EXPECT_NEAR(cell.volume(), 4, 1e-14);
  cell.clip(Vec(0, 0, 1), 1, 2);  // along the top
  EXPECT_NEAR(cell.volume(), 4, 1e-14);
  cell.clip(Vec(0, 0, -1), -1, 3);  // all but the top
  EXPECT_NEAR(cell.volume(), 0, 1e-14);
}

TEST(NaturalNeighbours, OfACubeHaveAnEighthEachInTheMiddle) {
  const NaturalNeighbours shapes(lattice(2, 2, 2));
  const auto s = shapes.at(Vec::Constant(0.5));
  ASSERT_EQ(s.nodes.size(), 8u);
  for (std::size_t k = 0; k < 8; ++k) {
    EXPECT_NEAR(s.values[k], 0.125, 1e-15);
    // by symmetry along the corner, by linear reproduction with sum grad phi_i (x_i - x)^T = I
    const Vec corner = 2 * (shapes.nodes()[k] - Vec::Constant(0.5));
    EXPECT_LT((s.gradients[k] - corner / 4).norm(), 1e-14);
  }
}

// Between four lattice nodes, at distance sqrt(1/2), and eight at sqrt(3/2): the cell is a prism over the
// diamond |u| + |v| <= 1/2 with roofs w <= 3/4 - (|u| + |v|)/2. Of its volume 7/12 each near node gets 1/8,
// the part with |w| <= 1/2, each far one 1/96.
TEST(NaturalNeighbours, OnAFaceOfTheLatticeHaveTheValuesByHand) {
  const NaturalNeighbours shapes(lattice(6, 6, 5));
  const auto s = shapes.at(Vec(2.5, 2.5, 2));
  ASSERT_EQ(s.nodes.size(), 12u);
  for (std::size_t k = 0; k < 12; ++k) {
    const bool near = shapes.nodes()[static_cast<std::size_t>(s.nodes[k])][2] == 2;
    EXPECT_NEAR(s.values[k], near ? 3.0 / 14 : 1.0 / 56, 1e-14) << k;
  }
}

TEST(NaturalNeighbours, OfRandomNodesFormAPartitionOfUnityAndReproduceLinearFields) {
  auto nodes = random_points(200, 1);
  for (const Vec& corner : lattice(2, 2, 2)) nodes.push_back(corner);
  const NaturalNeighbours shapes(nodes);
  EXPECT_EQ(shapes.consistency(), 1);
  EXPECT_TRUE(shapes.interpolates());
  EXPECT_EQ(shapes.support(), std::numeric_limits<double>::infinity());
  for (const Vec& x : random_points(50, 2, Vec::Constant(0.02), Vec::Constant(0.98))) {
    const auto s = shapes.at(x);
    expect_partition_of_unity(s, 1e-12, 0.2);
    expect_not_negative(s);
    expect_linear_reproduction(shapes, x, 1e-10);
  }
}

// Beside a cluster the nearest nodes are not the natural neighbours.
TEST(NaturalNeighbours, BesideAClusterReproduceLinearFields) {
  auto nodes = random_points(300, 10, Vec::Constant(0.4), Vec::Constant(0.42));
  for (const Vec& corner : lattice(2, 2, 2)) nodes.push_back(corner);
  for (const Vec& far : random_points(30, 11)) nodes.push_back(far);
  const NaturalNeighbours shapes(nodes);
  for (const Vec& x : {Vec(0.45, 0.44, 0.43), Vec(0.41, 0.41, 0.38), Vec(0.5, 0.5, 0.5)}) {
    expect_partition_of_unity(shapes.at(x), 1e-12, 0.02);
    expect_linear_reproduction(shapes, x, 1e-11);
  }
}

TEST(NaturalNeighbours, GradientsAreTheDerivatives) {
  auto nodes = random_points(60, 3);
  for (const Vec& corner : lattice(2, 2, 2)) nodes.push_back(corner);
  const NaturalNeighbours shapes(nodes);
  // The functions are once differentiable: the error of the difference is of order h, with third
  // derivatives up to 1/spacing^3.
  for (const Vec& x : random_points(20, 4, Vec::Constant(0.2), Vec::Constant(0.8)))
    expect_gradients_are_derivatives(shapes, x, 1e-5, 2e-4);
  const NaturalNeighbours regular(lattice(4, 4, 4));
  for (const Vec& x : random_points(10, 5, Vec::Constant(1.1), Vec::Constant(1.9)))
    expect_gradients_are_derivatives(regular, x, 1e-5, 1e-4);
}

// Whole numbers: every cell has corners where more than four nodes are equally near.
TEST(NaturalNeighbours, OfARegularGridReproduceLinearFieldsAtSpecialPoints) {
  const NaturalNeighbours shapes(lattice(5, 5, 5));
  for (const Vec& x :
       {Vec(2, 2, 2.5), Vec(2, 2.5, 2.5), Vec(1.5, 1.5, 1.5), Vec(2, 2, 2.25), Vec(2, 2.125, 2.5),
        Vec(2.0 + 1e-8, 2, 2), Vec(0.5, 0.5, 0.5), Vec(3.75, 3.75, 0.25)}) {
    const auto s = shapes.at(x);
    expect_partition_of_unity(s, 1e-12);
    expect_not_negative(s);
    expect_linear_reproduction(shapes, x, (x - Vec(2, 2, 2)).norm() < 1e-7 ? 1e-6 : 1e-12);
  }
}

// Reflections of the lattice turn the functions into each other.
TEST(NaturalNeighbours, HaveTheSymmetryOfTheNodes) {
  const NaturalNeighbours shapes(lattice(4, 4, 4));
  const Vec x(1.3, 1.45, 1.2);
  const auto here = values_by_node(shapes.at(x));
  const auto there = values_by_node(shapes.at(Vec(3 - x[0], x[2], x[1])));
  ASSERT_EQ(here.size(), there.size());
  for (const auto& [node, value] : here) {
    const std::int32_t i = node % 4, j = node / 4 % 4, k = node / 16;
    const std::int32_t image = (j * 4 + k) * 4 + 3 - i;
    ASSERT_TRUE(there.count(image));
    EXPECT_NEAR(there.at(image), value, 1e-14);
  }
}

// A count over a fine grid of the unit cube: which points are nearer to x than to any node, and whose they
// were. Of some 10,000 those at the cell's surface may be miscounted.
void expect_volumes_that_are_taken(const std::vector<Vec>& nodes, const Vec& x) {
  std::map<std::int32_t, int> count;
  int total = 0;
  constexpr int n = 120;
  for (int i = 0; i < n * n * n; ++i) {
    const Vec p = Vec((i % n + 0.5), (i / n % n + 0.5), (i / n / n + 0.5)) / n;
    std::size_t nearest = 0;
    for (std::size_t k = 1; k < nodes.size(); ++k)
      if ((nodes[k] - p).squaredNorm() < (nodes[nearest] - p).squaredNorm()) nearest = k;
    if ((p - x).squaredNorm() >= (nodes[nearest] - p).squaredNorm()) continue;
    ++count[static_cast<std::int32_t>(nearest)];
    ++total;
  }
  ASSERT_GT(total, 5000);
  for (const auto& [node, value] : values_by_node(NaturalNeighbours(nodes).at(x)))
    EXPECT_NEAR(count[node] / static_cast<double>(total), value, 5e-3) << node;
}

TEST(NaturalNeighbours, AreTheVolumesThatThePointTakes) {
  auto nodes = random_points(30, 6);
  for (const Vec& corner : lattice(2, 2, 2)) nodes.push_back(corner);
  expect_volumes_that_are_taken(nodes, Vec(0.45, 0.55, 0.5));
}

// The 24 nearest nodes, a cluster and four around, close the cell; others cut it down.
TEST(NaturalNeighbours, AreFoundBehindACluster) {
  const Vec x = Vec::Constant(0.5);
  auto nodes = random_points(20, 12, Vec(0.2, 0.45, 0.45), Vec(0.25, 0.55, 0.55));
  for (const Vec& way : {Vec(1, 1, 1), Vec(1, -1, -1), Vec(-1, 1, -1), Vec(-1, -1, 1)})
    nodes.push_back(x + 0.4 * way.normalized());
  for (const Vec& way : random_points(40, 13, Vec::Constant(-1), Vec::Constant(1)))
    nodes.push_back(x + 0.41 * way.normalized());
  expect_volumes_that_are_taken(nodes, x);
}

TEST(NaturalNeighbours, AreOneAtTheirNodeWithGradientsThatReproduceLinearFields) {
  auto nodes = random_points(40, 7);
  for (const Vec& corner : lattice(2, 2, 2)) nodes.push_back(corner);  // of the hull
  const NaturalNeighbours shapes(nodes);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const auto s = shapes.at(nodes[i]);
    for (const auto& [node, value] : values_by_node(s))
      EXPECT_EQ(value, node == static_cast<std::int32_t>(i) ? 1 : 0);
    expect_partition_of_unity(s, 1e-12, 0.2);
    expect_linear_reproduction(shapes, nodes[i], 1e-10);
    // continuous: next to an inner node nearly 1 (the slope is of the order of 1/spacing)
    if (i < 40 && (nodes[i] - Vec::Constant(0.5)).cwiseAbs().maxCoeff() < 0.3) {
      EXPECT_NEAR(value(shapes, nodes[i] + Vec(1e-6, -2e-6, 1e-6), static_cast<std::int32_t>(i)), 1, 1e-4);
    }
  }
}

TEST(NaturalNeighbours, OnALineInterpolateLinearly) {
  std::vector<Vec> along;
  for (const double t : {0.0, 3.0, 1.0, 7.0, 4.5}) along.push_back(Vec(t, 0, 0));
  const NaturalNeighbours shapes(placed(along));
  const auto s = shapes.at(turn * Vec(1.5, 0, 0) + shift);
  ASSERT_EQ(s.nodes, (std::vector<std::int32_t>{1, 2}));
  EXPECT_NEAR(s.values[0], 0.25, 1e-14);
  EXPECT_NEAR(s.values[1], 0.75, 1e-14);
  EXPECT_LT((s.gradients[0] - turn.col(0) / 2).norm(), 1e-14);
  EXPECT_LT((s.gradients[1] + turn.col(0) / 2).norm(), 1e-14);
  // beside the line: the same
  const auto beside = shapes.at(turn * Vec(1.5, 2, -3) + shift);
  EXPECT_NEAR(beside.values[0], 0.25, 1e-14);
  // at a node, the mean of the slopes on both sides
  const auto node = shapes.at(placed({Vec(3, 0, 0)})[0]);
  ASSERT_EQ(node.nodes, (std::vector<std::int32_t>{1, 2, 4}));
  EXPECT_LT((node.gradients[1] + turn.col(0) / 4).norm(), 1e-14);
  EXPECT_LT((node.gradients[2] - turn.col(0) / 3).norm(), 1e-14);
}

TEST(NaturalNeighbours, InAPlaneAreThoseOfAreas) {
  const NaturalNeighbours square(placed(lattice(2, 2, 1)));
  const auto s = square.at(turn * Vec(0.5, 0.5, 0) + shift);
  ASSERT_EQ(s.nodes.size(), 4u);
  for (const double value : s.values) EXPECT_NEAR(value, 0.25, 1e-14);

  auto flat = random_points(60, 8, Vec::Zero(), Vec(1, 1, 0));
  for (const Vec& corner : lattice(2, 2, 1)) flat.push_back(corner);
  const NaturalNeighbours shapes(placed(flat));
  const Vec slope = turn * Vec(0.7, -0.4, 0);
  const auto field = [&](const Vec& p) { return 2 + slope.dot(p); };
  for (const Vec& y : random_points(20, 9, Vec(0.1, 0.1, -1), Vec(0.9, 0.9, 1))) {
    const Vec x = turn * y + shift;
    const auto values = shapes.at(x);
    expect_partition_of_unity(values, 1e-12, 0.2);
    expect_not_negative(values);
    EXPECT_NEAR(interpolated(shapes, x, field), field(x), 1e-12);
    EXPECT_LT((interpolated_gradient(shapes, x, field) - slope).norm(), 1e-11);
    expect_gradients_are_derivatives(shapes, x, 1e-5, 1e-3);
  }
  const auto node = shapes.at(shapes.nodes()[3]);
  expect_partition_of_unity(node, 1e-12, 0.2);
  EXPECT_LT((interpolated_gradient(shapes, shapes.nodes()[3], field) - slope).norm(), 1e-11);
}

TEST(NaturalNeighbours, OfOneNodeAreOneEverywhere) {
  const auto s = NaturalNeighbours(std::vector<Vec>{Vec(1, 2, 3)}).at(Vec(5, 5, 5));
  EXPECT_EQ(s.values, std::vector<double>{1});
  EXPECT_EQ(s.gradients[0], Vec::Zero());
}

// The cell reaches out by about (spacing)^2 / (8 depth), and the digits go with its cube: up to where they
// are gone linear fields are reproduced, beyond that points are refused.
TEST(NaturalNeighbours, NearTheSurfaceReproduceLinearFieldsOrRefuse) {
  for (const auto& nodes : {lattice(3, 3, 3), placed(lattice(3, 3, 3))}) {
    const NaturalNeighbours shapes(nodes);
    const auto at_depth = [&](double depth) {
      const Vec y(0.6, 0.7, depth);
      return nodes[0] == Vec(0, 0, 0) ? y : placed({y})[0];
    };
    for (const double depth : {0.1, 1e-2, 1e-3})
      expect_linear_reproduction(shapes, at_depth(depth), 1e-13 + 1e-17 / std::pow(depth, 3));
    for (const double depth : {3e-4, 1e-4, 3e-5, 1e-5, 3e-6, 1e-6, 1e-7, 1e-9, 0.0, -1e-6}) try {
        const Vec x = at_depth(depth);
        (void)shapes.at(x);
        expect_linear_reproduction(shapes, x, 2e-6);
      } catch (const std::invalid_argument&) {
        EXPECT_LE(depth, 1e-4);
      }
  }
}

TEST(NaturalNeighbours, RefusePointsThatAreNotInsideTheHull) {
  const NaturalNeighbours shapes(lattice(2, 2, 2));
  expect_refused([&] { (void)shapes.at(Vec(0.5, 0.25, 1.5)); },
                 "point (0.5, 0.25, 1.5) m: is not inside the convex hull of the nodes, its Voronoi cell is "
                 "unbounded or reaches too far");
  expect_refused([&] { (void)shapes.at(Vec(0.5, 0.5, 0)); },
                 "point (0.5, 0.5, 0) m: is not inside the convex hull of the nodes, its Voronoi cell is "
                 "unbounded or reaches too far");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  expect_refused([&] { (void)shapes.at(Vec(0, nan, 0)); }, "point (0, nan, 0) m: is not finite");
  const NaturalNeighbours line(std::vector<Vec>{Vec(0, 0, 0), Vec(1, 0, 0)});
  EXPECT_THROW((void)line.at(Vec(1.01, 0, 0)), std::invalid_argument);
  EXPECT_THROW((void)line.at(Vec(-0.01, 0, 0)), std::invalid_argument);
  EXPECT_NEAR(line.at(Vec(0.99, 7, 0)).values[1], 0.99, 1e-14);
}

TEST(NaturalNeighbours, RefuseNodesThatNothingCanInterpolate) {
  expect_refused([] { NaturalNeighbours shapes(std::vector<Vec>{}); }, "affine hull: there are no nodes");
  expect_refused(
      [] {
        NaturalNeighbours shapes({Vec(0, 0, 0), Vec(1, 0, 0), Vec(0, 1, 0), Vec(1, 0, 0)});
      },
      "nodes 1 and 3 are at the same place: natural neighbours need distinct nodes");
  const double inf = std::numeric_limits<double>::infinity();
  expect_refused(
      [&] {
        NaturalNeighbours shapes({Vec(0, 0, 0), Vec(inf, 0, 0)});
      },
      "node 1: a coordinate is not a finite number");
}

}  // namespace natural_neighbours_test
