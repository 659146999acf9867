// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/potential/mass_tensor.hpp"

#include <gtest/gtest.h>

#include "potential/bodies.hpp"
#include "softsim/material/linear_elastic.hpp"
#include "softsim/material/st_venant_kirchhoff.hpp"
#include "softsim/potential/elastic.hpp"

namespace mass_tensor_test {

using bodies::gradient, bodies::hessian_product, bodies::relative_error;
using softsim::Lame, softsim::LinearMassTensor, softsim::MassTensor, softsim::State, softsim::Vector;

static_assert(softsim::LocalPotential<MassTensor> && softsim::LocalPotential<LinearMassTensor>);
static_assert(softsim::LocalPotential<MassTensor, softsim::Batch<float, 16>>);
static_assert(!softsim::Kinematics<MassTensor>);

const Lame lame = Lame::from_young_poisson(10, 0.3);
const softsim::TetrahedralMesh cube = bodies::distorted_cube(2, 7);

// The same polynomial, summed in another order: rounding of some hundred terms.
template <class A, class B>
void expect_equal(const A& tensors, const B& elements, const State<double>& q) {
  const Vector<double> d = bodies::random_vector(cube.points().size(), 1, 3);
  EXPECT_NEAR(tensors.energy(q) / elements.energy(q), 1, 1e-13);
  EXPECT_LT(relative_error(gradient(tensors, q), gradient(elements, q)), 1e-13);
  EXPECT_LT(relative_error(hessian_product(tensors, q, d), hessian_product(elements, q, d)), 1e-13);
}

TEST(MassTensor, IsTheFiniteElementOfStVenantKirchhoff) {
  const auto tensors = softsim::mass_tensors(cube, lame);
  const auto elements = softsim::elastic(cube, softsim::StVenantKirchhoff::from_lame(lame.lambda, lame.mu));
  for (const double size : {0.01, 0.1, 0.5})
    expect_equal(tensors, elements, bodies::random_state(cube.points().size(), size, 1));
}

TEST(LinearMassTensor, IsTheFiniteElementOfLinearElasticity) {
  const auto tensors = softsim::mass_tensors<LinearMassTensor>(cube, lame);
  const auto elements = softsim::elastic(cube, softsim::LinearElastic::from_lame(lame.lambda, lame.mu));
  expect_equal(tensors, elements, bodies::random_state(cube.points().size(), 0.1, 2));
}

TEST(MassTensor, AgreesWithItsLinearPartAtSmallStrain) {
  const auto tensors = softsim::mass_tensors(cube, lame);
  const auto linear = softsim::mass_tensors<LinearMassTensor>(cube, lame);
  const State<double> q = bodies::random_state(cube.points().size(), 1e-7, 4);
  EXPECT_LT(relative_error(gradient(tensors, q), gradient(linear, q)), 1e-5);
}

// The polynomial cancels to nothing only up to rounding of its terms, which a half turn makes large: the
// drawback of displacements from rest that Goulette & Chen name in Sec. 5.4.
TEST(MassTensor, IsFreeOfForceUnderRotationUpToRounding) {
  const auto tensors = softsim::mass_tensors(cube, lame);
  bodies::Random random(5);
  const State<double> q = bodies::affine_state(cube, random.rotation(), {1, -2, 3});
  EXPECT_LT(gradient(tensors, q).cwiseAbs().maxCoeff(), 1e-13 * (lame.lambda + 2 * lame.mu));
}

TEST(MassTensor, BalancesForcesAndMoments) {
  const auto tensors = softsim::mass_tensors(cube, lame);
  const State<double> q = bodies::random_state(cube.points().size(), 0.2, 6);
  const Vector<double> f = gradient(tensors, q);
  bodies::Vec force = bodies::Vec::Zero(), moment = force;
  for (std::size_t i = 0; i < cube.points().size(); ++i) {
    const bodies::Vec fi = softsim::block(f, static_cast<std::ptrdiff_t>(i));
    force += fi;
    moment += bodies::position(cube, q, i).cross(fi);
  }
  EXPECT_LT(force.norm(), 1e-13 * f.norm());
  EXPECT_LT(moment.norm(), 1e-13 * f.norm());
}

TEST(MassTensor, SinglePrecisionAndScalarsAgree) {
  const State<float> q = bodies::random_state<float>(cube.points().size(), 0.1, 8);
  State<double> exact;
  exact.displacement = q.displacement.cast<double>();
  const auto one = softsim::mass_tensors<MassTensor, double, 1>(cube, lame);
  EXPECT_LT(relative_error(gradient(softsim::mass_tensors(cube, lame), exact), gradient(one, exact)), 1e-14);
  const auto single = softsim::mass_tensors<MassTensor, float>(cube, lame);
  EXPECT_LT(relative_error(gradient(single, q), gradient(one, exact)), 5e-6);
}

TEST(MassTensor, RefusesModuliThatAreNotAdmissible) {
  EXPECT_EQ(bodies::refusal([] {
              return softsim::mass_tensors(cube, Lame{1, -2});
            }),
            "mu -2 Pa: the shear modulus must be positive and finite (bulk modulus -0.333333333 Pa)");
}

}  // namespace mass_tensor_test
