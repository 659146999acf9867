// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

#include "softsim/core/batch.hpp"
#include "softsim/core/tensor.hpp"

namespace softsim {

namespace detail {

/// Below this, squares of a T lose digits to underflow; a power of two.
template <class T>
inline constexpr double smallest_root =
    std::is_same_v<decltype(lane(std::declval<T>(), 0)), float> ? 0x1p-51 : 0x1p-485;

/// (a, b) <- (c a - s b, s a + c b).
template <class T>
void turn(T& a, T& b, const T& cosine, const T& sine) {
  const T previous = a;
  a = cosine * a - sine * b;
  b = sine * previous + cosine * b;
}

/// Rotation by the smaller of the two angles that make [[a_pp, a_pq], [a_pq, a_qq]] diagonal, for use with
/// `turn`; a_qq - a_pp becomes `shift`. Without branches, and cosine^2 + sine^2 = 1 to rounding for any
/// input.
template <class T>
struct JacobiRotation {
  T cosine, sine, shift;

  JacobiRotation(const T& a_pp, const T& a_qq, const T& a_pq) {
    using std::abs, std::sqrt;
    const T d = a_qq - a_pp, b = T(2) * a_pq, h = sqrt(d * d + b * b);
    const auto descending = d < T(0);
    // The angle has the tangent y / x; the constant serves the case 0 / 0.
    const T x = abs(d) + h + T(smallest_root<T>), y = select(descending, -b, b);
    const T scale = T(1) / sqrt(x * x + y * y);
    cosine = scale * x;
    sine = scale * y;
    shift = select(descending, -h, h);
  }
};

/// Jacobi's method for a symmetric 3x3 matrix A of about unit size: V A V^T stays the given matrix while A
/// becomes diagonal. Of A only the upper triangle is used; V stays a rotation.
template <class T>
struct JacobiEigenbasis {
  Mat3<T> A;
  Mat3<T> V = Mat3<T>::Identity();

  /// One rotation in each of the three planes.
  void sweep() {
    rotate<0, 1>();
    rotate<0, 2>();
    rotate<1, 2>();
  }

 private:
  template <int p, int q>
  void rotate() {
    constexpr int r = 3 - p - q;
    const JacobiRotation<T> J(A(p, p), A(q, q), A(p, q));
    const T sum = A(p, p) + A(q, q);
    A(p, p) = T(0.5) * (sum - J.shift);
    A(q, q) = T(0.5) * (sum + J.shift);
    A(p, q) = T(0);
    turn(A(p < r ? p : r, p < r ? r : p), A(q < r ? q : r, q < r ? r : q), J.cosine, J.sine);
    for (int i = 0; i < 3; ++i) turn(V(i, p), V(i, q), J.cosine, J.sine);
  }
};

}  // namespace detail

/// A = V diag(values) V^T with a proper rotation V; the values come in no particular order.
template <class T>
struct SymmetricEigen {
  Vec3<T> values;
  Mat3<T> V;
};

/// Eigenvalues and eigenvectors of a symmetric 3x3 tensor, of which the upper triangle is used, by four
/// sweeps of Jacobi's method without branches on values. Values and A itself are reproduced to a few machine
/// epsilons times the largest entry, V is orthogonal to a few epsilons, multiple eigenvalues included. NaN
/// and infinity give NaN.
template <class T>
[[nodiscard, gnu::flatten]] SymmetricEigen<T> symmetric_eigen(const Mat3<T>& A) {
  using std::abs, std::max;
  using Real = decltype(lane(std::declval<T>(), 0));
  T size = T(std::numeric_limits<Real>::min());
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i <= j; ++i) size = max(size, abs(A(i, j)));
  const T inverse_size = T(1) / size;
  detail::JacobiEigenbasis<T> basis{inverse_size * A};
  for (int k = 0; k < 4; ++k) basis.sweep();
  return {Vec3<T>(size * basis.A(0, 0), size * basis.A(1, 1), size * basis.A(2, 2)), basis.V};
}

}  // namespace softsim
