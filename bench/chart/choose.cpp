// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <set>
#include <string>
#include <vector>

#include "command_line.hpp"
#include "explore.hpp"

// choose SCENE: the cheapest method that is accurate and fast enough. `choose --help` tells the rest.

namespace {

using namespace chart;

constexpr const char* help =
    "usage: choose SCENE --tolerance E --rate HZ [--quantity NAME] [--trained] [--budget SECONDS]\n"
    "       [--mesh FILE] [--data DIR]\n"
    "Prints the method that solves a scene in the shortest time with an error of at most E, at least "
    "HZ times\n"
    "a second, the runners-up of other models, and what more accuracy costs. Explores for at most the budget "
    "(100 s).\n"
    "--quantity: what the error is of, displacement by default; chart --list names those of each scene.\n"
    "--trained: with bases that have seen the load before, by halves.\n"
    "Exit status: 0, 1 if no method is both accurate and fast enough, 2 for a wrong question.\n";

void print(const Scene& scene, const Point& p) {
  std::printf("  %9.3g s%s   error %8.3g   set-up %8.3g s   %8.3g MB   %s\n", cost(scene, p),
              scene.duration > 0 ? " a second" : "", p.error(), p.setup_seconds,
              static_cast<double>(p.memory) / 1e6, described(p).c_str());
}

int answer(const Scene& scene, const Wish& wish, double budget, const std::string& data, bool trained,
           const std::string& again) {
  const Reference reference = reference_of(scene, data);
  if (wish.tolerance < reference.errors[0]) {
    std::fprintf(
        stderr,
        "choose: %s: a tolerance of %g is tighter than the reference's own error; the nearest that can be "
        "told is %.2g\n",
        scene.name.c_str(), wish.tolerance, reference.errors[0]);
    return 2;
  }
  Toolbox tools;
  if (!trained) std::erase_if(tools.solvers, [](const Solver& s) { return s.trained; });
  Exploration exploration(scene, reference, wish, budget);
  exploration.run(tools);
  std::vector<Point> points = exploration.points();
  std::erase_if(points, [](const Point& p) { return !std::isfinite(p.error()); });
  const auto cost_of = [&](const Point& p) { return cost(scene, p); };
  std::sort(points.begin(), points.end(),
            [&](const Point& a, const Point& b) { return cost_of(a) < cost_of(b); });
  const auto best =
      std::find_if(points.begin(), points.end(), [&](const Point& p) { return wish.met_by(scene, p); });
  std::printf("%s: %zu measurements%s\n", scene.name.c_str(), exploration.points().size(),
              exploration.out_of_time() ? ", ended by the budget" : "");
  if (best == points.end()) {
    const auto accurate = std::find_if(points.begin(), points.end(),
                                       [&](const Point& p) { return p.error() <= wish.tolerance; });
    const Point* closest = nullptr;
    for (const Point& p : points)
      if (Wish{1e300, wish.rate}.met_by(scene, p) && (closest == nullptr || p.error() < closest->error()))
        closest = &p;
    std::fflush(stdout);
    std::fprintf(stderr, "choose: %s: no method reaches an error of %g at %g Hz", scene.name.c_str(),
                 wish.tolerance, wish.rate);
    if (accurate != points.end())
      std::fprintf(stderr, "; accurate enough is %s in %.3g s%s", described(*accurate).c_str(),
                   cost_of(*accurate), scene.duration > 0 ? " a second" : "");
    if (closest != nullptr)
      std::fprintf(stderr, "; fast enough is %s with an error of %.2g", described(*closest).c_str(),
                   closest->error());
    std::fprintf(stderr, "\n");
    return 1;
  }
  std::printf("cheapest with an error of at most %g, at %g Hz:\n", wish.tolerance, wish.rate);
  print(scene, *best);
  std::printf("  measured again by: chart %s --only %s%s\n", scene.name.c_str(), best->name().c_str(),
              again.c_str());
  std::printf("runners-up of other models (as far as they take less than %g times as long):\n",
              Exploration::hopeless);
  std::set<std::string> shown{best->model};
  for (const Point& p : points)
    if (p.error() <= wish.tolerance && wish.allows(scene, p.step) && shown.insert(p.model).second &&
        shown.size() <= 5)
      print(scene, p);
  if (shown.size() == 1) std::printf("  none\n");
  std::printf("less error costs:\n");
  double error = best->error();
  for (const Point& p : points)
    if (cost_of(p) >= cost_of(*best) && wish.allows(scene, p.step) && p.error() < error / 1.5) {
      error = p.error();
      print(scene, p);
    }
  if (error == best->error()) std::printf("  nothing that was tried has less\n");
  return 0;
}

int run(int argc, char** argv) {
  std::vector<std::string> names;
  double budget = 100, tolerance = 0, rate = 0;
  bool trained = false;
  std::string word, quantity, mesh = SOFTSIM_ORGAN, data = SOFTSIM_CHART_DATA;
  for (Words words(argc, argv); words.next(word);) {
    if (word == "--help") {
      std::fputs(help, stdout);
      return 0;
    }
    if (word == "--tolerance")
      tolerance = words.positive(word);
    else if (word == "--rate")
      rate = words.positive(word);
    else if (word == "--budget")
      budget = words.positive(word);
    else if (word == "--trained")
      trained = true;
    else if (word == "--quantity")
      quantity = words.value_of(word);
    else if (word == "--mesh")
      mesh = words.value_of(word);
    else if (word == "--data")
      data = words.value_of(word);
    else if (word.empty() || word[0] == '-')
      throw BadArguments("unknown option '" + word + "'");
    else
      names.push_back(word);
  }
  if (names.size() != 1) throw BadArguments("name one scene; chart --list names them");
  if (tolerance == 0 || rate == 0) throw BadArguments("--tolerance and --rate are needed");
  std::vector<Scene> wanted = scenes_named(names, mesh);
  if (wanted.size() != 1) throw BadArguments("name one scene; chart --list names them");
  Scene& scene = wanted.front();
  ask_for(quantity, scene);
  // what it takes to ask again
  std::string again;
  if (!quantity.empty()) again += " --quantity " + quantity;
  if (mesh != SOFTSIM_ORGAN) again += " --mesh " + mesh;
  if (data != SOFTSIM_CHART_DATA) again += " --data " + data;
  return answer(scene, {tolerance, rate}, budget, data, trained, again);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const BadArguments& error) {
    std::fprintf(stderr, "choose: %s\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "choose: %s\n", error.what());
    return 1;
  }
}
