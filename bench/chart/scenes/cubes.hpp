// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "../quantities.hpp"
#include "../scene.hpp"
#include "softsim/mesh/generators.hpp"

namespace chart {

/// (n + 1)^3 points of the unit cube, its surface included, x fastest: what `volume` asks for.
inline std::vector<Vec> cube_lattice(int n) {
  std::vector<Vec> points;
  for (int k = 0; k <= n; ++k)
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) points.push_back(Vec(i, j, k) / n);
  return points;
}

/// A cube of r x r x r cells, Neo-Hookean with E = 10 kPa.
inline Scene unit_cube(const std::string& name, const std::string& title) {
  Scene s{.name = name, .title = title};
  s.young = 1e4;
  s.poisson = 0.3;
  s.law = softsim::NeoHookean::from_young_poisson(s.young, s.poisson);
  s.density = 1000;
  s.resolutions = {1, 2, 4, 6, 8, 12};
  s.tetrahedra = [](int r) { return softsim::box_mesh({r, r, r}, {1, 1, 1}); };
  s.hexahedra = [](int r) { return softsim::box_hexahedra({r, r, r}, {1, 1, 1}); };
  return s;
}

/// d'Aulignac 2001, Figs 3.2 and 3.3: a cube turned by 60 degrees about one held edge, by another one. What
/// knows of large rotations turns it and nothing else; linear statics makes it grow.
inline Scene turning_block() {
  Scene s = unit_cube("turning_block", "Cube turned by 60 degrees about a held edge");
  const Vec turn(0, std::numbers::pi / 3, 0);
  const softsim::Mat3<double> R = softsim::rotation_exponential(turn);
  s.support = [R](const Vec& X) {
    if (X[2] != 0 || (X[0] != 0 && X[0] != 1)) return all_free();
    return Vec((R - softsim::Mat3<double>::Identity()) * X);
  };
  s.rotation = [turn](const Vec&) { return softsim::quaternion_exponential(turn); };
  s.load_steps = 4;
  s.resolutions = {1, 2, 4, 8};
  s.probes = cube_lattice(2);
  s.quantities = {displacement(), volume(2)};
  s.closed_form = [R](const Vec& X, double) { return Vec((R - softsim::Mat3<double>::Identity()) * X); };
  return s;
}

/// A unit cube of r x r x r cells, each of twelve tetrahedra around its middle, so that the diagonals of
/// faces may lie as one likes: here those of the sides x = const. zigzag, and those of the four sides around
/// the x axis all go round it the same way, as a screw does.
inline softsim::TetrahedralMesh screwed_cube(int r) {
  std::vector<Vec> points;
  for (int k = 0; k <= r; ++k)
    for (int j = 0; j <= r; ++j)
      for (int i = 0; i <= r; ++i) points.push_back(Vec(i, j, k) / r);
  const auto node = [r](const std::array<int, 3>& at) {
    return static_cast<std::int32_t>((at[2] * (r + 1) + at[1]) * (r + 1) + at[0]);
  };
  std::vector<softsim::Tetrahedron> tetrahedra;
  for (int cell = 0; cell < r * r * r; ++cell) {
    const std::array<int, 3> low{cell % r, cell / r % r, cell / (r * r)};
    const auto middle = static_cast<std::int32_t>(points.size());
    points.push_back((Vec(low[0], low[1], low[2]) + Vec::Constant(0.5)) / r);
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (const int side : {0, 1}) {
        // the axes of the face; a diagonal from its lowest corner, or the other one
        const std::size_t a = (axis + 1) % 3, b = (axis + 2) % 3;
        const auto corner = [&](int of_a, int of_b) {
          std::array<int, 3> at = low;
          at[axis] += side;
          at[a] += of_a;
          at[b] += of_b;
          return node(at);
        };
        const bool upper = 2 * (low[axis] + side) > r, zigzag = (low[0] + low[1] + low[2] + side) % 2 == 0,
                   from_lowest = axis == 0 ? zigzag : (axis == 1) == upper;
        const std::array<std::int32_t, 4> ring{corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)};
        const std::size_t first = from_lowest ? 0 : 1;
        for (const std::size_t k : {first, first + 2}) {
          softsim::Tetrahedron t{ring[k % 4], ring[(k + 1) % 4], ring[(k + 2) % 4], middle};
          if (side == 1) std::swap(t[1], t[2]);  // its normal points inwards
          tetrahedra.push_back(t);
        }
      }
  }
  return {std::move(points), std::move(tetrahedra)};
}

/// d'Aulignac 2001, Figs 2.7 and 2.11: a cube held at its back, every part of it pulled forwards. Springs
/// twist it, since the diagonals around it are all parallel.
inline Scene pulled_cube() {
  Scene s = unit_cube("pulled_cube", "Cube held at its back, pulled forwards everywhere");
  s.tetrahedra = screwed_cube;
  s.resolutions = {1, 2, 4, 6, 8};
  s.support = [](const Vec& X) { return X[0] == 0 ? held() : all_free(); };
  s.gravity = {5, 0, 0};
  s.load_steps = 2;
  s.reference_resolution = 16;
  s.probes = cube_lattice(4);
  s.quantities = {displacement(), twist({1, 0.5, 0.5}), volume(4)};
  return s;
}

}  // namespace chart
