// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/solver/incomplete_cholesky.hpp"

#include <gtest/gtest.h>

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "potential/bodies.hpp"
#include "solver/preconditioned.hpp"

namespace incomplete_cholesky_test {

using preconditioned::Operator, preconditioned::tangent;
using softsim::IncompleteCholesky, softsim::Status, softsim::Vector;

static_assert(softsim::Preconditioner<IncompleteCholesky<double>> &&
              softsim::Preconditioner<IncompleteCholesky<float>, float> &&
              !softsim::Preconditioner<IncompleteCholesky<float>, double>);

template <class T>
IncompleteCholesky<T> computed(const Operator<T>& A) {
  IncompleteCholesky<T> B;
  B.compute(A, A.free);
  return B;
}

// The factor is rounded to 2^-24, and an application in single precision sums some ten products per row.
constexpr double single_rounding = 1e-5;

TEST(IncompleteCholesky, IsSymmetricAndPositiveDefinite) {
  auto A = tangent(bodies::distorted_cube(4, 1));
  softsim::block(A.free, 7)[1] = 0;  // a roller
  preconditioned::expect_symmetric_positive(A, computed(A), single_rounding);
  const auto single = tangent<float>(bodies::distorted_cube(4, 1), 10);
  preconditioned::expect_symmetric_positive(single, computed(single), single_rounding);
}

TEST(IncompleteCholesky, IsExactForAChain) {
  std::vector<std::pair<std::int32_t, std::int32_t>> pattern;
  Operator<double> A;
  const std::int32_t n = 20;
  for (std::int32_t i = 0; i < n; ++i) {
    pattern.emplace_back(i, i);
    if (i > 0) pattern.emplace_back(i - 1, i);
    A.points.push_back({double(i), 0, 0});
  }
  A.blocks = softsim::SymmetricBlockMatrix<double>(n, pattern);
  A.free = Vector<double>::Zero(4 * n);
  bodies::Random random(3);
  for (std::int32_t i = 0; i < n; ++i) {
    softsim::block(A.free, i).setOnes();
    const bodies::Matrix G = random.matrix();
    // diagonally dominant by blocks: |off-diagonal| <= 3
    A.blocks.block(A.blocks.place(i, i) / 2) = G * G.transpose() + 7 * bodies::Matrix::Identity();
    if (i > 0) A.blocks.block(A.blocks.place(i - 1, i) / 2) = random.matrix();
  }
  softsim::block(A.free, 5)[2] = 0;
  softsim::block(A.free, 11).setZero();
  const auto B = computed(A);
  EXPECT_EQ(B.shift(), 0);
  // A scaled by what single precision cannot hold is solved just as well.
  for (const double scale : {1.0, 1e-60, 1e60}) {
    const Vector<double> x = preconditioned::right_hand_side(A, 4);
    Vector<double> r(x.size()), z(x.size());
    A.apply(x, r);
    r *= scale;
    B.apply(r, z);
    EXPECT_LT(bodies::relative_error(z, Vector<double>(scale * x)), 1e-6) << scale;
  }
}

TEST(IncompleteCholesky, LeadsToTheSolutionInFewerIterations) {
  for (const double mass : {0.0, 100.0}) {
    const auto A = tangent(bodies::distorted_cube(5, 1), mass);
    const auto [report, x] = preconditioned::solve(A, computed(A), 1e-10);
    EXPECT_EQ(report.status, Status::converged);
    EXPECT_LT(bodies::relative_error(x, preconditioned::solve_directly(A)), 1e-7);
    softsim::BlockJacobi<double> jacobi;
    jacobi.compute(A, A.free);
    EXPECT_LT(2.5 * report.iterations, preconditioned::solve(A, jacobi, 1e-10).first.iterations);
  }
  const auto A = tangent<float>(bodies::distorted_cube(5, 1));
  EXPECT_EQ(preconditioned::solve(A, computed(A), 1e-4).first.status, Status::converged);
}

// Iterations to 1e-8 over those with block Jacobi.
double fraction_of_block_jacobi(const Operator<double>& A) {
  softsim::BlockJacobi<double> jacobi;
  jacobi.compute(A, A.free);
  const auto report = preconditioned::solve(A, computed(A)).first;
  EXPECT_EQ(report.status, Status::converged);
  return report.iterations / double(preconditioned::solve(A, jacobi).first.iterations);
}

TEST(IncompleteCholesky, TakesJumpsOfStiffnessAndSlivers) {
  const auto cube = bodies::distorted_cube(5, 1);
  std::vector<std::int32_t> law_of(cube.tetrahedra().size());
  for (std::size_t t = 0; t < law_of.size(); ++t) law_of[t] = t % 100 < 20;
  const auto A = tangent(
      cube,
      {softsim::NeoHookean::from_young_poisson(1, 0.4), softsim::NeoHookean::from_young_poisson(1e6, 0.4)},
      law_of, softsim::State<double>(cube.points().size()),
      softsim::nodes_near(cube, softsim::Side::xmin, 0));
  EXPECT_LT(fraction_of_block_jacobi(A), 0.5);

  const auto flat = tangent(softsim::box_mesh({6, 6, 6}, {1, 1, 0.01}));
  EXPECT_LT(fraction_of_block_jacobi(flat), 0.8);
}

// Crushed to 0.3 or 0.1 of its height with its nodes shaken: the tangent has negative eigenvalues, as many as
// its LDL^T has negative pivots.
TEST(IncompleteCholesky, StaysPositiveDefiniteWhereTheTangentIsNot) {
  const auto mesh = bodies::distorted_cube(4, 1);
  for (const double height : {0.3, 0.1}) {
    const bodies::Matrix F = bodies::Vec(1, 1, height).asDiagonal();
    auto q = bodies::affine_state(mesh, F, {0, 0, 0});
    q.displacement += bodies::random_state(mesh.points().size(), 0.03 * height, 5).displacement;
    const auto A = tangent(mesh, {softsim::NeoHookean::from_young_poisson(1000, 0.4)},
                           std::vector<std::int32_t>(mesh.tetrahedra().size(), 0), q,
                           softsim::nodes_near(mesh, softsim::Side::xmin, 0));
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> direct(A.blocks.to_eigen());
    ASSERT_GT((direct.vectorD().array() < -1).count(), 20) << height;
    const auto B = computed(A);
    EXPECT_GT(B.shift(), 0);
    preconditioned::expect_symmetric_positive(A, B, single_rounding);
  }
}

TEST(IncompleteCholesky, ForgetsFormerValues) {
  auto A = tangent(bodies::distorted_cube(3, 1));
  auto B = computed(A);
  for (std::size_t k = 0; k < A.blocks.blocks(); ++k) A.blocks.block(static_cast<std::int32_t>(k)) *= -1;
  B.compute(A, A.free);  // negative definite: every row on its own
  preconditioned::expect_symmetric_positive(A, B, single_rounding);
  const auto C = tangent(bodies::distorted_cube(3, 1), 100);
  std::copy(C.blocks.values(), C.blocks.values() + 9 * C.blocks.blocks(), A.blocks.values());
  A.free.segment(40, 3).setZero();
  B.compute(A, A.free);
  const Vector<double> r = preconditioned::right_hand_side(A, 1);
  Vector<double> z(r.size()), fresh(r.size());
  B.apply(r, z);
  computed(A).apply(r, fresh);
  EXPECT_EQ(z, fresh);
  const auto smaller = tangent(bodies::distorted_cube(2, 1));  // another pattern
  B.compute(smaller, smaller.free);
  preconditioned::expect_symmetric_positive(smaller, B, single_rounding);
}

TEST(IncompleteCholesky, TakesWhatIsDegenerate) {
  auto one = preconditioned::points_alone(1, 4);
  Vector<double> r = Vector<double>::Zero(4), z(4);
  r[1] = 8;
  computed(one).apply(r, z);
  EXPECT_NEAR(z[1], 2, 1e-6);
  r.setZero();
  computed(one).apply(r, z);
  EXPECT_EQ(z, r);
  one.free.setZero();
  computed(one).apply(r, z);
  EXPECT_EQ(z, r);

  const auto loose = preconditioned::points_alone(3, 0);  // no stiffness at all
  preconditioned::expect_symmetric_positive(loose, computed(loose), single_rounding);
  const auto element = tangent(bodies::first_tetrahedra(softsim::box_mesh({1, 1, 1}, {1, 1, 1}), 1));
  preconditioned::expect_symmetric_positive(element, computed(element), single_rounding);
  const auto box = softsim::box_mesh({2, 2, 2}, {1, 1, 1});
  const auto two = tangent(preconditioned::side_by_side(box, softsim::box_mesh({1, 2, 1}, {1, 1, 1})));
  EXPECT_EQ(preconditioned::solve(two, computed(two)).first.status, Status::converged);

  auto broken = tangent(box);
  broken.blocks.block(3)(1, 1) = std::numeric_limits<double>::quiet_NaN();
  (void)computed(broken);  // comes to an end
}

}  // namespace incomplete_cholesky_test
