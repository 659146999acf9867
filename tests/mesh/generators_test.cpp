// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/mesh/generators.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

namespace generators_test {

using softsim::Tetrahedron, softsim::TetrahedralMesh, softsim::Triangle, softsim::box_mesh,
    softsim::cylinder_mesh;
using Vec = softsim::Vec3<double>;

Vec point(const TetrahedralMesh& mesh, std::int32_t i) { return mesh.points()[static_cast<std::size_t>(i)]; }

/// How many tetrahedra share each face.
std::map<Triangle, int> face_counts(const TetrahedralMesh& mesh) {
  std::map<Triangle, int> count;
  for (const Tetrahedron& v : mesh.tetrahedra())
    for (std::size_t skip = 0; skip < 4; ++skip) {
      Triangle face{};
      for (std::size_t a = 0, n = 0; a < 4; ++a)
        if (a != skip) face[n++] = v[a];
      std::sort(face.begin(), face.end());
      ++count[face];
    }
  return count;
}

double boundary_area(const TetrahedralMesh& mesh) {
  double area = 0;
  for (const Triangle& f : softsim::boundary_triangles(mesh))
    area += 0.5 * (point(mesh, f[1]) - point(mesh, f[0])).cross(point(mesh, f[2]) - point(mesh, f[0])).norm();
  return area;
}

/// 1 for the regular tetrahedron, 0 for a flat one.
double worst_shape(const TetrahedralMesh& mesh) {
  double worst = 1;
  for (std::size_t t = 0; t < mesh.tetrahedra().size(); ++t) {
    const Tetrahedron& v = mesh.tetrahedra()[t];
    double longest = 0;
    for (std::size_t a = 0; a < 4; ++a)
      for (std::size_t b = 0; b < a; ++b)
        longest = std::max(longest, (point(mesh, v[a]) - point(mesh, v[b])).norm());
    worst = std::min(worst, 6 * std::numbers::sqrt2 * mesh.volume(t) / std::pow(longest, 3));
  }
  return worst;
}

template <class Function>
std::string refusal(Function&& f) {
  try {
    (void)f();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return {};
}

TEST(BoxMesh, NumbersNodesAlongXThenYThenZ) {
  const int nx = 2, ny = 3, nz = 4;
  const TetrahedralMesh mesh = box_mesh({nx, ny, nz}, {1, 2, 3}, {10, 20, 30});
  ASSERT_EQ(mesh.points().size(), 3u * 4 * 5);
  for (int k = 0; k <= nz; ++k)
    for (int j = 0; j <= ny; ++j)
      for (int i = 0; i <= nx; ++i) {
        const Vec expected(10 + i / 2.0, 20 + 2 * j / 3.0, 30 + 3 * k / 4.0);
        EXPECT_LT((point(mesh, (k * (ny + 1) + j) * (nx + 1) + i) - expected).norm(), 1e-14);
      }
}

TEST(BoxMesh, SplitsTheCellInTheDocumentedOrder) {
  // Corner (i, j, k) of a single cell has the number i + 2 j + 4 k.
  const std::vector<Tetrahedron> expected{{0, 1, 3, 7}, {0, 2, 6, 7}, {0, 4, 5, 7},
                                          {0, 1, 7, 5}, {0, 4, 7, 6}, {0, 2, 7, 3}};
  EXPECT_EQ(box_mesh({1, 1, 1}, {1, 1, 1}).tetrahedra(), expected);
}

TEST(BoxMesh, VisitsCellsAlongXThenYThenZ) {
  const TetrahedralMesh mesh = box_mesh({2, 3, 4}, {2, 3, 4});
  ASSERT_EQ(mesh.tetrahedra().size(), 6u * 2 * 3 * 4);
  std::size_t t = 0;
  for (int k = 0; k < 4; ++k)
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 2; ++i)
        for (int s = 0; s < 6; ++s, ++t) EXPECT_EQ(mesh.tetrahedra()[t][0], (k * 4 + j) * 3 + i);
}

TEST(BoxMesh, FillsTheBoxWithEqualPositiveVolumes) {
  const TetrahedralMesh mesh = box_mesh({3, 2, 4}, {0.3, 0.1, 0.8});
  // Coordinates below 1 and 24 cells: rounding of the coordinates, relative to the smallest edge 0.05.
  for (std::size_t t = 0; t < mesh.tetrahedra().size(); ++t)
    EXPECT_NEAR(mesh.volume(t) / (0.3 * 0.1 * 0.8 / 144), 1, 1e-13);
  EXPECT_NEAR(mesh.volume(), 0.024, 1e-15);
}

TEST(BoxMesh, IsConformingWithTheSurfaceOfTheBox) {
  const TetrahedralMesh mesh = box_mesh({3, 2, 4}, {3, 1, 2});
  std::size_t outer = 0;
  for (const auto& [face, count] : face_counts(mesh)) {
    ASSERT_TRUE(count == 1 || count == 2);
    if (count == 2) continue;
    ++outer;
    bool on_side = false;
    for (int axis = 0; axis < 3; ++axis)
      for (const double plane : {0.0, Vec(3, 1, 2)[axis]})
        on_side = on_side || std::all_of(face.begin(), face.end(),
                                         [&](std::int32_t i) { return point(mesh, i)[axis] == plane; });
    EXPECT_TRUE(on_side);
  }
  EXPECT_EQ(outer, 4u * (3 * 2 + 2 * 4 + 4 * 3));
  EXPECT_NEAR(boundary_area(mesh), 2 * (3 * 1 + 1 * 2 + 2 * 3), 1e-12);
}

TEST(BoxMesh, EndsExactlyAtItsLengths) {
  const TetrahedralMesh mesh = box_mesh({49, 1, 1}, {0.1, 1, 1});
  EXPECT_EQ(mesh.points()[49][0], 0.1);
}

TEST(BoxMesh, RefusesBadArgumentsByNameAndValue) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  EXPECT_EQ(refusal([] { return box_mesh({1, 0, 1}, {1, 1, 1}); }), "cells[1] 0: must be at least 1");
  EXPECT_EQ(refusal([] { return box_mesh({-3, 1, 1}, {1, 1, 1}); }), "cells[0] -3: must be at least 1");
  EXPECT_EQ(refusal([] {
              return box_mesh({1, 1, 1}, {1, 1, 0});
            }),
            "lengths[2] 0: must be positive and finite");
  EXPECT_EQ(refusal([] {
              return box_mesh({1, 1, 1}, {-2.5, 1, 1});
            }),
            "lengths[0] -2.5: must be positive and finite");
  EXPECT_EQ(refusal([=] {
              return box_mesh({1, 1, 1}, {1, inf, 1});
            }),
            "lengths[1] inf: must be positive and finite");
  EXPECT_NE(refusal([=] { return box_mesh({1, 1, 1}, {1, nan, 1}); }).find("lengths[1]"), std::string::npos);
  EXPECT_EQ(refusal([=] {
              return box_mesh({1, 1, 1}, {1, 1, 1}, {0, 0, -inf});
            }),
            "origin[2] -inf: must be finite");
  EXPECT_EQ(refusal([] {
              return box_mesh({1999, 1999, 1999}, {1, 1, 1});
            }),
            "cells 1999 x 1999 x 1999: 8e+09 nodes are more than 32-bit numbers can count");
}

