// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/mesh/point_grid.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <vector>

#include "mesh/neighbour_sets.hpp"

namespace point_grid_test {

using neighbour_sets::Vec;
using softsim::NeighbourSearch, softsim::PointGrid;

static_assert(NeighbourSearch<PointGrid>);
static_assert(!NeighbourSearch<std::vector<Vec>>);
struct NoNearest {
  explicit NoNearest(std::vector<Vec>);
  [[nodiscard]] const std::vector<Vec>& points() const;
  [[nodiscard]] std::vector<std::int32_t> within(const Vec& x, double radius) const;
};
static_assert(!NeighbourSearch<NoNearest>);

TEST(PointGrid, FindsWhatLookingAtAllPointsFinds) {
  neighbour_sets::expect_same_as_looking_at_all<PointGrid>();
}

TEST(PointGrid, RefusesWhatIsNotFinite) { neighbour_sets::expect_refusal_of_what_is_not_finite<PointGrid>(); }

TEST(PointGrid, EquallyFarPointsCountByNumber) {
  const PointGrid grid({Vec(1, 0, 0), Vec(0, 0, 1), Vec(-1, 0, 0), Vec(0, 0.5, 0)});
  EXPECT_EQ(grid.nearest(Vec(0, 0, 0), 2), (std::vector<std::int32_t>{0, 3}));
  EXPECT_EQ(grid.nearest(Vec(0, 0, 0), 3), (std::vector<std::int32_t>{0, 1, 3}));
}

TEST(PointGrid, CopiesStandAlone) {
  auto first = std::make_unique<PointGrid>(std::vector<Vec>{Vec(0, 0, 0), Vec(1, 0, 0)});
  const PointGrid copy = *first;
  first.reset();
  EXPECT_EQ(copy.nearest(Vec(0.9, 0, 0), 1), std::vector<std::int32_t>{1});
}

}  // namespace point_grid_test
