// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT

// Bodies of frames after Bosman 2015, Sec. 4.3: a volume (Figs. 4.8 and 4.9), a surface (Fig. 4.10) and a
// line (Fig. 4.11), all by the same samples between frames. `frames --help` tells the options.

#include <cmath>
#include <cstdio>
#include <exception>
#include <functional>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "../picture.hpp"
#include "options.hpp"
#include "results.hpp"
#include "softsim/integrator/static_solver.hpp"
#include "softsim/kinematics/mesh_shapes.hpp"
#include "softsim/kinematics/polyline_shapes.hpp"
#include "softsim/kinematics/shepard.hpp"
#include "softsim/material/st_venant_kirchhoff.hpp"
#include "softsim/mesh/curve_samples.hpp"
#include "softsim/mesh/generators.hpp"
#include "softsim/mesh/samples.hpp"
#include "softsim/potential/dead_load.hpp"
#include "softsim/potential/frame_elastic.hpp"
#include "softsim/potential/frame_loads.hpp"
#include "softsim/potential/rotation_tie.hpp"
#include "softsim/solver/direct.hpp"
#include "softsim/solver/stationary.hpp"
#include "softsim/system/system.hpp"

namespace frames {

using softsim::GaussPoint;
using softsim::Samples;
using softsim::ShapeValues;
using softsim::Status;
using V = Vec3<double>;
using Law = softsim::StVenantKirchhoff;  // Green's strain and Hooke's law, as the thesis has them (Sec. 3.4)

/// A body with what holds and loads it.
template <int N, class System>
struct Scene {
  Summary summary;
  FrameNodes nodes;
  FrameBody<N> body;
  Law law;
  System system;
  std::function<void(System&, double)> set_load;  ///< to a part of it
  State<double> q = nodes.rest_state();
};

/// Puts the load on in steps, each a static equilibrium, and writes them; the summary tells how far it came.
template <int N, class System>
void solve(Scene<N, System>& scene, const std::string& folder, int steps) {
  using namespace softsim;
  Summary& s = scene.summary;
  s.frames = scene.nodes.frames().size();
  s.samples = scene.body.size();
  s.volume = scene.body.volume();
  s.load_steps = steps;
  FrameSeries series(folder, s.body);
  series.add(0, scene.nodes, scene.body, scene.law, scene.q);
  StaticSolver<System, Assembled, Ldlt, Stationary> solver({.tolerance = 1e-10});
  for (int k = 1; k <= steps && s.status == Status::converged; ++k) {
    const double part = static_cast<double>(k) / steps;
    scene.set_load(scene.system, part);
    State<double> trial = scene.q;
    const StepReport report = solver.solve(scene.system, trial);
    s.status = report.status;
    s.reason = report.reason;
    s.residual = report.residual;
    s.newton_iterations += report.newton_iterations;
    if (s.status != Status::converged) break;
    scene.q = trial;
    s.load_reached = part;
    series.add(part, scene.nodes, scene.body, scene.law, scene.q);
  }
  for (std::ptrdiff_t j = 0; j < scene.q.frames(); ++j)
    s.max_displacement = std::max(s.max_displacement, scene.q.translation(j).norm());
  s.least_j = least_volume_ratio(scene.body, scene.q);
  std::printf("%s: E = %s Pa, %zu frames, %zu samples; %s at %s of the load after %d Newton iterations\n",
              s.body.c_str(), to_text(s.young).c_str(), s.frames, s.samples,
              std::string(to_string(s.status)).c_str(), to_text(s.load_reached).c_str(), s.newton_iterations);
  std::printf("%s: largest displacement %.6g m, least J %.6g\n", s.body.c_str(), s.max_displacement,
              s.least_j);
}

/// A cantilever of sections of 3 x 3 frames, held at x = 0. A slice has 36 samples: 3 x 3 Gauss points over
/// the section of each of its four bricks, one in the middle along the beam. The shear that trilinear weights
/// blend into bending vanishes there, and there alone.
Summary beam(const Options& o, double young) {
  const V size(16, 1, 1);
  constexpr double mass = 1, poisson = 0.3;
  const softsim::MeshShapes shapes(
      softsim::box_hexahedra({o.frames - 1, 2, 2}, size, {0, -size[1] / 2, -size[2] / 2}));
  std::vector<ShapeValues> values;
  Samples samples;
  const std::vector<GaussPoint> rule = softsim::gauss_legendre(3);
  for (std::size_t e = 0; e < shapes.mesh().elements().size(); ++e)
    for (const GaussPoint& b : rule)
      for (const GaussPoint& a : rule) {
        values.push_back(shapes.at(e, {0, a.x, b.x}));
        V X = V::Zero();
        for (std::size_t i = 0; i < values.back().nodes.size(); ++i)
          X += values.back().values[i] * shapes.nodes()[static_cast<std::size_t>(values.back().nodes[i])];
        samples.positions.push_back(X);
        samples.volumes.push_back(shapes.mesh().volume(e) * a.weight * b.weight / 4);
      }
  const FrameNodes nodes(shapes.nodes());
  const FrameBody<8> body(nodes, values, samples.positions, samples.volumes);
  const Law law = Law::from_young_poisson(young, poisson);
  const double density = mass / size.prod();
  const auto weight = [body, density](double part) {
    return softsim::gravity(body, density, V(0, 0, -9.81 * part));
  };
  softsim::System system(nodes, softsim::elastic(body, law), weight(1),
                         softsim::rotation_tie(body, 1e-3 * young));
  for (std::size_t j = 0; j < nodes.frames().size(); ++j)
    if (nodes.frames()[j][0] == 0) system.prescribed.fix_frames({static_cast<std::int32_t>(j)});
  using System = decltype(system);
  Scene<8, System> scene{
      {.body = std::string("beam_") + softsim::to_text(young), .young = young, .poisson = poisson},
      nodes,
      body,
      law,
      system,
      [weight](System& s, double part) { std::get<1>(s.terms) = weight(part); }};
  solve(scene, o.out, 5);
  double deflection = 0;  // of the middle of the free end
  for (std::size_t j = 0; j < nodes.frames().size(); ++j)
    if ((nodes.frames()[j] - V(size[0], 0, 0)).norm() < 1e-9)
      deflection = 0 - scene.q.translation(static_cast<std::ptrdiff_t>(j))[2];
  std::printf("%s: the free end sinks by %.6g m\n", scene.summary.body.c_str(), deflection);
  scene.summary.own = {{"mass", mass}, {"tip_deflection", deflection}};
  return scene.summary;
}

/// A sheet of (4 k + 1) x (2 k + 1) frames, held at its short sides. Samples in its middle plane alone would
/// not see it bend: they are the two Gauss points through the thickness, whose second moment is t^3 / 12.
/// Each follows the nearest six frames; with four or eight some have two at the same distance to choose from,
/// which spoils the symmetry. Ten-node tetrahedra sink by 0.803 m, this sheet by 0.774 m; frames nearer to
/// each other do not do better (25 x 13: 0.856 m), as Shepard's functions reproduce nothing but constants.
Summary sheet(const Options& o) {
  const V size(4, 2, 0.1);
  constexpr double poisson = 0.3, force = 300;
  const double young = o.young > 0 ? o.young : 25e3;
  const int k = (o.frames - 1) / 4;
  const double gap = 1.0 / k;
  std::vector<V> positions;
  for (int j = 0; j <= 2 * k; ++j)
    for (int i = 0; i <= 4 * k; ++i) positions.push_back({i * gap, j * gap, 0});
  Samples samples;
  const int across = (16 * k + 2) / 3, along = 2 * across;  // squares, 8/3 a gap
  for (const GaussPoint& layer : softsim::gauss_legendre(2))
    for (int j = 0; j < across; ++j)
      for (int i = 0; i < along; ++i) {
        samples.positions.push_back(
            {(i + 0.5) / along * size[0], (j + 0.5) / across * size[1], layer.x * size[2] / 2});
        samples.volumes.push_back(size.prod() / along / across * layer.weight / 2);
      }
  const FrameNodes nodes(positions);
  const softsim::Shepard<> shapes(nodes.frames(), {.nearest = 6});
  const FrameBody<6> body(nodes, shapes, samples.positions, samples.volumes);
  const Law law = Law::from_young_poisson(young, poisson);

  std::vector<std::int32_t> held, loaded;
  for (std::size_t j = 0; j < positions.size(); ++j) {
    const V from_middle = positions[j] - V(size[0] / 2, size[1] / 2, 0);
    if (std::abs(from_middle[0]) > size[0] / 2 - 1e-9) held.push_back(static_cast<std::int32_t>(j));
    if (from_middle.cwiseAbs().maxCoeff() < 1.0 / 3 + 1e-9) loaded.push_back(static_cast<std::int32_t>(j));
  }
  const auto load = [loaded, count = positions.size()](double part) {
    softsim::DeadLoad<double> forces(0, count);
    for (const std::int32_t j : loaded)
      forces.add_to_frame(j, V(0, 0, -force * part / static_cast<double>(loaded.size())));
    return forces;
  };
  softsim::System system(nodes, softsim::elastic(body, law), load(1));
  system.prescribed.fix_frames(held);
  using System = decltype(system);
  Scene<6, System> scene{{.body = "sheet", .young = young, .poisson = poisson},
                         nodes,
                         body,
                         law,
                         system,
                         [load](System& s, double part) { std::get<1>(s.terms) = load(part); }};
  solve(scene, o.out, 10);
  scene.summary.own = {{"thickness", size[2]},
                       {"force", force},
                       {"held_frames", static_cast<double>(held.size())},
                       {"loaded_frames", static_cast<double>(loaded.size())}};
  return scene.summary;
}

/// Samples of a line of n frames, 5 n, such that all gaps are alike. The segment that a frame carries has
/// three stations along the line, by Gauss's rule: a sample at the frame, and two points of the four-point
/// rule of the disc on either side, at one side those along y, at the other those along z; the segment of an
/// end frame is half as long, and has all four at its one side. Each gap thus sees the section's second
/// moments of area: with 4/9 of the volume on the line itself the others stand farther out than that rule's.
Samples line_samples(int n, double gap, double radius) {
  const double area = std::numbers::pi * radius * radius;
  const softsim::Section ring = softsim::disc(radius * std::sqrt(9.0 / 5), 4);
  const std::vector<GaussPoint> rule = softsim::gauss_legendre(3);
  Samples samples;
  const auto add = [&](double x, const softsim::SectionPoint& point, double share) {
    samples.positions.push_back({x, point.y, point.z});
    samples.volumes.push_back(share * area * gap);
  };
  for (int i = 0; i < n; ++i) {
    const bool end = i == 0 || i == n - 1;
    const double x = i * gap, offset = rule[2].x * gap / 2, share = rule[2].weight / 2;
    add(x, {0, 0, 0}, rule[1].weight / (end ? 4 : 2));
    for (std::size_t k = 0; k < ring.size(); ++k)
      if (end)
        add(i == 0 ? x + offset : x - offset, ring[k], share / 4);
      else
        add(k % 2 == 0 ? x + offset : x - offset, ring[k], share / 2);
  }
  return samples;
}

/// Angle in degrees by which frame j is turned around the line.
double twist(const State<double>& q, std::ptrdiff_t j) {
  return softsim::quaternion_logarithm<double>(q.quaternion(j))[0] * 180 / std::numbers::pi;
}

/// A line of frames, held at one end and turned by half a turn at the other. Between two frames that are
/// turned against each other by theta the section shrinks by cos(theta/2): like the paper of a sweet. The
/// weights are linear along the line; Shepard's, which the thesis takes, twist in the middles of the gaps
/// only.
Summary line(const Options& o) {
  constexpr double gap = 1, radius = 0.2, poisson = 0, turn = std::numbers::pi;
  const double young = o.young > 0 ? o.young : 10e3;
  std::vector<V> positions;
  for (int i = 0; i < o.frames; ++i) positions.push_back({i * gap, 0, 0});
  const FrameNodes nodes(positions);
  const softsim::PolylineShapes shapes(nodes.frames());
  const Samples samples = line_samples(o.frames, gap, radius);
  const FrameBody<2> body(nodes, shapes, samples.positions, samples.volumes);
  const Law law = Law::from_young_poisson(young, poisson);
  softsim::System system(nodes, softsim::elastic(body, law));
  system.prescribed.fix_frames({0});
  using System = decltype(system);
  Scene<2, System> scene{{.body = "line", .young = young, .poisson = poisson},
                         nodes,
                         body,
                         law,
                         system,
                         [last = o.frames - 1](System& s, double part) {
                           s.prescribed.set_frame(last, V::Zero(),
                                                  softsim::quaternion_exponential(V(part * turn, 0, 0)));
                         }};
  solve(scene, o.out, 10);

  std::vector<V> middles;
  for (int i = 0; i + 1 < o.frames; ++i) middles.push_back({(i + 0.5) * gap, 0, 0});
  const FrameBody<2> probes(nodes, shapes, middles, std::vector<double>(middles.size(), 1));
  double least = 1e300, largest = -1e300, difference = 0;
  std::printf("gap   twist (degrees)   J in its middle   cos^2(twist/2)\n");
  for (std::size_t i = 0; i < middles.size(); ++i) {
    const auto j = static_cast<std::ptrdiff_t>(i);
    const double angle = twist(scene.q, j + 1) - twist(scene.q, j);
    const double J = softsim::determinant(deformation_gradient(probes, scene.q, i));
    const double limit = std::pow(std::cos(angle * std::numbers::pi / 360), 2);
    std::printf("%3zu   %15.9f   %15.9f   %14.9f\n", i + 1, angle, J, limit);
    least = std::min(least, angle);
    largest = std::max(largest, angle);
    difference = std::max(difference, std::abs(J - limit));
  }
  std::printf(
      "Between frames turned against each other by theta the section shrinks by cos(theta/2), so that J =\n"
      "cos^2(theta/2): at 180 degrees a gap would be twisted shut like a candy wrapper. More frames help.\n");
  softsim::Vector<double> force = softsim::Vector<double>::Zero(system.size());
  scene.system.add_gradient(scene.q, force);  // what holds the ends
  const double torque = scene.q.in_space(force, o.frames - 1)[0];
  const double of_rod = young / (2 * (1 + poisson)) * std::numbers::pi * std::pow(radius, 4) / 2 * turn *
                        scene.summary.load_reached / (gap * (o.frames - 1));
  std::printf("line: a torque of %.6g N m holds the end, by the theory of rods %.6g\n", torque, of_rod);
  scene.summary.own = {{"turn", turn * scene.summary.load_reached * 180 / std::numbers::pi},
                       {"radius", radius},
                       {"torque", torque},
                       {"torque_of_rod", of_rod},
                       {"least_twist_per_gap", least},
                       {"largest_twist_per_gap", largest},
                       {"largest_J_less_cos2", difference}};
  return scene.summary;
}

/// Draws DIR/EXAMPLE.png by the script beside this program's source.
void draw_picture(const Options& o, const std::vector<Summary>& bodies) {
  const std::string python = picture::drawing_python();
  if (python.empty()) {
    std::fprintf(stderr, "frames: no picture, no Python with numpy and matplotlib was found\n");
    return;
  }
  std::vector<std::string> command{python, FRAMES_PLOT_SCRIPT, o.example, o.out};
  for (const Summary& s : bodies) command.push_back(s.body);
  if (picture::runs(command))
    std::printf("picture: %s/%s.png\n", o.out.c_str(), o.example.c_str());
  else
    std::fprintf(stderr, "frames: the picture could not be drawn\n");
}

int main(const std::vector<std::string>& words) {
  try {
    const Options o = parse(words);
    if (o.show_help) {
      std::fputs(help, stdout);
      return 0;
    }
    prepare_folder(o.out, o.example);
    std::vector<Summary> bodies;
    const auto done = [&](const Summary& s) {
      write_summary(o.out, s);
      bodies.push_back(s);
      return s.status == Status::converged;
    };
    bool good = true;
    if (o.example == "beam")
      for (const double young : o.young > 0 ? std::vector{o.young} : std::vector{3e3, 9e3, 18e3})
        good = good && done(beam(o, young));
    else
      good = done(o.example == "sheet" ? sheet(o) : line(o));
    std::printf("results: %s\n", o.out.c_str());
    std::fflush(stdout);
    if (o.picture) draw_picture(o, bodies);
    if (good) return 0;
    const Summary& failed = bodies.back();
    std::fprintf(stderr, "frames: %s: %s after %s of the load: %s\n", failed.body.c_str(),
                 std::string(to_string(failed.status)).c_str(), softsim::to_text(failed.load_reached).c_str(),
                 failed.reason.c_str());
    return 1;
  } catch (const std::invalid_argument& error) {
    std::fprintf(stderr, "frames: %s\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "frames: %s\n", error.what());
    return 1;
  }
}

}  // namespace frames

int main(int argc, char** argv) { return frames::main({argv + 1, argv + argc}); }
