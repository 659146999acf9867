// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "potential/bodies.hpp"
#include "softsim/integrator/static_solver.hpp"
#include "softsim/material/projected.hpp"
#include "softsim/material/stable_neo_hookean.hpp"
#include "softsim/mesh/selection.hpp"
#include "softsim/potential/dead_load.hpp"
#include "softsim/potential/elastic.hpp"
#include "softsim/system/system.hpp"

namespace projected_newton_test {

using softsim::Side, softsim::SpdFilter, softsim::State, softsim::Status;

const auto law = softsim::StableNeoHookean::from_young_poisson(1000, 0.45);

struct Result {
  softsim::StepReport report;
  double energy;
  State<double> q;
};

/// A beam of 3 x 1 x 1 held at x = 0 under its weight, from rest or from a start in which all its free nodes
/// lie in the plane x = 0: every tetrahedron is flat or inverted.
template <class Material>
Result solve(const Material& material, bool from_rest, int max_iterations) {
  const auto mesh = softsim::box_mesh({6, 2, 2}, {3, 1, 1});
  softsim::System system(mesh, softsim::elastic(mesh, material), softsim::gravity(mesh, 1, {0, 0, -5}));
  system.prescribed.fix(softsim::nodes_near(mesh, Side::xmin, 0));
  Result result{{}, 0, State<double>(mesh.points().size())};
  for (std::size_t i = 0; i < mesh.points().size() && !from_rest; ++i)
    result.q.point(static_cast<std::ptrdiff_t>(i))[0] = -mesh.points()[i][0];
  softsim::StaticSolver<decltype(system)> solver({.max_iterations = max_iterations, .tolerance = 1e-8});
  result.report = solver.solve(system, result.q);
  result.energy = system.energy(result.q);
  return result;
}

TEST(ProjectedNewton, RecoversFromACollapsedStartWhereThePlainHessianGetsStuck) {
  const Result expected = solve(law, true, 200);
  ASSERT_EQ(expected.report.status, Status::converged);
  for (const SpdFilter filter : {SpdFilter::clamp, SpdFilter::absolute}) {
    const Result result = solve(softsim::projected(law, filter), false, 40);
    EXPECT_EQ(result.report.status, Status::converged) << result.report.reason;
    EXPECT_LT(bodies::relative_error(result.q.displacement, expected.q.displacement), 1e-5);
  }
  // The plain one has not arrived after as many iterations; later it ends in a tangled equilibrium.
  const Result plain = solve(law, false, 40);
  EXPECT_GT(plain.energy, expected.energy + 1);
}

TEST(ProjectedNewton, NearASolutionItIsNewtonsMethod) {
  const Result plain = solve(law, true, 200), filtered = solve(softsim::projected(law), true, 200);
  EXPECT_EQ(filtered.report.status, Status::converged);
  EXPECT_LT(bodies::relative_error(filtered.q.displacement, plain.q.displacement), 1e-6);
}

// A flat body has no stiffness across its plane once negative eigenvalues are cut off: the linear solve gives
// a direction without bound, and only the preconditioned gradient leads out of the plane.
TEST(ProjectedNewton, LeavesAnExactPlane) {
  const auto mesh = softsim::box_mesh({4, 4, 4}, {1, 1, 1});
  const auto stable = softsim::StableNeoHookean::from_young_poisson(1, 0.3);
  softsim::System system(mesh, softsim::elastic(mesh, softsim::projected(stable)));
  system.prescribed.fix({0});
  for (const auto& [node, axis] : {std::pair{4, 1}, std::pair{4, 2}, std::pair{20, 2}})
    system.prescribed.set(node, axis, 0);
  State<double> q(mesh.points().size());
  for (std::size_t i = 0; i < mesh.points().size(); ++i)
    q.point(static_cast<std::ptrdiff_t>(i))[2] = -mesh.points()[i][2];
  softsim::StaticSolver<decltype(system)> solver({.tolerance = 1e-9, .verify_minimum = true});
  EXPECT_EQ(solver.solve(system, q).status, Status::converged);
  EXPECT_LT(system.energy(q), 1e-12);
}

}  // namespace projected_newton_test
