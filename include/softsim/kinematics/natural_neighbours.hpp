// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "softsim/core/error.hpp"
#include "softsim/core/tensor.hpp"
#include "softsim/kinematics/affine_hull.hpp"
#include "softsim/kinematics/convex_cell.hpp"
#include "softsim/kinematics/node_shapes.hpp"
#include "softsim/kinematics/point_text.hpp"
#include "softsim/mesh/point_grid.hpp"

namespace softsim {

/// Sibson's natural neighbour shape functions of scattered nodes (Sibson 1981; Sukumar, Moran & Belytschko
/// 1998; Bosman 2015, Sec. 4.1 and Table 4.1): if x were a node, its Voronoi cell would take the volume v_i
/// from the cell of node i; phi_i = v_i / sum v. They are not negative, reproduce linear fields, interpolate,
/// and adapt to the spacing of the nodes without any length to choose.
/// grad v_i = A_i (c_i - x) / |x_i - x|, A_i and c_i being area and centroid of the facet between x and x_i:
/// that facet, half-way, moves by (y - x).dx / |x_i - x| at its point y, and nothing else of v_i does.
/// Coplanar and collinear nodes are taken within their plane (areas) or line (lengths: linear
/// interpolation): x is projected onto it, and gradients lie in it.
/// The cell of a point at a small depth t below the hull's surface reaches out by spacing^2 / t about. Points
/// count as outside where rounding, which grows with the cube of that, makes the gradients of linear fields
/// wrong by more than 1e-6: at depths below 1e-4 of the spacing or so. So the functions exist inside the hull
/// and at its nodes, not on the rest of its surface.
template <NeighbourSearch Search = PointGrid>
class NaturalNeighbours {
 public:
  /// @param nodes rest positions in m
  /// @throws std::invalid_argument if there are no nodes, a coordinate is not finite, or two nodes are nearer
  ///   to each other than 1e-9 of the extent of all
  explicit NaturalNeighbours(std::vector<Vec3<double>> nodes)
      : nodes_(std::move(nodes)), hull_(nodes_), search_(hull_.local(nodes_)) {
    for (std::size_t i = 0; i < nodes_.size(); ++i)
      for (const std::int32_t j : search_.nearest(local(i), 2))
        if (static_cast<std::size_t>(j) != i && (local(j) - local(i)).norm() <= same_place())
          invalid(std::string("nodes ") + std::to_string(std::min(i, static_cast<std::size_t>(j))) + " and " +
                  std::to_string(std::max(i, static_cast<std::size_t>(j))) +
                  " are at the same place: natural neighbours need distinct nodes");
  }

  /// Rest positions in m.
  [[nodiscard]] const std::vector<Vec3<double>>& nodes() const { return nodes_; }
  /// Linear fields are reproduced.
  [[nodiscard]] int consistency() const { return 1; }
  /// They have the Kronecker property.
  [[nodiscard]] bool interpolates() const { return true; }
  /// Infinite: it depends on the other nodes.
  [[nodiscard]] double support() const { return std::numeric_limits<double>::infinity(); }

  /// The shape functions at x (m). They have no gradient at a node (within 1e-9 of the extent), only
  /// slopes that depend on the direction: there, the gradients of the node's neighbours are those by which
  /// sum u_i g_i fits the slopes (u_j - u_i) / |x_j - x_i| best (least squares). They reproduce linear
  /// fields. The neighbours are listed with value 0.
  /// @throws std::invalid_argument if x is not finite or not inside the convex hull of the nodes
  [[nodiscard]] ShapeValues at(const Vec3<double>& x) const {
    if (!x.allFinite()) invalid(std::string("point ") + detail::point_text(x) + " m: is not finite");
    const Vec3<double> y = hull_.local(x);
    const std::int32_t nearest = search_.nearest(y, 1).front();
    if ((local(nearest) - y).norm() <= same_place()) return at_node(nearest);
    for (double half_width = hull_.extent(); half_width < 4e4 * hull_.extent(); half_width *= 32) {
      const ConvexCell cell = voronoi_cell(y, none, half_width);
      if (!is_bounded(cell)) continue;
      if (const auto result = stolen(cell, natural_neighbours(cell, y))) return *result;
      break;
    }
    invalid(
        std::string("point ") + detail::point_text(x) +
        " m: is not inside the convex hull of the nodes, its Voronoi cell is unbounded or reaches too far");
  }

 private:
  static constexpr std::int32_t none = -1;

  // A facet between x and a node.
  struct Neighbour {
    std::int32_t node;
    Vec3<double> offset;  // x_i - x
    Vec3<double> moment;  // A_i (c_i - x)
  };

  template <class Index>
  [[nodiscard]] const Vec3<double>& local(Index i) const {
    return search_.points()[static_cast<std::size_t>(i)];
  }
  [[nodiscard]] double same_place() const { return 1e-9 * hull_.extent(); }

  // The Voronoi cell of y among the nodes but `own`, relative to y, within a cube. In a plane or line it is a
  // prism over the cell there, which the cube closes: ratios of volumes are those of areas or lengths.
  [[nodiscard]] ConvexCell voronoi_cell(const Vec3<double>& y, std::int32_t own, double half_width) const {
    ConvexCell cell(half_width);
    const std::vector<std::int32_t> first = search_.nearest(y, 24);
    cut(cell, y, own, first);
    // Nodes farther than twice the cell's radius have their bisectors outside of it.
    const std::vector<std::int32_t> all = search_.within(y, 2 * cell.radius(hull_.dimension()));
    std::vector<std::int32_t> rest;
    std::set_difference(all.begin(), all.end(), first.begin(), first.end(), std::back_inserter(rest));
    cut(cell, y, own, rest);
    return cell;
  }

