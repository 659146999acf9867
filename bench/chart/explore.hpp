// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <queue>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "measure.hpp"

namespace chart {

/// What a point costs: s a solve, s per simulated second.
inline double cost(const Scene& scene, const Point& p) {
  return scene.duration > 0 ? p.seconds_per_simulated_second : p.seconds;
}

/// What a user wants of a scene.
struct Wish {
  double tolerance;  ///< relative error
  double rate;       ///< Hz: solves per second, or frames per second of a simulation in real time
  /// A simulation has to keep up with the clock, and to make a step a frame at least.
  [[nodiscard]] bool met_by(const Scene& scene, const Point& p) const {
    if (!(p.error() <= tolerance)) return false;
    return scene.duration > 0 ? p.seconds_per_simulated_second <= 1 && allows(scene, p.step)
                              : p.seconds * rate <= 1;
  }
  /// Whether a step is short enough.
  [[nodiscard]] bool allows(const Scene& scene, double step) const {
    return scene.duration == 0 || step * rate <= 1 + 1e-9;
  }
};

/// Finds cheap methods that meet a wish without trying all of them: what is expected to be cheapest is tried
/// first.
///
/// Every model starts on its coarsest resolution, with every solver, or with every integrator and its longest
/// step that the rate allows; none but reductions is expected to be quicker than another was. What was
/// measured tells what the next finer resolution and the next shorter step will take; both join the queue,
/// but not the resolution if it was accurate enough, or hardly better than the one before (its step is too
/// long). The search ends where the next try would take more than `hopeless` times as long as the best that
/// is accurate enough, fast enough or not. Then single precision is tried where double was accurate enough.
class Exploration {
 public:
  static constexpr double hopeless = 4;

  /// @param budget s of CPU time
  Exploration(const Scene& scene, const Reference& reference, const Wish& wish, double budget)
      : scene_(scene), reference_(reference), wish_(wish), end_(cpu_seconds() + budget) {}

  void run(const Toolbox& tools) {
    const auto later = [](const Try& a, const Try& b) { return a.expected > b.expected; };
    std::priority_queue<Try, std::vector<Try>, decltype(later)> queue(later);
    const std::size_t steps = scene_.duration > 0 ? scene_.steps.size() : 1;  // of each integrator
    std::vector<std::vector<Method>> methods;  // of each model; those of one integrator follow each other
    for (const Model& m : tools.models) {
      methods.push_back(tools.methods(scene_, m, false));
      for (std::size_t k = 0; k < methods.back().size(); k += steps)
        for (std::size_t j = k; j < k + steps; ++j)
          if (wish_.allows(scene_, methods.back()[j].step)) {
            queue.push({.model = methods.size() - 1, .method = j});
            break;
          }
    }
    std::vector<double> quickest(methods.size(), std::numeric_limits<double>::infinity());  // of each model
    std::vector<std::pair<Method, int>> accurate;
    while (!queue.empty() && queue.top().expected <= hopeless * limit()) {
      Try t = queue.top();
      queue.pop();
      // but for reductions, no method takes much less than all others with its model
      const bool reduced = methods[t.model][t.method].reduced();
      if (t.expected == 0 && !reduced && std::isfinite(quickest[t.model])) {
        t.expected = quickest[t.model];
        queue.push(t);
        continue;
      }
      const std::vector<Method>& of_model = methods[t.model];
      const int resolution = scene_.resolutions[t.level];
      const Point* p = ask(of_model[t.method], resolution, t.whole);
      if (p == nullptr) continue;
      if (!reduced) quickest[t.model] = std::min(quickest[t.model], p->seconds);
      if (t.level == 0 && (t.method + 1) % steps != 0)
        queue.push({.expected = 2 * p->seconds,
                    .whole = 2 * p->seconds + p->setup_seconds,
                    .model = t.model,
                    .method = t.method + 1});
      if (!std::isfinite(p->error())) continue;
      if (p->error() <= wish_.tolerance) accurate.emplace_back(of_model[t.method], resolution);
      if (p->error() > wish_.tolerance && p->error() < 0.9 * t.error &&
          t.level + 1 < scene_.resolutions.size()) {
        const double finer = static_cast<double>(scene_.resolutions[t.level + 1]) / resolution;
        queue.push({.expected = p->seconds * std::pow(finer, 3),
                    .whole = whole(*p, finer),
                    .error = p->error(),
                    .model = t.model,
                    .method = t.method,
                    .level = t.level + 1});
      }
    }
    for (auto& [method, resolution] : accurate) {
      Method single = method;
      single.single = true;
      (void)ask(single, resolution, 0);
    }
    dearer(accurate);
  }

  /// All that was measured.
  [[nodiscard]] const std::vector<Point>& points() const { return points_; }
  /// Whether the budget ended it.
  [[nodiscard]] bool out_of_time() const { return out_of_time_; }

 private:
  struct Try {
    double expected = 0;                                     // s that a run takes
    double whole = 0;                                        // s, set-up included
    double error = std::numeric_limits<double>::infinity();  // on the resolution before
    std::size_t model, method, level = 0;
  };

  // What more accuracy costs: the two finer resolutions of all that was accurate enough.
  void dearer(const std::vector<std::pair<Method, int>>& accurate) {
    for (const auto& [method, resolution] : accurate) {
      const std::string name = unmeasured(scene_, method, resolution).name();
      const Point before =
          *std::find_if(points_.begin(), points_.end(), [&](const Point& p) { return p.name() == name; });
      const auto finer = std::upper_bound(scene_.resolutions.begin(), scene_.resolutions.end(), resolution);
      for (auto r = finer; r != scene_.resolutions.end() && r - finer < 2; ++r) {
        const double expected = whole(before, static_cast<double>(*r) / resolution);
        if (5 * expected < end_ - cpu_seconds()) (void)ask(method, *r, expected);
      }
    }
  }

  // s that the fastest takes that is accurate enough; infinite before there is one
  [[nodiscard]] double limit() const {
    double best = std::numeric_limits<double>::infinity();
    for (const Point& p : points_)
      if (p.error() <= wish_.tolerance) best = std::min(best, p.seconds);
    return best;
  }
  // s that a finer resolution takes, set-up included: factorisations grow faster than the mesh
  static double whole(const Point& p, double finer) {
    return (p.seconds + p.setup_seconds) * std::pow(finer, 4);
  }
  // s that repeats may take
  [[nodiscard]] double patience() const {
    return std::isfinite(limit()) ? std::min(0.3, 10 * limit()) : 0.05;
  }
  // nullptr if the model does not fit, or too little time is left
  const Point* ask(const Method& m, int resolution, double whole) {
    if (cpu_seconds() + whole > end_) {
      out_of_time_ = true;
      return nullptr;
    }
    try {
      points_.push_back(measure(scene_, reference_, m, resolution, patience()));
      return &points_.back();
    } catch (const NotApplicable&) {
    } catch (const std::invalid_argument&) {
    }
    return nullptr;
  }

  const Scene& scene_;
  const Reference& reference_;
  Wish wish_;
  double end_;
  bool out_of_time_ = false;
  std::vector<Point> points_;
};

}  // namespace chart
