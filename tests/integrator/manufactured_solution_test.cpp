// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "potential/bodies.hpp"
#include "softsim/integrator/static_solver.hpp"
#include "softsim/material/neo_hookean.hpp"
#include "softsim/material/st_venant_kirchhoff.hpp"
#include "softsim/potential/dead_load.hpp"
#include "softsim/potential/elastic.hpp"
#include "softsim/system/system.hpp"

// A smooth displacement u on the unit cube is the solution for the body force b = -Div P(I + grad u) and its
// own values on the boundary. Linear tetrahedra then miss it by O(h^2) in the L2 norm.

namespace manufactured_solution_test {

using bodies::Matrix, bodies::Vec;
using softsim::State, softsim::Status, softsim::TetrahedralMesh;

// No symmetry, stretches between 0.75 and 1.25.
Vec displacement(const Vec& X) {
  constexpr double pi = std::numbers::pi;
  return {0.06 * std::sin(pi * X[0]) * std::cos(pi * X[1]) + 0.05 * X[2] * X[2],
          0.05 * std::cos(pi * X[0] + 0.3) * std::sin(pi * X[2]) - 0.04 * X[0] * X[1],
          0.06 * std::sin(pi * X[1]) * std::sin(0.5 * pi * X[2] + 0.2) + 0.03 * X[0]};
}

Matrix deformation_gradient(const Vec& X) {
  constexpr double pi = std::numbers::pi;
  const double angle = 0.5 * pi * X[2] + 0.2;
  Matrix F = Matrix::Identity();
  F(0, 0) += 0.06 * pi * std::cos(pi * X[0]) * std::cos(pi * X[1]);
  F(0, 1) -= 0.06 * pi * std::sin(pi * X[0]) * std::sin(pi * X[1]);
  F(0, 2) += 0.1 * X[2];
  F(1, 0) -= 0.05 * pi * std::sin(pi * X[0] + 0.3) * std::sin(pi * X[2]) + 0.04 * X[1];
  F(1, 1) -= 0.04 * X[0];
  F(1, 2) += 0.05 * pi * std::cos(pi * X[0] + 0.3) * std::cos(pi * X[2]);
  F(2, 0) += 0.03;
  F(2, 1) += 0.06 * pi * std::cos(pi * X[1]) * std::sin(angle);
  F(2, 2) += 0.03 * pi * std::sin(pi * X[1]) * std::cos(angle);
  return F;
}

// -Div P by eighth-order central differences: with the step 0.02 truncation and rounding are below 1e-10 of
// the value.
template <class Law>
Vec body_force(const Law& law, const Vec& X) {
  constexpr double h = 0.02, weight[] = {4.0 / 5, -1.0 / 5, 4.0 / 105, -1.0 / 280};
  Vec b = Vec::Zero();
  for (int axis = 0; axis < 3; ++axis)
    for (int k = 1; k <= 4; ++k) {
      const Vec step = k * h * Vec::Unit(axis);
      const Matrix ahead = law.first_piola(deformation_gradient(X + step)),
                   behind = law.first_piola(deformation_gradient(X - step));
      b -= weight[k - 1] / h * (ahead - behind).col(axis);
    }
  return b;
}

// Quadrature on a tetrahedron, exact for polynomials of degree 2: barycentric coordinates and equal weights
// 1/4.
constexpr double inner = 0.1381966011250105, outer = 0.5854101966249685;
std::array<double, 4> barycentric(int point) {
  std::array<double, 4> b{inner, inner, inner, inner};
  b[static_cast<std::size_t>(point)] = outer;
  return b;
}
// The error varies within a tetrahedron (it is small at the nodes): its square is averaged over an even grid
// of 35 points.
template <class F>
double mean_on_tetrahedron(F f) {
  double sum = 0;
  int count = 0;
  constexpr int n = 4;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; i + j <= n; ++j)
      for (int k = 0; i + j + k <= n; ++k, ++count)
        sum += f(std::array<double, 4>{(i + 0.25) / (n + 1), (j + 0.25) / (n + 1), (k + 0.25) / (n + 1),
                                       (n - i - j - k + 0.25) / (n + 1)});
  return sum / count;
}

template <class Law>
double error_with(int n, const Law& law) {
  const TetrahedralMesh mesh = bodies::distorted_cube(n, 1);
  softsim::DeadLoad<double> load(mesh.points().size());
  const auto at = [&](const softsim::Tetrahedron& v, const std::array<double, 4>& b) {
    Vec X = Vec::Zero();
    for (std::size_t i = 0; i < 4; ++i) X += b[i] * mesh.points()[static_cast<std::size_t>(v[i])];
    return X;
  };
  for (std::size_t t = 0; t < mesh.tetrahedra().size(); ++t)
    for (int point = 0; point < 4; ++point) {
      const softsim::Tetrahedron& v = mesh.tetrahedra()[t];
      const std::array<double, 4> b = barycentric(point);
      const Vec f = mesh.volume(t) / 4 * body_force(law, at(v, b));
      for (std::size_t i = 0; i < 4; ++i) load.add(v[i], b[i] * f);
    }
  softsim::System system(mesh, softsim::elastic(mesh, law), load);
  const std::vector<bool> surface = bodies::on_surface(mesh);
  for (std::size_t i = 0; i < surface.size(); ++i)
    if (surface[i]) system.prescribed.set(static_cast<std::int32_t>(i), displacement(mesh.points()[i]));
  State<double> q(mesh.points().size());
  EXPECT_LT((deformation_gradient({0.3, 0.6, 0.8}).col(1) - Vec::UnitY() -
             (displacement({0.3, 0.6001, 0.8}) - displacement({0.3, 0.5999, 0.8})) / 2e-4)
                .norm(),
            1e-6);
  const auto report = softsim::StaticSolver<decltype(system)>({.tolerance = 1e-8}).solve(system, q);
  EXPECT_EQ(report.status, Status::converged) << report.reason;

  double square = 0;
  for (std::size_t t = 0; t < mesh.tetrahedra().size(); ++t) {
    const softsim::Tetrahedron& v = mesh.tetrahedra()[t];
    square += mesh.volume(t) * mean_on_tetrahedron([&](const std::array<double, 4>& b) {
                Vec u = Vec::Zero();
                for (std::size_t i = 0; i < 4; ++i) u += b[i] * q.point(v[i]);
                return (u - displacement(at(v, b))).squaredNorm();
              });
  }
  return std::sqrt(square);
}

// Each mesh has twice the cells of the one before.
template <class Law>
void expect_second_order(const Law& law, const std::vector<int>& cells) {
  double coarse = error_with(cells.front(), law);
  for (std::size_t k = 1; k < cells.size(); ++k) {
    const double fine = error_with(cells[k], law), order = std::log2(coarse / fine);
    EXPECT_GT(order, 1.8) << cells[k] << ": " << coarse << " " << fine;
    EXPECT_LT(order, 2.2) << cells[k] << ": " << coarse << " " << fine;
    coarse = fine;
  }
}

TEST(ManufacturedSolution, NeoHookeanConvergesWithTheSquareOfTheMeshSize) {
  expect_second_order(softsim::NeoHookean::from_young_poisson(10, 0.3), {4, 8, 16});
}

TEST(ManufacturedSolution, StVenantKirchhoffConvergesWithTheSquareOfTheMeshSize) {
  expect_second_order(softsim::StVenantKirchhoff::from_young_poisson(10, 0.3), {4, 8});
}

}  // namespace manufactured_solution_test
