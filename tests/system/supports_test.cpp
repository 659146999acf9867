// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/system/supports.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "potential/bodies.hpp"
#include "potential/truss.hpp"
#include "softsim/material/neo_hookean.hpp"
#include "softsim/potential/dead_load.hpp"
#include "softsim/potential/elastic.hpp"
#include "softsim/system/system.hpp"

namespace supports_test {

using bodies::Vec;
using softsim::TetrahedralMesh;

// A cube of 3^3 nodes, numbered (k 3 + j) 3 + i, corner 0 at (1, 2, 3), edge 2.
TetrahedralMesh cube() { return softsim::box_mesh({2, 2, 2}, {2, 2, 2}, {1, 2, 3}); }

// Two such cubes that do not touch; the second has the nodes from 27 on, its corner at (11, 2, 3).
TetrahedralMesh two_cubes() {
  TetrahedralMesh one = cube();
  std::vector<Vec> points = one.points();
  std::vector<softsim::Tetrahedron> tetrahedra = one.tetrahedra();
  for (const Vec& x : one.points()) points.push_back(x + Vec(10, 0, 0));
  for (softsim::Tetrahedron v : one.tetrahedra()) {
    for (std::int32_t& i : v) i += 27;
    tetrahedra.push_back(v);
  }
  return {points, tetrahedra};
}

auto make_system(const TetrahedralMesh& mesh) {
  return softsim::System(mesh, softsim::elastic(mesh, softsim::NeoHookean::from_young_poisson(10, 0.3)),
                         softsim::gravity(mesh, 1, {0, 0, -1}));
}

template <class S>
std::string refusal(const S& system) {
  return bodies::refusal([&] { return softsim::require_supports(system), 0; });
}

const std::string free_cube = "static solve: piece 0 (27 nodes, around 2, 3, 4) is free to move: ";
const std::string needed = " held, and at least three that are not in line are needed";

TEST(Supports, AFreePieceIsRefused) {
  EXPECT_EQ(refusal(make_system(cube())), free_cube + "0 of its nodes are" + needed);
}

TEST(Supports, OneNodeIsRefused) {
  auto system = make_system(cube());
  system.prescribed.fix({13});
  EXPECT_EQ(refusal(system), free_cube + "1 of its nodes is" + needed);
}

TEST(Supports, TwoNodesAreRefused) {
  auto system = make_system(cube());
  system.prescribed.fix({0, 26});
  EXPECT_EQ(refusal(system), free_cube + "2 of its nodes are" + needed);
}

TEST(Supports, ThreeNodesInLineAreRefused) {
  for (const std::vector<std::int32_t>& line :
       {std::vector<std::int32_t>{0, 1, 2}, {0, 13, 26}, {9, 13, 17}}) {
    auto system = make_system(cube());
    system.prescribed.fix(line);
    EXPECT_EQ(refusal(system), free_cube + "3 of its nodes are" + needed);
  }
}

TEST(Supports, ThreeNodesNotInLineHold) {
  for (const std::vector<std::int32_t>& corner :
       {std::vector<std::int32_t>{0, 1, 3}, {0, 2, 24}, {26, 13, 1}}) {
    auto system = make_system(cube());
    system.prescribed.fix(corner);
    EXPECT_EQ(refusal(system), "");
  }
}

// A node that nothing is attached to cannot turn, but it can move.
TEST(Supports, ANodeAloneHasToBeHeldAltogether) {
  truss::Truss t(0.3, 1);  // no bar goes to its node 3
  EXPECT_EQ(refusal(t.system), "");
  t.system.prescribed.release(3);
  t.system.prescribed.set(3, 0, 0);
  t.system.prescribed.set(3, 1, 0);
  EXPECT_EQ(refusal(t.system),
            "static solve: piece 1 (1 nodes, around 0, 1, 0) is free to move: 1 of its nodes is" + needed);
}

TEST(Supports, RollersOnThreePlanesHold) {
  auto system = make_system(cube());
  for (int k = 0; k < 3; ++k)
    for (int j = 0; j < 3; ++j) {
      system.prescribed.set((k * 3 + j) * 3, 0, 0);
      system.prescribed.set((k * 3) * 3 + j, 1, 0);
      system.prescribed.set(k * 3 + j, 2, 0);
    }
  EXPECT_EQ(refusal(system), "");
}

// Six rollers, 3-2-1: the least that holds a body. Five leave a motion.
TEST(Supports, SixRollersHoldAndFiveDoNot) {
  auto system = make_system(cube());
  for (const std::int32_t i : {0, 2, 6}) system.prescribed.set(i, 2, 0);
  for (const std::int32_t i : {0, 2}) system.prescribed.set(i, 1, 0);
  EXPECT_EQ(refusal(system), free_cube + "3 of its nodes are" + needed);
  system.prescribed.set(0, 0, 0);
  EXPECT_EQ(refusal(system), "");
}

// A whole face on rollers still slides and turns in its plane.
TEST(Supports, RollersOnOnePlaneAreRefused) {
  auto system = make_system(cube());
  for (int n = 0; n < 9; ++n) system.prescribed.set(n, 2, 0);
  EXPECT_EQ(refusal(system), free_cube + "9 of its nodes are" + needed);
}

TEST(Supports, EveryPieceHasToBeHeld) {
  auto system = make_system(two_cubes());
  system.prescribed.fix({0, 1, 3});
  EXPECT_EQ(refusal(system),
            "static solve: piece 1 (27 nodes, around 12, 3, 4) is free to move: 0 of its nodes are" + needed);
  system.prescribed.fix({27, 28});
  EXPECT_EQ(refusal(system),
            "static solve: piece 1 (27 nodes, around 12, 3, 4) is free to move: 2 of its nodes are" + needed);
  system.prescribed.fix({35});
  EXPECT_EQ(refusal(system), "");
  system.prescribed.release(1);
  EXPECT_EQ(refusal(system),
            "static solve: piece 0 (27 nodes, around 2, 3, 4) is free to move: 2 of its nodes are" + needed);
}

// The measure has no unit: a body of a millimetre far from the origin is judged as a big one here.
TEST(Supports, AreJudgedBySizeNotByUnit) {
  const TetrahedralMesh tiny = softsim::box_mesh({2, 2, 2}, {1e-3, 1e-3, 1e-3}, {100, -50, 20});
  auto system = make_system(tiny);
  system.prescribed.fix({0, 1, 2});
  EXPECT_NE(refusal(system), "");
  system.prescribed.fix({4});
  EXPECT_EQ(refusal(system), "");
}

}  // namespace supports_test
