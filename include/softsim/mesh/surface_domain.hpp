// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "softsim/core/error.hpp"
#include "softsim/core/tensor.hpp"
#include "softsim/mesh/domain.hpp"
#include "softsim/mesh/tetrahedral_mesh.hpp"

namespace softsim {

namespace detail {

/// Node numbers and coordinates of a surface, as `SurfaceDomain` and `sample_surface` ask for them.
inline void check_surface(const std::vector<Vec3<double>>& points, const std::vector<Triangle>& triangles) {
  if (triangles.empty()) invalid("surface: no triangles");
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!points[i].allFinite())
      invalid(std::string("point ") + std::to_string(i) + ": a coordinate is not a finite number");
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const Triangle& v = triangles[t];
    const auto fail = [&](std::int32_t i, const std::string& what) {
      invalid(std::string("triangle ") + std::to_string(t) + ": point " + std::to_string(i) + what);
    };
    for (const std::int32_t i : v)
      if (i < 0 || static_cast<std::size_t>(i) >= points.size())
        fail(i,
             std::string(" is out of range (the surface has ") + std::to_string(points.size()) + " points)");
    for (std::size_t a = 0; a < 3; ++a)
      if (v[a] == v[(a + 1) % 3]) fail(v[a], " is repeated");
  }
}

}  // namespace detail

/// The inside of a closed surface of triangles, which may have several parts and cavities.
///
/// `contains` counts how often the surface winds around a point, by a ray along z. The plane y = const
/// through the point cuts each triangle in a segment whose ends are worked out edge by edge, so that
/// neighbours share them to the last bit, and half-open intervals decide who owns an end: no ray slips
/// through an edge or a vertex, whatever the rounding. Only points within rounding of the surface may fall to
/// either side. A grid over x and y leaves a handful of triangles for each query.
class SurfaceDomain {
 public:
  /// @param points m; those that no triangle uses do no harm
  /// @param triangles counter-clockwise seen from outside
  /// The surface must not cross itself: what it wraps twice would count twice in the volume.
  /// @throws std::invalid_argument naming the point, triangle or edge: no triangles, coordinates that are not
  ///   finite, node numbers out of range or repeated, an edge that is not shared by exactly two triangles
  ///   which run along it in opposite directions, an enclosed volume that is not positive (inside out), a
  ///   connected part that is inside out without being a cavity, or that lies within another part
  SurfaceDomain(std::vector<Vec3<double>> points, std::vector<Triangle> triangles)
      : points_(std::move(points)), triangles_(std::move(triangles)) {
    detail::check_surface(points_, triangles_);
    for (const Triangle& v : triangles_)
      for (const std::int32_t i : v) box_.extend(point(i));
    const std::vector<std::size_t> part = closed_parts();
    std::vector<double> volumes(triangles_.size());
    for (std::size_t t = 0; t < triangles_.size(); ++t) volumes[part[t]] += volume_below(t);
    volume_ = std::accumulate(volumes.begin(), volumes.end(), 0.0);
    if (volume_ < 0)
      invalid(std::string("surface: encloses ") + to_text(volume_) +
              " m^3, it is inside out (triangles must be counter-clockwise seen from outside)");
    const double extent = box_.sizes().maxCoeff();
    if (!(volume_ > 1e-14 * extent * extent * extent))
      invalid(std::string("surface: encloses ") + to_text(volume_) + " m^3, must be positive");
    make_grid();
    check_parts(part, volumes);
  }

  /// Positions in m.
  [[nodiscard]] const std::vector<Vec3<double>>& points() const { return points_; }
  /// Point numbers, counter-clockwise seen from outside.
  [[nodiscard]] const std::vector<Triangle>& triangles() const { return triangles_; }
  /// The smallest axis-aligned box around the triangles, m.
  [[nodiscard]] const Eigen::AlignedBox3d& box() const { return box_; }
  /// Enclosed volume in m^3 by the divergence theorem, exact for the triangles.
  [[nodiscard]] double volume() const { return volume_; }

  /// How often the surface winds around x (m): 1 inside, 0 outside and in cavities.
  [[nodiscard]] int winding_number(const Vec3<double>& x) const {
    return winding_number(x, [](std::size_t) { return true; });
  }
  /// Whether x (m) lies inside.
  [[nodiscard]] bool contains(const Vec3<double>& x) const { return winding_number(x) > 0; }

