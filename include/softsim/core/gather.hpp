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

// Transposes every 4x4 group of four batches (its own inverse): lane 4g + i of batch j <-> lane 4g + j of batch i. Two
// rounds of shuffles, which the compilers turn into unpack and permute instructions.
template <class T, int N, int... I>
void transpose_groups(Batch<T, N> (&r)[4], std::integer_sequence<int, I...>) {
  using Register = typename Batch<T, N>::Register;
  const Register &r0 = r[0].lanes, &r1 = r[1].lanes, &r2 = r[2].lanes, &r3 = r[3].lanes;
  const Register a = __builtin_shufflevector(r0, r1, (I % 2 * N + I / 4 * 4 + I % 4 / 2 * 2)...);
  const Register b = __builtin_shufflevector(r0, r1, (I % 2 * N + I / 4 * 4 + I % 4 / 2 * 2 + 1)...);
  const Register c = __builtin_shufflevector(r2, r3, (I % 2 * N + I / 4 * 4 + I % 4 / 2 * 2)...);
  const Register d = __builtin_shufflevector(r2, r3, (I % 2 * N + I / 4 * 4 + I % 4 / 2 * 2 + 1)...);
  r[0].lanes = __builtin_shufflevector(a, c, (I % 4 / 2 * N + I / 4 * 4 + I % 2)...);
  r[1].lanes = __builtin_shufflevector(b, d, (I % 4 / 2 * N + I / 4 * 4 + I % 2)...);
  r[2].lanes = __builtin_shufflevector(a, c, (I % 4 / 2 * N + I / 4 * 4 + I % 2 + 2)...);
  r[3].lanes = __builtin_shufflevector(b, d, (I % 4 / 2 * N + I / 4 * 4 + I % 2 + 2)...);
}

// Four scalars from each of N / 4 places, side by side in one batch.
template <class T, int N>
Batch<T, N> load_groups(const T* base, const std::int32_t* ids) {
  alignas(sizeof(T) * N) T lanes[N];
  for (int g = 0; g < N / 4; ++g)
    std::memcpy(lanes + 4 * g, base + block_stride * static_cast<std::ptrdiff_t>(ids[4 * g]), 4 * sizeof(T));
  return Batch<T, N>::load(lanes);
}

}  // namespace simd_detail

/// Numbers of N blocks of a flat vector.
template <int N>
using BlockIds = std::array<std::int32_t, static_cast<std::size_t>(N)>;

/// The blocks with the given numbers of the flat vector at `base`, component by component.
template <class T, int N>
[[nodiscard]] Vec3<Lanes<T, N>> gather_blocks(const T* base, const BlockIds<N>& ids) {
  if constexpr (N == 1) {
    const T* p = base + block_stride * static_cast<std::ptrdiff_t>(ids[0]);
    return Vec3<T>(p[0], p[1], p[2]);
  } else {
    using B = Batch<T, N>;
    B r[4];
    for (int i = 0; i < 4; ++i) r[i] = simd_detail::load_groups<T, N>(base, ids.data() + i);
    simd_detail::transpose_groups(r, std::make_integer_sequence<int, N>{});
    return Vec3<B>(r[0], r[1], r[2]);
  }
}

/// Adds lane l of v to block ids[l] of the flat vector at `base`, for the first `count` lanes, in the order of the
/// lanes: a block may occur several times.
template <class T, int N>
void scatter_add_blocks(T* base, const BlockIds<N>& ids, const Vec3<Lanes<T, N>>& v, int count = N) {
  if constexpr (N == 1) {
    T* p = base + block_stride * static_cast<std::ptrdiff_t>(ids[0]);
    for (int a = 0; a < 3; ++a) p[a] += v[a];
  } else {
    using Four = Batch<T, 4>;
    Batch<T, N> r[4] = {v[0], v[1], v[2], Batch<T, N>(0)};
    simd_detail::transpose_groups(r, std::make_integer_sequence<int, N>{});
    alignas(sizeof(T) * N) T parts[4][N];
    for (int i = 0; i < 4; ++i) r[i].store(parts[i]);
    for (int l = 0; l < count; ++l) {
      T* p = base + block_stride * static_cast<std::ptrdiff_t>(ids[static_cast<std::size_t>(l)]);
      (Four::load(p) + Four::load(parts[l % 4] + l / 4 * 4)).store(p);
    }
  }
}

}  // namespace SOFTSIM_SIMD_NAMESPACE
}  // namespace softsim
