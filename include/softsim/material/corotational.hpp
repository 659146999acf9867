// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <limits>
#include <utility>

#include "softsim/core/batch.hpp"
#include "softsim/core/polar.hpp"
#include "softsim/core/tensor.hpp"
#include "softsim/material/lame.hpp"
#include "softsim/material/principal_tangent.hpp"

namespace softsim {

/// Corotational linear elasticity: psi = mu |F - R|^2 + lambda/2 (tr S - 3)^2 with F = R S, R the nearest
/// rotation (det R = +1). Linear elasticity in the axes that turn with the material, so exact under rotation,
/// for small strain. Defined for every F; an inverted element is drawn back, because R stays proper.
///
/// P = 2 mu (F - R) + lambda (tr S - 3) R = R (2 mu (S - I) + lambda tr(S - I) I): R : dR = 0 and F : dR = 0,
/// since R^T dR is skew. On linear tetrahedra the nodal forces are those of 'stiffness warping',
/// R K0 (R^T x - X), whenever R is the polar factor of the element's own F; with another R (of the last step,
/// averaged at nodes, by Gram-Schmidt) the warped forces have no energy.
///
/// dP holds the derivative of R: dR = R [w]x with (tr S I - S) w = axial(R^T dF). It grows without bound
/// towards s2 + s3 = 0 (singular values, the last signed like det F), where R jumps, the force with it, and
/// psi has a ridge; the divisor is held off zero there, and dP is finite.
class Corotational : public LameLaw<Corotational> {
 public:
  /// psi(F), J/m^3.
  template <class Derived>
  [[nodiscard]] auto energy_density(const Eigen::MatrixBase<Derived>& F) const {
    using T = typename Derived::Scalar;
    const Mat3<T> R = rotation_factor<T>(F), D = F - R;
    const T t = double_dot(R, D);  // tr S - 3, without the cancellation: R : R = 3
    return T(T(mu()) * double_dot(D, D) + T(lambda() / 2) * t * t);
  }
  /// P, Pa.
  template <class Derived>
  [[nodiscard]] auto first_piola(const Eigen::MatrixBase<Derived>& F) const {
    using T = typename Derived::Scalar;
    const Mat3<T> R = rotation_factor<T>(F), D = F - R;
    const T two_mu = T(2 * mu()), pressure = T(lambda()) * double_dot(R, D);
    return Mat3<T>(two_mu * D + pressure * R);
  }
  /// dP(F; dF) = 2 mu (dF - dR) + lambda ((R : dF) R + (tr S - 3) dR), exact, Pa. Indefinite in compression.
  template <class Derived, class Other>
  [[nodiscard]] auto first_piola_differential(const Eigen::MatrixBase<Derived>& F,
                                              const Eigen::MatrixBase<Other>& dF_) const {
    using T = typename Derived::Scalar;
    const Mat3<T> R = rotation_factor<T>(F), D = F - R, dF = dF_;
    const Mat3<T> dR = rotation_differential<T>(R, F, dF);
    const T two_mu = T(2 * mu()), pressure = T(lambda()) * double_dot(R, D) - two_mu;
    const T change = T(lambda()) * double_dot(R, dF);
    return Mat3<T>(two_mu * dF + change * R + pressure * dR);
  }

 private:
  friend LameLaw<Corotational>;
  explicit Corotational(Lame lame) : LameLaw(lame) {}

  template <class T>
  static Mat3<T> rotation_differential(const Mat3<T>& R, const Mat3<T>& F, const Mat3<T>& dF) {
    using std::max;
    using Real = decltype(lane(std::declval<T>(), 0));
    const Mat3<T> S = symmetric_part<T>(R.transpose() * F), M = R.transpose() * dF;
    const T t = trace(S);
    const Mat3<T> G = t * Mat3<T>::Identity() - S, adjugate = cofactor(G);
    // det G = (s1 + s2)(s1 + s3)(s2 + s3) >= 0 but for rounding
    const T det = G.col(0).dot(adjugate.col(0));
    constexpr Real eps = std::numeric_limits<Real>::epsilon();
    const T least = T(eps) * t * t * t + T(std::numeric_limits<Real>::min());
    const Vec3<T> a = axial(M), w = adjugate * a / max(det, least);
    return R * skew(w);
  }
};

/// Tangent of corotational elasticity in principal axes: with w = mu sum (s_i - 1)^2 + lambda/2 (sum s_i -
/// 3)^2, flip is 2 mu and twist 2 mu + 2 (lambda (tr S - 3) - 2 mu)/(s_i + s_j), the divisor held off zero.
/// Project with `SpdFilter::clamp`: the absolute value of what has no bound near s2 + s3 = 0 is a stiffness
/// without bound.
template <class T>
[[nodiscard]] PrincipalTangent<T> principal_tangent(const Corotational& law, const Mat3<T>& F) {
  using std::max;
  using Real = decltype(lane(std::declval<T>(), 0));
  const SignedSvd<T> svd = signed_svd(F);
  const Vec3<T>& s = svd.s;
  const T two_mu = T(2 * law.mu()), lambda = T(law.lambda());
  const T change = (s[0] - T(1)) + (s[1] - T(1)) + (s[2] - T(1));
  const T least = T(std::numeric_limits<Real>::epsilon()) * s[0] + T(std::numeric_limits<Real>::min());
  PrincipalTangent<T> K;
  K.U = svd.U;
  K.V = svd.V;
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    K.stretch(k, k) = two_mu + lambda;
    K.stretch(i, j) = K.stretch(j, i) = lambda;
    K.flip[k] = two_mu;
    K.twist[k] = two_mu + T(2) * (lambda * change - two_mu) / max(T(s[i] + s[j]), least);
  }
  return K;
}

/// Corotational elasticity whose products leave out the derivative of R, dP = R (2 mu sym(R^T dF) + lambda
/// tr(R^T dF) I): the 'warped stiffness' R K0 R^T of real-time codes. Energy and force are those of
/// `Corotational`. The matrix is cheaper and never indefinite, whatever F, but Newton's method with it
/// converges linearly, and not at all under compression near buckling.
class WarpedStiffness : public LameLaw<WarpedStiffness> {
 public:
  /// psi(F), J/m^3.
  template <class Derived>
  [[nodiscard]] auto energy_density(const Eigen::MatrixBase<Derived>& F) const {
    return exact_.energy_density(F);
  }
  /// P, Pa.
  template <class Derived>
  [[nodiscard]] auto first_piola(const Eigen::MatrixBase<Derived>& F) const {
    return exact_.first_piola(F);
  }
  /// The approximate differential, positive semidefinite in dF, Pa.
  template <class Derived, class Other>
  [[nodiscard]] auto first_piola_differential(const Eigen::MatrixBase<Derived>& F,
                                              const Eigen::MatrixBase<Other>& dF) const {
    using T = typename Derived::Scalar;
    const Mat3<T> R = rotation_factor<T>(F), M = R.transpose() * dF;
    const T two_mu = T(2 * mu()), pressure = T(lambda()) * trace(M);
    const Mat3<T> stress = two_mu * symmetric_part<T>(M) + pressure * Mat3<T>::Identity();
    return Mat3<T>(R * stress);
  }

 private:
  friend LameLaw<WarpedStiffness>;
  explicit WarpedStiffness(Lame lame)
      : LameLaw(lame), exact_(Corotational::from_lame(lame.lambda, lame.mu)) {}
  Corotational exact_;
};

}  // namespace softsim
