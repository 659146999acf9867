// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "refusal.hpp"
#include "softsim/mesh/curve_samples.hpp"
#include "softsim/mesh/surface_samples.hpp"
#include "surfaces.hpp"

namespace thin_samples_test {

using softsim::Samples, softsim::Section, softsim::sample_curve, softsim::sample_surface,
    softsim::sample_surface_apart, softsim::Triangle;
using Vec = softsim::Vec3<double>;
constexpr double pi = std::numbers::pi, nan = std::numeric_limits<double>::quiet_NaN();

using refusals::expect_refused;

/// Area, first moments, second moments along y and z, mixed.
std::array<double, 6> moments(const Section& section) {
  std::array<double, 6> m{};
  for (const auto& [y, z, area] : section) {
    const double terms[] = {1, y, z, y * y, z * z, y * z};
    for (std::size_t i = 0; i < 6; ++i) m[i] += area * terms[i];
  }
  return m;
}

TEST(Section, SecondMomentsOfAreaAreExact) {
  const double w = 0.3, h = 0.5, r = 0.2;
  for (const int order : {2, 3, 5}) {
    const auto m = moments(softsim::rectangle(w, h, order));
    const double exact[] = {w * h, 0, 0, w * w * w * h / 12, w * h * h * h / 12, 0};
    for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(m[i], exact[i], 1e-16) << order << ", " << i;
  }
  for (const int points : {4, 7}) {
    const auto m = moments(softsim::disc(r, points));
    const double I = pi * r * r * r * r / 4, exact[] = {pi * r * r, 0, 0, I, I, 0};
    for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(m[i], exact[i], 1e-16) << points << ", " << i;
  }
  EXPECT_NEAR(moments(softsim::disc(r, 1))[0], pi * r * r, 1e-16);
  // degree 4 of the disc, int y^4 dA = pi r^6 / 8 and int y^2 z^2 dA = pi r^6 / 24: with 7 points alone
  const auto fourth = [&](int points) {
    std::array<double, 2> sum{};
    for (const auto& [y, z, area] : softsim::disc(r, points)) {
      sum[0] += area * y * y * y * y;
      sum[1] += area * y * y * z * z;
    }
    return sum;
  };
  EXPECT_NEAR(fourth(7)[0], pi * std::pow(r, 6) / 8, 1e-18);
  EXPECT_NEAR(fourth(7)[1], pi * std::pow(r, 6) / 24, 1e-18);
  EXPECT_GT(std::abs(fourth(4)[1] - pi * std::pow(r, 6) / 24), 1e-6);
}

TEST(SampleCurve, PiecesAreEqualAndVolumesSum) {
  const std::vector<Vec> bent{{0, 0, 0}, {1, 0, 0}, {1, 2, 0}, {1, 2, 0.7}};
  for (const int n : {1, 2, 7, 100}) {
    const Samples samples = sample_curve(bent, softsim::rectangle(0.02, 0.03, 3), n, {0, 0, 1});
    ASSERT_EQ(samples.positions.size(), static_cast<std::size_t>(9 * n));
    EXPECT_NEAR(samples.volume(), 3.7 * 0.02 * 0.03, 1e-12 * 3.7 * 0.02 * 0.03);
  }
  const Samples line = sample_curve(bent, softsim::disc(0.1, 1), 37);
  for (std::size_t i = 0; i < 37; ++i) {
    const double s = 0.1 * (static_cast<double>(i) + 0.5);
    const Vec x = s < 1 ? Vec(s, 0, 0) : s < 3 ? Vec(1, s - 1, 0) : Vec(1, 2, s - 3);
    EXPECT_LT((line.positions[i] - x).norm(), 1e-13) << i;
  }
}

TEST(SampleCurve, AxesOfTheSectionStandAsGiven) {
  const Section section = softsim::rectangle(0.4, 0.1, 2);
  const std::vector<Vec> along_x{{0, 0, 0}, {1, 0, 0}};
  // only the part of (5, 1, 1) across the curve matters: the first axis is (0, 1, 1) / sqrt 2
  const Samples samples = sample_curve(along_x, section, 1, {5, 1, 1});
  const Vec first = Vec(0, 1, 1).normalized(), second = Vec(0, -1, 1).normalized();
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec arm = samples.positions[i] - Vec(0.5, 0, 0);
    EXPECT_NEAR(arm.dot(first), section[i].y, 1e-15);
    EXPECT_NEAR(arm.dot(second), section[i].z, 1e-15);
    EXPECT_NEAR(arm[0], 0, 1e-15);
  }
}

