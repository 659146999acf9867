// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/potential/nodal_volume.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "potential/bodies.hpp"
#include "softsim/material/neo_hookean.hpp"
#include "softsim/potential/elastic.hpp"
#include "softsim/system/prescribed.hpp"

namespace nodal_volume_test {

using bodies::Matrix, bodies::Vec, bodies::gradient, bodies::hessian_product, bodies::refusal,
    bodies::relative_error;
using softsim::LogarithmicVolume, softsim::NeoHookean, softsim::NodalVolume, softsim::QuadraticVolume,
    softsim::State, softsim::TetrahedralMesh, softsim::Vector, softsim::block, softsim::nodal_volume;

static_assert(softsim::VolumeLaw<LogarithmicVolume> &&
              softsim::VolumeLaw<QuadraticVolume, softsim::Batch<float, 16>>);
static_assert(!softsim::VolumeLaw<NeoHookean>);
using Term = NodalVolume<LogarithmicVolume>;
static_assert(softsim::Potential<Term> && Term::conservative && !Term::external && Term::has_hessian);

constexpr double mu = 3, lambda = 500;

// 64 nodes, 162 tetrahedra, J_e between 0.6 and 1.5: no number that divides into batches
class NodalVolumeOfACube : public ::testing::Test {
 protected:
  TetrahedralMesh mesh = bodies::distorted_cube(3, 1);
  std::size_t nodes = mesh.points().size();
  State<double> q = bodies::random_state(nodes, 0.04, 2);
  Vector<double> d = bodies::random_vector(nodes, 1, 3);
  Term term = nodal_volume(mesh, LogarithmicVolume(lambda));
};

// The means by hand, node by node.
TEST_F(NodalVolumeOfACube, IsTheSumOverNodesOfTheirMeanVolume) {
  std::vector<double> rest(nodes, 0), deformed(nodes, 0);
  for (const softsim::Tetrahedron& v : mesh.tetrahedra()) {
    std::array<Vec, 4> X, x;
    for (std::size_t i = 0; i < 4; ++i) {
      X[i] = mesh.points()[static_cast<std::size_t>(v[i])];
      x[i] = bodies::position(mesh, q, static_cast<std::size_t>(v[i]));
    }
    for (const std::int32_t i : v) {
      rest[static_cast<std::size_t>(i)] += softsim::tetrahedron_volume(X[0], X[1], X[2], X[3]) / 4;
      deformed[static_cast<std::size_t>(i)] += softsim::tetrahedron_volume(x[0], x[1], x[2], x[3]) / 4;
    }
  }
  double sum = 0;
  for (std::size_t a = 0; a < nodes; ++a)
    sum += rest[a] * lambda / 2 * std::pow(std::log(deformed[a] / rest[a]), 2);
  EXPECT_NEAR(term.energy(q) / sum, 1, 1e-12);
}

// Truncation h^2 and rounding eps / h of a central difference, both below 1e-9 of the terms in it.
TEST_F(NodalVolumeOfACube, HasTheDerivativesOfItsEnergy) {
  constexpr double h = 6e-6;
  for (std::uint64_t n = 0; n < 3; ++n) {
    const Vector<double> direction = bodies::random_vector(nodes, 1, 10 + n);
    State<double> plus = q, minus = q;
    softsim::retract(plus, direction, h);
    softsim::retract(minus, direction, -h);
    const double slope = (term.energy(plus) - term.energy(minus)) / (2 * h);
    EXPECT_NEAR(gradient(term, q).dot(direction) / slope, 1, 1e-7);
    const Vector<double> difference = (gradient(term, plus) - gradient(term, minus)) / (2 * h);
    EXPECT_LT(relative_error(hessian_product(term, q, direction), difference), 1e-7);
  }
}

// Blocks into a dense matrix give all columns of the product, and only the diagonal where only it is asked
// for.
TEST_F(NodalVolumeOfACube, HasBlocksThatAreTheColumnsOfTheHessianProduct) {
  const auto n = static_cast<std::int32_t>(nodes);
  std::vector<std::int32_t> all, diagonal;
  std::size_t stencils = 0;
  term.for_each_stencil([&](const auto& stencil) {
    ++stencils;
    for (std::size_t a = 0; a < stencil.size(); ++a)
      for (std::size_t b = a; b < stencil.size(); ++b) {
        const auto [i, j] = std::minmax(stencil[a], stencil[b]);
        all.push_back(2 * (i * n + j) + (stencil[a] > stencil[b] ? 1 : 0));
        diagonal.push_back(i == j ? 2 * i : -1);
      }
  });
  EXPECT_EQ(stencils, term.size());
  EXPECT_EQ(term.size(), mesh.tetrahedra().size() + nodes);
  std::vector<double> values(9 * nodes * nodes, 0.0), diagonal_values(9 * nodes, 0.0);
  term.add_blocks(q, 2, all, values.data());
  term.add_blocks(q, 2, diagonal, diagonal_values.data());
  for (std::int32_t j = 0; j < n; ++j)
    for (int c = 0; c < 3; ++c) {
      Vector<double> unit = Vector<double>::Zero(q.size());
      block(unit, j)[c] = 2;
      const Vector<double> column = hessian_product(term, q, unit);
      for (std::int32_t i = 0; i < n; ++i)
        for (int b = 0; b < 3; ++b) {
          // rounding, against blocks of the size of lambda times an edge
          EXPECT_NEAR(values[static_cast<std::size_t>(9 * (i * n + j) + 3 * c + b)],
                      i > j ? 0 : block(column, i)[b], 1e-11);
          if (i != j) continue;
          EXPECT_NEAR(diagonal_values[static_cast<std::size_t>(9 * i + 3 * c + b)], block(column, i)[b],
                      1e-11);
        }
    }
}

// At one F everywhere the means are J: nothing tells the nodes from the tetrahedra.
TEST_F(NodalVolumeOfACube, CompletesNeoHookeanExactlyWhereTheDeformationIsHomogeneous) {
  bodies::Random random(4);
  const auto whole = softsim::elastic(mesh, NeoHookean::from_lame(lambda, mu));
  const auto rest = softsim::elastic(mesh, NeoHookean::from_lame(0, mu));
  const State<double> at = bodies::affine_state(mesh, Matrix::Identity() + 0.3 * random.matrix(), {1, 2, 3});
  EXPECT_NEAR((term.energy(at) + rest.energy(at)) / whole.energy(at), 1, 1e-12);
  const Vector<double> sum = gradient(term, at) + gradient(rest, at);
  EXPECT_LT(relative_error(sum, gradient(whole, at)), 1e-12);
  const State<double> undeformed(nodes);
  EXPECT_EQ(term.energy(undeformed), 0);
  EXPECT_EQ(gradient(term, undeformed).norm(), 0);
}

TEST_F(NodalVolumeOfACube, TurnsWithTheBodyAndHasNoResultant) {
  bodies::Random random(5);
  const Matrix R = random.rotation();
  State<double> turned(nodes);
  const Vector<double> g = gradient(term, q);
  Vector<double> Rg = g;
  Vec force = Vec::Zero(), torque = Vec::Zero();
  double size = 0;
  for (std::size_t i = 0; i < nodes; ++i) {
    const auto k = static_cast<std::ptrdiff_t>(i);
    const Vec f = block(g, k), x = bodies::position(mesh, q, i);
    turned.point(k) = R * x + Vec(1, 2, 3) - mesh.points()[i];
    block(Rg, k) = R * f;
    force += f;
    torque += x.cross(f);
    size += f.norm();
  }
  EXPECT_LT(relative_error(gradient(term, turned), Rg), 1e-12);
  EXPECT_LT(force.norm(), 1e-13 * size);
  EXPECT_LT(torque.norm(), 1e-13 * size);
}

TEST_F(NodalVolumeOfACube, IsTheSameOneByOneInBatchesAndInSinglePrecision) {
  const auto one = nodal_volume<double, 1>(mesh, LogarithmicVolume(lambda));
  const auto eight = nodal_volume<double, 8>(mesh, LogarithmicVolume(lambda));
  EXPECT_NEAR(eight.energy(q) / one.energy(q), 1, 1e-13);
  EXPECT_LT(relative_error(gradient(eight, q), gradient(one, q)), 1e-13);
  EXPECT_LT(relative_error(hessian_product(eight, q, d), hessian_product(one, q, d)), 1e-13);
  const auto single = nodal_volume<float>(mesh, LogarithmicVolume(lambda));
  State<float> q_single;
  q_single.displacement = q.displacement.cast<float>();
  // inputs and some thirty operations rounded to 6e-8
  EXPECT_NEAR(single.energy(q_single) / one.energy(q), 1, 2e-6);
  EXPECT_LT(relative_error(gradient(single, q_single), gradient(one, q)), 2e-6);
  const Vector<float> d_single = d.cast<float>();
  EXPECT_LT(relative_error(hessian_product(single, q_single, d_single), hessian_product(one, q, d)), 2e-6);
}

// Strains of 1e-9: the difference of J from 1 has to come from the displacements, or it would keep seven
// digits.
TEST_F(NodalVolumeOfACube, KeepsItsDigitsAtSmallStrain) {
  const Matrix H = 1e-9 * Vec(1, 2, 3).asDiagonal().toDenseMatrix();
  State<double> small(nodes);
  for (std::size_t i = 0; i < nodes; ++i) small.point(static_cast<std::ptrdiff_t>(i)) = H * mesh.points()[i];
  EXPECT_NEAR(term.energy(small) / (lambda / 2 * 36e-18), 1, 1e-8);
}

// Two laws that part the cube are two bodies that share the nodes between them.
TEST_F(NodalVolumeOfACube, KeepsTheMeansOfDifferentLawsApart) {
  std::vector<std::int32_t> index;
  std::vector<softsim::Tetrahedron> part[2];
  for (std::size_t e = 0; e < mesh.tetrahedra().size(); ++e) {
    index.push_back(e < 60 ? 1 : 0);
    part[index.back()].push_back(mesh.tetrahedra()[e]);
  }
  const std::vector<QuadraticVolume> laws{QuadraticVolume(2), QuadraticVolume(70)};
  double sum = 0;
  for (std::size_t m = 0; m < 2; ++m) {
    const TetrahedralMesh piece(mesh.points(), part[m]);
    State<double> at(piece.points().size());
    for (std::size_t i = 0; i < piece.points().size(); ++i)
      at.point(static_cast<std::ptrdiff_t>(i)) = q.point(piece.source_node()[i]);
    sum += nodal_volume(piece, laws[m]).energy(at);
  }
  EXPECT_NEAR(nodal_volume(mesh, laws, index).energy(q) / sum, 1, 1e-12);
}

// At rest U only adds to the stiffness of the law left to the tetrahedra: no mode is softer than with that
// law alone. It adds one constraint per node, less the three combinations that vanish: the cube's nodes take
// four colours so that every tetrahedron has each, and pressures by colour that add up to zero do no work
// (the checkerboard of equal orders).
TEST_F(NodalVolumeOfACube, AddsOneConstraintPerNodeAndNoUnstableMode) {
  const auto n = static_cast<std::ptrdiff_t>(nodes);
  const State<double> rest(nodes);
  Eigen::MatrixXd K(3 * n, 3 * n);
  for (std::ptrdiff_t j = 0; j < 3 * n; ++j) {
    Vector<double> unit = Vector<double>::Zero(q.size());
    block(unit, j / 3)[j % 3] = 1;
    const Vector<double> column = hessian_product(term, rest, unit);
    for (std::ptrdiff_t i = 0; i < n; ++i) K.block<3, 1>(3 * i, j) = block(column, i);
  }
  EXPECT_LT((K - K.transpose()).norm(), 1e-13 * K.norm());
  const Eigen::VectorXd values =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(K, Eigen::EigenvaluesOnly).eigenvalues();
  EXPECT_GT(values.minCoeff(), -1e-12 * values.maxCoeff());
  EXPECT_EQ((values.array() > 1e-6 * values.maxCoeff()).count(), n - 3);
}

// Inverted tetrahedra among others leave the means, and with them the energy, finite; a mean below zero does
// not.
TEST_F(NodalVolumeOfACube, IsNotFiniteOnlyWhereAMeanIsInverted) {
  State<double> mirrored = bodies::affine_state(mesh, Vec(1, 1, -1).asDiagonal().toDenseMatrix(), {0, 0, 0});
  EXPECT_FALSE(std::isfinite(term.energy(mirrored)));
  EXPECT_DOUBLE_EQ(nodal_volume(mesh, QuadraticVolume(2)).energy(mirrored), 4);
}

TEST(NodalVolume, RefusesWhatItCannotDo) {
  const auto mesh = softsim::box_mesh({1, 1, 1}, {1, 1, 1});
  const double inf = std::numeric_limits<double>::infinity();
  EXPECT_EQ(refusal([] { return LogarithmicVolume(0); }),
            "logarithmic volume law: modulus 0 Pa must be positive and finite");
  EXPECT_EQ(refusal([&] { return QuadraticVolume(inf); }),
            "quadratic volume law: modulus inf Pa must be positive and finite");
  const std::vector<QuadraticVolume> two(2, QuadraticVolume(1));
  EXPECT_EQ(refusal([&] { return nodal_volume(mesh, std::vector<QuadraticVolume>{}, {}); }),
            "nodal volume: no law");
  EXPECT_EQ(refusal([&] { return nodal_volume(mesh, two, {}); }),
            "nodal volume: 0 law indices for 6 tetrahedra");
  EXPECT_EQ(refusal([&] {
              return nodal_volume(mesh, two, {0, 1, 2, 0, 0, 0});
            }),
            "tetrahedron 2: law index 2 is out of range (there are 2 laws)");
}

}  // namespace nodal_volume_test
