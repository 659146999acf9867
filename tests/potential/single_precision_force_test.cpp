// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>

#include "potential/bodies.hpp"
#include "softsim/material/mooney_rivlin.hpp"
#include "softsim/material/neo_hookean.hpp"
#include "softsim/material/st_venant_kirchhoff.hpp"
#include "softsim/material/stable_neo_hookean.hpp"
#include "softsim/potential/elastic.hpp"

// A fine mesh in single precision: differences of displacements lose nothing, differences of positions would
// lose the ratio of the body to an element.

namespace single_precision_force_test {

using softsim::State, softsim::Vector;

TEST(SinglePrecision, ForcesOfTwoHundredThousandTetrahedraKeepSixDigits) {
  const softsim::TetrahedralMesh mesh = softsim::box_mesh({32, 32, 32}, {1, 1, 1});
  ASSERT_EQ(mesh.tetrahedra().size(), 196608u);
  State<float> q(mesh.points().size());
  for (std::size_t i = 0; i < mesh.points().size(); ++i) {  // strains of 10 to 20 %
    const double x = mesh.points()[i][0], y = mesh.points()[i][1], z = mesh.points()[i][2];
    const bodies::Vec u(0.10 * x + 0.05 * y * z + 0.02 * std::sin(5 * y),
                        -0.05 * y + 0.08 * x * x + 0.02 * std::sin(4 * z + 1),
                        0.04 * z - 0.06 * x * y + 0.02 * std::cos(6 * x));
    q.point(static_cast<std::ptrdiff_t>(i)) = u.cast<float>();
  }
  State<double> same;
  same.displacement = q.displacement.cast<double>();
  const auto expect_six_digits = [&](const auto& law) {
    const Vector<double> f = bodies::gradient(softsim::elastic<float>(mesh, law), q).template cast<double>(),
                         exact = bodies::gradient(softsim::elastic(mesh, law), same);
    EXPECT_LT(bodies::relative_error(f, exact), 3e-6);
    EXPECT_LT((f - exact).cwiseAbs().maxCoeff(), 3e-6 * exact.cwiseAbs().maxCoeff());
  };
  expect_six_digits(softsim::NeoHookean::from_young_poisson(1e4, 0.4));
  expect_six_digits(softsim::StableNeoHookean::from_young_poisson(1e4, 0.4));
  expect_six_digits(softsim::StVenantKirchhoff::from_young_poisson(1e4, 0.4));
  expect_six_digits(softsim::MooneyRivlin::from_young_poisson(1e4, 0.4, 0.5));
}

}  // namespace single_precision_force_test
