// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include "softsim/integrator/implicit.hpp"
#include "softsim/kinematics/frame_body.hpp"
#include "softsim/kinematics/mesh_shapes.hpp"
#include "softsim/kinematics/shepard.hpp"
#include "softsim/material/st_venant_kirchhoff.hpp"
#include "softsim/mesh/generators.hpp"
#include "softsim/mesh/mesh_samples.hpp"
#include "softsim/mesh/ordering.hpp"
#include "softsim/potential/frame_elastic.hpp"
#include "softsim/potential/frame_loads.hpp"
#include "softsim/potential/rotation_tie.hpp"
#include "softsim/solver/direct.hpp"
#include "softsim/system/system.hpp"
#include "study.hpp"

// The tables of times of Bosman 2015, Sec. 4.4, with the same counts on one core, beside the thesis's own
// figures (its processors are of 2010); and how the cost of a step grows with samples and neighbours. --long
// for the rows that take seconds each.

namespace {

using namespace softsim;
using V = Vec3<double>;
using Law = StVenantKirchhoff;
constexpr double young = 1e4, density = 1000, dt = 0.01;

// Frames on a grid, samples spread evenly over its box by the golden ratio of three dimensions (Roberts
// 2018).
std::vector<V> grid(const std::array<int, 3>& n, const V& size) {
  std::vector<V> X;
  for (int k = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j)
      for (int i = 0; i < n[0]; ++i)
        X.push_back(size.cwiseProduct(
            V(i / std::max(1.0, n[0] - 1.0), j / std::max(1.0, n[1] - 1.0), k / std::max(1.0, n[2] - 1.0))));
  return X;
}
std::vector<V> spread(int count, const V& size) {
  constexpr double g = 1.22074408460575947536;
  std::vector<V> X;
  for (int s = 1; s <= count; ++s) {
    V x;
    for (int a = 0; a < 3; ++a) {
      const double r = 0.5 + s / std::pow(g, a + 1);
      x[a] = size[a] * (r - std::floor(r));
    }
    X.push_back(x);
  }
  std::vector<V> sorted;
  for (const std::int32_t i : morton_order(X)) sorted.push_back(X[static_cast<std::size_t>(i)]);
  return sorted;
}

template <int N>
struct Scene {
  FrameNodes nodes;
  FrameBody<N> body;
  System<ElasticFrames<N, Law>, Elements<FrameDeadForces>> system;

  // The mass is summed over more samples than the energy: with one or two a frame has no inertia about some
  // axis.
  Scene(FrameNodes nodes_, FrameBody<N> body_, const FrameBody<N>& of_mass)
      : nodes(std::move(nodes_)),
        body(std::move(body_)),
        system(nodes, elastic(body, Law::from_young_poisson(young, 0.3)),
               gravity(body, density, {0, 0, -9.81})) {
    system.mass = Mass<double>::lumped(of_mass, density);
    std::vector<std::int32_t> fixed;
    for (std::size_t j = 0; j < nodes.frames().size(); ++j)
      if (nodes.frames()[j][0] == 0) fixed.push_back(static_cast<std::int32_t>(j));
    system.prescribed.fix_frames(fixed);
  }
};

// Frames that no sample follows are no unknowns: with a thousand samples most of many frames are.
template <int N>
Scene<N> shepard_scene(const std::array<int, 3>& frames, int samples, const V& size) {
  const Shepard<> all(grid(frames, size), {.nearest = N});
  const std::vector<V> X = spread(samples, size);
  std::vector<ShapeValues> shapes;
  std::vector<std::int32_t> number(all.nodes().size(), -1);
  for (const V& x : X) {
    shapes.push_back(all.at(x));
    for (const std::int32_t j : shapes.back().nodes) number[static_cast<std::size_t>(j)] = 0;
  }
  std::vector<V> seen;
  for (std::size_t j = 0; j < number.size(); ++j)
    if (number[j] == 0) {
      number[j] = static_cast<std::int32_t>(seen.size());
      seen.push_back(all.nodes()[j]);
    }
  for (ShapeValues& at : shapes)
    for (std::int32_t& j : at.nodes) j = number[static_cast<std::size_t>(j)];
  FrameNodes nodes(seen);
  const auto body_of = [&](const auto& with, const std::vector<V>& at) {
    return FrameBody<N>(nodes, with, at,
                        std::vector<double>(at.size(), size.prod() / static_cast<double>(at.size())));
  };
  const int fine = std::max(samples, 40 * static_cast<int>(seen.size()));
  return {nodes, body_of(shapes, X), body_of(Shepard<>(seen, {.nearest = N}), spread(fine, size))};
}

// Median of the times of f(), ms; as often as fits into a third of a second.
double median_ms(const std::function<void()>& f) {
  using Clock = std::chrono::steady_clock;
  f();
  std::vector<double> times;
  double total = 0;
  while (times.size() < 3 || (total < 300 && times.size() < 101)) {
    const auto start = Clock::now();
    f();
    times.push_back(std::chrono::duration<double, std::milli>(Clock::now() - start).count());
    total += times.back();
  }
  std::nth_element(times.begin(), times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2), times.end());
  return times[times.size() / 2];
}

