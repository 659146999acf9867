// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>

#include "softsim/kinematics/frame_sample.hpp"

namespace softsim {

/// The derivative of a first Piola-Kirchhoff stress at one F as nine matrices, dP = sum_ab dF_ab C_ab: where
/// many increments meet one F, a law is asked nine times and no more.
template <class T>
class StressTangent {
 public:
  /// Of `scale` times the stress of `law`.
  template <class Law>
  StressTangent(const Law& law, const Mat3<T>& F, const T& scale) {
    for (int k = 0; k < 9; ++k) {
      Mat3<T> unit = Mat3<T>::Zero();
      unit(k) = scale;
      along_[static_cast<std::size_t>(k)] = law.first_piola_differential(F, unit);
    }
  }
  /// dP along dF.
  [[nodiscard]] Mat3<T> operator()(const Mat3<T>& dF) const {
    Mat3<T> dP = dF(0) * along_[0];
    for (int k = 1; k < 9; ++k) dP += dF(k) * along_[static_cast<std::size_t>(k)];
    return dP;
  }
  /// dP along e_a g^T.
  [[nodiscard]] Mat3<T> operator()(int a, const Vec3<T>& g) const {
    Mat3<T> dP = g[0] * along_[static_cast<std::size_t>(a)];
    for (int b = 1; b < 3; ++b) dP += g[b] * along_[static_cast<std::size_t>(a + 3 * b)];
    return dP;
  }

 private:
  std::array<Mat3<T>, 9> along_;
};

/// Calls add(i, j, block) for the 3x3 blocks i <= j of the Hessian of `scale` times the elastic energy of one
/// sample, where block 2 i is the displacement and 2 i + 1 the rotation of frame i: K = M^T C M and K^R + K^F
/// of Bosman 2015, Eq. 3.70 and appendix B, from F's derivatives instead of the strain's.
template <int N, class Law, class T, class Add>
void add_frame_blocks(const typename FrameSample<N>::template Data<T>& data, const Local<T, 0, N>& u,
                      const Law& law, const T& scale, Add add) {
  using Sample = FrameSample<N>;
  const Mat3<T> F = Sample::deformation_gradient(data, u);
  const T v = scale * data.volume;
  const StressTangent<T> tangent(law, F, v);
  Mat3<T> P = law.first_piola(F);
  P *= v;
  // F's derivative with respect to the rotations, R_i [e_m]x A_i.
  std::array<std::array<Mat3<T>, 3>, Sample::count> turned;
  for (std::size_t i = 0; i < Sample::count; ++i) {
    const Mat3<T> R = Mat3<T>::Identity() + u.frames[i].turn;
    const Mat3<T>& A = data.lever[i];
    for (int m = 0; m < 3; ++m) {
      const int k = (m + 1) % 3, l = (m + 2) % 3;
      turned[i][static_cast<std::size_t>(m)] = R.col(l) * A.row(k) - R.col(k) * A.row(l);
    }
  }
  for (std::size_t j = 0; j < Sample::count; ++j)
    for (const int rotational : {0, 1}) {
      std::array<Mat3<T>, 3> dP;
      for (int a = 0; a < 3; ++a) {
        const auto c = static_cast<std::size_t>(a);
        dP[c] = rotational != 0 ? tangent(turned[j][c]) : tangent(a, data.gradient[j]);
      }
      const int column = 2 * static_cast<int>(j) + rotational;
      for (std::size_t i = 0; i <= j; ++i) {
        const int row = 2 * static_cast<int>(i);
        Mat3<T> block;
        for (int a = 0; a < 3; ++a) block.col(a) = dP[static_cast<std::size_t>(a)] * data.gradient[i];
        add(row, column, block);
        if (row + 1 > column) continue;
        for (int a = 0; a < 3; ++a)
          for (int m = 0; m < 3; ++m)
            block(m, a) = double_dot(turned[i][static_cast<std::size_t>(m)], dP[static_cast<std::size_t>(a)]);
        if (row + 1 == column) block += Sample::geometric_block(data, u, P, j);
        add(row + 1, column, block);
      }
    }
}

}  // namespace softsim
