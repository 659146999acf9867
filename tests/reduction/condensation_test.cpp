// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/reduction/condensation.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <limits>
#include <vector>

#include "potential/bodies.hpp"
#include "softsim/material/neo_hookean.hpp"
#include "softsim/mesh/quadratic_tetrahedral_mesh.hpp"
#include "softsim/mesh/selection.hpp"
#include "softsim/mesh/surface_nodes.hpp"
#include "softsim/potential/elastic.hpp"
#include "softsim/system/system.hpp"

namespace condensation_test {

using bodies::Vec, bodies::refusal, bodies::relative_error;
using softsim::Condensation, softsim::PlacedContact, softsim::PlacedForce, softsim::State, softsim::Status,
    softsim::Vector;
using Matrix = Eigen::MatrixXd;

const double nan = std::numeric_limits<double>::quiet_NaN();

// A cube that is fixed at xmin, bent a little, and its dense stiffness there.
class Cube : public ::testing::Test {
 protected:
  softsim::TetrahedralMesh mesh = bodies::distorted_cube(3, 1);
  softsim::System<softsim::ElasticTetrahedra<softsim::NeoHookean>> system{
      mesh, softsim::elastic(mesh, softsim::NeoHookean::from_young_poisson(10, 0.3))};
  State<double> q = bodies::random_state(mesh.points().size(), 0.01, 2);
  std::vector<std::int32_t> surface = softsim::surface_nodes(mesh);

