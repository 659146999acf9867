// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/mesh/sampling.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "refusal.hpp"
#include "softsim/mesh/generators.hpp"
#include "softsim/mesh/surface_domain.hpp"
#include "surfaces.hpp"

namespace sampling_test {

using softsim::ImplicitDomain, softsim::Samples, softsim::VolumeShares, softsim::Voxels;
using Vec = softsim::Vec3<double>;
using Box = Eigen::AlignedBox3d;
constexpr double ball_volume = 4 * std::numbers::pi / 3;

auto unit_ball() {
  return ImplicitDomain([](const Vec& x) { return x.norm() - 1; }, Box(Vec(-1, -1, -1), Vec(1, 1, 1)),
                        {.volume = ball_volume});
}

using refusals::expect_refused;

/// The integral of f by the samples.
template <class Function>
double integral(const Samples& samples, Function f) {
  double sum = 0;
  for (std::size_t i = 0; i < samples.volumes.size(); ++i)
    sum += samples.volumes[i] * f(samples.positions[i]);
  return sum;
}

TEST(GaussLegendre, IsExactUpToItsDegree) {
  for (const int n : {1, 2, 3, 5, 8, 20, 64})
    for (int degree = 0; degree < 2 * n + 2; ++degree) {
      double sum = 0;
      for (const auto& [x, weight] : softsim::gauss_legendre(n)) sum += weight * std::pow(x, degree);
      const double exact = degree % 2 == 1 ? 0 : 2.0 / (degree + 1);
      if (degree < 2 * n) {
        EXPECT_NEAR(sum, exact, 1e-14) << n << ", " << degree;
      } else if (degree == 2 * n && n < 8) {
        EXPECT_GT(std::abs(sum - exact), 1e-6) << n;
      }
    }
  expect_refused([] { (void)softsim::gauss_legendre(0); }, "Gauss points 0: must lie in [1, 64]");
  expect_refused([] { (void)softsim::gauss_legendre(65); }, "Gauss points 65: must lie in [1, 64]");
}

TEST(Samples, ASumOfManyEqualSharesKeepsItsDigits) {
  const std::size_t n = 1000000;
  EXPECT_NEAR((Samples{{}, std::vector<double>(n, 1.0 / n)}.volume()), 1, 4e-16);
}

TEST(Sample, VolumesSumToTheDomain) {
  const softsim::SurfaceDomain cylinder = surface_domain(softsim::cylinder_mesh(0.5, 2, 3, 4));
  for (const VolumeShares shares : {VolumeShares::equal, VolumeShares::voronoi})
    for (const double spacing : {0.6, 0.3, 0.15}) {
      const Samples in_ball = sample(unit_ball(), spacing, {.shares = shares});
      EXPECT_NEAR(in_ball.volume(), ball_volume, 1e-12 * ball_volume);
      const Samples in_cylinder = sample(cylinder, spacing, {.shares = shares});
      EXPECT_NEAR(in_cylinder.volume(), cylinder.volume(), 1e-12 * cylinder.volume());
      for (const Samples& samples : {in_ball, in_cylinder}) {
        ASSERT_EQ(samples.positions.size(), samples.volumes.size());
        for (const double volume : samples.volumes) EXPECT_GT(volume, 0);
      }
      for (const Vec& x : in_cylinder.positions) EXPECT_TRUE(cylinder.contains(x));
    }
}

TEST(Sample, VoronoiSharesIntegrateBetterThanEqualOnes) {
  const auto second_moment = [](const Vec& x) { return x.squaredNorm(); };
  const double exact = 4 * std::numbers::pi / 5;
  const auto error = [&](VolumeShares shares, double spacing) {
    return std::abs(integral(sample(unit_ball(), spacing, {.shares = shares}), second_moment) / exact - 1);
  };
  // equal shares put too much near the surface, where the points lie closer: an error of the first order
  EXPECT_GT(error(VolumeShares::equal, 0.1), 0.03);
  const double fine = error(VolumeShares::voronoi, 0.1);
  EXPECT_LT(fine, 0.01);
  EXPECT_LT(fine, 0.35 * error(VolumeShares::voronoi, 0.2)) << "second order";
}

TEST(Sample, IsTheSameForASeed) {
  const auto make = [](std::uint64_t seed) {
    return sample(unit_ball(), 0.3, {.poisson_disk = {.seed = seed}});
  };
  EXPECT_EQ(make(3).positions, make(3).positions);
  EXPECT_EQ(make(3).volumes, make(3).volumes);
  EXPECT_NE(make(3).positions, make(4).positions);
}

TEST(Sample, TwoBallsGetWhatIsTheirs) {
  const auto balls =
      surfaces::domain(surfaces::both(surfaces::sphere(3), surfaces::sphere(3, 0.5, {4, 0, 0})));
  const double small = surfaces::domain(surfaces::sphere(3, 0.5)).volume();
  const Samples samples = sample(balls, 0.2);
  EXPECT_NEAR(integral(samples, [](const Vec& x) { return x[0] > 2 ? 1.0 : 0.0; }), small, 0.02 * small);
}

TEST(VoronoiSamples, GiveEachPositionWhatIsNearest) {
  const Voxels voxels(surface_domain(softsim::box_mesh({1, 1, 1}, {4, 1, 1})), 0.125);
  // the planes half way lie at x = 1 and x = 2.5; the last two positions are nearest to nothing
  const Samples samples = voronoi_samples(
      voxels, {Vec(0.5, 0.5, 0.5), Vec(1.5, 0.5, 0.5), Vec(3.5, 0.5, 0.5), Vec(9, 9, 9), Vec(3.5, 0.5, 40)});
  ASSERT_EQ(samples.volumes.size(), 3u);
  EXPECT_NEAR(samples.volumes[0], 1, 1e-12);
  EXPECT_NEAR(samples.volumes[1], 1.5, 1e-12);
  EXPECT_NEAR(samples.volumes[2], 1.5, 1e-12);
  EXPECT_EQ(samples.positions[2], Vec(3.5, 0.5, 0.5));
}

TEST(EqualSamples, ShareTheVolume) {
  const Samples samples = equal_samples(unit_ball(), {Vec(0, 0, 0), Vec(0.5, 0, 0), Vec(0, 0.5, 0)});
  for (const double volume : samples.volumes) EXPECT_DOUBLE_EQ(volume, ball_volume / 3);
}

TEST(Sample, RefusesBadInput) {
  expect_refused([] { (void)sample(unit_ball(), 0); }, "spacing 0: must be positive and finite");
  expect_refused([] { (void)sample(unit_ball(), 0.5, {.voxels_per_spacing = 0}); },
                 "voxels_per_spacing 0: must be positive");
  expect_refused([] { (void)sample(unit_ball(), 0.5, {.poisson_disk = {.tries = -1}}); },
                 "tries -1: must be at least 1");
  expect_refused([] { (void)voronoi_samples(Voxels(unit_ball(), 0.5), {}); }, "samples: no positions");
  expect_refused([] { (void)equal_samples(unit_ball(), {}); }, "samples: no positions");
}

}  // namespace sampling_test
