// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/SparseCholesky>
#include <cstddef>
#include <limits>
#include <string>

#include "softsim/core/error.hpp"
#include "softsim/core/state.hpp"
#include "softsim/system/free_components.hpp"
#include "softsim/system/tangent.hpp"

namespace softsim {

/// Stiffness of `system` linearised at q on its free components, N/m.
/// @throws std::invalid_argument if q has another size, or all components are prescribed
template <class S>
[[nodiscard]] Eigen::SparseMatrix<double> stiffness_matrix(const S& system,
                                                           const State<typename S::Scalar>& q,
                                                           const FreeComponents& free) {
  if (q.size() != system.size())
    invalid(std::string("state: ") + std::to_string(q.size()) + " scalars, must be " +
            std::to_string(system.size()));
  if (free.size() == 0) invalid("system: no component is free, nothing is left to reduce");
  AssembledTangent<S> tangent;
  tangent.set(system, q, {});
  return free.matrix(tangent.matrix());
}

/// A factorised stiffness on the free components of a system.
using StiffnessFactor = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>;

/// Factorises the positive definite K. A pivot below `relative` times its diagonal entry counts as zero: 1e3
/// roundings of the scalar that K was summed in.
/// @throws std::invalid_argument naming what fails: the body is free to move, or the state is unstable
template <class Scalar = double>
void factorise_stiffness(const Eigen::SparseMatrix<double>& K, const char* what, StiffnessFactor& factor) {
  const double relative = 1e3 * static_cast<double>(std::numeric_limits<Scalar>::epsilon());
  factor.compute(K);
  const auto refuse = [&] {
    invalid(std::string(what) + ": the stiffness is not positive definite: the body must be held, and its " +
            "state stable");
  };
  if (factor.info() != Eigen::Success) refuse();
  const Eigen::VectorXd pivots = factor.vectorD(), diagonal = factor.permutationP() * K.diagonal().eval();
  for (std::ptrdiff_t k = 0; k < pivots.size(); ++k)
    if (!(pivots[k] > relative * diagonal[k])) refuse();
}

}  // namespace softsim
