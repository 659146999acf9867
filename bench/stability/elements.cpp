// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "contrast.hpp"
#include "extremes.hpp"
#include "laws.hpp"
#include "program.hpp"
#include "recovery.hpp"
#include "scene.hpp"
#include "slivers.hpp"
#include "softsim/io/read_mesh.hpp"

// Elements and laws in extreme states: which come back to rest from tangled, flat and inverted starts, what
// slivers and stiffness ratios cost, and how far a bar can be twisted, stretched and crushed.

namespace {

using namespace atlas;

std::string text(auto value) { return std::string(to_string(value)); }

// Laws that are promised to come back from every start with three nodes held, at nu = 0.3.
const std::set<std::string> stable_laws{
    "stable NH",        "stable NH projected",        "stable NH absolute",
    "corotational",     "corotational projected",     "warped stiffness",
    "continued NH 0.9", "continued NH 0.9 projected", "linear"};

// Laws that are promised to do so from an exact line or point, too, with six components held.
const std::set<std::string> convex_enough{"corotational projected", "warped stiffness", "linear"};

// Whether a law is promised to come back to rest, nu = 0.3. The exact tangent of the corotational law has no
// bound where its rotation jumps: a line or a point are for the filtered one. Hexahedra have other equilibria
// near a line.
bool promised(const std::string& law, Discretisation d, Support support, Start start) {
  if (!stable_laws.contains(law) || d == Discretisation::quadratic) return false;
  const bool degenerate = start == Start::line || start == Start::point;
  if ((law == "corotational" || d == Discretisation::hexahedra) && degenerate) return false;
  return support == Support::nodes || convex_enough.contains(law);
}

class RecoveryTable {
 public:
  RecoveryTable(const Arguments& arguments, Claims& claims)
      : table_(
            arguments, "elements_recovery",
            "law,discretisation,body,nu,guided,support,start,noise,runs,recovered,newton_median,newton_max,"
            "linear_median,elsewhere,inside_out,saddle,not_converged,not_finite,energy_left,inverted_left,"
            "reason"),
        claims_(claims) {}

  struct Case {
    std::string law;
    Discretisation discretisation;
    const Body& body;
    double nu;
    bool guided = false;
  };
  Tally add(const Case& c, bool promised, Support support, Start start, double noise, const Tally& t) {
    table_.row(c.law, to_string(c.discretisation), c.body.name, c.nu, c.guided, to_string(support),
               to_string(start), noise, t.runs, t.recovered, Tally::median(t.newton),
               *std::max_element(t.newton.begin(), t.newton.end()), Tally::median(t.linear), t.elsewhere,
               t.inside_out, t.saddle, t.not_converged, t.not_finite, t.energy, t.inverted, t.reason());
    ++cells_;
    if (t.recovered == t.runs) ++safe_;
    if (promised)
      claims_.check(t.recovered == t.runs, c.law + " (" + text(c.discretisation) + ", " + c.body.name +
                                               ") comes back from " + text(start) + " with " + text(support));
    return t;
  }
  [[nodiscard]] int cells() const { return cells_; }
  [[nodiscard]] int safe() const { return safe_; }

