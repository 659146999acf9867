// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include "../quantities.hpp"
#include "../scene.hpp"
#include "softsim/mesh/generators.hpp"

namespace chart {

/// A cantilever along x under its own weight, r cells across, each twice as long as wide.
inline Scene cantilever(const std::string& name, const std::string& title, const Vec& size, double young,
                        double poisson, double mass) {
  Scene s{.name = name, .title = title};
  s.law = softsim::StVenantKirchhoff::from_young_poisson(young, poisson);
  s.young = young;
  s.poisson = poisson;
  s.density = mass / size.prod();
  s.resolutions = {1, 2, 3, 4, 6, 8};
  const auto cells = [size](int r) -> std::array<int, 3> {
    return {static_cast<int>(std::lround(size[0] / size[2] * r / 2)), r, r};
  };
  s.tetrahedra = [=](int r) { return softsim::box_mesh(cells(r), size); };
  s.hexahedra = [=](int r) { return softsim::box_hexahedra(cells(r), size); };
  s.support = [](const Vec& X) { return X[0] == 0 ? held() : all_free(); };
  s.gravity = {0, 0, -9.81};
  s.quantities = {displacement(), largest_displacement(), energy()};
  s.probes =
      points_between({size[0] / 20, size[1] / 2, size[2] / 2}, {size[0], size[1] / 2, size[2] / 2}, 20);
  return s;
}

/// Bosman 2015, Fig. 4.12: sinks by a hundredth of its length.
inline Scene steel_cantilever() {
  return cantilever("steel_cantilever", "Steel beam, 16 x 0.5 x 0.5 m, under its own weight", {16, 0.5, 0.5},
                    2e11, 0.3, 31200);
}
/// Bosman 2015, Fig. 4.13: sinks by 6.5 m.
inline Scene soft_cantilever() {
  Scene s = cantilever("soft_cantilever", "Soft beam, 16 x 1 x 1 m, under its own weight: large deflection",
                       {16, 1, 1}, 4e4, 0.3, 5);
  s.load_steps = 2;
  return s;
}

}  // namespace chart
