// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include "softsim/core/tensor.hpp"
#include "softsim/material/lame.hpp"

namespace softsim {

/// Small-strain elasticity: psi = mu eps : eps + lambda/2 (tr eps)^2 with eps = sym(F) - I. The one law that
/// is not objective: a rigid rotation strains it. Its stress is P itself; there is no second Piola-Kirchhoff
/// stress to tell apart from it.
class LinearElastic : public LameLaw<LinearElastic> {
 public:
  static constexpr bool objective = false;

  /// psi(F), J/m^3.
  template <class Derived>
  [[nodiscard]] auto energy_density(const Eigen::MatrixBase<Derived>& F) const {
    using T = typename Derived::Scalar;
    const Mat3<T> eps = symmetric_part<T>(F) - Mat3<T>::Identity();
    const T t = trace(eps);
    return T(T(mu()) * double_dot(eps, eps) + T(lambda() / 2) * t * t);
  }
  /// P = 2 mu eps + lambda tr(eps) I, Pa.
  template <class Derived>
  [[nodiscard]] auto first_piola(const Eigen::MatrixBase<Derived>& F) const {
    using T = typename Derived::Scalar;
    return stress<T>(symmetric_part<T>(F) - Mat3<T>::Identity());
  }
  /// dP(F; dF), independent of F, Pa.
  template <class Derived, class Other>
  [[nodiscard]] auto first_piola_differential(const Eigen::MatrixBase<Derived>&,
                                              const Eigen::MatrixBase<Other>& dF) const {
    using T = typename Derived::Scalar;
    return stress<T>(symmetric_part<T>(dF));
  }

 private:
  friend LameLaw<LinearElastic>;
  explicit LinearElastic(Lame lame) : LameLaw(lame) {}

  template <class T>
  Mat3<T> stress(const Mat3<T>& eps) const {
    const T two_mu = T(2 * mu()), pressure = T(lambda()) * trace(eps);
    return two_mu * eps + pressure * Mat3<T>::Identity();
  }
};

}  // namespace softsim
