// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>

#include "potential/bodies.hpp"
#include "potential/solid_bodies.hpp"
#include "softsim/integrator/static_solver.hpp"
#include "softsim/material/neo_hookean.hpp"
#include "softsim/material/st_venant_kirchhoff.hpp"
#include "softsim/mesh/selection.hpp"
#include "softsim/potential/dead_load.hpp"
#include "softsim/potential/face_loads.hpp"
#include "softsim/potential/quadrature.hpp"
#include "softsim/system/system.hpp"

// Hexahedra and ten-node tetrahedra in static equilibrium: patch test, order of convergence, a slender beam.

namespace solid_elements_test {

using bodies::Matrix, bodies::Vec;
using softsim::HexahedralMesh, softsim::QuadraticTetrahedralMesh, softsim::Side, softsim::State,
    softsim::Status, softsim::Vector;

template <class System>
State<double> equilibrium(const System& system, double tolerance) {
  State<double> q(system.rest().size());
  const auto report =
      softsim::StaticSolver<System>({.tolerance = tolerance, .linear = {.max_iterations = 20000}})
          .solve(system, q);
  EXPECT_EQ(report.status, Status::converged) << report.reason;
  return q;
}

// With the surface on an affine map the inner nodes have to follow, and the surface carries P N A.
template <class Mesh, class Law>
void expect_patch(const Law& law) {
  const Mesh mesh = solid_bodies::distorted<Mesh>(3, 1, 0);
  Matrix U;
  U << 1.15, 0.05, -0.1, 0.05, 0.95, 0.08, -0.1, 0.08, 0.9;
  const Matrix F = Eigen::AngleAxisd(0.4, Vec(1, 2, -1).normalized()).toRotationMatrix() * U;
  // the empty load makes this the type of system of the other tests, which saves compile time
  softsim::System system(mesh, softsim::elastic(mesh, law), softsim::DeadLoad<double>(mesh.points().size()));
  const State<double> exact = solid_bodies::affine_state(mesh, F, Vec(0.1, -0.2, 0.3));
  for (std::size_t i = 0; i < mesh.points().size(); ++i)
    if (solid_bodies::on_unit_cube(mesh.points()[i]))
      system.prescribed.set(static_cast<std::int32_t>(i), exact.point(static_cast<std::ptrdiff_t>(i)));
  const State<double> q = equilibrium(system, 1e-12);
  // the residual bounds the error by the condition number, some hundred
  EXPECT_LT((q.displacement - exact.displacement).cwiseAbs().maxCoeff(), 1e-9);

  const Matrix P = law.first_piola(F);
  const Vector<double> areas = bodies::gradient(softsim::pressure(mesh, softsim::boundary_faces(mesh), 1),
                                                State<double>(mesh.points().size()));
  const Vector<double> forces = bodies::gradient(system, q);
  for (std::ptrdiff_t i = 0; i < static_cast<std::ptrdiff_t>(mesh.points().size()); ++i)
    EXPECT_LT((softsim::block(forces, i) - P * softsim::block(areas, i)).norm(), 1e-9) << i;
}

TEST(SolidPatch, HexahedraPassForStVenantKirchhoff) {
  expect_patch<HexahedralMesh>(softsim::StVenantKirchhoff::from_young_poisson(10, 0.3));
}
TEST(SolidPatch, HexahedraPassForNeoHookean) {
  expect_patch<HexahedralMesh>(softsim::NeoHookean::from_young_poisson(10, 0.3));
}
TEST(SolidPatch, TenNodeTetrahedraPassForStVenantKirchhoff) {
  expect_patch<QuadraticTetrahedralMesh>(softsim::StVenantKirchhoff::from_young_poisson(10, 0.3));
}
TEST(SolidPatch, TenNodeTetrahedraPassForNeoHookean) {
  expect_patch<QuadraticTetrahedralMesh>(softsim::NeoHookean::from_young_poisson(10, 0.3));
}

// Three plane waves u = sum a sin(k.X + phase), the solution for the body force -Div P(I + grad u) and its
// own values on the boundary.
struct Waves {
  std::array<Vec, 3> a{Vec(0.06, -0.03, 0.02), Vec(0.02, 0.06, -0.03), Vec(-0.02, 0.03, 0.05)};
  std::array<Vec, 3> k{Vec(2.5, 1, 0), Vec(-0.5, 2, 1.5), Vec(1, -1, 2.5)};

