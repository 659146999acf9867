// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/material/fibre.hpp"

#include <stdexcept>

#include "material/law_checks.hpp"
#include "softsim/core/batch.hpp"
#include "softsim/material/energy_law.hpp"
#include "softsim/material/holzapfel_gasser_ogden.hpp"
#include "softsim/material/sum.hpp"

// Fibres of one and two families, alone and in a matrix.

namespace fibre_test {

using namespace law_checks;
using softsim::Batch, softsim::HolzapfelGasserOgden, softsim::NeoHookean, softsim::SplitHolzapfelGasserOgden;
using Vec = Vec3<double>;

constexpr double k1 = 3, k2 = 0.7, kappa = 0.12, mu = 2;
const Vec a = Vec(1, 2, -0.5).normalized(), b = Vec(-0.3, 1, 1).normalized();
const HolzapfelGasserOgden fibres({.k1 = k1, .k2 = k2, .kappa = kappa});
const SplitHolzapfelGasserOgden split({.k1 = k1, .k2 = k2, .kappa = kappa});
const NeoHookean matrix = NeoHookean::from_lame(5, mu);

// No physics is meant: every derivative of w(I1, I4, J) is there and differs from the others.
struct Coupled : softsim::FibreTerm<Coupled> {
  template <class T>
  T density(const softsim::FibreInvariants<T>& i) const {
    return i.k1 * i.k1 * i.k4 + T(0.5) * i.k4 * i.k4 * i.k4 * i.j +
           T(0.3) * i.kj * i.kj * (i.k1 + T(2) * i.k4);
  }
  template <class T>
  softsim::FibreFirst<T> first(const softsim::FibreInvariants<T>& i) const {
    return {T(2) * i.k1 * i.k4 + T(0.3) * i.kj * i.kj,
            i.k1 * i.k1 + T(1.5) * i.k4 * i.k4 * i.j + T(0.6) * i.kj * i.kj,
            T(0.5) * i.k4 * i.k4 * i.k4 + T(0.6) * i.kj * (i.k1 + T(2) * i.k4)};
  }
  template <class T>
  softsim::FibreSecond<T> second(const softsim::FibreInvariants<T>& i) const {
    return {T(2) * i.k4,
            T(2) * i.k1,
            T(3) * i.k4 * i.j,
            T(0.6) * i.kj,
            T(1.5) * i.k4 * i.k4 + T(1.2) * i.kj,
            T(0.6) * (i.k1 + T(2) * i.k4)};
  }
};

using OneFamily = decltype(fibres.along(a));
using TwoFamilies = decltype(matrix + fibres.along(a, b));
static_assert(softsim::FibreLaw<HolzapfelGasserOgden> &&
              softsim::FibreLaw<HolzapfelGasserOgden, Batch<float, 8>>);
static_assert(softsim::FibreLaw<SplitHolzapfelGasserOgden> && softsim::FibreLaw<Coupled>);
static_assert(!softsim::FibreLaw<NeoHookean> && !softsim::InvariantLaw<HolzapfelGasserOgden>);
static_assert(!softsim::Material<HolzapfelGasserOgden> &&
              softsim::TakesFibreDirections<HolzapfelGasserOgden>);
static_assert(softsim::Material<OneFamily> && softsim::Material<OneFamily, Batch<double, 8>>);
static_assert(softsim::Material<TwoFamilies> && softsim::Material<TwoFamilies, float>);
static_assert(!softsim::TakesFibreDirections<TwoFamilies> && !softsim::TakesFibreDirections<NeoHookean>);
// a sum with a law that lacks its directions is no material yet
using Undirected = decltype(matrix + fibres);
static_assert(!softsim::Material<Undirected> && softsim::TakesFibreDirections<Undirected>);

// F in which the law's fibres are pulled (or pushed) along their direction, well off the bracket's switch.
Matrix along_fibre(Random& random, double stretch) {
  Matrix frame;
  frame.col(0) = a;
  frame.col(1) = a.unitOrthogonal();
  frame.col(2) = a.cross(frame.col(1));
  const Vec s(stretch, random.uniform(0.8, 1.1), random.uniform(0.8, 1.1));
  return random.rotation() * frame * s.asDiagonal() * frame.transpose();
}

template <class Law>
void expect_derivatives(const Law& law, std::uint64_t seed) {
  Random random(seed);
  for (int n = 0; n < 100; ++n) {
    const Matrix F = random.regular(2).F;
    expect_consistent_derivatives(law, F, k1);
    expect_symmetric_and_linear(law, F, k1, random);
  }
}

TEST(Fibres, DerivativesHoldForOneAndTwoFamilies) {
  expect_derivatives(fibres.along(a), 91);
  expect_derivatives(matrix + fibres.along(a, b), 92);
  expect_derivatives(split.along(a), 93);
  expect_derivatives(matrix + split.along(a, b), 94);
}

// Fibres of a law that is smooth in all its arguments, inverted and flat elements included.
TEST(Fibres, DerivativesOfACoupledLawHoldForEveryDeformation) {
  Random random(95);
  const auto law = Coupled().along(a, b);
  for (int n = 0; n < 100; ++n) {
    const Matrix F = random.any_sign(4).F;
    expect_consistent_derivatives(law, F, 1);
    expect_symmetric_and_linear(law, F, 1, random);
  }
  for (const Matrix& F : singular_deformations(random)) {
    expect_consistent_derivatives(law, F, 1);
    expect_consistent_derivatives(fibres.along(a), F, k1);
  }
}

// The formula typed once more as an energy, differentiated by machine.
struct ByMachine : softsim::EnergyLaw<ByMachine> {
  bool isochoric = false;
  template <class T>
  T energy_density(const Mat3<T>& F) const {
    using std::exp, std::max, std::pow;
    const Mat3<T> C = F.transpose() * F;
    const T g = isochoric ? pow(F.determinant(), -2.0 / 3) : T(1);
    T psi(0);
    for (const Vec& direction : {a, b}) {
      const Vec3<T> d = direction.cast<T>(), Cd = C * d;
      const T E = max(T(kappa) * (g * C.trace() - T(3)) + T(1 - 3 * kappa) * (g * d.dot(Cd) - T(1)), T(0));
      psi += T(k1 / (2 * k2)) * (exp(T(k2) * E * E) - T(1));
    }
    return psi;
  }
};

template <class Law>
void expect_equal_to_machine(const Law& law, const ByMachine& machine, std::uint64_t seed) {
  Random random(seed);
  for (int n = 0; n < 100; ++n) {
    const Matrix F = random.regular(2).F, dF = random.matrix();
    const Matrix P = machine.first_piola(F), S = machine.second_piola(F);
    const Matrix dP = machine.first_piola_differential(F, dF);
    const double psi = machine.energy_density(F);
    // E comes from H = F - I in one and from C in the other: a few roundings, which k2 E^2 < 10 magnifies
    EXPECT_NEAR(law.energy_density(F), psi, 1e-12 * (k1 + psi));
    EXPECT_LE((law.first_piola(F) - P).norm(), 1e-12 * (k1 + P.norm()));
    EXPECT_LE((law.second_piola(F) - S).norm(), 1e-12 * (k1 + S.norm()));
    EXPECT_LE((law.first_piola_differential(F, dF) - dP).norm(), 1e-12 * (k1 + dP.norm()));
  }
}

TEST(HolzapfelGasserOgden, EqualsItsFormulaDifferentiatedByMachine) {
  expect_equal_to_machine(fibres.along(a, b), {}, 96);
  ByMachine isochoric;
  isochoric.isochoric = true;
  expect_equal_to_machine(split.along(a, b), isochoric, 97);
}

TEST(Fibres, AreFreeOfEnergyAndStressAtRestAndInCompression) {
  const Matrix rest = Matrix::Identity();
  const auto law = fibres.along(a, b);
  EXPECT_EQ(law.energy_density(rest), 0);
  EXPECT_EQ(law.first_piola(rest).norm(), 0);
  EXPECT_EQ(split.along(a).energy_density(rest), 0);
  EXPECT_EQ(split.along(a).first_piola(rest).norm(), 0);
  const Matrix F = 0.9 * rest;
  EXPECT_EQ(law.energy_density(F), 0);
  EXPECT_EQ(law.first_piola(F).norm(), 0);
  EXPECT_EQ(law.first_piola_differential(F, rest).norm(), 0);
}

// A dilation stretches fibres; the split law does not see it.
TEST(Fibres, FeelADilationUnlessTheLawIsSplit) {
  const Matrix F = 1.1 * Matrix::Identity();
  EXPECT_GT(fibres.along(a).first_piola(F).norm(), 0.1);
  // J^(-2/3) I4 - 1 is rounding
  EXPECT_LT(split.along(a).first_piola(F).norm(), 1e-14);
}

// The stress is continuous where the fibres go slack, its differential jumps from 0.
TEST(Fibres, PullFromTheSwitchOn) {
  Random random(98);
  const auto law = HolzapfelGasserOgden({.k1 = k1, .k2 = k2}).along(a);
  const Matrix Q = random.rotation(), F = Q * along_fibre(random, 1), dF = F * a * a.transpose();
  for (const double eps : {1e-3, 1e-6, 1e-9}) {
    const Matrix taut = F + eps * dF, slack = F - eps * dF;
    EXPECT_EQ(law.first_piola(slack).norm(), 0);
    EXPECT_EQ(law.first_piola_differential(slack, dF).norm(), 0);
    // E = (1 + eps)^2 - 1, P = 2 k1 E exp(k2 E^2) F a a^T; E is rounded at some 1e-16
    const double E = eps * (2 + eps), P = 2 * k1 * E * std::exp(k2 * E * E) * (1 + eps);
    EXPECT_NEAR(law.first_piola(taut).norm(), P, 1e-14);
    EXPECT_NEAR(law.energy_density(taut) / (k1 / (2 * k2) * std::expm1(k2 * E * E)), 1, 5e-15 / eps);
    EXPECT_NEAR(law.first_piola_differential(taut, dF).norm(), 4 * k1, 40 * k1 * eps);
  }
  // and the derivative checks on both sides close to it, where the step 6e-6 does not reach it
  expect_consistent_derivatives(law, F + 1e-4 * dF, k1);
  expect_consistent_derivatives(law, F - 1e-4 * dF, k1);
}

TEST(Fibres, AreIndifferentToRotationsAndToTheirOwnSign) {
  Random random(99);
  const auto law = matrix + fibres.along(a, b);
  for (int n = 0; n < 100; ++n) {
    const Matrix F = random.regular(2).F, Q = random.rotation(), QF = Q * F, dF = random.matrix();
    const Matrix P = law.first_piola(F), dP = law.first_piola_differential(F, dF);
    const double psi = law.energy_density(F);
    EXPECT_NEAR(law.energy_density(QF), psi, 1e-12 * (k1 + psi));
    EXPECT_LE((law.first_piola(QF) - Q * P).norm(), 1e-12 * (k1 + P.norm()));
    const auto reversed = matrix + fibres.along(-a, b);
    // but for the fused multiply-adds that the compiler chooses at each place
    EXPECT_NEAR(reversed.energy_density(F), psi, 1e-13 * (k1 + psi));
    EXPECT_LE((reversed.first_piola(F) - P).norm(), 1e-13 * (k1 + P.norm()));
    EXPECT_LE((reversed.first_piola_differential(F, dF) - dP).norm(), 1e-13 * (k1 + dP.norm()));
    const auto swapped = matrix + fibres.along(b, a);
    EXPECT_LE((swapped.first_piola(F) - P).norm(), 1e-13 * (k1 + P.norm()));
    // a rotation of the rest shape has to take the fibres with it
    const auto turned = matrix + fibres.along(Q * a, Q * b);
    const Matrix FQt = F * Q.transpose();
    EXPECT_NEAR(turned.energy_density(FQt), psi, 1e-12 * (k1 + psi));
  }
}

// Uniaxial stretch of fibres in a matrix without lateral stiffness of their own: along the fibre the stress
// is that of the matrix plus 2 k1 E exp(k2 E^2) stretch, across it that of the matrix.
TEST(HolzapfelGasserOgden, UniaxialStretchAlongAndAcross) {
  const Vec x = Vec::UnitX(), y = Vec::UnitY();
  const HolzapfelGasserOgden aligned({.k1 = k1, .k2 = k2});
  for (const double stretch : {0.7, 0.95, 1.05, 1.4}) {
    const Matrix F = Vec(stretch, 0.9, 0.9).asDiagonal(), P = matrix.first_piola(F);
    const double E = std::max(stretch * stretch - 1, 0.0),
                 fibre = 2 * k1 * E * std::exp(k2 * E * E) * stretch;
    Matrix expected = P;
    expected(0, 0) += fibre;
    EXPECT_LE(((matrix + aligned.along(x)).first_piola(F) - expected).norm(), 1e-13 * (1 + expected.norm()));
    EXPECT_LE(((matrix + aligned.along(y)).first_piola(F) - P).norm(), 1e-15);
    // dispersed: E = kappa (I1 - 3) + (1 - 3 kappa)(I4 - 1), P = 2 w' (kappa F + (1 - 3 kappa) F x x^T)
    const double I1 = stretch * stretch + 2 * 0.81;
    const double e = std::max(kappa * (I1 - 3) + (1 - 3 * kappa) * (stretch * stretch - 1), 0.0);
    const double w = 2 * k1 * e * std::exp(k2 * e * e);
    const Matrix dispersed =
        Vec(w * (1 - 2 * kappa) * stretch, w * kappa * 0.9, w * kappa * 0.9).asDiagonal();
    EXPECT_LE((fibres.along(x).first_piola(F) - dispersed).norm(), 1e-13 * (1 + dispersed.norm()));
  }
}

// Dispersed evenly, the fibres are an isotropic law of Fung's kind in I1 alone.
struct Fung : softsim::IsotropicEnergyLaw<Fung> {
  static constexpr bool depends_on_i2 = false, depends_on_j = false;
  template <class T>
  T density(const softsim::Invariants<T>& i) const {
    using std::expm1, std::max;
    const T E = max(i.k1 / T(3), T(0));
    return T(k1 / (2 * k2)) * expm1(T(k2) * E * E);
  }
};

TEST(HolzapfelGasserOgden, DispersedEvenlyIsAnIsotropicLaw) {
  Random random(100);
  const auto law = HolzapfelGasserOgden({.k1 = k1, .k2 = k2, .kappa = 1.0 / 3}).along(a);
  for (int n = 0; n < 100; ++n) {
    const Matrix F = random.regular(2).F, dF = random.matrix();
    const Matrix P = Fung().first_piola(F), dP = Fung().first_piola_differential(F, dF);
    EXPECT_NEAR(law.energy_density(F), Fung().energy_density(F), 1e-13 * (k1 + Fung().energy_density(F)));
    EXPECT_LE((law.first_piola(F) - P).norm(), 1e-12 * (k1 + P.norm()));
    EXPECT_LE((law.first_piola_differential(F, dF) - dP).norm(), 1e-12 * (k1 + dP.norm()));
  }
}

TEST(Sum, AddsWhatItsLawsGive) {
  Random random(101);
  const auto along_a = HolzapfelGasserOgden({.k1 = 1, .k2 = 2}).along(a);
  const auto along_b = HolzapfelGasserOgden({.k1 = 4, .k2 = 1, .kappa = 0.2}).along(b);
  const auto law = matrix + along_a + along_b;
  const auto undirected = (matrix + fibres).along(a, b);  // directions after the sum
  for (int n = 0; n < 20; ++n) {
    const Matrix F = random.regular(2).F, dF = random.matrix();
    const double psi = matrix.energy_density(F) + along_a.energy_density(F) + along_b.energy_density(F);
    const double rounding = 1e-13;
    EXPECT_NEAR(law.energy_density(F), psi, rounding * (1 + std::abs(psi)));
    const Matrix P = matrix.first_piola(F) + along_a.first_piola(F) + along_b.first_piola(F);
    EXPECT_LE((law.first_piola(F) - P).norm(), rounding * (k1 + P.norm()));
    const Matrix S = matrix.second_piola(F) + along_a.second_piola(F) + along_b.second_piola(F);
    EXPECT_LE((law.second_piola(F) - S).norm(), rounding * (k1 + S.norm()));
    const Matrix dP = matrix.first_piola_differential(F, dF) + along_a.first_piola_differential(F, dF) +
                      along_b.first_piola_differential(F, dF);
    EXPECT_LE((law.first_piola_differential(F, dF) - dP).norm(), rounding * (k1 + dP.norm()));
    const Matrix both = (matrix + fibres.along(a, b)).first_piola(F);
    EXPECT_LE((undirected.first_piola(F) - both).norm(), rounding * (k1 + both.norm()));
  }
}

// Lanes and directions from the element: what the scalar with constant directions gives.
TEST(Fibres, TakeBatchesDirectionsPerLaneAndSinglePrecision) {
  using B = Batch<double, 4>;
  Random random(102);
  const auto law = matrix + split;
  Mat3<B> F, dF;
  softsim::FibreDirections<B, 2> directions;
  std::array<Matrix, 4> f, df;
  std::array<std::array<Vec, 2>, 4> d;
  for (int l = 0; l < 4; ++l) {
    const auto k = static_cast<std::size_t>(l);
    f[k] = random.regular(2).F;
    df[k] = random.matrix();
    d[k] = {random.rotation().col(0), random.rotation().col(1)};
    for (int i = 0; i < 9; ++i) {
      set_lane(F(i), l, f[k](i));
      set_lane(dF(i), l, df[k](i));
    }
    for (int i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 2; ++j) set_lane(directions.a[j][i], l, d[k][j][i]);
  }
  const auto bound = law.at(directions);
  const B psi = bound.energy_density(F);
  const Mat3<B> P = bound.first_piola(F), dP = bound.first_piola_differential(F, dF);
  for (int l = 0; l < 4; ++l) {
    const auto k = static_cast<std::size_t>(l);
    const auto scalar = law.along(d[k][0], d[k][1]);
    const Matrix p = scalar.first_piola(f[k]), dp = scalar.first_piola_differential(f[k], df[k]);
    // the two exponentials differ by some units in the last place
    EXPECT_NEAR(lane(psi, l), scalar.energy_density(f[k]), 1e-13 * (k1 + scalar.energy_density(f[k])));
    for (int i = 0; i < 9; ++i) {
      EXPECT_NEAR(lane(P(i), l), p(i), 1e-13 * (k1 + p.norm()));
      EXPECT_NEAR(lane(dP(i), l), dp(i), 1e-13 * (k1 + dp.norm()));
    }
    const Mat3<float> single = scalar.first_piola(Mat3<float>(f[k].cast<float>()));
    EXPECT_LE((single.cast<double>() - p).norm(), 2e-5 * (k1 + p.norm()));
  }
}

// At a strain of 1e-8 the energy is k1/2 (a . (H + H^T) a)^2 to about 1e-8; I4 - 1 as a difference would have
// lost all but eight digits of it.
TEST(Fibres, KeepTheirDigitsAtSmallStrain) {
  const HolzapfelGasserOgden aligned({.k1 = k1, .k2 = k2});
  Matrix H = Matrix::Zero();
  H(0, 0) = 0x1p-27;
  const auto law = aligned.along(Vec::UnitX());
  const double E = 2 * H(0, 0) + H(0, 0) * H(0, 0);
  EXPECT_NEAR(law.energy_density(Matrix::Identity() + H) / (k1 / 2 * E * E), 1, 1e-14);
  EXPECT_NEAR(law.first_piola(Matrix::Identity() + H)(0, 0) / (2 * k1 * E * (1 + H(0, 0))), 1, 1e-14);
}

TEST(Fibres, WithoutANumberForSplitLawsOfInvertedElements) {
  const Matrix F = Vec(-1.2, 1, 1).asDiagonal();
  EXPECT_FALSE(std::isfinite(split.along(a).energy_density(F)));
  EXPECT_FALSE(split.along(a).first_piola(F).allFinite());
  EXPECT_FALSE(split.along(a).first_piola_differential(F, F).allFinite());
}

template <class Function>
std::string refusal(Function f) {
  try {
    (void)f();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return {};
}

TEST(Fibres, RefuseBadParametersAndDirections) {
  const double nan = std::nan("");
  EXPECT_EQ(refusal([] { return HolzapfelGasserOgden({.k1 = 0, .k2 = 1}); }),
            "fibres: k1 0 Pa must be positive and finite");
  EXPECT_EQ(refusal([nan] { return SplitHolzapfelGasserOgden({.k1 = nan, .k2 = 1}); }),
            "fibres: k1 nan Pa must be positive and finite");
  EXPECT_EQ(refusal([] { return HolzapfelGasserOgden({.k1 = 1, .k2 = -2}); }),
            "fibres: k2 -2 must be positive and finite");
  EXPECT_EQ(refusal([] { return HolzapfelGasserOgden({.k1 = 1, .k2 = 1, .kappa = 0.34}); }),
            "fibres: dispersion kappa 0.34 must lie in [0, 1/3]");
  EXPECT_EQ(refusal([] { return HolzapfelGasserOgden({.k1 = 1, .k2 = 1, .kappa = -0.01}); }),
            "fibres: dispersion kappa -0.01 must lie in [0, 1/3]");
  EXPECT_EQ(refusal([] { return fibres.along(Vec(1, 1, 0)); }),
            "fibre direction (1, 1, 0): length 1.41421356 must be 1");
  EXPECT_EQ(refusal([] { return fibres.along(a, Vec::Zero()); }),
            "fibre direction (0, 0, 0): length 0 must be 1");
  EXPECT_EQ(refusal([nan] { return (matrix + fibres).along(Vec(nan, 0, 0)); }),
            "fibre direction (nan, 0, 0): length nan must be 1");
  EXPECT_EQ(refusal([] { return fibres.along((1 + 2e-6) * a); }).empty(), false);
  EXPECT_EQ(refusal([] { return fibres.along((1 + 5e-7) * a, (1 - 5e-7) * b); }), "");
  // what is taken is normalised
  EXPECT_NEAR(fibres.along((1 + 5e-7) * a).directions().a[0].norm(), 1, 1e-15);
}

}  // namespace fibre_test
