// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <type_traits>

#if defined(__AVX__)
#include <immintrin.h>
#elif defined(__SSE2__)
#include <emmintrin.h>  // the header of all sets costs half a second
#endif

// With the instruction set the layout of a batch changes: the namespace carries the width, so that batches of
// objects built with different -march flags are different types. Compile a program with one -march all the
// same: what is not made of batches has the same name with every flag.
#if defined(__AVX512F__)
#define SOFTSIM_SIMD_BYTES 64
#define SOFTSIM_SIMD_NAMESPACE simd512
#elif defined(__AVX__)
#define SOFTSIM_SIMD_BYTES 32
#define SOFTSIM_SIMD_NAMESPACE simd256
#else
#define SOFTSIM_SIMD_BYTES 16
#define SOFTSIM_SIMD_NAMESPACE simd128
#endif

namespace softsim {
inline namespace SOFTSIM_SIMD_NAMESPACE {

namespace simd_detail {
// A trait of its own: as a member typedef of Batch, g++ 12 drops the attribute.
template <class T, int N>
struct VectorRegister {
  typedef T type __attribute__((vector_size(sizeof(T) * N)));
  // For reading and writing at any address in one instruction: for memcpy g++ may take two halves and a
  // detour through the stack, where the halves written last are slow to read as one.
  typedef T in_memory __attribute__((vector_size(sizeof(T) * N), aligned(alignof(T)), may_alias));
};
template <class T>
using MaskInteger = std::conditional_t<sizeof(T) == 8, long long, int>;

// One bit per lane, set where the lane of a comparison's result is not zero.
template <class T, int N>
[[gnu::always_inline]] inline unsigned bits(const typename VectorRegister<MaskInteger<T>, N>::type& lanes) {
#if defined(__AVX512F__)
  if constexpr (sizeof(T) * N == 64) {
    const auto all = reinterpret_cast<__m512i>(lanes);
    if constexpr (sizeof(T) == 8)
      return _mm512_test_epi64_mask(all, all);
    else
      return _mm512_test_epi32_mask(all, all);
  }
#endif
#if defined(__AVX__)
  if constexpr (sizeof(T) * N == 32) {
    if constexpr (sizeof(T) == 8)
      return static_cast<unsigned>(_mm256_movemask_pd(reinterpret_cast<__m256d>(lanes)));
    else
      return static_cast<unsigned>(_mm256_movemask_ps(reinterpret_cast<__m256>(lanes)));
  }
#endif
#if defined(__SSE2__)
  if constexpr (sizeof(T) * N == 16) {
    if constexpr (sizeof(T) == 8)
      return static_cast<unsigned>(_mm_movemask_pd(reinterpret_cast<__m128d>(lanes)));
    else
      return static_cast<unsigned>(_mm_movemask_ps(reinterpret_cast<__m128>(lanes)));
  }
#endif
  unsigned result = 0;
  for (int l = 0; l < N; ++l) result |= static_cast<unsigned>(lanes[l] != 0) << l;
  return result;
}

// More lanes than a register has. Such a batch is two of half the size: left to the compiler, g++ keeps a
// vector without a register of its size in memory, which costs more than one element at a time.
template <class T, int N>
inline constexpr bool is_wide = sizeof(T) * N > SOFTSIM_SIMD_BYTES;
}  // namespace simd_detail

/// Result of comparing two batches lane by lane; goes into `select`, `any`, `all`.
template <class T, int N>
struct BatchMask {
  typename simd_detail::VectorRegister<simd_detail::MaskInteger<T>, N>::type lanes;

  friend BatchMask operator&(BatchMask a, BatchMask b) { return {a.lanes & b.lanes}; }
  friend BatchMask operator|(BatchMask a, BatchMask b) { return {a.lanes | b.lanes}; }
  friend bool any(const BatchMask& m) { return simd_detail::bits<T, N>(m.lanes) != 0; }
  friend bool all(const BatchMask& m) { return simd_detail::bits<T, N>(m.lanes) == ~0U >> (32 - N); }
};

/// N scalars of type T (float or double; N a power of two up to 32) that every generic function of the
/// library accepts in place of one scalar: arithmetic acts lane by lane in the compiler's vector registers.
/// Functions that take decisions use `select(mask, a, b)` instead of a branch.
template <class T, int N>
struct Batch {
  static_assert(std::is_floating_point_v<T> && N >= 2 && N <= 32 && (N & (N - 1)) == 0);
  using Register = typename simd_detail::VectorRegister<T, N>::type;
  using Mask = BatchMask<T, N>;

  Register lanes;

  Batch() = default;
  // Written out: the implicit ones copy memory instead of a register with g++.
  [[gnu::always_inline]] Batch(const Batch& b) : lanes(b.lanes) {}
  [[gnu::always_inline]] Batch& operator=(const Batch& b) {
    lanes = b.lanes;
    return *this;
  }
  Batch(const Register& r) : lanes(r) {}  // by reference: passing wide registers by value changes the ABI
  /// Every lane takes the value s.
  template <class S>
  requires std::is_arithmetic_v<S> Batch(S s) : lanes(static_cast<T>(s) - Register{}) {}

  /// Reads N consecutive values; no alignment is assumed.
  [[gnu::always_inline]] static Batch load(const T* p) {
    return Batch(Register(*reinterpret_cast<const InMemory*>(p)));
  }
  /// Writes N consecutive values; no alignment is assumed.
  [[gnu::always_inline]] void store(T* p) const { *reinterpret_cast<InMemory*>(p) = lanes; }

  Batch operator-() const { return Batch(Register(-lanes)); }
  Batch& operator+=(const Batch& b) {
    lanes += b.lanes;
    return *this;
  }
  Batch& operator-=(const Batch& b) {
    lanes -= b.lanes;
    return *this;
  }
  Batch& operator*=(const Batch& b) {
    lanes *= b.lanes;
    return *this;
  }
  Batch& operator/=(const Batch& b) {
    lanes /= b.lanes;
    return *this;
  }
  friend Batch operator+(const Batch& a, const Batch& b) { return Batch(Register(a.lanes + b.lanes)); }
  friend Batch operator-(const Batch& a, const Batch& b) { return Batch(Register(a.lanes - b.lanes)); }
  friend Batch operator*(const Batch& a, const Batch& b) { return Batch(Register(a.lanes * b.lanes)); }
  friend Batch operator/(const Batch& a, const Batch& b) { return Batch(Register(a.lanes / b.lanes)); }

  friend Mask operator<(const Batch& a, const Batch& b) { return {a.lanes < b.lanes}; }
  friend Mask operator<=(const Batch& a, const Batch& b) { return {a.lanes <= b.lanes}; }
  friend Mask operator>(const Batch& a, const Batch& b) { return {a.lanes > b.lanes}; }
  friend Mask operator>=(const Batch& a, const Batch& b) { return {a.lanes >= b.lanes}; }
  friend Mask operator==(const Batch& a, const Batch& b) { return {a.lanes == b.lanes}; }
  friend Mask operator!=(const Batch& a, const Batch& b) { return {a.lanes != b.lanes}; }

  friend Batch select(const Mask& m, const Batch& a, const Batch& b) {
    return Batch(Register(m.lanes ? a.lanes : b.lanes));
  }
  friend Batch abs(const Batch& a) { return select(a < Batch(0), -a, a); }
  friend Batch min(const Batch& a, const Batch& b) { return select(b < a, b, a); }
  friend Batch max(const Batch& a, const Batch& b) { return select(a < b, b, a); }
  friend Batch sqrt(const Batch& a) {
    return map(a, [](const auto& x) { return x.sqrt(); });
  }
  friend Batch exp(const Batch& a) {
    return map(a, [](const auto& x) { return x.exp(); });
  }
  /// To about 3 + |p log a| units in the last place: fused multiply-adds spoil Eigen's compensation.
  friend Batch pow(const Batch& a, double p) {
    return map(a, [p](const auto& x) { return x.pow(static_cast<T>(p)); });
  }

 private:
  using InMemory = typename simd_detail::VectorRegister<T, N>::in_memory;

  // Eigen's array functions vectorise without -ffast-math, a loop over std::log does not.
  template <class Function>
  static Batch map(const Batch& a, Function f) {
    Eigen::Array<T, N, 1> x;
    a.store(x.data());
    const Eigen::Array<T, N, 1> y = f(x);
    return load(y.data());
  }
};

template <class T, int N>
requires simd_detail::is_wide<T, N>
struct BatchMask<T, N> {
  BatchMask<T, N / 2> low, high;

  friend BatchMask operator&(const BatchMask& a, const BatchMask& b) {
    return {a.low & b.low, a.high & b.high};
  }
  friend BatchMask operator|(const BatchMask& a, const BatchMask& b) {
    return {a.low | b.low, a.high | b.high};
  }
  friend bool any(const BatchMask& m) { return any(m.low | m.high); }
  friend bool all(const BatchMask& m) { return all(m.low & m.high); }
};

template <class T, int N>
requires simd_detail::is_wide<T, N>
struct Batch<T, N> {
  static_assert(std::is_floating_point_v<T> && N <= 32 && (N & (N - 1)) == 0);
  using Half = Batch<T, N / 2>;
  using Mask = BatchMask<T, N>;

  Half low, high;

  Batch() = default;
  Batch(const Half& l, const Half& h) : low(l), high(h) {}
  template <class S>
  requires std::is_arithmetic_v<S> Batch(S s) : low(s), high(low) {}

  static Batch load(const T* p) { return {Half::load(p), Half::load(p + N / 2)}; }
  void store(T* p) const {
    low.store(p);
    high.store(p + N / 2);
  }

  Batch operator-() const { return {-low, -high}; }
  Batch& operator+=(const Batch& b) { return *this = *this + b; }
  Batch& operator-=(const Batch& b) { return *this = *this - b; }
  Batch& operator*=(const Batch& b) { return *this = *this * b; }
  Batch& operator/=(const Batch& b) { return *this = *this / b; }
  friend Batch operator+(const Batch& a, const Batch& b) { return {a.low + b.low, a.high + b.high}; }
  friend Batch operator-(const Batch& a, const Batch& b) { return {a.low - b.low, a.high - b.high}; }
  friend Batch operator*(const Batch& a, const Batch& b) { return {a.low * b.low, a.high * b.high}; }
  friend Batch operator/(const Batch& a, const Batch& b) { return {a.low / b.low, a.high / b.high}; }

  friend Mask operator<(const Batch& a, const Batch& b) { return {a.low < b.low, a.high < b.high}; }
  friend Mask operator<=(const Batch& a, const Batch& b) { return {a.low <= b.low, a.high <= b.high}; }
  friend Mask operator>(const Batch& a, const Batch& b) { return {a.low > b.low, a.high > b.high}; }
  friend Mask operator>=(const Batch& a, const Batch& b) { return {a.low >= b.low, a.high >= b.high}; }
  friend Mask operator==(const Batch& a, const Batch& b) { return {a.low == b.low, a.high == b.high}; }
  friend Mask operator!=(const Batch& a, const Batch& b) { return {a.low != b.low, a.high != b.high}; }

  friend Batch select(const Mask& m, const Batch& a, const Batch& b) {
    return {select(m.low, a.low, b.low), select(m.high, a.high, b.high)};
  }
  friend Batch abs(const Batch& a) { return {abs(a.low), abs(a.high)}; }
  friend Batch min(const Batch& a, const Batch& b) { return {min(a.low, b.low), min(a.high, b.high)}; }
  friend Batch max(const Batch& a, const Batch& b) { return {max(a.low, b.low), max(a.high, b.high)}; }
  friend Batch sqrt(const Batch& a) { return {sqrt(a.low), sqrt(a.high)}; }
  friend Batch exp(const Batch& a) { return {exp(a.low), exp(a.high)}; }
  friend Batch pow(const Batch& a, double p) { return {pow(a.low, p), pow(a.high, p)}; }
};

/// Lanes that fill one vector register of those the compiler was given: 8 doubles or 16 floats with AVX-512,
/// half of that with AVX, a quarter without.
template <class T>
inline constexpr int default_lanes = SOFTSIM_SIMD_BYTES / static_cast<int>(sizeof(T));

/// N lanes of T: T itself for N = 1, Batch<T, N> else.
template <class T, int N>
using Lanes = std::conditional_t<N == 1, T, Batch<T, N>>;

/// Number of lanes of a scalar type: 1 for float, double and other plain scalars, N for Batch<T, N>.
template <class T>
inline constexpr int lane_count = 1;
template <class T, int N>
inline constexpr int lane_count<Batch<T, N>> = N;

/// Value of lane l; for a plain scalar the value itself.
template <class T>
[[nodiscard]] T lane(const T& x, int) {
  return x;
}
template <class T, int N>
[[nodiscard]] T lane(const Batch<T, N>& x, int l) {
  if constexpr (simd_detail::is_wide<T, N>)
    return l < N / 2 ? lane(x.low, l) : lane(x.high, l - N / 2);
  else
    return x.lanes[l];
}

/// Writes lane l; for a plain scalar the value itself. For set-up, not for a hot loop.
template <class T>
void set_lane(T& x, int, std::type_identity_t<T> value) {
  x = value;
}
template <class T, int N>
void set_lane(Batch<T, N>& x, int l, std::type_identity_t<T> value) {
  if constexpr (simd_detail::is_wide<T, N>)
    set_lane(l < N / 2 ? x.low : x.high, l % (N / 2), value);
  else
    x.lanes[l] = value;
}

}  // namespace SOFTSIM_SIMD_NAMESPACE

/// a where the condition holds, b elsewhere: the scalar counterpart of the lane-wise select.
template <class T>
requires std::is_arithmetic_v<T>
[[nodiscard]] constexpr T select(bool condition, T a, T b) { return condition ? a : b; }

}  // namespace softsim

/// Lets Eigen's fixed-size matrices hold batches.
template <class T, int N>
struct Eigen::NumTraits<softsim::Batch<T, N>> : Eigen::NumTraits<T> {
  using Real = softsim::Batch<T, N>;
  using NonInteger = Real;
  using Nested = Real;
  using Literal = Real;
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 0,
    ReadCost = 1,
    AddCost = 1,
    MulCost = 1
  };
};

#include "softsim/core/elementary.hpp"  // log, log1p and inverse_cbrt belong to the type
