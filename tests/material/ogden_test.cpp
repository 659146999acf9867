// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/material/ogden.hpp"

#include "material/law_checks.hpp"

namespace ogden_test {

using namespace law_checks;
using softsim::Batch, softsim::Ogden, softsim::OgdenTerm, softsim::Stretches;

static_assert(softsim::Material<Ogden> && softsim::Material<Ogden, Batch<float, 8>>);
static_assert(softsim::StretchLawWithQuotients<Ogden> && !softsim::InvariantLaw<Ogden>);

/// Ogden's parameters of 1972 for Treloar's rubber, in Pa; nearly incompressible.
const Ogden rubber({{0.63e6, 1.3}, {0.0012e6, 5}, {-0.01e6, -2}}, 50e6);
/// Softer in volume and with larger exponents.
const Ogden foam({{3, 2}, {-0.5, -4}, {0.01, 9}}, 8);

std::string refusal(const std::vector<OgdenTerm>& terms, double bulk) {
  try {
    const Ogden law(terms, bulk);
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "";
}

TEST(Ogden, DerivativesAreConsistent) {
  Random random(40);
  for (int n = 0; n < 50; ++n) {
    const Matrix F = random.regular(10).F, G = random.regular(3).F;
    expect_consistent_derivatives(rubber, F, rubber.shear_modulus());
    expect_symmetric_and_linear(rubber, F, rubber.shear_modulus(), random);
    expect_consistent_derivatives(foam, G, foam.shear_modulus());
    expect_symmetric_and_linear(foam, G, foam.shear_modulus(), random);
  }
  for (const double d : {0.0, 1e-14, 1e-9, 1e-5, 1e-3, 3e-2})
    for (const Vec3<double>& s :
         {Vec3<double>(1.4, 1.4 - d, 0.7), Vec3<double>(2, 0.6 + d, 0.6), Vec3<double>(1 + d, 1, 1)})
      expect_consistent_derivatives(foam, random.from_stretches(s).F, foam.shear_modulus());
}

TEST(Ogden, EnergyAndStressVanishAtRestAndTheModuliAreThoseOfSmallStrain) {
  for (const Ogden& law : {rubber, foam}) {
    EXPECT_EQ(law.energy_density(Matrix::Identity()), 0);
    EXPECT_EQ(law.first_piola(Matrix::Identity()), Matrix::Zero());
    const double mu = law.shear_modulus(), lambda = law.bulk_modulus() - 2 * mu / 3;
    Random random(41);
    const Matrix dF = random.matrix(), e = softsim::symmetric_part(dF);
    const Matrix stress = lambda * e.trace() * Matrix::Identity() + 2 * mu * e;
    EXPECT_LE((law.first_piola_differential(Matrix::Identity(), dF) - stress).norm(), 1e-14 * stress.norm());
    for (const double strain : {1e-5, 1e-8, 1e-10}) {
      const Matrix F = Matrix::Identity() + strain * e;
      const Matrix rounded = (F - Matrix::Identity()) / strain;  // what F holds of it
      const double t = rounded.trace(), w = mu * rounded.squaredNorm() + lambda / 2 * t * t;
      // what remains are terms of third order, with derivatives up to alpha times as large
      EXPECT_NEAR(law.energy_density(F) / (strain * strain * w), 1, 20 * strain + 1e-14);
    }
  }
  EXPECT_NEAR(rubber.shear_modulus(), 0.5e6 * (0.63 * 1.3 + 0.0012 * 5 + 0.01 * 2), 1e-9);
  const Ogden made = Ogden::from_young_poisson(10, 0.3, -3);
  EXPECT_NEAR(made.shear_modulus(), 10 / 2.6, 1e-14);
  EXPECT_NEAR(made.bulk_modulus(), 10 / 1.2, 1e-14);
}

// w = mu/2 (J^(-2/3) I1 - 3) + K/2 (J - 1)^2 with P = mu J^(-2/3) (F - I1/3 F^-T) + K (J - 1) J F^-T
TEST(Ogden, OneTermOfExponentTwoIsTheIsochoricNeoHookeanLaw) {
  const double mu = 3, K = 20;
  const Ogden law({{mu, 2}}, K);
  EXPECT_EQ(law.shear_modulus(), mu);
  Random random(42);
  for (int n = 0; n < 100; ++n) {
    const Matrix F = random.regular(10).F, G = F.inverse().transpose();
    const double J = F.determinant(), c = std::pow(J, -2.0 / 3), i1 = F.squaredNorm();
    const double w = mu / 2 * (c * i1 - 3) + K / 2 * (J - 1) * (J - 1);
    const Matrix P = mu * c * (F - i1 / 3 * G) + K * (J - 1) * J * G;
    EXPECT_NEAR(law.energy_density(F), w, 1e-13 * (w + mu));
    EXPECT_LE((law.first_piola(F) - P).norm(), 1e-12 * (P.norm() + mu)) << F;
    EXPECT_LE((F * law.second_piola(F) - P).norm(), 1e-12 * (P.norm() + mu)) << F;
  }
}

// Nominal stresses at J = 1 with the pressure that frees one direction: sum mu (l^(a-1) - l^(-b-1)) with b =
// a/2, a and 2a in uniaxial tension, pure shear and equibiaxial tension.
TEST(Ogden, AgreesWithTheClosedFormsOfIncompressibleTests) {
  for (const Ogden& law : {rubber, foam})
    for (const double l : {0.7, 1.01, 1.5, 3.0}) {
      const std::array<Vec3<double>, 3> tests{Vec3<double>(l, 1 / std::sqrt(l), 1 / std::sqrt(l)),
                                              Vec3<double>(l, 1, 1 / l), Vec3<double>(l, l, 1 / (l * l))};
      const std::array<double, 3> factor{0.5, 1, 2};
      for (std::size_t k = 0; k < 3; ++k) {
        const Matrix P = law.first_piola(tests[k].asDiagonal().toDenseMatrix());
        double expected = 0, size = 0;
        for (const OgdenTerm& term : law.terms()) {
          const double a = std::pow(l, term.alpha - 1), b = std::pow(l, -factor[k] * term.alpha - 1);
          expected += term.mu * (a - b);
          size += std::abs(term.mu) * (a + b);
        }
        // The stretches are rounded, so that J - 1 is, which the bulk modulus multiplies.
        const double tolerance = 1e-14 * size + 1e-15 * law.bulk_modulus() * 30;
        EXPECT_NEAR(P(0, 0) - P(2, 2) * tests[k][2] / l, expected, tolerance) << l << " " << k;
      }
    }
}

// Uniaxial tension, pure shear and equibiaxial tension of rubber: stretch and nominal stress in MPa (Treloar
// 1944), every third point or so up to a stretch of 7.2, where
// Ogden's fit of 1972 lies within 10 % or 0.03 MPa of all of them.
TEST(Ogden, FollowsTreloarsRubber) {
  struct Point {
    double stretch, stress;
  };
  const std::array<std::vector<Point>, 3> data{
      {{{1.12, 0.14}, {1.39, 0.32}, {2.17, 0.58}, {3.58, 1.04}, {5.36, 1.94}, {6.40, 3.02}, {7.16, 4.47}},
       {{1.14, 0.16}, {1.46, 0.42}, {2.40, 0.76}, {3.48, 1.11}, {4.36, 1.46}, {4.96, 1.79}},
       {{1.08, 0.16}, {1.20, 0.33}, {1.69, 0.65}, {2.49, 0.96}, {3.43, 1.45}, {4.03, 1.96}, {4.44, 2.43}}}};
  for (std::size_t k = 0; k < 3; ++k)
    for (const Point& p : data[k]) {
      const double l = p.stretch;
      const double middle = k == 0 ? 1 / std::sqrt(l) : k == 1 ? 1 : l;
      const Vec3<double> s(l, middle, 1 / (l * middle));
      const Matrix P = rubber.first_piola(s.asDiagonal().toDenseMatrix());
      EXPECT_NEAR(1e-6 * (P(0, 0) - P(2, 2) * s[2] / l), p.stress, 0.03 + 0.1 * p.stress) << k << " " << l;
    }
}

// Direct in extended precision, where rounding over the distance is harmless down to 1e-5; below, the
// generic quadrature, which is exact there, also in extended precision.
TEST(Ogden, QuotientsKeepTheirDigitsAtEveryDistance) {
  double worst = 0;
  for (const double a : {0.3, 1.0, 4.0})
    for (double d = 1e-16; d < 3; d *= 1.5) {
      const double b = a / (1 + d);
      using Wide = long double;
      const Stretches<Wide> wide{Vec3<Wide>(1.2, a, b)};
      const Vec3<Wide> w = foam.first(wide);
      const Mat3<Wide> w2 = foam.second(wide);
      const Wide distance = static_cast<Wide>(a) - b;
      const Wide expected = d < 1e-5 ? softsim::detail::stretch_quotient(foam, wide, w, w2, 1, 2, -1)
                                     : (w[1] - w[2]) / distance;
      const double q = foam.difference_quotients(Stretches<double>{Vec3<double>(1.2, a, b)})[0];
      worst = std::max(worst, std::abs(q - static_cast<double>(expected)) / static_cast<double>(w2.norm()));
    }
  EXPECT_LE(worst, 1e-14);
}

TEST(Ogden, IsNotFiniteOverInvertedDeformations) {
  Random random(43);
  const auto expect_not_finite = [](const auto& F) {
    for (const Ogden& law : {rubber, foam, Ogden({{1, 6}}, 1)}) {
      EXPECT_FALSE(std::isfinite(law.energy_density(F))) << F;
      EXPECT_FALSE(law.first_piola(F).allFinite()) << F;
      EXPECT_FALSE(law.first_piola_differential(F, F).allFinite()) << F;
    }
  };
  for (int n = 0; n < 20; ++n) {
    Deformation d = random.regular(30);
    d.stretches[n % 3] *= -1;
    const Matrix F = d.U * d.stretches.asDiagonal() * d.V.transpose();
    expect_not_finite(F);
    expect_not_finite(Mat3<float>(F.cast<float>()));
  }
  expect_not_finite(Matrix(-Matrix::Identity()));
  expect_not_finite(Matrix(Matrix::Zero()));
  expect_not_finite(Matrix(Vec3<double>(1, 1, 0).asDiagonal()));
  expect_not_finite(Matrix(Vec3<double>(0, 0, 2).asDiagonal()));
  expect_not_finite(Matrix(Vec3<double>(1, 1, -1e-300).asDiagonal()));
}

TEST(Ogden, BatchesAreTheScalarsLaneByLaneAndKeepNaN) {
  using B = Batch<double, 4>;
  Random random(44);
  for (int n = 0; n < 10; ++n) {
    Mat3<B> F, dF;
    std::array<Matrix, 4> Fs, dFs;
    for (int l = 0; l < 4; ++l) {
      const auto k = static_cast<std::size_t>(l);
      Fs[k] = l == 3 ? Matrix(-Matrix::Identity()) : random.regular(4).F;
      dFs[k] = random.matrix();
      for (int i = 0; i < 9; ++i) {
        softsim::set_lane(F(i), l, Fs[k](i));
        softsim::set_lane(dF(i), l, dFs[k](i));
      }
    }
    const B w = foam.energy_density(F);
    const Mat3<B> P = foam.first_piola(F), dP = foam.first_piola_differential(F, dF);
    for (int l = 0; l < 3; ++l) {
      const auto k = static_cast<std::size_t>(l);
      const double size = tangent(foam, Fs[k]).norm();
      EXPECT_NEAR(lane(w, l), foam.energy_density(Fs[k]), 1e-13 * size);
      const Matrix P_one = foam.first_piola(Fs[k]), dP_one = foam.first_piola_differential(Fs[k], dFs[k]);
      for (int i = 0; i < 9; ++i) {
        EXPECT_NEAR(lane(P(i), l), P_one(i), 1e-13 * size);
        EXPECT_NEAR(lane(dP(i), l), dP_one(i), 1e-13 * size);
      }
    }
    EXPECT_FALSE(std::isfinite(lane(w, 3)));
    EXPECT_FALSE(std::isfinite(lane(P(0), 3)));
    EXPECT_FALSE(std::isfinite(lane(dP(0), 3)));
  }
}

TEST(Ogden, RefusesParametersByValue) {
  EXPECT_EQ(refusal({}, 1), "Ogden: at least one term (mu, alpha) is needed");
  EXPECT_EQ(refusal({{1, 2}, {1, 0}}, 1), "Ogden: alpha 0 of term 1 must be finite and not zero");
  EXPECT_EQ(
      refusal({{-3, 2}}, 5),
      "Ogden: shear modulus -3 Pa (half the sum of mu alpha) and bulk modulus 5 Pa must be positive and "
      "finite");
  EXPECT_NE(refusal({{3, 2}}, 0).find("bulk modulus 0 Pa"), std::string::npos);
  EXPECT_NE(refusal({{3, 2}}, std::nan("")).find("bulk modulus nan Pa"), std::string::npos);
  EXPECT_NE(refusal({{std::nan(""), 2}}, 1).find("shear modulus nan Pa"), std::string::npos);
  EXPECT_EQ(refusal({{3, 2}, {-0.5, 2}}, 5), "");  // a term may soften
  EXPECT_THROW((void)Ogden::from_young_poisson(10, 0.5), std::invalid_argument);
  EXPECT_THROW((void)Ogden::from_young_poisson(10, 0.3, 0), std::invalid_argument);
}

}  // namespace ogden_test
