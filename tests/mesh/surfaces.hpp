// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "softsim/mesh/generators.hpp"
#include "softsim/mesh/surface_domain.hpp"

namespace surfaces {

using Vec = softsim::Vec3<double>;

struct Surface {
  std::vector<Vec> points;
  std::vector<softsim::Triangle> triangles;
};

/// Octahedron whose triangles are split in four `levels` times, pushed onto the unit sphere each time.
inline Surface sphere(int levels, double radius = 1, const Vec& centre = Vec::Zero()) {
  Surface s{{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
            {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> middles;
    const auto middle = [&](std::int32_t a, std::int32_t b) {
      const auto [entry, is_new] =
          middles.try_emplace(std::minmax(a, b), static_cast<std::int32_t>(s.points.size()));
      if (is_new)
        s.points.push_back(
            (s.points[static_cast<std::size_t>(a)] + s.points[static_cast<std::size_t>(b)]).normalized());
      return entry->second;
    };
    std::vector<softsim::Triangle> finer;
    for (const auto& [a, b, c] : s.triangles) {
      const std::int32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      for (const softsim::Triangle& t :
           {softsim::Triangle{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}})
        finer.push_back(t);
    }
    s.triangles = finer;
  }
  for (Vec& x : s.points) x = centre + radius * x;
  return s;
}

/// Twelve triangles around a box.
inline Surface box(const Vec& lower, const Vec& upper) {
  const softsim::TetrahedralMesh mesh = softsim::box_mesh({1, 1, 1}, upper - lower, lower);
  return {mesh.points(), softsim::boundary_triangles(mesh)};
}

inline Surface inside_out(Surface s) {
  for (softsim::Triangle& t : s.triangles) std::swap(t[1], t[2]);
  return s;
}

/// Both surfaces as one, without shared points.
inline Surface both(Surface a, const Surface& b) {
  const auto shift = static_cast<std::int32_t>(a.points.size());
  a.points.insert(a.points.end(), b.points.begin(), b.points.end());
  for (const auto& [i, j, k] : b.triangles) a.triangles.push_back({i + shift, j + shift, k + shift});
  return a;
}

inline softsim::SurfaceDomain domain(const Surface& s) { return {s.points, s.triangles}; }

}  // namespace surfaces
