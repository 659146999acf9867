// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/mesh/refinement.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "softsim/mesh/generators.hpp"

namespace refinement_test {

using softsim::refined, softsim::TetrahedralMesh, softsim::Tetrahedron, softsim::Vec3;

// A crooked box, whose tetrahedra have all three choices of the inner diagonal.
TetrahedralMesh crooked() {
  const TetrahedralMesh box = softsim::box_mesh({2, 3, 2}, {1, 2, 1.5});
  std::vector<Vec3<double>> X = box.points();
  for (auto& x : X)
    x += 0.08 * Vec3<double>(std::sin(7 * x[1] + 3 * x[2]), std::cos(5 * x[0]), std::sin(9 * x[0] - x[1]));
  std::vector<int> region;
  for (std::size_t t = 0; t < box.tetrahedra().size(); ++t) region.push_back(static_cast<int>(t % 3));
  return {X, box.tetrahedra(), region};
}

// Volume over that of the cube on the longest edge.
double worst_shape(const TetrahedralMesh& mesh) {
  double worst = 1;
  for (std::size_t t = 0; t < mesh.tetrahedra().size(); ++t) {
    double longest = 0;
    const Tetrahedron& v = mesh.tetrahedra()[t];
    for (std::size_t a = 0; a < 4; ++a)
      for (std::size_t b = 0; b < a; ++b)
        longest = std::max(longest, (mesh.points()[static_cast<std::size_t>(v[a])] -
                                     mesh.points()[static_cast<std::size_t>(v[b])])
                                        .norm());
    worst = std::min(worst, mesh.volume(t) / std::pow(longest, 3));
  }
  return worst;
}

TEST(Refinement, EightPartsOfAnEighth) {
  const TetrahedralMesh mesh = crooked(), fine = refined(mesh);
  ASSERT_EQ(fine.tetrahedra().size(), 8 * mesh.tetrahedra().size());
  for (std::size_t t = 0; t < fine.tetrahedra().size(); ++t) {
    EXPECT_NEAR(fine.volume(t), mesh.volume(t / 8) / 8, 1e-12 * mesh.volume(t / 8));
    EXPECT_EQ(fine.region()[t], mesh.region()[t / 8]);
  }
  for (std::size_t i = 0; i < mesh.points().size(); ++i) EXPECT_EQ(fine.points()[i], mesh.points()[i]);
}

// Every face belongs to two tetrahedra, or lies on the surface, which is cut into four.
TEST(Refinement, IsConforming) {
  const TetrahedralMesh mesh = crooked(), fine = refined(mesh);
  std::map<std::array<std::int32_t, 3>, int> faces;
  for (const Tetrahedron& t : fine.tetrahedra())
    for (std::size_t left_out = 0; left_out < 4; ++left_out) {
      std::array<std::int32_t, 3> face{};
      for (std::size_t i = 0, k = 0; i < 4; ++i)
        if (i != left_out) face[k++] = t[i];
      std::sort(face.begin(), face.end());
      ++faces[face];
    }
  std::size_t outside = 0;
  for (const auto& [face, count] : faces) {
    EXPECT_LE(count, 2);
    outside += count == 1 ? 1 : 0;
  }
  EXPECT_EQ(outside, 4 * softsim::boundary_triangles(mesh).size());
  EXPECT_EQ(softsim::boundary_triangles(fine).size(), outside);
}

// With the shortest diagonal the shape of the worst tetrahedron settles after the first cut.
TEST(Refinement, ShapesDoNotDegenerate) {
  TetrahedralMesh mesh = crooked();
  mesh = refined(mesh);
  const double first = worst_shape(mesh);
  for (int k = 0; k < 2; ++k) mesh = refined(mesh);
  EXPECT_GT(worst_shape(mesh), 0.999 * first);
}

}  // namespace refinement_test
