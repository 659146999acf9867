// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <random>
#include <vector>

#include "softsim/core/state.hpp"
#include "softsim/integrator/stable_step.hpp"
#include "softsim/mesh/tetrahedral_mesh.hpp"
#include "softsim/system/system.hpp"

/// The largest stable step of a body as it is observed.
namespace atlas {

/// A motion at rest but for displacements of up to `amplitude` m along each axis.
template <class S>
softsim::Motion<double> perturbed(const S& system, double amplitude) {
  softsim::Motion<double> motion(system.rest().size());
  std::mt19937_64 bits(7);
  for (std::ptrdiff_t k = 0; k < motion.q.size(); ++k)
    motion.q.displacement[k] =
        system.prescribed.free()[k] * amplitude * (static_cast<double>(bits() >> 11) * 0x1p-52 - 1);
  return motion;
}

/// Whether a small motion stays bounded: its norm omega^2 |u|^2 + |v|^2, omega the largest frequency, grows
/// less than a million times in `steps` steps of h.
template <class S, class I>
bool stays_bounded(const S& system, I integrator, double h, double omega, double amplitude, int steps) {
  integrator.set_dt(h);
  softsim::Motion<double> motion = perturbed(system, amplitude);
  const auto square = [&] {
    return omega * omega * softsim::dot(motion.q.displacement, motion.q.displacement) +
           softsim::dot(motion.v, motion.v);
  };
  const double start = square();
  for (int n = 1; n <= steps; ++n) {
    if (integrator.step(system, motion).status != softsim::Status::converged) return false;
    if (n % 20 == 0 && !(square() < 1e6 * start)) return false;
  }
  return true;
}

/// Observed limit over the predicted step h, between 0.5 and 1.5, by bisection to `resolution`; 0 or infinity
/// if it is outside.
template <class S, class I>
double observed_over_predicted(const S& system, const I& integrator, double h, double omega, double amplitude,
                               int steps, double resolution) {
  const auto bounded = [&](double part) {
    return stays_bounded(system, integrator, part * h, omega, amplitude, steps);
  };
  double low = 0.5, high = 1.5;
  // most limits are close to the prediction
  for (const double part : {0.97, 1.03}) {
    if (part <= low || part >= high) continue;
    (bounded(part) ? low : high) = part;
  }
  if (low == 0.5 && !bounded(low)) return 0;
  if (high == 1.5 && bounded(high)) return std::numeric_limits<double>::infinity();
  while (high - low > resolution) {
    const double middle = (low + high) / 2;
    (bounded(middle) ? low : high) = middle;
  }
  return (low + high) / 2;
}

/// Shortest height of a tetrahedron, m.
inline double shortest_height(const softsim::TetrahedralMesh& mesh) {
  constexpr std::array<std::array<std::size_t, 3>, 4> faces{{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};
  double shortest = std::numeric_limits<double>::infinity();
  for (std::size_t t = 0; t < mesh.tetrahedra().size(); ++t) {
    const auto X = mesh.element_points(t);
    double largest = 0;
    for (const auto& f : faces)
      largest = std::max(largest, (X[f[1]] - X[f[0]]).cross(X[f[2]] - X[f[0]]).norm() / 2);
    shortest = std::min(shortest, 3 * mesh.volume(t) / largest);
  }
  return shortest;
}

}  // namespace atlas
