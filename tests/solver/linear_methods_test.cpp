// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "potential/bodies.hpp"
#include "softsim/material/neo_hookean.hpp"
#include "softsim/mesh/selection.hpp"
#include "softsim/potential/elastic.hpp"
#include "softsim/solver/chebyshev.hpp"
#include "softsim/solver/conjugate_gradient.hpp"
#include "softsim/solver/direct.hpp"
#include "softsim/solver/gauss_seidel.hpp"
#include "softsim/solver/incomplete_cholesky.hpp"
#include "softsim/solver/minres.hpp"
#include "softsim/solver/stationary.hpp"
#include "softsim/solver/steepest_descent.hpp"
#include "softsim/system/system.hpp"
#include "softsim/system/tangent.hpp"

namespace linear_methods_test {

using softsim::Chebyshev, softsim::ConjugateGradient, softsim::GaussSeidel, softsim::LinearReport,
    softsim::Minres, softsim::State, softsim::Stationary, softsim::Status, softsim::SteepestDescent,
    softsim::Vector;
template <class T>
using System = softsim::System<softsim::ElasticTetrahedra<softsim::NeoHookean, T>>;

// The tangent of a deformed cube that is held at one face, with some mass: well conditioned enough for all
// methods.
template <class T = double>
struct Problem {
  softsim::TetrahedralMesh mesh = bodies::distorted_cube(3, 1);
  System<T> system{mesh, softsim::elastic<T>(mesh, softsim::NeoHookean::from_young_poisson(10, 0.3))};
  State<T> q{mesh.points().size()};
  softsim::AssembledTangent<System<T>> A;
  Vector<T> b;

