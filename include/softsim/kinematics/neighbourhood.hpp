// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "softsim/core/error.hpp"
#include "softsim/core/tensor.hpp"
#include "softsim/kinematics/point_text.hpp"
#include "softsim/mesh/point_grid.hpp"

namespace softsim {

/// A node near the place x that is looked at.
struct Neighbour {
  std::int32_t node;
  Vec3<double> offset;  ///< x - x_i, m
  double distance;      ///< |x - x_i|, m
};

/// Scattered nodes and the rule by which some of them are the neighbours of a place: those less than a
/// radius away, of these only a number of nearest ones if asked for. All scattered shape functions stand on
/// it.
template <NeighbourSearch Search = PointGrid>
class Neighbourhood {
 public:
  /// @param nodes rest positions in m
  /// @param radius in m; infinite: no limit
  /// @param nearest largest number of neighbours; 0: no limit
  /// @throws std::invalid_argument if there are no nodes, a coordinate is not finite or the radius is not
  ///   positive
  Neighbourhood(std::vector<Vec3<double>> nodes, double radius, std::size_t nearest)
      : search_(std::move(nodes)), radius_(radius), nearest_(nearest) {
    if (search_.points().empty()) invalid("shape functions: there are no nodes");
    if (!(radius > 0)) invalid(std::string("radius ") + to_text(radius) + " m: must be positive");
  }

  /// Rest positions in m.
  [[nodiscard]] const std::vector<Vec3<double>>& nodes() const { return search_.points(); }
  /// In m, infinite if there is none.
  [[nodiscard]] double radius() const { return radius_; }

  /// The neighbours of x (m), ascending by node; at least one.
  /// @throws std::invalid_argument with x and the distance of the nearest node if there are none, or if x is
  ///   not finite
  [[nodiscard]] std::vector<Neighbour> at(const Vec3<double>& x) const {
    std::vector<Neighbour> result;
    for (const std::int32_t i : nearest_ > 0 ? search_.nearest(x, nearest_) : search_.within(x, radius_))
      if (const Neighbour n = neighbour(i, x); n.distance < radius_) result.push_back(n);
    if (result.empty()) {
      const Neighbour n = neighbour(search_.nearest(x, 1).front(), x);
      invalid("shape functions at " + detail::point_text(x) + ": no node is within the radius " +
              to_text(radius_) + " m, the nearest, node " + std::to_string(n.node) + ", is " +
              to_text(n.distance) + " m away");
    }
    return result;
  }

  /// @throws std::invalid_argument naming two nodes at the same place, where nothing can interpolate
  void require_distinct_nodes() const {
    for (std::size_t i = 0; i < nodes().size(); ++i) {
      // two at most: all nodes at one place would otherwise cost the square of their number
      for (const std::int32_t j : search_.nearest(nodes()[i], 2))
        if (static_cast<std::size_t>(j) != i && neighbour(j, nodes()[i]).distance == 0)
          invalid(std::string("nodes ") + std::to_string(std::min(i, static_cast<std::size_t>(j))) + " and " +
                  std::to_string(std::max(i, static_cast<std::size_t>(j))) +
                  " are at the same place: interpolating shape functions need distinct nodes");
    }
  }

 private:
  [[nodiscard]] Neighbour neighbour(std::int32_t i, const Vec3<double>& x) const {
    const Vec3<double> offset = x - nodes()[static_cast<std::size_t>(i)];
    return {i, offset, offset.norm()};
  }

  Search search_;
  double radius_;
  std::size_t nearest_;
};

namespace detail {

// Index of the nearest neighbour, the first of equally near ones.
inline std::size_t nearest_of(const std::vector<Neighbour>& near) {
  const auto closer = [](const Neighbour& a, const Neighbour& b) { return a.distance < b.distance; };
  return static_cast<std::size_t>(std::min_element(near.begin(), near.end(), closer) - near.begin());
}

// Distance of the farthest neighbour in m, as the unit of a polynomial basis; 1 where it would be 0.
inline double reach_of(const std::vector<Neighbour>& near) {
  double reach = 0;
  for (const Neighbour& n : near) reach = std::max(reach, n.distance);
  return reach > 0 ? reach : 1;
}

}  // namespace detail

}  // namespace softsim
