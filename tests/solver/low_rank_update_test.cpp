// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/solver/low_rank_update.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/SparseCholesky>
#include <limits>
#include <vector>

#include "potential/bodies.hpp"
#include "softsim/material/linear_elastic.hpp"
#include "softsim/mesh/selection.hpp"
#include "softsim/potential/elastic.hpp"
#include "softsim/solver/conjugate_gradient.hpp"
#include "softsim/system/free_components.hpp"
#include "softsim/system/system.hpp"
#include "softsim/system/tangent.hpp"

namespace low_rank_update_test {

using bodies::refusal, bodies::relative_error;
using softsim::LinearReport, softsim::LowRankUpdate, softsim::Status, softsim::Vector;
using Matrix = Eigen::MatrixXd;
using Sparse = Eigen::SparseMatrix<double>;

static_assert(softsim::SolvesFor<Eigen::SimplicialLDLT<Sparse>>);
static_assert(softsim::SolvesFor<Eigen::LLT<Matrix>>);
static_assert(!softsim::SolvesFor<softsim::ConjugateGradient>);

Matrix random_matrix(std::ptrdiff_t rows, std::ptrdiff_t columns, std::uint64_t seed) {
  bodies::Random random(seed);
  Matrix A(rows, columns);
  for (std::ptrdiff_t i = 0; i < A.size(); ++i) A.data()[i] = random.number();
  return A;
}

// A held cube and its factorised stiffness.
struct Cube {
  softsim::TetrahedralMesh mesh = bodies::distorted_cube(2, 1);
  softsim::System<softsim::ElasticTetrahedra<softsim::LinearElastic>> system{
      mesh, softsim::elastic(mesh, softsim::LinearElastic::from_young_poisson(10, 0.3))};
  softsim::FreeComponents free;
  Sparse K;
  Eigen::SimplicialLDLT<Sparse> factor;

