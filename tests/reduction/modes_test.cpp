// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/reduction/modes.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <limits>

#include "potential/bodies.hpp"
#include "reduction/reduced_bodies.hpp"

namespace modes_test {

using bodies::refusal;
using softsim::Mass, softsim::Modes;

TEST(Modes, AreSortedAndMassNormalised) {
  auto cube = reduced_bodies::held_cube(2);
  for (const bool lumped : {true, false}) {
    cube.mass = lumped ? Mass<double>::lumped(bodies::distorted_cube(2, 1), 3)
                       : Mass<double>::consistent(bodies::distorted_cube(2, 1), 3);
    Eigen::VectorXd lambda;
    Eigen::MatrixXd x;
    reduced_bodies::eigenpairs(cube, lambda, x);
    const Modes modes = softsim::make_modes(cube.mass, lambda.reverse(), -5 * x.rowwise().reverse(), 0);
    EXPECT_EQ(modes.count(), lambda.size());
    EXPECT_LT(softsim::orthonormality_error(cube.mass, modes), 1e-12);
    for (std::ptrdiff_t k = 0; k < modes.count(); ++k)
      EXPECT_NEAR(modes.frequencies[k] * modes.frequencies[k] / lambda[k], 1, 1e-14);
    EXPECT_EQ(modes.first(3).count(), 3);
    EXPECT_EQ(modes.first(3).shapes, modes.shapes.leftCols(3));
  }
}

// 3 kg, of which the nodes at xmin are held.
TEST(Modes, EffectiveMassesSumToTheMassThatMoves) {
  const auto cube = reduced_bodies::held_cube(2);
  const Modes modes = reduced_bodies::all_modes(cube);
  const auto masses = softsim::effective_masses(cube.mass, modes);
  double moves = 0;
  for (std::ptrdiff_t k = 0; k < cube.size(); k += 4)
    if (cube.prescribed.free()[k] != 0) moves += cube.mass.diagonal()[k];
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(masses.col(axis).sum(), moves, 1e-12 * moves);
}

TEST(Modes, RefuseEigenpairsThatAreNone) {
  const auto cube = reduced_bodies::held_cube(1);
  const Eigen::MatrixXd one = Eigen::MatrixXd::Ones(cube.size(), 1);
  const auto with = [&](double lambda, const Eigen::MatrixXd& x, const Mass<double>& mass) {
    return refusal([&] { return softsim::make_modes(mass, Eigen::VectorXd::Constant(1, lambda), x, 1e-3); });
  };
  EXPECT_EQ(with(-1e-4, one, cube.mass), "");
  EXPECT_EQ(with(-1, one, cube.mass),
            "eigenpair 0: eigenvalue -1: must not be negative, the state is unstable");
  EXPECT_EQ(with(std::numeric_limits<double>::quiet_NaN(), one, cube.mass), "eigenpair 0: must be finite");
  EXPECT_EQ(with(1, 0 * one, cube.mass), "eigenpair 0: the vector carries no mass");
  EXPECT_EQ(with(1, one, Mass<double>(8)), "eigenpair 0: the vector carries no mass");
  EXPECT_EQ(with(1, one.topRows(4), cube.mass), "modes: vectors are 4 x 1, must be 32 x 1");
  EXPECT_EQ(refusal([&] { return softsim::make_modes(cube.mass, Eigen::VectorXd(), Eigen::MatrixXd(), 0); }),
            "modes: no eigenpair");
  EXPECT_EQ(refusal([&] { return reduced_bodies::all_modes(cube).first(13); }),
            "modes 13: must lie in [1, 12]");
}

}  // namespace modes_test