 private:
  Table table_;
  Claims& claims_;
  int cells_ = 0, safe_ = 0;
};

// Every law and discretisation from every start.
void every_law(RecoveryTable& table, Claims& claims, bool short_form) {
  const int n = short_form ? 3 : 6, seeds = short_form ? 2 : 20;
  const Body tetrahedra("cube", cube(n, 0.2));
  const Body ten_nodes("cube", softsim::QuadraticTetrahedralMesh(cube(short_form ? 1 : 3, 0.2))),
      hexahedra("cube", softsim::box_hexahedra({short_form ? 2 : 4, short_form ? 2 : 4, short_form ? 2 : 4},
                                               {1, 1, 1}));
  for (const LawEntry& law : all_laws(0.3))
    for (const Discretisation d : law.discretisations) {
      const Body& body = d == Discretisation::quadratic   ? ten_nodes
                         : d == Discretisation::hexahedra ? hexahedra
                                                          : tetrahedra;
      const bool filtered = law.name.ends_with("projected") || law.name.ends_with("absolute");
      const bool fewer = filtered || d == Discretisation::hexahedra || d == Discretisation::quadratic;
      const int runs = !law.everywhere ? 2 : fewer ? std::max(2, seeds / 4) : seeds;
      const Elasticity elastic = law.make(body.mesh, d);
      for (const Support support : {Support::nodes, Support::components})
        for (const Start start : all_starts) {
          if (support == Support::components && start == Start::random) continue;
          const bool exact =
              support == Support::components && (start == Start::line || start == Start::point);
          const Tally t = table.add({law.name, d, body, 0.3}, promised(law.name, d, support, start), support,
                                    start, 0, attempt(body, elastic, support, start, runs));
          if (!law.everywhere && t.elsewhere > 0)
            claims.check(t.inverted == 0, law.name + " never says converged with inverted elements");
          // without forces as it is: moved by a millionth
          if (exact)
            table.add({law.name, d, body, 0.3}, false, support, start, 1e-6,
                      attempt(body, elastic, support, start, std::max(2, seeds / 4), 1e-6));
        }
    }
}

// Random starts over Poisson's ratio, as they are and after a solve with a corotational body of nu <= 0.3.
void over_poisson(RecoveryTable& table, bool short_form) {
  const Body body("cube", cube(short_form ? 3 : 4, 0.2));
  const int seeds = short_form ? 2 : 10;
  const std::vector<double> nus =
      short_form ? std::vector{0.3, 0.45} : std::vector{0.0, 0.2, 0.3, 0.4, 0.45, 0.49, 0.499};
  for (const double nu : nus) {
    const Elasticity first =
        tetrahedra(body.mesh, softsim::Corotational::from_young_poisson(1, std::min(nu, 0.3)));
    for (const LawEntry& law : all_laws(nu)) {
      const bool chosen = law.name == "stable NH" || law.name == "corotational" ||
                          law.name == "warped stiffness" || law.name == "continued NH" ||
                          law.name == "continued NH 0.9" || law.name == "neo-Hookean";
      if (!chosen || law.discretisations.front() != Discretisation::elastic) continue;
      const Elasticity elastic = law.make(body.mesh, Discretisation::elastic);
      for (const bool guided : {false, true})
        table.add({law.name, Discretisation::elastic, body, nu, guided}, guided, Support::nodes,
                  Start::random, 0,
                  attempt(body, elastic, Support::nodes, Start::random, seeds, 0, guided ? &first : nullptr));
    }
  }
}

// An irregular mesh of another shape.
void organ(RecoveryTable& table, bool short_form) {
  const Body body("organ", softsim::read_mesh(SOFTSIM_ORGAN));
  const int seeds = short_form ? 1 : 3;
  for (const LawEntry& law : all_laws(0.3)) {
    const bool chosen = law.name == "stable NH" || law.name == "corotational" ||
                        (!short_form && (law.name == "continued NH 0.9" || law.name == "warped stiffness"));
    if (!chosen || law.discretisations.front() != Discretisation::elastic) continue;
    const Elasticity elastic = law.make(body.mesh, Discretisation::elastic);
    for (const Start start : all_starts) {
      if (short_form && start != Start::random && start != Start::plane) continue;
      table.add({law.name, Discretisation::elastic, body, 0.3},
                promised(law.name, Discretisation::elastic, Support::nodes, start), Support::nodes, start, 0,
                attempt(body, elastic, Support::nodes, start, seeds));
    }
  }
}

void slivers(const Arguments& arguments, Claims& claims) {
  const bool short_form = arguments.short_form;
  Table table(arguments, "elements_slivers",
              "route,degrees,converged,newton,linear,answer_change,force_error,inverted,reason");
  const auto law = softsim::StableNeoHookean::from_young_poisson(1, 0.3);
  const int n = short_form ? 4 : 6;
  const Vec load(0.05, 0, -0.1);
  const Body good("good", cube(n));
  const LoadedCube reference = load_cube(good, tetrahedra(good.mesh, law), load);
  double worst_elastic = 0, worst_heml = 0;
  int linear = 0;
  for (const double degrees : {45.0, 10.0, 1.0, 0.1, 0.01, 0.001}) {
    const softsim::TetrahedralMesh mesh = degrees == 45 ? cube(n) : cube_with_sliver(n, degrees);
    const Body body("sliver", mesh);
    for (const Discretisation d : {Discretisation::elastic, Discretisation::heml}) {
      const Elasticity elastic = elasticity(body.mesh, law, d);
      const LoadedCube r = load_cube(body, elastic, load);
      const double change = (r.top - reference.top).norm() / reference.top.norm();
      const double error = force_error(mesh, law, elastic[0], r.q);
      const bool converged = r.report.status == softsim::Status::converged;
      table.row(to_string(d), degrees, converged, r.report.newton_iterations, r.report.linear_iterations,
                change, error, r.inverted, r.report.reason);
      claims.check(converged && r.inverted == 0 && change < 0.03,
                   "a sliver of " + std::to_string(degrees) + " degrees: converges, answer within 3 %");
      if (degrees < 0.1) continue;
      (d == Discretisation::heml ? worst_heml : worst_elastic) =
          std::max(error, d == Discretisation::heml ? worst_heml : worst_elastic);
      linear = r.report.linear_iterations;
    }
  }
  claims.check(worst_elastic < 1e-13 && worst_heml < 1e-11, "forces of slivers of 0.1 degrees keep digits");
  std::printf(
      "slivers: converged down to 0.001 degrees; at 0.1 degrees %d CG iterations for %d without; largest "
      "force "
      "error to there %.0e (elastic), %.0e (heml).\n",
      linear, reference.report.linear_iterations, worst_elastic, worst_heml);
}

void contrast(const Arguments& arguments, Claims& claims) {
  const bool short_form = arguments.short_form;
  Table table(arguments, "elements_contrast",
              "what,where,value,converged,newton,linear,top_x,top_z,inverted,reason");
  const Body body("cube", cube(short_form ? 4 : 8));
  const Vec load(0.02, 0, -0.05);
  int first = 0, most = 0, most_newton = 0;
  const auto add = [&](const std::string& what, const std::string& where, double value, bool promised,
                       const Elasticity& elastic) {
    const LoadedCube r = load_cube(body, elastic, load);
    const bool converged = r.report.status == softsim::Status::converged;
    table.row(what, where, value, converged, r.report.newton_iterations, r.report.linear_iterations, r.top[0],
              r.top[2], r.inverted, r.report.reason);
    if (promised)
      claims.check(converged && r.inverted == 0, what + " " + softsim::to_text(value) + ", " + where +
                                                     ": converges without inverted elements");
    return r.report;
  };
  for (const Stiff where : {Stiff::below, Stiff::above, Stiff::inclusion})
    for (const double ratio : {1.0, 10.0, 1e2, 1e3, 1e4, 1e5, 1e6}) {
      const auto report =
          add("stiffness ratio", text(where), ratio, true, two_stiffnesses(body, where, ratio));
      if (ratio == 1) first = report.linear_iterations;
      most = std::max(most, report.linear_iterations);
      most_newton = std::max(most_newton, report.newton_iterations);
    }
  std::printf(
      "stiffness ratio 1 to 1e6: all converge in up to %d Newton and %d CG iterations (ratio 1: %d).\n",
      most_newton, most, first);
  int plain = 0, averaged = 0;
  for (const bool stable : {true, false})
    for (const bool at_nodes : {false, true})
      for (const double nu : {0.3, 0.4, 0.45, 0.49, 0.499, 0.4999}) {
        const auto report =
            add("Poisson's ratio",
                std::string(stable ? "stable NH" : "neo-Hookean") + (at_nodes ? " nodal volume" : " linear"),
                nu, true, nearly_incompressible(body, stable, at_nodes, nu));
        int& iterations = at_nodes ? averaged : plain;
        iterations = std::max(iterations, report.linear_iterations);
      }
  std::printf(
      "Poisson's ratio 0.3 to 0.4999: up to %d CG iterations in a solve with linear tetrahedra, %d with "
      "volumes averaged at nodes.\n",
      plain, averaged);
}

void extremes(const Arguments& arguments, Claims& claims) {
  const bool short_form = arguments.short_form;
  Table table(arguments, "elements_extremes",
              "law,kind,steps,arrived,reached_degrees,reached_stretch,inverted,newton,linear,back,inverted_"
              "left,rest,reason");
  const Body body = bar(short_form ? 2 : 3);
  int safe = 0, all = 0;
  struct Kind {
    std::string name;
    Grip to;
    std::vector<int> steps;
  };
  const std::vector<Kind> kinds{
      {"one turn", {360, 1}, short_form ? std::vector{8} : std::vector{4, 8, 16}},
      {"two turns", {720, 1}, short_form ? std::vector{16} : std::vector{8, 16, 32, 64}},
      {"stretch", {0, 10}, short_form ? std::vector{16} : std::vector{1, 4, 16}},
      {"compression", {0, 0.05}, short_form ? std::vector{32} : std::vector{1, 8, 32}}};
  for (const LawEntry& law : all_laws(0.3)) {
    if (law.discretisations.front() != Discretisation::elastic) continue;
    if (short_form && law.name.ends_with("projected")) continue;
    const Elasticity elastic = law.make(body.mesh, Discretisation::elastic);
    for (const Kind& kind : kinds)
      for (const int steps : kind.steps) {
        const Excursion x = excursion(body, elastic, kind.to, steps);
        table.row(law.name, kind.name, steps, x.arrived, x.reached.degrees, x.reached.stretch, x.inverted,
                  x.newton, x.linear, x.back, x.left, x.rest, x.reason);
        ++all;
        const bool there_and_back = x.arrived && x.back && x.rest < 1e-6;
        if (there_and_back) ++safe;
        // a law that is not defined for inverted elements cannot slip; a filtered tangent converges too
        // slowly, and the exponential of I1 = 100 has lost its slope to rounding
        const bool exponential = law.name == "Fung" || law.name == "Veronda-Westmann";
        const bool never_inverts =
            !law.everywhere && !law.name.ends_with("projected") && !(exponential && kind.name == "stretch");
        const bool small_steps = kind.name == "stretch"       ? steps >= 16
                                 : kind.name == "compression" ? steps >= 32
                                                              : kind.to.degrees / steps <= 45;
        // the others come back from one turn; from two, some slip by a whole one
        const bool keeps_a_turn =
            kind.name == "one turn" && stable_laws.contains(law.name) && law.name != "linear";
        if (small_steps && (never_inverts || keeps_a_turn))
          claims.check(there_and_back && x.inverted == 0, law.name + ", " + kind.name + " in " +
                                                              std::to_string(steps) +
                                                              " steps: there and back, none inverted");
      }
  }
  std::printf(
      "one and two turns, 10 x stretch, 0.05 x compression: there and back to rest in %d of %d cells.\n",
      safe, all);
}

}  // namespace

int main(int argc, char** argv) {
  return run(argc, argv, [](const Arguments& arguments, Claims& claims) {
    const bool short_form = arguments.short_form;
    RecoveryTable table(arguments, claims);
    every_law(table, claims, short_form);
    over_poisson(table, short_form);
    organ(table, short_form);
    std::printf("recovery of rest: %d of %d cells (law, elements, start, support) are 100 %% safe.\n",
                table.safe(), table.cells());
    slivers(arguments, claims);
    contrast(arguments, claims);
    extremes(arguments, claims);
  });
}
