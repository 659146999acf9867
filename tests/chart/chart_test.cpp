// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
// Short form of the charts: the errors of all methods on coarse meshes, and the references.
// SOFTSIM_CHART_DATA is the folder of the references.
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
  return measure(scene, reference_of(scene, SOFTSIM_CHART_DATA),
                 {.model = &model(of), .solver = &tools().solvers[solver], .single = single}, resolution,
                 1e-9);
}

Point moving(const Scene& scene, const std::string& of, const std::string& integrator, double step,
             int resolution, bool single = false) {
  const auto& all = tools().integrators;
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const Integrator& i) { return i.name == integrator; });
  return measure(scene, reference_of(scene, SOFTSIM_CHART_DATA),
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
        if (tools().solvers[s].reduced || m.name == "mass_tensor_svk") continue;
        const Point p = one(scene, m.name, s, 2, single);
        const std::string what = m.name + " " + p.solver + " " + p.preconditioner + " " + p.scalar;
        if (m.name == "springs") continue;  // may find another equilibrium
        ASSERT_EQ(p.status, "converged") << what;
        if (another_law.contains(m.name))
          EXPECT_GT(p.error(), 0.01) << what;
        else if (m.name == "frames_least_squares")
          EXPECT_LT(p.error(), 0.02) << what;  // no polynomials, so Gauss points do not integrate them
        else
          for (std::size_t k = 0; k < 3; ++k)  // displacement, force, energy
            EXPECT_LT(p.error(k), single ? 1e-3 : 1e-5) << what << " " << scene.quantities[k].name;
        EXPECT_GT(p.memory, 1000u) << what;
        EXPECT_GT(p.seconds, 0) << what;
      }
}

// Solvers differ in time and not in the answer; HEML and tetrahedra are the same energy.
TEST(Chart, TheErrorIsThatOfTheModel) {
  const Scene scene = scene_of("soft_cantilever");
  const double tet4 = one(scene, "tet4", 0, 1).error();
  EXPECT_NEAR(tet4, 0.86, 0.01);
  for (std::size_t s = 0; s < tools().solvers.size(); ++s) {
    if (tools().solvers[s].reduced) continue;
    EXPECT_NEAR(one(scene, "tet4", s, 1).error(), tet4, 1e-4 * tet4);
    EXPECT_NEAR(one(scene, "heml", s, 1).error(), tet4, 1e-4 * tet4);
  }
  EXPECT_NEAR(one(scene, "tet4", 1, 1, true).error(), tet4, 1e-2 * tet4);
  EXPECT_LT(one(scene, "hex8", 0, 2).error(), one(scene, "hex8", 0, 1).error() / 2);
  EXPECT_LT(one(scene, "tet10", 0, 1).error(), 0.04);
  EXPECT_LT(one(scene, "frames_hex8_linked", 0, 2).error(), one(scene, "hex8", 0, 2).error() / 2);
}

// Beside the numbers of others: beam theory, other codes' finite elements.
TEST(Chart, ReferencesAgreeWithOthers) {
  const auto last = [](const std::string& name) {
    return reference_of(scene_of(name), SOFTSIM_CHART_DATA).answer.u.back();
  };
  const auto own_error = [](const std::string& name) {
    return reference_of(scene_of(name), SOFTSIM_CHART_DATA).errors[0];
  };
  EXPECT_NEAR(last("steel_cantilever")[2], -0.150593, 0.005 * 0.150593);  // Timoshenko
  EXPECT_NEAR(last("soft_cantilever")[2], -6.5090,
              std::max(0.001, 2 * own_error("soft_cantilever")) * 6.5090);
  EXPECT_NEAR(last("soft_cantilever")[0], -1.5985,
              std::max(0.002, 3 * own_error("soft_cantilever")) * 1.5985);
  for (const Scene& scene : scenes())
    for (const double error : reference_of(scene, SOFTSIM_CHART_DATA).errors)
      EXPECT_LT(error, 1e-2) << scene.name;
}

