// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <type_traits>

#include "softsim/concepts.hpp"
#include "softsim/material/linear_elastic.hpp"
#include "softsim/material/neo_hookean.hpp"
#include "softsim/material/st_venant_kirchhoff.hpp"
#include "softsim/material/stable_neo_hookean.hpp"

/// What the tests of all laws share: random deformation gradients and checks that hold for any `Material`.
namespace law_checks {

using softsim::Mat3;
using softsim::Vec3;
using Matrix = Mat3<double>;
using Tangent9 = Eigen::Matrix<double, 9, 9>;

using AllLaws = ::testing::Types<softsim::StVenantKirchhoff, softsim::NeoHookean, softsim::StableNeoHookean,
                                 softsim::LinearElastic>;
using ObjectiveLaws =
    ::testing::Types<softsim::StVenantKirchhoff, softsim::NeoHookean, softsim::StableNeoHookean>;

/// Name of a law in the names of the typed tests.
struct LawName {
  template <class Law>
  static std::string GetName(int) {
    if (std::is_same_v<Law, softsim::StVenantKirchhoff>) return "StVenantKirchhoff";
    if (std::is_same_v<Law, softsim::NeoHookean>) return "NeoHookean";
    if (std::is_same_v<Law, softsim::StableNeoHookean>) return "StableNeoHookean";
    return "LinearElastic";
  }
};

/// Young's modulus in Pa and Poisson's ratio.
struct Moduli {
  double young, poisson;
};
/// Soft, stiff and close to incompressible, auxetic (lambda < 0).
inline constexpr std::array<Moduli, 3> moduli{{{10, 0.3}, {7e6, 0.45}, {2.5e3, -0.3}}};

/// Deformation gradient with its singular value decomposition F = U diag(stretches) V^T.
struct Deformation {
  Matrix F, U, V;
  Vec3<double> stretches;
};

/// Random tensors from a fixed seed.
class Random {
 public:
  explicit Random(std::uint64_t seed) : bits_(seed) {}

  /// A number in [low, high).
  double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(bits_() >> 11) * 0x1p-53;
  }
  /// Entries in [-1, 1).
  Matrix matrix() {
    Matrix A;
    for (int i = 0; i < 9; ++i) A(i) = uniform(-1, 1);
    return A;
  }
  /// A proper rotation.
  Matrix rotation() {
    const Eigen::Quaterniond q(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
    return q.normalized().toRotationMatrix();
  }
  /// det F in [0.3, 3], the ratio of the largest to the smallest stretch up to `condition`.
  Deformation regular(double condition) {
    Vec3<double> s;
    for (double& l : s) l = std::exp(uniform(0, std::log(condition)));
    s *= std::cbrt(std::exp(uniform(std::log(0.3), std::log(3.0))) / s.prod());
    return from_stretches(s);
  }
  /// As `regular`, with det F in [-3, 3]; every other one inverted, by one or by all three stretches.
  Deformation any_sign(double condition) {
    Deformation d = regular(condition);
    const double kind = uniform(0, 4);
    if (kind < 1)
      d.stretches = -d.stretches;
    else if (kind < 2)
      d.stretches[0] = -d.stretches[0];
    d.F = d.U * d.stretches.asDiagonal() * d.V.transpose();
    return d;
  }
  /// U diag(s) V^T with random U and V.
  Deformation from_stretches(const Vec3<double>& s) {
    Deformation d;
    d.U = rotation();
    d.V = rotation();
    d.stretches = s;
    d.F = d.U * s.asDiagonal() * d.V.transpose();
    return d;
  }

 private:
  std::mt19937_64 bits_;
};

/// Deformations at which an F of less than full rank is exact: points, lines and planes.
inline std::array<Matrix, 5> singular_deformations(Random& random) {
  const Matrix Q = random.rotation();
  const Vec3<double> a = random.matrix().col(0), b = random.matrix().col(0);
  Matrix flat = random.matrix();
  flat.col(2) = flat.col(0);
  return {Matrix::Zero(), Vec3<double>(1, 1, 0).asDiagonal().toDenseMatrix(),
          Vec3<double>(0, 0, 2).asDiagonal().toDenseMatrix(), Matrix(Q * a * b.transpose()), flat};
}

/// Tangent as a 9x9 matrix: column i is dP(F; E_i) for the i-th entry of F.
template <class Law>
Tangent9 tangent(const Law& law, const Matrix& F) {
  Tangent9 K;
  for (int i = 0; i < 9; ++i) {
    Matrix D = Matrix::Zero();
    D(i) = 1;
    const Matrix dP = law.first_piola_differential(F, D);
    K.col(i) = dP.reshaped();
  }
  return K;
}

/// P against a central difference of psi in each of the nine entries, dP against one of P, both finite.
/// With the step 6e-6 ~ cbrt(eps) truncation and rounding of a central difference are each about 1e-10 of the
/// terms that cancel in it; 1e-7 leaves room for a stretch ratio of 30. `modulus` in Pa is the size that
/// stands in where the stress vanishes.
template <class Law>
void expect_consistent_derivatives(const Law& law, const Matrix& F, double modulus) {
  constexpr double h = 6e-6, tolerance = 1e-7;
  const Matrix P = law.first_piola(F);
  const Tangent9 K = tangent(law, F);
  ASSERT_TRUE(std::isfinite(law.energy_density(F))) << "F =\n" << F;
  ASSERT_TRUE(P.allFinite() && K.allFinite()) << "F =\n" << F;

  Matrix P_difference;
  Tangent9 K_difference;
  for (int i = 0; i < 9; ++i) {
    Matrix plus = F, minus = F;
    plus(i) += h;
    minus(i) -= h;
    P_difference(i) = (law.energy_density(plus) - law.energy_density(minus)) / (2 * h);
    const Matrix dP = (law.first_piola(plus) - law.first_piola(minus)) / (2 * h);
    K_difference.col(i) = dP.reshaped();
  }
  EXPECT_LE((P - P_difference).norm(), tolerance * std::max(P.norm(), modulus)) << "F =\n" << F;
  EXPECT_LE((K - K_difference).norm(), tolerance * std::max(K.norm(), modulus)) << "F =\n" << F;
}

/// dP is the second derivative of an energy: linear in dF, and A : dP(B) = B : dP(A).
template <class Law>
void expect_symmetric_and_linear(const Law& law, const Matrix& F, double modulus, Random& random) {
  const Matrix A = random.matrix(), B = random.matrix();
  const double a = random.uniform(-2, 2), b = random.uniform(-2, 2);
  const Matrix dA = law.first_piola_differential(F, A), dB = law.first_piola_differential(F, B);
  const Matrix sum = law.first_piola_differential(F, a * A + b * B);
  // rounding of about a hundred operations whose terms are up to a thousand times the result (stretch ratio
  // 30)
  const double tolerance = 1e-12 * std::max(tangent(law, F).norm(), modulus);
  EXPECT_NEAR(A.cwiseProduct(dB).sum(), B.cwiseProduct(dA).sum(), 10 * tolerance) << "F =\n" << F;
  EXPECT_LE((sum - a * dA - b * dB).norm(), 10 * tolerance) << "F =\n" << F;
}

}  // namespace law_checks
