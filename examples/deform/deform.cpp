// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT

// The main job: a mesh file in, a ParaView series, a summary and a picture out. `deform --help` tells the
// options.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

#include "../picture.hpp"
#include "options.hpp"
#include "results.hpp"
#include "softsim/io/read_mesh.hpp"
#include "softsim/softsim.hpp"

namespace deform {

using softsim::Status;
using softsim::StepReport;
using softsim::TetrahedralMesh;

double wall_clock() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

TetrahedralMesh load_mesh(const Options& o) {
  TetrahedralMesh mesh =
      softsim::read_mesh(o.mesh.empty() ? DEFORM_ORGAN : o.mesh, {.cell_array = o.cell_array});
  for (const std::string& warning : mesh.warnings())
    std::fprintf(stderr, "deform: warning: %s\n", warning.c_str());
  if (o.scale == 1) return mesh;
  std::vector<Vec3<double>> points = mesh.points();
  for (Vec3<double>& x : points) x *= o.scale;
  return TetrahedralMesh(points, mesh.tetrahedra(), mesh.region());
}

/// Parameters for every region of the mesh: those of --region in the order of their numbers, after those for
/// all others.
struct Parameters {
  std::vector<RegionParameters> sets;
  std::vector<std::int32_t> index;  // one per tetrahedron
  std::vector<double> density;      // one per tetrahedron
};

Parameters parameters_by_region(const Options& o, const TetrahedralMesh& mesh) {
  Parameters p{{o.parameters}, {}, {}};
  std::map<int, std::int32_t> number;
  for (const auto& [id, set] : o.regions) {
    if (std::find(mesh.region().begin(), mesh.region().end(), id) == mesh.region().end())
      invalid(std::string("--region ") + std::to_string(id) + ": the mesh has no such region");
    number[id] = static_cast<std::int32_t>(p.sets.size());
    p.sets.push_back(set);
  }
  for (const int id : mesh.region()) {
    const auto found = number.find(id);
    p.index.push_back(found == number.end() ? 0 : found->second);
    p.density.push_back(p.sets[static_cast<std::size_t>(p.index.back())].density);
  }
  return p;
}

template <class System>
void require_supports(const System& system, std::size_t fixed) {
  try {
    softsim::require_supports(system);
  } catch (const std::invalid_argument& error) {
    invalid(std::string("--fix took ") + std::to_string(fixed) + (fixed == 1 ? " node; " : " nodes; ") +
            error.what());
  }
}

/// Draws DIR/deform.png by the script beside this program's source, with the first Python that has
/// matplotlib.
void draw_picture(const std::string& folder, bool statics) {
  const std::string python = picture::drawing_python();
  if (python.empty()) {
    std::fprintf(stderr, "deform: no picture, no Python with numpy and matplotlib was found\n");
    return;
  }
  std::vector<std::string> command{python, DEFORM_PLOT_SCRIPT, folder};
  if (statics) command.push_back("--static");
  if (picture::runs(command))
    std::printf("picture: %s/deform.png\n", folder.c_str());
  else
    std::fprintf(stderr, "deform: the picture could not be drawn\n");
}

/// Makes the folder of the results, without those of an earlier run.
void prepare_folder(const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) invalid(std::string("--out ") + folder + ": cannot be made (" + error.message() + ")");
  for (const char* name : {"summary.json", "deform.pvd", "deform.png"})
    if (std::filesystem::is_directory(folder + "/" + name))
      invalid(std::string("--out ") + folder + ": " + name + " is a folder there");
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    const bool frame = name.starts_with("deform_") && name.ends_with(".vtu");
    if (frame || name == "deform.pvd" || name == "deform.png" || name == "summary.json")
      std::filesystem::remove(entry.path(), error);
  }
  if (error) invalid(std::string("--out ") + folder + ": " + error.message());
}

