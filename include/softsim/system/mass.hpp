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
#include "softsim/system/frame_mass.hpp"

namespace softsim {

/// Mass matrix of points: a scalar m_ij times the 3x3 identity between points i and j. Lumped (diagonal: the
/// row sums of the consistent mass, a quarter of each tetrahedron on each corner; for ten-node tetrahedra,
/// whose corners would get negative masses that way, the consistent diagonal scaled to the mass of the
/// element, HRZ) or consistent (int rho N_i N_j dV; for linear tetrahedra rho V/10 on the diagonal, rho V/20
/// beside it). Frames have a `FrameMass`, whose matrix changes with their rotations.
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

  /// Lumped mass of the frames of a body of one density in kg/m^3: see `FrameMass`. @throws as there
  template <int N>
  [[nodiscard]] static Mass lumped(const FrameBody<N>& body, double density) {
    return Mass(body.points(), FrameMass<T>::lumped(body, std::vector<double>(body.size(), density)));
  }
  /// Consistent mass of the frames of a body of one density in kg/m^3.
  template <int N>
  [[nodiscard]] static Mass consistent(const FrameBody<N>& body, double density) {
    return Mass(body.points(), FrameMass<T>::consistent(body, std::vector<double>(body.size(), density)));
  }
  /// Mass of frames behind a number of points that have none.
  Mass(std::size_t points, FrameMass<T> frames) : Mass(points, frames.size()) {
    frames_ = std::move(frames);
    set_frame_diagonal();
  }

  /// Adds another body's: the same points and frames, or points alone, which come first.
  /// @throws std::invalid_argument if sizes do not fit, or both couple points
  Mass& operator+=(const Mass& other) {
    if (other.diagonal_.size() > diagonal_.size() ||
        (other.frames_.size() > 0 && other.diagonal_.size() != diagonal_.size()))
      invalid(std::string("mass: ") + std::to_string(other.diagonal_.size() / block_stride) +
              " blocks added to " + std::to_string(diagonal_.size() / block_stride));
    if (!column_.empty() && !other.column_.empty())
      invalid("mass: two consistent masses of points cannot be added");
    diagonal_.head(other.diagonal_.size()) += other.diagonal_;
    if (column_.empty()) {
      column_ = other.column_;
      value_ = other.value_;
      std::copy(other.row_start_.begin(), other.row_start_.end(), row_start_.begin());
      std::fill(row_start_.begin() + static_cast<std::ptrdiff_t>(other.row_start_.size()), row_start_.end(),
                other.row_start_.back());
    }
    if (other.frames_.size() > 0) {
      frames_ += other.frames_;
      set_frame_diagonal();
    }
    return *this;
  }

  /// True if points and frames are not coupled.
  [[nodiscard]] bool is_lumped() const { return column_.empty() && frames_.is_lumped(); }
  /// The part of frames.
  [[nodiscard]] const FrameMass<T>& frames() const { return frames_; }
  /// Number of entries off the diagonal.
  [[nodiscard]] std::size_t couplings() const { return column_.size() + frames_.couplings(); }
  /// Diagonal of the matrix, kg and, for rotations, kg m^2: one block per point, two per frame.
  [[nodiscard]] const Vector<T>& diagonal() const { return diagonal_; }

  /// Sum of all entries, kg: the mass of the body.
  [[nodiscard]] double total() const {
    double sum = frames_.total();
    for (std::ptrdiff_t i = 0; i < point_size(); i += block_stride) sum += static_cast<double>(diagonal_[i]);
    for (const T m : value_) sum += static_cast<double>(m);
    return sum;
  }

  /// y += scale M(q) x.
  void add_product(const State<T>& q, const Vector<T>& x, T scale, Vector<T>& y) const {
    add_product_of_points(x, scale, y);
    frames_.add_product(q, x, scale, y);
  }
  /// The same with frames as they are at rest.
  void add_product(const Vector<T>& x, T scale, Vector<T>& y) const {
    add_product_of_points(x, scale, y);
    if (frames_.size() > 0) frames_.add_product(rest_state(), x, scale, y);
  }
  /// y += scale times the gyroscopic forces, see `FrameMass::add_gyroscopic`; points have none.
  void add_gyroscopic(const State<T>& q, const Vector<T>& v, T scale, Vector<T>& y) const {
    frames_.add_gyroscopic(q, v, scale, y);
  }
  /// Points and frames at rest.
  [[nodiscard]] State<T> rest_state() const {
    return State<T>(static_cast<std::size_t>(point_size() / block_stride), frames_.size());
  }

  /// Calls f(i, j, m_ij) for every entry off the diagonal between points.
  template <class Function>
  void for_each_coupling(Function f) const {
    for (std::size_t i = 0; i + 1 < row_start_.size(); ++i)
      for (std::int32_t k = row_start_[i]; k < row_start_[i + 1]; ++k)
        f(static_cast<std::int32_t>(i), column_[static_cast<std::size_t>(k)],
          value_[static_cast<std::size_t>(k)]);
  }

 private:
  // Scalars of points in a flat vector.
  [[nodiscard]] std::ptrdiff_t point_size() const {
    return diagonal_.size() - 2 * block_stride * static_cast<std::ptrdiff_t>(frames_.size());
  }
  void set_frame_diagonal() {
    for (std::size_t j = 0; j < frames_.size(); ++j) {
      const std::ptrdiff_t b = point_size() / block_stride + 2 * static_cast<std::ptrdiff_t>(j);
      const auto& m = frames_.moments(j);
      block(diagonal_, b).setConstant(m(0, 0));
      const Vec3<T> second = m.diagonal().template tail<3>();
      block(diagonal_, b + 1) = Vec3<T>::Constant(second.sum()) - second;
    }
  }
  void add_product_of_points(const Vector<T>& x, T scale, Vector<T>& y) const {
    const std::ptrdiff_t n = point_size();
    y.head(n).array() += scale * diagonal_.head(n).array() * x.head(n).array();
    if (column_.empty()) return;
    for (std::size_t i = 0; i + 1 < row_start_.size(); ++i) {
      Vec3<T> sum = Vec3<T>::Zero();
      for (std::int32_t k = row_start_[i]; k < row_start_[i + 1]; ++k)
        sum += value_[static_cast<std::size_t>(k)] * block(x, column_[static_cast<std::size_t>(k)]);
      block(y, static_cast<std::ptrdiff_t>(i)) += scale * sum;
    }
  }

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
  FrameMass<T> frames_;
  std::vector<std::int32_t> row_start_, column_;
  std::vector<T> value_;
};

}  // namespace softsim
