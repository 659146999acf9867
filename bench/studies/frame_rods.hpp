// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

#include "softsim/integrator/static_solver.hpp"
#include "softsim/kinematics/linked_shapes.hpp"
#include "softsim/kinematics/polyline_shapes.hpp"
#include "softsim/kinematics/shepard.hpp"
#include "softsim/material/rod.hpp"
#include "softsim/mesh/curve_samples.hpp"
#include "softsim/potential/dead_load.hpp"
#include "softsim/potential/frame_elastic.hpp"
#include "softsim/potential/frame_loads.hpp"
#include "softsim/solver/direct.hpp"
#include "softsim/solver/stationary.hpp"
#include "softsim/system/system.hpp"

/// Rods of one row of frames against closed forms, for the study and its short test.
namespace frame_rods {

using softsim::FrameBody, softsim::FrameNodes, softsim::State, softsim::Status;
using Vec = softsim::Vec3<double>;

/// How frames blend between each other, and how many sections of samples stand in a gap between two.
/// Shepard's functions are of the two nearest frames: flat at these, they stretch bending and shear, and once
/// frames are nearer than the rod is thick they are all but equal off the axis, and the rod goes soft.
enum class Blend { linear, linked, shepard };
struct Method {
  const char* name;
  Blend blend;
  int sections;
};

/// Square rod with frames at equal distances on a line or an inscribed polygon, clamped at its start.
struct Rod {
  FrameNodes nodes;
  double side;
  FrameBody<2> body;
  std::vector<softsim::Rod::Data<double>> tangents;

  Rod(std::vector<Vec> line, double side_, const Method& method)
      : nodes(std::move(line)), side(side_), body(make_body(method)) {
    const std::size_t gaps = nodes.frames().size() - 1, per_gap = body.size() / gaps;
    for (std::size_t s = 0; s < body.size(); ++s) {
      const std::size_t gap = s / per_gap;
      tangents.push_back({(nodes.frames()[gap + 1] - nodes.frames()[gap]).normalized()});
    }
  }
  [[nodiscard]] std::int32_t tip() const { return static_cast<std::int32_t>(nodes.frames().size()) - 1; }

