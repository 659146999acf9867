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
#include "softsim/kinematics/linear_tetrahedron.hpp"
#include "softsim/mesh/tetrahedral_mesh.hpp"

namespace softsim {

/// What is known of one deformed tetrahedron.
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

/// Fields of every tetrahedron at q, in the order of the mesh; arguments as for `elastic`. Stresses of a
/// tetrahedron whose F the law is not defined for (J <= 0 for Neo-Hookean) are NaN.
/// @throws std::invalid_argument as `elastic` does for its list of indices
template <class T, class M>
[[nodiscard]] std::vector<ElementField> element_fields(const TetrahedralMesh& mesh,
                                                       const std::vector<M>& materials,
                                                       const std::vector<std::int32_t>& material_index,
                                                       const State<T>& q) {
  if (materials.empty() || (!material_index.empty() && material_index.size() != mesh.tetrahedra().size()))
    invalid(std::string("element fields: ") + std::to_string(materials.size()) + " materials and " +
            std::to_string(material_index.size()) + " indices for " +
            std::to_string(mesh.tetrahedra().size()) + " tetrahedra");
  for (const std::int32_t m : material_index)
    if (m < 0 || static_cast<std::size_t>(m) >= materials.size())
      invalid(std::string("element fields: material index ") + std::to_string(m) + " is out of range");
  std::vector<ElementField> fields;
  fields.reserve(mesh.tetrahedra().size());
  for (std::size_t t = 0; t < mesh.tetrahedra().size(); ++t) {
    std::array<Vec3<double>, 4> X;
    Local<double, 4> u;
    for (std::size_t i = 0; i < 4; ++i) {
      const std::int32_t node = mesh.tetrahedra()[t][i];
      X[i] = mesh.points()[static_cast<std::size_t>(node)];
      u.points[i] = q.point(node).template cast<double>();
    }
    const M& material = materials[material_index.empty() ? 0 : static_cast<std::size_t>(material_index[t])];
    const Mat3<double> F = LinearTetrahedron::deformation_gradient(LinearTetrahedron::make(X), u);
    const Mat3<double> sigma = cauchy_stress(F, material.first_piola(F));
    ElementField field{determinant(F), von_mises(sigma), Vec3<double>::Constant(std::nan("")),
                       material.energy_density(F)};
    if (sigma.allFinite())
      field.principal =
          Eigen::SelfAdjointEigenSolver<Mat3<double>>(sigma, Eigen::EigenvaluesOnly).eigenvalues().reverse();
    fields.push_back(field);
  }
  return fields;
}

}  // namespace softsim
