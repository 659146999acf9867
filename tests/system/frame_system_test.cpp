// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "potential/frame_bodies.hpp"
#include "refusal.hpp"
#include "softsim/integrator/static_solver.hpp"
#include "softsim/kinematics/shepard.hpp"
#include "softsim/material/neo_hookean.hpp"
#include "softsim/material/st_venant_kirchhoff.hpp"
#include "softsim/potential/dead_load.hpp"
#include "softsim/potential/frame_elastic.hpp"
#include "softsim/potential/frame_loads.hpp"
#include "softsim/potential/spring.hpp"
#include "softsim/solver/multigrid.hpp"
#include "softsim/system/supports.hpp"
#include "softsim/system/system.hpp"

// Systems of frames: what is prescribed, supports, masses, preconditioners, and what is refused.

namespace frame_system_test {

using namespace softsim;
using Vec = Vector<double>;
using V = Vec3<double>;
using M = Mat3<double>;

// Four frames in a row, samples around their line.
std::vector<V> row(int n = 4) {
  std::vector<V> X;
  for (int j = 0; j < n; ++j) X.emplace_back(j, 0, 0);
  return X;
}
std::vector<V> around() {
  std::vector<V> X;
  for (int i = 0; i < 6; ++i)
    for (const double y : {-0.2, 0.2})
      for (const double z : {-0.15, 0.15}) X.emplace_back((i + 0.5) / 2, y, z);
  return X;
}
FrameBody<4> rod(const FrameNodes& nodes) {
  return {nodes, Shepard<>(nodes.frames(), {.nearest = 4}), around(), std::vector<double>(24, 0.02)};
}
const auto law = StVenantKirchhoff::from_young_poisson(10, 0.3);

TEST(FrameSystem, RefusesWhatIsNoFrame) {
  const auto message = [](std::vector<V> X, std::vector<UnitQuaternion<double>> axes = {}) {
    return refusals::refusal([&] { FrameNodes(X, axes); });
  };
  EXPECT_EQ(message({}), "frames: there are none");
  EXPECT_EQ(message({V(0, NAN, 0)}), "frame 0: a coordinate is not a finite number");
  EXPECT_EQ(message(row(2), {{0, 0, 0, 1}, {0, 0, 0, 1.1}}),
            "frame 1: quaternion of norm 1.1, it has to be 1");
  EXPECT_EQ(message(row(2), {{0, 0, 0, 1}}), "frames: 1 quaternions for 2 positions");
}

TEST(FrameSystem, RefusesSamplesThatFollowNothing) {
  const FrameNodes nodes(row());
  const Shepard<> near(nodes.frames(), {.radius = 0.4});
  const std::vector<double> one(1, 0.1);
  EXPECT_NE(refusals::refusal([&] {
              FrameBody<4>(nodes, near, {V(1.5, 0, 0)}, one);
            }).find("sample 0: shape functions at (1.5, 0, 0): no node is within"),
            std::string::npos);
  const Shepard<> two(nodes.frames(), {.nearest = 2});
  EXPECT_EQ(refusals::refusal([&] { FrameBody<4>(nodes, two, {V(0.5, 0, 0)}, one); }),
            "frame 2: no sample sees it");
  const Shepard<> all(nodes.frames());
  EXPECT_EQ(refusals::refusal([&] { FrameBody<2>(nodes, all, {V(0.5, 0, 0)}, one); }),
            "sample 0: 4 frames reach it, a sample of this body follows 2: fewer neighbours or a smaller "
            "support are needed");
  EXPECT_EQ(refusals::refusal([&] {
              FrameBody<4>(nodes, all, {V(0.5, 0, 0)}, {0.1, 0.2});
            }),
            "samples: 1 positions, 2 volumes and 1 lists of weights");
  EXPECT_EQ(refusals::refusal([&] { FrameBody<4>(nodes, all, {V(0.5, 0, 0)}, {-0.1}); }),
            "sample 0: volume -0.1 m^3 is not positive and finite");
  EXPECT_EQ(refusals::refusal([&] { FrameBody<4>(nodes, Shepard<>(row(3)), {V(0.5, 0, 0)}, one); }),
            "shape functions of 3 nodes that are not the 4 frames");
  EXPECT_EQ(refusals::refusal([&] { FrameBody<8>(nodes, all, {V(0.5, 0, 0)}, one); }),
            "frames: 4 are fewer than the 8 that a sample follows");
  ShapeValues values = all.at(V(0.5, 0, 0));
  values.values[1] += 0.1;
  EXPECT_EQ(refusals::refusal([&] { FrameBody<4>(nodes, {values}, {V(0.5, 0, 0)}, one); }),
            "sample 0: weights sum to 1.1, they have to sum to 1");
  values.values[1] -= 0.1;
  values.nodes[2] = 7;
  EXPECT_EQ(refusals::refusal([&] { FrameBody<4>(nodes, {values}, {V(0.5, 0, 0)}, one); }),
            "sample 0: frame 7 does not exist");
}

TEST(FrameSystem, RefusesMassesAndLoadsThatAreNone) {
  const FrameNodes nodes(row());
  const FrameBody<4> line(nodes, Shepard<>(nodes.frames()), row(), std::vector<double>(4, 0.1));
  EXPECT_EQ(refusals::refusal([&] { (void)Mass<double>::lumped(line, 1); }),
            "mass of frame 0: its samples have no inertia about some axis: spread them over a cross-section");
  const FrameBody<4> body = rod(nodes);
  EXPECT_EQ(refusals::refusal([&] { (void)Mass<double>::consistent(body, -1); }),
            "density -1 kg/m^3: must be positive and finite");
  EXPECT_EQ(refusals::refusal([&] {
              FrameLoad<4>(body).add(24, {1, 0, 0});
            }),
            "load on sample 24: out of range");
  EXPECT_EQ(refusals::refusal([&] { (void)moments(nodes, {4}, {V(1, 0, 0)}); }),
            "moment on frame 4: out of range");
  EXPECT_EQ(refusals::refusal([&] {
              DeadLoad<double>(1, 4).add_to_frame(4, {1, 0, 0});
            }),
            "load on frame 4: out of range");
  EXPECT_EQ(refusals::refusal([&] {
              DeadLoad<double>(1, 4).add(1, {1, 0, 0});
            }),
            "load on node 1: out of range");
  System system(nodes, elastic(body, law));
  EXPECT_EQ(refusals::refusal([&] {
              system.prescribed.set_frame(4, V::Zero(), {0, 0, 0, 1});
            }),
            "prescribed frame 4: out of range (there are 4)");
  EXPECT_EQ(refusals::refusal([&] {
              system.prescribed.set_rotation(0, {0, 0, 0, 2});
            }),
            "prescribed frame 0: quaternion of norm 2, it has to be 1");
  EXPECT_EQ(refusals::refusal([&] { system.prescribed.set(1, V::Zero()); }),
            "prescribed block 1 is the rotation of frame 0: see set_rotation");
}

// One frame that is held altogether holds the body; in its displacement alone it does not.
TEST(FrameSystem, OneHeldFrameIsASupport) {
  const FrameNodes nodes(row());
  System system(nodes, elastic(rod(nodes), law));
  system.prescribed.set(system.prescribed.first_block(0), V::Zero());
  EXPECT_EQ(
      refusals::refusal([&] { require_supports(system); }),
      "static solve: piece 0 (4 nodes, around 1.5, 0, 0) is free to move: 1 of its nodes is held, and at "
      "least three that are not in line are needed, or one frame, in its rotation too");
  system.prescribed.fix_frames({0});
  EXPECT_EQ(refusals::refusal([&] { require_supports(system); }), "");
}

// Rotations that are prescribed are reached, by load steps along the way too, and a hinge turns about its
// axis.
TEST(FrameSystem, PrescribedRotationsAreReached) {
  const FrameNodes nodes(row());
  System system(nodes, elastic(rod(nodes), law));
  using S = decltype(system);
  system.prescribed.fix_frames({0});
  const UnitQuaternion<double> turned = quaternion_exponential(V(1, 0.2, -0.1));
  system.prescribed.set_frame(3, {0.1, 0.2, 0}, turned);
  State<double> q = system.rest_state();
  StaticSolver<S, Assembled, BlockJacobi> solver({.tolerance = 1e-9}, {.steps = 3});
  const StepReport report = solver.solve(system, q);
  EXPECT_EQ(report.status, Status::converged) << report.reason;
  EXPECT_LT((q.quaternion(3) - turned).norm(), 1e-14);
  EXPECT_LT((q.translation(3) - V(0.1, 0.2, 0)).norm(), 1e-15);
  EXPECT_GT(q.rotation(1).trace(), q.rotation(2).trace());

  System hinged(nodes, elastic(rod(nodes), law), DeadLoad<double>(0, 4).add_to_frame(3, {0.01, 0.02, 0.01}));
  using H = decltype(hinged);
  hinged.prescribed.fix_frames({0});
  hinged.prescribed.hold_rotation(3, 0);
  hinged.prescribed.hold_rotation(3, 1);
  State<double> p = hinged.rest_state();
  StaticSolver<H, Assembled, BlockJacobi> other({.tolerance = 1e-9});
  EXPECT_EQ(other.solve(hinged, p).status, Status::converged);
  const V r = quaternion_logarithm<double>(p.quaternion(3));
  EXPECT_LT(r.head<2>().norm(), 1e-12);
  EXPECT_GT(std::abs(r[2]), 1e-3);
}

// Points and frames in one system, tied by a spring: a mesh's corner to a frame's origin.
TEST(FrameSystem, PointsAndFramesShareASystem) {
  const TetrahedralMesh mesh = box_mesh({1, 1, 1}, {1, 1, 1}, {-1.5, -0.5, -0.5});
  const FrameNodes nodes(row(), {}, mesh.points());
  const FrameBody<4> body = rod(nodes);
  std::vector<std::array<std::int32_t, 2>> ties;
  std::vector<SpringLink::Data<double>> data;
  for (std::int32_t i = 0; i < 8; ++i)
    if (mesh.points()[static_cast<std::size_t>(i)][0] > -0.6) {
      ties.push_back({i, body.frame_block(0)});
      data.push_back(SpringLink::make(mesh.points()[static_cast<std::size_t>(i)], nodes.frames()[0], 50));
    }
  System system(nodes, elastic(mesh, NeoHookean::from_young_poisson(10, 0.3)), elastic(body, law),
                Elements<Spring>({Spring{}}, data, ties),
                DeadLoad<double>(8, 4).add_to_frame(3, {-0.05, 0.01, 0}));
  using S = decltype(system);
  for (std::int32_t i = 0; i < 8; ++i)
    if (mesh.points()[static_cast<std::size_t>(i)][0] < -1.4) system.prescribed.set(i, V::Zero());
  // the springs meet in one point: the frame may turn about it
  system.prescribed.set_rotation(0, {0, 0, 0, 1});
  State<double> q = system.rest_state();
  StaticSolver<S, Assembled, BlockJacobi> solver({.tolerance = 1e-9});
  const StepReport report = solver.solve(system, q);
  EXPECT_EQ(report.status, Status::converged) << report.reason;
  Vec g = Vec::Zero(system.size());
  system.add_gradient(q, g);
  V sum = V::Zero();
  for (std::ptrdiff_t b = 0; b < 8; ++b)
    if (system.prescribed.contains(static_cast<std::int32_t>(b), 0)) sum += block(g, b);
  EXPECT_LT((sum - V(0.05, -0.01, 0)).norm(), 1e-8);  // the supports carry the load
}

TEST(FrameSystem, BlockJacobiInvertsTheBlocksOfFrames) {
  const FrameNodes nodes(row());
  System system(nodes, elastic(rod(nodes), law));
  system.prescribed.fix_frames({0});
  system.prescribed.hold_rotation(2, 1);
  using S = decltype(system);
  system.mass = Mass<double>::consistent(rod(nodes), 3);
  AssembledTangent<S> tangent;
  MatrixFreeTangent<S> matrix_free;
  const State<double> q = system.rest_state();
  tangent.set(system, q, {.mass = 2});
  matrix_free.set(system, q, {.mass = 2});
  BlockJacobi<double> jacobi, other;
  jacobi.compute(tangent, system.prescribed.free());
  other.compute(matrix_free, system.prescribed.free());
  EXPECT_EQ(jacobi.trouble(), "");
  Vec r = frame_bodies::increment(q, 1, 3), z(r.size()), y(r.size());
  system.prescribed.mask(r);
  jacobi.apply(r, z);
  other.apply(r, y);
  EXPECT_LT((z - y).norm(), 1e-12 * z.norm());
  const Eigen::MatrixXd A = tangent.matrix().to_eigen();
  for (int j = 0; j < 4; ++j) {
    Eigen::Matrix<double, 6, 6> D = A.block<6, 6>(6 * j, 6 * j);
    Eigen::Matrix<double, 6, 1> open, x;
    open << block(system.prescribed.free(), 2 * j), block(system.prescribed.free(), 2 * j + 1);
    D = (open.asDiagonal() * D * open.asDiagonal()).eval();
    D.diagonal() += Eigen::Matrix<double, 6, 1>::Ones() - open;
    x << block(r, 2 * j), block(r, 2 * j + 1);
    x = D.llt().solve(x).eval();
    EXPECT_LE((x.head<3>() - block(z, 2 * j)).norm(), 1e-12 * x.norm());
    EXPECT_LE((x.tail<3>() - block(z, 2 * j + 1)).norm(), 1e-12 * x.norm());
  }
}

// The assembled mass matrix is the product's.
TEST(FrameSystem, MassMatricesAreAssembled) {
  const FrameNodes nodes(row());
  System system(nodes, elastic(rod(nodes), law));
  using S = decltype(system);
  State<double> q = system.rest_state();
  retract(q, frame_bodies::increment(q, 0.7, 1));
  const Vec d = frame_bodies::increment(q, 1, 2);
  for (const bool consistent : {false, true}) {
    system.mass = consistent ? Mass<double>::consistent(rod(nodes), 3) : Mass<double>::lumped(rod(nodes), 3);
    AssembledTangent<S> tangent;
    tangent.set(system, q, {.mass = 1, .stiffness = 0});
    Vec assembled(d.size()), product = Vec::Zero(d.size());
    tangent.apply(d, assembled);
    system.mass.add_product(q, d, 1, product);
    EXPECT_LT((assembled - product).norm(), 1e-13 * product.norm());
    EXPECT_EQ(system.mass.is_lumped(), !consistent);
    EXPECT_NEAR(system.mass.total(), 3 * 24 * 0.02, 1e-13);
  }
}

TEST(FrameSystem, MultigridSolvesFrames) {
  const auto frames = frame_bodies::on_mesh(box_hexahedra({8, 2, 2}, {8, 2, 2}));
  std::vector<V> X = frames.nodes.frames();
  const FrameBody<8> body(frames.nodes, Shepard<>(X, {.nearest = 8}), frames.body.positions(),
                          frames.body.volumes());
  System system(frames.nodes, elastic(body, law), gravity(body, 1e-4, {0, 0, -9.81}));
  using S = decltype(system);
  std::vector<std::int32_t> fixed;
  for (std::size_t j = 0; j < X.size(); ++j)
    if (X[j][0] == 0) fixed.push_back(static_cast<std::int32_t>(j));
  system.prescribed.fix_frames(fixed);
  State<double> q = system.rest_state(), p = q;
  StaticSolver<S, Assembled, Multigrid> multigrid({.tolerance = 1e-8});
  StaticSolver<S, Assembled, BlockJacobi> jacobi({.tolerance = 1e-8});
  const StepReport a = multigrid.solve(system, q), b = jacobi.solve(system, p);
  EXPECT_EQ(a.status, Status::converged) << a.reason;
  EXPECT_EQ(b.status, Status::converged) << b.reason;
  EXPECT_LT(a.linear_iterations, b.linear_iterations / 2);
  Vec d;
  difference(p, q, d);
  EXPECT_LT(d.norm(), 1e-6 * norm(q));
}

}  // namespace frame_system_test
