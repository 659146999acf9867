// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "softsim/core/error.hpp"
#include "softsim/core/state.hpp"
#include "softsim/mesh/element_mesh.hpp"

namespace softsim {

/// Mass matrix of points: a scalar m_ij times the 3x3 identity between points i and j. Lumped (diagonal: the
/// row sums of the consistent mass, a quarter of each tetrahedron on each corner; for ten-node tetrahedra,
/// whose corners would get negative masses that way, the consistent diagonal scaled to the mass of the
/// element, HRZ) or consistent (int rho N_i N_j dV; for linear tetrahedra rho V/10 on the diagonal, rho V/20
/// beside it).
template <class T>
class Mass {
 public:
  /// No mass on any of the points and frames.
  explicit Mass(std::size_t points = 0, std::size_t frames = 0)
      : diagonal_(Vector<T>::Zero(block_stride * static_cast<std::ptrdiff_t>(points + 2 * frames))),
        row_start_(points + 2 * frames + 1, 0) {}

  /// Lumped mass.
  /// @param density kg/m^3, one per element
  /// @throws std::invalid_argument unless there is one positive, finite density per element
  template <SolidMesh Mesh>
  [[nodiscard]] static Mass lumped(const Mesh& mesh, const std::vector<double>& density) {
    check(mesh, density);
    Mass mass(mesh.points().size());
    for (std::size_t e = 0; e < density.size(); ++e) {
      const auto volumes = mesh.lumped_volumes(e);
      for (std::size_t i = 0; i < volumes.size(); ++i)
        mass.add_diagonal(mesh.elements()[e][i], density[e] * volumes[i]);
    }
    return mass;
  }
  /// Lumped mass of a body of one density in kg/m^3.
  template <SolidMesh Mesh>
  [[nodiscard]] static Mass lumped(const Mesh& mesh, double density) {
    return lumped(mesh, std::vector<double>(mesh.elements().size(), density));
  }

  /// Consistent mass. @throws as `lumped`
  template <SolidMesh Mesh>
  [[nodiscard]] static Mass consistent(const Mesh& mesh, const std::vector<double>& density) {
    check(mesh, density);
    Mass mass(mesh.points().size());
    struct Entry {
      std::int32_t row, column;
      double value;
    };
    std::vector<Entry> entries;
    for (std::size_t e = 0; e < density.size(); ++e) {
      const auto& nodes = mesh.elements()[e];
      if (e == 0) entries.reserve(nodes.size() * (nodes.size() - 1) * density.size());
      const auto products = mesh.shape_products(e);
      for (std::size_t i = 0; i < nodes.size(); ++i)
        for (std::size_t j = 0; j < nodes.size(); ++j) {
          const double m = density[e] * products(static_cast<int>(i), static_cast<int>(j));
          if (i == j)
            mass.add_diagonal(nodes[i], m);
          else
            entries.push_back({nodes[i], nodes[j], m});
        }
    }
    std::stable_sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
      return a.row != b.row ? a.row < b.row : a.column < b.column;
    });
    std::vector<double> sums;
    for (std::size_t k = 0; k < entries.size(); ++k) {
      const bool repeated =
          k > 0 && entries[k].row == entries[k - 1].row && entries[k].column == entries[k - 1].column;
      if (repeated) {
        sums.back() += entries[k].value;
      } else {
        mass.column_.push_back(entries[k].column);
        sums.push_back(entries[k].value);
        ++mass.row_start_[static_cast<std::size_t>(entries[k].row) + 1];
      }
    }
    for (std::size_t i = 1; i < mass.row_start_.size(); ++i) mass.row_start_[i] += mass.row_start_[i - 1];
    mass.value_.assign(sums.begin(), sums.end());
    return mass;
  }
  /// Consistent mass of a body of one density in kg/m^3.
  template <SolidMesh Mesh>
  [[nodiscard]] static Mass consistent(const Mesh& mesh, double density) {
    return consistent(mesh, std::vector<double>(mesh.elements().size(), density));
  }

  /// True if the matrix is diagonal.
  [[nodiscard]] bool is_lumped() const { return column_.empty(); }
  /// Number of entries off the diagonal.
  [[nodiscard]] std::size_t couplings() const { return column_.size(); }
  /// Diagonal of the matrix, kg: one block per point.
  [[nodiscard]] const Vector<T>& diagonal() const { return diagonal_; }

  /// Sum of all entries, kg: the mass of the body.
  [[nodiscard]] double total() const {
    double sum = 0;
    for (std::ptrdiff_t i = 0; i < diagonal_.size(); i += block_stride)
      sum += static_cast<double>(diagonal_[i]);
    for (const T m : value_) sum += static_cast<double>(m);
    return sum;
  }

  /// y += scale M x.
  void add_product(const Vector<T>& x, T scale, Vector<T>& y) const {
    y.array() += scale * diagonal_.array() * x.array();
    if (is_lumped()) return;
    for (std::size_t i = 0; i + 1 < row_start_.size(); ++i) {
      Vec3<T> sum = Vec3<T>::Zero();
      for (std::int32_t k = row_start_[i]; k < row_start_[i + 1]; ++k)
        sum += value_[static_cast<std::size_t>(k)] * block(x, column_[static_cast<std::size_t>(k)]);
      block(y, static_cast<std::ptrdiff_t>(i)) += scale * sum;
    }
  }

  /// Calls f(i, j, m_ij) for every entry off the diagonal.
  template <class Function>
  void for_each_coupling(Function f) const {
    for (std::size_t i = 0; i + 1 < row_start_.size(); ++i)
      for (std::int32_t k = row_start_[i]; k < row_start_[i + 1]; ++k)
        f(static_cast<std::int32_t>(i), column_[static_cast<std::size_t>(k)],
          value_[static_cast<std::size_t>(k)]);
  }

 private:
  template <SolidMesh Mesh>
  static void check(const Mesh& mesh, const std::vector<double>& density) {
    if (density.size() != mesh.elements().size())
      invalid(std::string("mass: ") + std::to_string(density.size()) + " densities for " +
              std::to_string(mesh.elements().size()) + " " + Mesh::name.plural);
    for (const double rho : density)
      if (!(rho > 0) || !(rho <= 1e300))
        invalid(std::string("density ") + to_text(rho) + " kg/m^3: must be positive and finite");
  }
  void add_diagonal(std::int32_t i, double m) { block(diagonal_, i).array() += static_cast<T>(m); }

  Vector<T> diagonal_;
  std::vector<std::int32_t> row_start_, column_;
  std::vector<T> value_;
};

}  // namespace softsim
