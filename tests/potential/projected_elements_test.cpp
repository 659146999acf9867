// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "potential/bodies.hpp"
#include "softsim/material/projected.hpp"
#include "softsim/material/stable_neo_hookean.hpp"
#include "softsim/potential/elastic.hpp"

namespace {

using softsim::SpdFilter, softsim::State, softsim::TetrahedralMesh;
using Dense = Eigen::MatrixXd;

const auto law = softsim::StableNeoHookean::from_young_poisson(10, 0.45);

template <class Set>
Dense hessian(const Set& set, const State<double>& q) {
  Dense H(q.size(), q.size());
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const softsim::Vector<double> unit = softsim::Vector<double>::Unit(q.size(), i);
    H.col(i) = bodies::hessian_product(set, q, unit);
  }
  return H;
}
double least_eigenvalue(const Dense& H) {
  return Eigen::SelfAdjointEigenSolver<Dense>(0.5 * (H + H.transpose())).eigenvalues()[0];
}

TEST(ProjectedElements, ElementHessiansArePositiveSemidefiniteFarFromRest) {
  const TetrahedralMesh tetrahedron = bodies::first_tetrahedra(bodies::distorted_cube(1, 60), 1);
  const std::size_t nodes = tetrahedron.points().size();
  int indefinite = 0;
  for (std::uint64_t n = 0; n < 20; ++n) {
    const State<double> q = bodies::random_state(nodes, 0.8, 61 + n);
    const Dense plain = hessian(softsim::elastic(tetrahedron, law), q);
    const double rounding = 1e-13 * plain.norm();
    if (least_eigenvalue(plain) < -1e-3) ++indefinite;
    for (const SpdFilter filter : {SpdFilter::clamp, SpdFilter::absolute}) {
      const Dense H = hessian(softsim::elastic(tetrahedron, softsim::projected(law, filter)), q);
      EXPECT_GE(least_eigenvalue(H), -rounding);
      EXPECT_LE((H - H.transpose()).norm(), rounding);
    }
    const Dense none = hessian(softsim::elastic(tetrahedron, softsim::projected(law, SpdFilter::none)), q);
    EXPECT_LE((none - plain).norm(), rounding);
  }
  EXPECT_GE(indefinite, 10);
}

TEST(ProjectedElements, TheWholeBodysHessianIsPositiveSemidefiniteAndForcesStay) {
  const TetrahedralMesh cube = bodies::distorted_cube(2, 62);
  const State<double> q = bodies::random_state(cube.points().size(), 0.4, 63);
  const auto plain = softsim::elastic(cube, law);
  const auto filtered = softsim::elastic(cube, softsim::projected(law));
  EXPECT_EQ(filtered.energy(q), plain.energy(q));
  EXPECT_EQ(bodies::gradient(filtered, q), bodies::gradient(plain, q));
  const Dense H = hessian(filtered, q);
  EXPECT_LT(least_eigenvalue(hessian(plain, q)), -1e-2 * H.norm() / std::sqrt(static_cast<double>(H.rows())));
  EXPECT_GE(least_eigenvalue(H), -1e-13 * H.norm());
}

}  // namespace
