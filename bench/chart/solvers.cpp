// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <memory>

#include "softsim/integrator/static_solver.hpp"
#include "softsim/solver/direct.hpp"
#include "softsim/solver/incomplete_cholesky.hpp"
#include "softsim/solver/multigrid.hpp"
#include "softsim/solver/stationary.hpp"
#include "solve.hpp"

namespace chart {
namespace {

using namespace softsim;

template <class T, class Operator, template <class> class Preconditioner, class Method>
Solve<T> solve_with(int load_steps) {
  using Statics = StaticSolver<AnySystem<T>, Operator, Preconditioner, Method>;
  // single precision ends where its forces round
  const double tolerance = std::is_same_v<T, double> ? 1e-7 : 1e-4;
  const auto statics = std::make_shared<Statics>(
      NewtonOptionsFor<Method>{.max_iterations = 60, .tolerance = tolerance}, LoadSteps{.steps = load_steps});
  return [statics](const Discrete<T>& d, State<T>& q) { return statics->solve(d.system, q); };
}

template <class Operator, template <class> class Preconditioner, class Method = ConjugateGradient>
Solver solver(const std::string& name, const std::string& preconditioner) {
  return {name, preconditioner, solve_with<double, Operator, Preconditioner, Method>,
          solve_with<float, Operator, Preconditioner, Method>};
}

}  // namespace

std::vector<Solver> solvers() {
  return {solver<Assembled, Ldlt, Stationary>("ldlt", "-"),
          solver<Assembled, BlockJacobi>("cg", "block_jacobi"),
          solver<Assembled, IncompleteCholesky>("cg", "incomplete_cholesky"),
          solver<Assembled, Multigrid>("cg", "multigrid"),
          solver<MatrixFree, BlockJacobi>("cg_matrix_free", "block_jacobi")};
}

}  // namespace chart
