// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/material/energy_law.hpp"

#include "material/law_checks.hpp"
#include "softsim/core/batch.hpp"

// Laws that a user gives as an energy alone: the derivatives come from automatic differentiation.

namespace energy_law_test {

using namespace law_checks;
using softsim::Batch;

// Neo-Hookean as a function of F.
struct OfF : softsim::EnergyLaw<OfF> {
  double lambda = 2, mu = 3;

  template <class T>
  T energy_density(const Mat3<T>& F) const {
    using std::log;
    const T log_j = log(F.determinant());
    return T(mu / 2) * (F.squaredNorm() - T(3)) - T(mu) * log_j + T(lambda / 2) * log_j * log_j;
  }
};

// The same as a function of the invariants.
struct OfInvariants : softsim::IsotropicEnergyLaw<OfInvariants> {
  double lambda = 2, mu = 3;

  template <class T>
  T density(const softsim::Invariants<T>& i) const {
    using std::log1p;
    const T log_j = log1p(i.kj);
    return T(mu / 2) * i.k1 - T(mu) * log_j + T(lambda / 2) * log_j * log_j;
  }
};

// Every function of the dual numbers, decisions, all three invariants, and a direction that stands out.
struct Intricate : softsim::EnergyLaw<Intricate> {
  template <class T>
  T energy_density(const Mat3<T>& F) const {
    using softsim::select, std::exp, std::max, std::pow, std::sqrt;
    const Mat3<T> C = F.transpose() * F;
    const T i1 = C.trace(), i2 = T(0.5) * (i1 * i1 - C.squaredNorm()), j = F.determinant();
    const T stretch = sqrt(C(0, 0)), taut = max(stretch - T(1), T(0));
    return T(2) * pow(i1 / T(3), 1.5) + exp(T(0.1) * (i2 - T(3))) + taut * taut * taut +
           select(j > T(1), T(2), T(3)) * (j - T(1)) * (j - T(1));
  }
};
// The same way through the invariants: all six second derivatives.
struct IntricateIsotropic : softsim::IsotropicEnergyLaw<IntricateIsotropic> {
  template <class T>
  T density(const softsim::Invariants<T>& i) const {
    using std::exp, std::pow;
    return pow(i.i1 / T(3), 1.5) * i.j + exp(T(0.1) * i.k2) * i.j * i.j + T(0.3) * i.k1 * i.k2 - T(2);
  }
};

static_assert(softsim::Material<OfF> && softsim::Material<OfF, float> &&
              softsim::Material<OfF, Batch<double, 8>>);
static_assert(!softsim::InvariantLaw<OfF>);
static_assert(softsim::InvariantLaw<OfInvariants> && softsim::Material<OfInvariants>);
static_assert(softsim::InvariantLaw<OfInvariants, Batch<float, 8>>);

template <class Law>
class EnergyAlone : public ::testing::Test {};
using NeoHookeans = ::testing::Types<OfF, OfInvariants>;
TYPED_TEST_SUITE(EnergyAlone, NeoHookeans);

// Differentiation is exact: what differs from the derivatives by hand is rounding, of some tens of
// operations, times the condition of cancelling terms (stretch ratio 5).
TYPED_TEST(EnergyAlone, EqualsTheLawWithDerivativesByHand) {
  Random random(71);
  const TypeParam law;
  const auto by_hand = softsim::NeoHookean::from_lame(law.lambda, law.mu);
  for (int n = 0; n < 100; ++n) {
    const Matrix F = random.regular(5).F, dF = random.matrix();
    const Matrix P = by_hand.first_piola(F), S = by_hand.second_piola(F);
    const Matrix dP = by_hand.first_piola_differential(F, dF);
    EXPECT_NEAR(law.energy_density(F), by_hand.energy_density(F),
                1e-13 * (law.mu + by_hand.energy_density(F)));
    EXPECT_LE((law.first_piola(F) - P).norm(), 1e-13 * (law.mu + P.norm()));
    EXPECT_LE((law.second_piola(F) - S).norm(), 1e-13 * (law.mu + S.norm()));
    EXPECT_LE((law.first_piola_differential(F, dF) - dP).norm(), 1e-13 * (law.mu + dP.norm()));
  }
}

TYPED_TEST(EnergyAlone, TakesBatchesAndSinglePrecision) {
  using B = Batch<double, 4>;
  Random random(72);
  const TypeParam law;
  Mat3<B> F, dF;
  std::array<Matrix, 4> f, df;
  for (int l = 0; l < 4; ++l) {
    const auto k = static_cast<std::size_t>(l);
    f[k] = random.regular(3).F;
    df[k] = random.matrix();
    for (int i = 0; i < 9; ++i) {
      set_lane(F(i), l, f[k](i));
      set_lane(dF(i), l, df[k](i));
    }
  }
  const B psi = law.energy_density(F);
  const Mat3<B> P = law.first_piola(F), dP = law.first_piola_differential(F, dF);
  for (int l = 0; l < 4; ++l) {
    const auto k = static_cast<std::size_t>(l);
    const Matrix p = law.first_piola(f[k]), dp = law.first_piola_differential(f[k], df[k]);
    EXPECT_NEAR(lane(psi, l), law.energy_density(f[k]), 1e-13 * law.mu);
    for (int i = 0; i < 9; ++i) {
      EXPECT_NEAR(lane(P(i), l), p(i), 1e-13 * (law.mu + p.norm()));
      EXPECT_NEAR(lane(dP(i), l), dp(i), 1e-13 * (law.mu + dp.norm()));
    }
    const Mat3<float> single = law.first_piola(Mat3<float>(f[k].cast<float>()));
    EXPECT_LE((single.cast<double>() - p).norm(), 1e-5 * (law.mu + p.norm()));
  }
}

TYPED_TEST(EnergyAlone, SaysThatItIsNotDefinedForInvertedF) {
  const Matrix F = Vec3<double>(-1, 1, 1).asDiagonal();
  EXPECT_FALSE(std::isfinite(TypeParam().energy_density(F)));
  EXPECT_FALSE(TypeParam().first_piola(F).allFinite());
}

TEST(EnergyLaw, DifferentiatesAnIntricateEnergy) {
  Random random(73);
  for (int n = 0; n < 50; ++n) {
    const Matrix F = random.regular(3).F;
    expect_consistent_derivatives(Intricate(), F, 1);
    expect_symmetric_and_linear(Intricate(), F, 1, random);
    expect_consistent_derivatives(IntricateIsotropic(), F, 1);
    expect_symmetric_and_linear(IntricateIsotropic(), F, 1, random);
    const Matrix P = Intricate().first_piola(F), S = Intricate().second_piola(F);
    EXPECT_LE((F * S - P).norm(), 1e-12 * (1 + P.norm()));
    EXPECT_LE((S - S.transpose()).norm(), 1e-12 * (1 + S.norm()));
  }
}

}  // namespace energy_law_test
