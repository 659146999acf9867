// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
// Short form of the charts: the errors of all methods on coarse meshes, and the references. CHART_DATA is the
// folder of the references.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "../../bench/chart/command_line.hpp"
#include "../../bench/chart/explore.hpp"

namespace chart_test {

using namespace chart;

const Toolbox& tools() {
  static const Toolbox all;
  return all;
}
Scene scene_of(const std::string& name) { return scenes_named({name}).front(); }
const Model& model(const std::string& name) {
  return *std::find_if(tools().models.begin(), tools().models.end(),
                       [&](const Model& m) { return m.name == name; });
}
Point one(const Scene& scene, const std::string& of, std::size_t solver, int resolution,
          bool single = false) {
  return measure(scene, reference_of(scene, CHART_DATA),
                 {.model = &model(of), .solver = &tools().solvers[solver], .single = single}, resolution,
                 1e-9);
}

Point moving(const Scene& scene, const std::string& of, const std::string& integrator, double step,
             int resolution, bool single = false) {
  const auto& all = tools().integrators;
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const Integrator& i) { return i.name == integrator; });
  return measure(scene, reference_of(scene, CHART_DATA),
                 {.model = &model(of), .integrator = &*found, .step = step, .single = single}, resolution,
                 1e-9);
}

// The patch test of all methods: whatever has the law of the scene is exact on the coarsest mesh, with every
// solver.
TEST(Chart, MethodsWithTheLawAreExactOnTheCompressedBlock) {
  const Scene scene = scene_of("compressed_block");
  const std::set<std::string> another_law{"springs",           "mass_tensor",       "tet4_linear",
                                          "tet4_corotational", "hex8_corotational", "frames_shepard"};
  for (const Model& m : tools().models)
    for (std::size_t s = 0; s < tools().solvers.size(); ++s)
      for (const bool single : {false, true}) {
        const Point p = one(scene, m.name, s, 2, single);
        const std::string what = m.name + " " + p.solver + " " + p.preconditioner + " " + p.scalar;
        if (m.name == "springs") continue;  // may find another equilibrium
        ASSERT_EQ(p.status, "converged") << what;
        if (another_law.contains(m.name))
          EXPECT_GT(p.error, 0.01) << what;
        else
          EXPECT_LT(p.error, single ? 1e-3 : 1e-5) << what;
        EXPECT_GT(p.memory, 1000u) << what;
        EXPECT_GT(p.seconds, 0) << what;
      }
}

// Solvers differ in time and not in the answer; HEML and tetrahedra are the same energy.
TEST(Chart, TheErrorIsThatOfTheModel) {
  const Scene scene = scene_of("soft_cantilever");
  const double tet4 = one(scene, "tet4", 0, 1).error;
  EXPECT_NEAR(tet4, 0.86, 0.01);
  for (std::size_t s = 0; s < tools().solvers.size(); ++s) {
    EXPECT_NEAR(one(scene, "tet4", s, 1).error, tet4, 1e-4 * tet4);
    EXPECT_NEAR(one(scene, "heml", s, 1).error, tet4, 1e-4 * tet4);
  }
  EXPECT_NEAR(one(scene, "tet4", 1, 1, true).error, tet4, 1e-2 * tet4);
  EXPECT_LT(one(scene, "hex8", 0, 2).error, one(scene, "hex8", 0, 1).error / 2);
  EXPECT_LT(one(scene, "tet10", 0, 1).error, 0.04);
  EXPECT_LT(one(scene, "frames_hex8_linked", 0, 2).error, one(scene, "hex8", 0, 2).error / 2);
}

