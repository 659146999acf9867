// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/ext/nanoflann.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <random>
#include <vector>

#include "mesh/neighbour_sets.hpp"
#include "softsim/kinematics/moving_least_squares.hpp"
#include "softsim/kinematics/node_shapes.hpp"

namespace nanoflann_test {

using neighbour_sets::Vec;
using softsim::KdTree, softsim::MovingLeastSquares;

static_assert(softsim::NeighbourSearch<KdTree>);
static_assert(softsim::NodeShapes<MovingLeastSquares<KdTree>>);

TEST(KdTree, FindsWhatLookingAtAllPointsFinds) { neighbour_sets::expect_same_as_looking_at_all<KdTree>(); }

TEST(KdTree, RefusesWhatIsNotFinite) { neighbour_sets::expect_refusal_of_what_is_not_finite<KdTree>(); }

TEST(KdTree, CopiesStandAlone) {
  auto first = std::make_unique<KdTree>(std::vector<Vec>{Vec(0, 0, 0), Vec(1, 0, 0)});
  const KdTree copy = *first;
  first.reset();
  EXPECT_EQ(copy.nearest(Vec(0.9, 0, 0), 1), std::vector<std::int32_t>{1});
}

TEST(KdTree, GivesTheShapeFunctionsOfTheGrid) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  const auto next = [&] { return Vec(unit(random), unit(random), unit(random)); };
  std::vector<Vec> nodes;
  for (int i = 0; i < 300; ++i) nodes.push_back(next());
  const MovingLeastSquares grid(nodes, {.order = 1, .radius = 0.4, .nearest = 12});
  const MovingLeastSquares<KdTree> tree(nodes, {.order = 1, .radius = 0.4, .nearest = 12});
  for (int i = 0; i < 50; ++i) {
    const Vec x = next();
    const auto a = grid.at(x), b = tree.at(x);
    EXPECT_EQ(a.nodes, b.nodes);
    EXPECT_EQ(a.values, b.values);
    EXPECT_EQ(a.gradients, b.gradients);
  }
}

}  // namespace nanoflann_test
