// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include "any_system.hpp"
#include "recovery.hpp"
#include "scene.hpp"
#include "softsim/mesh/selection.hpp"

namespace atlas {

/// A bar of 1 x 1 x 4 with n cells across; both ends will be held in full.
inline Body bar(int n) { return {"bar", softsim::box_mesh({n, n, 4 * n}, {1, 1, 4}, {-0.5, -0.5, 0})}; }

/// Where the upper end of a bar is brought: turned around its axis, and its length times a stretch.
struct Grip {
  double degrees = 0, stretch = 1;
};

/// How far a bar went and whether it came back.
struct Excursion {
  Grip reached;          ///< the last position held in equilibrium on the way out
  bool arrived = false;  ///< that is the one asked for
  int inverted = 0;      ///< largest number of inverted elements on the way out
  int newton = 0, linear = 0;
  int left = 0;        ///< inverted elements after the way back
  double rest = 0;     ///< largest displacement after the way back, over the bar's length
  bool back = false;   ///< every solve on the way back converged
  std::string reason;  ///< of the first solve that did not
};

inline void grip(AnySystem& system, const Body& body, const std::vector<std::int32_t>& end, const Grip& to) {
  const double a = to.degrees * std::numbers::pi / 180;
  for (const std::int32_t i : end) {
    const Vec& X = body.points()[static_cast<std::size_t>(i)];
    const Vec x(std::cos(a) * X[0] - std::sin(a) * X[1], std::sin(a) * X[0] + std::cos(a) * X[1],
                4 * to.stretch);
    system.prescribed.set(i, x - X);
  }
}

/// Brings the upper end of a bar to `to` in `steps` equal parts (of the angle, and of the logarithm of the
/// stretch), and back in as many. A part whose solve fails ends the way out; the way back then starts there.
inline Excursion excursion(const Body& body, const Elasticity& elastic, const Grip& to, int steps) {
  AnySystem system(body, elastic[0], elastic[1], softsim::DeadLoad<double>(body.points().size()));
  system.prescribed.fix(softsim::nodes_near(body, softsim::Side::zmin, 1e-9));
  const std::vector<std::int32_t> end = softsim::nodes_near(body, softsim::Side::zmax, 1e-9);
  Excursion result;
  State<double> q = body.rest();
  Solver solver({.max_iterations = 400, .tolerance = 1e-9});
  const auto at = [&](int k) {
    const double part = static_cast<double>(k) / steps;
    return Grip{part * to.degrees, std::pow(to.stretch, part)};
  };
  const auto solve = [&](int k) {
    grip(system, body, end, at(k));
    const softsim::StepReport report = solver.solve(system, q);
    result.newton += report.newton_iterations;
    result.linear += report.linear_iterations;
    const bool converged = report.status == softsim::Status::converged;
    if (!converged && result.reason.empty()) result.reason = report.reason;
    return converged;
  };
  int k = 0;
  State<double> last = q;
  while (k < steps && solve(k + 1)) {
    last = q;
    result.reached = at(++k);
    result.inverted = std::max(result.inverted, body.inverted(q));
  }
  q = last;
  result.arrived = k == steps;
  result.back = true;
  while (k > 0 && result.back) result.back = solve(--k);
  result.left = body.inverted(q);
  result.rest = q.displacement.cwiseAbs().maxCoeff() / 4;
  return result;
}

}  // namespace atlas
