// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>

#include "softsim/core/elementary.hpp"
#include "softsim/material/isochoric.hpp"

namespace softsim {

/// Law that couples shape and volume: w = W(I1, I2) - m ln J + U(J) with m = 2 (W1 + 2 W2) at rest, the term
/// without which W alone would shrink the rest shape (Goulette & Chen 2015, Table 3, "incompressible", and
/// Eq. 26, corrected). U is the penalty on the change of volume: the stiffer, the closer to incompressible.
/// Defined for J > 0 (nothing finite is returned elsewhere; see `Continued`). At small strain mu = 2 (W1 +
/// W2) and lambda = U''(1) + 4 (W2 + W11 + 4 W12 + 4 W22).
template <DistortionEnergy W, VolumeLaw U>
class Coupled : public Isotropic<Coupled<W, U>> {
 public:
  static constexpr bool depends_on_i2 = W::depends_on_i2, linear_in_i1 = W::linear_in_i1;
  static constexpr bool separable_in_j = true;

  /// @throws std::invalid_argument unless both small-strain moduli are positive and finite
  Coupled(const W& distortion, const U& volume) : distortion_(distortion), volume_(volume) {
    const First<double> rest = distortion.first(Invariants<double>{3, 3, 1});
    m_ = 2 * (rest.w1 + 2 * rest.w2);
    require_stiff_at_rest(*this, energy_name<W>());
  }

  /// w, J/m^3.
  template <class T>
  [[nodiscard]] T density(const Invariants<T>& i) const {
    using std::log1p;
    return distortion_.density(i) - T(m_) * log1p(i.kj) + volume_.density(i.kj);
  }
  /// First derivatives of w, Pa.
  template <class T>
  [[nodiscard]] First<T> first(const Invariants<T>& i) const {
    using std::sqrt;
    First<T> w = distortion_.first(i);
    const T root = sqrt(i.j);  // not a number for J < 0, where m/J would be one
    w.wj = volume_.first(i.kj) - T(m_) / (root * root);
    return w;
  }
  /// Second derivatives of w, Pa.
  template <class T>
  [[nodiscard]] Second<T> second(const Invariants<T>& i) const {
    using std::sqrt;
    Second<T> w = distortion_.second(i);
    const T root = sqrt(i.j), j = root * root;
    w.wjj = volume_.second(i.kj) + T(m_) / (j * j);
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
  W distortion_;
  U volume_;
  double m_;
};

}  // namespace softsim
