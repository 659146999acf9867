// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT

#include <cmath>
#include <map>
#include <memory>
#include <vector>

#include "common.hpp"
#include "softsim/integrator/implicit.hpp"
#include "softsim/kinematics/frame_body.hpp"
#include "softsim/kinematics/shepard.hpp"
#include "softsim/potential/frame_elastic.hpp"
#include "softsim/potential/frame_loads.hpp"

// Frames with the counts of Bosman 2015, Tables 4.3 to 4.6: forces, tangents and steps.

namespace bench {
namespace {

// Positions in the middles of the cells of a grid, or at its nodes.
std::vector<Vec3<double>> grid(const std::array<int, 3>& n, const Vec3<double>& size, bool nodes) {
  std::vector<Vec3<double>> X;
  for (int k = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j)
      for (int i = 0; i < n[0]; ++i) {
        const std::array<int, 3> at{i, j, k};
        Vec3<double> x;
        for (int a = 0; a < 3; ++a) {
          const auto c = static_cast<std::size_t>(a);
          x[a] = size[a] * (nodes ? at[c] / std::max(1.0, n[c] - 1.0) : (at[c] + 0.5) / n[c]);
        }
        X.push_back(x);
      }
  return X;
}

template <int N>
struct Body {
  FrameNodes nodes;
  FrameBody<N> body;
  int samples;

  // Frames on the nodes of a grid, the first so many samples of a finer one, Shepard's functions.
  Body(const std::array<int, 3>& frames, const std::array<int, 3>& finer, const Vec3<double>& size)
      : nodes(grid(frames, size, true)),
        body(make(nodes, finer, size)),
        samples(static_cast<int>(body.size())) {}
  static FrameBody<N> make(const FrameNodes& nodes, const std::array<int, 3>& finer,
                           const Vec3<double>& size) {
    const std::vector<Vec3<double>> X = grid(finer, size, false);
    const double volume = size.prod() / static_cast<double>(X.size());
    return {nodes, Shepard<>(nodes.frames(), {.nearest = N}), X, std::vector<double>(X.size(), volume)};
  }
};

template <int N, class Law>
struct Scene {
  Body<N> frames;
  System<ElasticFrames<N, Law>, Elements<FrameDeadForces>> system;
  Motion<double> motion;
  Vector<double> d, y;

