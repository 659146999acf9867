// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <stdexcept>

#include "material/any_law.hpp"
#include "material/tetrahedron_reference_more.hpp"
#include "softsim/material/continued.hpp"
#include "softsim/material/fung.hpp"
#include "softsim/material/mooney_rivlin.hpp"
#include "softsim/material/volume_law.hpp"

// Laws continued below a threshold J0, through J = 0 and over inverted deformations.

namespace continued_laws_test {

using namespace law_checks;
using softsim::Continued;
using softsim::Coupled;
using softsim::CoupledMooneyRivlin;
using softsim::Fung;
using softsim::Isochoric;
using softsim::MooneyRivlin;
using softsim::NeoHookean;
using softsim::SimoTaylorVolume;
using softsim::TwoTermVolume;

// A product of I1 and J in a law that does not come apart.
struct Inseparable : softsim::Isotropic<Inseparable> {
  static constexpr bool depends_on_i2 = false;
  template <class T>
  T density(const Invariants<T>& i) const {
    return i.k1 * i.kj;
  }
  template <class T>
  First<T> first(const Invariants<T>& i) const {
    return {i.kj, T(0), i.k1};
  }
  template <class T>
  Second<T> second(const Invariants<T>&) const {
    return {T(0), T(0), T(0), T(1), T(0), T(0)};
  }
};

template <class Law>
concept Continuable = requires {
  typename Continued<Law>;
};
static_assert(Continuable<NeoHookean> && Continuable<softsim::StableNeoHookean> &&
              Continuable<MooneyRivlin> && Continuable<CoupledMooneyRivlin> && Continuable<Fung>);
static_assert(!Continuable<softsim::StVenantKirchhoff> && !Continuable<softsim::LinearElastic> &&
              !Continuable<Inseparable> && !Continuable<int>);
static_assert(!softsim::SeparableLaw<MooneyRivlin> && !softsim::LawOfExtensibleVolume<NeoHookean>);
static_assert(softsim::InvariantLaw<Continued<NeoHookean>, Batch<float, 8>> &&
              softsim::Material<Continued<MooneyRivlin>, Batch<double, 8>> &&
              softsim::Material<Continued<MooneyRivlin>, float>);

struct Pair {
  AnyLaw law;  // continued
  LawOn<double> original;
  double j0;

