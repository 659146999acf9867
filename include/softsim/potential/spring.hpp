// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "softsim/concepts.hpp"
#include "softsim/core/batch.hpp"
#include "softsim/core/error.hpp"
#include "softsim/mesh/edges.hpp"
#include "softsim/mesh/tetrahedral_mesh.hpp"
#include "softsim/potential/elements.hpp"

namespace softsim {

/// What the two kinds of spring know of one link, and how they find its stretch.
struct SpringLink {
  static constexpr int points = 2;
  static constexpr bool translation_invariant = true;

  /// Link at rest from point 0 to point 1 in m, its length in m, and the stiffness in N/m.
  template <class T>
  struct Data {
    Vec3<T> link;
    T length, stiffness;
  };

  /// From the rest positions of the two ends in m and a stiffness in N/m.
  /// @throws std::invalid_argument unless stiffness and length are positive and finite
  [[nodiscard]] static Data<double> make(const Vec3<double>& X0, const Vec3<double>& X1, double stiffness) {
    if (!(stiffness > 0) || !std::isfinite(stiffness))
      invalid(std::string("spring: stiffness ") + to_text(stiffness) + " N/m must be positive and finite");
    const Vec3<double> D = X1 - X0;
    const double length = D.norm();
    if (!(length > 0) || !std::isfinite(length))
      invalid(std::string("spring: rest length ") + to_text(length) + " m must be positive and finite");
    return {D, length, stiffness};
  }

 protected:
  /// Deformed link d = D + du, and l^2 - l0^2 = du . (D + d), which holds its digits at small strain.
  template <class T>
  struct Stretch {
    Vec3<T> d;
    T squares;
  };
  template <class T>
  static Stretch<T> stretch(const Data<T>& data, const Local<T, 2>& u) {
    const Vec3<T> du = u.points[1] - u.points[0], d = data.link + du, sum = data.link + d;
    return {d, du.dot(sum)};
  }
  template <class T>
  static Eigen::Matrix<T, 6, 1> opposite(const Vec3<T>& f) {
    Eigen::Matrix<T, 6, 1> both;
    both.template head<3>() = -f;
    both.template tail<3>() = f;
    return both;
  }
};

/// Hooke's spring between two points: W = k/2 (l - l0)^2. As a function of the squared length, the variable
/// of HEML, W = k/2 (sqrt(l^2) - l0)^2 with dW/d(l^2) = k/2 (1 - l0/l): the degenerate case of Goulette &
/// Chen 2015, Sec. 5.3 (Eqs. 34-41), degenerate because it is not smooth at l = 0. `SquaredLengthSpring` is.
/// Below sqrt(epsilon) l0 a link has no direction that stands above the rounding of its ends; there the
/// force, k l0 in size, fades out linearly, and nothing divides by zero.
struct Spring : SpringLink {
  /// k/2 (l - l0)^2, J.
  template <class T>
  [[nodiscard]] T energy(const Data<T>& data, const Local<T, 2>& u) const {
    using std::sqrt;
    const auto [d, squares] = stretch(data, u);
    const T elongation = squares / (sqrt(d.dot(d)) + data.length);
    return T(0.5) * data.stiffness * elongation * elongation;
  }

  /// k (1 - l0/l) d on point 1 and the opposite on point 0, N.
  template <class T>
  [[nodiscard]] Eigen::Matrix<T, 6, 1> gradient(const Data<T>& data, const Local<T, 2>& u) const {
    using std::sqrt;
    const auto [d, squares] = stretch(data, u);
    const T l2 = clamped(data, d);
    const T tension = data.stiffness * squares / (l2 + sqrt(l2) * data.length);
    const Vec3<T> f = tension * d;
    return opposite<T>(f);
  }

