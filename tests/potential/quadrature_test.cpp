// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/potential/quadrature.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <vector>

#include "potential/bodies.hpp"
#include "potential/solid_bodies.hpp"
#include "softsim/material/neo_hookean.hpp"
#include "softsim/material/st_venant_kirchhoff.hpp"
#include "softsim/potential/dead_load.hpp"
#include "softsim/system/tangent.hpp"

namespace quadrature_test {

using bodies::Matrix, bodies::Vec, bodies::gradient, bodies::hessian_product, bodies::random_vector,
    bodies::relative_error;
using softsim::HexahedralMesh, softsim::NeoHookean, softsim::QuadraticTetrahedralMesh, softsim::State,
    softsim::StVenantKirchhoff, softsim::Vector;

using HexahedronTerm = softsim::ElasticElement<softsim::TrilinearHexahedronShape, NeoHookean>;
static_assert(softsim::LocalPotential<HexahedronTerm> &&
              softsim::LocalPotential<HexahedronTerm, softsim::Batch<float, 8>>);
static_assert(softsim::Potential<softsim::ElasticBody<QuadraticTetrahedralMesh, NeoHookean>>);
static_assert(!softsim::IsoparametricElements<softsim::TetrahedralMesh>);

const NeoHookean law = NeoHookean::from_young_poisson(10, 0.3);

template <class Mesh>
class SolidElements : public ::testing::Test {
 protected:
  // 8 hexahedra, 48 ten-node tetrahedra (whose inner edge nodes are moved too: curved sides)
  Mesh mesh = solid_bodies::distorted<Mesh>(2, 1, 0.2);
  std::size_t points = mesh.points().size();
  State<double> q = [&] {
    State<double> state = solid_bodies::affine_state(mesh, Vec(1.1, 0.9, 1.05).asDiagonal(), Vec(1, 2, 3));
    state.displacement += random_vector(points, 0.02, 2);
    return state;
  }();
};
using Meshes = ::testing::Types<HexahedralMesh, QuadraticTetrahedralMesh>;
TYPED_TEST_SUITE(SolidElements, Meshes);

// Central differences with step h: h^2 f''' and 1e-16 / h, both about 1e-10 of the value.
TYPED_TEST(SolidElements, DerivativesAgreeWithDifferences) {
  const auto term = softsim::elastic(this->mesh, law);
  const Vector<double> d = random_vector(this->points, 1, 3);
  constexpr double h = 1e-5;
  State<double> ahead = this->q, behind = this->q;
  softsim::retract(ahead, d, h);
  softsim::retract(behind, d, -h);
  const double slope = (term.energy(ahead) - term.energy(behind)) / (2 * h);
  EXPECT_NEAR(gradient(term, this->q).dot(d) / slope, 1, 1e-6);
  const Vector<double> change = (gradient(term, ahead) - gradient(term, behind)) / (2 * h);
  EXPECT_LT(relative_error(hessian_product(term, this->q, d), change), 1e-6);
  // symmetric
  const Vector<double> other = random_vector(this->points, 1, 4);
  const double ab = other.dot(hessian_product(term, this->q, d)),
               ba = d.dot(hessian_product(term, this->q, other));
  EXPECT_NEAR(ab, ba, 1e-12 * hessian_product(term, this->q, d).norm() * other.norm());
}

TYPED_TEST(SolidElements, RigidMotionsCostNothing) {
  const auto term = softsim::elastic(this->mesh, law);
  bodies::Random random(5);
  const Matrix R = random.rotation();
  const State<double> rigid = solid_bodies::affine_state(this->mesh, R, Vec(1, 2, 3));
  EXPECT_NEAR(term.energy(rigid), 0, 1e-13);
  EXPECT_LT(gradient(term, rigid).norm(), 1e-12);
  // and turn the forces with them
  State<double> turned = this->q;
  Vector<double> expected = gradient(term, this->q);
  for (std::size_t i = 0; i < this->points; ++i) {
    const auto k = static_cast<std::ptrdiff_t>(i);
    turned.point(k) = R * (this->mesh.points()[i] + this->q.point(k)) - this->mesh.points()[i];
    const Vec f = R * softsim::block(expected, k);
    softsim::block(expected, k) = f;
  }
  EXPECT_LT(relative_error(gradient(term, turned), expected), 1e-11);
  EXPECT_NEAR(term.energy(turned) / term.energy(this->q), 1, 1e-11);
}

// The sums are the same whatever the number of lanes and the scalar.
using HexahedronElements = SolidElements<HexahedralMesh>;
TEST_F(HexahedronElements, LanesAndSinglePrecisionGiveTheSame) {
  const auto one = softsim::elastic<double, 1>(mesh, law);
  const auto batch = softsim::elastic(mesh, law);
  EXPECT_NEAR(batch.energy(q) / one.energy(q), 1, 1e-13);
  EXPECT_LT(relative_error(gradient(batch, q), gradient(one, q)), 1e-13);
  const auto single = softsim::elastic<float>(mesh, law);
  State<float> rounded;
  rounded.displacement = q.displacement.cast<float>();
  // displacements of 3 m rounded to 2e-7 m, strains of elements of half a metre to 1e-6 of about 0.1
  EXPECT_LT(relative_error(gradient(single, rounded), gradient(one, q)), 1e-4);
}

// A homogeneous deformation: psi(F) times the volume, curved elements included up to the error of the rule on
// the volume; on straight ones to rounding.
TYPED_TEST(SolidElements, HomogeneousEnergyIsDensityTimesVolume) {
  const TypeParam straight = solid_bodies::distorted<TypeParam>(2, 1, 0);
  const Matrix F = (Matrix() << 1.1, 0.2, 0, -0.1, 0.95, 0.1, 0, 0, 1.05).finished();
  const auto energy = [&](const TypeParam& body) {
    return softsim::elastic(body, law).energy(solid_bodies::affine_state(body, F, Vec(0, 0, 1)));
  };
  EXPECT_NEAR(energy(straight), law.energy_density(F), 1e-13);
  EXPECT_NEAR(energy(this->mesh) / law.energy_density(F), 1, TypeParam::nodes == 8 ? 1e-13 : 1e-3);
}

TYPED_TEST(SolidElements, EachElementHasItsMaterial) {
  const NeoHookean stiff = NeoHookean::from_young_poisson(1000, 0.3);
  std::vector<std::int32_t> index;
  double expected = 0;
  const Matrix F = Vec(1.2, 0.9, 1).asDiagonal();
  const TypeParam straight = solid_bodies::distorted<TypeParam>(2, 1, 0);
  for (std::size_t e = 0; e < straight.elements().size(); ++e) {
    index.push_back(e % 3 == 0);
    expected += straight.volume(e) * (index[e] == 0 ? law : stiff).energy_density(F);
  }
  const auto stretched = solid_bodies::affine_state(straight, F, Vec::Zero());
  EXPECT_NEAR(softsim::elastic(straight, std::vector{law, stiff}, index).energy(stretched) / expected, 1,
              1e-13);
  EXPECT_NE(bodies::refusal([&] {
              return softsim::elastic(straight, std::vector{law, stiff});
            }).find("2 materials need an index per"),
            std::string::npos);
}

// int rho N_i g dV: the sum is the weight, and its moment is that of the body.
TYPED_TEST(SolidElements, WeightHasTheRightSumAndMoment) {
  const auto load = softsim::gravity(this->mesh, 2, {0, 0, -9.81});
  Vec sum = Vec::Zero(), moment = Vec::Zero();
  for (std::size_t i = 0; i < this->points; ++i) {
    const Vec f = softsim::block(load.force(), static_cast<std::ptrdiff_t>(i));
    sum += f;
    moment += this->mesh.points()[i].cross(f);
  }
  EXPECT_LT((sum - Vec(0, 0, -2 * 9.81)).norm(), 1e-12);
  EXPECT_LT((moment - Vec(0.5, 0.5, 0.5).cross(sum)).norm(), 1e-12);
}

}  // namespace quadrature_test
