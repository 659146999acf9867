// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/mesh/isoparametric_mesh.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "potential/bodies.hpp"
#include "softsim/mesh/generators.hpp"
#include "softsim/mesh/hexahedral_mesh.hpp"
#include "softsim/mesh/quadratic_tetrahedral_mesh.hpp"
#include "softsim/mesh/selection.hpp"

namespace isoparametric_mesh_test {

using bodies::Matrix, bodies::Random, bodies::Vec, bodies::refusal;
using softsim::HexahedralMesh, softsim::Hexahedron, softsim::QuadraticTetrahedralMesh;

static_assert(softsim::SolidMesh<HexahedralMesh> && softsim::SolidMesh<QuadraticTetrahedralMesh>);
static_assert(softsim::SolidMesh<softsim::TetrahedralMesh> && softsim::PointMesh<softsim::TetrahedralMesh>);
static_assert(!softsim::SolidMesh<std::vector<Vec>> && !softsim::PointMesh<std::vector<Vec>>);

using Points = std::vector<Vec>;

const Hexahedron one{0, 1, 2, 3, 4, 5, 6, 7};
Points cube() {
  return {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
}

TEST(HexahedralMesh, KeepsACleanMeshAndDropsUnusedNodes) {
  Points points = cube();
  points.insert(points.begin(), Vec(9, 9, 9));
  const HexahedralMesh mesh(points, {{1, 2, 3, 4, 5, 6, 7, 8}}, {7});
  EXPECT_EQ(mesh.points(), cube());
  EXPECT_EQ(mesh.elements(), std::vector<Hexahedron>{one});
  EXPECT_EQ(mesh.region(), std::vector<int>{7});
  EXPECT_EQ(mesh.source_node().front(), 1);
  EXPECT_EQ(mesh.warnings(), std::vector<std::string>{"1 node dropped that no hexahedron uses"});
  EXPECT_DOUBLE_EQ(mesh.volume(), 1);
}

TEST(HexahedralMesh, RefusesBadInputByName) {
  EXPECT_EQ(refusal([] { return HexahedralMesh(cube(), {}); }), "mesh: no hexahedra");
  EXPECT_EQ(refusal([] {
              return HexahedralMesh(cube(), {one}, {1, 2});
            }),
            "mesh: 2 region numbers for 1 hexahedra");
  EXPECT_EQ(refusal([] {
              return HexahedralMesh(cube(), {one, {0, 1, 2, 3, 4, 5, 6, 8}});
            }),
            "hexahedron 1: node 8 is out of range (the mesh has 8 nodes)");
  EXPECT_EQ(refusal([] {
              return HexahedralMesh(cube(), {{0, 1, 2, 3, 4, 5, 6, 3}});
            }),
            "hexahedron 0: node 3 is repeated");
  Points points = cube();
  points[2][1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(refusal([&] { return HexahedralMesh(points, {one}); }),
            "node 2: a coordinate is not a finite number");
}

TEST(HexahedralMesh, RefusesElementsThatAreTurnedInsideOutOrFlat) {
  // bottom and top exchanged: det dX/dxi = -1/8 everywhere
  EXPECT_EQ(refusal([] {
              return HexahedralMesh(cube(), {one, {4, 5, 6, 7, 0, 1, 2, 3}});
            }),
            "hexahedron 1: inverted, Jacobian determinant -0.125 m^3 at (xi, eta, zeta) = (-0.577350269, "
            "-0.577350269, -0.577350269) is not positive");
  Points flat = cube();
  for (Vec& x : flat) x[2] *= 1e-13;
  EXPECT_NE(refusal([&] { return HexahedralMesh(flat, {one}); }).find("hexahedron 0: degenerate"),
            std::string::npos);
  // one corner pushed through the element: inverted at the points next to it only
  Points dented = cube();
  dented[6] = Vec(0.2, 0.2, 0.2);
  EXPECT_NE(refusal([&] { return HexahedralMesh(dented, {one}); }).find("hexahedron 0: inverted"),
            std::string::npos);
}

// Volume inside bilinear faces by the divergence theorem: a bilinear face encloses the mean of what the two
// ways of splitting it into triangles do.
double volume_from_faces(const Points& X) {
  double sum = 0;
  for (const auto& f : softsim::TrilinearHexahedronShape::faces)
    for (std::size_t i = 0; i < 4; ++i) {
      const Vec &a = X[f[i]], &b = X[f[(i + 1) % 4]], &c = X[f[(i + 2) % 4]];
      sum += a.dot(b.cross(c)) / 12;
    }
  return sum;
}

TEST(HexahedralMesh, VolumesAreExact) {
  Random random(1);
  for (int k = 0; k < 20; ++k) {
    Points skewed = cube(), general = cube();
    Matrix A = Matrix::Identity();
    A += 0.4 * random.matrix();
    for (Vec& x : skewed) x = A * x + Vec(1, 2, 3);
    EXPECT_NEAR(HexahedralMesh(skewed, {one}).volume(0), A.determinant(), 1e-14);
    for (Vec& x : general) x = A * (x + 0.12 * random.vec()) + Vec(1, 2, 3);
    EXPECT_NEAR(HexahedralMesh(general, {one}).volume(0), volume_from_faces(general), 1e-14);
  }
}

TEST(BoxHexahedra, FillTheBoxCellByCell) {
  const HexahedralMesh mesh = softsim::box_hexahedra({3, 2, 4}, {3, 1, 2}, {-1, 5, 2});
  EXPECT_EQ(mesh.points(), softsim::box_mesh({3, 2, 4}, {3, 1, 2}, {-1, 5, 2}).points());
  EXPECT_EQ(mesh.elements().size(), 24u);
  for (std::size_t e = 0; e < 24; ++e) EXPECT_NEAR(mesh.volume(e), 0.25, 1e-14);
  EXPECT_EQ(softsim::nodes_near(mesh, softsim::Side::xmax, 0).size(), 15u);
  EXPECT_EQ(refusal([] {
              return softsim::box_hexahedra({3, 0, 1}, {1, 1, 1});
            }),
            "cells[1] 0: must be at least 1");
}

TEST(BoundaryFaces, AreTheSurfaceOfTheBox) {
  const auto hexahedra = softsim::box_hexahedra({3, 2, 4}, {1, 1, 1});
  const auto faces = softsim::boundary_faces(hexahedra);
  EXPECT_EQ(faces.size(), 2u * (6 + 8 + 12));
  EXPECT_EQ(softsim::faces_on(faces, softsim::nodes_near(hexahedra, softsim::Side::zmin, 0)).size(), 6u);
  const QuadraticTetrahedralMesh tetrahedra(softsim::box_mesh({3, 2, 4}, {1, 1, 1}));
  const auto triangles = softsim::boundary_faces(tetrahedra);
  EXPECT_EQ(triangles.size(), 4u * (6 + 8 + 12));
  EXPECT_EQ(softsim::faces_on(triangles, softsim::nodes_near(tetrahedra, softsim::Side::zmin, 0)).size(),
            12u);
}

TEST(QuadraticTetrahedralMesh, PutsNodesInTheMiddleOfTheEdges) {
  const softsim::TetrahedralMesh linear({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}},
                                        {{0, 1, 2, 3}, {1, 2, 3, 4}}, {3, 5});
  const QuadraticTetrahedralMesh mesh(linear);
  EXPECT_EQ(mesh.points().size(), 5u + 9u);  // three edges are shared
  EXPECT_EQ(mesh.region(), (std::vector<int>{3, 5}));
  for (std::size_t e = 0; e < 2; ++e) {
    const auto X = mesh.element_points(e);
    for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(mesh.elements()[e][i], linear.tetrahedra()[e][i]);
    constexpr std::size_t edge[6][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};  // VTK
    for (std::size_t k = 0; k < 6; ++k) EXPECT_EQ(X[4 + k], (0.5 * (X[edge[k][0]] + X[edge[k][1]])).eval());
    EXPECT_NEAR(mesh.volume(e), linear.volume(e), 1e-15);
  }
}

TEST(QuadraticTetrahedralMesh, RefusesBadInputByName) {
  const QuadraticTetrahedralMesh mesh(softsim::box_mesh({1, 1, 1}, {1, 1, 1}));
  auto elements = mesh.elements();
  std::swap(elements[4][0], elements[4][1]);  // corners without their edge nodes
  EXPECT_NE(refusal([&] {
              return QuadraticTetrahedralMesh(mesh.points(), elements);
            }).find("ten-node tetrahedron 4: "),
            std::string::npos);
  auto points = mesh.points();
  points[static_cast<std::size_t>(mesh.elements()[2][7])] =
      points[static_cast<std::size_t>(mesh.elements()[2][0])];
  EXPECT_NE(
      refusal([&] { return QuadraticTetrahedralMesh(points, mesh.elements()); }).find("Jacobian determinant"),
      std::string::npos);
  EXPECT_EQ(refusal([&] { return QuadraticTetrahedralMesh(mesh.points(), {}); }),
            "mesh: no ten-node tetrahedra");
}

// Edge nodes on the circle: the section between chord and circle, 8 n of them, shrinks from O(n^-2) to
// O(n^-4) of the area.
TEST(QuadraticTetrahedralMesh, TakesCurvedEdges) {
  double error[2];
  for (const int n : {1, 2}) {
    const QuadraticTetrahedralMesh straight(softsim::cylinder_mesh(1, 0.5, n, 1));
    Points points = straight.points();
    for (const auto& face : softsim::boundary_faces(straight))
      for (std::size_t k = 0; k < 3; ++k) {
        const auto radius = [&](std::size_t i) {
          return straight.points()[static_cast<std::size_t>(face[i])].head<2>().norm();
        };
        if (radius(k) < 1 - 1e-9 || radius((k + 1) % 3) < 1 - 1e-9) continue;
        Vec& x = points[static_cast<std::size_t>(face[3 + k])];
        x.head<2>().normalize();
      }
    const double volume = QuadraticTetrahedralMesh(points, straight.elements()).volume();
    error[n - 1] = std::abs(2 * volume / std::numbers::pi - 1);
  }
  EXPECT_LT(error[0], 1e-3);  // the polygon of 8 corners misses 10 %
  EXPECT_GT(std::log2(error[0] / error[1]), 3.5);
}

// int 1 dV, int x dV and int x y dV of a body, from its shape integrals and products: exact on general
// trilinear hexahedra and straight ten-node tetrahedra of the unit cube.
template <class Mesh>
void expect_exact_moments(const Mesh& mesh) {
  double volume = 0, first = 0, second = 0, lumped = 0;
  for (std::size_t e = 0; e < mesh.elements().size(); ++e) {
    const auto X = mesh.element_points(e);
    const auto integrals = mesh.shape_integrals(e);
    const auto lumps = mesh.lumped_volumes(e);
    const auto products = mesh.shape_products(e);
    for (std::size_t i = 0; i < X.size(); ++i) {
      volume += integrals[i];
      first += integrals[i] * X[i][0];
      lumped += lumps[i];
      EXPECT_GT(lumps[i], 0);
      double row = 0;
      for (std::size_t j = 0; j < X.size(); ++j) {
        const double m = products(static_cast<int>(i), static_cast<int>(j));
        second += X[i][0] * m * X[j][1];
        row += m;
      }
      EXPECT_NEAR(row, integrals[i], 1e-15);
    }
  }
  EXPECT_NEAR(volume, 1, 1e-13);
  EXPECT_NEAR(mesh.volume(), 1, 1e-13);
  EXPECT_NEAR(lumped, 1, 1e-13);
  EXPECT_NEAR(first, 0.5, 1e-13);
  EXPECT_NEAR(second, 0.25, 1e-13);
}

TEST(SolidMeshes, IntegrateExactly) {
  expect_exact_moments(bodies::distorted_cube(2, 1));
  expect_exact_moments(QuadraticTetrahedralMesh(bodies::distorted_cube(2, 1)));
  const HexahedralMesh regular = softsim::box_hexahedra({3, 3, 3}, {1, 1, 1});
  Points points = regular.points();
  Random random(2);
  for (Vec& x : points)
    if ((x - Vec(0.5, 0.5, 0.5)).cwiseAbs().maxCoeff() < 0.4) x += 0.08 * random.vec();
  expect_exact_moments(HexahedralMesh(points, regular.elements()));
}

// HRZ: 1/36 of the volume on a corner, 4/27 on an edge node, known for straight sides.
TEST(QuadraticTetrahedralMesh, LumpsByTheScaledDiagonal) {
  const QuadraticTetrahedralMesh mesh(softsim::box_mesh({1, 1, 1}, {6, 1, 1}));
  const auto volumes = mesh.lumped_volumes(0);
  for (std::size_t i = 0; i < 10; ++i) EXPECT_NEAR(volumes[i], i < 4 ? 1.0 / 36 : 4.0 / 27, 1e-15) << i;
  EXPECT_NEAR(mesh.shape_integrals(0)[0], -1.0 / 20, 1e-15);
}

}  // namespace isoparametric_mesh_test