TEST(Chart, EverySceneHasAFrontOfSeveralModelsAtCoarseResolutions) {
  for (const Scene& scene : scenes()) {
    std::set<std::string> solved;
    for (const Model& m : tools().models) {
      if (m.family == "frames" && scene.name == "organ") continue;  // a minute
      try {
        const std::vector<Method> all = tools().methods(scene, m, false);
        const auto stable = std::find_if(all.begin(), all.end(), [](const Method& method) {
          return method.integrator == nullptr ? method.solver->preconditioner == "incomplete_cholesky"
                                              : method.integrator->solver != "-";
        });
        const Point p =
            measure(scene, reference_of(scene, SOFTSIM_CHART_DATA), *stable, scene.resolutions[0], 1e-9);
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
  one(scene_of("compressed_block"), "tet4", 0, 1).write(out, 0);
  const std::string header = Point::header, row = out.str();
  EXPECT_EQ(std::count(header.begin(), header.end(), ','), std::count(row.begin(), row.end(), ','));
  EXPECT_EQ(row.rfind("tet4,static,ldlt,-,,1,double,converged,", 0), 0u) << row;
}

TEST(Choose, FindsTheCheapestOfTheBlock) {
  const Scene scene = scene_of("compressed_block");
  const Reference reference = reference_of(scene, SOFTSIM_CHART_DATA);
  Exploration exploration(scene, reference, {.tolerance = 1e-4, .rate = 25}, 60);
  exploration.run(tools());
  const auto& points = exploration.points();
  const auto good = [](const Point& p) { return p.error() <= 1e-4; };
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
      const double error = moving(scene, "hex8", rule, period / steps, 16).error();
      EXPECT_NEAR(error, expected(-1.0 / 12, steps, 16), 0.05 * error) << rule << " " << steps;
    }
  for (const int cells : {8, 16}) {
    const double error = moving(scene, "hex8", "velocity_verlet", period / 160, cells).error();
    EXPECT_NEAR(error, expected(1.0 / 24, 160, cells), 0.05 * error) << cells;
  }
  EXPECT_GT(moving(scene, "hex8", "backward_euler", period / 80, 16).error(), 0.5);
  const Point unstable = moving(scene, "hex8", "velocity_verlet", period / 20, 32);
  EXPECT_TRUE(unstable.status != "converged" || !(unstable.error() < 10)) << unstable.error();
  const Point p = moving(scene, "frames_hex8", "velocity_verlet", period / 640, 4);
  EXPECT_EQ(p.status, "converged");
  EXPECT_NEAR(p.seconds_per_simulated_second * scene.duration, p.seconds, 1e-12);
  EXPECT_EQ(p.integrator, "velocity_verlet");
}

TEST(Choose, AWishNeedsBoth) {
  const Scene still = scene_of("compressed_block"), moves = scene_of("vibrating_bar");
  Point p;
  p.errors = {0.01};
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
  p.errors.clear();
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
  EXPECT_NE(said("# error displacement 1e-3\nx,y,z,ux,uy,uz\n").find("too few points"), std::string::npos);
  EXPECT_NE(said("1,2,3,0,0,0\n").find("of other points"), std::string::npos);
  EXPECT_NE(said("1,2,3,0,zero,0\n").find("not six numbers"), std::string::npos);
  std::filesystem::remove(folder / "twisted_bar.csv");
  try {
    (void)reference_of(scene, folder);
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("is missing; chart --reference twisted_bar makes it"),
              std::string::npos);
  }
  // what is written is read again, or missed
  Reference r = reference_of(scene, SOFTSIM_CHART_DATA);
  r.errors[1] = not_told;
  write_reference(scene, r, folder);
  try {
    (void)reference_of(scene, folder);
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("does not tell its own error of the force"), std::string::npos)
        << error.what();
  }
  r = reference_of(scene, SOFTSIM_CHART_DATA);
  write_reference(scene, r, folder);
  const Reference again = reference_of(scene, folder);
  EXPECT_LT(relative_distance(again.answer.u, r.answer.u), 1e-8);
  EXPECT_NEAR(again.answer.energy[0], r.answer.energy[0], 1e-8 * std::abs(r.answer.energy[0]));
  EXPECT_LT((again.answer.force - r.answer.force).norm(), 1e-8 * r.answer.force.norm());
  EXPECT_EQ(again.recipe, r.recipe);
  ASSERT_EQ(again.errors.size(), r.errors.size());
  for (std::size_t k = 0; k < r.errors.size(); ++k) EXPECT_NEAR(again.errors[k], r.errors[k], 1e-8);
}

