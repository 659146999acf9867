// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Spectra/MatOp/SparseSymMatProd.h>
#include <Spectra/SymGEigsShiftSolver.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <exception>
#include <limits>
#include <string>

#include "softsim/core/error.hpp"
#include "softsim/core/state.hpp"
#include "softsim/reduction/linearised.hpp"
#include "softsim/reduction/modes.hpp"
#include "softsim/solver/report.hpp"
#include "softsim/system/free_components.hpp"

namespace softsim {

/// Options of `lowest_modes`.
struct SpectraOptions {
  /// Eigenvalues nearest to this shift are sought, (rad/s)^2; it must lie below the lowest. Not a number: a
  /// small negative one, 1e-8 of the largest diagonal ratio K_ii / M_ii (1e-4 in single precision), which
  /// suits held and free bodies.
  double shift = std::numeric_limits<double>::quiet_NaN();
  double tolerance = 1e-10;  ///< relative, on the shifted and inverted eigenvalues
  int max_iterations = 1000;
  std::ptrdiff_t subspace = 0;  ///< Lanczos vectors, more than the number of modes; 0: 2 m + 20
};

namespace detail {

// y = (K - sigma M)^-1 x for Spectra, by Eigen's sparse Cholesky.
class ShiftInvert {
 public:
  using Scalar = double;
  ShiftInvert(const Eigen::SparseMatrix<double>& K, const Eigen::SparseMatrix<double>& M) : K_(K), M_(M) {}
  [[nodiscard]] Eigen::Index rows() const { return K_.rows(); }
  [[nodiscard]] Eigen::Index cols() const { return K_.cols(); }
  void set_shift(double sigma) { factor_.compute(Eigen::SparseMatrix<double>(K_ - sigma * M_)); }
  void perform_op(const double* x, double* y) const {
    Eigen::Map<Eigen::VectorXd>(y, rows()) = factor_.solve(Eigen::Map<const Eigen::VectorXd>(x, rows()));
  }
  // True if K - sigma M is positive definite.
  [[nodiscard]] bool definite() const {
    return factor_.info() == Eigen::Success && factor_.vectorD().minCoeff() > 0;
  }

 private:
  const Eigen::SparseMatrix<double>&K_, &M_;
  StiffnessFactor factor_;
};

}  // namespace detail

/// The `count` lowest modes, K x = lambda M x, of `system` linearised at q, M lumped or consistent, by shift
/// and invert with Spectra's Lanczos solver. Free bodies are welcome: their rigid motions come first, with
/// frequency 0. `modes` is set if the status is `converged`; the residual is the largest |K x - lambda M x|
/// over |M x| and the largest diagonal ratio K_ii / M_ii. Allocates.
/// @throws std::invalid_argument if q has another size, count is below 1 or not below the number of free
///   components, a node that is free to move has no mass, a tolerance is not positive
template <class S>
LinearReport lowest_modes(const S& system, const State<typename S::Scalar>& q, std::ptrdiff_t count,
                          Modes& modes, const SpectraOptions& options = {}) {
  const FreeComponents free(system.prescribed);
  const Eigen::SparseMatrix<double> K = stiffness_matrix(system, q, free);
  const std::ptrdiff_t n = free.size();
  if (count < 1 || count >= n)
    invalid(std::string("modes ") + std::to_string(count) + ": must be at least 1 and below " +
            std::to_string(n) + ", the number of free components");
  if (!(options.tolerance > 0))
    invalid(std::string("tolerance ") + to_text(options.tolerance) + ": must be positive");
  const Eigen::SparseMatrix<double> M = free.matrix(system.mass);
  double largest = 0;
  for (std::ptrdiff_t k = 0; k < n; ++k) {
    const double m = M.coeff(k, k);
    if (!(m > 0))
      invalid(std::string("node ") + std::to_string(free.flat(k) / block_stride) + ": has no mass");
    largest = std::max(largest, K.coeff(k, k) / m);
  }
  const bool single = sizeof(typename S::Scalar) == sizeof(float);
  const double sigma = std::isnan(options.shift) ? -(single ? 1e-4 : 1e-8) * largest : options.shift;
  const std::ptrdiff_t subspace =
      std::clamp(options.subspace > 0 ? options.subspace : 2 * count + 20, count + 1, n);
  LinearReport report;
  try {
    detail::ShiftInvert inverse(K, M);
    inverse.set_shift(sigma);
    if (!inverse.definite())
      return detail::ended(report, Status::not_converged,
                           "modes: an eigenvalue lies below the shift (an unstable state?)");
    Spectra::SparseSymMatProd<double> product(M);
    Spectra::SymGEigsShiftSolver<detail::ShiftInvert, Spectra::SparseSymMatProd<double>,
                                 Spectra::GEigsMode::ShiftInvert>
        solver(inverse, product, count, subspace, sigma);
    solver.init();
    const auto found = solver.compute(Spectra::SortRule::LargestMagn, options.max_iterations,
                                      options.tolerance, Spectra::SortRule::SmallestAlge);
    report.iterations = static_cast<int>(solver.num_iterations());
    if (solver.info() != Spectra::CompInfo::Successful || found < count)
      return detail::ended(report, Status::not_converged, "modes: too many iterations");
    const Eigen::VectorXd lambda = solver.eigenvalues();
    const Eigen::MatrixXd x = solver.eigenvectors();
    Eigen::MatrixXd vectors(free.flat_size(), count);
    for (std::ptrdiff_t k = 0; k < count; ++k) {
      const Eigen::VectorXd Kx = K * x.col(k), Mx = M * x.col(k);
      report.residual = std::max(report.residual, (Kx - lambda[k] * Mx).norm() / (largest * Mx.norm()));
      free.scatter(x.col(k), vectors.col(k));
    }
    if (!std::isfinite(report.residual))
      return detail::ended(report, Status::not_finite, "modes: an eigenpair is not finite");
    modes = make_modes(system.mass, lambda, vectors, (single ? 1e-6 : 1e-12) * largest);
  } catch (const std::exception&) {  // Spectra throws where Lanczos breaks down
    return detail::ended(report, Status::not_converged, "modes: the eigensolver failed");
  }
  return detail::ended(report, Status::converged, "");
}

}  // namespace softsim
