// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <vector>

#include "../../bench/stability/contrast.hpp"
#include "../../bench/stability/discretise.hpp"
#include "../../bench/stability/extremes.hpp"
#include "../../bench/stability/recovery.hpp"
#include "../../bench/stability/slivers.hpp"
#include "softsim/material/continued.hpp"
#include "softsim/material/corotational.hpp"
#include "softsim/material/neo_hookean.hpp"
#include "softsim/material/projected.hpp"
#include "softsim/material/st_venant_kirchhoff.hpp"
#include "softsim/material/stable_neo_hookean.hpp"

// What the stability atlas found safe (bench/stability/elements.cpp, the long form), in small.
namespace elements_atlas_test {

using namespace atlas;
using softsim::Continued, softsim::Corotational, softsim::NeoHookean, softsim::projected,
    softsim::StableNeoHookean, softsim::Status, softsim::StVenantKirchhoff, softsim::WarpedStiffness;

// Without optimisation the larger one takes minutes.
#ifdef __OPTIMIZE__
constexpr int cells = 3;
#else
constexpr int cells = 2;
#endif
const Body& body() {
  static const Body b("cube", cube(cells, 0.2));
  return b;
}
const StableNeoHookean stable = StableNeoHookean::from_young_poisson(1, 0.3);
const NeoHookean neo_hookean = NeoHookean::from_young_poisson(1, 0.3);
const Corotational corotational = Corotational::from_young_poisson(1, 0.3);

void expect_recovery(const std::string& name, const Elasticity& elastic, Support support,
                     const std::vector<Start>& starts) {
  for (const Start start : starts) {
    const Tally tally = attempt(body(), elastic, support, start, 3);
    EXPECT_EQ(tally.recovered, tally.runs) << name << " from " << to_string(start) << ": " << tally.reason();
  }
}
const std::vector<Start> all{all_starts.begin(), all_starts.end()};
const std::vector<Start> all_but_degenerate{Start::random, Start::plane, Start::scaled, Start::reflected,
                                            Start::inflated};

TEST(ElementsAtlas, StableLawsComeBackFromEveryStartWithThreeNodesHeld) {
  const Mesh& mesh = body().mesh;
  expect_recovery("stable NH", tetrahedra(mesh, stable), Support::nodes, all);
  expect_recovery("stable NH, edge lengths", elasticity(mesh, stable, Discretisation::heml), Support::nodes,
                  all);
  expect_recovery("stable NH, volumes averaged",
                  averaged_stable_neo_hookean(mesh, softsim::Lame::from_young_poisson(1, 0.3)),
                  Support::nodes, all);
  expect_recovery("stable NH, projected", tetrahedra(mesh, projected(stable)), Support::nodes, all);
  expect_recovery("continued NH, J0 = 0.9", tetrahedra(mesh, Continued<NeoHookean>(neo_hookean, 0.9)),
                  Support::nodes, all);
  expect_recovery("corotational", tetrahedra(mesh, corotational), Support::nodes, all_but_degenerate);
}

// With six components held, a line and a point are free of forces for the others, or close to it.
TEST(ElementsAtlas, CorotationalComesBackEvenFromAnExactPoint) {
  for (const Support support : {Support::nodes, Support::components}) {
    expect_recovery("corotational, projected", tetrahedra(body().mesh, projected(corotational)), support,
                    all);
    expect_recovery("warped stiffness", tetrahedra(body().mesh, WarpedStiffness::from_young_poisson(1, 0.3)),
                    support, all);
  }
}

// A point is a strict local minimum of this law: no minimiser leaves it, and what is left shows.
TEST(ElementsAtlas, APointIsAnEquilibriumOfStableNeoHookean) {
  const Recovery r =
      recover(body(), tetrahedra(body().mesh, stable), Support::components, Start::point, 1, 1e-6);
  EXPECT_EQ(r.report.status, Status::inverted);
  EXPECT_FALSE(r.recovered());
  EXPECT_GT(r.inverted, 0);
  EXPECT_NEAR(r.energy, -1.5 * stable.mu() + stable.mu() + (stable.lambda() + stable.mu()) / 2, 1e-6);
}

// The mirror image is at rest for a law of C alone.
TEST(ElementsAtlas, StVenantKirchhoffStaysMirrored) {
  const Recovery r = recover(body(), tetrahedra(body().mesh, StVenantKirchhoff::from_young_poisson(1, 0.3)),
                             Support::nodes, Start::reflected, 1);
  EXPECT_EQ(r.report.status, Status::inverted);
  EXPECT_EQ(r.inverted, static_cast<int>(body().volume_ratios(body().rest()).size()));
  EXPECT_LT(r.energy, 1e-20);
}

TEST(ElementsAtlas, LawsWithALogarithmRefuseInvertedStarts) {
  for (const Start start : {Start::random, Start::plane, Start::point, Start::reflected}) {
    const Recovery r = recover(body(), tetrahedra(body().mesh, neo_hookean), Support::nodes, start, 1);
    EXPECT_EQ(r.report.status, Status::not_finite) << to_string(start);
    EXPECT_EQ(r.report.newton_iterations, 0);
  }
}

// Tangled states are equilibria of a law that is stiff against a change of volume; a body without that
// stiffness untangles first.
TEST(ElementsAtlas, ACorotationalSolveUntanglesForAnyLaw) {
  const Elasticity first = tetrahedra(body().mesh, corotational);
  const auto law = NeoHookean::from_young_poisson(1, 0.45);
  for (const Elasticity& elastic :
       {tetrahedra(body().mesh, law), tetrahedra(body().mesh, Continued<NeoHookean>(law))}) {
    const Tally tally = attempt(body(), elastic, Support::nodes, Start::random, 3, 0, &first);
    EXPECT_EQ(tally.recovered, tally.runs) << tally.reason();
  }
  const Tally alone =
      attempt(body(), tetrahedra(body().mesh, Continued<NeoHookean>(law)), Support::nodes, Start::random, 3);
  EXPECT_EQ(alone.elsewhere, alone.runs);
}

TEST(ElementsAtlas, SliversCostIterationsButNoAnswer) {
  const Vec load(0.05, 0, -0.1);
  const Body good("good", cube(4));
  const LoadedCube reference = load_cube(good, tetrahedra(good.mesh, stable), load);
  ASSERT_EQ(reference.report.status, Status::converged);
  for (const double degrees : {10.0, 1.0, 0.1, 0.001}) {
    const softsim::TetrahedralMesh mesh = cube_with_sliver(4, degrees);
    EXPECT_NEAR(smallest_dihedral(mesh.points(), mesh.tetrahedra()), degrees, 1e-6 * degrees);
    const Body sliver("sliver", mesh);
    for (const Discretisation d : {Discretisation::elastic, Discretisation::heml}) {
      const Elasticity elastic = elasticity(sliver.mesh, stable, d);
      const LoadedCube r = load_cube(sliver, elastic, load);
      EXPECT_EQ(r.report.status, Status::converged) << degrees << ": " << r.report.reason;
      EXPECT_EQ(r.inverted, 0);
      EXPECT_LT((r.top - reference.top).norm(), 0.03 * reference.top.norm());
      // 1e-15 times the sliver's ratio of edge to height, that again for edge lengths
      const double allowed = d == Discretisation::heml ? 1e-13 : 1e-14;
      EXPECT_LT(force_error(mesh, stable, elastic[0], r.q), allowed * std::max(1.0, 3 / degrees));
    }
  }
}

TEST(ElementsAtlas, StiffnessRatiosUpToAMillionConverge) {
  const Body cube_of_two("cube", cube(4));
  for (const Stiff where : {Stiff::below, Stiff::above, Stiff::inclusion})
    for (const double ratio : {1e3, 1e6}) {
      const LoadedCube r =
          load_cube(cube_of_two, two_stiffnesses(cube_of_two, where, ratio), Vec(0.02, 0, -0.05));
      EXPECT_EQ(r.report.status, Status::converged) << to_string(where) << ' ' << ratio;
      EXPECT_EQ(r.inverted, 0);
    }
}

TEST(ElementsAtlas, PoissonsRatiosUpToAlmostAHalfConverge) {
  const Body block("cube", cube(4));
  for (const bool stable_law : {true, false})
    for (const bool at_nodes : {false, true})
      for (const double nu : {0.49, 0.4999}) {
        const LoadedCube r =
            load_cube(block, nearly_incompressible(block, stable_law, at_nodes, nu), Vec(0.02, 0, -0.05));
        EXPECT_EQ(r.report.status, Status::converged) << stable_law << at_nodes << ' ' << nu;
        EXPECT_EQ(r.inverted, 0);
      }
}

TEST(ElementsAtlas, TwoTurnsTenfoldStretchAndBack) {
  const Body b = bar(2);
  const auto expect_return = [&](const std::string& name, const Elasticity& elastic, const Grip& to,
                                 int steps) {
    const Excursion x = excursion(b, elastic, to, steps);
    EXPECT_TRUE(x.arrived && x.back) << name << ": " << x.reason;
    EXPECT_EQ(x.inverted, 0) << name;
    EXPECT_LT(x.rest, 1e-6) << name;
  };
  const Elasticity elastic = tetrahedra(b.mesh, neo_hookean);
  expect_return("neo-Hookean", elastic, {720, 1}, 16);
  expect_return("neo-Hookean", elastic, {0, 10}, 4);
  expect_return("neo-Hookean", elastic, {0, 0.05}, 8);
  expect_return("stable NH", tetrahedra(b.mesh, stable), {0, 10}, 4);
  expect_return("stable NH", tetrahedra(b.mesh, stable), {360, 1}, 8);
  expect_return("corotational", tetrahedra(b.mesh, corotational), {360, 1}, 8);
}

}  // namespace elements_atlas_test
