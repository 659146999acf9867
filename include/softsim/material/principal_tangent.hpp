// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

#include "softsim/concepts.hpp"
#include "softsim/core/batch.hpp"
#include "softsim/core/polar.hpp"
#include "softsim/core/signed_svd.hpp"
#include "softsim/core/symmetric_eigen.hpp"
#include "softsim/core/tensor.hpp"

namespace softsim {

/// What happens to negative eigenvalues of a tangent: nothing; zero in their place (Teran, Sifakis, Irving,
/// Fedkiw 2005); their absolute value (Chen et al. 2024, "Stabler Neo-Hookean Simulation: Absolute Eigenvalue
/// Filtering for Projected Newton").
enum class SpdFilter { none, clamp, absolute };

/// d^2 psi/dF^2 of an isotropic energy at F = U diag(s) V^T, in Pa, in the frames of U and V, where it falls
/// apart: a 3x3 block w_ij = d^2w/ds_i ds_j between the stretches, and for each pair (i, j) of axes the
/// eigenvalues (w_i - w_j)/(s_i - s_j) on the symmetric tensor U (E_ij + E_ji) V^T ("flip") and
/// (w_i + w_j)/(s_i + s_j) on the antisymmetric U (E_ij - E_ji) V^T ("twist"); Stomakhin, Howes, Schroeder,
/// Teran 2012; Smith, de Goes, Kim 2019. Entry k of `flip` and `twist` belongs to the pair without k.
template <class T>
struct PrincipalTangent {
  Mat3<T> U, V;
  Mat3<T> stretch;
  Vec3<T> flip, twist;

  // Flattened: without, g++ calls the operations on batches one by one, three times as slow.
  /// dP(F; dF).
  template <class Derived>
  [[nodiscard, gnu::flatten]] Mat3<T> operator()(const Eigen::MatrixBase<Derived>& dF) const {
    const Mat3<T> UtD = U.transpose() * dF.derived(), D = UtD * V;
    Mat3<T> R;
    for (int k = 0; k < 3; ++k) {
      const int i = (k + 1) % 3, j = (k + 2) % 3;
      const T symmetric = T(0.5) * flip[k] * (D(i, j) + D(j, i));
      const T antisymmetric = T(0.5) * twist[k] * (D(i, j) - D(j, i));
      R(i, j) = symmetric + antisymmetric;
      R(j, i) = symmetric - antisymmetric;
      R(k, k) = stretch(k, 0) * D(0, 0) + stretch(k, 1) * D(1, 1) + stretch(k, 2) * D(2, 2);
    }
    const Mat3<T> UR = U * R;
    return UR * V.transpose();
  }

  /// K with dP(F; v b^T) a = K v for every v: with gradients of shape functions for a and b, K is their block
  /// of an element's Hessian (per volume).
  [[nodiscard, gnu::flatten]] Mat3<T> block(const Vec3<T>& a, const Vec3<T>& b) const {
    return block_of_turned(V.transpose() * a, V.transpose() * b);
  }
  /// The same from p = V^T a and q = V^T b, for those who need several blocks.
  [[nodiscard, gnu::flatten]] Mat3<T> block_of_turned(const Vec3<T>& p, const Vec3<T>& q) const {
    Mat3<T> K;
    for (int k = 0; k < 3; ++k) {
      const int i = (k + 1) % 3, j = (k + 2) % 3;
      const T beta = T(0.5) * (flip[k] - twist[k]);
      K(i, j) = stretch(i, j) * p[i] * q[j] + beta * p[j] * q[i];
      K(j, i) = stretch(j, i) * p[j] * q[i] + beta * p[i] * q[j];
      K(k, k) = stretch(k, k) * p[k] * q[k] + T(0.5) * (flip[j] + twist[j]) * p[i] * q[i] +
                T(0.5) * (flip[i] + twist[i]) * p[j] * q[j];
    }
    const Mat3<T> UK = U * K;
    return UK * U.transpose();
  }

