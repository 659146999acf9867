// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/kinematics/linear_tetrahedron.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <limits>
#include <string>

#include "potential/bodies.hpp"
#include "softsim/core/batch.hpp"
#include "softsim/mesh/tetrahedral_mesh.hpp"

namespace linear_tetrahedron_test {

using bodies::Matrix, bodies::Random, bodies::Vec, bodies::refusal;
using softsim::Batch, softsim::Kinematics, softsim::LinearTetrahedron, softsim::Local, softsim::Mat3;
using Corners = std::array<Vec, 4>;
using Twelve = Eigen::Matrix<double, 12, 1>;

static_assert(Kinematics<LinearTetrahedron> && Kinematics<LinearTetrahedron, float>);
static_assert(Kinematics<LinearTetrahedron, Batch<double, 8>> &&
              Kinematics<LinearTetrahedron, Batch<float, 4>>);
static_assert(!softsim::NonlinearKinematics<LinearTetrahedron>);

// Everything but the pull-back.
struct WithoutPullback {
  static constexpr int points = 4;
  template <class T>
  using Data = LinearTetrahedron::Data<T>;
  template <class T>
  static T volume(const Data<T>& data) {
    return data.volume;
  }
  template <class T>
  static Mat3<T> deformation_gradient(const Data<T>& data, const Local<T, 4>& u) {
    return LinearTetrahedron::deformation_gradient(data, u);
  }
  template <class T>
  static Mat3<T> deformation_gradient_differential(const Data<T>& data, const Local<T, 4>& u,
                                                   const Eigen::Matrix<T, 12, 1>& du) {
    return LinearTetrahedron::deformation_gradient_differential(data, u, du);
  }
};
// With a pull-back, and with the second derivative that makes it nonlinear.
struct WithPullback : WithoutPullback {
  template <class T>
  static Eigen::Matrix<T, 12, 1> pullback(const Data<T>& data, const Local<T, 4>& u, const Mat3<T>& P) {
    return LinearTetrahedron::pullback(data, u, P);
  }
};
struct Nonlinear : WithPullback {
  template <class T>
  static Eigen::Matrix<T, 12, 1> geometric_product(const Data<T>&, const Local<T, 4>&, const Mat3<T>&,
                                                   const Eigen::Matrix<T, 12, 1>& du) {
    return du;
  }
};
static_assert(!Kinematics<WithoutPullback> && !Kinematics<int> && !Kinematics<Corners>);
static_assert(Kinematics<WithPullback> && !softsim::NonlinearKinematics<WithPullback>);
static_assert(softsim::NonlinearKinematics<Nonlinear>);

// Random corners around those of the unit tetrahedron: positive volume, no angle too small.
Corners corners(Random& random) {
  Corners X{Vec::Zero(), Vec::UnitX(), Vec::UnitY(), Vec::UnitZ()};
  const Vec shift = random.vec();
  for (Vec& x : X) x += 0.2 * random.vec() + shift;
  return X;
}

Local<double, 4> affine(const Corners& X, const Matrix& A, const Vec& b) {
  Local<double, 4> u;
  for (std::size_t i = 0; i < 4; ++i) u.points[i] = A * X[i] + b - X[i];
  return u;
}

Twelve random_twelve(Random& random) {
  Twelve v;
  for (double& x : v) x = random.number();
  return v;
}

TEST(LinearTetrahedron, ReproducesAffineFields) {
  Random random(1);
  for (int n = 0; n < 100; ++n) {
    const Corners X = corners(random);
    const Matrix A = Matrix::Identity() + random.matrix();
    const Matrix F =
        LinearTetrahedron::deformation_gradient(LinearTetrahedron::make(X), affine(X, A, random.vec()));
    // gradients of up to 10/m times rounded displacements of up to 10 m
    EXPECT_LT((F - A).norm(), 1e-13) << "A =\n" << A;
  }
}

TEST(LinearTetrahedron, KnowsItsVolumeAndGradients) {
  const auto data = LinearTetrahedron::make({Vec(1, 1, 1), Vec(3, 1, 1), Vec(1, 4, 1), Vec(1, 1, 5)});
  EXPECT_NEAR(LinearTetrahedron::volume(data), 4, 1e-15);
  EXPECT_LT((data.gradient[0] - Vec(0.5, 0, 0)).norm(), 1e-15);
  EXPECT_LT((data.gradient[1] - Vec(0, 1.0 / 3, 0)).norm(), 1e-15);
  EXPECT_LT((data.gradient[2] - Vec(0, 0, 0.25)).norm(), 1e-15);

  Random random(2);
  const Corners X = corners(random);
  EXPECT_NEAR(LinearTetrahedron::volume(LinearTetrahedron::make(X)),
              softsim::tetrahedron_volume(X[0], X[1], X[2], X[3]), 1e-16);
}

TEST(LinearTetrahedron, DifferentialIsTheDifferenceOfTwoGradients) {
  Random random(3);
  const Corners X = corners(random);
  const auto data = LinearTetrahedron::make(X);
  const Local<double, 4> u = affine(X, random.matrix(), random.vec());
  const Twelve du = random_twelve(random);
  Local<double, 4> moved = u;
  for (std::size_t i = 0; i < 4; ++i) moved.points[i] += du.segment<3>(3 * static_cast<std::ptrdiff_t>(i));
  const Matrix difference =
      LinearTetrahedron::deformation_gradient(data, moved) - LinearTetrahedron::deformation_gradient(data, u);
  EXPECT_LT((LinearTetrahedron::deformation_gradient_differential(data, u, du) - difference).norm(), 1e-13);
}

TEST(LinearTetrahedron, PullbackIsTheTransposeOfTheDifferential) {
  Random random(4);
  for (int n = 0; n < 100; ++n) {
    const Corners X = corners(random);
    const auto data = LinearTetrahedron::make(X);
    const Local<double, 4> u = affine(X, random.matrix(), random.vec());
    const Matrix P = random.matrix();
    const Twelve du = random_twelve(random);
    EXPECT_NEAR(
        softsim::double_dot<double>(P, LinearTetrahedron::deformation_gradient_differential(data, u, du)),
        LinearTetrahedron::pullback(data, u, P).dot(du), 1e-13);
  }
}

TEST(LinearTetrahedron, PullbackSumsToZero) {
  Random random(5);
  for (int n = 0; n < 100; ++n) {
    const Corners X = corners(random);
    const Local<double, 4> u = affine(X, random.matrix(), random.vec());
    const Twelve f = LinearTetrahedron::pullback(LinearTetrahedron::make(X), u, random.matrix());
    const Vec sum = f.segment<3>(0) + f.segment<3>(3) + f.segment<3>(6) + f.segment<3>(9);
    EXPECT_LE(sum.norm(), 1e-15 * f.norm());
  }
}

TEST(LinearTetrahedron, LanesOfABatchAreTetrahedraOfTheirOwn) {
  using B = Batch<double, 4>;
  Random random(6);
  LinearTetrahedron::Data<B> data;
  Local<B, 4> u;
  Eigen::Matrix<B, 12, 1> du;
  Mat3<B> P;
  std::array<LinearTetrahedron::Data<double>, 4> one_data;
  std::array<Local<double, 4>, 4> one_u;
  std::array<Twelve, 4> one_du;
  std::array<Matrix, 4> one_P;
  for (int l = 0; l < 4; ++l) {
    const auto k = static_cast<std::size_t>(l);
    one_data[k] = LinearTetrahedron::make(corners(random));
    one_du[k] = random_twelve(random);
    one_P[k] = random.matrix();
    for (Vec& x : one_u[k].points) x = random.vec();
    softsim::set_lane(data.volume, l, one_data[k].volume);
    for (std::size_t i = 0; i < 3; ++i)
      for (int a = 0; a < 3; ++a) softsim::set_lane(data.gradient[i][a], l, one_data[k].gradient[i][a]);
    for (std::size_t i = 0; i < 4; ++i)
      for (int a = 0; a < 3; ++a) softsim::set_lane(u.points[i][a], l, one_u[k].points[i][a]);
    for (int i = 0; i < 12; ++i) softsim::set_lane(du[i], l, one_du[k][i]);
    for (int i = 0; i < 9; ++i) softsim::set_lane(P(i), l, one_P[k](i));
  }
  const Mat3<B> F = LinearTetrahedron::deformation_gradient(data, u);
  const Mat3<B> dF = LinearTetrahedron::deformation_gradient_differential(data, u, du);
  const Eigen::Matrix<B, 12, 1> f = LinearTetrahedron::pullback(data, u, P);
  for (int l = 0; l < 4; ++l) {
    const auto k = static_cast<std::size_t>(l);
    const Matrix one_F = LinearTetrahedron::deformation_gradient(one_data[k], one_u[k]);
    const Matrix one_dF =
        LinearTetrahedron::deformation_gradient_differential(one_data[k], one_u[k], one_du[k]);
    const Twelve one_f = LinearTetrahedron::pullback(one_data[k], one_u[k], one_P[k]);
    EXPECT_EQ(softsim::lane(LinearTetrahedron::volume(data), l), one_data[k].volume);
    // the same sums, up to fused multiplications
    for (int i = 0; i < 9; ++i) EXPECT_NEAR(softsim::lane(F(i), l), one_F(i), 1e-14);
    for (int i = 0; i < 9; ++i) EXPECT_NEAR(softsim::lane(dF(i), l), one_dF(i), 1e-14);
    for (int i = 0; i < 12; ++i) EXPECT_NEAR(softsim::lane(f[i], l), one_f[i], 1e-14);
  }
}

TEST(LinearTetrahedron, RefusesCornersInTheWrongOrder) {
  EXPECT_EQ(refusal([] {
              return LinearTetrahedron::make({Vec(0, 0, 0), Vec(0, 1, 0), Vec(3, 0, 0), Vec(0, 0, 1)});
            }),
            "tetrahedron: volume -0.5 m^3 is not positive");
}

TEST(LinearTetrahedron, RefusesFlatAndNonFiniteCorners) {
  EXPECT_EQ(refusal([] {
              return LinearTetrahedron::make({Vec(0, 0, 0), Vec(1, 0, 0), Vec(0, 1, 0), Vec(1, 1, 0)});
            }),
            "tetrahedron: volume 0 m^3 is not positive");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(refusal([=] {
              return LinearTetrahedron::make({Vec(0, 0, nan), Vec(1, 0, 0), Vec(0, 1, 0), Vec(0, 0, 1)});
            }).find("is not positive"),
            std::string::npos);
}

}  // namespace linear_tetrahedron_test
