// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "any_system.hpp"
#include "scene.hpp"
#include "softsim/integrator/static_solver.hpp"

namespace atlas {

using Solver = softsim::StaticSolver<AnySystem>;

/// How one attempt to come back to rest ended.
struct Recovery {
  softsim::StepReport report;
  double distance;  ///< largest, of a node to where it is at rest, over the body's size
  double energy;    ///< left, J
  int inverted;     ///< integration points

  /// True if the body is at rest again.
  [[nodiscard]] bool recovered() const {
    return report.status == softsim::Status::converged && distance < 1e-4 && inverted == 0;
  }
};

/// Options of every attempt: far below the default tolerance, because forces of a tangled start are large.
inline softsim::NewtonOptions recovery_options(int max_iterations = 1000) {
  return {.max_iterations = max_iterations, .tolerance = 1e-12, .verify_minimum = true};
}

/// Solves without a load from a deformed start. `first`, if given, is an energy that is minimised before and
/// whose result the solve starts from, whatever it is.
inline Recovery recover(const Body& body, const Elasticity& elastic, Support support, Start start,
                        std::uint64_t seed, double noise = 0, const Elasticity* first = nullptr,
                        const softsim::NewtonOptions& options = recovery_options()) {
  const auto make = [&](const Elasticity& e) {
    AnySystem system(body, e[0], e[1], softsim::DeadLoad<double>(body.points().size()));
    hold(system, body, support);
    return system;
  };
  const AnySystem system = make(elastic);
  State<double> q = start_state(body, system.prescribed, start, seed, noise);
  softsim::StepReport before;
  if (first != nullptr) before = Solver(options).solve(make(*first), q);
  Recovery result{Solver(options).solve(system, q), 0, 0, 0};
  result.report.newton_iterations += before.newton_iterations;
  result.report.linear_iterations += before.linear_iterations;
  result.distance = distance_to_rest(body, q, support) / body.size();
  result.energy = system.energy(q);
  result.inverted = body.inverted(q);
  return result;
}

/// What became of several attempts.
struct Tally {
  int runs = 0, recovered = 0, elsewhere = 0, inside_out = 0, saddle = 0, not_converged = 0, not_finite = 0;
  double energy = 0;  ///< largest that was left by a failure, J
  int inverted = 0;   ///< largest number of inverted points left
  std::vector<int> newton, linear;
  std::map<std::string, int> reasons;

  void add(const Recovery& r) {
    ++runs;
    newton.push_back(r.report.newton_iterations);
    linear.push_back(r.report.linear_iterations);
    if (r.recovered()) {
      ++recovered;
      return;
    }
    energy = std::max(energy, r.energy);
    inverted = std::max(inverted, r.inverted);
    switch (r.report.status) {
      case softsim::Status::converged:
        ++elsewhere;
        ++reasons["another equilibrium"];
        return;
      case softsim::Status::inverted:
        ++inside_out;
        break;
      case softsim::Status::stationary_not_minimum:
        ++saddle;
        break;
      case softsim::Status::not_finite:
        ++not_finite;
        break;
      case softsim::Status::not_converged:
        ++not_converged;
        break;
    }
    ++reasons[std::string(r.report.reason)];
  }

  [[nodiscard]] double share() const { return static_cast<double>(recovered) / runs; }
  /// The reason of most failures; empty without one.
  [[nodiscard]] std::string reason() const {
    const auto most = std::max_element(reasons.begin(), reasons.end(),
                                       [](const auto& a, const auto& b) { return a.second < b.second; });
    return most == reasons.end() ? "" : most->first;
  }
  static int median(std::vector<int> values) {
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
  }
};

/// Attempts from one kind of start; random ones from `seeds` seeds, the others once.
inline Tally attempt(const Body& body, const Elasticity& elastic, Support support, Start start, int seeds,
                     double noise = 0, const Elasticity* first = nullptr) {
  Tally tally;
  const int runs = start == Start::random || noise > 0 ? seeds : 1;
  for (int seed = 1; seed <= runs; ++seed)
    tally.add(recover(body, elastic, support, start, static_cast<std::uint64_t>(seed), noise, first));
  return tally;
}

}  // namespace atlas
