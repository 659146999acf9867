// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/reduction/warped_modes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "potential/bodies.hpp"
#include "potential/solid_bodies.hpp"
#include "reduction/reduced_bodies.hpp"

namespace warped_modes_test {

using bodies::Matrix, bodies::Vec, bodies::refusal;
using softsim::LinearReport, softsim::Prescribed, softsim::Status, softsim::WarpedModes;
using Shape = Eigen::VectorXd;
using Function = LinearReport (WarpedModes::*)(const Shape&, Shape&);

const double nan = std::numeric_limits<double>::quiet_NaN();

Shape shape_of(WarpedModes& warped, Function f, const Shape& a) {
  Shape u;
  const LinearReport report = (warped.*f)(a, u);
  EXPECT_EQ(report.status, Status::converged) << report.reason;
  return u;
}

// Rest positions plus displacements.
template <class Mesh>
std::vector<Vec> positions(const Mesh& mesh, const Shape& u) {
  std::vector<Vec> x = mesh.points();
  for (std::size_t i = 0; i < x.size(); ++i) x[i] += u.segment<3>(4 * static_cast<std::ptrdiff_t>(i));
  return x;
}

// A small rotation w x X of the whole body has to become the rotation exp(w), whatever the elements.
template <class Mesh>
void expect_rigid_rotation(const Mesh& mesh) {
  const Prescribed<double> nothing(mesh.points().size());
  const Vec w(0.9, -1.1, 0.6);
  const Matrix R = softsim::rotation_exponential(w);
  Shape phi = Shape::Zero(4 * static_cast<std::ptrdiff_t>(mesh.points().size()));
  for (std::size_t i = 0; i < mesh.points().size(); ++i)
    phi.segment<3>(4 * static_cast<std::ptrdiff_t>(i)) = w.cross(mesh.points()[i]);
  WarpedModes warped(mesh, nothing, phi);
  for (const Function f : {&WarpedModes::modal_warping, &WarpedModes::rotation_strain}) {
    const std::vector<Vec> x = positions(mesh, shape_of(warped, f, Shape::Ones(1)));
    for (std::size_t i = 1; i < x.size(); ++i)
      EXPECT_LT((x[i] - x[0] - R * (mesh.points()[i] - mesh.points()[0])).norm(), 1e-12) << i;
  }
}

TEST(WarpedModes, TurnBodiesOfAllElementsRigidly) {
  expect_rigid_rotation(bodies::distorted_cube(2, 1));
  expect_rigid_rotation(solid_bodies::distorted<softsim::HexahedralMesh>(2, 1, 0));
  expect_rigid_rotation(solid_bodies::distorted<softsim::QuadraticTetrahedralMesh>(2, 1, 0.3));
}

// A bar of 8 x 1 x 1 m, clamped at x = 0, and its lowest mode, a bending one; scaled to a tip that moves
// by 1.
struct Bar {
  softsim::TetrahedralMesh mesh = softsim::box_mesh({16, 2, 2}, {8, 1, 1});
  reduced_bodies::System system = reduced_bodies::body(mesh);
  Shape phi;

