// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <sstream>
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
    "       chart SCENE|all [--budget SECONDS[,SCENE=SECONDS]...] [--resolutions N] [--out DIR] "
    "[--no-picture]\n"
    "       chart SCENE --only METHOD [--quantity NAME]\n"
    "       chart --reference SCENE|all\n"
    "       all of them: [--mesh FILE] [--data DIR]\n"
    "Runs every method that fits on a scene, coarse to fine, within a budget of CPU time (default 60 s a "
    "scene), and\n"
    "writes DIR/SCENE.csv and DIR/SCENE.png (default out/chart): error against time to solution; for each "
    "further\n"
    "quantity that the scene asks for DIR/SCENE_QUANTITY.csv and .png, and the unknowns of each model into\n"
    "DIR/SCENE_unknowns.csv. --resolutions takes the N coarsest only. --only measures one method, by the "
    "first "
    "columns\n"
    "of its row. --reference works the answer of a scene out again, on ten-node tetrahedra, and writes it "
    "where "
    "charts\n"
    "look for it, --data (minutes). --mesh takes another body for the scene 'organ'; its reference has to be "
    "made "
    "first.\n";

struct Options {
  std::vector<std::string> scenes;
  double budget = 60;
  std::map<std::string, double> budgets = {};  // of scenes that need another
  [[nodiscard]] double budget_of(const Scene& scene) const {
    const auto own = budgets.find(scene.name);
    return own == budgets.end() ? budget : own->second;
  }
  int resolutions = 1000;
  fs::path out = fs::path("out") / "chart", data = SOFTSIM_CHART_DATA;
  std::string mesh = SOFTSIM_ORGAN, only, quantity;
  bool list = false, reference = false, picture = true, show_help = false;
};

// SECONDS[,SCENE=SECONDS]...
void parse_budget(const std::string& text, Options& o) {
  std::istringstream parts(text + ",");
  for (std::string part; std::getline(parts, part, ',');) {
    const std::size_t sign = part.find('=');
    const std::string scene = sign == std::string::npos ? "" : part.substr(0, sign);
    const double seconds =
        positive_number("--budget", sign == std::string::npos ? part : part.substr(sign + 1));
    if (scene.empty())
      o.budget = seconds;
    else
      o.budgets[scene] = seconds;
  }
}

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
      parse_budget(words.value_of(word), o);
    else if (word == "--resolutions")
      o.resolutions = static_cast<int>(std::ceil(words.positive(word)));
    else if (word == "--out")
      o.out = words.value_of(word);
    else if (word == "--data")
      o.data = words.value_of(word);
    else if (word == "--mesh")
      o.mesh = words.value_of(word);
    else if (word == "--only")
      o.only = words.value_of(word);
    else if (word == "--quantity")
      o.quantity = words.value_of(word);
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
  for (const Scene& s : scenes()) {
    std::printf("  %-20s %s;", s.name.c_str(), s.title.c_str());
    for (const Quantity& q : s.quantities) std::printf(" %s", q.name.c_str());
    std::printf("\n");
  }
  std::printf("models\n");
  for (const Model& m : tools.models) std::printf("  %-20s %s\n", m.name.c_str(), m.family.c_str());
  std::printf("solvers\n");
  for (const Solver& s : tools.solvers) std::printf("  %-20s %s\n", s.name.c_str(), s.preconditioner.c_str());
  std::printf("integrators\n");
  for (const Integrator& i : tools.integrators)
    std::printf("  %-26s %-6s %s\n", i.name.c_str(), i.solver.c_str(), i.preconditioner.c_str());
  std::printf("scalars\n  double, float\n");
}

void print_front(const Scene& scene, std::vector<Point> points, const Reference& reference, std::size_t k) {
  std::erase_if(points, [&](const Point& p) { return p.off_front || !std::isfinite(p.error(k)); });
  std::sort(points.begin(), points.end(),
            [](const Point& a, const Point& b) { return a.seconds < b.seconds; });
  std::printf("%s: the front of the %s (own error of the reference %.2g)\n", scene.name.c_str(),
              scene.quantities[k].name.c_str(), reference.errors[k]);
  double best = 1e300;
  for (const Point& p : points) {
    const double error = std::max(p.error(k), reference.errors[k]);  // below it nothing can be told
    if (error > 0.98 * best) continue;                               // no better but for rounding
    best = error;
    std::printf("  %10.3g s  error %9.3g  %s\n", p.seconds, p.error(k), described(p).c_str());
  }
}