  /// The tangent with its negative eigenvalues replaced; what has none stays as it is to the last bit. The
  /// one branch skips the eigenvalues of `stretch` where no lane needs them: a lane's result does not depend
  /// on its neighbours.
  [[nodiscard]] PrincipalTangent filtered(SpdFilter filter) const {
    using std::min;
    if (filter == SpdFilter::none) return *this;
    PrincipalTangent result = *this;
    // What has to be added to an eigenvalue. NaN stays NaN: the comparison fails and the sum keeps it.
    const T factor = filter == SpdFilter::clamp ? T(-1) : T(-2);
    const auto correction = [&factor](const T& x) { return select(x < T(0), T(factor * x), T(0)); };
    // Not by a sum: an eigenvalue of minus infinity (`Corotational` at F = 0) would become NaN.
    const auto replaced = [&filter](const T& x) {
      return select(x < T(0), filter == SpdFilter::clamp ? T(0) : T(-x), x);
    };
    for (int k = 0; k < 3; ++k) {
      result.flip[k] = replaced(flip[k]);
      result.twist[k] = replaced(twist[k]);
    }
    // Positive definite if all leading minors are positive (Sylvester); `min` keeps a NaN of its first.
    const T minor = stretch(0, 0) * stretch(1, 1) - stretch(0, 1) * stretch(0, 1);
    const auto positive = min(T(min(determinant(stretch), minor)), stretch(0, 0)) > T(0);
    if (detail::everywhere(positive)) return result;
    const SymmetricEigen<T> eigen = symmetric_eigen(stretch);
    Mat3<T> sum = Mat3<T>::Zero();
    for (int k = 0; k < 3; ++k) {
      const T c = correction(eigen.values[k]);
      const Vec3<T> v = eigen.V.col(k), cv = c * v;
      sum += cv * v.transpose();
    }
    for (int i = 0; i < 9; ++i) result.stretch(i) += select(positive, T(0), sum(i));
    return result;
  }
};

/// Tangent of a law w(I1, I2, J) at F. The quotients of its stretch derivatives are polynomials of the
/// stretches, so that nothing is lost where stretches coincide or cancel:
///   w_i = 2 w1 s_i + 2 w2 s_i (s_j^2 + s_k^2) + wJ s_j s_k,
///   (w_i -+ w_j)/(s_i -+ s_j) = 2 w1 + 2 w2 (s_k^2 -+ s_i s_j) -+ wJ s_k.
template <class Law, class T>
requires InvariantLaw<Law>
[[nodiscard]] PrincipalTangent<T> principal_tangent(const Law& law, const Mat3<T>& F) {
  const SignedSvd<T> svd = signed_svd(F);
  const Vec3<T>& s = svd.s;
  const Vec3<T> s2(s[0] * s[0], s[1] * s[1], s[2] * s[2]);
  const T i2 = Law::depends_on_i2 ? s2[0] * s2[1] + s2[1] * s2[2] + s2[2] * s2[0] : T(0);
  const Invariants<T> invariants{s2[0] + s2[1] + s2[2], i2, Law::depends_on_j ? determinant(F) : T(1)};
  const First<T> w = law.first(invariants);
  const Second<T> h = law.second(invariants);

  PrincipalTangent<T> K;
  K.U = svd.U;
  K.V = svd.V;
  Vec3<T> d1, d2, dj;  // derivatives of I1, I2, J by the stretches
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    d1[k] = T(2) * s[k];
    T twice_w1 = T(2) * w.w1, diagonal = twice_w1, off_diagonal(0);
    K.flip[k] = K.twist[k] = twice_w1;
    if constexpr (Law::depends_on_i2) {
      const T twice_w2 = T(2) * w.w2, product = s[i] * s[j];
      d2[k] = d1[k] * (s2[i] + s2[j]);
      diagonal += twice_w2 * (s2[i] + s2[j]);
      off_diagonal += T(2) * twice_w2 * product;
      K.flip[k] += twice_w2 * (s2[k] - product);
      K.twist[k] += twice_w2 * (s2[k] + product);
    }
    if constexpr (Law::depends_on_j) {
      const T wj = w.wj * s[k];
      dj[k] = s[i] * s[j];
      off_diagonal += wj;
      K.flip[k] -= wj;
      K.twist[k] += wj;
    }
    K.stretch(k, k) = diagonal;
    K.stretch(i, j) = K.stretch(j, i) = off_diagonal;
  }
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j <= i; ++j) {
      T sum(0);
      if constexpr (!Law::linear_in_i1) sum += h.w11 * d1[i] * d1[j];
      if constexpr (Law::depends_on_i2)
        sum += h.w12 * (d1[i] * d2[j] + d2[i] * d1[j]) + h.w22 * d2[i] * d2[j];
      if constexpr (Law::depends_on_j) {
        sum += h.wjj * dj[i] * dj[j];
        if constexpr (!Law::linear_in_i1) sum += h.w1j * (d1[i] * dj[j] + dj[i] * d1[j]);
        if constexpr (Law::depends_on_i2) sum += h.w2j * (d2[i] * dj[j] + dj[i] * d2[j]);
      }
      K.stretch(i, j) += sum;
      if (i != j) K.stretch(j, i) += sum;
    }
  return K;
}

/// Where the tangent of a law w = c I1 + f(J) is sure to have no negative eigenvalue, without the singular
/// values s: all eigenvalues of two symmetric tensors have to stand above rounding errors.
///  - flip and twist are 2 w1 -+ wJ s_k, positive if 4 w1^2 I - wJ^2 C is; all its leading minors have to be
///    (Sylvester).
///  - `stretch` = 2 w1 I + wJ [s_k off the diagonal] + wJJ d d^T, d = J / s, is positive if the coefficients
///    of its characteristic polynomial alternate; they are functions of the invariants.
template <class Law, class T>
requires(InvariantLaw<Law> && !Law::depends_on_i2 && Law::linear_in_i1)
    [[nodiscard]] auto surely_positive(const Law& law, const Mat3<T>& F) {
  using std::min;
  using Real = decltype(lane(std::declval<T>(), 0));
  constexpr bool single = std::is_same_v<Real, float>;
  const Mat3<T> C = F.transpose() * F, c = cofactor(F);
  const T i1 = trace(C), i2 = double_dot(c, c), j = F.col(0).dot(c.col(0));
  const Invariants<T> i{i1, T(0), j};
  const First<T> w = law.first(i);
  const T a = T(2) * w.w1, b2 = w.wj * w.wj;

  const T above = T(1 - 32 * std::numeric_limits<Real>::epsilon()) * a * a;
  const Mat3<T> M = above * Mat3<T>::Identity() - b2 * C;
  const T minor = M(0, 0) * M(1, 1) - M(0, 1) * M(0, 1);
  const T flip_and_twist = min(T(min(determinant(M), minor)), M(0, 0));

  // The polynomial is further from its roots' digits: a root has to stand above the fourth root of epsilon.
  const T s = T(single ? 0.98 : 0.9999) * a, s2 = s * s, bj = w.wj * j, wjj = law.second(i).wjj;
  const T det = s * (s2 - b2 * i1) + T(2) * b2 * bj + wjj * (s2 * i2 + T(3) * bj * bj - T(2) * s * bj * i1);
  const T second = T(3) * s2 - b2 * i1 + T(2) * wjj * (s * i2 - bj * i1);
  const T stretch = min(T(min(det, second)), T(T(3) * s + wjj * i2));
  return detail::both(flip_and_twist > T(0), stretch > T(0));
}

}  // namespace softsim
