// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/system/mass.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "potential/bodies.hpp"

namespace mass_test {

using bodies::Vec, bodies::refusal;
using softsim::Mass, softsim::TetrahedralMesh, softsim::Vector, softsim::block;

Vector<double> product(const Mass<double>& mass, const Vector<double>& x) {
  Vector<double> y = Vector<double>::Zero(x.size());
  mass.add_product(x, 1, y);
  return y;
}

// The body of different densities that the tests weigh.
const TetrahedralMesh cube = bodies::distorted_cube(3, 1);
const std::vector<double> densities = [] {
  std::vector<double> rho;
  bodies::Random random(2);
  for (std::size_t t = 0; t < cube.tetrahedra().size(); ++t) rho.push_back(1000 + 800 * random.number());
  return rho;
}();
const double body_mass = [] {
  double sum = 0;
  for (std::size_t t = 0; t < densities.size(); ++t) sum += densities[t] * cube.volume(t);
  return sum;
}();

TEST(Mass, IsZeroUntilSet) {
  const Mass<double> mass(3);
  EXPECT_TRUE(mass.is_lumped());
  EXPECT_EQ(mass.total(), 0);
  EXPECT_EQ(product(mass, bodies::random_vector(3, 1, 1)).norm(), 0);
}

TEST(LumpedMass, WeighsWhatTheBodyWeighs) {
  const auto mass = Mass<double>::lumped(cube, densities);
  EXPECT_TRUE(mass.is_lumped());
  EXPECT_NEAR(mass.total() / body_mass, 1, 1e-13);
  EXPECT_NEAR(Mass<double>::lumped(cube, 1000).total() / 1000, 1, 1e-13);
  EXPECT_NEAR(Mass<float>::lumped(cube, 1000).total() / 1000, 1, 1e-6);
}

TEST(LumpedMass, IsAQuarterOfEveryTetrahedronOnEachCorner) {
  const TetrahedralMesh mesh({Vec(0, 0, 0), Vec(1, 0, 0), Vec(0, 1, 0), Vec(0, 0, 6), Vec(1, 1, 6)},
                             {{0, 1, 2, 3}, {1, 2, 3, 4}});
  const double other = mesh.volume(1);
  const auto mass = Mass<double>::lumped(mesh, {10, 20});
  const double quarter[] = {2.5, 2.5 + 5 * other, 2.5 + 5 * other, 2.5 + 5 * other, 5 * other};
  for (int i = 0; i < 5; ++i)
    for (int a = 0; a < 4; ++a) EXPECT_NEAR(mass.diagonal()[4 * i + a], a < 3 ? quarter[i] : 0, 1e-13) << i;
}

TEST(ConsistentMass, WeighsWhatTheBodyWeighs) {
  const auto mass = Mass<double>::consistent(cube, densities);
  EXPECT_FALSE(mass.is_lumped());
  EXPECT_NEAR(mass.total() / body_mass, 1, 1e-13);
}

// Rows sum to the lumped mass: both move a rigid translation alike.
TEST(ConsistentMass, SumsToTheLumpedMassInEveryRow) {
  Vector<double> ones = Vector<double>::Zero(4 * static_cast<std::ptrdiff_t>(cube.points().size()));
  for (std::ptrdiff_t i = 0; i < ones.size() / 4; ++i) block(ones, i).setOnes();
  const Vector<double> lumped = product(Mass<double>::lumped(cube, densities), ones);
  EXPECT_LT(bodies::relative_error(product(Mass<double>::consistent(cube, densities), ones), lumped), 1e-13);
}

TEST(ConsistentMass, OfOneTetrahedronIsThatOfTheTextbooks) {
  const TetrahedralMesh mesh({Vec(0, 0, 0), Vec(1, 0, 0), Vec(0, 1, 0), Vec(0, 0, 6)}, {{0, 1, 2, 3}});
  const auto mass = Mass<double>::consistent(mesh, 20);  // 20 kg: M_ij = 1 kg, M_ii = 2 kg
  for (int j = 0; j < 4; ++j)
    for (int a = 0; a < 3; ++a) {
      const Vector<double> column = product(mass, Vector<double>(Vector<double>::Unit(16, 4 * j + a)));
      for (int i = 0; i < 4; ++i)
        for (int b = 0; b < 4; ++b) EXPECT_NEAR(column[4 * i + b], a != b ? 0 : i == j ? 2 : 1, 1e-14);
    }
  int couplings = 0;
  mass.for_each_coupling([&](std::int32_t i, std::int32_t j, double m) {
    EXPECT_NE(i, j);
    EXPECT_NEAR(m, 1, 1e-14);
    ++couplings;
  });
  EXPECT_EQ(couplings, 12);
}

// u = (x, y, z) and v = (y, z, x) on the unit cube: int u.v = int xy + yz + zx = 3/4, int u.u = 3 int x^2
// = 1.
TEST(ConsistentMass, IntegratesProductsOfLinearFieldsExactly) {
  const auto mass = Mass<double>::consistent(cube, 1000);
  Vector<double> u = Vector<double>::Zero(4 * static_cast<std::ptrdiff_t>(cube.points().size())), v = u;
  for (std::size_t i = 0; i < cube.points().size(); ++i) {
    const Vec x = cube.points()[i];
    block(u, static_cast<std::ptrdiff_t>(i)) = x;
    block(v, static_cast<std::ptrdiff_t>(i)) = Vec(x[1], x[2], x[0]);
  }
  EXPECT_NEAR(u.dot(product(mass, u)), 1000, 1e-10);
  EXPECT_NEAR(u.dot(product(mass, v)), 750, 1e-10);
  // lumping does not: that is how the two are told apart
  EXPECT_GT(u.dot(product(Mass<double>::lumped(cube, 1000), u)), 1010);
}

TEST(ConsistentMass, IsSymmetricAndPositive) {
  const TetrahedralMesh mesh = bodies::distorted_cube(2, 3);
  const auto mass = Mass<double>::consistent(mesh, 1000);
  const auto n = static_cast<std::ptrdiff_t>(mesh.points().size());
  Eigen::MatrixXd M(n, n);
  for (std::ptrdiff_t j = 0; j < n; ++j) {
    const Vector<double> column = product(mass, Vector<double>(Vector<double>::Unit(4 * n, 4 * j)));
    for (std::ptrdiff_t i = 0; i < n; ++i) M(i, j) = column[4 * i];
  }
  EXPECT_LT((M - M.transpose()).norm(), 1e-14 * M.norm());
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(M).eigenvalues()[0],
            0.1 * M.diagonal().minCoeff());
}

