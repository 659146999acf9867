// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "softsim/core/error.hpp"
#include "softsim/core/tensor.hpp"
#include "softsim/mesh/dart_board.hpp"
#include "softsim/mesh/domain.hpp"
#include "softsim/mesh/point_grid.hpp"
#include "softsim/mesh/poisson_disk.hpp"
#include "softsim/mesh/samples.hpp"
#include "softsim/mesh/shape_functions.hpp"
#include "softsim/mesh/surface_domain.hpp"
#include "softsim/mesh/tetrahedral_mesh.hpp"

namespace softsim {

namespace detail {

/// A point of a surface and what it stands for.
struct SurfacePoint {
  Vec3<double> position, normal;
  double area;
};

/// The checked triangles of a surface, open or closed.
class SampledSurface {
 public:
  SampledSurface(const std::vector<Vec3<double>>& points, const std::vector<Triangle>& triangles)
      : points_(points), triangles_(triangles) {
    check_surface(points, triangles);
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      const auto X = corners(t);
      const Vec3<double> twice = (X[1] - X[0]).cross(X[2] - X[0]);
      const double longest = std::max({(X[1] - X[0]).norm(), (X[2] - X[1]).norm(), (X[0] - X[2]).norm()});
      if (!(twice.norm() > 1e-12 * longest * longest))
        invalid(std::string("triangle ") + std::to_string(t) + ": degenerate, area " +
                to_text(twice.norm() / 2) + " m^2 at longest edge " + to_text(longest) + " m");
      areas_.push_back(twice.norm() / 2);
      normals_.push_back(twice.normalized());
    }
  }

  [[nodiscard]] std::array<Vec3<double>, 3> corners(std::size_t t) const {
    std::array<Vec3<double>, 3> X;
    for (std::size_t i = 0; i < 3; ++i) X[i] = points_[static_cast<std::size_t>(triangles_[t][i])];
    return X;
  }
  [[nodiscard]] const std::vector<double>& areas() const { return areas_; }
  /// The point of triangle t at the reference coordinates (xi, eta).
  [[nodiscard]] SurfacePoint at(std::size_t t, double xi, double eta, double area) const {
    const auto X = corners(t);
    return {X[0] + xi * (X[1] - X[0]) + eta * (X[2] - X[0]), normals_[t], area};
  }

 private:
  const std::vector<Vec3<double>>& points_;
  const std::vector<Triangle>& triangles_;
  std::vector<double> areas_;
  std::vector<Vec3<double>> normals_;
};

/// Gauss points through the thickness at each point of the surface.
inline Samples through_thickness(const std::vector<SurfacePoint>& points, double thickness, int layers) {
  if (!(thickness > 0 && std::isfinite(thickness)))
    invalid(std::string("thickness ") + to_text(thickness) + ": must be positive and finite");
  if (layers < 1 || layers > 64)
    invalid(std::string("layers ") + std::to_string(layers) + ": must lie in [1, 64]");
  Samples samples;
  const std::vector<GaussPoint> rule = gauss_legendre(layers);
  for (const SurfacePoint& point : points)
    for (const GaussPoint& layer : rule) {
      samples.positions.push_back(point.position + thickness / 2 * layer.x * point.normal);
      samples.volumes.push_back(thickness / 2 * layer.weight * point.area);
    }
  return samples;
}

/// `count` random points, each standing for the same area: the area is laid out as a line, and one point
/// falls in each of `count` equal pieces.
inline std::vector<SurfacePoint> scatter(const SampledSurface& surface, std::size_t count, double area,
                                         UniformRandom& random) {
  std::vector<SurfacePoint> darts;
  const double share = area / static_cast<double>(count);
  double passed = surface.areas()[0];
  for (std::size_t i = 0, t = 0; i < count; ++i) {
    const double place = (static_cast<double>(i) + random()) * share;
    while (passed <= place && t + 1 < surface.areas().size()) passed += surface.areas()[++t];
    double xi = random(), eta = random();
    if (xi + eta > 1) xi = 1 - xi, eta = 1 - eta;
    darts.push_back(surface.at(t, xi, eta, share));
  }
  for (std::size_t i = count; i > 1; --i) std::swap(darts[i - 1], darts[random.below(i)]);
  return darts;
}

}  // namespace detail

