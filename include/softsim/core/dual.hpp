// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>
#include <type_traits>

#include "softsim/core/batch.hpp"
#include "softsim/core/elementary.hpp"

namespace softsim {

/// Forward-mode automatic differentiation: a value and its derivatives by N variables. T is a plain scalar, a
/// Batch, or a Dual again for second derivatives. Stands in for a scalar in every generic function of the
/// library and in Eigen's fixed-size matrices. Comparisons look at values only and give what T gives, so that
/// `select` takes decisions; the derivative of abs, min and max is that of the branch taken.
template <class T, int N>
struct Dual {
  static_assert(N >= 1);

  T value;
  std::array<T, static_cast<std::size_t>(N)> derivative;

  Dual() = default;
  /// A constant.
  Dual(const T& v) : value(v) { derivative.fill(T(0)); }
  /// A constant.
  template <class S>
  requires(std::is_arithmetic_v<S> && !std::is_same_v<S, T>) Dual(S s) : Dual(T(s)) {}
  /// A value with all of its derivatives.
  Dual(const T& v, const std::array<T, static_cast<std::size_t>(N)>& d) : value(v), derivative(d) {}

  /// Variable number i, at value v: its derivative by itself is 1.
  [[nodiscard]] static Dual variable(const T& v, int i) {
    Dual x(v);
    x.derivative[static_cast<std::size_t>(i)] = T(1);
    return x;
  }

  Dual operator-() const {
    return combine([](const T& a) -> T { return -a; }, *this);
  }
  Dual& operator+=(const Dual& b) { return *this = *this + b; }
  Dual& operator-=(const Dual& b) { return *this = *this - b; }
  Dual& operator*=(const Dual& b) { return *this = *this * b; }
  Dual& operator/=(const Dual& b) { return *this = *this / b; }

  friend Dual operator+(const Dual& a, const Dual& b) {
    return combine([](const T& x, const T& y) -> T { return x + y; }, a, b);
  }
  friend Dual operator-(const Dual& a, const Dual& b) {
    return combine([](const T& x, const T& y) -> T { return x - y; }, a, b);
  }
  friend Dual operator*(const Dual& a, const Dual& b) {
    Dual c;
    c.value = a.value * b.value;
    for (std::size_t i = 0; i < N; ++i)
      c.derivative[i] = a.derivative[i] * b.value + a.value * b.derivative[i];
    return c;
  }
  friend Dual operator/(const Dual& a, const Dual& b) {
    Dual c;
    const T inverse = T(1) / b.value;
    c.value = a.value / b.value;
    for (std::size_t i = 0; i < N; ++i)
      c.derivative[i] = (a.derivative[i] - c.value * b.derivative[i]) * inverse;
    return c;
  }

  friend auto operator<(const Dual& a, const Dual& b) { return a.value < b.value; }
  friend auto operator<=(const Dual& a, const Dual& b) { return a.value <= b.value; }
  friend auto operator>(const Dual& a, const Dual& b) { return a.value > b.value; }
  friend auto operator>=(const Dual& a, const Dual& b) { return a.value >= b.value; }
  friend auto operator==(const Dual& a, const Dual& b) { return a.value == b.value; }
  friend auto operator!=(const Dual& a, const Dual& b) { return a.value != b.value; }

  /// a where the condition (or a lane of the mask) holds, b elsewhere, with its derivatives.
  template <class Mask>
  friend Dual select(const Mask& mask, const Dual& a, const Dual& b) {
    return combine([&mask](const T& x, const T& y) -> T { return select(mask, x, y); }, a, b);
  }
  friend Dual abs(const Dual& a) { return select(a < Dual(0), -a, a); }
  friend Dual min(const Dual& a, const Dual& b) { return select(b < a, b, a); }
  friend Dual max(const Dual& a, const Dual& b) { return select(a < b, b, a); }

  /// No derivative at 0.
  friend Dual sqrt(const Dual& a) {
    using std::sqrt;
    const T root = sqrt(a.value);
    return a.chain(root, T(0.5) / root);
  }
  friend Dual log(const Dual& a) {
    using std::log;
    return a.chain(log(a.value), T(1) / a.value);
  }
  friend Dual log1p(const Dual& a) {
    using std::log1p;
    return a.chain(log1p(a.value), T(1) / (T(1) + a.value));
  }
  friend Dual exp(const Dual& a) {
    using std::exp;
    const T e = exp(a.value);
    return a.chain(e, e);
  }
  friend Dual expm1(const Dual& a) {
    using std::exp, std::expm1;
    return a.chain(expm1(a.value), exp(a.value));
  }
  /// a^p with a constant p.
  friend Dual pow(const Dual& a, double p) {
    using std::pow;
    return a.chain(pow(a.value, p), T(p) * pow(a.value, p - 1));
  }
  /// a^(-1/3) for a > 0.
  friend Dual inverse_cbrt(const Dual& a) {
    const T r = inverse_cbrt(a.value);
    return a.chain(r, T(-1.0 / 3) * r / a.value);
  }

 private:
  // f of the values and of each derivative, for functions that are linear in them.
  template <class Function, class... Arguments>
  static Dual combine(Function f, const Arguments&... a) {
    Dual c;
    c.value = f(a.value...);
    for (std::size_t i = 0; i < N; ++i) c.derivative[i] = f(a.derivative[i]...);
    return c;
  }
  // A function of this value: its value and its derivative by it.
  [[nodiscard]] Dual chain(const T& f, const T& df) const {
    Dual c;
    c.value = f;
    for (std::size_t i = 0; i < N; ++i) c.derivative[i] = df * derivative[i];
    return c;
  }
};

}  // namespace softsim

/// Lets Eigen's fixed-size matrices hold duals.
template <class T, int N>
struct Eigen::NumTraits<softsim::Dual<T, N>> : Eigen::NumTraits<T> {
  using Real = softsim::Dual<T, N>;
  using NonInteger = Real;
  using Nested = Real;
  using Literal = Real;
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 0,
    ReadCost = N + 1,
    AddCost = N + 1,
    MulCost = 2 * N + 1
  };
};