  explicit Problem(double mass = 30) {
    system.mass = softsim::Mass<T>::lumped(mesh, 1);
    system.prescribed.fix(softsim::nodes_near(mesh, softsim::Side::xmin, 0.01));
    q.displacement = bodies::random_state(mesh.points().size(), 0.02, 2).displacement.template cast<T>();
    system.prescribed.mask(q.displacement);
    A.set(system, q, {.mass = mass, .stiffness = 1});
    b = bodies::random_vector(mesh.points().size(), 1, 3).template cast<T>();
    system.prescribed.mask(b);
  }
  // Eigen's solution on the free components.
  [[nodiscard]] Vector<double> exact() const {
    const Vector<double> free =
        softsim::pack(Vector<double>(system.prescribed.free().template cast<double>()));
    Eigen::MatrixXd K = Eigen::Matrix<T, -1, -1>(A.matrix().to_eigen()).template cast<double>();
    K = free.asDiagonal() * K * free.asDiagonal();
    K.diagonal() += Vector<double>::Ones(free.size()) - free;
    return softsim::unpack(
        Vector<double>(K.ldlt().solve(softsim::pack(Vector<double>(b.template cast<double>())))));
  }
  template <template <class> class B>
  [[nodiscard]] B<T> preconditioner() const {
    B<T> result;
    result.compute(A, system.prescribed.free());
    return result;
  }
};

template <class Method, class A, class B, class T>
LinearReport solve(const Method& method, const A& a, const B& preconditioner, const Vector<T>& b,
                   Vector<T>& x) {
  typename Method::template Workspace<T> workspace;
  return method.solve(a, preconditioner, b, x, workspace);
}

// ---------------------------------------------------------------- all of them against a direct solver

TEST(LinearMethods, AllReachTheSolution) {
  const Problem problem;
  const Vector<double> exact = problem.exact();
  const auto check = [&](const auto& method, const auto& preconditioner, const char* name) {
    Vector<double> x = Vector<double>::Zero(problem.b.size());
    const LinearReport report = solve(method, problem.A, preconditioner, problem.b, x);
    EXPECT_EQ(report.status, Status::converged) << name << ": " << report.reason;
    EXPECT_LE(report.residual, 1e-10) << name;
    EXPECT_LT(bodies::relative_error(x, exact), 1e-7) << name;
    // what it reports is the residual
    Vector<double> Ax(x.size());
    problem.A.apply(x, Ax);
    EXPECT_NEAR(report.residual, (problem.b - Ax).norm() / problem.b.norm(), 1e-13) << name;
    // from the solution there is nothing to do
    EXPECT_EQ(solve(method, problem.A, preconditioner, problem.b, x).iterations, 0) << name;
    // no load, no motion
    Vector<double> y = x;
    const Vector<double> none = Vector<double>::Zero(x.size());
    EXPECT_EQ(solve(method, problem.A, preconditioner, none, y).status, Status::converged) << name;
    EXPECT_EQ(y.norm(), 0) << name;
  };
  const auto none = softsim::NoPreconditioner<double>();
  const auto jacobi = problem.preconditioner<softsim::Jacobi>();
  const auto block = problem.preconditioner<softsim::BlockJacobi>();
  const auto seidel = problem.preconditioner<GaussSeidel>();
  const auto cholesky = problem.preconditioner<softsim::IncompleteCholesky>();
  check(ConjugateGradient{.tolerance = 1e-10}, none, "CG");
  check(ConjugateGradient{.tolerance = 1e-10}, seidel, "CG SSOR");
  check(Minres{.tolerance = 1e-10}, none, "MINRES");
  check(Minres{.tolerance = 1e-10}, block, "MINRES block Jacobi");
  check(Minres{.tolerance = 1e-10}, cholesky, "MINRES IC");
  check(SteepestDescent{.tolerance = 1e-10}, block, "steepest descent");
  check(Chebyshev{.tolerance = 1e-10}, block, "Chebyshev");
  check(Chebyshev{.tolerance = 1e-10}, cholesky, "Chebyshev IC");
  check(Stationary{.tolerance = 1e-10, .relaxation = 0.5}, jacobi, "damped Jacobi");
  check(Stationary{.tolerance = 1e-10, .relaxation = 0.5}, block, "damped block Jacobi");
  check(Stationary{.tolerance = 1e-10}, seidel, "Gauss-Seidel");
  check(Stationary{.tolerance = 1e-10}, cholesky, "iterated IC");
  GaussSeidel<double> sor, both, coloured;
  sor.omega = 1.3;
  both.symmetric = true;
  coloured.coloured = true;
  for (GaussSeidel<double>* g : {&sor, &both, &coloured}) {
    g->compute(problem.A, problem.system.prescribed.free());
    check(Stationary{.tolerance = 1e-10}, *g, "a kind of Gauss-Seidel");
    check(ConjugateGradient{.tolerance = 1e-10}, *g, "CG with it");
  }
  check(Stationary{.tolerance = 1e-10}, problem.preconditioner<softsim::Ldlt>(), "LDLT");
  check(ConjugateGradient{.tolerance = 1e-10}, problem.preconditioner<softsim::Llt>(), "LLT");
}

TEST(LinearMethods, InSinglePrecision) {
  const Problem<float> problem;
  const Vector<double> exact = problem.exact();
  const auto check = [&](const auto& method, const auto& preconditioner, const char* name) {
    Vector<float> x = Vector<float>::Zero(problem.b.size());
    const LinearReport report = solve(method, problem.A, preconditioner, problem.b, x);
    EXPECT_EQ(report.status, Status::converged) << name << ": " << report.reason << " " << report.residual;
    EXPECT_LT(bodies::relative_error(Vector<double>(x.cast<double>()), exact), 1e-4) << name;
  };
  const auto block = problem.preconditioner<softsim::BlockJacobi>();
  check(Minres{.tolerance = 1e-5}, block, "MINRES");
  check(SteepestDescent{.tolerance = 1e-5}, block, "steepest descent");
  check(Chebyshev{.tolerance = 1e-5}, block, "Chebyshev");
  check(Stationary{.tolerance = 1e-5}, problem.preconditioner<GaussSeidel>(), "Gauss-Seidel");
  check(Stationary{.tolerance = 1e-5}, problem.preconditioner<softsim::Ldlt>(), "LDLT");
}

// ---------------------------------------------------------------- fixed iterations

TEST(LinearMethods, DoAsManyIterationsAsTheyAreTold) {
  const Problem problem(0);
  const auto check = [&](auto method, const auto& preconditioner, const char* name) {
    double before = std::numeric_limits<double>::infinity();
    for (const int n : {1, 4, 16}) {
      method.max_iterations = n;
      method.fixed = true;
      method.tolerance = 1e-3;
      Vector<double> x = Vector<double>::Zero(problem.b.size()), Ax(x.size());
      const LinearReport report = solve(method, problem.A, preconditioner, problem.b, x);
      EXPECT_EQ(report.iterations, n) << name;
      problem.A.apply(x, Ax);
      const double residual = (problem.b - Ax).norm() / problem.b.norm();
      EXPECT_NEAR(report.residual, residual, 1e-12) << name;
      EXPECT_EQ(report.status == Status::converged, residual <= 1e-3) << name;
      EXPECT_EQ(report.reason.empty(), residual <= 1e-3) << name;
      EXPECT_LT(residual, before) << name;
      before = residual;
    }
  };
  const auto block = problem.preconditioner<softsim::BlockJacobi>();
  check(Minres(), block, "MINRES");
  check(Chebyshev{.lambda_min = 0.05, .lambda_max = 3}, block, "Chebyshev");
  check(Stationary(), problem.preconditioner<GaussSeidel>(), "Gauss-Seidel");
  check(ConjugateGradient(), problem.preconditioner<softsim::IncompleteCholesky>(), "CG");
}

// ---------------------------------------------------------------- against theory

// tridiag(-1, 2, -1) of size n in the first component of the blocks, the identity in the others.
struct Chain {
  softsim::SymmetricBlockMatrix<double> entries;
  Vector<double> free;
  explicit Chain(int n) {
    std::vector<std::pair<std::int32_t, std::int32_t>> blocks;
    for (int i = 0; i < n; ++i) {
      blocks.emplace_back(i, i);
      if (i + 1 < n) blocks.emplace_back(i, i + 1);
    }
    entries = softsim::SymmetricBlockMatrix<double>(static_cast<std::size_t>(n), blocks);
    for (int i = 0; i < n; ++i) {
      entries.block(entries.place(i, i) / 2).diagonal() = softsim::Vec3<double>(2, 1, 1);
      if (i + 1 < n) entries.block(entries.place(i, i + 1) / 2)(0, 0) = -1;
    }
    free = Vector<double>::Zero(4 * n);
    for (int i = 0; i < n; ++i) free.segment<3>(4 * i).setOnes();
  }
  void apply(const Vector<double>& x, Vector<double>& y) const { entries.apply(x, y); }
  [[nodiscard]] const auto& matrix() const { return entries; }
  void diagonal_blocks(std::vector<softsim::Mat3<double>>& blocks) const {
    blocks.clear();
    for (std::size_t i = 0; i < entries.rows(); ++i) {
      const auto k = static_cast<std::int32_t>(i);
      blocks.emplace_back(entries.block(entries.place(k, k) / 2));
    }
  }
};

// Factor by which the error falls in an iteration, after many, in the first components.
double factor(const Chain& chain, const GaussSeidel<double>& g, int n, int settle) {
  Vector<double> x = Vector<double>::Zero(chain.free.size());
  const Vector<double> b = x;
  for (std::ptrdiff_t i = 0; i < x.size(); i += 4) x[i] = std::sin(0.3 * static_cast<double>(i) + 1);
  for (int k = 0; k < settle; ++k) g.sweep(b, x);
  const double before = x.norm();
  for (int k = 0; k < n; ++k) g.sweep(b, x);
  return std::pow(x.norm() / before, 1.0 / n);
}

// Refcase S4.11: n = 50.
TEST(GaussSeidelTheory, SpectralRadiiOfTheChain) {
  const Chain chain(50);
  softsim::Jacobi<double> jacobi;
  jacobi.compute(chain, chain.free);
  const double rho = softsim::iteration_radius(chain, jacobi, chain.free, 4000);
  EXPECT_NEAR(rho, 0.9981033287, 1e-7);
  EXPECT_NEAR(softsim::optimal_relaxation(rho), 1.8840181364, 1e-5);
  GaussSeidel<double> g;
  g.compute(chain, chain.free);
  EXPECT_NEAR(factor(chain, g, 100, 4000), 0.9962102548, 1e-7);
  g.omega = 1.8840181364;  // all eigenvalues of SOR have this modulus, in a Jordan block: k rho^k at last
  const int n = 400;
  EXPECT_NEAR(factor(chain, g, n, 200), 0.8840181364 * std::pow((200.0 + n) / 200, 1.0 / n), 2e-3);
  // conjugate gradients end after n iterations
  Vector<double> b = chain.free, x = Vector<double>::Zero(b.size());
  EXPECT_LE(solve(ConjugateGradient{.tolerance = 1e-12}, chain, softsim::NoPreconditioner<double>(), b, x)
                .iterations,
            51);
}

// The error in the energy norm: CG 2 ((sqrt k - 1)/(sqrt k + 1))^n (d'Aulignac Eq. 3.49), Chebyshev the same,
// steepest descent ((k - 1)/(k + 1))^n; MINRES never lets the residual grow.
TEST(ConvergenceTheory, BoundsOfTheErrors) {
  const Chain chain(50);
  const double k = 1053.478991;  // refcase S4.11
  const auto none = softsim::NoPreconditioner<double>();
  Vector<double> exact = Vector<double>::Zero(chain.free.size()), b(exact.size());
  bodies::Random random(4);
  for (std::ptrdiff_t i = 0; i < exact.size(); i += 4) exact[i] = random.number();
  chain.apply(exact, b);
  const auto error = [&](const Vector<double>& x) {
    const Vector<double> e = x - exact;
    Vector<double> Ae(e.size());
    chain.apply(e, Ae);
    return std::sqrt(e.dot(Ae));
  };
  const double start = error(Vector<double>::Zero(b.size())), fast = (std::sqrt(k) - 1) / (std::sqrt(k) + 1),
               slow = (k - 1) / (k + 1), theta = 3.141592653589793 / 102;
  const double lowest = 4 * std::pow(std::sin(theta), 2), highest = 4 * std::pow(std::cos(theta), 2);
  double residual = 1;
  for (const int n : {5, 10, 20, 40}) {
    Vector<double> x = Vector<double>::Zero(b.size());
    (void)solve(ConjugateGradient{.max_iterations = n, .fixed = true}, chain, none, b, x);
    EXPECT_LE(error(x), 2 * std::pow(fast, n) * start * (1 + 1e-9));
    x.setZero();
    (void)solve(Chebyshev{.max_iterations = n, .fixed = true, .lambda_min = lowest, .lambda_max = highest},
                chain, none, b, x);
    EXPECT_LE(error(x), 2 * std::pow(fast, n) * start * (1 + 1e-9)) << "Chebyshev";
    x.setZero();
    (void)solve(SteepestDescent{.max_iterations = n, .fixed = true}, chain, none, b, x);
    EXPECT_LE(error(x), std::pow(slow, n) * start * (1 + 1e-9)) << "steepest descent";
    x.setZero();
    const LinearReport report = solve(Minres{.max_iterations = n, .fixed = true}, chain, none, b, x);
    EXPECT_LE(report.residual, residual);
    residual = report.residual;
  }
}

TEST(Chebyshev, EstimatesItsBounds) {
  const Problem problem;
  const auto block = problem.preconditioner<softsim::BlockJacobi>();
  Chebyshev::Workspace<double> workspace;
  const auto bounds = Chebyshev().estimate(problem.A, block, problem.b.size(), workspace);
  // against all eigenvalues of B A
  const Vector<double> free = softsim::pack(problem.system.prescribed.free());
  const std::ptrdiff_t n = problem.b.size() / 4 * 3;
  Eigen::MatrixXd BA(n, n);
  for (std::ptrdiff_t j = 0; j < n; ++j) {
    Vector<double> e = Vector<double>::Zero(problem.b.size()), Ae(e.size()), BAe(e.size());
    e[j / 3 * 4 + j % 3] = free[j];
    problem.A.apply(e, Ae);
    block.apply(Ae, BAe);
    BA.col(j) = softsim::pack(BAe);
    if (free[j] == 0) BA(j, j) = 1;
  }
  const Eigen::VectorXd values = BA.eigenvalues().real();
  EXPECT_GE(bounds.lambda_max, values.maxCoeff());
  EXPECT_LE(bounds.lambda_max, 1.3 * values.maxCoeff());
  EXPECT_LE(bounds.lambda_min, 1.5 * values.minCoeff());
  EXPECT_GE(bounds.lambda_min, 0.5 * values.minCoeff());
}

// ---------------------------------------------------------------- as preconditioners

TEST(GaussSeidel, IsSymmetricAndPositiveDefiniteAsAPreconditioner) {
  const Problem problem;
  for (const double omega : {0.7, 1.0, 1.6})
    for (const bool coloured : {false, true}) {
      GaussSeidel<double> g;
      g.omega = omega;
      g.coloured = coloured;
      g.compute(problem.A, problem.system.prescribed.free());
      for (std::uint64_t k = 0; k < 5; ++k) {
        Vector<double> x = bodies::random_vector(problem.mesh.points().size(), 1, 10 + 2 * k),
                       y = bodies::random_vector(problem.mesh.points().size(), 1, 11 + 2 * k), Bx(x.size()),
                       By(x.size());
        problem.system.prescribed.mask(x);
        problem.system.prescribed.mask(y);
        g.apply(x, Bx);
        g.apply(y, By);
        EXPECT_NEAR(x.dot(By), y.dot(Bx), 1e-12 * x.norm() * By.norm());
        EXPECT_GT(x.dot(Bx), 0);
        Vector<double> masked = Bx;
        problem.system.prescribed.mask(masked);
        EXPECT_EQ(masked, Bx) << "prescribed components stay zero";
      }
    }
}

TEST(Direct, SolvesAgainOnTheSamePatternAndCountsNegativePivots) {
  Problem problem(0);
  softsim::Ldlt<double> direct = problem.preconditioner<softsim::Ldlt>();
  EXPECT_EQ(softsim::negative_pivots(direct), 0);
  // twenty times its own weight of negative mass: as many negative pivots as eigenvalues below it
  problem.A.set(problem.system, problem.q, {.mass = -300, .stiffness = 1});
  direct.compute(problem.A, problem.system.prescribed.free());
  Vector<double> x = Vector<double>::Zero(problem.b.size());
  EXPECT_EQ(solve(Stationary{.tolerance = 1e-9}, problem.A, direct, problem.b, x).iterations, 1);
  EXPECT_LT(bodies::relative_error(x, problem.exact()), 1e-8);
  const Vector<double> free = softsim::pack(problem.system.prescribed.free());
  Eigen::MatrixXd K = problem.A.matrix().to_eigen();
  K = free.asDiagonal() * K * free.asDiagonal();
  K.diagonal() += Vector<double>::Ones(free.size()) - free;
  const auto negative = (Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(K).eigenvalues().array() < 0).count();
  EXPECT_GT(negative, 0);
  EXPECT_EQ(softsim::negative_pivots(direct), negative);
  // a definite factorisation fails
  const auto llt = problem.preconditioner<softsim::Llt>();
  EXPECT_NE(llt.trouble().find("singular"), std::string::npos);
  EXPECT_EQ(solve(Stationary(), problem.A, llt, problem.b, x).reason, llt.trouble());
}

// ---------------------------------------------------------------- what they refuse

TEST(Minres, SolvesIndefiniteAndConsistentSingularSystems) {
  Problem problem(0);
  problem.A.set(problem.system, problem.q, {.mass = -40, .stiffness = 1});  // between the lowest eigenvalues
  Vector<double> x = Vector<double>::Zero(problem.b.size());
  const auto none = softsim::NoPreconditioner<double>();
  const LinearReport refused = solve(ConjugateGradient(), problem.A, none, problem.b, x);
  EXPECT_TRUE(refused.indefinite);
  EXPECT_EQ(refused.reason, "the operator is not positive definite");
  x.setZero();
  const LinearReport report = solve(Minres{.tolerance = 1e-9}, problem.A, none, problem.b, x);
  EXPECT_EQ(report.status, Status::converged) << report.reason;
  EXPECT_LT(bodies::relative_error(x, problem.exact()), 1e-6);

  // A free chain, with a load that balances and with one that does not.
  Chain chain(10);
  for (const int i : {0, 9}) chain.entries.block(chain.entries.place(i, i) / 2)(0, 0) = 1;
  Vector<double> b = Vector<double>::Zero(40), y = b;
  b[4] = 1;
  b[32] = -1;
  EXPECT_EQ(solve(Minres{.tolerance = 1e-10}, chain, none, b, y).status, Status::converged);
  Vector<double> Ay(40);
  chain.apply(y, Ay);
  EXPECT_LT((Ay - b).norm(), 1e-9);
  b[32] = 0;
  y.setZero();
  const LinearReport hopeless = solve(Minres{.max_iterations = 100, .tolerance = 1e-10}, chain, none, b, y);
  EXPECT_EQ(hopeless.status, Status::not_converged);
  EXPECT_FALSE(hopeless.reason.empty());
  EXPECT_TRUE(y.allFinite());
}

TEST(LinearMethods, SayWhatIsWrong) {
  Problem problem;
  const auto block = problem.preconditioner<softsim::BlockJacobi>();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Vector<double> bad = problem.b, start = bodies::random_vector(problem.mesh.points().size(), 1, 8);
  problem.system.prescribed.mask(start);
  bad[60] = nan;
  const auto check = [&](const auto& method) {
    Vector<double> x = start;
    const LinearReport report = solve(method, problem.A, block, bad, x);
    EXPECT_EQ(report.status, Status::not_finite);
    EXPECT_EQ(report.reason, "the right-hand side is not finite");
    EXPECT_EQ(x, start);
  };
  check(ConjugateGradient());
  check(Minres());
  check(SteepestDescent());
  check(Chebyshev());
  check(Stationary());

  Vector<double> x = start;
  EXPECT_EQ(solve(Stationary{.relaxation = 2}, problem.A, block, problem.b, x).reason,
            "relaxation: must be in (0, 2)");
  EXPECT_EQ(solve(Chebyshev{.lambda_min = 2, .lambda_max = 1}, problem.A, block, problem.b, x).reason,
            "Chebyshev bounds: must be 0 < lambda_min <= lambda_max");
  for (const double omega : {0.0, 2.0, -1.0, nan}) {
    GaussSeidel<double> g;
    g.omega = omega;
    g.compute(problem.A, problem.system.prescribed.free());
    EXPECT_EQ(solve(Stationary(), problem.A, g, problem.b, x).reason, "omega: must be in (0, 2)");
  }
  EXPECT_EQ(x, start) << "nothing was done";

  // Chebyshev with an upper bound that is none, and Jacobi's method where it diverges: nothing is lost.
  x = start;
  const LinearReport outside =
      solve(Chebyshev{.lambda_min = 0.01, .lambda_max = 0.3}, problem.A, block, problem.b, x);
  EXPECT_NE(outside.reason.find("diverges"), std::string::npos);
  EXPECT_EQ(x, start);
  x.setZero();
  const Problem stiff(0);
  const auto jacobi = stiff.preconditioner<softsim::Jacobi>();
  const LinearReport diverged = solve(Stationary{.relaxation = 1.9}, stiff.A, jacobi, stiff.b, x);
  EXPECT_EQ(diverged.reason, "the iteration diverges");
  EXPECT_LE(diverged.residual, 1);
  EXPECT_TRUE(x.allFinite());

  // A node without stiffness: its diagonal block is zero.
  Chain chain(5);
  chain.entries.block(chain.entries.place(3, 3) / 2).setZero();
  GaussSeidel<double> g;
  g.compute(chain, chain.free);
  Vector<double> b = chain.free, y = Vector<double>::Zero(20);
  EXPECT_EQ(solve(Stationary(), chain, g, b, y).reason, "node 3: diagonal block is not positive definite");
  softsim::Jacobi<double> diagonal;
  diagonal.compute(chain, chain.free);
  EXPECT_EQ(solve(Stationary(), chain, diagonal, b, y).reason, "node 3: diagonal entry is not positive");
  EXPECT_EQ(y.norm(), 0);
}

}  // namespace linear_methods_test
