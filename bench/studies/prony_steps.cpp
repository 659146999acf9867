// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <numbers>
#include <ostream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "softsim/integrator/implicit.hpp"
#include "softsim/integrator/static_solver.hpp"
#include "softsim/material/st_venant_kirchhoff.hpp"
#include "softsim/mesh/generators.hpp"
#include "softsim/mesh/selection.hpp"
#include "softsim/potential/dead_load.hpp"
#include "softsim/potential/elastic.hpp"
#include "softsim/potential/prony.hpp"
#include "softsim/system/system.hpp"
#include "study.hpp"

// How the error of a viscoelastic body depends on the step: relaxation at a held stretch, creep under a held
// load and a cycle of stretching, each one second at finite strain, with the history at nodes or in elements
// and both updates of it, against closed forms. A cube of 1 m whose sides are free, St. Venant-Kirchhoff with
// E = 10 Pa and nu = 0.3, alpha = 0.3, tau = 0.5 s, without mass: a step is a quasi-static one.

namespace {

using namespace softsim;

constexpr double E = 10, alpha = 0.3, tau = 0.5, omega = 2 * std::numbers::pi;
constexpr double stretch = 1.25, held_force = E / 2 * (stretch * stretch * stretch - stretch);
constexpr double amplitude = 1.5;  // of the cycle, Pa
constexpr std::array<double, 7> sizes{0.1, 0.05, 0.02, 0.01, 0.005, 0.002, 0.001};

const TetrahedralMesh mesh = box_mesh({1, 1, 1}, {1, 1, 1});
const std::vector<std::int32_t> end = nodes_near(mesh, Side::xmax, 0);

// Uniaxial stretch at which the elastic force E/2 (s^3 - s) is `force`, by Newton's method.
double stretch_at(double force) {
  double s = 1;
  for (int k = 0; k < 50; ++k) s -= (E / 2 * (s * s * s - s) - force) / (E / 2 * (3 * s * s - 1));
  return s;
}
// Response to sin(omega t): tau gamma' + gamma = alpha sin(omega t), gamma(0) = 0.
double cycled(double t) {
  const double x = omega * tau;
  return std::sin(omega * t) -
         alpha / (1 + x * x) * (std::sin(omega * t) - x * std::cos(omega * t) + x * std::exp(-t / tau));
}

// Where the history is kept decides what is stretched: nodal forces or the second Piola-Kirchhoff stress.
struct AtNodes {
  static constexpr const char* name = "nodes";
  static auto term(const PronySeries& series) {
    auto term = prony_nodes(elastic(mesh, StVenantKirchhoff::from_young_poisson(E, 0.3)),
                            mesh.points().size(), series);
    term.static_response = StaticResponse::instantaneous;
    return term;
  }
  static double stretch_at(double response) { return ::stretch_at(response); }
  static double force(double response, double) { return response; }
};
struct InElements {
  static constexpr const char* name = "elements";
  static auto term(const PronySeries& series) {
    return prony_elements(mesh, StVenantKirchhoff::from_young_poisson(E, 0.3), series,
                          StaticResponse::instantaneous);
  }
  // S = E/2 (s^2 - 1), P = s S
  static double stretch_at(double response) { return std::sqrt(1 + 2 * response / E); }
  static double force(double response, double s) { return s * response; }
};

DeadLoad<double> traction(double t) {
  DeadLoad<double> load(mesh.points().size());
  for (const Triangle& f : boundary_triangles(mesh)) {
    const auto X = [&](std::size_t i) { return mesh.points()[static_cast<std::size_t>(f[i])]; };
    if (std::min({X(0)[0], X(1)[0], X(2)[0]}) < 1) continue;
    for (const std::int32_t i : f)
      load.add(i, Vec3<double>(t * (X(1) - X(0)).cross(X(2) - X(0)).norm() / 6, 0, 0));
  }
  return load;
}

void require(const StepReport& report) {
  if (report.status != Status::converged) throw std::runtime_error(std::string(report.reason));
}

// The cube on rollers at x = 0, y = 0 and z = 0.
template <class Term>
struct Cube {
  using Body = System<Term, DeadLoad<double>>;
  Body system;
  Motion<double> motion;
  double dt;
  BackwardEuler<Body> integrator;

