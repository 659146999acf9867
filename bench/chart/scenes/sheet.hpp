// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>

#include "../quantities.hpp"
#include "../scene.hpp"
#include "softsim/mesh/generators.hpp"

namespace chart {

/// A sheet like a ligament, 40 x 10 x 1 mm, held at both ends and pressed on one side: it bends by a tenth of
/// its length, and then carries the load like a membrane. Few elements across, so stretched ones.
inline Scene sheet() {
  Scene s{.name = "sheet", .title = "Sheet of 40 x 10 x 1 mm, held at both ends, Neo-Hookean, pressed aside"};
  s.young = 1e6;
  s.poisson = 0.45;
  s.law = softsim::NeoHookean::from_young_poisson(s.young, s.poisson);
  s.density = 1000;
  const Vec size(0.04, 0.01, 0.001);
  s.resolutions = {1, 2, 4, 6, 8};
  const auto cells = [](int r) -> std::array<int, 3> { return {8 * r, 2 * r, (r + 1) / 2}; };
  s.tetrahedra = [=](int r) { return softsim::box_mesh(cells(r), size); };
  s.hexahedra = [=](int r) { return softsim::box_hexahedra(cells(r), size); };
  s.support = [=](const Vec& X) { return X[0] == 0 || X[0] > size[0] - 1e-9 ? held() : all_free(); };
  s.traction = [=](const Vec& X) { return Vec(0, 0, X[2] > size[2] - 1e-9 ? -500 : 0); };
  s.load_steps = 4;
  s.probes = points_in_box(size, {8, 3, 1});
  s.quantities = {displacement(), largest_displacement(), energy()};
  return s;
}

}  // namespace chart
