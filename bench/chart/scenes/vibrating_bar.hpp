// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <numbers>

#include "../quantities.hpp"
#include "../scene.hpp"
#include "softsim/mesh/generators.hpp"

namespace chart {

/// A bar that is held at one end and swings along its axis in its first mode, nu = 0, so little that its law
/// does not matter: what integrators make of twenty periods.
inline Scene vibrating_bar() {
  Scene s{.name = "vibrating_bar", .title = "Bar in its first axial mode, 20 periods"};
  constexpr double length = 1, side = 0.1, speed = 1, period = 4 * length / speed;
  s.young = 1000;
  s.poisson = 0;
  s.density = s.young / (speed * speed);
  s.law = softsim::StVenantKirchhoff::from_young_poisson(s.young, 0);
  s.resolutions = {4, 8, 16, 32, 64};
  const Vec size(length, side, side);
  s.tetrahedra = [=](int r) { return softsim::box_mesh({r, 1, 1}, size); };
  s.hexahedra = [=](int r) { return softsim::box_hexahedra({r, 1, 1}, size); };
  s.support = [](const Vec& X) { return X[0] == 0 ? held() : all_free(); };
  s.duration = 20 * period;
  constexpr double omega = 2 * std::numbers::pi / period, wave = std::numbers::pi / (2 * length),
                   amplitude = 1e-5;
  s.velocity = [=](const Vec& X) { return Vec(amplitude * omega * std::sin(wave * X[0]), 0, 0); };
  s.closed_form = [=](const Vec& X, double t) {
    return Vec(amplitude * std::sin(omega * t) * std::sin(wave * X[0]), 0, 0);
  };
  s.steps = {period / 24, period / 40, period / 80, period / 160, period / 320};
  s.times = 160;
  s.quantities = {displacement(), frequency(period, 0), drift()};
  s.probes = points_between({length / 4, side / 2, side / 2}, {length, side / 2, side / 2}, 4);
  return s;
}

}  // namespace chart
