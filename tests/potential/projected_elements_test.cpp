// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <numeric>
#include <vector>

#include "potential/bodies.hpp"
#include "softsim/material/neo_hookean.hpp"
#include "softsim/material/projected.hpp"
#include "softsim/material/stable_neo_hookean.hpp"
#include "softsim/potential/elastic.hpp"

namespace projected_elements_test {

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

// The blocks take another way where nothing needs the filter: a chunk of one, stretched, compressed and near
// rest, must be what the products say.
TEST(ProjectedElements, BlocksAreThoseOfTheProducts) {
  const TetrahedralMesh tetrahedron = bodies::first_tetrahedra(bodies::distorted_cube(1, 64), 1);
  const std::size_t nodes = tetrahedron.points().size();
  const auto set = softsim::elastic<double, 1>(tetrahedron, softsim::projected(law));
  const auto& v = tetrahedron.tetrahedra()[0];
  std::vector<std::int32_t> places;
  for (std::int32_t k = 0; k < 10; ++k) places.push_back(2 * k);
  for (const double dilation : {0.2, 1e-7, 0.0, -1e-7, -0.2}) {
    State<double> q = bodies::random_state(nodes, 0.1 * std::abs(dilation), 65);
    for (std::size_t i = 0; i < nodes; ++i)
      softsim::block(q.displacement, static_cast<std::ptrdiff_t>(i)) += dilation * tetrahedron.points()[i];
    std::vector<double> values(10 * 9, 0.0);
    set.add_blocks(q, 1, places, values.data());
    const Dense H = hessian(set, q);
    Dense blocks = Dense::Zero(H.rows(), H.cols());
    const double* value = values.data();
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = i; j < 4; ++j, value += 9) {
        const Eigen::Map<const softsim::Mat3<double>> block(value);
        blocks.block<3, 3>(4 * v[i], 4 * v[j]) = block;
        blocks.block<3, 3>(4 * v[j], 4 * v[i]) = block.transpose();
      }
    EXPECT_LE((blocks - H).norm(), 1e-13 * H.norm()) << dilation;
  }
}

// The short way may miss a definite tangent but never take an indefinite one for definite.
template <class Law>
void check_surely_positive(const Law& any) {
  int sure = 0, negative = 0;
  std::srand(66);
  for (int n = 0; n < 3000; ++n) {
    const double size = std::pow(10.0, n % 10 - 8);
    softsim::Mat3<double> F = softsim::Mat3<double>::Identity() + size * softsim::Mat3<double>::Random();
    F *= 1 + 0.3 * size;
    if (F.determinant() <= 0) continue;
    const auto tangent = softsim::principal_tangent(any, F);
    const double least =
        std::min({tangent.flip.minCoeff(), tangent.twist.minCoeff(), least_eigenvalue(tangent.stretch)});
    if (softsim::surely_positive(any, F)) {
      ++sure;
      EXPECT_GE(least, 0) << n;
    }
    if (least < 0) ++negative;
  }
  EXPECT_GE(sure, 300);
  EXPECT_GE(negative, 300);
}
TEST(ProjectedElements, TheCheapTestNeverOverlooksANegativeEigenvalue) {
  check_surely_positive(law);
  check_surely_positive(softsim::NeoHookean::from_young_poisson(10, 0.45));
}

}  // namespace projected_elements_test
