// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/LU>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <string_view>

#include "softsim/core/error.hpp"
#include "softsim/core/state.hpp"
#include "softsim/solver/report.hpp"

namespace softsim {

/// Anything that solves A x = b: it has `x = s.solve(b)`, as Eigen's factorisations, or is called s(b, x).
template <class F, class T = double>
concept SolvesFor = requires(const F& s, const Vector<T>& b, Vector<T>& x) {
  x = s.solve(b);
}
|| requires(const F& s, const Vector<T>& b, Vector<T>& x) { s(b, x); };

/// A column that adds a spring between the unknowns i and j of n (or from i to the ground, j < 0) to A.
/// @throws std::invalid_argument for unknowns that do not exist
template <class T = double>
[[nodiscard]] Vector<T> spring_column(std::ptrdiff_t n, std::ptrdiff_t i, std::ptrdiff_t j = -1) {
  if (i < 0 || i >= n || j >= n)
    invalid(std::string("unknown ") + std::to_string(i < 0 || i >= n ? i : j) + ": must be below " +
            std::to_string(n));
  Vector<T> u = Vector<T>::Zero(n);
  u[i] = T(1);
  if (j >= 0) u[j] -= T(1);
  return u;
}

/// Solves (A + U C U^T) x = b with what solves A, for few columns U: springs, supports by penalty (large C),
/// an element that is taken out (U the unit columns of its unknowns, C minus its stiffness). By Sherman,
/// Morrison and Woodbury, with Z = A^-1 U,
///   x = y - Z (I + C U^T Z)^-1 C U^T y,   y = A^-1 b,
/// a form that takes any C, singular ones too (James & Pai 1999, "ArtDefo", for changing boundary conditions;
/// d'Aulignac 2001, section 3.2). The k solves for Z are made once, when columns are added; a solve for x
/// costs one solve with A and 4 n k operations. A itself must be regular. Allocates when columns are added or
/// coefficients set, and what the solver of A allocates.
template <class T = double>
class LowRankUpdate {
 public:
  using Matrix = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;

  /// Pivots of the scaled capacitance matrix I + C U^T Z below this times k count as zero. (Scaled: each row
  /// by the size of what was added up in it.)
  double singular_below = 100 * static_cast<double>(std::numeric_limits<T>::epsilon());

  /// Adds U C U^T, U n x k and C k x k, to what was added before. The report says if the matrix became
  /// singular, or if the solver of A gave numbers that are not finite: then nothing was added.
  /// @throws std::invalid_argument if sizes do not fit or numbers are not finite
  template <SolvesFor<T> Solver>
  LinearReport add(const Solver& solver, const Matrix& U, const Matrix& C) {
    const std::ptrdiff_t old = rank(), k = U.cols();
    if (k == 0 || (old > 0 && U.rows() != U_.rows()))
      invalid(std::string("low-rank update: U is ") + std::to_string(U.rows()) + " x " + std::to_string(k) +
              ", must have " + (old > 0 ? std::to_string(U_.rows()) + " rows" : "columns"));
    check_coefficients(C, k);
    if (!U.allFinite()) invalid("low-rank update: U must be finite");
    Matrix Z(U.rows(), k);
    for (std::ptrdiff_t j = 0; j < k; ++j) {
      b_ = U.col(j);
      y_.resize(b_.size());
      solve_with(solver, b_, y_);
      if (y_.size() != b_.size() || !y_.allFinite())
        return detail::ended(LinearReport{}, Status::not_finite,
                             "low-rank update: a solve with the unchanged matrix is not finite");
      Z.col(j) = y_;
    }
    U_.conservativeResize(U.rows(), old + k);
    Z_.conservativeResize(U.rows(), old + k);
    C_.conservativeResize(old + k, old + k);
    U_.rightCols(k) = U;
    Z_.rightCols(k) = Z;
    C_.topRightCorner(old, k).setZero();
    C_.bottomLeftCorner(k, old).setZero();
    C_.bottomRightCorner(k, k) = C;
    S_.noalias() = U_.transpose() * Z_;
    return factorise();
  }

