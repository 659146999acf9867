// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/kinematics/mesh_shapes.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include "node_shape_checks.hpp"
#include "softsim/mesh/generators.hpp"
#include "softsim/mesh/hexahedral_mesh.hpp"
#include "softsim/mesh/quadratic_tetrahedral_mesh.hpp"

namespace mesh_shapes_test {

using namespace node_shape_checks;
using softsim::MeshShapes, softsim::TetrahedralMesh, softsim::HexahedralMesh,
    softsim::QuadraticTetrahedralMesh;

static_assert(softsim::NodeShapes<MeshShapes<TetrahedralMesh>>);
static_assert(softsim::NodeShapes<MeshShapes<HexahedralMesh>>);
static_assert(softsim::NodeShapes<MeshShapes<QuadraticTetrahedralMesh>>);
static_assert(
    softsim::NodeShapes<MeshShapes<softsim::IsoparametricMesh<softsim::QuadraticTetrahedronShape>>>);
static_assert(!softsim::NodeShapes<TetrahedralMesh>);

// The mesh turned by 45 degrees about z, then shifted.
template <class Mesh>
Mesh turned(const Mesh& mesh) {
  const softsim::Mat3<double> R = Eigen::AngleAxisd(std::acos(-1.0) / 4, Vec::UnitZ()).toRotationMatrix();
  std::vector<Vec> points;
  for (const Vec& x : mesh.points()) points.push_back(R * x + Vec(2, -1, 0.5));
  return Mesh(points, mesh.elements());
}

// Nodes moved at random by up to `amount` of a cell, those of the surface too.
template <class Mesh>
Mesh distorted(const Mesh& mesh, double amount, unsigned seed) {
  std::mt19937 bits(seed);
  std::uniform_real_distribution<double> number(-amount, amount);
  std::vector<Vec> points = mesh.points();
  for (Vec& x : points)
    for (int a = 0; a < 3; ++a) x[a] += number(bits);
  return Mesh(points, mesh.elements());
}

template <class Mesh>
Mesh box(const std::array<int, 3>& cells) {
  const Vec lengths(cells[0], cells[1], cells[2]);
  if constexpr (std::same_as<Mesh, HexahedralMesh>) {
    return softsim::box_hexahedra(cells, lengths);
  } else {
    return Mesh(softsim::box_mesh(cells, lengths));
  }
}

// Of an element of the mesh: a random point in the middle of its reference shape.
template <class Shapes>
std::array<double, 3> reference_point(std::mt19937& bits) {
  std::uniform_real_distribution<double> number(0.02, 0.98);
  std::array<double, 3> xi{number(bits), number(bits), number(bits)};
  if constexpr (Shapes::Domain::corners.size() == 8) {
    for (double& x : xi) x = 2 * x - 1;
  } else {
    for (double& x : xi) x /= 3;
  }
  return xi;
}

template <class Shapes>
Vec position(const Shapes& shapes, std::size_t e, const std::array<double, 3>& xi) {
  const auto X = shapes.mesh().element_points(e);
  const auto N = Shapes::Shape::values(xi);
  Vec x = Vec::Zero();
  for (std::size_t i = 0; i < X.size(); ++i) x += N[static_cast<int>(i)] * X[i];
  return x;
}

template <class Mesh>
class MeshShapesOf : public ::testing::Test {};
using AllMeshes = ::testing::Types<TetrahedralMesh, HexahedralMesh, QuadraticTetrahedralMesh>;
TYPED_TEST_SUITE(MeshShapesOf, AllMeshes);

TYPED_TEST(MeshShapesOf, FormAPartitionOfUnityAndReproduceLinearFields) {
  const double amount = std::same_as<TypeParam, QuadraticTetrahedralMesh> ? 0.03 : 0.15;
  for (const TypeParam& mesh : {box<TypeParam>({3, 2, 4}), turned(box<TypeParam>({3, 2, 4})),
                                turned(distorted(box<TypeParam>({3, 2, 4}), amount, 1))}) {
    const MeshShapes<TypeParam> shapes(mesh);
    EXPECT_TRUE(shapes.interpolates());
    EXPECT_EQ(shapes.support(), std::numeric_limits<double>::infinity());
    std::mt19937 bits(2);
    for (std::size_t e = 0; e < mesh.elements().size(); ++e) {
      const Vec x = position(shapes, e, reference_point<MeshShapes<TypeParam>>(bits));
      const auto s = shapes.at(x);
      expect_partition_of_unity(s, 1e-12);
      expect_linear_reproduction(shapes, x, 1e-12);
    }
  }
}

TYPED_TEST(MeshShapesOf, FindThePlaceThatAPointCameFrom) {
  const double amount = std::same_as<TypeParam, QuadraticTetrahedralMesh> ? 0.05 : 0.2;
  const MeshShapes<TypeParam> shapes(distorted(box<TypeParam>({4, 4, 4}), amount, 3));
  std::mt19937 bits(4);
  for (std::size_t e = 0; e < shapes.mesh().elements().size(); ++e) {
    const auto xi = reference_point<MeshShapes<TypeParam>>(bits);
    const auto place = shapes.place(position(shapes, e, xi));
    EXPECT_EQ(place.element, e);
    for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(place.xi[a], xi[a], 1e-12);
    const auto found = shapes.at(position(shapes, e, xi)), direct = shapes.at(e, xi);
    EXPECT_EQ(found.nodes, direct.nodes);
    for (std::size_t k = 0; k < found.nodes.size(); ++k)
      EXPECT_NEAR(found.values[k], direct.values[k], 1e-11);
  }
}

TYPED_TEST(MeshShapesOf, GradientsAreTheDerivatives) {
  const double amount = std::same_as<TypeParam, QuadraticTetrahedralMesh> ? 0.03 : 0.15;
  const MeshShapes<TypeParam> shapes(turned(distorted(box<TypeParam>({2, 2, 2}), amount, 5)));
  std::mt19937 bits(6);
  for (std::size_t e = 0; e < shapes.mesh().elements().size(); ++e)
    expect_gradients_are_derivatives(
        shapes, position(shapes, e, reference_point<MeshShapes<TypeParam>>(bits)), 1e-5, 1e-8);
}

TYPED_TEST(MeshShapesOf, AreOneAtTheirOwnNodeAndZeroAtTheOthers) {
  const MeshShapes<TypeParam> shapes(turned(box<TypeParam>({2, 3, 2})));
  for (std::size_t i = 0; i < shapes.nodes().size(); ++i) {
    const auto values = values_by_node(shapes.at(shapes.nodes()[i]));
    ASSERT_TRUE(values.count(static_cast<std::int32_t>(i)));
    for (const auto& [node, value] : values)
      EXPECT_NEAR(value, node == static_cast<std::int32_t>(i) ? 1 : 0, 1e-13);
  }
}

TYPED_TEST(MeshShapesOf, TakeTheLowestElementWhereSeveralTouch) {
  const MeshShapes<TypeParam> shapes(turned(box<TypeParam>({2, 2, 2})));
  const auto& elements = shapes.mesh().elements();
  for (std::size_t i = 0; i < shapes.nodes().size(); ++i) {
    std::size_t lowest = 0;
    while (std::find(elements[lowest].begin(), elements[lowest].end(), static_cast<std::int32_t>(i)) ==
           elements[lowest].end())
      ++lowest;
    EXPECT_EQ(shapes.place(shapes.nodes()[i]).element, lowest);
  }
}

// 1e-9 of the diagonal of a cell of the box, sqrt(3).
TYPED_TEST(MeshShapesOf, TakePointsThatAreOutsideByRoundingAndNoOthers) {
  const MeshShapes<TypeParam> shapes(box<TypeParam>({2, 2, 2}));
  EXPECT_NO_THROW((void)shapes.at(Vec(2 + 1.6e-9, 0.3, 0.6)));
  expect_linear_reproduction(shapes, Vec(2 + 1.6e-9, 0.3, 0.6), 1e-12);
  EXPECT_THROW((void)shapes.at(Vec(2 + 1.9e-9, 0.3, 0.6)), std::invalid_argument);
  EXPECT_NO_THROW((void)shapes.at(Vec(0.3, -1.6e-9, 0.6)));
  EXPECT_THROW((void)shapes.at(Vec(0.3, -1.9e-9, 0.6)), std::invalid_argument);
  EXPECT_THROW((void)shapes.at(Vec(1e9, -1e9, 0)), std::invalid_argument);
}

// The trilinear functions of a unit cube, turned: Bosman's Eq. 4.4 has rank 6 of 8 here (ERRATA).
TEST(MeshShapes, OfABrickAtFortyFiveDegreesAreTrilinear) {
  const MeshShapes<HexahedralMesh> shapes(turned(box<HexahedralMesh>({1, 1, 1})));
  Eigen::Matrix<double, 8, 8> P;
  for (int i = 0; i < 8; ++i) {
    const Vec X = shapes.nodes()[static_cast<std::size_t>(i)] - Vec(2, -1, 0.5);
    P.col(i) << X[0], X[1], X[2], X[0] * X[1], X[1] * X[2], X[0] * X[2], X.prod(), 1;
  }
  EXPECT_EQ(Eigen::FullPivLU<Eigen::MatrixXd>(P).setThreshold(1e-12).rank(), 6);
  const Vec y(0.2, 0.7, 0.4);
  const double c = std::sqrt(0.5);
  const auto s = shapes.at(Vec(c * (y[0] - y[1]) + 2, c * (y[0] + y[1]) - 1, y[2] + 0.5));
  for (std::size_t k = 0; k < 8; ++k) {
    const double along_x = k % 2 == 1 ? y[0] : 1 - y[0], along_y = k / 2 % 2 == 1 ? y[1] : 1 - y[1];
    EXPECT_NEAR(s.values[k], along_x * along_y * (k / 4 == 1 ? y[2] : 1 - y[2]), 1e-14);
  }
}

// Bricks about as crooked as a mesh allows.
TEST(MeshShapes, OfCrookedBricksFindEveryPlace) {
  std::mt19937 bits(8);
  std::uniform_real_distribution<double> number(-0.45, 0.45);
  int bricks = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    auto points = box<HexahedralMesh>({1, 1, 1}).points();
    for (Vec& x : points)
      for (int a = 0; a < 3; ++a) x[a] += number(bits);
    const auto element = box<HexahedralMesh>({1, 1, 1}).elements()[0];
    std::array<Vec, 8> X;
    for (std::size_t i = 0; i < 8; ++i) X[i] = points[static_cast<std::size_t>(element[i])];
    bool valid = true;
    for (int k = 0; k < 125; ++k) {
      const std::array<double, 3> xi{k % 5 / 2.0 - 1, k / 5 % 5 / 2.0 - 1, k / 25 / 2.0 - 1};
      valid = valid && softsim::jacobian<softsim::TrilinearHexahedronShape>(X, xi).determinant() > 0.005;
    }
    if (!valid) continue;
    ++bricks;
    const MeshShapes<HexahedralMesh> shapes{HexahedralMesh(points, {element})};
    for (int k = 0; k < 5; ++k) {
      const auto xi = reference_point<MeshShapes<HexahedralMesh>>(bits);
      const Vec x = position(shapes, 0, xi);
      try {
        const auto found = shapes.place(x).xi;
        EXPECT_LT((position(shapes, 0, found) - x).norm(), 1e-12);
      } catch (const std::invalid_argument& error) {
        ADD_FAILURE() << "trial " << trial << ": " << error.what();
      }
    }
  }
  EXPECT_GT(bricks, 500);
}

