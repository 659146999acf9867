// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "softsim/core/error.hpp"
#include "softsim/kinematics/frame_sample.hpp"
#include "softsim/kinematics/node_shapes.hpp"
#include "softsim/mesh/frame_nodes.hpp"

namespace softsim {

/// A body of samples between frames: each sample stands for a volume and follows at most N frames. What the
/// elastic energy, the mass and the loads of frames are made of. A sample with fewer frames gets ones that do
/// not move it, so that samples of one body can be worked off side by side.
template <int N>
class FrameBody {
 public:
  static constexpr std::size_t count = N;
  using Sample = FrameSample<N>;
  /// What one sample follows: x = sum_i w_i x_i + R_i c_i.
  struct Blend {
    std::array<std::int32_t, count> frames;
    std::array<double, count> weights;     ///< w_i
    std::array<Vec3<double>, count> arms;  ///< c_i, m; (X - X_i) w_i for skinning
  };

  /// @param nodes frames, which `shapes` has to be made of
  /// @param positions rest positions of the samples in m
  /// @param volumes what they stand for, m^3
  /// @throws std::invalid_argument naming the sample or frame: a sample that no frame reaches, or more than N
  ///   do; weights that do not sum to 1 or whose gradients do not sum to 0; a volume that is not positive; a
  ///   frame that no sample sees; lists of different lengths; fewer than N frames
  template <NodeShapes Shapes>
  FrameBody(const FrameNodes& nodes, const Shapes& shapes, const std::vector<Vec3<double>>& positions,
            const std::vector<double>& volumes)
      : FrameBody(nodes, evaluated(nodes, shapes, positions), positions, volumes) {}

  /// The same from shape functions that have been evaluated at the samples, integration points for instance.
  FrameBody(const FrameNodes& nodes, const std::vector<ShapeValues>& shapes,
            const std::vector<Vec3<double>>& positions, const std::vector<double>& volumes)
      : points_(nodes.points().size()), frames_(nodes.frames()), positions_(positions), volumes_(volumes) {
    const std::size_t n = frames_.size();
    if (n < count)
      invalid(std::string("frames: ") + std::to_string(n) + " are fewer than the " + std::to_string(N) +
              " that a sample follows");
    if (positions.size() != volumes.size() || positions.size() != shapes.size())
      invalid(std::string("samples: ") + std::to_string(positions.size()) + " positions, " +
              std::to_string(volumes.size()) + " volumes and " + std::to_string(shapes.size()) +
              " lists of weights");
    std::vector<bool> seen(n, false);
    for (std::size_t s = 0; s < positions.size(); ++s) {
      try {
        add(nodes, shapes[s], positions[s], volumes[s], seen);
      } catch (const std::invalid_argument& error) {
        invalid(std::string("sample ") + std::to_string(s) + ": " + error.what());
      }
    }
    for (std::size_t j = 0; j < n; ++j)
      if (!seen[j]) invalid(std::string("frame ") + std::to_string(j) + ": no sample sees it");
  }

  /// Number of samples.
  [[nodiscard]] std::size_t size() const { return positions_.size(); }
  /// Rest positions of the samples, m.
  [[nodiscard]] const std::vector<Vec3<double>>& positions() const { return positions_; }
  /// Rest volumes, m^3.
  [[nodiscard]] const std::vector<double>& volumes() const { return volumes_; }
  /// Sum of the rest volumes, m^3.
  [[nodiscard]] double volume() const {
    double sum = 0;
    for (const double v : volumes_) sum += v;
    return sum;
  }
  /// What each sample follows.
  [[nodiscard]] const std::vector<Blend>& blends() const { return blends_; }
  /// Gradients at rest, for the kernels.
  [[nodiscard]] const std::vector<typename Sample::template Data<double>>& data() const { return data_; }
  /// Rest positions of the frames, m.
  [[nodiscard]] const std::vector<Vec3<double>>& frames() const { return frames_; }
  /// Number of points that a system has before the frames.
  [[nodiscard]] std::size_t points() const { return points_; }
  /// Number of the first block of frame j in the flat vectors of a system.
  [[nodiscard]] std::int32_t frame_block(std::int32_t j) const {
    return static_cast<std::int32_t>(points_) + 2 * j;
  }
  /// Block numbers of the frames of each sample.
  [[nodiscard]] std::vector<std::array<std::int32_t, 2 * count>> stencils() const {
    std::vector<std::array<std::int32_t, 2 * count>> result;
    result.reserve(size());
    for (const Blend& blend : blends_) {
      std::array<std::int32_t, 2 * count> stencil;
      for (std::size_t i = 0; i < count; ++i) {
        stencil[2 * i] = frame_block(blend.frames[i]);
        stencil[2 * i + 1] = stencil[2 * i] + 1;
      }
      result.push_back(stencil);
    }
    return result;
  }

