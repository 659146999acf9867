// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include "softsim/concepts.hpp"
#include "softsim/core/batch.hpp"
#include "softsim/kinematics/linear_tetrahedron.hpp"
#include "softsim/material/lame.hpp"
#include "softsim/mesh/tetrahedral_mesh.hpp"
#include "softsim/potential/elements.hpp"

// Mass tensors (Cotin, Delingette & Ayache 1999; for large deformation Picinbono et al. and d'Aulignac;
// Goulette & Chen 2015, Eq. 42): the elastic energy of a linear tetrahedron as a polynomial in the
// displacements, its coefficients worked out beforehand. Written in e_j = u_j - u_0, j = 1..3, with the rest
// gradients g_j of the shape functions and repeated indices summed:
//
//   W = 1/2 e_p . B_pj e_j + (e_j . e_k) (C_jkp . e_p) + D_jklp (e_j . e_k) (e_l . e_p)
//   B_pj   = V [lambda g_p g_j^T + mu g_j g_p^T + mu (g_p . g_j) I]
//   C_jkp  = V [lambda/2 (g_j . g_k) g_p + mu/2 ((g_k . g_p) g_j + (g_j . g_p) g_k)]
//   D_jklp = V [lambda/8 (g_j . g_k) (g_l . g_p) + mu/8 ((g_j . g_l) (g_k . g_p) + (g_j . g_p) (g_k . g_l))]
//
// which is V psi(F) of the St. Venant-Kirchhoff law, E = (H + H^T + H^T H)/2 with H = e_j g_j^T. The products
// e_j . e_k are six numbers m_a, so that W = 1/2 e.B e + m.C e + m.D m with a 9x9, a 6x9 and a 6x6 matrix.

namespace softsim {

namespace detail {

/// Entries of a symmetric n x n matrix, the lower triangle row by row.
template <class T, int n>
using Packed = std::array<T, static_cast<std::size_t>(n*(n + 1) / 2)>;

template <class T, int n>
[[nodiscard]] Eigen::Matrix<T, n, 1> packed_product(const Packed<T, n>& A, const Eigen::Matrix<T, n, 1>& x) {
  Eigen::Matrix<T, n, 1> y = Eigen::Matrix<T, n, 1>::Zero();
  std::size_t k = 0;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < i; ++j, ++k) {
      y[i] += A[k] * x[j];
      y[j] += A[k] * x[i];
    }
    y[i] += A[k++] * x[i];
  }
  return y;
}

template <int n>
[[nodiscard]] Packed<double, n> packed(const Eigen::Matrix<double, n, n>& A) {
  Packed<double, n> p;
  std::size_t k = 0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j <= i; ++j) p[k++] = A(i, j);
  return p;
}

/// Pairs (j, k) whose products e_j . e_k are the six numbers m.
inline constexpr std::array<std::array<int, 2>, 6> edge_pairs{
    {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}}};

/// The three vectors e_j of a stencil's unknowns or increments, one below the other.
template <class T>
[[nodiscard]] Eigen::Matrix<T, 9, 1> relative(const Local<T, 4>& u) {
  Eigen::Matrix<T, 9, 1> e;
  for (int j = 0; j < 3; ++j)
    e.template segment<3>(3 * j) = u.points[static_cast<std::size_t>(j) + 1] - u.points[0];
  return e;
}
template <class T>
[[nodiscard]] Eigen::Matrix<T, 9, 1> relative(const Eigen::Matrix<T, 12, 1>& du) {
  Eigen::Matrix<T, 9, 1> e;
  for (int j = 0; j < 3; ++j)
    e.template segment<3>(3 * j) = du.template segment<3>(3 * j + 3) - du.template head<3>();
  return e;
}

/// Forces on the e_j as forces on the four corners.
template <class T>
[[nodiscard]] Eigen::Matrix<T, 12, 1> on_corners(const Eigen::Matrix<T, 9, 1>& f) {
  Eigen::Matrix<T, 12, 1> all;
  all.template tail<9>() = f;
  all.template head<3>() = -(f.template head<3>() + f.template segment<3>(3) + f.template tail<3>());
  return all;
}

