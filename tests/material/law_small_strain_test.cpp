// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "softsim/core/batch.hpp"
#include "softsim/material/linear_elastic.hpp"
#include "softsim/material/neo_hookean.hpp"
#include "softsim/material/st_venant_kirchhoff.hpp"
#include "softsim/material/stable_neo_hookean.hpp"

namespace law_small_strain_test {

using softsim::Mat3;

// psi of a law against psi of small-strain elasticity at a strain of size e. The two differ by O(e) by nature; F = I + H
// loses H's digits to eps/e, and with an energy that cancels no further the error stays at a few times that.
template <class Law, class T>
void expect_energy_near_rest(double strain) {
  Mat3<double> G;
  G << 0.9, 0.3, -0.2, 0.1, -0.7, 0.4, 0.5, -0.3, 0.6;
  const Mat3<double> F = Mat3<double>::Identity() + strain * G;
  const double hooke = softsim::LinearElastic::from_young_poisson(10, 0.3).energy_density(F);
  const double psi = static_cast<double>(softsim::lane(Law::from_young_poisson(10, 0.3).energy_density(F.cast<T>().eval()), 0));
  const double eps = static_cast<double>(std::numeric_limits<std::decay_t<decltype(softsim::lane(T(), 0))>>::epsilon());
  EXPECT_NEAR(psi / hooke, 1, 5 * strain + 20 * eps / strain) << "strain " << strain;
}

template <class Law>
class SmallStrain : public testing::Test {};
using Laws = testing::Types<softsim::StVenantKirchhoff, softsim::NeoHookean, softsim::StableNeoHookean, softsim::LinearElastic>;
TYPED_TEST_SUITE(SmallStrain, Laws);

TYPED_TEST(SmallStrain, EnergyKeepsItsDigitsInDouble) {
  for (const double strain : {1e-2, 1e-4, 1e-6, 1e-8}) {
    expect_energy_near_rest<TypeParam, double>(strain);
    expect_energy_near_rest<TypeParam, softsim::Batch<double, 8>>(strain);
  }
}

TYPED_TEST(SmallStrain, EnergyKeepsItsDigitsInFloat) {
  for (const double strain : {1e-2, 1e-3, 1e-4}) {
    expect_energy_near_rest<TypeParam, float>(strain);
    expect_energy_near_rest<TypeParam, softsim::Batch<float, 8>>(strain);
  }
}

}  // namespace law_small_strain_test
