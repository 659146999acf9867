// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/ext/spectra.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "potential/bodies.hpp"
#include "reduction/reduced_bodies.hpp"
#include "softsim/material/linear_elastic.hpp"
#include "softsim/mesh/quadratic_tetrahedral_mesh.hpp"
#include "softsim/mesh/selection.hpp"
#include "softsim/potential/quadrature.hpp"

namespace spectra_test {

using bodies::refusal;
using softsim::LinearReport, softsim::Mass, softsim::Modes, softsim::State, softsim::Status;

void expect_those_of_dense_solver(const reduced_bodies::System& system, std::ptrdiff_t count) {
  Modes modes;
  const LinearReport report =
      softsim::lowest_modes(system, State<double>(system.rest().size()), count, modes);
  ASSERT_EQ(report.status, Status::converged) << report.reason;
  EXPECT_LT(report.residual, 1e-8);  // the shift of 1e-8 costs eight of sixteen digits
  EXPECT_LT(softsim::orthonormality_error(system.mass, modes), 1e-8);
  Eigen::VectorXd lambda;
  Eigen::MatrixXd x;
  reduced_bodies::eigenpairs(system, lambda, x);
  const double largest = lambda.tail(1)[0];
  for (std::ptrdiff_t k = 0; k < count; ++k)
    EXPECT_NEAR(modes.frequencies[k] * modes.frequencies[k], lambda[k], 1e-8 * lambda[k] + 1e-12 * largest);
}

TEST(Spectra, FindsTheModesOfAHeldBody) {
  auto cube = reduced_bodies::held_cube(3);
  expect_those_of_dense_solver(cube, 10);
  cube.mass = Mass<double>::consistent(bodies::distorted_cube(3, 1), 3);
  expect_those_of_dense_solver(cube, 10);
}

TEST(Spectra, FindsAllButOneMode) { expect_those_of_dense_solver(reduced_bodies::held_cube(1), 11); }

TEST(Spectra, AFreeBodyHasSixRigidModes) {
  const softsim::TetrahedralMesh mesh = bodies::distorted_cube(3, 1);
  auto cube = reduced_bodies::body(mesh);
  for (const bool lumped : {true, false}) {
    cube.mass = lumped ? Mass<double>::lumped(mesh, 3) : Mass<double>::consistent(mesh, 3);
    expect_those_of_dense_solver(cube, 9);
    Modes modes;
    ASSERT_EQ(softsim::lowest_modes(cube, State<double>(mesh.points().size()), 9, modes).status,
              Status::converged);
    EXPECT_EQ(modes.frequencies.head(6).norm(), 0);
    EXPECT_GT(modes.frequencies[6], 1);
    const auto masses = softsim::effective_masses(cube.mass, modes.first(6));
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(masses.col(axis).sum(), cube.mass.total(), 1e-8 * cube.mass.total());
  }
}

// refcases S4.6: 1 x 0.1 x 0.1 m, steel, clamped at one end. Reference by 40 x 4 x 4 quadratic hexahedra of
// another code: bending 81.592, 489.34 and 1288.5 Hz, each twice, torsion 722.9, axial 1269.9 Hz.
TEST(Spectra, FrequenciesOfACantilever) {
  const softsim::QuadraticTetrahedralMesh mesh(softsim::box_mesh({20, 3, 3}, {1, 0.1, 0.1}));
  softsim::System system(mesh, softsim::elastic(mesh, softsim::LinearElastic::from_young_poisson(2e11, 0.3)));
  system.mass = Mass<double>::consistent(mesh, 7800);
  system.prescribed.fix(softsim::nodes_near(mesh, softsim::Side::xmin, 0));
  Modes modes;
  const LinearReport report = softsim::lowest_modes(system, State<double>(mesh.points().size()), 8, modes);
  ASSERT_EQ(report.status, Status::converged) << report.reason;
  const double reference[] = {81.592, 81.592, 489.34, 489.34, 722.9, 1269.9, 1288.5, 1288.5};
  for (int k = 0; k < 8; ++k) {
    const double f = modes.frequencies[k] / (2 * std::numbers::pi);
    EXPECT_NEAR(f / reference[k], 1, 0.01) << f;
    RecordProperty("mode_" + std::to_string(k) + "_Hz", std::to_string(f));
  }
}

TEST(Spectra, FailureIsReportedAndLeavesTheModesAlone) {
  const auto cube = reduced_bodies::held_cube(2);
  Modes modes;
  const State<double> rest(cube.rest().size());
  EXPECT_EQ(
      softsim::lowest_modes(cube, rest, 4, modes, {.tolerance = 1e-14, .max_iterations = 1, .subspace = 5})
          .status,
      Status::not_converged);
  const LinearReport above = softsim::lowest_modes(cube, rest, 4, modes, {.shift = 1e4});
  EXPECT_EQ(above.status, Status::not_converged);
  EXPECT_EQ(above.reason, "modes: an eigenvalue lies below the shift (an unstable state?)");
  EXPECT_EQ(modes.count(), 0);
}

TEST(Spectra, RefusesWhatHasNoModes) {
  auto cube = reduced_bodies::held_cube(1);
  Modes modes;
  const auto with = [&](std::ptrdiff_t count, const softsim::SpectraOptions& options = {}) {
    return refusal([&] {
      return softsim::lowest_modes(cube, State<double>(cube.rest().size()), count, modes, options);
    });
  };
  EXPECT_EQ(with(0), "modes 0: must be at least 1 and below 12, the number of free components");
  EXPECT_EQ(with(12), "modes 12: must be at least 1 and below 12, the number of free components");
  EXPECT_EQ(with(3, {.tolerance = 0}), "tolerance 0: must be positive");
  cube.mass = Mass<double>(8);
  EXPECT_EQ(with(3), "node 1: has no mass");
}

}  // namespace spectra_test
