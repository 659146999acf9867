// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>
#include <vector>

#include "softsim/integrator/static_solver.hpp"
#include "softsim/kinematics/linked_shapes.hpp"
#include "softsim/kinematics/mesh_shapes.hpp"
#include "softsim/material/st_venant_kirchhoff.hpp"
#include "softsim/mesh/generators.hpp"
#include "softsim/mesh/hexahedral_mesh.hpp"
#include "softsim/mesh/mesh_samples.hpp"
#include "softsim/mesh/selection.hpp"
#include "softsim/potential/dead_load.hpp"
#include "softsim/potential/elastic.hpp"
#include "softsim/potential/frame_elastic.hpp"
#include "softsim/potential/frame_loads.hpp"
#include "softsim/potential/quadrature.hpp"
#include "softsim/potential/rotation_tie.hpp"
#include "softsim/solver/direct.hpp"
#include "softsim/solver/stationary.hpp"
#include "softsim/system/system.hpp"

/// Bodies of frames on the nodes of a mesh, for the study and its short test (Bosman 2015, Sec. 4.3).
namespace frame_statics {

using softsim::State, softsim::Status;
using Vec = softsim::Vec3<double>;

/// Whole arms are Bosman's blend, half arms `LinkedShapes`. A whole arm makes frames turn by half of what the
/// body does, where forces alone act on it: small displacements are then the same.
enum class Arms { whole, half };
/// Samples in an element: its Gauss points; in hexahedra 8 of them, in a single layer 27, else rotations stay
/// undetermined; or four in the plane halfway along x, from frame to frame.
enum class Sampling { gauss, halfway };

/// Frames on the nodes of a mesh.
template <class Mesh>
class Frames {
  static constexpr int N = std::is_same_v<Mesh, softsim::TetrahedralMesh> ? 4 : 8;
  using Body = softsim::FrameBody<N>;

 public:
  softsim::MeshShapes<Mesh> shapes;
  Arms arms;
  softsim::FrameNodes nodes;
  Body body;

  Frames(const Mesh& mesh, Arms arms_, Sampling sampling) : Frames(mesh, arms_, sampled(mesh, sampling)) {}
  Frames(const Mesh& mesh, Arms arms_, const softsim::Samples& samples)
      : shapes(mesh), arms(arms_), nodes(mesh.points()), body(make_body(samples)) {}

  [[nodiscard]] std::size_t unknowns() const { return 6 * nodes.frames().size(); }
  /// Displacement at X.
  [[nodiscard]] Vec displacement(const State<double>& q, const Vec& X) const {
    const softsim::ShapeValues s = shapes.at(X);
    Vec u = Vec::Zero();
    for (std::size_t i = 0; i < s.nodes.size(); ++i) {
      const Vec arm = s.values[i] * (X - nodes.frames()[static_cast<std::size_t>(s.nodes[i])]);
      u += s.values[i] * q.translation(s.nodes[i]) +
           softsim::rotation_less_identity<double>(q.quaternion(s.nodes[i])) *
               (arms == Arms::half ? 0.5 * arm : arm);
    }
    return u;
  }

