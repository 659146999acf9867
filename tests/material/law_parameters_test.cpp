// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <limits>
#include <stdexcept>

#include "material/law_checks.hpp"
#include "softsim/core/batch.hpp"

// What a law has to be and what its parameters may be.

namespace law_parameters_test {

using namespace law_checks;
using softsim::Batch;
using softsim::First;
using softsim::InvariantLaw;
using softsim::Invariants;
using softsim::Isotropic;
using softsim::LinearElastic;
using softsim::Material;
using softsim::NeoHookean;
using softsim::Second;
using softsim::StableNeoHookean;
using softsim::StVenantKirchhoff;

// ---------------------------------------------------------------- concepts

template <class Law, class... T>
inline constexpr bool is_material = (Material<Law, T> && ...);
template <class Law, class... T>
inline constexpr bool is_invariant_law = (InvariantLaw<Law, T> && ...);
template <class Law>
inline constexpr bool material_everywhere =
    is_material<Law, float, double, Batch<float, 4>, Batch<float, 8>, Batch<float, 16>, Batch<double, 2>,
                Batch<double, 4>, Batch<double, 8>>;
template <class Law>
inline constexpr bool invariant_law_everywhere =
    is_invariant_law<Law, float, double, Batch<float, 4>, Batch<float, 8>, Batch<float, 16>, Batch<double, 2>,
                     Batch<double, 4>, Batch<double, 8>>;

static_assert(material_everywhere<StVenantKirchhoff> && invariant_law_everywhere<StVenantKirchhoff>);
static_assert(material_everywhere<NeoHookean> && invariant_law_everywhere<NeoHookean>);
static_assert(material_everywhere<StableNeoHookean> && invariant_law_everywhere<StableNeoHookean>);
static_assert(material_everywhere<LinearElastic>);
static_assert(!InvariantLaw<LinearElastic, double> && !InvariantLaw<LinearElastic, float>);
static_assert(!Material<int> && !InvariantLaw<int> && !Material<softsim::Lame>);

struct WithoutDifferential {
  template <class T>
  T energy_density(const Mat3<T>& F) const {
    return softsim::trace(F);
  }
  template <class T>
  Mat3<T> first_piola(const Mat3<T>&) const {
    return Mat3<T>::Identity();
  }
};
static_assert(!Material<WithoutDifferential>);

struct WithDifferential : WithoutDifferential {
  template <class T>
  Mat3<T> first_piola_differential(const Mat3<T>&, const Mat3<T>&) const {
    return Mat3<T>::Zero();
  }
};
static_assert(Material<WithDifferential>);

struct WithStressOfAScalar : WithDifferential {
  template <class T>
  T first_piola(const Mat3<T>& F) const {
    return softsim::trace(F);
  }
};
static_assert(!Material<WithStressOfAScalar>);

struct Sound : Isotropic<Sound> {
  template <class T>
  T density(const Invariants<T>& i) const {
    return i.j - T(1);
  }
  template <class T>
  First<T> first(const Invariants<T>&) const {
    return {T(0), T(0), T(1)};
  }
  template <class T>
  Second<T> second(const Invariants<T>&) const {
    return {};
  }
};
static_assert(InvariantLaw<Sound> && Material<Sound>);

struct FirstOfWrongType : Sound {
  template <class T>
  Second<T> first(const Invariants<T>&) const {
    return {};
  }
};
static_assert(!InvariantLaw<FirstOfWrongType>);

struct FirstOfWrongScalar : Sound {
  template <class T>
  First<double> first(const Invariants<T>&) const {
    return {0, 0, 1};
  }
};
static_assert(InvariantLaw<FirstOfWrongScalar, double>);
static_assert(!InvariantLaw<FirstOfWrongScalar, float> &&
              !InvariantLaw<FirstOfWrongScalar, Batch<double, 4>>);

struct WithoutFlags {
  template <class T>
  T density(const Invariants<T>& i) const {
    return i.j - T(1);
  }
  template <class T>
  First<T> first(const Invariants<T>&) const {
    return {T(0), T(0), T(1)};
  }
  template <class T>
  Second<T> second(const Invariants<T>&) const {
    return {};
  }
};
static_assert(!InvariantLaw<WithoutFlags> && !Material<WithoutFlags>);

// ---------------------------------------------------------------- parameters

template <class Law>
class LawParameters : public ::testing::Test {};
TYPED_TEST_SUITE(LawParameters, AllLaws, LawName);

TYPED_TEST(LawParameters, YoungAndPoissonComeBackFromLame) {
  for (const double young : {1e-3, 10.0, 2.1e11})
    for (const double poisson : {-0.99, -0.3, 0.0, 0.3, 0.499}) {
      const auto law = TypeParam::from_young_poisson(young, poisson);
      const double l = law.lambda(), m = law.mu();
      // at -0.99 and 0.499 one modulus is 500 and the other 1/3 of Young's: a few hundred eps
      EXPECT_NEAR(m * (3 * l + 2 * m) / (l + m), young, 1e-12 * young) << poisson;
      EXPECT_NEAR(l / (2 * (l + m)), poisson, 1e-12) << young;

      const auto same = TypeParam::from_lame(l, m);
      EXPECT_EQ(same.lambda(), l);
      EXPECT_EQ(same.mu(), m);
    }
}

TYPED_TEST(LawParameters, LameParametersAreKeptAsGiven) {
  const auto law = TypeParam::from_lame(5.5, 2.25);
  EXPECT_EQ(law.lambda(), 5.5);
  EXPECT_EQ(law.mu(), 2.25);
  // lambda may be negative as long as the bulk modulus is positive: lambda > -2/3 mu
  EXPECT_EQ(TypeParam::from_lame(-1.49, 2.25).lambda(), -1.49);
  EXPECT_EQ(TypeParam::from_lame(0, 2.25).lambda(), 0);
}

// `make` throws std::invalid_argument, and the message has every word of `words` in it.
template <class Make>
void expect_refused(Make make, std::initializer_list<std::string> words) {
  try {
    make();
    ADD_FAILURE() << "accepted " << *words.begin();
  } catch (const std::invalid_argument& e) {
    const std::string message = e.what();
    for (const std::string& word : words)
      EXPECT_NE(message.find(word), std::string::npos) << '"' << message << "\" lacks \"" << word << '"';
  }
}

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

TYPED_TEST(LawParameters, RefusesAYoungsModulusThatIsNotPositiveAndFinite) {
  struct Row {
    double value;
    const char* text;
  };
  for (const Row& row : {Row{0, "0"}, {-2.5, "-2.5"}, {nan, "nan"}, {infinity, "inf"}, {-infinity, "-inf"}})
    expect_refused([&] { (void)TypeParam::from_young_poisson(row.value, 0.3); }, {"young", row.text});
}

TYPED_TEST(LawParameters, RefusesAPoissonsRatioOutsideItsRange) {
  struct Row {
    double value;
    const char* text;
  };
  for (const Row& row : {Row{0.5, "0.5"},
                         {0.6, "0.6"},
                         {-1, "-1"},
                         {-1.5, "-1.5"},
                         {nan, "nan"},
                         {infinity, "inf"},
                         {-infinity, "-inf"}})
    expect_refused([&] { (void)TypeParam::from_young_poisson(10, row.value); }, {"poisson_ratio", row.text});
}

TYPED_TEST(LawParameters, RefusesAShearModulusThatIsNotPositiveAndFinite) {
  struct Row {
    double value;
    const char* text;
  };
  for (const Row& row : {Row{0, "0"}, {-2.5, "-2.5"}, {nan, "nan"}, {infinity, "inf"}, {-infinity, "-inf"}})
    expect_refused([&] { (void)TypeParam::from_lame(4, row.value); }, {"mu", row.text});
}

TYPED_TEST(LawParameters, RefusesABulkModulusThatIsNotPositiveAndFinite) {
  struct Row {
    double lambda;
    const char *text, *bulk;
  };
  for (const Row& row : {Row{-2, "lambda -2 ", "= 0 "},
                         {-3.5, "lambda -3.5 ", "= -1.5 "},
                         {nan, "lambda ", "nan"},
                         {infinity, "lambda inf ", "= inf "},
                         {-infinity, "lambda -inf ", "= -inf "}})
    expect_refused([&] { (void)TypeParam::from_lame(row.lambda, 3); }, {"bulk modulus", row.text, row.bulk});
}

}  // namespace law_parameters_test
