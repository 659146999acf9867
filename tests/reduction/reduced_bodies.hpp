// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Eigenvalues>

#include "potential/bodies.hpp"
#include "softsim/material/st_venant_kirchhoff.hpp"
#include "softsim/mesh/selection.hpp"
#include "softsim/potential/dead_load.hpp"
#include "softsim/potential/elastic.hpp"
#include "softsim/reduction/linearised.hpp"
#include "softsim/reduction/modes.hpp"
#include "softsim/system/system.hpp"

/// Systems and dense eigenpairs that the tests of this room share.
namespace reduced_bodies {

using System =
    softsim::System<softsim::ElasticTetrahedra<softsim::StVenantKirchhoff>, softsim::DeadLoad<double>>;

/// A body of tetrahedra, E = 1000 Pa, nu = 0.3, 3 kg/m^3, with a load that is still zero.
inline System body(const softsim::TetrahedralMesh& mesh) {
  System system(mesh, softsim::elastic(mesh, softsim::StVenantKirchhoff::from_young_poisson(1000, 0.3)),
                softsim::DeadLoad<double>(mesh.points().size()));
  system.mass = softsim::Mass<double>::lumped(mesh, 3);
  return system;
}
/// A distorted unit cube of n^3 cells, fixed at xmin.
inline System held_cube(int n) {
  const softsim::TetrahedralMesh mesh = bodies::distorted_cube(n, 1);
  System system = body(mesh);
  system.prescribed.fix(softsim::nodes_near(mesh, softsim::Side::xmin, 0));
  return system;
}

/// All eigenpairs at rest, ascending, as flat vectors, by Eigen's dense solver.
template <class S>
void eigenpairs(const S& system, Eigen::VectorXd& lambda, Eigen::MatrixXd& vectors) {
  const softsim::FreeComponents free(system.prescribed);
  const Eigen::MatrixXd K = softsim::stiffness_matrix(
                            system, softsim::State<typename S::Scalar>(system.rest().size()), free),
                        M = free.matrix(system.mass);
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(K, M);
  lambda = solver.eigenvalues();
  vectors.resize(free.flat_size(), lambda.size());
  for (std::ptrdiff_t k = 0; k < lambda.size(); ++k)
    free.scatter(solver.eigenvectors().col(k), vectors.col(k));
}
/// All modes at rest.
template <class S>
softsim::Modes all_modes(const S& system) {
  Eigen::VectorXd lambda;
  Eigen::MatrixXd vectors;
  eigenpairs(system, lambda, vectors);
  return softsim::make_modes(system.mass, lambda, vectors, 1e-11 * lambda.tail(1)[0]);
}

}  // namespace reduced_bodies