  Bar() {
    system.prescribed.fix(softsim::nodes_near(mesh, softsim::Side::xmin, 0));
    phi = reduced_bodies::all_modes(system).shapes.col(0);
    phi /= phi.segment<3>(4 * middle(16)).norm();
  }
  static std::ptrdiff_t middle(int i) { return (1 * 3 + 1) * 17 + i; }  // node i of the middle line
  double volume_change(const Shape& u) const {
    const std::vector<Vec> x = positions(mesh, u);
    double sum = 0;
    for (const auto& v : mesh.tetrahedra()) {
      const auto at = [&](std::size_t i) { return x[static_cast<std::size_t>(v[i])]; };
      sum += softsim::tetrahedron_volume(at(0), at(1), at(2), at(3));
    }
    return sum / mesh.volume() - 1;
  }
  double length_change(const Shape& u) const {
    const std::vector<Vec> x = positions(mesh, u);
    double sum = 0;
    for (int i = 0; i < 16; ++i)
      sum += (x[static_cast<std::size_t>(middle(i + 1))] - x[static_cast<std::size_t>(middle(i))]).norm();
    return sum / 8 - 1;
  }
};

const Bar& the_bar() {
  static const Bar bar;
  return bar;
}

// The tip moves by 5 of 8 m. Along straight lines the middle line becomes longer by int (w'^2) / 2 and the
// body swells with it.
TEST(WarpedModes, ABendingBarKeepsItsLengthAndVolume) {
  const Bar& bar = the_bar();
  WarpedModes warped(bar.mesh, bar.system.prescribed, bar.phi);
  const Shape a = Shape::Constant(1, 5), linear = shape_of(warped, &WarpedModes::linear, a),
              node_wise = shape_of(warped, &WarpedModes::modal_warping, a),
              strain = shape_of(warped, &WarpedModes::rotation_strain, a);
  const auto record = [&](const std::string& name, const Shape& u) {
    RecordProperty(name + "_length", std::to_string(bar.length_change(u)));
    RecordProperty(name + "_volume", std::to_string(bar.volume_change(u)));
  };
  record("linear", linear);
  record("node_wise", node_wise);
  record("strain", strain);
  EXPECT_GT(bar.length_change(linear), 0.15);
  EXPECT_GT(bar.volume_change(linear), 0.3);
  EXPECT_LT(std::abs(bar.length_change(node_wise)), 0.2 * bar.length_change(linear));
  EXPECT_LT(std::abs(bar.volume_change(node_wise)), 0.2 * bar.volume_change(linear));
  EXPECT_LT(std::abs(bar.length_change(strain)), 0.002);
  EXPECT_LT(std::abs(bar.volume_change(strain)), 0.005);
  for (const std::int32_t i : softsim::nodes_near(bar.mesh, softsim::Side::xmin, 0))
    for (const Shape* u : {&node_wise, &strain}) EXPECT_EQ(u->segment<4>(4 * i).norm(), 0);
}

TEST(WarpedModes, DifferFromTheLinearShapeInSecondOrder) {
  const Bar& bar = the_bar();
  WarpedModes warped(bar.mesh, bar.system.prescribed, bar.phi);
  for (const Function f : {&WarpedModes::modal_warping, &WarpedModes::rotation_strain}) {
    const auto difference = [&](double a) {
      const Shape one = Shape::Constant(1, a);
      return (shape_of(warped, f, one) - shape_of(warped, &WarpedModes::linear, one)).norm();
    };
    EXPECT_NEAR(difference(0.02) / difference(0.01), 4, 0.01);
  }
}

TEST(WarpedModes, FailureLeavesTheShapeAlone) {
  const Bar& bar = the_bar();
  WarpedModes warped(bar.mesh, bar.system.prescribed, bar.phi);
  Shape u = Shape::Constant(2, 7);
  for (const Function f :
       {&WarpedModes::linear, &WarpedModes::modal_warping, &WarpedModes::rotation_strain}) {
    EXPECT_EQ((warped.*f)(Shape::Constant(1, nan), u).status, Status::not_finite);
    EXPECT_EQ((warped.*f)(Shape::Ones(2), u).status, Status::not_converged);
    EXPECT_EQ(u, Shape::Constant(2, 7));
  }
}

TEST(WarpedModes, RefuseShapesThatDoNotFit) {
  const softsim::TetrahedralMesh mesh = bodies::distorted_cube(1, 1);
  Prescribed<double> prescribed(8);
  const auto with = [&](const Eigen::MatrixXd& shapes) {
    return refusal([&] { return WarpedModes(mesh, prescribed, shapes); });
  };
  EXPECT_EQ(with(Eigen::MatrixXd(32, 0)), "shapes: 32 x 0, must have 32 rows and a column");
  EXPECT_EQ(with(Eigen::MatrixXd::Ones(28, 1)), "shapes: 28 x 1, must have 32 rows and a column");
  EXPECT_EQ(with(Eigen::MatrixXd::Constant(32, 1, nan)), "shapes: must be finite");
  prescribed.set(3, 1, 0);
  Shape one = Shape::Zero(32);
  one[13] = 1;
  EXPECT_EQ(with(one), "shapes: node 3: a shape moves a prescribed component");
  const softsim::TetrahedralMesh two(
      {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {5, 0, 0}, {6, 0, 0}, {5, 1, 0}, {5, 0, 1}},
      {{0, 1, 2, 3}, {4, 5, 6, 7}});
  EXPECT_EQ(refusal([&] { return WarpedModes(two, Prescribed<double>(8), one); }),
            "warped modes: a piece of the mesh is not held along axis 0, a free body must be of one piece");
}

}  // namespace warped_modes_test
