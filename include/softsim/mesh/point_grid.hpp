// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "softsim/core/error.hpp"
#include "softsim/core/tensor.hpp"

namespace softsim {

/// Finds the neighbours of any place among fixed points (m). Distances are compared by their squares, as
/// rounded, so that all searches agree on ties.
///  - `within(x, radius)`: numbers of the points with |x - x_i| <= radius, ascending; none if the radius is
///    negative, all if it is infinite;
///  - `nearest(x, count)`: the `count` nearest, of two equally far ones that with the lower number; their
///    numbers, ascending; all if there are no more than that.
/// Points and x are finite, else the constructor and the queries throw `std::invalid_argument`.
template <class S>
concept NeighbourSearch = std::constructible_from<S, std::vector<Vec3<double>>> &&
    requires(const S& search, const Vec3<double>& x, double radius, std::size_t count) {
  { search.points() } -> std::same_as<const std::vector<Vec3<double>>&>;
  { search.within(x, radius) } -> std::same_as<std::vector<std::int32_t>>;
  { search.nearest(x, count) } -> std::same_as<std::vector<std::int32_t>>;
};

namespace detail {

inline void require_finite(const std::vector<Vec3<double>>& points) {
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!points[i].allFinite())
      invalid(std::string("node ") + std::to_string(i) + ": a coordinate is not a finite number");
}

inline void require_finite(const Vec3<double>& x) {
  if (!x.allFinite()) invalid("point to find neighbours of: a coordinate is not a finite number");
}

// |a - b|^2. Compilers may or may not contract x x + y y, in one place so and in another not; written as
// fused products it rounds alike everywhere, which ties and points on the radius depend on.
inline double squared_distance(const Vec3<double>& a, const Vec3<double>& b) {
  const double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
  return std::fma(z, z, std::fma(y, y, x * x));
}

// Those of `numbers` that are at most sqrt(square) from x, ascending.
inline std::vector<std::int32_t> keep_within(const std::vector<Vec3<double>>& points,
                                             std::vector<std::int32_t> numbers, const Vec3<double>& x,
                                             double square) {
  std::erase_if(numbers, [&](std::int32_t i) {
    return squared_distance(points[static_cast<std::size_t>(i)], x) > square;
  });
  std::sort(numbers.begin(), numbers.end());
  return numbers;
}

// The `count` of `numbers` that are nearest to x, ascending.
inline std::vector<std::int32_t> keep_nearest(const std::vector<Vec3<double>>& points,
                                              const std::vector<std::int32_t>& numbers, const Vec3<double>& x,
                                              std::size_t count) {
  std::vector<std::pair<double, std::int32_t>> ranked;
  for (const std::int32_t i : numbers)
    ranked.emplace_back(squared_distance(points[static_cast<std::size_t>(i)], x), i);
  std::sort(ranked.begin(), ranked.end());
  ranked.resize(std::min(count, ranked.size()));
  std::vector<std::int32_t> result;
  for (const auto& entry : ranked) result.push_back(entry.second);
  std::sort(result.begin(), result.end());
  return result;
}

}  // namespace detail

/// Points sorted into the equal cells of a box, about as many cells as points: a query costs as much as it
/// finds, and building is linear, where the points spread evenly over their box. That holds for curves and
/// sheets along the axes; where most cells would be empty (clusters, curves and sheets at a slant) answers
/// stay exact but cost more, and a tree (ext/nanoflann.hpp) is better from some thousand points on.
class PointGrid {
 public:
  /// @param points in m
  /// @throws std::invalid_argument naming a point whose coordinates are not finite
  explicit PointGrid(std::vector<Vec3<double>> points) : points_(std::move(points)) {
    detail::require_finite(points_);
    if (points_.empty()) return;
    choose_cells();
    sort_into_cells();
  }

  /// The points in m.
  [[nodiscard]] const std::vector<Vec3<double>>& points() const { return points_; }

