// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "softsim/integrator/energy_momentum.hpp"
#include "softsim/integrator/implicit.hpp"
#include "softsim/integrator/runge_kutta.hpp"
#include "softsim/integrator/semi_explicit_euler.hpp"
#include "softsim/integrator/velocity_verlet.hpp"
#include "softsim/material/linear_elastic.hpp"
#include "softsim/mesh/generators.hpp"
#include "softsim/potential/elastic.hpp"
#include "softsim/potential/spring.hpp"
#include "softsim/system/system.hpp"

/// A body of one free component, and what one step of an integrator does to it.
namespace atlas {

using LinearSystem = softsim::System<softsim::ElasticTetrahedra<softsim::LinearElastic>>;

/// A small-strain tetrahedron of which one component may move: u'' + alpha u' + omega^2 u = 0 with omega = 1.
struct Oscillator {
  LinearSystem system;
  static constexpr std::ptrdiff_t component = 3 * softsim::block_stride;  // node 3, x

  Oscillator() : system(make()) {}

  /// Damping ratio 0 or more (below 0: driven).
  void set_damping(double xi) { system.damping = {2 * xi, 0}; }
  [[nodiscard]] static softsim::Motion<double> at(double u, double v) {
    softsim::Motion<double> motion(4);
    motion.q.displacement[component] = u;
    motion.v[component] = v;
    return motion;
  }

 private:
  static LinearSystem make() {
    const softsim::TetrahedralMesh mesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2, 3}});
    LinearSystem system(mesh, softsim::elastic(mesh, softsim::LinearElastic::from_young_poisson(10, 0.3)));
    system.prescribed.fix({0, 1, 2});
    system.prescribed.set(3, 1, 0);
    system.prescribed.set(3, 2, 0);
    const softsim::State<double> rest(4);
    softsim::Vector<double> e = softsim::Vector<double>::Zero(rest.size()), Ke = e;
    e[component] = 1;
    system.add_hessian_product(rest, e, Ke);
    // a quarter of the mass of 1/6 m^3 is on the node
    system.mass = softsim::Mass<double>::lumped(mesh, 24 * Ke[component]);
    return system;
  }
};

/// The order of the recurrence that an integrator's steps obey on an oscillator: 2 where a step knows nothing
/// but its start, 3 with an acceleration of its own beside it, 4 with the step before.
template <class I>
inline constexpr int memory = 2;
template <class S>
inline constexpr int memory<softsim::Implicit<softsim::Bdf2, S>> = 4;
template <class S>
inline constexpr int memory<softsim::Implicit<softsim::HhtScheme, S>> = 3;
template <class S>
inline constexpr int memory<softsim::Implicit<softsim::GeneralisedAlphaScheme, S>> = 3;

/// Largest growth in a step that is seen in a simulation of the oscillator with h = Omega and damping xi: the
/// largest eigenvalue of the matrix that two motions give in one step or, where the integrator remembers
/// more, the largest root of the recurrence that both obey, fitted to their first steps.
template <class I>
double measured_growth(Oscillator& body, I integrator, double Omega, double xi) {
  constexpr int order = memory<I>, windows = 3;
  body.set_damping(xi);
  integrator.set_dt(Omega);
  if constexpr (order == 2) {
    // (u, h v) after one step from (1, 0) and from (0, 1) are the columns of the amplification matrix
    softsim::Motion<double> first = Oscillator::at(1, 0), second = Oscillator::at(0, 1 / Omega);
    I again = integrator;
    if (integrator.step(body.system, first).status == softsim::Status::not_finite ||
        again.step(body.system, second).status == softsim::Status::not_finite)
      return HUGE_VAL;
    constexpr std::ptrdiff_t k = Oscillator::component;
    const double a = first.q.displacement[k], b = second.q.displacement[k], c = Omega * first.v[k],
                 d = Omega * second.v[k];
    const double radicand = (a - d) * (a - d) / 4 + b * c;
    if (radicand < 0) return std::hypot((a + d) / 2, std::sqrt(-radicand));
    return std::abs(a + d) / 2 + std::sqrt(radicand);
  }
  // Row n: u and h v of both motions after n steps.
  Eigen::Matrix<double, Eigen::Dynamic, 4> seen(order + windows, 4);
  for (int start = 0; start < 2; ++start) {
    softsim::Motion<double> motion = Oscillator::at(start == 0 ? 1 : 0, start == 0 ? 0 : 1 / Omega);
    I fresh = integrator;
    for (int n = 0; n < order + windows; ++n) {
      // The first step of Bdf2, backward Euler's, is not one of its recurrence.
      if (n > 0 || order == 4)
        if (fresh.step(body.system, motion).status == softsim::Status::not_finite) return HUGE_VAL;
      seen(n, 2 * start) = motion.q.displacement[Oscillator::component];
      seen(n, 2 * start + 1) = Omega * motion.v[Oscillator::component];
    }
  }
  // sum_k c_k x_{n+k} + x_{n+order} = 0
  Eigen::MatrixXd A(4 * windows, order);
  Eigen::VectorXd b(4 * windows);
  for (int n = 0; n < windows; ++n)
    for (int s = 0; s < 4; ++s) {
      for (int k = 0; k < order; ++k) A(4 * n + s, k) = seen(n + k, s);
      b[4 * n + s] = -seen(n + order, s);
    }
  // rows of like size, or the first of a strongly damped motion would be all that counts
  for (int r = 0; r < A.rows(); ++r) {
    const double scale = A.row(r).cwiseAbs().maxCoeff();
    if (scale == 0) continue;
    A.row(r) /= scale;
    b[r] /= scale;
  }
  const Eigen::VectorXd c = A.completeOrthogonalDecomposition().solve(b);
  Eigen::MatrixXd companion = Eigen::MatrixXd::Zero(order, order);
  companion.bottomLeftCorner(order - 1, order - 1).setIdentity();
  for (int k = 0; k < order; ++k) companion(0, order - 1 - k) = -c[k];
  return companion.eigenvalues().cwiseAbs().maxCoeff();
}

