// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "softsim/core/tensor.hpp"

namespace softsim {

/// A convex polyhedron around the origin that planes cut down: a Voronoi cell in the making. Facets are
/// polygons of their own, without shared vertices, so that planes through vertices, edges or along facets,
/// which regular grids make all the time, need no special case: they leave facets without area.
class ConvexCell {
 public:
  /// A facet, corners counter-clockwise seen from outside, and the number of the plane that made it.
  struct Facet {
    int plane;
    std::vector<Vec3<double>> corners;

    /// Area times unit normal, outward.
    [[nodiscard]] Vec3<double> area_vector() const {
      Vec3<double> sum = Vec3<double>::Zero();
      for (std::size_t k = 2; k < corners.size(); ++k)
        sum += (corners[k - 1] - corners[0]).cross(corners[k] - corners[0]) / 2;
      return sum;
    }
    /// Area times centroid, the first moment of the facet.
    [[nodiscard]] Vec3<double> first_moment() const {
      const Vec3<double> normal = area_vector().normalized();
      Vec3<double> sum = Vec3<double>::Zero();
      for (std::size_t k = 2; k < corners.size(); ++k)
        sum += normal.dot((corners[k - 1] - corners[0]).cross(corners[k] - corners[0])) / 6 *
               (corners[0] + corners[k - 1] + corners[k]);
      return sum;
    }
  };

  /// The cube [-half_width, half_width]^3; its sides are planes -1 (low x), -2 (high x), -3 ... -6 (high z).
  explicit ConvexCell(double half_width) {
    for (int side = 0; side < 6; ++side) {
      const int a = side / 2, b = (a + 1) % 3, c = (a + 2) % 3;
      const double s = side % 2 == 0 ? -half_width : half_width;
      Facet facet{-1 - side, {}};
      for (int k = 0; k < 4; ++k) {
        Vec3<double> corner;
        corner[a] = s;
        corner[b] = k == 1 || k == 2 ? s : -s;  // turns the other way round on the low side
        corner[c] = k < 2 ? -half_width : half_width;
        facet.corners.push_back(corner);
      }
      facets_.push_back(facet);
    }
  }

  [[nodiscard]] const std::vector<Facet>& facets() const { return facets_; }

  /// Keeps the part with normal . y <= offset; the new facet gets the number `plane`.
  void clip(const Vec3<double>& normal, double offset, int plane) {
    const double length = normal.norm();
    const Vec3<double> n = normal / length;
    const double height = offset / length;
    const auto above = [&](const Vec3<double>& y) { return n.dot(y) - height; };
    const auto is_cut = [&](const Facet& facet) {
      return std::any_of(facet.corners.begin(), facet.corners.end(),
                         [&](const Vec3<double>& y) { return above(y) > 0; });
    };
    if (std::none_of(facets_.begin(), facets_.end(), is_cut)) return;
    std::vector<Facet> kept;
    Facet cap{plane, {}};
    for (Facet& facet : facets_) {
      if (!is_cut(facet)) {
        kept.push_back(std::move(facet));
        continue;
      }
      Facet part{facet.plane, {}};
      for (std::size_t k = 0; k < facet.corners.size(); ++k) {
        const Vec3<double>&y = facet.corners[k], &z = facet.corners[(k + 1) % facet.corners.size()];
        const double p = above(y), q = above(z);
        if (p <= 0) part.corners.push_back(y);
        if ((p <= 0) == (q <= 0)) continue;
        const Vec3<double> cut = p <= 0 ? crossing(y, z, p, q) : crossing(z, y, q, p);
        cap.corners.push_back(cut);
        if (p < 0 || q < 0) part.corners.push_back(cut);  // else it is a corner that is kept anyway
      }
      if (part.corners.size() > 2) kept.push_back(std::move(part));
    }
    cap.corners = sorted_around(n, cap.corners);
    if (cap.corners.size() > 2) kept.push_back(std::move(cap));
    facets_ = std::move(kept);
  }

  /// Volume, 0 if nothing is left.
  [[nodiscard]] double volume() const {
    double sum = 0;
    for (const Facet& facet : facets_) sum += facet.area_vector().dot(facet.corners[0]) / 3;
    return sum;
  }

  /// Greatest distance of a corner from the origin along the first `dimension` axes.
  [[nodiscard]] double radius(int dimension) const {
    double largest = 0;
    for (const Facet& facet : facets_)
      for (const Vec3<double>& y : facet.corners) {
        double square = 0;
        for (int a = 0; a < dimension; ++a) square += y[a] * y[a];
        largest = std::max(largest, square);
      }
    return std::sqrt(largest);
  }

 private:
  // Where the edge from `inside` (at p <= 0) to `outside` (at q > 0) meets the plane, reckoned from the
  // nearer end: the far one may be very far. Both facets of the edge get the same bits.
  static Vec3<double> crossing(const Vec3<double>& inside, const Vec3<double>& outside, double p, double q) {
    if (-p <= q) return inside + p / (p - q) * (outside - inside);
    return outside + q / (q - p) * (inside - outside);
  }

  // Counter-clockwise around their mean, `normal` pointing to the eye; each came from two facets.
  static std::vector<Vec3<double>> sorted_around(const Vec3<double>& normal,
                                                 const std::vector<Vec3<double>>& corners) {
    Vec3<double> mean = Vec3<double>::Zero();
    for (const Vec3<double>& y : corners) mean += y / static_cast<double>(corners.size());
    const Vec3<double> u = normal.unitOrthogonal(), v = normal.cross(u);
    std::vector<std::pair<double, std::size_t>> angle;
    for (std::size_t k = 0; k < corners.size(); ++k)
      angle.emplace_back(std::atan2(v.dot(corners[k] - mean), u.dot(corners[k] - mean)), k);
    std::sort(angle.begin(), angle.end());
    std::vector<Vec3<double>> result;
    for (const auto& entry : angle)
      if (result.empty() || result.back() != corners[entry.second]) result.push_back(corners[entry.second]);
    return result;
  }

  std::vector<Facet> facets_;
};

}  // namespace softsim