// Beside the numbers of others: beam theory, other codes' finite elements.
TEST(Chart, ReferencesAgreeWithOthers) {
  const auto last = [](const std::string& name) { return reference_of(scene_of(name), CHART_DATA).u.back(); };
  const auto own_error = [](const std::string& name) {
    return reference_of(scene_of(name), CHART_DATA).error;
  };
  EXPECT_NEAR(last("steel_cantilever")[2], -0.150593, 0.005 * 0.150593);  // Timoshenko
  EXPECT_NEAR(last("soft_cantilever")[2], -6.5090,
              std::max(0.001, 2 * own_error("soft_cantilever")) * 6.5090);
  EXPECT_NEAR(last("soft_cantilever")[0], -1.5985,
              std::max(0.002, 3 * own_error("soft_cantilever")) * 1.5985);
  for (const Scene& scene : scenes()) EXPECT_LT(reference_of(scene, CHART_DATA).error, 5e-3) << scene.name;
}

TEST(Chart, EverySceneHasAFrontOfSeveralModelsAtCoarseResolutions) {
  for (const Scene& scene : scenes()) {
    std::set<std::string> solved;
    for (const Model& m : tools().models) {
      try {
        const std::vector<Method> all = tools().methods(scene, m, false);
        const auto stable = std::find_if(all.begin(), all.end(), [](const Method& method) {
          return method.integrator == nullptr || method.integrator->solver != "-";
        });
        const Point p = measure(scene, reference_of(scene, CHART_DATA), *stable, scene.resolutions[0], 1e-9);
        if (p.status == "converged") solved.insert(m.family);
      } catch (const NotApplicable&) {
      }
    }
    EXPECT_GE(solved.size(), 5u) << scene.name;
  }
}

TEST(Chart, ModelsThatDoNotFitSayWhy) {
  const Scene scene = scene_of("soft_cantilever");
  try {
    one(scene, "tet4_nodal_volume", 0, 1);
    FAIL();
  } catch (const NotApplicable& why) {
    EXPECT_STREQ(why.what(), "averaged volumes need a law that splits them off");
  }
}

TEST(Chart, RowsHaveTheColumnsOfTheHeader) {
  std::ostringstream out;
  out << one(scene_of("compressed_block"), "tet4", 0, 1);
  const std::string header = Point::header, row = out.str();
  EXPECT_EQ(std::count(header.begin(), header.end(), ','), std::count(row.begin(), row.end(), ','));
  EXPECT_EQ(row.rfind("tet4,static,ldlt,-,,1,double,converged,", 0), 0u) << row;
}

TEST(Choose, FindsTheCheapestOfTheBlock) {
  const Scene scene = scene_of("compressed_block");
  const Reference reference = reference_of(scene, CHART_DATA);
  Exploration exploration(scene, reference, {.tolerance = 1e-4, .rate = 25}, 60);
  exploration.run(tools());
  const auto& points = exploration.points();
  const auto good = [](const Point& p) { return p.error <= 1e-4; };
  ASSERT_GT(std::count_if(points.begin(), points.end(), good), 5);
  for (const Point& p : points)
    EXPECT_LE(p.resolution, 4);  // the coarsest is good enough; two more tell what less error costs
  EXPECT_TRUE(std::any_of(points.begin(), points.end(),
                          [&](const Point& p) { return good(p) && p.scalar == "float"; }));
  EXPECT_FALSE(exploration.out_of_time());
}

