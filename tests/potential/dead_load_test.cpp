// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/potential/dead_load.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "potential/bodies.hpp"
#include "softsim/concepts.hpp"

namespace dead_load_test {

using bodies::Vec, bodies::refusal;
using softsim::DeadLoad, softsim::State, softsim::Vector, softsim::block;

static_assert(softsim::Potential<DeadLoad<double>> && softsim::Potential<DeadLoad<float>>);
static_assert(DeadLoad<double>::external && DeadLoad<double>::conservative && !DeadLoad<double>::has_hessian);

Vec total(const Vector<double>& f) {
  Vec sum = Vec::Zero();
  for (std::ptrdiff_t i = 0; i < f.size() / softsim::block_stride; ++i) sum += block(f, i);
  return sum;
}

TEST(DeadLoad, AddsUpForcesOnPoints) {
  DeadLoad<double> load(3);
  load.add(1, {1, 2, 3}).add(1, {0, 0, 1}).add(2, {-1, 0, 0});
  EXPECT_EQ(Vec(block(load.force(), 0)), Vec(0, 0, 0));
  EXPECT_EQ(Vec(block(load.force(), 1)), Vec(1, 2, 4));
  EXPECT_EQ(Vec(block(load.force(), 2)), Vec(-1, 0, 0));
}

TEST(DeadLoad, SpreadsATotalEvenly) {
  DeadLoad<double> load(5);
  load.spread({4, 0, 2}, {3, -6, 9});
  for (const int i : {0, 2, 4}) EXPECT_LT((block(load.force(), i) - Vec(1, -2, 3)).norm(), 1e-15);
  EXPECT_LT((total(load.force()) - Vec(3, -6, 9)).norm(), 1e-14);
}

TEST(DeadLoad, HasTheEnergyOfItsWorkAndNoStiffness) {
  DeadLoad<double> load(4);
  load.add(0, {1, 2, 3}).add(3, {-4, 5, -6});
  const State<double> q = bodies::random_state(4, 1, 1);
  EXPECT_NEAR(load.energy(q), -(Vec(1, 2, 3).dot(q.point(0)) + Vec(-4, 5, -6).dot(q.point(3))), 1e-14);
  EXPECT_EQ(bodies::gradient(load, q), -load.force());
  EXPECT_EQ(bodies::hessian_product(load, q, q.displacement).norm(), 0);
}

TEST(DeadLoad, RefusesPointsAndForcesThatAreNotThere) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  DeadLoad<double> load(3);
  EXPECT_EQ(refusal([&] { return load.add(3, Vec::Zero()); }), "load on node 3: out of range");
  EXPECT_EQ(refusal([&] { return load.add(-1, Vec::Zero()); }), "load on node -1: out of range");
  EXPECT_EQ(refusal([&] { return load.add(1, Vec(0, nan, 0)); }), "load on node 1: not a finite force");
  EXPECT_EQ(refusal([&] {
              return load.spread({0, 2}, Vec(inf, 0, 0));
            }),
            "load on node 0: not a finite force");
  EXPECT_EQ(refusal([&] { return load.spread({0, 7}, Vec(1, 0, 0)); }), "load on node 7: out of range");
  EXPECT_EQ(refusal([&] { return load.spread({}, Vec(1, 0, 0)); }), "load: no node to spread the force over");
}

TEST(Gravity, WeighsWhatTheBodyWeighs) {
  const auto mesh = bodies::distorted_cube(3, 2);
  const Vec g(1, -9.81, 2);
  const auto load = softsim::gravity(mesh, 1200, g);
  EXPECT_LT((total(load.force()) - 1200 * mesh.volume() * g).norm(), 1e-12 * 1200 * g.norm());
}

TEST(Gravity, TakesADensityPerTetrahedron) {
  const auto mesh = bodies::distorted_cube(2, 3);
  std::vector<double> density;
  double mass = 0;
  for (std::size_t t = 0; t < mesh.tetrahedra().size(); ++t) {
    density.push_back(t % 2 == 0 ? 500 : 2000);
    mass += density.back() * mesh.volume(t);
  }
  const auto load = softsim::gravity(mesh, density, {0, 0, -10});
  EXPECT_NEAR(total(load.force())[2], -10 * mass, 1e-12 * 10 * mass);
}

// Linear shape functions integrate to a quarter of the volume each.
TEST(Gravity, PutsAQuarterOfATetrahedronOnEachCorner) {
  const softsim::TetrahedralMesh mesh({Vec(0, 0, 0), Vec(1, 0, 0), Vec(0, 2, 0), Vec(0, 0, 3)},
                                      {{0, 1, 2, 3}});
  const auto load = softsim::gravity(mesh, 8, {0, 0, -10});
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(load.force()[4 * i + 2], -20, 1e-14);
  // uniform gravity has no torque around the centre of mass
  Vec torque = Vec::Zero();
  for (std::size_t i = 0; i < 4; ++i)
    torque += (mesh.points()[i] - Vec(0.25, 0.5, 0.75))
                  .cross(Vec(block(load.force(), static_cast<std::ptrdiff_t>(i))));
  EXPECT_LT(torque.norm(), 1e-13);
}

TEST(Gravity, RefusesDensitiesByValue) {
  const auto mesh = softsim::box_mesh({1, 1, 1}, {1, 1, 1});
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  const Vec g(0, 0, -9.81);
  EXPECT_EQ(refusal([&] { return softsim::gravity(mesh, 0, g); }),
            "density 0 kg/m^3: must be positive and finite");
  EXPECT_EQ(refusal([&] { return softsim::gravity(mesh, -2.5, g); }),
            "density -2.5 kg/m^3: must be positive and finite");
  EXPECT_EQ(refusal([&] { return softsim::gravity(mesh, inf, g); }),
            "density inf kg/m^3: must be positive and finite");
  EXPECT_NE(refusal([&] { return softsim::gravity(mesh, nan, g); }).find("must be positive and finite"),
            std::string::npos);
  EXPECT_NE(refusal([&] { return softsim::gravity(mesh, 1000, Vec(0, nan, 0)); }).find("not a finite force"),
            std::string::npos);
  EXPECT_EQ(refusal([&] {
              return softsim::gravity(mesh, std::vector<double>{1, 2}, g);
            }),
            "gravity: 2 densities for 6 tetrahedra");
}

}  // namespace dead_load_test
