// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <ctime>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "program.hpp"
#include "softsim/integrator/energy_momentum.hpp"
#include "softsim/integrator/implicit.hpp"
#include "softsim/integrator/runge_kutta.hpp"
#include "softsim/integrator/semi_explicit_euler.hpp"
#include "softsim/integrator/stable_step.hpp"
#include "softsim/integrator/velocity_verlet.hpp"
#include "softsim/material/neo_hookean.hpp"
#include "softsim/mesh/generators.hpp"
#include "softsim/mesh/selection.hpp"
#include "softsim/potential/elastic.hpp"
#include "softsim/system/system.hpp"

// What every integrator makes of a stiff bar at steps from far below to far above what resolves its motion:
// whether it converges, its energy, error and time; orders of accuracy; and drift over very many steps.

namespace {

using namespace softsim;
using namespace atlas;
using std::string;
using S = System<ElasticTetrahedra<NeoHookean>>;

constexpr double duration = 0.25;  // s, at which errors are taken

// A clamped bar of Neo-Hookean material, 1 m long, flicked sideways at its free end.
struct Bar {
  S system;
  double velocity;  // of the tip, m/s

  Bar(const std::array<int, 3>& cells, double thickness, double E, double nu, double rho, double tip)
      : system(make(box_mesh(cells, {1, thickness, thickness}), E, nu, rho)), velocity(tip) {}
  [[nodiscard]] Motion<double> start() const {
    Motion<double> motion(system.rest().size());
    for (std::size_t i = 0; i < system.rest().size(); ++i) {
      const double x = system.rest()[i][0];
      block(motion.v, static_cast<std::ptrdiff_t>(i)) = velocity * x * x * Vec3<double>(0.1, 0, -1);
    }
    return motion;
  }
  [[nodiscard]] double energy(const Motion<double>& motion) const {
    return system.energy(motion.q) + system.kinetic_energy(motion.v);
  }

