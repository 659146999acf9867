// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT

#include <algorithm>

#include "common.hpp"
#include "reference.hpp"

// One time step, or the equilibrium, of a cube of 0.1 m that is held at its face x = 0 and sags under
// gravity.

namespace bench {
namespace {

constexpr double side = 0.1;          // m
constexpr double density = 1000;      // kg/m^3
constexpr double implicit_dt = 0.01;  // s
constexpr int lead = 6;               // steps before the measured one, to start from a state in motion

// Far below the time a wave takes through an element: 2/omega_max is at least h/(4 c) for these tetrahedra.
double explicit_dt(int n) {
  const Lame lame = Lame::from_young_poisson(young, poisson);
  return 0.2 * side / n / std::sqrt((lame.lambda + 2 * lame.mu) / density);
}

template <class K>
using Body = System<ElasticTetrahedra<typename K::Law, typename K::T>, DeadLoad<typename K::T>>;

template <class K>
Body<K> make_body(int n) {
  using T = typename K::T;
  const TetrahedralMesh& mesh = cube(n, side);
  Body<K> body(mesh, elastic<T>(mesh, K::law()), gravity<T>(mesh, density, {0, 0, -9.81}));
  body.mass = Mass<T>::lumped(mesh, density);
  body.prescribed.fix(nodes_near(mesh, Side::xmin, 0));
  return body;
}

// What the reference kernel makes of a step from (q_0, v_0) to q_1, in double and packed.
template <class K>
struct StepCheck {
  using Law = typename K::Law;
  ReferenceBody<Law, double> body;
  Vector<double> rest, mass, load, free;

  explicit StepCheck(int n) : body(cube(n, side), K::law()) {
    const TetrahedralMesh& mesh = cube(n, side);
    rest = packed(field<double>(mesh, [](const Vec3<double>& X) { return X; }));
    mass = packed(Mass<double>::lumped(mesh, density).diagonal());
    load = packed(gravity<double>(mesh, density, {0, 0, -9.81}).force());
    free = Vector<double>::Ones(rest.size());
    for (std::ptrdiff_t k = 0; k < rest.size(); k += 3)
      if (rest[k] == 0) free.segment<3>(k).setZero();
  }

  // Total force at displacement u, zero where held.
  [[nodiscard]] Vector<double> force(const Vector<double>& u) const {
    Vector<double> g(u.size());
    body.force(rest + u, g);
    return free.cwiseProduct(load - g);
  }
  [[nodiscard]] double semi_explicit_error(const Motion<typename K::T>& a, const Motion<typename K::T>& b,
                                           double h) const {
    const Vector<double> u = packed(a.q.displacement), v = packed(a.v);
    const Vector<double> expected = v + h * force(u).cwiseQuotient(mass);
    return std::max(relative_error(packed(b.v), expected),
                    relative_error(packed(b.q.displacement), u + h * expected));
  }
  // |(M/h^2 + K) d - b| / |b| of the linearised step d.
  [[nodiscard]] double linearised_error(const Motion<typename K::T>& a, const Motion<typename K::T>& b,
                                        double h) const {
    const Vector<double> u = packed(a.q.displacement), d = packed(b.q.displacement) - u;
    const Vector<double> rhs = force(u) + mass.cwiseProduct(packed(a.v)) / h;
    Vector<double> Kd(d.size());
    body.product(rest + u, d, Kd);
    return (free.cwiseProduct(mass.cwiseProduct(d) / (h * h) + Kd) - rhs).norm() / rhs.norm();
  }
  // |residual of equilibrium| over the load.
  [[nodiscard]] double newton_error(const Motion<typename K::T>& a, const Motion<typename K::T>& b,
                                    double h) const {
    const Vector<double> u = packed(b.q.displacement), d = u - packed(a.q.displacement);
    const Vector<double> inertia = free.cwiseProduct(mass.cwiseProduct(d - h * packed(a.v))) / (h * h);
    return (inertia - force(u)).norm() / free.cwiseProduct(load).norm();
  }
};

template <class K>
struct SemiExplicitCase {
  using T = typename K::T;
  Body<K> body;
  SemiExplicitEuler<Body<K>> integrator;
  Motion<T> motion;
  Status status = Status::converged;
  double error = 0;

