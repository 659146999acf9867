// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include "softsim/solver/incomplete_cholesky.hpp"
#include "softsim/solver/preconditioner.hpp"
#include "softsim/system/tangent.hpp"

namespace softsim {

/// The preconditioner that solvers and integrators take if none is chosen: `type<T>`. It needs no options and
/// works for any tangent; which one is fastest for a scene is charted in BENCHMARKS.md.
template <class Operator>
struct DefaultPreconditioner {
  template <class T>
  using type = BlockJacobi<T>;
};
template <>
struct DefaultPreconditioner<Assembled> {
  template <class T>
  using type = IncompleteCholesky<T>;
};

}  // namespace softsim
