// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include "softsim/core/tensor.hpp"

namespace softsim {

/// Inverse of a 3x3 matrix by its cofactors; false if A is symmetric and not positive definite.
template <class T>
[[nodiscard]] bool invert(const Mat3<T>& A, Mat3<T>& inverse) {
  const Mat3<T> c = cofactor(A);
  const T det = A.col(0).dot(c.col(0));
  inverse = c.transpose() / det;
  return A(0, 0) > T(0) && c(2, 2) > T(0) && det > T(0);
}

/// Symmetric 6x6 matrix over displacement and rotation of one frame, [tt tr; tr^T rr].
template <class T>
struct FrameBlock {
  Mat3<T> tt, tr, rr;

  /// Its first three rows times (x, y).
  [[nodiscard]] Vec3<T> translational(const Vec3<T>& x, const Vec3<T>& y) const { return tt * x + tr * y; }
  /// Its last three rows times (x, y).
  [[nodiscard]] Vec3<T> rotational(const Vec3<T>& x, const Vec3<T>& y) const {
    return tr.transpose() * x + rr * y;
  }
};

/// Inverse by way of the Schur complement of tt; false if A is not positive definite.
template <class T>
[[nodiscard]] bool invert(const FrameBlock<T>& A, FrameBlock<T>& inverse) {
  Mat3<T> D;
  if (!invert(A.tt, D)) return false;
  if (!invert(Mat3<T>(A.rr - A.tr.transpose() * D * A.tr), inverse.rr)) return false;
  inverse.tr = -D * A.tr * inverse.rr;
  inverse.tt = D - inverse.tr * A.tr.transpose() * D;
  return true;
}

/// A with rows and columns of an identity where `free`, 1 or 0 per component, is 0.
template <class T>
[[nodiscard]] FrameBlock<T> restricted(const FrameBlock<T>& A, const Vec3<T>& free_t, const Vec3<T>& free_r) {
  FrameBlock<T> B{free_t.asDiagonal() * A.tt * free_t.asDiagonal(),
                  free_t.asDiagonal() * A.tr * free_r.asDiagonal(),
                  free_r.asDiagonal() * A.rr * free_r.asDiagonal()};
  B.tt.diagonal() += Vec3<T>::Ones() - free_t;
  B.rr.diagonal() += Vec3<T>::Ones() - free_r;
  return B;
}

}  // namespace softsim
