// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "softsim/mesh/point_grid.hpp"

// Points and questions on which every `NeighbourSearch` is held against looking at all points.
namespace neighbour_sets {

using Vec = softsim::Vec3<double>;

struct Named {
  std::string name;
  std::vector<Vec> points;
};

// Steps of 1/4 are exact in binary: distances tie often, and fall on the radius.
inline std::vector<Named> all() {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto next = [&] { return Vec(unit(random), unit(random), unit(random)); };
  std::vector<Named> sets;
  const auto add = [&](const std::string& name, int count, const auto& point) {
    sets.push_back({name, {}});
    for (int i = 0; i < count; ++i) sets.back().points.push_back(point(i));
  };
  add("none", 0, [&](int) { return next(); });
  add("one", 1, [&](int) { return next(); });
  add("two", 2, [&](int) { return next(); });
  add("random", 500, [&](int) { return next(); });
  add("far from the origin", 300, [&](int) { return Vec(next() * 1e-3 + Vec(1e3, -2e3, 5e3)); });
  add("lattice", 512, [&](int i) { return Vec(Vec(i % 8, i / 8 % 8, i / 64) / 4); });
  add("coplanar along the axes", 144, [&](int i) { return Vec(Vec(i % 12, 3, i / 12) / 4); });
  add("coplanar at a slant", 300,
      [&](int) { return Vec(Vec(1, 2, 3) + unit(random) * Vec(1, 1, 0) + unit(random) * Vec(0, 1, 2)); });
  add("collinear along an axis", 100, [&](int i) { return Vec(1, 2, i / 4.0); });
  add("collinear at a slant", 100, [&](int i) { return Vec(i * Vec(1, -2, 3) / 4); });
  add("coincident", 50, [&](int) { return Vec(0.3, 0.1, -0.7); });
  add("each twice", 200, [&](int i) { return Vec(Vec(i % 100 % 5, i % 100 / 5 % 5, i % 100 / 25) / 4); });
  add("two clusters", 400, [&](int i) { return Vec(next() * 1e-4 + (i % 2) * Vec(10, 0, 0)); });
  add("nearer than the square root of the smallest number", 20, [&](int i) { return Vec(i * 1e-170, 0, 0); });
  add("as near as numbers get", 20, [&](int i) { return Vec(i * 5e-324, 0, 0); });
  return sets;
}

// By which points are compared: rounded in the library's way, else ties would be broken otherwise.
inline double square(const Vec& a, const Vec& b) { return softsim::detail::squared_distance(a, b); }

inline std::vector<std::int32_t> within(const std::vector<Vec>& points, const Vec& x, double radius) {
  std::vector<std::int32_t> result;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (radius >= 0 && square(points[i], x) <= radius * radius)
      result.push_back(static_cast<std::int32_t>(i));
  return result;
}

inline std::vector<std::int32_t> nearest(const std::vector<Vec>& points, const Vec& x, std::size_t count) {
  std::vector<std::int32_t> result(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) result[i] = static_cast<std::int32_t>(i);
  std::stable_sort(result.begin(), result.end(), [&](std::int32_t a, std::int32_t b) {
    return square(points[static_cast<std::size_t>(a)], x) < square(points[static_cast<std::size_t>(b)], x);
  });
  result.resize(std::min(count, result.size()));
  std::sort(result.begin(), result.end());
  return result;
}

// Against all points, compared one by one.
template <softsim::NeighbourSearch Search>
void expect_same_as_looking_at_all() {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (const Named& set : all()) {
    SCOPED_TRACE(set.name);
    const Search search(set.points);
    EXPECT_EQ(search.points(), set.points);
    std::vector<Vec> places{Vec(0, 0, 0), Vec(0.5, 0.75, 0.25), Vec(0.375, 0.375, 0.375), Vec(100, -3, 2),
                            Vec(-1e6, 1e6, 3)};
    for (std::size_t i = 0; i < set.points.size(); i += 7) {
      places.push_back(set.points[i]);
      places.push_back(set.points[i] + 0.3 * Vec(unit(random), unit(random), unit(random)));
      places.push_back(set.points[i] + 1e-4 * Vec(unit(random), unit(random), unit(random)));
    }
    for (const Vec& x : places) {
      for (const double radius : {-1.0, 0.0, 1e-160, 1e-5, 1e-4, 0.25, 0.5, 1.0, 3.0, 100.0, 2e6,
                                  std::numeric_limits<double>::infinity()})
        ASSERT_EQ(search.within(x, radius), within(set.points, x, radius)) << x.transpose() << ", " << radius;
      // the radius is a distance that occurs: that point is in
      if (!set.points.empty()) {
        const double radius = std::sqrt(square(set.points[0], x));
        ASSERT_EQ(search.within(x, radius), within(set.points, x, radius)) << x.transpose() << ", " << radius;
      }
      for (const std::size_t count : {0U, 1U, 2U, 7U, 27U, 499U, 1000U})
        ASSERT_EQ(search.nearest(x, count), nearest(set.points, x, count)) << x.transpose() << ", " << count;
    }
  }
}

template <softsim::NeighbourSearch Search>
void expect_refusal_of_what_is_not_finite() {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  const auto message = [](const auto& act) -> std::string {
    try {
      act();
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "nothing thrown";
  };
  for (const double bad : {nan, inf, -inf}) {
    EXPECT_EQ(message([&] {
                Search({Vec(0, 0, 0), Vec(0, bad, 0)});
              }),
              "node 1: a coordinate is not a finite number");
    const Search search({Vec(0, 0, 0), Vec(1, 0, 0)});
    const std::string expected = "point to find neighbours of: a coordinate is not a finite number";
    EXPECT_EQ(message([&] { (void)search.within(Vec(0, 0, bad), 1); }), expected);
    EXPECT_EQ(message([&] { (void)search.nearest(Vec(0, 0, bad), 1); }), expected);
  }
  EXPECT_TRUE(Search({Vec(0, 0, 0)}).within(Vec(0, 0, 0), nan).empty());
}

}  // namespace neighbour_sets