  void SetUp() override {
    system.prescribed.fix(softsim::nodes_near(mesh, softsim::Side::xmin, 0));
    system.prescribed.set(63, 1, 0);
  }
  // K^-1 f of the flat vector f, by a dense solve.
  Vector<double> full_solve(const Vector<double>& f) const {
    const softsim::FreeComponents free(system.prescribed);
    const Matrix K = softsim::stiffness_matrix(system, q, free);
    Vector<double> x(free.size()), u = f;
    free.gather(f, x);
    x = K.llt().solve(x).eval();
    free.scatter(x, u);
    return u;
  }
  Vector<double> flat(const Condensation<>& condensed, const std::vector<PlacedForce>& forces) const {
    Vector<double> f = Vector<double>::Zero(system.size());
    for (const PlacedForce& one : forces)
      softsim::block(f, condensed.nodes()[static_cast<std::size_t>(one.place)]) += one.force;
    return f;
  }
};

TEST_F(Cube, SurfaceNodesAreThoseOnTheSides) {
  EXPECT_EQ(surface.size(), 64U - 8U);
  for (const std::int32_t i : surface) {
    const Vec x = mesh.points()[static_cast<std::size_t>(i)] - Vec::Constant(0.5);
    EXPECT_NEAR(x.cwiseAbs().maxCoeff(), 0.5, 1e-12);
  }
  // a cube of one cell: 8 corners, 12 edges, 6 diagonals of sides; only the long diagonal's middle is inside
  const softsim::QuadraticTetrahedralMesh quadratic(softsim::box_mesh({1, 1, 1}, {1, 1, 1}));
  EXPECT_EQ(softsim::surface_nodes(quadratic).size(), 26U);
  EXPECT_EQ(quadratic.points().size(), 27U);
}

TEST_F(Cube, DisplacementsAreThoseOfTheFullSolve) {
  Condensation<> condensed(system, q, surface);
  const std::vector<PlacedForce> forces{{condensed.place(63), {0.1, 0.2, -0.3}},
                                        {condensed.place(31), {0, 1, 0}},
                                        {condensed.place(0), {1, 1, 1}}};  // fixed: without effect
  Eigen::VectorXd u;
  ASSERT_EQ(condensed.displacements(forces, u).status, Status::converged);
  const Vector<double> full = full_solve(flat(condensed, forces));
  for (std::size_t k = 0; k < surface.size(); ++k)
    EXPECT_LT((u.segment<3>(3 * static_cast<std::ptrdiff_t>(k)) - softsim::block(full, surface[k])).norm(),
              1e-10 * full.norm());
  Vector<double> all;
  ASSERT_EQ(condensed.recover(forces, all).status, Status::converged);
  EXPECT_LT(relative_error(all, full), 1e-10);
}

TEST_F(Cube, CondensedStiffnessIsTheInverseOfTheCompliance) {
  const std::vector<std::int32_t> nodes{62, 47, 21, 9};  // 21 lies inside
  const Condensation<> condensed(system, q, nodes);
  const Matrix K = softsim::condensed_stiffness(system, q, nodes);
  EXPECT_LT((K * condensed.compliance() - Matrix::Identity(12, 12)).norm(), 1e-10);
  EXPECT_LT((condensed.compliance() - condensed.compliance().transpose()).norm(),
            1e-12 * condensed.compliance().norm());
}

TEST_F(Cube, PrescribedRowsAreZero) {
  const std::vector<std::int32_t> nodes{63, 47};
  const Condensation<> condensed(system, q, nodes);
  const Matrix K = softsim::condensed_stiffness(system, q, nodes);
  EXPECT_EQ(condensed.compliance().row(1).norm(), 0);
  EXPECT_EQ(condensed.compliance().col(1).norm(), 0);
  EXPECT_EQ(K.row(1).norm(), 0);
  EXPECT_GT(K.row(0).norm(), 0);
}

// The chosen nodes of a free body carry its six rigid motions: six eigenvalues are zero.
TEST_F(Cube, CondensedStiffnessOfAFreeBodyKeepsRigidMotions) {
  for (std::int32_t i = 0; i < 64; ++i) system.prescribed.release(i);
  const Matrix K = softsim::condensed_stiffness(system, State<double>(64), surface);
  const Eigen::VectorXd lambda = Eigen::SelfAdjointEigenSolver<Matrix>(K).eigenvalues();
  EXPECT_LT(lambda.head(6).cwiseAbs().maxCoeff(), 1e-12 * lambda.tail(1)[0]);
  EXPECT_GT(lambda[6], 1e-6 * lambda.tail(1)[0]);
  EXPECT_NE(refusal([&] { return Condensation<>(system, State<double>(64), surface); }).find("must be held"),
            std::string::npos);
}

// One node held altogether and one along an oblique direction, while a force acts elsewhere: the demands are
// met, and the full solve under all those forces agrees.
TEST_F(Cube, ContactForcesMeetTheDemands) {
  Condensation<> condensed(system, q, surface);
  const Vec normal = Vec(1, 2, -2) / 3;
  const std::ptrdiff_t a = condensed.place(47), b = condensed.place(62);
  const std::vector<PlacedContact> contacts{
      {a, Vec::UnitX(), 0.01}, {a, Vec::UnitY(), -0.02}, {a, Vec::UnitZ(), 0.03}, {b, normal, -0.05}};
  std::vector<PlacedForce> forces{{condensed.place(51), {0, 0, 0.2}}};
  Eigen::VectorXd f, u;
  ASSERT_EQ(condensed.contact(contacts, f, u, forces).status, Status::converged);
  ASSERT_EQ(f.size(), 4);
  EXPECT_LT((u.segment<3>(3 * a) - Vec(0.01, -0.02, 0.03)).norm(), 1e-14);
  EXPECT_NEAR(normal.dot(u.segment<3>(3 * b)), -0.05, 1e-14);
  forces.push_back({a, f.head<3>()});
  forces.push_back({b, f[3] * normal});
  const Vector<double> full = full_solve(flat(condensed, forces));
  for (std::size_t k = 0; k < surface.size(); ++k)
    EXPECT_LT((u.segment<3>(3 * static_cast<std::ptrdiff_t>(k)) - softsim::block(full, surface[k])).norm(),
              1e-10 * full.norm());
  ASSERT_EQ(condensed.contact({}, f, u).status, Status::converged);
  EXPECT_EQ(u.norm(), 0);
}

TEST_F(Cube, FloatsKeepSevenDigits) {
  Condensation<float> small(system, q, surface);
  Condensation<> condensed(system, q, surface);
  EXPECT_LT(relative_error(small.compliance(), condensed.compliance()), 1e-7);
  Eigen::VectorXd u, v, f;
  const std::vector<PlacedForce> forces{{small.place(63), {0.1, 0.2, -0.3}}};
  ASSERT_EQ(small.displacements(forces, u).status, Status::converged);
  ASSERT_EQ(condensed.displacements(forces, v).status, Status::converged);
  EXPECT_LT(relative_error(u, v), 1e-6);
  ASSERT_EQ(small.contact({{small.place(47), Vec::UnitX(), 0.01}}, f, u).status, Status::converged);
  EXPECT_NEAR(u[3 * small.place(47)], 0.01, 1e-8);
}

TEST_F(Cube, DemandsThatCannotBeMetAreReportedAndChangeNothing) {
  Condensation<> condensed(system, q, surface);
  const Eigen::VectorXd before = Eigen::VectorXd::Constant(2, 7);
  Eigen::VectorXd f = before, u = before;
  const std::ptrdiff_t a = condensed.place(47), fixed = condensed.place(0);
  const auto reason = [&](const std::vector<PlacedContact>& contacts) {
    const softsim::LinearReport report = condensed.contact(contacts, f, u);
    EXPECT_NE(report.status, Status::converged);
    EXPECT_EQ(f, before);
    EXPECT_EQ(u, before);
    return std::string(report.reason);
  };
  EXPECT_EQ(reason({{a, Vec::UnitX(), 0.1}, {a, Vec::UnitX(), 0.2}}),
            "condensation: demands that depend on each other");
  EXPECT_EQ(reason({{fixed, Vec::UnitX(), 0.1}}), "condensation: a demand on a prescribed component");
  EXPECT_EQ(reason({{-1, Vec::UnitX(), 0.1}}), "condensation: no such place");
  EXPECT_EQ(reason({{99, Vec::UnitX(), 0.1}}), "condensation: no such place");
  EXPECT_EQ(reason({{a, Vec(1, 1, 0), 0.1}}), "condensation: a direction is not a unit vector");
  EXPECT_EQ(reason({{a, Vec::UnitX(), nan}}), "condensation: a demand is not finite");
  EXPECT_EQ(condensed.displacements({{99, Vec::UnitX()}}, u).status, Status::not_converged);
  EXPECT_EQ(condensed.displacements({{a, Vec(0, nan, 0)}}, u).status, Status::not_finite);
  EXPECT_EQ(u, before);
  Vector<double> all = before;
  EXPECT_EQ(condensed.recover({{99, Vec::UnitX()}}, all).status, Status::not_converged);
  EXPECT_EQ(condensed.recover({{a, Vec(0, nan, 0)}}, all).status, Status::not_finite);
  EXPECT_EQ(all, before);
}

TEST_F(Cube, RefusesNodesThatDoNotExist) {
  const auto with = [&](const std::vector<std::int32_t>& nodes) {
    return refusal([&] { return Condensation<>(system, q, nodes); });
  };
  EXPECT_EQ(with({}), "condensation: no node is chosen");
  EXPECT_EQ(with({3, 64}), "condensation: node 64 is out of range (there are 64)");
  EXPECT_EQ(with({-1}), "condensation: node -1 is out of range (there are 64)");
  EXPECT_EQ(with({3, 5, 3}), "condensation: node 3 is chosen twice");
  EXPECT_EQ(refusal([&] { return Condensation<>(system, State<double>(3), {1}); }),
            "state: 12 scalars, must be 256");
  EXPECT_EQ(refusal([&] { return Condensation<>(system, q, {1}).place(2); }),
            "condensation: node 2 was not chosen");
  for (std::int32_t i = 0; i < 64; ++i) system.prescribed.set(i, Vec::Zero());
  EXPECT_EQ(with({1}), "system: no component is free, nothing is left to reduce");
}

}  // namespace condensation_test
