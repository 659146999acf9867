// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/material/corotational.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "material/law_checks.hpp"
#include "softsim/core/batch.hpp"
#include "softsim/kinematics/linear_tetrahedron.hpp"
#include "softsim/potential/elastic.hpp"

namespace corotational_test {

using law_checks::Deformation, law_checks::Matrix, law_checks::Random, law_checks::Tangent9,
    law_checks::tangent;
using softsim::Corotational, softsim::LinearElastic, softsim::WarpedStiffness;
using softsim::Mat3, softsim::Vec3;

static_assert(softsim::Material<Corotational> && softsim::Material<WarpedStiffness>);
static_assert(softsim::Material<Corotational, softsim::Batch<float, 8>>);
static_assert(!softsim::InvariantLaw<Corotational>);

const Corotational law = Corotational::from_young_poisson(10, 0.3);
const WarpedStiffness warped = WarpedStiffness::from_young_poisson(10, 0.3);
const LinearElastic linear = LinearElastic::from_young_poisson(10, 0.3);

// Signed stretches with s2 + s3 (the smaller two, the last one signed) at 0.2 or more: dP grows with its
// inverse, and the third derivatives that a central difference feels with its square.
const std::array<Vec3<double>, 7> stretches{{{1, 1, 1},
                                             {1.2, 0.9, 0.7},
                                             {2.5, 0.5, 0.3},
                                             {1.4, 1.1, 0},
                                             {1.3, 1.1, -0.6},
                                             {1, 0.8, -0.3},
                                             {-0.6, -1, -1.2}}};

TEST(Corotational, StressAndDifferentialAreDerivativesInvertedElementsIncluded) {
  Random random(1);
  for (const Vec3<double>& s : stretches) {
    const Matrix F = random.from_stretches(s).F;
    law_checks::expect_consistent_derivatives(law, F, law.mu());
    law_checks::expect_symmetric_and_linear(law, F, law.mu(), random);
  }
}

// Singular values as they are, largest first, the sign of det F on the last: psi is a function of these
// alone.
TEST(Corotational, EnergyIsThatOfTheSignedStretches) {
  Random random(2);
  for (const Vec3<double>& s : stretches) {
    const Deformation d = random.from_stretches(s);
    Vec3<double> proper = s.cwiseAbs();
    std::sort(proper.begin(), proper.end());
    if (s.prod() < 0) proper[0] = -proper[0];
    const double t = proper.sum() - 3;
    const double expected =
        law.mu() * (proper - Vec3<double>::Ones()).squaredNorm() + law.lambda() / 2 * t * t;
    EXPECT_NEAR(law.energy_density(d.F), expected, 1e-13 * law.mu()) << s.transpose();
  }
}

TEST(Corotational, RotationsAreFreeOfStressAndTurnItAlong) {
  Random random(3);
  for (int i = 0; i < 50; ++i) {
    const Matrix Q = random.rotation(), F = random.any_sign(2).F;
    // a few units of rounding in R times the moduli
    EXPECT_LE(law.first_piola(Q).norm(), 2e-14 * law.mu());
    EXPECT_LE(law.energy_density(Q), 1e-28 * law.mu());
    const Matrix P = law.first_piola(F), PF = P * F.transpose();
    const double condition = 1e-13 * law.mu() * F.norm() * F.norm();
    EXPECT_NEAR(law.energy_density(Matrix(Q * F)), law.energy_density(F), condition);
    EXPECT_LE((law.first_piola(Matrix(Q * F)) - Q * P).norm(), 100 * condition);
    EXPECT_LE((PF - PF.transpose()).norm(), 100 * condition) << "moment balance";
  }
}

TEST(Corotational, TendsToLinearElasticityAtSmallStrain) {
  Random random(4);
  const Matrix A = random.matrix(), Q = random.rotation();
  double last = 1;
  for (const double h : {1e-2, 1e-3, 1e-4}) {
    const Matrix F = Matrix::Identity() + h * A, P = linear.first_piola(F);
    const double error = (law.first_piola(F) - P).norm() / P.norm();
    EXPECT_LT(error, 0.15 * last) << "first order in the strain";
    last = error;
  }
  // the tangent at rest is that of linear elasticity, also in a turned body
  EXPECT_LE((tangent(law, Matrix::Identity()) - tangent(linear, Matrix::Identity())).norm(),
            1e-13 * law.mu());
  const Matrix D = random.matrix(), turned = law.first_piola_differential(Q, Q * D);
  EXPECT_LE((turned - Q * linear.first_piola_differential(Matrix::Identity(), D)).norm(), 1e-13 * law.mu());
}

// diag(1, 1, -s) with s < 1 is an element pushed through its base: the nearest rotation is I, and the stress
// asks for more stretch along the third axis, towards the upright shape.
TEST(Corotational, InvertedElementsAreDrawnBack) {
  for (const double s : {0.0, 0.2, 0.5, 0.9}) {
    const Matrix F = Vec3<double>(1, 1, -s).asDiagonal();
    Matrix expected = 2 * law.mu() * (F - Matrix::Identity());
    expected.diagonal().array() += law.lambda() * (-s - 1);
    EXPECT_LE((law.first_piola(F) - expected).norm(), 1e-12 * law.mu()) << s;
    EXPECT_LT(law.first_piola(F)(2, 2), 0);
  }
  // Where R is not unique everything is finite still.
  Random random(5);
  for (const Matrix& F : law_checks::singular_deformations(random)) {
    EXPECT_TRUE(std::isfinite(law.energy_density(F)));
    EXPECT_TRUE(law.first_piola(F).allFinite() && tangent(law, F).allFinite()) << F;
  }
  EXPECT_TRUE(tangent(law, Vec3<double>(1, 1, -1).asDiagonal()).allFinite());
}

TEST(Corotational, ATetrahedronTurnedInsideOutFindsItsRestShape) {
  const softsim::TetrahedralMesh mesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2, 3}});
  const auto body = softsim::elastic<double, 1>(mesh, law);
  softsim::State<double> q(4);
  q.point(3) = Vec3<double>(0.1, -0.1, -1.4);
  softsim::Vector<double> g = softsim::Vector<double>::Zero(q.size());
  const double start = body.energy(q);
  double energy = start;
  // steepest descent; the Hessian's largest eigenvalue is about V |g|^2 (2 mu + 3 lambda)
  for (int i = 0; i < 600; ++i) {
    g.setZero();
    body.add_gradient(q, g);
    softsim::retract(q, g, -0.05);
    const double next = body.energy(q);
    ASSERT_LE(next, energy + 1e-15 * start);
    energy = next;
  }
  EXPECT_LT(energy, 1e-8 * start);
  std::array<Vec3<double>, 4> x;
  for (std::size_t i = 0; i < 4; ++i) x[i] = mesh.points()[i] + q.point(static_cast<std::ptrdiff_t>(i));
  EXPECT_NEAR(softsim::tetrahedron_volume(x[0], x[1], x[2], x[3]), mesh.volume(), 1e-4);
}

