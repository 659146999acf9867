// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "integrator/free_rotation.hpp"
#include "softsim/integrator/implicit.hpp"
#include "softsim/integrator/runge_kutta.hpp"
#include "softsim/integrator/velocity_verlet.hpp"
#include "softsim/kinematics/frame_body.hpp"
#include "softsim/material/st_venant_kirchhoff.hpp"
#include "softsim/potential/frame_elastic.hpp"
#include "softsim/potential/frame_loads.hpp"
#include "softsim/system/system.hpp"

// Rigid bodies, which are bodies of one frame, against what Euler, Lagrange and Huygens found.

namespace frame_dynamics_test {

using namespace softsim;
using V = Vec3<double>;
using M = Mat3<double>;
using free_rotation::Attitude;
using S = System<Elements<FrameDeadForces>>;

constexpr double density = 100;

// Eight equal masses at the corners of a box of half the given sides, around `centre`; 3 kg.
struct Rigid {
  FrameNodes nodes;
  FrameBody<1> body;
  V centre;   // from the frame's origin at rest, m
  M inertia;  // about the frame's origin, kg m^2
  double mass = 3;

  Rigid(const V& half, const V& centre_, const M& tilt = M::Identity())
      : nodes({V(0.4, -0.3, 0.2)}), body(make(nodes, half, centre_, tilt)), centre(centre_) {
    const M second =
        mass * (centre * centre.transpose() + tilt * V(half.cwiseAbs2()).asDiagonal() * tilt.transpose());
    inertia = second.trace() * M::Identity() - second;
  }
  static FrameBody<1> make(const FrameNodes& nodes, const V& half, const V& centre, const M& tilt) {
    std::vector<V> X;
    for (int i = 0; i < 8; ++i)
      X.push_back(nodes.frames()[0] + centre +
                  tilt * half.cwiseProduct(V(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1)));
    const ShapeValues one{{0}, {1}, {V::Zero()}, {}, {}};
    return {nodes, std::vector<ShapeValues>(8, one), X, std::vector<double>(8, 3 / density / 8)};
  }
  // Angular momentum about where the frame's origin is at rest.
  [[nodiscard]] V momentum(const Motion<double>& motion) const {
    const M R = motion.q.rotation(0);
    const V omega = block(motion.v, 1), v = block(motion.v, 0);
    const V x = motion.q.translation(0), c = R * centre;
    const V p = mass * (v + R * omega.cross(centre));
    return R * (inertia * omega) + mass * c.cross(v) + x.cross(p);
  }
  [[nodiscard]] S system(const V& g = V::Zero()) const {
    S system(nodes, gravity(body, density, g));
    system.mass = Mass<double>::lumped(body, density);
    return system;
  }
};

// An integrator of one kind, whatever its type.
struct Method {
  std::string name;
  int order;
  // Takes so many steps of h, and calls `observe` after each.
  std::function<void(const S&, Motion<double>&, double h, int steps, const std::function<void()>& observe)>
      run;
};
template <class Make>
Method method(const std::string& name, int order, Make make) {
  return {name, order,
          [=](const S& system, Motion<double>& motion, double h, int steps,
              const std::function<void()>& observe) {
            auto integrator = make(h);
            for (int k = 0; k < steps; ++k) {
              const StepReport report = integrator.step(system, motion);
              ASSERT_EQ(report.status, Status::converged) << name << ", step " << k << ": " << report.reason;
              if (observe) observe();
            }
          }};
}
template <class Scheme>
auto implicit(const Scheme& scheme) {
  using Kind = std::conditional_t<std::is_same_v<Scheme, Midpoint>, Midpoint, GeneralisedAlphaParameters>;
  return [=](double h) {
    return Implicit<Kind, S, Assembled, BlockJacobi>(
        {.dt = h, .scheme = scheme, .newton = true, .tolerance = 1e-13});
  };
}
const std::vector<Method> methods{
    method("Runge-Kutta 4", 4, [](double h) { return RungeKutta<S>({.dt = h}); }),
    method("velocity Verlet", 2, [](double h) { return VelocityVerlet<S>({.dt = h}); }),
    method("implicit midpoint", 2, implicit(Midpoint())), method("Newmark", 2, implicit(NewmarkScheme())),
    method("generalised-alpha", 2, implicit(GeneralisedAlphaScheme(0.8)))};

// What a frame is off in rotation and angular velocity.
double error(const Motion<double>& motion, const Attitude& exact) {
  const M off = exact.orientation.transpose() * motion.q.rotation(0);
  return rotation_logarithm(off).norm() + (block(motion.v, 1) - exact.velocity).norm();
}

// Observed orders of all methods from so many steps (RK4, others) to twice as many.
void expect_orders(const S& system, const Motion<double>& start, double time, const Attitude& exact,
                   std::array<int, 2> steps, double band) {
  for (const Method& m : methods) {
    std::array<double, 2> e;
    for (std::size_t k = 0; k < 2; ++k) {
      Motion<double> motion = start;
      const int n = steps[m.order == 4 ? 0 : 1] << k;
      m.run(system, motion, time / n, n, {});
      e[k] = error(motion, exact);
    }
    EXPECT_NEAR(std::log2(e[0] / e[1]), m.order, band) << m.name << ": " << e[0] << ", " << e[1];
  }
}

// Turning at omega while its centre of mass stands still.
Motion<double> spinning(const Rigid& rigid, const S& system, const V& omega) {
  Motion<double> motion = system.rest_motion();
  block(motion.v, 0) = -omega.cross(rigid.centre);
  block(motion.v, 1) = omega;
  return motion;
}

TEST(FrameDynamics, ABodyOfOneFrameIsRigid) {
  const Rigid rigid({0.5, 0.3, 0.2}, {0.1, 0.2, -0.1});
  const auto solid = elastic(rigid.body, StVenantKirchhoff::from_young_poisson(10, 0.3));
  State<double> q = rigid.nodes.rest_state();
  Vector<double> d(8), g = Vector<double>::Zero(8);
  d << 1, 2, 3, 0, 0.7, -1.5, 2, 0;
  retract(q, d);
  EXPECT_LT(solid.energy(q), 1e-28);  // strains of rounding, squared
  solid.add_gradient(q, g);
  EXPECT_LT(g.norm(), 1e-14);
  const M R = rotation_exponential(V(0.7, -1.5, 2));
  for (std::size_t s = 0; s < 8; ++s) {
    const V arm = rigid.body.positions()[s] - rigid.nodes.frames()[0];
    EXPECT_LT((rigid.body.position(q, s) - (rigid.nodes.frames()[0] + V(1, 2, 3) + R * arm)).norm(), 1e-14);
  }
  const S system = rigid.system();
  EXPECT_NEAR(system.mass.total(), 3, 1e-14);
  const V omega(0.3, 2, 1.1);
  const double T = omega.dot(rigid.inertia * omega) / 2 - 1.5 * omega.cross(rigid.centre).squaredNorm();
  EXPECT_NEAR(system.kinetic_energy(system.rest_state(), spinning(rigid, system, omega).v), T, 1e-14 * T);
}

// Torque-free precession of a body with two equal moments of inertia; its frame beside the centre of mass.
TEST(FrameDynamics, AnAxisymmetricBodyPrecesses) {
  const Rigid rigid({0.3, 0.3, 0.5}, {0.1, 0.2, -0.1});
  const V J = 3 * V(0.34, 0.34, 0.18), omega(1, 0.5, 3);
  const S system = rigid.system();
  expect_orders(system, spinning(rigid, system, omega), 2, free_rotation::axisymmetric(J, omega, 2),
                {50, 200}, 0.05);
}

// Three different moments: Jacobi's elliptic functions, nearly one period of them.
TEST(FrameDynamics, ABodyOfThreeMomentsTumbles) {
  const Rigid rigid({0.5, 0.4, 0.2}, {0.1, 0.2, -0.1});
  const free_rotation::Jacobi exact(3 * V(0.2, 0.29, 0.41), 2, 2.5);  // J of the half sides above
  const S system = rigid.system();
  const double time = 0.9 * exact.period();
  expect_orders(system, spinning(rigid, system, exact.at(0).velocity), time, exact.at(time), {100, 800}, 0.1);
}

// Sixty seconds, 15 periods of the velocity, of a body whose frame is its centre of mass. Both energy and the
// size of the angular momentum are squares of the velocity, which Euler's equations leave alone: the midpoint
// rule keeps both up to the tolerance of its solves; Newmark's method (the trapezoidal rule, which is the
// midpoint rule seen from half a step away) lets them swing by h^2, and so does generalised-alpha; under the
// explicit methods they drift, by one power of h more than these methods are of order.
TEST(FrameDynamics, EnergyAndMomentumOfAFreeBody) {
  const Rigid rigid({0.5, 0.4, 0.2}, V::Zero());
  const S system = rigid.system();
  for (const Method& m : methods) {
    std::array<double, 2> first{0, 0}, second{0, 0};
    for (std::size_t fine = 0; fine < 2; ++fine) {
      const int steps = fine == 0 ? 2000 : 4000;
      Motion<double> motion = spinning(rigid, system, {2, 0.01, 2.5});
      const double T = system.kinetic_energy(motion.q, motion.v), L = rigid.momentum(motion).norm();
      int k = 0;
      m.run(system, motion, 60.0 / steps, steps, [&] {
        double& worst = (++k <= steps / 2 ? first : second)[fine];
        worst = std::max({worst, std::abs(system.kinetic_energy(motion.q, motion.v) / T - 1),
                          std::abs(rigid.momentum(motion).norm() / L - 1)});
      });
    }
    if (m.name == "implicit midpoint") {
      // residuals of 1e-13 of the inertial force, 4 J omega/h, change J omega by 4e-13 a step
      EXPECT_LT(second[0], 2000 * 8e-13);
      EXPECT_LT(second[1], 4000 * 8e-13);
    } else if (m.name == "Newmark" || m.name == "generalised-alpha") {
      EXPECT_NEAR(std::log2(second[0] / second[1]), 2, 0.1) << m.name;
      EXPECT_LT(second[0], 1.001 * first[0]) << m.name;
    } else {
      EXPECT_NEAR(std::log2((second[0] - first[0]) / (second[1] - first[1])), m.order + 1, 0.1) << m.name;
    }
    RecordProperty(m.name, std::to_string(second[0]));
  }
}

// Lagrange's top in steady precession at Omega about the vertical, its axis inclined at theta, on a pivot.
TEST(FrameDynamics, AHeavyTopPrecessesSteadily) {
  const Rigid rigid({0.2, 0.2, 0.1}, {0, 0, 0.4});
  const double g = 9.81, theta = 0.7, Omega = 1.5, time = 1.5;
  const V J = rigid.inertia.diagonal();
  const double weight = rigid.mass * g * rigid.centre[2];  // times sin theta: the torque
  const double spin =
      (weight + J[0] * Omega * Omega * std::cos(theta)) / (J[2] * Omega) - Omega * std::cos(theta);
  const auto at = [&](double t) -> Attitude {
    const M R = rotation_exponential(V(0, 0, Omega * t)) * rotation_exponential(V(theta, 0, 0)) *
                rotation_exponential(V(0, 0, spin * t));
    return {R, R.transpose() * V(0, 0, Omega) + V(0, 0, spin)};
  };
  S system = rigid.system({0, 0, -g});
  system.prescribed.set(0, {0, 0, 0});
  Motion<double> motion = system.rest_motion();
  motion.q.quaternion(0) = quaternion_exponential(V(theta, 0, 0));
  block(motion.v, 1) = at(0).velocity;
  expect_orders(system, motion, time, at(time), {400, 3200}, 0.1);
}

// A compound pendulum that is free to rotate about its pivot and swings about a principal axis, little and
// much: a quarter of its period later it hangs. T = 2 pi sqrt(J/(m g l))/agm(1, cos(amplitude/2)).
TEST(FrameDynamics, APendulumKeepsItsPeriod) {
  const Rigid rigid({0.1, 0.2, 0.3}, {0, 0, -0.8});
  const double g = 9.81, J = rigid.inertia(0, 0), weight = rigid.mass * g * 0.8;
  S system = rigid.system({0, 0, -g});
  system.prescribed.set(0, {0, 0, 0});
  for (const double amplitude : {0.01, 0.5}) {
    double a = 1, b = std::cos(amplitude / 2);
    for (int k = 0; k < 6; ++k) {
      const double mean = (a + b) / 2;
      b = std::sqrt(a * b);
      a = mean;
    }
    const double period = 2 * std::numbers::pi * std::sqrt(J / weight) / a;
    Motion<double> motion = system.rest_motion();
    motion.q.quaternion(0) = quaternion_exponential(V(amplitude, 0, 0));
    const double fastest = 2 * std::sqrt(weight / J) * std::sin(amplitude / 2);
    expect_orders(system, motion, 3.25 * period, {M::Identity(), V(-fastest, 0, 0)}, {400, 400}, 0.1);
  }
}

// A hinge at a skew angle to all principal axes of a body that swings over the top, six turns: the body moves
// like a pendulum of its moment about the axis, and never leaves it.
TEST(FrameDynamics, AHingeHolds) {
  const Rigid rigid({0.1, 0.3, 0.5}, {0.3, 0.2, -0.4}, rotation_exponential(V(0.4, -0.6, 0.3)));
  const double time = 5;
  double angle = 0, rate = 9;
  const auto torque = [&](double x) {
    return rigid.mass * 9.81 * (rigid.centre[0] * std::cos(x) + rigid.centre[2] * std::sin(x)) /
           rigid.inertia(1, 1);
  };
  constexpr int fine = 20000;
  for (int k = 0; k < fine; ++k) {  // Nystrom's method, of order 4
    const double h = time / fine, k1 = torque(angle), k2 = torque(angle + h / 2 * rate + h * h / 8 * k1),
                 k3 = torque(angle + h * rate + h * h / 2 * k2);
    angle += h * rate + h * h / 6 * (k1 + 2 * k2);
    rate += h / 6 * (k1 + 4 * k2 + k3);
  }
  EXPECT_GT(angle, 12 * std::numbers::pi);
  S system = rigid.system({0, 0, -9.81});
  system.prescribed.set(0, {0, 0, 0});
  system.prescribed.hold_rotation(0, 0);
  system.prescribed.hold_rotation(0, 2);
  Motion<double> start = system.rest_motion();
  start.v[5] = 9;
  expect_orders(system, start, time, {rotation_exponential(V(0, angle, 0)), V(0, rate, 0)}, {2000, 2000},
                0.1);
  for (const Method& m : methods) {
    Motion<double> motion = start;
    double off = 0;
    m.run(system, motion, 0.005, 1000, [&] {
      const auto Q = motion.q.quaternion(0);
      off = std::max({off, std::abs(Q[0]), std::abs(Q[2]), motion.q.translation(0).norm(),
                      std::abs(motion.v[4]), std::abs(motion.v[6])});
    });
    EXPECT_LT(off, 1e-15) << m.name;
  }
}

}  // namespace frame_dynamics_test
