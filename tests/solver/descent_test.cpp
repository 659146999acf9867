// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "softsim/solver/chebyshev.hpp"
#include "softsim/solver/conjugate_gradient.hpp"
#include "softsim/solver/minres.hpp"
#include "softsim/solver/preconditioner.hpp"
#include "softsim/solver/steepest_descent.hpp"
#include "solver/linear_problems.hpp"

// Steepest descent and Chebyshev's iteration, and what all methods for positive definite operators have in
// common.

namespace descent_test {

using linear_problems::BlockOperator, linear_problems::Cube, linear_problems::with_eigenvalues;
using softsim::Chebyshev, softsim::ConjugateGradient, softsim::LinearReport, softsim::Minres, softsim::pack,
    softsim::Status, softsim::SteepestDescent, softsim::Vector;

const softsim::NoPreconditioner<double> none;

template <class Method, class A, class B, class T>
LinearReport solve(const Method& method, const A& a, const B& preconditioner, const Vector<T>& b,
                   Vector<T>& x) {
  static_assert(softsim::LinearMethod<Method, A, B, T>);
  typename Method::template Workspace<T> workspace;
  return method.solve(a, preconditioner, b, x, workspace);
}

template <class Method>
class DescentMethod : public ::testing::Test {};
using Methods = ::testing::Types<ConjugateGradient, SteepestDescent, Chebyshev, Minres>;
TYPED_TEST_SUITE(DescentMethod, Methods);

TYPED_TEST(DescentMethod, AgreesWithADenseSolutionOnATangent) {
  const Cube<> cube;
  softsim::BlockJacobi<double> preconditioner;
  preconditioner.compute(cube.A, cube.free);
  Vector<double> x = Vector<double>::Zero(cube.b.size());
  const LinearReport report = solve(TypeParam{.tolerance = 1e-10}, cube.A, preconditioner, cube.b, x);
  EXPECT_EQ(report.status, Status::converged) << report.reason << report.residual;
  EXPECT_EQ(report.reason, "");
  EXPECT_LE(report.residual, 1e-10);
  EXPECT_LT(bodies::relative_error(pack(x), cube.exact()), 1e-7);  // times a condition number of some hundred
  EXPECT_EQ(Vector<double>(x.cwiseProduct(cube.free)), x) << "a prescribed component moved";
}

TYPED_TEST(DescentMethod, WorksInSinglePrecision) {
  const Cube<float> cube;
  softsim::BlockJacobi<float> preconditioner;
  preconditioner.compute(cube.A, cube.free);
  Vector<float> x = Vector<float>::Zero(cube.b.size());
  const LinearReport report = solve(TypeParam{.tolerance = 1e-5}, cube.A, preconditioner, cube.b, x);
  EXPECT_EQ(report.status, Status::converged) << report.reason << report.residual;
  EXPECT_LT(bodies::relative_error(pack(x), cube.exact()), 3e-3);
}

// Well conditioned, so that every method gets there.
TYPED_TEST(DescentMethod, StartsFromTheGuessItIsGiven) {
  const Eigen::MatrixXd K = with_eigenvalues(Eigen::VectorXd::LinSpaced(30, 1, 9), 1);
  const BlockOperator<> A(K);
  const Vector<double> b = bodies::random_vector(10, 1, 2),
                       exact = softsim::unpack(Vector<double>(K.ldlt().solve(pack(b))));
  Vector<double> x = exact;
  EXPECT_EQ(solve(TypeParam{}, A, none, b, x).iterations, 0);
  x.setZero();
  const int cold = solve(TypeParam{.tolerance = 1e-8}, A, none, b, x).iterations;
  x = exact + 1e-5 * bodies::random_vector(10, 1, 3);
  EXPECT_LT(solve(TypeParam{.tolerance = 1e-8}, A, none, b, x).iterations, cold);
}

TYPED_TEST(DescentMethod, DoesAsManyIterationsAsFixedAndMeasuresItself) {
  const Eigen::MatrixXd K = with_eigenvalues(Eigen::VectorXd::LinSpaced(30, 1, 9), 4);
  const BlockOperator<> A(K);
  const Vector<double> b = bodies::random_vector(10, 1, 5);
  for (const int n : {0, 1, 2, 7, 12}) {
    Vector<double> x = Vector<double>::Zero(40);
    const LinearReport report =
        solve(TypeParam{.max_iterations = n, .tolerance = 0.5, .fixed = true}, A, none, b, x);
    EXPECT_EQ(report.iterations, n);
    EXPECT_NEAR(report.residual, linear_problems::residual(K, b, x), 1e-13);
    EXPECT_EQ(report.status, report.residual <= 0.5 ? Status::converged : Status::not_converged);
    EXPECT_EQ(report.reason.empty(), report.residual <= 0.5) << report.reason;
  }
}

TYPED_TEST(DescentMethod, FixedEndsWhereThereIsNothingLeftToGain) {
  const BlockOperator<> A(2 * Eigen::MatrixXd::Identity(12, 12));
  const Vector<double> b = Vector<double>(linear_problems::all_free(4));
  Vector<double> x = Vector<double>::Zero(16);
  const LinearReport report = solve(TypeParam{.max_iterations = 500, .fixed = true}, A, none, b, x);
  EXPECT_EQ(report.status, Status::converged) << report.reason;
  EXPECT_LT((x - b / 2).norm(), 1e-15);
}

TYPED_TEST(DescentMethod, LeavesNothingThatIsNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  const BlockOperator<> A(with_eigenvalues(Eigen::VectorXd::LinSpaced(12, 1, 2), 6));
  for (const double bad : {nan, inf}) {
    Vector<double> b = bodies::random_vector(4, 1, 7), x = bodies::random_vector(4, 1, 8);
    const Vector<double> start = x;
    BlockOperator<> broken = A;
    broken.matrix().block(0)(1, 1) = bad;
    EXPECT_EQ(solve(TypeParam{}, broken, none, b, x).status, Status::not_finite);
    EXPECT_EQ(x, start);
    b[5] = bad;
    const LinearReport report = solve(TypeParam{}, A, none, b, x);
    EXPECT_EQ(report.status, Status::not_finite);
    EXPECT_EQ(report.reason, "the right-hand side is not finite");
    EXPECT_EQ(x, start);
  }
  Vector<double> x = bodies::random_vector(4, 1, 8);
  EXPECT_EQ(solve(TypeParam{}, A, none, Vector<double>(Vector<double>::Zero(16)), x).status,
            Status::converged);
  EXPECT_EQ(x.norm(), 0);
}

struct Minus {
  void apply(const Vector<double>& r, Vector<double>& z) const { z = -r; }
};
struct Nothing {
  void apply(const Vector<double>& r, Vector<double>& z) const { z = std::log(-1.0) * r; }
};
TYPED_TEST(DescentMethod, SaysWhatIsWrongWithThePreconditioner) {
  const BlockOperator<> A(with_eigenvalues(Eigen::VectorXd::LinSpaced(12, 1, 2), 9));
  const Vector<double> b = bodies::random_vector(4, 1, 10);
  Vector<double> x = Vector<double>::Zero(16);
  const LinearReport report = solve(TypeParam{}, A, Minus{}, b, x);
  EXPECT_EQ(report.status, Status::not_converged);
  EXPECT_NE(report.reason.find("preconditioner is not positive definite"), std::string_view::npos)
      << report.reason;
  EXPECT_EQ(x.norm(), 0);
  EXPECT_NE(solve(TypeParam{}, A, Nothing{}, b, x).status, Status::converged);
  EXPECT_EQ(x.norm(), 0);
}

TEST(SteepestDescent, EndsAtNegativeCurvature) {
  Eigen::VectorXd e = Eigen::VectorXd::LinSpaced(12, 1, 2);
  e[3] = -1;
  const Eigen::MatrixXd K = with_eigenvalues(e, 11);
  const Vector<double> b = bodies::random_vector(4, 1, 12);
  Vector<double> x = Vector<double>::Zero(16);
  const LinearReport report = solve(SteepestDescent{}, BlockOperator<>(K), none, b, x);
  EXPECT_EQ(report.status, Status::not_converged);
  EXPECT_TRUE(report.indefinite);
  EXPECT_EQ(report.reason, "the operator is not positive definite");
  EXPECT_NEAR(report.residual, linear_problems::residual(K, b, x), 1e-13);
  EXPECT_TRUE(x.allFinite());
}

TEST(Chebyshev, SaysThatAnOperatorIsIndefiniteOrABoundWrong) {
  Eigen::VectorXd e = Eigen::VectorXd::LinSpaced(12, 1, 2);
  const Eigen::MatrixXd K = with_eigenvalues(e, 13);
  e[3] = -1;
  const Vector<double> b = bodies::random_vector(4, 1, 14);
  Vector<double> x = Vector<double>::Zero(16);
  LinearReport report = solve(Chebyshev{}, BlockOperator<>(with_eigenvalues(e, 13)), none, b, x);
  EXPECT_EQ(report.status, Status::not_converged);
  EXPECT_TRUE(report.indefinite);
  const BlockOperator<> A(K);
  const double inf = std::numeric_limits<double>::infinity();
  for (const auto& [low, high] : {std::pair(-1.0, 2.0), {2.0, 1.0}, {0.0, 1.0}, {1.0, 0.0}, {1.0, inf}}) {
    report = solve(Chebyshev{.lambda_min = low, .lambda_max = high}, A, none, b, x);
    EXPECT_EQ(report.status, Status::not_converged);
    EXPECT_EQ(report.reason, "Chebyshev bounds: must be 0 < lambda_min <= lambda_max");
  }
  // a bound too low: x is as it was, whether the residual is looked at or not
  x = bodies::random_vector(4, 1, 15);
  const Vector<double> start = x;
  for (const bool fixed : {false, true}) {
    for (const int n : {100, 10000}) {
      report = solve(Chebyshev{.max_iterations = n, .fixed = fixed, .lambda_min = 0.1, .lambda_max = 0.5}, A,
                     none, b, x);
      EXPECT_EQ(report.status, Status::not_converged);
      EXPECT_EQ(report.reason, "the iteration diverges: lambda_max is below the largest eigenvalue");
      EXPECT_EQ(x, start);
      EXPECT_NEAR(report.residual, linear_problems::residual(K, b, x), 1e-13);
    }
  }
}

// The largest eigenvalue is found soon, the smallest (by a factor of 150 smaller here) with more steps.
TEST(Chebyshev, EstimatesTheBounds) {
  const Cube<> cube;
  softsim::Jacobi<double> jacobi;
  jacobi.compute(cube.A, cube.free);
  const Eigen::MatrixXd K = cube.dense();
  const Eigen::VectorXd scale = K.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> all(scale.asDiagonal() * K * scale.asDiagonal());
  Chebyshev::Workspace<double> workspace;
  for (const int steps : {20, 40}) {
    const auto bounds = Chebyshev{.estimate_steps = steps}.estimate(cube.A, jacobi, cube.b.size(), workspace);
    EXPECT_GT(bounds.lambda_max, all.eigenvalues().maxCoeff());
    EXPECT_LT(bounds.lambda_max, 1.11 * all.eigenvalues().maxCoeff());
    EXPECT_GT(bounds.lambda_min, 0.8 * all.eigenvalues().minCoeff());
    EXPECT_LT(bounds.lambda_min, (steps == 20 ? 3 : 1.1) * all.eigenvalues().minCoeff());
  }

  // of one eigenvalue: as many steps as that needs
  const BlockOperator<> A(3 * Eigen::MatrixXd::Identity(12, 12));
  const auto one = Chebyshev{.safety = 1}.estimate(A, none, 16, workspace);
  EXPECT_NEAR(one.lambda_min, 3, 1e-12);
  EXPECT_NEAR(one.lambda_max, 3, 1e-12);
}

// ---------------------------------------------------------------- rates

double energy_norm(const Eigen::MatrixXd& K, const Eigen::VectorXd& e) { return std::sqrt(e.dot(K * e)); }

// The error's energy norm falls at least by the factor of each method's bound, in every iteration for
// steepest descent and after n iterations for the others (d'Aulignac 2001, Eq. 3.49, with the energy norm in
// which it holds). From the worst start steepest descent attains its factor for ever.
TEST(Rates, AreThoseOfTheTextbook) {
  for (const double k : {4.0, 100.0}) {
    const Eigen::MatrixXd K = with_eigenvalues(Eigen::VectorXd::LinSpaced(30, 1, k), 16);
    const BlockOperator<> A(K);
    const Vector<double> b = bodies::random_vector(10, 1, 17);
    const Eigen::VectorXd exact = K.ldlt().solve(pack(b));
    const double at_start = energy_norm(K, exact), root = std::sqrt(k);
    const auto error = [&](const auto& method) {
      Vector<double> x = Vector<double>::Zero(40);
      (void)solve(method, A, none, b, x);
      return energy_norm(K, exact - pack(x)) / at_start;
    };
    double before = 1;
    for (int n = 1; n < 25; ++n) {
      const double bound = 2 * std::pow((root - 1) / (root + 1), n);
      const double descent = error(SteepestDescent{.max_iterations = n, .fixed = true}),
                   chebyshev =
                       error(Chebyshev{.max_iterations = n, .fixed = true, .lambda_min = 1, .lambda_max = k}),
                   conjugate = error(ConjugateGradient{.max_iterations = n, .fixed = true});
      EXPECT_LE(descent, before * (k - 1) / (k + 1) * (1 + 1e-12));
      EXPECT_LE(chebyshev, bound * (1 + 1e-12) + 1e-14);
      EXPECT_LE(conjugate, chebyshev * (1 + 1e-12) + 1e-14);  // the best polynomial of all
      before = descent;
    }
  }
}

TEST(Rates, OfSteepestDescentFromTheWorstStartAreItsBound) {
  const double k = 50;
  Eigen::VectorXd e = Eigen::VectorXd::LinSpaced(12, 1, k);
  const Eigen::MatrixXd K = e.asDiagonal();
  Vector<double> b = Vector<double>::Zero(16);
  b[0] = b[14] = 1;  // equal parts of the residual in the first and the last eigenvector
  Vector<double> x = Vector<double>::Zero(16);
  const int n = 40;
  (void)solve(SteepestDescent{.max_iterations = n, .fixed = true}, BlockOperator<>(K), none, b, x);
  const Eigen::VectorXd exact = K.diagonal().cwiseInverse().cwiseProduct(pack(b));
  EXPECT_NEAR(std::pow(energy_norm(K, exact - pack(x)) / energy_norm(K, exact), 1.0 / n), (k - 1) / (k + 1),
              1e-9);
}

// In the long run Chebyshev's error falls by (sqrt k - 1)/(sqrt k + 1) an iteration, no faster.
TEST(Rates, OfChebyshevAreAttained) {
  const double k = 400, rate = 19.0 / 21;
  const Eigen::MatrixXd K = Eigen::VectorXd::LinSpaced(30, 1, k).asDiagonal();
  Vector<double> b = linear_problems::all_free(10);
  const auto error = [&](int n) {
    Vector<double> x = Vector<double>::Zero(40);
    (void)solve(Chebyshev{.max_iterations = n, .fixed = true, .lambda_min = 1, .lambda_max = k},
                BlockOperator<>(K), none, b, x);
    return std::abs(x[0] - 1);  // at the end of the interval the polynomial is 1/T_n
  };
  EXPECT_NEAR(std::pow(error(120) / error(60), 1.0 / 60), rate, 1e-5);
}

}  // namespace descent_test
