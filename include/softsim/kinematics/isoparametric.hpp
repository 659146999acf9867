// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <string>

#include "softsim/concepts.hpp"
#include "softsim/core/error.hpp"
#include "softsim/mesh/shape_functions.hpp"

namespace softsim {

/// One integration point of an isoparametric element: F = I + sum_i u_i g_i^T with g_i the rest gradient of
/// shape function i there. The gradients sum to zero, so that g_0 is not stored.
/// An element has several of them on one stencil; `Quadrature` sums over them.
template <ShapeFunctions S>
struct Isoparametric {
  static constexpr int points = S::nodes;
  static constexpr bool translation_invariant = true;
  using Shape = S;
  /// Rest positions of the nodes, m.
  using Nodes = std::array<Vec3<double>, static_cast<std::size_t>(points)>;

  /// Gradients of the shape functions of nodes 1, 2, ... in 1/m, and the rest volume that the point stands
  /// for, weight times Jacobian determinant, in m^3.
  template <class T>
  struct Data {
    std::array<Vec3<T>, static_cast<std::size_t>(points - 1)> gradient;
    T volume;
  };

  /// From the rest positions of the nodes in m.
  /// @throws std::invalid_argument unless the Jacobian determinant is positive at the point
  [[nodiscard]] static Data<double> make(const Nodes& X, const IntegrationPoint<3>& point) {
    const Mat3<double> J = jacobian<S>(X, point.xi), c = cofactor(J);
    const double det = J.col(0).dot(c.col(0));
    if (!(det > 0))
      invalid(std::string(S::name.singular) + ": Jacobian determinant " + to_text(det) +
              " m^3 is not positive");
    const Eigen::Matrix<double, points, 3> dN = S::gradients(point.xi);
    Data<double> data;
    for (int i = 1; i < points; ++i)
      data.gradient[static_cast<std::size_t>(i - 1)] = c * dN.row(i).transpose() / det;
    data.volume = point.weight * det;
    return data;
  }

  /// Rest volume, m^3.
  template <class T>
  [[nodiscard]] static const T& volume(const Data<T>& data) {
    return data.volume;
  }

  /// F = I + grad u.
  template <class T>
  [[nodiscard]] static Mat3<T> deformation_gradient(const Data<T>& data, const Local<T, points>& u) {
    Mat3<T> F = Mat3<T>::Identity();
    for (std::size_t i = 0; i < data.gradient.size(); ++i) {
      const Vec3<T> e = u.points[i + 1] - u.points[0];
      F += e * data.gradient[i].transpose();
    }
    return F;
  }

  /// dF = grad du.
  template <class T>
  [[nodiscard]] static Mat3<T> deformation_gradient_differential(const Data<T>& data, const Local<T, points>&,
                                                                 const Eigen::Matrix<T, 3 * points, 1>& du) {
    Mat3<T> dF = Mat3<T>::Zero();
    for (int i = 1; i < points; ++i) {
      const Vec3<T> e = du.template segment<3>(3 * i) - du.template head<3>();
      dF += e * data.gradient[static_cast<std::size_t>(i - 1)].transpose();
    }
    return dF;
  }

  /// B^T P: P g_i at node i. The parts sum to zero.
  template <class T>
  [[nodiscard]] static Eigen::Matrix<T, 3 * points, 1> pullback(const Data<T>& data, const Local<T, points>&,
                                                                const Mat3<T>& P) {
    Eigen::Matrix<T, 3 * points, 1> f;
    Vec3<T> sum = Vec3<T>::Zero();
    for (int i = 1; i < points; ++i) {
      const Vec3<T> part = P * data.gradient[static_cast<std::size_t>(i - 1)];
      f.template segment<3>(3 * i) = part;
      sum += part;
    }
    f.template head<3>() = -sum;
    return f;
  }
};

}  // namespace softsim
