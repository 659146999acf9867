// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "softsim/core/error.hpp"
#include "softsim/core/tensor.hpp"
#include "softsim/mesh/selection.hpp"

namespace softsim {

/// Finds the boxes that hold a point, in time about constant for boxes of like size that do not overlap much,
/// as those of the elements of a mesh: a uniform grid of at most as many cells as boxes.
class BoxGrid {
 public:
  /// @param boxes in m, at least one
  /// @throws std::invalid_argument if there are no boxes
  explicit BoxGrid(std::vector<BoundingBox> boxes) : boxes_(std::move(boxes)) {
    if (boxes_.empty()) invalid("box grid: there are no boxes");
    all_ = boxes_.front();
    for (const BoundingBox& box : boxes_) {
      all_.lower = all_.lower.cwiseMin(box.lower);
      all_.upper = all_.upper.cwiseMax(box.upper);
    }
    choose_cells();
    list_boxes();
  }

  /// Numbers of the boxes that hold x (m), ascending.
  [[nodiscard]] std::vector<std::size_t> holding(const Vec3<double>& x) const {
    std::vector<std::size_t> result;
    if (!holds(all_, x)) return result;
    const Cell c = cell(x);
    const std::size_t number = (c[2] * cells_[1] + c[1]) * cells_[0] + c[0];
    for (std::size_t s = start_[number]; s < start_[number + 1]; ++s)
      if (holds(boxes_[listed_[s]], x)) result.push_back(listed_[s]);
    return result;
  }

 private:
  using Cell = std::array<std::size_t, 3>;

  static bool holds(const BoundingBox& box, const Vec3<double>& x) {
    return (x.array() >= box.lower.array()).all() && (x.array() <= box.upper.array()).all();
  }

  // Cubes as small as their number allows; a flat body gets a flat grid.
  void choose_cells() {
    const Vec3<double> extent = all_.upper - all_.lower;
    const double longest = extent.maxCoeff();
    const auto along = [&](double n, int axis) { return std::floor(extent[axis] / longest * n) + 1; };
    double n = 1;
    if (longest > 0) {
      while (along(1.25 * n, 0) * along(1.25 * n, 1) * along(1.25 * n, 2) <=
             static_cast<double>(boxes_.size()))
        n *= 1.25;
      per_metre_ = n / longest;
      for (int a = 0; a < 3; ++a) cells_[static_cast<std::size_t>(a)] = static_cast<std::size_t>(along(n, a));
    }
  }

  // The boxes that reach into cell c are listed_[start_[c]] up to listed_[start_[c + 1] - 1].
  void list_boxes() {
    start_.assign(cells_[0] * cells_[1] * cells_[2] + 1, 0);
    for (const BoundingBox& box : boxes_) for_each_cell(box, [&](std::size_t c) { ++start_[c + 1]; });
    for (std::size_t c = 1; c < start_.size(); ++c) start_[c] += start_[c - 1];
    std::vector<std::size_t> next = start_;
    listed_.resize(start_.back());
    for (std::size_t b = 0; b < boxes_.size(); ++b)
      for_each_cell(boxes_[b], [&](std::size_t c) { listed_[next[c]++] = b; });
  }

  template <class Function>
  void for_each_cell(const BoundingBox& box, Function f) const {
    const Cell low = cell(box.lower), high = cell(box.upper);
    for (std::size_t k = low[2]; k <= high[2]; ++k)
      for (std::size_t j = low[1]; j <= high[1]; ++j)
        for (std::size_t i = low[0]; i <= high[0]; ++i) f((k * cells_[1] + j) * cells_[0] + i);
  }

  // Monotonic along each axis in spite of rounding: a point of a box is in a cell of the box.
  [[nodiscard]] Cell cell(const Vec3<double>& x) const {
    Cell result{};
    for (std::size_t a = 0; a < 3; ++a) {
      const double position = (x - all_.lower)[static_cast<Eigen::Index>(a)] * per_metre_;
      result[a] = static_cast<std::size_t>(std::clamp(position, 0.0, static_cast<double>(cells_[a] - 1)));
    }
    return result;
  }

  std::vector<BoundingBox> boxes_;
  BoundingBox all_;
  double per_metre_ = 0;
  Cell cells_{1, 1, 1};
  std::vector<std::size_t> start_, listed_;
};

}  // namespace softsim
