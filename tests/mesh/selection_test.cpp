// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/mesh/selection.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "softsim/mesh/generators.hpp"

namespace selection_test {

using softsim::Side, softsim::nodes_near;
using Vec = softsim::Vec3<double>;

TEST(Side, NamesAreParsedAndOthersRefused) {
  EXPECT_EQ(softsim::parse_side("xmin"), Side::xmin);
  EXPECT_EQ(softsim::parse_side("xmax"), Side::xmax);
  EXPECT_EQ(softsim::parse_side("ymin"), Side::ymin);
  EXPECT_EQ(softsim::parse_side("ymax"), Side::ymax);
  EXPECT_EQ(softsim::parse_side("zmin"), Side::zmin);
  EXPECT_EQ(softsim::parse_side("zmax"), Side::zmax);
  for (const char* name : {"", "x", "Xmin", "xmin ", "wmax"}) EXPECT_FALSE(softsim::parse_side(name)) << name;
}

TEST(BoundingBox, SpansTheNodes) {
  const auto box = softsim::bounding_box(softsim::box_mesh({2, 1, 3}, {2, 4, 6}, {-1, 0, 10}));
  EXPECT_EQ(box.lower, Vec(-1, 0, 10));
  EXPECT_EQ(box.upper, Vec(1, 4, 16));
}

TEST(NodesNear, DepthZeroIsTheFlatSide) {
  const auto mesh = softsim::box_mesh({4, 3, 2}, {0.3, 0.7, 0.1}, {0.1, 0.1, 0.1});
  EXPECT_EQ(nodes_near(mesh, Side::xmin, 0).size(), 4u * 3);
  EXPECT_EQ(nodes_near(mesh, Side::xmax, 0).size(), 4u * 3);
  EXPECT_EQ(nodes_near(mesh, Side::ymin, 0).size(), 5u * 3);
  EXPECT_EQ(nodes_near(mesh, Side::ymax, 0).size(), 5u * 3);
  EXPECT_EQ(nodes_near(mesh, Side::zmin, 0).size(), 5u * 4);
  EXPECT_EQ(nodes_near(mesh, Side::zmax, 0).size(), 5u * 4);
  for (const std::int32_t i : nodes_near(mesh, Side::ymax, 0))
    EXPECT_DOUBLE_EQ(mesh.points()[static_cast<std::size_t>(i)][1], 0.8);
}

TEST(NodesNear, DepthIsAFractionOfTheExtent) {
  const auto mesh = softsim::box_mesh({4, 1, 1}, {8, 1, 1});
  EXPECT_EQ(nodes_near(mesh, Side::xmin, 0.2).size(), 4u);
  EXPECT_EQ(nodes_near(mesh, Side::xmin, 0.25).size(), 8u);
  EXPECT_EQ(nodes_near(mesh, Side::xmax, 0.5).size(), 12u);
  EXPECT_EQ(nodes_near(mesh, Side::xmax, 1).size(), mesh.points().size());
}

TEST(NodesNear, RoundingOfASideLosesNoNode) {
  auto points = softsim::box_mesh({3, 3, 1}, {1, 1, 1}).points();
  for (std::size_t i = 0; i < points.size(); i += 2) points[i][2] = std::nextafter(points[i][2], 2.0);
  const softsim::TetrahedralMesh mesh(points, softsim::box_mesh({3, 3, 1}, {1, 1, 1}).tetrahedra());
  EXPECT_EQ(nodes_near(mesh, Side::zmax, 0).size(), 16u);
  EXPECT_EQ(nodes_near(mesh, Side::zmin, 0).size(), 16u);
}

TEST(NodesNear, RefusesADepthOutsideZeroToOne) {
  const auto mesh = softsim::box_mesh({1, 1, 1}, {1, 1, 1});
  for (const double depth : {-0.1, 1.5, std::numeric_limits<double>::quiet_NaN()}) {
    try {
      (void)nodes_near(mesh, Side::xmin, depth);
      ADD_FAILURE() << depth << " was accepted";
    } catch (const std::invalid_argument& error) {
      EXPECT_EQ(std::string(error.what()), "depth " + softsim::to_text(depth) + ": must lie in [0, 1]");
    }
  }
}

}  // namespace selection_test
