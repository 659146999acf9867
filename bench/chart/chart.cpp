// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

#include "../../examples/picture.hpp"
#include "command_line.hpp"
#include "measure.hpp"
#include "sweep.hpp"

// chart SCENE: all methods on one scene, error against time. `chart --help` tells the rest.

namespace {

using namespace chart;
namespace fs = std::filesystem;

constexpr const char* help =
    "usage: chart --list\n"
    "       chart SCENE|all [--budget SECONDS] [--resolutions N] [--out DIR] [--no-picture]\n"
    "       chart --reference SCENE|all\n"
    "Runs every method that fits on a scene, coarse to fine, within a budget of CPU time (default 60 s a "
    "scene), and\n"
    "writes DIR/SCENE.csv and DIR/SCENE.png (default out/chart): error against time to solution. "
    "--resolutions takes\n"
    "the N coarsest only. --reference works the answer of a scene out again, on ten-node tetrahedra, and "
    "writes it\n"
    "where charts look for it (minutes).\n";

struct Options {
  std::vector<std::string> scenes;
  double budget = 60;
  int resolutions = 1000;
  fs::path out = fs::path("out") / "chart";
  bool list = false, reference = false, picture = true, show_help = false;
};

Options parse(int argc, char** argv) {
  Options o;
  std::string word;
  for (Words words(argc, argv); words.next(word);) {
    if (word == "--help")
      o.show_help = true;
    else if (word == "--list")
      o.list = true;
    else if (word == "--reference")
      o.reference = true;
    else if (word == "--no-picture")
      o.picture = false;
    else if (word == "--budget")
      o.budget = words.positive(word);
    else if (word == "--resolutions")
      o.resolutions = static_cast<int>(words.positive(word));
    else if (word == "--out")
      o.out = words.value_of(word);
    else if (word.empty() || word[0] == '-')
      throw BadArguments("unknown option '" + word + "'");
    else
      o.scenes.push_back(word);
  }
  if (o.scenes.empty() && !o.list && !o.show_help) throw BadArguments("no scene; chart --list names them");
  return o;
}

void list(const Toolbox& tools) {
  std::printf("scenes\n");
  for (const Scene& s : scenes()) std::printf("  %-20s %s\n", s.name.c_str(), s.title.c_str());
  std::printf("models\n");
  for (const Model& m : tools.models) std::printf("  %-20s %s\n", m.name.c_str(), m.family.c_str());
  std::printf("solvers\n");
  for (const Solver& s : tools.solvers) std::printf("  %-20s %s\n", s.name.c_str(), s.preconditioner.c_str());
  std::printf("integrators\n");
  for (const Integrator& i : tools.integrators)
    std::printf("  %-26s %-6s %s\n", i.name.c_str(), i.solver.c_str(), i.preconditioner.c_str());
  std::printf("scalars\n  double, float\n");
}

void print_front(const Scene& scene, std::vector<Point> points, double reference_error) {
  std::erase_if(points, [](const Point& p) { return !std::isfinite(p.error); });
  std::sort(points.begin(), points.end(),
            [](const Point& a, const Point& b) { return a.seconds < b.seconds; });
  std::printf("%s: the front (own error of the reference %.2g)\n", scene.name.c_str(), reference_error);
  double best = 1e300;
  for (const Point& p : points) {
    if (p.error > 0.98 * best) continue;  // no better but for rounding
    best = p.error;
    std::printf("  %10.3g s  error %9.3g  %s\n", p.seconds, p.error, described(p).c_str());
  }
}

// Ten-node tetrahedra on three meshes, each with half the cells of the one before, and what their answers
// tend to (Richardson); half of the last correction is taken for the error.
void make_reference(const Scene& scene, const Toolbox& tools) {
  if (scene.closed_form) {
    std::printf("%s: has a closed form\n", scene.name.c_str());
    return;
  }
  const Model& model = *std::find_if(tools.models.begin(), tools.models.end(),
                                     [](const Model& m) { return m.name == "tet10"; });
  const Solver& solver = *std::find_if(tools.solvers.begin(), tools.solvers.end(), [&](const Solver& s) {
    return s.preconditioner == scene.reference_preconditioner;
  });
  const int finest = scene.reference_resolution;
  std::vector<std::vector<Vec>> u;
  for (const int resolution : {finest / 4, finest / 2, finest}) {
    const double start = cpu_seconds();
    Bench<double> bench(scene, {.model = &model, .solver = &solver}, resolution);
    if (bench.run().status != softsim::Status::converged)
      throw std::runtime_error("the reference of " + scene.name + " did not converge");
    u.push_back(bench.answer());
    std::printf("%s: resolution %d in %.0f s\n", scene.name.c_str(), resolution, cpu_seconds() - start);
    std::fflush(stdout);
  }
  const double before = relative_distance(u[0], u[1]), now = relative_distance(u[1], u[2]);
  const double rate = std::clamp(std::log2(before / now), 0.5, 4.0), part = 1 / (std::exp2(rate) - 1);
  Reference r;
  for (std::size_t i = 0; i < u[2].size(); ++i) r.u.push_back(u[2][i] + part * (u[2][i] - u[1][i]));
  r.error = relative_distance(u[2], r.u) / 2;
  r.recipe = "chart --reference " + scene.name + ": ten-node tetrahedra, extrapolated from resolutions " +
             std::to_string(finest / 4) + ", " + std::to_string(finest / 2) + ", " + std::to_string(finest) +
             " at the rate " + softsim::to_text(std::round(100 * rate) / 100) +
             "; error: half of the last correction";
  write_reference(scene, r, SOFTSIM_CHART_DATA);
  std::printf("%s: %s; error %.3g\n", scene.name.c_str(), r.recipe.c_str(), r.error);
}

int run(const Options& o) {
  const Toolbox tools;
  if (o.show_help) {
    std::fputs(help, stdout);
    return 0;
  }
  if (o.list) {
    list(tools);
    return 0;
  }
  const std::vector<Scene> wanted = scenes_named(o.scenes);
  if (o.reference) {
    for (const Scene& scene : wanted) make_reference(scene, tools);
    return 0;
  }
  std::error_code error;
  fs::create_directories(o.out, error);
  for (const Scene& scene : wanted) {
    const fs::path path = o.out / (scene.name + ".csv");
    std::ofstream csv(path);
    csv.precision(6);
    csv << Point::header << '\n';
    if (!csv.flush()) throw std::runtime_error("cannot write '" + path.string() + "'");
    const Reference reference = reference_of(scene, SOFTSIM_CHART_DATA);
    Sweep sweep(scene, reference, o.budget, static_cast<std::size_t>(o.resolutions));
    sweep.run(tools, [&](const Point& p) { csv << p << std::endl; });
    const std::vector<Point>& points = sweep.points();
    if (!csv.flush()) throw std::runtime_error("cannot write '" + path.string() + "'");
    for (const auto& [model, why] : sweep.reasons())
      std::printf("%s: no %s: %s\n", scene.name.c_str(), model.c_str(), why.c_str());
    if (sweep.ended_early() > 0)
      std::printf("%s: %d methods ended before the finest resolution, for want of time\n", scene.name.c_str(),
                  sweep.ended_early());
    print_front(scene, points, reference.error);
    std::printf("%s: %zu points in %s\n", scene.name.c_str(), points.size(), path.string().c_str());
  }
  if (!o.picture) return 0;
  const std::string python = picture::drawing_python();
  std::vector<std::string> command{python, SOFTSIM_CHART_PLOT, o.out.string()};
  for (const Scene& scene : wanted) command.push_back(scene.name + "=" + scene.title);
  if (python.empty() || !picture::runs(command))
    std::fprintf(stderr, "chart: no picture: %s\n",
                 python.empty() ? "no Python with matplotlib" : "it failed");
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(parse(argc, argv));
  } catch (const BadArguments& error) {
    std::fprintf(stderr, "chart: %s\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "chart: %s\n", error.what());
    return 1;
  }
}
