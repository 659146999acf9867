// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "softsim/concepts.hpp"
#include "softsim/core/error.hpp"
#include "softsim/mesh/tetrahedral_mesh.hpp"
#include "softsim/potential/elements.hpp"

namespace softsim {

/// Follower pressure on one triangle: the force -p n da of the deformed triangle, a third on each corner. n
/// is the outward normal, so that p > 0 pushes inwards. A pressure has an energy only on a closed surface or
/// on a patch whose rim is held. `hessian_product` is the symmetric part of the load's derivative, which is
/// all of it there; elsewhere Newton's method still finds the equilibrium, with conjugate gradients, but not
/// quadratically.
struct FollowerPressure {
  static constexpr int points = 3;
  static constexpr bool external = true;

  /// Rest positions of the corners, m.
  template <class T>
  struct Data {
    std::array<Vec3<T>, 3> X;
  };

  double pressure;  ///< Pa

  /// p/6 (x1 - x0) x (x2 - x0) on each corner, N.
  template <class T>
  [[nodiscard]] Eigen::Matrix<T, 9, 1> gradient(const Data<T>& data, const Local<T, 3>& u) const {
    const auto x = corners(data, u);
    const Vec3<T> a = x[1] - x[0], b = x[2] - x[0], f = T(pressure / 6) * a.cross(b);
    Eigen::Matrix<T, 9, 1> g;
    for (int i = 0; i < 3; ++i) g.template segment<3>(3 * i) = f;
    return g;
  }

  /// Symmetric part of the derivative. With N = sum_j dx_j x e_j, e_j the edge opposite corner j taken
  /// against the turn, the derivative's block (i, j) is -p/6 [e_j]x and its symmetric part p/12 ([e_i]x -
  /// [e_j]x).
  template <class T>
  [[nodiscard]] Eigen::Matrix<T, 9, 1> hessian_product(const Data<T>& data, const Local<T, 3>& u,
                                                       const Eigen::Matrix<T, 9, 1>& du) const {
    const auto x = corners(data, u);
    const std::array<Vec3<T>, 3> e{x[1] - x[2], x[2] - x[0], x[0] - x[1]};
    Vec3<T> sum = Vec3<T>::Zero(), turned = Vec3<T>::Zero();
    for (int j = 0; j < 3; ++j) {
      const Vec3<T> d = du.template segment<3>(3 * j);
      sum += d;
      turned += e[static_cast<std::size_t>(j)].cross(d);
    }
    Eigen::Matrix<T, 9, 1> g;
    for (int i = 0; i < 3; ++i)
      g.template segment<3>(3 * i) = T(pressure / 12) * (e[static_cast<std::size_t>(i)].cross(sum) - turned);
    return g;
  }

 private:
  template <class T>
  static std::array<Vec3<T>, 3> corners(const Data<T>& data, const Local<T, 3>& u) {
    return {data.X[0] + u.points[0], data.X[1] + u.points[1], data.X[2] + u.points[2]};
  }
};

/// Follower pressure on triangles of a mesh's boundary (see `boundary_triangles`).
/// @param pressure Pa, positive pushes inwards
/// @throws std::invalid_argument if there is no triangle, one names a node that does not exist, or p is not
/// finite
template <class T = double, int N = default_lanes<T>>
[[nodiscard]] Elements<FollowerPressure, T, N> pressure(const TetrahedralMesh& mesh,
                                                        const std::vector<Triangle>& triangles,
                                                        double pressure) {
  if (triangles.empty()) invalid("pressure: no triangle to act on");
  if (!(std::abs(pressure) <= 1e300))
    invalid(std::string("pressure ") + to_text(pressure) + " Pa: must be finite");
  std::vector<FollowerPressure::Data<double>> data;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    FollowerPressure::Data<double> d;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::int32_t node = triangles[t][i];
      if (node < 0 || static_cast<std::size_t>(node) >= mesh.points().size())
        invalid(std::string("pressure on triangle ") + std::to_string(t) + ": node " + std::to_string(node) +
                " is out of range");
      d.X[i] = mesh.points()[static_cast<std::size_t>(node)];
    }
    data.push_back(d);
  }
  return {{FollowerPressure{pressure}}, data, triangles};
}

}  // namespace softsim
