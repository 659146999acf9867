// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "softsim/core/error.hpp"
#include "softsim/core/tensor.hpp"
#include "softsim/mesh/element_mesh.hpp"
#include "softsim/mesh/shape_functions.hpp"

namespace softsim {

/// A mesh of isoparametric elements, X = sum X_i N_i(xi), that has been checked: all node numbers exist,
/// every element has different nodes and a positive Jacobian determinant det dX/dxi at all its integration
/// points, and every node belongs to an element.
template <ShapeFunctions S>
class IsoparametricMesh : public ElementMesh<static_cast<std::size_t>(S::nodes)> {
 public:
  static constexpr std::size_t nodes = static_cast<std::size_t>(S::nodes);
  static constexpr ElementName name = S::name;
  using Shape = S;
  using Base = ElementMesh<nodes>;
  using typename Base::Element;

  /// @param points node positions in m
  /// @param elements node numbers in the order of the shape functions
  /// @param region one number per element; empty means all 0
  /// Nodes that no element uses are dropped, the rest keep their order; `warnings()` says how many.
  /// @throws std::invalid_argument naming the node or element: no elements, coordinates that are not finite,
  ///   node numbers out of range or repeated, a Jacobian determinant that is not positive at an integration
  ///   point, a region list of another length
  IsoparametricMesh(std::vector<Vec3<double>> points, std::vector<Element> elements,
                    std::vector<int> region = {})
      : Base(name, std::move(points), std::move(elements), std::move(region)) {
    for (std::size_t e = 0; e < this->elements().size(); ++e) {
      check(e, S::stiffness_rule);
      check(e, S::mass_rule);
    }
  }

  /// Rest volume of element e in m^3.
  [[nodiscard]] double volume(std::size_t e) const {
    double sum = 0;
    integrate(e, [&](const auto&, double dV) { sum += dV; });
    return sum;
  }
  /// Rest volume of the body in m^3.
  [[nodiscard]] double volume() const {
    double sum = 0;
    for (std::size_t e = 0; e < this->elements().size(); ++e) sum += volume(e);
    return sum;
  }

  /// int N_i dV over element e, m^3.
  [[nodiscard]] std::array<double, nodes> shape_integrals(std::size_t e) const {
    std::array<double, nodes> sum{};
    integrate(e, [&](const Eigen::Matrix<double, S::nodes, 1>& N, double dV) {
      for (std::size_t i = 0; i < nodes; ++i) sum[i] += N[static_cast<int>(i)] * dV;
    });
    return sum;
  }
  /// int N_i N_j dV over element e, m^3.
  [[nodiscard]] Eigen::Matrix<double, S::nodes, S::nodes> shape_products(std::size_t e) const {
    Eigen::Matrix<double, S::nodes, S::nodes> sum = Eigen::Matrix<double, S::nodes, S::nodes>::Zero();
    integrate(e,
              [&](const Eigen::Matrix<double, S::nodes, 1>& N, double dV) { sum += dV * N * N.transpose(); });
    return sum;
  }
  /// Volume per node that a lumped mass uses, m^3: the row sums int N_i dV where they are positive by nature,
  /// else the diagonal of `shape_products` scaled to the volume of the element (Hinton, Rock & Zienkiewicz
  /// 1976).
  [[nodiscard]] std::array<double, nodes> lumped_volumes(std::size_t e) const {
    if constexpr (S::row_sum_lumping) {
      return shape_integrals(e);
    } else {
      const Eigen::Matrix<double, S::nodes, 1> diagonal = shape_products(e).diagonal();
      const double scale = volume(e) / diagonal.sum();
      std::array<double, nodes> volumes{};
      for (std::size_t i = 0; i < nodes; ++i) volumes[i] = scale * diagonal[static_cast<int>(i)];
      return volumes;
    }
  }

 private:
  template <class Function>
  void integrate(std::size_t e, Function f) const {
    const std::array<Vec3<double>, nodes> X = this->element_points(e);
    for (const IntegrationPoint<3>& point : S::mass_rule)
      f(S::values(point.xi), point.weight * determinant(jacobian<S>(X, point.xi)));
  }

  template <class Rule>
  void check(std::size_t e, const Rule& rule) const {
    const std::array<Vec3<double>, nodes> X = this->element_points(e);
    double longest = 0;
    for (std::size_t a = 0; a < nodes; ++a)
      for (std::size_t b = 0; b < a; ++b) longest = std::max(longest, (X[a] - X[b]).norm());
    for (const IntegrationPoint<3>& point : rule) {
      const double det = determinant(jacobian<S>(X, point.xi));
      // as for linear tetrahedra: the rounding of the coordinates has to stay four digits away
      const bool flat = std::abs(det) <= 1e-12 * longest * longest * longest;
      if (det > 0 && !flat) continue;
      invalid(std::string(name.singular) + " " + std::to_string(e) + ": " +
              (flat ? "degenerate" : "inverted") + ", Jacobian determinant " + to_text(det) +
              " m^3 at (xi, eta, zeta) = (" + to_text(point.xi[0]) + ", " + to_text(point.xi[1]) + ", " +
              to_text(point.xi[2]) + ") is not positive");
    }
  }
};

/// Node numbers of one face of a mesh of such elements.
template <ShapeFunctions S>
using FaceOf = std::array<std::int32_t, static_cast<std::size_t>(S::Face::nodes)>;

/// Faces that belong to one element only, nodes in the order of `S::Face`, counter-clockwise seen from
/// outside.
template <ShapeFunctions S>
[[nodiscard]] std::vector<FaceOf<S>> boundary_faces(const IsoparametricMesh<S>& mesh) {
  std::map<FaceOf<S>, std::pair<FaceOf<S>, int>> count;
  for (const auto& v : mesh.elements())
    for (const auto& f : S::faces) {
      FaceOf<S> face, key;
      for (std::size_t i = 0; i < face.size(); ++i) face[i] = v[f[i]];
      key = face;
      std::sort(key.begin(), key.end());
      auto& entry = count[key];
      entry.first = face;
      ++entry.second;
    }
  std::vector<FaceOf<S>> result;
  for (const auto& [key, entry] : count)
    if (entry.second == 1) result.push_back(entry.first);
  return result;
}

/// The faces all of whose nodes are among `nodes` (see `nodes_near`).
template <std::size_t n>
[[nodiscard]] std::vector<std::array<std::int32_t, n>> faces_on(
    const std::vector<std::array<std::int32_t, n>>& faces, std::vector<std::int32_t> nodes) {
  std::sort(nodes.begin(), nodes.end());
  std::vector<std::array<std::int32_t, n>> result;
  for (const auto& face : faces)
    if (std::all_of(face.begin(), face.end(),
                    [&](std::int32_t i) { return std::binary_search(nodes.begin(), nodes.end(), i); }))
      result.push_back(face);
  return result;
}

}  // namespace softsim
