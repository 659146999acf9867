// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/kinematics/isoparametric.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstddef>

#include "potential/bodies.hpp"
#include "softsim/core/batch.hpp"
#include "softsim/kinematics/quadratic_tetrahedron.hpp"
#include "softsim/kinematics/trilinear_hexahedron.hpp"
#include "softsim/material/st_venant_kirchhoff.hpp"
#include "softsim/potential/elastic.hpp"

namespace isoparametric_test {

using bodies::Matrix, bodies::Random, bodies::Vec, bodies::refusal;
using softsim::Batch, softsim::Local, softsim::QuadraticTetrahedron, softsim::TrilinearHexahedron;

static_assert(softsim::Kinematics<TrilinearHexahedron> && softsim::Kinematics<QuadraticTetrahedron, float>);
static_assert(softsim::Kinematics<TrilinearHexahedron, Batch<float, 4>>);
static_assert(softsim::Kinematics<QuadraticTetrahedron, Batch<double, 8>>);
static_assert(!softsim::NonlinearKinematics<TrilinearHexahedron>);

// Nodes of a distorted element of size 1.
template <class K>
typename K::Nodes distorted(Random& random, double by = 0.1) {
  typename K::Nodes X;
  if constexpr (K::points == 8) {
    X = {Vec(0, 0, 0), Vec(1, 0, 0), Vec(1, 1, 0), Vec(0, 1, 0),
         Vec(0, 0, 1), Vec(1, 0, 1), Vec(1, 1, 1), Vec(0, 1, 1)};
  } else {
    X = {Vec(0, 0, 0), Vec(1, 0, 0), Vec(0, 1, 0), Vec(0, 0, 1)};
    for (std::size_t k = 0; k < 6; ++k) X[4 + k] = (X[K::Shape::edges[k][0]] + X[K::Shape::edges[k][1]]) / 2;
    by /= 2;
  }
  for (Vec& x : X) x += by * random.vec();
  return X;
}

template <class K>
Local<double, K::points> random_local(Random& random) {
  Local<double, K::points> u;
  for (Vec& x : u.points) x = random.vec();
  return u;
}

template <class K>
class IsoparametricPoint : public ::testing::Test {};
using Both = ::testing::Types<TrilinearHexahedron, QuadraticTetrahedron>;
TYPED_TEST_SUITE(IsoparametricPoint, Both);

// Curved sides included: an affine map of the nodes is an affine map of the element.
TYPED_TEST(IsoparametricPoint, ReproducesAffineFields) {
  Random random(1);
  for (int n = 0; n < 20; ++n) {
    const auto X = distorted<TypeParam>(random);
    const Matrix A = Matrix::Identity() + random.matrix();
    Local<double, TypeParam::points> u;
    for (std::size_t i = 0; i < X.size(); ++i) u.points[i] = A * X[i] + Vec(1, 2, 3) - X[i];
    for (const auto& point : TypeParam::Shape::stiffness_rule) {
      const auto data = TypeParam::make(X, point);
      EXPECT_LT((TypeParam::deformation_gradient(data, u) - A).norm(), 1e-13);
    }
  }
}

TYPED_TEST(IsoparametricPoint, PullbackIsTheTransposeOfTheDifferentialAndSumsToZero) {
  Random random(2);
  const auto data = TypeParam::make(distorted<TypeParam>(random), TypeParam::Shape::stiffness_rule[1]);
  const auto u = random_local<TypeParam>(random), moved = random_local<TypeParam>(random);
  Eigen::Matrix<double, 3 * TypeParam::points, 1> du;
  for (int i = 0; i < TypeParam::points; ++i)
    du.template segment<3>(3 * i) =
        moved.points[static_cast<std::size_t>(i)] - u.points[static_cast<std::size_t>(i)];
  const Matrix P = random.matrix(), dF = TypeParam::deformation_gradient_differential(data, u, du);
  const Matrix difference =
      TypeParam::deformation_gradient(data, moved) - TypeParam::deformation_gradient(data, u);
  EXPECT_LT((dF - difference).norm(), 1e-13);
  const auto f = TypeParam::pullback(data, u, P);
  EXPECT_NEAR(f.dot(du), softsim::double_dot<double>(P, dF), 1e-13);
  Vec sum = Vec::Zero();
  for (int i = 0; i < TypeParam::points; ++i) sum += f.template segment<3>(3 * i);
  EXPECT_LT(sum.norm(), 1e-14);
}

TYPED_TEST(IsoparametricPoint, RefusesANegativeJacobian) {
  Random random(3);
  auto X = distorted<TypeParam>(random, 0);
  for (Vec& x : X) x[0] = -x[0];
  EXPECT_NE(refusal([&] {
              return TypeParam::make(X, TypeParam::Shape::stiffness_rule[0]);
            }).find("Jacobian determinant -"),
            std::string::npos);
}

// Since the gradients sum to zero, C = -1/2 sum_ij |x_i - x_j|^2 g_i g_j^T for any element, and the energy's
// derivative by the squared distances gives the forces: forces from edge lengths, where all pairs of nodes
// count as edges. Relative error about 1e-16 times (size x |g|)^2.
TYPED_TEST(IsoparametricPoint, SquaredDistancesGiveTheSameForces) {
  constexpr std::size_t n = static_cast<std::size_t>(TypeParam::points);
  Random random(4);
  const auto X = distorted<TypeParam>(random);
  const auto u = random_local<TypeParam>(random);
  const auto law = softsim::StVenantKirchhoff::from_young_poisson(10, 0.3);
  const softsim::Elastic<TypeParam, softsim::StVenantKirchhoff> elastic{law};
  for (const auto& point : TypeParam::Shape::stiffness_rule) {
    const auto data = TypeParam::make(X, point);
    std::array<Vec, n> x, g;
    g[0] = Vec::Zero();
    for (std::size_t i = 0; i < n; ++i) {
      x[i] = X[i] + u.points[i];
      if (i == 0) continue;
      g[i] = data.gradient[i - 1];
      g[0] -= g[i];
    }
    Matrix C = Matrix::Zero();
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < i; ++j)
        C -= (x[i] - x[j]).squaredNorm() / 2 * (g[i] * g[j].transpose() + g[j] * g[i].transpose());
    const Matrix F = TypeParam::deformation_gradient(data, u);
    EXPECT_LT((C - F.transpose() * F).norm(), 1e-13 * C.norm());

    const Matrix E = (C - Matrix::Identity()) / 2;
    const Matrix S = law.lambda() * E.trace() * Matrix::Identity() + 2 * law.mu() * E;
    Eigen::Matrix<double, 3 * TypeParam::points, 1> gradient;
    gradient.setZero();
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j)
        gradient.template segment<3>(3 * static_cast<int>(i)) -=
            data.volume * g[i].dot(S * g[j]) * (x[i] - x[j]);
    EXPECT_LT(bodies::relative_error(gradient, elastic.gradient(data, u)), 1e-12);
  }
}

// Its edges alone do not carry a hexahedron: a cube of twelve rods folds flat without strain in any of them.
TEST(TrilinearHexahedron, ItsTwelveEdgesDoNotFixItsShape) {
  Random random(5);
  const auto X = distorted<TrilinearHexahedron>(random, 0);
  Local<double, 8> u;
  Matrix fold = Matrix::Identity();
  fold.col(1) = Vec(std::sin(0.5), std::cos(0.5), 0);
  for (std::size_t i = 0; i < 8; ++i) u.points[i] = fold * X[i] - X[i];
  for (std::size_t i = 0; i < 4; ++i)
    for (const auto& [a, b] : {std::pair{i, (i + 1) % 4}, {i + 4, (i + 1) % 4 + 4}, {i, i + 4}})
      EXPECT_NEAR((X[a] + u.points[a] - X[b] - u.points[b]).norm(), 1, 1e-15);
  const auto data = TrilinearHexahedron::make(X, TrilinearHexahedron::Shape::stiffness_rule[0]);
  EXPECT_NEAR(softsim::determinant<double>(TrilinearHexahedron::deformation_gradient(data, u)), std::cos(0.5),
              1e-15);
}

}  // namespace isoparametric_test
