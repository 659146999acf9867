// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <limits>
#include <type_traits>

#include "softsim/core/batch.hpp"
#include "softsim/core/tensor.hpp"

/// Rotations and their increments. An increment dr (rad) acts from the body side: R becomes R exp([dr]x), so
/// that dr has the components of the rotated body's own axes.
namespace softsim {

/// Rotation exp([r]x) by |r| radians around r (Rodrigues' formula); accurate to rounding for every angle,
/// r = 0 included. Also for any scalar with sin, cos, sqrt and select.
template <class T>
[[nodiscard]] Mat3<T> rotation_exponential(const Vec3<T>& r) {
  using std::cos, std::sin, std::sqrt;
  const T angle2 = r.dot(r);
  // Above this both closed forms are free of cancellation; below it the dropped terms are under a hundredth
  // of a rounding error.
  const auto tiny = angle2 < T(sqrt(Eigen::NumTraits<T>::epsilon()));
  const T angle = sqrt(select(tiny, T(1), angle2));
  const T half = sin(T(0.5) * angle) / angle;
  const T a = select(tiny, T(1) - angle2 / T(6), sin(angle) / angle);
  const T b = select(tiny, T(0.5), T(2) * half * half);
  const Mat3<T> K = skew(r);
  Mat3<T> R = a * K + b * (K * K);
  R.diagonal().array() += T(1);
  return R;
}

/// Rotation vector r in rad with rotation_exponential(r) = R, |r| <= pi (to rounding); accurate from angle 0
/// up to pi, where the sign of r is one of the two that are possible.
/// @param R rotation matrix; what it lacks in orthogonality perturbs r by as much
template <class T>
requires std::is_floating_point_v<T>
[[nodiscard]] Vec3<T> rotation_logarithm(const Mat3<T>& R) {
  // 4 q q^T of the unit quaternion q = (w, v); its column with the largest diagonal is the one without
  // cancellation.
  using Quaternion = Eigen::Matrix<T, 4, 1>;
  Eigen::Matrix<T, 4, 4> Q;
  Q << T(1) + R(0, 0) + R(1, 1) + R(2, 2), R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1),  //
      R(2, 1) - R(1, 2), T(1) + R(0, 0) - R(1, 1) - R(2, 2), R(0, 1) + R(1, 0), R(0, 2) + R(2, 0),   //
      R(0, 2) - R(2, 0), R(0, 1) + R(1, 0), T(1) - R(0, 0) + R(1, 1) - R(2, 2), R(1, 2) + R(2, 1),   //
      R(1, 0) - R(0, 1), R(0, 2) + R(2, 0), R(1, 2) + R(2, 1), T(1) - R(0, 0) - R(1, 1) + R(2, 2);
  Eigen::Index largest = 0;
  Q.diagonal().maxCoeff(&largest);
  Quaternion q = Q.col(largest);
  if (q[0] < T(0)) q = -q;
  const Vec3<T> v = q.template tail<3>();
  const T sine = v.stableNorm();
  if (sine < std::numeric_limits<T>::min()) return (T(2) / q[0]) * v;
  return (T(2) * std::atan2(sine, q[0]) / sine) * v;
}

/// Unit quaternion (x, y, z, w) of a rotation: w + x i + y j + z k, as Eigen stores it.
template <class T>
using UnitQuaternion = Eigen::Matrix<T, 4, 1>;

/// The rotation by |r| radians around r; accurate to rounding for every angle.
template <class T>
requires std::is_floating_point_v<T>
[[nodiscard]] UnitQuaternion<T> quaternion_exponential(const Vec3<T>& r) {
  const T angle = r.norm(), half = angle / 2;
  // sin(angle/2)/angle; what is dropped is below rounding
  const T s = angle < std::sqrt(std::numeric_limits<T>::epsilon()) ? T(0.5) - angle * angle / 48
                                                                   : std::sin(half) / angle;
  return {s * r[0], s * r[1], s * r[2], std::cos(half)};
}

