// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/mesh/domain.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "refusal.hpp"
#include "softsim/mesh/generators.hpp"
#include "softsim/mesh/surface_domain.hpp"
#include "surfaces.hpp"

namespace domain_test {

using softsim::ImplicitDomain, softsim::SurfaceDomain, surfaces::both, surfaces::box, surfaces::domain,
    surfaces::inside_out, surfaces::sphere, surfaces::Surface;
using Vec = softsim::Vec3<double>;
using Box = Eigen::AlignedBox3d;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

double ball(const Vec& x) { return x.norm() - 1; }

static_assert(softsim::Domain<SurfaceDomain>);
static_assert(softsim::Domain<ImplicitDomain<decltype(&ball)>>);
static_assert(!softsim::Domain<softsim::TetrahedralMesh>);
static_assert(softsim::ScalarField<decltype(&ball)>);
static_assert(!softsim::ScalarField<double>);

using refusals::expect_refused;

Vec random_point(std::mt19937& random, double reach) {
  std::uniform_real_distribution<double> u(-reach, reach);
  const double x = u(random), y = u(random), z = u(random);
  return {x, y, z};
}

/// Generalised winding number by the solid angles of all triangles (van Oosterom & Strackee 1983).
double solid_angle_winding(const Surface& s, const Vec& x) {
  double sum = 0;
  for (const auto& v : s.triangles) {
    const auto at = [&](std::size_t k) -> Vec { return s.points[static_cast<std::size_t>(v[k])] - x; };
    const Vec a = at(0), b = at(1), c = at(2);
    const double na = a.norm(), nb = b.norm(), nc = c.norm();
    sum += 2 * std::atan2(a.dot(b.cross(c)), na * nb * nc + a.dot(b) * nc + b.dot(c) * na + c.dot(a) * nb);
  }
  return sum / (4 * std::numbers::pi);
}

/// A sphere with bumps and dents, nowhere convex for long.
Surface bumpy(int levels) {
  Surface s = sphere(levels);
  for (Vec& x : s.points) x *= 1 + 0.35 * std::sin(5 * x[0]) * std::cos(4 * x[1] + 2 * x[2]);
  return s;
}

TEST(SurfaceDomain, VolumeIsThatOfTheMesh) {
  for (const auto& mesh :
       {softsim::cylinder_mesh(0.3, 2, 4, 6), softsim::box_mesh({3, 2, 1}, {1, 2, 3}, {50, -70, 90})}) {
    const SurfaceDomain body = surface_domain(mesh);
    // coordinates of size 100 and lengths of size 1: the rounding of one is 1e-14 of the other
    EXPECT_NEAR(body.volume(), mesh.volume(), 1e-12 * mesh.volume());
    EXPECT_EQ(body.points(), mesh.points());
  }
}

TEST(SurfaceDomain, SphereConvergesWithTheSquareOfItsTriangles) {
  const double exact = 4 * std::numbers::pi / 3 * 8;
  double before = 0;
  for (int levels = 2; levels <= 5; ++levels) {
    const double error = exact - domain(sphere(levels, 2, {5, 6, 7})).volume();
    EXPECT_GT(error, 0) << "inscribed";
    if (levels > 3) {
      EXPECT_NEAR(before / error, 4, 0.1);
    }
    before = error;
  }
}

TEST(SurfaceDomain, AgreesWithTheGeneralisedWindingNumber) {
  const Surface s = both(bumpy(3), sphere(2, 0.4, {1.5, 1.5, 0}));
  const SurfaceDomain body = domain(s);
  std::mt19937 random(7);
  int inside = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec x = random_point(random, 2);
    const double winding = solid_angle_winding(s, x);
    EXPECT_EQ(body.winding_number(x), static_cast<int>(std::lround(winding))) << x.transpose();
    inside += body.contains(x);
  }
  const double expected = body.volume() / 64 * 20000;
  EXPECT_NEAR(inside, expected, 4 * std::sqrt(expected));
}

