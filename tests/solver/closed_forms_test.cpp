// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "material/law_checks.hpp"
#include "potential/bodies.hpp"
#include "softsim/integrator/static_solver.hpp"
#include "softsim/mesh/selection.hpp"
#include "softsim/potential/dead_load.hpp"
#include "softsim/potential/elastic.hpp"
#include "softsim/potential/pressure.hpp"
#include "softsim/system/system.hpp"

// Homogeneous states of a unit cube on rollers at x = 0, y = 0 and z = 0. Linear tetrahedra hold them
// exactly, so that only the solver's tolerance is left: 1e-10 of the load times a condition number of some
// hundred. E = 10 Pa, nu = 0.3.

namespace closed_forms_test {

using bodies::Vec;
using softsim::NeoHookean, softsim::Side, softsim::StableNeoHookean, softsim::State, softsim::Status,
    softsim::StVenantKirchhoff, softsim::Triangle;

constexpr double lambda = 10 * 0.3 / (1.3 * 0.4), mu = 10 / 2.6;
const auto mesh = bodies::distorted_cube(3, 1);

template <class S>
void put_on_rollers(S& system) {
  for (int axis = 0; axis < 3; ++axis)
    for (const std::int32_t i : softsim::nodes_near(mesh, static_cast<Side>(2 * axis), 0))
      system.prescribed.set(i, axis, 0);
}

// Triangles of the surface on the upper side along an axis.
std::vector<Triangle> upper_side(int axis) {
  std::vector<Triangle> side;
  for (const Triangle& f : softsim::boundary_triangles(mesh)) {
    bool inside = true;
    for (const std::int32_t i : f) inside = inside && mesh.points()[static_cast<std::size_t>(i)][axis] == 1;
    if (inside) side.push_back(f);
  }
  return side;
}

// A traction in Pa of rest area along x on the side x = 1.
softsim::DeadLoad<double> traction(double t) {
  softsim::DeadLoad<double> load(mesh.points().size());
  for (const Triangle& f : upper_side(0)) {
    const auto X = [&](std::size_t i) { return mesh.points()[static_cast<std::size_t>(f[i])]; };
    for (const std::int32_t i : f) load.add(i, Vec(t * (X(1) - X(0)).cross(X(2) - X(0)).norm() / 6, 0, 0));
  }
  return load;
}

void expect_stretches(const State<double>& q, const Vec& s, double tolerance) {
  const State<double> exact = bodies::affine_state(mesh, s.asDiagonal(), Vec::Zero());
  EXPECT_LT((q.displacement - exact.displacement).cwiseAbs().maxCoeff(), tolerance);
}

// Pulls the cube to the stretch s by its end face, in one go.
template <class Law>
void expect_pulled(double s, double lateral, double P) {
  softsim::System system(mesh, softsim::elastic(mesh, Law::from_young_poisson(10, 0.3)));
  put_on_rollers(system);
  const auto end = softsim::nodes_near(mesh, Side::xmax, 0);
  for (const std::int32_t i : end) system.prescribed.set(i, 0, s - 1);
  State<double> q(mesh.points().size());
  const auto report = softsim::StaticSolver<decltype(system)>({.tolerance = 1e-10}).solve(system, q);
  ASSERT_EQ(report.status, Status::converged) << report.reason;
  expect_stretches(q, {s, lateral, lateral}, 1e-8);
  const softsim::Vector<double> g = bodies::gradient(system, q);
  double reaction = 0;
  for (const std::int32_t i : end) reaction += softsim::block(g, i)[0];
  EXPECT_NEAR(reaction, P, 1e-7);
}

// Pulls the cube by a dead traction, in one go.
template <class Law>
void expect_stretched(double P, double s, double lateral) {
  softsim::System system(mesh, softsim::elastic(mesh, Law::from_young_poisson(10, 0.3)), traction(P));
  put_on_rollers(system);
  State<double> q(mesh.points().size());
  const auto report = softsim::StaticSolver<decltype(system)>({.tolerance = 1e-10}).solve(system, q);
  ASSERT_EQ(report.status, Status::converged) << report.reason;
  expect_stretches(q, {s, lateral, lateral}, 1e-8);
}

// Lateral stretch^2 of the log-free law from P_22 = mu l - mu s l + (lambda + mu)(s l^2 - 1) s l = 0.
double stable_lateral(double s) { return std::sqrt((1 + mu * (s - 1) / (s * (lambda + mu))) / s); }
double stable_stress(double s) {
  const double l2 = std::pow(stable_lateral(s), 2);
  return mu * s + ((lambda + mu) * (s * l2 - 1) - mu) * l2;
}

// Roots of the lateral equation to ten digits.
TEST(UniaxialStretch, OfNeoHookeanByDisplacement) {
  expect_pulled<NeoHookean>(0.7, 1.1079347328, -4.0523042431);
  expect_pulled<NeoHookean>(1.1, 0.9714929459, 0.9307743218);
  expect_pulled<NeoHookean>(1.5, 0.8801745918, 3.7828017639);
  expect_pulled<NeoHookean>(2, 0.7980775445, 6.4674466017);
}

TEST(UniaxialStretch, OfStVenantKirchhoffByDisplacement) {
  for (const double s : {0.9, 1.25, 1.5})
    expect_pulled<StVenantKirchhoff>(s, std::sqrt(1 - 0.3 * (s * s - 1)), 5 * (s * s * s - s));
}

TEST(UniaxialStretch, OfStableNeoHookeanByDisplacement) {
  for (const double s : {0.7, 1.1, 1.5})
    expect_pulled<StableNeoHookean>(s, stable_lateral(s), stable_stress(s));
}

TEST(UniaxialStretch, OfNeoHookeanByTraction) {
  expect_stretched<NeoHookean>(-4.0523042431, 0.7, 1.1079347328);
  expect_stretched<NeoHookean>(3.7828017639, 1.5, 0.8801745918);
}

TEST(UniaxialStretch, OfStVenantKirchhoffByTraction) {
  expect_stretched<StVenantKirchhoff>(3.515625, 1.25, std::sqrt(1 - 0.3 * 0.5625));
  expect_stretched<StVenantKirchhoff>(-0.855, 0.9, std::sqrt(1 + 0.3 * 0.19));
}

TEST(UniaxialStretch, OfStableNeoHookeanByTraction) {
  for (const double s : {0.8, 1.3})
    expect_stretched<StableNeoHookean>(stable_stress(s), s, stable_lateral(s));
}

// Equal stretches along x and y, z free: l3 for the stretches 0.7, 1.2 and 2, to ten digits.
TEST(EquibiaxialStretch, OfNeoHookean) {
  const double states[3][3] = {
      {0.7, 1.2963960221, -6.5419925607}, {1.2, 0.8425870041, 2.3398946814}, {2, 0.4303711698, 7.3361166465}};
  for (const auto& [s, l3, P] : states) {
    softsim::System system(mesh, softsim::elastic(mesh, NeoHookean::from_young_poisson(10, 0.3)));
    put_on_rollers(system);
    for (int axis = 0; axis < 2; ++axis)
      for (const std::int32_t i : softsim::nodes_near(mesh, static_cast<Side>(2 * axis + 1), 0))
        system.prescribed.set(i, axis, s - 1);
    State<double> q(mesh.points().size());
    const auto report = softsim::StaticSolver<decltype(system)>({.tolerance = 1e-10}).solve(system, q);
    ASSERT_EQ(report.status, Status::converged) << report.reason;
    expect_stretches(q, {s, s, l3}, 1e-8);
    const softsim::Vector<double> g = bodies::gradient(system, q);
    double reaction = 0;
    for (const std::int32_t i : softsim::nodes_near(mesh, Side::ymax, 0)) reaction += softsim::block(g, i)[1];
    EXPECT_NEAR(reaction, P, 1e-7);
  }
}

// All round pressure on the three free sides: mu (s - 1/s) + 3 lambda ln s / s = -p s^2. The patch ends on
// rollers, where its edge slides: the load's tangent is not symmetric there and Newton not quadratic, the
// answer is the same.
TEST(FollowerPressure, CompressesACubeEvenly) {
  const double s = 0.8, p = -(mu * (s - 1 / s) + 3 * lambda * std::log(s) / s) / (s * s);
  std::vector<Triangle> sides;
  for (int axis = 0; axis < 3; ++axis)
    for (const Triangle& f : upper_side(axis)) sides.push_back(f);
  softsim::System system(mesh, softsim::elastic(mesh, NeoHookean::from_young_poisson(10, 0.3)),
                         softsim::pressure(mesh, sides, p));
  put_on_rollers(system);
  State<double> q(mesh.points().size());
  const auto report = softsim::StaticSolver<decltype(system)>({.tolerance = 1e-10}).solve(system, q);
  ASSERT_EQ(report.status, Status::converged) << report.reason << ", residual " << report.residual;
  expect_stretches(q, {s, s, s}, 1e-8);
}

}  // namespace closed_forms_test