TEST(WarpedStiffness, HasTheForcesOfCorotationalAndASemidefiniteMatrix) {
  Random random(6);
  for (const Vec3<double>& s : stretches) {
    const Matrix F = random.from_stretches(s).F;
    EXPECT_EQ(warped.energy_density(F), law.energy_density(F));
    EXPECT_EQ(warped.first_piola(F), law.first_piola(F));
    const Tangent9 K = tangent(warped, F);
    EXPECT_LE((K - K.transpose()).norm(), 1e-13 * law.mu());
    EXPECT_GE(Eigen::SelfAdjointEigenSolver<Tangent9>(K).eigenvalues()[0], -1e-13 * law.mu());
  }
  const Matrix Q = random.rotation();
  EXPECT_LE((tangent(warped, Q) - tangent(law, Q)).norm(), 1e-13 * law.mu())
      << "exact where nothing is strained";
  // In compression the exact matrix is indefinite: that is what leaving out dR hides.
  const Tangent9 K = tangent(law, Matrix(0.5 * Matrix::Identity()));
  EXPECT_LT(Eigen::SelfAdjointEigenSolver<Tangent9>(K).eigenvalues()[0], -0.1 * law.mu());
}

// f = R K0 (R^T x - X), K0 the stiffness matrix at rest, R the polar factor of this tetrahedron.
TEST(WarpedStiffness, ForcesOfATetrahedronAreTheTurnedLinearOnes) {
  Random random(7);
  const std::array<Vec3<double>, 4> X{{{0, 0, 0}, {1.1, 0.1, 0}, {0.2, 0.9, -0.1}, {0.1, 0.3, 1.2}}};
  const auto data = softsim::LinearTetrahedron::make(X);
  const softsim::Elastic<softsim::LinearTetrahedron, Corotational> element{law};
  const softsim::Elastic<softsim::LinearTetrahedron, LinearElastic> rest{linear};
  softsim::Local<double, 4> u;
  for (auto& p : u.points) p = 0.4 * random.matrix().col(0);
  const Matrix R =
      softsim::rotation_factor<double>(softsim::LinearTetrahedron::deformation_gradient(data, u));
  Eigen::Matrix<double, 12, 1> back;
  for (std::size_t i = 0; i < 4; ++i)
    back.segment<3>(static_cast<int>(3 * i)) = R.transpose() * (X[i] + u.points[i]) - X[i];
  Eigen::Matrix<double, 12, 1> f = rest.hessian_product(data, u, back);
  for (int i = 0; i < 4; ++i) f.segment<3>(3 * i) = R * f.segment<3>(3 * i).eval();
  EXPECT_LE((element.gradient(data, u) - f).norm(), 1e-13 * f.norm());
}

