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
#include <sstream>
#include <string>
#include <vector>

#include "model.hpp"
#include "reference.hpp"
#include "solve.hpp"

namespace chart {

/// What can be asked: a model with a solver, or with an integrator and a step, in double or single precision.
struct Method {
  const Model* model;
  const Solver* solver = nullptr;          ///< of a static scene
  const Integrator* integrator = nullptr;  ///< of a dynamic one
  double step = std::numeric_limits<double>::quiet_NaN();
  bool single = false;
  /// In few unknowns: a run takes little, once they are found.
  [[nodiscard]] bool reduced() const { return solver != nullptr ? solver->reduced : integrator->reduced; }
};

/// One line of a chart.
struct Point {
  std::string model, integrator, solver, preconditioner;
  double step = std::numeric_limits<double>::quiet_NaN();  ///< s; a static solve has none
  int resolution = 0;
  std::string scalar, status = "";
  std::vector<double> errors = {};  ///< of the scene's quantities
  double seconds =
      std::numeric_limits<double>::quiet_NaN();  ///< to the solution, once everything is in place
  double seconds_per_simulated_second = std::numeric_limits<double>::quiet_NaN();
  std::size_t memory = 0;    ///< bytes in use for mesh, system and solver after the solve
  double setup_seconds = 0;  ///< mesh, system, patterns, symbolic factorisation: what is done once a scene
  std::size_t unknowns = 0;
  /// It has seen the load before (see `Solver`), or has another law than the scene: not to be compared.
  bool off_front = false;

  /// Of the k-th of the scene's quantities; not a number where the method failed or does not tell.
  [[nodiscard]] double error(std::size_t k = 0) const { return k < errors.size() ? errors[k] : not_told; }

  static constexpr const char* header =
      "model,integrator,solver,preconditioner,step,resolution,scalar,status,error,seconds,"
      "seconds_per_simulated_second,memory,setup_seconds";
  /// What tells its method and mesh from all others: the first columns of its row.
  [[nodiscard]] std::string name() const {
    std::ostringstream out;
    out << model << ',' << integrator << ',' << solver << ',' << preconditioner << ',';
    if (std::isfinite(step)) out << step;
    out << ',' << resolution << ',' << scalar;
    return out.str();
  }
  /// A row of the chart of the k-th quantity.
  void write(std::ostream& out, std::size_t k) const {
    const auto number = [&out](double x) {
      if (std::isfinite(x)) out << x;
      out << ',';
    };
    out << name() << ',' << status << ',';
    number(error(k));
    number(seconds);
    number(seconds_per_simulated_second);
    out << memory << ',' << setup_seconds << '\n';
  }
};

/// A point in words.
inline std::string described(const Point& p) {
  std::string words = p.model;
  if (p.integrator != "static") {
    std::ostringstream step;
    step << ", " << p.integrator << " in steps of " << p.step << " s";
    words += step.str();
  }
  if (p.solver != "-") words += ", " + p.solver;
  if (p.preconditioner != "-") words += " with " + p.preconditioner;
  return words + ", " + p.scalar + ", resolution " + std::to_string(p.resolution);
}

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
      : scene_(scene), discrete_(m.model->make<T>(scene, resolution)) {
    if (scene.duration == 0) {
      solve_ = m.solver->make<T>(scene.load_steps);
    } else {
      const int per_time =
          std::max(1, static_cast<int>(std::ceil(scene.duration / m.step / scene.times - 1e-9)));
      steps_ = per_time * scene.times;
      advance_ = m.integrator->make<T>(scene.duration / steps_);
    }
  }

  /// Solves from rest, or simulates the whole duration.
  /// @param answer if it is wanted
  softsim::StepReport run(Answer* answer = nullptr) {
    if (answer != nullptr) *answer = {};
    if (scene_.duration > 0) return simulate(answer);
    softsim::State<T> q = discrete_.system.rest_state();
    const softsim::StepReport report = solve_(discrete_, q);
    if (answer != nullptr) *answer = {discrete_.at_probes(q), {discrete_.system.energy(q)}, force(q)};
    return report;
  }
  /// s that it took in the last run to tell where a motion is.
  [[nodiscard]] double telling() const { return telling_; }
  /// Components that are free to move.
  [[nodiscard]] std::size_t unknowns() const {
    return static_cast<std::size_t>((discrete_.system.prescribed.free().array() != T(0)).count());
  }