TEST(SurfaceDomain, RaysThroughEdgesAndVerticesDoNotLeak) {
  // every x and y is that of nodes, and many lie in the planes of triangles
  const auto mesh = softsim::box_mesh({4, 4, 4}, {1, 1, 1});
  const SurfaceDomain body = surface_domain(mesh);
  for (int i = 1; i < 16; ++i)
    for (int j = 1; j < 16; ++j)
      for (int k = 1; k < 16; ++k) EXPECT_TRUE(body.contains(Vec(i, j, k) / 16));
  for (int i = -2; i <= 18; ++i)
    for (int j = -2; j <= 18; ++j)
      for (const int k : {-1, 17})
        for (int axis = 0; axis < 3; ++axis) {
          Vec x;
          x[axis] = k;
          x[(axis + 1) % 3] = i;
          x[(axis + 2) % 3] = j;
          EXPECT_FALSE(body.contains(x / 16)) << x.transpose();
        }
  // an octahedron: poles and equator of its own symmetry planes
  const SurfaceDomain octahedron = domain(sphere(0));
  for (int i = -8; i <= 8; ++i)
    for (int j = -8; j <= 8; ++j)
      for (int k = -8; k <= 8; ++k) {
        const int sum = std::abs(i) + std::abs(j) + std::abs(k);
        if (sum != 4) {
          EXPECT_EQ(octahedron.contains(Vec(i, j, k) / 4), sum < 4) << i << j << k;
        }
      }
}

TEST(SurfaceDomain, TurningTheBodyChangesNothing) {
  const Surface s = bumpy(2);
  const SurfaceDomain body = domain(s);
  const Eigen::Quaterniond turn = Eigen::Quaterniond(0.3, -0.5, 0.7, 0.2).normalized();
  Surface turned = s;
  for (Vec& x : turned.points) x = turn * x;
  const SurfaceDomain other = domain(turned);
  EXPECT_NEAR(other.volume(), body.volume(), 1e-13);
  std::mt19937 random(3);
  for (int i = 0; i < 20000; ++i) {
    const Vec x = random_point(random, 1.3);
    EXPECT_EQ(other.contains(turn * x), body.contains(x)) << x.transpose();
  }
}

TEST(SurfaceDomain, NeedlesAcrossTheGridAreFound) {
  // long thin triangles stand in so many bins that the grid has to become coarser
  Surface s = sphere(3);
  const Vec along = Vec(1, 1, 0).normalized();
  for (Vec& x : s.points) x += 400 * along.dot(x) * along;
  const SurfaceDomain body = domain(s);
  std::mt19937 random(5);
  for (int i = 0; i < 5000; ++i) {
    const Vec x = random_point(random, 0.9), y = x + 400 * along.dot(x) * along;
    EXPECT_EQ(body.contains(y), domain_test::solid_angle_winding(s, y) > 0.5);
  }
}

TEST(SurfaceDomain, CavitiesAndSeveralParts) {
  const SurfaceDomain hollow = domain(both(box({0, 0, 0}, {3, 3, 3}), inside_out(box({1, 1, 1}, {2, 2, 2}))));
  EXPECT_NEAR(hollow.volume(), 26, 1e-12);
  EXPECT_FALSE(hollow.contains({1.5, 1.5, 1.5}));
  EXPECT_TRUE(hollow.contains({1.5, 1.5, 0.5}));
  const SurfaceDomain kernel = domain(both(
      both(box({0, 0, 0}, {5, 5, 5}), inside_out(box({1, 1, 1}, {4, 4, 4}))), box({2, 2, 2}, {3, 3, 3})));
  EXPECT_NEAR(kernel.volume(), 125 - 27 + 1, 1e-12);
  EXPECT_TRUE(kernel.contains({2.5, 2.5, 2.5}));
  const SurfaceDomain touching = domain(both(box({0, 0, 0}, {1, 1, 1}), box({1, 0, 0}, {2, 1, 1})));
  EXPECT_NEAR(touching.volume(), 2, 1e-12);
  EXPECT_TRUE(touching.contains({0.5, 0.5, 0.5}) && touching.contains({1.5, 0.5, 0.5}));
}

