// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/mesh/voxels.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "softsim/mesh/generators.hpp"
#include "softsim/mesh/surface_domain.hpp"
#include "surfaces.hpp"

namespace voxels_test {

using softsim::ImplicitDomain, softsim::Voxel, softsim::Voxels;
using Vec = softsim::Vec3<double>;
using Box = Eigen::AlignedBox3d;
constexpr double ball_volume = 4 * std::numbers::pi / 3;

double sum(const Voxels& voxels) {
  double volume = 0;
  for (const Voxel& voxel : voxels.voxels()) volume += voxel.volume;
  return volume;
}

auto unit_ball() {
  return ImplicitDomain([](const Vec& x) { return x.norm() - 1; }, Box(Vec(-1, -1, -1), Vec(1, 1, 1)),
                        {.volume = ball_volume});
}

TEST(Voxels, ABoxOfWholeCubesIsExact) {
  const Voxels voxels(surface_domain(softsim::box_mesh({1, 1, 1}, {1, 0.5, 0.75}, {3, 4, 5})), 0.125);
  EXPECT_EQ(voxels.cells(), (std::array<int, 3>{8, 4, 6}));
  EXPECT_EQ(voxels.voxels().size(), 8u * 4 * 6);
  EXPECT_NEAR(voxels.scale(), 1, 1e-14);
  EXPECT_EQ(voxels.origin(), Vec(3, 4, 5));
  for (const Voxel& voxel : voxels.voxels()) {
    EXPECT_NEAR(voxel.volume, std::pow(0.125, 3), 1e-16);
    const Vec middle =
        Vec(3, 4, 5) + 0.125 * (Vec(voxel.cell[0], voxel.cell[1], voxel.cell[2]) + Vec::Constant(0.5));
    EXPECT_LT((voxel.centre - middle).norm(), 1e-14);
  }
}

TEST(Voxels, SumToTheVolumeOfTheDomain) {
  for (const double spacing : {1.3, 0.4, 0.11, 0.05})
    for (const int subdivisions : {2, 3, 4}) {
      const Voxels voxels(unit_ball(), spacing, subdivisions);
      EXPECT_NEAR(sum(voxels), ball_volume, 1e-12 * ball_volume);
      for (const Voxel& voxel : voxels.voxels()) {
        EXPECT_GT(voxel.volume, 0);
        EXPECT_LE(voxels.size().maxCoeff(), spacing);
        EXPECT_LE(voxel.volume, voxels.scale() * voxels.size().prod() * (1 + 1e-12));
      }
    }
}

TEST(Voxels, CountTheBoundaryFinely) {
  // counted before scaling: about 2000 cubes at the boundary are wrong by some 5 % each, at random
  const Voxels voxels(unit_ball(), 0.1);
  EXPECT_NEAR(voxels.scale(), 1, 2e-3);
  EXPECT_GT(std::abs(Voxels(unit_ball(), 0.4, 2).scale() - 1), 1e-3) << "two points per axis should do worse";
  double second = 0;
  Vec first = Vec::Zero();
  for (const Voxel& voxel : voxels.voxels()) {
    first += voxel.volume * voxel.centre;
    second += voxel.volume * voxel.centre.squaredNorm();
  }
  EXPECT_LT(first.norm(), 1e-12);
  // int |x|^2 dV = 4 pi / 5; a full cube around its centre lacks h^2 / 4
  EXPECT_NEAR(second, 4 * std::numbers::pi / 5 - ball_volume * 0.01 / 4, 1e-2);
}

TEST(Voxels, FindPartsOfHalfASpacing) {
  const auto plate = [](double thickness) {
    return surfaces::domain(surfaces::box({0, 0, 0.03}, {1, 1, 0.03 + thickness}));
  };
  const auto tall =
      surfaces::both(surfaces::box({0, 0, 0.33}, {1, 1, 0.39}), surfaces::box({2, 0, 0}, {3, 1, 1}));
  const Voxels voxels(surfaces::domain(tall), 0.1);
  double in_plate = 0;
  for (const Voxel& voxel : voxels.voxels())
    if (voxel.centre[0] < 1.5) in_plate += voxel.volume;
  EXPECT_NEAR(in_plate, 0.06, 0.015) << "four points per axis: steps of 0.025";
  EXPECT_NEAR(sum(Voxels(plate(0.001), 0.1)), 0.001, 1e-15) << "the grid fills the box, however thin";
}

TEST(Voxels, RefuseBadInput) {
  const auto refuse = [](double spacing, int subdivisions, const std::string& message) {
    try {
      (void)Voxels(unit_ball(), spacing, subdivisions);
      ADD_FAILURE() << "accepted";
    } catch (const std::invalid_argument& error) {
      EXPECT_EQ(error.what(), message);
    }
  };
  refuse(0, 4, "spacing 0: must be positive and finite");
  refuse(-0.1, 4, "spacing -0.1: must be positive and finite");
  refuse(4, 4, "spacing 4: is larger than the domain, whose box measures 3.46410162 m from corner to corner");
  refuse(1e-4, 4, "spacing 0.0001: too small, the box of the domain would need 8e+12 cells");
  refuse(0.1, 1, "subdivisions 1: must lie in [2, 64]");
  const ImplicitDomain nothing([](const Vec&) { return 1.0; }, Box(Vec(-1, -1, -1), Vec(1, 1, 1)),
                               {.volume = 1.0});
  try {
    (void)Voxels(nothing, 0.1);
    ADD_FAILURE() << "accepted";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "spacing 0.1: no voxel has a point inside the domain");
  }
}

}  // namespace voxels_test
