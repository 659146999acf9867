// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/reduction/pod.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "potential/bodies.hpp"
#include "reduction/reduced_bodies.hpp"
#include "softsim/concepts.hpp"
#include "softsim/integrator/implicit.hpp"
#include "softsim/integrator/static_solver.hpp"
#include "softsim/material/neo_hookean.hpp"
#include "softsim/reduction/reduced_newton.hpp"

namespace pod_test {

using bodies::Vec, bodies::refusal, bodies::relative_error;
using softsim::Mass, softsim::Motion, softsim::PodBasis, softsim::ReducedNewton, softsim::ReducedReport,
    softsim::State, softsim::Status, softsim::Vector;
using Matrix = Eigen::MatrixXd;
template <class T>
using SystemOf = softsim::System<softsim::ElasticTetrahedra<softsim::NeoHookean, T>, softsim::DeadLoad<T>>;
using System = SystemOf<double>;

static_assert(softsim::Integrator<ReducedNewton<System>, System>);

const double nan = std::numeric_limits<double>::quiet_NaN();

// ---------------------------------------------------------------- bases

// Snapshots of three vectors with given strengths and random mixtures.
Matrix snapshots(std::ptrdiff_t count, const Vec& strength) {
  bodies::Random random(4);
  Matrix X(32, count);
  Matrix three(32, 3);
  for (std::uint64_t k = 0; k < 3; ++k)
    three.col(static_cast<std::ptrdiff_t>(k)) = bodies::random_vector(8, 1, k + 1);
  for (std::ptrdiff_t j = 0; j < count; ++j) X.col(j) = three * strength.cwiseProduct(random.vec());
  return X;
}

double best_error(const Matrix& X, const Matrix& V, const Matrix& MV) {
  return (X - V * (MV.transpose() * X)).norm();
}

TEST(Pod, KeepsWhatTheSingularValuesSay) {
  const Matrix X = snapshots(10, {1, 0.1, 1e-3});
  const PodBasis all = softsim::pod(X, {.energy = 1});
  ASSERT_EQ(all.vectors.cols(), 3);  // the rank, not ten
  EXPECT_NEAR(all.energy_kept, 1, 1e-15);
  EXPECT_LT(best_error(X, all.vectors, all.vectors), 1e-13);
  const double total = all.singular_values.squaredNorm();
  for (std::ptrdiff_t r = 1; r <= 2; ++r) {
    const PodBasis basis = softsim::pod(X, {.energy = 1, .max_vectors = r});
    ASSERT_EQ(basis.vectors.cols(), r);
    EXPECT_LT((basis.vectors.transpose() * basis.vectors - Matrix::Identity(r, r)).norm(), 1e-14);
    const double dropped = all.singular_values.tail(10 - r).norm();  // Eckart and Young
    EXPECT_NEAR(best_error(X, basis.vectors, basis.vectors), dropped, 1e-10 * dropped + 1e-14);
    EXPECT_NEAR(1 - basis.energy_kept, dropped * dropped / total, 1e-14);
  }
  EXPECT_EQ(softsim::pod(X, {.energy = 0.5}).vectors.cols(), 1);
  EXPECT_EQ(softsim::pod(X).vectors.cols(), 2);
}

TEST(Pod, WeightedBasesAreMassOrthonormalAndBestInItsNorm) {
  const softsim::TetrahedralMesh mesh = bodies::distorted_cube(1, 1);
  const Matrix X = snapshots(6, {1, 0.1, 1e-3});
  for (const bool lumped : {true, false}) {
    const Mass<double> mass = lumped ? Mass<double>::lumped(mesh, 3) : Mass<double>::consistent(mesh, 3);
    const auto times = [&](const Matrix& A) { return softsim::detail::mass_times(mass, A); };
    for (std::ptrdiff_t r = 1; r <= 3; ++r) {
      const PodBasis basis = softsim::pod(X, mass, {.energy = 1, .max_vectors = r});
      ASSERT_EQ(basis.vectors.cols(), r);
      const Matrix MV = times(basis.vectors);
      EXPECT_LT((basis.vectors.transpose() * MV - Matrix::Identity(r, r)).norm(), 1e-12);
      const Matrix R = X - basis.vectors * (MV.transpose() * X);
      const double error = std::sqrt((R.transpose() * times(R)).trace());
      EXPECT_NEAR(error, basis.singular_values.tail(6 - r).norm(), r == 3 ? 1e-7 : 1e-4 * error) << r;
    }
  }
}

TEST(Pod, RefusesWhatIsNoSetOfSnapshots) {
  const Matrix X = snapshots(4, {1, 1, 1});
  EXPECT_EQ(refusal([&] { return softsim::pod(Matrix(32, 0)); }), "pod: no snapshots");
  EXPECT_EQ(refusal([&] { return softsim::pod(0 * X); }), "pod: all snapshots are zero");
  EXPECT_EQ(refusal([&] { return softsim::pod(nan * X); }), "pod: snapshots must be finite");
  EXPECT_EQ(refusal([&] { return softsim::pod(X, {.energy = 0}); }), "energy 0: must lie in (0, 1]");
  EXPECT_EQ(refusal([&] { return softsim::pod(X, {.energy = 1, .max_vectors = 5}); }),
            "max_vectors 5: must lie in [0, 4], the smaller of unknowns and snapshots");
  EXPECT_EQ(refusal([&] { return softsim::pod(X, Mass<double>(8)); }), "node 0: moves, but has no mass");
  EXPECT_EQ(refusal([&] { return softsim::pod(X, Mass<double>(7)); }), "pod: mass of 28 scalars, must be 32");
}

// ---------------------------------------------------------------- reduced solves

// A bar of 4 x 1 x 1 m, fixed at one end, that a force on the other end bends far.
template <class T>
SystemOf<T> bar() {
  const softsim::TetrahedralMesh mesh = softsim::box_mesh({8, 2, 2}, {4, 1, 1});
  SystemOf<T> system(mesh, softsim::elastic<T>(mesh, softsim::NeoHookean::from_young_poisson(1000, 0.3)),
                     softsim::DeadLoad<T>(mesh.points().size()));
  system.mass = Mass<T>::lumped(mesh, 3);
  system.prescribed.fix(softsim::nodes_near(mesh, softsim::Side::xmin, 0));
  return system;
}
template <class T>
void load(SystemOf<T>& system, double force) {
  const softsim::TetrahedralMesh mesh = softsim::box_mesh({8, 2, 2}, {4, 1, 1});
  std::get<1>(system.terms) = softsim::DeadLoad<T>(mesh.points().size());
  std::get<1>(system.terms).spread(softsim::nodes_near(mesh, softsim::Side::xmax, 0), {0, 0, force});
}

State<double> equilibrium(System& system, double force) {
  load(system, force);
  State<double> q(system.rest().size());
  EXPECT_EQ(softsim::StaticSolver<System>({.tolerance = 1e-9}).solve(system, q).status, Status::converged);
  return q;
}

// Snapshots of the bar under eight forces up to 12 N.
Matrix bent_bars(System& system) {
  Matrix X(system.size(), 8);
  for (int k = 0; k < 8; ++k) X.col(k) = equilibrium(system, 1.5 * (k + 1)).displacement;
  return X;
}

TEST(ReducedNewton, WithTheAnswerInItsSpanFindsIt) {
  System system = bar<double>();
  const Matrix X = bent_bars(system);
  ReducedNewton<System> reduced(system, softsim::pod(X, {.energy = 1}).vectors, {.tolerance = 1e-10});
  load(system, 6);
  State<double> q(system.rest().size());
  const ReducedReport report = reduced.solve(system, q);
  ASSERT_EQ(report.status, Status::converged) << report.reason;
  EXPECT_LT(relative_error(q.displacement, Vector<double>(X.col(3))), 1e-7);
  EXPECT_LT(report.full_residual, 1e-6);
}

// A force between and one beyond those of the snapshots, by bases of growing size.
TEST(ReducedNewton, TheErrorFallsWithTheBasis) {
  System system = bar<double>();
  const Matrix X = bent_bars(system);
  for (const double force : {8.25, 13.5}) {
    const State<double> full = equilibrium(system, force);
    EXPECT_GT(full.displacement.cwiseAbs().maxCoeff(), 0.8);
    double last = 1, last_residual = 1e9;
    for (const std::ptrdiff_t r : {1, 2, 3, 5}) {
      ReducedNewton<System> reduced(system, softsim::pod(X, {.energy = 1, .max_vectors = r}).vectors,
                                    {.tolerance = 1e-6});
      State<double> q(system.rest().size());
      const ReducedReport report = reduced.solve(system, q);
      ASSERT_EQ(report.status, Status::converged) << report.reason;
      const double error = relative_error(q.displacement, full.displacement);
      RecordProperty("error_" + std::to_string(r) + (force < 12 ? "_in" : "_out"),
                     std::to_string(error * 1e6));
      RecordProperty("residual_" + std::to_string(r) + (force < 12 ? "_in" : "_out"),
                     std::to_string(report.full_residual * 1e6));
      EXPECT_LT(error, last);
      EXPECT_LT(report.full_residual, last_residual);
      last = error;
      last_residual = report.full_residual;
    }
    EXPECT_LT(last, force < 12 ? 1e-5 : 1e-3);
  }
}

// With a basis of all free components it is the full Newton method.
TEST(ReducedNewton, WithAWholeBasisIsBackwardEuler) {
  const softsim::TetrahedralMesh mesh = bodies::distorted_cube(2, 1);
  System system(mesh, softsim::elastic(mesh, softsim::NeoHookean::from_young_poisson(1000, 0.3)),
                softsim::gravity(mesh, 3, {5, 0, -30}));
  system.mass = Mass<double>::consistent(mesh, 3);
  system.damping = {.alpha = 1, .beta = 0.001};
  system.prescribed.fix(softsim::nodes_near(mesh, softsim::Side::xmin, 0));
  const softsim::FreeComponents free(system.prescribed);
  Matrix basis = Matrix::Zero(system.size(), free.size());
  for (std::ptrdiff_t k = 0; k < free.size(); ++k) basis(free.flat(k), k) = 2;
  ReducedNewton<System> reduced(system, basis, {.dt = 0.02, .tolerance = 1e-10});
  ReducedNewton<System, softsim::MatrixFree> matrix_free(system, basis, {.dt = 0.02, .tolerance = 1e-10});
  softsim::BackwardEuler<System> full({.dt = 0.02, .newton = true, .tolerance = 1e-10});
  Motion<double> x(27), y(27), z(27);
  x.v = y.v = z.v = bodies::random_vector(27, 0.2, 3).cwiseProduct(system.prescribed.free());
  for (int k = 0; k < 5; ++k) {
    ASSERT_EQ(full.step(system, x).status, Status::converged);
    const ReducedReport report = reduced.step(system, y);
    ASSERT_EQ(report.status, Status::converged) << report.reason;
    EXPECT_NEAR(report.residual, report.full_residual, 1e-12);
    ASSERT_EQ(matrix_free.step(system, z).status, Status::converged);
    EXPECT_LT(relative_error(y.q.displacement, x.q.displacement), 1e-8);
    EXPECT_LT(relative_error(y.v, x.v), 1e-7);
    EXPECT_LT(relative_error(z.q.displacement, y.q.displacement), 1e-9);
  }
  EXPECT_EQ(y.time, x.time);
}

TEST(ReducedNewton, SwingsLikeTheFullMotion) {
  System system = bar<double>();
  load(system, 6);
  const double h = 0.05;
  softsim::BackwardEuler<System> full({.dt = h, .newton = true, .tolerance = 1e-8});
  Motion<double> motion(system.rest().size());
  Matrix X(system.size(), 40);
  for (int k = 0; k < 40; ++k) {
    ASSERT_EQ(full.step(system, motion).status, Status::converged);
    X.col(k) = motion.q.displacement;
  }
  const PodBasis basis = softsim::pod(X, system.mass, {.energy = 0.999999});
  RecordProperty("vectors", static_cast<int>(basis.vectors.cols()));
  EXPECT_LE(basis.vectors.cols(), 6);
  ReducedNewton<System> reduced(system, basis.vectors, {.dt = h});
  Motion<double> y(system.rest().size());
  double error = 0;
  for (int k = 0; k < 40; ++k) {
    const ReducedReport report = reduced.step(system, y);
    ASSERT_EQ(report.status, Status::converged) << report.reason;
    error += (y.q.displacement - X.col(k)).squaredNorm();
  }
  RecordProperty("error_1e6", std::to_string(std::sqrt(error) / X.norm() * 1e6));
  EXPECT_LT(std::sqrt(error) / X.norm(), 0.01);
}

TEST(ReducedNewton, WorksInSinglePrecision) {
  System system = bar<double>();
  const Matrix X = bent_bars(system);
  auto small = bar<float>();
  load(small, 6);
  ReducedNewton<SystemOf<float>> reduced(small, softsim::pod(X, {.energy = 1, .max_vectors = 4}).vectors,
                                         {.tolerance = 1e-4});
  State<float> q(small.rest().size());
  const ReducedReport report = reduced.solve(small, q);
  ASSERT_EQ(report.status, Status::converged) << report.reason;
  EXPECT_LT(relative_error(q.displacement, Vector<double>(X.col(3))), 1e-3);
}

TEST(ReducedNewton, FailureIsReportedAndLeavesFiniteNumbers) {
  System system = bar<double>(), other = bar<double>();
  Matrix basis = Matrix::Zero(system.size(), 1);
  basis(system.size() - 2, 0) = 1;
  ReducedNewton<System> reduced(system, basis, {.max_iterations = 1});
  load(system, 1e4);
  State<double> q(system.rest().size());
  const ReducedReport stopped = reduced.solve(system, q);
  EXPECT_EQ(stopped.status, Status::not_converged);
  EXPECT_TRUE(q.displacement.allFinite());
  Motion<double> motion(system.rest().size());
  EXPECT_EQ(reduced.step(system, motion).reason, "reduced Newton: dt is 0, no step was set");
  State<double> broken(system.rest().size());
  broken.displacement[100] = nan;
  EXPECT_EQ(reduced.solve(system, broken).status, Status::not_finite);
  EXPECT_EQ(reduced.solve(other, q).reason, "reduced Newton: the basis is that of another system");
  system.prescribed.set(0, 0, 0.1);
  EXPECT_EQ(reduced.solve(system, q).reason, "reduced Newton: prescribed components are not in place");
}

TEST(ReducedNewton, RefusesBasesThatDoNotFit) {
  const System system = bar<double>();
  const auto with = [&](const Matrix& basis, const softsim::ReducedNewtonOptions& options = {}) {
    return refusal([&] { return ReducedNewton<System>(system, basis, options); });
  };
  Matrix basis = Matrix::Zero(system.size(), 2);
  basis(4, 0) = basis(4, 1) = 1;
  EXPECT_EQ(with(basis), "basis: column 1 depends on those before it");
  EXPECT_EQ(with(0 * basis), "basis: a column is zero");
  EXPECT_EQ(with(basis.leftCols(0)), "basis: 324 x 0, must have 324 rows and 1 to 216 columns");
  EXPECT_EQ(with(Matrix::Zero(324, 217)), "basis: 324 x 217, must have 324 rows and 1 to 216 columns");
  EXPECT_EQ(with(basis.topRows(8)), "basis: 8 x 2, must have 324 rows and 1 to 216 columns");
  EXPECT_EQ(with(basis.leftCols(1), {.tolerance = 0}), "tolerance 0: must be positive");
  EXPECT_EQ(with(basis.leftCols(1), {.dt = -1}), "dt -1 s: must not be negative, and finite");
  EXPECT_EQ(with(basis.leftCols(1), {.max_iterations = 0}), "max_iterations 0: must be at least 1");
  basis(0, 0) = 1;
  EXPECT_EQ(with(basis.leftCols(1)), "basis: node 0: a column moves a prescribed component");
}

}  // namespace pod_test