TEST(SampleCurve, ParallelTransportDoesNotTwist) {
  // a circle in a slanted plane: its normal stays the first axis all the way, the second stays radial
  const Eigen::Quaterniond turn = Eigen::Quaterniond(0.4, 0.2, -0.7, 0.5).normalized();
  std::vector<Vec> circle;
  for (int i = 0; i <= 200; ++i) {
    const double a = 1.9 * pi * i / 200;
    circle.push_back(turn * Vec(std::cos(a), std::sin(a), 0));
  }
  const Section section{{0.1, 0, 1}, {0, 0.1, 1}};
  const Vec normal = turn * Vec(0, 0, 1);
  const Samples samples = sample_curve(circle, section, 50, normal);
  for (std::size_t i = 0; i < 100; i += 2) {
    EXPECT_NEAR(samples.positions[i].dot(normal), 0.1, 1e-13);
    EXPECT_NEAR(samples.positions[i + 1].dot(normal), 0, 1e-13);
    EXPECT_NEAR(std::abs(samples.positions[i + 1].norm() - 1), 0.1, 1e-3);
  }
  // around a corner of a cube, x -> y -> z -> x: a vector carried around an octant turns by a right angle
  const std::vector<Vec> loop{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {1, 1, 1}, {2, 1, 1}};
  const Samples carried = sample_curve(loop, {{1, 0, 1}}, 4, {0, 1, 0});
  EXPECT_LT((carried.positions[0] - Vec(0.5, 0, 0) - Vec(0, 1, 0)).norm(), 1e-14);
  EXPECT_LT((carried.positions[3] - Vec(1.5, 1, 1) - Vec(0, 0, 1)).norm(), 1e-14);
}

TEST(SampleCurve, AnyAxisServesADisc) {
  for (const Vec& end : {Vec(1, 0, 0), Vec(0, -1, 0), Vec(0, 0, 2), Vec(1, 1, 1)}) {
    const Samples samples = sample_curve({Vec(0, 0, 0), end}, softsim::disc(0.1, 7), 3);
    EXPECT_NEAR(samples.volume(), pi * 0.01 * end.norm(), 1e-15);
    for (std::size_t i = 1; i < 7; ++i)
      EXPECT_NEAR((samples.positions[i] - samples.positions[0]).dot(end), 0, 1e-15);
  }
}

TEST(SampleCurve, RefusesBadInput) {
  const Section disc = softsim::disc(0.1);
  const auto refuse = [&](const std::vector<Vec>& curve, const Section& section, int n, const Vec& axis,
                          const std::string& message) {
    expect_refused([&] { (void)sample_curve(curve, section, n, axis); }, message);
  };
  const std::vector<Vec> line{{0, 0, 0}, {1, 0, 0}};
  refuse({{0, 0, 0}}, disc, 1, {0, 1, 0}, "curve: 1 points, must be at least 2");
  refuse({{0, 0, 0}, {nan, 0, 0}}, disc, 1, {0, 1, 0}, "curve: point 1: a coordinate is not a finite number");
  refuse({{0, 0, 0}, {1, 0, 0}, {1, 0, 0}}, disc, 1, {0, 1, 0}, "curve: segment 1 has no length");
  refuse({{0, 0, 0}, {1, 0, 0}, {0.5, 0, 0}}, disc, 1, {0, 1, 0},
         "curve: segment 1 folds back on the one before");
  refuse(line, {}, 1, {0, 1, 0}, "curve: the section has no points");
  refuse(line, disc, 0, {0, 1, 0}, "n 0: must be at least 1");
  for (const Vec& axis : {Vec(2, 0, 0), Vec(0, 0, 0), Vec(0, nan, 0)})
    EXPECT_THROW((void)sample_curve(line, disc, 1, axis), std::invalid_argument);
  refuse(line, disc, 1, {2, 0, 0},
         "width_axis (2, 0, 0): must be finite and not along the start of the curve");
  expect_refused([] { (void)softsim::disc(0.1, 5); }, "disc: points 5: must be 1, 4 or 7");
  expect_refused([] { (void)softsim::disc(0); }, "disc: radius 0: must be positive and finite");
  expect_refused([] { (void)softsim::rectangle(1, -2); },
                 "rectangle 1 x -2: sides must be positive and finite");
  expect_refused([] { (void)softsim::rectangle(1, 2, 0); }, "Gauss points 0: must lie in [1, 64]");
}