  template <class Law, class... Tag>
  Pair(const char* name, const Law& l, double threshold, Tag... tag)
      : law(name, Continued(l, threshold), tag...), original(l), j0(threshold) {}
};

const std::vector<Pair>& pairs() {
  static const std::vector<Pair> all{
      {"NeoHookean", NeoHookean::from_young_poisson(3, 0.3), 0.4, InAllScalars{}},
      {"MooneyRivlin", MooneyRivlin::from_young_poisson(3, 0.3, 0.25), 0.4, InAllScalars{}},
      {"Fung", Fung::from_young_poisson(3, 0.3, 0.02), 0.6},
      {"full energy, Simo-Taylor", Isochoric(FullEnergy{}, SimoTaylorVolume(3)), 0.5},
      {"full energy, coupled, two terms", Coupled(FullEnergy{}, TwoTermVolume(0.5, 0.3)), 0.3}};
  return all;
}

Matrix diagonal(double a, double b, double c) { return Vec3<double>(a, b, c).asDiagonal(); }

// The size of the terms that cancel in energy and stress; below J0 it exceeds the moduli by far.
double stiffness(const AnyLaw& law, const Matrix& F) { return tangent(law, F).norm(); }

TEST(ContinuedLaws, DerivativesHoldForDeterminantsBetweenMinusOneAndThree) {
  Random random(71);
  for (const Pair& pair : pairs()) {
    SCOPED_TRACE(pair.law.name);
    for (int n = 0; n < 40; ++n) {
      const Matrix F = with_determinant(random, -1, 3);
      const double size = stiffness(pair.law, F);
      expect_consistent_invariant_derivatives(pair.law, invariants_of(F));
      expect_consistent_derivatives(pair.law, F, 0.1 * size);
      expect_symmetric_and_linear(pair.law, F, size, random);
    }
    for (const Matrix& F : singular_deformations(random))
      expect_consistent_derivatives(pair.law, F, 0.1 * stiffness(pair.law, F));
  }
}

TEST(ContinuedLaws, AreIsotropicAndObjectiveOverInvertedDeformations) {
  Random random(72);
  for (const Pair& pair : pairs()) {
    SCOPED_TRACE(pair.law.name);
    for (int n = 0; n < 20; ++n) {
      const double J = random.uniform(-1, 3);
      expect_isotropic_and_objective(pair.law, with_determinant(random, J, J), random);
    }
  }
}

TEST(ContinuedLaws, NothingChangesAboveTheThreshold) {
  Random random(73);
  for (const Pair& pair : pairs()) {
    SCOPED_TRACE(pair.law.name);
    for (int n = 0; n < 20; ++n) {
      const Matrix F = with_determinant(random, pair.j0 + 1e-3, 3), D = random.matrix();
      // the same operations, which the compiler may fuse in another way
      const double rounding = 1e-14 * (1 + F.norm()) * stiffness(pair.law, F);
      const Matrix dP = pair.original.first_piola_differential(F, D);
      EXPECT_NEAR(pair.law.energy_density(F), pair.original.energy_density(F), rounding);
      EXPECT_LE((pair.law.first_piola(F) - pair.original.first_piola(F)).norm(), rounding);
      EXPECT_LE((pair.law.first_piola_differential(F, D) - dP).norm(), 10 * rounding);
    }
  }
}

// A step of 1e-8 across J0 changes each by about 1e-8 of its derivative, a hundred times its size at most.
// One derivative too few in the continuation makes dP jump by a third of itself and more.
TEST(ContinuedLaws, EnergyStressAndDifferentialAreContinuousAcrossTheThreshold) {
  Random random(74);
  for (const Pair& pair : pairs()) {
    SCOPED_TRACE(pair.law.name);
    for (int n = 0; n < 20; ++n) {
      const Matrix F = with_determinant(random, pair.j0, pair.j0);
      const Matrix above = std::cbrt(1 + 1e-8) * F, below = std::cbrt(1 - 1e-8) * F;
      ASSERT_GT(above.determinant(), pair.j0);
      ASSERT_LT(below.determinant(), pair.j0);
      const double size = stiffness(pair.law, F);
      EXPECT_NEAR(pair.law.energy_density(above), pair.law.energy_density(below), 1e-6 * size);
      EXPECT_LE((pair.law.first_piola(above) - pair.law.first_piola(below)).norm(), 1e-6 * size);
      EXPECT_LE((tangent(pair.law, above) - tangent(pair.law, below)).norm(), 1e-6 * size);
    }
  }
}

TEST(ContinuedLaws, AreFiniteOnEveryLaneForEveryDeterminant) {
  Random random(75);
  for (const Pair& pair : pairs()) {
    SCOPED_TRACE(pair.law.name);
    for (int n = 0; n < 5; ++n) {
      std::array<Matrix, 8> F;
      for (Matrix& f : F) f = with_determinant(random, -1, 3);
      F[static_cast<std::size_t>(n)] = n < 2 ? Matrix(n * diagonal(1, 1, 0)) : diagonal(0.5, 2, -1e-9);
      for (const Matrix& f : F) {
        EXPECT_TRUE(std::isfinite(pair.law.energy_density(f)) && pair.law.first_piola(f).allFinite());
        EXPECT_TRUE(tangent(pair.law, f).allFinite());
      }
      if (!pair.law.in_batch) continue;
      const Matrix D = random.matrix();
      expect_lanes_as_scalars(pair.law, *pair.law.in_batch, F, D, 1e-14);
      expect_lanes_as_scalars(pair.law, *pair.law.in_float, F, D, 1e-5);
    }
    Matrix broken = Matrix::Identity();
    broken(1, 2) = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(std::isfinite(pair.law.energy_density(broken)));  // a NaN stays one
  }
}

// A block pushed through itself: the force has no jump, nor has its slope, and it always pushes back. With a
// kink in the force a second difference would be as large as the first ones; smooth, it is a few steps per
// J0.
TEST(ContinuedLaws, ForceIsSmoothThroughInversionAndPushesBack) {
  constexpr double step = 0.01;
  for (const Pair& pair : pairs()) {
    SCOPED_TRACE(pair.law.name);
    const auto force = [&](double J) { return pair.law.first_piola(diagonal(1, 1, J))(2, 2); };
    for (int n = 1; n < 200; ++n) {
      const double J = 1 - step * n, before = force(J + step), now = force(J), after = force(J - step);
      EXPECT_LE(std::abs(after - 2 * now + before), 0.15 * std::abs(after - before)) << "J " << J;
      EXPECT_LT(now, before) << "J " << J;
      EXPECT_LT(now, 0) << "J " << J;
    }
  }
  const Continued law(NeoHookean::from_young_poisson(10, 0.3));
  const auto force = [&](double J) { return law.first_piola(diagonal(1, 1, J))(2, 2); };
  for (int n = 0; n < 200; ++n)
    EXPECT_LT(force(1 - step * n) - force(1 - step * (n + 1)), 3 * (force(1) - force(-1)) / 200);
}

// b' = (lambda ln J - mu)/J and its tangent at J0.
TEST(ContinuedNeoHookean, FollowsTheTangentBelowTheThreshold) {
  const double lambda = 400, mu = 300;
  for (const double j0 : {0.2, 0.4, 0.9}) {
    const Continued law(NeoHookean::from_lame(lambda, mu), j0);
    const double slope = (lambda - lambda * std::log(j0) + mu) / (j0 * j0);
    const double at_zero = (2 * lambda * std::log(j0) - lambda - 2 * mu) / j0;
    for (const double J : {0.99 * j0, 0.1, 0.0, -0.5, -2.0}) {
      const Invariants<double> i{3.5, 4, J};
      EXPECT_NEAR(law.first(i).wj, slope * J + at_zero, 1e-12 * slope);
      EXPECT_NEAR(law.second(i).wjj, slope, 1e-12 * slope);
      EXPECT_EQ(law.first(i).w1, 150);
    }
  }
  EXPECT_EQ(Continued(NeoHookean::from_lame(lambda, mu)).threshold(), 0.4);
}

TEST(ContinuedNeoHookean, SingleTetrahedraAgreeWithFiftyDigits) {
  namespace reference = tetrahedron_reference;
  const Continued law(NeoHookean::from_lame(reference::lambda, reference::mu));
  for (std::size_t n = 0; n < reference::cases.size(); ++n)
    reference::expect_tetrahedron(law, reference::cases[n], reference::continued_neo_hookean[n]);
}

// w1 = C1 p and w2 = C2 q, with p and q the Taylor polynomials of J^-2/3 and J^-4/3 at J0.
TEST(ContinuedMooneyRivlin, FollowsTheParabolasBelowTheThreshold) {
  const double j0 = 0.5;
  const Continued law(MooneyRivlin(2, 3, 10), j0);
  for (const double J : {0.4, 0.0, -1.5}) {
    const double x = J / j0 - 1, p = std::pow(j0, -2.0 / 3), q = p * p;
    const Invariants<double> i{3.5, 4, J};
    EXPECT_NEAR(law.first(i).w1, 2 * p * (1 - 2. / 3 * x + 5. / 9 * x * x), 1e-12);
    EXPECT_NEAR(law.first(i).w2, 3 * q * (1 - 4. / 3 * x + 14. / 9 * x * x), 1e-12);
    EXPECT_NEAR(law.second(i).w1j, 2 * p / j0 * (-2. / 3 + 10. / 9 * x), 1e-12);
    EXPECT_NEAR(law.second(i).w2j, 3 * q / j0 * (-4. / 3 + 28. / 9 * x), 1e-12);
    EXPECT_NEAR(law.second(i).wjj, 2 * 3.5 * p / (j0 * j0) * 10 / 9 + 3 * 4 * q / (j0 * j0) * 28 / 9 + 10,
                1e-11);
  }
}

TEST(ContinuedLaws, ThresholdLiesBetweenZeroAndOne) {
  const auto law = NeoHookean::from_young_poisson(10, 0.3);
  for (const double j0 : {0.0, 1.0, -0.1, 1.5, std::numeric_limits<double>::quiet_NaN()}) try {
      (void)Continued(law, j0);
      ADD_FAILURE() << "accepted " << j0;
    } catch (const std::invalid_argument& e) {
      const std::string message = e.what();
      EXPECT_NE(message.find("J0 " + softsim::to_text(j0)), std::string::npos) << message;
      EXPECT_NE(message.find("(0, 1)"), std::string::npos) << message;
    }
}

}  // namespace continued_laws_test