TEST(CylinderMesh, HasTheVolumeOfItsRegularPolygon) {
  const double r = 0.5, length = 2;
  for (const int n : {1, 2, 3, 5}) {
    const TetrahedralMesh mesh = cylinder_mesh(r, length, n, 3);
    const double polygon = 4 * n * r * r * std::sin(std::numbers::pi / (4 * n));
    EXPECT_NEAR(mesh.volume(), polygon * length, 1e-13);
    // The polygon misses pi r^2 by the cubic term of the sine.
    const double missing = std::pow(std::numbers::pi, 3) / (96 * n * n) * r * r * length;
    EXPECT_NEAR(std::numbers::pi * r * r * length - mesh.volume(), missing, 0.05 * missing);
  }
}

TEST(CylinderMesh, IsConformingAndClosed) {
  const double r = 0.5, length = 2;
  const int n = 3, axial = 4;
  const TetrahedralMesh mesh = cylinder_mesh(r, length, n, axial);
  EXPECT_EQ(mesh.points().size(), 7u * 7 * 5);
  EXPECT_EQ(mesh.tetrahedra().size(), 6u * 6 * 6 * 4);
  for (const auto& [face, count] : face_counts(mesh)) EXPECT_TRUE(count == 1 || count == 2);
  const double side = 2 * r * std::sin(std::numbers::pi / (8 * n));
  const double polygon = 4 * n * r * r * std::sin(std::numbers::pi / (4 * n));
  EXPECT_NEAR(boundary_area(mesh), 8 * n * side * length + 2 * polygon, 1e-12);
}

TEST(CylinderMesh, SurfaceNodesLieOnTheCircleAtEqualSteps) {
  const double r = 0.7;
  const int n = 4;
  const TetrahedralMesh mesh = cylinder_mesh(r, 1, n, 1);
  std::set<long> steps;
  double lower = 1, upper = 0;
  for (const Vec& x : mesh.points()) {
    lower = std::min(lower, x[2]);
    upper = std::max(upper, x[2]);
    const double distance = x.head<2>().norm();
    EXPECT_LE(distance, r * (1 + 1e-15));
    if (distance < r * (1 - 1e-12)) continue;
    const double step = std::atan2(x[1], x[0]) / (2 * std::numbers::pi) * 8 * n;
    EXPECT_NEAR(step, std::round(step), 1e-12);
    steps.insert((std::lround(step) + 8 * n) % (8 * n));
  }
  EXPECT_EQ(steps.size(), 8u * n);
  EXPECT_EQ(lower, 0);
  EXPECT_EQ(upper, 1);
}

// Cells as long as wide: no worse than the Kuhn tetrahedra of a cube (0.27) but for the stretch of the map.
TEST(CylinderMesh, TetrahedraAreWellShaped) {
  for (const int n : {1, 2, 4, 8}) EXPECT_GT(worst_shape(cylinder_mesh(1, 2, n, 2 * n)), 0.25) << n;
}

TEST(CylinderMesh, RefusesBadArgumentsByNameAndValue) {
  EXPECT_EQ(refusal([] { return cylinder_mesh(0, 1, 1, 1); }), "radius 0: must be positive and finite");
  EXPECT_EQ(refusal([] { return cylinder_mesh(1, -1, 1, 1); }), "length -1: must be positive and finite");
  EXPECT_EQ(refusal([] { return cylinder_mesh(1, 1, 0, 1); }), "radial_cells 0: must be at least 1");
  EXPECT_EQ(refusal([] { return cylinder_mesh(1, 1, 1, -1); }), "axial_cells -1: must be at least 1");
  EXPECT_NE(refusal([] { return cylinder_mesh(1, 1, 2000000000, 1); }).find("32-bit"), std::string::npos);
}

}  // namespace generators_test
