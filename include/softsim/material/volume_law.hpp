// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <concepts>
#include <string>
#include <string_view>

#include "softsim/core/error.hpp"

namespace softsim {

/// Energy U(J) of a change of volume alone, J/m^3 of rest volume, with U(1) = 0: a function of k = J - 1,
/// which keeps the digits that J loses at small strain, with its first and second derivative by J in Pa.
template <class U, class T = double>
concept VolumeLaw = requires(const U& law, const T& k) {
  { law.density(k) } -> std::convertible_to<T>;
  { law.first(k) } -> std::convertible_to<T>;
  { law.second(k) } -> std::convertible_to<T>;
};

namespace detail {
inline double checked_volume_modulus(std::string_view law, double c) {
  if (!(c > 0) || !(c <= 1e300))
    invalid(std::string(law) + ": modulus " + to_text(c) + " Pa must be positive and finite");
  return c;
}
}  // namespace detail

/// U = c/2 (ln J)^2, for J > 0: what `NeoHookean` with lambda = c has on top of the one with lambda = 0.
/// Convex for J < e.
class LogarithmicVolume {
 public:
  /// @param c Pa
  /// @throws std::invalid_argument unless c is positive and finite
  explicit LogarithmicVolume(double c) : c_(detail::checked_volume_modulus("logarithmic volume law", c)) {}

  /// U, J/m^3.
  template <class T>
  [[nodiscard]] T density(const T& k) const {
    using std::log1p;
    const T l = log1p(k);
    return T(c_ / 2) * l * l;
  }
  /// dU/dJ, Pa.
  template <class T>
  [[nodiscard]] T first(const T& k) const {
    using std::log1p;
    return T(c_) * log1p(k) / (T(1) + k);
  }
  /// d^2U/dJ^2, Pa.
  template <class T>
  [[nodiscard]] T second(const T& k) const {
    using std::log1p;
    const T J = T(1) + k;
    return T(c_) * (T(1) - log1p(k)) / (J * J);
  }

 private:
  double c_;
};

/// U = c/2 (J - 1)^2, for every J.
class QuadraticVolume {
 public:
  /// @param c Pa
  /// @throws std::invalid_argument unless c is positive and finite
  explicit QuadraticVolume(double c) : c_(detail::checked_volume_modulus("quadratic volume law", c)) {}

  /// U, J/m^3.
  template <class T>
  [[nodiscard]] T density(const T& k) const {
    return T(c_ / 2) * k * k;
  }
  /// dU/dJ, Pa.
  template <class T>
  [[nodiscard]] T first(const T& k) const {
    return T(c_) * k;
  }
  /// d^2U/dJ^2, Pa.
  template <class T>
  [[nodiscard]] T second(const T&) const {
    return T(c_);
  }

 private:
  double c_;
};

/// U = c/4 (J^2 - 1 - 2 ln J), for J > 0 (Simo & Taylor 1982). Convex, infinite both at J -> 0 and J -> oo.
class SimoTaylorVolume {
 public:
  /// @param c = U''(1), Pa
  /// @throws std::invalid_argument unless c is positive and finite
  explicit SimoTaylorVolume(double c) : c_(detail::checked_volume_modulus("Simo-Taylor volume law", c)) {}

  /// U, J/m^3.
  template <class T>
  [[nodiscard]] T density(const T& k) const {
    using std::log1p;
    return T(c_ / 4) * (k * (k + T(2)) - T(2) * log1p(k));
  }
  /// dU/dJ, Pa.
  template <class T>
  [[nodiscard]] T first(const T& k) const {
    return T(c_ / 2) * k * (k + T(2)) / (T(1) + k);
  }
  /// d^2U/dJ^2, Pa.
  template <class T>
  [[nodiscard]] T second(const T& k) const {
    const T J = T(1) + k;
    return T(c_ / 2) * (T(1) + T(1) / (J * J));
  }

 private:
  double c_;
};

/// U = (J - 1)^2/D1 + (J - 1)^4/D2, for every J: the first two terms of the series that finite-element codes
/// use; U''(1) = 2/D1. It stays finite as J -> 0.
class TwoTermVolume {
 public:
  /// @param d1,d2 1/Pa; an infinite d2 leaves the first term alone
  /// @throws std::invalid_argument unless d1 is positive and finite and d2 positive: with a negative one the
  /// volume would lose its resistance to large changes
  TwoTermVolume(double d1, double d2) : a_(1 / d1), b_(1 / d2) {
    if (!(a_ > 0) || !(a_ <= 1e300) || !(b_ >= 0) || !(b_ <= 1e300) || !(d2 > 0))
      invalid(std::string("two-term volume law: D1 ") + to_text(d1) + " and D2 " + to_text(d2) +
              " 1/Pa must be positive");
  }

  /// U, J/m^3.
  template <class T>
  [[nodiscard]] T density(const T& k) const {
    const T k2 = k * k;
    return (T(a_) + T(b_) * k2) * k2;
  }
  /// dU/dJ, Pa.
  template <class T>
  [[nodiscard]] T first(const T& k) const {
    return (T(2 * a_) + T(4 * b_) * k * k) * k;
  }
  /// d^2U/dJ^2, Pa.
  template <class T>
  [[nodiscard]] T second(const T& k) const {
    return T(2 * a_) + T(12 * b_) * k * k;
  }

 private:
  double a_, b_;  // 1/D1 and 1/D2, Pa
};

}  // namespace softsim
