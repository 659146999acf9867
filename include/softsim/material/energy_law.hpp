// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>

#include "softsim/concepts.hpp"
#include "softsim/core/dual.hpp"
#include "softsim/core/tensor.hpp"
#include "softsim/material/isotropic.hpp"

namespace softsim {

/// Makes a `Material` of a law that gives nothing but its energy, by automatic differentiation: some ten
/// times the arithmetic of a law with derivatives by hand, and as exact. Derive `struct MyLaw :
/// EnergyLaw<MyLaw>` and give it
///
///     template <class T>
///     T energy_density(const Mat3<T>& F) const;
///
/// with psi(I) = 0 in J/m^3, any dependence on F, and no branch on values: `select(mask, a, b)`, `max`,
/// `abs`. Wherever psi is not twice differentiable the stress and its differential are those of the branch
/// taken. The digits at small strain are those of psi as written (see `Invariants`).
template <class Law>
class EnergyLaw {
 public:
  /// P = dpsi/dF, Pa.
  template <class Derived>
  [[nodiscard]] auto first_piola(const Eigen::MatrixBase<Derived>& F_) const {
    using T = typename Derived::Scalar;
    const Mat3<T>& F = F_.derived();
    return gradient(F);
  }

  /// S = F^-1 P, Pa. Needs J != 0.
  template <class Derived>
  [[nodiscard]] auto second_piola(const Eigen::MatrixBase<Derived>& F_) const {
    using T = typename Derived::Scalar;
    const Mat3<T>& F = F_.derived();
    const Mat3<T> c = cofactor(F);
    const T inverse_j = T(1) / F.col(0).dot(c.col(0));
    const Mat3<T> cP = c.transpose() * gradient(F);
    const Mat3<T> S = inverse_j * cP;
    return S;
  }

  /// dP(F; dF), the directional derivative of the first Piola-Kirchhoff stress, Pa.
  template <class Derived, class Other>
  [[nodiscard]] auto first_piola_differential(const Eigen::MatrixBase<Derived>& F_,
                                              const Eigen::MatrixBase<Other>& dF_) const {
    using T = typename Derived::Scalar;
    const Mat3<T>& F = F_.derived();
    const Mat3<T>& dF = dF_.derived();
    Mat3<Dual<T, 1>> along;
    for (int i = 0; i < 9; ++i) along(i) = Dual<T, 1>(F(i), {dF(i)});
    const Mat3<Dual<T, 1>> P = gradient(along);
    Mat3<T> dP;
    for (int i = 0; i < 9; ++i) dP(i) = P(i).derivative[0];
    return dP;
  }

 private:
  template <class T>
  [[nodiscard]] Mat3<T> gradient(const Mat3<T>& F) const {
    Mat3<Dual<T, 9>> variables;
    for (int i = 0; i < 9; ++i) variables(i) = Dual<T, 9>::variable(F(i), i);
    const Dual<T, 9> psi = static_cast<const Law&>(*this).energy_density(variables);
    Mat3<T> P;
    for (int i = 0; i < 9; ++i) P(i) = psi.derivative[static_cast<std::size_t>(i)];
    return P;
  }
};

/// Makes an `InvariantLaw` of an isotropic law that gives nothing but w(I1, I2, J), by automatic
/// differentiation in three variables: cheaper than `EnergyLaw`, and it works wherever an `InvariantLaw`
/// does. Derive `struct MyLaw : IsotropicEnergyLaw<MyLaw>` and give it
///
///     template <class T>
///     T density(const Invariants<T>& i) const;
///
/// with w(3, 3, 1) = 0 in J/m^3, and no branch on values. A law without I2 or J says so with the flags of
/// `Isotropic` and is faster.
template <class Law>
class IsotropicEnergyLaw : public Isotropic<Law> {
 public:
  /// First derivatives of w, Pa.
  template <class T>
  [[nodiscard]] First<T> first(const Invariants<T>& i) const {
    const auto w = differentiate(i);
    return {w[0], w[1], w[2]};
  }

  /// Second derivatives of w, Pa.
  template <class T>
  [[nodiscard]] Second<T> second(const Invariants<T>& i) const {
    const auto w = differentiate(variables(i));
    return {w[0].derivative[0], w[0].derivative[1], w[1].derivative[1],
            w[0].derivative[2], w[1].derivative[2], w[2].derivative[2]};
  }

 private:
  template <class T>
  [[nodiscard]] std::array<T, 3> differentiate(const Invariants<T>& i) const {
    const Dual<T, 3> w = static_cast<const Law&>(*this).density(variables(i));
    return w.derivative;
  }

  template <class T>
  static Invariants<Dual<T, 3>> variables(const Invariants<T>& i) {
    using D = Dual<T, 3>;
    return {D::variable(i.i1, 0), D::variable(i.i2, 1), D::variable(i.j, 2),
            D::variable(i.k1, 0), D::variable(i.k2, 1), D::variable(i.kj, 2)};
  }
};

}  // namespace softsim
