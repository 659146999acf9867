// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <malloc.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <ctime>
#include <limits>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

#include "model.hpp"
#include "reference.hpp"
#include "solve.hpp"

namespace chart {

/// What can be asked: a model with a solver at a resolution, in double or single precision.
struct Method {
  const Model* model;
  const Solver* solver;
  bool single = false;
};

/// One line of a chart.
struct Point {
  std::string model, integrator, solver, preconditioner;
  double step = std::numeric_limits<double>::quiet_NaN();  ///< s; a static solve has none
  int resolution = 0;
  std::string scalar, status = "";
  double error = std::numeric_limits<double>::quiet_NaN();  ///< relative, see `Scene::probes`
  double seconds =
      std::numeric_limits<double>::quiet_NaN();  ///< to the solution, once everything is in place
  double seconds_per_simulated_second = std::numeric_limits<double>::quiet_NaN();
  std::size_t memory = 0;    ///< bytes in use for mesh, system and solver after the solve
  double setup_seconds = 0;  ///< mesh, system, patterns, symbolic factorisation: what is done once a scene

  static constexpr const char* header =
      "model,integrator,solver,preconditioner,step,resolution,scalar,status,error,seconds,"
      "seconds_per_simulated_second,memory,setup_seconds";
  friend std::ostream& operator<<(std::ostream& out, const Point& p) {
    const auto number = [&out](double x) {
      if (std::isfinite(x)) out << x;
      out << ',';
    };
    out << p.model << ',' << p.integrator << ',' << p.solver << ',' << p.preconditioner << ',';
    number(p.step);
    out << p.resolution << ',' << p.scalar << ',' << p.status << ',';
    number(p.error);
    number(p.seconds);
    number(p.seconds_per_simulated_second);
    return out << p.memory << ',' << p.setup_seconds;
  }
};

/// CPU time of this thread, s: others' work on a shared machine does not count.
inline double cpu_seconds() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// A method on a scene, with what was worked out for it in place.
template <class T>
class Bench {
 public:
  Bench(const Scene& scene, const Method& m, int resolution)
      : discrete_(m.model->make<T>(scene, resolution)), solve_(m.solver->make<T>(scene.load_steps)) {}

  /// Solves from rest.
  softsim::StepReport solve() {
    q_ = discrete_.system.rest_state();
    return solve_(discrete_.system, q_);
  }
  /// Displacements at the probes after the last solve.
  [[nodiscard]] std::vector<Vec> answer() const { return discrete_.at_probes(q_); }

 private:
  Discrete<T> discrete_;
  Solve<T> solve_;
  softsim::State<T> q_;
};

/// Runs a method on a scene. The first solve, which also makes patterns and orders, counts to the set-up as
/// far as it takes longer than the median of the others.
/// @param patience s that the repeats may take; at least one is made if the first solve took less
/// @throws NotApplicable if the model does not fit the scene
template <class T>
Point measure_in(const Scene& scene, const Reference& reference, const Method& m, int resolution,
                 double patience) {
  Point p{.model = m.model->name,
          .integrator = "static",
          .solver = m.solver->name,
          .preconditioner = m.solver->preconditioner,
          .resolution = resolution,
          .scalar = std::is_same_v<T, double> ? "double" : "float"};
  const std::size_t before = mallinfo2().uordblks + mallinfo2().hblkhd;
  const double start = cpu_seconds();
  Bench<T> bench(scene, m, resolution);
  const double built = cpu_seconds();
  const softsim::StepReport report = bench.solve();
  const double first = cpu_seconds() - built;
  p.memory = mallinfo2().uordblks + mallinfo2().hblkhd - before;
  p.status = to_string(report.status);
  p.setup_seconds = built - start;
  p.seconds = first;
  if (report.status != softsim::Status::converged) return p;
  p.error = relative_distance(bench.answer(), reference.u);
  std::vector<double> times;
  for (double spent = 0;
       times.size() < 9 && (spent + first < patience || (times.empty() && first < patience));) {
    const double begin = cpu_seconds();
    (void)bench.solve();
    times.push_back(cpu_seconds() - begin);
    spent += times.back();
  }
  if (times.empty()) return p;
  std::nth_element(times.begin(), times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2), times.end());
  p.seconds = times[times.size() / 2];
  p.setup_seconds += std::max(0.0, first - p.seconds);
  return p;
}

inline Point measure(const Scene& scene, const Reference& reference, const Method& m, int resolution,
                     double patience) {
  return m.single ? measure_in<float>(scene, reference, m, resolution, patience)
                  : measure_in<double>(scene, reference, m, resolution, patience);
}

/// Whether b is in no respect better than a.
inline bool dominates(const Point& a, const Point& b) {
  return a.error <= b.error && a.seconds <= b.seconds && (a.error < b.error || a.seconds < b.seconds);
}

}  // namespace chart
