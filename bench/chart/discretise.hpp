// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <utility>
#include <variant>
#include <vector>

#include "model.hpp"
#include "softsim/kinematics/mesh_shapes.hpp"
#include "softsim/mesh/isoparametric_mesh.hpp"
#include "softsim/mesh/quadratic_tetrahedral_mesh.hpp"
#include "softsim/potential/dead_load.hpp"
#include "softsim/potential/face_loads.hpp"

// What models of points share: meshes, supports, loads, probes.

namespace chart {

/// The mesh of a scene, or why there is none.
inline softsim::HexahedralMesh hexahedra_of(const Scene& scene, int resolution) {
  if (!scene.hexahedra) throw NotApplicable("this shape has no mesh of hexahedra");
  return scene.hexahedra(resolution);
}

template <class T>
void hold_points(AnySystem<T>& system, const Scene& scene) {
  for (std::size_t i = 0; i < system.rest().size(); ++i) {
    const Vec u = scene.support(system.rest()[i]);
    for (int a = 0; a < 3; ++a)
      if (!std::isnan(u[a])) system.prescribed.set(static_cast<std::int32_t>(i), a, u[a]);
  }
}

/// Calls f(node, share of its force) for the tractions of a scene on the boundary of a mesh.
template <class Mesh, class Function>
void for_each_traction(const Scene& scene, const Mesh& mesh, Function f) {
  if (!scene.traction) return;
  const auto middle = [&](const auto& face) {
    Vec X = Vec::Zero();
    for (const std::int32_t i : face) X += mesh.points()[static_cast<std::size_t>(i)];
    return Vec(X / static_cast<double>(face.size()));
  };
  if constexpr (std::is_same_v<Mesh, softsim::TetrahedralMesh>) {
    for (const softsim::Triangle& t : softsim::boundary_triangles(mesh)) {
      const auto X = [&](std::size_t i) -> const Vec& {
        return mesh.points()[static_cast<std::size_t>(t[i])];
      };
      const Vec third = (X(1) - X(0)).cross(X(2) - X(0)).norm() / 6 * scene.traction(middle(t));
      if (!third.isZero(0))
        for (const std::int32_t i : t) f(i, third);
    }
  } else {
    for (const auto& face : softsim::boundary_faces(mesh)) {
      const Vec t = scene.traction(middle(face));
      if (t.isZero(0)) continue;
      const softsim::DeadLoad<double> load = softsim::traction(mesh, {face}, t);
      for (const std::int32_t i : face) f(i, Vec(softsim::block(load.force(), i)));
    }
  }
}

/// Weight and tractions as forces on nodes.
template <class T, class Mesh>
softsim::DeadLoad<T> nodal_loads(const Scene& scene, const Mesh& mesh) {
  softsim::DeadLoad<T> load = scene.gravity.isZero(0)
                                  ? softsim::DeadLoad<T>(mesh.points().size())
                                  : softsim::gravity<T>(mesh, scene.density, scene.gravity);
  for_each_traction(scene, mesh, [&](std::int32_t i, const Vec& f) { load.add(i, f); });
  return load;
}

/// A system of points on the nodes of a mesh.
template <class T, class Mesh>
Discrete<T> discrete(const Scene& scene, const Mesh& mesh, bench::AnyTerm<T> elastic,
                     bench::AnyTerm<T> more = {}) {
  AnySystem<T> system(mesh, std::move(elastic), std::move(more), nodal_loads<T>(scene, mesh));
  hold_points(system, scene);
  system.mass = softsim::Mass<T>::lumped(mesh, scene.density);
  std::vector<softsim::ShapeValues> shapes;
  const softsim::MeshShapes<Mesh> of_mesh(mesh);
  for (const Vec& X : scene.probes) shapes.push_back(of_mesh.at(X));
  const auto at_probes = [shapes](const softsim::State<T>& q) {
    std::vector<Vec> u;
    for (const softsim::ShapeValues& s : shapes) {
      u.push_back(Vec::Zero());
      for (std::size_t i = 0; i < s.nodes.size(); ++i)
        u.back() += s.values[i] * q.point(s.nodes[i]).template cast<double>();
    }
    return u;
  };
  const auto warped = [mesh, held = system.prescribed](const Eigen::MatrixXd& modes) {
    return std::make_shared<softsim::WarpedModes>(mesh, held, modes);
  };
  return {std::move(system), at_probes, warped};
}

}  // namespace chart
