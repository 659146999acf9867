// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "softsim/core/batch.hpp"
#include "softsim/core/state.hpp"

namespace softsim {
inline namespace SOFTSIM_SIMD_NAMESPACE {
namespace simd_detail {

// Everything here is inlined by force: g++ else hands the lanes over through memory, in pieces of half a
// register, which makes a force a third slower.

// Four batches r hold a block (four scalars) of each lane, in one of two arrangements. By component: r[c]
// holds component c. By block, as memory has them: r[i] holds the blocks of lanes i, i + 4, ... one after the
// other. With two lanes a block takes two registers: r[0] and r[1] hold the first halves of the blocks, r[2]
// and r[3] the second. A batch of two halves is arranged half by half.

// The same half of four batches.
template <class T, int N>
[[gnu::always_inline]] inline void halve(const Batch<T, N> (&r)[4], Batch<T, N / 2> (&low)[4],
                                         Batch<T, N / 2> (&high)[4]) {
  for (int k = 0; k < 4; ++k) {
    low[k] = r[k].low;
    high[k] = r[k].high;
  }
}

// The shuffle of a and b given by the places I: the first half of each 128 bits of both, by turns. Eight
// doubles are handled as integers: with a in memory and b a constant, g++ 12 takes vmovddup, which reads a
// twice, for vunpcklpd (also of _mm512_unpacklo_pd and _mm512_shuffle_pd; sse.md, *avx512f_unpcklpd512).
template <class T, int N, int... I>
[[gnu::always_inline]] inline typename Batch<T, N>::Register interleave_first(
    const typename Batch<T, N>::Register& a, const typename Batch<T, N>::Register& b) {
#if defined(__AVX512F__)
  if constexpr (sizeof(T) == 8 && N == 8)
    return reinterpret_cast<typename Batch<T, N>::Register>(
        // without a mask g++ 12 warns of an uninitialised argument in its own header
        _mm512_maskz_unpacklo_epi64(0xFF, reinterpret_cast<__m512i>(a), reinterpret_cast<__m512i>(b)));
  else
#endif
    return __builtin_shufflevector(a, b, I...);
}

// From one arrangement to the other and back. Two rounds of shuffles, the first within each 128 bits and the
// second of pairs of lanes, which the compilers turn into one unpack or permute instruction each.
template <class T, int N, int... I>
[[gnu::always_inline]] inline void transpose_groups(Batch<T, N> (&r)[4], std::integer_sequence<int, I...>) {
  using Register = typename Batch<T, N>::Register;
  constexpr int step = sizeof(T) == 8 ? 2 : 1, odd = 3 - step;
  const Register r0 = r[0].lanes, r1 = r[1].lanes, r2 = r[2].lanes, r3 = r[3].lanes;
  const Register a = interleave_first<T, N, (I % 2 * N + I / 4 * 4 + I % 4 / 2 * step)...>(r0, r1);
  const Register b = __builtin_shufflevector(r0, r1, (I % 2 * N + I / 4 * 4 + I % 4 / 2 * step + odd)...);
  const Register c = interleave_first<T, N, (I % 2 * N + I / 4 * 4 + I % 4 / 2 * step)...>(r2, r3);
  const Register d = __builtin_shufflevector(r2, r3, (I % 2 * N + I / 4 * 4 + I % 4 / 2 * step + odd)...);
#if defined(__AVX512F__)
  if constexpr (sizeof(T) * N == 64 && sizeof(T) == 8) {
    // One instruction with the places in it; the compilers would load them from memory.
    const auto low = [](const Register& x, const Register& y) __attribute__((always_inline)) {
      return reinterpret_cast<Register>(
          _mm512_mask_permutex_pd(reinterpret_cast<__m512d>(x), 0xCC, reinterpret_cast<__m512d>(y), 0x44));
    };
    const auto high = [](const Register& x, const Register& y) __attribute__((always_inline)) {
      return reinterpret_cast<Register>(
          _mm512_mask_permutex_pd(reinterpret_cast<__m512d>(y), 0x33, reinterpret_cast<__m512d>(x), 0xEE));
    };
    r[0].lanes = low(a, c);
    r[odd].lanes = low(b, d);
    r[step].lanes = high(a, c);
    r[3].lanes = high(b, d);
    return;
  }
#endif
  r[0].lanes = __builtin_shufflevector(a, c, (I % 4 / 2 * N + I / 4 * 4 + I % 2)...);
  r[odd].lanes = __builtin_shufflevector(b, d, (I % 4 / 2 * N + I / 4 * 4 + I % 2)...);
  r[step].lanes = __builtin_shufflevector(a, c, (I % 4 / 2 * N + I / 4 * 4 + I % 2 + 2)...);
  r[3].lanes = __builtin_shufflevector(b, d, (I % 4 / 2 * N + I / 4 * 4 + I % 2 + 2)...);
}
template <class T, int N>
[[gnu::always_inline]] inline void transpose(Batch<T, N> (&r)[4]) {
  if constexpr (is_wide<T, N>) {
    Batch<T, N / 2> low[4], high[4];
    halve(r, low, high);
    transpose(low);
    transpose(high);
    for (int k = 0; k < 4; ++k) r[k] = {low[k], high[k]};
  } else if constexpr (N == 2) {
    for (int k = 0; k < 4; k += 2) {
      const auto first = r[k].lanes, second = r[k + 1].lanes;
      r[k].lanes = __builtin_shufflevector(first, second, 0, 2);
      r[k + 1].lanes = __builtin_shufflevector(first, second, 1, 3);
    }
  } else {
    transpose_groups(r, std::make_integer_sequence<int, N>{});
  }
}

template <class T, int N, int... I>
[[gnu::always_inline]] inline void concatenate(const Batch<T, N>& low, const Batch<T, N>& high,
                                               Batch<T, 2 * N>& r, std::integer_sequence<int, I...>) {
  r.lanes = __builtin_shufflevector(low.lanes, high.lanes, I...);
}

// Four scalars from each of N / 4 places, side by side in one batch. They are put together in registers: a
// batch read from memory right after it was written there in parts has to wait for the writes.
template <class T, int N>
[[gnu::always_inline]] inline void load_groups(const T* base, const std::int32_t* ids, Batch<T, N>& r) {
  if constexpr (N == 4) {
    r = Batch<T, N>::load(base + block_stride * static_cast<std::ptrdiff_t>(ids[0]));
  } else {
    Batch<T, N / 2> low, high;
    load_groups(base, ids, low);
    load_groups(base, ids + N / 2, high);
    concatenate(low, high, r, std::make_integer_sequence<int, N>{});
  }
}

// The blocks with the given numbers, arranged by block.
template <class T, int N>
[[gnu::always_inline]] inline void load_blocks(const T* base, const std::int32_t* ids, Batch<T, N> (&r)[4]) {
  if constexpr (is_wide<T, N>) {
    Batch<T, N / 2> low[4], high[4];
    load_blocks(base, ids, low);
    load_blocks(base, ids + N / 2, high);
    for (int k = 0; k < 4; ++k) r[k] = {low[k], high[k]};
  } else if constexpr (N == 2) {
    for (int l = 0; l < 2; ++l) {
      const T* p = base + block_stride * static_cast<std::ptrdiff_t>(ids[l]);
      r[l] = Batch<T, N>::load(p);
      r[l + 2] = Batch<T, N>::load(p + 2);
    }
  } else {
    for (int i = 0; i < 4; ++i) load_groups(base, ids + i, r[i]);
  }
}

// Adds the block of lane l, arranged by block, to the four scalars at p.
template <int l, class T, int N>
[[gnu::always_inline]] inline void add_block(const Batch<T, N> (&r)[4], T* p) {
  if constexpr (is_wide<T, N>) {
    Batch<T, N / 2> low[4], high[4];
    halve(r, low, high);
    if constexpr (l < N / 2)
      add_block<l>(low, p);
    else
      add_block<l - N / 2>(high, p);
  } else if constexpr (N == 2) {
    (Batch<T, N>::load(p) + r[l]).store(p);
    (Batch<T, N>::load(p + 2) + r[l + 2]).store(p + 2);
  } else {
    Batch<T, 4> sum = Batch<T, 4>::load(p);
    constexpr int g = l / 4 * 4;
    const auto& group = r[l % 4].lanes;
    if constexpr (N == 4)
      sum.lanes += group;
    else
      sum.lanes += __builtin_shufflevector(group, group, g, g + 1, g + 2, g + 3);
    sum.store(p);
  }
}

// Adds what `load_blocks` would read, for the first `count` lanes.
template <class T, int N, int... L>
[[gnu::always_inline]] inline void add_blocks(T* base, const std::int32_t* ids, const Batch<T, N> (&r)[4],
                                              int count, std::integer_sequence<int, L...>) {
  const auto place = [&](int l) { return base + block_stride * static_cast<std::ptrdiff_t>(ids[l]); };
  if (count == N)
    (add_block<L>(r, place(L)), ...);
  else
    ((L < count ? add_block<L>(r, place(L)) : void()), ...);
}

// Where the places of the first `count` lanes are odd; those of the others are not read.
template <class T, int N, int... L>
[[gnu::always_inline]] inline BatchMask<T, N> odd(const std::int32_t* places, int stride, int count,
                                                  std::integer_sequence<int, L...>) {
  if constexpr (is_wide<T, N>) {
    constexpr auto half = std::make_integer_sequence<int, N / 2>{};
    return {odd<T, N / 2>(places, stride, count, half),
            odd<T, N / 2>(places + N / 2 * stride, stride, count - N / 2, half)};
  } else {
    using Register = typename VectorRegister<MaskInteger<T>, N>::type;
    return {Register{(L < count ? -MaskInteger<T>(places[L * stride] & 1) : MaskInteger<T>(0))...}};
  }
}

// Lane l of nine entries, the first eight of which are arranged by block.
template <int l, class T, int N>
[[gnu::always_inline]] inline void add_matrix(const Batch<T, N> (&first)[4], const Batch<T, N> (&second)[4],
                                              const T (&last)[N], T* values, const std::int32_t* places,
                                              int stride, int count) {
  if (l >= count || places[l * stride] < 0) return;
  T* p = values + 9 * static_cast<std::ptrdiff_t>(places[l * stride] / 2);
  add_block<l>(first, p);
  add_block<l>(second, p + 4);
  p[8] += last[l];
}
template <class T, int N, int... L>
[[gnu::always_inline]] inline void add_matrices(const Batch<T, N> (&first)[4], const Batch<T, N> (&second)[4],
                                                const T (&last)[N], T* values, const std::int32_t* places,
                                                int stride, int count, std::integer_sequence<int, L...>) {
  (add_matrix<L>(first, second, last, values, places, stride, count), ...);
}

}  // namespace simd_detail

/// Numbers of N blocks of a flat vector.
template <int N>
using BlockIds = std::array<std::int32_t, static_cast<std::size_t>(N)>;

/// The blocks with the given numbers of the flat vector at `base`, component by component.
template <class T, int N>
[[nodiscard, gnu::always_inline]] inline Vec3<Lanes<T, N>> gather_blocks(const T* base,
                                                                         const BlockIds<N>& ids) {
  if constexpr (N == 1) {
    const T* p = base + block_stride * static_cast<std::ptrdiff_t>(ids[0]);
    return Vec3<T>(p[0], p[1], p[2]);
  } else {
    using B = Batch<T, N>;
    B r[4];
    simd_detail::load_blocks(base, ids.data(), r);
    simd_detail::transpose(r);
    return Vec3<B>(r[0], r[1], r[2]);
  }
}

/// All four scalars of the blocks with the given numbers: the quaternions of frames.
template <class T, int N>
[[nodiscard, gnu::always_inline]] inline Eigen::Matrix<Lanes<T, N>, 4, 1> gather_whole_blocks(
    const T* base, const BlockIds<N>& ids) {
  if constexpr (N == 1) {
    const T* p = base + block_stride * static_cast<std::ptrdiff_t>(ids[0]);
    return {p[0], p[1], p[2], p[3]};
  } else {
    Batch<T, N> r[4];
    simd_detail::load_blocks(base, ids.data(), r);
    simd_detail::transpose(r);
    return {r[0], r[1], r[2], r[3]};
  }
}

/// Adds lane l of v to block ids[l] of the flat vector at `base`, for the first `count` lanes, in the order
/// of the lanes: a block may occur several times.
template <class T, int N>
[[gnu::always_inline]] inline void scatter_add_blocks(T* base, const BlockIds<N>& ids,
                                                      const Vec3<Lanes<T, N>>& v, int count = N) {
  if constexpr (N == 1) {
    T* p = base + block_stride * static_cast<std::ptrdiff_t>(ids[0]);
    for (int a = 0; a < 3; ++a) p[a] += v[a];
  } else {
    Batch<T, N> r[4] = {v[0], v[1], v[2], Batch<T, N>(0)};
    simd_detail::transpose(r);
    simd_detail::add_blocks(base, ids.data(), r, count, std::make_integer_sequence<int, N>{});
  }
}

/// As `gather_blocks` for P points, each less the first: `v[0]` is zero. One subtraction a point before the
/// transposition, and no transposition for the first: what a translation cannot change costs a quarter less.
template <class T, int N, std::size_t P>
[[gnu::always_inline]] inline void gather_relative(const T* base, const std::array<BlockIds<N>, P>& ids,
                                                   std::array<Vec3<Lanes<T, N>>, P>& v) {
  using L = Lanes<T, N>;
  v[0] = Vec3<L>(L(0), L(0), L(0));
  if constexpr (N == 1) {
    const Vec3<T> first = gather_blocks<T, 1>(base, ids[0]);
    for (std::size_t i = 1; i < P; ++i) v[i] = gather_blocks<T, 1>(base, ids[i]) - first;
  } else {
    L first[4];
    simd_detail::load_blocks(base, ids[0].data(), first);
    for (std::size_t i = 1; i < P; ++i) {
      L r[4];
      simd_detail::load_blocks(base, ids[i].data(), r);
      for (int k = 0; k < 4; ++k) r[k] -= first[k];
      simd_detail::transpose(r);
      v[i] = Vec3<L>(r[0], r[1], r[2]);
    }
  }
}

/// As `scatter_add_blocks` for forces on P points that balance: the three components of point i stand at
/// f[3 i]; those of point 0 are not read, it gets minus the sum of the others.
template <class T, int N, std::size_t P>
[[gnu::always_inline]] inline void scatter_add_balanced(T* base, const std::array<BlockIds<N>, P>& ids,
                                                        const Lanes<T, N>* f, int count = N) {
  using L = Lanes<T, N>;
  if constexpr (N == 1) {
    Vec3<T> sum = Vec3<T>::Zero();
    for (std::size_t i = 1; i < P; ++i) {
      const Vec3<T> v(f[3 * i], f[3 * i + 1], f[3 * i + 2]);
      scatter_add_blocks<T, 1>(base, ids[i], v);
      sum -= v;
    }
    scatter_add_blocks<T, 1>(base, ids[0], sum);
  } else {
    constexpr auto all = std::make_integer_sequence<int, N>{};
    L sum[4] = {L(0), L(0), L(0), L(0)};
    for (std::size_t i = 1; i < P; ++i) {
      L r[4] = {f[3 * i], f[3 * i + 1], f[3 * i + 2], L(0)};
      simd_detail::transpose(r);
      for (int k = 0; k < 4; ++k) sum[k] -= r[k];
      simd_detail::add_blocks(base, ids[i].data(), r, count, all);
    }
    simd_detail::add_blocks(base, ids[0].data(), sum, count, all);
  }
}

/// Adds lane l of the 3x3 matrix m to one of the blocks that follow each other in `values`, nine scalars
/// each, column by column, for the first `count` lanes. The place p of a lane, at places[l * stride], means
/// block p / 2, and the transpose of m if p is odd; a negative one leaves the lane out. No place of a lane
/// from `count` on is read, and nothing but those nine scalars is touched: other threads may add to the
/// blocks beside it.
// Not inlined: an assembly calls it for ten blocks and more, and each would be a few hundred instructions.
template <class T, int N>
[[gnu::noinline]] void scatter_add_matrix(T* values, const std::int32_t* places, int stride,
                                          const Mat3<Lanes<T, N>>& m, int count = N) {
  if constexpr (N == 1) {
    if (places[0] < 0) return;
    Eigen::Map<Mat3<T>> block(values + 9 * static_cast<std::ptrdiff_t>(places[0] / 2));
    if (places[0] % 2 == 0)
      block += m;
    else
      block += m.transpose();
  } else {
    constexpr auto all = std::make_integer_sequence<int, N>{};
    using B = Batch<T, N>;
    const auto turned = simd_detail::odd<T, N>(places, stride, count, all);
    const auto entry = [&](int a, int b) { return select(turned, m(b, a), m(a, b)); };
    B first[4] = {m(0, 0), entry(1, 0), entry(2, 0), entry(0, 1)},
      second[4] = {m(1, 1), entry(2, 1), entry(0, 2), entry(1, 2)};
    simd_detail::transpose(first);
    simd_detail::transpose(second);
    alignas(64) T last[N];
    m(2, 2).store(last);
    simd_detail::add_matrices(first, second, last, values, places, stride, count, all);
  }
}

}  // namespace SOFTSIM_SIMD_NAMESPACE
}  // namespace softsim