// One lane in need of the slow way must not change a digit of its neighbours.
template <class B>
void expect_lanes_equal_scalars(double tolerance) {
  using T = decltype(softsim::lane(B{}, 0));
  Random random(8);
  Mat3<B> F, D;
  for (int l = 0; l < softsim::lane_count<B>; ++l) {
    const Matrix f = l == 1 ? Matrix(Vec3<double>(1, 1e-3, -0.5e-3).asDiagonal()) : random.regular(2).F;
    const Matrix d = random.matrix();
    for (int i = 0; i < 9; ++i) softsim::set_lane(F(i), l, static_cast<T>(f(i)));
    for (int i = 0; i < 9; ++i) softsim::set_lane(D(i), l, static_cast<T>(d(i)));
  }
  Mat3<B> easy = F;
  for (int i = 0; i < 9; ++i) softsim::set_lane(easy(i), 1, softsim::lane(F(i), 0));
  const Mat3<B> R = softsim::rotation_factor(F), R_easy = softsim::rotation_factor(easy);
  const Mat3<B> P = law.first_piola(F), dP = law.first_piola_differential(F, D);
  const B w = law.energy_density(F);
  for (int l = 0; l < softsim::lane_count<B>; ++l) {
    if (l == 1) continue;
    const auto pick = [l](const B& b) { return softsim::lane(b, l); };
    const Mat3<T> f = F.unaryExpr(pick), d = D.unaryExpr(pick);
    EXPECT_EQ(Mat3<T>(R.unaryExpr(pick)), Mat3<T>(R_easy.unaryExpr(pick)));
    const Matrix fd = f.template cast<double>(), dd = d.template cast<double>();
    EXPECT_LE((P.unaryExpr(pick).template cast<double>() - law.first_piola(fd)).norm(), tolerance);
    EXPECT_LE((dP.unaryExpr(pick).template cast<double>() - law.first_piola_differential(fd, dd)).norm(),
              tolerance);
    EXPECT_NEAR(pick(w), law.energy_density(fd), tolerance);
  }
}
TEST(Corotational, LanesAreIndependentAndEqualToScalars) {
  expect_lanes_equal_scalars<softsim::Batch<double, 4>>(1e-12);
  expect_lanes_equal_scalars<softsim::Batch<float, 8>>(1e-3);
}

TEST(Corotational, RefusesModuliThatAreNotAdmissible) {
  EXPECT_THROW((void)Corotational::from_young_poisson(10, 0.5), std::invalid_argument);
  EXPECT_THROW((void)WarpedStiffness::from_lame(-10, 1), std::invalid_argument);
}

}  // namespace corotational_test
