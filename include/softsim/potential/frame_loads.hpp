// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "softsim/core/error.hpp"
#include "softsim/kinematics/frame_body.hpp"
#include "softsim/potential/elements.hpp"

namespace softsim {

/// Dead forces on what a frame carries, summed up: with forces f at c from the frame's origin at rest, E =
/// -(u . sum f + (R - I) : sum f c^T). Its torque turns with the frame, and so has a tangent.
struct FrameDeadForces {
  static constexpr int points = 0, frames = 1;
  static constexpr bool external = true;
  /// Sum of the forces in N, and of f c^T in N m.
  template <class T>
  struct Data {
    Vec3<T> force;
    Mat3<T> moment;
  };

  /// J.
  template <class T>
  [[nodiscard]] T energy(const Data<T>& data, const Local<T, 0, 1>& u) const {
    return -(data.force.dot(u.frames[0].displacement) + double_dot<T>(data.moment, u.frames[0].turn));
  }
  /// Minus force, N, and torque in the axes of the body, N m.
  template <class T>
  [[nodiscard]] Eigen::Matrix<T, 6, 1> gradient(const Data<T>& data, const Local<T, 0, 1>& u) const {
    Eigen::Matrix<T, 6, 1> g;
    g.template head<3>() = -data.force;
    g.template tail<3>() = -axial<T>(u.frames[0].to_body(data.moment));
    return g;
  }
  /// The derivative of the torque, its symmetric part: see `FrameSample::geometric_product`.
  template <class T>
  [[nodiscard]] Eigen::Matrix<T, 6, 1> hessian_product(const Data<T>& data, const Local<T, 0, 1>& u,
                                                       const Eigen::Matrix<T, 6, 1>& du) const {
    const Mat3<T> B = squared_skew_form(Mat3<T>(u.frames[0].to_body(data.moment)));
    Eigen::Matrix<T, 6, 1> g;
    g.template head<3>().setZero();
    g.template tail<3>() = -(B * du.template tail<3>());
    return g;
  }
};

/// A moment on a frame that keeps its direction in space, m: it does not derive from an energy. The symmetric
/// part of its derivative is zero.
struct FrameMoment {
  static constexpr int points = 0, frames = 1;
  static constexpr bool external = true;
  /// In the axes of space, N m.
  template <class T>
  struct Data {
    Vec3<T> moment;
  };

  /// Minus the torque in the axes of the body, N m.
  template <class T>
  [[nodiscard]] Eigen::Matrix<T, 6, 1> gradient(const Data<T>& data, const Local<T, 0, 1>& u) const {
    Eigen::Matrix<T, 6, 1> g;
    g.template head<3>().setZero();
    g.template tail<3>() = -u.frames[0].to_body(data.moment);
    return g;
  }
  /// Zero: [R^T m]x, the derivative of the torque, is skew.
  template <class T>
  [[nodiscard]] Eigen::Matrix<T, 6, 1> hessian_product(const Data<T>&, const Local<T, 0, 1>&,
                                                       const Eigen::Matrix<T, 6, 1>&) const {
    return Eigen::Matrix<T, 6, 1>::Zero();
  }
};

/// Dead forces on samples of a body, to be added up and made a term of a system.
template <int N>
class FrameLoad {
 public:
  /// No force on `body`, which has to stay alive while forces are added.
  explicit FrameLoad(const FrameBody<N>& body) : body_(&body) {}

  /// Adds the force f in N at sample s, shared out between its frames as its motion is.
  /// @throws std::invalid_argument if the sample does not exist or the force is not finite
  FrameLoad& add(std::size_t s, const Vec3<double>& f) {
    if (s >= body_->size()) invalid(std::string("load on sample ") + std::to_string(s) + ": out of range");
    if (!f.allFinite()) invalid(std::string("load on sample ") + std::to_string(s) + ": not a finite force");
    const auto& blend = body_->blends()[s];
    for (std::size_t i = 0; i < FrameBody<N>::count; ++i) {
      if (blend.weights[i] == 0 && blend.arms[i].isZero(0)) continue;
      FrameDeadForces::Data<double>& data = at(body_->frame_block(blend.frames[i]));
      data.force += blend.weights[i] * f;
      data.moment += f * blend.arms[i].transpose();
    }
    return *this;
  }
  /// Adds the weight of the body.
  /// @param density kg/m^3
  /// @param g acceleration in m/s^2
  /// @throws std::invalid_argument unless the density is positive and finite
  FrameLoad& add_weight(double density, const Vec3<double>& g) {
    if (!(density > 0) || !(density <= 1e300))
      invalid(std::string("density ") + to_text(density) + " kg/m^3: must be positive and finite");
    for (std::size_t s = 0; s < body_->size(); ++s) add(s, density * body_->volumes()[s] * g);
    return *this;
  }

  /// The load as a term of a system.
  template <class T = double>
  [[nodiscard]] Elements<FrameDeadForces, T> term() const {
    std::vector<FrameDeadForces::Data<double>> data;
    std::vector<std::array<std::int32_t, 2>> stencils;
    for (std::size_t k = 0; k < forces_.size(); ++k)
      if (loaded_[k]) {
        data.push_back(forces_[k]);
        const auto first = static_cast<std::int32_t>(k);
        stencils.push_back({first, first + 1});
      }
    return {{FrameDeadForces{}}, data, stencils};
  }

 private:
  FrameDeadForces::Data<double>& at(std::int32_t frame_block) {
    const auto k = static_cast<std::size_t>(frame_block);
    if (k >= forces_.size()) {
      forces_.resize(k + 1, {Vec3<double>::Zero(), Mat3<double>::Zero()});
      loaded_.resize(k + 1, false);
    }
    loaded_[k] = true;
    return forces_[k];
  }

  const FrameBody<N>* body_;
  std::vector<FrameDeadForces::Data<double>> forces_;  // by the frame's first block
  std::vector<bool> loaded_;
};

/// Weight of a body of one density, as a term of a system: see `FrameLoad::add_weight`.
template <class T = double, int N>
[[nodiscard]] Elements<FrameDeadForces, T> gravity(const FrameBody<N>& body, double density,
                                                   const Vec3<double>& g) {
  return FrameLoad<N>(body).add_weight(density, g).template term<T>();
}

/// Moments in N m on frames, in the axes of space.
/// @throws std::invalid_argument naming a frame that does not exist or whose moment is not finite
template <class T = double>
[[nodiscard]] inline Elements<FrameMoment, T> moments(const FrameNodes& nodes,
                                                      const std::vector<std::int32_t>& frames,
                                                      const std::vector<Vec3<double>>& values) {
  if (frames.size() != values.size())
    invalid(std::string("moments: ") + std::to_string(values.size()) + " for " +
            std::to_string(frames.size()) + " frames");
  std::vector<FrameMoment::Data<double>> data;
  std::vector<std::array<std::int32_t, 2>> stencils;
  for (std::size_t k = 0; k < frames.size(); ++k) {
    if (frames[k] < 0 || static_cast<std::size_t>(frames[k]) >= nodes.frames().size())
      invalid(std::string("moment on frame ") + std::to_string(frames[k]) + ": out of range");
    if (!values[k].allFinite())
      invalid(std::string("moment on frame ") + std::to_string(frames[k]) + ": not finite");
    const auto first = static_cast<std::int32_t>(nodes.points().size()) + 2 * frames[k];
    data.push_back({values[k]});
    stencils.push_back({first, first + 1});
  }
  return {{FrameMoment{}}, data, stencils};
}

}  // namespace softsim