TEST(Mass, ProductsAreScaledAndAdded) {
  for (const auto& mass :
       {Mass<double>::lumped(cube, densities), Mass<double>::consistent(cube, densities)}) {
    const Vector<double> x = bodies::random_vector(cube.points().size(), 1, 4),
                         start = bodies::random_vector(cube.points().size(), 1, 5);
    Vector<double> y = start;
    mass.add_product(x, -3, y);
    EXPECT_LT(bodies::relative_error(y, Vector<double>(start - 3 * product(mass, x))), 1e-14);
  }
}

TEST(Mass, RefusesDensitiesByValue) {
  const auto mesh = softsim::box_mesh({1, 1, 1}, {1, 1, 1});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(refusal([&] { return Mass<double>::lumped(mesh, 0); }),
            "density 0 kg/m^3: must be positive and finite");
  EXPECT_EQ(refusal([&] { return Mass<double>::consistent(mesh, -1); }),
            "density -1 kg/m^3: must be positive and finite");
  EXPECT_NE(refusal([&] { return Mass<double>::lumped(mesh, nan); }).find("must be positive and finite"),
            std::string::npos);
  EXPECT_EQ(refusal([&] {
              return Mass<double>::consistent(mesh, std::vector<double>{1, 2, 3});
            }),
            "mass: 3 densities for 6 tetrahedra");
}

}  // namespace mass_test
