// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "softsim/core/error.hpp"
#include "softsim/core/state.hpp"

namespace softsim {

/// Which components of which points and frames are prescribed, and the displacement or rotation that each has
/// to reach by the end of the next step (or of the static solve). A fixed component is one prescribed to 0.
template <class T>
class Prescribed {
 public:
  /// Nothing prescribed on any of the points and frames.
  explicit Prescribed(std::size_t points, std::size_t frames = 0)
      : free_(Vector<T>::Zero(block_stride * static_cast<std::ptrdiff_t>(points + 2 * frames))),
        target_(points, frames) {
    for (std::ptrdiff_t i = 0; i < free_.size() / block_stride; ++i) block(free_, i).setOnes();
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
    target_.displacement[k] = static_cast<T>(displacement);
  }
  /// Fixes points at rest.
  void fix(const std::vector<std::int32_t>& points) {
    for (const std::int32_t i : points) set(i, Vec3<double>::Zero());
  }
  /// Lets a point go.
  void release(std::int32_t point) {
    for (int axis = 0; axis < 3; ++axis) free_[index(point, axis)] = T(1);
  }

  /// Prescribes displacement in m and rotation from rest of a frame.
  /// @throws std::invalid_argument if it does not exist, the displacement is not finite, or the quaternion's
  ///   norm is off 1 by more than 1e-6
  void set_frame(std::int32_t frame, const Vec3<double>& displacement,
                 const UnitQuaternion<double>& rotation) {
    const std::int32_t first = first_block(frame);
    set(first, displacement);
    set_rotation(frame, rotation);
  }
  /// Prescribes the rotation of a frame from rest.
  void set_rotation(std::int32_t frame, const UnitQuaternion<double>& rotation) {
    const std::int32_t first = first_block(frame);
    if (!(std::abs(rotation.norm() - 1) <= 1e-6))
      invalid(std::string("prescribed frame ") + std::to_string(frame) + ": quaternion of norm " +
              to_text(rotation.norm()) + ", it has to be 1");
    block(free_, first + 1).setZero();
    target_.quaternion(frame) = rotation.normalized().template cast<T>();
  }
  /// Prescribes one component of the rotation (axis 0, 1 or 2 of the body), which is brought to that of the
  /// target: no rotation unless it was set before. Two of them held make a hinge about the third: a twist
  /// about that axis is all that may be left. One held alone lets the frame turn about the two others, whose
  /// turns do not commute, and then takes back what has become a twist about it.
  void hold_rotation(std::int32_t frame, int axis) {
    if (axis < 0 || axis > 2) invalid(std::string("axis ") + std::to_string(axis) + ": must be 0, 1 or 2");
    block(free_, first_block(frame) + 1)[axis] = T(0);
  }
  /// Lets the rotation of a frame go; its target stays that of `hold_rotation`.
  void release_rotation(std::int32_t frame) { block(free_, first_block(frame) + 1).setOnes(); }
  /// Fixes frames at rest.
  void fix_frames(const std::vector<std::int32_t>& frames) {
    for (const std::int32_t j : frames) set_frame(j, Vec3<double>::Zero(), {0, 0, 0, 1});
  }
  /// Number of the first block of a frame, its displacement: what `set` takes for single components of it.
  /// @throws std::invalid_argument if it does not exist
  [[nodiscard]] std::int32_t first_block(std::int32_t frame) const {
    if (frame < 0 || frame >= target_.frames())
      invalid(std::string("prescribed frame ") + std::to_string(frame) + ": out of range (there are " +
              std::to_string(target_.frames()) + ")");
    return static_cast<std::int32_t>(target_.frame_block(frame));
  }

  /// 1 for a free component, 0 for a prescribed one and for the fourth scalar of a block.
  [[nodiscard]] const Vector<T>& free() const { return free_; }
  /// Displacement to reach, m; meaningful where a component is prescribed.
  [[nodiscard]] const Vector<T>& target() const { return target_.displacement; }
  /// True if this component is prescribed.
  [[nodiscard]] bool contains(std::int32_t point, int axis) const {
    return free_[any_index(point, axis)] == T(0);
  }

  /// Zeroes the prescribed components of v.
  void mask(Vector<T>& v) const { v.array() *= free_.array(); }