  Scene(const std::array<int, 3>& grid_of_frames, const std::array<int, 3>& finer, const Vec3<double>& size)
      : frames(grid_of_frames, finer, size),
        system(frames.nodes, elastic(frames.body, Law::from_young_poisson(young, 0.3)),
               gravity(frames.body, 1000, {0, 0, -9.81})),
        motion(system.rest_motion()) {
    system.mass = Mass<double>::lumped(frames.body, 1000);
    std::vector<std::int32_t> fixed;
    for (std::size_t j = 0; j < frames.nodes.frames().size(); ++j)
      if (frames.nodes.frames()[j][0] == 0) fixed.push_back(static_cast<std::int32_t>(j));
    system.prescribed.fix_frames(fixed);
    d.setZero(system.size());
    for (std::ptrdiff_t k = 0; k < d.size(); ++k)
      if (k % block_stride != 3) d[k] = 0.02 * std::sin(0.7 * static_cast<double>(k));
    retract(motion.q, d);
    y.setZero(system.size());
  }
};

template <class Function>
void time(benchmark::State& state, double items, Function f) {
  f();
  const double start = seconds();
  for (auto _ : state) {
    f();
    benchmark::ClobberMemory();
  }
  const double spent = (seconds() - start) / static_cast<double>(state.iterations());
  state.counters["ns_per_sample"] = 1e9 * spent / items;
  state.counters["ms"] = 1e3 * spent;
}

template <int N, class Law>
void add_kernels(const std::string& law, const std::array<int, 3>& frames, const std::array<int, 3>& finer) {
  const int count = finer[0] * finer[1] * finer[2], nodes = frames[0] * frames[1] * frames[2];
  const std::string tail =
      "/" + law + "/" + std::to_string(N) + "/" + std::to_string(nodes) + "/" + std::to_string(count);
  const auto scene = [=]() -> Scene<N, Law>& {
    static std::map<int, std::unique_ptr<Scene<N, Law>>> scenes;
    auto& s = scenes[count];
    if (s == nullptr) s = std::make_unique<Scene<N, Law>>(frames, finer, Vec3<double>(1, 1, 1));
    return *s;
  };
  const auto add_one = [&](const std::string& what, auto f) {
    benchmark::RegisterBenchmark(("frames/" + what + tail).c_str(), [=](benchmark::State& state) {
      Scene<N, Law>& s = scene();
      time(state, count, f(s));
    })->Unit(benchmark::kMillisecond);
  };
  add_one("force", [](auto& s) {
    return [&s] {
      s.y.setZero();
      std::get<0>(s.system.terms).add_gradient(s.motion.q, s.y);
    };
  });
  add_one("hessian_product", [](auto& s) {
    return [&s] {
      s.y.setZero();
      std::get<0>(s.system.terms).add_hessian_product(s.motion.q, s.d, s.y);
    };
  });
  using S = decltype(Scene<N, Law>::system);
  add_one("assemble", [](auto& s) {
    auto tangent = std::make_shared<AssembledTangent<S>>();
    return [&s, tangent] { tangent->set(s.system, s.motion.q, TangentWeights{.mass = 1e4}); };
  });
  add_one("newton_iteration_without_solve", [](auto& s) {
    auto tangent = std::make_shared<AssembledTangent<S>>();
    return [&s, tangent] {
      s.y.setZero();
      s.system.add_gradient(s.motion.q, s.y);
      tangent->set(s.system, s.motion.q, TangentWeights{.mass = 1e4});
    };
  });
  add_one("first_assembly", [](auto& s) {
    return [&s] {
      AssembledTangent<S> tangent;
      tangent.set(s.system, s.motion.q, TangentWeights{.mass = 1e4});
    };
  });
  add_one("apply", [](auto& s) {
    auto tangent = std::make_shared<AssembledTangent<S>>();
    tangent->set(s.system, s.motion.q, TangentWeights{.mass = 1e4});
    return [&s, tangent] { tangent->apply(s.d, s.y); };
  });
}

template <int N, class Operator>
void add_step(const std::string& route, const std::array<int, 3>& frames, const std::array<int, 3>& finer,
              const Vec3<double>& size, int iterations) {
  using Law = StVenantKirchhoff;
  const int count = finer[0] * finer[1] * finer[2], nodes = frames[0] * frames[1] * frames[2];
  const std::string name = "frames/step/" + route + "/" + std::to_string(N) + "/" + std::to_string(nodes) +
                           "/" + std::to_string(count) + "/cg_" + std::to_string(iterations);
  benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) {
    Scene<N, Law> s(frames, finer, size);
    using S = decltype(Scene<N, Law>::system);
    BackwardEuler<S, Operator, BlockJacobi> integrator(
        {.dt = 0.01, .linear = {.max_iterations = iterations, .fixed = true}});
    s.motion = s.system.rest_motion();
    time(state, count, [&] {
      if (integrator.step(s.system, s.motion).status == Status::not_finite) state.SkipWithError("not finite");
    });
  })->Unit(benchmark::kMillisecond);
}

[[maybe_unused]] const bool registered = [] {
  add_kernels<4, StVenantKirchhoff>("svk", {8, 3, 3}, {16, 5, 5});
  add_kernels<8, StVenantKirchhoff>("svk", {8, 3, 3}, {16, 5, 5});
  add_kernels<4, StVenantKirchhoff>("svk", {12, 12, 12}, {33, 22, 44});
  add_kernels<8, StVenantKirchhoff>("svk", {12, 12, 12}, {33, 22, 44});
  add_kernels<4, NeoHookean>("neo_hookean", {12, 12, 12}, {33, 22, 44});
  add_kernels<4, LinearElastic>("linear", {12, 12, 12}, {33, 22, 44});
  add_step<4, Assembled>("assembled", {8, 3, 3}, {16, 5, 5}, {8, 2, 2}, 50);
  add_step<8, Assembled>("assembled", {8, 3, 3}, {16, 5, 5}, {8, 2, 2}, 50);
  add_step<4, MatrixFree>("matrix_free", {8, 3, 3}, {16, 5, 5}, {8, 2, 2}, 50);
  add_step<8, MatrixFree>("matrix_free", {8, 3, 3}, {16, 5, 5}, {8, 2, 2}, 50);
  add_step<4, Assembled>("assembled", {10, 10, 10}, {30, 34, 34}, {1, 1, 1}, 60);
  add_step<4, MatrixFree>("matrix_free", {10, 10, 10}, {30, 34, 34}, {1, 1, 1}, 60);
  return true;
}();

}  // namespace
}  // namespace bench
