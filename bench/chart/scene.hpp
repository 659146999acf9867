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

inline constexpr double not_told = std::numeric_limits<double>::quiet_NaN();
inline constexpr double is_free = not_told;

struct Scene;

/// What a method makes of a scene.
struct Answer {
  std::vector<Vec> u;  ///< displacements at the probes, time after time, m
  /// J: the potential energy of an equilibrium, that of the loads included; of a motion all of its energy, at
  /// the start and at each time. Empty where a method does not tell it.
  std::vector<double> energy = {};
  Vec force = Vec::Constant(not_told);  ///< on the nodes in `Scene::grip`, in equilibrium, N
};

/// Something that may be asked of an answer, and how far off it is.
struct Quantity {
  std::string name;   ///< of the chart's file
  std::string title;  ///< "relative error of ..."
  /// Not a number where the answer does not tell.
  std::function<double(const Scene&, const Answer&, const Answer& reference)> error;
};

/// The root of the sum of squares of the distances from the reference at the probes, over that of the
/// reference. More quantities are in quantities.hpp, and a scene can make its own.
inline Quantity displacement();

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

  std::vector<Vec> probes = {};  ///< where the displacement is asked
  /// Where the force is asked that moves a prescribed node.
  std::function<bool(const Vec&)> grip = nullptr;
  /// What counts as error, a chart each; the first steers how a chart spends its time.
  std::vector<Quantity> quantities = {displacement()};
  /// The displacement at a point and a time, where there is a closed form; else it is kept in data/NAME.csv.
  std::function<Vec(const Vec&, double)> closed_form = nullptr;
  double closed_energy = not_told;             ///< J, beside `closed_form`, if it is asked for
  Vec closed_force = Vec::Constant(not_told);  ///< N, likewise
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

/// sqrt(sum |u - v|^2 / sum |v|^2).
inline double relative_distance(const std::vector<Vec>& u, const std::vector<Vec>& v) {
  double difference = 0, size = 0;
  for (std::size_t i = 0; i < v.size(); ++i) {
    difference += (u[i] - v[i]).squaredNorm();
    size += v[i].squaredNorm();
  }
  return std::sqrt(difference / size);
}

Quantity displacement() {
  return {"displacement", "relative error of the displacement",
          [](const Scene&, const Answer& a, const Answer& b) { return relative_distance(a.u, b.u); }};
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