  Vec displacement(const Vec& X) const {
    Vec u = Vec::Zero();
    for (std::size_t m = 0; m < 3; ++m) u += a[m] * std::sin(k[m].dot(X) + 0.4);
    return u;
  }
  Matrix deformation_gradient(const Vec& X) const {
    Matrix F = Matrix::Identity();
    for (std::size_t m = 0; m < 3; ++m) F += std::cos(k[m].dot(X) + 0.4) * a[m] * k[m].transpose();
    return F;
  }
  template <class Law>
  Vec body_force(const Law& law, const Vec& X) const {
    Vec b = Vec::Zero();
    for (int j = 0; j < 3; ++j) {
      Matrix slope = Matrix::Zero();  // dF/dX_j
      for (std::size_t m = 0; m < 3; ++m)
        slope -= std::sin(k[m].dot(X) + 0.4) * k[m][j] * a[m] * k[m].transpose();
      const Matrix dP = law.first_piola_differential(deformation_gradient(X), slope);
      b -= dP.col(j);
    }
    return b;
  }
};

struct Errors {
  double displacement, gradient;  // L2 norms
};

template <class Mesh>
Errors errors_with(int n) {
  using S = typename Mesh::Shape;
  const Waves waves;
  const auto law = softsim::NeoHookean::from_young_poisson(10, 0.3);
  const Mesh mesh = solid_bodies::distorted<Mesh>(n, 1, 0);
  softsim::DeadLoad<double> load(mesh.points().size());
  const auto for_each_point = [&](auto f) {
    for (std::size_t e = 0; e < mesh.elements().size(); ++e) {
      const auto X = mesh.element_points(e);
      for (const auto& point : S::mass_rule) {
        const auto N = S::values(point.xi);
        Vec x = Vec::Zero();
        for (std::size_t i = 0; i < X.size(); ++i) x += N[static_cast<int>(i)] * X[i];
        f(mesh.elements()[e], softsim::Isoparametric<S>::make(X, point), N, x);
      }
    }
  };
  for_each_point([&](const auto& v, const auto& data, const auto& N, const Vec& x) {
    const Vec f = data.volume * waves.body_force(law, x);
    for (std::size_t i = 0; i < v.size(); ++i) load.add(v[i], N[static_cast<int>(i)] * f);
  });
  softsim::System system(mesh, softsim::elastic(mesh, law), load);
  for (std::size_t i = 0; i < mesh.points().size(); ++i)
    if (solid_bodies::on_unit_cube(mesh.points()[i]))
      system.prescribed.set(static_cast<std::int32_t>(i), waves.displacement(mesh.points()[i]));
  const State<double> q = equilibrium(system, 1e-8);

  double displacement = 0, gradient = 0;
  for_each_point([&](const auto& v, const auto& data, const auto& N, const Vec& x) {
    softsim::Local<double, S::nodes> u;
    Vec at = Vec::Zero();
    for (std::size_t i = 0; i < v.size(); ++i) {
      u.points[i] = q.point(v[i]);
      at += N[static_cast<int>(i)] * u.points[i];
    }
    displacement += data.volume * (at - waves.displacement(x)).squaredNorm();
    const Matrix F = softsim::Isoparametric<S>::deformation_gradient(data, u);
    gradient += data.volume * (F - waves.deformation_gradient(x)).squaredNorm();
  });
  return {std::sqrt(displacement), std::sqrt(gradient)};
}

// Element order p: p + 1 in the displacement, p in its gradient (and so in the energy norm).
TEST(SolidConvergence, TenNodeTetrahedraAreOfOrderThree) {
  const Errors coarse = errors_with<QuadraticTetrahedralMesh>(2),
               fine = errors_with<QuadraticTetrahedralMesh>(4);
  EXPECT_NEAR(std::log2(coarse.displacement / fine.displacement), 3, 0.2);
  EXPECT_NEAR(std::log2(coarse.gradient / fine.gradient), 2, 0.2);
}
TEST(SolidConvergence, HexahedraAreOfOrderTwo) {
  const Errors coarse = errors_with<HexahedralMesh>(4), fine = errors_with<HexahedralMesh>(8);
  EXPECT_NEAR(std::log2(coarse.displacement / fine.displacement), 2, 0.2);
  EXPECT_NEAR(std::log2(coarse.gradient / fine.gradient), 1, 0.2);
}

// Middle of the free end of a beam along x that is clamped at x = 0 and bends under its weight along -z.
template <class Law>
Vec tip_of_beam(const std::array<int, 3>& cells, const Vec& size, const Law& law, double density) {
  const QuadraticTetrahedralMesh mesh(softsim::box_mesh(cells, size));
  softsim::System system(mesh, softsim::elastic(mesh, law), softsim::gravity(mesh, density, {0, 0, -9.81}));
  system.prescribed.fix(softsim::nodes_near(mesh, Side::xmin, 0));
  const State<double> q = equilibrium(system, 1e-6);
  std::size_t tip = 0;
  const Vec middle(size[0], size[1] / 2, size[2] / 2);
  for (std::size_t i = 0; i < mesh.points().size(); ++i)
    if ((mesh.points()[i] - middle).norm() < (mesh.points()[tip] - middle).norm()) tip = i;
  return q.point(static_cast<std::ptrdiff_t>(tip));
}

// 16 x 1 x 1 m, St. Venant-Kirchhoff with E = 40 kPa, nu = 0.3, mass 5 kg: other codes with quadratic
// hexahedra, refined, give (-1.5985, -6.5090) m.
TEST(SolidBeam, TenNodeTetrahedraBendFarUnderTheWeight) {
  const auto law = softsim::StVenantKirchhoff::from_young_poisson(40000, 0.3);
  const Vec tip = tip_of_beam({20, 1, 1}, {16, 1, 1}, law, 5.0 / 16);
  EXPECT_NEAR(tip[2] / -6.5090, 1, 0.01);
  EXPECT_NEAR(tip[0] / -1.5985, 1, 0.02);
}

}  // namespace solid_elements_test