  /// Where sample s is at q, m.
  template <class T>
  [[nodiscard]] Vec3<double> position(const State<T>& q, std::size_t s) const {
    const Blend& blend = blends_[s];
    Vec3<double> x = positions_[s];
    for (std::size_t i = 0; i < count; ++i) {
      const std::ptrdiff_t j = blend.frames[i];
      x += blend.weights[i] * q.translation(j).template cast<double>() +
           rotation_less_identity<double>(q.quaternion(j).template cast<double>()) * blend.arms[i];
    }
    return x;
  }

 private:
  template <class Shapes>
  static std::vector<ShapeValues> evaluated(const FrameNodes& nodes, const Shapes& shapes,
                                            const std::vector<Vec3<double>>& positions) {
    if (shapes.nodes() != nodes.frames())
      invalid(std::string("shape functions of ") + std::to_string(shapes.nodes().size()) +
              " nodes that are not the " + std::to_string(nodes.frames().size()) + " frames");
    std::vector<ShapeValues> values;
    values.reserve(positions.size());
    for (std::size_t s = 0; s < positions.size(); ++s) {
      try {
        values.push_back(shapes.at(positions[s]));
      } catch (const std::invalid_argument& error) {
        invalid(std::string("sample ") + std::to_string(s) + ": " + error.what());
      }
    }
    return values;
  }

  void add(const FrameNodes& nodes, const ShapeValues& shapes, const Vec3<double>& X, double volume,
           std::vector<bool>& seen) {
    const std::size_t reached = shapes.nodes.size();
    if (!X.allFinite()) invalid("a coordinate is not a finite number");
    if (reached == 0) invalid("no frame reaches it");
    if (reached > count)
      invalid(std::to_string(reached) + " frames reach it, a sample of this body follows " +
              std::to_string(N) + ": fewer neighbours or a smaller support are needed");
    if (shapes.values.size() != reached || shapes.gradients.size() != reached ||
        (!shapes.slopes.empty() &&
         (shapes.slopes.size() != reached || shapes.slope_gradients.size() != reached)))
      invalid(std::to_string(reached) + " frames, but " + std::to_string(shapes.values.size()) +
              " weights and " + std::to_string(shapes.gradients.size()) + " gradients");
    Blend blend;
    std::array<Vec3<double>, count> frame, gradient;
    std::array<Mat3<double>, count> lever;
    double sum = 0;
    for (std::size_t i = 0; i < reached; ++i) {
      const std::int32_t j = shapes.nodes[i];
      if (j < 0 || static_cast<std::size_t>(j) >= seen.size())
        invalid(std::string("frame ") + std::to_string(j) + " does not exist");
      frame[i] = nodes.frames()[static_cast<std::size_t>(j)];
      blend.frames[i] = j;
      blend.weights[i] = shapes.values[i];
      gradient[i] = shapes.gradients[i];
      sum += shapes.values[i];
      if (shapes.slopes.empty()) {
        blend.arms[i] = shapes.values[i] * (X - frame[i]);
        lever[i] = (X - frame[i]) * gradient[i].transpose();
        lever[i].diagonal().array() += shapes.values[i];
      } else {
        blend.arms[i] = shapes.slopes[i];
        lever[i] = shapes.slope_gradients[i];
      }
      seen[static_cast<std::size_t>(j)] = true;
    }
    if (!(std::abs(sum - 1) <= 1e-9))
      invalid(std::string("weights sum to ") + to_text(sum) + ", they have to sum to 1");
    fill_up(nodes, reached, blend, frame, gradient, lever);
    data_.push_back(Sample::make(frame, gradient, lever, volume));
    blends_.push_back(blend);
  }

  // Frames that do not move the sample: those whose numbers are nearest to its own, which an ordered set has
  // nearby.
  static void fill_up(const FrameNodes& nodes, std::size_t reached, Blend& blend,
                      std::array<Vec3<double>, count>& frame, std::array<Vec3<double>, count>& gradient,
                      std::array<Mat3<double>, count>& lever) {
    const auto n = static_cast<std::int32_t>(nodes.frames().size());
    std::int32_t distance = 0;
    for (std::size_t i = reached; i < count; ++distance)
      for (const std::int32_t j : {blend.frames[0] - distance, blend.frames[0] + distance}) {
        const auto end = blend.frames.begin() + static_cast<std::ptrdiff_t>(i);
        if (i == count || j < 0 || j >= n || std::find(blend.frames.begin(), end, j) != end) continue;
        blend.frames[i] = j;
        blend.weights[i] = 0;
        blend.arms[i].setZero();
        frame[i] = nodes.frames()[static_cast<std::size_t>(j)];
        gradient[i].setZero();
        lever[i].setZero();
        ++i;
      }
  }

  std::size_t points_;
  std::vector<Vec3<double>> frames_, positions_;
  std::vector<double> volumes_;
  std::vector<Blend> blends_;
  std::vector<typename Sample::template Data<double>> data_;
};

}  // namespace softsim
