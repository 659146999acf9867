// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/material/stretch_law.hpp"

#include "material/law_checks.hpp"

// Laws written by a user in principal stretches, beside the same law in invariants.

namespace stretch_law_test {

using namespace law_checks;
using softsim::Batch, softsim::Stretches, softsim::StVenantKirchhoff;

/// w = mu sum E_i^2 + lambda/2 (sum E_i)^2 with E = (l^2 - 1)/2: St. Venant-Kirchhoff, for stretches of any
/// sign.
struct StretchSvk : softsim::FromStretches<StretchSvk> {
  static constexpr bool extends_to_inversion = true;
  double lambda = 3, mu = 2;

  template <class T>
  Vec3<T> strain(const Stretches<T>& s) const {
    Vec3<T> E;
    for (int i = 0; i < 3; ++i) E[i] = T(0.5) * s.e[i] * (s.l[i] + T(1));
    return E;
  }
  template <class T>
  T density(const Stretches<T>& s) const {
    const Vec3<T> E = strain(s);
    const T t = E[0] + E[1] + E[2];
    return T(mu) * (E[0] * E[0] + E[1] * E[1] + E[2] * E[2]) + T(lambda / 2) * t * t;
  }
  template <class T>
  Vec3<T> first(const Stretches<T>& s) const {
    Vec3<T> E = strain(s);
    const T t = E[0] + E[1] + E[2];
    for (int i = 0; i < 3; ++i) E[i] = s.l[i] * (T(2 * mu) * E[i] + T(lambda) * t);
    return E;
  }
  template <class T>
  Mat3<T> second(const Stretches<T>& s) const {
    const Vec3<T> E = strain(s);
    const T t = E[0] + E[1] + E[2];
    Mat3<T> w;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) w(i, j) = T(lambda) * s.l[i] * s.l[j];
      w(i, i) += T(2 * mu) * (E[i] + s.l[i] * s.l[i]) + T(lambda) * t;
    }
    return w;
  }
};

/// w = mu sum (ln l_i)^2, for positive stretches only: not smooth at zero, unlike the law above.
struct Hencky : softsim::FromStretches<Hencky> {
  template <class T>
  Vec3<T> logarithms(const Stretches<T>& s) const {
    using std::log1p;
    return Vec3<T>(log1p(s.e[0]), log1p(s.e[1]), log1p(s.e[2]));
  }
  template <class T>
  T density(const Stretches<T>& s) const {
    const Vec3<T> x = logarithms(s);
    return x[0] * x[0] + x[1] * x[1] + x[2] * x[2];
  }
  template <class T>
  Vec3<T> first(const Stretches<T>& s) const {
    Vec3<T> x = logarithms(s);
    for (int i = 0; i < 3; ++i) x[i] *= T(2) / s.l[i];
    return x;
  }
  template <class T>
  Mat3<T> second(const Stretches<T>& s) const {
    const Vec3<T> x = logarithms(s);
    Mat3<T> w = Mat3<T>::Zero();
    for (int i = 0; i < 3; ++i) w(i, i) = T(2) * (T(1) - x[i]) / (s.l[i] * s.l[i]);
    return w;
  }
};

static_assert(softsim::StretchLaw<StretchSvk> && softsim::StretchLaw<Hencky, Batch<float, 8>>);
static_assert(!softsim::StretchLawWithQuotients<Hencky> && !softsim::StretchLaw<StVenantKirchhoff>);
static_assert(softsim::Material<StretchSvk> && softsim::Material<Hencky, Batch<double, 4>>);
static_assert(!softsim::InvariantLaw<StretchSvk>);

const StVenantKirchhoff svk = StVenantKirchhoff::from_lame(3, 2);

// Stretches that are equal, that cancel, or nearly so, on both sides of the distance where the quotients
// change their formula.
std::vector<Vec3<double>> near_coincidence() {
  std::vector<Vec3<double>> result{{0, 0, 0}, {1, 1, 1}, {1, 1, -1}, {2, 0, 0}, {1, 1, 0}};
  for (double d : {1e-15, 1e-12, 1e-9, 1e-6, 1e-4, 1e-3, 3e-3, 5e-3, 7e-3, 1e-2, 2e-2, 5e-2, 0.3}) {
    result.insert(result.end(), {{1.3, 1.3 - d, 0.6}, {1.3, 0.6, 0.6 - d}, {1.3, 0.6, -0.6 + d}});
    result.insert(result.end(), {{1 + d, 1, 1 - d}, {1, 1 - d, -1 + 3 * d}, {1, 2 * d, d}, {1, 2 * d, -d}});
  }
  return result;
}