// From a sequence that settles with the square of the spacing the limit itself, whose distance tells the
// error.
TEST(References, AreExtrapolated) {
  const Scene scene = scene_of("twisted_bar");
  const Vec u(1, 2, 3), slope(0.1, -0.2, 0.3), force(0, 0, 5);
  std::array<Answer, 3> answers;
  for (std::size_t k = 0; k < 3; ++k) {
    const double h2 = std::pow(0.25, static_cast<double>(k));
    answers[k] = {{u + h2 * slope, 2 * u}, {-7 + h2}, force + h2 * slope};
  }
  const Reference r = extrapolated(scene, answers);
  EXPECT_LT((r.answer.u[0] - u).norm(), 1e-3);  // the rate is that of relative distances
  EXPECT_LT((r.answer.u[1] - 2 * u).norm(), 1e-12);
  EXPECT_NEAR(r.answer.energy[0], -7, 1e-12);
  EXPECT_LT((r.answer.force - force).norm(), 1e-12);
  EXPECT_NEAR(r.errors[2], 1.0 / 16 / 7 / 2, 1e-12);
}

TEST(Quantities, TellWhatTheySay) {
  // a lattice that is stretched and sheared, and turned about x
  const Scene cube = scene_of("pulled_cube");
  const softsim::Mat3<double> F{{1.2, 0, 0}, {0.3, 0.9, 0.1}, {0, 0, 1.1}};
  Answer a, b;
  const double angle = 1e-4;
  for (const Vec& X : cube.probes) {
    a.u.push_back((F - softsim::Mat3<double>::Identity()) * X);
    b.u.push_back(X[0] * angle * Vec(0, -(X[2] - 0.5), X[1] - 0.5));
  }
  Answer rest;
  rest.u.assign(cube.probes.size(), Vec::Zero());
  EXPECT_NEAR(cube.quantities[2].error(cube, a, rest), F.determinant() - 1, 1e-12);
  EXPECT_NEAR(cube.quantities[1].error(cube, b, rest), angle, 1e-12);
  // a swing that is too slow by 3 %, more than a quarter of a period behind after the twenty
  const Scene bar = scene_of("vibrating_bar");
  const Answer exact = reference_of(bar, SOFTSIM_CHART_DATA).answer;
  Answer slow;
  for (const double t : times_of(bar))
    for (const Vec& X : bar.probes) slow.u.push_back(bar.closed_form(X, 0.97 * t));
  EXPECT_NEAR(bar.quantities[1].error(bar, slow, exact), 0.03, 2e-4);
  EXPECT_LT(bar.quantities[1].error(bar, exact, exact), 1e-12);
  slow.energy = {2, 2.02, 1.9};
  EXPECT_NEAR(bar.quantities[2].error(bar, slow, exact), 0.05, 1e-12);
}

// By Lame's solution where the pressure is small; finite elements tend to it with the square of their size.
TEST(Scenes, TheThickSphereIsRight) {
  const double young = 10, poisson = 0.45, mu = young / (2 * (1 + poisson)),
               bulk = young / (3 * (1 - 2 * poisson)), pressure = 1e-5;
  const ThickSphere sphere(mu, bulk - 2 * mu / 3, pressure);
  for (const double R : {1.0, 1.3, 2.0}) {
    const double a3 = 1, b3 = 8, lame = pressure * a3 / (b3 - a3) * (R / (3 * bulk) + b3 / (4 * mu * R * R));
    EXPECT_NEAR(sphere(R), lame, 1e-5 * lame) << R;
  }
  const Scene scene = scene_of("thick_sphere");
  const double coarse = one(scene, "tet10", 0, 2).error(), fine = one(scene, "tet10", 0, 4).error();
  EXPECT_NEAR(coarse / fine, 4, 0.6);
}

// Whatever knows of rotations turns the block, on one cell; linear statics makes it grow, however fine.
TEST(Scenes, OnlyLinearStaticsChangesTheVolumeOfWhatTurns) {
  const Scene scene = scene_of("turning_block");
  for (const char* model : {"tet4", "heml", "tet4_corotational", "hex8", "tet10", "springs", "frames_hex8"})
    EXPECT_LT(one(scene, model, 0, 1).error(1), 1e-6) << model;
  const double grown = one(scene, "tet4_linear", 0, 4).error(1);
  EXPECT_GT(grown, 0.2);
  EXPECT_NEAR(one(scene, "mass_tensor", 0, 4).error(1), grown, 1e-6);
}

TEST(Scenes, SpringsTwistTheCube) {
  const Scene scene = scene_of("pulled_cube");
  for (const int r : {1, 2, 3}) EXPECT_NEAR(scene.tetrahedra(r).volume(), 1, 1e-12);
  const double springs = one(scene, "springs", 0, 2).error(1), tet4 = one(scene, "tet4", 0, 2).error(1);
  EXPECT_GT(springs, 0.01);
  EXPECT_LT(tet4, springs / 2);
  EXPECT_LT(one(scene, "tet4", 0, 4).error(1), tet4 / 2);
}

