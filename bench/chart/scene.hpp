// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <variant>
#include <vector>

#include "softsim/core/rotation.hpp"
#include "softsim/core/tensor.hpp"
#include "softsim/material/neo_hookean.hpp"
#include "softsim/material/st_venant_kirchhoff.hpp"
#include "softsim/mesh/hexahedral_mesh.hpp"
#include "softsim/mesh/tetrahedral_mesh.hpp"

/// Speed against accuracy: scenes, the methods that may solve them, and what runs one on the other.
namespace chart {

using Vec = softsim::Vec3<double>;
/// The law that a scene takes for the truth.
using Law = std::variant<softsim::StVenantKirchhoff, softsim::NeoHookean>;

inline constexpr double is_free = std::numeric_limits<double>::quiet_NaN();

/// A question: a body at any resolution, what holds and loads it, and where its displacement is asked, in
/// equilibrium or on its way. A scene says nothing of elements: every method makes of it what it can. All SI.
struct Scene {
  std::string name;
  std::string title;  ///< one line for people
  Law law = softsim::StVenantKirchhoff::from_young_poisson(1, 0.3);
  double young = 1, poisson = 0.3;  ///< of `law`, in small strains
  double density = 1;

  /// Resolutions to be charted, ascending; what one means is the scene's affair.
  std::vector<int> resolutions = {};
  std::function<softsim::TetrahedralMesh(int)> tetrahedra = nullptr;
  std::function<softsim::HexahedralMesh(int)> hexahedra = nullptr;  ///< empty: the shape has none

  /// Displacement that is prescribed at the node with this rest position, under the whole load; `is_free`
  /// where a component is.
  std::function<Vec(const Vec&)> support = nullptr;
  /// Rotation of a frame there, if `support` prescribes all of its displacement.
  std::function<softsim::UnitQuaternion<double>(const Vec&)> rotation = nullptr;
  Vec gravity = Vec::Zero();  ///< m/s^2
  /// Dead traction per rest area on the boundary face with this middle, Pa; empty: none.
  std::function<Vec(const Vec&)> traction = nullptr;
  int load_steps = 1;  ///< that a static solve starts with

  double duration = 0;  ///< s to be simulated from the rest shape; 0: equilibrium is asked for
  std::function<Vec(const Vec&)> velocity = nullptr;  ///< that it starts with, m/s
  std::vector<double> steps = {};                     ///< s, to be charted, descending
  int times = 1;  ///< how often on the way the displacement is asked, the end included

  /// Where the displacement is asked: the error of a method is the root of the sum of squares of its
  /// distances from the reference there, over that of the reference.
  std::vector<Vec> probes = {};
  /// The answer at a point and a time, where there is a closed form; else it is kept in data/NAME.csv.
  std::function<Vec(const Vec&, double)> closed_form = nullptr;
  /// Finest mesh that it is worked out on, a multiple of four, and with what.
  int reference_resolution = 8;
  std::string reference_preconditioner = "multigrid";
};

/// The times at which the displacement of a scene is asked; 0 for an equilibrium.
inline std::vector<double> times_of(const Scene& scene) {
  if (scene.duration == 0) return {0};
  std::vector<double> times;
  for (int k = 1; k <= scene.times; ++k) times.push_back(scene.duration * k / scene.times);
  return times;
}

/// n points from a to b, both included.
inline std::vector<Vec> points_between(const Vec& a, const Vec& b, int n) {
  std::vector<Vec> points;
  for (int i = 0; i < n; ++i) points.push_back(a + (b - a) * i / (n - 1));
  return points;
}

/// Middles of n[0] x n[1] x n[2] equal cells of a box.
inline std::vector<Vec> points_in_box(const Vec& size, const std::array<int, 3>& n) {
  std::vector<Vec> points;
  for (int k = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j)
      for (int i = 0; i < n[0]; ++i)
        points.push_back(size.cwiseProduct(Vec((i + 0.5) / n[0], (j + 0.5) / n[1], (k + 0.5) / n[2])));
  return points;
}

/// Held in all directions.
inline Vec held() { return Vec::Zero(); }
/// Free in all directions.
inline Vec all_free() { return Vec::Constant(is_free); }

}  // namespace chart
