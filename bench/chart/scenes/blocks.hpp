// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <numbers>

#include "../quantities.hpp"
#include "../scene.hpp"
#include "softsim/core/error.hpp"
#include "softsim/material/lame.hpp"
#include "softsim/mesh/generators.hpp"

namespace chart {

/// A cube between two smooth plates, pressed together by 30 %: every method that passes the patch test and
/// has the law is exact, whatever its mesh.
inline Scene compressed_block() {
  Scene s{.name = "compressed_block", .title = "Neo-Hookean cube between smooth plates, pressed to 70 %"};
  s.young = 10;
  s.poisson = 0.3;
  s.law = softsim::NeoHookean::from_young_poisson(s.young, s.poisson);
  s.resolutions = {1, 2, 4, 8, 12};
  s.tetrahedra = [](int r) { return softsim::box_mesh({r, r, r}, {1, 1, 1}); };
  s.hexahedra = [](int r) { return softsim::box_hexahedra({r, r, r}, {1, 1, 1}); };
  constexpr double stretch = 0.7, across = 1.1079347328;  // Neo-Hookean with E = 10, nu = 0.3: a root
  s.support = [](const Vec& X) {
    Vec u = all_free();
    if (X[2] == 0) u[2] = 0;
    if (X[2] == 1) u[2] = stretch - 1;
    for (const int a : {0, 1})
      if (X[a] == 0) u[a] = 0;
    return u;
  };
  s.probes = points_in_box({1, 1, 1}, {3, 3, 3});
  s.closed_form = [](const Vec& X, double) {
    return Vec((across - 1) * X[0], (across - 1) * X[1], (stretch - 1) * X[2]);
  };
  s.grip = [](const Vec& X) { return X[2] == 1; };
  s.quantities = {displacement(), force(), energy()};
  const softsim::Lame lame = softsim::Lame::from_young_poisson(s.young, s.poisson);
  const double log_volume = std::log(across * across * stretch);
  s.closed_energy = lame.mu / 2 * (2 * across * across + stretch * stretch - 3) - lame.mu * log_volume +
                    lame.lambda / 2 * log_volume * log_volume;
  s.closed_force = {0, 0, lame.mu * (stretch - 1 / stretch) + lame.lambda * log_volume / stretch};
  return s;
}

/// A bar of four cubes, one end turned by 90 degrees about its axis.
inline Scene twisted_bar() {
  Scene s{.name = "twisted_bar", .title = "Neo-Hookean bar, 1 x 1 x 4 m, one end turned by 90 degrees"};
  s.young = 10;
  s.poisson = 0.3;
  s.law = softsim::NeoHookean::from_young_poisson(s.young, s.poisson);
  s.resolutions = {1, 2, 3, 4, 6, 8};
  const Vec size(1, 1, 4);
  s.tetrahedra = [=](int r) { return softsim::box_mesh({r, r, 4 * r}, size); };
  s.hexahedra = [=](int r) { return softsim::box_hexahedra({r, r, 4 * r}, size); };
  s.support = [](const Vec& X) {
    if (X[2] == 0) return held();
    if (X[2] < 4) return all_free();
    return Vec(1 - X[1] - X[0], X[0] - X[1], 0);  // (x, y) becomes (1 - y, x)
  };
  s.rotation = [](const Vec& X) {
    return softsim::quaternion_exponential(Vec(0, 0, X[2] == 0 ? 0 : std::numbers::pi / 2));
  };
  s.load_steps = 4;
  s.grip = [](const Vec& X) { return X[2] == 4; };
  s.quantities = {displacement(), force(), energy()};
  s.probes = points_in_box(size, {3, 3, 6});
  return s;
}

/// Cook's membrane: a tapered panel of 48 mm, in plane strain, sheared at its right side.
inline Scene cooks_membrane(const std::string& name, double poisson) {
  Scene s{.name = name, .title = "Cook's membrane, plane strain, Neo-Hookean, nu = "};
  s.title += softsim::to_text(poisson);
  constexpr double mu = 0.4225;
  s.poisson = poisson;
  s.young = 2 * mu * (1 + poisson);
  s.law = softsim::NeoHookean::from_young_poisson(s.young, poisson);
  s.resolutions = {2, 4, 8, 16, 24, 32};
  const auto tapered = [](const Vec& X) {  // of the unit square; in mm, N and MPa
    const double bottom = 44 * X[0], top = 44 + 16 * X[0];
    return Vec(48 * X[0], bottom + (top - bottom) * X[1], X[2]);
  };
  const auto shaped = [tapered](auto mesh) {
    std::vector<Vec> points = mesh.points();
    for (Vec& X : points) X = tapered(X);
    return decltype(mesh)(points, mesh.elements());
  };
  // turned around x by half a turn, so that cells are not cut along their long diagonals
  s.tetrahedra = [=](int r) {
    const softsim::TetrahedralMesh box = softsim::box_mesh({r, r, 1}, {1, 1, 48.0 / r});
    std::vector<Vec> points = box.points();
    for (Vec& X : points) X = {X[0], 1 - X[1], 48.0 / r - X[2]};
    return shaped(softsim::TetrahedralMesh(points, box.elements()));
  };
  s.hexahedra = [=](int r) { return shaped(softsim::box_hexahedra({r, r, 1}, {1, 1, 48.0 / r})); };
  s.support = [](const Vec& X) { return X[0] == 0 ? held() : Vec(is_free, is_free, 0); };
  // 1 N a mm of thickness over the 16 mm of the right side
  s.traction = [](const Vec& X) { return Vec(0, X[0] > 48 - 1e-9 ? 1.0 / 16 : 0, 0); };
  s.load_steps = 2;
  s.reference_resolution = poisson > 0.499 ? 16 : 32;
  s.reference_preconditioner = "-";
  s.quantities = {displacement(), largest_displacement()};
  for (const Vec& X : points_in_box({1, 1, 0}, {4, 4, 1})) s.probes.push_back(tapered(X));
  return s;
}

}  // namespace chart