TEST(StretchLaw, IsTheSameLawAsInInvariants) {
  const StretchSvk law;
  Random random(30);
  std::vector<Matrix> all;
  for (int n = 0; n < 100; ++n) all.push_back(random.any_sign(30).F);
  for (const Matrix& F : singular_deformations(random)) all.push_back(F);
  for (const Vec3<double>& s : near_coincidence()) all.push_back(random.from_stretches(s).F);
  for (const Matrix& F : all) {
    // Rounding of stresses as large as the stretches to the third power; for the tangent that rounding over
    // the distance 6e-3 at which the quotients change their formula.
    const double size = 10 * std::pow(1 + F.norm(), 4);
    EXPECT_NEAR(law.energy_density(F), svk.energy_density(F), 1e-14 * size);
    EXPECT_LE((law.first_piola(F) - svk.first_piola(F)).norm(), 1e-14 * size) << F;
    EXPECT_LE((tangent(law, F) - tangent(svk, F)).norm(), 1e-13 * size) << F;
    if (std::abs(F.determinant()) > 1e-2) {
      EXPECT_LE((law.second_piola(F) - svk.second_piola(F)).norm(), 1e-12 * size) << F;
    }
  }
}

TEST(StretchLaw, DerivativesAreConsistent) {
  Random random(31);
  for (int n = 0; n < 50; ++n) {
    expect_consistent_derivatives(Hencky(), random.regular(10).F, 1);
    expect_symmetric_and_linear(Hencky(), random.regular(10).F, 1, random);
  }
  for (const Vec3<double>& s : near_coincidence())
    if (s[2] > 0.3) expect_consistent_derivatives(Hencky(), random.from_stretches(s).F, 1);
}

// (ln a/a - ln b/b)/(a - b) in extended precision, where 1e-19 over the distance is enough down to 1e-5, and
// the mean of the derivative by Simpson's rule below.
TEST(StretchLaw, QuotientsKeepTheirDigitsAtEveryDistance) {
  const auto f = [](long double l) { return 2 * std::log(l) / l; };
  const auto df = [](long double l) { return 2 * (1 - std::log(l)) / (l * l); };
  double worst = 0;
  for (const double a : {0.2, 0.7, 1.0, 3.0})
    for (double d = 1e-16; d < 0.2; d *= 1.3) {
      const double b = a * (1 - d);
      const long double distance = static_cast<long double>(a) - b;
      const long double expected =
          d < 1e-5 ? (df(a) + df(b) + 4 * df(a - distance / 2)) / 6 : (f(a) - f(b)) / distance;
      const Matrix F = Vec3<double>(a, b, 10).asDiagonal();
      // stretches come sorted: 10, a, b
      const auto K = principal_tangent(Hencky(), F);
      const double error = K.flip[0] - static_cast<double>(expected);
      worst = std::max(worst, std::abs(error) / static_cast<double>(std::abs(df(b))));
    }
  EXPECT_LE(worst, 3e-13);
}

TEST(StretchLaw, KeepsTheDigitsOfSmallStrain) {
  Random random(32);
  for (const double strain : {0.1, 1e-4, 1e-7, 1e-10}) {
    const Matrix F = Matrix::Identity() + strain * softsim::symmetric_part(random.matrix());
    const Matrix H = F - Matrix::Identity(), E = 0.5 * (H + H.transpose() + H.transpose() * H);
    const double t = E.trace(), w = svk.mu() * E.squaredNorm() + svk.lambda() / 2 * t * t;
    // The principal axes are turned by the rounding of F over the strain, which counts quadratically.
    const double rounding = 1e-14 + 10 * std::pow(2.2e-16 / strain, 2);
    EXPECT_NEAR(StretchSvk().energy_density(F) / w, 1, rounding);
    if (strain < 1e-2) {
      // terms of third order
      EXPECT_NEAR(Hencky().energy_density(F) / H.squaredNorm(), 1, 3 * strain + rounding);
    }
  }
}

TEST(StretchLaw, BatchesAndSinglePrecisionAgreeWithDouble) {
  using B = Batch<float, 8>;
  Random random(33);
  for (int n = 0; n < 10; ++n) {
    Mat3<B> F, dF;
    std::array<Matrix, 8> Fs, dFs;
    for (int l = 0; l < 8; ++l) {
      const auto k = static_cast<std::size_t>(l);
      Fs[k] = random.regular(3).F.cast<float>().cast<double>();
      dFs[k] = random.matrix().cast<float>().cast<double>();
      for (int i = 0; i < 9; ++i) {
        softsim::set_lane(F(i), l, static_cast<float>(Fs[k](i)));
        softsim::set_lane(dF(i), l, static_cast<float>(dFs[k](i)));
      }
    }
    const Mat3<B> P = StretchSvk().first_piola(F), dP = StretchSvk().first_piola_differential(F, dF);
    for (int l = 0; l < 8; ++l) {
      const auto k = static_cast<std::size_t>(l);
      const Matrix P_exact = svk.first_piola(Fs[k]), dP_exact = svk.first_piola_differential(Fs[k], dFs[k]);
      for (int i = 0; i < 9; ++i) {
        EXPECT_NEAR(static_cast<double>(lane(P(i), l)), P_exact(i), 1e-5 * tangent(svk, Fs[k]).norm());
        EXPECT_NEAR(static_cast<double>(lane(dP(i), l)), dP_exact(i), 1e-5 * tangent(svk, Fs[k]).norm());
      }
    }
  }
}

}  // namespace stretch_law_test