// One of the few places (2 in 60,000 of such bricks) that Newton's method does not find from the centre.
TEST(MeshShapes, OfAVeryCrookedBrickFindThePlaceFromAnotherStart) {
  const MeshShapes shapes{
      HexahedralMesh({Vec(0.30851, -0.222991, -0.184189), Vec(0.845751, -0.248409, -0.602779),
                      Vec(-0.743143, 0.722454, -0.647278), Vec(0.42305, 1.65378, -0.193402),
                      Vec(0.2646, 0.758318, 1.65419), Vec(0.513914, -0.728288, 0.206453),
                      Vec(0.0365809, 1.54406, 1.39374), Vec(0.955478, 0.775723, 0.554129)},
                     box<HexahedralMesh>({1, 1, 1}).elements())};
  for (const std::array<double, 3>& xi :
       {std::array{0.285482, -0.95308, 0.822415}, std::array{0.765779, -0.92466, 0.650932}}) {
    const Vec x = position(shapes, 0, xi);
    EXPECT_LT((position(shapes, 0, shapes.place(x).xi) - x).norm(), 1e-11);
  }
}

TEST(MeshShapes, ConsistencyIsThatOfTheElements) {
  EXPECT_EQ(MeshShapes(box<TetrahedralMesh>({1, 1, 1})).consistency(), 1);
  EXPECT_EQ(MeshShapes(box<HexahedralMesh>({1, 1, 1})).consistency(), 1);
  EXPECT_EQ(MeshShapes(box<QuadraticTetrahedralMesh>({1, 1, 1})).consistency(), 2);
  EXPECT_EQ(MeshShapes(distorted(box<QuadraticTetrahedralMesh>({1, 1, 1}), 0.01, 9)).consistency(), 1);
}

