// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <utility>

#include "softsim/core/batch.hpp"
#include "softsim/core/tensor.hpp"

namespace softsim {

namespace detail {

/// Matrix N of the quadratic form q . N q = tr(R(q)^T A) over unit quaternions q = (w, x, y, z) (Horn 1987);
/// symmetric, trace 0, eigenvalues s1 + s2 + s3, s1 - s2 - s3, s2 - s1 - s3, s3 - s1 - s2 from the signed
/// singular values of A.
template <class T>
[[nodiscard]] Eigen::Matrix<T, 4, 4> quaternion_form(const Mat3<T>& A) {
  const T x = A(2, 1) - A(1, 2), y = A(0, 2) - A(2, 0), z = A(1, 0) - A(0, 1);
  const T xy = A(0, 1) + A(1, 0), xz = A(0, 2) + A(2, 0), yz = A(1, 2) + A(2, 1);
  Eigen::Matrix<T, 4, 4> N;
  N << A(0, 0) + A(1, 1) + A(2, 2), x, y, z,   //
      x, A(0, 0) - A(1, 1) - A(2, 2), xy, xz,  //
      y, xy, A(1, 1) - A(0, 0) - A(2, 2), yz,  //
      z, xz, yz, A(2, 2) - A(0, 0) - A(1, 1);
  return N;
}

/// Jacobi's eigenvalue method for a symmetric 4x4 matrix N of about unit size, without branches: V N V^T
/// stays the given matrix while N becomes diagonal. Of N only the upper triangle is used.
template <class T>
struct QuaternionEigenbasis {
  Eigen::Matrix<T, 4, 4> N;
  Eigen::Matrix<T, 4, 4> V = Eigen::Matrix<T, 4, 4>::Identity();

  /// One rotation in each of the six planes. Disjoint planes are neighbours, so that their latencies overlap.
  void sweep() {
    rotate<0, 1>();
    rotate<2, 3>();
    rotate<0, 2>();
    rotate<1, 3>();
    rotate<0, 3>();
    rotate<1, 2>();
  }

 private:
  template <int i, int j>
  T& upper() {
    return N(i < j ? i : j, i < j ? j : i);
  }

  static void turn(T& a, T& b, const T& cosine, const T& sine) {
    const T previous = a;
    a = cosine * a - sine * b;
    b = sine * previous + cosine * b;
  }

