// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/potential/elastic.hpp"

#include <gtest/gtest.h>

#include <cstddef>

#include "material/law_checks.hpp"
#include "potential/bodies.hpp"

// Elastic energy of a whole mesh, for every law.

namespace elastic_test {

using bodies::Matrix, bodies::Vec, bodies::gradient, bodies::hessian_product;
using softsim::State, softsim::Vector;

template <class Law>
class ElasticBody : public ::testing::Test {
 protected:
  static constexpr double young = 10;
  softsim::TetrahedralMesh mesh = bodies::distorted_cube(3, 21);  // 162 tetrahedra
  std::size_t nodes = mesh.points().size();
  softsim::ElasticTetrahedra<Law> body = softsim::elastic(mesh, Law::from_young_poisson(young, 0.3));

  // A stretch and a shear of some 30 % and noise on top; J stays well above 0.
  State<double> deformed(std::uint64_t seed) const {
    Matrix A = Matrix::Identity();
    A(0, 0) = 1.3;
    A(0, 1) = 0.3;
    A(2, 1) = -0.2;
    State<double> q = bodies::affine_state(mesh, A, Vec(0.1, 0.2, 0.3));
    q.displacement += bodies::random_vector(nodes, 0.03, seed);
    return q;
  }
};
template <class Law>
class ObjectiveBody : public ElasticBody<Law> {};
TYPED_TEST_SUITE(ElasticBody, law_checks::AllLaws, law_checks::LawName);
TYPED_TEST_SUITE(ObjectiveBody, law_checks::ObjectiveLaws, law_checks::LawName);

TYPED_TEST(ElasticBody, IsFreeOfEnergyAndForceAtRest) {
  const State<double> rest(this->nodes);
  EXPECT_NEAR(this->body.energy(rest), 0, 1e-15 * TestFixture::young);
  EXPECT_LT(gradient(this->body, rest).norm(), 1e-14 * TestFixture::young);
}

// With the step 6e-6 truncation and rounding of a central difference both stay below 1e-9 of the value.
TYPED_TEST(ElasticBody, GradientIsTheDerivativeOfTheEnergy) {
  constexpr double h = 6e-6;
  const State<double> q = this->deformed(22);
  const Vector<double> g = gradient(this->body, q);
  Vector<double> difference = Vector<double>::Zero(q.size());
  for (std::ptrdiff_t k = 0; k < q.size(); ++k) {
    if (k % softsim::block_stride == 3) continue;
    State<double> plus = q, minus = q;
    plus.displacement[k] += h;
    minus.displacement[k] -= h;
    difference[k] = (this->body.energy(plus) - this->body.energy(minus)) / (2 * h);
  }
  EXPECT_LT(bodies::relative_error(g, difference), 1e-7);
}

TYPED_TEST(ElasticBody, HessianProductIsTheDerivativeOfTheGradient) {
  constexpr double h = 6e-6;
  const State<double> q = this->deformed(23);
  for (std::uint64_t n = 0; n < 5; ++n) {
    const Vector<double> d = bodies::random_vector(this->nodes, 1, 24 + n);
    State<double> plus = q, minus = q;
    softsim::retract(plus, d, h);
    softsim::retract(minus, d, -h);
    const Vector<double> difference = (gradient(this->body, plus) - gradient(this->body, minus)) / (2 * h);
    EXPECT_LT(bodies::relative_error(hessian_product(this->body, q, d), difference), 1e-7);
  }
}

TYPED_TEST(ElasticBody, HessianIsSymmetric) {
  const State<double> q = this->deformed(30);
  for (std::uint64_t n = 0; n < 5; ++n) {
    const Vector<double> a = bodies::random_vector(this->nodes, 1, 31 + n),
                         b = bodies::random_vector(this->nodes, 1, 41 + n);
    const Vector<double> Ka = hessian_product(this->body, q, a), Kb = hessian_product(this->body, q, b);
    EXPECT_NEAR(a.dot(Kb), b.dot(Ka), 1e-13 * a.norm() * Kb.norm());
  }
}

TYPED_TEST(ElasticBody, ForcesBalance) {
  const State<double> q = this->deformed(51);
  const Vector<double> g = gradient(this->body, q);
  Vec sum = Vec::Zero();
  double size = 0;
  for (std::size_t i = 0; i < this->nodes; ++i) {
    const Vec f = softsim::block(g, static_cast<std::ptrdiff_t>(i));
    sum += f;
    size += f.norm();
  }
  EXPECT_LT(sum.norm(), 1e-12 * size);
}

TYPED_TEST(ElasticBody, TorquesBalance) {
  const State<double> q = this->deformed(52);
  const Vector<double> g = gradient(this->body, q);
  Vec sum = Vec::Zero();
  double size = 0;
  for (std::size_t i = 0; i < this->nodes; ++i) {
    const Vec f = softsim::block(g, static_cast<std::ptrdiff_t>(i));
    // small-strain elasticity balances around the undeformed positions
    const Vec x = std::is_same_v<TypeParam, softsim::LinearElastic> ? this->mesh.points()[i]
                                                                    : bodies::position(this->mesh, q, i);
    sum += x.cross(f);
    size += x.norm() * f.norm();
  }
  EXPECT_LT(sum.norm(), 1e-12 * size);
}

TYPED_TEST(ObjectiveBody, RotatesItsForcesWithTheBody) {
  bodies::Random random(61);
  const State<double> q = this->deformed(62);
  const Vector<double> g = gradient(this->body, q), d = bodies::random_vector(this->nodes, 1, 63);
  const Vector<double> Kd = hessian_product(this->body, q, d);
  for (int n = 0; n < 20; ++n) {
    const Matrix R = random.rotation();
    const Vec t = 3 * random.vec();
    State<double> moved(this->nodes);
    Vector<double> Rg = Vector<double>::Zero(q.size()), Rd = Rg, RKd = Rg;
    for (std::size_t i = 0; i < this->nodes; ++i) {
      const auto k = static_cast<std::ptrdiff_t>(i);
      moved.point(k) = R * bodies::position(this->mesh, q, i) + t - this->mesh.points()[i];
      softsim::block(Rg, k) = R * softsim::block(g, k);
      softsim::block(Rd, k) = R * softsim::block(d, k);
      softsim::block(RKd, k) = R * softsim::block(Kd, k);
    }
    // displacements of some 5 m, rounded at 1e-15, over edges of 0.2 m
    EXPECT_NEAR(this->body.energy(moved) / this->body.energy(q), 1, 1e-12);
    EXPECT_LT(bodies::relative_error(gradient(this->body, moved), Rg), 1e-12);
    EXPECT_LT(bodies::relative_error(hessian_product(this->body, moved, Rd), RKd), 1e-12);
  }
}

// The counter-example: without it the test above could pass for any law.
TEST(SmallStrainBody, IsStrainedByARotation) {
  const auto mesh = bodies::distorted_cube(2, 64);
  const auto body = softsim::elastic(mesh, softsim::LinearElastic::from_young_poisson(10, 0.3));
  const Matrix R = Eigen::AngleAxisd(0.5, Vec::UnitZ()).toRotationMatrix();
  EXPECT_GT(body.energy(bodies::affine_state(mesh, R, Vec::Zero())), 0.1);
}

}  // namespace elastic_test