/// B of one tetrahedron, N/m.
[[nodiscard]] inline Packed<double, 9> linear_tensor(const LinearTetrahedron::Data<double>& rest,
                                                     const Lame& lame) {
  const auto& g = rest.gradient;
  Eigen::Matrix<double, 9, 9> B;
  for (std::size_t p = 0; p < 3; ++p)
    for (std::size_t j = 0; j < 3; ++j)
      B.block<3, 3>(static_cast<int>(3 * p), static_cast<int>(3 * j)) =
          rest.volume * (lame.lambda * g[p] * g[j].transpose() + lame.mu * g[j] * g[p].transpose() +
                         lame.mu * g[p].dot(g[j]) * Mat3<double>::Identity());
  return packed<9>(B);
}

}  // namespace detail

/// Linear mass tensor: a tetrahedron of `LinearElastic` as the constant matrix B, 45 numbers. A `Tangent` of
/// these elements is the constant block matrix over the mesh's edges and nodes.
struct LinearMassTensor {
  static constexpr int points = 4;

  /// B, N/m.
  template <class T>
  struct Data {
    detail::Packed<T, 9> B;
  };

  /// From the tetrahedron at rest.
  [[nodiscard]] static Data<double> make(const LinearTetrahedron::Data<double>& rest, const Lame& lame) {
    return {detail::linear_tensor(rest, lame)};
  }

  /// e.B e/2, J.
  template <class T>
  [[nodiscard]] T energy(const Data<T>& data, const Local<T, 4>& u) const {
    const Eigen::Matrix<T, 9, 1> e = detail::relative(u), f = detail::packed_product<T, 9>(data.B, e);
    return T(0.5) * e.dot(f);
  }
  /// B e, N.
  template <class T>
  [[nodiscard]] Eigen::Matrix<T, 12, 1> gradient(const Data<T>& data, const Local<T, 4>& u) const {
    const Eigen::Matrix<T, 9, 1> e = detail::relative(u);
    return detail::on_corners<T>(detail::packed_product<T, 9>(data.B, e));
  }
  /// B de.
  template <class T>
  [[nodiscard]] Eigen::Matrix<T, 12, 1> hessian_product(const Data<T>& data, const Local<T, 4>&,
                                                        const Eigen::Matrix<T, 12, 1>& du) const {
    const Eigen::Matrix<T, 9, 1> de = detail::relative(du);
    return detail::on_corners<T>(detail::packed_product<T, 9>(data.B, de));
  }
};

/// Mass tensor of the St. Venant-Kirchhoff law: forces quadratic and cubic in the displacements from 120
/// numbers a tetrahedron, exactly those of `Elastic<LinearTetrahedron, StVenantKirchhoff>`, which needs ten.
/// For comparison: the time goes into reading the numbers.
struct MassTensor {
  static constexpr int points = 4;

  /// B in N/m, C (row a: the pair edge_pairs[a]) in N/m^2, D in N/m^3; without padding between them.
  template <class T>
  struct Data {
    detail::Packed<T, 9> B;
    Eigen::Matrix<T, 6, 9, Eigen::DontAlign> C;
    detail::Packed<T, 6> D;
  };

  /// From the tetrahedron at rest.
  [[nodiscard]] static Data<double> make(const LinearTetrahedron::Data<double>& rest, const Lame& lame) {
    Mat3<double> g;
    for (int j = 0; j < 3; ++j) g.col(j) = rest.gradient[static_cast<std::size_t>(j)];
    const Mat3<double> G = g.transpose() * g;
    const double V = rest.volume, lambda = lame.lambda, mu = lame.mu;
    Data<double> data;
    data.B = detail::linear_tensor(rest, lame);
    Eigen::Matrix<double, 6, 6> D;
    for (int a = 0; a < 6; ++a) {
      const auto [j, k] = detail::edge_pairs[static_cast<std::size_t>(a)];
      const double twice = j == k ? 1 : 2;  // (j, k) and (k, j) are one number
      for (int p = 0; p < 3; ++p)
        data.C.block<1, 3>(a, 3 * p) =
            twice * V / 2 *
            (lambda * G(j, k) * g.col(p) + mu * (G(k, p) * g.col(j) + G(j, p) * g.col(k))).transpose();
      for (int b = 0; b < 6; ++b) {
        const auto [l, p] = detail::edge_pairs[static_cast<std::size_t>(b)];
        D(a, b) = twice * (l == p ? 1 : 2) * V / 8 *
                  (lambda * G(j, k) * G(l, p) + mu * (G(j, l) * G(k, p) + G(j, p) * G(k, l)));
      }
    }
    data.D = detail::packed<6>(D);
    return data;
  }

