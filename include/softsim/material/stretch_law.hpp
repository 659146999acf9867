// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <concepts>
#include <limits>
#include <type_traits>
#include <utility>

#include "softsim/core/batch.hpp"
#include "softsim/core/signed_svd.hpp"
#include "softsim/core/tensor.hpp"
#include "softsim/material/principal_tangent.hpp"

namespace softsim {

/// Principal stretches, signed singular values of F: l1 >= l2 >= |l3|. An energy is best written in `e`,
/// which comes to it with the digits that the subtraction loses at small strain: an energy is right to about
/// (epsilon / strain)^2 and rounding.
template <class T>
struct Stretches {
  Vec3<T> l;
  Vec3<T> e = Vec3<T>(l[0] - T(1), l[1] - T(1), l[2] - T(1));  ///< l - 1
};

/// Isotropic law written once, as a symmetric function w(l1, l2, l3) of the principal stretches with
/// w(1, 1, 1) = 0, J/m^3, its gradient and its matrix of second derivatives in Pa. A law that holds for
/// negative stretches too says so with `extends_to_inversion` and must then be smooth there and the same for
/// two flipped signs, w(l1, -l2, -l3) = w(l1, l2, l3), as a smooth function of F is.
template <class L, class T = double>
concept StretchLaw = requires(const L& law, const Stretches<T>& s) {
  { law.density(s) } -> std::convertible_to<T>;
  { law.first(s) } -> std::same_as<Vec3<T>>;
  { law.second(s) } -> std::same_as<Mat3<T>>;
  { L::extends_to_inversion } -> std::convertible_to<bool>;
};

/// A stretch law that knows the quotients (w_i - w_j)/(l_i - l_j) in closed form, of the pairs (2, 3), (3, 1)
/// and (1, 2) in this order. Without it they are made from `first` and `second`.
template <class L, class T = double>
concept StretchLawWithQuotients = StretchLaw<L, T> && requires(const L& law, const Stretches<T>& s) {
  { law.difference_quotients(s) } -> std::same_as<Vec3<T>>;
};

namespace detail {

/// (w_i + sign w_j)/(l_i + sign l_j) with sign = +-1, also where the denominator vanishes. With
/// g(x) = w_i + sign w_j along the path on which h = (l_i + sign l_j)/2 becomes x and everything else stays,
/// g is odd by the symmetry of the law, so that the quotient is half the mean of the even function g' = w_ii
/// + 2 sign w_ij + w_jj over [-h, h]. Close to zero that mean is taken by Lobatto's rule with four points, of
/// which two are the given state: an error of order h^6 in place of rounding over h.
template <class Law, class T>
[[nodiscard]] T stretch_quotient(const Law& law, const Stretches<T>& s, const Vec3<T>& w,
                                 const Mat3<T>& second, int i, int j, double sign) {
  using std::abs, std::max;
  const T h = T(0.5) * (s.l[i] + T(sign) * s.l[j]), m = T(0.5) * (s.l[i] - T(sign) * s.l[j]);
  constexpr bool single = std::is_same_v<decltype(lane(std::declval<T>(), 0)), float>;
  const T scale = Law::extends_to_inversion ? max(abs(m), T(1)) : abs(m);
  const auto near = abs(h) <= T(single ? 0.1 : 6e-3) * scale;  // about the seventh root of the rounding error
  const T node = h * T(0.44721359549995793928);                // 1/sqrt(5)
  Vec3<T> between = s.l;
  between[i] = m + node;
  between[j] = T(sign) * (node - m);
  const Mat3<T> there = law.second(Stretches<T>{between});
  const T mean = (second(i, i) + second(j, j) + T(5) * (there(i, i) + there(j, j)) +
                  T(2 * sign) * (second(i, j) + T(5) * there(i, j))) /
                 T(12);
  return select(near, mean, T((w[i] + T(sign) * w[j]) / (T(2) * select(near, T(1), h))));
}

}  // namespace detail

/// Tangent of a law of the principal stretches at F. The quotients of `PrincipalTangent` are those of a
/// `StretchLawWithQuotients`, or else right to about 3e-13 (single precision 1e-5) of the largest second
/// derivative, equal and nearly equal stretches included.
template <class Law, class T>
requires StretchLaw<Law>
[[nodiscard]] PrincipalTangent<T> principal_tangent(const Law& law, const Mat3<T>& F) {
  const SignedSvd<T> svd = signed_svd(F);
  const Stretches<T> s{svd.s};
  const Vec3<T> w = law.first(s);
  PrincipalTangent<T> K;
  K.U = svd.U;
  K.V = svd.V;
  K.stretch = law.second(s);
  if constexpr (StretchLawWithQuotients<Law, T>) K.flip = law.difference_quotients(s);
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    if constexpr (!StretchLawWithQuotients<Law, T>)
      K.flip[k] = detail::stretch_quotient(law, s, w, K.stretch, i, j, -1);
    if constexpr (Law::extends_to_inversion)
      K.twist[k] = detail::stretch_quotient(law, s, w, K.stretch, i, j, 1);
    else
      K.twist[k] = (w[i] + w[j]) / (s.l[i] + s.l[j]);
  }
  return K;
}