/// Growth per step of a motion's norm over the second half of a long run, with the norm averaged over a
/// stretch of steps: what the eye sees. To about 1/steps.
template <class I>
double growth_of_long_run(Oscillator& body, I integrator, double Omega, double xi, int steps) {
  body.set_damping(xi);
  integrator.set_dt(Omega);
  softsim::Motion<double> motion = Oscillator::at(1, 0.5);
  double early = 0, late = 0;
  const int quarter = steps / 4;
  for (int n = 0; n < steps; ++n) {
    if (integrator.step(body.system, motion).status == softsim::Status::not_finite) return HUGE_VAL;
    const double u = motion.q.displacement[Oscillator::component], v = motion.v[Oscillator::component];
    if (u * u + v * v < 1e-250) return 0;  // nothing is left, or soon only rounding of the smallest numbers
    if (n >= quarter && n < 2 * quarter) early += u * u + v * v;
    if (n >= 3 * quarter) late += u * u + v * v;
  }
  return std::pow(late / early, 0.25 / quarter);
}

/// Calls f(name, integrator, is_explicit) for every integrator of the library with a step of its own size.
template <class S, class Function>
void for_each_integrator(Function f) {
  using namespace softsim;
  const double h = 1, exact = 1e-14;
  f("explicit Euler", ExplicitEuler<S>({.dt = h}), true);
  f("RK2 midpoint", RungeKutta<S>({.dt = h, .tableau = ButcherTableau::midpoint()}), true);
  f("RK2 Heun", RungeKutta<S>({.dt = h, .tableau = ButcherTableau::heun()}), true);
  f("RK3 Kutta", RungeKutta<S>({.dt = h, .tableau = ButcherTableau::kutta3()}), true);
  f("RK4", RungeKutta<S>({.dt = h}), true);
  f("RK3 Bogacki-Shampine", RungeKutta<S>({.dt = h, .tableau = ButcherTableau::bogacki_shampine()}), true);
  f("RK5 Dormand-Prince", RungeKutta<S>({.dt = h, .tableau = ButcherTableau::dormand_prince()}), true);
  f("semi-explicit Euler", SemiExplicitEuler<S>({.dt = h}), true);
  f("velocity Verlet", VelocityVerlet<S>({.dt = h}), true);
  f("backward Euler", BackwardEuler<S>({.dt = h, .tolerance = exact}), false);
  f("theta 0.7", Implicit<Theta, S>({.dt = h, .scheme = Theta{0.7}, .tolerance = exact}), false);
  f("theta 0.4", Implicit<Theta, S>({.dt = h, .scheme = Theta{0.4}, .tolerance = exact}), false);
  f("implicit midpoint", ImplicitMidpoint<S>({.dt = h, .tolerance = exact}), false);
  f("trapezoidal", Implicit<Trapezoidal, S>({.dt = h, .tolerance = exact}), false);
  f("BDF2", Implicit<Bdf2, S>({.dt = h, .tolerance = exact}), false);
  f("Newmark 1/4 1/2", Newmark<S>({.dt = h, .tolerance = exact}), false);
  f("Newmark 0.4 0.7", Newmark<S>({.dt = h, .scheme = NewmarkScheme(0.4, 0.7), .tolerance = exact}), false);
  f("HHT -0.1", Hht<S>({.dt = h, .scheme = HhtScheme(-0.1), .tolerance = exact}), false);
  f("generalised-alpha 0.8",
    GeneralisedAlpha<S>({.dt = h, .scheme = GeneralisedAlphaScheme(0.8), .tolerance = exact}), false);
  f("generalised-alpha 0",
    GeneralisedAlpha<S>({.dt = h, .scheme = GeneralisedAlphaScheme(0), .tolerance = exact}), false);
  f("energy-momentum", EnergyMomentum<S>({.dt = h, .tolerance = exact}), false);
}

