// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <vector>

#include "softsim/core/error.hpp"
#include "softsim/core/tensor.hpp"
#include "softsim/mesh/samples.hpp"

namespace softsim {

/// One point of a cross-section: coordinates along its two axes in m, and its share of the area in m^2.
struct SectionPoint {
  double y, z, area;
};
/// Points of a cross-section, whose centroid lies on the curve.
using Section = std::vector<SectionPoint>;

/// Rectangle of `width` along the first and `height` along the second axis, m, with `order` Gauss points
/// along each. From order 2 on the second moments of area, width^3 height / 12 and width height^3 / 12, are
/// exact.
/// @throws std::invalid_argument for a length that is not positive and finite, or an order outside [1, 64]
[[nodiscard]] inline Section rectangle(double width, double height, int order = 2) {
  for (const double length : {width, height})
    if (!(length > 0 && std::isfinite(length)))
      invalid(std::string("rectangle ") + to_text(width) + " x " + to_text(height) +
              ": sides must be positive and finite");
  Section section;
  const std::vector<GaussPoint> rule = gauss_legendre(order);
  for (const GaussPoint& b : rule)
    for (const GaussPoint& a : rule)
      section.push_back({width / 2 * a.x, height / 2 * b.x, width * height / 4 * a.weight * b.weight});
  return section;
}

/// Disc with 1, 4 or 7 points. The second moments of area, pi radius^4 / 4, are exact with 4 (degree 3) and 7
/// (degree 5; Stroud 1971, S2: 5-1) and zero with 1.
/// @param radius in m
/// @throws std::invalid_argument for a radius that is not positive and finite, or another number of points
[[nodiscard]] inline Section disc(double radius, int points = 4) {
  if (!(radius > 0 && std::isfinite(radius)))
    invalid(std::string("disc: radius ") + to_text(radius) + ": must be positive and finite");
  if (points != 1 && points != 4 && points != 7)
    invalid(std::string("disc: points ") + std::to_string(points) + ": must be 1, 4 or 7");
  const double area = std::numbers::pi * radius * radius;
  Section section;
  if (points != 4) section.push_back({0, 0, points == 1 ? area : area / 4});
  const int ring = points == 1 ? 0 : points == 4 ? 4 : 6;
  const double r = radius * std::sqrt(points == 4 ? 0.5 : 2.0 / 3), share = points == 4 ? area / 4 : area / 8;
  for (int i = 0; i < ring; ++i) {
    const double angle = 2 * std::numbers::pi * i / ring;
    section.push_back({r * std::cos(angle), r * std::sin(angle), share});
  }
  return section;
}

namespace detail {

inline void check_polyline(const std::vector<Vec3<double>>& polyline) {
  if (polyline.size() < 2)
    invalid(std::string("curve: ") + std::to_string(polyline.size()) + " points, must be at least 2");
  for (std::size_t i = 0; i < polyline.size(); ++i)
    if (!polyline[i].allFinite())
      invalid(std::string("curve: point ") + std::to_string(i) + ": a coordinate is not a finite number");
  for (std::size_t i = 0; i + 1 < polyline.size(); ++i)
    if (!((polyline[i + 1] - polyline[i]).norm() > 0))
      invalid(std::string("curve: segment ") + std::to_string(i) + " has no length");
}

}  // namespace detail

/// Samples of a rod: the polyline (m) is cut into n pieces of equal length, and the section stands in the
/// middle of each, perpendicular to the segment there; samples of a piece follow one another. Each has the
/// volume of its area times the length of a piece. On a curve that is the exact volume (Pappus: the centroid
/// lies on the curve), as long as its radius of curvature stays larger than the section.
/// @param width_axis direction of the section's first axis at the start of the curve; only its part
///   perpendicular to the curve matters. Along the curve the axes are carried by parallel transport: from
///   segment to segment by the smallest rotation, without twist. The second axis is tangent x first.
/// @throws std::invalid_argument for fewer than two points, coordinates that are not finite, a segment that
///   has no length or folds back on the segment before, an empty section, n below 1, or a width_axis that
///   is not finite or along the curve
[[nodiscard]] inline Samples sample_curve(const std::vector<Vec3<double>>& polyline, const Section& section,
                                          int n, const Vec3<double>& width_axis) {
  detail::check_polyline(polyline);
  if (section.empty()) invalid("curve: the section has no points");
  if (n < 1) invalid(std::string("n ") + std::to_string(n) + ": must be at least 1");
  double length = 0;
  for (std::size_t i = 0; i + 1 < polyline.size(); ++i) length += (polyline[i + 1] - polyline[i]).norm();

  Vec3<double> tangent = (polyline[1] - polyline[0]).normalized();
  Vec3<double> first = width_axis - width_axis.dot(tangent) * tangent;
  if (!(first.norm() > 1e-9 * width_axis.norm() && width_axis.allFinite()))
    invalid(std::string("width_axis (") + to_text(width_axis[0]) + ", " + to_text(width_axis[1]) + ", " +
            to_text(width_axis[2]) + "): must be finite and not along the start of the curve");
  first.normalize();

  Samples samples;
  const double piece = length / n;
  double passed = 0;  // length up to the segment
  int next = 0;
  for (std::size_t i = 0; i + 1 < polyline.size(); ++i) {
    const Vec3<double> along = polyline[i + 1] - polyline[i], before = tangent;
    const double segment = along.norm();
    tangent = along / segment;
    if (before.dot(tangent) < -1 + 1e-12)
      invalid(std::string("curve: segment ") + std::to_string(i) + " folds back on the one before");
    first = Eigen::Quaterniond::FromTwoVectors(before, tangent) * first;
    first = (first - first.dot(tangent) * tangent).normalized();
    const Vec3<double> second = tangent.cross(first);
    const bool last = i + 2 == polyline.size();  // takes what rounding would push past the end
    for (; next < n && (last || (next + 0.5) * piece < passed + segment); ++next) {
      const Vec3<double> middle = polyline[i] + ((next + 0.5) * piece - passed) * tangent;
      for (const SectionPoint& point : section) {
        samples.positions.push_back(middle + point.y * first + point.z * second);
        samples.volumes.push_back(point.area * piece);
      }
    }
    passed += segment;
  }
  return samples;
}

/// The same with the first axis of the section as near as can be to the axis of space that the start of the
/// curve is least along: for discs, which look alike from all sides.
[[nodiscard]] inline Samples sample_curve(const std::vector<Vec3<double>>& polyline, const Section& section,
                                          int n) {
  detail::check_polyline(polyline);
  int axis = 0;
  (polyline[1] - polyline[0]).cwiseAbs().minCoeff(&axis);
  return sample_curve(polyline, section, n, Vec3<double>::Unit(axis));
}

}  // namespace softsim
