// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/integrator/arc_length.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "potential/bodies.hpp"
#include "potential/truss.hpp"
#include "softsim/solver/minres.hpp"
#include "softsim/solver/preconditioner.hpp"

namespace arc_length_test {

using softsim::State, softsim::Status;

using Path = softsim::ArcLength<truss::System>;
using WithoutDirect =
    softsim::ArcLength<truss::System, softsim::MatrixFree, softsim::NoPreconditioner, softsim::Minres>;

// Every point of the path is on the curve in closed form, up to the limit load, down through the reversed one
// and up again on the far side.
template <class Path>
void expect_snap_through(Path path) {
  const truss::Truss t(0.3, 1);
  State<double> q(4);
  double highest = 0, lowest = 0, before = 0.3;
  int steps = 0;
  for (double z = 0.3; z > -0.35; ++steps) {
    ASSERT_LT(steps, 200);
    const auto report = path.step(t.system, q);
    ASSERT_EQ(report.status, Status::converged) << report.reason;
    z = 0.3 + q.point(2)[2];
    EXPECT_LT(z, before) << "always onward";
    before = z;
    EXPECT_NEAR(t.force(z), path.load() * t.load, 1e-8 * t.load);
    if (z > 0) highest = std::max(highest, path.load());
    lowest = std::min(lowest, path.load());
  }
  EXPECT_NEAR(highest, 1, 0.02);
  EXPECT_NEAR(lowest, -1, 0.02);
  EXPECT_GT(path.load(), 0);
}

TEST(ArcLength, FollowsATrussThroughBothLimitPoints) {
  expect_snap_through(Path({.length = 0.03}));
  expect_snap_through(WithoutDirect({.length = 0.03, .linear = {.tolerance = 1e-10}}));
}

TEST(ArcLength, KeepsTheLastEquilibriumIfAStepFails) {
  const truss::Truss t(0.3, 1);
  Path path({.length = 0.03, .tolerance = 1e-14, .max_iterations = 1});
  State<double> q(4);
  const auto report = path.step(t.system, q);
  EXPECT_EQ(report.status, Status::not_converged);
  EXPECT_EQ(report.reason, "arc length: too many iterations");
  EXPECT_EQ(path.load(), 0);
  EXPECT_EQ(q.displacement.norm(), 0);
}

TEST(ArcLength, RefusesBadInputByValue) {
  using bodies::refusal;
  EXPECT_NE(refusal([] { Path({}); }).find("arc length 0: must be positive"), std::string::npos);
  EXPECT_NE(refusal([] { Path({.length = 1, .tolerance = -1}); }).find("tolerance -1"), std::string::npos);
  EXPECT_NE(refusal([] { Path({.length = 1, .max_iterations = 0}); }).find("max_iterations 0"),
            std::string::npos);
  Path path({.length = 1});
  State<double> q(4);
  const truss::Truss unloaded(0.3, 0);
  EXPECT_NE(refusal([&] { (void)path.step(unloaded.system, q); }).find("the norm of the load is 0"),
            std::string::npos);
  truss::Truss moving(0.3, 1);
  moving.system.prescribed.set(0, softsim::Vec3<double>(0.1, 0, 0));
  EXPECT_NE(refusal([&] { (void)path.step(moving.system, q); }).find("0.1 m to go"), std::string::npos);
}

}  // namespace arc_length_test
