// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Geometry>

namespace softsim {

/// Column vector of three scalars (a plain scalar or a Batch).
template <class T>
using Vec3 = Eigen::Matrix<T, 3, 1>;
/// 3x3 tensor of scalars (a plain scalar or a Batch).
template <class T>
using Mat3 = Eigen::Matrix<T, 3, 3>;
/// Flat vector over all unknowns of a system; see core/state.hpp for its layout.
template <class T>
using Vector = Eigen::Matrix<T, Eigen::Dynamic, 1>;

/// Double contraction A : B = sum_ij A_ij B_ij.
template <class T>
[[nodiscard]] T double_dot(const Mat3<T>& A, const Mat3<T>& B) {
  // column by column: three short sums wait less than a long one
  const T x = A(0) * B(0) + A(1) * B(1) + A(2) * B(2), y = A(3) * B(3) + A(4) * B(4) + A(5) * B(5);
  return x + y + (A(6) * B(6) + A(7) * B(7) + A(8) * B(8));
}

/// Trace of A.
template <class T>
[[nodiscard]] T trace(const Mat3<T>& A) {
  return A(0) + A(4) + A(8);
}

/// Cofactor matrix, dJ/dF for J = det F; equals J F^-T where F is regular, and stays exact where it is not.
template <class T>
[[nodiscard]] Mat3<T> cofactor(const Mat3<T>& F) {
  Mat3<T> c;
  c.col(0) = F.col(1).cross(F.col(2));
  c.col(1) = F.col(2).cross(F.col(0));
  c.col(2) = F.col(0).cross(F.col(1));
  return c;
}

/// Derivative of the cofactor matrix at F in the direction dF.
template <class T>
[[nodiscard]] Mat3<T> cofactor_differential(const Mat3<T>& F, const Mat3<T>& dF) {
  Mat3<T> c;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    c.col(i) = dF.col(j).cross(F.col(k)) + F.col(j).cross(dF.col(k));
  }
  return c;
}

/// Determinant as a triple product.
template <class T>
[[nodiscard]] T determinant(const Mat3<T>& F) {
  return F.col(0).dot(F.col(1).cross(F.col(2)));
}

/// Symmetric part (A + A^T)/2.
template <class T>
[[nodiscard]] Mat3<T> symmetric_part(const Mat3<T>& A) {
  return T(0.5) * (A + A.transpose());
}

/// Cross-product matrix [v]x, so that [v]x w = v x w.
template <class T>
[[nodiscard]] Mat3<T> skew(const Vec3<T>& v) {
  Mat3<T> m;
  m << T(0), -v[2], v[1], v[2], T(0), -v[0], -v[1], v[0], T(0);
  return m;
}

/// Symmetric matrix B with A : [v]x^2 = v . B v for every v: sym(A) - tr(A) I, since [v]x^2 = v v^T - |v|^2
/// I. With A = R^T P A_i^T it is the second derivative of P : R exp([v]x) A_i along a rotation.
template <class T>
[[nodiscard]] Mat3<T> squared_skew_form(const Mat3<T>& A) {
  Mat3<T> B = symmetric_part(A);
  B.diagonal().array() -= trace(A);
  return B;
}

/// Vector a with A : [v]x = a . v for every v (twice the axial vector of the skew part of A).
template <class T>
[[nodiscard]] Vec3<T> axial(const Mat3<T>& A) {
  return Vec3<T>(A(2, 1) - A(1, 2), A(0, 2) - A(2, 0), A(1, 0) - A(0, 1));
}

}  // namespace softsim
