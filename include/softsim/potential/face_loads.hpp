// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "softsim/concepts.hpp"
#include "softsim/core/batch.hpp"
#include "softsim/core/error.hpp"
#include "softsim/core/state.hpp"
#include "softsim/mesh/isoparametric_mesh.hpp"
#include "softsim/potential/dead_load.hpp"
#include "softsim/potential/elements.hpp"
#include "softsim/potential/quadrature.hpp"

namespace softsim {

/// Follower pressure on one face (`BilinearQuadrilateral`, `QuadraticTriangle`): the force -p int N_i n da of
/// the deformed face on its node i, by the face's rule, which is exact. n is the outward normal, so that p >
/// 0 pushes inwards. What `FollowerPressure` says of energy and Hessian holds here too.
template <class Face>
struct FollowerFacePressure {
  static constexpr int points = Face::nodes;
  static constexpr bool external = true;

  /// Rest positions of the nodes, m.
  template <class T>
  struct Data {
    std::array<Vec3<T>, static_cast<std::size_t>(Face::nodes)> X;
  };

  double pressure;  ///< Pa

  /// p int N_i x_xi x x_eta dxi deta on node i, N.
  template <class T>
  [[nodiscard]] Eigen::Matrix<T, 3 * points, 1> gradient(const Data<T>& data,
                                                         const Local<T, points>& u) const {
    Eigen::Matrix<T, 3 * points, 1> g = Eigen::Matrix<T, 3 * points, 1>::Zero();
    for (const auto& point : Face::rule) {
      const auto [a, b] = tangents(data, u, point.xi);
      const Vec3<T> area = T(pressure * point.weight) * a.cross(b);
      const Eigen::Matrix<double, points, 1> N = Face::values(point.xi);
      for (int i = 0; i < points; ++i) g.template segment<3>(3 * i) += T(N[i]) * area;
    }
    return g;
  }

  /// Symmetric part of the derivative, (K d + K^T d)/2 with K d = p int N_i (d_xi x x_eta + x_xi x d_eta) on
  /// node i and K^T d = p int (N_i,xi x_eta x d + N_i,eta d x x_xi).
  template <class T>
  [[nodiscard]] Eigen::Matrix<T, 3 * points, 1> hessian_product(
      const Data<T>& data, const Local<T, points>& u, const Eigen::Matrix<T, 3 * points, 1>& du) const {
    Eigen::Matrix<T, 3 * points, 1> g = Eigen::Matrix<T, 3 * points, 1>::Zero();
    for (const auto& point : Face::rule) {
      const auto [a, b] = tangents(data, u, point.xi);
      const Eigen::Matrix<double, points, 1> N = Face::values(point.xi);
      const Eigen::Matrix<double, points, 2> dN = Face::gradients(point.xi);
      Vec3<T> d = Vec3<T>::Zero(), da = d, db = d;
      for (int i = 0; i < points; ++i) {
        const Vec3<T> di = du.template segment<3>(3 * i);
        d += T(N[i]) * di;
        da += T(dN(i, 0)) * di;
        db += T(dN(i, 1)) * di;
      }
      const T half = T(pressure * point.weight / 2);
      const Vec3<T> direct = half * (da.cross(b) + a.cross(db)), along = half * b.cross(d),
                    across = half * d.cross(a);
      for (int i = 0; i < points; ++i)
        g.template segment<3>(3 * i) += T(N[i]) * direct + T(dN(i, 0)) * along + T(dN(i, 1)) * across;
    }
    return g;
  }

 private:
  // dx/dxi and dx/deta
  template <class T>
  static std::array<Vec3<T>, 2> tangents(const Data<T>& data, const Local<T, points>& u,
                                         const std::array<double, 2>& xi) {
    const Eigen::Matrix<double, points, 2> dN = Face::gradients(xi);
    std::array<Vec3<T>, 2> t{Vec3<T>::Zero(), Vec3<T>::Zero()};
    for (int i = 0; i < points; ++i) {
      const std::size_t k = static_cast<std::size_t>(i);
      const Vec3<T> x = data.X[k] + u.points[k];
      t[0] += T(dN(i, 0)) * x;
      t[1] += T(dN(i, 1)) * x;
    }
    return t;
  }
};

namespace detail {

template <class Mesh>
void check_face(const Mesh& mesh, const char* load, std::size_t f,
                const std::vector<FaceOf<typename Mesh::Shape>>& faces) {
  for (const std::int32_t node : faces[f])
    if (node < 0 || static_cast<std::size_t>(node) >= mesh.points().size())
      invalid(std::string(load) + " on face " + std::to_string(f) + ": node " + std::to_string(node) +
              " is out of range");
}

}  // namespace detail

/// Follower pressure on faces of a mesh's boundary (see `boundary_faces`, `faces_on`).
/// @param pressure Pa, positive pushes inwards
/// @throws std::invalid_argument if there is no face, one names a node that does not exist, or p is not
/// finite
template <class T = double, int N = default_lanes<T>, IsoparametricElements Mesh>
[[nodiscard]] auto pressure(const Mesh& mesh, const std::vector<FaceOf<typename Mesh::Shape>>& faces,
                            double pressure) {
  using Load = FollowerFacePressure<typename Mesh::Shape::Face>;
  if (faces.empty()) invalid("pressure: no face to act on");
  if (!(std::abs(pressure) <= 1e300))
    invalid(std::string("pressure ") + to_text(pressure) + " Pa: must be finite");
  std::vector<typename Load::template Data<double>> data(faces.size());
  for (std::size_t f = 0; f < faces.size(); ++f) {
    detail::check_face(mesh, "pressure", f, faces);
    for (std::size_t i = 0; i < faces[f].size(); ++i)
      data[f].X[i] = mesh.points()[static_cast<std::size_t>(faces[f][i])];
  }
  return Elements<Load, T, N>({Load{pressure}}, data, faces);
}

/// Dead load of a traction per rest area on faces of a mesh's boundary: int N_i t dA on node i.
/// @param traction Pa; its direction stays
/// @throws std::invalid_argument if there is no face, one names a node that does not exist, or the traction
/// is
///   not finite
template <class T = double, IsoparametricElements Mesh>
[[nodiscard]] DeadLoad<T> traction(const Mesh& mesh, const std::vector<FaceOf<typename Mesh::Shape>>& faces,
                                   const Vec3<double>& traction) {
  using Face = typename Mesh::Shape::Face;
  if (faces.empty()) invalid("traction: no face to act on");
  DeadLoad<T> load(mesh.points().size());
  for (std::size_t f = 0; f < faces.size(); ++f) {
    detail::check_face(mesh, "traction", f, faces);
    for (const auto& point : Face::rule) {
      const auto N = Face::values(point.xi);
      const auto dN = Face::gradients(point.xi);
      Vec3<double> a = Vec3<double>::Zero(), b = a;
      for (std::size_t i = 0; i < faces[f].size(); ++i) {
        const Vec3<double>& X = mesh.points()[static_cast<std::size_t>(faces[f][i])];
        a += dN(static_cast<int>(i), 0) * X;
        b += dN(static_cast<int>(i), 1) * X;
      }
      const double dA = point.weight * a.cross(b).norm();
      for (std::size_t i = 0; i < faces[f].size(); ++i)
        load.add(faces[f][i], N[static_cast<int>(i)] * dA * traction);
    }
  }
  return load;
}

}  // namespace softsim