 private:
  struct Side {
    std::int32_t lower, upper;
    std::size_t triangle;
    bool forward;  // the triangle runs along it from lower to upper
  };

  [[nodiscard]] const Vec3<double>& point(std::int32_t i) const {
    return points_[static_cast<std::size_t>(i)];
  }

  /// Signed volume between triangle t and the middle of the box.
  [[nodiscard]] double volume_below(std::size_t t) const {
    const Triangle& v = triangles_[t];
    return tetrahedron_volume(box_.center(), point(v[0]), point(v[1]), point(v[2]));
  }

  /// The first triangle of the connected part that each triangle belongs to; checks the edges on the way.
  [[nodiscard]] std::vector<std::size_t> closed_parts() const {
    std::vector<Side> sides;
    sides.reserve(3 * triangles_.size());
    for (std::size_t t = 0; t < triangles_.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::int32_t a = triangles_[t][k], b = triangles_[t][(k + 1) % 3];
        sides.push_back({std::min(a, b), std::max(a, b), t, a < b});
      }
    const auto key = [](const Side& s) { return std::tie(s.lower, s.upper, s.triangle); };
    std::sort(sides.begin(), sides.end(), [&](const Side& a, const Side& b) { return key(a) < key(b); });

    std::vector<std::size_t> part(triangles_.size());
    std::iota(part.begin(), part.end(), std::size_t{0});
    const auto root = [&](std::size_t t) {
      while (part[t] != t) t = part[t] = part[part[t]];
      return t;
    };
    for (std::size_t first = 0, last = 0; first < sides.size(); first = last) {
      const Side &one = sides[first], &two = sides[std::min(first + 1, sides.size() - 1)];
      while (last < sides.size() && sides[last].lower == one.lower && sides[last].upper == one.upper) ++last;
      const std::string edge =
          std::string("edge ") + std::to_string(one.lower) + "-" + std::to_string(one.upper) + ": ";
      const std::string owner = std::to_string(one.triangle);
      if (last - first == 1)
        invalid(edge + "belongs to triangle " + owner + " only, the surface is open there");
      if (last - first > 2)
        invalid(edge + "is shared by " + std::to_string(last - first) + " triangles, must be two");
      if (one.forward == two.forward)
        invalid(edge + "triangles " + owner + " and " + std::to_string(two.triangle) +
                " run along it in the same direction, one of them is turned over");
      const std::size_t a = root(one.triangle), b = root(two.triangle);
      part[std::max(a, b)] = std::min(a, b);
    }
    for (std::size_t t = 0; t < part.size(); ++t) part[t] = root(t);
    return part;
  }

  /// A part that encloses a positive volume must lie outside the others, a cavity inside. Parts may touch,
  /// which makes a single point of them undecided, so all points of a part have to agree that it is wrong.
  void check_parts(const std::vector<std::size_t>& part, const std::vector<double>& volumes) const {
    std::vector<char> wrong(part.size(), 1);
    for (std::size_t t = 0; t < part.size(); ++t)
      for (const std::int32_t i : triangles_[t]) {
        if (!wrong[part[t]]) break;
        const int around =
            winding_number(point(i), [&](std::size_t other) { return part[other] != part[t]; });
        wrong[part[t]] = around != (volumes[part[t]] < 0 ? 1 : 0);
      }
    for (std::size_t t = 0; t < part.size(); ++t)
      if (part[t] == t && wrong[t])
        invalid(std::string("triangle ") + std::to_string(t) + ": its part of the surface encloses " +
                to_text(volumes[t]) +
                (volumes[t] < 0 ? " m^3, it is inside out and no cavity of another part"
                                : " m^3 within another part, which would count twice"));
  }

