// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/solver/minres.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "softsim/solver/preconditioner.hpp"
#include "solver/linear_problems.hpp"

namespace minres_test {

using linear_problems::BlockOperator, linear_problems::Cube, linear_problems::with_eigenvalues;
using softsim::LinearReport, softsim::Minres, softsim::Status, softsim::Vector;

static_assert(softsim::LinearMethod<Minres, BlockOperator<>, softsim::NoPreconditioner<double>>);
static_assert(
    !softsim::LinearMethod<Minres, softsim::NoPreconditioner<int>, softsim::NoPreconditioner<double>>);
static_assert(!softsim::LinearMethod<softsim::NoPreconditioner<double>, BlockOperator<>,
                                     softsim::NoPreconditioner<double>>);

const softsim::NoPreconditioner<double> none;

// Eigenvalues from -low to high, none near zero.
Eigen::VectorXd of_either_sign(std::ptrdiff_t n, double low, double high) {
  Eigen::VectorXd e(n);
  for (std::ptrdiff_t i = 0; i < n; ++i)
    e[i] = (i % 3 == 0 ? -low : high) * (1 + 4.0 * static_cast<double>(i) / static_cast<double>(n));
  return e;
}

template <class B>
LinearReport solve(const Minres& method, const BlockOperator<>& A, const B& preconditioner,
                   const Vector<double>& b, Vector<double>& x) {
  Minres::Workspace<double> workspace;
  return method.solve(A, preconditioner, b, x, workspace);
}

TEST(Minres, AgreesWithADenseSolutionOnATangent) {
  const Cube<> cube;
  softsim::BlockJacobi<double> preconditioner;
  preconditioner.compute(cube.A, cube.free);
  Minres::Workspace<double> workspace;
  Vector<double> x = Vector<double>::Zero(cube.b.size());
  const LinearReport report = Minres{.tolerance = 1e-11}.solve(cube.A, preconditioner, cube.b, x, workspace);
  EXPECT_EQ(report.status, Status::converged) << report.reason;
  EXPECT_LE(report.residual, 1e-11);
  // 1e-11 times a condition number of some hundred
  EXPECT_LT(bodies::relative_error(softsim::pack(x), cube.exact()), 1e-8);
}

TEST(Minres, SolvesIndefiniteSystems) {
  const Eigen::MatrixXd K = with_eigenvalues(of_either_sign(30, 1, 2), 1);
  const BlockOperator<> A(K);
  const Vector<double> b = bodies::random_vector(10, 1, 2);
  softsim::Jacobi<double> jacobi;
  jacobi.compute(A, linear_problems::all_free(10));
  const Eigen::VectorXd exact = K.partialPivLu().solve(softsim::pack(b));
  for (const bool with : {false, true}) {
    Vector<double> x = Vector<double>::Zero(40);
    const Minres method{.max_iterations = 90, .tolerance = 1e-10};
    const LinearReport report = with ? solve(method, A, jacobi, b, x) : solve(method, A, none, b, x);
    EXPECT_EQ(report.status, Status::converged) << report.reason;
    EXPECT_NEAR(report.residual, linear_problems::residual(K, b, x), 1e-13);
    EXPECT_LT(bodies::relative_error(softsim::pack(x), exact), 1e-9);
  }
}

// As many iterations as different eigenvalues, whatever their signs.
TEST(Minres, NeedsAsManyIterationsAsThereAreEigenvalues) {
  Eigen::VectorXd e(30);
  for (std::ptrdiff_t i = 0; i < 30; ++i) e[i] = static_cast<double>(i % 5) - 1.5;
  Vector<double> x = Vector<double>::Zero(40);
  const LinearReport report = solve({.tolerance = 1e-11}, BlockOperator<>(with_eigenvalues(e, 3)), none,
                                    bodies::random_vector(10, 1, 4), x);
  EXPECT_EQ(report.status, Status::converged) << report.reason;
  EXPECT_EQ(report.iterations, 5);
}

// Without a preconditioner every iterate has the least residual of its Krylov space: compared with that of a
// dense least-squares problem over the space itself.
TEST(Minres, HasTheLeastResidualAndItNeverGrows) {
  const Eigen::MatrixXd K = with_eigenvalues(of_either_sign(30, 1, 2), 5);
  const BlockOperator<> A(K);
  const Vector<double> b = bodies::random_vector(10, 1, 6);
  double before = 1;
  Eigen::MatrixXd space(30, 0);
  Eigen::VectorXd next = softsim::pack(b).normalized();
  for (int n = 1; n <= 12; ++n) {
    space.conservativeResize(30, n);
    space.col(n - 1) = next;
    next = K * next;
    for (int twice = 0; twice < 2; ++twice) next -= space * (space.transpose() * next);
    next.normalize();
    const Eigen::VectorXd y = (K * space).householderQr().solve(softsim::pack(b));
    const double least = (softsim::pack(b) - K * space * y).norm() / b.norm();
    Vector<double> x = Vector<double>::Zero(40);
    const LinearReport report = solve({.max_iterations = n, .fixed = true}, A, none, b, x);
    EXPECT_EQ(report.iterations, n);
    EXPECT_NEAR(report.residual, least, 1e-12);
    EXPECT_LE(report.residual, before * (1 + 1e-14));
    before = report.residual;
  }
}

// The recurrence of the residual stops the iteration where the true one does: at the same count as the first
// of the fixed iterations that is good enough.
TEST(Minres, StopsAsSoonAsItIsGoodEnough) {
  const Eigen::MatrixXd K = with_eigenvalues(of_either_sign(30, 1, 2), 5);
  const BlockOperator<> A(K);
  const Vector<double> b = bodies::random_vector(10, 1, 6);
  softsim::Jacobi<double> jacobi;
  jacobi.compute(A, linear_problems::all_free(10));
  Vector<double> x = Vector<double>::Zero(40), y;
  const LinearReport report = solve({.tolerance = 1e-3}, A, jacobi, b, x);
  ASSERT_EQ(report.status, Status::converged);
  for (int n = 1; n <= report.iterations; ++n) {
    y.setZero(40);
    const LinearReport fixed =
        solve({.max_iterations = n, .tolerance = 1e-3, .fixed = true}, A, jacobi, b, y);
    EXPECT_EQ(fixed.status, n < report.iterations ? Status::not_converged : Status::converged);
    EXPECT_EQ(fixed.reason.empty(), n == report.iterations);
  }
  EXPECT_EQ(x, y);
}

TEST(Minres, SolvesSingularConsistentSystems) {
  Eigen::VectorXd e = of_either_sign(30, 1, 2);
  e.head(4).setZero();
  const Eigen::MatrixXd K = with_eigenvalues(e, 7);
  const BlockOperator<> A(K);
  Vector<double> b(40);
  A.apply(bodies::random_vector(10, 1, 8), b);
  Vector<double> x = Vector<double>::Zero(40);
  const LinearReport report = solve({.tolerance = 1e-10}, A, none, b, x);
  EXPECT_EQ(report.status, Status::converged) << report.reason;
  EXPECT_LT(linear_problems::residual(K, b, x), 1.01e-10);
  // from zero, without a preconditioner: the shortest solution
  const Eigen::VectorXd shortest = K.completeOrthogonalDecomposition().solve(softsim::pack(b));
  EXPECT_LT(bodies::relative_error(softsim::pack(x), shortest), 1e-8);
}

TEST(Minres, SaysThatASingularSystemHasNoSolution) {
  Eigen::VectorXd e = of_either_sign(30, 1, 2);
  e.head(4).setZero();
  const Eigen::MatrixXd K = with_eigenvalues(e, 9);
  const Vector<double> b = bodies::random_vector(10, 1, 10);
  Vector<double> x = Vector<double>::Zero(40);
  const LinearReport report =
      solve({.max_iterations = 1000, .tolerance = 1e-10}, BlockOperator<>(K), none, b, x);
  EXPECT_EQ(report.status, Status::not_converged);
  EXPECT_FALSE(report.reason.empty());
  EXPECT_LT(report.iterations, 100);
  const Eigen::VectorXd y = K.completeOrthogonalDecomposition().solve(softsim::pack(b));
  EXPECT_NEAR(report.residual, (softsim::pack(b) - K * y).norm() / b.norm(), 1e-6);
  EXPECT_TRUE(x.allFinite());
  // nothing of it in the range at all: there is nothing to gain
  Vector<double> zero = Vector<double>::Zero(40);
  const LinearReport none_left = solve({}, BlockOperator<>(Eigen::MatrixXd::Zero(30, 30)), none, b, zero);
  EXPECT_EQ(none_left.status, Status::not_converged);
  EXPECT_EQ(none_left.reason, "the operator is singular and the right-hand side not in its range");
  EXPECT_EQ(zero.norm(), 0);
}

TEST(Minres, StartsFromTheGuessItIsGiven) {
  const Eigen::MatrixXd K = with_eigenvalues(of_either_sign(30, 1, 2), 11);
  const BlockOperator<> A(K);
  const Vector<double> b = bodies::random_vector(10, 1, 12),
                       exact = softsim::unpack(Vector<double>(K.partialPivLu().solve(softsim::pack(b))));
  Vector<double> x = exact;
  EXPECT_EQ(solve({}, A, none, b, x).iterations, 0);
  x.setZero();
  const int cold = solve({}, A, none, b, x).iterations;
  x = exact + 1e-4 * bodies::random_vector(10, 1, 13);
  EXPECT_LT(solve({}, A, none, b, x).iterations, cold);
}

TEST(Minres, SaysWhatIsWrong) {
  const BlockOperator<> A(with_eigenvalues(Eigen::VectorXd::LinSpaced(12, 1, 2), 14));
  Vector<double> b = bodies::random_vector(4, 1, 15), x = Vector<double>::Zero(16);
  struct Minus {
    void apply(const Vector<double>& r, Vector<double>& z) const { z = -r; }
  };
  LinearReport report = solve({}, A, Minus{}, b, x);
  EXPECT_EQ(report.status, Status::not_converged);
  EXPECT_EQ(report.reason, "the preconditioner is not positive definite");
  EXPECT_EQ(x.norm(), 0);
  report = solve({.max_iterations = 2, .tolerance = 1e-12}, A, none, b, x);
  EXPECT_EQ(report.reason, "MINRES: too many iterations");
  BlockOperator<> broken = A;
  broken.matrix().block(0)(1, 1) = std::numeric_limits<double>::quiet_NaN();
  const Vector<double> before = x;
  EXPECT_EQ(solve({}, broken, none, b, x).status, Status::not_finite);
  EXPECT_EQ(x, before);
  b[5] = std::numeric_limits<double>::infinity();
  report = solve({}, A, none, b, x);
  EXPECT_EQ(report.status, Status::not_finite);
  EXPECT_EQ(report.reason, "the right-hand side is not finite");
  EXPECT_EQ(x, before);
  b.setZero();
  EXPECT_EQ(solve({}, A, none, b, x).status, Status::converged);
  EXPECT_EQ(x.norm(), 0);
}

// A tolerance at the edge of what single precision can: the solve begins anew where the recurrence has
// drifted, and ends in any case.
TEST(Minres, WorksInSinglePrecision) {
  const Cube<float> cube;
  softsim::BlockJacobi<float> preconditioner;
  preconditioner.compute(cube.A, cube.free);
  Minres::Workspace<float> workspace;
  Vector<float> x = Vector<float>::Zero(cube.b.size());
  LinearReport report = Minres{.tolerance = 3e-6}.solve(cube.A, preconditioner, cube.b, x, workspace);
  EXPECT_EQ(report.status, Status::converged) << report.reason << report.residual;
  // its residual times the condition number
  EXPECT_LT(bodies::relative_error(softsim::pack(x), cube.exact()), 1e-3);
  report =
      Minres{.max_iterations = 3000, .tolerance = 1e-12}.solve(cube.A, preconditioner, cube.b, x, workspace);
  EXPECT_EQ(report.status, Status::not_converged);
  EXPECT_LT(report.iterations, 3000);
  EXPECT_LT(report.residual, 1e-5);
}

}  // namespace minres_test