  Cube() {
    system.prescribed.fix(softsim::nodes_near(mesh, softsim::Side::xmin, 0));
    free = softsim::FreeComponents(system.prescribed);
    softsim::AssembledTangent<decltype(system)> tangent;
    tangent.set(system, softsim::State<double>(mesh.points().size()), {});
    K = free.matrix(tangent.matrix());
    factor.compute(K);
  }
};

TEST(LowRankUpdate, OfNothingIsTheUnchangedMatrix) {
  const Cube cube;
  const Vector<double> b = random_matrix(cube.K.rows(), 1, 1);
  LowRankUpdate<> update;
  EXPECT_EQ(update.set_coefficients(Matrix(0, 0)).status, Status::converged);
  Vector<double> x;
  ASSERT_EQ(update.solve(cube.factor, b, x).status, Status::converged);
  EXPECT_LT(relative_error(Vector<double>(cube.K * x), b), 1e-12);
}

TEST(LowRankUpdate, IsTheSolveWithTheChangedMatrix) {
  const Cube cube;
  const std::ptrdiff_t n = cube.free.size();
  const Matrix U = random_matrix(n, 3, 1), C = random_matrix(3, 3, 2);  // not symmetric: it need not be
  LowRankUpdate<> update;
  ASSERT_EQ(update.add(cube.factor, U, C).status, Status::converged);
  const Vector<double> b = random_matrix(n, 1, 3);
  Vector<double> x;
  ASSERT_EQ(update.solve(cube.factor, b, x).status, Status::converged);
  const Matrix changed = Matrix(cube.K) + U * C * U.transpose();
  EXPECT_LT(relative_error(x, Vector<double>(changed.fullPivLu().solve(b))), 1e-11);
  EXPECT_LT((changed * x - b).norm() / b.norm(), 1e-11);
}

TEST(LowRankUpdate, FurtherColumnsAndOtherCoefficientsNeedNoNewStart) {
  const Cube cube;
  const std::ptrdiff_t n = cube.free.size();
  const Matrix U = random_matrix(n, 4, 1);
  const Vector<double> b = random_matrix(n, 1, 3), c = Eigen::Vector4d(1, 20, 3, 0.5);
  LowRankUpdate<> at_once, in_turn;
  int solves = 0;
  const auto counted = [&](const Vector<double>& rhs, Vector<double>& x) {
    ++solves;
    x = cube.factor.solve(rhs);
  };
  ASSERT_EQ(at_once.add(counted, U, c.asDiagonal()).status, Status::converged);
  EXPECT_EQ(solves, 4);
  for (int k = 0; k < 4; ++k)
    ASSERT_EQ(in_turn.add(counted, U.col(k), Matrix::Constant(1, 1, c[k])).status, Status::converged);
  EXPECT_EQ(solves, 8);
  Vector<double> x, y;
  ASSERT_EQ(at_once.solve(counted, b, x).status, Status::converged);
  ASSERT_EQ(in_turn.solve(counted, b, y).status, Status::converged);
  EXPECT_LT(relative_error(x, y), 1e-13);

  ASSERT_EQ(at_once.set_coefficients(Matrix::Zero(4, 4)).status, Status::converged);
  ASSERT_EQ(at_once.solve(counted, b, x).status, Status::converged);
  EXPECT_LT(relative_error(x, Vector<double>(cube.factor.solve(b))), 1e-15);
  EXPECT_EQ(solves, 11);
  at_once.clear();
  EXPECT_EQ(at_once.rank(), 0);
  ASSERT_EQ(at_once.solve(counted, b, x).status, Status::converged);
  EXPECT_LT(relative_error(x, Vector<double>(cube.factor.solve(b))), 1e-15);
}

// The penalty error of a support is b / C; with 1e12 times the stiffness twelve digits remain for it.
TEST(LowRankUpdate, APenaltyIsASupport) {
  const Cube cube;
  const std::ptrdiff_t n = cube.free.size();
  const std::int32_t k = cube.free.number(26, 2);
  ASSERT_GE(k, 0);
  LowRankUpdate<> update;
  ASSERT_EQ(update.add(cube.factor, softsim::spring_column(n, k), Matrix::Constant(1, 1, 1e13)).status,
            Status::converged);
  const Vector<double> b = random_matrix(n, 1, 3);
  Vector<double> x;
  ASSERT_EQ(update.solve(cube.factor, b, x).status, Status::converged);
  Matrix held = Matrix(cube.K);
  held.row(k).setZero();
  held.col(k).setZero();
  held(k, k) = 1;
  Vector<double> b_held = b;
  b_held[k] = 0;
  EXPECT_LT(relative_error(x, Vector<double>(held.llt().solve(b_held))), 1e-10);
}

TEST(LowRankUpdate, TakesAnElementOut) {
  const Cube cube;
  const std::ptrdiff_t n = cube.free.size();
  std::vector<softsim::Tetrahedron> rest(cube.mesh.tetrahedra().begin() + 1, cube.mesh.tetrahedra().end());
  const softsim::TetrahedralMesh cut(cube.mesh.points(), rest);
  const auto law = softsim::LinearElastic::from_young_poisson(10, 0.3);
  softsim::System<softsim::ElasticTetrahedra<softsim::LinearElastic>> system(cut, softsim::elastic(cut, law));
  ASSERT_EQ(cut.points().size(), cube.mesh.points().size());
  softsim::AssembledTangent<decltype(system)> tangent;
  tangent.set(system, softsim::State<double>(cut.points().size()), {});
  const Matrix K_cut = cube.free.matrix(tangent.matrix());

  const Matrix removed = Matrix(cube.K) - K_cut;  // the element's stiffness
  std::vector<std::int32_t> unknowns;
  for (const std::int32_t i : cube.mesh.tetrahedra().front())
    for (int axis = 0; axis < 3; ++axis)
      if (cube.free.number(i, axis) >= 0) unknowns.push_back(cube.free.number(i, axis));
  const auto k = static_cast<std::ptrdiff_t>(unknowns.size());
  Matrix U(n, k), C(k, k);
  for (std::ptrdiff_t a = 0; a < k; ++a) {
    U.col(a) = softsim::spring_column(n, unknowns[static_cast<std::size_t>(a)]);
    for (std::ptrdiff_t b = 0; b < k; ++b)
      C(a, b) = -removed(unknowns[static_cast<std::size_t>(a)], unknowns[static_cast<std::size_t>(b)]);
  }
  LowRankUpdate<> update;
  ASSERT_EQ(update.add(cube.factor, U, C).status, Status::converged);
  const Vector<double> b = random_matrix(n, 1, 3);
  Vector<double> x;
  ASSERT_EQ(update.solve(cube.factor, b, x).status, Status::converged);
  EXPECT_LT(relative_error(x, Vector<double>(K_cut.llt().solve(b))), 1e-11);
}

// Two unknowns on one spring each; the first spring is cut.
TEST(LowRankUpdate, ReportsASingularMatrixAndCanBeMendedAfterwards) {
  const Eigen::LLT<Matrix> factor(Matrix(Eigen::Vector2d(0.3, 5).asDiagonal()));
  LowRankUpdate<> update;
  const LinearReport cut = update.add(factor, softsim::spring_column(2, 0), Matrix::Constant(1, 1, -0.3));
  EXPECT_EQ(cut.status, Status::not_converged);
  EXPECT_NE(cut.reason.find("singular"), std::string_view::npos);
  Vector<double> x = Eigen::Vector2d(7, 8);
  EXPECT_EQ(update.solve(factor, Eigen::Vector2d(1, 1), x).status, Status::not_converged);
  EXPECT_EQ(x, Eigen::Vector2d(7, 8));

  ASSERT_EQ(update.add(factor, softsim::spring_column(2, 0, 1), Matrix::Constant(1, 1, 2)).status,
            Status::converged);
  ASSERT_EQ(update.solve(factor, Eigen::Vector2d(1, 1), x).status, Status::converged);
  Eigen::Matrix2d K;
  K << 2, -2, -2, 7;
  EXPECT_LT((K * x - Eigen::Vector2d(1, 1)).norm(), 1e-13);
}

// A large coefficient beside a small one is no singular matrix.
TEST(LowRankUpdate, CoefficientsOfVeryDifferentSizeAreRegular) {
  const Eigen::LLT<Matrix> factor(Matrix::Identity(3, 3));
  LowRankUpdate<> update;
  ASSERT_EQ(update.add(factor, Matrix::Identity(3, 3), Eigen::Vector3d(1e25, 1e-20, 1).asDiagonal()).status,
            Status::converged);
  Vector<double> x;
  ASSERT_EQ(update.solve(factor, Eigen::Vector3d(1, 1, 1), x).status, Status::converged);
  EXPECT_NEAR(x[0], 0, 1e-15);  // the difference of y and its correction
  EXPECT_NEAR(x[1], 1, 1e-15);
  EXPECT_NEAR(x[2], 0.5, 1e-15);
}

TEST(LowRankUpdate, NumbersThatAreNotFiniteLeaveTheCallersAlone) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Eigen::LLT<Matrix> factor(Matrix::Identity(2, 2));
  LowRankUpdate<> update;
  const auto broken = [&](const Vector<double>& b, Vector<double>& x) {
    x = Vector<double>::Constant(b.size(), nan);
  };
  EXPECT_EQ(update.add(broken, Matrix::Identity(2, 2), Matrix::Identity(2, 2)).status, Status::not_finite);
  EXPECT_EQ(update.rank(), 0);
  ASSERT_EQ(update.add(factor, Matrix::Identity(2, 2), Matrix::Identity(2, 2)).status, Status::converged);
  Vector<double> x = Eigen::Vector2d(7, 8);
  EXPECT_EQ(update.solve(factor, Eigen::Vector2d(nan, 1), x).status, Status::not_finite);
  EXPECT_EQ(update.solve(factor, Eigen::Vector3d(1, 1, 1), x).status, Status::not_converged);
  EXPECT_EQ(x, Eigen::Vector2d(7, 8));
}

