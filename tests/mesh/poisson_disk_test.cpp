// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/mesh/poisson_disk.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "refusal.hpp"
#include "softsim/mesh/generators.hpp"
#include "softsim/mesh/surface_domain.hpp"
#include "surfaces.hpp"

namespace poisson_disk_test {

using softsim::ImplicitDomain, softsim::poisson_disk, softsim::poisson_disk_count;
using Vec = softsim::Vec3<double>;
using Points = std::vector<Vec>;
using Box = Eigen::AlignedBox3d;
constexpr double pi = std::numbers::pi;

auto unit_ball() {
  return ImplicitDomain([](const Vec& x) { return x.norm() - 1; }, Box(Vec(-1, -1, -1), Vec(1, 1, 1)),
                        {.volume = 4 * pi / 3});
}

using refusals::expect_refused;

double smallest_distance(const Points& points) {
  double smallest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) smallest = std::min(smallest, (points[i] - points[j]).norm());
  return smallest;
}

/// Distances from places in the domain to the nearest point, largest first.
template <class D>
std::vector<double> gaps(const D& domain, const Points& points, int places) {
  softsim::detail::UniformRandom random(99);
  const softsim::PointGrid grid(points);
  std::vector<double> distances;
  while (static_cast<int>(distances.size()) < places) {
    const Vec x = domain.box().min() + domain.box().sizes().cwiseProduct(random.in_cube());
    if (!domain.contains(x)) continue;
    distances.push_back((points[static_cast<std::size_t>(grid.nearest(x, 1)[0])] - x).norm());
  }
  std::sort(distances.begin(), distances.end(), std::greater<>());
  return distances;
}

TEST(UniformRandom, IsTheStandardsGeneratorInUnitSteps) {
  softsim::detail::UniformRandom random(5489);
  double last = 0;
  for (int i = 0; i < 10000; ++i) {
    last = random();
    ASSERT_TRUE(last >= 0 && last < 1);
  }
  // [rand.predef]: the 10000th number of mt19937_64 with this seed
  EXPECT_EQ(last, static_cast<double>(9981545732273789042u >> 11) / 9007199254740992.0);
}

TEST(PoissonDisk, KeepsItsDistanceAndStaysInside) {
  const auto ball = unit_ball();
  for (const double spacing : {1.5, 0.5, 0.2, 0.1}) {
    const Points points = poisson_disk(ball, spacing);
    EXPECT_GE(smallest_distance(points), spacing * (1 - 1e-15));
    for (const Vec& x : points) EXPECT_TRUE(ball.contains(x));
  }
}

TEST(PoissonDisk, IsTheSameForASeed) {
  const auto ball = unit_ball();
  const Points points = poisson_disk(ball, 0.2, {.seed = 5});
  EXPECT_EQ(poisson_disk(ball, 0.2, {.seed = 5}), points);
  EXPECT_NE(poisson_disk(ball, 0.2, {.seed = 6}), points);
  EXPECT_EQ(poisson_disk_count(ball, 150, {.seed = 5}), poisson_disk_count(ball, 150, {.seed = 5}));
}

TEST(PoissonDisk, DensityIsThatOfARandomSaturatedPacking) {
  const double spacing = 0.1;
  const auto n = static_cast<double>(poisson_disk(unit_ball(), spacing).size());
  // Certain: spheres of half the spacing do not overlap and lie in the grown ball (Kepler), and spheres of
  // little more than the spacing cover the ball.
  EXPECT_LT(n, 0.7405 * std::pow(1 + 2 / spacing, 3));
  EXPECT_GT(n, std::pow(1 / spacing, 3) / std::pow(1.1, 3));
  // Random sequential addition saturates at the volume fraction 0.384 in infinite space, 0.733 per spacing^3;
  // the ball behaves as one that is half a spacing larger.
  const double density = n * std::pow(spacing, 3) / (4 * pi / 3 * std::pow(1 + spacing / 2, 3));
  EXPECT_GT(density, 0.6);
  EXPECT_LT(density, 0.74);
  const auto more = static_cast<double>(poisson_disk(unit_ball(), spacing, {.tries = 200}).size());
  EXPECT_GT(more, n);
}

TEST(PoissonDisk, CoversTheDomain) {
  const auto ball = unit_ball();
  const softsim::SurfaceDomain cylinder = surface_domain(softsim::cylinder_mesh(0.5, 2, 3, 4));
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    for (const auto& distances : {gaps(ball, poisson_disk(ball, 0.2, {.seed = seed}), 20000),
                                  gaps(cylinder, poisson_disk(cylinder, 0.2, {.seed = seed}), 20000)}) {
      EXPECT_LT(distances[0], 1.3 * 0.2);
      EXPECT_LT(distances[20], 1.0 * 0.2) << "one place in a thousand";
    }
  }
}

