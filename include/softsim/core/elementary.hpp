// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "softsim/core/batch.hpp"

// Logarithms, inverse cube roots and exp(x) - 1 of batches. They are written out because a constitutive law
// spends most of its arithmetic here: Eigen's logarithm is a call through memory, which costs a Neo-Hookean
// force as much as the rest of the tetrahedron. Every lane takes the same way; the one branch serves lanes
// that no admissible deformation has, and leaves the others their bits.

namespace softsim {
inline namespace SOFTSIM_SIMD_NAMESPACE {
namespace simd_detail {

// What the format of T needs: bits of its parts, and polynomials just long enough for its digits.
template <class T>
struct Format;
template <>
struct Format<double> {
  static constexpr int fraction_bits = 52;
  static constexpr unsigned long long one = 0x3ff0000000000000, sqrt_half = 0x3fe6a09e667f3bcd;
  // Adding it to the bits of a small integer n gives the floating-point number magic + n.
  static constexpr unsigned long long magic_bits = 0x4330000000000000;
  static constexpr double magic = 4503599627370496.0, bias = 1023, subnormal_scale = 18014398509481984.0,
                          subnormal_shift = 54;
  static constexpr double ln2_high = 0x1.62e42fefap-1, ln2_low = 0x1.cf79abc9e3b3ap-40;
  // (2 atanh(s)/s - 2)/s^2 as a polynomial of s^2 for |s| <= 3 - 2 sqrt(2), interpolated at Chebyshev points;
  // relative error of the logarithm 5e-18.
  static constexpr double atanh_series[] = {0.66666666666666696, 0.39999999999899505, 0.28571428625975487,
                                            0.22222211134795081, 0.18182889125261723, 0.15331721600556042,
                                            0.14616449685043406};
  // m^(-1/3) as a polynomial of m - 1 on [sqrt(1/2), sqrt(2)], relative error 4.5e-5.
  static constexpr double inverse_cbrt_series[] = {0.9999717061, -0.3329600436, 0.2247185007, -0.1879438357,
                                                   0.124740559};
  static constexpr int newton_steps = 2;
};
template <>
struct Format<float> {
  static constexpr int fraction_bits = 23;
  static constexpr unsigned one = 0x3f800000, sqrt_half = 0x3f3504f3;
  static constexpr unsigned magic_bits = 0x4b000000;
  static constexpr float magic = 8388608.0F, bias = 127, subnormal_scale = 33554432.0F, subnormal_shift = 25;
  static constexpr float ln2_high = 0x1.62e4p-1F, ln2_low = 0x1.7f7d1cp-20F;
  static constexpr float atanh_series[] = {0.66666666554497089F, 0.40000121839806124F, 0.28550820815960665F,
                                           0.23330467216303835F};
  static constexpr float inverse_cbrt_series[] = {0.9999717061F, -0.3329600436F, 0.2247185007F,
                                                  -0.1879438357F, 0.124740559F};
  static constexpr int newton_steps = 1;
};

// Horner's rule in pairs (Estrin): the terms wait less for each other.
template <class T, std::size_t n, class B>
[[gnu::always_inline]] inline B polynomial(const T (&c)[n], const B& x) {
  const B x2 = x * x;
  constexpr std::size_t top = (n - 1) / 2 * 2;
  B y = top + 1 < n ? B(c[top]) + x * B(c[top + (top + 1 < n)]) : B(c[top]);
  for (std::size_t k = top; k > 0; k -= 2) y = y * x2 + (B(c[k - 2]) + x * B(c[k - 1]));
  return y;
}

// Bits of a batch as unsigned integers: on what is not positive or not finite, the arithmetic below wraps
// around before its result is thrown away.
template <class T>
using BitsOf = std::make_unsigned_t<MaskInteger<T>>;
template <class T, int N>
using BatchBits = typename VectorRegister<BitsOf<T>, N>::type;

// x = m 2^k with m in [sqrt(1/2), sqrt(2)), and 2^-k, for positive normal x.
template <class T, int N>
struct Split {
  Batch<T, N> m, k, scale;
};
template <class T, int N>
[[gnu::always_inline]] inline Split<T, N> split_normal(const Batch<T, N>& x) {
  if constexpr (is_wide<T, N>) {
    const Split<T, N / 2> low = split_normal(x.low), high = split_normal(x.high);
    return {{low.m, high.m}, {low.k, high.k}, {low.scale, high.scale}};
  } else {
    using B = Batch<T, N>;
    using Register = typename B::Register;
    using Bits = BatchBits<T, N>;
    using Part = Format<T>;
    const Bits shifted = reinterpret_cast<Bits>(x.lanes) + (Part::one - Part::sqrt_half);
    const Bits biased = shifted >> Part::fraction_bits;
    const Bits exponent = biased + Part::magic_bits;
    const Bits scale = 2 * Part::one - (biased << Part::fraction_bits);
    const Bits fraction = (shifted & ((BitsOf<T>{1} << Part::fraction_bits) - 1)) + Part::sqrt_half;
    return {B(reinterpret_cast<Register>(fraction)),
            B(reinterpret_cast<Register>(exponent)) - B(Part::magic + Part::bias),
            B(reinterpret_cast<Register>(scale))};
  }
}
// The same for all positive finite x; `scale` holds for normal numbers only.
template <class T, int N>
[[gnu::always_inline]] inline Split<T, N> split(const Batch<T, N>& x) {
  using B = Batch<T, N>;
  using Part = Format<T>;
  const auto tiny = x < B(std::numeric_limits<T>::min());
  Split<T, N> parts = split_normal(select(tiny, x * B(Part::subnormal_scale), x));
  parts.k -= select(tiny, B(Part::subnormal_shift), B(0));
  return parts;
}

// log of (1 + f) 2^k with s = f/(2 + f): log(1 + f) = 2 atanh(s), arranged so that the rounding of s counts
// s times only.
template <class T, int N>
[[gnu::always_inline]] inline Batch<T, N> log_of_parts(const Batch<T, N>& f, const Batch<T, N>& s,
                                                       const Batch<T, N>& k) {
  using B = Batch<T, N>;
  using Part = Format<T>;
  const B z = s * s, r = z * polynomial(Part::atanh_series, z);
  return k * B(Part::ln2_high) + (f - (s * (f - r) - k * B(Part::ln2_low)));
}

// 2^-q, where the integer q stands in the lowest bits of `shifted`.
template <class T, int N>
[[gnu::always_inline]] inline Batch<T, N> inverse_power_of_two(const Batch<T, N>& shifted) {
  if constexpr (is_wide<T, N>) {
    return {inverse_power_of_two(shifted.low), inverse_power_of_two(shifted.high)};
  } else {
    using Register = typename Batch<T, N>::Register;
    const auto q = reinterpret_cast<BatchBits<T, N>>(shifted.lanes);
    return Batch<T, N>(reinterpret_cast<Register>(Format<T>::one - (q << Format<T>::fraction_bits)));
  }
}

}  // namespace simd_detail

/// Natural logarithm of every lane, to about one unit in the last place; -inf at 0, NaN below.
template <class T, int N>
[[nodiscard, gnu::always_inline]] inline Batch<T, N> log(const Batch<T, N>& x) {
  using B = Batch<T, N>;
  const auto [m, k, scale] = simd_detail::split(x);
  const B f = m - B(1), y = simd_detail::log_of_parts(f, f / (m + B(1)), k);
  const B infinity(std::numeric_limits<T>::infinity());
  const B outside =
      select(x == B(0), -infinity, select(x == infinity, x, B(std::numeric_limits<T>::quiet_NaN())));
  return select((x > B(0)) & (x < infinity), y, outside);
}

/// log(x) and 1/x.
template <class T>
struct LogAndInverse {
  T log, inverse;
};

/// Natural logarithm and inverse of every lane for the price of one division, the inverse to about two units
/// in the last place; as `log` and a division would give them outside the positive normal numbers.
template <class T, int N>
[[nodiscard, gnu::always_inline]] inline LogAndInverse<Batch<T, N>> log_and_inverse(const Batch<T, N>& x) {
  using B = Batch<T, N>;
  const auto [m, k, scale] = simd_detail::split_normal(x);
  // One inverse for both: 1/m = p/(m p) and 1/p = m/(m p).
  const B p = m + B(1), r = B(1) / (m * p), f = m - B(1), s = f * m * r;
  LogAndInverse<B> y{simd_detail::log_of_parts(f, s, k), p * r * scale};
  // Between these both are right. Outside, which an admissible deformation never is, it may take longer.
  constexpr T least = std::numeric_limits<T>::min(), beyond = 1 / least;
  const auto usual = (x >= B(least)) & (x < B(beyond));
  if (!all(usual)) [[unlikely]] {
    y.log = select(usual, y.log, log(x));
    y.inverse = select(usual, y.inverse, B(1) / x);
  }
  return y;
}

/// log(1 + x) of every lane, with its digits for small x; -inf at -1, NaN below.
template <class T, int N>
[[nodiscard, gnu::always_inline]] inline Batch<T, N> log1p(const Batch<T, N>& x) {
  using B = Batch<T, N>;
  // 1 + x is rounded to u; what was lost, x - (u - 1), is exact and counts to first order.
  const B u = B(1) + x, lost = x - (u - B(1));
  const B y = log(u) + lost / u;
  return select((u > B(0)) & (u < B(std::numeric_limits<T>::infinity())), y, log(u));
}

/// exp(x) - 1 of every lane, with its digits for small x (Kahan's quotient of exp(x) - 1 and its rounded
/// exponent); -1 at -inf, inf where it overflows.
template <class T, int N>
[[nodiscard]] inline Batch<T, N> expm1(const Batch<T, N>& x) {
  using B = Batch<T, N>;
  const B u = exp(x), y = u - B(1);
  const B quotient = y * x / log(u);
  const auto exact = (y == B(-1)) | (u == B(std::numeric_limits<T>::infinity()));
  return select(u == B(1), x, select(exact, y, quotient));
}

/// x^(-1/3) of every lane for x > 0, to about two units in the last place; inf at 0, NaN below.
template <class T, int N>
[[nodiscard, gnu::always_inline]] inline Batch<T, N> inverse_cbrt(const Batch<T, N>& x) {
  using B = Batch<T, N>;
  using Part = simd_detail::Format<T>;
  const auto [m, k, inverse_power] = simd_detail::split(x);
  B y = simd_detail::polynomial(Part::inverse_cbrt_series, m - B(1));
  for (int i = 0; i < Part::newton_steps; ++i) y += y * (B(1) - m * y * y * y) * B(T(1) / T(3));
  // k = 3 q + r: the sum with 3/2 magic rounds k/3 to the integer q, which then stands in its lowest bits.
  const B shifted = k * B(T(1) / T(3)) + B(T(1.5) * Part::magic);
  const B r = k - B(3) * (shifted - B(T(1.5) * Part::magic));
  y *= simd_detail::inverse_power_of_two(shifted);
  y *= select(r > B(0.5), B(0.79370052598409974), select(r < B(-0.5), B(1.2599210498948732), B(1)));
  const B infinity(std::numeric_limits<T>::infinity());
  const B outside =
      select(x == B(0), infinity, select(x == infinity, B(0), B(std::numeric_limits<T>::quiet_NaN())));
  return select((x > B(0)) & (x < infinity), y, outside);
}

}  // namespace SOFTSIM_SIMD_NAMESPACE

/// x^(-1/3) for x > 0; inf at 0, NaN below.
template <class T>
requires std::is_floating_point_v<T>
[[nodiscard]] T inverse_cbrt(T x) {
  return x < T(0) ? std::numeric_limits<T>::quiet_NaN() : T(1) / std::cbrt(x);
}

/// Natural logarithm and inverse of x.
template <class T>
requires std::is_floating_point_v<T>
[[nodiscard]] LogAndInverse<T> log_and_inverse(T x) { return {std::log(x), T(1) / x}; }

}  // namespace softsim
