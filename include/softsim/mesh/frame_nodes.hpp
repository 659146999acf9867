// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "softsim/core/error.hpp"
#include "softsim/core/rotation.hpp"
#include "softsim/core/state.hpp"
#include "softsim/core/tensor.hpp"

namespace softsim {

/// Nodes that translate and rotate, with points beside them: what a `System` of frames is made of, as one of
/// points alone is made of a mesh.
class FrameNodes {
 public:
  /// @param positions rest positions of the frames in m
  /// @param axes rest axes of the frames as unit quaternions (x, y, z, w); empty: those of space. They matter
  ///   for what is reported in a frame's own axes alone: unknowns are rotations from rest.
  /// @param points rest positions of points in m
  /// @throws std::invalid_argument naming the frame or point: coordinates that are not finite, a quaternion
  ///   whose norm is off 1 by more than 1e-9; no frames; lists of different lengths
  explicit FrameNodes(std::vector<Vec3<double>> positions, std::vector<UnitQuaternion<double>> axes = {},
                      std::vector<Vec3<double>> points = {})
      : positions_(std::move(positions)), axes_(std::move(axes)), points_(std::move(points)) {
    if (positions_.empty()) invalid("frames: there are none");
    if (axes_.empty()) axes_.assign(positions_.size(), UnitQuaternion<double>(0, 0, 0, 1));
    if (axes_.size() != positions_.size())
      invalid(std::string("frames: ") + std::to_string(axes_.size()) + " quaternions for " +
              std::to_string(positions_.size()) + " positions");
    for (std::size_t j = 0; j < positions_.size(); ++j) {
      if (!positions_[j].allFinite())
        invalid(std::string("frame ") + std::to_string(j) + ": a coordinate is not a finite number");
      if (!(std::abs(axes_[j].norm() - 1) <= 1e-9))
        invalid(std::string("frame ") + std::to_string(j) + ": quaternion of norm " +
                to_text(axes_[j].norm()) + ", it has to be 1");
    }
    for (std::size_t i = 0; i < points_.size(); ++i)
      if (!points_[i].allFinite())
        invalid(std::string("point ") + std::to_string(i) + ": a coordinate is not a finite number");
  }

  /// Rest positions of the frames in m.
  [[nodiscard]] const std::vector<Vec3<double>>& frames() const { return positions_; }
  /// Rest positions of the points in m.
  [[nodiscard]] const std::vector<Vec3<double>>& points() const { return points_; }
  /// Rest axes of frame j.
  [[nodiscard]] const UnitQuaternion<double>& axes(std::size_t j) const { return axes_[j]; }

  /// Points and frames at rest.
  template <class T = double>
  [[nodiscard]] State<T> rest_state() const {
    return State<T>(points_.size(), positions_.size());
  }
  /// Axes of frame j at q.
  template <class T>
  [[nodiscard]] Mat3<double> axes(const State<T>& q, std::size_t j) const {
    return q.rotation(static_cast<std::ptrdiff_t>(j)).template cast<double>() *
           (Mat3<double>::Identity() + rotation_less_identity(axes_[j]));
  }

 private:
  std::vector<Vec3<double>> positions_;
  std::vector<UnitQuaternion<double>> axes_;
  std::vector<Vec3<double>> points_;
};

}  // namespace softsim