  explicit SemiExplicitCase(int n)
      : body(make_body<K>(n)), integrator({.dt = explicit_dt(n)}), motion(body.rest().size()) {
    for (int i = 0; i < lead; ++i) step();
    const Motion<T> start = motion;
    step();
    error = StepCheck<K>(n).semi_explicit_error(start, motion, explicit_dt(n));
  }
  // Every step costs the same: the motion goes on from step to step.
  void step() {
    if (const Status s = integrator.step(body, motion).status; s != Status::converged) status = s;
  }
};

template <class K, bool newton>
struct ImplicitCase {
  using T = typename K::T;
  static constexpr bool in_double = sizeof(T) == 8;
  // Rounding in single precision keeps the residual of equilibrium near 1e-3 of the load at the finest mesh.
  static constexpr double tolerance = newton && !in_double ? 1e-2 : 1e-6;
  // What the step asked for, and the rounding between its own residual and the reference's.
  static constexpr double allowed = in_double ? 1.01 * tolerance : newton ? 2 * tolerance : 1e-3;

  Body<K> body;
  BackwardEuler<Body<K>> integrator;
  Motion<T> start, motion;
  Status status = Status::converged;
  double error = 0;

  explicit ImplicitCase(int n)
      : body(make_body<K>(n)),
        integrator({.dt = implicit_dt, .newton = newton, .tolerance = tolerance}),
        start(body.rest().size()) {
    for (int i = 0; i < lead; ++i) {
      step();
      std::swap(start, motion);
    }
    step();
    const StepCheck<K> check(n);
    error = newton ? check.newton_error(start, motion, implicit_dt)
                   : check.linearised_error(start, motion, implicit_dt);
  }
  // From the same motion every time.
  void step() {
    motion = start;
    if (const Status s = integrator.step(body, motion).status; s != Status::converged) status = s;
  }
};

// The whole weight at once, from rest. St. Venant-Kirchhoff has no shape for it on fine meshes and says so.
template <class K>
struct StaticCase {
  static constexpr double allowed = 1.01e-6;
  Body<K> body;
  StaticSolver<Body<K>> solver{
      {.tolerance = 1e-6, .refuse_inversion = std::is_same_v<typename K::Law, StVenantKirchhoff>}};
  Motion<double> motion;
  Status status = Status::converged;
  double error = 0;

  explicit StaticCase(int n) : body(make_body<K>(n)), motion(body.rest().size()) {
    step();
    if (status == Status::converged) error = StepCheck<K>(n).newton_error(motion, motion, 1);
  }
  void step() {
    motion.q.displacement.setZero();
    status = solver.solve(body, motion.q).status;
  }
};

template <class K, class Case>
void add_step(const std::string& route, int n, double tolerance) {
  add("step", K(), route, n, [n, tolerance](benchmark::State& state) {
    auto& c = cached<Case>(n);
    measure(state, tetrahedra(n), c.error, tolerance, [&] { c.step(); });
    if (c.status == Status::not_converged && std::is_same_v<typename K::Law, StVenantKirchhoff>)
      state.SetLabel("not converged: every step would invert elements");
    else if (c.status != Status::converged)
      state.SkipWithError("a step did not converge");
  });
}

[[maybe_unused]] const bool registered = [] {
  for_each_kind_and_size([]<class K>(K, int n) {
    if constexpr (std::is_same_v<typename K::Law, NeoHookean>) {
      using Linearised = ImplicitCase<K, false>;
      using Newton = ImplicitCase<K, true>;
      // One step, from rounded positions: a little above the rounding of a force.
      add_step<K, SemiExplicitCase<K>>("semi_explicit", n, rounding<typename K::T>);
      add_step<K, Linearised>("backward_euler", n, Linearised::allowed);
      add_step<K, Newton>("backward_euler_newton", n, Newton::allowed);
    }
    if constexpr (std::is_same_v<typename K::T, double> &&
                  (std::is_same_v<typename K::Law, NeoHookean> ||
                   std::is_same_v<typename K::Law, StVenantKirchhoff>))
      add_step<K, StaticCase<K>>("static", n, StaticCase<K>::allowed);
  });
  return true;
}();

}  // namespace
}  // namespace bench
