// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "potential/bodies.hpp"
#include "softsim/integrator/implicit.hpp"
#include "softsim/integrator/semi_explicit_euler.hpp"
#include "softsim/integrator/static_solver.hpp"
#include "softsim/material/linear_elastic.hpp"
#include "softsim/material/neo_hookean.hpp"
#include "softsim/mesh/selection.hpp"
#include "softsim/potential/dead_load.hpp"
#include "softsim/potential/elastic.hpp"
#include "softsim/potential/prony.hpp"
#include "softsim/system/system.hpp"

// A cube with a Prony series, its history kept per node or per element. Without mass a step of backward Euler
// is a quasi-static one.

namespace viscoelastic_test {

using bodies::Matrix, bodies::Vec;
using softsim::BackwardEuler, softsim::DeadLoad, softsim::Motion, softsim::NeoHookean, softsim::PronySeries,
    softsim::PronyUpdate, softsim::Side, softsim::State, softsim::StaticResponse, softsim::Status,
    softsim::System, softsim::Vector;

const auto mesh = bodies::distorted_cube(2, 1);
const std::size_t points = mesh.points().size();
const auto law = NeoHookean::from_young_poisson(10, 0.3);
const PronySeries series({{0.2, 0.8}, {0.15, 0.3}});

using Elastic = softsim::ElasticTetrahedra<NeoHookean>;
using Nodes = softsim::PronyNodes<Elastic>;
using Tetrahedra = softsim::PronyTetrahedra<NeoHookean>;
static_assert(softsim::Potential<Nodes> && softsim::Potential<Tetrahedra>);
static_assert(System<Nodes>::has_memory && System<Tetrahedra>::has_memory);
static_assert(!System<Elastic, DeadLoad<double>>::has_memory);
// A law without second Piola-Kirchhoff stress has no objective history.
template <class M>
concept HasStressHistory = requires(const M& m) {
  softsim::prony_elements(mesh, m, series);
};
static_assert(HasStressHistory<NeoHookean> && !HasStressHistory<softsim::LinearElastic>);

Nodes nodes(const PronySeries& s, StaticResponse response = StaticResponse::instantaneous) {
  Nodes term = softsim::prony_nodes(softsim::elastic(mesh, law), points, s);
  term.static_response = response;
  return term;
}
Tetrahedra tetrahedra(const PronySeries& s, StaticResponse response = StaticResponse::instantaneous) {
  return softsim::prony_elements(mesh, law, s, response);
}
// f(term maker, name) for both kinds.
template <class Function>
void for_both(Function f) {
  {
    SCOPED_TRACE("history per node");
    f([](auto... arguments) { return nodes(arguments...); });
  }
  {
    SCOPED_TRACE("history per element");
    f([](auto... arguments) { return tetrahedra(arguments...); });
  }
}

template <class S>
void put_on_rollers(S& system) {
  for (int axis = 0; axis < 3; ++axis)
    for (const std::int32_t i : softsim::nodes_near(mesh, static_cast<Side>(2 * axis), 0))
      system.prescribed.set(i, axis, 0);
}
template <class S>
void hold(S& system, const State<double>& q) {
  for (std::size_t i = 0; i < points; ++i)
    system.prescribed.set(static_cast<std::int32_t>(i), q.point(static_cast<std::ptrdiff_t>(i)));
}
template <class S>
double reaction(const S& system, const State<double>& q) {
  const Vector<double> g = bodies::gradient(system, q);
  double sum = 0;
  for (const std::int32_t i : softsim::nodes_near(mesh, Side::xmax, 0)) sum += softsim::block(g, i)[0];
  return sum;
}
template <class S>
void run(S& system, Motion<double>& motion, double dt, int steps, double tolerance = 1e-11) {
  BackwardEuler<S> integrator({.dt = dt, .newton = true, .tolerance = tolerance});
  for (int n = 0; n < steps; ++n) {
    const auto report = integrator.step(system, motion);
    ASSERT_EQ(report.status, Status::converged) << report.reason;
  }
}

// Pulled to 1.5 of its length and held: lateral sides stay where they are, the force relaxes. Returns the
// largest difference to the relaxation function over one second.
template <class Make>
double relaxation_error(Make make, const PronySeries& s, int steps) {
  System system(mesh, make(s));
  put_on_rollers(system);
  for (const std::int32_t i : softsim::nodes_near(mesh, Side::xmax, 0)) system.prescribed.set(i, 0, 0.5);
  Motion<double> motion(points);
  const auto report = softsim::StaticSolver<decltype(system)>({.tolerance = 1e-11}).solve(system, motion.q);
  EXPECT_EQ(report.status, Status::converged);
  const double P = 3.7828017639;  // closed form, uniaxial
  EXPECT_NEAR(reaction(system, motion.q), P, 1e-9);
  double error = 0;
  for (int n = 1; n <= steps; ++n) {
    run(system, motion, 1.0 / steps, 1);
    error = std::max(error, std::abs(reaction(system, motion.q) / P - s.relaxation(n * 1.0 / steps)));
  }
  return error;
}

TEST(Viscoelastic, RelaxesAtAHeldStretch) {
  for_both([](auto make) {
    // exact: the elastic force is constant, ten digits of P are given
    EXPECT_LT(relaxation_error(make, series, 7), 1e-9);
    const PronySeries paper({{0.2, 0.8}, {0.15, 0.5}}, PronyUpdate::first_order);
    const double coarse = relaxation_error(make, paper, 50), fine = relaxation_error(make, paper, 100);
    EXPECT_LT(fine, 1e-3);
    EXPECT_NEAR(coarse / fine, 2, 0.05);
  });
}

// Under a load held from t = 0 on a small-strain body creeps like 1/(1 - a) - a/(1 - a) exp(-(1 - a) t/tau).
template <class Make>
double creep_error(Make make, PronyUpdate update, int steps) {
  const double a = 0.4, tau = 0.7;
  DeadLoad<double> load(points);
  load.spread(softsim::nodes_near(mesh, Side::xmax, 0), {2e-5, 0, -1e-5});
  System system(mesh, make(PronySeries({{a, tau}}, update)), load);
  system.prescribed.fix(softsim::nodes_near(mesh, Side::xmin, 0));
  Motion<double> motion(points);
  const double tolerance = 1e-8;  // such small loads come with rounding of 1e-10 of them
  const auto report =
      softsim::StaticSolver<decltype(system)>({.tolerance = tolerance}).solve(system, motion.q);
  EXPECT_EQ(report.status, Status::converged);
  const State<double> start = motion.q;
  run(system, motion, 1.0 / steps, steps, tolerance);
  const double exact = 1 / (1 - a) - a / (1 - a) * std::exp(-(1 - a) / tau);
  return bodies::relative_error(motion.q.displacement, exact * start.displacement);
}

TEST(Viscoelastic, CreepsUnderAHeldLoad) {
  for_both([](auto make) {
    const double first = creep_error(make, PronyUpdate::first_order, 20);
    EXPECT_NEAR(first / creep_error(make, PronyUpdate::first_order, 40), 2, 0.05);
    // strains of 1e-6 leave the error of the small-strain formula far below
    const double second = creep_error(make, PronyUpdate::exponential, 5);
    EXPECT_LT(second, 0.1 * first);
    EXPECT_NEAR(second / creep_error(make, PronyUpdate::exponential, 10), 4, 0.1);
  });
}

// Every history is a multiple of the elastic force (stress) as long as the shape is held. The stress turns
// with the body; the nodal forces that have relaxed stay where they were.
TEST(Viscoelastic, OnlyTheHistoryPerElementTurnsWithTheBody) {
  const State<double> rest_shape = bodies::random_state(points, 0.05, 3);
  const auto turned = [&](double angle) {
    const Matrix R = Eigen::AngleAxisd(angle, Vec(1, 2, 3).normalized()).toRotationMatrix();
    State<double> q(points);
    for (std::size_t i = 0; i < points; ++i)
      q.point(static_cast<std::ptrdiff_t>(i)) = R * bodies::position(mesh, rest_shape, i) - mesh.points()[i];
    return q;
  };
  for_both([&](auto make) {
    System system(mesh, make(series));
    const State<double> q_0 = turned(0), q_1 = turned(2);
    Motion<double> motion(points);
    motion.q = q_0;
    const Vector<double> f_1 = bodies::gradient(softsim::elastic(mesh, law), q_1);
    for (int n = 1; n <= 10; ++n) {
      hold(system, turned(0.2 * n));
      run(system, motion, 0.1, 1);
    }
    const double error =
        bodies::relative_error(bodies::gradient(system, motion.q), series.relaxation(1) * f_1);
    if constexpr (std::is_same_v<decltype(make(series)), Tetrahedra>) {
      EXPECT_LT(error, 1e-12);
    } else {
      EXPECT_GT(error, 0.1);
    }
  });
}

// During a step: gradient = dE/dq, Hessian = d gradient/dq by central differences of 1e-5 (error 1e-10 of the
// third derivative, rounding 1e-11), and the blocks are the product's.
TEST(Viscoelastic, StepsHaveAConsistentPotential) {
  for_both([&](auto make) {
    System system(mesh, make(series));
    const Vector<double> v = Vector<double>::Zero(system.size());
    for (std::uint64_t n = 0; n < 3; ++n) {
      system.begin_step(bodies::random_state(points, 0.04, 10 + n), v, 0.1);
      system.end_step(bodies::random_state(points, 0.04, 11 + n), v, 0.1);
    }
    const State<double> q_0 = bodies::random_state(points, 0.04, 20);
    system.begin_step(q_0, v, 0.2);
    const Vector<double> d = bodies::random_vector(points, 1, 30);
    const double h = 1e-5;
    State<double> q = bodies::random_state(points, 0.04, 21), plus = q, minus = q;
    softsim::retract(plus, d, h);
    softsim::retract(minus, d, -h);
    const Vector<double> g = bodies::gradient(system, q), K_d = bodies::hessian_product(system, q, d);
    EXPECT_NEAR((system.energy(plus) - system.energy(minus)) / (2 * h) / g.dot(d), 1, 1e-7);
    const Vector<double> difference =
        (bodies::gradient(system, plus) - bodies::gradient(system, minus)) / (2 * h);
    EXPECT_LT(bodies::relative_error(K_d, difference), 1e-7);
    softsim::AssembledTangent<decltype(system)> tangent;
    tangent.set(system, q, {.stiffness = 1});
    Vector<double> product = Vector<double>::Zero(system.size());
    tangent.apply(d, product);
    EXPECT_LT(bodies::relative_error(product, K_d), 1e-13);
    // A failed step is begun again without a trace.
    system.begin_step(q_0, v, 0.05);
    system.begin_step(q_0, v, 0.2);
    EXPECT_EQ(bodies::gradient(system, q), g);
    // The end of the step has the forces that its potential had there.
    system.end_step(q, v, 0.2);
    EXPECT_LT(bodies::relative_error(bodies::gradient(system, q), g), 1e-12);
  });
}

// Quadratic: with a tight tolerance a large step takes no more than a few iterations.
TEST(Viscoelastic, ImplicitStepsConvergeFast) {
  for_both([&](auto make) {
    System system(mesh, make(series), softsim::gravity(mesh, 1, {0, 0, -1}));
    system.mass = softsim::Mass<double>::lumped(mesh, 1);
    system.prescribed.fix(softsim::nodes_near(mesh, Side::xmin, 0));
    Motion<double> motion(points);
    BackwardEuler<decltype(system)> integrator({.dt = 0.3, .newton = true, .tolerance = 1e-11});
    for (int n = 0; n < 5; ++n) {
      const auto report = integrator.step(system, motion);
      ASSERT_EQ(report.status, Status::converged) << report.reason;
      EXPECT_LE(report.newton_iterations, 7);
    }
  });
}

TEST(Viscoelastic, ExplicitStepsRelaxExactlyToo) {
  for_both([&](auto make) {
    System system(mesh, make(series));
    system.mass = softsim::Mass<double>::lumped(mesh, 1);
    Motion<double> motion(points);
    motion.q = bodies::random_state(points, 0.05, 4);
    hold(system, motion.q);
    const Vector<double> f = bodies::gradient(system, motion.q);
    softsim::SemiExplicitEuler<decltype(system)> integrator({.dt = 0.05});
    for (int n = 0; n < 10; ++n) ASSERT_EQ(integrator.step(system, motion).status, Status::converged);
    EXPECT_LT(bodies::relative_error(bodies::gradient(system, motion.q), series.relaxation(0.5) * f), 1e-13);
    // Another shape, all at once: its force is the difference times one more than what has relaxed.
    const State<double> other = bodies::random_state(points, 0.05, 5);
    const Vector<double> f_2 = bodies::gradient(softsim::elastic(mesh, law), other);
    hold(system, other);
    motion.q = other;
    ASSERT_EQ(integrator.step(system, motion).status, Status::converged);
    if constexpr (std::is_same_v<decltype(make(series)), Nodes>) {
      EXPECT_LT(bodies::relative_error(bodies::gradient(system, motion.q),
                                       series.relaxation(0.55) * f + series.relaxation(0.05) * (f_2 - f)),
                1e-13);
    }
  });
}

TEST(Viscoelastic, SolvesStaticallyForBothResponses) {
  for_both([&](auto make) {
    for (const auto response : {StaticResponse::relaxed, StaticResponse::instantaneous}) {
      const double share = response == StaticResponse::relaxed ? series.relaxed() : 1;
      DeadLoad<double> load(points), scaled(points);
      load.spread(softsim::nodes_near(mesh, Side::xmax, 0), {0.2, 0, -0.1});
      scaled.spread(softsim::nodes_near(mesh, Side::xmax, 0), Vec(0.2, 0, -0.1) / share);
      System system(mesh, make(series, response), load);
      System elastic(mesh, softsim::elastic(mesh, law), scaled);
      system.prescribed.fix(softsim::nodes_near(mesh, Side::xmin, 0));
      elastic.prescribed = system.prescribed;
      Motion<double> motion(points);
      State<double> q(points);
      ASSERT_EQ(softsim::StaticSolver<decltype(system)>({.tolerance = 1e-11}).solve(system, motion.q).status,
                Status::converged);
      ASSERT_EQ(softsim::StaticSolver<decltype(elastic)>({.tolerance = 1e-11}).solve(elastic, q).status,
                Status::converged);
      EXPECT_LT(bodies::relative_error(motion.q.displacement, q.displacement), 1e-9);
      run(system, motion, 1, 20);  // on to the end of all relaxation
      const double moved = bodies::relative_error(motion.q.displacement, q.displacement);
      if (response == StaticResponse::relaxed) {
        EXPECT_LT(moved, 1e-9);
      } else {
        EXPECT_GT(moved, 0.1);
      }
    }
  });
}

TEST(Viscoelastic, IsElasticWithoutTerms) {
  const auto elastic = softsim::elastic(mesh, law);
  const State<double> q_0 = bodies::random_state(points, 0.05, 6), q = bodies::random_state(points, 0.05, 7);
  const Vector<double> v = Vector<double>::Zero(q.size());
  for_both([&](auto make) {
    System system(mesh, make(PronySeries()));
    system.begin_step(q_0, v, 0.1);
    system.end_step(q_0, v, 0.1);
    system.begin_step(q_0, v, 0.1);
    EXPECT_LT(bodies::relative_error(bodies::gradient(system, q), bodies::gradient(elastic, q)), 1e-14);
    EXPECT_NEAR(system.energy(q) / elastic.energy(q), 1, 1e-14);
  });
}

TEST(Viscoelastic, LanesAndScalarsAgree) {
  const auto after = [&](auto term) {
    using T = typename decltype(term)::Scalar;
    const Vector<T> v = Vector<T>::Zero(4 * static_cast<std::ptrdiff_t>(points));
    const State<T> q_0 = bodies::random_state<T>(points, 0.05, 8),
                   q = bodies::random_state<T>(points, 0.05, 9);
    term.begin_step(q_0, v, 0.1);
    term.end_step(q, v, 0.1);
    term.begin_step(q, v, 0.1);
    return bodies::gradient(term, q_0);
  };
  const Vector<double> reference = after(tetrahedra(series));
  EXPECT_LT(bodies::relative_error(after(softsim::prony_elements<double, 1>(mesh, law, series)), reference),
            1e-13);
  EXPECT_LT(bodies::relative_error(after(softsim::prony_elements<float>(mesh, law, series)), reference),
            1e-5);
  EXPECT_LT(
      bodies::relative_error(after(softsim::prony_nodes(softsim::elastic<float>(mesh, law), points, series)),
                             after(nodes(series))),
      1e-5);
}

using Local = softsim::PronyElastic<softsim::LinearTetrahedron, NeoHookean>;

std::vector<softsim::LinearTetrahedron::Data<double>> rest_data() {
  return softsim::detail::tetrahedron_data(mesh);
}

// The recursion written out element by element, over steps of different length; and whatever is asked for
// first after a step, once or twice, every answer is of its end.
TEST(Viscoelastic, HistoryPerElementFollowsTheRecursion) {
  using K = softsim::LinearTetrahedron;
  const std::vector<double> steps{0.05, 0.3, 0.05};
  const std::vector<K::Data<double>> rest = rest_data();
  const auto state = [&](std::size_t n) { return bodies::random_state(points, 0.05, 40 + n); };
  const auto unknowns = [&](std::size_t e, const State<double>& q) {
    softsim::Local<double, 4> u;
    for (std::size_t i = 0; i < 4; ++i) u.points[i] = q.point(mesh.tetrahedra()[e][i]);
    return u;
  };
  for (const auto update : {PronyUpdate::first_order, PronyUpdate::exponential}) {
    const PronySeries s(series.terms(), update);
    Vector<double> expected = Vector<double>::Zero(state(0).size());
    for (std::size_t e = 0; e < rest.size(); ++e) {
      std::vector<Matrix> gamma(s.terms().size(), Matrix::Zero());
      const auto F = [&](std::size_t n) { return K::deformation_gradient(rest[e], unknowns(e, state(n))); };
      const auto S = [&](std::size_t n) -> Matrix { return F(n).inverse() * law.first_piola(F(n)); };
      for (std::size_t n = 0; n < steps.size(); ++n)
        for (std::size_t k = 0; k < gamma.size(); ++k) {
          const auto [decay, start, end] = s.coefficients(k, steps[n]);
          gamma[k] = decay * gamma[k] + start * S(n) + end * S(n + 1);
        }
      Matrix P = S(steps.size());
      for (const Matrix& g : gamma) P -= g;
      P = rest[e].volume * F(steps.size()) * P;
      const auto f = K::pullback(rest[e], unknowns(e, state(0)), P);
      for (int i = 0; i < 4; ++i)
        softsim::block(expected, mesh.tetrahedra()[e][static_cast<std::size_t>(i)]) += f.segment<3>(3 * i);
    }
    const Vector<double> v = Vector<double>::Zero(expected.size()), d = bodies::random_vector(points, 1, 50);
    const State<double> q = state(steps.size());
    const auto after_steps = [&](double dt, bool forces) {
      Tetrahedra term = tetrahedra(s);
      for (std::size_t n = 0; n < steps.size(); ++n) {
        term.begin_step(state(n), v, dt * steps[n]);
        if (forces) (void)bodies::gradient(term, state(n));
        term.end_step(state(n + 1), v, steps[n]);
      }
      return term;
    };
    // Rounding of S, of the order of 1e-15 times the stress, against forces that are sums of some twenty.
    const double tolerance = 1e-12;
    for (const double dt : {0.0, 1.0})
      for (const bool forces : {false, true}) {
        Tetrahedra term = after_steps(dt, forces);
        for (int n = 0; n < 3; ++n)
          EXPECT_LT(bodies::relative_error(bodies::gradient(term, q), expected), tolerance) << dt << n;
      }
    Tetrahedra once = after_steps(0, true);
    (void)bodies::gradient(once, q);
    const Tetrahedra product = after_steps(0, true), value = after_steps(0, true),
                     other = after_steps(0, true);
    EXPECT_LT(
        bodies::relative_error(bodies::hessian_product(product, q, d), bodies::hessian_product(once, q, d)),
        tolerance);
    EXPECT_NEAR(value.energy(q) / once.energy(q), 1, tolerance);
    EXPECT_LT(bodies::relative_error(bodies::gradient(other, state(9)), bodies::gradient(once, state(9))),
              tolerance);
  }
}

// Against the same steps of a set that never had the elements that are removed half way.
TEST(Viscoelastic, MemoryMovesWithTheElementsThatStay) {
  const auto run_with = [&](Tetrahedra term, const std::vector<std::size_t>& removed) {
    const Vector<double> v = Vector<double>::Zero(4 * static_cast<std::ptrdiff_t>(points));
    const auto state = [&](std::uint64_t n) { return bodies::random_state(points, 0.05, 60 + n); };
    for (std::uint64_t n = 0; n < 6; ++n) {
      if (n == 3)
        for (const std::size_t e : removed) term.remove(e);
      term.begin_step(state(n), v, n % 2 == 0 ? 0 : 0.1);
      term.end_step(state(n + 1), v, 0.1);
    }
    return bodies::gradient(term, state(9));
  };
  const std::vector<std::size_t> removed{0, 1, 5, 17, 46, 47};
  std::vector<softsim::LinearTetrahedron::Data<double>> data;
  std::vector<softsim::Tetrahedron> stencils;
  for (std::size_t e = 0; e < mesh.tetrahedra().size(); ++e)
    if (std::find(removed.begin(), removed.end(), e) == removed.end()) {
      data.push_back(rest_data()[e]);
      stencils.push_back(mesh.tetrahedra()[e]);
    }
  ASSERT_EQ(stencils.size(), 42u);
  const Vector<double> left = run_with(tetrahedra(series), removed);
  EXPECT_LT(bodies::relative_error(left, run_with(Tetrahedra({Local(law, series)}, data, stencils), {})),
            1e-13);
}

TEST(Viscoelastic, RefusesListsThatDoNotFit) {
  const Local local(law, series);
  EXPECT_NE(bodies::refusal([&] { return Tetrahedra({}, rest_data(), mesh.tetrahedra()); }), "");
  EXPECT_NE(bodies::refusal([&] { return Tetrahedra({local}, {}, mesh.tetrahedra()); }), "");
  EXPECT_NE(bodies::refusal([&] { return Tetrahedra({local}, {}, {}, {0}); }), "");
  EXPECT_EQ(bodies::refusal([&] { return Tetrahedra({local}, {}, {}); }), "");
}

}  // namespace viscoelastic_test