const std::vector<Vec> square{{0, 0, 1}, {2, 0, 1}, {2, 3, 1}, {0, 3, 1}};
const std::vector<Triangle> halves{{0, 1, 2}, {0, 2, 3}};

double area_of(const surfaces::Surface& s) {
  double area = 0;
  for (const Triangle& v : s.triangles) {
    const auto at = [&](std::size_t k) { return s.points[static_cast<std::size_t>(v[k])]; };
    area += (at(1) - at(0)).cross(at(2) - at(0)).norm() / 2;
  }
  return area;
}

TEST(SampleSurface, GaussPointsIntegrateAFlatPlateExactly) {
  const double t = 0.1;
  for (const auto& [points, degree] : {std::pair{1, 1}, {3, 2}, {6, 4}})
    for (const int layers : {1, 2, 3}) {
      const Samples samples = sample_surface(square, halves, t, layers, points);
      ASSERT_EQ(samples.positions.size(), static_cast<std::size_t>(2 * points * layers));
      EXPECT_NEAR(samples.volume(), 6 * t, 1e-12 * 6 * t);
      double xs = 0, y4 = 0, bending = 0;
      for (std::size_t i = 0; i < samples.volumes.size(); ++i) {
        const Vec& x = samples.positions[i];
        xs += samples.volumes[i] * std::pow(x[0], std::min(degree, 2));
        y4 += samples.volumes[i] * std::pow(x[1], 4);
        bending += samples.volumes[i] * (x[2] - 1) * (x[2] - 1);
      }
      EXPECT_NEAR(xs, degree == 1 ? 6 * t : 8 * t, 1e-14);  // int x = 6 t, int x^2 = 8 t
      if (degree == 4) {
        EXPECT_NEAR(y4, 2 * 243.0 / 5 * t, 1e-13);
      }
      if (layers > 1) {
        EXPECT_NEAR(bending, 6 * t * t * t / 12, 1e-17);
      }
    }
}

TEST(SampleSurface, CurvedSurfacesGetAreaTimesThickness) {
  const surfaces::Surface s = surfaces::sphere(4);
  const double t = 0.2;
  const Samples samples = sample_surface(s.points, s.triangles, t, 3);
  EXPECT_NEAR(samples.volume(), area_of(s) * t, 1e-12 * area_of(s) * t);
  // as the docstring says: the shell of radius 1 has t^2 / 12 more than its area, 4 pi, times thickness
  const double shell = 4 * pi / 3 * (std::pow(1.1, 3) - std::pow(0.9, 3));
  EXPECT_NEAR(samples.volume() / area_of(s) * 4 * pi / shell, 1 / (1 + t * t / 12), 1e-12);
  for (std::size_t i = 0; i < samples.positions.size(); ++i) {
    const double z = std::sqrt(0.6) * t / 2 * (static_cast<double>(i % 3) - 1);  // lowest layer first
    EXPECT_NEAR(samples.positions[i].norm(), 1 + z, 5e-3);
  }
}

