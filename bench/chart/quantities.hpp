// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <vector>

#include "scene.hpp"

// What scenes may ask for beside the displacement.

namespace chart {

/// The largest distance from the reference at a probe, over its largest displacement.
inline Quantity largest_displacement() {
  return {"largest_displacement", "largest error of a displacement, relative to the largest displacement",
          [](const Scene&, const Answer& a, const Answer& b) {
            double distance = 0, size = 0;
            for (std::size_t i = 0; i < b.u.size(); ++i) {
              distance = std::max(distance, (a.u[i] - b.u[i]).norm());
              size = std::max(size, b.u[i].norm());
            }
            return distance / size;
          }};
}

/// Potential energy of an equilibrium.
inline Quantity energy() {
  return {"energy", "relative error of the potential energy",
          [](const Scene&, const Answer& a, const Answer& b) {
            return a.energy.empty() || b.energy.empty()
                       ? not_told
                       : std::abs(a.energy[0] - b.energy[0]) / std::abs(b.energy[0]);
          }};
}

/// Force that it takes to move what is prescribed, see `Scene::grip`.
inline Quantity force() {
  return {"force", "relative error of the force", [](const Scene&, const Answer& a, const Answer& b) {
            return (a.force - b.force).norm() / b.force.norm();
          }};
}

/// How far the energy of a motion without damping strays from what it was, relative to that.
inline Quantity drift() {
  return {"drift", "largest change of the energy, relative to its start",
          [](const Scene&, const Answer& a, const Answer&) {
            if (a.energy.empty()) return not_told;
            double most = 0;
            for (const double e : a.energy) most = std::max(most, std::abs(e - a.energy[0]));
            return most / std::abs(a.energy[0]);
          }};
}

/// Frequency of the last probe's swing along an axis, against what it should be: the phase of each period, of
/// which the reference has a whole number of samples, followed from one period to the next.
/// @param period s
inline Quantity frequency(double period, int axis) {
  return {"frequency", "relative error of the frequency",
          [period, axis](const Scene& scene, const Answer& a, const Answer& reference) {
            const std::vector<double> times = times_of(scene);
            const std::size_t probes = scene.probes.size();
            const auto samples = static_cast<std::size_t>(std::lround(period / times[0]));
            // the swing in one period, as parts of a sine and a cosine
            const auto swing = [&](const Answer& of, std::size_t first) {
              std::array<double, 2> parts{0, 0};
              for (std::size_t k = first; k < first + samples; ++k) {
                const double angle = 2 * std::numbers::pi * times[k] / period,
                             x = of.u[k * probes + probes - 1][axis];
                parts[0] += x * std::sin(angle);
                parts[1] += x * std::cos(angle);
              }
              return parts;
            };
            double lag = 0, since = 0;
            for (std::size_t first = 0; first + samples <= times.size(); first += samples) {
              const auto [sine, cosine] = swing(a, first);
              const auto [s, c] = swing(reference, first);
              if (!(std::hypot(sine, cosine) > 0.01 * std::hypot(s, c))) return not_told;  // it hardly swings
              lag += std::remainder(std::atan2(cosine, sine) - lag, 2 * std::numbers::pi);
              since = times[first + samples - 1] - (static_cast<double>(samples) - 1) / 2 * times[0];
            }
            return std::abs(lag) / (2 * std::numbers::pi * since / period);
          }};
}

/// Volume of a lattice of (n + 1)^3 probes, x fastest, which are the first of a scene.
/// @param u displacements of the probes
inline double lattice_volume(const Scene& scene, const std::vector<Vec>& u, std::size_t n) {
  const auto x = [&](std::size_t i, std::size_t j, std::size_t k) -> Vec {
    const std::size_t p = (k * (n + 1) + j) * (n + 1) + i;
    return scene.probes[p] + u[p];
  };
  // six tetrahedra a cell, around its diagonal
  constexpr std::array<std::array<std::size_t, 2>, 6> ways{{{1, 3}, {3, 2}, {2, 6}, {6, 4}, {4, 5}, {5, 1}}};
  double volume = 0;
  for (std::size_t k = 0; k < n; ++k)
    for (std::size_t j = 0; j < n; ++j)
      for (std::size_t i = 0; i < n; ++i) {
        const auto corner = [&](std::size_t c) { return x(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2)); };
        const Vec origin = corner(0), diagonal = corner(7) - origin;
        for (const auto& [a, b] : ways)
          volume += (corner(a) - origin).cross(corner(b) - origin).dot(diagonal) / 6;
      }
  return volume;
}

/// Volume, from a lattice of (n + 1)^3 probes: the error over the volume at rest.
inline Quantity volume(std::size_t n) {
  return {"volume", "error of the volume, relative to that at rest",
          [n](const Scene& scene, const Answer& a, const Answer& b) {
            const double at_rest =
                lattice_volume(scene, std::vector<Vec>(scene.probes.size(), Vec::Zero()), n);
            return std::abs(lattice_volume(scene, a.u, n) - lattice_volume(scene, b.u, n)) / at_rest;
          }};
}

/// Mean rotation about an axis through `centre` along x of the probes in the plane of `centre`, rad.
inline double mean_twist(const Scene& scene, const std::vector<Vec>& u, const Vec& centre) {
  double moment = 0, inertia = 0;
  for (std::size_t i = 0; i < scene.probes.size(); ++i) {
    const Vec r = scene.probes[i] - centre;
    if (std::abs(r[0]) > 1e-9) continue;
    moment += r[1] * u[i][2] - r[2] * u[i][1];
    inertia += r[1] * r[1] + r[2] * r[2];
  }
  return moment / inertia;
}

/// Twist of a face that should have none, rad.
inline Quantity twist(const Vec& centre) {
  return {"twist", "rotation of the end face, which should have none (rad)",
          [centre](const Scene& scene, const Answer& a, const Answer& b) {
            return std::abs(mean_twist(scene, a.u, centre) - mean_twist(scene, b.u, centre));
          }};
}

}  // namespace chart