TEST(PoissonDisk, CoversASheetThinnerThanItsCells) {
  const ImplicitDomain sheet([](const Vec& x) { return std::abs(x[2] - 0.3 * x[0] - 0.2) - 0.005; },
                             Box(Vec(0, 0, 0), Vec(1, 1, 1)), {.volume = 0.01});
  const Points points = poisson_disk(sheet, 0.1);
  EXPECT_GE(smallest_distance(points), 0.1 * (1 - 1e-15));
  EXPECT_LT(gaps(sheet, points, 5000)[0], 0.2);
}

TEST(PoissonDisk, CoversPartsThatTheFrontDoesNotReach) {
  const Vec far(6, 1, -2);
  const ImplicitDomain two([&](const Vec& x) { return std::min(x.norm() - 1, (x - far).norm() - 0.6); },
                           Box(Vec(-1, -1, -3), Vec(7, 2, 1)), {.volume = 4 * pi / 3 * (1 + 0.216)});
  const Points points = poisson_disk(two, 0.25);
  const auto in_second = std::count_if(points.begin(), points.end(), [&](const Vec& x) { return x[0] > 3; });
  EXPECT_GT(in_second, 40);
  EXPECT_GT(static_cast<int>(points.size()) - in_second, 180);
  EXPECT_LT(gaps(two, points, 20000)[0], 1.3 * 0.25);
  // parts so small that one point fills them, of a surface
  const auto specks = surfaces::domain(
      surfaces::both(surfaces::both(surfaces::sphere(2), surfaces::sphere(1, 0.1, {3, 0, 0})),
                     surfaces::sphere(1, 0.1, {0, 3, 0})));
  const Points some = poisson_disk(specks, 0.3);
  EXPECT_EQ(std::count_if(some.begin(), some.end(), [](const Vec& x) { return x[0] > 2; }), 1);
  EXPECT_EQ(std::count_if(some.begin(), some.end(), [](const Vec& x) { return x[1] > 2; }), 1);
}

TEST(PoissonDisk, RefusesBadInput) {
  const auto ball = unit_ball();
  const auto refuse = [&](double spacing, int tries, const std::string& message) {
    expect_refused([&] { (void)poisson_disk(ball, spacing, {.tries = tries}); }, message);
  };
  refuse(0, 30, "spacing 0: must be positive and finite");
  refuse(-1, 30, "spacing -1: must be positive and finite");
  refuse(std::numeric_limits<double>::quiet_NaN(), 30, "spacing nan: must be positive and finite");
  refuse(3.5, 30,
         "spacing 3.5: is larger than the domain, whose box measures 3.46410162 m from corner to corner");
  refuse(0.1, 0, "tries 0: must be at least 1");
  EXPECT_THROW((void)poisson_disk(ball, 1e-5), std::invalid_argument);
  const ImplicitDomain nothing([](const Vec&) { return 1.0; }, ball.box(), {.volume = 1.0});
  expect_refused([&] { (void)poisson_disk(nothing, 0.5); }, "spacing 0.5: found no point inside the domain");
  expect_refused([&] { (void)poisson_disk_count(ball, 0); }, "n 0: must be at least 1");
}

TEST(PoissonDiskCount, GivesExactlyThatMany) {
  const auto ball = unit_ball();
  for (const int n : {1, 2, 3, 4, 7, 20, 100, 333, 1000}) {
    const Points points = poisson_disk_count(ball, n);
    EXPECT_EQ(static_cast<int>(points.size()), n);
    // of a set that is maximal but for a fiftieth of its points
    if (n >= 20) {
      const double spacing = smallest_distance(points);
      EXPECT_GT(n * std::pow(spacing, 3) / (4 * pi / 3), 0.6) << n;
      EXPECT_LT(gaps(ball, points, 5000)[0], 1.5 * spacing) << n;
    }
  }
}

TEST(Eliminate, TakesTheMostCrowdedFirst) {
  // pairs at distances 0.1, 0.2, ... far from each other: the closest pairs lose one point each
  Points points;
  for (int i = 0; i < 9; ++i) {
    points.emplace_back(10 * i, 0, 0);
    points.emplace_back(10 * i, 0.1 * (i + 1), 0);
  }
  const Points rest = softsim::detail::eliminate(points, 15, 2);
  EXPECT_EQ(rest.size(), 15u);
  for (int i = 0; i < 9; ++i)
    EXPECT_EQ(std::count_if(rest.begin(), rest.end(), [&](const Vec& x) { return x[0] == 10 * i; }),
              i < 3 ? 1 : 2);
}

}  // namespace poisson_disk_test
