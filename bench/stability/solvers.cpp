// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "program.hpp"
#include "softsim/softsim.hpp"
#include "softsim/solver/direct.hpp"
#include "softsim/solver/gauss_seidel.hpp"
#include "softsim/solver/multigrid.hpp"
#include "softsim/solver/stationary.hpp"

// Cost of one linear solve against the number of unknowns, for direct solvers and for conjugate gradients
// with every preconditioner: a cube of 0.1 m that is held at one face, Neo-Hookean with E = 10 kPa and nu =
// 0.4, loaded by its weight; its stiffness at rest alone (static) and with the mass of a backward Euler step
// of 10 ms (dynamic). To 1e-6.

namespace {

using namespace softsim;
using Body = System<ElasticTetrahedra<NeoHookean>, DeadLoad<double>>;

struct Result {
  double unknowns = 0, setup = 0, solve = 0;
  int iterations = 0;
  bool converged = false;
};

struct Case {
  Body body;
  AssembledTangent<Body> A;
  Vector<double> b;
  double unknowns = 0;

  Case(int n, bool dynamic) : body(make(n)) {
    A.set(body, State<double>(body.rest().size()), {.mass = dynamic ? 1e4 : 0, .stiffness = 1});
    b = std::get<1>(body.terms).force();
    body.prescribed.mask(b);
    unknowns = body.prescribed.free().sum();
  }
  static Body make(int n) {
    const TetrahedralMesh mesh = box_mesh({n, n, n}, {0.1, 0.1, 0.1});
    Body body(mesh, elastic(mesh, NeoHookean::from_young_poisson(1e4, 0.4)),
              gravity(mesh, 1000, {0, 0, -9.81}));
    body.mass = Mass<double>::lumped(mesh, 1000);
    body.prescribed.fix(nodes_near(mesh, Side::xmin, 0));
    return body;
  }

  // Best of some; the pattern's own work is done before, as it is between the steps of a simulation.
  template <class Method, class B>
  Result measure(const Method& method, B& preconditioner, int repetitions) const {
    Result best{unknowns, HUGE_VAL, HUGE_VAL};
    Vector<double> x;
    typename Method::template Workspace<double> workspace;
    preconditioner.compute(A, body.prescribed.free());
    for (int k = 0; k < repetitions; ++k) {
      const double start = atlas::seconds();
      preconditioner.compute(A, body.prescribed.free());
      const double ready = atlas::seconds();
      x.setZero(b.size());
      const LinearReport report = method.solve(A, preconditioner, b, x, workspace);
      best.solve = std::min(best.solve, atlas::seconds() - ready);
      best.setup = std::min(best.setup, ready - start);
      best.iterations = report.iterations;
      best.converged = report.status == Status::converged;
    }
    return best;
  }
};

void solvers(const atlas::Arguments& arguments, atlas::Claims& claims) {
  atlas::Table csv(arguments, "solvers",
                   "problem,solver,tetrahedra,unknowns,iterations,setup_ms,solve_ms,converged");
  const std::vector<int> cells =
      arguments.short_form ? std::vector<int>{4, 6, 9} : std::vector<int>{6, 9, 15, 24, 32, 46, 69};
  for (const bool dynamic : {false, true}) {
    std::vector<Result> multigrid;
    for (const int n : cells) {
      const Case c(n, dynamic);
      const int repetitions = n <= 15 ? 5 : n <= 32 ? 3 : 1;
      const auto write = [&](const char* name, const Result& r) {
        csv << (dynamic ? "dynamic," : "static,") << name << ',' << 6 * n * n * n << ',' << r.unknowns << ','
            << r.iterations << ',' << 1e3 * r.setup << ',' << 1e3 * r.solve << ',' << r.converged
            << std::endl;
        claims.check(r.converged, std::string(name) + " converges");
      };
      const ConjugateGradient cg{.tolerance = 1e-6};
      const auto with = [&](const char* name, auto preconditioner) {
        write(name, c.measure(cg, preconditioner, repetitions));
      };
      if (n <= 46) {
        with("CG", NoPreconditioner<double>());
        with("CG Jacobi", Jacobi<double>());
        with("CG block Jacobi", BlockJacobi<double>());
        with("CG SSOR", GaussSeidel<double>());
      }
      with("CG IC", IncompleteCholesky<double>());
      Multigrid<double> mg;
      multigrid.push_back(c.measure(cg, mg, repetitions));
      write("CG multigrid", multigrid.back());
      if (n <= 24) {
        Ldlt<double> direct;
        write("LDLT", c.measure(Stationary{.tolerance = 1e-6}, direct, 1));
      }
      if (n <= 9 && dynamic) {
        GaussSeidel<double> seidel;
        write("Gauss-Seidel", c.measure(Stationary{.tolerance = 1e-6, .check_every = 10}, seidel, 1));
      }
    }
    const auto at = [&](double unknowns) {
      const Result* nearest = &multigrid.front();
      for (const Result& r : multigrid)
        if (std::abs(std::log(r.unknowns / unknowns)) < std::abs(std::log(nearest->unknowns / unknowns)))
          nearest = &r;
      return *nearest;
    };
    const auto exponent = [](const Result& few, const Result& many) {
      return few.unknowns == many.unknowns ? 0
                                           : std::log((many.setup + many.solve) / (few.setup + few.solve)) /
                                                 std::log(many.unknowns / few.unknowns);
    };
    const Result few = at(1e4), middle = at(1e5), many = at(3e5), most = multigrid.back();
    const double growth = static_cast<double>(many.iterations) / few.iterations;
    std::printf(
        "multigrid, %s: %d iterations at %.0f unknowns, %d at %.0f (%.2f times); time ~ n^%.2f; from %.0f "
        "unknowns, which no cache holds, to %.0f ~ n^%.2f\n",
        dynamic ? "dynamic" : "static", few.iterations, few.unknowns, many.iterations, many.unknowns, growth,
        exponent(few, many), middle.unknowns, most.unknowns, exponent(middle, most));
    claims.check(growth < 1.5, "multigrid needs less than 1.5 times the iterations from 1e4 to 3e5 unknowns");
  }
}

}  // namespace

int main(int argc, char** argv) { return atlas::run(argc, argv, solvers); }