/// A particle of 1 kg that moves across a spring of 1 m: the force k/(2 l^2) u^3, convex, with 0 <= E'' <= 1
/// for |u| <= 1, and damping 1/s. Of two motions y = (u, v) that stay there, with w = v + u/2, the distance
///   V = |dw|^2 + |du|^2 / 4
/// never grows: y' = f(y) is contractive.
struct ContractiveBody {
  using S = softsim::System<softsim::Elements<softsim::SquaredLengthSpring, double, 1>>;
  S system;
  static constexpr std::ptrdiff_t component = softsim::block_stride + 1;  // node 1, y

  ContractiveBody() : system(make()) {}

  struct Point {
    double u, w;
  };
  [[nodiscard]] static softsim::Motion<double> motion(Point y) {
    softsim::Motion<double> motion(4);
    motion.q.displacement[component] = y.u;
    motion.v[component] = y.w - y.u / 2;
    return motion;
  }
  [[nodiscard]] static Point point(const softsim::Motion<double>& motion) {
    const double u = motion.q.displacement[component];
    return {u, motion.v[component] + u / 2};
  }
  /// Square root of V between two motions.
  [[nodiscard]] static double distance(Point a, Point b) { return std::hypot(a.w - b.w, (a.u - b.u) / 2); }

 private:
  static S make() {
    const softsim::TetrahedralMesh mesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2, 3}});
    // E'' = 3 k u^2 / (2 l^2) = 1 at u = 1
    S system(mesh, softsim::springs<softsim::SquaredLengthSpring, double, 1>(mesh, {{0, 1}}, {2.0 / 3}));
    system.mass = softsim::Mass<double>::lumped(mesh, 24);
    system.damping = {1, 0};
    system.prescribed.fix({0, 2, 3});
    system.prescribed.set(1, 0, 0);
    system.prescribed.set(1, 2, 0);
    return system;
  }
};

/// Largest growth of the distance of two motions of a `ContractiveBody` in one step, over pairs in the ball
/// V <= 1/4, in which |u| <= 1, and steps from 0.1 s to 1000 s.
struct Contraction {
  double growth = 0, step = 0;
  ContractiveBody::Point a{}, b{};
};
template <class I>
Contraction contraction(const ContractiveBody& body, I integrator, int pairs) {
  using Point = ContractiveBody::Point;
  Contraction worst;
  double seed = 0.5;
  const auto number = [&] {  // additive recurrence: fills an interval evenly
    seed += 0.6180339887498949;
    seed -= std::floor(seed);
    return seed;
  };
  const auto after = [&](Point y, double h) {
    softsim::Motion<double> motion = ContractiveBody::motion(y);
    I fresh = integrator;
    fresh.set_dt(h);
    if (fresh.step(body.system, motion).status == softsim::Status::not_finite)
      throw std::runtime_error("contraction: a step is not finite");
    return ContractiveBody::point(motion);
  };
  for (int k = 0; k < pairs; ++k) {
    const double h = std::pow(10.0, -1 + 4 * number());
    const auto in_ball = [&](double r, double angle) {
      return Point{r * std::cos(angle), r / 2 * std::sin(angle)};
    };
    const Point a = in_ball(number(), 6.283185307179586 * number());
    Point b = in_ball(number(), 6.283185307179586 * number());
    if (k % 2 == 0) b = {a.u + 0.01 * (b.u - a.u), a.w + 0.01 * (b.w - a.w)};  // close to each other
    const double before = ContractiveBody::distance(a, b);
    if (before < 1e-6) continue;
    const double growth = ContractiveBody::distance(after(a, h), after(b, h)) / before;
    if (growth > worst.growth) worst = {growth, h, a, b};
  }
  return worst;
}

}  // namespace atlas