 private:
  static S make(const TetrahedralMesh& mesh, double E, double nu, double rho) {
    S system(mesh, elastic(mesh, NeoHookean::from_young_poisson(E, nu)));
    system.mass = Mass<double>::lumped(mesh, rho);
    system.prescribed.fix(nodes_near(mesh, Side::xmin, 0));
    return system;
  }
};

// The motion after `duration` in so many steps; throws if a step does not converge.
template <class I>
Motion<double> after(const Bar& bar, I integrator, int steps) {
  integrator.set_dt(duration / steps);
  Motion<double> motion = bar.start();
  for (int n = 0; n < steps; ++n)
    if (const StepReport report = integrator.step(bar.system, motion); report.status != Status::converged)
      throw std::runtime_error(string(report.reason));
  return motion;
}
// RK4 with two steps, extrapolated.
Motion<double> reference(const Bar& bar, int steps) {
  const RungeKutta<S> rk4({.dt = 1});
  const Motion<double> coarse = after(bar, rk4, steps);
  Motion<double> fine = after(bar, rk4, 2 * steps);
  fine.q.displacement += (fine.q.displacement - coarse.q.displacement) / 15;
  fine.v += (fine.v - coarse.v) / 15;
  return fine;
}
double displacement_error(const Motion<double>& a, const Motion<double>& exact) {
  return (a.q.displacement - exact.q.displacement).norm() / exact.q.displacement.norm();
}
// That and the relative error of the velocity. (By its displacement alone semi-explicit Euler is of second
// order from a start without acceleration.)
double error(const Motion<double>& a, const Motion<double>& exact) {
  return displacement_error(a, exact) + (a.v - exact.v).norm() / exact.v.norm();
}
// CPU time of this thread, s: the wall clock of a shared machine counts others' work.
double seconds() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

enum Kind { explicit_method, linearised, converged };
constexpr std::array<const char*, 3> kind_names{"explicit", "linearised", "Newton"};

// Calls f(name, kind, integrator, order of accuracy).
template <class Function>
void for_each_method(double tolerance, Function f) {
  f("explicit Euler", explicit_method, ExplicitEuler<S>({.dt = 1}), 1);
  f("semi-explicit Euler", explicit_method, SemiExplicitEuler<S>({.dt = 1}), 1);
  f("velocity Verlet", explicit_method, VelocityVerlet<S>({.dt = 1}), 2);
  f("RK2 midpoint", explicit_method, RungeKutta<S>({.dt = 1, .tableau = ButcherTableau::midpoint()}), 2);
  f("RK2 Heun", explicit_method, RungeKutta<S>({.dt = 1, .tableau = ButcherTableau::heun()}), 2);
  f("RK3 Kutta", explicit_method, RungeKutta<S>({.dt = 1, .tableau = ButcherTableau::kutta3()}), 3);
  f("RK4", explicit_method, RungeKutta<S>({.dt = 1}), 4);
  const auto implicit = [&](const string& name, auto scheme, int order) {
    for (const bool newton : {false, true})
      f(name, newton ? converged : linearised,
        Implicit<decltype(scheme), S>({.dt = 1, .scheme = scheme, .newton = newton, .tolerance = tolerance}),
        order);
  };
  implicit("backward Euler", Theta(), 1);
  implicit("implicit midpoint", Midpoint(), 2);
  implicit("trapezoidal", Trapezoidal(), 2);
  implicit("BDF2", Bdf2(), 2);
  implicit("Newmark 1/4 1/2", NewmarkScheme(), 2);
  implicit("Newmark 0.4 0.7", NewmarkScheme(0.4, 0.7), 1);
  implicit("HHT -0.1", HhtScheme(-0.1), 2);
  implicit("generalised-alpha 0.8", GeneralisedAlphaScheme(0.8), 2);
  f("energy-momentum", converged, EnergyMomentum<S>({.dt = 1, .tolerance = tolerance}), 2);
}

void sweep_steps(const Arguments& arguments, Claims& claims) {
  Table csv(arguments, "step_sizes",
            "method,kind,step,steps,simulated,outcome,not_converged,energy_ratio,largest_energy_ratio,error,"
            "seconds_to_error,linear_iterations_a_step");
  const Bar bar({arguments.short_form ? 5 : 10, 1, 1}, 0.1, 1e6, 0.4, 1000, 1);
  const Motion<double> exact = reference(bar, arguments.short_form ? 512 : 1024);
  const double at_rest_limit =
      stable_step(bar.system, State<double>(bar.system.rest().size()), SemiExplicitEuler<S>({.dt = 1}));
  std::printf("bar: largest stable step of semi-explicit Euler %.3g s\n", at_rest_limit);
  const int cap = arguments.short_form ? 64 : 2048;
  const int finest = arguments.short_form ? 9 : 14;  // steps of 0.25 s/2^finest: 15 us
  for_each_method(1e-7, [&](const string& name, Kind kind, auto integrator, int) {
    string outcomes;
    for (int k = -2; k <= finest; ++k) {
      const double h = duration / std::pow(2.0, k), start_energy = bar.energy(bar.start());
      const int steps = static_cast<int>(std::min<double>(cap, std::ceil(10 / h)));
      const int at_error = k >= 0 ? 1 << k : -1;
      auto fresh = integrator;
      fresh.set_dt(h);
      Motion<double> motion = bar.start();
      double largest = 1, energy = 1, spent = NAN, wrong = NAN;
      int bad = 0, n = 0;
      long iterations = 0;
      bool diverged = false;
      const double begin = seconds();
      while (n < steps && !diverged) {
        const StepReport report = fresh.step(bar.system, motion);
        ++n;
        iterations += report.linear_iterations;
        if (report.status == Status::not_finite) {
          diverged = true;
          break;
        }
        bad += report.status != Status::converged;
        energy = bar.energy(motion) / start_energy;
        largest = std::max(largest, energy);
        diverged = !(energy < 1e3);
        if (n == at_error) {
          spent = seconds() - begin;
          if (!diverged) wrong = displacement_error(motion, exact);
        }
      }
      const char* outcome = diverged ? "diverged" : bad > 0 ? "not converged" : "converged";
      outcomes += diverged ? 'x' : bad > 0 ? '?' : '.';
      csv << name << ',' << kind_names[kind] << ',' << h << ',' << n << ',' << n * h << ',' << outcome << ','
          << bad << ',' << energy << ',' << largest << ',' << wrong << ',' << spent << ','
          << static_cast<double>(iterations) / n << '\n';
      if (name == "backward Euler" && kind == converged && bad == 0)
        claims.check(largest <= 1 + 1e-5, name + ": the energy grew");
      // a step that fails says so; nothing that says it converged may blow up
      if (kind == converged && name != "trapezoidal" && name.find("Newmark") == string::npos &&
          name.find("HHT") == string::npos && name.find("alpha") == string::npos)
        claims.check(!diverged || bad > 0, name + ": diverged though every step converged");
      if (kind == explicit_method && name != "explicit Euler" && name.find("RK2") == string::npos &&
          h < 0.5 * at_rest_limit)
        claims.check(!diverged, name + ": diverged at half of its stable step");
    }
    std::printf(
        "%-22s %-10s steps from 1 s down by halves: %s   (. converged, ? not converged, x diverged)\n",
        name.c_str(), kind_names[kind], outcomes.c_str());
  });
}

void check_orders(const Arguments& arguments, Claims& claims) {
  Table csv(arguments, "orders", "method,kind,steps,error,finer_error,order,theory");
  const Bar bar({4, 1, 1}, 0.3, 150, 0.3, 10, 0.5);
  const Motion<double> exact = reference(bar, 640);
  for_each_method(1e-10, [&](const string& name, Kind kind, auto integrator, int order) {
    const int steps = order == 1 ? 160 : name == "BDF2" ? 80 : 40;
    const double coarse = error(after(bar, integrator, steps), exact),
                 fine = error(after(bar, integrator, 2 * steps), exact);
    const double seen = std::log2(coarse / fine);
    csv << name << ',' << kind_names[kind] << ',' << steps << ',' << coarse << ',' << fine << ',' << seen
        << ',' << order << '\n';
    std::printf("%-22s %-10s error %.2e in %d steps, order %.3f\n", name.c_str(), kind_names[kind], coarse,
                steps, seen);
    claims.check(std::abs(seen - order) < 0.1, name + ' ' + kind_names[kind] + ": order of accuracy");
  });
}

// Energy and momenta of a free body that spins and vibrates.
void check_drift(const Arguments& arguments, Claims& claims) {
  Table csv(arguments, "drift", "method,step,steps,energy,momentum,angular_momentum");
  const TetrahedralMesh mesh = box_mesh({1, 1, 1}, {0.1, 0.1, 0.1});
  S system(mesh, elastic(mesh, NeoHookean::from_young_poisson(1e4, 0.3)));
  system.mass = Mass<double>::lumped(mesh, 1000);
  const State<double> rest(mesh.points().size());
  const double limit = stable_step(system, rest, VelocityVerlet<S>({.dt = 1}));
  const int steps = arguments.short_form ? 1000 : 1000000;
  struct Sums {
    double energy;
    Vec3<double> momentum, angular;
  };
  const auto sums = [&](const Motion<double>& motion) {
    Sums s{system.energy(motion.q) + system.kinetic_energy(motion.v), Vec3<double>::Zero(),
           Vec3<double>::Zero()};
    for (std::size_t i = 0; i < mesh.points().size(); ++i) {
      const auto k = static_cast<std::ptrdiff_t>(i);
      const Vec3<double> x = mesh.points()[i] + motion.q.point(k);
      const Vec3<double> p = system.mass.diagonal()[block_stride * k] * block(motion.v, k);
      s.momentum += p;
      s.angular += x.cross(p);
    }
    return s;
  };
  const auto run = [&](const string& name, auto integrator, double h, double energy_band, double momenta) {
    integrator.set_dt(h);
    Motion<double> motion(mesh.points().size());
    for (std::size_t i = 0; i < mesh.points().size(); ++i) {
      const Vec3<double> x = mesh.points()[i];
      block(motion.v, static_cast<std::ptrdiff_t>(i)) =
          Vec3<double>(0, 1, 2).cross(x) + Vec3<double>(2 * x[0], -x[1], 3 * x[2] * x[0]);
    }
    // The body stays where it is: after a way of many lengths displacements have no digits left for a strain.
    const Vec3<double> mean = sums(motion).momentum / system.mass.total();
    double size = 0;  // of the momenta of the parts, which the momentum, now 0, is measured against
    for (std::size_t i = 0; i < mesh.points().size(); ++i) {
      const auto k = static_cast<std::ptrdiff_t>(i);
      block(motion.v, k) -= mean;
      size += system.mass.diagonal()[block_stride * k] * block(motion.v, k).norm();
    }
    const Sums start = sums(motion);
    double worst_energy = 0, worst_momenta = 0;
    int next = 1, bad = 0;
    for (int n = 1; n <= steps; ++n) {
      bad += integrator.step(system, motion).status != Status::converged;
      if (n < next && n != steps) continue;
      next = std::max(next + 1, static_cast<int>(1.3 * next));
      const Sums now = sums(motion);
      const double e = now.energy / start.energy - 1, p = now.momentum.norm() / size,
                   l = (now.angular - start.angular).norm() / start.angular.norm();
      csv << name << ',' << h << ',' << n << ',' << e << ',' << p << ',' << l << '\n';
      worst_energy = std::max(worst_energy, std::abs(e));
      worst_momenta = std::max({worst_momenta, p, l});
    }
    std::printf(
        "%-34s %7d steps of %.2g s: energy within %.1e, momenta within %.1e, %d steps not converged\n",
        name.c_str(), steps, h, worst_energy, worst_momenta, bad);
    claims.check(worst_energy < energy_band, name + ": energy");
    claims.check(worst_momenta < momenta, name + ": momenta");
  };
  const double h = 0.2 * limit, large = 2 * limit;
  run("semi-explicit Euler", SemiExplicitEuler<S>({.dt = 1}), h, 0.2, 1e-14 * steps);
  run("velocity Verlet", VelocityVerlet<S>({.dt = 1}), h, 0.05, 1e-14 * steps);
  // what Newton's tolerance leaves adds up
  run("implicit midpoint", ImplicitMidpoint<S>({.dt = 1, .newton = true, .tolerance = 1e-11}), large, 0.5,
      1e-11 * steps);
  run("energy-momentum", EnergyMomentum<S>({.dt = 1, .tolerance = 1e-11}), large, 1e-11 * steps,
      1e-11 * steps);
}

}  // namespace

int main(int argc, char** argv) {
  return atlas::run(argc, argv, [](const Arguments& arguments, Claims& claims) {
    check_orders(arguments, claims);
    check_drift(arguments, claims);
    sweep_steps(arguments, claims);
  });
}