  // Cuts the cell along the bisectors between y and the nodes, the nearest first.
  void cut(ConvexCell& cell, const Vec3<double>& y, std::int32_t own,
           const std::vector<std::int32_t>& nodes) const {
    std::vector<std::pair<double, std::int32_t>> ranked;
    for (const std::int32_t i : nodes)
      if (i != own) ranked.emplace_back((local(i) - y).norm(), i);
    std::sort(ranked.begin(), ranked.end());
    for (const auto& [distance, i] : ranked) {
      if (distance > 2 * cell.radius(hull_.dimension())) return;
      cell.clip(local(i) - y, distance * distance / 2, i);
    }
  }

  [[nodiscard]] bool is_bounded(const ConvexCell& cell) const {
    return std::none_of(cell.facets().begin(), cell.facets().end(), [&](const ConvexCell::Facet& facet) {
      return facet.plane < 0 && (-1 - facet.plane) / 2 < hull_.dimension();
    });
  }

  // The nodes with which the cell of y shares a facet, ascending; without the facets that a regular grid
  // makes by rounding.
  [[nodiscard]] std::vector<Neighbour> natural_neighbours(const ConvexCell& cell,
                                                          const Vec3<double>& y) const {
    double largest = 0;
    for (const ConvexCell::Facet& facet : cell.facets())
      if (facet.plane >= 0) largest = std::max(largest, facet.area_vector().norm());
    std::vector<Neighbour> result;
    for (const ConvexCell::Facet& facet : cell.facets()) {
      if (facet.plane < 0 || facet.area_vector().norm() <= 1e-12 * largest) continue;
      Vec3<double> moment = facet.first_moment();
      for (int a = hull_.dimension(); a < 3; ++a) moment[a] = 0;
      result.push_back({facet.plane, local(facet.plane) - y, moment});
    }
    std::sort(result.begin(), result.end(),
              [](const Neighbour& a, const Neighbour& b) { return a.node < b.node; });
    return result;
  }

  // What each neighbour loses: the part of the cell that is nearer to it than to the other neighbours.
  // Nothing if rounding has spoilt it.
  [[nodiscard]] std::optional<ShapeValues> stolen(const ConvexCell& cell,
                                                  const std::vector<Neighbour>& neighbours) const {
    double sum = 0;
    Vec3<double> sum_of_gradients = Vec3<double>::Zero();
    ShapeValues result;
    for (const Neighbour& n : neighbours) {
      ConvexCell part = cell;
      for (const Neighbour& other : neighbours) {
        const Vec3<double> between = other.offset - n.offset;
        if (other.node != n.node) part.clip(between, between.dot(other.offset + n.offset) / 2, other.node);
      }
      result.nodes.push_back(n.node);
      result.values.push_back(part.volume());
      result.gradients.push_back(n.moment / n.offset.norm());
      sum += result.values.back();
      sum_of_gradients += result.gradients.back();
    }
    Mat3<double> identity = Mat3<double>::Zero();  // within the hull
    for (std::size_t k = 0; k < result.nodes.size(); ++k) {
      result.values[k] /= sum;
      result.gradients[k] = (result.gradients[k] - result.values[k] * sum_of_gradients) / sum;
      identity += result.gradients[k] * neighbours[k].offset.transpose();
      result.gradients[k] = hull_.direction(result.gradients[k]);
    }
    for (int a = 0; a < hull_.dimension(); ++a) identity(a, a) -= 1;
    if (!(identity.norm() <= 1e-6)) return std::nullopt;
    return result;
  }

  [[nodiscard]] ShapeValues at_node(std::int32_t own) const {
    std::vector<Neighbour> neighbours;
    Mat3<double> M = Mat3<double>::Identity();
    // The cell of a node of the hull's surface is unbounded, hence cut off; a larger one has more neighbours.
    for (double half_width = hull_.extent(); half_width < 4e4 * hull_.extent(); half_width *= 32) {
      neighbours = natural_neighbours(voronoi_cell(local(own), own, half_width), local(own));
      M.setZero();
      for (int a = hull_.dimension(); a < 3; ++a) M(a, a) = 1;
      for (const Neighbour& n : neighbours) M += n.offset * n.offset.transpose() / n.offset.squaredNorm();
      if (Eigen::SelfAdjointEigenSolver<Mat3<double>>(M).eigenvalues()[0] > 1e-6) break;
    }
    const Mat3<double> inverse = M.inverse();
    Vec3<double> sum = Vec3<double>::Zero();
    ShapeValues result;
    for (const Neighbour& n : neighbours) {
      result.nodes.push_back(n.node);
      result.values.push_back(0);
      result.gradients.push_back(hull_.direction(inverse * n.offset) / n.offset.squaredNorm());
      sum += result.gradients.back();
    }
    const auto place = std::lower_bound(result.nodes.begin(), result.nodes.end(), own) - result.nodes.begin();
    result.nodes.insert(result.nodes.begin() + place, own);
    result.values.insert(result.values.begin() + place, 1);
    result.gradients.insert(result.gradients.begin() + place, -sum);
    return result;
  }

  std::vector<Vec3<double>> nodes_;
  AffineHull hull_;
  Search search_;
};

}  // namespace softsim
