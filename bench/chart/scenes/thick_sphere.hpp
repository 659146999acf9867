// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>

#include "../scene.hpp"
#include "softsim/mesh/generators.hpp"

namespace chart {

/// A thick Neo-Hookean sphere under pressure from inside: r(R), by the ordinary differential equation of its
/// equilibrium, dP_r/dR + 2 (P_r - P_t) / R = 0, P_i = mu (l_i - 1/l_i) + lambda log(l_r l_t^2) / l_i.
class ThickSphere {
 public:
  static constexpr double inner = 1, outer = 2;

  /// @param traction on the inside, per rest area
  ThickSphere(double mu, double lambda, double traction) : mu_(mu), lambda_(lambda) {
    // shooting: the radius of the cavity for which nothing pulls outside
    double low = inner, high = 3 * inner;
    for (int i = 0; i < 100; ++i) {
      const double middle = (low + high) / 2;
      (integrate(middle, -traction) > 0 ? high : low) = middle;
    }
    (void)integrate((low + high) / 2, -traction);
  }
  /// Displacement of a point at rest distance R from the centre.
  [[nodiscard]] double operator()(double R) const {
    const double at = (std::clamp(R, inner, outer) - inner) / step;
    const auto k = std::min(static_cast<std::size_t>(at), steps - 1);
    const double t = at - static_cast<double>(k);
    const auto& [r0, d0] = table_[k];
    const auto& [r1, d1] = table_[k + 1];
    const double square = t * t, cube = square * t;  // Hermite
    return (2 * cube - 3 * square + 1) * r0 + (cube - 2 * square + t) * step * d0 +
           (3 * square - 2 * cube) * r1 + (cube - square) * step * d1 - R;
  }

 private:
  static constexpr std::size_t steps = 1000;
  static constexpr double step = (outer - inner) / static_cast<double>(steps);

  [[nodiscard]] double stress(double stretch, double log_volume) const {
    return mu_ * (stretch - 1 / stretch) + lambda_ * log_volume / stretch;
  }
  // dr/dR, which has the radial stress P
  [[nodiscard]] double radial_stretch(double P, double across) const {
    double l = 1 / (across * across);
    for (int i = 0; i < 60; ++i) {
      const double log_volume = std::log(l * across * across),
                   slope = mu_ * (1 + 1 / (l * l)) + lambda_ * (1 - log_volume) / (l * l),
                   change = (stress(l, log_volume) - P) / slope;
      l = std::max(l - change, l / 2);
      if (std::abs(change) < 1e-15 * l) break;
    }
    return l;
  }
  // Runge and Kutta's method from the inside; returns P_r outside
  double integrate(double r, double P) {
    using Pair = std::array<double, 2>;
    const auto slope = [this](double R, const Pair& y) -> Pair {
      const double across = y[0] / R, along = radial_stretch(y[1], across),
                   log_volume = std::log(along * across * across);
      return {along, -2 * (y[1] - stress(across, log_volume)) / R};
    };
    const auto moved = [](const Pair& y, double h, const Pair& d) -> Pair {
      return {y[0] + h * d[0], y[1] + h * d[1]};
    };
    Pair y{r, P};
    for (std::size_t k = 0; k <= steps; ++k) {
      const double R = inner + static_cast<double>(k) * step;
      const Pair k1 = slope(R, y);
      table_[k] = {y[0], k1[0]};
      if (k == steps) break;
      const Pair k2 = slope(R + step / 2, moved(y, step / 2, k1)),
                 k3 = slope(R + step / 2, moved(y, step / 2, k2)), k4 = slope(R + step, moved(y, step, k3));
      for (std::size_t i = 0; i < 2; ++i) y[i] += step / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]);
    }
    return y[1];
  }

  double mu_, lambda_;
  std::array<std::array<double, 2>, steps + 1> table_{};
};

/// An octant of a hollow sphere: the three faces of a cube blown up to it, each the same unit box of cells,
/// turned round the diagonal, its third axis along the radius.
template <class Mesh>
Mesh sphere_octant(const Mesh& box, double inner, double outer) {
  std::vector<Vec> points;
  auto elements = box.elements();
  elements.clear();
  std::map<std::array<long, 3>, std::int32_t> number;
  for (int turn = 0; turn < 3; ++turn) {
    std::vector<std::int32_t> of_node;
    for (const Vec& x : box.points()) {
      const Vec on_cube(std::tan(std::numbers::pi / 4 * x[0]), std::tan(std::numbers::pi / 4 * x[1]), 1);
      const Vec on_sphere = (inner + (outer - inner) * x[2]) * on_cube.normalized();
      const Vec X(on_sphere[(3 - turn) % 3], on_sphere[(4 - turn) % 3], on_sphere[(5 - turn) % 3]);
      const std::array<long, 3> key{std::lround(1e9 * X[0]), std::lround(1e9 * X[1]),
                                    std::lround(1e9 * X[2])};
      const auto [entry, is_new] = number.try_emplace(key, static_cast<std::int32_t>(points.size()));
      if (is_new) points.push_back(X);
      of_node.push_back(entry->second);
    }
    for (auto element : box.elements()) {
      for (std::int32_t& i : element) i = of_node[static_cast<std::size_t>(i)];
      elements.push_back(element);
    }
  }
  return Mesh(std::move(points), std::move(elements));
}

/// An octant between three planes of symmetry; blown up by more than a third of its inner radius, of a
/// material that hardly changes its volume.
inline Scene thick_sphere() {
  Scene s{.name = "thick_sphere",
          .title = "Thick sphere (radii 1 and 2 m), Neo-Hookean, nu = 0.45, under pressure from inside"};
  s.young = 10;
  s.poisson = 0.45;
  const auto law = softsim::NeoHookean::from_young_poisson(s.young, s.poisson);
  s.law = law;
  s.resolutions = {1, 2, 3, 4, 6, 8};
  s.tetrahedra = [](int r) {
    return sphere_octant(softsim::box_mesh({r, r, r}, {1, 1, 1}), ThickSphere::inner, ThickSphere::outer);
  };
  s.hexahedra = [](int r) {
    return sphere_octant(softsim::box_hexahedra({r, r, r}, {1, 1, 1}), ThickSphere::inner,
                         ThickSphere::outer);
  };
  s.support = [](const Vec& X) {
    Vec u = all_free();
    for (int a = 0; a < 3; ++a)
      if (X[a] == 0) u[a] = 0;
    return u;
  };
  constexpr double pull = 4;  // Pa
  s.traction = [=](const Vec& X) {
    const bool inside = X.minCoeff() > 1e-9 && X.norm() < (ThickSphere::inner + ThickSphere::outer) / 2;
    return inside ? Vec(pull * X.normalized()) : Vec(Vec::Zero());
  };
  s.load_steps = 2;
  const softsim::Lame lame = softsim::Lame::from_young_poisson(s.young, s.poisson);
  const auto exact = std::make_shared<const ThickSphere>(lame.mu, lame.lambda, pull);
  s.closed_form = [exact](const Vec& X, double) { return Vec((*exact)(X.norm()) * X.normalized()); };
  for (const double R : {1.1, 1.25, 1.4, 1.55})
    for (const Vec& way : {Vec(1, 1, 1), Vec(3, 2, 1), Vec(1, 4, 2), Vec(2, 1, 6), Vec(5, 5, 1)})
      s.probes.push_back(R * way.normalized());
  return s;
}

}  // namespace chart