  Cube(Term term, double load, double dt_)
      : system(mesh, std::move(term), traction(load)),
        motion(mesh.points().size()),
        dt(dt_),
        integrator({.dt = dt, .newton = true, .tolerance = 1e-11}) {
    for (int axis = 0; axis < 3; ++axis)
      for (const std::int32_t i : nodes_near(mesh, static_cast<Side>(2 * axis), 0))
        system.prescribed.set(i, axis, 0);
  }
  void pull(double s) {
    for (const std::int32_t i : end) system.prescribed.set(i, 0, s - 1);
  }
  void settle() { require(StaticSolver<Body>({.tolerance = 1e-11}).solve(system, motion.q)); }
  double reaction() const {
    Vector<double> g = Vector<double>::Zero(motion.q.size());
    system.add_gradient(motion.q, g);
    double sum = 0;
    for (const std::int32_t i : end) sum += block(g, i)[0];
    return sum;
  }
  // Steps through a second and returns the largest error; before(t) each step, error(t) after it.
  template <class Before, class Error>
  double run(Before before, Error error) {
    double worst = 0;
    const int steps = static_cast<int>(std::lround(1 / dt));
    for (int n = 1; n <= steps; ++n) {
      before(n * dt);
      require(integrator.step(system, motion));
      worst = std::max(worst, error(n * dt));
    }
    return worst;
  }
};

const auto nothing = [](double) {};

// Errors relative to the force at first.
template <class History>
double relaxation(const PronySeries& series, double dt, double& at_end) {
  Cube cube(History::term(series), 0, dt);
  cube.pull(stretch);
  cube.settle();
  return cube.run(nothing, [&](double t) {
    at_end = cube.reaction() / held_force;
    return std::abs(at_end - series.relaxation(t));
  });
}
// Errors relative to the elongation at first. Forces of the nodes creep as those of a spring would; the
// stretch follows from them.
double creep(const PronySeries& series, double dt) {
  Cube cube(AtNodes::term(series), held_force, dt);
  cube.settle();
  return cube.run(nothing, [&](double t) {
    const double share = (1 - alpha * std::exp(-(1 - alpha) * t / tau)) / (1 - alpha);
    const double s = 1 + cube.motion.q.point(end[0])[0];
    return std::abs(s - stretch_at(share * held_force)) / (stretch - 1);
  });
}
// The stretch is such that the elastic response is amplitude sin(omega t); errors relative to that amplitude.
template <class History>
double cycle(const PronySeries& series, double dt) {
  Cube cube(History::term(series), 0, dt);
  double s = 1;
  return cube.run(
      [&](double t) {
        s = History::stretch_at(amplitude * std::sin(omega * t));
        cube.pull(s);
      },
      [&](double t) {
        return std::abs(cube.reaction() - History::force(amplitude * cycled(t), s)) / amplitude;
      });
}

}  // namespace

int main(int argc, char** argv) {
  const std::string header = "load,history,update,step,largest_error";
  return study::run(argc, argv, "prony_steps", header, false, [](std::ostream& csv, bool) {
    bool holds = true;
    for (const PronyUpdate update : {PronyUpdate::first_order, PronyUpdate::exponential}) {
      const bool first = update == PronyUpdate::first_order;
      const char* name = first ? "first_order" : "exponential";
      const PronySeries series({{alpha, tau}}, update);
      // order 0: exact
      const auto sweep = [&](const char* load, const char* history, int order, auto error) {
        std::array<double, sizes.size()> errors;
        for (std::size_t i = 0; i < sizes.size(); ++i) {
          errors[i] = error(sizes[i]);
          csv << load << ',' << history << ',' << name << ',' << sizes[i] << ',' << errors[i] << '\n';
        }
        std::printf("%-11s %-9s %-12s error %.1e at 0.1 s, %.1e at 0.001 s", load, history, name,
                    errors.front(), errors.back());
        bool good = order > 0 || *std::max_element(errors.begin(), errors.end()) < 1e-10;
        if (order > 0) {
          const double slope = std::log(errors[2] / errors[6]) / std::log(sizes[2] / sizes[6]);
          std::printf(", slope %.3f below 0.02 s", slope);
          good = std::abs(slope - order) < 0.05;
        } else {
          std::printf(", exact");
        }
        std::puts(good ? "" : " VIOLATED");
        holds = holds && good;
      };
      const auto relax = [&]<class History>(const History&) {
        sweep("relaxation", History::name, first ? 1 : 0, [&](double dt) {
          double at_end = 0;
          const double error = relaxation<History>(series, dt, at_end);
          // the paper's recursion by itself, to ten digits
          if (first && dt == 0.01) holds = holds && std::abs(at_end - 0.7414098902) < 1e-9;
          if (first && dt == 0.001) holds = holds && std::abs(at_end - 0.7406817591) < 1e-9;
          return error;
        });
      };
      relax(AtNodes());
      relax(InElements());
      sweep("creep", "nodes", first ? 1 : 2, [&](double dt) { return creep(series, dt); });
      const auto cycles = [&]<class History>(const History&) {
        sweep("cycle", History::name, first ? 1 : 2, [&](double dt) { return cycle<History>(series, dt); });
      };
      cycles(AtNodes());
      cycles(InElements());
    }
    return holds;
  });
}
