// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "measure.hpp"

namespace chart {

/// What a user wants of a scene.
struct Wish {
  double tolerance;  ///< relative error
  double rate;       ///< solves per second
  [[nodiscard]] bool met_by(const Point& p) const { return p.error <= tolerance && p.seconds * rate <= 1; }
};

/// Finds cheap methods that meet a wish without trying all of them.
///
/// The error depends on the model and its resolution, hardly on the solver: every model climbs from its
/// coarsest resolution, with the solver that was fastest one resolution before, until it is accurate enough
/// or takes more than `hopeless` times as long as the best that is. Then solvers and single precision are
/// tried on the resolutions that were accurate enough, the fastest first.
class Exploration {
 public:
  static constexpr double hopeless = 4;

  /// @param budget s of CPU time
  Exploration(const Scene& scene, const Reference& reference, const Wish& wish, double budget)
      : scene_(scene), reference_(reference), wish_(wish), end_(cpu_seconds() + budget) {}

  void run(const std::vector<Model>& models, const std::vector<Solver>& solvers) {
    struct Climb {
      const Model* model;
      std::size_t next = 0, solver = 0;
      double seconds = 0;
      bool out = false;
    };
    std::vector<Climb> climbs;
    for (const Model& m : models) climbs.push_back({&m});
    struct Feasible {
      const Model* model;
      int resolution;
      std::size_t solver;
      double seconds;
    };
    std::vector<Feasible> feasible;
    for (std::size_t left = climbs.size(); left > 0;) {
      left = 0;
      for (Climb& c : climbs) {
        if (c.out) continue;
        if (c.next == scene_.resolutions.size() || cpu_seconds() > end_) {
          c.out = true;
          continue;
        }
        const int resolution = scene_.resolutions[c.next];
        if (c.next > 0) {
          const double growth = std::pow(static_cast<double>(resolution) / scene_.resolutions[c.next - 1], 3);
          if (c.seconds * growth > hopeless * limit()) {
            c.out = true;
            continue;
          }
        }
        // all solvers where that is cheap, else the last one's best
        std::size_t first = c.solver, last = c.solver + 1;
        if (c.seconds < 0.05) first = 0, last = solvers.size();
        double best = std::numeric_limits<double>::infinity(), error = best;
        for (std::size_t s = first; s < last && !c.out; ++s) {
          const Point* p = ask({c.model, &solvers[s]}, resolution);
          if (p == nullptr) {
            c.out = true;
          } else if (p->seconds < best && std::isfinite(p->error)) {
            best = p->seconds;
            error = p->error;
            c.solver = s;
          }
        }
        if (c.out) continue;
        ++c.next;
        if (std::isfinite(best)) c.seconds = best;
        if (error <= wish_.tolerance) {
          feasible.push_back({c.model, resolution, c.solver, best});
          c.out = true;
        } else {
          ++left;
        }
      }
    }
    std::sort(feasible.begin(), feasible.end(),
              [](const Feasible& a, const Feasible& b) { return a.seconds < b.seconds; });
    for (const Feasible& f : feasible) {
      if (f.seconds > hopeless * limit()) break;
      for (std::size_t s = 0; s < solvers.size(); ++s)
        for (const bool single : {false, true})
          if (cpu_seconds() < end_) (void)ask({f.model, &solvers[s], single}, f.resolution);
    }
  }

  /// All that was measured.
  [[nodiscard]] const std::vector<Point>& points() const { return points_; }
  /// Whether the budget ended it.
  [[nodiscard]] bool out_of_time() const { return cpu_seconds() > end_; }

 private:
  // s of the fastest that is accurate enough; of the rate, if there is none
  [[nodiscard]] double limit() const {
    double best = std::numeric_limits<double>::infinity();
    for (const Point& p : points_)
      if (p.error <= wish_.tolerance) best = std::min(best, p.seconds);
    return std::isfinite(best) ? best : std::max(1 / wish_.rate, 0.05);
  }
  // nullptr if the model does not fit
  const Point* ask(const Method& m, int resolution) {
    for (const Point& p : points_)
      if (p.model == m.model->name && p.solver == m.solver->name &&
          p.preconditioner == m.solver->preconditioner && p.resolution == resolution &&
          (p.scalar == "float") == m.single)
        return &p;
    try {
      points_.push_back(measure(scene_, reference_, m, resolution, std::min(1.0, 20 * limit())));
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
  std::vector<Point> points_;
};

}  // namespace chart