TEST(SurfaceDomain, RefusesWhatIsNotClosedAndOriented) {
  const Surface good = box({0, 0, 0}, {1, 1, 1});
  const auto refuse = [](const Surface& s, const std::string& message) {
    expect_refused([&] { (void)domain(s); }, message);
  };
  refuse({good.points, {}}, "surface: no triangles");
  Surface s = sphere(0);
  s.triangles.pop_back();  // {0, 3, 5}
  refuse(s, "edge 0-3: belongs to triangle 3 only, the surface is open there");
  s = sphere(0);
  std::swap(s.triangles[7][0], s.triangles[7][1]);
  refuse(s, "edge 0-3: triangles 3 and 7 run along it in the same direction, one of them is turned over");
  s = sphere(0);
  s.triangles.push_back({0, 2, 3});
  refuse(s, "edge 0-2: is shared by 3 triangles, must be two");
  s = sphere(0);
  s.triangles[2][1] = 6;
  refuse(s, "triangle 2: point 6 is out of range (the surface has 6 points)");
  s.triangles[2][1] = -1;
  refuse(s, "triangle 2: point -1 is out of range (the surface has 6 points)");
  s.triangles[2][1] = 1;
  refuse(s, "triangle 2: point 1 is repeated");
  s = sphere(0);
  s.points[4][1] = nan;
  refuse(s, "point 4: a coordinate is not a finite number");
  refuse(
      inside_out(box({0, 0, 0}, {1, 1, 2})),
      "surface: encloses -2 m^3, it is inside out (triangles must be counter-clockwise seen from outside)");
  s = sphere(0);
  for (Vec& x : s.points) x[2] = 0;
  refuse(s, "surface: encloses 0 m^3, must be positive");
}

TEST(SurfaceDomain, RefusesPartsThatCountWrongly) {
  const auto refuse = [](const Surface& s, const std::string& message) {
    expect_refused([&] { (void)domain(s); }, message);
  };
  refuse(
      both(box({0, 0, 0}, {3, 3, 3}), inside_out(box({5, 0, 0}, {6, 1, 1}))),
      "triangle 12: its part of the surface encloses -1 m^3, it is inside out and no cavity of another part");
  refuse(both(box({0, 0, 0}, {3, 3, 3}), box({1, 1, 1}, {2, 2, 2})),
         "triangle 12: its part of the surface encloses 1 m^3 within another part, which would count twice");
}