// SCENE for the first quantity, SCENE_QUANTITY for the others.
std::string chart_name(const Scene& scene, std::size_t k) {
  return k == 0 ? scene.name : scene.name + "_" + scene.quantities[k].name;
}

// Rows of one file, each written out as it comes.
class Rows {
 public:
  Rows(const fs::path& path, const std::string& header) : path_(path), file_(path) {
    file_.precision(6);
    file_ << header << '\n';
    check();
  }
  template <class F>
  void add(F row) {
    row(file_);
    check();
  }

 private:
  void check() {
    if (!file_.flush()) throw std::runtime_error("cannot write '" + path_.string() + "'");
  }
  fs::path path_;
  std::ofstream file_;
};

// Where and how charts were made: the processor, the compiler, its flags, today.
std::string machine() {
  std::ifstream file("/proc/cpuinfo");
  std::string processor = "a processor unknown";
  for (std::string line; std::getline(file, line);)
    if (line.rfind("model name", 0) == 0) {
      processor = line.substr(line.find(':') + 2);
      break;
    }
  const std::time_t now = std::time(nullptr);
  std::array<char, 32> date{};
  std::strftime(date.data(), date.size(), "%Y-%m-%d", std::localtime(&now));
#ifdef __clang__
  const std::string compiler = "clang " __clang_version__;
#else
  const std::string compiler = "g++ " __VERSION__;
#endif
  return "One core of: " + processor + "; " + compiler + ", " SOFTSIM_CHART_FLAGS "; " + date.data() + ".";
}

void draw_chart(const Scene& scene, const Toolbox& tools, const Options& o) {
  const Reference reference = reference_of(scene, o.data);
  // nothing of an earlier run is left
  for (const auto& entry : fs::directory_iterator(o.out))
    if (const std::string name = entry.path().filename().string();
        name.starts_with(scene.name + ".") || name.starts_with(scene.name + "_"))
      fs::remove(entry.path());
  std::vector<Rows> charts;
  for (std::size_t k = 0; k < scene.quantities.size(); ++k)
    charts.emplace_back(o.out / (chart_name(scene, k) + ".csv"), Point::header);
  Sweep sweep(scene, reference, o.budget_of(scene), static_cast<std::size_t>(o.resolutions));
  sweep.run(tools, [&](const Point& p) {
    for (std::size_t k = 0; k < charts.size(); ++k)
      charts[k].add([&](std::ostream& out) { p.write(out, k); });
  });
  std::map<std::pair<std::string, int>, std::size_t> unknowns;
  for (const Point& p : sweep.points())
    if (p.unknowns > 0) unknowns[{p.model, p.resolution}] = p.unknowns;  // of peers we do not know
  Rows of_unknowns(o.out / (scene.name + "_unknowns.csv"), "model,resolution,unknowns");
  for (const auto& row : unknowns)
    of_unknowns.add([&](std::ostream& out) {
      out << row.first.first << ',' << row.first.second << ',' << row.second << '\n';
    });
  for (const std::string& reason : sweep.reasons())
    std::printf("%s: %s\n", scene.name.c_str(), reason.c_str());
  if (sweep.ended_early() > 0)
    std::printf(
        "%s: %d methods ended before the finest resolution, for want of time; %d of them never began\n",
        scene.name.c_str(), sweep.ended_early(), sweep.never_began());
  for (std::size_t k = 0; k < charts.size(); ++k) print_front(scene, sweep.points(), reference, k);
  std::printf("%s: %zu points in %s\n", scene.name.c_str(), sweep.points().size(),
              (o.out / (scene.name + ".csv")).string().c_str());
}

