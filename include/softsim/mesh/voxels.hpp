// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "softsim/core/error.hpp"
#include "softsim/core/tensor.hpp"
#include "softsim/mesh/domain.hpp"

namespace softsim {

/// One cell of a regular grid that holds a part of a domain.
struct Voxel {
  std::array<int, 3> cell;  ///< its place in the grid along x, y, z
  Vec3<double> centre;      ///< centre of the part inside, m
  double volume;            ///< of the part inside, m^3
};

/// A domain on a regular grid (Bosman 2015, Sec. 4.1 "Domain sampling"). The grid fills the box of the
/// domain, with the fewest equal cells along each axis that are no longer than the spacing.
///
/// Each cell is asked for 2 x 2 x 2 points. Where they and those of the 26 neighbours agree it is full or
/// empty; else the part inside is counted with `subdivisions`^3 points. Parts of the domain thinner than half
/// a cell can be missed.
class Voxels {
 public:
  /// @param spacing longest allowed edge of a cell in m
  /// @param subdivisions points per axis in a cell at the boundary
  /// All volumes are multiplied by one factor, so that their sum is the volume of the domain.
  /// @throws std::invalid_argument for a spacing that is not positive, larger than the domain or so small as
  ///   to need more than 2^28 cells, subdivisions outside [2, 64], or no point inside the domain
  template <Domain D>
  Voxels(const D& domain, double spacing, int subdivisions = 4) {
    const Eigen::AlignedBox3d box = domain.box();
    detail::check_spacing(box, spacing);
    if (subdivisions < 2 || subdivisions > 64)
      invalid(std::string("subdivisions ") + std::to_string(subdivisions) + ": must lie in [2, 64]");
    cells_ = detail::cells_of(box, spacing, spacing);
    origin_ = box.min();
    size_ = box.sizes().cwiseQuotient(Vec3<double>(cells_[0], cells_[1], cells_[2]));
    const std::vector<std::uint8_t> coarse = coarse_counts(domain);
    for (int k = 0; k < cells_[2]; ++k)
      for (int j = 0; j < cells_[1]; ++j)
        for (int i = 0; i < cells_[0]; ++i) {
          const int all = coarse[number({i, j, k})] == 0 ? 0 : subdivisions * subdivisions * subdivisions;
          const Part part = alike(coarse, {i, j, k}) ? Part{all, corner({i, j, k}, 0.5)}
                                                     : count_inside(domain, {i, j, k}, subdivisions);
          if (part.points > 0) voxels_.push_back({{i, j, k}, part.centre, double(part.points)});
        }
    if (voxels_.empty())
      invalid(std::string("spacing ") + to_text(spacing) + ": no voxel has a point inside the domain");
    set_volumes(detail::checked_volume(domain.volume()), size_.prod() / std::pow(subdivisions, 3));
  }

  /// The cells that hold a part of the domain, x fastest.
  [[nodiscard]] const std::vector<Voxel>& voxels() const { return voxels_; }
  /// Lowest corner of the grid, m.
  [[nodiscard]] const Vec3<double>& origin() const { return origin_; }
  /// Edges of a cell, m.
  [[nodiscard]] const Vec3<double>& size() const { return size_; }
  /// Cells of the grid along each axis, the empty ones too.
  [[nodiscard]] const std::array<int, 3>& cells() const { return cells_; }
  /// The factor that the counted volumes were multiplied by. Far from 1, the cells are too coarse for the
  /// domain, or its volume does not fit what it contains (a surface that crosses itself).
  [[nodiscard]] double scale() const { return scale_; }

 private:
  using Cell = std::array<int, 3>;
  struct Part {
    int points;
    Vec3<double> centre;
  };

  [[nodiscard]] std::size_t number(const Cell& c) const {
    const auto n = [&](std::size_t a) { return static_cast<std::size_t>(cells_[a]); };
    return (static_cast<std::size_t>(c[2]) * n(1) + static_cast<std::size_t>(c[1])) * n(0) +
           static_cast<std::size_t>(c[0]);
  }
  /// Point of a cell at a fraction of its edges.
  [[nodiscard]] Vec3<double> corner(const Cell& c, const Vec3<double>& fraction) const {
    return origin_ + size_.cwiseProduct(Vec3<double>(c[0], c[1], c[2]) + fraction);
  }
  [[nodiscard]] Vec3<double> corner(const Cell& c, double fraction) const {
    return corner(c, Vec3<double>::Constant(fraction));
  }

  template <Domain D>
  [[nodiscard]] Part count_inside(const D& domain, const Cell& c, int n) const {
    Vec3<double> sum = Vec3<double>::Zero();
    int inside = 0;
    for (int k = 0; k < n; ++k)
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
          const Vec3<double> x = corner(c, Vec3<double>(i + 0.5, j + 0.5, k + 0.5) / n);
          if (!domain.contains(x)) continue;
          sum += x;
          ++inside;
        }
    return {inside, inside == 0 ? corner(c, 0.5) : Vec3<double>(sum / inside)};
  }

  /// Points inside out of eight per cell.
  template <Domain D>
  [[nodiscard]] std::vector<std::uint8_t> coarse_counts(const D& domain) const {
    std::vector<std::uint8_t> counts;
    counts.reserve(number({0, 0, cells_[2]}));
    for (int k = 0; k < cells_[2]; ++k)
      for (int j = 0; j < cells_[1]; ++j)
        for (int i = 0; i < cells_[0]; ++i)
          counts.push_back(static_cast<std::uint8_t>(count_inside(domain, {i, j, k}, 2).points));
    return counts;
  }

  /// Whether a cell and its neighbours are all full or all empty; there is nothing beyond the grid.
  [[nodiscard]] bool alike(const std::vector<std::uint8_t>& counts, const Cell& c) const {
    const std::uint8_t own = counts[number(c)];
    if (own != 0 && own != 8) return false;
    for (int k = c[2] - 1; k <= c[2] + 1; ++k)
      for (int j = c[1] - 1; j <= c[1] + 1; ++j)
        for (int i = c[0] - 1; i <= c[0] + 1; ++i) {
          const bool in_grid = i >= 0 && j >= 0 && k >= 0 && i < cells_[0] && j < cells_[1] && k < cells_[2];
          if ((in_grid ? counts[number({i, j, k})] : 0) != own) return false;
        }
    return true;
  }

  /// Turns the points of each voxel, whose sum has no rounding, into its volume.
  void set_volumes(double volume, double volume_per_point) {
    double points = 0;
    for (const Voxel& voxel : voxels_) points += voxel.volume;
    for (Voxel& voxel : voxels_) voxel.volume *= volume / points;
    scale_ = volume / (points * volume_per_point);
  }

  Vec3<double> origin_, size_;
  double scale_ = 1;
  Cell cells_{};
  std::vector<Voxel> voxels_;
};

}  // namespace softsim
