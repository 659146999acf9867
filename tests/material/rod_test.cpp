// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/material/rod.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "softsim/core/rotation.hpp"
#include "softsim/material/st_venant_kirchhoff.hpp"
#include "softsim/potential/elastic.hpp"

namespace rod_test {

using softsim::double_dot, softsim::Rod;
using M = softsim::Mat3<double>;
using V = softsim::Vec3<double>;

static_assert(softsim::MaterialField<Rod> && !softsim::Material<Rod>);

const M F = (M() << 1.2, 0.1, -0.3, 0.2, 0.9, 0.15, 0.05, -0.2, 1.1).finished();
const M dF = (M() << 0.3, -0.2, 0.5, 0.1, 0.4, -0.6, -0.3, 0.2, 0.7).finished();
const V a = V(2, -1, 2) / 3;

TEST(Rod, StressAndTangentAreDerivatives) {
  const auto law = Rod(10, 4).at(Rod::Data<double>{a});
  const double h = 1e-5;
  const double slope = (law.energy_density(F + h * dF) - law.energy_density(F - h * dF)) / (2 * h);
  EXPECT_NEAR(double_dot(law.first_piola(F), dF), slope, 1e-8 * std::abs(slope));
  const M difference = (law.first_piola(F + h * dF) - law.first_piola(F - h * dF)) / (2 * h);
  EXPECT_LT((law.first_piola_differential(F, dF) - difference).norm(), 1e-8 * difference.norm());
  // but for the rounding of |a| = 1
  EXPECT_LT(law.energy_density(M::Identity()), 1e-29);
  EXPECT_LT(law.first_piola(M::Identity()).norm(), 1e-14);
}

TEST(Rod, DoesNotFeelRotations) {
  const auto law = Rod(10, 4).at(Rod::Data<double>{a});
  const M R = softsim::rotation_exponential<double>(V(1, -2, 0.5));
  EXPECT_NEAR(law.energy_density(R * F), law.energy_density(F), 1e-14);
  EXPECT_LT((law.first_piola(R * F) - R * law.first_piola(F)).norm(), 1e-13);
}

// Where sections do not strain it is St. Venant-Kirchhoff with nu = 0; what they strain costs nothing.
TEST(Rod, IsStVenantKirchhoffLessTheSection) {
  const double E = 10;
  const auto solid = softsim::StVenantKirchhoff::from_young_poisson(E, 0);
  const auto law = Rod(E, E / 2).at(Rod::Data<double>{V::UnitX()});
  // orthonormal columns along the section's axes
  M G = softsim::rotation_exponential<double>(V(0.3, -0.2, 0.4));
  G.col(0) += V(0.2, 0.1, -0.3);
  EXPECT_NEAR(law.energy_density(G), solid.energy_density(G), 1e-14);
  M shrunk = M::Identity();
  shrunk(1, 1) = 0.8;
  shrunk(1, 2) = 0.1;
  EXPECT_EQ(law.energy_density(shrunk), 0);
}

TEST(Rod, RefusesModuliThatAreNotPositive) {
  EXPECT_THROW(Rod(0, 1), std::invalid_argument);
  EXPECT_THROW(Rod(1, -1), std::invalid_argument);
  EXPECT_THROW(Rod(std::numeric_limits<double>::infinity(), 1), std::invalid_argument);
}

}  // namespace rod_test