  /// W, J.
  template <class T>
  [[nodiscard]] T energy(const Data<T>& data, const Local<T, 4>& u) const {
    const Vec9<T> e = detail::relative(u), Be = detail::packed_product<T, 9>(data.B, e);
    const Vec6<T> m = products<T>(e, e), Ce = data.C * e, Dm = detail::packed_product<T, 6>(data.D, m);
    return T(0.5) * e.dot(Be) + m.dot(Ce) + m.dot(Dm);
  }
  /// B e + C^T m + (dm/de)^T (C e + 2 D m), N.
  template <class T>
  [[nodiscard]] Eigen::Matrix<T, 12, 1> gradient(const Data<T>& data, const Local<T, 4>& u) const {
    const Vec9<T> e = detail::relative(u);
    const Vec6<T> m = products<T>(e, e), Dm = detail::packed_product<T, 6>(data.D, m);
    const Vec6<T> s = data.C * e + T(2) * Dm;
    Vec9<T> f = detail::packed_product<T, 9>(data.B, e);
    f += data.C.transpose() * m;
    f += pulled_back<T>(s, e);
    return detail::on_corners<T>(f);
  }
  /// The derivative of the gradient, exact.
  template <class T>
  [[nodiscard]] Eigen::Matrix<T, 12, 1> hessian_product(const Data<T>& data, const Local<T, 4>& u,
                                                        const Eigen::Matrix<T, 12, 1>& du) const {
    const Vec9<T> e = detail::relative(u), de = detail::relative(du);
    const Vec6<T> m = products<T>(e, e), dm = T(2) * products<T>(e, de);
    const Vec6<T> Dm = detail::packed_product<T, 6>(data.D, m),
                  dDm = detail::packed_product<T, 6>(data.D, dm);
    const Vec6<T> s = data.C * e + T(2) * Dm, ds = data.C * de + T(2) * dDm;
    Vec9<T> f = detail::packed_product<T, 9>(data.B, de);
    f += data.C.transpose() * dm;
    f += pulled_back<T>(s, de);
    f += pulled_back<T>(ds, e);
    return detail::on_corners<T>(f);
  }

 private:
  template <class T>
  using Vec6 = Eigen::Matrix<T, 6, 1>;
  template <class T>
  using Vec9 = Eigen::Matrix<T, 9, 1>;

  /// The symmetric part of e_j . d_k for the six pairs; for e = d the numbers m.
  template <class T>
  static Vec6<T> products(const Vec9<T>& e, const Vec9<T>& d) {
    Vec6<T> m;
    for (int a = 0; a < 6; ++a) {
      const auto [j, k] = detail::edge_pairs[static_cast<std::size_t>(a)];
      m[a] = T(0.5) * (e.template segment<3>(3 * j).dot(d.template segment<3>(3 * k)) +
                       e.template segment<3>(3 * k).dot(d.template segment<3>(3 * j)));
    }
    return m;
  }
  /// (dm/de)^T s.
  template <class T>
  static Vec9<T> pulled_back(const Vec6<T>& s, const Vec9<T>& e) {
    Vec9<T> f = Vec9<T>::Zero();
    for (int a = 0; a < 6; ++a) {
      const auto [j, k] = detail::edge_pairs[static_cast<std::size_t>(a)];
      const T c = s[a];
      f.template segment<3>(3 * j) += c * e.template segment<3>(3 * k);
      f.template segment<3>(3 * k) += c * e.template segment<3>(3 * j);
    }
    return f;
  }
};

/// Mass tensors of all tetrahedra of `mesh`: M is `MassTensor` (St. Venant-Kirchhoff) or `LinearMassTensor`.
template <class M = MassTensor, class T = double, int N = default_lanes<T>>
[[nodiscard]] Elements<M, T, N> mass_tensors(const TetrahedralMesh& mesh, const Lame& lame) {
  const Lame checked = Lame::checked(lame.lambda, lame.mu);
  std::vector<typename M::template Data<double>> data;
  data.reserve(mesh.tetrahedra().size());
  for (std::size_t t = 0; t < mesh.tetrahedra().size(); ++t)
    data.push_back(M::make(LinearTetrahedron::make(mesh.element_points(t)), checked));
  return {{M{}}, data, mesh.tetrahedra()};
}

}  // namespace softsim