  /// Replaces the coefficients of all columns (0 switches one off): no solve with A.
  /// @throws std::invalid_argument unless C is rank() x rank() and finite
  LinearReport set_coefficients(const Matrix& C) {
    check_coefficients(C, rank());
    C_ = C;
    return factorise();
  }

  /// Back to A itself.
  void clear() {
    U_.resize(0, 0);
    Z_.resize(0, 0);
    C_.resize(0, 0);
    S_.resize(0, 0);
    regular_ = true;
  }

  /// Number of columns.
  [[nodiscard]] std::ptrdiff_t rank() const { return U_.cols(); }
  /// The coefficients C of all columns.
  [[nodiscard]] const Matrix& coefficients() const { return C_; }

  /// Solves (A + U C U^T) x = b with the solver of A that `add` was given. x stays as it was unless the
  /// status is `converged`. The residual is not known: A is not.
  template <SolvesFor<T> Solver>
  LinearReport solve(const Solver& solver, const Vector<T>& b, Vector<T>& x) {
    if (!regular_) return detail::ended(LinearReport{}, Status::not_converged, singular_);
    if (rank() > 0 && b.size() != U_.rows())
      return detail::ended(LinearReport{}, Status::not_converged,
                           "low-rank update: the right-hand side has another size");
    y_.resize(b.size());
    solve_with(solver, b, y_);
    if (y_.size() == b.size() && rank() > 0) {
      t_.noalias() = U_.transpose() * y_;
      s_.noalias() = C_ * t_;
      s_.array() *= scale_.array();
      t_ = factor_.solve(s_);
      y_.noalias() -= Z_ * t_;
    }
    if (y_.size() != b.size() || !y_.allFinite())
      return detail::ended(LinearReport{}, Status::not_finite, "low-rank update: the result is not finite");
    x = y_;
    return detail::ended(LinearReport{}, Status::converged, "");
  }

 private:
  static constexpr std::string_view singular_ =
      "low-rank update: the changed matrix is singular (capacitance matrix)";

  static void check_coefficients(const Matrix& C, std::ptrdiff_t k) {
    if (C.rows() != k || C.cols() != k || !C.allFinite())
      invalid(std::string("low-rank update: C is ") + std::to_string(C.rows()) + " x " +
              std::to_string(C.cols()) + ", must be " + std::to_string(k) + " x " + std::to_string(k) +
              " and finite");
  }

  template <class Solver>
  static void solve_with(const Solver& solver, const Vector<T>& b, Vector<T>& x) {
    if constexpr (requires { x = solver.solve(b); })
      x = solver.solve(b);
    else
      solver(b, x);
  }

  LinearReport factorise() {
    if (rank() == 0) {
      regular_ = true;
      return detail::ended(LinearReport{}, Status::converged, "");
    }
    const std::ptrdiff_t k = rank();
    // Cancellation, 1 - 1, has to be told from a small number: a row counts by what is added up in it.
    scale_ = (Matrix(C_.cwiseAbs() * S_.cwiseAbs()).rowwise().maxCoeff().array() + T(1)).inverse();
    const Matrix capacitance = scale_.asDiagonal() * (Matrix::Identity(k, k) + C_ * S_);
    if (!capacitance.allFinite()) {
      regular_ = false;
      return detail::ended(LinearReport{}, Status::not_finite,
                           "low-rank update: the capacitance matrix is not finite");
    }
    factor_.compute(capacitance);
    regular_ = static_cast<double>(factor_.matrixLU().diagonal().cwiseAbs().minCoeff()) >
               static_cast<double>(k) * singular_below;
    return detail::ended(LinearReport{}, regular_ ? Status::converged : Status::not_converged, singular_);
  }

  Matrix U_, Z_, C_, S_;
  Vector<T> scale_, b_, y_, t_, s_;
  Eigen::FullPivLU<Matrix> factor_;
  bool regular_ = true;
};

}  // namespace softsim
