// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <nanoflann.hpp>
#include <utility>
#include <vector>

#include "softsim/core/tensor.hpp"
#include "softsim/mesh/point_grid.hpp"

namespace softsim {

/// nanoflann's k-d tree as a `NeighbourSearch`: for points in clusters, on curves or on sheets, where a
/// `PointGrid` wastes cells. Both give the same answers. Copies share one tree.
class KdTree {
 public:
  /// @param points in m
  /// @throws std::invalid_argument naming a point whose coordinates are not finite
  explicit KdTree(std::vector<Vec3<double>> points) {
    detail::require_finite(points);
    tree_ = std::make_shared<const Tree>(std::move(points));
  }

  /// The points in m.
  [[nodiscard]] const std::vector<Vec3<double>>& points() const { return tree_->points; }

  /// Numbers of the points at most `radius` (m) from x (m), ascending.
  /// @throws std::invalid_argument if x is not finite
  [[nodiscard]] std::vector<std::int32_t> within(const Vec3<double>& x, double radius) const {
    detail::require_finite(x);
    if (!(radius >= 0)) return {};
    return detail::keep_within(points(), candidates(x, radius * radius), x, radius * radius);
  }

  /// Numbers of the `count` points nearest to x (m), ascending; of two equally far ones the lower number.
  /// @throws std::invalid_argument if x is not finite
  [[nodiscard]] std::vector<std::int32_t> nearest(const Vec3<double>& x, std::size_t count) const {
    detail::require_finite(x);
    count = std::min(count, points().size());
    if (count == 0) return {};
    // nanoflann breaks ties as the tree happens to be; it tells how far to look, the rule then decides.
    std::vector<std::uint32_t> numbers(count);
    std::vector<double> squares(count);
    tree_->index.knnSearch(x.data(), count, numbers.data(), squares.data());
    const double square = *std::max_element(squares.begin(), squares.end());
    return detail::keep_nearest(points(), candidates(x, square), x, count);
  }

 private:
  // The points, as nanoflann asks for them, and their tree.
  struct Tree {
    explicit Tree(std::vector<Vec3<double>> given) : points(std::move(given)), index(3, *this) {}
    [[nodiscard]] std::size_t kdtree_get_point_count() const { return points.size(); }
    [[nodiscard]] double kdtree_get_pt(std::size_t i, std::size_t axis) const {
      return points[i][static_cast<Eigen::Index>(axis)];
    }
    template <class Box>
    bool kdtree_get_bbox(Box&) const {
      return false;  // nanoflann works it out
    }

    std::vector<Vec3<double>> points;
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Tree>, Tree, 3> index;
  };

  // All points with a squared distance up to `square`, and few more: nanoflann's bounds are rounded, and it
  // leaves out what lies on the radius.
  [[nodiscard]] std::vector<std::int32_t> candidates(const Vec3<double>& x, double square) const {
    std::vector<std::pair<std::uint32_t, double>> found;
    const double slack = square * (1 + 1e-10) + std::numeric_limits<double>::min();
    tree_->index.radiusSearch(x.data(), slack, found, nanoflann::SearchParams(32, 0, false));
    std::vector<std::int32_t> numbers;
    for (const auto& entry : found) numbers.push_back(static_cast<std::int32_t>(entry.first));
    return numbers;
  }

  std::shared_ptr<const Tree> tree_;
};

}  // namespace softsim