TEST(MeshShapes, OfQuadraticTetrahedraReproduceQuadraticFieldsUnlessCurved) {
  const auto field = [](const Vec& p) {
    return 1 + p[0] - 2 * p[0] * p[1] + 0.5 * p[1] * p[1] + p[2] * p[0] - p[2] * p[2];
  };
  const auto slope = [](const Vec& p) { return Vec(1 - 2 * p[1] + p[2], -2 * p[0] + p[1], p[0] - 2 * p[2]); };
  const auto skewed = distorted(softsim::box_mesh({2, 2, 2}, {2, 2, 2}), 0.15, 10);
  const MeshShapes shapes(turned(QuadraticTetrahedralMesh(skewed)));
  const MeshShapes linear(turned(skewed));
  std::mt19937 bits(11);
  for (std::size_t e = 0; e < shapes.mesh().elements().size(); ++e) {
    const Vec x = position(shapes, e, reference_point<MeshShapes<QuadraticTetrahedralMesh>>(bits));
    EXPECT_NEAR(interpolated(shapes, x, field), field(x), 1e-12);
    EXPECT_LT((interpolated_gradient(shapes, x, field) - slope(x)).norm(), 1e-11);
    EXPECT_GT(std::abs(interpolated(linear, x, field) - field(x)), 1e-4);
  }
  const MeshShapes curved(distorted(box<QuadraticTetrahedralMesh>({1, 1, 1}), 0.05, 12));
  const Vec x = position(curved, 0, {0.2, 0.3, 0.1});
  EXPECT_GT(std::abs(interpolated(curved, x, field) - field(x)), 1e-4);
}

