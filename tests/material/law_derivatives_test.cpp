// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "material/law_checks.hpp"

// Energy, stress and differential of every law belong together: the first is zero at rest, each of the others
// is the derivative of the one before it, wherever the law is defined.

namespace law_derivatives_test {

using namespace law_checks;
using softsim::NeoHookean;
using softsim::StableNeoHookean;
using softsim::StVenantKirchhoff;

template <class Law>
class LawDerivatives : public ::testing::Test {};
TYPED_TEST_SUITE(LawDerivatives, AllLaws, LawName);

TYPED_TEST(LawDerivatives, EnergyAndStressVanishAtRest) {
  for (const Moduli& m : moduli) {
    const auto law = TypeParam::from_young_poisson(m.young, m.poisson);
    // every term is a small multiple of a modulus, exact but for a rounding
    const double rounding = 4e-16 * (law.mu() + std::abs(law.lambda()));
    EXPECT_NEAR(law.energy_density(Matrix::Identity()), 0, rounding);
    EXPECT_LE(law.first_piola(Matrix::Identity()).norm(), rounding);
  }
}

TYPED_TEST(LawDerivatives, EnergyIsPositiveAroundRest) {
  Random random(10);
  for (const Moduli& m : moduli) {
    const auto law = TypeParam::from_young_poisson(m.young, m.poisson);
    for (int n = 0; n < 50; ++n) {
      const Matrix e = softsim::symmetric_part(random.matrix());
      // the energy of strain 1e-3 is 1e-6 of the modulus, third-order terms 1e-9
      EXPECT_GT(law.energy_density(Matrix::Identity() + 1e-3 * e), 0) << "e =\n" << e;
    }
  }
}

TYPED_TEST(LawDerivatives, StressIsTheGradientAndTheDifferentialItsDerivative) {
  Random random(11);
  for (const Moduli& m : moduli) {
    const auto law = TypeParam::from_young_poisson(m.young, m.poisson);
    for (int n = 0; n < 100; ++n) expect_consistent_derivatives(law, random.regular(30).F, law.mu());
  }
}

TYPED_TEST(LawDerivatives, DifferentialIsSymmetricAndLinear) {
  Random random(12);
  for (const Moduli& m : moduli) {
    const auto law = TypeParam::from_young_poisson(m.young, m.poisson);
    for (int n = 0; n < 100; ++n) expect_symmetric_and_linear(law, random.regular(30).F, law.mu(), random);
  }
}

TYPED_TEST(LawDerivatives, TakesAnyExpressionOfThreeByThree) {
  Random random(13);
  const auto law = TypeParam::from_young_poisson(10, 0.3);
  const Matrix Q = random.rotation(), F = random.regular(3).F, dF = random.matrix();
  const Matrix QF = Q * F, sum = F + dF;
  Eigen::Matrix<double, 6, 6> large = Eigen::Matrix<double, 6, 6>::Zero();
  large.block<3, 3>(2, 1) = QF;
  const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> rows = QF;

  EXPECT_EQ(law.energy_density(large.block<3, 3>(2, 1)), law.energy_density(QF));
  EXPECT_EQ(law.energy_density(rows), law.energy_density(QF));
  EXPECT_EQ(law.first_piola(large.block<3, 3>(2, 1)), law.first_piola(QF));
  EXPECT_EQ(law.first_piola(rows), law.first_piola(QF));
  EXPECT_EQ(law.first_piola_differential(rows, F + dF), law.first_piola_differential(QF, sum));
}

template <class Law>
class LawsOfEveryF : public ::testing::Test {};
using LawsDefinedEverywhere = ::testing::Types<StVenantKirchhoff, StableNeoHookean>;
TYPED_TEST_SUITE(LawsOfEveryF, LawsDefinedEverywhere, LawName);

TYPED_TEST(LawsOfEveryF, DerivativesHoldOverInvertedDeformations) {
  Random random(14);
  int inverted = 0;
  for (const Moduli& m : moduli) {
    const auto law = TypeParam::from_young_poisson(m.young, m.poisson);
    for (int n = 0; n < 100; ++n) {
      const Matrix F = random.any_sign(30).F;
      inverted += F.determinant() < 0;
      expect_consistent_derivatives(law, F, law.mu());
      expect_symmetric_and_linear(law, F, law.mu(), random);
    }
  }
  EXPECT_GT(inverted, 100);
}

TYPED_TEST(LawsOfEveryF, DerivativesHoldWhereTheDeformationIsSingular) {
  Random random(15);
  for (const Moduli& m : moduli) {
    const auto law = TypeParam::from_young_poisson(m.young, m.poisson);
    for (const Matrix& F : singular_deformations(random)) {
      expect_consistent_derivatives(law, F, law.mu());
      expect_symmetric_and_linear(law, F, law.mu(), random);
    }
  }
}

// Inverted or flat, the energy of the Neo-Hookean law may be infinite or not a number, but never a finite
// value that a line search would accept.
template <class T>
void expect_nowhere_finite(const NeoHookean& law, const Mat3<T>& F) {
  EXPECT_FALSE(std::isfinite(law.energy_density(F))) << "F =\n" << F;
  EXPECT_FALSE(law.first_piola(F).allFinite()) << "F =\n" << F;
  EXPECT_FALSE(law.first_piola_differential(F, Mat3<T>::Identity()).allFinite()) << "F =\n" << F;
}

TEST(NeoHookeanLaw, IsNotFiniteOverInvertedDeformations) {
  Random random(16);
  for (const Moduli& m : moduli) {
    const auto law = NeoHookean::from_young_poisson(m.young, m.poisson);
    for (int n = 0; n < 100; ++n) {
      Deformation d = random.regular(30);
      d.stretches[n % 3] *= -1;
      const Matrix F = d.U * d.stretches.asDiagonal() * d.V.transpose();
      expect_nowhere_finite<double>(law, F);
      expect_nowhere_finite<float>(law, F.cast<float>());
    }
    expect_nowhere_finite<double>(law, -Matrix::Identity());
    // a hair beyond flat
    expect_nowhere_finite<double>(law, Vec3<double>(1, 1, -1e-300).asDiagonal().toDenseMatrix());
  }
}

TEST(NeoHookeanLaw, IsNotFiniteWhereTheDeterminantIsZero) {
  for (const Moduli& m : moduli) {
    const auto law = NeoHookean::from_young_poisson(m.young, m.poisson);
    const Matrix zero = Matrix::Zero(), line = Vec3<double>(0, 0, 2).asDiagonal(),
                 plane = Vec3<double>(1, 1, 0).asDiagonal();
    for (const Matrix& F : {zero, line, plane}) {
      expect_nowhere_finite<double>(law, F);
      expect_nowhere_finite<float>(law, F.cast<float>());
    }
  }
}

}  // namespace law_derivatives_test
