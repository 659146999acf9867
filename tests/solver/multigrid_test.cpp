// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/solver/multigrid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "potential/bodies.hpp"
#include "solver/preconditioned.hpp"

namespace multigrid_test {

using preconditioned::Operator, preconditioned::tangent;
using softsim::Multigrid, softsim::Status, softsim::Vector;

static_assert(softsim::Preconditioner<Multigrid<double>> &&
              softsim::Preconditioner<Multigrid<float>, float> &&
              !softsim::Preconditioner<Multigrid<float>, double>);

template <class T>
Multigrid<T> computed(const Operator<T>& A) {
  Multigrid<T> B;
  B.compute(A, A.free);
  return B;
}

// Single precision; the sums of a cycle are longer than those of one row.
constexpr double single_rounding = 3e-5;

TEST(Multigrid, IsSymmetricAndPositiveDefinite) {
  auto A = tangent(bodies::distorted_cube(7, 1));
  softsim::block(A.free, 77)[1] = 0;  // a roller
  const auto B = computed(A);
  preconditioned::expect_symmetric_positive(A, B, single_rounding);
  const auto single = tangent<float>(bodies::distorted_cube(5, 1), 10);
  preconditioned::expect_symmetric_positive(single, computed(single), single_rounding);
}

TEST(Multigrid, LeadsToTheSolution) {
  for (const double mass : {0.0, 100.0}) {
    const auto A = tangent(bodies::distorted_cube(5, 1), mass);
    const auto [report, x] = preconditioned::solve(A, computed(A), 1e-10);
    EXPECT_EQ(report.status, Status::converged);
    EXPECT_LT(report.iterations, 40);
    EXPECT_LT(bodies::relative_error(x, preconditioned::solve_directly(A)), 1e-7);
  }
  const auto A = tangent<float>(bodies::distorted_cube(5, 1));
  EXPECT_EQ(preconditioned::solve(A, computed(A), 1e-4).first.status, Status::converged);
}

TEST(Multigrid, IterationsHardlyGrowWithTheMesh) {
  const auto iterations = [](int n) {
    const auto A = tangent(softsim::box_mesh({n, n, n}, {1, 1, 1}));
    const auto B = computed(A);
    EXPECT_EQ(B.levels(), n > 10 ? 3U : 2U);
    const auto report = preconditioned::solve(A, B, 1e-6).first;
    EXPECT_EQ(report.status, Status::converged);
    return report.iterations;
  };
  const int coarse = iterations(6), fine = iterations(18);  // 1,029 and 20,577 unknowns, two and three levels
  EXPECT_LT(fine, 1.5 * coarse);
  EXPECT_LT(fine, 25);
  const auto rod = tangent(softsim::cylinder_mesh(0.1, 2, 3, 60));
  EXPECT_LT(preconditioned::solve(rod, computed(rod), 1e-6).first.iterations, 60);
}

// A body that nothing holds: A times a rigid mode vanishes, and smoothing changes none.
TEST(Multigrid, ProlongationReproducesRigidModes) {
  auto A = tangent(bodies::distorted_cube(6, 1));
  A.free = Vector<double>::Zero(A.free.size());
  for (std::size_t i = 0; i < A.points.size(); ++i)
    softsim::block(A.free, static_cast<std::ptrdiff_t>(i)).setOnes();
  const auto B = computed(A);
  const auto& fine = B.finest();
  const auto& coarse = B.second();
  ASSERT_GT(fine.groups, 5U);
  for (std::size_t mode = 0; mode < 6; ++mode) {
    double tentative = 0, smoothed = 0;
    coarse.x.assign(8 * fine.groups, 0.0F);
    for (std::size_t a = 0; a < fine.groups; ++a)
      for (std::size_t c = 0; c < 6; ++c)
        coarse.x[8 * a + c] = static_cast<float>(coarse.modes[36 * a + 6 * c + mode]);
    std::fill(fine.x.begin(), fine.x.end(), 0.0F);
    fine.prolong(coarse);
    for (std::size_t i = 0; i < A.points.size(); ++i) {
      ASSERT_GE(fine.group[i], 0);
      const std::size_t a = static_cast<std::size_t>(fine.group[i]);
      for (std::size_t c = 0; c < 3; ++c) {
        double sum = 0;
        for (std::size_t d = 0; d < 6; ++d)
          sum += fine.tentative()[24 * i + 8 * c + d] * coarse.modes[36 * a + 6 * d + mode];
        const double expected = fine.modes[18 * i + 6 * c + mode];
        tentative = std::max(tentative, std::abs(sum - expected));
        smoothed = std::max(smoothed, std::abs(static_cast<double>(fine.x[4 * i + c]) - expected));
      }
    }
    EXPECT_LT(tentative, 1e-13) << mode;
    EXPECT_LT(smoothed, 3e-6) << mode;  // single precision
  }
}

// Iterations to 1e-8 over those with block Jacobi.
double fraction_of_block_jacobi(const Operator<double>& A) {
  softsim::BlockJacobi<double> jacobi;
  jacobi.compute(A, A.free);
  const auto report = preconditioned::solve(A, computed(A)).first;
  EXPECT_EQ(report.status, Status::converged) << report.reason;
  return report.iterations / static_cast<double>(preconditioned::solve(A, jacobi).first.iterations);
}

TEST(Multigrid, TakesJumpsOfStiffnessAndSlivers) {
  const auto cube = bodies::distorted_cube(6, 1);
  std::vector<std::int32_t> law_of(cube.tetrahedra().size());
  for (std::size_t t = 0; t < law_of.size(); ++t) law_of[t] = t % 100 < 20;
  const auto A = tangent(
      cube,
      {softsim::NeoHookean::from_young_poisson(1, 0.4), softsim::NeoHookean::from_young_poisson(1e6, 0.4)},
      law_of, softsim::State<double>(cube.points().size()),
      softsim::nodes_near(cube, softsim::Side::xmin, 0));
  EXPECT_LT(fraction_of_block_jacobi(A), 0.3);
  const auto flat = tangent(softsim::box_mesh({6, 6, 6}, {1, 1, 0.01}));
  EXPECT_LT(fraction_of_block_jacobi(flat), 0.3);
}

TEST(Multigrid, ForgetsFormerValues) {
  const auto mesh = bodies::distorted_cube(6, 1);
  auto A = tangent(mesh);
  auto B = computed(A);
  const auto C = tangent(bodies::distorted_cube(6, 2), 100);
  std::copy(C.blocks.values(), C.blocks.values() + 9 * C.blocks.blocks(), A.blocks.values());
  for (int pass = 0; pass < 3; ++pass) {
    if (pass == 1) A.free.segment(400, 3).setZero();
    if (pass == 2)  // another coupling is strong
      for (std::int32_t k = 0; k < 300; ++k)
        if (k % 7 == 1) A.blocks.block(k) *= 1e-3;
    B.compute(A, A.free);
    const Vector<double> r = preconditioned::right_hand_side(A, 1);
    Vector<double> z(r.size()), fresh(r.size());
    B.apply(r, z);
    computed(A).apply(r, fresh);
    EXPECT_EQ(z, fresh) << pass;
  }
  const auto smaller = tangent(bodies::distorted_cube(2, 1));  // another pattern
  B.compute(smaller, smaller.free);
  preconditioned::expect_symmetric_positive(smaller, B, single_rounding);
}

// What it does then is CG's business to judge; it has to come to an end and be finite.
TEST(Multigrid, IsFiniteForAnIndefiniteTangent) {
  const auto mesh = bodies::distorted_cube(5, 1);
  auto q = bodies::affine_state(mesh, bodies::Vec(1, 1, 0.2).asDiagonal(), {0, 0, 0});
  q.displacement += bodies::random_state(mesh.points().size(), 0.01, 5).displacement;
  const auto A = tangent(mesh, {softsim::NeoHookean::from_young_poisson(1000, 0.4)},
                         std::vector<std::int32_t>(mesh.tetrahedra().size(), 0), q,
                         softsim::nodes_near(mesh, softsim::Side::xmin, 0));
  const Vector<double> r = preconditioned::right_hand_side(A, 1);
  Vector<double> z(r.size());
  computed(A).apply(r, z);
  EXPECT_TRUE(z.allFinite());
}

TEST(Multigrid, TakesWhatIsDegenerate) {
  auto one = preconditioned::points_alone(1, 4);
  Vector<double> r = Vector<double>::Zero(4), z(4);
  r[1] = 8;
  computed(one).apply(r, z);
  EXPECT_NEAR(z[1], 2, 1e-6);
  r *= 1e-60;
  computed(one).apply(r, z);
  EXPECT_NEAR(z[1], 2e-60, 1e-66);
  r.setZero();
  computed(one).apply(r, z);
  EXPECT_EQ(z, r);
  one.free.setZero();
  computed(one).apply(r, z);
  EXPECT_EQ(z, r);

  const auto loose = preconditioned::points_alone(3, 0);  // no stiffness at all
  preconditioned::expect_symmetric_positive(loose, computed(loose), single_rounding);
  const auto element = tangent(bodies::first_tetrahedra(softsim::box_mesh({1, 1, 1}, {1, 1, 1}), 1), 1);
  preconditioned::expect_symmetric_positive(element, computed(element), single_rounding);
  const auto box = softsim::box_mesh({4, 4, 4}, {1, 1, 1});
  const auto two = tangent(preconditioned::side_by_side(box, softsim::box_mesh({1, 2, 1}, {1, 1, 1})));
  EXPECT_EQ(preconditioned::solve(two, computed(two)).first.status, Status::converged);
  auto held = tangent(box);
  held.free.setZero();
  r.setZero(held.free.size());
  computed(held).apply(r, z);
  EXPECT_EQ(z, r);

  // 256 pieces that cannot become fewer: too many for a dense coarsest level
  auto pieces = softsim::box_mesh({1, 1, 1}, {1, 1, 1});
  for (int k = 0; k < 8; ++k) pieces = preconditioned::side_by_side(pieces, pieces);
  const auto many = tangent(pieces);
  EXPECT_EQ(preconditioned::solve(many, computed(many)).first.status, Status::converged);
}

}  // namespace multigrid_test
