// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include "softsim/concepts.hpp"
#include "softsim/core/tensor.hpp"

namespace softsim {

/// Makes a `Material` of a law written as w(I1, I2, J). Derive `struct MyLaw : Isotropic<MyLaw>` and give it
/// `density`, `first` and `second`; see `InvariantLaw`. All functions take F (3x3, any Eigen expression) over
/// plain scalars or batches and never branch on its values.
template <class Law>
class Isotropic {
 public:
  // What a law may sharpen by declaring the same name.
  static constexpr bool depends_on_i2 = true;  ///< false: w2 and all its derivatives are zero
  static constexpr bool depends_on_j = true;   ///< false: wJ and all its derivatives are zero
  static constexpr bool linear_in_i1 = false;  ///< true: w11 = w12 = w1J = 0

  /// psi(F), J/m^3.
  template <class Derived>
  [[nodiscard]] auto energy_density(const Eigen::MatrixBase<Derived>& F_) const {
    using T = typename Derived::Scalar;
    // From H = F - I, so that small strains keep their digits: C - I = B, tr B = I1 - 3.
    const Mat3<T> H = F_ - Mat3<T>::Identity();
    const T t = trace(H), k1 = T(2) * t + double_dot(H, H);
    T k2(0), kj(0);
    if constexpr (Law::depends_on_i2) {
      const Mat3<T> B = H + H.transpose() + H.transpose() * H;
      k2 = T(2) * k1 + T(0.5) * (k1 * k1 - double_dot(B, B));
    }
    if constexpr (Law::depends_on_j) {
      const Mat3<T> c = cofactor(H);
      kj = t + trace(c) + H.col(0).dot(c.col(0));
    }
    return law().density(Invariants<T>{T(3) + k1, T(3) + k2, T(1) + kj, k1, k2, kj});
  }

  /// P = 2 (w1 + I1 w2) F - 2 w2 F C + wJ cof F, Pa.
  template <class Derived>
  [[nodiscard]] auto first_piola(const Eigen::MatrixBase<Derived>& F_) const {
    using T = typename Derived::Scalar;
    const Mat3<T>& F = F_.derived();
    Mat3<T> P;
    if constexpr (Law::depends_on_i2) {
      const Mat3<T> C = F.transpose() * F;
      const Invariants<T> i = invariants(F, C);
      const First<T> w = law().first(i);
      const T a = T(2) * (w.w1 + w.w2 * i.i1), b = T(2) * w.w2;
      const Mat3<T> FC = F * C;
      P = a * F - b * FC;
      if constexpr (Law::depends_on_j) P += w.wj * cofactor(F);
    } else {
      const Mat3<T> c = cofactor(F);
      const First<T> w = law().first(Invariants<T>{double_dot(F, F), T(0), F.col(0).dot(c.col(0))});
      const T a = T(2) * w.w1;
      P = a * F + w.wj * c;
    }
    return P;
  }

  /// S = F^-1 P = 2 (w1 + I1 w2) I - 2 w2 C + wJ J C^-1, Pa. Needs J != 0 unless w does not depend on J.
  template <class Derived>
  [[nodiscard]] auto second_piola(const Eigen::MatrixBase<Derived>& F_) const {
    using T = typename Derived::Scalar;
    const Mat3<T>& F = F_.derived();
    const Mat3<T> C = F.transpose() * F;
    const Invariants<T> i = invariants(F, C);
    const First<T> w = law().first(i);
    const T a = T(2) * (w.w1 + w.w2 * i.i1), b = T(2) * w.w2;
    Mat3<T> S = a * Mat3<T>::Identity();
    if constexpr (Law::depends_on_i2) S -= b * C;
    if constexpr (Law::depends_on_j) {
      const T c = w.wj / i.j;
      S += c * cofactor(C);
    }
    return S;
  }

  /// dP(F; dF), the directional derivative of the first Piola-Kirchhoff stress, Pa.
  template <class Derived, class Other>
  [[nodiscard]] auto first_piola_differential(const Eigen::MatrixBase<Derived>& F_,
                                              const Eigen::MatrixBase<Other>& dF_) const {
    using T = typename Derived::Scalar;
    const Mat3<T>& F = F_.derived();
    const Mat3<T>& dF = dF_.derived();
    Mat3<T> dP;
    if constexpr (!Law::depends_on_i2 && Law::linear_in_i1) {
      const Mat3<T> c = cofactor(F);
      const Invariants<T> i{double_dot(F, F), T(0), F.col(0).dot(c.col(0))};
      const First<T> w = law().first(i);
      const T a = T(2) * w.w1, ej = law().second(i).wjj * double_dot(c, dF);
      dP = a * dF + w.wj * cofactor_differential(F, dF) + ej * c;
    } else {
      const Mat3<T> C = F.transpose() * F, FC = F * C;
      const Invariants<T> i = invariants(F, C);
      const First<T> w = law().first(i);
      const Second<T> s = law().second(i);
      const T d1 = T(2) * double_dot(F, dF);
      const T d2 = i.i1 * d1 - T(2) * double_dot(FC, dF);
      T e1 = s.w11 * d1 + s.w12 * d2, e2 = s.w12 * d1 + s.w22 * d2;
      if constexpr (Law::depends_on_j) {
        const Mat3<T> c = cofactor(F);
        const T dj = double_dot(c, dF);
        e1 += s.w1j * dj;
        e2 += s.w2j * dj;
        const T ej = s.w1j * d1 + s.w2j * d2 + s.wjj * dj;
        dP = ej * c + w.wj * cofactor_differential(F, dF);
      } else {
        dP.setZero();
      }
      if constexpr (Law::depends_on_i2) {
        const Mat3<T> M = dF.transpose() * F, dC = M + M.transpose(), FdC = F * dC, dFC = dF * C;
        const T a = T(2) * (w.w1 + w.w2 * i.i1), b = T(2) * (e1 + e2 * i.i1 + w.w2 * d1);
        const T c2 = T(2) * w.w2, e = T(2) * e2;
        dP += a * dF + b * F - e * FC - c2 * (dFC + FdC);
      } else {
        const T a = T(2) * w.w1, b = T(2) * e1;
        dP += a * dF + b * F;
      }
    }
    return dP;
  }

 private:
  [[nodiscard]] const Law& law() const { return static_cast<const Law&>(*this); }

  template <class T>
  static Invariants<T> invariants(const Mat3<T>& F, const Mat3<T>& C) {
    const T i1 = trace(C);
    return {i1, Law::depends_on_i2 ? T(0.5) * (i1 * i1 - double_dot(C, C)) : T(0),
            Law::depends_on_j ? determinant(F) : T(1)};
  }
};

}  // namespace softsim
