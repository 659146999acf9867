// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <limits>

#include "material/law_checks.hpp"
#include "softsim/core/batch.hpp"

// A batch of deformations in one call gives, lane by lane, what the same law gives for one deformation.

namespace law_batch_test {

using namespace law_checks;
using softsim::Batch;
using softsim::LinearElastic;
using softsim::NeoHookean;
using softsim::StableNeoHookean;
using softsim::StVenantKirchhoff;

template <class Pack>
struct Lanes;
template <class T, int N>
struct Lanes<Batch<T, N>> {
  using Scalar = T;
  static constexpr int count = N;
};

template <class Pack>
using Scalar = typename Lanes<Pack>::Scalar;
template <class Pack>
using Deformations = std::array<Mat3<Scalar<Pack>>, static_cast<std::size_t>(Lanes<Pack>::count)>;

template <class Pack>
Mat3<Pack> packed(const Deformations<Pack>& one) {
  Mat3<Pack> all;
  for (int l = 0; l < Lanes<Pack>::count; ++l)
    for (int i = 0; i < 9; ++i) softsim::set_lane(all(i), l, one[static_cast<std::size_t>(l)](i));
  return all;
}

template <class Pack>
Mat3<Scalar<Pack>> unpacked(const Mat3<Pack>& all, int l) {
  Mat3<Scalar<Pack>> one;
  for (int i = 0; i < 9; ++i) one(i) = softsim::lane(all(i), l);
  return one;
}

// Sizes of the terms that psi, P and dP are sums of: their rounding is a few eps of these.
struct Sizes {
  double energy, stress, differential;
};

template <class Law>
Sizes sizes(const Law& law, const Matrix& F) {
  const double modulus = law.mu() + std::abs(law.lambda()), n = 1 + F.norm();
  if constexpr (softsim::InvariantLaw<Law>) {
    const double i1 = F.squaredNorm(), J = F.determinant();
    const softsim::Invariants<double> i{i1, 0.5 * (i1 * i1 - (F.transpose() * F).squaredNorm()), J};
    const auto w = law.first(i);
    const auto s = law.second(i);
    const double n2 = n * n, n3 = n2 * n;
    // eps |F|^3 is the rounding of J, which the logarithm and the derivatives magnify
    const double j = Law::depends_on_j ? n3 : 0;
    const double stress = std::abs(w.w1) * n + std::abs(w.w2) * n3 +
                          (std::abs(w.wj) + std::abs(s.wjj) * j) * n2 + std::abs(s.w11) * n3;
    return {modulus + stress * n, modulus + stress, modulus + stress * (1 + (Law::depends_on_j ? n2 : 0))};
  } else {
    return {modulus * n * n, modulus * n, modulus * n};
  }
}

template <class Pack>
class LawsInBatches : public ::testing::Test {
 protected:
  using T = Scalar<Pack>;
  static constexpr int lanes = Lanes<Pack>::count;

  template <class Law>
  void expect_lanes_as_scalars(bool invert) {
    SCOPED_TRACE(LawName::GetName<Law>(0));
    constexpr double eps = std::numeric_limits<T>::epsilon();
    Random random(51);
    const Law law = Law::from_young_poisson(10, 0.3);
    for (int n = 0; n < 20; ++n) {
      Deformations<Pack> F, dF;
      for (auto& f : F) f = (invert ? random.any_sign(5) : random.regular(5)).F.template cast<T>();
      for (auto& f : dF) f = random.matrix().template cast<T>();
      const Mat3<Pack> FF = packed<Pack>(F), dFF = packed<Pack>(dF);
      const Pack psi = law.energy_density(FF);
      const Mat3<Pack> P = law.first_piola(FF), dP = law.first_piola_differential(FF, dFF);
      for (int l = 0; l < lanes; ++l) {
        const auto& f = F[static_cast<std::size_t>(l)];
        const auto& df = dF[static_cast<std::size_t>(l)];
        const Sizes size = sizes(law, Matrix(f.template cast<double>()));
        EXPECT_LE(std::abs(softsim::lane(psi, l) - law.energy_density(f)), 4 * eps * size.energy)
            << "lane " << l;
        EXPECT_LE((unpacked<Pack>(P, l) - law.first_piola(f)).norm(), 4 * eps * size.stress) << "lane " << l;
        EXPECT_LE((unpacked<Pack>(dP, l) - law.first_piola_differential(f, df)).norm(),
                  4 * eps * size.differential)
            << "lane " << l;
        // and close to double precision
        const Matrix exact = f.template cast<double>();
        EXPECT_LE(std::abs(double(softsim::lane(psi, l)) - law.energy_density(exact)), 4 * eps * size.energy);
      }
    }
  }
};

struct PackName {
  template <class Pack>
  static std::string GetName(int) {
    return (sizeof(Scalar<Pack>) == 8 ? "double" : "float") + std::to_string(Lanes<Pack>::count);
  }
};
using Packs = ::testing::Types<Batch<double, 4>, Batch<double, 8>, Batch<float, 8>, Batch<float, 16>>;
TYPED_TEST_SUITE(LawsInBatches, Packs, PackName);

TYPED_TEST(LawsInBatches, EveryLaneIsTheScalarResult) {
  this->template expect_lanes_as_scalars<StVenantKirchhoff>(false);
  this->template expect_lanes_as_scalars<NeoHookean>(false);
  this->template expect_lanes_as_scalars<StableNeoHookean>(false);
  this->template expect_lanes_as_scalars<LinearElastic>(false);
}

TYPED_TEST(LawsInBatches, EveryLaneIsTheScalarResultOverInvertedDeformations) {
  this->template expect_lanes_as_scalars<StVenantKirchhoff>(true);
  this->template expect_lanes_as_scalars<StableNeoHookean>(true);
  this->template expect_lanes_as_scalars<LinearElastic>(true);
}

TYPED_TEST(LawsInBatches, AnInvertedLaneOfNeoHookeanIsNotFiniteAndSpoilsNoOther) {
  constexpr int count = Lanes<TypeParam>::count;
  Random random(52);
  const auto law = NeoHookean::from_young_poisson(10, 0.3);
  const Matrix bad[] = {-Matrix::Identity(), Vec3<double>(1, 1, 0).asDiagonal().toDenseMatrix(),
                        Matrix::Zero()};
  for (int spoilt = 0; spoilt < count; ++spoilt)
    for (const Matrix& b : bad) {
      Deformations<TypeParam> F;
      for (auto& f : F) f = random.regular(5).F.template cast<Scalar<TypeParam>>();
      F[static_cast<std::size_t>(spoilt)] = b.template cast<Scalar<TypeParam>>();
      const Mat3<TypeParam> FF = packed<TypeParam>(F);
      const TypeParam psi = law.energy_density(FF);
      const Mat3<TypeParam> P = law.first_piola(FF), dP = law.first_piola_differential(FF, FF);
      for (int l = 0; l < count; ++l) {
        const bool good = l != spoilt;
        EXPECT_EQ(std::isfinite(softsim::lane(psi, l)), good) << "lane " << l << " F =\n" << b;
        EXPECT_EQ(unpacked<TypeParam>(P, l).allFinite(), good) << "lane " << l << " F =\n" << b;
        EXPECT_EQ(unpacked<TypeParam>(dP, l).allFinite(), good) << "lane " << l << " F =\n" << b;
      }
    }
}

}  // namespace law_batch_test