struct Table {
  std::ostream& csv;
  bool finite = true;

  /// @param followed frames that a sample follows: those that are unknowns
  void line(const std::string& table, std::size_t frames, std::size_t followed, std::size_t samples,
            int neighbours, int iterations, const std::string& what, double ms, double thesis) {
    csv << table << ',' << frames << ',' << followed << ',' << samples << ',' << neighbours << ','
        << iterations << ',' << what << ',' << ms << ',' << thesis << std::endl;
    std::printf("%-8s %6zu frames", table.c_str(), frames);
    if (followed < frames) std::printf(" (%zu followed)", followed);
    std::printf(" %8zu samples %3d neighbours %4d iterations  %-22s %10.3f ms", samples, neighbours,
                iterations, what.c_str(), ms);
    if (thesis > 0)
      std::printf("  thesis %10.2f ms, %.3g times as long\n", thesis, thesis / ms);
    else
      std::printf("\n");
  }

  // One implicit step with so many iterations of conjugate gradients.
  template <class Operator, int N>
  void step(const std::string& table, const std::string& route, Scene<N>& scene, std::size_t frames,
            int iterations, double thesis) {
    using S = decltype(scene.system);
    BackwardEuler<S, Operator, BlockJacobi> integrator(
        {.dt = dt, .linear = {.max_iterations = iterations, .fixed = true}});
    Motion<double> motion = scene.system.rest_motion();
    const double ms = median_ms([&] {
      if (integrator.step(scene.system, motion).status == Status::not_finite) finite = false;
    });
    line(table, frames, scene.nodes.frames().size(), scene.body.size(), N, iterations, route, ms, thesis);
  }
};

template <int N>
void table_4_3(Table& table, const std::array<int, 3>& frames, int samples, double thesis) {
  Scene<N> scene = shepard_scene<N>(frames, samples, V(frames[0] - 1, frames[1] - 1, frames[2] - 1));
  const auto count = static_cast<std::size_t>(frames[0] * frames[1] * frames[2]);
  table.step<Assembled>("4.3", "assembled", scene, count, 50, thesis);
  if constexpr (N == 4) table.step<MatrixFree>("4.3", "matrix_free", scene, count, 50, thesis);
}

// Tetrahedral interpolation, four samples a tetrahedron, a sparse LDLT.
void table_4_4(Table& table, const std::array<int, 3>& frames, const std::array<double, 3>& thesis) {
  const TetrahedralMesh mesh =
      box_mesh({frames[0] - 1, frames[1] - 1, frames[2] - 1}, V(frames[0] - 1, frames[1] - 1, frames[2] - 1));
  const ElementSamples samples = equal_samples(mesh, 4);
  const FrameNodes nodes(mesh.points());
  const FrameBody<4> body(nodes, MeshShapes(mesh), samples.positions, samples.volumes);
  Scene<4> scene(nodes, body, body);
  auto& system = scene.system;
  using S = std::decay_t<decltype(system)>;
  State<double> q = system.rest_state();
  Vector<double> g(system.size()), d = Vector<double>::Zero(system.size()), x(system.size());
  AssembledTangent<S> tangent;
  Ldlt<double> direct;
  const auto count = nodes.frames().size();
  const double forces = median_ms([&] {
    g.setZero();
    system.add_gradient(q, g);
    system.prescribed.mask(g);
    retract(q, d);
  });
  const double build = median_ms([&] { tangent.set(system, q, {.mass = 1 / (dt * dt)}); });
  const double solve = median_ms([&] {
    direct.compute(tangent, system.prescribed.free());
    direct.apply(g, x);
  });
  if (!x.allFinite()) table.finite = false;
  table.line("4.4", count, count, body.size(), 4, 0, "newton_iteration", forces, thesis[0]);
  table.line("4.4", count, count, body.size(), 4, 0, "system_build", build, thesis[1]);
  table.line("4.4", count, count, body.size(), 4, 0, "system_solving", solve, thesis[2]);
}

