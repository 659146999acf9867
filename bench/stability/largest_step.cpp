// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "largest_step.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>

#include "program.hpp"
#include "softsim/integrator/runge_kutta.hpp"
#include "softsim/integrator/semi_explicit_euler.hpp"
#include "softsim/integrator/velocity_verlet.hpp"
#include "softsim/material/linear_elastic.hpp"
#include "softsim/material/neo_hookean.hpp"
#include "softsim/material/st_venant_kirchhoff.hpp"
#include "softsim/material/stable_neo_hookean.hpp"
#include "softsim/mesh/generators.hpp"
#include "softsim/mesh/selection.hpp"
#include "softsim/potential/elastic.hpp"
#include "softsim/potential/spring.hpp"
#include "softsim/solver/element_eigenvalue_bound.hpp"

// The largest step with which a small random perturbation stays bounded, against `stable_step`, the element
// bound and the shortest height over the wave speed; and what finite amplitudes make of it.

namespace {

using namespace softsim;
using namespace atlas;
using std::string;

constexpr double E = 1e4, nu = 0.4, rho = 1000;  // Pa, 1, kg/m^3

struct Case {
  int n;  // cells along the cube's side
  string law, mass, damping_name;
  bool promised = true;  // the prediction is the linear theory's at rest
  double amplitude = 1e-9;
};

class Steps {
 public:
  Steps(const Arguments& arguments, Claims& claims)
      : arguments_(arguments),
        claims_(claims),
        csv_(arguments, "largest_step",
             "tetrahedra,law,mass,damping,amplitude,integrator,predicted,observed_over_predicted,"
             "element_over_predicted,height_over_predicted") {}

  template <class S>
  void run(const TetrahedralMesh& mesh, S system, const Case& c) {
    const State<double> rest(mesh.points().size());
    const EigenvalueReport found = largest_eigenvalue(system, rest);
    if (found.status != Status::converged) return claims_.check(false, "no largest eigenvalue");
    const double omega = found.omega();
    const double height = shortest_height(mesh);
    if (c.damping_name == "alpha" || c.damping_name == "both") system.damping.alpha = omega / 4;
    if (c.damping_name == "beta" || c.damping_name == "both") system.damping.beta = 0.4 / omega;
    const bool damped = c.damping_name != "none";
    // Height over wave speed as a step, and that of the element bound, both of 2/omega kind.
    const double speed = std::sqrt(E * (1 - nu) / ((1 + nu) * (1 - 2 * nu)) / rho);
    const double element =
        system.mass.is_lumped() ? omega / std::sqrt(element_eigenvalue_bound(system, rest)) : NAN;
    const double heights = height / speed / (2 / omega);
    if (system.mass.is_lumped() && c.promised)
      claims_.check(element <= 1 + 1e-6, c.law + ": the element bound is not one");
    const auto check = [&](const string& name, auto integrator) {
      const double predicted = stable_step(system, rest, integrator);
      if (!(predicted > 0) || !(predicted < 1e300))
        return claims_.check(false, c.law + ", " + name + ": no stable step predicted");
      const int steps = damped ? 4000 : 1500;
      const double ratio = observed_over_predicted(system, integrator, predicted, omega, c.amplitude / c.n,
                                                   steps, arguments_.short_form ? 0.02 : 0.005);
      csv_ << mesh.tetrahedra().size() << ',' << c.law << ',' << c.mass << ',' << c.damping_name << ','
           << c.amplitude << ',' << name << ',' << predicted << ',' << ratio << ',' << element << ','
           << heights << '\n';
      csv_.flush();
      std::printf("%6zu %-18s %-10s %-5s amplitude %-6.3g %-20s %.4e s, observed over that %.3f\n",
                  mesh.tetrahedra().size(), c.law.c_str(), c.mass.c_str(), c.damping_name.c_str(),
                  c.amplitude, name.c_str(), predicted, ratio);
      if (c.promised)
        claims_.check(ratio >= 0.9 && ratio <= 1.1,
                      c.law + ", " + c.damping_name + ", " + name + ": observed over predicted step");
    };
    std::printf("%6zu %-18s element bound gives %.3f, shortest height over wave speed %.3f of 2/omega\n",
                mesh.tetrahedra().size(), c.law.c_str(), element, heights);
    check("semi-explicit Euler", SemiExplicitEuler<S>({.dt = 1}));
    check("velocity Verlet", VelocityVerlet<S>({.dt = 1}));
    if (!c.promised) return;
    check("RK4", RungeKutta<S>({.dt = 1}));
    if (arguments_.short_form && c.damping_name == "none") return;
    check("RK3 Kutta", RungeKutta<S>({.dt = 1, .tableau = ButcherTableau::kutta3()}));
    if (!damped) return;
    // Without beta damping the lowest and the highest frequencies leave little room, which shows only after
    // many steps.
    check("explicit Euler", ExplicitEuler<S>({.dt = 1}));
    check("RK2 midpoint", RungeKutta<S>({.dt = 1, .tableau = ButcherTableau::midpoint()}));
  }

 private:
  const Arguments& arguments_;
  Claims& claims_;
  Table csv_;
};

template <class Term>
System<Term> body(const TetrahedralMesh& mesh, Term term, bool lumped) {
  System<Term> system(mesh, std::move(term));
  system.mass = lumped ? Mass<double>::lumped(mesh, rho) : Mass<double>::consistent(mesh, rho);
  system.prescribed.fix(nodes_near(mesh, Side::zmin, 0));
  return system;
}

}  // namespace

int main(int argc, char** argv) {
  return atlas::run(argc, argv, [](const Arguments& arguments, Claims& claims) {
    Steps steps(arguments, claims);
    const auto cube = [](int n) { return box_mesh({n, n, n}, {1, 1, 1}); };
    const int n = arguments.short_form ? 3 : 6;
    const TetrahedralMesh mesh = cube(n);
    const auto law = [&](const string& name, const auto& material) {
      for (const string damping : {"none", "alpha", "beta", "both"}) {
        if (arguments.short_form && damping != "none" && !(name == "neo_hookean" && damping == "both"))
          continue;
        steps.run(mesh, body(mesh, elastic(mesh, material), true), {n, name, "lumped", damping});
      }
      for (const double amplitude : {0.02, 0.05, 0.1, 0.2, 0.3}) {
        if (arguments.short_form && amplitude != 0.1) continue;
        steps.run(mesh, body(mesh, elastic(mesh, material), true),
                  {n, name, "lumped", "none", false, amplitude});
      }
    };
    law("neo_hookean", NeoHookean::from_young_poisson(E, nu));
    law("st_venant_kirchhoff", StVenantKirchhoff::from_young_poisson(E, nu));
    law("stable_neo_hookean", StableNeoHookean::from_young_poisson(E, nu));
    law("linear", LinearElastic::from_young_poisson(E, nu));
    steps.run(mesh, body(mesh, van_gelder_springs(mesh, E), true), {n, "springs", "lumped", "none"});
    steps.run(mesh, body(mesh, elastic(mesh, NeoHookean::from_young_poisson(E, nu)), false),
              {n, "neo_hookean", "consistent", "none"});
    if (arguments.short_form) return;
    for (const int larger : {12, 26}) {  // 10,368 and 105,456 tetrahedra
      const TetrahedralMesh fine = cube(larger);
      steps.run(fine, body(fine, elastic(fine, NeoHookean::from_young_poisson(E, nu)), true),
                {larger, "neo_hookean", "lumped", "none"});
    }
  });
}
