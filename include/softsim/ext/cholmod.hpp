// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/CholmodSupport>
#include <concepts>

#include "softsim/solver/direct.hpp"

namespace softsim {

/// Supernodal L L^T by CHOLMOD, in double, for positive definite operators: the fastest direct solver here
/// for more than a few thousand nodes. Used like `Llt`: StaticSolver<S, Assembled, CholmodLlt>. Needs
/// SuiteSparse (target softsim::cholmod, or -lcholmod and its include folder).
template <class T>
requires std::same_as<T, double>
using CholmodLlt = Direct<T, Eigen::CholmodSupernodalLLT<Eigen::SparseMatrix<T>, Eigen::Lower>>;

}  // namespace softsim
