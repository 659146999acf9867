// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "material/law_checks.hpp"

// What every law has to share: Hooke's law at small strain, indifference to rotations, a symmetric second
// Piola-Kirchhoff stress.

namespace law_symmetry_test {

using namespace law_checks;
using softsim::LinearElastic;
using softsim::StVenantKirchhoff;

template <class Law>
class SmallStrain : public ::testing::Test {};
TYPED_TEST_SUITE(SmallStrain, AllLaws, LawName);

TYPED_TEST(SmallStrain, DifferentialAtRestIsHookesLaw) {
  Random random(21);
  for (const Moduli& m : moduli) {
    const auto law = TypeParam::from_young_poisson(m.young, m.poisson);
    const double lambda = m.young * m.poisson / ((1 + m.poisson) * (1 - 2 * m.poisson));
    const double mu = m.young / (2 * (1 + m.poisson));
    for (int n = 0; n < 20; ++n) {
      const Matrix dF = random.matrix(),
                   e = 0.5 * (dF + dF.transpose());  // the skew part is a rotation: no stress
      const Matrix hooke = lambda * e.trace() * Matrix::Identity() + 2 * mu * e;
      const Matrix dP = law.first_piola_differential(Matrix::Identity(), dF);
      EXPECT_LE((dP - hooke).norm(), 1e-14 * (mu + std::abs(lambda)));
    }
  }
}

// Lateral stretch at which the sides of a bar drawn out to the axial stretch s are free of stress.
template <class Law>
double free_lateral_stretch(const Law& law, double s) {
  double l = 1;
  for (int iteration = 0; iteration < 20; ++iteration) {
    const Matrix F = Vec3<double>(s, l, l).asDiagonal(), D = Vec3<double>(0, 1, 1).asDiagonal();
    const Matrix P = law.first_piola(F), dP = law.first_piola_differential(F, D);
    l -= P(1, 1) / dP(1, 1);
  }
  return l;
}

TYPED_TEST(SmallStrain, UniaxialTensionRecoversYoungsModulusAndPoissonsRatio) {
  // central difference over strains of 1e-4: an error of 1e-8 times a factor of order one (ten for nu close
  // to 1/2)
  const double strain = 1e-4;
  for (const Moduli& m : moduli) {
    const auto law = TypeParam::from_young_poisson(m.young, m.poisson);
    const double l_plus = free_lateral_stretch(law, 1 + strain),
                 l_minus = free_lateral_stretch(law, 1 - strain);
    const Matrix plus = Vec3<double>(1 + strain, l_plus, l_plus).asDiagonal();
    const Matrix minus = Vec3<double>(1 - strain, l_minus, l_minus).asDiagonal();
    const double young = (law.first_piola(plus)(0, 0) - law.first_piola(minus)(0, 0)) / (2 * strain);
    EXPECT_NEAR(young, m.young, 1e-6 * m.young);
    EXPECT_NEAR(-(l_plus - l_minus) / (2 * strain), m.poisson, 1e-6);
  }
}

template <class Law>
class Objectivity : public ::testing::Test {};
TYPED_TEST_SUITE(Objectivity, ObjectiveLaws, LawName);

// 1e-11 of the larger of the result and the moduli: with a stretch ratio of 30 the terms of det F are up to
// 900 times their sum.
TYPED_TEST(Objectivity, EnergyIgnoresAndStressFollowsARotationOfSpace) {
  Random random(22);
  for (const Moduli& m : moduli) {
    const auto law = TypeParam::from_young_poisson(m.young, m.poisson);
    const double modulus = law.mu() + std::abs(law.lambda());
    for (int n = 0; n < 100; ++n) {
      const Matrix F = random.regular(30).F, Q = random.rotation(), QF = Q * F;
      const double psi = law.energy_density(F);
      const Matrix P = law.first_piola(F);
      EXPECT_NEAR(law.energy_density(QF), psi, 1e-11 * std::max(psi, modulus)) << "F =\n" << F;
      EXPECT_LE((law.first_piola(QF) - Q * P).norm(), 1e-11 * std::max(P.norm(), modulus)) << "F =\n" << F;
    }
  }
}

TYPED_TEST(Objectivity, RotationOfTheRestShapeChangesNothing) {
  Random random(23);
  for (const Moduli& m : moduli) {
    const auto law = TypeParam::from_young_poisson(m.young, m.poisson);
    const double modulus = law.mu() + std::abs(law.lambda());
    for (int n = 0; n < 100; ++n) {
      const Matrix F = random.regular(30).F, Q = random.rotation(), FQ = F * Q;
      const double psi = law.energy_density(F);
      const Matrix P = law.first_piola(F);
      EXPECT_NEAR(law.energy_density(FQ), psi, 1e-11 * std::max(psi, modulus)) << "F =\n" << F;
      EXPECT_LE((law.first_piola(FQ) - P * Q).norm(), 1e-11 * std::max(P.norm(), modulus)) << "F =\n" << F;
    }
  }
}

TYPED_TEST(Objectivity, RotationAloneIsFreeOfEnergyAndStress) {
  Random random(24);
  const auto law = TypeParam::from_young_poisson(7e6, 0.45);
  for (int n = 0; n < 100; ++n) {
    const Matrix Q = random.rotation();
    EXPECT_NEAR(law.energy_density(Q), 0, 1e-14 * law.lambda());
    EXPECT_LE(law.first_piola(Q).norm(), 1e-14 * law.lambda());
  }
}

TYPED_TEST(Objectivity, SecondPiolaIsSymmetricAndThePullBackOfTheFirst) {
  Random random(25);
  for (const Moduli& m : moduli) {
    const auto law = TypeParam::from_young_poisson(m.young, m.poisson);
    const double modulus = law.mu() + std::abs(law.lambda());
    for (int n = 0; n < 100; ++n) {
      const Matrix F = random.regular(5).F, P = law.first_piola(F), S = law.second_piola(F);
      const Matrix pulled_back = F.inverse() * P;
      const double size = std::max(P.norm(), modulus);
      EXPECT_LE((S - S.transpose()).norm(), 1e-12 * size) << "F =\n" << F;
      EXPECT_LE((pulled_back - pulled_back.transpose()).norm(), 1e-12 * F.inverse().norm() * size) << "F =\n"
                                                                                                   << F;
      EXPECT_LE((F * S - P).norm(), 1e-12 * size) << "F =\n" << F;
    }
  }
}

TEST(StVenantKirchhoffLaw, SecondPiolaIsLinearInGreensStrain) {
  Random random(26);
  for (const Moduli& m : moduli) {
    const auto law = StVenantKirchhoff::from_young_poisson(m.young, m.poisson);
    for (int n = 0; n < 100; ++n) {
      const Matrix F = random.any_sign(30).F, E = 0.5 * (F.transpose() * F - Matrix::Identity());
      const Matrix expected = law.lambda() * E.trace() * Matrix::Identity() + 2 * law.mu() * E;
      const double energy = law.lambda() / 2 * E.trace() * E.trace() + law.mu() * E.squaredNorm();
      const double modulus = law.mu() + std::abs(law.lambda());
      EXPECT_LE((law.second_piola(F) - expected).norm(), 1e-13 * modulus * (1 + E.norm()));
      EXPECT_LE((law.first_piola(F) - F * expected).norm(), 1e-13 * modulus * (1 + E.norm()) * F.norm());
      EXPECT_NEAR(law.energy_density(F), energy, 1e-13 * modulus * (1 + E.squaredNorm()));
    }
  }
}

template <class Law>
concept HasSecondPiola = requires(const Law& law, const Matrix& F) {
  law.second_piola(F);
};
static_assert(HasSecondPiola<StVenantKirchhoff>);
static_assert(HasSecondPiola<softsim::NeoHookean>);
static_assert(HasSecondPiola<softsim::StableNeoHookean>);
static_assert(!HasSecondPiola<LinearElastic>);

TEST(LinearElasticLaw, IsStrainedByARotation) {
  const auto law = LinearElastic::from_young_poisson(10, 0.3);
  const Matrix Q = Eigen::AngleAxisd(0.5, Vec3<double>::UnitZ()).toRotationMatrix();
  // eps = (cos 0.5 - 1) diag(1, 1, 0)
  const double e = std::cos(0.5) - 1;
  EXPECT_NEAR(law.energy_density(Q), 2 * (law.mu() + law.lambda()) * e * e, 1e-14);
  EXPECT_NEAR(law.first_piola(Q)(0, 0), 2 * (law.mu() + law.lambda()) * e, 1e-14);
  EXPECT_NEAR(law.first_piola(Q)(2, 2), 2 * law.lambda() * e, 1e-14);
  EXPECT_GT(law.energy_density(Q), 0.1);

  Random random(27);
  const Matrix F = random.regular(3).F, QF = Q * F;
  EXPECT_GT(std::abs(law.energy_density(QF) - law.energy_density(F)), 1e-2);
  EXPECT_GT((law.first_piola(QF) - Q * law.first_piola(F)).norm(), 1e-1);
}

TEST(LinearElasticLaw, IsHookesLawForEveryDeformation) {
  Random random(28);
  for (const Moduli& m : moduli) {
    const auto law = LinearElastic::from_young_poisson(m.young, m.poisson);
    for (int n = 0; n < 20; ++n) {
      const Matrix F = 5 * random.matrix(), dF = random.matrix();
      const Matrix e = 0.5 * (F + F.transpose()) - Matrix::Identity(), de = 0.5 * (dF + dF.transpose());
      const Matrix P = law.lambda() * e.trace() * Matrix::Identity() + 2 * law.mu() * e;
      const Matrix dP = law.lambda() * de.trace() * Matrix::Identity() + 2 * law.mu() * de;
      const double rounding = 1e-14 * (law.mu() + std::abs(law.lambda())) * (1 + e.squaredNorm());
      EXPECT_NEAR(law.energy_density(F), 0.5 * P.cwiseProduct(e).sum(), rounding);
      EXPECT_LE((law.first_piola(F) - P).norm(), rounding);
      EXPECT_LE((law.first_piola_differential(F, dF) - dP).norm(), rounding);
    }
  }
}

}  // namespace law_symmetry_test
