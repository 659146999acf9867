// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "material/law_checks.hpp"
#include "softsim/material/isotropic.hpp"

// Laws that a user writes: none of the library's has a full set of second derivatives, these have.

namespace own_law_test {

using namespace law_checks;
using softsim::First;
using softsim::Invariants;
using softsim::Isotropic;
using softsim::Second;

// Every first and second derivative depends on the invariants and differs from the others; no physics is
// meant. w = a (I1 I2 J - 9) + b (I1 - 3)^3 + c (I2 - 3)^2 I1 + d (J - 1)^2 I2 - 27 a (J - 1); the last term
// takes the stress from rest.
struct Coupled : Isotropic<Coupled> {
  static constexpr double a = 0.1, b = 0.3, c = 0.2, d = 2;

  template <class T>
  T density(const Invariants<T>& i) const {
    const T x = i.i1 - T(3), y = i.i2 - T(3), z = i.j - T(1);
    return T(a) * (i.i1 * i.i2 * i.j - T(9)) + T(b) * x * x * x + T(c) * y * y * i.i1 + T(d) * z * z * i.i2 -
           T(27 * a) * z;
  }
  template <class T>
  First<T> first(const Invariants<T>& i) const {
    const T x = i.i1 - T(3), y = i.i2 - T(3), z = i.j - T(1);
    return {T(a) * i.i2 * i.j + T(3 * b) * x * x + T(c) * y * y,
            T(a) * i.i1 * i.j + T(2 * c) * y * i.i1 + T(d) * z * z,
            T(a) * i.i1 * i.i2 + T(2 * d) * z * i.i2 - T(27 * a)};
  }
  template <class T>
  Second<T> second(const Invariants<T>& i) const {
    const T x = i.i1 - T(3), y = i.i2 - T(3), z = i.j - T(1);
    return {T(6 * b) * x, T(a) * i.j + T(2 * c) * y,  T(2 * c) * i.i1,
            T(a) * i.i2,  T(a) * i.i1 + T(2 * d) * z, T(2 * d) * i.i2};
  }
};

// Yeoh's series in I1 with a volume term and a product of both: no I2.
struct Yeoh : Isotropic<Yeoh> {
  static constexpr bool depends_on_i2 = false;
  static constexpr double c1 = 1, c2 = 0.4, c3 = 0.2, e = 0.3, k = 5;

  template <class T>
  T density(const Invariants<T>& i) const {
    const T x = i.i1 - T(3), z = i.j - T(1);
    return ((T(c3) * x + T(c2)) * x + T(c1)) * x + T(e) * x * x * z + T(k / 2) * z * z - T(2 * c1) * z;
  }
  template <class T>
  First<T> first(const Invariants<T>& i) const {
    const T x = i.i1 - T(3), z = i.j - T(1);
    return {(T(3 * c3) * x + T(2 * c2)) * x + T(c1) + T(2 * e) * x * z, T(0),
            T(e) * x * x + T(k) * z - T(2 * c1)};
  }
  template <class T>
  Second<T> second(const Invariants<T>& i) const {
    const T x = i.i1 - T(3), z = i.j - T(1);
    return {T(6 * c3) * x + T(2 * c2) + T(2 * e) * z, T(0), T(0), T(2 * e) * x, T(0), T(k)};
  }
};

// I1 alone.
struct SquareOfI1 : Isotropic<SquareOfI1> {
  static constexpr bool depends_on_i2 = false, depends_on_j = false;

  template <class T>
  T density(const Invariants<T>& i) const {
    return (i.i1 - T(3)) * (i.i1 - T(3));
  }
  template <class T>
  First<T> first(const Invariants<T>& i) const {
    return {T(2) * (i.i1 - T(3)), T(0), T(0)};
  }
  template <class T>
  Second<T> second(const Invariants<T>&) const {
    return {T(2), T(0), T(0), T(0), T(0), T(0)};
  }
};

// I1 and I2 without J, all three second derivatives.
struct WithoutJ : Isotropic<WithoutJ> {
  static constexpr bool depends_on_j = false;

  template <class T>
  T density(const Invariants<T>& i) const {
    const T x = i.i1 - T(3), y = i.i2 - T(3);
    return x * x + T(0.3) * x * y + T(0.1) * y * y;
  }
  template <class T>
  First<T> first(const Invariants<T>& i) const {
    const T x = i.i1 - T(3), y = i.i2 - T(3);
    return {T(2) * x + T(0.3) * y, T(0.3) * x + T(0.2) * y, T(0)};
  }
  template <class T>
  Second<T> second(const Invariants<T>&) const {
    return {T(2), T(0.3), T(0.2), T(0), T(0), T(0)};
  }
};

// A law of the library with all of its flags taken back.
template <class Law>
struct WithoutFlags : Isotropic<WithoutFlags<Law>> {
  Law law;