TEST(SurfaceDomain, NamesTheEdgeWhereAMeshTouchesItself) {
  // two tetrahedra that share the edge 0-1 alone
  const softsim::TetrahedralMesh mesh({{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {1, 1, 0}, {-1, 0, 0}, {-1, -1, 0}},
                                      {{0, 2, 3, 1}, {0, 4, 5, 1}});
  expect_refused([&] { (void)surface_domain(mesh); }, "edge 0-1: is shared by 4 triangles, must be two");
}

TEST(CutFraction, IsTheVolumeBelowAPlane) {
  EXPECT_NEAR(softsim::detail::cut_fraction(0.2, {1, 0, 0}), 0.3, 1e-6);
  EXPECT_NEAR(softsim::detail::cut_fraction(-0.2, {0, -2, 0}), 0.6, 1e-6);
  EXPECT_NEAR(softsim::detail::cut_fraction(1, {1, 1, 1}), 1.0 / 48, 1e-14);  // a corner: 0.5^3 / 6
  EXPECT_NEAR(softsim::detail::cut_fraction(-1, {1, -1, 1}), 47.0 / 48, 1e-14);
  EXPECT_NEAR(softsim::detail::cut_fraction(0, {3, 2, 7}), 0.5, 1e-14);
  EXPECT_EQ(softsim::detail::cut_fraction(-1, {0, 0, 0}), 1);
  EXPECT_EQ(softsim::detail::cut_fraction(1, {0, 0, 0}), 0);
  // edge wedge g = (1, 1, 0): area 0.4^2 / 2 below x + y = -0.6
  EXPECT_NEAR(softsim::detail::cut_fraction(0.6, {1, 1, 0}), 0.08, 1e-6);
}

TEST(ImplicitDomain, SphereVolumeMeetsItsAccuracy) {
  const Box box(Vec(-1.1, -1.2, -1.05), Vec(1.1, 1.1, 1.3));
  const double exact = 4 * std::numbers::pi / 3;
  for (const double accuracy : {1e-2, 1e-4, 1e-6}) {
    const ImplicitDomain domain(ball, box, {.accuracy = accuracy});
    EXPECT_NEAR(domain.volume(), exact, accuracy * exact);
  }
  EXPECT_NEAR(ImplicitDomain(ball, box).volume(), exact, 1e-4 * exact);
}

TEST(ImplicitDomain, EdgesThinPartsAndSignsOnly) {
  const Box box(Vec(-1.1, -1.2, -1.05), Vec(1.1, 1.1, 1.3));
  const ImplicitDomain cube([](const Vec& x) { return (x - Vec(.1, .05, .2)).cwiseAbs().maxCoeff() - 0.7; },
                            box);
  EXPECT_NEAR(cube.volume(), 2.744, 1e-4 * 2.744);
  const ImplicitDomain inside([](const Vec& x) { return x.norm() < 1 ? -1.0 : 1.0; }, box,
                              {.accuracy = 1e-3});
  EXPECT_NEAR(inside.volume(), 4 * std::numbers::pi / 3, 1e-3 * 4 * std::numbers::pi / 3);
  // 1/20 of the box, slanted
  const Vec n = Vec(1, 2, 3).normalized();
  const ImplicitDomain plate([&](const Vec& x) { return std::max(std::abs(n.dot(x)) - 0.05, x.norm() - 1); },
                             box);
  const double exact = 2 * std::numbers::pi * (0.05 - 0.05 * 0.05 * 0.05 / 3);
  EXPECT_NEAR(plate.volume(), exact, 2e-4 * exact);
  // the box cuts: what lies outside of it does not count
  const ImplicitDomain half(ball, Box(Vec(0, -2, -2), Vec(2, 2, 2)));
  EXPECT_NEAR(half.volume(), 2 * std::numbers::pi / 3, 2e-4);
  EXPECT_FALSE(half.contains({-0.5, 0, 0}));
  EXPECT_TRUE(half.contains({0.5, 0, 0}));
  const ImplicitDomain all([](const Vec&) { return -std::numeric_limits<double>::infinity(); }, box);
  EXPECT_NEAR(all.volume(), box.volume(), 1e-10);  // a sum of 32^3 cells
}

TEST(ImplicitDomain, TakesAGivenVolume) {
  const ImplicitDomain domain(ball, Box(Vec(-1, -1, -1), Vec(1, 1, 1)), {.volume = 4.25});
  EXPECT_EQ(domain.volume(), 4.25);
}

TEST(ImplicitDomain, RefusesBadInput) {
  const Box unit(Vec(-1, -1, -1), Vec(1, 1, 1));
  const auto refuse = [](auto f, const Box& box, const softsim::ImplicitDomainOptions& options,
                         const std::string& message) {
    expect_refused([&] { (void)ImplicitDomain(f, box, options); }, message);
  };
  refuse(ball, Box(Vec(0, 1, 0), Vec(1, 1, 1)), {},
         "domain: axis 1 of the box runs from 1 to 1 m; must be a finite interval");
  refuse(ball, Box(Vec(0, 0, nan), Vec(1, 1, 1)), {},
         "domain: axis 2 of the box runs from nan to 1 m; must be a finite interval");
  refuse(ball, unit, {.accuracy = 0}, "accuracy 0: must lie in (0, 1)");
  refuse(ball, unit, {.accuracy = nan}, "accuracy nan: must lie in (0, 1)");
  refuse(ball, unit, {.volume = 0.0}, "domain: volume 0 m^3 is not positive and finite");
  refuse(ball, unit, {.volume = 9.0}, "implicit domain: volume 9 m^3 is larger than that of the box, 8 m^3");
  refuse([](const Vec&) { return 1.0; }, unit, {}, "implicit domain: f is negative nowhere in the box");
  refuse([](const Vec&) { return nan; }, unit, {}, "implicit domain: f is not a number at (-1, -1, -1)");
  // 1e-9 is out of reach for edges that lie across the cells (a long box: few cells)
  try {
    (void)ImplicitDomain([](const Vec& x) { return (x - Vec(16.1, .55, .47)).lpNorm<1>() - 0.377; },
                         Box(Vec(0, 0, 0), Vec(32, 1, 1)), {.accuracy = 1e-9});
    ADD_FAILURE() << "accepted";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("give the volume or a coarser accuracy than 1e-09"),
              std::string::npos)
        << error.what();
  }
}

}  // namespace domain_test
