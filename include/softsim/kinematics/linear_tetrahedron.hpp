// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>

#include "softsim/concepts.hpp"
#include "softsim/core/error.hpp"

namespace softsim {

/// Four-node tetrahedron with linear shape functions: one integration point, constant deformation gradient
/// F = I + sum_i u_i g_i^T with g_i the rest gradient of shape function i; g_0 = -(g_1 + g_2 + g_3).
struct LinearTetrahedron {
  static constexpr int points = 4;
  static constexpr bool translation_invariant = true;

  /// Gradients of the shape functions of corners 1 to 3 in 1/m, and the rest volume in m^3.
  template <class T>
  struct Data {
    std::array<Vec3<T>, 3> gradient;
    T volume;
  };

  /// From the rest positions of the corners in m.
  /// @throws std::invalid_argument unless the volume is positive
  [[nodiscard]] static Data<double> make(const std::array<Vec3<double>, 4>& X) {
    Mat3<double> edges;
    for (int i = 0; i < 3; ++i) edges.col(i) = X[static_cast<std::size_t>(i) + 1] - X[0];
    const Mat3<double> c = cofactor(edges);
    const double det = edges.col(0).dot(c.col(0));
    if (!(det > 0)) invalid(std::string("tetrahedron: volume ") + to_text(det / 6) + " m^3 is not positive");
    Data<double> data;
    for (int i = 0; i < 3; ++i) data.gradient[static_cast<std::size_t>(i)] = c.col(i) / det;
    data.volume = det / 6;
    return data;
  }

  /// Rest volume, m^3.
  template <class T>
  [[nodiscard]] static const T& volume(const Data<T>& data) {
    return data.volume;
  }

  /// F = I + grad u.
  template <class T>
  [[nodiscard]] static Mat3<T> deformation_gradient(const Data<T>& data, const Local<T, 4>& u) {
    Mat3<T> F = Mat3<T>::Identity();
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3<T> e = u.points[i + 1] - u.points[0];
      F += e * data.gradient[i].transpose();
    }
    return F;
  }

  /// dF = grad du.
  template <class T>
  [[nodiscard]] static Mat3<T> deformation_gradient_differential(const Data<T>& data, const Local<T, 4>&,
                                                                 const Eigen::Matrix<T, 12, 1>& du) {
    Mat3<T> dF = Mat3<T>::Zero();
    for (int i = 0; i < 3; ++i) {
      const Vec3<T> e = du.template segment<3>(3 * i + 3) - du.template head<3>();
      dF += e * data.gradient[static_cast<std::size_t>(i)].transpose();
    }
    return dF;
  }

  /// B^T P: P g_i at corner i. The four parts sum to zero.
  template <class T>
  [[nodiscard]] static Eigen::Matrix<T, 12, 1> pullback(const Data<T>& data, const Local<T, 4>&,
                                                        const Mat3<T>& P) {
    Eigen::Matrix<T, 12, 1> f;
    for (int i = 0; i < 3; ++i)
      f.template segment<3>(3 * i + 3) = P * data.gradient[static_cast<std::size_t>(i)];
    f.template head<3>() = -(f.template segment<3>(3) + f.template segment<3>(6) + f.template segment<3>(9));
    return f;
  }
};

}  // namespace softsim
