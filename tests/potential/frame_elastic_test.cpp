// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/potential/frame_elastic.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

#include "potential/frame_bodies.hpp"
#include "softsim/integrator/static_solver.hpp"
#include "softsim/material/neo_hookean.hpp"
#include "softsim/material/st_venant_kirchhoff.hpp"
#include "softsim/potential/frame_loads.hpp"
#include "softsim/potential/rotation_tie.hpp"
#include "softsim/potential/spring.hpp"
#include "softsim/solver/direct.hpp"
#include "softsim/solver/stationary.hpp"
#include "softsim/system/system.hpp"

namespace frame_elastic_test {

using namespace softsim;
using frame_bodies::increment;
using frame_bodies::on_mesh;
using Vec = Vector<double>;
using V = Vec3<double>;
using M = Mat3<double>;

auto cube(const std::array<int, 3>& cells = {2, 2, 2}) { return on_mesh(box_hexahedra(cells, {1, 1, 1})); }
const auto law = StVenantKirchhoff::from_young_poisson(10, 0.3);

// A term against differences of its energy, at a state with large rotations.
template <class S>
void derives(const S& system) {
  State<double> q = system.rest_state();
  Vec d = increment(q, 0.9, 1);
  for (std::ptrdiff_t j = 0; j < q.frames(); ++j) block(d, q.frame_block(j)) *= 0.2;
  retract(q, d);
  frame_bodies::expect_derivatives(system, q, increment(q, 1, 2));
}

// A law whose stiffness is a sample's own.
struct StiffnessField {
  template <class T>
  struct Data {
    T factor;
  };
  template <class T>
  struct Scaled {
    StVenantKirchhoff law;
    T factor;
    [[nodiscard]] T energy_density(const Mat3<T>& F) const { return factor * law.energy_density(F); }
    [[nodiscard]] Mat3<T> first_piola(const Mat3<T>& F) const {
      Mat3<T> P = law.first_piola(F);
      P *= factor;
      return P;
    }
    [[nodiscard]] Mat3<T> first_piola_differential(const Mat3<T>& F, const Mat3<T>& dF) const {
      Mat3<T> dP = law.first_piola_differential(F, dF);
      dP *= factor;
      return dP;
    }
  };
  StVenantKirchhoff law;
  template <class T>
  [[nodiscard]] Scaled<T> at(const Data<T>& data) const {
    return {law, data.factor};
  }
};

TEST(FrameElastic, DerivesFromItsEnergyAtLargeRotations) {
  const auto frames = cube();
  derives(System(frames.nodes, elastic(frames.body, law)));
  derives(System(frames.nodes, elastic<double, 1>(frames.body, law)));
  derives(System(frames.nodes, gravity(frames.body, 3, {1, -2, 3})));
  derives(System(frames.nodes, rotation_tie(frames.body, 2)));
}

// Every sample may have parameters, a law's data, and a scalar of its own.
TEST(FrameElastic, LawsDifferFromSampleToSample) {
  const auto frames = cube();
  State<double> q = frames.nodes.rest_state();
  retract(q, increment(q, 0.3, 1));
  std::vector<std::int32_t> index;
  for (std::size_t s = 0; s < frames.body.size(); ++s) index.push_back(s % 3 == 0 ? 1 : 0);
  const auto soft = StVenantKirchhoff::from_young_poisson(10, 0.3),
             hard = StVenantKirchhoff::from_young_poisson(30, 0.1);
  double expected = 0;
  for (std::size_t s = 0; s < frames.body.size(); ++s) {
    Local<double, 0, 8> u;
    for (std::size_t i = 0; i < 8; ++i) {
      const std::ptrdiff_t j = frames.body.blends()[s].frames[i];
      u.frames[i] = {q.translation(j), q.rotation(j) - M::Identity()};
    }
    const M F = FrameSample<8>::deformation_gradient(frames.body.data()[s], u);
    expected += frames.body.volumes()[s] * (index[s] == 1 ? hard : soft).energy_density(F);
  }
  EXPECT_NEAR(elastic(frames.body, std::vector{soft, hard}, index).energy(q), expected, 1e-12 * expected);
  EXPECT_THROW((void)elastic(frames.body, std::vector{soft, hard}), std::invalid_argument);
  EXPECT_THROW((void)elastic(frames.body, std::vector<StVenantKirchhoff>{}), std::invalid_argument);
  index.pop_back();
  EXPECT_THROW((void)elastic(frames.body, std::vector{soft, hard}, index), std::invalid_argument);

  // a law with data of its own: Young's modulus
  std::vector<StiffnessField::Data<double>> stiffness;
  for (std::size_t s = 0; s < frames.body.size(); ++s) stiffness.push_back({s % 2 == 0 ? 1.0 : 3.0});
  const auto field = elastic(frames.body, StiffnessField{soft}, stiffness);
  const double one = elastic(frames.body, soft).energy(q), mixed = field.energy(q);
  EXPECT_GT(mixed, one);
  EXPECT_LT(mixed, 3 * one);
  derives(System(frames.nodes, field));
  stiffness.pop_back();
  EXPECT_THROW((void)elastic(frames.body, StiffnessField{soft}, stiffness), std::invalid_argument);

  // single precision
  State<float> p = frames.nodes.rest_state<float>();
  p.displacement = q.displacement.cast<float>();
  const double single = elastic<float>(frames.body, soft).energy(p);
  EXPECT_NEAR(single, one, 1e-5 * one);
}

// Both tangents, matrix-free and assembled, are the same product; block diagonals included.
TEST(FrameElastic, AssembledAndMatrixFreeTangentsAgree) {
  const auto frames = cube({3, 2, 2});
  System system(frames.nodes, elastic(frames.body, law), gravity(frames.body, 3, {1, -2, 3}));
  State<double> q = system.rest_state();
  retract(q, increment(q, 0.3, 1));
  AssembledTangent<decltype(system)> assembled;
  MatrixFreeTangent<decltype(system)> matrix_free;
  assembled.set(system, q, {.stiffness = 2});
  matrix_free.set(system, q, {.stiffness = 2});
  const Vec d = increment(q, 1, 2);
  Vec a = Vec::Zero(q.size()), b = a;
  assembled.apply(d, a);
  matrix_free.apply(d, b);
  EXPECT_LT((a - b).norm(), 1e-13 * a.norm());
  std::vector<M> from_matrix, from_blocks;
  assembled.diagonal_blocks(from_matrix);
  matrix_free.diagonal_blocks(from_blocks);
  ASSERT_EQ(from_matrix.size(), from_blocks.size());
  for (std::size_t i = 0; i < from_matrix.size(); ++i)
    EXPECT_LT((from_matrix[i] - from_blocks[i]).norm(), 1e-12 * from_matrix[i].norm()) << i;
  assembled.frame_blocks(from_matrix);
  matrix_free.frame_blocks(from_blocks);
  ASSERT_EQ(from_matrix.size(), from_blocks.size());
  for (std::size_t i = 0; i < from_matrix.size(); ++i)
    EXPECT_LT((from_matrix[i] - from_blocks[i]).norm(), 1e-12 * from_matrix[i].norm()) << i;
}

// 1,000 rigid motions of a deformed body.
TEST(FrameElastic, RigidMotionsTurnTheForces) {
  const auto frames = cube({1, 1, 1});
  const System system(frames.nodes, elastic(frames.body, law));
  State<double> q = system.rest_state();
  retract(q, increment(q, 0.2, 1));
  frame_bodies::expect_objective(system, q, 1000);
}

// A cantilever that bends far, by Newton's method: the same equilibrium by direct and by iterative solves.
TEST(FrameElastic, ACantileverFindsItsEquilibrium) {
  const auto frames = on_mesh(box_hexahedra({4, 1, 1}, {4, 1, 1}));
  System system(frames.nodes, elastic(frames.body, law), gravity(frames.body, 0.003, {0, 0, -9.81}),
                rotation_tie(frames.body, 0.01));
  EXPECT_THROW(require_supports(system), std::invalid_argument);
  std::vector<std::int32_t> fixed;
  for (std::size_t j = 0; j < frames.nodes.frames().size(); ++j)
    if (frames.nodes.frames()[j][0] == 0) fixed.push_back(static_cast<std::int32_t>(j));
  system.prescribed.fix_frames(fixed);
  const auto solved = [&](auto solver) {
    State<double> q = system.rest_state();
    const StepReport report = solver.solve(system, q);
    EXPECT_EQ(report.status, Status::converged) << report.reason;
    EXPECT_LT(report.newton_iterations, 12);
    return q;
  };
  using S = decltype(system);
  const State<double> q = solved(StaticSolver<S, Assembled, BlockJacobi>({.tolerance = 1e-10}));
  const State<double> p = solved(StaticSolver<S, Assembled, Ldlt, Stationary>({.tolerance = 1e-10}));
  const State<double> f = solved(StaticSolver<S, MatrixFree>({.tolerance = 1e-10}));
  Vec d(q.size());
  difference(q, p, d);
  EXPECT_LT(d.norm(), 1e-8);
  difference(q, f, d);
  EXPECT_LT(d.norm(), 1e-8);
  double tip = 0;
  for (std::ptrdiff_t j = 0; j < q.frames(); ++j) tip = std::min(tip, q.translation(j)[2]);
  EXPECT_LT(tip, -0.3);  // it does bend far
}

}  // namespace frame_elastic_test
