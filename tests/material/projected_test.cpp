// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/material/projected.hpp"

#include <Eigen/Eigenvalues>
#include <vector>

#include "material/law_checks.hpp"
#include "softsim/material/corotational.hpp"
#include "softsim/material/holzapfel_gasser_ogden.hpp"
#include "softsim/material/linear_elastic.hpp"
#include "softsim/material/ogden.hpp"
#include "softsim/material/sum.hpp"

namespace projected_test {

using namespace law_checks;
using softsim::Batch, softsim::Corotational, softsim::Invariants, softsim::NeoHookean, softsim::Ogden,
    softsim::Projected, softsim::projected, softsim::SpdFilter, softsim::StableNeoHookean;

/// All first and second derivatives by I1, I2 and J are there, of both signs.
struct Coupled : softsim::Isotropic<Coupled> {
  template <class T>
  T density(const Invariants<T>& i) const {
    return i.k1 + T(0.5) * i.k2 - T(4) * i.kj + T(0.3) * i.k1 * i.k1 - T(0.2) * i.k1 * i.k2 +
           T(0.1) * i.k2 * i.k2 + T(0.7) * i.k1 * i.kj - T(0.4) * i.k2 * i.kj + T(2) * i.kj * i.kj;
  }
  template <class T>
  softsim::First<T> first(const Invariants<T>& i) const {
    return {T(1) + T(0.6) * i.k1 - T(0.2) * i.k2 + T(0.7) * i.kj,
            T(0.5) - T(0.2) * i.k1 + T(0.2) * i.k2 - T(0.4) * i.kj,
            T(-4) + T(0.7) * i.k1 - T(0.4) * i.k2 + T(4) * i.kj};
  }
  template <class T>
  softsim::Second<T> second(const Invariants<T>&) const {
    return {T(0.6), T(-0.2), T(0.2), T(0.7), T(-0.4), T(4)};
  }
};

static_assert(softsim::Material<Projected<NeoHookean>> &&
              softsim::Material<Projected<Ogden>, Batch<float, 8>>);
static_assert(softsim::HasPrincipalTangent<Corotational> &&
              !softsim::HasPrincipalTangent<softsim::LinearElastic>);
// routes that take a law apart would lose the filter
static_assert(!softsim::InvariantLaw<Projected<NeoHookean>> && !softsim::StretchLaw<Projected<Ogden>>);

const StableNeoHookean stable = StableNeoHookean::from_young_poisson(10, 0.45);
const NeoHookean neo_hookean = NeoHookean::from_young_poisson(10, 0.3);
const Ogden ogden({{3, 2}, {-0.5, -4}, {0.01, 9}}, 8);

/// Stretched, compressed, inverted and singular deformations, equal and opposite stretches among them.
std::vector<Matrix> deformations(bool inverted) {
  Random random(50);
  std::vector<Matrix> all{Matrix::Identity(), 0.3 * Matrix::Identity(), 2 * Matrix::Identity()};
  for (int n = 0; n < 40; ++n) all.push_back(inverted ? random.any_sign(10).F : random.regular(10).F);
  for (const double d : {0.0, 1e-12, 1e-6, 1e-2}) {
    all.push_back(random.from_stretches({1.2, 0.4 + d, 0.4}).F);
    all.push_back(random.from_stretches({0.5 + d, 0.5, 0.5 - d}).F);
    if (inverted) all.push_back(random.from_stretches({1.2, 0.4, d - 0.4}).F);
    if (inverted) all.push_back(random.from_stretches({0.5 + d, 0.5, -0.5}).F);
  }
  if (inverted)
    for (const Matrix& F : singular_deformations(random)) all.push_back(F);
  return all;
}

/// The plain tangent with its eigenvalues filtered by a dense eigensolver.
Tangent9 oracle(const Tangent9& K, SpdFilter filter) {
  const Eigen::SelfAdjointEigenSolver<Tangent9> solver(K);
  const Eigen::Matrix<double, 9, 1> d = filter == SpdFilter::clamp
                                            ? Eigen::Matrix<double, 9, 1>(solver.eigenvalues().cwiseMax(0))
                                            : Eigen::Matrix<double, 9, 1>(solver.eigenvalues().cwiseAbs());
  return solver.eigenvectors() * d.asDiagonal() * solver.eigenvectors().transpose();
}

// The function of a symmetric matrix is unique even where its eigenvectors are not. `rounding` is that of the
// tangents times the size of terms that cancel in them.
template <class Law>
void expect_filtered(const Law& law, bool inverted, double rounding) {
  int indefinite = 0, definite = 0;
  for (const Matrix& F : deformations(inverted)) {
    const Tangent9 K = tangent(law, F);
    const double tolerance = rounding * std::max(K.norm(), 1.0);
    EXPECT_LE((tangent(projected(law, SpdFilter::none), F) - K).norm(), tolerance) << "F =\n" << F;
    for (const SpdFilter filter : {SpdFilter::clamp, SpdFilter::absolute}) {
      const Tangent9 filtered = tangent(projected(law, filter), F);
      EXPECT_LE((filtered - oracle(K, filter)).norm(), tolerance) << "F =\n" << F;
      EXPECT_LE((filtered - filtered.transpose()).norm(), tolerance) << "F =\n" << F;
      const Tangent9 symmetric = 0.5 * (filtered + filtered.transpose());
      const double least = Eigen::SelfAdjointEigenSolver<Tangent9>(symmetric).eigenvalues()[0];
      EXPECT_GE(least, -tolerance) << "F =\n" << F;
    }
    if (Eigen::SelfAdjointEigenSolver<Tangent9>(K).eigenvalues()[0] < -1e-3)
      ++indefinite;
    else if (tangent(projected(law), F) == tangent(projected(law, SpdFilter::none), F))
      ++definite;  // not a bit changes
  }
  EXPECT_GE(indefinite, 10);
  EXPECT_GE(definite, 2);
}

TEST(Projected, EigenvaluesAreFilteredStableNeoHookean) { expect_filtered(stable, true, 1e-13); }
TEST(Projected, EigenvaluesAreFilteredOfALawWithAllDerivatives) { expect_filtered(Coupled(), true, 1e-13); }
TEST(Projected, EigenvaluesAreFilteredOgden) { expect_filtered(ogden, false, 1e-13); }

// Its twist has a pole where two stretches cancel: there is no tangent to compare with, and none is near.
TEST(Projected, EigenvaluesAreFilteredCorotational) {
  expect_filtered(Corotational::from_young_poisson(10, 0.3), false, 1e-13);
}

// Fibres that bear tension only have a tangent without negative eigenvalues, so that the sum with a projected
// matrix has none; in compression the matrix alone is left.
TEST(Projected, MatrixWithFibresHasNoNegativeEigenvalue) {
  const softsim::HolzapfelGasserOgden fibres({.k1 = 5, .k2 = 2, .kappa = 0.1});
  const auto law = (projected(stable) + fibres).along({1, 0, 0}, Vec3<double>(1, 1, 0).normalized());
  const auto plain = (stable + fibres).along({1, 0, 0}, Vec3<double>(1, 1, 0).normalized());
  int indefinite = 0;
  for (const Matrix& F : deformations(true)) {
    const Tangent9 K = tangent(law, F);
    const Tangent9 symmetric = 0.5 * (K + K.transpose());
    EXPECT_GE(Eigen::SelfAdjointEigenSolver<Tangent9>(symmetric).eigenvalues()[0], -1e-13 * K.norm()) << F;
    if (Eigen::SelfAdjointEigenSolver<Tangent9>(tangent(plain, F)).eigenvalues()[0] < -1e-3) ++indefinite;
  }
  EXPECT_GE(indefinite, 10);
}

TEST(Projected, EnergyAndStressAreTheLawsOwn) {
  const auto law = projected(neo_hookean, SpdFilter::absolute);
  EXPECT_EQ(law.filter(), SpdFilter::absolute);
  EXPECT_EQ(law.law().mu(), neo_hookean.mu());
  for (const Matrix& F : deformations(false)) {
    EXPECT_EQ(law.energy_density(F), neo_hookean.energy_density(F));
    EXPECT_EQ(law.first_piola(F), neo_hookean.first_piola(F));
    EXPECT_EQ(law.second_piola(F), neo_hookean.second_piola(F));
  }
}

TEST(Projected, LinearisedOnceItGivesProductsAndBlocks) {
  Random random(51);
  const auto law = projected(Coupled(), SpdFilter::clamp);
  for (const Matrix& F : deformations(true)) {
    const auto K = law.linearise(F);
    const Matrix dF = random.matrix();
    EXPECT_EQ(K(dF), law.first_piola_differential(F, dF));
    const Vec3<double> a = random.matrix().col(0), b = random.matrix().col(0), v = random.matrix().col(0);
    const Vec3<double> expected = K(v * b.transpose()) * a;
    EXPECT_LE((K.block(a, b) * v - expected).norm(), 1e-13 * tangent(law, F).norm()) << F;
  }
}

TEST(Projected, NotFiniteStaysNotFinite) {
  const Matrix inverted = Vec3<double>(1, 1, -0.5).asDiagonal();
  for (const SpdFilter filter : {SpdFilter::none, SpdFilter::clamp, SpdFilter::absolute}) {
    EXPECT_FALSE(projected(neo_hookean, filter).first_piola_differential(inverted, inverted).allFinite());
    EXPECT_FALSE(projected(ogden, filter).first_piola_differential(inverted, inverted).allFinite());
    const Matrix nan = Matrix::Constant(std::nan(""));
    EXPECT_FALSE(projected(Coupled(), filter).first_piola_differential(nan, inverted).allFinite());
  }
}

// The eigenvalues of twists are minus infinity there; what they are replaced by must not be NaN.
TEST(Projected, CorotationalTangentOfAPointIsFinite) {
  const auto law = projected(Corotational::from_young_poisson(10, 0.3));
  Random random(53);
  const Matrix F = Matrix::Zero(), dF = random.matrix();
  const Matrix dP = law.first_piola_differential(F, dF);
  EXPECT_TRUE(dP.allFinite());
  EXPECT_GE((dP.array() * dF.array()).sum(), 0);
}

// Double batches go through the elements in tests/potential.
TEST(Projected, BatchesInSinglePrecisionAgreeWithDouble) {
  using B = Batch<float, 8>;
  const auto law = projected(stable, SpdFilter::absolute);
  const std::vector<Matrix> all = deformations(true);
  Random random(52);
  for (std::size_t first = 0; first + 8 <= all.size(); first += 8) {
    const Matrix dF = random.matrix();
    Mat3<B> Fs, dFs;
    for (int l = 0; l < 8; ++l)
      for (int i = 0; i < 9; ++i) {
        softsim::set_lane(Fs(i), l, static_cast<float>(all[first + static_cast<std::size_t>(l)](i)));
        softsim::set_lane(dFs(i), l, static_cast<float>(dF(i)));
      }
    const Mat3<B> dP = law.first_piola_differential(Fs, dFs);
    for (int l = 0; l < 8; ++l) {
      const Matrix& F = all[first + static_cast<std::size_t>(l)];
      const Matrix expected = law.first_piola_differential(F, dF);
      // the filter is Lipschitz but for a logarithm, with rounding of 1e-6 in its argument
      for (int i = 0; i < 9; ++i)
        EXPECT_NEAR(static_cast<double>(lane(dP(i), l)), expected(i), 3e-5 * tangent(stable, F).norm()) << F;
    }
  }
}

}  // namespace projected_test
