// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/solver/conjugate_gradient.hpp"

#include <gtest/gtest.h>

#include <Eigen/SparseCholesky>
#include <cstddef>
#include <limits>
#include <string>

#include "potential/bodies.hpp"
#include "softsim/material/neo_hookean.hpp"
#include "softsim/mesh/selection.hpp"
#include "softsim/potential/elastic.hpp"
#include "softsim/solver/preconditioner.hpp"
#include "softsim/system/system.hpp"
#include "softsim/system/tangent.hpp"

namespace conjugate_gradient_test {

using softsim::ConjugateGradient, softsim::LinearReport, softsim::Status,
    softsim::Vector;
using System = softsim::System<softsim::ElasticTetrahedra<softsim::NeoHookean>>;

static_assert(softsim::Preconditioner<softsim::NoPreconditioner<double>> &&
              softsim::Preconditioner<softsim::Jacobi<double>>);
static_assert(softsim::Preconditioner<softsim::BlockJacobi<float>, float>);
static_assert(!softsim::Preconditioner<softsim::BlockJacobi<double>, float> &&
              !softsim::Preconditioner<ConjugateGradient>);
static_assert(!softsim::LinearOperator<softsim::NoPreconditioner<int>>);

struct Diagonal {
  Vector<double> d;
  void apply(const Vector<double>& x, Vector<double>& y) const { y = d.cwiseProduct(x); }
};
const softsim::NoPreconditioner<double> none;

// ---------------------------------------------------------------- against a direct solver

template <class Operator_, template <class> class Preconditioner_>
struct Choice {
  template <class S>
  using Tangent = typename Operator_::template Tangent<S>;
  using Preconditioner = Preconditioner_<double>;
};
struct ChoiceName {
  template <class C>
  static std::string GetName(int) {
    std::string name = std::is_same_v<typename C::template Tangent<System>, softsim::AssembledTangent<System>>
                           ? "Assembled"
                           : "MatrixFree";
    if (std::is_same_v<typename C::Preconditioner, softsim::Jacobi<double>>) return name + "Jacobi";
    return name + (std::is_same_v<typename C::Preconditioner, softsim::BlockJacobi<double>> ? "BlockJacobi"
                                                                                            : "None");
  }
};
template <class C>
class LinearSolve : public ::testing::Test {};
using Choices = ::testing::Types<
    Choice<softsim::Assembled, softsim::NoPreconditioner>, Choice<softsim::Assembled, softsim::Jacobi>,
    Choice<softsim::Assembled, softsim::BlockJacobi>, Choice<softsim::MatrixFree, softsim::NoPreconditioner>,
    Choice<softsim::MatrixFree, softsim::Jacobi>, Choice<softsim::MatrixFree, softsim::BlockJacobi>>;
TYPED_TEST_SUITE(LinearSolve, Choices, ChoiceName);

TYPED_TEST(LinearSolve, AgreesWithEigensCholeskyFactorisation) {
  const auto mesh = bodies::distorted_cube(3, 1);
  System system(mesh, softsim::elastic(mesh, softsim::NeoHookean::from_young_poisson(10, 0.4)));
  system.prescribed.fix(softsim::nodes_near(mesh, softsim::Side::zmin, 0));
  system.prescribed.set(63, 1, 0);  // a roller, so that a block is half free
  const auto q = bodies::random_state(mesh.points().size(), 0.01, 2);

  typename TypeParam::template Tangent<System> A;
  A.set(system, q, {});
  typename TypeParam::Preconditioner preconditioner;
  preconditioner.compute(A, system.prescribed.free());
  Vector<double> b = bodies::random_vector(mesh.points().size(), 1, 3), x = Vector<double>::Zero(b.size());
  system.prescribed.mask(b);
  ConjugateGradient::Workspace<double> workspace;
  const LinearReport report = ConjugateGradient{.tolerance = 1e-11}.solve(A, preconditioner, b, x, workspace);
  EXPECT_EQ(report.status, Status::converged);
  EXPECT_LE(report.residual, 1e-11);
  EXPECT_FALSE(report.indefinite);

  // the same system with an identity on prescribed components
  softsim::AssembledTangent<System> assembled;
  assembled.set(system, q, {});
  const Vector<double> free = softsim::pack(system.prescribed.free());
  Eigen::SparseMatrix<double> K = assembled.matrix().to_eigen();
  K.prune([&](Eigen::Index i, Eigen::Index j, double) { return free[i] * free[j] == 1; });
  for (Eigen::Index i = 0; i < free.size(); ++i)
    if (free[i] == 0) K.coeffRef(i, i) = 1;
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> direct(K);
  ASSERT_EQ(direct.info(), Eigen::Success);
  EXPECT_LT(bodies::relative_error(softsim::pack(x), Vector<double>(direct.solve(softsim::pack(b)))), 1e-8);
  Vector<double> masked = x;
  system.prescribed.mask(masked);
  EXPECT_EQ(masked, x) << "a prescribed component moved";
}

TEST(Preconditioners, MakeTheSolveShorter) {
  const auto mesh = bodies::distorted_cube(3, 1);
  // a hard inclusion makes the diagonal uneven
  std::vector<std::int32_t> index;
  for (std::size_t t = 0; t < mesh.tetrahedra().size(); ++t) index.push_back(t < 40);
  System system(mesh, softsim::elastic(mesh,
                                       std::vector{softsim::NeoHookean::from_young_poisson(1, 0.4),
                                                   softsim::NeoHookean::from_young_poisson(1e4, 0.4)},
                                       index));
  system.prescribed.fix(softsim::nodes_near(mesh, softsim::Side::zmin, 0));
  softsim::AssembledTangent<System> A;
  A.set(system, softsim::State<double>(mesh.points().size()), {});
  Vector<double> b = bodies::random_vector(mesh.points().size(), 1, 3);
  system.prescribed.mask(b);
  const auto iterations = [&](auto preconditioner) {
    preconditioner.compute(A, system.prescribed.free());
    ConjugateGradient::Workspace<double> workspace;
    Vector<double> x = Vector<double>::Zero(b.size());
    return ConjugateGradient{.max_iterations = 20000, .tolerance = 1e-8}
        .solve(A, preconditioner, b, x, workspace)
        .iterations;
  };
  const int without = iterations(none), jacobi = iterations(softsim::Jacobi<double>{}),
            block_jacobi = iterations(softsim::BlockJacobi<double>{});
  EXPECT_LT(2 * jacobi, without);
  EXPECT_LT(block_jacobi, jacobi);
}

// ---------------------------------------------------------------- what the textbook promises

TEST(ConjugateGradient, NeedsAsManyIterationsAsThereAreEigenvalues) {
  for (int eigenvalues = 1; eigenvalues <= 6; ++eigenvalues) {
    Diagonal A{Vector<double>(60)};
    for (int i = 0; i < 60; ++i) A.d[i] = 1 + 2 * (i % eigenvalues);
    const Vector<double> b = bodies::random_vector(15, 1, 1) + Vector<double>::Ones(60);
    Vector<double> x = Vector<double>::Zero(60);
    ConjugateGradient::Workspace<double> workspace;
    const LinearReport report = ConjugateGradient{.tolerance = 1e-12}.solve(A, none, b, x, workspace);
    EXPECT_EQ(report.status, Status::converged);
    EXPECT_EQ(report.iterations, eigenvalues);
    EXPECT_LT(bodies::relative_error(x, Vector<double>(b.cwiseQuotient(A.d))), 1e-11);
  }
}

TEST(ConjugateGradient, StartsFromTheGuessItIsGiven) {
  const Diagonal A{Vector<double>::LinSpaced(40, 1, 40)};
  const Vector<double> b = Vector<double>::Ones(40), exact = b.cwiseQuotient(A.d);
  ConjugateGradient::Workspace<double> workspace;
  Vector<double> x = exact;
  EXPECT_EQ(ConjugateGradient{}.solve(A, none, b, x, workspace).iterations, 0);
  x = Vector<double>::Zero(40);
  const int cold = ConjugateGradient{}.solve(A, none, b, x, workspace).iterations;
  x = 1.001 * exact;
  const int warm = ConjugateGradient{}.solve(A, none, b, x, workspace).iterations;
  EXPECT_LT(warm, cold);
}

TEST(ConjugateGradient, OfNothingIsNothing) {
  const Diagonal A{Vector<double>::LinSpaced(8, 1, 8)};
  Vector<double> x = Vector<double>::Ones(8);
  ConjugateGradient::Workspace<double> workspace;
  const LinearReport report =
      ConjugateGradient{}.solve(A, none, Vector<double>(Vector<double>::Zero(8)), x, workspace);
  EXPECT_EQ(report.status, Status::converged);
  EXPECT_EQ(report.iterations, 0);
  EXPECT_EQ(report.residual, 0);
  EXPECT_EQ(x.norm(), 0);
}

TEST(ConjugateGradient, ReportsWhatIsNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  ConjugateGradient::Workspace<double> workspace;
  for (const double bad : {nan, inf}) {
    Vector<double> b = Vector<double>::Ones(8), x = Vector<double>::Zero(8);
    b[5] = bad;
    const Diagonal A{Vector<double>::LinSpaced(8, 1, 8)};
    EXPECT_EQ(ConjugateGradient{}.solve(A, none, b, x, workspace).status, Status::not_finite);
    Diagonal broken = A;
    broken.d[2] = bad;
    x.setZero();
    EXPECT_EQ(
        ConjugateGradient{}.solve(broken, none, Vector<double>(Vector<double>::Ones(8)), x, workspace).status,
        Status::not_finite);
  }
}

TEST(ConjugateGradient, StopsAtNegativeCurvatureOnADescentDirection) {
  Diagonal A{Vector<double>::LinSpaced(20, 1, 20)};
  A.d[7] = -0.5;
  Vector<double> b = Vector<double>::Ones(20), x = Vector<double>::Zero(20);
  ConjugateGradient::Workspace<double> workspace;
  const LinearReport report = ConjugateGradient{.tolerance = 1e-12}.solve(A, none, b, x, workspace);
  EXPECT_EQ(report.status, Status::not_converged);
  EXPECT_TRUE(report.indefinite);
  EXPECT_GT(report.iterations, 0);
  EXPECT_GT(b.dot(x), 0) << "x . A x / 2 - b . x does not fall along x";
  EXPECT_NEAR(report.residual, (b - A.d.cwiseProduct(x)).norm() / b.norm(), 1e-12);

  // negative at once: nothing was gained, and that shows
  x.setZero();
  const LinearReport at_once = ConjugateGradient{}.solve(Diagonal{-A.d.cwiseAbs()}, none, b, x, workspace);
  EXPECT_TRUE(at_once.indefinite);
  EXPECT_EQ(at_once.iterations, 0);
  EXPECT_EQ(x.norm(), 0);
}

TEST(ConjugateGradient, SaysHowFarItGotWhenItRunsOut) {
  const Diagonal A{Vector<double>::LinSpaced(40, 1, 400)};
  const Vector<double> b = Vector<double>::Ones(40);
  Vector<double> x = Vector<double>::Zero(40);
  ConjugateGradient::Workspace<double> workspace;
  const LinearReport report =
      ConjugateGradient{.max_iterations = 7, .tolerance = 1e-12}.solve(A, none, b, x, workspace);
  EXPECT_EQ(report.status, Status::not_converged);
  EXPECT_FALSE(report.indefinite);
  EXPECT_EQ(report.iterations, 7);
  EXPECT_NEAR(report.residual, (b - A.d.cwiseProduct(x)).norm() / b.norm(), 1e-12);
  EXPECT_GT(report.residual, 1e-3);
}

TEST(ConjugateGradient, WorksInSinglePrecision) {
  const auto mesh = bodies::distorted_cube(2, 4);
  softsim::System system(mesh,
                         softsim::elastic<float>(mesh, softsim::NeoHookean::from_young_poisson(10, 0.3)));
  system.prescribed.fix(softsim::nodes_near(mesh, softsim::Side::zmin, 0));
  const softsim::State<float> q(mesh.points().size());
  softsim::AssembledTangent<decltype(system)> A;
  A.set(system, q, {});
  softsim::BlockJacobi<float> preconditioner;
  preconditioner.compute(A, system.prescribed.free());
  Vector<float> b = bodies::random_vector<float>(mesh.points().size(), 1, 5),
                x = Vector<float>::Zero(b.size()), Ax(b.size());
  system.prescribed.mask(b);
  ConjugateGradient::Workspace<float> workspace;
  const LinearReport report = ConjugateGradient{.tolerance = 1e-5}.solve(A, preconditioner, b, x, workspace);
  EXPECT_EQ(report.status, Status::converged);
  A.apply(x, Ax);
  EXPECT_LT(bodies::relative_error(Ax, b), 3e-5);
}

// ---------------------------------------------------------------- preconditioners one by one

struct Blocks {
  std::vector<softsim::Mat3<double>> of_the_diagonal;
  void diagonal_blocks(std::vector<softsim::Mat3<double>>& out) const { out = of_the_diagonal; }
};

TEST(BlockJacobi, InvertsTheFreePartOfEveryBlock) {
  bodies::Random random(6);
  const bodies::Matrix R = random.rotation(), D = R * bodies::Vec(1, 2, 5).asDiagonal() * R.transpose();
  softsim::BlockJacobi<double> preconditioner;
  Vector<double> free = Vector<double>::Ones(12);
  free[3] = free[7] = free[11] = 0;
  free[4 + 1] = 0;                   // block 1 held along y
  free[8] = free[9] = free[10] = 0;  // block 2 held
  preconditioner.compute(Blocks{{D, D, D}}, free);
  Vector<double> r = bodies::random_vector(3, 1, 7), z(12);
  r = r.cwiseProduct(free);
  preconditioner.apply(r, z);
  EXPECT_LT((D * z.segment<3>(0) - r.segment<3>(0)).norm(), 1e-14);
  const Eigen::Matrix2d D_xz = D({0, 2}, {0, 2});
  EXPECT_LT((D_xz * Eigen::Vector2d(z[4], z[6]) - Eigen::Vector2d(r[4], r[6])).norm(), 1e-14);
  EXPECT_EQ(z[5], 0);
  EXPECT_EQ(z.segment<4>(8).norm(), 0);
  EXPECT_EQ(z[3], 0);
}

// Conjugate gradients need a positive preconditioner, whatever the tangent.
TEST(Preconditioners, StayPositiveForIndefiniteAndEmptyBlocks) {
  bodies::Random random(8);
  Vector<double> free = Vector<double>::Ones(16);
  for (int k = 3; k < 16; k += 4) free[k] = 0;
  const bodies::Matrix R = random.rotation(),
                       negative = R * bodies::Vec(1, -2, 5).asDiagonal() * R.transpose();
  const Blocks blocks{
      {negative, -bodies::Matrix::Identity(), bodies::Matrix::Zero(), bodies::Vec(-1, -1, 2).asDiagonal()}};
  softsim::BlockJacobi<double> block_jacobi;
  softsim::Jacobi<double> jacobi;
  block_jacobi.compute(blocks, free);
  jacobi.compute(blocks, free);
  for (std::uint64_t n = 0; n < 20; ++n) {
    const Vector<double> r = bodies::random_vector(4, 1, 9 + n);
    Vector<double> z(16);
    block_jacobi.apply(r, z);
    for (std::ptrdiff_t i = 0; i < 4; ++i) EXPECT_GT(softsim::block(r, i).dot(softsim::block(z, i)), 0) << i;
    jacobi.apply(r, z);
    for (std::ptrdiff_t i = 0; i < 4; ++i) EXPECT_GT(softsim::block(r, i).dot(softsim::block(z, i)), 0) << i;
  }
}

}  // namespace conjugate_gradient_test