TEST(LowRankUpdate, WorksInSinglePrecision) {
  const Eigen::LLT<Eigen::MatrixXf> factor(Eigen::MatrixXf::Identity(2, 2));
  LowRankUpdate<float> update;
  ASSERT_EQ(update.add(factor, softsim::spring_column<float>(2, 0, 1), Eigen::MatrixXf::Ones(1, 1)).status,
            Status::converged);
  Vector<float> x;
  ASSERT_EQ(update.solve(factor, Eigen::Vector2f(3, 0), x).status, Status::converged);
  EXPECT_LT((x - Eigen::Vector2f(2, 1)).norm(), 1e-6f);
}

TEST(LowRankUpdate, RefusesSizesThatDoNotFit) {
  const Eigen::LLT<Matrix> factor(Matrix::Identity(2, 2));
  LowRankUpdate<> update;
  EXPECT_EQ(refusal([&] { return update.add(factor, Matrix(2, 0), Matrix(0, 0)); }),
            "low-rank update: U is 2 x 0, must have columns");
  EXPECT_EQ(refusal([&] { return update.add(factor, Matrix::Ones(2, 1), Matrix::Ones(2, 2)); }),
            "low-rank update: C is 2 x 2, must be 1 x 1 and finite");
  ASSERT_EQ(update.add(factor, Matrix::Ones(2, 1), Matrix::Ones(1, 1)).status, Status::converged);
  EXPECT_EQ(refusal([&] { return update.add(factor, Matrix::Ones(3, 1), Matrix::Ones(1, 1)); }),
            "low-rank update: U is 3 x 1, must have 2 rows");
  EXPECT_EQ(refusal([&] { return softsim::spring_column(3, 3); }), "unknown 3: must be below 3");
  EXPECT_EQ(refusal([&] { return softsim::spring_column(3, 0, 5); }), "unknown 5: must be below 3");
}

}  // namespace low_rank_update_test
