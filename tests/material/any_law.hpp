// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "material/law_checks.hpp"
#include "softsim/core/batch.hpp"

/// Laws in one list: the checks compile once instead of once per law.
namespace law_checks {

using softsim::Batch;
using softsim::First;
using softsim::Invariants;
using softsim::Second;

/// All second derivatives differ from zero and from each other: W = x + y/2 + x^2/5 + 3/10 x y + y^2/10 with
/// x = I1 - 3, y = I2 - 3. An energy for `Isochoric` and `Coupled`; no physics is meant.
struct FullEnergy {
  static constexpr bool depends_on_i2 = true, depends_on_j = false, linear_in_i1 = false;

  template <class T>
  T density(const Invariants<T>& i) const {
    return i.k1 + T(0.5) * i.k2 + T(0.2) * i.k1 * i.k1 + T(0.3) * i.k1 * i.k2 + T(0.1) * i.k2 * i.k2;
  }
  template <class T>
  First<T> first(const Invariants<T>& i) const {
    return {T(1) + T(0.4) * i.k1 + T(0.3) * i.k2, T(0.5) + T(0.3) * i.k1 + T(0.2) * i.k2, T(0)};
  }
  template <class T>
  Second<T> second(const Invariants<T>&) const {
    return {T(0.4), T(0.3), T(0.2), T(0), T(0), T(0)};
  }
};

/// The functions of one law on scalars of type T.
template <class T>
struct LawOn {
  std::function<T(const Mat3<T>&)> energy_density;
  std::function<Mat3<T>(const Mat3<T>&)> first_piola;
  std::function<Mat3<T>(const Mat3<T>&, const Mat3<T>&)> first_piola_differential;

  template <class Law>
  explicit LawOn(const Law& law)
      : energy_density([law](const Mat3<T>& F) -> T { return law.energy_density(F); }),
        first_piola([law](const Mat3<T>& F) -> Mat3<T> { return law.first_piola(F); }),
        first_piola_differential([law](const Mat3<T>& F, const Mat3<T>& dF) -> Mat3<T> {
          return law.first_piola_differential(F, dF);
        }) {}
};

/// Asks for a law in float and in batches too; that takes a second to compile.
struct InAllScalars {};

/// One law with a name; parameters of about 1 Pa.
struct AnyLaw : LawOn<double> {
  std::string name;
  double lambda, mu;
  std::function<Matrix(const Matrix&)> second_piola;
  std::function<double(const Invariants<double>&)> density;
  std::function<First<double>(const Invariants<double>&)> first;
  std::function<Second<double>(const Invariants<double>&)> second;
  std::optional<LawOn<float>> in_float;
  std::optional<LawOn<Batch<double, 8>>> in_batch;