// A bar in its first mode: second order of the midpoint rule, damping of backward Euler, the limit of
// explicit steps.
TEST(Chart, TheVibratingBarTellsIntegratorsApart) {
  const Scene scene = scene_of("vibrating_bar");
  const double period = scene.duration / 20;
  // Relative errors of the frequency add up to a phase, which grows from zero: its root mean square is 1 /
  // sqrt(3) of the last. Lumped masses on cells of size h take (k h)^2 / 24 off the frequency, k = pi / 2;
  // the midpoint rule takes (omega dt)^2 / 12 off, Verlet's method adds half of that.
  const auto expected = [](double of_step, int steps, int cells) {
    const double pi = std::numbers::pi, phase = 2 * pi * 20;
    return phase / std::sqrt(3.0) *
           std::abs(of_step * std::pow(2 * pi / steps, 2) - std::pow(pi / 2 / cells, 2) / 24);
  };
  for (const int steps : {80, 160})
    for (const char* rule : {"implicit_midpoint", "implicit_midpoint_frozen"}) {
      const double error = moving(scene, "hex8", rule, period / steps, 16).error;
      EXPECT_NEAR(error, expected(-1.0 / 12, steps, 16), 0.05 * error) << rule << " " << steps;
    }
  for (const int cells : {8, 16}) {
    const double error = moving(scene, "hex8", "velocity_verlet", period / 160, cells).error;
    EXPECT_NEAR(error, expected(1.0 / 24, 160, cells), 0.05 * error) << cells;
  }
  EXPECT_GT(moving(scene, "hex8", "backward_euler", period / 80, 16).error, 0.5);
  const Point unstable = moving(scene, "hex8", "velocity_verlet", period / 20, 32);
  EXPECT_TRUE(unstable.status != "converged" || !(unstable.error < 10)) << unstable.error;
  const Point p = moving(scene, "frames_hex8", "velocity_verlet", period / 640, 4);
  EXPECT_EQ(p.status, "converged");
  EXPECT_NEAR(p.seconds_per_simulated_second * scene.duration, p.seconds, 1e-12);
  EXPECT_EQ(p.integrator, "velocity_verlet");
}

TEST(Choose, AWishNeedsBoth) {
  const Scene still = scene_of("compressed_block"), moves = scene_of("vibrating_bar");
  Point p;
  p.error = 0.01;
  p.seconds = 0.01;
  EXPECT_TRUE((Wish{0.01, 100}.met_by(still, p)));
  EXPECT_FALSE((Wish{0.009, 100}.met_by(still, p)));
  EXPECT_FALSE((Wish{0.01, 101}.met_by(still, p)));
  p.step = 0.01;
  p.seconds_per_simulated_second = 0.9;
  EXPECT_TRUE((Wish{0.01, 100}.met_by(moves, p)));
  EXPECT_FALSE((Wish{0.01, 101}.met_by(moves, p)));
  p.seconds_per_simulated_second = 1.1;
  EXPECT_FALSE((Wish{0.01, 100}.met_by(moves, p)));
  p.error = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE((Wish{1, 1}.met_by(still, p)));
}

TEST(References, AreRefusedIfTheyAreNotOfTheScene) {
  const std::filesystem::path folder = std::filesystem::path(::testing::TempDir()) / "softsim_references";
  std::filesystem::create_directories(folder);
  const Scene scene = scene_of("twisted_bar");
  const auto said = [&](const std::string& text) -> std::string {
    std::ofstream(folder / "twisted_bar.csv") << text;
    try {
      (void)reference_of(scene, folder);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(said("# error 1e-3\nx,y,z,ux,uy,uz\n").find("too few points"), std::string::npos);
  EXPECT_NE(said("# error 1e-3\n1,2,3,0,0,0\n").find("of other points"), std::string::npos);
  EXPECT_NE(said("# error 1e-3\n1,2,3,0,zero,0\n").find("not six numbers"), std::string::npos);
  std::filesystem::remove(folder / "twisted_bar.csv");
  try {
    (void)reference_of(scene, folder);
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("is missing; chart --reference twisted_bar makes it"),
              std::string::npos);
  }
  // what is written is read again
  Reference r = reference_of(scene, CHART_DATA);
  write_reference(scene, r, folder);
  const Reference again = reference_of(scene, folder);
  EXPECT_LT(relative_distance(again.u, r.u), 1e-8);
  EXPECT_EQ(again.recipe, r.recipe);
  EXPECT_NEAR(again.error, r.error, 1e-8);
}

TEST(CommandLine, NamesScenes) {
  EXPECT_EQ(scenes_named({"all"}).size(), scenes().size());
  EXPECT_THROW((void)scenes_named({"cook"}), BadArguments);
}

}  // namespace chart_test