  explicit WithoutFlags(const Law& l) : law(l) {}
  template <class T>
  T density(const Invariants<T>& i) const {
    return law.density(i);
  }
  template <class T>
  First<T> first(const Invariants<T>& i) const {
    return law.first(i);
  }
  template <class T>
  Second<T> second(const Invariants<T>& i) const {
    return law.second(i);
  }
};

template <class Law>
class OwnLaw : public ::testing::Test {};
struct OwnLawName {
  template <class Law>
  static std::string GetName(int) {
    if (std::is_same_v<Law, Coupled>) return "Coupled";
    if (std::is_same_v<Law, Yeoh>) return "Yeoh";
    return std::is_same_v<Law, SquareOfI1> ? "SquareOfI1" : "WithoutJ";
  }
};
using OwnLaws = ::testing::Types<Coupled, Yeoh, SquareOfI1, WithoutJ>;
TYPED_TEST_SUITE(OwnLaw, OwnLaws, OwnLawName);

// about one Pa at rest
constexpr double modulus = 1;

TYPED_TEST(OwnLaw, IsAnInvariantLawAndAMaterial) {
  static_assert(softsim::InvariantLaw<TypeParam> && softsim::Material<TypeParam>);
  const TypeParam law;
  EXPECT_NEAR(law.energy_density(Matrix::Identity()), 0, 1e-15);
  EXPECT_LE(law.first_piola(Matrix::Identity()).norm(), 1e-14);
}

TYPED_TEST(OwnLaw, DerivativesHoldForEveryDeformation) {
  Random random(41);
  const TypeParam law;
  for (int n = 0; n < 200; ++n) {
    const Matrix F = n % 2 == 0 ? random.regular(30).F : random.any_sign(30).F;
    expect_consistent_derivatives(law, F, modulus);
    expect_symmetric_and_linear(law, F, modulus, random);
  }
  for (const Matrix& F : singular_deformations(random)) expect_consistent_derivatives(law, F, modulus);
}

TYPED_TEST(OwnLaw, IsIndifferentToRotations) {
  Random random(42);
  const TypeParam law;
  for (int n = 0; n < 100; ++n) {
    const Matrix F = random.any_sign(5).F, Q = random.rotation(), QF = Q * F, P = law.first_piola(F);
    const double psi = law.energy_density(F);
    EXPECT_NEAR(law.energy_density(QF), psi, 1e-11 * std::max(std::abs(psi), modulus));
    EXPECT_LE((law.first_piola(QF) - Q * P).norm(), 1e-11 * std::max(P.norm(), modulus));
  }
}

TYPED_TEST(OwnLaw, SecondPiolaIsThePullBackOfTheFirst) {
  Random random(43);
  const TypeParam law;
  for (int n = 0; n < 100; ++n) {
    const Matrix F = random.any_sign(5).F, P = law.first_piola(F), S = law.second_piola(F);
    EXPECT_LE((F * S - P).norm(), 1e-11 * std::max(P.norm(), modulus));
    EXPECT_LE((S - S.transpose()).norm(), 1e-11 * std::max(P.norm(), modulus));
  }
}

// One value of the stress that no code of the library takes part in: F = diag(2, 1, 1) has I1 = 6, I2 = 9, J
// = 2.
TEST(CoupledLaw, StressOfAStretchBlock) {
  const Coupled law;
  const Matrix F = Vec3<double>(2, 1, 1).asDiagonal();
  const double w1 = 0.1 * 18 + 0.9 * 9 + 0.2 * 36, w2 = 0.1 * 12 + 0.4 * 6 * 6 + 2,
               wj = 0.1 * 54 + 4 * 9 - 2.7;
  // dI1/dF = 2 F, dI2/dF = 2 (I1 F - F C), dJ/dF = cof F, along the first and the second axis
  const double axial = 4 * w1 + 2 * (12 - 8) * w2 + wj, lateral = 2 * w1 + 2 * (6 - 1) * w2 + 2 * wj;
  const Matrix expected = Vec3<double>(axial, lateral, lateral).asDiagonal();
  EXPECT_LE((law.first_piola(F) - expected).norm(), 1e-13 * expected.norm());
}

template <class Law>
class Flags : public ::testing::Test {};
TYPED_TEST_SUITE(Flags, ObjectiveLaws, LawName);

TYPED_TEST(Flags, OnlyDropWhatIsZero) {
  Random random(44);
  const auto law = TypeParam::from_young_poisson(10, 0.3);
  const WithoutFlags<TypeParam> full(law);
  for (int n = 0; n < 100; ++n) {
    const Matrix F = random.regular(5).F, dF = random.matrix();
    const Matrix P = law.first_piola(F), dP = law.first_piola_differential(F, dF);
    const Matrix S = law.second_piola(F);
    EXPECT_NEAR(full.energy_density(F), law.energy_density(F), 1e-12 * std::max(law.energy_density(F), 10.0));
    EXPECT_LE((full.first_piola(F) - P).norm(), 1e-12 * std::max(P.norm(), 10.0));
    EXPECT_LE((full.second_piola(F) - S).norm(), 1e-12 * std::max(S.norm(), 10.0));
    EXPECT_LE((full.first_piola_differential(F, dF) - dP).norm(), 1e-12 * std::max(dP.norm(), 10.0));
  }
}

}  // namespace own_law_test