  void make_grid() {
    // about as many bins as triangles; fewer if long triangles would stand in too many of them
    const double size = std::sqrt(box_.sizes()[0] * box_.sizes()[1] / double(triangles_.size()));
    for (std::size_t a = 0; a < 2; ++a)
      bins_[a] =
          static_cast<int>(std::min(double(triangles_.size()), 1 + box_.sizes()[static_cast<int>(a)] / size));
    for (;;) {
      std::size_t entries = 0;
      first_.assign(static_cast<std::size_t>(bins_[0]) * static_cast<std::size_t>(bins_[1]) + 1, 0);
      for (std::size_t t = 0; t < triangles_.size(); ++t)
        for_bins(t, [&](std::size_t bin) { ++first_[bin + 1], ++entries; });
      if (entries <= 32 * triangles_.size() || first_.size() == 2) break;
      for (int& n : bins_) n = (n + 1) / 2;
    }
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    members_.resize(first_.back());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for (std::size_t t = 0; t < triangles_.size(); ++t)
      for_bins(t, [&](std::size_t bin) { members_[next[bin]++] = t; });
  }

  /// Monotone in x, so that a triangle stands in every bin that a point over it falls in.
  [[nodiscard]] int bin_of(int axis, double x) const {
    const int n = bins_[static_cast<std::size_t>(axis)];
    return std::clamp(static_cast<int>((x - box_.min()[axis]) / box_.sizes()[axis] * n), 0, n - 1);
  }
  [[nodiscard]] std::size_t bin_number(int i, int j) const {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(bins_[0]) + static_cast<std::size_t>(i);
  }
  template <class Function>
  void for_bins(std::size_t t, Function f) const {
    Eigen::AlignedBox3d box;
    for (const std::int32_t i : triangles_[t]) box.extend(point(i));
    for (int j = bin_of(1, box.min()[1]); j <= bin_of(1, box.max()[1]); ++j)
      for (int i = bin_of(0, box.min()[0]); i <= bin_of(0, box.max()[0]); ++i) f(bin_number(i, j));
  }

  template <class Keep>
  [[nodiscard]] int winding_number(const Vec3<double>& x, Keep keep) const {
    if (!box_.contains(x)) return 0;
    const std::size_t bin = bin_number(bin_of(0, x[0]), bin_of(1, x[1]));
    int winding = 0;
    for (std::size_t k = first_[bin]; k < first_[bin + 1]; ++k)
      if (keep(members_[k])) winding += crossing(triangles_[members_[k]], x);
    return winding;
  }

  /// 1 if the ray from x along +z leaves through the triangle, -1 if it enters, 0 if it misses.
  [[nodiscard]] int crossing(const Triangle& v, const Vec3<double>& x) const {
    const Vec3<double>&A = point(v[0]), &B = point(v[1]), &C = point(v[2]);
    if (std::max({A[2], B[2], C[2]}) <= x[2]) return 0;  // most are done with here
    std::array<double, 2> left{}, right{};  // (x, z) where the plane y = x[1] cuts the triangle's edges
    bool has_left = false, has_right = false, upward = false;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3<double>&a = point(v[k]), &b = point(v[(k + 1) % 3]);
      const bool up = a[1] <= x[1] && x[1] < b[1], down = b[1] <= x[1] && x[1] < a[1];
      if (!up && !down) continue;
      const Vec3<double>&low = up ? a : b, &high = up ? b : a;
      const double s = (x[1] - low[1]) / (high[1] - low[1]);
      const auto at = [&](int axis) { return low[axis] + s * (high[axis] - low[axis]); };
      // rounding must not carry the cut past the triangle's bins
      const double cut = std::clamp(at(0), std::min(low[0], high[0]), std::max(low[0], high[0]));
      (cut > x[0] ? right : left) = {cut, at(2)};
      (cut > x[0] ? has_right : has_left) = true;
      if (cut > x[0]) upward = up;
    }
    if (!has_left || !has_right) return 0;
    const double z = left[1] + (x[0] - left[0]) / (right[0] - left[0]) * (right[1] - left[1]);
    return z > x[2] ? (upward ? 1 : -1) : 0;
  }

  std::vector<Vec3<double>> points_;
  std::vector<Triangle> triangles_;
  Eigen::AlignedBox3d box_;
  double volume_;
  std::array<int, 2> bins_{};
  std::vector<std::size_t> first_, members_;  // triangles that stand in each bin over x and y
};

/// The body of a mesh as a domain: its boundary with the node numbers of the mesh.
/// @throws std::invalid_argument naming the edge where the boundary touches itself along it
[[nodiscard]] inline SurfaceDomain surface_domain(const TetrahedralMesh& mesh) {
  return SurfaceDomain(mesh.points(), boundary_triangles(mesh));
}

}  // namespace softsim