 private:
  [[nodiscard]] FrameBody<2> make_body(const Method& method) const {
    const auto& line = nodes.frames();
    const int pieces = method.sections * (static_cast<int>(line.size()) - 1);
    const auto samples = softsim::sample_curve(line, softsim::rectangle(side, side), pieces, Vec::UnitZ());
    const auto with = [&](const auto& shapes) -> FrameBody<2> {
      return {nodes, shapes, samples.positions, samples.volumes};
    };
    if (method.blend == Blend::linear) return with(softsim::PolylineShapes(line));
    if (method.blend == Blend::linked) return with(softsim::LinkedShapes(softsim::PolylineShapes(line)));
    return with(softsim::Shepard<>(line, {.nearest = 2}));
  }
};

/// n frames from the origin along x.
inline std::vector<Vec> straight(int n, double length) {
  std::vector<Vec> line;
  for (int i = 0; i < n; ++i) line.emplace_back(length * i / (n - 1), 0, 0);
  return line;
}

/// The tip: displacement, and angle of its rotation; NaN if no equilibrium was found.
struct Tip {
  Vec u;
  double angle;
};

/// Equilibrium of a clamped system. Newton's steps are taken as they are: a rod resists stretching so much
/// more than bending that a line search on residuals would cut back every turn.
template <class S>
Tip solve(S& system, State<double>& q, std::int32_t tip, int steps) {
  system.prescribed.fix_frames({0});
  using Solver = softsim::StaticSolver<S, softsim::Assembled, softsim::Ldlt, softsim::Stationary>;
  Solver solver({.max_iterations = 30, .tolerance = 1e-6, .line_search = false},
                {.steps = steps, .smallest = 1e-2});
  if (solver.solve(system, q).status != Status::converged) return {Vec::Constant(NAN), NAN};
  return {q.translation(tip), softsim::quaternion_logarithm<double>(q.quaternion(tip)).norm()};
}

/// A dead force on the last frame in N, one per length of the rod in N/m, and a moment on the last frame
/// about z in N m.
struct Loads {
  Vec force = Vec::Zero(), per_length = Vec::Zero();
  double moment = 0;
};
template <class Elastic>
auto system_of(const Rod& rod, const Elastic& elastic, const Loads& loads) {
  softsim::DeadLoad<double> at_tip(0, rod.nodes.frames().size());
  at_tip.add_to_frame(rod.tip(), loads.force);
  return softsim::System(rod.nodes, elastic, at_tip,
                         softsim::gravity(rod.body, 1 / (rod.side * rod.side), loads.per_length),
                         softsim::moments(rod.nodes, {rod.tip()}, {{0, 0, loads.moment}}));
}
inline auto elastic(const Rod& rod, double E) {
  return softsim::elastic(rod.body, softsim::Rod(E, E / 2), rod.tangents);
}
inline Tip under(const Loads& loads, const Rod& rod, double E, int steps) {
  auto system = system_of(rod, elastic(rod, E), loads);
  State<double> q = system.rest_state();
  return solve(system, q, rod.tip(), steps);
}
/// The moment alone, the rod kept in its plane: past 0.4 of the moment that closes a ring the tangent, which
/// is symmetrised, does not lead Newton's method back to it.
template <class Elastic>
Tip under_moment(const Rod& rod, const Elastic& elastic, double moment, int steps) {
  auto system = system_of(rod, elastic, {.moment = moment});
  for (std::int32_t j = 1; j <= rod.tip(); ++j) {
    system.prescribed.set(system.prescribed.first_block(j), 2, 0);
    system.prescribed.hold_rotation(j, 0);
    system.prescribed.hold_rotation(j, 1);
  }
  State<double> q = system.rest_state();
  return solve(system, q, rod.tip(), steps);
}

// The cases; each gives the distance of the tip from where it should be, over the length of the rod.

/// A rod that a moment of 2 pi EI/L rolls up to a ring (refcase S3.8).
inline constexpr double ring_length = 10, ring_stiffness = 100, ring_side = 0.05;
inline double roll_up(const Method& method, int frames) {
  const Rod rod(straight(frames, ring_length), ring_side, method);
  const double E = 12 * ring_stiffness / std::pow(ring_side, 4);
  const Tip tip = under_moment(rod, elastic(rod, E), 2 * std::numbers::pi * ring_stiffness / ring_length, 10);
  return (tip.u - Vec(-ring_length, 0, 0)).norm() / ring_length;
}

/// The same by hand: the moment in the middle of a gap is EI sin(theta)/h, theta being the turn between its
/// two frames, and chords of length h follow each other; less the thickness.
inline double predicted_roll_up(int frames) {
  const int gaps = frames - 1;
  const double theta = std::asin(2 * std::numbers::pi / gaps);
  Vec tip = Vec::Zero();
  for (int i = 0; i < gaps; ++i)
    tip += Vec(std::cos((i + 0.5) * theta), std::sin((i + 0.5) * theta), 0) / gaps;
  return tip.norm();
}

/// Bathe & Bolourchi's bend of 45 degrees under a force out of its plane (S3.9).
struct Bend {
  double force;
  Vec tip;
};
inline const std::vector<Bend> bends{{300, {58.7789, 22.2447, 40.1924}},
                                     {450, {52.2383, 18.5081, 48.5035}},
                                     {600, {47.1501, 15.6847, 53.4755}}};
inline double bend_45(const Method& method, int frames, const Bend& bend) {
  constexpr double radius = 100, angle = std::numbers::pi / 4;
  std::vector<Vec> arc;
  for (int i = 0; i < frames; ++i) {
    const double phi = angle * i / (frames - 1);
    arc.emplace_back(radius * std::sin(phi), radius * (1 - std::cos(phi)), 0);
  }
  const Rod rod(arc, 1, method);
  const Tip tip = under({.force = {0, 0, bend.force}}, rod, 1e7, 6);
  return (arc.back() + tip.u - bend.tip).norm() / (radius * angle);
}

/// Elastica under a dead force at the tip, P L^2/EI (S3.6), or a dead load per length, q L^3/EI (S3.7): what
/// the tip sinks and comes back, over L.
struct Elastica {
  double load, sink, back;
};
inline const std::vector<Elastica> tip_loads{
    {1, .30172077, .05643324}, {4, .66996418, .32894124}, {10, .81060902, .55499560}};
inline const std::vector<Elastica> uniform_loads{
    {5, .49590504, .15334282}, {10, .70019972, .34364624}, {20, .82988144, .55476795}};
inline constexpr double elastica_side = 0.01;  // of length 1
inline double elastica(const Method& method, int frames, const Elastica& goal, bool uniform) {
  const Rod rod(straight(frames, 1), elastica_side, method);
  const double E = 12 / std::pow(elastica_side, 4);  // EI = 1
  const Vec load(0, -goal.load, 0);
  const Tip tip = under(uniform ? Loads{.per_length = load} : Loads{.force = load}, rod, E, 4);
  return (tip.u - Vec(-goal.back, -goal.sink, 0)).norm();
}

/// Deflection of such a rod under a small force at its tip, over that of Timoshenko's beam with shear
/// factor 1.
inline double small_deflection(const Method& method, int frames) {
  const Rod rod(straight(frames, 1), elastica_side, method);
  const double E = 12 / std::pow(elastica_side, 4), shear = E / 2 * elastica_side * elastica_side;
  constexpr double force = 0.01;
  const Tip tip = under({.force = {0, -force, 0}}, rod, E, 1);
  return -tip.u[1] / (force * (1.0 / 3 + 1 / shear));
}
/// What linear weights make of it, linked or not, with frames at a distance h in a rod of height t. Every gap
/// bends by the moment in its middle: 1 - 1/(4 gaps^2) of the beam's deflection. Two sections in a gap stand
/// at s = 1/4 and 3/4; unless linked, the shear strain (1/2 - s) (theta_0 - theta_1) there makes bending
/// stiffer by 1 + 6 (h/t)^2/16.
inline double predicted_small_deflection(const Method& method, int frames) {
  const double gaps = frames - 1, ratio = 1 / (gaps * elastica_side);
  const double bending = (1 - 1 / (4 * gaps * gaps)) / 3, shear = elastica_side * elastica_side / 6;
  const bool locks = method.blend == Blend::linear && method.sections == 2;
  return (bending / (locks ? 1 + 6 * ratio * ratio / 16 : 1) + shear) / (1.0 / 3 + shear);
}

/// A row of frames along x, held at one end, whose other end is turned by half a turn, both ends staying
/// where they are: determinant of F on the axis in the middles of the gaps (Bosman 2015, Fig. 4.11; S3.5).
inline std::vector<double> torsion(int frames, int sections) {
  const Rod rod(straight(frames, 1), 0.1, {"linear", Blend::linear, sections});
  auto system = system_of(rod, elastic(rod, 1e4), {});
  State<double> q = system.rest_state();
  for (int step = 1; step <= 4; ++step) {
    const double half = std::numbers::pi / 8 * step;
    system.prescribed.set_frame(rod.tip(), Vec::Zero(), {std::sin(half), 0, 0, std::cos(half)});
    if (std::isnan(solve(system, q, rod.tip(), 1).angle)) return {};
  }
  // to look at only
  const FrameBody<2> axis{rod.nodes, softsim::PolylineShapes(rod.nodes.frames()),
                          softsim::sample_curve(rod.nodes.frames(), {{0, 0, 1}}, frames - 1).positions,
                          std::vector<double>(static_cast<std::size_t>(frames - 1), 1)};
  std::vector<double> J;
  for (std::size_t s = 0; s < axis.size(); ++s) {
    softsim::Local<double, 0, 2> u;
    for (std::size_t i = 0; i < 2; ++i) {
      const std::ptrdiff_t j = axis.blends()[s].frames[i];
      u.frames[i] = {q.translation(j), q.rotation(j) - softsim::Mat3<double>::Identity()};
    }
    J.push_back(softsim::determinant(softsim::FrameSample<2>::deformation_gradient(axis.data()[s], u)));
  }
  return J;
}

}  // namespace frame_rods
