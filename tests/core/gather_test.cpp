// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/core/gather.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

namespace gather_test {

using softsim::BlockIds, softsim::lane, softsim::Lanes, softsim::Mat3, softsim::set_lane, softsim::Vec3;

template <class L>
class Gather : public ::testing::Test {
 public:
  using Scalar = decltype(lane(L{}, 0));
  static constexpr int lane_total = softsim::lane_count<L>;
  static constexpr int blocks = 23;

  std::mt19937 generator{static_cast<unsigned>(lane_total)};

  // Small integers: sums are exact in any order.
  Scalar number() { return static_cast<Scalar>(std::uniform_int_distribution<int>(-50, 50)(generator)); }
  std::vector<Scalar> vector() {
    std::vector<Scalar> x(static_cast<std::size_t>(blocks * softsim::block_stride));
    for (Scalar& v : x) v = number();
    return x;
  }
  // With repetitions as soon as there are many lanes.
  BlockIds<lane_total> ids() {
    BlockIds<lane_total> result;
    for (auto& i : result) i = std::uniform_int_distribution<int>(0, blocks - 1)(generator);
    if (lane_total > 1) result[1] = result[0];
    return result;
  }
  L lanes() {
    L x;
    for (int l = 0; l < lane_total; ++l) set_lane(x, l, number());
    return x;
  }
};

using AllLanes = ::testing::Types<Lanes<double, 1>, Lanes<double, 2>, Lanes<double, 4>, Lanes<double, 8>,
                                  Lanes<float, 1>, Lanes<float, 4>, Lanes<float, 8>, Lanes<float, 16>>;
TYPED_TEST_SUITE(Gather, AllLanes);

TYPED_TEST(Gather, ReadsEveryComponentOfEveryLane) {
  using T = typename TestFixture::Scalar;
  constexpr int N = TestFixture::lane_total;
  const std::vector<T> x = this->vector();
  const std::array<BlockIds<N>, 3> ids = {this->ids(), this->ids(), this->ids()};
  const auto at = [&](std::size_t i, int l, int a) {
    return x[static_cast<std::size_t>(ids[i][static_cast<std::size_t>(l)] * softsim::block_stride + a)];
  };
  const Vec3<TypeParam> v = softsim::gather_blocks<T, N>(x.data(), ids[0]);
  std::array<Vec3<TypeParam>, 3> relative;
  softsim::gather_relative<T, N>(x.data(), ids, relative);
  for (int l = 0; l < N; ++l)
    for (int a = 0; a < 3; ++a) {
      EXPECT_EQ(lane(v[a], l), at(0, l, a));
      for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(lane(relative[i][a], l), at(i, l, a) - at(0, l, a));
    }
}

TYPED_TEST(Gather, AddsEveryLaneThatCounts) {
  using T = typename TestFixture::Scalar;
  constexpr int N = TestFixture::lane_total;
  for (int count = 1; count <= N; ++count) {
    std::vector<T> y = this->vector(), expected = y;
    const BlockIds<N> ids = this->ids();
    const Vec3<TypeParam> v(this->lanes(), this->lanes(), this->lanes());
    softsim::scatter_add_blocks<T, N>(y.data(), ids, v, count);
    for (int l = 0; l < count; ++l)
      for (int a = 0; a < 3; ++a)
        expected[static_cast<std::size_t>(ids[static_cast<std::size_t>(l)] * softsim::block_stride + a)] +=
            lane(v[a], l);
    EXPECT_EQ(y, expected) << count;
  }
}

TYPED_TEST(Gather, BalancesThePointThatIsNotGiven) {
  using T = typename TestFixture::Scalar;
  constexpr int N = TestFixture::lane_total;
  for (int count = 1; count <= N; ++count) {
    std::vector<T> y = this->vector(), expected = y;
    const std::array<BlockIds<N>, 3> ids = {this->ids(), this->ids(), this->ids()};
    std::array<TypeParam, 9> f;
    for (TypeParam& x : f) x = this->lanes();
    softsim::scatter_add_balanced<T, N>(y.data(), ids, f.data(), count);
    for (int l = 0; l < count; ++l)
      for (std::size_t a = 0; a < 3; ++a) {
        const auto place = [&](std::size_t i) {
          return static_cast<std::size_t>(ids[i][static_cast<std::size_t>(l)] * softsim::block_stride) + a;
        };
        expected[place(0)] -= lane(f[3 + a], l) + lane(f[6 + a], l);
        expected[place(1)] += lane(f[3 + a], l);
        expected[place(2)] += lane(f[6 + a], l);
      }
    EXPECT_EQ(y, expected) << count;
  }
}

// A constant row whose other rows come from memory: g++ 12 reads the row before it twice if it is given the
// choice (see `interleave_first`), here because no register outlives the clobber. Every other result only.
template <class L, int constant, int first>
[[gnu::noinline]] void transpose_from_memory(const L* from, L* to, L* zero) {
  *zero = L(0);
  L r[4];
  for (int k = 0; k < 4; ++k) r[k] = k == constant ? L(0) : from[k];
#if defined(__AVX512F__)
  asm volatile("" ::
                   : "xmm0", "xmm1", "xmm2", "xmm3", "xmm4", "xmm5", "xmm6", "xmm7", "xmm8", "xmm9", "xmm10",
                     "xmm11", "xmm12", "xmm13", "xmm14", "xmm15", "xmm16", "xmm17", "xmm18", "xmm19", "xmm20",
                     "xmm21", "xmm22", "xmm23", "xmm24", "xmm25", "xmm26", "xmm27", "xmm28", "xmm29", "xmm30",
                     "xmm31");
#endif
  softsim::simd_detail::transpose(r);
  for (int k = first; k < 4; k += 2) to[k] = r[k];
}
template <class L, int constant>
void expect_transposed() {
  constexpr int N = softsim::lane_count<L>;
  L from[4], there[4], back[4], zero;
  for (int k = 0; k < 4; ++k)
    for (int l = 0; l < N; ++l) set_lane(from[k], l, static_cast<decltype(lane(from[0], 0))>(1 + k * N + l));
  transpose_from_memory<L, constant, 0>(from, there, &zero);
  transpose_from_memory<L, constant, 1>(from, there, &zero);
  for (int k = 0; k < 4; ++k) back[k] = there[k];
  softsim::simd_detail::transpose(back);  // to blocks and back: twice is nothing
  for (int k = 0; k < 4; ++k)
    for (int l = 0; l < N; ++l)
      EXPECT_EQ(static_cast<int>(lane(back[k], l)), k == constant ? 0 : 1 + k * N + l) << k << ' ' << l;
}
TYPED_TEST(Gather, TransposesWhatIsPartlyConstant) {
  if constexpr (TestFixture::lane_total >= 4) {
    expect_transposed<TypeParam, 0>();
    expect_transposed<TypeParam, 1>();
    expect_transposed<TypeParam, 2>();
    expect_transposed<TypeParam, 3>();
  }
}

TYPED_TEST(Gather, AddsMatricesOrTheirTransposesAndNothingBesideThem) {
  using T = typename TestFixture::Scalar;
  constexpr int N = TestFixture::lane_total, stride = 2;
  for (int count = 1; count <= N; ++count)
    for (int trial = 0; trial < 4; ++trial) {
      std::vector<T> y(static_cast<std::size_t>(9 * TestFixture::blocks)), expected = y;
      const BlockIds<N> ids = this->ids();
      // not one more than the lanes that count may read
      std::vector<std::int32_t> places(static_cast<std::size_t>((count - 1) * stride + 1));
      std::uniform_int_distribution<std::int32_t> odd(0, 1), left_out(0, 4);
      for (int l = 0; l < count; ++l)
        places[static_cast<std::size_t>(l * stride)] =
            left_out(this->generator) == 0 ? -1 : 2 * ids[static_cast<std::size_t>(l)] + odd(this->generator);
      Mat3<TypeParam> m;
      for (int k = 0; k < 9; ++k) m(k) = this->lanes();
      softsim::scatter_add_matrix<T, N>(y.data(), places.data(), stride, m, count);
      for (int l = 0; l < count; ++l) {
        const std::int32_t p = places[static_cast<std::size_t>(l * stride)];
        for (int a = 0; a < 3 && p >= 0; ++a)
          for (int b = 0; b < 3; ++b)
            expected[static_cast<std::size_t>(9 * (p / 2) + 3 * b + a)] +=
                lane(p % 2 == 0 ? m(a, b) : m(b, a), l);
      }
      EXPECT_EQ(y, expected) << count;
    }
}

}  // namespace gather_test
