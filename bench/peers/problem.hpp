// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <cstddef>
#include <ctime>
#include <string>
#include <utility>
#include <vector>

#include "../chart/discretise.hpp"
#include "peer.hpp"
#include "softsim/material/lame.hpp"

namespace chart {

/// What peers are given: the nodes, supports, forces and probes that our own methods get.
template <class Mesh>
class Problem {
 public:
  /// A component of a displacement that is prescribed.
  struct Held {
    std::size_t node;
    int axis;
    double u;
  };

  /// @throws NotApplicable if the scene is a motion
  Problem(const Scene& scene, Mesh of) : mesh(std::move(of)) {
    if (scene.duration > 0) throw NotApplicable("equilibria only");
    const softsim::DeadLoad<double> load = nodal_loads<double>(scene, mesh);
    for (std::size_t i = 0; i < mesh.points().size(); ++i) {
      forces.push_back(softsim::block(load.force(), static_cast<std::ptrdiff_t>(i)));
      const Vec u = scene.support(mesh.points()[i]);
      for (int a = 0; a < 3; ++a)
        if (!std::isnan(u[a])) held.push_back({i, a, u[a]});
    }
    const softsim::MeshShapes<Mesh> of_mesh(mesh);
    for (const Vec& X : scene.probes) shapes_.push_back(of_mesh.at(X));
  }

  /// Displacements at the probes, of those of the nodes.
  [[nodiscard]] std::vector<Vec> at_probes(const std::vector<Vec>& nodes) const {
    std::vector<Vec> u;
    for (const softsim::ShapeValues& s : shapes_) {
      u.push_back(Vec::Zero());
      for (std::size_t i = 0; i < s.nodes.size(); ++i)
        u.back() += s.values[i] * nodes[static_cast<std::size_t>(s.nodes[i])];
    }
    return u;
  }

  Mesh mesh;
  std::vector<Vec> forces;  ///< N, one a node
  std::vector<Held> held;

 private:
  std::vector<softsim::ShapeValues> shapes_;
};

inline Problem<softsim::TetrahedralMesh> tet4_problem(const Scene& scene, int resolution) {
  return {scene, scene.tetrahedra(resolution)};
}
inline Problem<softsim::QuadraticTetrahedralMesh> tet10_problem(const Scene& scene, int resolution) {
  return {scene, softsim::QuadraticTetrahedralMesh(scene.tetrahedra(resolution))};
}
inline Problem<softsim::HexahedralMesh> hex8_problem(const Scene& scene, int resolution) {
  return {scene, hexahedra_of(scene, resolution)};
}

inline softsim::Lame lame_of(const Scene& scene) {
  return softsim::Lame::from_young_poisson(scene.young, scene.poisson);
}
/// Whether the scene has this law.
template <class L>
bool has_law(const Scene& scene) {
  return std::holds_alternative<L>(scene.law);
}

/// CPU time of this process with all of its threads, s.
inline double process_seconds() {
  timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace chart
