// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Eigenvalues>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "softsim/concepts.hpp"
#include "softsim/core/error.hpp"
#include "softsim/kinematics/isoparametric.hpp"
#include "softsim/kinematics/linear_tetrahedron.hpp"
#include "softsim/mesh/element_mesh.hpp"
#include "softsim/mesh/tetrahedral_mesh.hpp"
#include "softsim/potential/quadrature.hpp"

namespace softsim {

/// What is known of one deformed element, as means over its integration points: of J and psi by rest volume,
/// of the Cauchy stress by deformed volume.
struct ElementField {
  double j;                ///< det F, deformed over rest volume
  double von_mises;        ///< of the Cauchy stress, Pa
  Vec3<double> principal;  ///< principal Cauchy stresses, largest first, Pa
  double energy_density;   ///< psi, J/m^3 of rest volume
};

/// Cauchy stress sigma = P F^T / J, symmetrised (for a small-strain law it is symmetric to first order only).
[[nodiscard]] inline Mat3<double> cauchy_stress(const Mat3<double>& F, const Mat3<double>& P) {
  return symmetric_part<double>(P * F.transpose() / determinant(F));
}

/// sqrt(3/2 s : s) with s the deviator of sigma.
[[nodiscard]] inline double von_mises(const Mat3<double>& sigma) {
  const Mat3<double> s = sigma - trace(sigma) / 3 * Mat3<double>::Identity();
  return std::sqrt(1.5 * double_dot(s, s));
}

namespace detail {

// Calls f(kinematics, rest data) for every integration point of element e.
template <class Function>
void for_each_integration_point(const TetrahedralMesh& mesh, std::size_t e, Function f) {
  f(LinearTetrahedron{}, LinearTetrahedron::make(mesh.element_points(e)));
}
template <IsoparametricElements Mesh, class Function>
void for_each_integration_point(const Mesh& mesh, std::size_t e, Function f) {
  using S = typename Mesh::Shape;
  for (const auto& data : integration_data<S>(mesh.element_points(e))) f(Isoparametric<S>{}, data);
}

}  // namespace detail

/// Fields of every element at q, in the order of the mesh; arguments as for `elastic`. Stresses of an element
/// with a point whose F the law is not defined for (J <= 0 for Neo-Hookean) are NaN.
/// @throws std::invalid_argument as `elastic` does for its list of indices
template <SolidMesh Mesh, class T, class M>
[[nodiscard]] std::vector<ElementField> element_fields(const Mesh& mesh, const std::vector<M>& materials,
                                                       const std::vector<std::int32_t>& material_index,
                                                       const State<T>& q) {
  const std::size_t count = mesh.elements().size();
  if (materials.empty() || (!material_index.empty() && material_index.size() != count))
    invalid(std::string("element fields: ") + std::to_string(materials.size()) + " materials and " +
            std::to_string(material_index.size()) + " indices for " + std::to_string(count) + " " +
            Mesh::name.plural);
  for (const std::int32_t m : material_index)
    if (m < 0 || static_cast<std::size_t>(m) >= materials.size())
      invalid(std::string("element fields: material index ") + std::to_string(m) + " is out of range");
  std::vector<ElementField> fields;
  fields.reserve(count);
  for (std::size_t e = 0; e < count; ++e) {
    const M& material = materials[material_index.empty() ? 0 : static_cast<std::size_t>(material_index[e])];
    double rest = 0, deformed = 0, energy = 0;
    Mat3<double> sum = Mat3<double>::Zero();
    detail::for_each_integration_point(mesh, e, [&]<class K>(K, const auto& data) {
      Local<double, K::points> u;
      for (std::size_t i = 0; i < u.points.size(); ++i)
        u.points[i] = q.point(mesh.elements()[e][i]).template cast<double>();
      const Mat3<double> F = K::deformation_gradient(data, u), P = material.first_piola(F);
      const double V = K::volume(data), v = V * determinant(F);
      rest += V;
      deformed += v;
      energy += V * material.energy_density(F);
      sum += v * cauchy_stress(F, P);
    });
    const Mat3<double> sigma = sum / deformed;
    ElementField field{deformed / rest, von_mises(sigma), Vec3<double>::Constant(std::nan("")),
                       energy / rest};
    if (sigma.allFinite())
      field.principal =
          Eigen::SelfAdjointEigenSolver<Mat3<double>>(sigma, Eigen::EigenvaluesOnly).eigenvalues().reverse();
    fields.push_back(field);
  }
  return fields;
}

}  // namespace softsim