 private:
  [[nodiscard]] Body make_body(const softsim::Samples& samples) const {
    if (arms == Arms::whole) return {nodes, shapes, samples.positions, samples.volumes};
    return {nodes, softsim::LinkedShapes(shapes), samples.positions, samples.volumes};
  }
  static softsim::Samples sampled(const Mesh& mesh, Sampling sampling) {
    if constexpr (N == 4) {
      return softsim::gauss_samples(mesh, 4);
    } else {
      const softsim::Samples samples = softsim::gauss_samples(mesh);
      if (sampling == Sampling::gauss) {
        const bool single_layer = mesh.points().size() > 2 * mesh.elements().size();
        return single_layer ? softsim::gauss_samples(mesh, softsim::ElementRule::mass) : samples;
      }
      softsim::Samples halfway;  // of bricks: each pair along x, which follow one another, becomes one
      for (std::size_t s = 0; s < samples.positions.size(); s += 2) {
        halfway.positions.push_back((samples.positions[s] + samples.positions[s + 1]) / 2);
        halfway.volumes.push_back(samples.volumes[s] + samples.volumes[s + 1]);
      }
      return halfway;
    }
  }
};

/// Equilibrium of a system, by direct solves.
template <class S>
bool solve(S& system, State<double>& q, int steps, double tolerance = 1e-8) {
  using Solver = softsim::StaticSolver<S, softsim::Assembled, softsim::Ldlt, softsim::Stationary>;
  return Solver({.max_iterations = 60, .tolerance = tolerance}, {.steps = steps}).solve(system, q).status ==
         Status::converged;
}

/// A beam along x, clamped at x = 0, under its own weight along -z.
struct Beam {
  Vec size;
  double young, poisson, mass;
  [[nodiscard]] double density() const { return mass / size.prod(); }
  [[nodiscard]] Vec tip() const { return {size[0], size[1] / 2, size[2] / 2}; }
};
/// Bosman's Fig. 4.12 (refcase S2.5) and 4.13 (S2.3).
inline const Beam steel{{16, 0.5, 0.5}, 2e11, 0.3, 31200}, soft{{16, 1, 1}, 4e4, 0.3, 5};
inline const Vec down(0, 0, -9.81);

/// Frames with St. Venant-Kirchhoff under their weight along g, m/s^2.
template <class Mesh>
auto system_of(const Frames<Mesh>& frames, double young, double poisson, double density, const Vec& g) {
  return softsim::System(
      frames.nodes,
      softsim::elastic(frames.body, softsim::StVenantKirchhoff::from_young_poisson(young, poisson)),
      softsim::gravity(frames.body, density, g), softsim::rotation_tie(frames.body, 1e-3 * young));
}

/// Displacement of the middle of the end, and the number of unknowns; NaN if no equilibrium was found.
struct Answer {
  Vec u;
  std::size_t unknowns;
};

/// @param sampling a `Sampling` or `Samples`
template <class Mesh, class S>
Answer with_frames(const Beam& beam, const Mesh& mesh, Arms arms, const S& sampling, int steps = 1) {
  const Frames<Mesh> frames(mesh, arms, sampling);
  auto system = system_of(frames, beam.young, beam.poisson, beam.density(), down);
  system.prescribed.fix_frames(softsim::nodes_near(mesh, softsim::Side::xmin, 0));
  State<double> q = system.rest_state();
  if (!solve(system, q, steps)) return {Vec::Constant(NAN), frames.unknowns()};
  return {frames.displacement(q, beam.tip()), frames.unknowns()};
}

/// Finite elements.
template <class Mesh, class Law>
Answer with_elements(const Beam& beam, const Mesh& mesh, const Law& law, int steps = 1) {
  softsim::System system(mesh, softsim::elastic(mesh, law), softsim::gravity(mesh, beam.density(), down));
  system.prescribed.fix(softsim::nodes_near(mesh, softsim::Side::xmin, 0));
  State<double> q = system.rest_state();
  const std::size_t unknowns = 3 * mesh.points().size();
  if (!solve(system, q, steps)) return {Vec::Constant(NAN), unknowns};
  const softsim::ShapeValues at_tip = softsim::MeshShapes<Mesh>(mesh).at(beam.tip());
  Vec u = Vec::Zero();
  for (std::size_t i = 0; i < at_tip.nodes.size(); ++i) u += at_tip.values[i] * q.point(at_tip.nodes[i]);
  return {u, unknowns};
}

/// A steel beam of 0.5 x 0.5 m under a moment of 1 kN m on the frames of its end, nu = 0: deflection over M
/// L^2/(2 E I). The frames' rotations are what the moment works on, and whole arms let them turn by half of
/// what the body does.
inline double deflection_by_moment(double length, const std::array<int, 3>& cells, Arms arms) {
  const double side = 0.5;
  const auto mesh = softsim::box_hexahedra(cells, {length, side, side});
  const Frames<softsim::HexahedralMesh> frames(mesh, arms, Sampling::gauss);
  const auto end = softsim::nodes_near(mesh, softsim::Side::xmax, 0);
  const double inertia = std::pow(side, 4) / 12, moment = 1e3;
  softsim::System system(
      frames.nodes,
      softsim::elastic(frames.body, softsim::StVenantKirchhoff::from_young_poisson(steel.young, 0)),
      softsim::moments(frames.nodes, end,
                       std::vector<Vec>(end.size(), Vec(0, moment / static_cast<double>(end.size()), 0))),
      softsim::rotation_tie(frames.body, 1e-3 * steel.young));
  system.prescribed.fix_frames(softsim::nodes_near(mesh, softsim::Side::xmin, 0));
  State<double> q = system.rest_state();
  if (!solve(system, q, 1)) return NAN;
  return -frames.displacement(q, {length, side / 2, side / 2})[2] /
         (moment * length * length / (2 * steel.young * inertia));
}

/// The bar of Bosman's Table 4.2 (S2.14): a cylinder around z that is made 3 mm longer, in hexahedra or
/// tetrahedra on the same nodes.
struct Bar {
  static constexpr double length = 6, radius = 0.5, poisson = 0.3, elongation = 0.003;
};
template <class Mesh>
Mesh bar(int radial_cells, int axial_cells) {
  auto cylinder = softsim::cylinder_mesh(Bar::radius, Bar::length, radial_cells, axial_cells);
  if constexpr (std::is_same_v<Mesh, softsim::TetrahedralMesh>) {
    return cylinder;
  } else {
    const std::array<int, 3> cells{2 * radial_cells, 2 * radial_cells, axial_cells};
    return {cylinder.points(), softsim::box_hexahedra(cells, {1, 1, 1}).elements()};
  }
}
/// How far three points of its surface, in the middle, halfway to the end that is pulled, and there, move
/// towards the axis, m. `anchored`: the other end is clamped; else it may contract too.
template <class Mesh>
std::array<double, 3> contraction(const Mesh& mesh, Arms arms, bool anchored) {
  const Frames<Mesh> frames(mesh, arms, Sampling::gauss);
  auto system = system_of(frames, 1e6, Bar::poisson, 1, Vec::Zero());
  // The ends stay plane between frames only if these do not tilt: the traction there has a moment about each.
  const auto move = [&](std::int32_t j, double z) {
    system.prescribed.set(system.prescribed.first_block(j), 2, z);
    system.prescribed.hold_rotation(j, 0);
    system.prescribed.hold_rotation(j, 1);
  };
  for (const std::int32_t j : softsim::nodes_near(mesh, softsim::Side::zmin, 0)) {
    const Vec& X = frames.nodes.frames()[static_cast<std::size_t>(j)];
    const std::int32_t first = system.prescribed.first_block(j);
    move(j, 0);
    if (anchored || X.isZero(1e-12)) system.prescribed.fix_frames({j});
    // A frame that is held does not keep the body from turning about it: two places do.
    if (std::abs(X[1]) < 1e-12) system.prescribed.set(first, 1, 0);
  }
  for (const std::int32_t j : softsim::nodes_near(mesh, softsim::Side::zmax, 0)) move(j, Bar::elongation);
  State<double> q = system.rest_state();
  if (!solve(system, q, 1, 1e-11)) return {NAN, NAN, NAN};
  std::array<double, 3> inwards;
  for (std::size_t k = 0; k < 3; ++k)
    inwards[k] =
        -frames.displacement(q, {Bar::radius, 0, Bar::length * (0.5 + 0.25 * static_cast<double>(k))})[0];
  return inwards;
}
/// What it is in a uniform state: of linear elasticity, and of St. Venant-Kirchhoff.
inline constexpr double linear_contraction = Bar::poisson * Bar::elongation / Bar::length * Bar::radius;
inline double contraction_of_svk() {
  const double stretch = 1 + Bar::elongation / Bar::length;
  return Bar::radius * (1 - std::sqrt(1 - Bar::poisson * (stretch * stretch - 1)));
}

}  // namespace frame_statics
