// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>

#include "softsim/concepts.hpp"
#include "softsim/core/error.hpp"
#include "softsim/core/voigt.hpp"

namespace softsim {

/// A sample of volume between N frames (Bosman 2015, Sec. 3.5): frame i carries the body around it rigidly,
/// and shape functions w_i blend what they carry. A point at rest at X is at
///   x = sum_i w_i(X) (x_i + R_i (X - X_i)),
/// x_i and R_i being position and rotation from rest of frame i (Eqs. 3.33 and 3.34; the frame's own axes at
/// rest cancel), so that (Eq. 3.40)
///   F = sum_i x_i g_i^T + R_i A_i,  g_i = grad w_i,  A_i = (X - X_i) g_i^T + w_i I.
/// A_i is constant; other blends that are linear in x_i and R_i differ in it alone. Any partition of unity
/// reproduces rigid motions. Two frames that are turned against each other by theta shrink the section
/// between them by cos(theta/2): more frames help. Which shape functions leave rotations undetermined, or
/// make frames turn less than the body, and what mends it: see `RotationTie` and `LinkedShapes`.
template <int N>
struct FrameSample {
  static constexpr int points = 0, frames = N;
  static constexpr std::size_t count = N;

  /// g_i in 1/m, A_i, and the rest volume that the sample stands for in m^3.
  template <class T>
  struct Data {
    std::array<Vec3<T>, count> gradient;
    std::array<Mat3<T>, count> lever;
    T volume;
  };

  /// From the rest position X of the sample, those of the frames, in m, and the shape functions there.
  /// @throws std::invalid_argument unless sum w = 1, sum g = 0 (relative to the largest) and the volume is
  ///   positive
  [[nodiscard]] static Data<double> make(const Vec3<double>& X, const std::array<Vec3<double>, count>& frame,
                                         const std::array<double, count>& w,
                                         const std::array<Vec3<double>, count>& g, double volume) {
    std::array<Mat3<double>, count> lever;
    for (std::size_t i = 0; i < count; ++i) {
      lever[i] = (X - frame[i]) * g[i].transpose();
      lever[i].diagonal().array() += w[i];
    }
    double sum = 0;
    for (const double wi : w) sum += wi;
    if (!(std::abs(sum - 1) <= 1e-9))
      invalid(std::string("weights sum to ") + to_text(sum) + ", they have to sum to 1");
    return make(frame, g, lever, volume);
  }
  /// The same of a general blend x = sum_i w_i x_i + R_i c_i, with `lever` the gradients of c_i.
  /// @throws std::invalid_argument unless the frames at rest give F = I, sum g = 0 and the volume is positive
  [[nodiscard]] static Data<double> make(const std::array<Vec3<double>, count>& frame,
                                         const std::array<Vec3<double>, count>& g,
                                         const std::array<Mat3<double>, count>& lever, double volume) {
    if (!(volume > 0) || !(volume <= 1e300))
      invalid(std::string("volume ") + to_text(volume) + " m^3 is not positive and finite");
    Vec3<double> sum = Vec3<double>::Zero();
    Mat3<double> F = Mat3<double>::Zero();
    double largest = 0, size = 1;
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3<double> from_first = frame[i] - frame[0];
      sum += g[i];
      F += from_first * g[i].transpose() + lever[i];
      largest = std::max(largest, g[i].norm());
      size = std::max(size, from_first.norm() * g[i].norm());
    }
    if (!(sum.norm() <= 1e-9 * largest))
      invalid(std::string("gradients of the weights sum to ") + to_text(sum.norm()) +
              " 1/m, they have to sum to 0");
    if (!((F - Mat3<double>::Identity()).norm() <= 1e-9 * size))
      invalid(std::string("F at rest is off the identity by ") +
              to_text((F - Mat3<double>::Identity()).norm()));
    return {g, lever, volume};
  }

  /// Rest volume, m^3.
  template <class T>
  [[nodiscard]] static const T& volume(const Data<T>& data) {
    return data.volume;
  }

  /// F = I + sum_i u_i g_i^T + (R_i - I) A_i (Eq. 3.40 in displacements from rest).
  template <class T>
  [[nodiscard]] static Mat3<T> deformation_gradient(const Data<T>& data, const Local<T, 0, N>& u) {
    Mat3<T> F = Mat3<T>::Identity();
    for (std::size_t i = 0; i < count; ++i) {
      F += u.frames[i].displacement * data.gradient[i].transpose();
      F += u.frames[i].turn * data.lever[i];
    }
    return F;
  }

  /// dF = sum_i du_i g_i^T + R_i [dr_i]x A_i (Eq. 3.42 for body increments).
  template <class T>
  [[nodiscard]] static Mat3<T> deformation_gradient_differential(const Data<T>& data, const Local<T, 0, N>& u,
                                                                 const Eigen::Matrix<T, 6 * N, 1>& du) {
    Mat3<T> dF = Mat3<T>::Zero();
    for (std::size_t i = 0; i < count; ++i) {
      const int at = 6 * static_cast<int>(i);
      const Vec3<T> dr = du.template segment<3>(at + 3);
      Mat3<T> turned;
      for (int k = 0; k < 3; ++k) turned.col(k) = dr.cross(data.lever[i].col(k));
      dF += du.template segment<3>(at) * data.gradient[i].transpose();
      dF += u.frames[i].to_space(turned);
    }
    return dF;
  }

  /// B^T P: the force P g_i and the torque axial(R_i^T P A_i^T), in the axes of the body, on frame i.
  template <class T>
  [[nodiscard]] static Eigen::Matrix<T, 6 * N, 1> pullback(const Data<T>& data, const Local<T, 0, N>& u,
                                                           const Mat3<T>& P) {
    Eigen::Matrix<T, 6 * N, 1> f;
    for (std::size_t i = 0; i < count; ++i) {
      const int at = 6 * static_cast<int>(i);
      f.template segment<3>(at) = P * data.gradient[i];
      f.template segment<3>(at + 3) = axial<T>(body_moment(data, u, P, i));
    }
    return f;
  }

  /// (sym(N_i) - tr(N_i) I) dr_i with N_i = R_i^T P A_i^T: the derivative of the pull-back at fixed P, as the
  /// second derivative of P : F along the increments (K^F is in the rest; appendix B).
  template <class T>
  [[nodiscard]] static Eigen::Matrix<T, 6 * N, 1> geometric_product(const Data<T>& data,
                                                                    const Local<T, 0, N>& u, const Mat3<T>& P,
                                                                    const Eigen::Matrix<T, 6 * N, 1>& du) {
    Eigen::Matrix<T, 6 * N, 1> f;
    for (std::size_t i = 0; i < count; ++i) {
      const int at = 6 * static_cast<int>(i);
      f.template segment<3>(at).setZero();
      f.template segment<3>(at + 3) = geometric_block(data, u, P, i) * du.template segment<3>(at + 3);
    }
    return f;
  }

  /// sym(N_i) - tr(N_i) I: the block of frame i in `geometric_product`.
  template <class T>
  [[nodiscard]] static Mat3<T> geometric_block(const Data<T>& data, const Local<T, 0, N>& u, const Mat3<T>& P,
                                               std::size_t i) {
    return squared_skew_form(body_moment(data, u, P, i));
  }

 private:
  // N_i, whose double contraction with [dr]x is the work of the torque.
  template <class T>
  static Mat3<T> body_moment(const Data<T>& data, const Local<T, 0, N>& u, const Mat3<T>& P, std::size_t i) {
    return u.frames[i].to_body(Mat3<T>(P * data.lever[i].transpose()));
  }
};

}  // namespace softsim
