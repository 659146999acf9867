// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
// Runs the example `deform` as a user would. DEFORM_PROGRAM and DEFORM_ORGAN are the paths of the program and
// of the mesh that it ships with.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "examples/run_deform.hpp"

namespace softsim::test {
namespace deform_test {

const Words tissue = words("--young 10000 --poisson 0.4 --density 1060");
const Words base = words("--fix zmin --fix-depth 0.2 --no-picture --out out");

/// Arguments for the shipped mesh, held at its bottom, with results in `out` and no picture.
Words organ(const std::string& more) { return Words{DEFORM_ORGAN} + tissue + base + words(more); }

Vec3<double> sum(const std::vector<Vec3<double>>& v) {
  Vec3<double> total = Vec3<double>::Zero();
  for (const Vec3<double>& x : v) total += x;
  return total;
}

double largest_norm(const std::vector<Vec3<double>>& v) {
  double largest = 0;
  for (const Vec3<double>& x : v) largest = std::max(largest, x.norm());
  return largest;
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

/// Runs to the end and gives the summary.
Summary good(Deform& deform, const Words& arguments, const std::string& out = "out") {
  const Ended ended = deform.run(arguments);
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_EQ(ended.err, "");
  const Summary summary(deform.folder.path(out));
  EXPECT_EQ(summary.text("status"), "\"converged\"");
  EXPECT_EQ(summary["inverted_tetrahedra"], 0);
  return summary;
}

Summary good(const std::string& more) {
  Deform deform;
  return good(deform, organ(more));
}

TEST(DeformExample, HelpNamesEveryOption) {
  Deform deform;
  const Ended ended = deform.run({"--help"});
  EXPECT_EQ(ended.code, 0);
  EXPECT_EQ(ended.err, "");
  for (const char* option :
       {"--static",     "--steps",       "--dt",         "--material", "--young", "--poisson",
        "--density",    "--fix SIDE",    "--fix-depth",  "--gravity",  "--pull",  "--mass",
        "--integrator", "--newton",      "--tolerance",  "--scale",    "--out",   "--rayleigh",
        "--region",     "--write-every", "--no-picture", "SI units"})
    EXPECT_NE(ended.out.find(option), std::string::npos) << option;
  EXPECT_EQ(deform.folder.number_of_files(), 0U);
}

class EveryMaterial : public ::testing::TestWithParam<std::string> {};

TEST_P(EveryMaterial, ReachesStaticEquilibrium) {
  Deform deform;
  const Summary s = good(
      deform, organ("--static --gravity 0,0.5,-1 --pull xmax:-0.02,0.01,0 --pull ymin:0,0,0.03 --material " +
                    GetParam()));
  for (const char* key : {"nodes", "tetrahedra", "volume", "mass", "status", "max_displacement",
                          "strain_energy", "inverted_tetrahedra", "newton_iterations", "linear_iterations",
                          "seconds_solving", "real_time_factor"})
    EXPECT_TRUE(s.has(key)) << key;
  EXPECT_EQ(s["nodes"], 738);
  EXPECT_EQ(s["tetrahedra"], 3013);
  EXPECT_NEAR(s["volume"], 1.0998e-3, 1e-7);  // as the mesh's README has it, to five digits
  EXPECT_NEAR(s["mass"], 1060 * s["volume"], 1e-12);
  EXPECT_GE(s["newton_iterations"], 1);
  EXPECT_GE(s["linear_iterations"], s["newton_iterations"]);
  EXPECT_GT(s["seconds_solving"], 0);

  const Series series(deform.folder.path("out"));
  ASSERT_EQ(series.states.size(), 2U);
  const State &rest = series.states[0], &loaded = series.states[1];
  const auto u = loaded.vectors("displacement"), f = loaded.vectors("force"), load = rest.vectors("force");
  ASSERT_EQ(u.size(), 738U);
  EXPECT_EQ(largest_norm(rest.vectors("displacement")), 0);
  EXPECT_DOUBLE_EQ(largest_norm(u), s["max_displacement"]);
  const auto x = loaded.vectors("Points"), X = rest.vectors("Points");
  for (std::size_t i = 0; i < x.size(); ++i) EXPECT_LT((x[i] - X[i] - u[i]).norm(), 1e-15);

  // Inner forces have no resultant, at rest or loaded; the rest is rounding of some 10 N.
  const Vec3<double> applied = s["mass"] * Vec3<double>(0, 0.5, -1) + Vec3<double>(-0.02, 0.01, 0.03);
  EXPECT_LT((sum(load) - applied).norm(), 1e-11);
  EXPECT_LT((sum(f) - applied).norm(), 1e-11);
  double unbalanced = 0, external = 0, work = 0;
  std::size_t held = 0;
  for (std::size_t i = 0; i < u.size(); ++i) {
    external += load[i].squaredNorm();
    work += load[i].dot(u[i]);
    if (u[i].norm() == 0)
      ++held;
    else
      unbalanced += f[i].squaredNorm();
  }
  EXPECT_EQ(static_cast<double>(held), s["fixed_nodes"]);
  EXPECT_LE(std::sqrt(unbalanced), 1e-6 * std::sqrt(external));  // the promised tolerance
  // Clapeyron: half the work of dead loads is stored. Exact for the small-strain law, whose energy is second
  // order in the residual; strains of a tenth leave the others near it.
  EXPECT_NEAR(s["strain_energy"], work / 2, (GetParam() == "linear" ? 1e-5 : 0.2) * work);

  const auto J = loaded.scalars("J");
  ASSERT_EQ(J.size(), 3013U);
  EXPECT_GT(*std::min_element(J.begin(), J.end()), 0.5);
  EXPECT_LT(*std::max_element(J.begin(), J.end()), 1.5);
  for (const double at_rest : rest.scalars("J")) EXPECT_NEAR(at_rest, 1, 1e-12);
  const auto principal = loaded.vectors("principal_cauchy_stress");
  const auto von_mises = loaded.scalars("von_mises"), density = loaded.scalars("strain_energy_density");
  ASSERT_EQ(principal.size(), J.size());
  ASSERT_EQ(density.size(), J.size());
  for (std::size_t t = 0; t < J.size(); ++t) {
    const Vec3<double>& p = principal[t];
    const double squared =
        ((p[0] - p[1]) * (p[0] - p[1]) + (p[1] - p[2]) * (p[1] - p[2]) + (p[2] - p[0]) * (p[2] - p[0])) / 2;
    EXPECT_NEAR(von_mises[t], std::sqrt(squared), 1e-9 * (1 + von_mises[t]));
  }
}
INSTANTIATE_TEST_SUITE_P(Laws, EveryMaterial,
                         ::testing::Values("svk", "neo-hookean", "stable-neo-hookean", "linear"),
                         [](const auto& law) {
                           std::string name = law.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

TEST(DeformExample, LawsAgreeUnderASmallLoad) {
  // Strains are of order 1e-4, and laws differ in second order.
  const std::string load = "--static --gravity 0,0,-0.01 --material ";
  const double linear = good(load + "linear")["max_displacement"];
  for (const char* law : {"svk", "neo-hookean", "stable-neo-hookean"})
    EXPECT_NEAR(good(load + law)["max_displacement"], linear, 2e-3 * linear) << law;
}

TEST(DeformExample, ABackwardEulerRunTellsItsProgressAndWritesASeries) {
  Deform deform;
  const Ended ended =
      deform.run(organ("--material neo-hookean --steps 7 --dt 0.01 --gravity 0,0,-9.81 --write-every 3"));
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_EQ(ended.err, "");
  EXPECT_EQ(count(ended.out, "real-time factor"), 7U) << ended.out;
  const std::size_t last = ended.out.find("step 7/7");
  ASSERT_NE(last, std::string::npos) << ended.out;
  const std::string line = ended.out.substr(last, ended.out.find('\n', last) - last);
  for (const char* part : {"time 0.07 s", "iterations", "residual", "real-time factor"})
    EXPECT_NE(line.find(part), std::string::npos) << line;

  const Series series(deform.folder.path("out"));
  ASSERT_EQ(series.times.size(), 4U);
  const double expected[] = {0, 0.03, 0.06, 0.07};
  for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(series.times[k], expected[k], 1e-12);
  EXPECT_FALSE(std::filesystem::exists(deform.folder.path("out/deform.png")));  // --no-picture

  const Summary s(deform.folder.path("out"));
  EXPECT_EQ(s["newton_iterations"], 7);  // one linearised solve a step
  EXPECT_GT(s["max_displacement"], 0);
  EXPECT_DOUBLE_EQ(s["max_displacement"], largest_norm(series.states.back().vectors("displacement")));
  EXPECT_GT(largest_norm(series.states.back().vectors("velocity")), 0);
  EXPECT_NEAR(s["real_time_factor"] * s["seconds_solving"], 0.07, 1e-9);
}

TEST(DeformExample, IntegratorsAndMassesAgreeOnAShortFall) {
  // Under a constant force both Euler methods move alike, so that they differ only by what has deformed until
  // then. Consistent mass differs more, by the size of the elements. Found: 0.002, 0.04 and, both at once,
  // 0.008.
  const std::string fall = "--material stable-neo-hookean --gravity 0,0,-9.81 --steps 50 --dt 2e-4 ";
  const Summary newton = good(fall + "--newton --integrator backward-euler --mass lumped");
  const Summary linearised = good(fall);
  const Summary consistent = good(fall + "--newton --mass consistent");
  const Summary explicit_lumped = good(fall + "--integrator semi-explicit");
  const Summary explicit_consistent = good(fall + "--integrator semi-explicit --mass consistent");
  const double moved = newton["max_displacement"];
  EXPECT_GT(moved, 1e-4);
  EXPECT_GT(newton["newton_iterations"], 50);
  EXPECT_EQ(explicit_lumped["linear_iterations"], 0);
  EXPECT_GT(explicit_consistent["linear_iterations"], 50);
  EXPECT_NEAR(linearised["max_displacement"], moved, 1e-3 * moved);
  EXPECT_NEAR(explicit_lumped["max_displacement"], moved, 0.01 * moved);
  EXPECT_NE(explicit_lumped.text("max_displacement"), linearised.text("max_displacement"));
  EXPECT_NEAR(consistent["max_displacement"], moved, 0.1 * moved);
  EXPECT_NE(consistent.text("max_displacement"), newton.text("max_displacement"));
  EXPECT_NEAR(explicit_consistent["max_displacement"], consistent["max_displacement"], 0.03 * moved);
  EXPECT_NEAR(consistent["mass"], newton["mass"], 1e-12);
}

TEST(DeformExample, NewtonConvergesToTheToleranceAskedFor) {
  const std::string load = "--material svk --gravity 0,0,-2 --steps 2 --dt 0.01 --newton --tolerance ";
  EXPECT_LE(good(load + "1e-3")["residual"], 1e-3);
  const Summary tight = good(load + "1e-9");
  EXPECT_LE(tight["residual"], 1e-9);
  EXPECT_GT(tight["newton_iterations"], good(load + "0.1")["newton_iterations"]);
}

TEST(DeformExample, RayleighDampingTakesEnergyAway) {
  const std::string fall = "--material linear --gravity 0,0,-9.81 --steps 10 --dt 0.005 ";
  const double free = good(fall)["kinetic_energy"];
  EXPECT_LT(good(fall + "--rayleigh 50,0")["kinetic_energy"], 0.5 * free);
  EXPECT_LT(good(fall + "--rayleigh 0,0.05")["kinetic_energy"], 0.9 * free);
  EXPECT_EQ(good(fall + "--rayleigh 0,0").text("max_displacement"), good(fall).text("max_displacement"));
}

TEST(DeformExample, AValueMayFollowAnEqualsSignAndStartWithAMinus) {
  const Summary s = good("--material=svk --static --gravity=-1,-0.5,-.25 --pull=xmax:-0.01,0,0");
  const Summary t = good("--material svk --static --gravity -1,-0.5,-.25 --pull xmax:-0.01,0,0");
  EXPECT_EQ(s.text("max_displacement"), t.text("max_displacement"));
  EXPECT_GT(s["max_displacement"], 0);
}

TEST(DeformExample, SeveralSidesAreHeldAtOnce) {
  const std::string load = "--material svk --static --gravity 0,0,-1 ";
  const Summary one = good(load), two = good(load + "--fix zmax");
  EXPECT_GT(two["fixed_nodes"], one["fixed_nodes"]);
  EXPECT_LT(two["max_displacement"], one["max_displacement"]);
}

TEST(DeformExample, CoordinatesAreScaled) {
  const Summary s = good("--material svk --static --gravity 0,0,-0.1"),
                t = good("--material svk --static --gravity 0,0,-0.1 --scale 2");
  EXPECT_NEAR(t["volume"], 8 * s["volume"], 1e-12);
  EXPECT_NEAR(t["max_displacement"], 4 * s["max_displacement"],
              0.05 * t["max_displacement"]);  // rho g L^2 / E, small strain
}

TEST(DeformExample, RegionsHaveTheirOwnParameters) {
  const std::string load = "--material svk --static --gravity 0,0,-1 ";
  const Summary one = good(load), left = good(load + "--region 2:40000,0.3,500"),
                both = good(load + "--region 1:40000,0.4,500 --region 2:40000,0.4,500");
  EXPECT_LT(left["mass"], one["mass"]);
  EXPECT_GT(left["mass"], both["mass"]);
  EXPECT_NEAR(both["mass"], 500 * both["volume"], 1e-12);
  EXPECT_LT(left["max_displacement"], one["max_displacement"]);
  // Twice lighter and four times stiffer: an eighth of it, but for second-order effects of strains of some
  // hundredths.
  EXPECT_NEAR(both["max_displacement"], one["max_displacement"] / 8, 0.02 * one["max_displacement"]);
}

TEST(DeformExample, ShippedOrganNeedsNoArguments) {
  Deform deform;
  const Summary s = good(deform, words("--no-picture --steps 2"), "out/organ");
  EXPECT_EQ(s["tetrahedra"], 3013);
  EXPECT_GT(s["max_displacement"], 0);
}

TEST(DeformExample, DrawsAPicture) {
  // The program takes the first Python that can; so does this test.
  const auto draws = [](const std::string& python) {
    return std::system((python + " -c 'import numpy, matplotlib' >/dev/null 2>&1").c_str()) == 0;
  };
  if (!draws("python3") && !draws("/usr/bin/python3")) GTEST_SKIP() << "no Python with matplotlib";
  Deform deform;
  const Ended ended = deform.run(words("--steps 1 --out out"));
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_NE(ended.out.find("deform.png"), std::string::npos) << ended.out;
  const std::string png = slurp(deform.folder.path("out/deform.png"));
  ASSERT_GT(png.size(), 1000U);
  EXPECT_EQ(png.substr(1, 3), "PNG");
  EXPECT_NE(png.find("IEND"), std::string::npos);
}

TEST(DeformExample, ResultsAreReplacedByTheNextRun) {
  Deform deform;
  good(deform, organ("--material svk --gravity 0,0,-1 --steps 5 --dt 0.01"));
  good(deform, organ("--material svk --gravity 0,0,-1 --static"));
  EXPECT_EQ(Series(deform.folder.path("out")).states.size(), 2U);
}
}  // namespace deform_test
}  // namespace softsim::test