 private:
  softsim::StepReport simulate(Answer* answer) {
    const auto& system = discrete_.system;
    softsim::Motion<T> motion = system.rest_motion();
    const auto blocks = static_cast<std::ptrdiff_t>(system.rest().size());
    for (std::ptrdiff_t b = 0; b < blocks && scene_.velocity; ++b)
      if (moves_a_place(b))
        softsim::block(motion.v, b) =
            scene_.velocity(system.rest()[static_cast<std::size_t>(b)]).template cast<T>();
    system.prescribed.mask(motion.v);
    const auto tell = [&](bool at_probes) {
      const double begin = cpu_seconds();
      if (at_probes) {
        const std::vector<Vec> u = discrete_.at_probes(motion.q);
        answer->u.insert(answer->u.end(), u.begin(), u.end());
      }
      answer->energy.push_back(system.energy(motion.q) + system.kinetic_energy(motion.q, motion.v));
      telling_ += cpu_seconds() - begin;
    };
    telling_ = 0;
    if (answer != nullptr) tell(false);
    softsim::StepReport report;
    for (int k = 1; k <= steps_; ++k) {
      report = advance_(system, motion);
      if (report.status != softsim::Status::converged) return report;
      if (answer != nullptr && k % (steps_ / scene_.times) == 0) tell(true);
    }
    return report;
  }
  // The first of a frame's two blocks is where it is.
  [[nodiscard]] bool moves_a_place(std::ptrdiff_t b) const {
    const auto points = static_cast<std::ptrdiff_t>(discrete_.system.points());
    return b < points || (b - points) % 2 == 0;
  }
  // What holds the nodes in the grip of the scene.
  [[nodiscard]] Vec force(const softsim::State<T>& q) const {
    if (!scene_.grip) return Vec::Constant(not_told);
    const auto& system = discrete_.system;
    softsim::Vector<T> g = softsim::Vector<T>::Zero(system.size());
    system.add_gradient(q, g);
    Vec sum = Vec::Zero();
    for (std::size_t b = 0; b < system.rest().size(); ++b)
      if (const auto i = static_cast<std::ptrdiff_t>(b); moves_a_place(i) && scene_.grip(system.rest()[b]))
        sum += softsim::block(g, i).template cast<double>();
    return sum;
  }

  const Scene& scene_;
  Discrete<T> discrete_;
  Solve<T> solve_;
  Advance<T> advance_;
  int steps_ = 0;
  double telling_ = 0;
};

/// A point of which only the name is known.
inline Point unmeasured(const Scene& scene, const Method& m, int resolution) {
  const bool moves = scene.duration > 0;
  return {.model = m.model->name,
          .integrator = moves ? m.integrator->name : "static",
          .solver = moves ? m.integrator->solver : m.solver->name,
          .preconditioner = moves ? m.integrator->preconditioner : m.solver->preconditioner,
          .step = m.step,
          .resolution = resolution,
          .scalar = m.single ? "float" : "double",
          .off_front = !moves && m.solver->trained};
}

/// Runs a method on a scene. The first run, which also makes patterns and orders, counts to the set-up as far
/// as it takes longer than the median of the others.
/// @param patience s that the repeats may take; at least one is made if the first run took less than ten
///   times that, or the method is reduced; otherwise the first run is all there is, with its patterns
/// @throws NotApplicable if the model does not fit the scene
template <class T>
Point measure_in(const Scene& scene, const Reference& reference, const Method& m, int resolution,
                 double patience) {
  const bool moves = scene.duration > 0;
  Point p = unmeasured(scene, m, resolution);
  const auto took = [&](double seconds) {
    p.seconds = seconds;
    if (moves) p.seconds_per_simulated_second = seconds / scene.duration;
  };
  const auto in_use = [] {
    const auto info = mallinfo2();
    return info.uordblks + info.hblkhd;
  };
  const std::size_t before = in_use();
  const double start = cpu_seconds();
  Bench<T> bench(scene, m, resolution);
  const double built = cpu_seconds();
  Answer answer;
  const softsim::StepReport report = bench.run(&answer);
  const double first = cpu_seconds() - built - bench.telling();
  p.memory = in_use() - before;
  p.status = to_string(report.status);
  p.setup_seconds = built - start;
  p.unknowns = bench.unknowns();
  took(first);
  if (report.status != softsim::Status::converged) return p;
  for (const Quantity& q : scene.quantities) p.errors.push_back(q.error(scene, answer, reference.answer));
  if (!std::isfinite(p.error())) p.status = "not_finite";
  std::vector<double> times;
  for (double spent = 0; times.size() < 9 && (spent + first < patience ||
                                              (times.empty() && (m.reduced() || first < 10 * patience)));) {
    const double begin = cpu_seconds();
    (void)bench.run();
    times.push_back(cpu_seconds() - begin);
    spent += times.back();
  }
  if (times.empty()) return p;
  std::nth_element(times.begin(), times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2), times.end());
  took(times[times.size() / 2]);
  p.setup_seconds += std::max(0.0, first - p.seconds);
  return p;
}

/// The same, in the precision that the method has.
inline Point measure(const Scene& scene, const Reference& reference, const Method& m, int resolution,
                     double patience) {
  return m.single ? measure_in<float>(scene, reference, m, resolution, patience)
                  : measure_in<double>(scene, reference, m, resolution, patience);
}

/// All that scenes may be asked with.
struct Toolbox {
  std::vector<Model> models = chart::models();
  std::vector<Solver> solvers = both(chart::solvers(), chart::reductions());
  std::vector<Integrator> integrators = both(chart::integrators(), chart::modal_integrators());

  /// The methods for a scene with one model: its kind of solver, its steps.
  [[nodiscard]] std::vector<Method> methods(const Scene& scene, const Model& model, bool single) const {
    std::vector<Method> all;
    if (scene.duration == 0)
      for (const Solver& s : solvers) all.push_back({.model = &model, .solver = &s, .single = single});
    else
      for (const Integrator& i : integrators)
        for (const double dt : scene.steps)
          all.push_back({.model = &model, .integrator = &i, .step = dt, .single = single});
    return all;
  }

 private:
  template <class All>
  static All both(All all, const All& more) {
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
};

}  // namespace chart
