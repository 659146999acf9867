// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/mesh/tetrahedral_mesh.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "softsim/mesh/generators.hpp"

namespace tetrahedral_mesh_test {

using softsim::Tetrahedron, softsim::TetrahedralMesh, softsim::Triangle;
using Vec = softsim::Vec3<double>;
using Points = std::vector<Vec>;

Points unit_corners() { return {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}; }

/// Message of the exception that the constructor throws; empty if it accepts the mesh.
std::string refusal(Points points, std::vector<Tetrahedron> tetrahedra, std::vector<int> region = {}) {
  try {
    const TetrahedralMesh mesh(std::move(points), std::move(tetrahedra), std::move(region));
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return {};
}

TEST(TetrahedralMesh, KeepsACleanMeshAsItIs) {
  const TetrahedralMesh mesh(unit_corners(), {{0, 1, 2, 3}}, {7});
  EXPECT_EQ(mesh.points(), unit_corners());
  EXPECT_EQ(mesh.tetrahedra(), (std::vector<Tetrahedron>{{0, 1, 2, 3}}));
  EXPECT_EQ(mesh.region(), std::vector<int>{7});
  EXPECT_EQ(mesh.source_node(), (std::vector<std::int32_t>{0, 1, 2, 3}));
  EXPECT_TRUE(mesh.warnings().empty());
  EXPECT_DOUBLE_EQ(mesh.volume(0), 1.0 / 6);
}

TEST(TetrahedralMesh, RegionsDefaultToZero) {
  const TetrahedralMesh mesh = softsim::box_mesh({1, 1, 1}, {1, 1, 1});
  EXPECT_EQ(mesh.region(), std::vector<int>(6, 0));
}

TEST(TetrahedralMesh, RefusesAnEmptyMesh) { EXPECT_EQ(refusal(unit_corners(), {}), "mesh: no tetrahedra"); }

TEST(TetrahedralMesh, RefusesRegionsOfAnotherLength) {
  EXPECT_EQ(refusal(unit_corners(), {{0, 1, 2, 3}}, {1, 2}), "mesh: 2 region numbers for 1 tetrahedra");
}

TEST(TetrahedralMesh, RefusesCoordinatesThatAreNotFinite) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    Points points = unit_corners();
    points[2][1] = bad;
    EXPECT_EQ(refusal(points, {{0, 1, 2, 3}}), "node 2: a coordinate is not a finite number");
  }
}

TEST(TetrahedralMesh, RefusesNodeNumbersOutOfRange) {
  EXPECT_EQ(refusal(unit_corners(), {{0, 1, 2, 3}, {0, 1, 2, 4}}),
            "tetrahedron 1: node 4 is out of range (the mesh has 4 nodes)");
  EXPECT_EQ(refusal(unit_corners(), {{-1, 1, 2, 3}}),
            "tetrahedron 0: node -1 is out of range (the mesh has 4 nodes)");
}

TEST(TetrahedralMesh, RefusesRepeatedNodes) {
  EXPECT_EQ(refusal(unit_corners(), {{0, 1, 2, 1}}), "tetrahedron 0: node 1 is repeated");
}

TEST(TetrahedralMesh, RefusesInvertedTetrahedra) {
  Points points = unit_corners();
  for (Vec& x : points) x *= 6;
  EXPECT_EQ(refusal(points, {{0, 1, 2, 3}, {1, 0, 2, 3}}),
            "tetrahedron 1: inverted, volume -36 m^3 is not positive");
}

