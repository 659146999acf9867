// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "potential/frame_bodies.hpp"
#include "softsim/kinematics/gaussian.hpp"
#include "softsim/kinematics/generalised_moving_least_squares.hpp"
#include "softsim/kinematics/interpolating_moving_least_squares.hpp"
#include "softsim/kinematics/maximum_entropy.hpp"
#include "softsim/kinematics/mesh_shapes.hpp"
#include "softsim/kinematics/moving_least_squares.hpp"
#include "softsim/kinematics/natural_neighbours.hpp"
#include "softsim/kinematics/shepard.hpp"
#include "softsim/material/st_venant_kirchhoff.hpp"
#include "softsim/mesh/quadratic_tetrahedral_mesh.hpp"
#include "softsim/potential/frame_elastic.hpp"
#include "softsim/system/system.hpp"
#include "softsim/system/tangent.hpp"

// Frames through every shape function: forces, tangents, invariances at large rotations.

namespace frame_shapes_test {

using namespace softsim;
using Vec = Vector<double>;
using V = Vec3<double>;
using M = Mat3<double>;
constexpr int N = 12;  // frames a sample follows at most

std::vector<V> scattered() {
  std::vector<V> nodes;
  for (int i = 0; i < 8; ++i) nodes.emplace_back(i & 1, i >> 1 & 1, i >> 2);
  for (const V& x : {V(0.3, 0.4, 0.6), V(0.7, 0.25, 0.35), V(0.55, 0.7, 0.5), V(0.4, 0.6, 0.2)})
    nodes.push_back(x);
  return nodes;
}
// Points inside the cube, some next to each corner.
std::vector<V> places() {
  std::mt19937 engine(5);
  const auto random = [&] { return static_cast<double>(engine()) / 4294967296.0; };
  std::vector<V> X;
  for (int s = 0; s < 8; ++s) {
    const double x = random(), y = random(), z = random();
    X.emplace_back(0.1 + 0.8 * x, 0.1 + 0.8 * y, 0.1 + 0.8 * z);
  }
  for (int i = 0; i < 8; ++i)
    X.emplace_back(0.1 + 0.8 * (i & 1), 0.15 + 0.8 * (i >> 1 & 1), 0.1 + 0.75 * (i >> 2));
  return X;
}

struct Body {
  FrameNodes nodes;
  FrameBody<N> body;
};
template <class Shapes>
Body body_of(const Shapes& shapes, std::vector<V> X = places()) {
  FrameNodes nodes(shapes.nodes());
  FrameBody<N> body(nodes, shapes, X, std::vector<double>(X.size(), 1.0 / static_cast<double>(X.size())));
  return {nodes, body};
}
Body quadratic() {
  const TetrahedralMesh two({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}},
                            {Tetrahedron{0, 1, 2, 3}, Tetrahedron{4, 1, 3, 2}});
  return body_of(MeshShapes(QuadraticTetrahedralMesh(two)),
                 {{0.2, 0.2, 0.3}, {0.1, 0.3, 0.2}, {0.5, 0.5, 0.4}, {0.6, 0.4, 0.5}});
}

struct Case {
  std::string name;
  std::function<Body()> make;
};
const std::vector<Case> cases = {
    {"LinearTetrahedra",
     [] {
       return body_of(MeshShapes(box_mesh({2, 1, 1}, {1, 1, 1})));
     }},
    {"TrilinearHexahedra",
     [] {
       return body_of(MeshShapes(box_hexahedra({2, 1, 1}, {1, 1, 1})));
     }},
    {"QuadraticTetrahedra", [] { return quadratic(); }},
    {"Gaussian", [] { return body_of(Gaussian<>(scattered(), {.width = 0.4})); }},
    {"Shepard", [] { return body_of(Shepard<>(scattered())); }},
    {"ShepardFourNearest", [] { return body_of(Shepard<>(scattered(), {.nearest = 4})); }},
    {"ShepardCompact", [] { return body_of(Shepard<>(scattered(), {.radius = 0.9})); }},
    {"MovingLeastSquares0",
     [] { return body_of(MovingLeastSquares<>(scattered(), {.order = 0, .radius = 1.2})); }},
    {"MovingLeastSquares1",
     [] { return body_of(MovingLeastSquares<>(scattered(), {.order = 1, .radius = 1.5})); }},
    {"MovingLeastSquares2",
     [] { return body_of(MovingLeastSquares<>(scattered(), {.order = 2, .radius = 3})); }},
    {"InterpolatingMovingLeastSquares",
     [] { return body_of(InterpolatingMovingLeastSquares<>(scattered(), {.order = 1})); }},
    {"GeneralisedMovingLeastSquares",
     [] { return body_of(GeneralisedMovingLeastSquares<>(scattered(), {.radius = 1.2})); }},
    {"NaturalNeighbours", [] { return body_of(NaturalNeighbours<>(scattered())); }},
    {"MaximumEntropy", [] { return body_of(MaximumEntropy<>(scattered(), {.spacing = 0.6})); }},
};

class FrameShapes : public testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(All, FrameShapes, testing::ValuesIn(cases),
                         [](const auto& test) { return test.param.name; });

const auto law = StVenantKirchhoff::from_young_poisson(10, 0.3);

State<double> far_from_rest(const Body& body) {
  State<double> q = body.nodes.rest_state();
  Vec d = frame_bodies::increment(q, 1, 1);
  for (std::ptrdiff_t b = 0; b < d.size() / block_stride; b += 2) block(d, b) *= 0.2;
  retract(q, d);
  return q;
}

TEST_P(FrameShapes, ForcesAndTangentsDeriveFromTheEnergy) {
  const Body body = GetParam().make();
  const System system(body.nodes, elastic<double, 1>(body.body, law));
  const State<double> q = far_from_rest(body);
  frame_bodies::expect_derivatives(system, q, frame_bodies::increment(q, 1, 2));
}

TEST_P(FrameShapes, RigidMotionsTurnForcesAndDoNoWork) {
  const Body body = GetParam().make();
  const System system(body.nodes, elastic<double, 1>(body.body, law));
  frame_bodies::expect_objective(system, far_from_rest(body), 100);
}

// Where shape functions reproduce linear fields, a uniform strain is one of the body's states.
TEST_P(FrameShapes, ReproducesUniformStrainIfTheShapesReproduceLinearFields) {
  const Body body = GetParam().make();
  const M strain = (M() << 0.1, 0.02, -0.03, 0.02, -0.05, 0.04, -0.03, 0.04, 0.08).finished();
  State<double> q = body.nodes.rest_state();
  for (std::ptrdiff_t j = 0; j < q.frames(); ++j)
    q.translation(j) = strain * body.nodes.frames()[static_cast<std::size_t>(j)];
  double error = 0;
  for (std::size_t s = 0; s < body.body.size(); ++s) {
    Local<double, 0, N> u;
    for (std::size_t i = 0; i < N; ++i) {
      const std::ptrdiff_t j = body.body.blends()[s].frames[i];
      u.frames[i] = {q.translation(j), M::Zero()};
    }
    const M F = FrameSample<N>::deformation_gradient(body.body.data()[s], u);
    error = std::max(error, (F - M::Identity() - strain).norm());
  }
  const std::string& name = GetParam().name;
  const bool linear = name.find("Shepard") == std::string::npos && name != "Gaussian" &&
                      name != "MovingLeastSquares0" && name != "GeneralisedMovingLeastSquares";
  if (linear)
    EXPECT_LT(error, 1e-10);
  else
    EXPECT_GT(error, 1e-3);  // rigid motions alone
}

}  // namespace frame_shapes_test
