// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "softsim/core/error.hpp"
#include "softsim/core/state.hpp"

namespace softsim {

/// Which components of which points are prescribed, and the displacement that each has to reach by the end of
/// the next step (or of the static solve). A fixed component is one prescribed to 0.
template <class T>
class Prescribed {
 public:
  /// Nothing prescribed on `points` points.
  explicit Prescribed(std::size_t points)
      : free_(Vector<T>::Zero(block_stride * static_cast<std::ptrdiff_t>(points))), target_(free_) {
    for (std::ptrdiff_t i = 0; i < static_cast<std::ptrdiff_t>(points); ++i) block(free_, i).setOnes();
  }

  /// Prescribes the displacement of a point in m; call again to move it on.
  /// @throws std::invalid_argument if the point does not exist or the displacement is not finite
  void set(std::int32_t point, const Vec3<double>& displacement) {
    for (int axis = 0; axis < 3; ++axis) set(point, axis, displacement[axis]);
  }
  /// Prescribes one component (axis 0, 1 or 2) and leaves the others as they are.
  void set(std::int32_t point, int axis, double displacement) {
    const std::ptrdiff_t k = index(point, axis);
    if (!(std::abs(displacement) <= 1e300))
      invalid(std::string("node ") + std::to_string(point) + ": prescribed displacement is not finite");
    free_[k] = T(0);
    target_[k] = static_cast<T>(displacement);
  }
  /// Fixes points at rest.
  void fix(const std::vector<std::int32_t>& points) {
    for (const std::int32_t i : points) set(i, Vec3<double>::Zero());
  }
  /// Lets a point go.
  void release(std::int32_t point) {
    for (int axis = 0; axis < 3; ++axis) free_[index(point, axis)] = T(1);
  }

  /// 1 for a free component, 0 for a prescribed one and for the fourth scalar of a block.
  [[nodiscard]] const Vector<T>& free() const { return free_; }
  /// Displacement to reach, m; meaningful where a component is prescribed.
  [[nodiscard]] const Vector<T>& target() const { return target_; }
  /// True if this component is prescribed.
  [[nodiscard]] bool contains(std::int32_t point, int axis) const {
    return free_[index(point, axis)] == T(0);
  }

  /// Zeroes the prescribed components of v.
  void mask(Vector<T>& v) const { v.array() *= free_.array(); }

  /// d = target - q on prescribed components, 0 on free ones. Returns the largest |component|, m.
  double increment(const State<T>& q, Vector<T>& d) const {
    d.array() = (T(1) - free_.array()) * (target_ - q.displacement).array();
    for (std::ptrdiff_t i = 3; i < d.size(); i += block_stride) d[i] = T(0);
    return d.size() == 0 ? 0 : static_cast<double>(d.cwiseAbs().maxCoeff());
  }
  /// The same to where these components are after a fraction of the way from `start` to their target.
  double increment(const State<T>& q, Vector<T>& d, const State<T>& start, double fraction) const {
    // the goal first, so that it is met to the last bit
    d.array() = start.displacement.array() +
                static_cast<T>(fraction) * (target_ - start.displacement).array() - q.displacement.array();
    d.array() *= T(1) - free_.array();
    for (std::ptrdiff_t i = 3; i < d.size(); i += block_stride) d[i] = T(0);
    return d.size() == 0 ? 0 : static_cast<double>(d.cwiseAbs().maxCoeff());
  }

 private:
  std::ptrdiff_t index(std::int32_t point, int axis) const {
    if (point < 0 || point >= free_.size() / block_stride)
      invalid(std::string("prescribed node ") + std::to_string(point) + ": out of range");
    if (axis < 0 || axis > 2) invalid(std::string("axis ") + std::to_string(axis) + ": must be 0, 1 or 2");
    return block_stride * static_cast<std::ptrdiff_t>(point) + axis;
  }

  Vector<T> free_, target_;
};

}  // namespace softsim
