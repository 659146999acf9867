// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <queue>
#include <string>
#include <utility>
#include <vector>

#include "softsim/core/error.hpp"
#include "softsim/core/tensor.hpp"
#include "softsim/mesh/dart_board.hpp"
#include "softsim/mesh/domain.hpp"
#include "softsim/mesh/point_grid.hpp"

namespace softsim {

/// How a Poisson-disk set is drawn.
struct PoissonDiskOptions {
  /// Equal seeds give equal points, with every compiler that rounds each operation (not if it is told to fuse
  /// multiplications and additions: a distance that rounds otherwise changes all that follows).
  std::uint64_t seed = 0;
  /// Points tried around each point and in each empty cell before giving up; more fill the domain tighter.
  int tries = 30;
};

namespace detail {

inline void check_tries(int tries) {
  if (tries < 1) invalid(std::string("tries ") + std::to_string(tries) + ": must be at least 1");
}

}  // namespace detail

/// Random points of the domain, m, no two nearer than `spacing` and, up to the tries, no place left for
/// another (a maximal Poisson-disk set; Bridson 2007; Bosman 2015, Sec. 4.1 "Domain sampling").
///
/// Bridson's front grows from a point until all of its surroundings are filled: `tries` points are proposed
/// at one to two spacings from a random point of the front, which leaves the front when all are refused. What
/// the front does not reach, gaps and other parts of the domain, is found by `tries` points in each cell
/// (edge 0.58 spacing), aimed at what no point covers. A domain that fills the fraction p of a cell's gaps is
/// missed there with probability (1 - p)^tries. A solid body gets about 0.7 points per cubed spacing, and
/// more for its surface.
/// @throws std::invalid_argument for a spacing that is not positive, larger than the domain or too small to
///   count the cells, tries below 1, or a domain in which no point is found
template <Domain D>
[[nodiscard]] std::vector<Vec3<double>> poisson_disk(const D& domain, double spacing,
                                                     const PoissonDiskOptions& options = {}) {
  const Eigen::AlignedBox3d box = domain.box();
  detail::check_spacing(box, spacing);
  detail::check_tries(options.tries);
  detail::UniformRandom random(options.seed);
  detail::DartBoard board(box, spacing);
  std::vector<Vec3<double>> front;
  const auto add = [&](const Vec3<double>& x) {
    board.add(x);
    front.push_back(x);
  };
  const auto step = [&]() -> Vec3<double> {  // uniform in the shell between one and two spacings
    for (;;) {
      const Vec3<double> s = 4 * random.in_cube() - Vec3<double>::Constant(2);
      if (s.squaredNorm() >= 1 && s.squaredNorm() < 4) return spacing * s;
    }
  };
  const auto grow = [&] {
    while (!front.empty()) {
      const std::size_t i = random.below(front.size());
      const Vec3<double> x = front[i];
      bool found = false;
      for (int t = 0; t < options.tries && !found; ++t) {
        const Vec3<double> dart = x + step();
        found = board.is_free(dart) && domain.contains(dart);
        if (found) add(dart);
      }
      if (found) continue;
      front[i] = front.back();
      front.pop_back();
    }
  };
  detail::DartBoard::Room room;
  for (int k = 0; k < board.cells()[2]; ++k)
    for (int j = 0; j < board.cells()[1]; ++j)
      for (int i = 0; i < board.cells()[0]; ++i) {
        board.find_room({i, j, k}, room);
        for (int t = 0; t < options.tries && !room.gaps.empty(); ++t) {
          const Vec3<double> dart = room.random_point(random);
          if (!room.is_free(dart, spacing) || !box.contains(dart) || !domain.contains(dart)) continue;
          add(dart);
          grow();
          break;  // a point covers its cell
        }
      }
  if (board.points().empty())
    invalid(std::string("spacing ") + to_text(spacing) + ": found no point inside the domain");
  return board.points();
}

namespace detail {

/// Takes points away until n are left, each time the one with the closest company within `radius` (weighted
/// sample elimination; Yuksel 2015). The rest keeps its order.
inline std::vector<Vec3<double>> eliminate(const std::vector<Vec3<double>>& points, std::size_t n,
                                           double radius) {
  const PointGrid grid(points);
  const auto closeness = [&](std::size_t i, std::size_t j) {
    const double x = std::max(0.0, 1 - (points[i] - points[j]).norm() / radius), x2 = x * x, x4 = x2 * x2;
    return x4 * x4;
  };
  std::vector<double> crowd(points.size(), 0);
  std::priority_queue<std::pair<double, std::size_t>> queue;
  std::vector<char> kept(points.size(), 1);
  const auto neighbours = [&](std::size_t i, auto function) {
    for (const std::int32_t number : grid.within(points[i], radius)) {
      const auto j = static_cast<std::size_t>(number);
      if (j != i && kept[j]) function(j);
    }
  };
  for (std::size_t i = 0; i < points.size(); ++i) {
    neighbours(i, [&](std::size_t j) { crowd[i] += closeness(i, j); });
    queue.emplace(crowd[i], i);
  }
  for (std::size_t left = points.size(); left > n;) {
    const double weight = queue.top().first;
    const std::size_t i = queue.top().second;
    queue.pop();
    if (!kept[i] || weight != crowd[i]) continue;  // gone, or queued anew with less company
    kept[i] = 0;
    --left;
    neighbours(i, [&](std::size_t j) { queue.emplace(crowd[j] -= closeness(i, j), j); });
  }
  std::vector<Vec3<double>> rest;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (kept[i]) rest.push_back(points[i]);
  return rest;
}

}  // namespace detail

/// Exactly n random points spread over the domain, m: a Poisson-disk set whose spacing is searched for until
/// it has n points or up to a fiftieth more (or until forty runs are made), of which the most crowded are
/// taken away. Deterministic too.
/// @throws std::invalid_argument for n below 1 and as `poisson_disk`
template <Domain D>
[[nodiscard]] std::vector<Vec3<double>> poisson_disk_count(const D& domain, int n,
                                                           const PoissonDiskOptions& options = {}) {
  if (n < 1) invalid(std::string("n ") + std::to_string(n) + ": must be at least 1");
  const Eigen::AlignedBox3d box = domain.box();
  detail::check_box(box);
  const std::size_t wanted = static_cast<std::size_t>(n), enough = wanted + wanted / 50;
  // brackets: at spacing `low` there are too many points, above `high` too few
  double low = 0, high = box.diagonal().norm();
  double spacing = std::min(high, std::cbrt(0.8 * detail::checked_volume(domain.volume()) / n));
  std::vector<Vec3<double>> best;
  double best_spacing = spacing;
  for (int run = 0; run < 40; ++run) {
    std::vector<Vec3<double>> points = poisson_disk(domain, spacing, options);
    const std::size_t count = points.size();
    (count < wanted ? high : low) = spacing;
    if (count >= wanted && (best.empty() || count < best.size())) {
      best = std::move(points);
      best_spacing = spacing;
    }
    if (count >= wanted && count <= enough) break;
    // counts fall with the cube of the spacing in a solid body, and with chance in a small one
    const double guess = spacing * std::cbrt(static_cast<double>(count) / (1.01 * n));
    if (guess > low && guess < high && run % 3 < 2)
      spacing = guess;
    else
      spacing = low > 0 ? (low + high) / 2 : high / 2;
    if (!best.empty() && high - low < 1e-6 * high) break;
  }
  if (best.empty())
    invalid(std::string("n ") + std::to_string(n) + ": no spacing was found that gives so many points");
  return detail::eliminate(best, wanted, 2 * best_spacing);
}

}  // namespace softsim
