// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <random>
#include <utility>
#include <vector>

#include "softsim/core/tensor.hpp"
#include "softsim/mesh/domain.hpp"

namespace softsim::detail {

/// Uniform numbers in [0, 1); the standard's distributions differ between libraries, its generator does not.
class UniformRandom {
 public:
  explicit UniformRandom(std::uint64_t seed) : generator_(seed) {}
  [[nodiscard]] double operator()() { return static_cast<double>(generator_() >> 11) * 0x1p-53; }
  /// A point of the unit cube. One statement each: compilers order the arguments of a call as they like.
  [[nodiscard]] Vec3<double> in_cube() {
    Vec3<double> x;
    for (int a = 0; a < 3; ++a) x[a] = (*this)();
    return x;
  }
  /// A number below n > 0.
  [[nodiscard]] std::size_t below(std::size_t n) {
    return std::min(static_cast<std::size_t>((*this)() * static_cast<double>(n)), n - 1);
  }

 private:
  std::mt19937_64 generator_;
};

/// Points at least `spacing` apart, in a grid whose cells hold one point at most.
class DartBoard {
 public:
  DartBoard(const Eigen::AlignedBox3d& box, double spacing) : box_(box), spacing_(spacing) {
    cells_ = cells_of(box, cell(), spacing);
    for (int a = 0; a < 3; ++a) stride_[a] = a == 0 ? 1 : stride_[a - 1] * padded(a - 1);
    grid_.assign(static_cast<std::size_t>(stride_[2] * padded(2)), none);
    std::vector<std::pair<int, std::ptrdiff_t>> around;  // nearest first: they refuse most of the darts
    for (int k = -2; k <= 2; ++k)
      for (int j = -2; j <= 2; ++j)
        for (int i = -2; i <= 2; ++i)
          if (std::abs(i * j * k) < 8)
            around.emplace_back(i * i + j * j + k * k, i + j * stride_[1] + k * stride_[2]);
    std::sort(around.begin(), around.end());
    for (const auto& entry : around) around_.push_back(entry.second);
  }

  [[nodiscard]] const std::vector<Vec3<double>>& points() const { return points_; }
  [[nodiscard]] const std::array<int, 3>& cells() const { return cells_; }

  /// Whether x lies in the box and no point is nearer than the spacing.
  [[nodiscard]] bool is_free(const Vec3<double>& x) const {
    if (!box_.contains(x)) return false;
    const std::ptrdiff_t home = number(cell_of(x));
    return std::none_of(around_.begin(), around_.end(), [&](std::ptrdiff_t step) {
      const std::int32_t i = grid_[static_cast<std::size_t>(home + step)];
      return i != none && (points_[static_cast<std::size_t>(i)] - x).squaredNorm() < spacing_ * spacing_;
    });
  }
  /// Adds a point that is free.
  void add(const Vec3<double>& x) {
    grid_[static_cast<std::size_t>(number(cell_of(x)))] = static_cast<std::int32_t>(points_.size());
    points_.push_back(x);
  }

  /// Where a dart may find room in a cell.
  struct Room {
    std::vector<Vec3<double>> near;  ///< points that darts in the cell could be too near to
    std::vector<Vec3<double>> gaps;  ///< lowest corners of parts of the cell that none of these covers alone
    double edge = 0;                 ///< of these parts

    [[nodiscard]] bool is_free(const Vec3<double>& x, double spacing) const {
      return std::none_of(near.begin(), near.end(), [&](const Vec3<double>& point) {
        return (point - x).squaredNorm() < spacing * spacing;
      });
    }
    [[nodiscard]] Vec3<double> random_point(UniformRandom& random) const {
      const Vec3<double> gap = gaps[random.below(gaps.size())];
      return gap + edge * random.in_cube();
    }
  };
  /// The room in a cell: all of it if no point is near, else its gaps among 4 x 4 x 4 parts.
  void find_room(const std::array<int, 3>& c, Room& room) const {
    room.near.clear();
    room.gaps.clear();
    const std::ptrdiff_t home = number(c);
    for (const std::ptrdiff_t step : around_)
      if (const std::int32_t i = grid_[static_cast<std::size_t>(home + step)]; i != none)
        room.near.push_back(points_[static_cast<std::size_t>(i)]);
    const int halvings = room.near.empty() ? 0 : 2;
    room.edge = cell() / (1 << halvings);
    add_gaps(lowest(c), cell(), halvings, room);
  }

 private:
  static constexpr std::int32_t none = -1;

  /// A little less than spacing / sqrt(3), the edge of a cube with that diagonal.
  [[nodiscard]] double cell() const { return 0.577 * spacing_; }
  /// Two more cells on each side, so that neighbours need no look at the border.
  [[nodiscard]] std::ptrdiff_t padded(int axis) const { return cells_[static_cast<std::size_t>(axis)] + 4; }
  [[nodiscard]] Vec3<double> lowest(const std::array<int, 3>& c) const {
    return box_.min() + cell() * Vec3<double>(c[0], c[1], c[2]);
  }
  [[nodiscard]] std::array<int, 3> cell_of(const Vec3<double>& x) const {
    std::array<int, 3> c;
    for (std::size_t a = 0; a < 3; ++a) {
      const int axis = static_cast<int>(a);
      c[a] = std::min(static_cast<int>((x[axis] - box_.min()[axis]) / cell()), cells_[a] - 1);
    }
    return c;
  }
  void add_gaps(const Vec3<double>& lower, double edge, int halvings, Room& room) const {
    for (const Vec3<double>& x : room.near) {
      const Vec3<double> from_centre = (x - lower).array() - edge / 2;
      if ((from_centre.array().abs() + edge / 2).matrix().squaredNorm() < spacing_ * spacing_) return;
    }
    if (halvings == 0) {
      room.gaps.push_back(lower);
      return;
    }
    for (int child = 0; child < 8; ++child)
      add_gaps(lower + edge / 2 * Vec3<double>(child & 1, child >> 1 & 1, child >> 2 & 1), edge / 2,
               halvings - 1, room);
  }
  [[nodiscard]] std::ptrdiff_t number(const std::array<int, 3>& c) const {
    return (c[0] + 2) * stride_[0] + (c[1] + 2) * stride_[1] + (c[2] + 2) * stride_[2];
  }

  Eigen::AlignedBox3d box_;
  double spacing_;
  std::array<int, 3> cells_{};
  std::ptrdiff_t stride_[3];
  std::vector<std::ptrdiff_t> around_;
  std::vector<std::int32_t> grid_;
  std::vector<Vec3<double>> points_;
};

}  // namespace softsim::detail
