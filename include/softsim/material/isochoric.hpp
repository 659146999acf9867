// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "softsim/core/elementary.hpp"
#include "softsim/material/isotropic.hpp"
#include "softsim/material/rest_moduli.hpp"
#include "softsim/material/volume_law.hpp"

namespace softsim {

/// What an adaptor makes a law of: an energy W(I1, I2), an `InvariantLaw` that does not depend on J. It may
/// declare `linear = true` where all its second derivatives are zero, and a `name` for error messages.
template <class W>
concept DistortionEnergy = InvariantLaw<W> && !W::depends_on_j;

/// Name of an energy in error messages.
template <class W>
[[nodiscard]] std::string energy_name() {
  if constexpr (requires { W::name; })
    return W::name;
  else
    return "law";
}

/// A function of J and its first two derivatives.
template <class T>
struct Jet {
  T value, first, second;

  /// By how much the second-order Taylor polynomial of the function rises over a step x.
  [[nodiscard]] T rise(const T& x) const { return (first + T(0.5) * second * x) * x; }
  /// That polynomial, a step x further.
  [[nodiscard]] Jet extended(const T& x) const { return {value + rise(x), first + second * x, second}; }
};

/// Law split into a part without and one of change of volume: w = W(I1 J^-2/3, I2 J^-4/3) + U(J) (Goulette &
/// Chen 2015, Eqs. 21-25), defined for J > 0 (nothing finite is returned elsewhere; see `Continued`). Free of
/// stress at rest for any W; the small-strain moduli are mu = 2 (W1 + W2) and bulk = U''(1).
template <DistortionEnergy W, VolumeLaw U>
class Isochoric : public Isotropic<Isochoric<W, U>> {
 public:
  static constexpr bool depends_on_i2 = W::depends_on_i2;

  /// @throws std::invalid_argument unless both small-strain moduli are positive and finite
  Isochoric(const W& distortion, const U& volume) : distortion_(distortion), volume_(volume) {
    require_stiff_at_rest(*this, energy_name<W>());
  }

  /// The functions of J that w is made of, p = J^-2/3, q = J^-4/3 and U; p - 1 and q - 1 keep the digits of
  /// small strains.
  template <class T>
  struct OfVolume {
    Jet<T> p, q, u;
    T p_minus_1, q_minus_1;

    /// All three replaced by their second-order Taylor polynomials, a step x further.
    [[nodiscard]] OfVolume extended(const T& x) const {
      return {p.extended(x), q.extended(x), u.extended(x), p_minus_1 + p.rise(x), q_minus_1 + q.rise(x)};
    }
  };
  /// The functions of J at J.
  template <class T>
  [[nodiscard]] OfVolume<T> of_volume(const Invariants<T>& i) const {
    const T r = inverse_cbrt(i.j), p = r * r, q = p * p, r3 = p * r;  // not a number for J < 0
    // r - 1 = -(J - 1) r^3 / (1 + r + r^2), without a difference of close numbers
    const T p_minus_1 = -i.kj * r3 * (T(1) + r) / (T(1) + r + p);
    return {{p, T(-2.0 / 3) * p * r3, T(10.0 / 9) * p * r3 * r3},
            {q, T(-4.0 / 3) * q * r3, T(28.0 / 9) * q * r3 * r3},
            {volume_.density(i.kj), volume_.first(i.kj), volume_.second(i.kj)},
            p_minus_1,
            p_minus_1 * (T(1) + p)};
  }

  /// w, J/m^3.
  template <class T>
  [[nodiscard]] T density(const Invariants<T>& i) const {
    return density(i, of_volume(i));
  }
  /// First derivatives of w, Pa.
  template <class T>
  [[nodiscard]] First<T> first(const Invariants<T>& i) const {
    return first(i, of_volume(i));
  }
  /// Second derivatives of w, Pa.
  template <class T>
  [[nodiscard]] Second<T> second(const Invariants<T>& i) const {
    return second(i, of_volume(i));
  }

  /// The same with given functions of J in the place of those at J.
  template <class T>
  [[nodiscard]] T density(const Invariants<T>& i, const OfVolume<T>& v) const {
    return distortion_.density(isochoric(i, v)) + v.u.value;
  }
  template <class T>
  [[nodiscard]] First<T> first(const Invariants<T>& i, const OfVolume<T>& v) const {
    const First<T> d = distortion_.first(isochoric(i, v));
    First<T> w{d.w1 * v.p.value, T(0), d.w1 * i.i1 * v.p.first + v.u.first};
    if constexpr (depends_on_i2) {
      w.w2 = d.w2 * v.q.value;
      w.wj += d.w2 * i.i2 * v.q.first;
    }
    return w;
  }
  template <class T>
  [[nodiscard]] Second<T> second(const Invariants<T>& i, const OfVolume<T>& v) const {
    const Invariants<T> iso = isochoric(i, v);
    const First<T> d = distortion_.first(iso);
    Second<T> w{T(0), T(0), T(0), d.w1 * v.p.first, T(0), d.w1 * i.i1 * v.p.second + v.u.second};
    if constexpr (depends_on_i2) {
      w.w2j = d.w2 * v.q.first;
      w.wjj += d.w2 * i.i2 * v.q.second;
    }
    if constexpr (!linear) {
      const Second<T> s = distortion_.second(iso);
      const T p = v.p.value, a = i.i1 * v.p.first;  // derivatives of I1 p by I1 and by J
      w.w11 = s.w11 * p * p;
      w.w1j += s.w11 * p * a;
      w.wjj += s.w11 * a * a;
      if constexpr (depends_on_i2) {
        const T q = v.q.value, b = i.i2 * v.q.first;
        w.w12 = s.w12 * p * q;
        w.w22 = s.w22 * q * q;
        w.w1j += s.w12 * p * b;
        w.w2j += (s.w12 * a + s.w22 * b) * q;
        w.wjj += (T(2) * s.w12 * a + s.w22 * b) * b;
      }
    }
    return w;
  }

  /// W.
  [[nodiscard]] const W& distortion() const { return distortion_; }
  /// U.
  [[nodiscard]] const U& volume() const { return volume_; }
  /// Lame parameters of small strain, Pa.
  [[nodiscard]] double lambda() const { return rest_moduli(*this).lambda; }
  [[nodiscard]] double mu() const { return rest_moduli(*this).mu; }

 private:
  static constexpr bool linear = requires { requires W::linear; };

  template <class T>
  static Invariants<T> isochoric(const Invariants<T>& i, const OfVolume<T>& v) {
    const T k1 = i.k1 + i.i1 * v.p_minus_1;
    T k2(0);
    if constexpr (depends_on_i2) k2 = i.k2 + i.i2 * v.q_minus_1;
    return {T(3) + k1, T(3) + k2, T(1), k1, k2, T(0)};
  }

  W distortion_;
  U volume_;
};

}  // namespace softsim