// The same body, held in the same places and under the same load, whatever the mesh.
TEST(Scenes, TheOrganStaysTheSame) {
  const Scene scene = scene_of("organ");
  double volume = 0;
  Vec before = Vec::Zero();
  std::size_t held_before = 0;
  for (const int r : {1, 2}) {
    const softsim::TetrahedralMesh mesh = scene.tetrahedra(r);
    Vec load = Vec::Zero();
    for (const softsim::Triangle& t : softsim::boundary_triangles(mesh)) {
      const auto X = [&](std::size_t i) { return mesh.points()[static_cast<std::size_t>(t[i])]; };
      load += (X(1) - X(0)).cross(X(2) - X(0)).norm() / 2 * scene.traction((X(0) + X(1) + X(2)) / 3);
    }
    const auto held =
        static_cast<std::size_t>(std::count_if(mesh.points().begin(), mesh.points().end(),
                                               [&](const Vec& X) { return !scene.support(X).hasNaN(); }));
    if (r == 2) {
      EXPECT_NEAR(mesh.volume(), volume, 1e-12 * volume);
      EXPECT_NEAR(load[2], before[2], 0.05 * before[2]);
      EXPECT_GT(held, 4 * held_before);
      EXPECT_LT(held, 9 * held_before);
    }
    volume = mesh.volume();
    before = load;
    held_before = held;
  }
  EXPECT_GT(before[2], 0);
}

const Solver* solver_named(const std::string& name) {
  const auto& all = tools().solvers;
  const auto found = std::find_if(all.begin(), all.end(), [&](const Solver& s) { return s.name == name; });
  return found == all.end() ? nullptr : &*found;
}
Point reduced(const Scene& scene, const std::string& of, const std::string& solver, int resolution) {
  return measure(scene, reference_of(scene, SOFTSIM_CHART_DATA),
                 {.model = &model(of), .solver = solver_named(solver)}, resolution, 1e-9);
}

// Modes of a beam that hardly bends are as good as its elements, which large deflections are not.
TEST(Reductions, AreAsGoodAsTheirModelWhereTheyShouldBe) {
  const Scene steel = scene_of("steel_cantilever"), soft = scene_of("soft_cantilever");
  const double full = one(soft, "hex8", 0, 2).error();
  // half of the load tells a lot about the rest of it, seven eighths of which hex8 sinks too little
  const Point by_pod = reduced(soft, "hex8", "pod", 2);
  EXPECT_EQ(by_pod.status, "converged");
  EXPECT_NEAR(by_pod.error(), full, 0.05);
  EXPECT_TRUE(by_pod.off_front);
  if (solver_named("modes_20") == nullptr) GTEST_SKIP() << "without modes";
  EXPECT_NEAR(reduced(steel, "tet10", "modes_20", 1).error(), one(steel, "tet10", 0, 1).error(), 5e-3);
  const double straight = reduced(soft, "tet10", "modes_20", 1).error(),
               warped = reduced(soft, "tet10", "warped_modes_20", 1).error();
  EXPECT_GT(straight, 0.2);
  EXPECT_LT(warped, straight / 2);
  EXPECT_THROW((void)reduced(scene_of("turning_block"), "tet4", "modes_20", 1), NotApplicable);
  EXPECT_THROW((void)reduced(soft, "frames_hex8", "warped_modes_20", 1), NotApplicable);
}

TEST(Chart, MethodsHaveNamesOfTheirOwn) {
  for (const char* name : {"organ", "vibrating_bar"}) {
    const Scene scene = scene_of(name);
    std::set<std::string> names;
    std::size_t count = 0;
    for (const Model& m : tools().models)
      for (const bool single : {false, true})
        for (const Method& method : tools().methods(scene, m, single)) {
          names.insert(unmeasured(scene, method, 1).name());
          ++count;
        }
    EXPECT_EQ(names.size(), count);
  }
}

TEST(CommandLine, NamesScenes) {
  EXPECT_THROW((void)scenes_named({"organ"}, "no.msh"), std::invalid_argument);
  EXPECT_EQ(scenes_named({"all"}).size(), scenes().size());
  EXPECT_THROW((void)scenes_named({"cook"}), BadArguments);
}

}  // namespace chart_test
