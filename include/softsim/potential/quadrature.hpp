// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "softsim/concepts.hpp"
#include "softsim/core/batch.hpp"
#include "softsim/core/error.hpp"
#include "softsim/kinematics/isoparametric.hpp"
#include "softsim/mesh/element_mesh.hpp"
#include "softsim/potential/elastic.hpp"
#include "softsim/potential/elements.hpp"

namespace softsim {

/// Sum of a local potential over the n integration points of one element: they share a stencil, hence one
/// gather and one scatter.
template <class E, std::size_t n>
struct Quadrature {
  static constexpr int points = E::points;
  static constexpr bool translation_invariant = requires { requires E::translation_invariant; };
  template <class T>
  using Data = std::array<typename E::template Data<T>, n>;

  E local;

  /// Sum of the points' energies, J.
  template <class T>
  [[nodiscard]] T energy(const Data<T>& data, const Local<T, points>& u) const requires LocalPotential<E, T> {
    T sum(0);
    for (std::size_t k = 0; k < n; ++k) sum += local.energy(data[k], u);
    return sum;
  }

  /// The smallest det F of the points.
  template <class T>
  [[nodiscard]] T volume_ratio(const Data<T>& data, const Local<T, points>& u) const requires requires {
    local.volume_ratio(data[0], u);
  }
  {
    T smallest = local.volume_ratio(data[0], u);
    for (std::size_t k = 1; k < n; ++k) {
      const T ratio = local.volume_ratio(data[k], u);
      smallest = select(smallest < ratio, smallest, ratio);
    }
    return smallest;
  }

  /// Sum of the points' gradients, N.
  template <class T>
  [[nodiscard]] Eigen::Matrix<T, 3 * points, 1> gradient(const Data<T>& data,
                                                         const Local<T, points>& u) const {
    Eigen::Matrix<T, 3 * points, 1> sum = Eigen::Matrix<T, 3 * points, 1>::Zero();
    for (std::size_t k = 0; k < n; ++k) sum += local.gradient(data[k], u);
    return sum;
  }

  /// Sum of the points' Hessian products.
  template <class T>
  [[nodiscard]] Eigen::Matrix<T, 3 * points, 1> hessian_product(
      const Data<T>& data, const Local<T, points>& u, const Eigen::Matrix<T, 3 * points, 1>& du) const {
    Eigen::Matrix<T, 3 * points, 1> sum = Eigen::Matrix<T, 3 * points, 1>::Zero();
    for (std::size_t k = 0; k < n; ++k) sum += local.hessian_product(data[k], u, du);
    return sum;
  }
  /// Sum of the points' discrete gradients, N.
  template <class T>
  [[nodiscard]] Eigen::Matrix<T, 3 * points, 1> discrete_gradient(
      const Data<T>& data, const Local<T, points>& u_0, const Local<T, points>& u_1) const requires requires {
    local.discrete_gradient(data[0], u_0, u_1);
  }
  {
    Eigen::Matrix<T, 3 * points, 1> sum = Eigen::Matrix<T, 3 * points, 1>::Zero();
    for (std::size_t k = 0; k < n; ++k) sum += local.discrete_gradient(data[k], u_0, u_1);
    return sum;
  }
};

/// A mesh whose elements are isoparametric: hexahedra, ten-node tetrahedra.
template <class Mesh>
concept IsoparametricElements = SolidMesh<Mesh> && ShapeFunctions<typename Mesh::Shape>;

/// Rest data of the integration points of one element with shape functions S and nodes X in m.
/// @throws std::invalid_argument unless the Jacobian determinant is positive at all of them
template <ShapeFunctions S>
[[nodiscard]] auto integration_data(const typename Isoparametric<S>::Nodes& X) {
  std::array<typename Isoparametric<S>::template Data<double>, S::stiffness_rule.size()> data;
  for (std::size_t k = 0; k < data.size(); ++k) data[k] = Isoparametric<S>::make(X, S::stiffness_rule[k]);
  return data;
}

/// Elastic energy of one element with shape functions S.
template <ShapeFunctions S, class M>
using ElasticElement = Quadrature<Elastic<Isoparametric<S>, M>, S::stiffness_rule.size()>;

/// Elastic energy of a mesh of isoparametric elements.
template <class Mesh, class M, class T = double, int N = default_lanes<T>>
using ElasticBody = Elements<ElasticElement<typename Mesh::Shape, M>, T, N>;

/// Elastic energy of `mesh` with one of `materials` per element; `material_index` chooses it and may be empty
/// if there is one material only.
/// @throws std::invalid_argument for an index out of range or a list of the wrong length
template <class T = double, int N = default_lanes<T>, IsoparametricElements Mesh, class M>
[[nodiscard]] ElasticBody<Mesh, M, T, N> elastic(const Mesh& mesh, const std::vector<M>& materials,
                                                 const std::vector<std::int32_t>& material_index = {}) {
  using S = typename Mesh::Shape;
  if (materials.empty()) invalid("elastic: no material");
  if (material_index.empty() && materials.size() > 1)
    invalid(std::string("elastic: ") + std::to_string(materials.size()) + " materials need an index per " +
            S::name.singular);
  std::vector<typename ElasticElement<S, M>::template Data<double>> data;
  data.reserve(mesh.elements().size());
  for (std::size_t e = 0; e < mesh.elements().size(); ++e)
    data.push_back(integration_data<S>(mesh.element_points(e)));
  std::vector<ElasticElement<S, M>> models;
  for (const M& material : materials) models.push_back({{material}});
  return {std::move(models), data, mesh.elements(), material_index};
}

/// Elastic energy of `mesh` made of one material.
template <class T = double, int N = default_lanes<T>, IsoparametricElements Mesh, class M>
requires Material<M>
[[nodiscard]] ElasticBody<Mesh, M, T, N> elastic(const Mesh& mesh, const M& material) {
  return elastic<T, N>(mesh, std::vector<M>{material});
}

}  // namespace softsim
