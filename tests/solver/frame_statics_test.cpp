// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "../../bench/studies/frame_statics.hpp"

#include <gtest/gtest.h>

#include <cmath>

// Short form of the study bench/studies/frame_statics.cpp: the same code on few frames.

namespace frame_statics_test {

using namespace frame_statics;

// With one cell across, the section cannot take on the parabolas that nu = 0.3 asks of it in bending; half of
// their size leaves a quarter of that. Samples halfway between frames along the beam leave no error of the
// eight cells along it.
TEST(FrameStatics, ASteelBeamBendsAsTimoshenkoSays) {
  const double timoshenko = -0.150593;
  const auto error = [&](int across) {
    const auto mesh = softsim::box_hexahedra({8, across, across}, steel.size);
    return 1 - with_frames(steel, mesh, Arms::half, Sampling::halfway).u[2] / timoshenko;
  };
  const double coarse = error(1), fine = error(2);
  EXPECT_GT(fine, 0);  // too stiff
  EXPECT_LT(fine, 0.03);
  EXPECT_NEAR(coarse / fine, 4, 1);
}

// A uniform state is met exactly, as closely as the equations are solved (1e-11).
TEST(FrameStatics, ABarContractsUniformlyUnderTraction) {
  for (const Arms arms : {Arms::whole, Arms::half})
    for (const double u : contraction(bar<softsim::HexahedralMesh>(1, 1), arms, false))
      EXPECT_NEAR(u, contraction_of_svk(), 1e-9 * contraction_of_svk());
  EXPECT_NEAR(contraction_of_svk(), linear_contraction, 5e-4 * linear_contraction);
}

// The tie of the rotations adds 3/1000 (h/t)^2 to the stiffness, h/t = 1 here.
TEST(FrameStatics, WholeArmsTakeHalfOfAMoment) {
  EXPECT_NEAR(deflection_by_moment(1.5, {3, 1, 1}, Arms::whole), 0.5, 0.01);
  EXPECT_NEAR(deflection_by_moment(1.5, {3, 1, 1}, Arms::half), 1, 0.02);
}

}  // namespace frame_statics_test