// The edge 01 bulges beyond the box of the nodes: its outermost point is beside the middle node.
TEST(MeshShapes, FindPointsInTheBulgeOfACurvedElement) {
  std::vector<Vec> points{Vec(0, 0, 0), Vec(1, 0.6, 0), Vec(0, 1, 0), Vec(0, 0, 1)};
  for (const auto& [a, b] : softsim::QuadraticTetrahedronShape::edges)
    points.push_back((points[a] + points[b]) / 2);
  points[4] += Vec(0.1, -0.35, 0);
  const MeshShapes shapes{QuadraticTetrahedralMesh(points, {{0, 1, 2, 3, 4, 5, 6, 7, 8, 9}})};
  double lowest = 0;
  for (const Vec& p : points) lowest = std::min(lowest, p[1]);
  const Vec x = position(shapes, 0, {0.35, 0.001, 0.001});
  ASSERT_LT(x[1], lowest);
  EXPECT_NEAR(shapes.place(x).xi[0], 0.35, 1e-12);
}

TEST(MeshShapes, OfSliversHoldTheirPoints) {
  const MeshShapes shapes{
      TetrahedralMesh({Vec(0, 0, 0), Vec(1, 0, 0), Vec(0, 1, 0), Vec(0.3, 0.3, 1e-8)}, {{0, 1, 2, 3}})};
  const auto s = shapes.at(Vec(0.3, 0.3, 0.5e-8));
  EXPECT_NEAR(s.values[3], 0.5, 1e-7);
  EXPECT_THROW((void)shapes.at(Vec(0.3, 0.3, -0.5e-8)), std::invalid_argument);
}

TEST(MeshShapes, RefuseWhatIsNotThere) {
  const MeshShapes shapes(box<TetrahedralMesh>({2, 1, 1}));
  expect_refused([&] { (void)shapes.at(Vec(0.5, 2, -1)); },
                 "point (0.5, 2, -1) m: is in none of the 12 tetrahedra of the mesh");
  expect_refused([&] { (void)shapes.at(Vec(0.5, std::nan(""), 0)); },
                 "point (0.5, nan, 0) m: is in none of the 12 tetrahedra of the mesh");
  expect_refused([&] { (void)shapes.at(12, {0.1, 0.1, 0.1}); }, "tetrahedron 12: the mesh has 12");
  // outside of its reference shape an element may be inside out
  std::vector<Vec> wedge = box<HexahedralMesh>({1, 1, 1}).points();
  wedge[7] -= Vec(0.4, 0.4, 0.4);
  const MeshShapes hexahedron{HexahedralMesh(wedge, box<HexahedralMesh>({1, 1, 1}).elements())};
  EXPECT_THROW((void)hexahedron.at(0, {4, 4, 4}), std::invalid_argument);
  expect_refused([] { softsim::BoxGrid grid({}); }, "box grid: there are no boxes");
}

// The search looks at few elements, however many there are, in flat bodies too.
TEST(BoxGrid, FindsTheBoxesThatHoldAPoint) {
  for (const Vec& extent : {Vec(1, 1, 1), Vec(1, 1, 1e-9), Vec(1, 0, 0), Vec(0, 0, 0)}) {
    std::vector<softsim::BoundingBox> boxes;
    for (const Vec& p : random_points(300, 13, Vec::Zero(), extent)) boxes.push_back({p, p + 0.2 * extent});
    const softsim::BoxGrid grid(boxes);
    for (const Vec& p : random_points(100, 14, Vec::Zero(), 1.2 * extent)) {
      std::vector<std::size_t> expected;
      for (std::size_t b = 0; b < boxes.size(); ++b)
        if ((p.array() >= boxes[b].lower.array()).all() && (p.array() <= boxes[b].upper.array()).all())
          expected.push_back(b);
      EXPECT_EQ(grid.holding(p), expected);
    }
    EXPECT_TRUE(grid.holding(Vec(0, 0, 3)).empty());
  }
}

}  // namespace mesh_shapes_test
