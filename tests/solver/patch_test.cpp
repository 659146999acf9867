// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

#include "material/law_checks.hpp"
#include "potential/bodies.hpp"
#include "softsim/integrator/static_solver.hpp"
#include "softsim/potential/elastic.hpp"
#include "softsim/system/system.hpp"

// Patch test: with every surface node on an affine map the inner nodes of a distorted mesh have to follow it,
// and the surface has to carry P N A.

namespace patch_test {

using bodies::Matrix, bodies::Vec;
using softsim::State, softsim::Status, softsim::Vector;

template <class Law>
class Patch : public ::testing::Test {
 protected:
  static constexpr double young = 10;
  softsim::TetrahedralMesh mesh = bodies::distorted_cube(4, 1);  // 27 inner nodes
  Law law = Law::from_young_poisson(young, 0.3);

  // Solves from rest in one go and compares.
  void expect_affine(const Matrix& F) {
    softsim::System system(mesh, softsim::elastic(mesh, law));
    const State<double> exact = bodies::affine_state(mesh, F, Vec(0.1, -0.2, 0.3));
    const std::vector<bool> outer = bodies::on_surface(mesh);
    for (std::size_t i = 0; i < outer.size(); ++i)
      if (outer[i])
        system.prescribed.set(static_cast<std::int32_t>(i), exact.point(static_cast<std::ptrdiff_t>(i)));
    State<double> q(outer.size());
    const auto report = softsim::StaticSolver<decltype(system)>({.tolerance = 1e-12}).solve(system, q);
    ASSERT_EQ(report.status, Status::converged) << report.reason << ", residual " << report.residual;
    // the residual bounds the error by the condition number, some hundred
    EXPECT_LT((q.displacement - exact.displacement).cwiseAbs().maxCoeff(), 1e-9);

    const Matrix P = law.first_piola(F);
    Vector<double> reaction = Vector<double>::Zero(q.size());
    for (const softsim::Triangle& f : softsim::boundary_triangles(mesh)) {
      const auto X = [&](std::size_t i) { return mesh.points()[static_cast<std::size_t>(f[i])]; };
      const Vec area = 0.5 * (X(1) - X(0)).cross(X(2) - X(0));
      for (const std::int32_t i : f) softsim::block(reaction, i) += P * area / 3;
    }
    EXPECT_LT((bodies::gradient(system, q) - reaction).norm(), 1e-9 * std::max(P.norm(), young));
  }
};
TYPED_TEST_SUITE(Patch, law_checks::AllLaws, law_checks::LawName);

TYPED_TEST(Patch, UniaxialStretch) { this->expect_affine(Vec(1.25, 0.9, 0.9).asDiagonal()); }

TYPED_TEST(Patch, EquibiaxialStretch) { this->expect_affine(Vec(1.2, 1.2, 0.8425870041).asDiagonal()); }

TYPED_TEST(Patch, SimpleShear) {
  Matrix F = Matrix::Identity();
  F(0, 1) = 0.4;
  this->expect_affine(F);
}

TYPED_TEST(Patch, StretchAndRotation) {
  Matrix U;
  U << 1.1, 0.05, -0.1, 0.05, 0.95, 0.08, -0.1, 0.08, 0.9;
  const Matrix R = Eigen::AngleAxisd(0.7, Vec(1, 2, -1).normalized()).toRotationMatrix();
  this->expect_affine(R * U);
}

}  // namespace patch_test
