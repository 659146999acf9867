// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "softsim/core/error.hpp"
#include "softsim/core/tensor.hpp"
#include "softsim/mesh/element_mesh.hpp"

namespace softsim {

/// One of the six sides of a mesh's bounding box.
enum class Side { xmin, xmax, ymin, ymax, zmin, zmax };

/// The side named "xmin" ... "zmax", or nothing.
[[nodiscard]] inline std::optional<Side> parse_side(std::string_view name) {
  constexpr std::string_view names[] = {"xmin", "xmax", "ymin", "ymax", "zmin", "zmax"};
  for (int s = 0; s < 6; ++s)
    if (name == names[s]) return static_cast<Side>(s);
  return std::nullopt;
}

/// Axis-aligned bounding box in m.
struct BoundingBox {
  Vec3<double> lower, upper;
};

/// Bounding box of the mesh at rest.
template <PointMesh Mesh>
[[nodiscard]] BoundingBox bounding_box(const Mesh& mesh) {
  BoundingBox box{mesh.points().front(), mesh.points().front()};
  for (const Vec3<double>& x : mesh.points()) {
    box.lower = box.lower.cwiseMin(x);
    box.upper = box.upper.cwiseMax(x);
  }
  return box;
}

/// Nodes within `fraction` of the mesh's extent from one of its sides.
/// @throws std::invalid_argument if fraction is not in [0, 1]
template <PointMesh Mesh>
[[nodiscard]] std::vector<std::int32_t> nodes_near(const Mesh& mesh, Side side, double fraction) {
  if (!(fraction >= 0 && fraction <= 1))
    invalid(std::string("depth ") + to_text(fraction) + ": must lie in [0, 1]");
  const BoundingBox box = bounding_box(mesh);
  const int axis = static_cast<int>(side) / 2;
  const bool upper = static_cast<int>(side) % 2 == 1;
  // A rounding error of the coordinates must not lose a node of a flat side.
  const double depth = (fraction + 1e-12) * (box.upper[axis] - box.lower[axis]);
  std::vector<std::int32_t> nodes;
  for (std::size_t i = 0; i < mesh.points().size(); ++i) {
    const double x = mesh.points()[i][axis];
    if ((upper ? box.upper[axis] - x : x - box.lower[axis]) <= depth)
      nodes.push_back(static_cast<std::int32_t>(i));
  }
  return nodes;
}

}  // namespace softsim