  /// Makes N(p, q) zero by the smaller of the two possible angles.
  template <int p, int q>
  void rotate() {
    using std::abs, std::sqrt;
    constexpr int r = p == 0 ? (q == 1 ? 2 : 1) : 0, s = 6 - p - q - r;
    const T sum = N(p, p) + N(q, q), d = N(q, q) - N(p, p), b = T(2) * N(p, q);
    const T h = sqrt(d * d + b * b);
    const auto descending = d < T(0);
    // The angle has the tangent y / x; the constant, far below rounding, serves the case 0 / 0.
    const auto eps = Eigen::NumTraits<T>::epsilon();
    const T x = abs(d) + h + T(eps * eps), y = select(descending, -b, b);
    const T scale = T(1) / sqrt(x * x + y * y);
    const T cosine = scale * x, sine = scale * y, shift = select(descending, -h, h);
    N(p, p) = T(0.5) * (sum - shift);
    N(q, q) = T(0.5) * (sum + shift);
    N(p, q) = T(0);
    turn(upper<p, r>(), upper<q, r>(), cosine, sine);
    turn(upper<p, s>(), upper<q, s>(), cosine, sine);
    for (int i = 0; i < 4; ++i) turn(V(i, p), V(i, q), cosine, sine);
  }
};

/// Rotation factor by Horn's quaternion form (J. Opt. Soc. Am. A 4, 1987), diagonalised by four Jacobi
/// sweeps: unlike anything made from the characteristic polynomial that also holds where the largest
/// eigenvalue is nearly multiple. A is F divided by its largest entry.
template <class T>
[[nodiscard, gnu::noinline, gnu::flatten]] Mat3<T> rotation_by_sweeps(const Mat3<T>& A) {
  using std::sqrt;
  using Real = decltype(lane(std::declval<T>(), 0));
  using Quaternion = Eigen::Matrix<T, 4, 1>;
  const Eigen::Matrix<T, 4, 4> N = quaternion_form<T>(A);

  // A small multiple of the identity added to A settles ties. It stands above the rounding errors of the
  // sweeps.
  constexpr Real tie = 32 * std::numeric_limits<Real>::epsilon();
  QuaternionEigenbasis<T> basis{N};
  basis.N(0, 0) += T(4 * tie);
  for (int k = 0; k < 4; ++k) basis.sweep();

  T largest = basis.N(0, 0);
  Quaternion q = basis.V.col(0);
  for (int k = 1; k < 4; ++k) {
    const auto better = basis.N(k, k) > largest;
    largest = select(better, basis.N(k, k), largest);
    for (int i = 0; i < 4; ++i) q[i] = select(better, basis.V(i, k), q[i]);
  }
  // First-order correction with the undisturbed form. It takes away what the tie-breaker and the last sweep
  // left where the eigenvalue is simple, and fades out where it is not.
  const Quaternion Nq = N * q;
  for (int k = 0; k < 4; ++k) {
    const T gap = largest - basis.N(k, k);
    q += (basis.V.col(k).dot(Nq) * gap / (gap * gap + T(tie))) * basis.V.col(k);
  }
  q *= T(1) / sqrt(q.dot(q));

  const T w = q[0], x = q[1], y = q[2], z = q[3];
  Mat3<T> R;
  R << T(1) - T(2) * (y * y + z * z), T(2) * (x * y - w * z), T(2) * (x * z + w * y),  //
      T(2) * (x * y + w * z), T(1) - T(2) * (x * x + z * z), T(2) * (y * z - w * x),   //
      T(2) * (x * z - w * y), T(2) * (y * z + w * x), T(1) - T(2) * (x * x + y * y);
  return R;
}

// Conditions of a plain scalar and of a batch.
inline bool both(bool a, bool b) { return a && b; }
inline bool everywhere(bool condition) { return condition; }
template <class T, int N>
[[nodiscard]] BatchMask<T, N> both(const BatchMask<T, N>& a, const BatchMask<T, N>& b) {
  return a & b;
}
template <class T, int N>
[[nodiscard]] bool everywhere(const BatchMask<T, N>& mask) {
  return all(mask);
}

/// Rotation factor in closed form, and where it is good to rounding.
template <class T>
struct ClosedRotation {
  Mat3<T> R;
  decltype(std::declval<T>() < std::declval<T>()) good;
};

/// A^T A, whose halves are the same numbers.
template <class T>
[[nodiscard]] Mat3<T> gram(const Mat3<T>& A) {
  Mat3<T> C;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j <= i; ++j) C(i, j) = C(j, i) = A.col(i).dot(A.col(j));
  return C;
}

/// The trace t = tr S = s1 + s2 + s3 is the largest root of (t^2 - |A|^2)^2 - 4 |cof A|^2 - 8 t det A = 0,
/// and R is its derivative with respect to A, which is R times a polynomial of S, so R times a symmetric
/// tensor also where t is not yet the root. Halley's method falls to the root from sqrt(3) |A| >= t; two
/// steps do for stretches of 0.7 to 1.4. Like most rounding errors, an error of t makes that symmetric tensor
/// differ from I, which one step towards the nearest orthogonal tensor takes away to second order. Everything
/// divides by (s1 + s2)(s1 + s3)(s2 + s3).
template <class T>
[[nodiscard]] ClosedRotation<T> rotation_in_closed_form(const Mat3<T>& A, int steps) {
  using std::sqrt;
  using Real = decltype(lane(std::declval<T>(), 0));
  const Mat3<T> C = gram(A), c = cofactor(A);
  const T n = trace(C), m = double_dot(c, c), j2 = T(2) * A.col(0).dot(c.col(0));
  T t = sqrt(T(3) * n);
  for (int k = 0; k < steps; ++k) {
    // a quarter of the polynomial and its first two derivatives
    const T d = t * t - n, p = T(0.25) * d * d - (m + t * j2), p1 = t * d - j2, p2 = T(2) * t * t + d;
    t -= T(2) * p * p1 / (T(2) * p1 * p1 - p * p2);
  }
  const T t2 = t * t, denominator = t * (t2 - n) - j2, scale = T(1) / denominator;
  const T a = scale * (t2 + n), b = T(-2) * scale, e = -b * t;
  Mat3<T> M = b * C;
  for (int i = 0; i < 3; ++i) M(i, i) += a;
  const Mat3<T> Q = A * M + e * c;
  Mat3<T> D = T(-0.5) * gram(Q);
  for (int i = 0; i < 3; ++i) D(i, i) += T(0.5);
  // What the square of the departure from a rotation leaves behind has to vanish in rounding, and no product
  // above, of up to seven lengths, may leave the range of the scalar.
  const auto settled = double_dot(D, D) < T(0.25 * std::numeric_limits<Real>::epsilon());
  const auto in_range = both(n > T(1e-8), n < T(1e8));
  return {Q + Q * D, both(both(denominator > T(0.05) * t2 * t, settled), in_range)};
}

/// For any F, for those that two steps do not settle: nearly ambiguous, very large or small, far from rigid.
template <class T>
[[nodiscard, gnu::noinline, gnu::flatten]] Mat3<T> rotation_of_any(const Mat3<T>& F) {
  using std::abs, std::max;
  using Real = decltype(lane(std::declval<T>(), 0));
  T size = abs(F(0));
  for (int i = 1; i < 9; ++i) size = max(size, T(abs(F(i))));
  const T inverse_size = T(1) / max(size, T(std::numeric_limits<Real>::min()));
  const Mat3<T> A = inverse_size * F;
  ClosedRotation<T> closed = rotation_in_closed_form<T>(A, 6);
  if (!everywhere(closed.good)) {
    const Mat3<T> R = rotation_by_sweeps<T>(A);
    for (int i = 0; i < 9; ++i) closed.R(i) = select(closed.good, closed.R(i), R(i));
  }
  return closed.R;
}

}  // namespace detail

