// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <limits>
#include <utility>

#include "softsim/core/batch.hpp"
#include "softsim/core/symmetric_eigen.hpp"
#include "softsim/core/tensor.hpp"

namespace softsim {

/// F = U diag(s) V^T with proper rotations U and V; s1 >= s2 >= |s3|, and s3 has the sign of det F.
template <class T>
struct SignedSvd {
  Mat3<T> U;
  Vec3<T> s;
  Mat3<T> V;
};

namespace detail {

// One-sided Jacobi step: turns columns p and q of B = F V until they are orthogonal.
template <int p, int q, class T>
void orthogonalise(Mat3<T>& B, Mat3<T>& V) {
  const T b_pp = B(0, p) * B(0, p) + B(1, p) * B(1, p) + B(2, p) * B(2, p);
  const T b_qq = B(0, q) * B(0, q) + B(1, q) * B(1, q) + B(2, q) * B(2, q);
  const T b_pq = B(0, p) * B(0, q) + B(1, p) * B(1, q) + B(2, p) * B(2, q);
  const JacobiRotation<T> J(b_pp, b_qq, b_pq);
  for (int i = 0; i < 3; ++i) {
    turn(B(i, p), B(i, q), J.cosine, J.sine);
    turn(V(i, p), V(i, q), J.cosine, J.sine);
  }
}

// Puts the longer of the columns p and q of B first; the sign keeps V a rotation.
template <int p, int q, class T>
void sort_columns(Mat3<T>& B, Mat3<T>& V, Vec3<T>& lengths) {
  const auto swap = lengths[p] < lengths[q];
  const auto exchange = [&swap](T& a, T& b, bool negate) {
    const T previous = a;
    a = select(swap, b, a);
    b = select(swap, negate ? -previous : previous, b);
  };
  exchange(lengths[p], lengths[q], false);
  for (int i = 0; i < 3; ++i) {
    exchange(B(i, p), B(i, q), true);
    exchange(V(i, p), V(i, q), true);
  }
}

// Givens rotation of rows p and q that makes B(q, p) zero and B(p, p) >= 0, with U B unchanged.
template <int p, int q, class T>
void eliminate(Mat3<T>& B, Mat3<T>& U) {
  using std::sqrt;
  const T a = B(p, p), b = B(q, p), square = a * a + b * b;
  const auto turns = square > T(smallest_root<T> * smallest_root<T>);
  const T inverse = T(1) / sqrt(select(turns, square, T(1)));
  const T cosine = select(turns, a * inverse, T(1)), sine = select(turns, -b * inverse, T(0));
  for (int i = 0; i < 3; ++i) {
    turn(B(p, i), B(q, i), cosine, sine);
    turn(U(i, p), U(i, q), cosine, sine);
  }
}

}  // namespace detail

/// Signed singular value decomposition (Irving, Teran, Fedkiw 2004), without branches on values. U and V are
/// orthogonal and F is reproduced to about ten machine epsilons (times the largest entry), whatever the
/// singular values: equal, zero, negative. Singular values are exact to as much, small ones usually better.
/// Where singular values coincide, U and V are one choice of many. F = 0 gives U = V = I; NaN and infinity
/// give NaN.
///
/// Jacobi's method on F^T F, then one-sided on F itself to regain the digits that squaring lost, then a QR
/// factorisation that carries the sign (the outline is that of McAdams, Selle, Tamstorf, Teran, Sifakis
/// 2011).
template <class T>
[[nodiscard, gnu::flatten]] SignedSvd<T> signed_svd(const Mat3<T>& F) {
  using std::abs, std::max;
  using Real = decltype(lane(std::declval<T>(), 0));
  T size = T(std::numeric_limits<Real>::min());
  for (int i = 0; i < 9; ++i) size = max(size, abs(F(i)));
  const T inverse_size = T(1) / size;
  const Mat3<T> G = inverse_size * F;

  detail::JacobiEigenbasis<T> basis{G.transpose() * G};
  for (int k = 0; k < 2; ++k) basis.sweep();
  Mat3<T> V = basis.V, B = G * V;
  for (int k = 0; k < 2; ++k) {
    detail::orthogonalise<0, 1>(B, V);
    detail::orthogonalise<0, 2>(B, V);
    detail::orthogonalise<1, 2>(B, V);
  }

  Vec3<T> lengths;
  for (int i = 0; i < 3; ++i) lengths[i] = B(0, i) * B(0, i) + B(1, i) * B(1, i) + B(2, i) * B(2, i);
  detail::sort_columns<0, 1>(B, V, lengths);
  detail::sort_columns<0, 2>(B, V, lengths);
  detail::sort_columns<1, 2>(B, V, lengths);

  Mat3<T> U = Mat3<T>::Identity();
  detail::eliminate<0, 1>(B, U);
  detail::eliminate<0, 2>(B, U);
  detail::eliminate<1, 2>(B, U);
  return {U, Vec3<T>(size * B(0, 0), size * B(1, 1), size * B(2, 2)), V};
}

}  // namespace softsim
