// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "material/tetrahedron_reference.hpp"
#include "softsim/core/tensor.hpp"

/// More laws on the tetrahedra of tetrahedron_reference.hpp, also in 50 digits.
namespace tetrahedron_reference {

/// w = c1 (I1 J^-2/3 - 3) + c2 (I2 J^-4/3 - 3) + kappa/2 (J - 1)^2, Pa.
inline constexpr double c1 = 120, c2 = 30, kappa = 600;

// clang-format off
/// Mooney-Rivlin, case by case.
inline constexpr std::array<Result, 5> mooney_rivlin{{
  {true, 3.3942865003753613, {{{0.9510474548416109, -9.529592619209522, 26.230991884300796},
   {-9.93945968354832, 2.4433394115184908, -24.43535550846386},
   {0.29728074898733703, -2.6457111576539676, 3.224332031023626},
   {8.69113147971937, 9.731964365345, -5.019968406860562}}}},
  {true, 72.15242216110148, {{{21.178837534312265, 21.178837534312265, -351.19225022874843},
   {-21.178837534312265, 0, 0},
   {0, -21.178837534312265, 0},
   {0, 0, 351.19225022874843}}}},
  {true, 0, {}},
  {true, 0.031504991090089744, {{{-4.543430687799493, -2.827783412100998, -17.949632235703202},
   {-4.827502436710257, -2.98446181082934, -18.072009906310154},
   {4.539137588232934, 3.001095958585712, 18.003649453032185},
   {4.831795536276816, 2.811149264344626, 18.01799268898117}}}},
  {}}};

/// Neo-Hookean with its function of J continued quadratically below J0 = 0.4.
inline constexpr std::array<Result, 5> continued_neo_hookean{{
  {true, 3.480865217704804, {{{3.2621058123904043, -10.024502732375101, 25.69651930758675},
   {-9.960366425961707, 1.9706235378025312, -25.030254237422437},
   {-1.173643952788938, -0.5107212613150109, 4.063705874314119},
   {7.871904566360241, 8.56460045588758, -4.729970944478434}}}},
  {true, 84.37711132696398, {{{-66.64317074213469, -66.64317074213469, -373.810569140449},
   {66.64317074213469, 0, 0},
   {0, 66.64317074213469, 0},
   {0, 0, 373.810569140449}}}},
  {true, 0, {}},
  {true, 0.030985104688964336, {{{-5.136457074437828, -3.1586094325836407, -16.76552597613695},
   {-5.384763985714642, -3.269527971429121, -16.908365414255172},
   {5.131669394588908, 3.2847293565939446, 16.826592132304565},
   {5.389551665563563, 3.1434080474188173, 16.84729925808756}}}},
  {true, 248.76323329173908, {{{50.0, 50.0, -722.0969106247184},
   {-50.0, 0, 0},
   {0, -50.0, 0},
   {0, 0, 722.0969106247184}}}}}};
// clang-format on

/// Energy and forces of one tetrahedron under `law` against the numbers of `expected`.
template <class Law>
void expect_tetrahedron(const Law& law, const Case& c, const Result& expected) {
  if (!expected.defined) return;
  SCOPED_TRACE(c.name);
  softsim::Mat3<double> rest, now;
  for (int i = 0; i < 3; ++i)
    for (int a = 0; a < 3; ++a) {
      const auto v = static_cast<std::size_t>(i) + 1, row = static_cast<std::size_t>(a);
      rest(a, i) = c.rest[v][row] - c.rest[0][row];
      now(a, i) = c.now[v][row] - c.now[0][row];
    }
  const softsim::Mat3<double> F = now * rest.inverse();
  const double volume = std::abs(rest.determinant()) / 6;
  Eigen::Matrix<double, 3, 4> gradients;  // of the four shape functions
  gradients.rightCols<3>() = rest.inverse().transpose();
  gradients.col(0) = -gradients.rightCols<3>().rowwise().sum();
  const Eigen::Matrix<double, 3, 4> forces = -volume * law.first_piola(F) * gradients;
  // where the result is zero, rounding of the terms that cancel in it
  const double rounding = 1e-14 * (lambda + 2 * mu) * volume;
  EXPECT_NEAR(volume * law.energy_density(F), expected.energy, c.tolerance * expected.energy + rounding);
  double largest = 0;
  for (const auto& f : expected.forces)
    for (const double component : f) largest = std::max(largest, std::abs(component));
  const double tolerance = c.tolerance * largest + rounding * gradients.cwiseAbs().maxCoeff();
  for (int n = 0; n < 4; ++n)
    for (int a = 0; a < 3; ++a)
      EXPECT_NEAR(forces(a, n), expected.forces[static_cast<std::size_t>(n)][static_cast<std::size_t>(a)],
                  tolerance)
          << "vertex " << n << " component " << a;
}

}  // namespace tetrahedron_reference
