// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <vector>

#include "softsim/mesh/tetrahedral_mesh.hpp"
#include "softsim/potential/dead_load.hpp"
#include "softsim/potential/spring.hpp"
#include "softsim/system/system.hpp"

/// The shallow truss of von Mises: two bars of stiffness 1 N/m from (-1, 0, 0) and (1, 0, 0) to an apex at
/// the given height, which moves up and down only.
namespace truss {

using System = softsim::System<softsim::Elements<softsim::Spring>, softsim::DeadLoad<double>>;

struct Truss {
  double height, length, load;  // load downwards, N
  System system;

  /// Under `part` times the load at which it snaps through.
  Truss(double height_, double part)
      : height(height_), length(std::sqrt(1 + height * height)), load(part * limit()), system(make()) {
    const softsim::Vec3<double> none = softsim::Vec3<double>::Zero();
    for (const int i : {0, 1, 3}) system.prescribed.set(i, none);
    system.prescribed.set(2, 0, 0.0);
    system.prescribed.set(2, 1, 0.0);
  }

  /// Force downwards that holds the apex at height z: 2 (L/l - 1) z with l^2 = 1 + z^2.
  [[nodiscard]] double force(double z) const { return 2 * (length / std::sqrt(1 + z * z) - 1) * z; }
  /// Its maximum: at l^3 = L, with l^2 = 1 + z^2.
  [[nodiscard]] double limit() const { return force(std::sqrt(std::pow(length, 2.0 / 3) - 1)); }

 private:
  [[nodiscard]] System make() const {
    using Vec = softsim::Vec3<double>;
    const softsim::TetrahedralMesh mesh({Vec(-1, 0, 0), Vec(1, 0, 0), Vec(0, 0, height), Vec(0, 1, 0)},
                                        {softsim::Tetrahedron{0, 1, 3, 2}});
    softsim::DeadLoad<double> weight(4);
    weight.add(2, Vec(0, 0, -load));
    const std::vector<softsim::Edge> bars{{0, 2}, {1, 2}};
    return System(mesh, softsim::springs(mesh, bars, {1, 1}), weight);
  }
};

}  // namespace truss