/// Rotation R (det R = +1, always) that maximises tr(R^T F), the nearest rotation to F: F = R S with S
/// symmetric, indefinite where det F < 0. With F's singular values s1 >= s2 >= |s3|, s3 signed like det F, R
/// is unique unless s2 + s3 = 0 (rank 1 or 0; two equal smallest singular values of an inverted F); its error
/// is at most about 100 machine epsilons times s1 / (s2 + s3), in single precision 200. Without uniqueness
/// the result is one of the maximisers (within 128 epsilons of the largest entry of F), drawn towards the one
/// that turns least; F = 0 gives I. Defined for every finite F; R does not depend on the size of F but for
/// rounding, except that a subnormal F is drawn towards I. NaN and infinity give NaN.
///
/// A closed form serves deformations that are far from those ambiguities, Jacobi sweeps the others. The
/// branches skip what no lane needs: a lane's result does not depend on its neighbours.
template <class T>
[[nodiscard, gnu::flatten]] Mat3<T> rotation_factor(const Mat3<T>& F) {
  detail::ClosedRotation<T> closed = detail::rotation_in_closed_form<T>(F, 2);
  if (!detail::everywhere(closed.good)) {
    const Mat3<T> R = detail::rotation_of_any<T>(F);
    for (int i = 0; i < 9; ++i) closed.R(i) = select(closed.good, closed.R(i), R(i));
  }
  return closed.R;
}

/// Factors of F = R S: a rotation and a symmetric tensor.
template <class T>
struct PolarDecomposition {
  Mat3<T> R, S;
};

/// Polar decomposition with det R = +1; see `rotation_factor` for what holds where F is singular or inverted.
template <class T>
[[nodiscard]] PolarDecomposition<T> polar_decomposition(const Mat3<T>& F) {
  PolarDecomposition<T> result;
  result.R = rotation_factor(F);
  result.S = symmetric_part<T>(result.R.transpose() * F);
  return result;
}

}  // namespace softsim