  /// k ((1 - l0/l) dd + (l0/l^3) (d . dd) d), exact: the first part is negative across a spring in
  /// compression.
  template <class T>
  [[nodiscard]] Eigen::Matrix<T, 6, 1> hessian_product(const Data<T>& data, const Local<T, 2>& u,
                                                       const Eigen::Matrix<T, 6, 1>& du) const {
    using std::sqrt;
    const auto [d, squares] = stretch(data, u);
    const Vec3<T> dd = du.template tail<3>() - du.template head<3>();
    const T l2 = clamped(data, d), l = sqrt(l2), inverse = T(1) / (l2 * (l + data.length));
    const T tension = data.stiffness * squares * l * inverse;
    const T along = data.stiffness * data.length * (l + data.length) * inverse / l * d.dot(dd);
    const Vec3<T> df = tension * dd + along * d;
    return opposite<T>(df);
  }

  /// k (1 - 2 l0/(l_0 + l_1)) on the mean of the two links: over the increment between two states it does the
  /// work of the difference of their energies, and is central (Gonzalez' discrete gradient in the squared
  /// length).
  template <class T>
  [[nodiscard]] Eigen::Matrix<T, 6, 1> discrete_gradient(const Data<T>& data, const Local<T, 2>& u_0,
                                                         const Local<T, 2>& u_1) const {
    using std::sqrt;
    const auto [d_0, squares_0] = stretch(data, u_0);
    const auto [d_1, squares_1] = stretch(data, u_1);
    const T l_0 = sqrt(clamped(data, d_0)), l_1 = sqrt(clamped(data, d_1));
    const T elongations = squares_0 / (l_0 + data.length) + squares_1 / (l_1 + data.length);
    const T half = T(0.5) * data.stiffness * elongations / (l_0 + l_1);
    const Vec3<T> f = half * (d_0 + d_1);
    return opposite<T>(f);
  }

 private:
  template <class T>
  static T clamped(const Data<T>& data, const Vec3<T>& d) {
    using std::max;
    using Real = decltype(lane(T{}, 0));
    const T least = T(std::numeric_limits<Real>::epsilon()) * data.length * data.length;
    return max(T(d.dot(d)), least);
  }
};

/// Spring that is smooth in the squared length: W = k/(8 l0^2) (l^2 - l0^2)^2, half of k l0^2 times the
/// square of the link's Green strain. The regular HEML energy of a link: no root, no division, defined at
/// l = 0; equals `Spring` at small strain, is stiffer in tension and softer in compression (from
/// l = l0/sqrt(3) on the force falls).
struct SquaredLengthSpring : SpringLink {
  /// k/(8 l0^2) (l^2 - l0^2)^2, J.
  template <class T>
  [[nodiscard]] T energy(const Data<T>& data, const Local<T, 2>& u) const {
    const T strain = stretch(data, u).squares / data.length;
    return T(0.125) * data.stiffness * strain * strain;
  }

  /// k/(2 l0^2) (l^2 - l0^2) d on point 1 and the opposite on point 0, N.
  template <class T>
  [[nodiscard]] Eigen::Matrix<T, 6, 1> gradient(const Data<T>& data, const Local<T, 2>& u) const {
    const auto [d, squares] = stretch(data, u);
    const T tension = coefficient(data) * squares;
    const Vec3<T> f = tension * d;
    return opposite<T>(f);
  }

  /// k/(2 l0^2) ((l^2 - l0^2) dd + 2 (d . dd) d).
  template <class T>
  [[nodiscard]] Eigen::Matrix<T, 6, 1> hessian_product(const Data<T>& data, const Local<T, 2>& u,
                                                       const Eigen::Matrix<T, 6, 1>& du) const {
    const auto [d, squares] = stretch(data, u);
    const Vec3<T> dd = du.template tail<3>() - du.template head<3>();
    const T c = coefficient(data), tension = c * squares, along = T(2) * c * d.dot(dd);
    const Vec3<T> df = tension * dd + along * d;
    return opposite<T>(df);
  }

  /// The same with the mean of both tensions on the mean of both links: see `Spring::discrete_gradient`.
  template <class T>
  [[nodiscard]] Eigen::Matrix<T, 6, 1> discrete_gradient(const Data<T>& data, const Local<T, 2>& u_0,
                                                         const Local<T, 2>& u_1) const {
    const auto [d_0, squares_0] = stretch(data, u_0);
    const auto [d_1, squares_1] = stretch(data, u_1);
    const T quarter = T(0.25) * coefficient(data) * (squares_0 + squares_1);
    const Vec3<T> f = quarter * (d_0 + d_1);
    return opposite<T>(f);
  }

