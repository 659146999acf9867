// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/potential/face_loads.hpp"

#include <gtest/gtest.h>

#include <cstddef>

#include "potential/bodies.hpp"
#include "potential/solid_bodies.hpp"
#include "softsim/mesh/selection.hpp"

namespace face_loads_test {

using bodies::Matrix, bodies::Vec, bodies::gradient, bodies::hessian_product, bodies::random_vector,
    bodies::refusal, bodies::relative_error;
using softsim::State, softsim::Vector, softsim::block;

static_assert(softsim::LocalForce<softsim::FollowerFacePressure<softsim::QuadraticTriangle>>);
static_assert(!softsim::LocalPotential<softsim::FollowerFacePressure<softsim::BilinearQuadrilateral>>);

template <class Mesh>
class FaceLoads : public ::testing::Test {
 protected:
  Mesh body = solid_bodies::distorted<Mesh>(2, 1, 0);
  std::size_t points = body.points().size();
  State<double> state = bodies::random_state(points, 0.1, 2);
};
using Meshes = ::testing::Types<softsim::HexahedralMesh, softsim::QuadraticTetrahedralMesh>;
TYPED_TEST_SUITE(FaceLoads, Meshes);

TYPED_TEST(FaceLoads, PressureOnAClosedSurfaceIsItsVolumesDerivative) {
  const auto faces = softsim::boundary_faces(this->body);
  const auto load = softsim::pressure(this->body, faces, 3);
  // no net force, no net moment
  const Vector<double> g = gradient(load, this->state);
  Vec sum = Vec::Zero(), moment = Vec::Zero();
  for (std::size_t i = 0; i < this->points; ++i) {
    const Vec f = block(g, static_cast<std::ptrdiff_t>(i));
    sum += f;
    moment += (this->body.points()[i] + this->state.point(static_cast<std::ptrdiff_t>(i))).cross(f);
  }
  EXPECT_LT(sum.norm(), 1e-14);
  EXPECT_LT(moment.norm(), 1e-14);
  // p dV, with V the volume of the deformed mesh, whose surface is that of its shape functions
  const auto volume = [&](const Vector<double>& u) {
    auto x = this->body.points();
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += block(u, static_cast<std::ptrdiff_t>(i));
    return TypeParam(x, this->body.elements()).volume();
  };
  const Vector<double> d = random_vector(this->points, 1, 3);
  const Vector<double> start = 0.1 * this->state.displacement;
  State<double> q;
  q.displacement = start;
  const double slope = (volume(start + 1e-3 * d) - volume(start - 1e-3 * d)) / 2e-3;
  EXPECT_NEAR(gradient(load, q).dot(d), 3 * slope, 1e-5 * 3 * std::abs(slope));
}

// The forces are quadratic in the positions: central differences are exact. On a closed surface the
// derivative is symmetric, so that its symmetric part is all of it.
TYPED_TEST(FaceLoads, HessianIsTheDerivativeOnAClosedSurface) {
  const auto load = softsim::pressure(this->body, softsim::boundary_faces(this->body), 3);
  const Vector<double> d = random_vector(this->points, 1, 4);
  State<double> ahead = this->state, behind = this->state;
  softsim::retract(ahead, d, 0.5);
  softsim::retract(behind, d, -0.5);
  const Vector<double> change = gradient(load, ahead) - gradient(load, behind);
  EXPECT_LT(relative_error(hessian_product(load, this->state, d), change), 1e-13);
}

TYPED_TEST(FaceLoads, HessianIsSymmetricOnAPatch) {
  const auto top = softsim::faces_on(softsim::boundary_faces(this->body),
                                     softsim::nodes_near(this->body, softsim::Side::zmax, 0));
  const auto load = softsim::pressure(this->body, top, 3);
  const Vector<double> d = random_vector(this->points, 1, 5), e = random_vector(this->points, 1, 6);
  EXPECT_NEAR(e.dot(hessian_product(load, this->state, d)), d.dot(hessian_product(load, this->state, e)),
              1e-13);
}

// Area times traction, with the moment of an even load.
TYPED_TEST(FaceLoads, TractionOnASideIsEven) {
  const auto top = softsim::faces_on(softsim::boundary_faces(this->body),
                                     softsim::nodes_near(this->body, softsim::Side::zmax, 0));
  const auto load = softsim::traction(this->body, top, Vec(1, 2, 3));
  const Vector<double> pressed =
      gradient(softsim::pressure(this->body, top, -3), State<double>(this->points));
  Vec sum = Vec::Zero(), moment = Vec::Zero();
  for (std::size_t i = 0; i < this->points; ++i) {
    const Vec f = block(load.force(), static_cast<std::ptrdiff_t>(i));
    sum += f;
    moment += this->body.points()[i].cross(f);
    EXPECT_NEAR(f[2], -block(pressed, static_cast<std::ptrdiff_t>(i))[2], 1e-15);
  }
  EXPECT_LT((sum - Vec(1, 2, 3)).norm(), 1e-14);
  EXPECT_LT((moment - Vec(0.5, 0.5, 1).cross(sum)).norm(), 1e-14);
}

TYPED_TEST(FaceLoads, RefuseBadInput) {
  auto faces = softsim::boundary_faces(this->body);
  EXPECT_EQ(refusal([&] { return softsim::pressure(this->body, {}, 1); }), "pressure: no face to act on");
  EXPECT_EQ(refusal([&] { return softsim::traction(this->body, {}, Vec(0, 0, 1)); }),
            "traction: no face to act on");
  EXPECT_EQ(refusal([&] { return softsim::pressure(this->body, faces, 1e301); }),
            "pressure 1e+301 Pa: must be finite");
  faces[1][2] = -1;
  EXPECT_EQ(refusal([&] { return softsim::pressure(this->body, faces, 1); }),
            "pressure on face 1: node -1 is out of range");
  EXPECT_EQ(refusal([&] { return softsim::traction(this->body, faces, Vec(0, 0, 1)); }),
            "traction on face 1: node -1 is out of range");
}

}  // namespace face_loads_test