  /// d = the increment of prescribed components from q to their target, 0 on free ones. Returns the largest
  /// |component|, m or rad.
  double increment(const State<T>& q, Vector<T>& d) const {
    d.array() = target_.displacement.array() - q.displacement.array();
    for (std::ptrdiff_t j = 0; j < q.frames(); ++j)
      block(d, q.frame_block(j) + 1) = turn(j, q.quaternion(j), target_.quaternion(j));
    return masked(d);
  }
  /// The same to where these components are after a fraction of the way from `start` to their target.
  double increment(const State<T>& q, Vector<T>& d, const State<T>& start, double fraction) const {
    // the goal first, so that it is met to the last bit
    d.array() = start.displacement.array() +
                static_cast<T>(fraction) * (target_.displacement - start.displacement).array() -
                q.displacement.array();
    for (std::ptrdiff_t j = 0; j < q.frames(); ++j) {
      const Vec3<T> way = static_cast<T>(fraction) * turn(j, start.quaternion(j), target_.quaternion(j));
      const UnitQuaternion<T> goal = quaternion_product<T>(start.quaternion(j), quaternion_exponential(way));
      block(d, q.frame_block(j) + 1) = turn(j, q.quaternion(j), goal);
    }
    return masked(d);
  }

 private:
  // The rotation vector along the held axes of frame j that takes a to b, or with free axes as far as that
  // is their matter. With a hinge, exp([r]x) is the swing of the rotation between them and what is left a
  // twist about the free axis. (Components of the rotation vector between them would mix with the twist, and
  // corrections by them run away from the hinge once it has turned by 109 degrees.)
  Vec3<T> turn(std::ptrdiff_t j, const UnitQuaternion<T>& a, const UnitQuaternion<T>& b) const {
    const Vec3<T> open = block(free_, target_.frame_block(j) + 1);
    const int axes = static_cast<int>(open.sum());
    if (axes == 3) return Vec3<T>::Zero();
    UnitQuaternion<T> between = quaternion_product<T>({-a[0], -a[1], -a[2], a[3]}, b);
    UnitQuaternion<T> twist = between;  // about the axis that is alone, free or held
    for (int axis = 0; axis < 3; ++axis)
      if (open[axis] != (axes == 1 ? T(1) : T(0))) twist[axis] = T(0);
    if (twist.isZero(0)) twist[3] = T(1);  // half a turn about another axis
    if (axes == 2) between = twist;
    if (axes == 1)
      between = quaternion_product<T>(between, UnitQuaternion<T>(-twist[0], -twist[1], -twist[2], twist[3]));
    // Of any norm for the logarithm. A turn below the rounding of a quaternion is none.
    constexpr T rounding = 4 * std::numeric_limits<T>::epsilon();
    const Vec3<T> r = quaternion_logarithm(between);
    return r.squaredNorm() > rounding * rounding ? r : Vec3<T>(Vec3<T>::Zero());
  }
  // Leaves what is prescribed of d; its largest |component|.
  double masked(Vector<T>& d) const {
    d.array() *= T(1) - free_.array();
    for (std::ptrdiff_t i = 3; i < d.size(); i += block_stride) d[i] = T(0);
    return d.size() == 0 ? 0 : static_cast<double>(d.cwiseAbs().maxCoeff());
  }
  std::ptrdiff_t index(std::int32_t point, int axis) const {
    const std::ptrdiff_t beyond = point - target_.points();
    if (beyond >= 0 && beyond % 2 == 1 && beyond < 2 * target_.frames())
      invalid(std::string("prescribed block ") + std::to_string(point) + " is the rotation of frame " +
              std::to_string(beyond / 2) + ": see set_rotation");
    return any_index(point, axis);
  }
  std::ptrdiff_t any_index(std::int32_t point, int axis) const {
    if (point < 0 || point >= free_.size() / block_stride)
      invalid(std::string("prescribed node ") + std::to_string(point) + ": out of range");
    if (axis < 0 || axis > 2) invalid(std::string("axis ") + std::to_string(axis) + ": must be 0, 1 or 2");
    return block_stride * static_cast<std::ptrdiff_t>(point) + axis;
  }

  Vector<T> free_;
  State<T> target_;
};

}  // namespace softsim