/// Makes a `Material` of a law written as w(l1, l2, l3): P = U diag(w_i) V^T. Derive
/// `struct MyLaw : FromStretches<MyLaw>` and give it `density`, `first` and `second`; see `StretchLaw`. All
/// functions take F (3x3, any Eigen expression) over plain scalars or batches and never branch on its values.
template <class Law>
class FromStretches {
 public:
  /// True for a law that is defined for negative stretches too.
  static constexpr bool extends_to_inversion = false;

  /// psi(F), J/m^3.
  template <class Derived>
  [[nodiscard]] auto energy_density(const Eigen::MatrixBase<Derived>& F_) const {
    using T = typename Derived::Scalar;
    const Mat3<T> F = F_;
    return law().density(stretches(F, signed_svd(F)));
  }

  /// P = U diag(w_i) V^T, Pa.
  template <class Derived>
  [[nodiscard]] auto first_piola(const Eigen::MatrixBase<Derived>& F_) const {
    using T = typename Derived::Scalar;
    const Mat3<T> F = F_;
    const SignedSvd<T> svd = signed_svd(F);
    const Vec3<T> w = law().first(stretches(F, svd));
    const Mat3<T> Uw = svd.U * w.asDiagonal(), P = Uw * svd.V.transpose();
    return P;
  }

  /// S = F^-1 P = V diag(w_i / l_i) V^T, Pa. Needs J != 0.
  template <class Derived>
  [[nodiscard]] auto second_piola(const Eigen::MatrixBase<Derived>& F_) const {
    using T = typename Derived::Scalar;
    const Mat3<T> F = F_;
    const SignedSvd<T> svd = signed_svd(F);
    Vec3<T> w = law().first(stretches(F, svd));
    for (int i = 0; i < 3; ++i) w[i] /= svd.s[i];
    const Mat3<T> Vw = svd.V * w.asDiagonal(), S = Vw * svd.V.transpose();
    return S;
  }

  /// dP(F; dF), the directional derivative of the first Piola-Kirchhoff stress, Pa.
  template <class Derived, class Other>
  [[nodiscard]] auto first_piola_differential(const Eigen::MatrixBase<Derived>& F,
                                              const Eigen::MatrixBase<Other>& dF) const {
    using T = typename Derived::Scalar;
    return principal_tangent(law(), Mat3<T>(F))(dF);
  }

 private:
  [[nodiscard]] const Law& law() const { return static_cast<const Law&>(*this); }

  // With H = F - I, l^2 - 1 are the eigenvalues of C - I = H + H^T + H^T H and keep the digits of H; at
  // larger strain that sum is the less exact one.
  template <class T>
  static Stretches<T> stretches(const Mat3<T>& F, const SignedSvd<T>& svd) {
    using std::abs, std::max;
    const Mat3<T> H = F - Mat3<T>::Identity(), B = H + H.transpose() + H.transpose() * H, BV = B * svd.V;
    Stretches<T> result{svd.s};
    Vec3<T> c;
    for (int i = 0; i < 3; ++i) c[i] = svd.V.col(i).dot(BV.col(i));
    const T largest = max(max(abs(c[0]), abs(c[1])), abs(c[2]));
    for (int i = 0; i < 3; ++i) {
      const auto small = (largest < T(0.5)) & (svd.s[i] > T(0));
      result.e[i] = select(small, T(c[i] / (T(1) + svd.s[i])), result.e[i]);
    }
    return result;
  }
};

}  // namespace softsim
