// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>

#include "softsim/core/error.hpp"
#include "softsim/core/tensor.hpp"

namespace softsim {

/// A body in space that has no mesh: what voxels, Poisson-disk sets and samples need to know of it.
///  - `contains(x)`: whether the point x (m) lies inside;
///  - `box()`: an axis-aligned box around it, m;
///  - `volume()`: m^3.
/// Models: `ImplicitDomain`, `SurfaceDomain` (surface_domain.hpp).
template <class D>
concept Domain = requires(const D& domain, const Vec3<double>& x) {
  { domain.contains(x) } -> std::convertible_to<bool>;
  { domain.box() } -> std::convertible_to<Eigen::AlignedBox3d>;
  { domain.volume() } -> std::convertible_to<double>;
};

namespace detail {

inline void check_box(const Eigen::AlignedBox3d& box) {
  for (int a = 0; a < 3; ++a)
    if (!(std::isfinite(box.min()[a]) && std::isfinite(box.max()[a]) && box.min()[a] < box.max()[a]))
      invalid(std::string("domain: axis ") + std::to_string(a) + " of the box runs from " +
              to_text(box.min()[a]) + " to " + to_text(box.max()[a]) + " m; must be a finite interval");
}

/// What every way of filling a domain asks of its spacing.
inline void check_spacing(const Eigen::AlignedBox3d& box, double spacing) {
  check_box(box);
  if (!(spacing > 0 && std::isfinite(spacing)))
    invalid(std::string("spacing ") + to_text(spacing) + ": must be positive and finite");
  if (spacing > box.diagonal().norm())
    invalid(std::string("spacing ") + to_text(spacing) + ": is larger than the domain, whose box measures " +
            to_text(box.diagonal().norm()) + " m from corner to corner");
}

/// Cells of edge `cell` that cover the box along each axis.
/// @throws std::invalid_argument if they are more than 2^28, a gibibyte of numbers, naming the spacing that
///   they come from
inline std::array<int, 3> cells_of(const Eigen::AlignedBox3d& box, double cell, double spacing) {
  // rounding must not add a cell to a whole number of them
  const Vec3<double> count = (box.diagonal() / cell * (1 - 1e-12)).array().ceil().max(1.0);
  const double with_margin = (count.array() + 4).prod();  // as `DartBoard` has it
  if (!(with_margin <= 0x1p28))
    invalid(std::string("spacing ") + to_text(spacing) + ": too small, the box of the domain would need " +
            to_text(count.prod()) + " cells");
  return {static_cast<int>(count[0]), static_cast<int>(count[1]), static_cast<int>(count[2])};
}

inline double checked_volume(double volume) {
  if (!(volume > 0 && std::isfinite(volume)))
    invalid(std::string("domain: volume ") + to_text(volume) + " m^3 is not positive and finite");
  return volume;
}

/// Part of the unit cube around the origin where c + g . x < 0: the distribution function of a sum of three
/// uniform variables of widths |g_a|, a piecewise cubic.
inline double cut_fraction(double c, const Vec3<double>& g) {
  const double steepest = g.cwiseAbs().maxCoeff();
  if (steepest == 0) return c < 0 ? 1 : 0;
  // a floor under the slopes: the cubic divides by their product, and the fraction changes by 1e-6 at most
  const Vec3<double> a = g.cwiseAbs().cwiseMax(1e-3 * steepest) / steepest;
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    double height = -c / steepest, sign = 1;
    for (int k = 0; k < 3; ++k) {
      const bool lower = (corner >> k & 1) == 0;
      height += lower ? a[k] / 2 : -a[k] / 2;
      sign *= lower ? 1 : -1;
    }
    if (height > 0) sum += sign * height * height * height;
  }
  return std::clamp(sum / (6 * a.prod()), 0.0, 1.0);
}

}  // namespace detail

/// A number for each point of space.
template <class F>
concept ScalarField = requires(const F& f, const Vec3<double>& x) {
  { f(x) } -> std::convertible_to<double>;
};

/// How an `ImplicitDomain` comes to its volume.
struct ImplicitDomainOptions {
  /// Relative accuracy of the volume that is worked out.
  double accuracy = 1e-4;
  /// The volume in m^3 where it is known; then nothing is worked out.
  std::optional<double> volume = std::nullopt;
};