/// Rotation vector r in rad with quaternion_exponential(r) = +-q, |r| <= pi.
template <class T>
requires std::is_floating_point_v<T>
[[nodiscard]] Vec3<T> quaternion_logarithm(const UnitQuaternion<T>& q) {
  const Vec3<T> v = q[3] < T(0) ? Vec3<T>(-q.template head<3>()) : Vec3<T>(q.template head<3>());
  const T w = std::abs(q[3]), sine = v.stableNorm();
  if (sine < std::numeric_limits<T>::min()) return (T(2) / w) * v;
  return (T(2) * std::atan2(sine, w) / sine) * v;
}

/// The rotation a after b, R(a) R(b).
template <class T>
[[nodiscard]] UnitQuaternion<T> quaternion_product(const UnitQuaternion<T>& a, const UnitQuaternion<T>& b) {
  return {a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1],
          a[3] * b[1] + a[1] * b[3] + a[2] * b[0] - a[0] * b[2],
          a[3] * b[2] + a[2] * b[3] + a[0] * b[1] - a[1] * b[0],
          a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2]};
}

/// Rotation vector r with a exp([r]x) = b, |r| <= pi.
template <class T>
[[nodiscard]] Vec3<T> rotation_between(const UnitQuaternion<T>& a, const UnitQuaternion<T>& b) {
  return quaternion_logarithm(quaternion_product<T>({-a[0], -a[1], -a[2], a[3]}, b));
}

/// R - I of the rotation matrix of a unit quaternion: it keeps its digits at small angles. Also for batches.
template <class T>
[[nodiscard]] Mat3<T> rotation_less_identity(const UnitQuaternion<T>& q) {
  const T x = q[0] + q[0], y = q[1] + q[1], z = q[2] + q[2];
  const T xx = x * q[0], yy = y * q[1], zz = z * q[2], xy = x * q[1], xz = x * q[2], yz = y * q[2];
  const T wx = x * q[3], wy = y * q[3], wz = z * q[3];
  Mat3<T> D;
  D << -(yy + zz), xy - wz, xz + wy,  //
      xy + wz, -(xx + zz), yz - wx,   //
      xz - wy, yz + wx, -(xx + yy);
  return D;
}

/// Right Jacobian of the rotation vector: exp([u + du]x) = exp([u]x) exp([J du]x) to first order. That of -u
/// is its transpose.
template <class T>
requires std::is_floating_point_v<T>
[[nodiscard]] Mat3<T> rotation_jacobian(const Vec3<T>& u) {
  const T angle2 = u.squaredNorm(), angle = std::sqrt(angle2);
  const bool tiny = angle2 < T(1e-6);  // what the series drop is below 1e-14
  const T half = tiny ? T(0) : std::sin(angle / 2) / angle;
  const T a = tiny ? T(0.5) - angle2 / 24 : 2 * half * half;
  const T b = tiny ? T(1) / 6 - angle2 / 120 : (angle - std::sin(angle)) / (angle2 * angle);
  const Mat3<T> K = skew(u);
  return Mat3<T>::Identity() - a * K + b * (K * K);
}

/// The inverse of `rotation_jacobian`, for |u| < 2 pi.
template <class T>
requires std::is_floating_point_v<T>
[[nodiscard]] Mat3<T> rotation_jacobian_inverse(const Vec3<T>& u) {
  const T angle2 = u.squaredNorm(), half = std::sqrt(angle2) / 2;
  // (1 - half cot half)/angle^2
  const T c = angle2 < T(1e-3) ? T(1) / 12 + angle2 / 720 + angle2 * angle2 / 30240
                               : (1 - half / std::tan(half)) / angle2;
  const Mat3<T> K = skew(u);
  return Mat3<T>::Identity() + T(0.5) * K + c * (K * K);
}

}  // namespace softsim