void steps_of_1000_frames(Table& table, const std::string& name, int samples, double thesis) {
  Scene<4> scene = shepard_scene<4>({10, 10, 10}, samples, {1, 1, 1});
  table.step<Assembled>(name, "assembled", scene, 1000, 60, thesis);
  table.step<MatrixFree>(name, "matrix_free", scene, 1000, 60, thesis);
}

template <int N>
void neighbours(Table& table, int samples) {
  Scene<N> scene = shepard_scene<N>({10, 10, 10}, samples, {1, 1, 1});
  table.step<Assembled>("neighbours", "assembled", scene, 1000, 60, 0);
  using S = decltype(scene.system);
  Vector<double> y(scene.system.size());
  State<double> q = scene.system.rest_state();
  MatrixFreeTangent<S> tangent;
  tangent.set(scene.system, q, {});
  const Vector<double> d = Vector<double>::Constant(y.size(), 1e-3);
  table.line("neighbours", 1000, scene.nodes.frames().size(), scene.body.size(), N, 1, "product",
             median_ms([&] { tangent.apply(d, y); }), 0);
  table.line("neighbours", 1000, scene.nodes.frames().size(), scene.body.size(), N, 1, "force",
             median_ms([&] {
               y.setZero();
               scene.system.add_gradient(q, y);
             }),
             0);
}

}  // namespace

int main(int argc, char** argv) {
  const std::string header = "table,frames,frames_followed,samples,neighbours,iterations,what,ms,thesis_ms";
  return study::run(argc, argv, "frame_tables", header, true, [](std::ostream& csv, bool long_form) {
    csv.precision(6);
    Table table{csv};
    // Table 4.3 as we read its columns: neighbours vary at 400 samples and 72 frames, then samples, then
    // frames.
    table_4_3<4>(table, {8, 3, 3}, 400, 32.65);
    table_4_3<8>(table, {8, 3, 3}, 400, 45.42);
    table_4_3<4>(table, {8, 3, 3}, 2340, 160.53);
    table_4_4(table, {4, 4, 3}, {3.53, 22.41, 1.42});
    table_4_4(table, {6, 6, 6}, {16.49, 143.24, 17.77});
    steps_of_1000_frames(table, "4.5", 800, 78.42);
    if (!long_form) return table.finite;
    table_4_3<6>(table, {8, 3, 3}, 400, 55.15);
    table_4_3<10>(table, {8, 3, 3}, 400, 69.56);
    table_4_3<4>(table, {8, 3, 3}, 500, 39.18);
    table_4_3<4>(table, {8, 3, 3}, 864, 43.42);
    table_4_3<4>(table, {8, 3, 3}, 1470, 114.3);
    table_4_3<4>(table, {16, 3, 3}, 400, 54.49);
    table_4_3<4>(table, {8, 6, 6}, 400, 56.64);
    table_4_3<4>(table, {20, 5, 5}, 400, 58.5);
    table_4_3<4>(table, {22, 6, 6}, 400, 69.12);
    table_4_4(table, {8, 8, 8}, {46.24, 600.91, 105.99});
    table_4_4(table, {12, 12, 12}, {183.64, 5654.16, 1572.54});
    table_4_4(table, {14, 14, 14}, {1036.46, 99723.8, 4926.15});
    for (const auto& [samples, thesis] : std::vector<std::pair<int, double>>{{2600, 251.77},
                                                                             {6070, 595.77},
                                                                             {12700, 1228.8},
                                                                             {16210, 1561.8},
                                                                             {19990, 1990.06},
                                                                             {26750, 2675.47},
                                                                             {34610, 3468.54}})
      steps_of_1000_frames(table, "4.5", samples, thesis);
    for (const auto& [n, thesis] : std::vector<std::pair<int, double>>{
             {3, 8.11}, {6, 8.25}, {10, 8.32}, {12, 8.81}, {15, 8.89}, {19, 9.44}, {22, 10.3}, {24, 10.7}}) {
      Scene<4> scene = shepard_scene<4>({n, n, n}, 1000, {1, 1, 1});
      const auto frames = static_cast<std::size_t>(n * n * n);
      table.step<Assembled>("4.6", "assembled", scene, frames, 100, thesis);
      table.step<MatrixFree>("4.6", "matrix_free", scene, frames, 100, thesis);
    }
    for (const int samples : {1000, 3000, 10000, 30000, 100000, 300000, 1000000})
      steps_of_1000_frames(table, "samples", samples, 0);
    neighbours<2>(table, 30000);
    neighbours<4>(table, 30000);
    neighbours<6>(table, 30000);
    neighbours<8>(table, 30000);
    neighbours<10>(table, 30000);
    return table.finite;
  });
}
