// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <cstddef>

#include "potential/bodies.hpp"
#include "softsim/integrator/static_solver.hpp"
#include "softsim/material/linear_elastic.hpp"
#include "softsim/mesh/selection.hpp"
#include "softsim/potential/dead_load.hpp"
#include "softsim/potential/elastic.hpp"
#include "softsim/system/system.hpp"

// Slender cantilever under small loads. Linear tetrahedra cannot bend and put a stiffness of their own on top
// of the beam's: with n cells across the height (each twice as long as high) about 8/n^2 of it. Stiffnesses
// at three n extrapolate to n = infinity.

namespace beam_test {

using softsim::Side, softsim::State, softsim::Status;

constexpr double length = 8, young = 1000, poisson = 0.3;

template <class Load>
std::array<double, 3> tip_deflections(const std::array<int, 3>& cells, int axis, Load load) {
  std::array<double, 3> tip{};
  for (std::size_t k = 0; k < 3; ++k) {
    const int n = cells[k];
    const auto mesh = softsim::box_mesh({4 * n, n, n}, {length, 1, 1});
    softsim::System system(
        mesh, softsim::elastic(mesh, softsim::LinearElastic::from_young_poisson(young, poisson)), load(mesh));
    system.prescribed.fix(softsim::nodes_near(mesh, Side::xmin, 0));
    State<double> q(mesh.points().size());
    const auto report =
        softsim::StaticSolver<decltype(system)>({.tolerance = 1e-7, .linear = {.max_iterations = 20000}})
            .solve(system, q);
    EXPECT_EQ(report.status, Status::converged) << report.reason;
    const auto end = softsim::nodes_near(mesh, Side::xmax, 0);
    for (const std::int32_t i : end) tip[k] += q.point(i)[axis] / static_cast<double>(end.size());
  }
  return tip;
}

// d in 1/tip = 1/d + a/n^2 + b/n^4.
double extrapolated(const std::array<int, 3>& cells, const std::array<double, 3>& tip) {
  Eigen::Matrix3d A;
  for (int k = 0; k < 3; ++k) {
    const double h2 = 1.0 / (cells[static_cast<std::size_t>(k)] * cells[static_cast<std::size_t>(k)]);
    A.row(k) << 1, h2, h2 * h2;
  }
  return 1 / A.partialPivLu().solve(Eigen::Vector3d(1 / tip[0], 1 / tip[1], 1 / tip[2]))[0];
}

constexpr double inertia = 1.0 / 12, shear_modulus = young / (2 * (1 + poisson)), shear_area = 5.0 / 6;
constexpr std::array<int, 3> cells{3, 5, 7};

// Timoshenko: F L^3/(3 E I) + F L/(kappa G A). Clamping the whole section, Poisson effect included, and the
// layout of the shear at the ends are what the formula leaves out, about (height/length)^2 = 1.5 %: it is
// that much too soft.
TEST(Cantilever, BendsUnderATipForce) {
  const double F = 1e-3;
  const auto tip = tip_deflections(cells, 2, [&](const softsim::TetrahedralMesh& mesh) {
    softsim::DeadLoad<double> load(mesh.points().size());
    load.spread(softsim::nodes_near(mesh, Side::xmax, 0), {0, 0, F});
    return load;
  });
  const double beam =
      F * std::pow(length, 3) / (3 * young * inertia) + F * length / (shear_area * shear_modulus);
  EXPECT_NEAR(extrapolated(cells, tip) / beam, 1, 0.02);
  for (std::size_t k = 0; k < 3; ++k) {
    const double excess = (beam / tip[k] - 1) * cells[k] * cells[k];
    EXPECT_GT(excess, 6) << cells[k];
    EXPECT_LT(excess, 10) << cells[k];
  }
}

// q L^4/(8 E I) + q L^2/(2 kappa G A) under the weight q per length.
TEST(Cantilever, BendsUnderItsWeight) {
  const double q = 1e-4;
  const auto tip = tip_deflections(cells, 1, [&](const softsim::TetrahedralMesh& mesh) {
    return softsim::gravity(mesh, 1, {0, -q, 0});
  });
  const double beam = q * std::pow(length, 4) / (8 * young * inertia) +
                      q * length * length / (2 * shear_area * shear_modulus);
  EXPECT_NEAR(-extrapolated(cells, tip) / beam, 1, 0.02);
}

}  // namespace beam_test
