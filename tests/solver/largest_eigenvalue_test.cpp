// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/solver/largest_eigenvalue.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>

#include "potential/bodies.hpp"
#include "softsim/material/neo_hookean.hpp"
#include "softsim/mesh/selection.hpp"
#include "softsim/potential/elastic.hpp"
#include "softsim/potential/nodal_volume.hpp"
#include "softsim/potential/spring.hpp"
#include "softsim/solver/element_eigenvalue_bound.hpp"
#include "softsim/system/tangent.hpp"

namespace largest_eigenvalue_test {

using bodies::Vec, bodies::refusal;
using softsim::EigenvalueReport, softsim::Mass, softsim::State, softsim::Status, softsim::Vector,
    softsim::element_eigenvalue_bound, softsim::largest_eigenvalue;
template <class T>
using SystemOf = softsim::System<softsim::ElasticTetrahedra<softsim::NeoHookean, T>>;
using System = SystemOf<double>;

template <class T = double>
SystemOf<T> cube(bool lumped = true, int n = 2) {
  const auto mesh = bodies::distorted_cube(n, 1);
  SystemOf<T> system(mesh, softsim::elastic<T>(mesh, softsim::NeoHookean::from_young_poisson(100, 0.4)));
  system.mass = lumped ? Mass<T>::lumped(mesh, 2) : Mass<T>::consistent(mesh, 2);
  system.prescribed.fix(softsim::nodes_near(mesh, softsim::Side::zmin, 0));
  system.prescribed.set(20, 1, 0);
  return system;
}

// From the matrices over the free components.
template <class S>
double exact(const S& system, const State<double>& q) {
  softsim::AssembledTangent<S> K, M;
  K.set(system, q, {});
  M.set(system, q, {.mass = 1, .stiffness = 0});
  const Vector<double> free = softsim::pack(system.prescribed.free());
  Eigen::MatrixXd k = K.matrix().to_eigen(), m = M.matrix().to_eigen();
  for (Eigen::Index i = 0; i < free.size(); ++i)
    if (free[i] == 0) {
      k.row(i).setZero();
      k.col(i).setZero();
      m.row(i).setZero();
      m.col(i).setZero();
      m(i, i) = 1;
    }
  return Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd>(k, m).eigenvalues().maxCoeff();
}

TEST(LargestEigenvalue, IsThatOfTheMatrices) {
  for (const bool lumped : {true, false}) {
    const System system = cube(lumped, 3);
    for (const double scale : {0.0, 0.05}) {
      const State<double> q = bodies::random_state(system.rest().size(), scale, 1);
      const double lambda = exact(system, q);
      const EigenvalueReport report = largest_eigenvalue(system, q);
      EXPECT_EQ(report.status, Status::converged);
      EXPECT_NEAR(report.value / lambda, 1, 1e-6);
      EXPECT_LE(report.value, lambda * (1 + 1e-12));      // from below
      EXPECT_GE(report.value + report.residual, lambda);  // from above
      EXPECT_LT(report.residual, 1e-4 * lambda * 1.01);   // sqrt(tolerance)
      EXPECT_GE(report.omega(), std::sqrt(lambda));
      EXPECT_LT(report.iterations, 150);
      // To the end: nothing is lost by what is not orthogonal any more.
      const EigenvalueReport sharp = largest_eigenvalue(system, q, {.tolerance = 1e-14});
      EXPECT_NEAR(sharp.value / lambda, 1, 1e-12);
      EXPECT_LT(sharp.residual, 1.1e-7 * lambda);
    }
  }
}

TEST(LargestEigenvalue, InSinglePrecision) {
  const System system = cube();
  const SystemOf<float> single = cube<float>();
  const EigenvalueReport report = largest_eigenvalue(single, State<float>(27), {.tolerance = 1e-6});
  EXPECT_EQ(report.status, Status::converged);
  EXPECT_NEAR(report.value / exact(system, State<double>(27)), 1, 1e-5);
}

TEST(LargestEigenvalue, ReportsWhatItCannotDo) {
  System system = cube();
  const State<double> rest(27);
  const EigenvalueReport few = largest_eigenvalue(system, rest, {.max_iterations = 3});
  EXPECT_EQ(few.status, Status::not_converged);
  EXPECT_EQ(few.iterations, 3);
  EXPECT_EQ(few.reason, "Lanczos: too many iterations");
  EXPECT_GT(few.residual, 0);
  State<double> broken = rest;
  broken.point(26)[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(largest_eigenvalue(system, broken).status, Status::not_finite);
  const EigenvalueReport starved =
      largest_eigenvalue(cube(false), rest, {.linear = {.max_iterations = 1, .tolerance = 1e-12}});
  EXPECT_EQ(starved.status, Status::not_converged);
  EXPECT_NE(starved.reason, "");
  for (std::int32_t i = 0; i < 27; ++i) system.prescribed.set(i, Vec::Zero());
  const EigenvalueReport held = largest_eigenvalue(system, rest);
  EXPECT_EQ(held.status, Status::converged);
  EXPECT_EQ(held.omega(), 0);
}

TEST(LargestEigenvalue, RefusesByValue) {
  System system = cube();
  const State<double> q(27);
  EXPECT_EQ(refusal([&] { return largest_eigenvalue(system, q, {.max_iterations = 0}).value; }),
            "max_iterations 0: must be at least 1");
  EXPECT_EQ(refusal([&] { return largest_eigenvalue(system, q, {.tolerance = 0}).value; }),
            "tolerance 0: must be in (0, 1)");
  EXPECT_EQ(refusal([&] { return largest_eigenvalue(system, q, {.tolerance = 1}).value; }),
            "tolerance 1: must be in (0, 1)");
  system.mass = Mass<double>(27);
  EXPECT_EQ(refusal([&] { return largest_eigenvalue(system, q).value; }),
            "node 9: mass 0 kg must be positive where it is free");
  EXPECT_EQ(refusal([&] { return element_eigenvalue_bound(system, q); }),
            // the first one in the order of storage
            "element bound: node 13 has mass 0 kg, which must be positive where it is free");
  EXPECT_EQ(refusal([&] { return element_eigenvalue_bound(cube(false), q); }),
            "element bound: the mass must be lumped");
}

// ---------------------------------------------------------------- bounds by elements

TEST(ElementBound, IsAboveTheEigenvalueAndNotByFar) {
  const auto expect = [](const auto& system, double most) {
    for (const double scale : {0.0, 0.03}) {
      const State<double> q = bodies::random_state(system.rest().size(), scale, 1);
      const double lambda = exact(system, q), bound = element_eigenvalue_bound(system, q);
      EXPECT_GE(bound, lambda);
      EXPECT_LT(bound, most * lambda);
    }
  };
  expect(cube(), 3);
  const auto mesh = bodies::distorted_cube(2, 1);
  const auto law = softsim::NeoHookean::from_young_poisson(100, 0.4);
  softsim::System springs(mesh, softsim::springs(mesh, 10));
  springs.mass = Mass<double>::lumped(mesh, 1);
  expect(springs, 3);
  softsim::System both(mesh, softsim::elastic(mesh, law), softsim::springs(mesh, 10));
  both.mass = Mass<double>::lumped(mesh, 1);
  expect(both, 4);
}

}  // namespace largest_eigenvalue_test