  template <class Law>
  AnyLaw(std::string n, const Law& law)
      : LawOn<double>(law),
        name(std::move(n)),
        lambda(law.lambda()),
        mu(law.mu()),
        second_piola([law](const Matrix& F) -> Matrix { return law.second_piola(F); }),
        density([law](const Invariants<double>& i) { return law.density(i); }),
        first([law](const Invariants<double>& i) { return law.first(i); }),
        second([law](const Invariants<double>& i) { return law.second(i); }) {}
  template <class Law>
  AnyLaw(std::string n, const Law& law, InAllScalars) : AnyLaw(std::move(n), law) {
    in_float.emplace(law);
    in_batch.emplace(law);
  }
};

/// Moderate F, whose determinant lies in [low, high].
inline Matrix with_determinant(Random& random, double low, double high) {
  const double a = std::exp(random.uniform(-0.7, 0.7)), b = std::exp(random.uniform(-0.7, 0.7));
  return random.from_stretches({a, b, random.uniform(low, high) / (a * b)}).F;
}

/// I1, I2 and J of F.
inline Invariants<double> invariants_of(const Matrix& F) {
  const double i1 = F.squaredNorm();
  return {i1, 0.5 * (i1 * i1 - (F.transpose() * F).squaredNorm()), F.determinant()};
}

/// `first` against central differences of `density` in I1, I2, J and `second` against those of `first`. Step
/// and tolerance as in `expect_consistent_derivatives`; 1e-6 for J near 0.3, where the fifth power of 1/J
/// enters the error of truncation.
inline void expect_consistent_invariant_derivatives(const AnyLaw& law, const Invariants<double>& i) {
  constexpr double h = 6e-6, tolerance = 1e-6;
  const First<double> w = law.first(i);
  const Second<double> s = law.second(i);
  const Eigen::Vector3d slopes(w.w1, w.w2, w.wj);
  Matrix curvatures;
  curvatures << s.w11, s.w12, s.w1j, s.w12, s.w22, s.w2j, s.w1j, s.w2j, s.wjj;
  Eigen::Vector3d slopes_difference;
  Matrix curvatures_difference;
  for (int k = 0; k < 3; ++k) {
    const auto moved = [&](double d) {
      return Invariants<double>{i.i1 + (k == 0) * d, i.i2 + (k == 1) * d, i.j + (k == 2) * d};
    };
    const First<double> a = law.first(moved(h)), b = law.first(moved(-h));
    slopes_difference[k] = (law.density(moved(h)) - law.density(moved(-h))) / (2 * h);
    curvatures_difference.col(k) = Eigen::Vector3d(a.w1 - b.w1, a.w2 - b.w2, a.wj - b.wj) / (2 * h);
  }
  EXPECT_LE((slopes - slopes_difference).norm(), tolerance * (law.mu + slopes.norm())) << "J " << i.j;
  EXPECT_LE((curvatures - curvatures_difference).norm(), tolerance * (law.mu + curvatures.norm()))
      << "J " << i.j << "\n"
      << curvatures << "\n"
      << curvatures_difference;
}

/// Rotations of space and of the rest shape change nothing; S is symmetric and the pull-back of P.
inline void expect_isotropic_and_objective(const AnyLaw& law, const Matrix& F, Random& random) {
  const Matrix Q = random.rotation(), R = random.rotation(), P = law.first_piola(F), G = Q * F * R;
  const double psi = law.energy_density(F), size = std::max(P.norm(), law.mu + std::abs(law.lambda));
  EXPECT_NEAR(law.energy_density(G), psi, 1e-11 * std::max(psi, size)) << "F =\n" << F;
  EXPECT_LE((law.first_piola(G) - Q * P * R).norm(), 1e-11 * size) << "F =\n" << F;
  const Matrix S = law.second_piola(F);
  EXPECT_LE((S - S.transpose()).norm(), 1e-12 * (size + S.norm())) << "F =\n" << F;
  EXPECT_LE((F * S - P).norm(), 1e-12 * (size + S.norm() * F.norm())) << "F =\n" << F;
}

/// Small-strain digits: psi of a strain of size e is Hooke's but for O(e), and the rounding of F = I + H.
template <class T>
void expect_digits_near_rest(const LawOn<T>& law, double lambda, double mu, double strain) {
  Matrix G;
  G << 0.9, 0.3, -0.2, 0.1, -0.7, 0.4, 0.5, -0.3, 0.6;
  const Matrix e = 0.5 * strain * (G + G.transpose()), F = Matrix::Identity() + strain * G;
  const double hooke = lambda / 2 * e.trace() * e.trace() + mu * e.squaredNorm();
  using Scalar = std::decay_t<decltype(softsim::lane(T(), 0))>;
  Mat3<T> FF;
  for (int i = 0; i < 9; ++i) FF(i) = T(F(i));
  const double psi = static_cast<double>(softsim::lane(law.energy_density(FF), 0));
  EXPECT_NEAR(psi / hooke, 1, 10 * strain + 30 * double(std::numeric_limits<Scalar>::epsilon()) / strain)
      << "strain " << strain;
}

/// Lane l of a batch of eight is what `law` gives in double for `F[l]`, to `tolerance` of the size of stress.
template <class T>
void expect_lanes_as_scalars(const AnyLaw& law, const LawOn<T>& in_batch, const std::array<Matrix, 8>& F,
                             const Matrix& D, double tolerance) {
  using Scalar = std::decay_t<decltype(softsim::lane(T(), 0))>;
  Mat3<T> FF, DD;
  for (int i = 0; i < 9; ++i) {
    DD(i) = T(static_cast<Scalar>(D(i)));
    for (int l = 0; l < softsim::lane_count<T>; ++l)
      softsim::set_lane(FF(i), l, static_cast<Scalar>(F[static_cast<std::size_t>(l)](i)));
  }
  const T psi = in_batch.energy_density(FF);
  const Mat3<T> P = in_batch.first_piola(FF), dP = in_batch.first_piola_differential(FF, DD);
  for (int l = 0; l < softsim::lane_count<T>; ++l) {
    const Matrix f = F[static_cast<std::size_t>(l)].cast<Scalar>().template cast<double>();
    const double energy = law.energy_density(f), tangent_norm = tangent(law, f).norm();
    const double size = law.first_piola(f).norm() + tangent_norm * f.norm();
    Matrix one, two;
    for (int i = 0; i < 9; ++i) {
      one(i) = static_cast<double>(softsim::lane(P(i), l));
      two(i) = static_cast<double>(softsim::lane(dP(i), l));
    }
    const Matrix df = D.cast<Scalar>().template cast<double>();
    EXPECT_NEAR(double(softsim::lane(psi, l)), energy, tolerance * (size * f.norm() + std::abs(energy))) << f;
    EXPECT_LE((one - law.first_piola(f)).norm(), tolerance * size) << "lane " << l << " F =\n" << f;
    // a change of J by its rounding changes dP by about |F| / J of itself
    EXPECT_LE((two - law.first_piola_differential(f, df)).norm(),
              30 * tolerance * tangent_norm * (1 + f.norm()))
        << "lane " << l << " F =\n"
        << f;
  }
}

}  // namespace law_checks
