// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "../../bench/studies/frame_rods.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

// Short form of the study bench/studies/frame_rods.cpp: the same code on few frames.

namespace frame_rods_test {

using namespace frame_rods;

const Method middle{"", Blend::linear, 1}, two_sections{"", Blend::linear, 2}, linked{"", Blend::linked, 2};

// Closed forms of what the blend makes of a little bending. The rod sinks by 0.3 % of its length: what is not
// linear is of the second order in that.
TEST(FrameRods, BendAsTheBlendPredicts) {
  for (const Method& method : {middle, two_sections, linked})
    for (const int frames : {5, 17})
      EXPECT_NEAR(small_deflection(method, frames), predicted_small_deflection(method, frames), 5e-5);
}

// Until the thickness of the rod shows, about the square of its curvature times t: (10 * 0.01)^2 / 12.
TEST(FrameRods, ConvergeToTheElasticaInTheSecondOrder) {
  const Elastica& tip = tip_loads[2];
  const double coarse = elastica(middle, 5, tip, false), fine = elastica(middle, 9, tip, false);
  EXPECT_NEAR(std::log2(coarse / fine), 2, 0.1);
  EXPECT_LT(fine, 0.01);
  EXPECT_LT(elastica(linked, 17, uniform_loads[1], true), 0.01);
  EXPECT_GT(elastica(two_sections, 9, tip, false), 0.5);  // shear locking
}

TEST(FrameRods, FollowTheBendOf45Degrees) { EXPECT_LT(bend_45(middle, 9, bends[2]), 0.01); }

TEST(FrameRods, RollUpToARing) {
  const double error = roll_up(middle, 17);
  EXPECT_LT(error, 0.03);
  EXPECT_NEAR(error, predicted_roll_up(17), 1e-3);
}

TEST(FrameRods, TwistUniformly) {
  const double expected = std::pow(std::cos(std::numbers::pi / 18), 2);  // 0.96985
  const auto J = torsion(10, 5);
  ASSERT_EQ(J.size(), 9u);
  for (const double j : J) EXPECT_NEAR(j, expected, 1e-9);
}

}  // namespace frame_rods_test
