// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "softsim/core/error.hpp"
#include "softsim/core/state.hpp"
#include "softsim/mesh/element_mesh.hpp"

namespace softsim {

/// Constant forces on points: E = -f . u. Gravity and nodal forces; loads may be added up in one.
template <class T>
class DeadLoad {
 public:
  using Scalar = T;
  static constexpr bool conservative = true;
  static constexpr bool external = true;
  static constexpr bool has_hessian = false;

  /// No force on any of the points and frames.
  explicit DeadLoad(std::size_t points, std::size_t frames = 0)
      : force_(Vector<T>::Zero(block_stride * static_cast<std::ptrdiff_t>(points + 2 * frames))),
        frames_(static_cast<std::ptrdiff_t>(frames)) {}

  /// Adds the force f in N on the origin of one frame. Forces on what frames carry: see `FrameLoad`.
  /// @throws std::invalid_argument if the frame does not exist or the force is not finite
  DeadLoad& add_to_frame(std::int32_t frame, const Vec3<double>& f) {
    if (frame < 0 || frame >= frames_)
      invalid(std::string("load on frame ") + std::to_string(frame) + ": out of range");
    if (!f.allFinite())
      invalid(std::string("load on frame ") + std::to_string(frame) + ": not a finite force");
    block(force_, points() + 2 * frame) += f.template cast<T>();
    return *this;
  }
  /// Makes room for frames that no force of this load acts on, as a system has them beside its points.
  DeadLoad& with_frames(std::size_t frames) {
    const std::ptrdiff_t count = points();
    frames_ = static_cast<std::ptrdiff_t>(frames);
    force_.conservativeResize(block_stride * (count + 2 * frames_));
    force_.tail(force_.size() - block_stride * count).setZero();
    return *this;
  }

  /// Adds the force f in N on one point.
  /// @throws std::invalid_argument if the point does not exist or the force is not finite
  DeadLoad& add(std::int32_t point, const Vec3<double>& f) {
    if (point < 0 || point >= points())
      invalid(std::string("load on node ") + std::to_string(point) + ": out of range");
    if (!f.allFinite())
      invalid(std::string("load on node ") + std::to_string(point) + ": not a finite force");
    block(force_, point) += f.template cast<T>();
    return *this;
  }

  /// Spreads the total force f in N evenly over points.
  /// @throws std::invalid_argument if there is no point, one does not exist, or the force is not finite
  DeadLoad& spread(const std::vector<std::int32_t>& points, const Vec3<double>& f) {
    if (points.empty()) invalid("load: no node to spread the force over");
    for (const std::int32_t i : points) add(i, f / static_cast<double>(points.size()));
    return *this;
  }

  /// Forces, N: one block per point, two per frame, the second zero.
  [[nodiscard]] const Vector<T>& force() const { return force_; }

  /// -f . u, J.
  [[nodiscard]] double energy(const State<T>& q) const { return -dot(force_, q.displacement); }
  /// y -= f.
  void add_gradient(const State<T>&, Vector<T>& y) const { y -= force_; }
  /// Nothing: the force does not depend on the state.
  void add_hessian_product(const State<T>&, const Vector<T>&, Vector<T>&) const {}

 private:
  [[nodiscard]] std::ptrdiff_t points() const { return force_.size() / block_stride - 2 * frames_; }

  Vector<T> force_;
  std::ptrdiff_t frames_ = 0;
};

/// Weight of a body: int rho N_i g dV on each node, for linear tetrahedra a quarter of each one's rho V g.
/// @param density one value in kg/m^3, or one per element
/// @param g acceleration in m/s^2
/// @throws std::invalid_argument unless every density is positive and finite
template <class T = double, SolidMesh Mesh>
[[nodiscard]] DeadLoad<T> gravity(const Mesh& mesh, const std::vector<double>& density,
                                  const Vec3<double>& g) {
  DeadLoad<T> load(mesh.points().size());
  if (density.size() != mesh.elements().size())
    invalid(std::string("gravity: ") + std::to_string(density.size()) + " densities for " +
            std::to_string(mesh.elements().size()) + " " + Mesh::name.plural);
  for (std::size_t e = 0; e < mesh.elements().size(); ++e) {
    if (!(density[e] > 0) || !(density[e] <= 1e300))
      invalid(std::string("density ") + to_text(density[e]) + " kg/m^3: must be positive and finite");
    const auto volumes = mesh.shape_integrals(e);
    for (std::size_t i = 0; i < volumes.size(); ++i)
      load.add(mesh.elements()[e][i], density[e] * volumes[i] * g);
  }
  return load;
}

/// Weight of a body of one density, see above.
template <class T = double, SolidMesh Mesh>
[[nodiscard]] DeadLoad<T> gravity(const Mesh& mesh, double density, const Vec3<double>& g) {
  return gravity<T>(mesh, std::vector<double>(mesh.elements().size(), density), g);
}

}  // namespace softsim
