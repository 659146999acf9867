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

}  // namespace softsim
