// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "softsim/core/error.hpp"
#include "softsim/kinematics/frame_body.hpp"
#include "softsim/potential/elements.hpp"

namespace softsim {

/// Ties the rotations of the N frames of a sample to each other: E = gamma v/2 sum_{i<j} w_i w_j |R_i -
/// R_j|^2 = gamma v/2 (3 - |sum w_i R_i|^2).
///
/// Shape functions that reproduce linear fields (those of meshes, moving least squares, natural neighbours,
/// maximum entropy) need it: turning every frame in its place by the same R then moves no point of the body,
/// x = sum w_i (X_i + R (X - X_i)) = X, and there are more combinations like that, so that elastic forces
/// leave some rotations undetermined, and loads find equilibria far away in them. With the tie they follow
/// the frames that are held; in a free body the turn of all frames in place remains. Shape functions that are
/// flat at the nodes, Shepard's for one, do without.
///
/// What the tie adds to the stiffness in bending is about gamma/E (h/t)^2 for frames at a distance h in a
/// body of thickness t (measured on beams of hexahedra; 3 gamma/E (h/t)^2 bounds it). A thousandth of Young's
/// modulus is a good gamma with `BlockJacobi` or `Ldlt`; `IncompleteCholesky` amplifies what is nearly
/// undetermined, and needs a hundredth.
template <int N>
struct RotationTie {
  static constexpr int points = 0, frames = N;
  static constexpr std::size_t count = N;
  template <class T>
  struct Data {
    std::array<T, count> weight;
    T volume;
  };

  double gamma;  ///< Pa

  /// J.
  template <class T>
  [[nodiscard]] T energy(const Data<T>& data, const Local<T, 0, N>& u) const {
    Mat3<T> D = Mat3<T>::Zero();  // of sum w_i R_i from the identity
    for (std::size_t i = 0; i < count; ++i) D += data.weight[i] * u.frames[i].turn;
    return T(-0.5) * stiffness(data) * (T(2) * trace(D) + double_dot(D, D));
  }

  /// Minus torques in the axes of the body, N m; no forces.
  template <class T>
  [[nodiscard]] Eigen::Matrix<T, 6 * N, 1> gradient(const Data<T>& data, const Local<T, 0, N>& u) const {
    const Mat3<T> mean = mean_rotation(data, u);
    Eigen::Matrix<T, 6 * N, 1> f = Eigen::Matrix<T, 6 * N, 1>::Zero();
    for (std::size_t i = 0; i < count; ++i)
      f.template segment<3>(6 * static_cast<int>(i) + 3) =
          T(-1) * stiffness(data) * data.weight[i] * axial<T>(u.frames[i].to_body(mean));
    return f;
  }

  /// Second derivative of the energy along increments.
  template <class T>
  [[nodiscard]] Eigen::Matrix<T, 6 * N, 1> hessian_product(const Data<T>& data, const Local<T, 0, N>& u,
                                                           const Eigen::Matrix<T, 6 * N, 1>& du) const {
    const Mat3<T> mean = mean_rotation(data, u);
    const auto rotation = [&](std::size_t i) -> Vec3<T> {
      return du.template segment<3>(6 * static_cast<int>(i) + 3);
    };
    Mat3<T> change = Mat3<T>::Zero();
    for (std::size_t i = 0; i < count; ++i) {
      const Mat3<T> r = skew<T>(rotation(i));
      change += data.weight[i] * u.frames[i].to_space(r);
    }
    Eigen::Matrix<T, 6 * N, 1> f = Eigen::Matrix<T, 6 * N, 1>::Zero();
    for (std::size_t i = 0; i < count; ++i) {
      const Mat3<T> B = squared_skew_form(Mat3<T>(u.frames[i].to_body(mean)));
      const Vec3<T> along = axial<T>(u.frames[i].to_body(change)) + B * rotation(i);
      f.template segment<3>(6 * static_cast<int>(i) + 3) = T(-1) * stiffness(data) * data.weight[i] * along;
    }
    return f;
  }

 private:
  template <class T>
  T stiffness(const Data<T>& data) const {
    return T(gamma) * data.volume;
  }
  template <class T>
  static Mat3<T> mean_rotation(const Data<T>& data, const Local<T, 0, N>& u) {
    Mat3<T> mean = Mat3<T>::Identity();
    for (std::size_t i = 0; i < count; ++i) mean += data.weight[i] * u.frames[i].turn;
    return mean;
  }
};

/// The tie at all samples of `body`, as a term of a system.
/// @param gamma Pa, see `RotationTie`
/// @throws std::invalid_argument unless gamma is positive and finite
template <class T = double, int lanes = default_lanes<T>, int N>
[[nodiscard]] Elements<RotationTie<N>, T, lanes> rotation_tie(const FrameBody<N>& body, double gamma) {
  if (!(gamma > 0) || !(gamma <= 1e300))
    invalid(std::string("gamma ") + to_text(gamma) + " Pa: must be positive and finite");
  std::vector<typename RotationTie<N>::template Data<double>> data;
  data.reserve(body.size());
  for (std::size_t s = 0; s < body.size(); ++s) data.push_back({body.blends()[s].weights, body.volumes()[s]});
  return {{RotationTie<N>{gamma}}, data, body.stencils()};
}

}  // namespace softsim