TEST(TetrahedralMesh, RefusesDegenerateTetrahedraAtAnyScale) {
  EXPECT_EQ(refusal({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, {{0, 1, 2, 3}}),
            "tetrahedron 0: degenerate, volume 0 m^3 at longest edge 1.41421356 m");
  for (const double scale : {1e-6, 1.0, 1e6}) {
    const auto with_height = [scale](double h) {
      return Points{{0, 0, 0}, {scale, 0, 0}, {0, scale, 0}, {0, 0, scale * h}};
    };
    EXPECT_NE(refusal(with_height(1e-12), {{0, 1, 2, 3}}).find("degenerate"), std::string::npos);
    EXPECT_EQ(refusal(with_height(1e-10), {{0, 1, 2, 3}}), "");
  }
}

TEST(TetrahedralMesh, DropsUnusedNodesAndSaysSo) {
  const Vec unused(9, 9, 9);
  const Points c = unit_corners();
  const TetrahedralMesh one({unused, c[0], c[1], c[2], c[3]}, {{1, 2, 3, 4}});
  EXPECT_EQ(one.points(), c);
  EXPECT_EQ(one.tetrahedra(), (std::vector<Tetrahedron>{{0, 1, 2, 3}}));
  EXPECT_EQ(one.source_node(), (std::vector<std::int32_t>{1, 2, 3, 4}));
  EXPECT_EQ(one.warnings(), std::vector<std::string>{"1 node dropped that no tetrahedron uses"});

  const TetrahedralMesh three({c[0], unused, c[1], unused, c[2], c[3], unused}, {{0, 2, 4, 5}});
  EXPECT_EQ(three.points(), c);
  EXPECT_EQ(three.source_node(), (std::vector<std::int32_t>{0, 2, 4, 5}));
  EXPECT_EQ(three.warnings(), std::vector<std::string>{"3 nodes dropped that no tetrahedron uses"});
}

TEST(TetrahedralMesh, VolumesAreSignedAndAddUp) {
  const Vec a(0, 0, 0), b(2, 0, 0), c(0, 3, 0), d(0, 0, 4);
  EXPECT_DOUBLE_EQ(softsim::tetrahedron_volume(a, b, c, d), 4);
  EXPECT_DOUBLE_EQ(softsim::tetrahedron_volume(b, a, c, d), -4);
  // A sum of 144 volumes of size 0.04.
  EXPECT_NEAR(softsim::box_mesh({2, 3, 4}, {1, 2, 3}).volume(), 6, 1e-13);
}

TEST(BoundaryTriangles, OfOneTetrahedronAreItsFourFacesOutward) {
  const TetrahedralMesh mesh(unit_corners(), {{0, 1, 2, 3}});
  const auto faces = softsim::boundary_triangles(mesh);
  ASSERT_EQ(faces.size(), 4u);
  const Vec centre(0.25, 0.25, 0.25);
  for (const Triangle& f : faces) {
    const Vec &a = mesh.points()[std::size_t(f[0])], &b = mesh.points()[std::size_t(f[1])],
              &c = mesh.points()[std::size_t(f[2])];
    EXPECT_GT((b - a).cross(c - a).dot(a - centre), 0);
  }
}

TEST(BoundaryTriangles, EncloseTheBodyWithoutGaps) {
  const TetrahedralMesh mesh = softsim::box_mesh({3, 2, 2}, {3, 1, 2}, {-1, 5, 2});
  std::map<std::pair<std::int32_t, std::int32_t>, int> edges;
  double area = 0, enclosed = 0;
  Vec sum = Vec::Zero();
  for (const Triangle& f : softsim::boundary_triangles(mesh)) {
    const Vec &a = mesh.points()[std::size_t(f[0])], &b = mesh.points()[std::size_t(f[1])],
              &c = mesh.points()[std::size_t(f[2])];
    const Vec normal = 0.5 * (b - a).cross(c - a);
    area += normal.norm();
    sum += normal;
    enclosed += normal.dot(a) / 3;
    for (std::size_t i = 0; i < 3; ++i) ++edges[{f[i], f[(i + 1) % 3]}];
  }
  // Each edge is walked once in each direction: closed and consistently oriented.
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1);
    EXPECT_TRUE(edges.contains({edge.second, edge.first}));
  }
  // Sums of a few dozen terms of size 1.
  EXPECT_NEAR(area, 2 * (3 * 1 + 1 * 2 + 2 * 3), 1e-12);
  EXPECT_LT(sum.norm(), 1e-12);
  EXPECT_NEAR(enclosed, 6, 1e-12);
}

}  // namespace tetrahedral_mesh_test
