// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "softsim/core/error.hpp"
#include "softsim/core/tensor.hpp"
#include "softsim/mesh/isoparametric_mesh.hpp"
#include "softsim/mesh/samples.hpp"
#include "softsim/mesh/shape_functions.hpp"
#include "softsim/mesh/tetrahedral_mesh.hpp"

namespace softsim {

/// Samples of a mesh that know their elements; the samples of an element follow one another.
struct ElementSamples : Samples {
  std::vector<std::int32_t> elements;  ///< number of the element that each lies in
};

namespace detail {

/// Maps the reference tetrahedron to a linear one.
struct LinearTetrahedronMap {
  static constexpr int nodes = 4;
  static Eigen::Vector4d values(const std::array<double, 3>& xi) {
    return {1 - xi[0] - xi[1] - xi[2], xi[0], xi[1], xi[2]};
  }
  static Eigen::Matrix<double, 4, 3> gradients(const std::array<double, 3>&) {
    Eigen::Matrix<double, 4, 3> dN;
    dN << -1, -1, -1, 1, 0, 0, 0, 1, 0, 0, 0, 1;
    return dN;
  }
};

/// What the weights of a rule are shares of.
enum class Weights { reference_volume, element_volume };

/// The points of `rule` in every element, their shares scaled so that they sum to its volume.
template <class Shape, class Mesh, class Rule>
ElementSamples samples_in_elements(const Mesh& mesh, const Rule& rule, Weights weights) {
  ElementSamples samples;
  for (std::size_t e = 0; e < mesh.elements().size(); ++e) {
    const auto X = mesh.element_points(e);
    const std::size_t first = samples.volumes.size();
    double sum = 0;
    for (const IntegrationPoint<3>& point : rule) {
      const Eigen::Matrix<double, Shape::nodes, 1> N = Shape::values(point.xi);
      Vec3<double> x = Vec3<double>::Zero();
      for (int i = 0; i < Shape::nodes; ++i) x += N[i] * X[static_cast<std::size_t>(i)];
      const double share = weights == Weights::element_volume
                               ? point.weight
                               : point.weight * determinant(jacobian<Shape>(X, point.xi));
      samples.positions.push_back(x);
      samples.volumes.push_back(share);
      samples.elements.push_back(static_cast<std::int32_t>(e));
      sum += share;
    }
    const double scale = mesh.volume(e) / sum;
    for (std::size_t s = first; s < samples.volumes.size(); ++s) samples.volumes[s] *= scale;
  }
  return samples;
}

/// k (k + 1) (k + 2) / 6 points in the reference tetrahedron, a lattice that keeps its symmetry, drawn
/// together so far that equal weights are exact for degree 2: mean of L_i^2 = 1/10, the rest by symmetry.
inline std::vector<IntegrationPoint<3>> equal_tetrahedron_points(int k) {
  std::vector<IntegrationPoint<3>> rule;
  double mean = 0, square = 0;
  for (int a = 0; a < k; ++a)
    for (int b = 0; a + b < k; ++b)
      for (int c = 0; a + b + c < k; ++c) {
        rule.push_back({{double(a), double(b), double(c)}, 1});
        mean += a;
        square += a * a;
      }
  const auto n = static_cast<double>(rule.size());
  mean /= n;
  square /= n;
  // L = (a + m) / (k - 1 + 4 m): the mean of (a + m)^2 is a tenth of the denominator squared
  double m = 1;
  if (k > 1) {
    const double A = 6, B = 8 * (k - 1) - 20 * mean, C = (k - 1) * (k - 1) - 10 * square;
    m = (-B + std::sqrt(B * B - 4 * A * C)) / (2 * A);
  }
  for (IntegrationPoint<3>& point : rule)
    for (double& L : point.xi) L = (L + m) / (k - 1 + 4 * m);
  return rule;
}

/// k^3 points in [-1, 1]^3: the middles of equal cells, moved apart so far that equal weights are exact for
/// degree 3 along each axis (k = 2 is the Gauss rule).
inline std::vector<IntegrationPoint<3>> equal_cube_points(int k) {
  const double scale = k == 1 ? 0 : 1 / std::sqrt(1 - 1.0 / (k * k));
  const auto at = [&](int i) { return scale * ((2 * i + 1.0) / k - 1); };
  std::vector<IntegrationPoint<3>> rule;
  for (int c = 0; c < k; ++c)
    for (int b = 0; b < k; ++b)
      for (int a = 0; a < k; ++a) rule.push_back({{at(a), at(b), at(c)}, 1});
  return rule;
}

/// The k for which `count(k)` is `per_element`.
template <class Count>
int lattice_size(int per_element, Count count, const char* kind) {
  int k = 1;
  while (k < 48 && count(k) < per_element) ++k;
  if (count(k) == per_element) return k;
  const std::string below = k > 1 ? std::to_string(count(k - 1)) + " or " : "";
  invalid(std::string("per_element ") + std::to_string(per_element) + ": must be a " + kind + " such as " +
          below + std::to_string(count(k)));
}
inline std::vector<IntegrationPoint<3>> equal_points_in_tetrahedron(int per_element) {
  return equal_tetrahedron_points(lattice_size(
      per_element, [](int k) { return k * (k + 1) * (k + 2) / 6; }, "tetrahedral number"));
}

}  // namespace detail

/// Gauss points of linear tetrahedra: 1 point (exact for degree 1), 4 (degree 2) or 14 (degree 5).
/// @throws std::invalid_argument for another number
[[nodiscard]] inline ElementSamples gauss_samples(const TetrahedralMesh& mesh, int points = 4) {
  const auto samples = [&](const auto& rule) {
    return detail::samples_in_elements<detail::LinearTetrahedronMap>(mesh, rule,
                                                                     detail::Weights::reference_volume);
  };
  if (points == 1) return samples(detail::equal_tetrahedron_points(1));
  if (points == 4) return samples(QuadraticTetrahedronShape::stiffness_rule);
  if (points == 14) return samples(QuadraticTetrahedronShape::mass_rule);
  invalid(std::string("Gauss points ") + std::to_string(points) + ": must be 1, 4 or 14 in a tetrahedron");
}

/// The two rules of an isoparametric element.
enum class ElementRule { stiffness, mass };

/// Gauss points of isoparametric elements, by the rule for the stiffness (hexahedra 8, ten-node tetrahedra 4
/// points) or for the mass (27 and 14). Where a rule misses the volume of an element (the stiffness rule in
/// ten-node tetrahedra with curved sides), its shares are scaled to it.
template <ShapeFunctions S>
[[nodiscard]] ElementSamples gauss_samples(const IsoparametricMesh<S>& mesh,
                                           ElementRule rule = ElementRule::stiffness) {
  constexpr auto weights = detail::Weights::reference_volume;
  return rule == ElementRule::stiffness ? detail::samples_in_elements<S>(mesh, S::stiffness_rule, weights)
                                        : detail::samples_in_elements<S>(mesh, S::mass_rule, weights);
}

/// Points spread over each tetrahedron with equal shares of its volume (Bosman 2015, Sec. 4.1 "Mesh-based
/// simulation scheme"): 1, 4, 10, 20, 35, ... points of a lattice, so placed that from 4 points on equal
/// shares are exact for degree 2.
/// @throws std::invalid_argument for a number that is not k (k + 1) (k + 2) / 6 with k up to 48
[[nodiscard]] inline ElementSamples equal_samples(const TetrahedralMesh& mesh, int per_element) {
  return detail::samples_in_elements<detail::LinearTetrahedronMap>(
      mesh, detail::equal_points_in_tetrahedron(per_element), detail::Weights::element_volume);
}
/// The same in isoparametric elements: in hexahedra 1, 8, 27, 64, ... points in rows (k^3), in ten-node
/// tetrahedra as in linear ones. Exact as there (in hexahedra for degree 3 along each axis) where the map
/// from the reference shape is affine; where det dX/dxi varies over the element equal shares ignore it.
template <ShapeFunctions S>
[[nodiscard]] ElementSamples equal_samples(const IsoparametricMesh<S>& mesh, int per_element) {
  if constexpr (std::same_as<S, TrilinearHexahedronShape>)
    return detail::samples_in_elements<S>(mesh,
                                          detail::equal_cube_points(detail::lattice_size(
                                              per_element, [](int k) { return k * k * k; }, "cube")),
                                          detail::Weights::element_volume);
  else
    return detail::samples_in_elements<S>(mesh, detail::equal_points_in_tetrahedron(per_element),
                                          detail::Weights::element_volume);
}

}  // namespace softsim
