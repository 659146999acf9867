// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <array>
#include <cstddef>
#include <cstdint>

#include "discretise.hpp"
#include "softsim/kinematics/frame_body.hpp"
#include "softsim/kinematics/interpolating_moving_least_squares.hpp"
#include "softsim/kinematics/linked_shapes.hpp"
#include "softsim/kinematics/shepard.hpp"
#include "softsim/mesh/frame_nodes.hpp"
#include "softsim/mesh/mesh_samples.hpp"
#include "softsim/potential/frame_elastic.hpp"
#include "softsim/potential/frame_loads.hpp"
#include "softsim/potential/rotation_tie.hpp"

// Models with a 6-DoF frame on every node of a mesh.

namespace chart {
namespace {

using namespace softsim;

/// What the load on one frame sums up to.
class FrameForces {
 public:
  explicit FrameForces(std::size_t frames) : data_(frames, {Vec::Zero(), Mat3<double>::Zero()}) {}
  /// The force f at a point that moves with the frame by its weight and its arm.
  void add(std::int32_t frame, double weight, const Vec& arm, const Vec& f) {
    auto& d = data_[static_cast<std::size_t>(frame)];
    d.force += weight * f;
    d.moment += f * arm.transpose();
  }
  template <class T>
  [[nodiscard]] Elements<FrameDeadForces, T> term() const {
    std::vector<std::array<std::int32_t, 2>> stencils;
    for (std::size_t j = 0; j < data_.size(); ++j)
      stencils.push_back({2 * static_cast<std::int32_t>(j), 2 * static_cast<std::int32_t>(j) + 1});
    return {{FrameDeadForces{}}, data_, stencils};
  }

 private:
  std::vector<FrameDeadForces::Data<double>> data_;
};

template <class T>
void hold_frames(AnySystem<T>& system, const Scene& scene, const FrameNodes& nodes) {
  for (std::size_t k = 0; k < nodes.frames().size(); ++k) {
    const Vec& X = nodes.frames()[k];
    const auto j = static_cast<std::int32_t>(k);
    const Vec u = scene.support(X);
    if (!u.hasNaN()) {
      system.prescribed.set_frame(
          j, u, scene.rotation ? scene.rotation(X) : quaternion_exponential(Vec(Vec::Zero())));
      continue;
    }
    for (int a = 0; a < 3; ++a) {
      if (std::isnan(u[a])) continue;
      system.prescribed.set(system.prescribed.first_block(j), a, u[a]);
      for (const int other : {(a + 1) % 3, (a + 2) % 3})
        system.prescribed.hold_rotation(j, other);  // stays a plane
    }
  }
}

/// Frames on all nodes that `shapes` is made of. `half`: with half the arms, as `LinkedShapes` has them.
template <class T, int N, class Mesh, class Shapes>
Discrete<T> discrete(const Scene& scene, const Mesh& mesh, const Shapes& shapes, bool half,
                     const Samples& samples) {
  const FrameNodes nodes(mesh.points());
  const auto body = [&]() -> FrameBody<N> {
    if constexpr (std::is_same_v<Shapes, MeshShapes<Mesh>>)
      if (half) return {nodes, LinkedShapes(shapes), samples.positions, samples.volumes};
    return {nodes, shapes, samples.positions, samples.volumes};
  }();
  FrameForces forces(nodes.frames().size());
  for (std::size_t s = 0; s < body.size(); ++s) {
    const auto& blend = body.blends()[s];
    for (std::size_t i = 0; i < body.count; ++i)
      forces.add(blend.frames[i], blend.weights[i], blend.arms[i],
                 scene.density * body.volumes()[s] * scene.gravity);
  }
  const auto blend_at = [shapes, half, X0 = nodes.frames()](const Vec& X) {
    const ShapeValues s = shapes.at(X);
    std::vector<Vec> arms;
    for (std::size_t i = 0; i < s.nodes.size(); ++i)
      arms.push_back((half ? 0.5 : 1) * s.values[i] * (X - X0[static_cast<std::size_t>(s.nodes[i])]));
    return std::pair(s, arms);
  };
  // on the nodes, where all of these functions interpolate: a frame's own arm is zero there
  for_each_traction(scene, mesh, [&](std::int32_t j, const Vec& f) { forces.add(j, 1, Vec::Zero(), f); });
  AnySystem<T> system(
      nodes,
      std::visit([&](const auto& law) -> bench::AnyTerm<T> { return elastic<T>(body, law); }, scene.law),
      bench::AnyTerm<T>(rotation_tie<T>(body, 1e-3 * scene.young)), forces.template term<T>());
  hold_frames(system, scene, nodes);
  system.mass = Mass<T>::lumped(body, scene.density);
  std::vector<std::pair<ShapeValues, std::vector<Vec>>> blends;
  for (const Vec& X : scene.probes) blends.push_back(blend_at(X));
  const auto at_probes = [blends](const State<T>& q) {
    std::vector<Vec> u;
    for (const auto& [s, arms] : blends) {
      u.push_back(Vec::Zero());
      for (std::size_t i = 0; i < arms.size(); ++i) {
        const std::int32_t j = s.nodes[i];
        u.back() += s.values[i] * q.translation(j).template cast<double>() +
                    rotation_less_identity<double>(q.quaternion(j).template cast<double>()) * arms[i];
      }
    }
    return u;
  };
  return {std::move(system), at_probes};
}

Model on_hexahedra(const std::string& name, bool half) {
  return Model(name, "frames", [half]<class T>(std::type_identity<T>, const Scene& s, int resolution) {
    const HexahedralMesh mesh = hexahedra_of(s, resolution);
    const bool single_layer = mesh.points().size() > 2 * mesh.elements().size();
    const Samples samples = gauss_samples(mesh, single_layer ? ElementRule::mass : ElementRule::stiffness);
    return discrete<T, 8>(s, mesh, MeshShapes(mesh), half, samples);
  });
}
Model on_tetrahedra(const std::string& name, bool half) {
  return Model(name, "frames", [half]<class T>(std::type_identity<T>, const Scene& s, int resolution) {
    const TetrahedralMesh mesh = s.tetrahedra(resolution);
    return discrete<T, 4>(s, mesh, MeshShapes(mesh), half, gauss_samples(mesh));
  });
}

// Functions of scattered nodes that interpolate, since the supports of scenes are those of nodes.
template <class F>
Model without_mesh(const std::string& name, F shapes) {
  return Model(name, "frames", [shapes]<class T>(std::type_identity<T>, const Scene& s, int resolution) {
    const TetrahedralMesh mesh = s.tetrahedra(resolution);
    if (mesh.points().size() < 8) throw NotApplicable("needs eight nodes");
    const FrameNodes nodes(mesh.points());
    return discrete<T, 8>(s, mesh, shapes(nodes.frames()), false, gauss_samples(mesh));
  });
}

}  // namespace

std::vector<Model> frames() {
  return {
      on_hexahedra("frames_hex8", false),
      on_hexahedra("frames_hex8_linked", true),
      on_tetrahedra("frames_tet4", false),
      on_tetrahedra("frames_tet4_linked", true),
      // without a mesh but for its nodes and samples: the nearest eight
      without_mesh("frames_shepard", [](const auto& nodes) { return Shepard<>(nodes, {.nearest = 8}); }),
      without_mesh(
          "frames_least_squares",
          [](const auto& nodes) { return InterpolatingMovingLeastSquares<>(nodes, {.nearest = 8}); }),
  };
}

}  // namespace chart