 private:
  template <class T>
  static T coefficient(const Data<T>& data) {
    return data.stiffness / (T(2) * data.length * data.length);
  }
};

/// Springs on all edges of `mesh`, each with the stiffness of the same place in `stiffness`, in N/m, the
/// edges being for instance those of `mesh_edges`.
/// @throws std::invalid_argument naming the edge whose stiffness is not positive and finite or whose nodes do
/// not
///   exist, or for a list of another length
template <class S = Spring, class T = double, int N = default_lanes<T>>
[[nodiscard]] Elements<S, T, N> springs(const TetrahedralMesh& mesh, const std::vector<Edge>& edges,
                                        const std::vector<double>& stiffness) {
  if (stiffness.size() != edges.size())
    invalid(std::string("springs: ") + std::to_string(stiffness.size()) + " stiffnesses for " +
            std::to_string(edges.size()) + " edges");
  std::vector<SpringLink::Data<double>> data;
  std::vector<Edge> stencils;
  data.reserve(edges.size());
  stencils.reserve(edges.size());
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const Edge& v = edges[e];
    const double k = stiffness[e];
    for (const std::int32_t i : v)
      if (i < 0 || static_cast<std::size_t>(i) >= mesh.points().size())
        invalid(std::string("spring between nodes ") + std::to_string(v[0]) + " and " + std::to_string(v[1]) +
                ": out of range (the mesh has " + std::to_string(mesh.points().size()) + " nodes)");
    if (!(k > 0) || !std::isfinite(k))
      invalid(std::string("spring between nodes ") + std::to_string(v[0]) + " and " + std::to_string(v[1]) +
              ": stiffness " + to_text(k) + " N/m must be positive and finite");
    data.push_back(SpringLink::make(mesh.points()[static_cast<std::size_t>(v[0])],
                                    mesh.points()[static_cast<std::size_t>(v[1])], k));
    stencils.push_back(v);
  }
  return {{S{}}, data, stencils};
}

/// One spring of the stiffness k in N/m on every edge of `mesh`. What body that makes depends on the mesh;
/// for a material see `van_gelder_springs`.
/// @throws std::invalid_argument unless k is positive and finite
template <class S = Spring, class T = double, int N = default_lanes<T>>
[[nodiscard]] Elements<S, T, N> springs(const TetrahedralMesh& mesh, double k) {
  const MeshEdges all = mesh_edges(mesh);
  return springs<S, T, N>(mesh, all.edges, std::vector<double>(all.edges.size(), k));
}

/// Springs that imitate an elastic body of Young's modulus E in Pa: k = E sum V / L^2 over the tetrahedra
/// around an edge of length L (Van Gelder 1998). The energy at a small strain eps is then
/// E/2 sum V (n . eps n)^2 over the edges n of all tetrahedra. With edges in all directions alike its mean is
/// that of Lame parameters lambda = mu = 2 E/5, that is Young's modulus E and, whatever one would like,
/// Poisson's ratio 1/4; a uniform dilation is that of these moduli on every mesh. A real mesh is anisotropic.
/// @throws std::invalid_argument unless E is positive and finite
template <class S = Spring, class T = double, int N = default_lanes<T>>
[[nodiscard]] Elements<S, T, N> van_gelder_springs(const TetrahedralMesh& mesh, double E) {
  if (!(E > 0) || !std::isfinite(E))
    invalid(std::string("young ") + to_text(E) + " Pa: must be positive and finite");
  MeshEdges all = mesh_edges(mesh);
  for (std::size_t e = 0; e < all.edges.size(); ++e) {
    const Vec3<double> D = mesh.points()[static_cast<std::size_t>(all.edges[e][1])] -
                           mesh.points()[static_cast<std::size_t>(all.edges[e][0])];
    all.volume[e] *= E / D.squaredNorm();
  }
  return springs<S, T, N>(mesh, all.edges, all.volume);
}

}  // namespace softsim
