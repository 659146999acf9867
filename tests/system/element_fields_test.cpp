// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/system/element_fields.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <vector>

#include "potential/bodies.hpp"
#include "softsim/material/neo_hookean.hpp"
#include "softsim/material/st_venant_kirchhoff.hpp"
#include "softsim/material/stable_neo_hookean.hpp"

namespace element_fields_test {

using bodies::Matrix, bodies::Vec;
using softsim::ElementField, softsim::NeoHookean, softsim::State, softsim::StVenantKirchhoff;

const auto mesh = bodies::distorted_cube(2, 1);

template <class Law>
std::vector<ElementField> fields_of(const Law& law, const Matrix& F) {
  return softsim::element_fields(mesh, std::vector<Law>{law}, {},
                                 bodies::affine_state(mesh, F, Vec(1, 2, 3)));
}

// St. Venant-Kirchhoff at free sides: P = E/2 (s^3 - s), lateral stretch^2 = 1 - nu (s^2 - 1), psi = E/8 (s^2
// - 1)^2; E = 10, nu = 0.3, s = 1.25: P = 3.515625 Pa.
TEST(ElementFields, OfAUniaxialStateAreThoseOfTheClosedForm) {
  const double s = 1.25, l = std::sqrt(1 - 0.3 * (s * s - 1));
  const auto law = StVenantKirchhoff::from_young_poisson(10, 0.3);
  bodies::Random random(2);
  const Matrix Q = random.rotation();
  for (const Matrix& R : {Matrix(Matrix::Identity()), random.rotation()}) {
    const Matrix F = R * Q * Vec(l, s, l).asDiagonal() * Q.transpose();
    const auto fields = fields_of(law, F);
    ASSERT_EQ(fields.size(), mesh.tetrahedra().size());
    const double cauchy = 3.515625 / (l * l);
    for (const ElementField& field : fields) {
      EXPECT_NEAR(field.j, s * l * l, 1e-13);
      EXPECT_NEAR(field.von_mises, cauchy, 1e-12);
      EXPECT_NEAR(field.principal[0], cauchy, 1e-12);
      EXPECT_NEAR(field.principal[1], 0, 1e-12);
      EXPECT_NEAR(field.principal[2], 0, 1e-12);
      EXPECT_NEAR(field.energy_density, 10.0 / 8 * std::pow(s * s - 1, 2), 1e-13);
    }
  }
}

// Neo-Hookean, F = diag(1.1, 1, 1): 863901.0097711232 and twice 349914.99578510894 Pa for E = 7 MPa, nu =
// 0.3.
TEST(ElementFields, SortPrincipalStressesFromTheLargest) {
  const auto law = NeoHookean::from_young_poisson(7e6, 0.3);
  for (const ElementField& field : fields_of(law, Vec(1, 1.1, 1).asDiagonal())) {
    EXPECT_NEAR(field.principal[0], 863901.0097711232, 1e-6);
    EXPECT_NEAR(field.principal[1], 349914.99578510894, 1e-6);
    EXPECT_NEAR(field.principal[2], 349914.99578510894, 1e-6);
    EXPECT_NEAR(field.von_mises, 863901.0097711232 - 349914.99578510894, 1e-6);
  }
}

// Simple shear k of St. Venant-Kirchhoff: sigma_00 = (l/2 + 2m) k^2 + (l/2 + m) k^4, sigma_11 = (l/2 + m)
// k^2, sigma_22 = l/2 k^2, sigma_01 = m k + (l/2 + m) k^3.
TEST(ElementFields, OfSimpleShearAreThoseOfTheClosedForm) {
  const double k = 0.4, l = 3, m = 2;
  Matrix F = Matrix::Identity();
  F(0, 1) = k;
  const double s00 = (l / 2 + 2 * m) * k * k + (l / 2 + m) * std::pow(k, 4), s11 = (l / 2 + m) * k * k,
               s22 = l / 2 * k * k, s01 = m * k + (l / 2 + m) * k * k * k;
  const double mises = std::sqrt(
      0.5 * (std::pow(s00 - s11, 2) + std::pow(s11 - s22, 2) + std::pow(s22 - s00, 2)) + 3 * s01 * s01);
  const double mean = (s00 + s11) / 2, radius = std::hypot((s00 - s11) / 2, s01);
  for (const ElementField& field : fields_of(StVenantKirchhoff::from_lame(l, m), F)) {
    EXPECT_NEAR(field.j, 1, 1e-14);
    EXPECT_NEAR(field.von_mises, mises, 1e-13);
    EXPECT_NEAR(field.principal[0], mean + radius, 1e-13);
    EXPECT_NEAR(field.principal[1], s22, 1e-13);
    EXPECT_NEAR(field.principal[2], mean - radius, 1e-13);
  }
}

TEST(ElementFields, AreZeroAfterARigidMotion) {
  bodies::Random random(3);
  for (const ElementField& field : fields_of(NeoHookean::from_young_poisson(10, 0.3), random.rotation())) {
    EXPECT_NEAR(field.j, 1, 1e-13);
    EXPECT_NEAR(field.von_mises, 0, 1e-12);
    EXPECT_LT(field.principal.norm(), 1e-12);
    EXPECT_NEAR(field.energy_density, 0, 1e-13);
  }
}

TEST(ElementFields, UseTheMaterialOfEachTetrahedron) {
  const auto soft = NeoHookean::from_young_poisson(1, 0.3), stiff = NeoHookean::from_young_poisson(100, 0.3);
  std::vector<std::int32_t> index;
  for (std::size_t t = 0; t < mesh.tetrahedra().size(); ++t) index.push_back(t % 5 == 0);
  const Matrix F = Vec(1.2, 0.9, 1).asDiagonal();
  const auto fields = softsim::element_fields(mesh, std::vector{soft, stiff}, index,
                                              bodies::affine_state(mesh, F, Vec::Zero()));
  for (std::size_t t = 0; t < fields.size(); ++t)
    EXPECT_NEAR(fields[t].energy_density / soft.energy_density(F), t % 5 == 0 ? 100 : 1, 1e-10);
}

// An inverted tetrahedron shows: J is negative, what the law cannot say is NaN, what another law can say is a
// number.
TEST(ElementFields, ShowInvertedTetrahedra) {
  const Matrix F = Vec(1, 1, -0.5).asDiagonal();
  for (const ElementField& field : fields_of(NeoHookean::from_young_poisson(10, 0.3), F)) {
    EXPECT_NEAR(field.j, -0.5, 1e-14);
    EXPECT_TRUE(std::isnan(field.von_mises) && std::isnan(field.principal[0]) &&
                std::isnan(field.energy_density));
  }
  for (const ElementField& field : fields_of(softsim::StableNeoHookean::from_young_poisson(10, 0.3), F)) {
    EXPECT_NEAR(field.j, -0.5, 1e-14);
    EXPECT_TRUE(std::isfinite(field.von_mises) && field.principal.allFinite() && field.energy_density > 0);
  }
}

TEST(ElementFields, TakeStatesInSinglePrecision) {
  const Matrix F = Vec(1.25, 0.9, 0.8).asDiagonal();
  const auto law = NeoHookean::from_young_poisson(10, 0.3);
  State<float> single;
  single.displacement = bodies::affine_state(mesh, F, Vec::Zero()).displacement.cast<float>();
  const auto fields = softsim::element_fields(mesh, std::vector{law}, {}, single);
  const auto exact = fields_of(law, F);
  for (std::size_t t = 0; t < fields.size(); ++t)
    EXPECT_NEAR(fields[t].von_mises / exact[t].von_mises, 1, 2e-6);
}

TEST(ElementFields, RefuseIndicesThatDoNotFit) {
  const auto box = softsim::box_mesh({1, 1, 1}, {1, 1, 1});
  const std::vector<softsim::NeoHookean> laws{softsim::NeoHookean::from_young_poisson(10, 0.3)};
  const State<double> q(box.points().size());
  EXPECT_THROW((void)softsim::element_fields(box, laws, {0, 0}, q), std::invalid_argument);
  EXPECT_THROW((void)softsim::element_fields(box, laws, {0, 0, 0, 0, 0, 1}, q), std::invalid_argument);
  EXPECT_THROW((void)softsim::element_fields(box, laws, {0, 0, 0, 0, 0, -1}, q), std::invalid_argument);
}

}  // namespace element_fields_test
