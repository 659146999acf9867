// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

#include "softsim/kinematics/frame_sample.hpp"

// B and M as matrices, for who assembles or reads by hand. The kernels store neither.

namespace softsim {

/// B of frame i (9x6, Eq. 3.44): the derivative of F, column by column, with respect to the frame's
/// increment, three displacements in m and three rotations in rad about the axes of the body. Its rotational
/// part for column j is -R_i [A_i e_j]x.
template <int N, class T>
[[nodiscard]] Eigen::Matrix<T, 9, 6> deformation_gradient_matrix(
    const typename FrameSample<N>::template Data<T>& data, const Local<T, 0, N>& u, std::size_t i) {
  Eigen::Matrix<T, 9, 6> B;
  const Mat3<T> R = Mat3<T>::Identity() + u.frames[i].turn;
  for (int j = 0; j < 3; ++j) {
    B.template block<3, 3>(3 * j, 0) = data.gradient[i][j] * Mat3<T>::Identity();
    B.template block<3, 3>(3 * j, 3) = -R * skew<T>(data.lever[i].col(j));
  }
  return B;
}

/// M of frame i (6x6, Eqs. 3.49 and 3.50 with F_00 on row 3 of B): the derivative of the Green strain L =
/// (F^T F - I)/2 as `strain_to_voigt`, from B and F.
template <class T>
[[nodiscard]] Eigen::Matrix<T, 6, 6> green_strain_matrix(const Eigen::Matrix<T, 9, 6>& B, const Mat3<T>& F) {
  // 2 dL_ab along each of the six increments
  const auto twice = [&](int a, int b) -> Eigen::Matrix<T, 1, 6> {
    return F.col(a).transpose() * B.template middleRows<3>(3 * b) +
           F.col(b).transpose() * B.template middleRows<3>(3 * a);
  };
  Eigen::Matrix<T, 6, 6> M;
  for (int a = 0; a < 3; ++a) M.row(a) = T(0.5) * twice(a, a);
  M.row(3) = twice(1, 2);
  M.row(4) = twice(0, 2);
  M.row(5) = twice(0, 1);
  return M;
}

}  // namespace softsim