/// The points of a box where f(x) < 0.
///
/// Unless given, the volume is the sum over cells: 32 along the longest side of the box, those near the
/// boundary halved until the sum has changed twice in a row by less than `accuracy` times itself. In a cell
/// of the last level f is replaced by a plane with its mean and mean slope, so that the error falls with
/// the square of the cell for a smooth boundary (and with the first power at an edge, or for an f that only
/// tells inside from outside). A cell counts as far from the boundary where all eight values have one sign
/// and the smallest magnitude exceeds their spread, which is certain for a distance function; parts thinner
/// than 1/32 of the box can be missed.
template <ScalarField F>
class ImplicitDomain {
 public:
  /// @param f negative inside, positive outside; best like a distance near the boundary
  /// @param box m; what lies outside of it does not belong to the domain
  /// @throws std::invalid_argument for a box that is empty or not finite, an accuracy outside (0, 1), a given
  ///   volume that is not positive or exceeds that of the box, a domain without volume, an f that is not a
  ///   number somewhere, or an accuracy that 1024 cells along the longest side do not reach
  ImplicitDomain(F f, const Eigen::AlignedBox3d& box, const ImplicitDomainOptions& options = {})
      : f_(std::move(f)), box_(box) {
    detail::check_box(box_);
    if (!(options.accuracy > 0 && options.accuracy < 1))
      invalid(std::string("accuracy ") + to_text(options.accuracy) + ": must lie in (0, 1)");
    if (options.volume && *options.volume > box_.volume() * (1 + 1e-12))
      invalid(std::string("implicit domain: volume ") + to_text(*options.volume) +
              " m^3 is larger than that of the box, " + to_text(box_.volume()) + " m^3");
    volume_ = options.volume ? detail::checked_volume(*options.volume) : found_volume(options.accuracy);
  }

  /// Whether x (m) lies in the box and f(x) < 0.
  [[nodiscard]] bool contains(const Vec3<double>& x) const { return box_.contains(x) && f_(x) < 0; }
  /// The box that was given, m.
  [[nodiscard]] const Eigen::AlignedBox3d& box() const { return box_; }
  /// Volume in m^3, given or worked out.
  [[nodiscard]] double volume() const { return volume_; }

 private:
  [[nodiscard]] double found_volume(double accuracy) const {
    const std::array<int, 3> cells = detail::cells_of(box_, box_.sizes().maxCoeff() / 32, 0);
    constexpr int deepest = 5;
    double before = 0, change = 0;
    bool was_close = false;
    for (int depth = 0; depth <= deepest; ++depth) {
      const double volume = volume_at(cells, depth);
      change = std::abs(volume - before);
      const bool close = volume > 0 && change <= accuracy * volume;
      if (close && was_close) return volume;
      was_close = close;
      before = volume;
    }
    if (before == 0) invalid("implicit domain: f is negative nowhere in the box");
    invalid(std::string("implicit domain: volume ") + to_text(before) + " m^3 still changes by " +
            to_text(change) + " m^3 at 1024 cells; give the volume or a coarser accuracy than " +
            to_text(accuracy));
  }

  [[nodiscard]] double volume_at(const std::array<int, 3>& cells, int depth) const {
    const Vec3<double> size = box_.sizes().cwiseQuotient(Vec3<double>(cells[0], cells[1], cells[2]));
    double sum = 0;
    for (int k = 0; k < cells[2]; ++k)
      for (int j = 0; j < cells[1]; ++j)
        for (int i = 0; i < cells[0]; ++i)
          sum += part_inside(box_.min() + size.cwiseProduct(Vec3<double>(i, j, k)), size, depth);
    return sum;
  }

  /// Volume inside the cell with this lowest corner.
  [[nodiscard]] double part_inside(const Vec3<double>& lower, const Vec3<double>& size, int depth) const {
    double least = 0, greatest = 0, mean = 0;
    int inside = 0;
    Vec3<double> slope = Vec3<double>::Zero();
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3<double> side(corner & 1, corner >> 1 & 1, corner >> 2 & 1);
      const Vec3<double> x = lower + size.cwiseProduct(side);
      const double value = f_(x);
      if (std::isnan(value))
        invalid(std::string("implicit domain: f is not a number at (") + to_text(x[0]) + ", " +
                to_text(x[1]) + ", " + to_text(x[2]) + ")");
      least = corner == 0 ? value : std::min(least, value);
      greatest = corner == 0 ? value : std::max(greatest, value);
      mean += value / 24;
      slope += value / 4 * (2 * side - Vec3<double>::Ones());
      if (value < 0) ++inside;
    }
    const double spread = greatest - least;  // not a number if all are infinite, hence far
    const bool far = (least > 0 && !(least <= spread)) || (greatest < 0 && !(-greatest <= spread));
    if (far) return least < 0 ? size.prod() : 0;
    // the mean of a quadratic over a cube is that of its corners, weighted by 1/3, and its middle, by 2/3
    if (depth == 0) mean += 2 * f_(lower + size / 2) / 3;
    if (depth == 0)  // an infinite f has no plane
      return size.prod() *
             (std::isfinite(mean) && slope.allFinite() ? detail::cut_fraction(mean, slope) : inside / 8.0);
    double sum = 0;
    for (int child = 0; child < 8; ++child)
      sum +=
          part_inside(lower + size.cwiseProduct(Vec3<double>(child & 1, child >> 1 & 1, child >> 2 & 1)) / 2,
                      size / 2, depth - 1);
    return sum;
  }

  F f_;
  Eigen::AlignedBox3d box_;
  double volume_;
};

}  // namespace softsim
