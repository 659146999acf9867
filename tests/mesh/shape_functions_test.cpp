// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/mesh/shape_functions.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <random>

#include "softsim/mesh/hexahedral_mesh.hpp"
#include "softsim/mesh/quadratic_tetrahedral_mesh.hpp"

namespace shape_functions_test {

using softsim::BilinearQuadrilateral, softsim::QuadraticTetrahedronShape, softsim::QuadraticTriangle,
    softsim::TrilinearHexahedronShape;

static_assert(softsim::ShapeFunctions<TrilinearHexahedronShape>);
static_assert(softsim::ShapeFunctions<QuadraticTetrahedronShape>);
static_assert(!softsim::ShapeFunctions<QuadraticTriangle> && !softsim::ShapeFunctions<int>);

// Reference positions of the nodes in VTK's order.
template <class S>
struct Nodes;
template <>
struct Nodes<TrilinearHexahedronShape> {
  static constexpr std::array<std::array<double, 3>, 8> xi{
      {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}, {-1, -1, 1}, {1, -1, 1}, {1, 1, 1}, {-1, 1, 1}}};
};
template <>
struct Nodes<QuadraticTetrahedronShape> {
  static constexpr std::array<std::array<double, 3>, 10> xi{{{0, 0, 0},
                                                             {1, 0, 0},
                                                             {0, 1, 0},
                                                             {0, 0, 1},
                                                             {0.5, 0, 0},
                                                             {0.5, 0.5, 0},
                                                             {0, 0.5, 0},
                                                             {0, 0, 0.5},
                                                             {0.5, 0, 0.5},
                                                             {0, 0.5, 0.5}}};
};
template <>
struct Nodes<BilinearQuadrilateral> {
  static constexpr std::array<std::array<double, 2>, 4> xi{{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};
};
template <>
struct Nodes<QuadraticTriangle> {
  static constexpr std::array<std::array<double, 2>, 6> xi{
      {{0, 0}, {1, 0}, {0, 1}, {0.5, 0}, {0.5, 0.5}, {0, 0.5}}};
};

template <class S>
class Shapes : public ::testing::Test {};
using AllShapes = ::testing::Types<TrilinearHexahedronShape, QuadraticTetrahedronShape, BilinearQuadrilateral,
                                   QuadraticTriangle>;
TYPED_TEST_SUITE(Shapes, AllShapes);

TYPED_TEST(Shapes, AreOneAtTheirOwnNodeAndZeroAtTheOthers) {
  for (std::size_t j = 0; j < Nodes<TypeParam>::xi.size(); ++j) {
    const auto N = TypeParam::values(Nodes<TypeParam>::xi[j]);
    for (int i = 0; i < TypeParam::nodes; ++i) EXPECT_EQ(N[i], i == static_cast<int>(j) ? 1 : 0) << i << j;
  }
}

TYPED_TEST(Shapes, SumToOneAndReproducePositions) {
  std::mt19937 bits(1);
  std::uniform_real_distribution<double> number(-1, 1);
  auto xi = Nodes<TypeParam>::xi[0];
  for (double& x : xi) x = number(bits);
  const auto N = TypeParam::values(xi);
  EXPECT_NEAR(N.sum(), 1, 1e-14);
  EXPECT_LT(TypeParam::gradients(xi).colwise().sum().norm(), 1e-14);
  for (std::size_t a = 0; a < xi.size(); ++a) {
    double sum = 0;
    for (std::size_t i = 0; i < Nodes<TypeParam>::xi.size(); ++i)
      sum += N[static_cast<int>(i)] * Nodes<TypeParam>::xi[i][a];
    EXPECT_NEAR(sum, xi[a], 1e-14);
  }
}

// Central differences of polynomials of degree 3 or less along one axis: h^2/6 f''' is zero for all of them.
TYPED_TEST(Shapes, GradientsAreTheDerivatives) {
  auto xi = Nodes<TypeParam>::xi[0];
  for (std::size_t a = 0; a < xi.size(); ++a) xi[a] = 0.1 + 0.13 * static_cast<double>(a);
  const auto dN = TypeParam::gradients(xi);
  for (std::size_t a = 0; a < xi.size(); ++a) {
    auto ahead = xi, behind = xi;
    ahead[a] += 0.125;
    behind[a] -= 0.125;
    const auto difference = ((TypeParam::values(ahead) - TypeParam::values(behind)) / 0.25).eval();
    EXPECT_LT((dN.col(static_cast<int>(a)) - difference).norm(), 1e-14);
  }
}

double factorial(int n) { return n < 2 ? 1 : n * factorial(n - 1); }

template <class Rule>
double integral(const Rule& rule, const std::array<int, 3>& power) {
  double sum = 0;
  for (const auto& point : rule) {
    double f = point.weight;
    for (std::size_t a = 0; a < point.xi.size(); ++a) f *= std::pow(point.xi[a], power[a]);
    sum += f;
  }
  return sum;
}

// int xi^a eta^b zeta^c = a! b! c! / (a + b + c + d)! on the unit simplex of dimension d; the points are
// known to 20 digits.
template <class Rule>
void expect_exact_on_simplex(const Rule& rule, int degree, int dimension) {
  for (int a = 0; a <= degree; ++a)
    for (int b = 0; a + b <= degree; ++b)
      for (int c = 0; a + b + c <= (dimension == 3 ? degree : a + b); ++c)
        EXPECT_NEAR(integral(rule, {a, b, c}),
                    factorial(a) * factorial(b) * factorial(c) / factorial(a + b + c + dimension), 1e-16)
            << a << b << c;
  for (const auto& point : rule) EXPECT_GT(point.weight, 0);
}

TEST(IntegrationRules, OnTheTetrahedronAreExactForTheirDegree) {
  expect_exact_on_simplex(QuadraticTetrahedronShape::stiffness_rule, 2, 3);
  expect_exact_on_simplex(QuadraticTetrahedronShape::mass_rule, 5, 3);
  // and no more, by which the test knows one rule from another
  EXPECT_GT(std::abs(integral(QuadraticTetrahedronShape::stiffness_rule, {3, 0, 0}) - 6.0 / 720), 1e-6);
  EXPECT_GT(std::abs(integral(QuadraticTetrahedronShape::mass_rule, {6, 0, 0}) - 720.0 / 362880), 1e-6);
}

TEST(IntegrationRules, OnTheTriangleAreExactForTheirDegree) {
  expect_exact_on_simplex(QuadraticTriangle::rule, 4, 2);
}

TEST(IntegrationRules, OfGaussAreExactForTheirDegreeAlongEachAxis) {
  const auto exact = [](int n) { return n % 2 == 0 ? 2.0 / (n + 1) : 0; };
  for (int a = 0; a <= 5; ++a)
    for (int b = 0; b <= 5; ++b)
      for (int c = 0; c <= 5; ++c) {
        EXPECT_NEAR(integral(TrilinearHexahedronShape::mass_rule, {a, b, c}), exact(a) * exact(b) * exact(c),
                    1e-14);
        if (a <= 3 && b <= 3 && c <= 3) {
          EXPECT_NEAR(integral(TrilinearHexahedronShape::stiffness_rule, {a, b, c}),
                      exact(a) * exact(b) * exact(c), 1e-14);
        }
        if (a <= 3 && b <= 3 && c == 0) {
          EXPECT_NEAR(integral(BilinearQuadrilateral::rule, {a, b, c}), exact(a) * exact(b), 1e-14);
        }
      }
}

// The area vector of each face points away from the element's middle, and the face's own nodes are where its
// shape functions have them (an edge node halfway between the corners before and after it).
template <class S>
void expect_faces_outward() {
  const auto& X = Nodes<S>::xi;
  const auto at = [&](std::size_t i) { return softsim::Vec3<double>(X[i][0], X[i][1], X[i][2]); };
  softsim::Vec3<double> middle = softsim::Vec3<double>::Zero();
  for (std::size_t i = 0; i < X.size(); ++i) middle += at(i) / static_cast<double>(X.size());
  for (const auto& face : S::faces) {
    const std::array<double, 2> xi{0.3, 0.2};
    const auto N = S::Face::values(xi);
    const auto dN = S::Face::gradients(xi);
    softsim::Vec3<double> x = softsim::Vec3<double>::Zero(), a = x, b = x;
    for (std::size_t i = 0; i < face.size(); ++i) {
      const int k = static_cast<int>(i);
      x += N[k] * at(face[i]);
      a += dN(k, 0) * at(face[i]);
      b += dN(k, 1) * at(face[i]);
    }
    EXPECT_GT(a.cross(b).dot(x - middle), 0.01);
    // a plane face stays an affine map
    const std::array<double, 2> other{0.1, 0.4};
    const auto dM = S::Face::gradients(other);
    softsim::Vec3<double> c = softsim::Vec3<double>::Zero();
    for (std::size_t i = 0; i < face.size(); ++i) c += dM(static_cast<int>(i), 0) * at(face[i]);
    EXPECT_LT((a - c).norm(), 1e-14);
  }
}

TEST(Faces, PointOutward) {
  expect_faces_outward<TrilinearHexahedronShape>();
  expect_faces_outward<QuadraticTetrahedronShape>();
}

}  // namespace shape_functions_test
