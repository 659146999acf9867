// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <stdexcept>

#include "material/any_law.hpp"
#include "material/tetrahedron_reference_more.hpp"
#include "softsim/material/fung.hpp"
#include "softsim/material/isochoric_neo_hookean.hpp"
#include "softsim/material/mooney_rivlin.hpp"
#include "softsim/material/veronda_westmann.hpp"
#include "softsim/material/volume_law.hpp"
#include "softsim/material/yeoh.hpp"

// Laws in isochoric invariants with every volume law, and laws in the plain invariants with a penalty.

namespace isochoric_laws_test {

using namespace law_checks;
using softsim::Coupled;
using softsim::CoupledMooneyRivlin;
using softsim::Fung;
using softsim::InvariantLaw;
using softsim::Isochoric;
using softsim::IsochoricNeoHookean;
using softsim::LogarithmicVolume;
using softsim::MooneyRivlin;
using softsim::MooneyRivlinEnergy;
using softsim::QuadraticVolume;
using softsim::SimoTaylorVolume;
using softsim::TwoTermVolume;
using softsim::VerondaWestmann;
using softsim::Yeoh;

static_assert(softsim::DistortionEnergy<MooneyRivlinEnergy> && softsim::DistortionEnergy<FullEnergy>);
static_assert(!softsim::DistortionEnergy<softsim::NeoHookean> && !softsim::DistortionEnergy<int>);
static_assert(!softsim::Material<MooneyRivlinEnergy>);
static_assert(softsim::VolumeLaw<SimoTaylorVolume, Batch<float, 8>> && softsim::VolumeLaw<TwoTermVolume>);
static_assert(!softsim::VolumeLaw<MooneyRivlinEnergy>);
static_assert(InvariantLaw<MooneyRivlin> && InvariantLaw<MooneyRivlin, Batch<double, 4>> &&
              softsim::Material<MooneyRivlin, Batch<float, 16>>);
static_assert(InvariantLaw<CoupledMooneyRivlin> && softsim::Material<CoupledMooneyRivlin, float>);
static_assert(InvariantLaw<IsochoricNeoHookean> && !IsochoricNeoHookean::depends_on_i2 &&
              !IsochoricNeoHookean::linear_in_i1);

const std::vector<AnyLaw>& laws() {
  static const std::vector<AnyLaw> all{
      {"MooneyRivlin", MooneyRivlin::from_young_poisson(3, 0.3, 0.25), InAllScalars{}},
      {"CoupledMooneyRivlin", CoupledMooneyRivlin::from_young_poisson(3, 0.3, 0.3)},
      {"IsochoricNeoHookean", IsochoricNeoHookean::from_young_poisson(3, 0.3)},
      {"Yeoh", Yeoh(0.6, -0.1, 0.02, 4)},
      {"Fung", Fung::from_young_poisson(3, 0.45, 0.4)},
      {"VerondaWestmann", VerondaWestmann::from_young_poisson(3, 0.3, 0.5), InAllScalars{}},
      {"full energy, Simo-Taylor", Isochoric(FullEnergy{}, SimoTaylorVolume(3))},
      {"full energy, coupled, two terms", Coupled(FullEnergy{}, TwoTermVolume(0.5, 0.3)), InAllScalars{}}};
  return all;
}

TEST(IsochoricLaws, RestIsFreeOfEnergyAndStressAndHookean) {
  Random random(61);
  for (const AnyLaw& law : laws()) {
    SCOPED_TRACE(law.name);
    const double modulus = law.mu + std::abs(law.lambda);
    // every term is a small multiple of a modulus, exact but for a rounding
    EXPECT_NEAR(law.energy_density(Matrix::Identity()), 0, 4e-15 * modulus);
    EXPECT_LE(law.first_piola(Matrix::Identity()).norm(), 4e-15 * modulus);
    for (int n = 0; n < 5; ++n) {
      const Matrix dF = random.matrix(), e = softsim::symmetric_part(dF);
      const Matrix hooke = law.lambda * e.trace() * Matrix::Identity() + 2 * law.mu * e;
      EXPECT_LE((law.first_piola_differential(Matrix::Identity(), dF) - hooke).norm(), 2e-14 * modulus);
    }
  }
}

template <class Law>
void expect_moduli(const Law& law, double lambda, double mu) {
  EXPECT_NEAR(law.lambda(), lambda, 1e-13);
  EXPECT_NEAR(law.mu(), mu, 1e-14);
}

TEST(IsochoricLaws, HaveTheModuliTheyWereMadeFrom) {
  const double lambda = 3 * 0.3 / (1.3 * 0.4), mu = 3 / 2.6;  // E 3, nu 0.3
  expect_moduli(MooneyRivlin::from_young_poisson(3, 0.3, 0.25), lambda, mu);
  expect_moduli(CoupledMooneyRivlin::from_young_poisson(3, 0.3, 0.3), lambda, mu);
  expect_moduli(IsochoricNeoHookean::from_young_poisson(3, 0.3), lambda, mu);
  expect_moduli(IsochoricNeoHookean::from_lame(lambda, mu), lambda, mu);
  expect_moduli(Fung::from_young_poisson(3, 0.3, 0.4), lambda, mu);
  expect_moduli(VerondaWestmann::from_young_poisson(3, 0.3, 0.5), lambda, mu);
  expect_moduli(Yeoh(0.6, -0.1, 0.02, 4), 4 - 0.8, 1.2);
  expect_moduli(Isochoric(FullEnergy{}, SimoTaylorVolume(3)), 3 - 2, 3);
  // U''(1) + 4 (W2 + W11 + 4 W12 + 4 W22)
  expect_moduli(Coupled(FullEnergy{}, TwoTermVolume(0.5, 0.3)), 4 + 4 * (0.5 + 0.4 + 1.2 + 0.8), 3);
  const auto lame = MooneyRivlin::from_lame(5.5, 2.25, 1);
  expect_moduli(lame, 5.5, 2.25);
  EXPECT_EQ(lame.distortion().c1, lame.distortion().c2);
}

TEST(IsochoricLaws, DerivativesHold) {
  Random random(62);
  for (const AnyLaw& law : laws()) {
    SCOPED_TRACE(law.name);
    for (int n = 0; n < 30; ++n) {
      const Matrix F = with_determinant(random, 0.3, 3);
      expect_consistent_invariant_derivatives(law, invariants_of(F));
      expect_consistent_derivatives(law, F, law.mu);
      expect_symmetric_and_linear(law, F, law.mu, random);
      expect_isotropic_and_objective(law, F, random);
    }
  }
}

TEST(IsochoricLaws, LanesAndSinglePrecisionAgreeWithDouble) {
  Random random(63);
  for (const AnyLaw& law : laws()) {
    if (!law.in_batch) continue;
    SCOPED_TRACE(law.name);
    for (int n = 0; n < 5; ++n) {
      std::array<Matrix, 8> F;
      for (Matrix& f : F) f = with_determinant(random, 0.3, 3);
      const Matrix D = random.matrix();
      // some tens of operations, one of which has the few-ulp error of a logarithm or exponential
      expect_lanes_as_scalars(law, *law.in_batch, F, D, 2e-15);
      expect_lanes_as_scalars(law, *law.in_float, F, D, 1e-6);
    }
  }
}

TEST(IsochoricLaws, EnergyKeepsItsDigitsAtSmallStrain) {
  for (const AnyLaw& law : laws()) {
    SCOPED_TRACE(law.name);
    for (const double strain : {1e-2, 1e-4, 1e-6, 1e-8}) {
      expect_digits_near_rest<double>(law, law.lambda, law.mu, strain);
      if (law.in_batch) expect_digits_near_rest(*law.in_batch, law.lambda, law.mu, strain);
    }
    if (!law.in_float) continue;
    for (const double strain : {1e-2, 1e-3, 1e-4})
      expect_digits_near_rest(*law.in_float, law.lambda, law.mu, strain);
  }
}

// No finite value that a line search would accept, no finite stress that an explicit step would follow.
TEST(IsochoricLaws, NothingIsFiniteWhereTheDeformationIsFlatOrInverted) {
  const Matrix flat = Vec3<double>(1, 1, 0).asDiagonal(), inverted = Vec3<double>(1, 1.1, -0.9).asDiagonal();
  for (const AnyLaw& law : laws()) {
    SCOPED_TRACE(law.name);
    for (const Matrix& F : {flat, inverted}) {
      EXPECT_FALSE(std::isfinite(law.energy_density(F)));
      EXPECT_FALSE(law.first_piola(F).allFinite());
      EXPECT_FALSE(law.first_piola_differential(F, Matrix::Identity()).allFinite());
      if (!law.in_batch) continue;
      Mat3<Batch<double, 8>> FF;
      for (int i = 0; i < 9; ++i) {
        FF(i) = i % 4 == 0 ? 1 : 0;
        softsim::set_lane(FF(i), 3, F(i));
      }
      const Batch<double, 8> psi = law.in_batch->energy_density(FF);
      const Mat3<Batch<double, 8>> P = law.in_batch->first_piola(FF);
      for (int l = 0; l < 8; ++l) {
        EXPECT_EQ(std::isfinite(softsim::lane(psi, l)), l != 3);
        EXPECT_EQ(std::isfinite(softsim::lane(P(8), l)), l != 3);
      }
    }
  }
}

// ---------------------------------------------------------------- closed forms and numbers found elsewhere

Matrix diagonal(double a, double b, double c) { return Vec3<double>(a, b, c).asDiagonal(); }

TEST(IsochoricLaws, UniaxialTensionOfMooneyRivlinWithFreeSides) {
  const auto law = MooneyRivlin::from_young_poisson(10, 0.3, 0.25);
  struct Row {
    double s, P, lateral;
  };
  for (const Row& row : {Row{0.5, -11.8600926545, 1.1073652470},
                         {0.7, -4.7096702399, 1.0978546193},
                         {0.9, -1.1370062528, 1.0313094682},
                         {1.1, 0.8943292526, 0.9713688023},
                         {1.5, 3.2077924344, 0.8813559026},
                         {2, 4.9114605931, 0.8067902321}}) {
    double l = row.s < 0.6 ? 1.1 : 1;
    for (int iteration = 0; iteration < 30; ++iteration) {
      const Matrix F = diagonal(row.s, l, l);
      l -= law.first_piola(F)(1, 1) / law.first_piola_differential(F, diagonal(0, 1, 1))(1, 1);
    }
    EXPECT_NEAR(l, row.lateral, 1e-8);
    const Matrix P = law.first_piola(diagonal(row.s, l, l));
    EXPECT_LE((P - diagonal(row.P, 0, 0)).cwiseAbs().maxCoeff(), 1e-8) << "P =\n" << P;
  }
}

// Stress P11 of F = diag(s, l2, l3), J = 1, with the pressure that takes P33 away.
template <class Law>
double incompressible(const Law& law, double s, double l2) {
  const double l3 = 1 / (s * l2);
  const Matrix P = law.first_piola(diagonal(s, l2, l3));
  return P(0, 0) - P(2, 2) * l3 / s;
}

TEST(IsochoricLaws, AtConstantVolumeMooneyRivlinIsTheIncompressibleLaw) {
  const double c1 = 1.3, c2 = 0.4;
  const MooneyRivlin split(c1, c2, 50);
  const CoupledMooneyRivlin coupled(c1, c2, 50);
  const IsochoricNeoHookean neo_hookean(c1, 50);
  for (const double s : {0.5, 0.8, 1.2, 2.0, 3.0}) {
    const double uniaxial = 2 * (c1 + c2 / s) * (s - 1 / (s * s)),
                 biaxial = 2 * (c1 + c2 * s * s) * (s - std::pow(s, -5)),
                 shear = 2 * (c1 + c2) * (s - 1 / (s * s * s)), tolerance = 1e-10;
    EXPECT_NEAR(incompressible(split, s, 1 / std::sqrt(s)), uniaxial, tolerance);
    EXPECT_NEAR(incompressible(split, s, s), biaxial, tolerance);
    EXPECT_NEAR(incompressible(split, s, 1), shear, tolerance);
    EXPECT_NEAR(incompressible(coupled, s, 1 / std::sqrt(s)), uniaxial, tolerance);
    EXPECT_NEAR(incompressible(coupled, s, s), biaxial, tolerance);
    EXPECT_NEAR(incompressible(coupled, s, 1), shear, tolerance);
    EXPECT_NEAR(incompressible(neo_hookean, s, s), 2 * c1 * (s - std::pow(s, -5)), tolerance);
  }
}

// Uniaxial stretch at constant volume: P = 2 (W1 + W2/s) (s - s^-2) for each energy.
TEST(IsochoricLaws, UniaxialStressOfTheOtherEnergies) {
  for (const double s : {0.7, 1.3, 1.8}) {
    const double x = s * s + 2 / s - 3, factor = 2 * (s - 1 / (s * s)), l = 1 / std::sqrt(s);
    EXPECT_NEAR(incompressible(Yeoh(1, -0.2, 0.05, 9), s, l), factor * (1 - 0.4 * x + 0.15 * x * x), 1e-12);
    EXPECT_NEAR(incompressible(Fung(2, 0.6, 9), s, l), factor * std::exp(0.6 * x), 1e-12);
    EXPECT_NEAR(incompressible(VerondaWestmann(2, 0.7, 9), s, l),
                factor * 1.4 * (std::exp(0.7 * x) - 0.5 / s), 1e-12);
  }
}

TEST(IsochoricLaws, CoupledMooneyRivlinWithoutItsSecondTermIsNeoHookean) {
  Random random(64);
  const auto expected = softsim::NeoHookean::from_young_poisson(10, 0.3);
  const auto law = CoupledMooneyRivlin::from_young_poisson(10, 0.3);
  for (int n = 0; n < 20; ++n) {
    const Matrix F = with_determinant(random, 0.3, 3), D = random.matrix();
    const Matrix P = expected.first_piola(F), dP = expected.first_piola_differential(F, D);
    EXPECT_NEAR(law.energy_density(F), expected.energy_density(F), 1e-12);
    EXPECT_LE((law.first_piola(F) - P).norm(), 1e-13 * (P.norm() + 10));
    EXPECT_LE((law.first_piola_differential(F, D) - dP).norm(), 1e-12 * (dP.norm() + 10));
  }
}

// A tetrahedron on three planes of symmetry, pressed by 0.5 N at its tip: F = diag(a, a, c), V P33 = -0.5.
// FEBio's law c1 = 1, c2 = 0, k = 1000 with k/2 (ln J)^2 (its test te01).
TEST(IsochoricLaws, PressedTetrahedronWithALogarithmicVolume) {
  const Isochoric law(MooneyRivlinEnergy{1, 0}, LogarithmicVolume(1000));
  double a = 1.2, c = 0.7;
  for (int iteration = 0; iteration < 30; ++iteration) {
    const Matrix P = law.first_piola(diagonal(a, a, c));
    const Matrix A = law.first_piola_differential(diagonal(a, a, c), diagonal(1, 1, 0));
    const Matrix C = law.first_piola_differential(diagonal(a, a, c), diagonal(0, 0, 1));
    Eigen::Matrix2d K;
    K << A(0, 0), C(0, 0), A(2, 2), C(2, 2);
    const Eigen::Vector2d step = K.inverse() * Eigen::Vector2d(P(0, 0), P(2, 2) + 3);
    a -= step[0];
    c -= step[1];
  }
  EXPECT_NEAR(a - 1, 0.21446319, 1e-8);
  EXPECT_NEAR(c - 1, -0.32245673, 1e-8);
}

// Bar under a live pressure of -2: Cauchy stress 2 along it, none across (C10 = 1.92505, D1 = 0.026).
TEST(IsochoricLaws, BarUnderALivePressureWithAVolumeTermInD1) {
  const double infinity = std::numeric_limits<double>::infinity();
  const Isochoric law(MooneyRivlinEnergy{1.92505, 0}, TwoTermVolume(0.026, infinity));
  const Matrix F = diagonal(1 + 1.412480 / 8, 1 - 0.07409424, 1 - 0.07409424);
  const Matrix cauchy = law.first_piola(F) * F.transpose() / F.determinant();
  // half of the last printed digit, 5e-7 / 8 of strain, times the bulk modulus 77
  EXPECT_LE((cauchy - diagonal(2, 0, 0)).cwiseAbs().maxCoeff(), 5e-6) << cauchy;
}

TEST(IsochoricLaws, SingleTetrahedraAgreeWithFiftyDigits) {
  namespace reference = tetrahedron_reference;
  const MooneyRivlin law(reference::c1, reference::c2, reference::kappa);
  for (std::size_t n = 0; n < reference::cases.size(); ++n)
    reference::expect_tetrahedron(law, reference::cases[n], reference::mooney_rivlin[n]);
}

TEST(VolumeLaws, ClosedForms) {
  for (const double J : {0.2, 0.9, 1.0, 1.5, 4.0}) {
    const double k = J - 1;
    const SimoTaylorVolume simo(3);
    EXPECT_NEAR(simo.density(k), 0.75 * (J * J - 1 - 2 * std::log(J)), 1e-14);
    EXPECT_NEAR(simo.first(k), 1.5 * (J - 1 / J), 1e-13);
    EXPECT_NEAR(simo.second(k), 1.5 * (1 + 1 / (J * J)), 1e-13);
    const TwoTermVolume two(0.5, 4);
    EXPECT_NEAR(two.density(k), 2 * k * k + k * k * k * k / 4, 1e-13);
    EXPECT_NEAR(two.first(k), 4 * k + k * k * k, 1e-13);
    EXPECT_NEAR(two.second(k), 4 + 3 * k * k, 1e-13);
  }
}

// ---------------------------------------------------------------- parameters

template <class Make>
void expect_refused(Make make, std::initializer_list<const char*> words) {
  try {
    make();
    ADD_FAILURE() << "accepted " << *words.begin();
  } catch (const std::invalid_argument& e) {
    const std::string message = e.what();
    for (const char* word : words)
      EXPECT_NE(message.find(word), std::string::npos) << '"' << message << "\" lacks \"" << word << '"';
  }
}

TEST(IsochoricLaws, InadmissibleParametersAreRefusedWithTheModuli) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = 1 / 0.0;
  expect_refused([] { MooneyRivlin(1, -2, 5); },
                 {"Mooney-Rivlin", "shear modulus -2 Pa", "bulk modulus 5 Pa"});
  expect_refused([] { MooneyRivlin(1, 0, -5); }, {"volume", "-5 Pa"});
  expect_refused([] { CoupledMooneyRivlin(4, -3, 1); },
                 {"shear modulus 2 Pa", "bulk modulus -9.66666667 Pa"});
  expect_refused([] { (void)CoupledMooneyRivlin::from_young_poisson(10, 0.1, 1); }, {"volume", "-"});
  expect_refused([] { IsochoricNeoHookean(-1, 5); }, {"Neo-Hookean", "shear modulus -2 Pa"});
  expect_refused([] { Yeoh(-0.5, 1, 1, 5); }, {"Yeoh", "shear modulus -1 Pa"});
  expect_refused([&] { Yeoh(1, nan, 1, 5); }, {"Yeoh", "nan"});
  expect_refused([&] { Yeoh(1, 1, infinity, 5); }, {"Yeoh", "nan"});
  expect_refused([] { Fung(-2, 1, 5); }, {"Fung", "shear modulus -2 Pa"});
  expect_refused([] { Fung(2, -1, 5); }, {"Fung", "exponent -1"});
  expect_refused([] { VerondaWestmann(2, 0, 5); }, {"Veronda-Westmann", "C2 0 "});
  expect_refused([] { VerondaWestmann(-2, 1.5, 5); }, {"Veronda-Westmann", "shear modulus -3 Pa"});
  expect_refused([&] { MooneyRivlin(infinity, 0, 5); }, {"Mooney-Rivlin", "inf"});
  expect_refused([] { (void)MooneyRivlin::from_young_poisson(10, 0.3, -1); }, {"c2_over_c1 -1"});
  expect_refused([] { (void)MooneyRivlin::from_young_poisson(10, 0.5); }, {"poisson_ratio 0.5"});
  expect_refused([] { (void)MooneyRivlin::from_lame(-2, 3); }, {"bulk modulus"});
  expect_refused([] { TwoTermVolume(0, 1); }, {"D1 0"});
  expect_refused([] { TwoTermVolume(1, -1); }, {"D2 -1"});
  expect_refused([] { SimoTaylorVolume(-3); }, {"Simo-Taylor", "-3 Pa"});
}

}  // namespace isochoric_laws_test