  /// Numbers of the points at most `radius` (m) from x (m), ascending.
  /// @throws std::invalid_argument if x is not finite
  [[nodiscard]] std::vector<std::int32_t> within(const Vec3<double>& x, double radius) const {
    detail::require_finite(x);
    if (points_.empty() || !(radius >= 0)) return {};
    // A little more than the radius, since the squares that are compared are rounded, and to nought when
    // small.
    const Vec3<double> reach = Vec3<double>::Constant(radius * (1 + 1e-14) + 1e-150);
    const Cell low = cell(x - reach), high = cell(x + reach);
    std::vector<std::int32_t> candidates;
    for (std::size_t k = low[2]; k <= high[2]; ++k)
      for (std::size_t j = low[1]; j <= high[1]; ++j) {
        const std::size_t row = (k * cells_[1] + j) * cells_[0];
        for (std::size_t s = start_[row + low[0]]; s < start_[row + high[0] + 1]; ++s)
          candidates.push_back(sorted_[s]);
      }
    return detail::keep_within(points_, std::move(candidates), x, radius * radius);
  }

  /// Numbers of the `count` points nearest to x (m), ascending; of two equally far ones the lower number.
  /// @throws std::invalid_argument if x is not finite
  [[nodiscard]] std::vector<std::int32_t> nearest(const Vec3<double>& x, std::size_t count) const {
    detail::require_finite(x);
    count = std::min(count, points_.size());
    if (count == 0) return {};
    // A ball that just enters the box grows until it holds enough; it then holds the nearest.
    const double outside = (x - x.cwiseMax(lower_).cwiseMin(upper_)).norm();
    double depth =
        extent_ / per_extent_ * std::cbrt(static_cast<double>(count)) + std::numeric_limits<double>::min();
    std::vector<std::int32_t> found = within(x, outside + depth);
    while (found.size() < count) found = within(x, outside + (depth *= 2));
    return detail::keep_nearest(points_, found, x, count);
  }

 private:
  using Cell = std::array<std::size_t, 3>;

  // The finest cubes, by steps of a fifth, that are no more than the points.
  void choose_cells() {
    lower_ = upper_ = points_[0];
    for (const Vec3<double>& p : points_) {
      lower_ = lower_.cwiseMin(p);
      upper_ = upper_.cwiseMax(p);
    }
    if (const double longest = (upper_ - lower_).maxCoeff(); longest > 0) extent_ = longest;
    const auto along = [&](double per_extent, int axis) {
      return std::floor((upper_ - lower_)[axis] / extent_ * per_extent) + 1;
    };
    const auto count = [&](double n) { return along(n, 0) * along(n, 1) * along(n, 2); };
    if (upper_ != lower_)
      while (count(1.25 * per_extent_) <= static_cast<double>(points_.size())) per_extent_ *= 1.25;
    for (int a = 0; a < 3; ++a)
      cells_[static_cast<std::size_t>(a)] = static_cast<std::size_t>(along(per_extent_, a));
  }

  // Counting sort: the points of cell c are sorted_[start_[c]] up to sorted_[start_[c + 1] - 1].
  void sort_into_cells() {
    std::vector<std::size_t> cell_of(points_.size());
    start_.assign(cells_[0] * cells_[1] * cells_[2] + 1, 0);
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const Cell c = cell(points_[i]);
      cell_of[i] = (c[2] * cells_[1] + c[1]) * cells_[0] + c[0];
      ++start_[cell_of[i] + 1];
    }
    for (std::size_t c = 1; c < start_.size(); ++c) start_[c] += start_[c - 1];
    std::vector<std::size_t> next = start_;
    sorted_.resize(points_.size());
    for (std::size_t i = 0; i < points_.size(); ++i)
      sorted_[next[cell_of[i]]++] = static_cast<std::int32_t>(i);
  }

  // The cell that holds x or, from outside, is next to it; monotonic along each axis in spite of rounding.
  [[nodiscard]] Cell cell(const Vec3<double>& x) const {
    Cell result{};
    for (std::size_t a = 0; a < 3; ++a) {
      const auto axis = static_cast<Eigen::Index>(a);
      const double position = (x[axis] - lower_[axis]) / extent_ * per_extent_;
      result[a] = static_cast<std::size_t>(std::clamp(position, 0.0, static_cast<double>(cells_[a] - 1)));
    }
    return result;
  }

  std::vector<Vec3<double>> points_;
  Vec3<double> lower_ = Vec3<double>::Zero(), upper_ = Vec3<double>::Zero();
  double extent_ = 1;      // longest side of the box in m, 1 if it has none
  double per_extent_ = 1;  // cells along it
  Cell cells_{};
  std::vector<std::size_t> start_;
  std::vector<std::int32_t> sorted_;
};

}  // namespace softsim