/// Everything that depends on the law: builds the system, steps or solves it, writes what comes out.
template <class Law>
int run(const Options& o, const TetrahedralMesh& mesh) {
  const Parameters parameters = parameters_by_region(o, mesh);
  std::vector<Law> laws{Law::from_young_poisson(o.parameters.young, o.parameters.poisson)};
  for (const auto& [id, p] : o.regions) {
    try {
      laws.push_back(Law::from_young_poisson(p.young, p.poisson));
    } catch (const std::invalid_argument& error) {
      invalid(std::string("--region ") + std::to_string(id) + ": " + error.what());
    }
  }

  softsim::DeadLoad<double> load = softsim::gravity(mesh, parameters.density, o.gravity);
  for (const Pull& pull : o.pulls) load.spread(softsim::nodes_near(mesh, pull.side, o.fix_depth), pull.force);

  softsim::System system(mesh, softsim::elastic(mesh, laws, parameters.index), load);
  using System = decltype(system);
  system.mass = o.consistent_mass ? softsim::Mass<double>::consistent(mesh, parameters.density)
                                  : softsim::Mass<double>::lumped(mesh, parameters.density);
  system.damping = {.alpha = o.alpha, .beta = o.beta};
  std::vector<std::int32_t> fixed;
  for (const Side side : o.fix)
    for (const std::int32_t node : softsim::nodes_near(mesh, side, o.fix_depth)) fixed.push_back(node);
  std::sort(fixed.begin(), fixed.end());
  fixed.erase(std::unique(fixed.begin(), fixed.end()), fixed.end());
  system.prescribed.fix(fixed);

  if (o.statics) require_supports(system, fixed.size());
  softsim::StaticSolver<System> statics({.tolerance = o.tolerance});
  softsim::BackwardEuler<System> implicit(
      {.dt = o.statics ? 1 : o.dt, .newton = o.newton, .tolerance = o.tolerance});
  softsim::SemiExplicitEuler<System> explicit_euler({.dt = o.statics ? 1 : o.dt});

  // Nothing is written before this line: whatever was wrong with the input has been said.
  prepare_folder(o.out);
  softsim::VtuSeries series(o.out, "deform");
  softsim::Motion<double> motion(mesh.points().size());
  double last_written = -1;
  const auto write = [&] {
    if (motion.time <= last_written) return;
    write_state(series, mesh, system, laws, parameters.index, motion);
    last_written = motion.time;
  };

  Summary summary;
  summary.nodes = mesh.points().size();
  summary.tetrahedra = mesh.tetrahedra().size();
  summary.fixed_nodes = fixed.size();
  summary.volume = mesh.volume();
  summary.mass = system.mass.total();
  std::printf("%s: %zu nodes, %zu tetrahedra, %s m^3, %s kg, %zu nodes fixed\n",
              o.mesh.empty() ? "organ" : o.mesh.c_str(), summary.nodes, summary.tetrahedra,
              softsim::to_text(summary.volume).c_str(), softsim::to_text(summary.mass).c_str(), fixed.size());
  write();

  const int steps = o.statics ? 1 : o.steps;
  const int every = o.write_every > 0 ? o.write_every : std::max(1, steps / 50);
  double largest_work = 0;
  for (int k = 1; k <= steps; ++k) {
    const double start = wall_clock();
    StepReport report;
    if (o.statics) {
      report = statics.solve(system, motion.q);
      motion.time = 1;  // of the series: 0 is rest, 1 is loaded
    } else {
      report = o.semi_explicit ? explicit_euler.step(system, motion) : implicit.step(system, motion);
      if (report.status != Status::not_finite) motion.time = k * o.dt;  // free of the rounding of a long sum
    }
    const double seconds = wall_clock() - start;
    // From rest and under dead loads no motion holds more energy than the loads have done work: an explicit
    // step that is too large shows here long before its numbers overflow.
    if (o.semi_explicit && !o.statics && (k % 10 == 0 || k == steps) && report.status == Status::converged) {
      const double work = -std::get<1>(system.terms).energy(motion.q);
      largest_work = std::max(largest_work, std::abs(work));
      if (!(system.energy(motion.q) + system.kinetic_energy(motion.v) <= largest_work)) {
        report.status = Status::not_converged;
        report.reason = "energy comes out of nothing, the explicit step is too large";
      }
    }
    summary.seconds_solving += seconds;
    summary.steps = k;
    summary.newton_iterations += report.newton_iterations;
    summary.linear_iterations += report.linear_iterations;
    summary.residual = report.residual;
    summary.status = report.status;
    summary.reason = report.reason;
    if (o.statics)
      std::printf("static solve: %d Newton, %d linear iterations, residual %.2e, %.3g s, %s\n",
                  report.newton_iterations, report.linear_iterations, report.residual, seconds,
                  std::string(to_string(report.status)).c_str());
    else
      std::printf(
          "step %d/%d  time %.6g s  iterations %d Newton %d linear  residual %.2e  real-time factor %.3g\n",
          k, steps, motion.time, report.newton_iterations, report.linear_iterations, report.residual,
          o.dt / seconds);
    std::fflush(stdout);
    if (report.status != Status::converged) break;
    if (k % every == 0) write();
  }

  const auto elastic_energy = std::get<0>(system.terms).energy(motion.q);
  summary.strain_energy = elastic_energy;
  summary.kinetic_energy = system.kinetic_energy(motion.v);
  if (summary.status == Status::converged && !std::isfinite(elastic_energy)) {
    summary.status = Status::not_finite;
    summary.reason = "the strain energy of the last state is not finite";
  }
  write();  // the last state reached, converged or not
  for (std::ptrdiff_t i = 0; i < static_cast<std::ptrdiff_t>(summary.nodes); ++i)
    summary.max_displacement = std::max(summary.max_displacement, motion.q.point(i).norm());
  for (const softsim::ElementField& f : softsim::element_fields(mesh, laws, parameters.index, motion.q))
    summary.inverted_tetrahedra += f.j > 0 ? 0 : 1;
  summary.time = o.statics ? 0 : motion.time;
  summary.real_time_factor =
      o.statics || summary.seconds_solving == 0 ? 0 : motion.time / summary.seconds_solving;
  write_summary(o.out + "/summary.json", summary, o.mesh.empty() ? "organ" : o.mesh, o.material);

  std::printf(
      "%s: largest displacement %s m, strain energy %s J, %zu inverted tetrahedra, %.3g s solving\n",
      std::string(to_string(summary.status)).c_str(), softsim::to_text(summary.max_displacement).c_str(),
      softsim::to_text(summary.strain_energy).c_str(), summary.inverted_tetrahedra, summary.seconds_solving);
  if (summary.inverted_tetrahedra > 0)
    std::fprintf(stderr, "deform: warning: %zu tetrahedra are inverted in the last state; do not trust it\n",
                 summary.inverted_tetrahedra);
  std::printf("results: %s/deform.pvd, %s/summary.json\n", o.out.c_str(), o.out.c_str());
  std::fflush(stdout);
  if (o.picture) draw_picture(o.out, o.statics);
  if (summary.status == Status::converged) return 0;
  std::fprintf(stderr, "deform: %s%s: %s (residual %.2e, tolerance %.2e)\n",
               std::string(to_string(summary.status)).c_str(),
               o.statics ? "" : (std::string(" in step ") + std::to_string(summary.steps)).c_str(),
               summary.reason.c_str(), summary.residual, o.tolerance);
  return 3;
}

int main(const std::vector<std::string>& arguments) {
  try {
    const Options o = parse(arguments);
    if (o.show_help) {
      std::fputs(help, stdout);
      return 0;
    }
    const TetrahedralMesh mesh = load_mesh(o);
    if (o.material == "svk") return run<softsim::StVenantKirchhoff>(o, mesh);
    if (o.material == "linear") return run<softsim::LinearElastic>(o, mesh);
    if (o.material == "neo-hookean") return run<softsim::NeoHookean>(o, mesh);
    return run<softsim::StableNeoHookean>(o, mesh);
  } catch (const std::invalid_argument& error) {
    std::fprintf(stderr, "deform: %s\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "deform: %s\n", error.what());
    return 1;
  }
}

}  // namespace deform

int main(int argc, char** argv) { return deform::main({argv + 1, argv + argc}); }
