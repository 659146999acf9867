// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/potential/pressure.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cstddef>
#include <limits>
#include <vector>

#include "potential/bodies.hpp"

namespace pressure_test {

using bodies::Matrix, bodies::Vec, bodies::gradient, bodies::hessian_product, bodies::refusal,
    bodies::relative_error;
using softsim::FollowerPressure, softsim::State, softsim::TetrahedralMesh, softsim::Vector, softsim::block;
using Nine = Eigen::Matrix<double, 9, 1>;
using Matrix9 = Eigen::Matrix<double, 9, 9>;

static_assert(softsim::LocalForce<FollowerPressure> &&
              softsim::LocalForce<FollowerPressure, softsim::Batch<float, 8>>);
static_assert(!softsim::LocalPotential<FollowerPressure>);
using Term = softsim::Elements<FollowerPressure>;
static_assert(softsim::ForceTerm<Term> && !softsim::Potential<Term>);
static_assert(Term::external && !Term::conservative && Term::has_hessian);

constexpr double p = 7;

class PressureOnAClosedSurface : public ::testing::Test {
 protected:
  TetrahedralMesh mesh = bodies::distorted_cube(2, 1);
  std::size_t nodes = mesh.points().size();
  State<double> q = bodies::random_state(nodes, 0.08, 2);
  Term term = softsim::pressure(mesh, softsim::boundary_triangles(mesh), p);

