// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "softsim/concepts.hpp"
#include "softsim/kinematics/linear_tetrahedron.hpp"
#include "softsim/mesh/tetrahedral_mesh.hpp"
#include "softsim/potential/elements.hpp"

namespace softsim {

/// Elastic energy of one integration point: V psi(F), with any kinematics and any material.
template <class K, class M>
requires Kinematics<K> && Material<M>
struct Elastic {
  static constexpr int points = K::points;
  template <class T>
  using Data = typename K::template Data<T>;

  M material;

  /// V psi(F), J.
  template <class T>
  [[nodiscard]] T energy(const Data<T>& data, const Local<T, points>& u) const {
    return K::volume(data) * material.energy_density(K::deformation_gradient(data, u));
  }

  /// V B^T P(F), N.
  template <class T>
  [[nodiscard]] Eigen::Matrix<T, 3 * points, 1> gradient(const Data<T>& data,
                                                         const Local<T, points>& u) const {
    Mat3<T> P = material.first_piola(K::deformation_gradient(data, u));
    P *= K::volume(data);
    return K::pullback(data, u, P);
  }

  /// V B^T dP(F; B du), and the geometric product where F is not linear in the unknowns.
  template <class T>
  [[nodiscard]] Eigen::Matrix<T, 3 * points, 1> hessian_product(
      const Data<T>& data, const Local<T, points>& u, const Eigen::Matrix<T, 3 * points, 1>& du) const {
    const Mat3<T> F = K::deformation_gradient(data, u);
    Mat3<T> dP = material.first_piola_differential(F, K::deformation_gradient_differential(data, u, du));
    dP *= K::volume(data);
    Eigen::Matrix<T, 3 * points, 1> df = K::pullback(data, u, dP);
    if constexpr (NonlinearKinematics<K, T>) {
      Mat3<T> P = material.first_piola(F);
      P *= K::volume(data);
      df += K::geometric_product(data, u, P, du);
    }
    return df;
  }
};

/// Elastic energy of a tetrahedral mesh with linear tetrahedra.
template <class M, class T = double, int N = default_lanes<T>>
using ElasticTetrahedra = Elements<Elastic<LinearTetrahedron, M>, T, N>;

/// Elastic energy of `mesh` with one of `materials` per tetrahedron; `material_index` chooses it and may be
/// empty if there is one material only.
/// @throws std::invalid_argument for an index out of range or a list of the wrong length
template <class T = double, int N = default_lanes<T>, class M>
[[nodiscard]] ElasticTetrahedra<M, T, N> elastic(const TetrahedralMesh& mesh, const std::vector<M>& materials,
                                                 const std::vector<std::int32_t>& material_index = {}) {
  if (materials.empty()) invalid("elastic: no material");
  if (material_index.empty() && materials.size() > 1)
    invalid(std::string("elastic: ") + std::to_string(materials.size()) +
            " materials need an index per tetrahedron");
  std::vector<LinearTetrahedron::Data<double>> data;
  data.reserve(mesh.tetrahedra().size());
  for (const Tetrahedron& v : mesh.tetrahedra()) {
    std::array<Vec3<double>, 4> X;
    for (std::size_t i = 0; i < 4; ++i) X[i] = mesh.points()[static_cast<std::size_t>(v[i])];
    data.push_back(LinearTetrahedron::make(X));
  }
  std::vector<Elastic<LinearTetrahedron, M>> models;
  for (const M& material : materials) models.push_back({material});
  return {std::move(models), data, mesh.tetrahedra(), material_index};
}

/// Elastic energy of `mesh` made of one material.
template <class T = double, int N = default_lanes<T>, class M>
requires Material<M>
[[nodiscard]] ElasticTetrahedra<M, T, N> elastic(const TetrahedralMesh& mesh, const M& material) {
  return elastic<T, N>(mesh, std::vector<M>{material});
}

}  // namespace softsim