TEST(SampleSurfaceApart, KeepsItsDistanceCoversAndSums) {
  const surfaces::Surface s = surfaces::sphere(3);
  const double spacing = 0.2, t = 0.05, area = area_of(s);
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    const Samples middle = sample_surface_apart(s.points, s.triangles, t, 1, spacing, {.seed = seed});
    EXPECT_NEAR(middle.volume(), area * t, 1e-12 * area * t);
    const auto n = static_cast<double>(middle.positions.size());
    // random sequential addition of discs saturates at 0.547 of the area: 0.697 per spacing^2
    EXPECT_NEAR(n * spacing * spacing / area, 0.67, 0.06);
    for (std::size_t i = 0; i < middle.positions.size(); ++i) {
      EXPECT_GT(middle.volumes[i], 0);
      for (std::size_t j = 0; j < i; ++j)
        ASSERT_GE((middle.positions[i] - middle.positions[j]).norm(), spacing * (1 - 1e-15));
    }
    const softsim::PointGrid grid(middle.positions);
    for (const Vec& x : s.points)
      EXPECT_LT((middle.positions[static_cast<std::size_t>(grid.nearest(x, 1)[0])] - x).norm(),
                1.4 * spacing);
    const Samples layers = sample_surface_apart(s.points, s.triangles, t, 3, spacing, {.seed = seed});
    EXPECT_EQ(layers.positions.size(), 3 * middle.positions.size());
    EXPECT_NEAR(layers.volume(), area * t, 1e-12 * area * t);
    EXPECT_EQ(sample_surface_apart(s.points, s.triangles, t, 1, spacing, {.seed = seed}).positions,
              middle.positions);
  }
}

TEST(SampleSurfaceApart, DoesNotMindTheTriangles) {
  // a plate of two large triangles and the same of many, far from even
  const Samples coarse = sample_surface_apart(square, halves, 0.1, 1, 0.15);
  EXPECT_NEAR(coarse.volume(), 0.6, 0.6e-12);
  const Vec mean = [&] {
    Vec sum = Vec::Zero();
    for (std::size_t i = 0; i < coarse.volumes.size(); ++i) sum += coarse.volumes[i] * coarse.positions[i];
    return Vec(sum / 0.6);
  }();
  EXPECT_LT((mean - Vec(1, 1.5, 1)).norm(), 0.01);
  const Samples large = sample_surface_apart(square, halves, 0.1, 2, 3.5);
  EXPECT_GE(large.positions.size(), 2u);
  EXPECT_NEAR(large.volume(), 0.6, 1e-13);
}

TEST(SampleSurface, RefusesBadInput) {
  expect_refused([] { (void)sample_surface(square, {}, 0.1, 1); }, "surface: no triangles");
  expect_refused(
      [] {
        (void)sample_surface(square, {{0, 1, 4}}, 0.1, 1);
      },
      "triangle 0: point 4 is out of range (the surface has 4 points)");
  expect_refused(
      [] {
        (void)sample_surface({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}}, 0.1, 1);
      },
      "triangle 0: degenerate, area 0 m^2 at longest edge 2 m");
  expect_refused([] { (void)sample_surface(square, halves, 0, 1); },
                 "thickness 0: must be positive and finite");
  expect_refused([] { (void)sample_surface(square, halves, 0.1, 0); }, "layers 0: must lie in [1, 64]");
  expect_refused([] { (void)sample_surface(square, halves, 0.1, 1, 4); },
                 "points_per_triangle 4: must be 1, 3 or 6");
  expect_refused([] { (void)sample_surface_apart(square, halves, 0.1, 1, 0); },
                 "spacing 0: must be positive and finite");
  expect_refused([] { (void)sample_surface_apart(square, halves, 0.1, 1, 0.1, {.tries = 0}); },
                 "tries 0: must be at least 1");
  EXPECT_THROW((void)sample_surface_apart(square, halves, 0.1, 1, 4), std::invalid_argument);
  EXPECT_THROW((void)sample_surface_apart(square, halves, 0.1, 1, 1e-5), std::invalid_argument);
}

}  // namespace thin_samples_test