  double volume(const State<double>& at) const {
    double sum = 0;
    for (const softsim::Tetrahedron& v : mesh.tetrahedra()) {
      std::array<Vec, 4> x;
      for (std::size_t i = 0; i < 4; ++i) x[i] = bodies::position(mesh, at, static_cast<std::size_t>(v[i]));
      sum += softsim::tetrahedron_volume(x[0], x[1], x[2], x[3]);
    }
    return sum;
  }
};

TEST_F(PressureOnAClosedSurface, HasNoResultantForceOrTorque) {
  const Vector<double> g = gradient(term, q);
  Vec force = Vec::Zero(), torque = Vec::Zero();
  double size = 0;
  for (std::size_t i = 0; i < nodes; ++i) {
    const Vec f = block(g, static_cast<std::ptrdiff_t>(i));
    force += f;
    torque += bodies::position(mesh, q, i).cross(f);
    size += f.norm();
  }
  EXPECT_LT(force.norm(), 1e-13 * size);
  EXPECT_LT(torque.norm(), 1e-13 * size);
}

// The volume is a cubic polynomial of the displacements: truncation and rounding are below 1e-9.
TEST_F(PressureOnAClosedSurface, IsTheGradientOfPressureTimesVolume) {
  constexpr double h = 6e-6;
  Vector<double> difference = Vector<double>::Zero(q.size());
  for (std::ptrdiff_t k = 0; k < q.size(); ++k) {
    if (k % softsim::block_stride == 3) continue;
    State<double> plus = q, minus = q;
    plus.displacement[k] += h;
    minus.displacement[k] -= h;
    difference[k] = p * (volume(plus) - volume(minus)) / (2 * h);
  }
  EXPECT_LT(relative_error(gradient(term, q), difference), 1e-8);
}

TEST_F(PressureOnAClosedSurface, PushesInwardsWherePositive) {
  const State<double> rest(nodes);
  const Vector<double> g = gradient(term, rest);
  const std::vector<bool> outer = bodies::on_surface(mesh);
  for (std::size_t i = 0; i < nodes; ++i) {
    const Vec force = -block(g, static_cast<std::ptrdiff_t>(i));
    if (outer[i])
      EXPECT_LT(force.dot(mesh.points()[i] - Vec(0.5, 0.5, 0.5)), 0) << "node " << i;
    else
      EXPECT_EQ(force.norm(), 0) << "node " << i;
  }
}

TEST_F(PressureOnAClosedSurface, HasItsWholeDerivativeInTheHessianProduct) {
  constexpr double h = 1e-4;  // the force is quadratic: a central difference has no truncation error
  for (std::uint64_t n = 0; n < 5; ++n) {
    const Vector<double> d = bodies::random_vector(nodes, 1, 10 + n);
    State<double> plus = q, minus = q;
    softsim::retract(plus, d, h);
    softsim::retract(minus, d, -h);
    const Vector<double> difference = (gradient(term, plus) - gradient(term, minus)) / (2 * h);
    EXPECT_LT(relative_error(hessian_product(term, q, d), difference), 1e-10);
  }
}

TEST_F(PressureOnAClosedSurface, TurnsWithTheBody) {
  bodies::Random random(3);
  const Matrix R = random.rotation();
  State<double> moved(nodes);
  const Vector<double> g = gradient(term, q);
  Vector<double> Rg = g;
  for (std::size_t i = 0; i < nodes; ++i) {
    const auto k = static_cast<std::ptrdiff_t>(i);
    moved.point(k) = R * bodies::position(mesh, q, i) + Vec(1, 2, 3) - mesh.points()[i];
    block(Rg, k) = R * block(g, k);
  }
  EXPECT_LT(relative_error(gradient(term, moved), Rg), 1e-13);
}

TEST_F(PressureOnAClosedSurface, IsTheSameInSinglePrecision) {
  const auto single = softsim::pressure<float>(mesh, softsim::boundary_triangles(mesh), p);
  State<float> q_single;
  q_single.displacement = q.displacement.cast<float>();
  const Vector<float> d = bodies::random_vector<float>(nodes, 1, 4);
  EXPECT_LT(relative_error(gradient(single, q_single), gradient(term, q)), 1e-6);
  EXPECT_LT(relative_error(hessian_product(single, q_single, d),
                           hessian_product(term, q, Vector<double>(d.cast<double>()))),
            2e-6);
}

// One triangle, by hand: area 1/2, normal +z; a third of p A on each corner, against the normal.
TEST(FollowerPressure, PutsAThirdOfTheForceOnEachCorner) {
  const FollowerPressure::Data<double> data{{Vec(0, 0, 1), Vec(1, 0, 1), Vec(0, 1, 1)}};
  const softsim::Local<double, 3> rest{{Vec::Zero(), Vec::Zero(), Vec::Zero()}};
  const Nine force = -FollowerPressure{6}.gradient(data, rest);
  for (int i = 0; i < 3; ++i) EXPECT_LT((force.segment<3>(3 * i) - Vec(0, 0, -1)).norm(), 1e-15);
  // stretched twice along x it pushes twice as hard: the load follows the area of today
  const softsim::Local<double, 3> stretched{{Vec::Zero(), Vec(1, 0, 0), Vec::Zero()}};
  EXPECT_LT((FollowerPressure{6}.gradient(data, stretched) + 2 * force).norm(), 1e-15);
}

TEST(FollowerPressure, HessianProductIsTheSymmetricPartOfTheDerivative) {
  constexpr double h = 1e-4;
  bodies::Random random(5);
  const FollowerPressure load{p};
  const FollowerPressure::Data<double> data{{random.vec(), random.vec(), random.vec()}};
  const softsim::Local<double, 3> u{{random.vec(), random.vec(), random.vec()}};
  Matrix9 derivative, product;
  for (int k = 0; k < 9; ++k) {
    softsim::Local<double, 3> plus = u, minus = u;
    plus.points[static_cast<std::size_t>(k / 3)][k % 3] += h;
    minus.points[static_cast<std::size_t>(k / 3)][k % 3] -= h;
    derivative.col(k) = (load.gradient(data, plus) - load.gradient(data, minus)) / (2 * h);
    product.col(k) = load.hessian_product(data, u, Nine(Nine::Unit(k)));
  }
  const Matrix9 symmetric = 0.5 * (derivative + derivative.transpose());
  EXPECT_LT((product - symmetric).norm(), 1e-10 * derivative.norm());
  // on an open patch the other part is there: the load has no energy of its own
  EXPECT_GT((derivative - symmetric).norm(), 0.1 * derivative.norm());
}

TEST(Pressure, RefusesWhatItCannotActOn) {
  const auto mesh = softsim::box_mesh({1, 1, 1}, {1, 1, 1});
  const double inf = std::numeric_limits<double>::infinity();
  EXPECT_EQ(refusal([&] { return softsim::pressure(mesh, {}, 1); }), "pressure: no triangle to act on");
  EXPECT_EQ(refusal([&] {
              return softsim::pressure(mesh, {{0, 1, 2}, {0, 1, 8}}, 1);
            }),
            "pressure on triangle 1: node 8 is out of range");
  EXPECT_EQ(refusal([&] {
              return softsim::pressure(mesh, {{0, -1, 2}}, 1);
            }),
            "pressure on triangle 0: node -1 is out of range");
  EXPECT_EQ(refusal([&] {
              return softsim::pressure(mesh, {{0, 1, 2}}, inf);
            }),
            "pressure inf Pa: must be finite");
}

}  // namespace pressure_test
