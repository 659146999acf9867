// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "program.hpp"
#include "softsim/io/read_mesh.hpp"
#include "softsim/softsim.hpp"
#include "softsim/solver/gauss_seidel.hpp"
#include "softsim/solver/stationary.hpp"
#include "softsim/system/element_fields.hpp"

// Static equilibrium of an organ (or of the mesh given): Newton's method under random loads, and what inexact
// linear solves cost it (d'Aulignac 2001, tables 6.3 and 6.4).

namespace {

using namespace softsim;
using Body = System<ElasticTetrahedra<NeoHookean>, DeadLoad<double>>;

struct Organ {
  TetrahedralMesh mesh;
  NeoHookean law = NeoHookean::from_young_poisson(5e3, 0.4);
  Body body;
  double size = 0, volume = 0;

  explicit Organ(const std::string& path)
      : mesh(read_mesh(path)), body(mesh, elastic(mesh, law), DeadLoad<double>(mesh.points().size())) {
    Vec3<double> low = mesh.points()[0], high = low;
    for (const auto& x : mesh.points()) {
      low = low.cwiseMin(x);
      high = high.cwiseMax(x);
    }
    size = (high - low).maxCoeff();
    for (std::size_t t = 0; t < mesh.tetrahedra().size(); ++t) volume += mesh.volume(t);
    body.prescribed.fix(nodes_near(mesh, Side::xmin, 0.15 * size));
  }
  [[nodiscard]] double smallest_j(const State<double>& q) const {
    double j = HUGE_VAL;
    for (const auto& field : element_fields(mesh, std::vector{law}, {}, q)) j = std::min(j, field.j);
    return j;
  }
};

// ---------------------------------------------------------------- random loads

bool random_loads(const atlas::Arguments& arguments, const std::string& path) {
  atlas::Table csv(arguments, "random_loads",
                   "load,force,status,reason,newton,linear,residual,displacement,smallest_j,energy");
  Organ organ(path);
  std::mt19937_64 bits(7);
  const auto number = [&] { return static_cast<double>(bits() >> 11) * 0x1p-53; };
  const int count = arguments.short_form ? 20 : 200;
  // E times the area of a section: a force that stretches the whole body to about twice its length
  const double unit = 5e3 * std::pow(organ.volume, 2.0 / 3);
  int solved = 0, wrong = 0;
  std::map<std::string, int> reasons;
  StaticSolver<Body> solver({.max_iterations = 300, .tolerance = 1e-6});
  for (int k = 0; k < count; ++k) {
    // one to four pulls at random nodes, together 1 % to 100 % of that force
    auto& load = std::get<1>(organ.body.terms);
    load = DeadLoad<double>(organ.mesh.points().size());
    const int pulls = 1 + static_cast<int>(4 * number());
    const double force = unit * std::pow(10, -2 + 2 * number());
    for (int p = 0; p < pulls; ++p) {
      const auto node = static_cast<std::int32_t>(number() * static_cast<double>(organ.mesh.points().size()));
      Vec3<double> direction;
      do
        for (int a = 0; a < 3; ++a) direction[a] = 2 * number() - 1;
      while (direction.norm() > 1 || direction.norm() < 0.1);
      load.add(node, force / pulls * direction.normalized());
    }
    State<double> q(organ.mesh.points().size());
    const StepReport report = solver.solve(organ.body, q);
    // looked at from outside: forces in balance, nothing inverted, energy below that of rest
    Vector<double> g = Vector<double>::Zero(organ.body.size()), external = load.force();
    organ.body.add_gradient(q, g);
    organ.body.prescribed.mask(g);
    organ.body.prescribed.mask(external);
    const double residual = norm(external) > 0 ? norm(g) / norm(external) : 0, j = organ.smallest_j(q),
                 energy = organ.body.energy(q);
    const bool right = residual <= 1.01e-6 && j > 0 && energy <= 0;
    if (report.status == Status::converged) (right ? solved : wrong) += 1;
    ++reasons[report.status == Status::converged ? (right ? "solved" : "WRONG") : std::string(report.reason)];
    double largest = 0;
    for (std::ptrdiff_t i = 0; i < q.size(); i += 4)
      largest = std::max(largest, q.displacement.segment<3>(i).norm());
    csv << k << ',' << force / unit << ',' << to_string(report.status) << ',' << report.reason << ','
        << report.newton_iterations << ',' << report.linear_iterations << ',' << residual << ','
        << largest / organ.size << ',' << j << ',' << energy << '\n';
  }
  std::printf("random loads: %d of %d solved, %d wrong", solved, count, wrong);
  for (const auto& [reason, n] : reasons)
    if (reason != "solved") std::printf("; %d: %s", n, reason.c_str());
  std::printf("\n");
  return solved >= 0.95 * count && wrong == 0;
}

// ---------------------------------------------------------------- quadratic convergence

bool newton_residuals(const atlas::Arguments& arguments, const std::string& path) {
  atlas::Table csv(arguments, "newton_residuals", "iteration,residual");
  Organ organ(path);
  std::get<1>(organ.body.terms) = gravity(organ.mesh, 1000, {0, 0, -9.81});
  StaticSolver<Body> solver({.tolerance = 1e-12});
  std::vector<double> residuals;
  solver.newton.on_iteration = [&](const State<double>&, const StepReport& report) {
    residuals.push_back(report.residual);
    return true;
  };
  State<double> q(organ.mesh.points().size());
  (void)solver.solve(organ.body, q);
  std::printf("Newton's residuals:");
  for (std::size_t k = 0; k < residuals.size(); ++k) {
    csv << k << ',' << residuals[k] << '\n';
    std::printf(" %.1e", residuals[k]);
  }
  std::printf("\n");
  // Below 1e-3 the square of the residual, with room for a factor, until rounding.
  for (std::size_t k = 0; k + 1 < residuals.size(); ++k)
    if (residuals[k] < 1e-3 && residuals[k + 1] > 100 * residuals[k] * residuals[k] + 1e-12) return false;
  return residuals.back() <= 1e-12;
}

// ---------------------------------------------------------------- tables 6.3 and 6.4

struct Row {
  int newton = 0, linear = 0;
  double ms = 0;
  bool converged = false;
};

template <template <class> class Preconditioner, class Method>
Row equilibrium(Organ& organ, bool full, int inner, Method method) {
  method.max_iterations = inner;
  method.fixed = true;
  StaticSolver<Body, Assembled, Preconditioner, Method> solver(
      {.max_iterations = 1000, .tolerance = 1e-4, .linear = method, .update_every = full ? 1 : 0});
  if constexpr (requires { solver.newton.preconditioner.omega; }) solver.newton.preconditioner.omega = 1.7;
  Row best;
  best.ms = HUGE_VAL;
  for (int k = 0; k < 2; ++k) {
    State<double> q(organ.mesh.points().size());
    const double start = atlas::seconds();
    const StepReport report = solver.solve(organ.body, q);
    best = {report.newton_iterations, report.linear_iterations,
            std::min(best.ms, 1e3 * (atlas::seconds() - start)), report.status == Status::converged};
  }
  return best;
}

bool inner_iterations(const atlas::Arguments& arguments, const std::string& path) {
  atlas::Table csv(arguments, "inner_iterations",
                   "tangent,inner,inner_iterations,newton,linear,ms,converged");
  Organ organ(path);
  // a pull of (-1, -1, -1) at one point of the surface, as in the thesis: the node farthest from the support
  std::size_t farthest = 0;
  for (std::size_t i = 0; i < organ.mesh.points().size(); ++i)
    if (organ.mesh.points()[i][0] > organ.mesh.points()[farthest][0]) farthest = i;
  const double force = 0.0005 * 5e3 * std::pow(organ.volume, 2.0 / 3);
  std::get<1>(organ.body.terms)
      .add(static_cast<std::int32_t>(farthest), force * Vec3<double>(-1, -1, -1).normalized());
  const std::vector<int> counts = arguments.short_form
                                      ? std::vector<int>{8, 64}
                                      : std::vector<int>{1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 24, 32, 64, 128};
  bool any = false;
  for (const std::string inner : {"SOR", "CG block Jacobi", "CG IC"}) {
    Row best[2];
    int best_count[2] = {0, 0}, crossover = 0;
    for (const int n : counts) {
      Row row[2];
      for (const int full : {0, 1}) {
        row[full] = inner == "SOR" ? equilibrium<GaussSeidel>(organ, full == 1, n, Stationary())
                    : inner == "CG block Jacobi"
                        ? equilibrium<BlockJacobi>(organ, full == 1, n, ConjugateGradient())
                        : equilibrium<IncompleteCholesky>(organ, full == 1, n, ConjugateGradient());
        csv << (full ? "full," : "modified,") << inner << ',' << n << ',' << row[full].newton << ','
            << row[full].linear << ',' << row[full].ms << ',' << row[full].converged << '\n';
        if (row[full].converged && (best_count[full] == 0 || row[full].ms < best[full].ms)) {
          best[full] = row[full];
          best_count[full] = n;
        }
        any = any || row[full].converged;
      }
      if (!row[1].converged || (row[0].converged && row[0].ms < row[1].ms))
        crossover = 0;
      else if (crossover == 0)
        crossover = n;
    }
    std::printf(
        "%s: full Newton best with %d inner iterations, %.1f ms in %d; modified with %d, %.1f ms in %d; full "
        "is always faster from %d on\n",
        inner.c_str(), best_count[1], best[1].ms, best[1].newton, best_count[0], best[0].ms, best[0].newton,
        crossover);
  }
  return any;
}

void statics(const atlas::Arguments& arguments, atlas::Claims& claims) {
  const std::string path = arguments.mesh.empty() ? SOFTSIM_ORGAN : arguments.mesh;
  claims.check(newton_residuals(arguments, path), "Newton's method converges quadratically");
  claims.check(inner_iterations(arguments, path), "Newton's method converges with few inner iterations");
  claims.check(random_loads(arguments, path), "95 % of the random loads are solved, none wrongly");
}

}  // namespace

int main(int argc, char** argv) { return atlas::run(argc, argv, statics); }