// Ten-node tetrahedra on three meshes, each with twice the cells across of the one before.
void make_reference(const Scene& scene, const Toolbox& tools, const Options& o) {
  if (scene.closed_form) {
    std::printf("%s: has a closed form\n", scene.name.c_str());
    return;
  }
  if (scene.duration > 0)
    throw BadArguments(scene.name + ": the reference of a motion has to be a closed form");
  const Model& model = *std::find_if(tools.models.begin(), tools.models.end(),
                                     [](const Model& m) { return m.name == "tet10"; });
  const Solver& solver = *std::find_if(tools.solvers.begin(), tools.solvers.end(), [&](const Solver& s) {
    return s.preconditioner == scene.reference_preconditioner;
  });
  const int finest = scene.reference_resolution;
  std::array<Answer, 3> answers;
  for (std::size_t k = 0; k < 3; ++k) {
    const int resolution = finest >> (2 - k);
    const double start = cpu_seconds();
    Bench<double> bench(scene, {.model = &model, .solver = &solver}, resolution);
    if (bench.run(&answers[k]).status != softsim::Status::converged)
      throw std::runtime_error("the reference of " + scene.name + " did not converge");
    std::printf("%s: resolution %d in %.0f s\n", scene.name.c_str(), resolution, cpu_seconds() - start);
    std::fflush(stdout);
  }
  Reference r = extrapolated(scene, answers);
  r.recipe = "chart --reference " + scene.name + ": ten-node tetrahedra, extrapolated from resolutions " +
             std::to_string(finest / 4) + ", " + std::to_string(finest / 2) + ", " + std::to_string(finest) +
             "; errors: half of the last correction";
  write_reference(scene, r, o.data);
  std::printf("%s: %s\n", scene.name.c_str(), r.recipe.c_str());
  for (std::size_t k = 0; k < r.errors.size(); ++k)
    std::printf("%s: own error of the %s %.3g\n", scene.name.c_str(), scene.quantities[k].name.c_str(),
                r.errors[k]);
}

// One method, as a row of a chart names it.
int measure_one(const Scene& scene, const Toolbox& tools, const Options& o) {
  const Method* found = nullptr;
  int resolution = 0;
  std::vector<Method> all;
  for (const bool single : {false, true})
    for (const Model& m : tools.models)
      for (const Method& method : tools.methods(scene, m, single)) all.push_back(method);
  for (const int r : scene.resolutions)
    for (const Method& m : all)
      if (unmeasured(scene, m, r).name() == o.only) {
        found = &m;
        resolution = r;
      }
  if (found == nullptr)
    throw BadArguments("--only '" + o.only +
                       "': no such method; a name is the first columns of a chart's row, like '" +
                       unmeasured(scene, all.front(), scene.resolutions[0]).name() + "'");
  const Point p = measure(scene, reference_of(scene, o.data), *found, resolution, 2);
  std::printf("%s\n", Point::header);
  std::fflush(stdout);
  p.write(std::cout, 0);
  return p.status == "converged" ? 0 : 1;
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
  const std::vector<Scene> wanted = scenes_named(o.scenes, o.mesh);
  if (o.reference) {
    if (o.mesh != SOFTSIM_ORGAN && o.data == SOFTSIM_CHART_DATA)
      throw BadArguments("--reference with --mesh needs a --data of its own");
    for (const Scene& scene : wanted) make_reference(scene, tools, o);
    return 0;
  }
  if (!o.only.empty()) {
    if (wanted.size() != 1) throw BadArguments("--only needs one scene");
    Scene scene = wanted.front();
    ask_for(o.quantity, scene);
    return measure_one(scene, tools, o);
  }
  for (const Scene& scene : wanted) (void)reference_of(scene, o.data);  // before anything is written over
  std::error_code error;
  fs::create_directories(o.out, error);
  Rows of_scenes(o.out / "scenes.csv", "scene;title;reference_error;budget");
  for (const Scene& scene : wanted) {
    draw_chart(scene, tools, o);
    of_scenes.add([&](std::ostream& out) {
      out << scene.name << ';' << scene.title << ';' << reference_of(scene, o.data).errors[0] << ';'
          << o.budget_of(scene) << '\n';
    });
  }
  Rows(o.out / "machine.txt", machine());
  if (!o.picture) return 0;
  const std::string python = picture::drawing_python();
  std::vector<std::string> command{python, SOFTSIM_CHART_PLOT, o.out.string()};
  for (const Scene& scene : wanted)
    for (std::size_t k = 0; k < scene.quantities.size(); ++k)
      command.insert(command.end(), {chart_name(scene, k), scene.title, scene.quantities[k].title,
                                     softsim::to_text(reference_of(scene, o.data).errors[k])});
  if (!python.empty() && picture::runs(command)) return 0;
  std::fprintf(stderr, "chart: no picture: %s\n", python.empty() ? "no Python with matplotlib" : "it failed");
  return 1;
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