/// Samples of a shell with the given mid-surface: in each triangle 1, 3 or 6 Gauss points (exact for degree
/// 1, 2, 4), at each of them `layers` Gauss points along the normal from -thickness/2 to thickness/2, lowest
/// first. The volumes sum to area x thickness. On a curved surface (mean curvature H, Gauss curvature K) the
/// true volume element is 1 - 2 H z + K z^2 times that: left out here; H averages out over the thickness, K
/// leaves a relative error of K thickness^2 / 12 in the volume, with K = 1 / R^2 on a sphere of radius R.
/// @param points, triangles open or closed surface, m
/// @param thickness m
/// @throws std::invalid_argument naming the point or triangle: no triangles, coordinates that are not finite,
///   point numbers out of range or repeated, a triangle without area; for a thickness that is not positive
///   and finite, layers outside [1, 64], or another number of points per triangle
[[nodiscard]] inline Samples sample_surface(const std::vector<Vec3<double>>& points,
                                            const std::vector<Triangle>& triangles, double thickness,
                                            int layers, int points_per_triangle = 3) {
  const detail::SampledSurface surface(points, triangles);
  std::vector<IntegrationPoint<2>> rule;
  if (points_per_triangle == 1)
    rule = {{{1.0 / 3, 1.0 / 3}, 0.5}};
  else if (points_per_triangle == 3)
    rule = {{{1.0 / 6, 1.0 / 6}, 1.0 / 6}, {{2.0 / 3, 1.0 / 6}, 1.0 / 6}, {{1.0 / 6, 2.0 / 3}, 1.0 / 6}};
  else if (points_per_triangle == 6)
    rule.assign(QuadraticTriangle::rule.begin(), QuadraticTriangle::rule.end());
  else
    invalid(std::string("points_per_triangle ") + std::to_string(points_per_triangle) +
            ": must be 1, 3 or 6");
  std::vector<detail::SurfacePoint> places;
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (const IntegrationPoint<2>& point : rule)
      places.push_back(surface.at(t, point.xi[0], point.xi[1], 2 * point.weight * surface.areas()[t]));
  return detail::through_thickness(places, thickness, layers);
}

/// The same with a Poisson-disk set on the mid-surface, whatever its triangles: no two of its points nearer
/// than `spacing` (m), measured through space, so that sheets closer than that thin each other out. The set
/// is chosen from about `tries` random points for each that fits; each of those stands for the same area,
/// which goes to the nearest chosen point.
/// @throws std::invalid_argument as above, for a spacing that is not positive, larger than the surface or too
///   small to count the points, and tries below 1
[[nodiscard]] inline Samples sample_surface_apart(const std::vector<Vec3<double>>& points,
                                                  const std::vector<Triangle>& triangles, double thickness,
                                                  int layers, double spacing,
                                                  const PoissonDiskOptions& options = {}) {
  const detail::SampledSurface surface(points, triangles);
  detail::check_tries(options.tries);
  Eigen::AlignedBox3d box;
  double area = 0;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (const Vec3<double>& x : surface.corners(t)) box.extend(x);
    area += surface.areas()[t];
  }
  // a flat surface has a box without volume, and points of a slanted one may round to its outside
  const Vec3<double> margin = Vec3<double>::Constant(1e-6 * box.diagonal().norm());
  box = Eigen::AlignedBox3d(box.min() - margin, box.max() + margin);
  detail::check_spacing(box, spacing);
  const double fitting = 1 + 2 / std::numbers::sqrt3 * area / (spacing * spacing);  // hexagonal packing
  if (fitting * options.tries > 0x1p28)
    invalid(std::string("spacing ") + to_text(spacing) + ": too small, it would need " +
            to_text(fitting * options.tries) + " random points");

  detail::UniformRandom random(options.seed);
  const std::vector<detail::SurfacePoint> darts =
      detail::scatter(surface, static_cast<std::size_t>(fitting * options.tries), area, random);
  detail::DartBoard board(box, spacing);
  std::vector<detail::SurfacePoint> chosen;
  for (const detail::SurfacePoint& dart : darts)
    if (board.is_free(dart.position)) {
      board.add(dart.position);
      chosen.push_back({dart.position, dart.normal, 0});
    }
  const PointGrid grid(board.points());
  for (const detail::SurfacePoint& dart : darts)
    chosen[static_cast<std::size_t>(grid.nearest(dart.position, 1)[0])].area += dart.area;
  return detail::through_thickness(chosen, thickness, layers);
}

}  // namespace softsim
