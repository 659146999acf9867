// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <utility>

#include "softsim/core/error.hpp"
#include "softsim/core/state.hpp"
#include "softsim/solver/report.hpp"
#include "softsim/system/incremental_potential.hpp"
#include "softsim/system/system.hpp"
#include "softsim/system/tangent.hpp"

namespace softsim {

/// Options of `ReducedNewton`.
struct ReducedNewtonOptions {
  double dt = 0;            ///< step of backward Euler, s; 0 if only static problems are solved
  double tolerance = 1e-8;  ///< on the reduced residual over what IncrementalPotential::gradient returns
  int max_iterations = 50;
  int max_halvings = 30;  ///< of the step, in the line search
};

/// How a reduced solve ended.
struct [[nodiscard]] ReducedReport : StepReport {
  /// Norm of the whole residual over the same reference: the forces that the basis cannot balance. It is the
  /// price of the reduction, not of the solve, and tells when a basis is too poor.
  double full_residual = 0;
};

/// Newton's method in few unknowns: q = q_0 + Phi a with any basis Phi (`pod`, modes, a user's own), reduced
/// residual Phi^T g and reduced tangent Phi^T K Phi of the whole nonlinear system (Krysl, Lall & Marsden
/// 2001, "Dimensional model reduction in non-linear finite element dynamics"). q_0 is the state handed in.
/// Forces and tangents are still summed over all elements: what is saved is the linear system, and stiff
/// motions that the basis does not contain. Prescribed components must be in place and stay there. The
/// factorisation of the small matrix apart, nothing is allocated after the first step.
template <class S, class Operator = Assembled>
class ReducedNewton {
 public:
  using T = typename S::Scalar;

  /// The basis is orthonormalised; only its span counts.
  /// @throws std::invalid_argument unless the basis has a row per scalar of the system, at least one column
  ///   and no more than there are free components, finite and independent columns, zeros where the system is
  ///   prescribed; or for tolerance <= 0, dt < 0, fewer than one iteration
  ReducedNewton(const S& system, const Eigen::MatrixXd& basis, const ReducedNewtonOptions& options = {})
      : options_(options), number_(system.number()) {
    check(system, basis);
    const Eigen::VectorXd lengths = basis.colwise().norm();
    if (!(lengths.minCoeff() > 0)) invalid("basis: a column is zero");
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(basis * lengths.cwiseInverse().asDiagonal());
    const Eigen::VectorXd pivots = qr.matrixQR().diagonal().cwiseAbs();
    for (std::ptrdiff_t k = 0; k < pivots.size(); ++k)
      if (!(pivots[k] > 1e-10))
        invalid(std::string("basis: column ") + std::to_string(k) + " depends on those before it");
    basis_ = qr.householderQ() * Eigen::MatrixXd::Identity(basis.rows(), basis.cols());
    // rounding must not move what is prescribed
    for (std::ptrdiff_t k = 0; k < basis.rows(); ++k)
      if (system.prescribed.free()[k] == T(0)) basis_.row(k).setZero();
  }

  /// The orthonormal basis.
  [[nodiscard]] const Eigen::MatrixXd& basis() const { return basis_; }

  /// Moves q to static equilibrium within q + span. q stays as it was if the result is not finite; otherwise
  /// it is the last iterate.
  ReducedReport solve(Stepped<S> system, State<T>& q) {
    ReducedReport report;
    if (!fits(system, q, report)) return report;
    if constexpr (S::has_memory) system.begin_static();
    potential_.set_static(system);
    next_ = q;
    minimise(next_, report);
    if (report.status == Status::not_finite) return report;
    q.displacement.swap(next_.displacement);
    if constexpr (S::has_memory) system.end_static(q);
    return report;
  }

  /// One step of backward Euler within motion.q + span. The motion stays as it was if the result is not
  /// finite or dt is 0; otherwise it takes the last iterate.
  ReducedReport step(Stepped<S> system, Motion<T>& motion) {
    ReducedReport report;
    if (!(options_.dt > 0))
      return detail::ended(report, Status::not_converged, "reduced Newton: dt is 0, no step was set");
    if (!fits(system, motion.q, report)) return report;
    if constexpr (S::has_memory) system.begin_step(motion.q, motion.v, options_.dt);
    start_ = next_ = motion.q;
    const double h = options_.dt;
    terms_.mass = 1 / (h * h);
    terms_.damping = 1 / h;
    terms_.inertia = motion.v / static_cast<T>(h);
    potential_.set_step(system, start_, terms_);
    minimise(next_, report);
    if (report.status == Status::not_finite) return report;
    difference(start_, next_, x_);
    motion.q.displacement.swap(next_.displacement);
    motion.v = x_ / static_cast<T>(options_.dt);
    motion.time += options_.dt;
    if constexpr (S::has_memory) system.end_step(motion.q, motion.v, options_.dt);
    return report;
  }

 private:
  // of an eigenvalue of the reduced tangent to the largest
  static constexpr double smallest_ratio = 1e-10;

  void check(const S& system, const Eigen::MatrixXd& basis) const {
    if (!(options_.tolerance > 0))
      invalid(std::string("tolerance ") + to_text(options_.tolerance) + ": must be positive");
    if (!(options_.dt >= 0) || !std::isfinite(options_.dt))
      invalid(std::string("dt ") + to_text(options_.dt) + " s: must not be negative, and finite");
    if (options_.max_iterations < 1)
      invalid(std::string("max_iterations ") + std::to_string(options_.max_iterations) +
              ": must be at least 1");
    const auto unknowns = static_cast<std::ptrdiff_t>((system.prescribed.free().array() != T(0)).count());
    if (basis.rows() != system.size() || basis.cols() < 1 || basis.cols() > unknowns)
      invalid(std::string("basis: ") + std::to_string(basis.rows()) + " x " + std::to_string(basis.cols()) +
              ", must have " + std::to_string(system.size()) + " rows and 1 to " + std::to_string(unknowns) +
              " columns");
    if (!basis.allFinite()) invalid("basis: must be finite");
    for (std::ptrdiff_t k = 0; k < basis.rows(); ++k)
      if (system.prescribed.free()[k] == T(0) && !basis.row(k).isZero(0))
        invalid(std::string("basis: node ") + std::to_string(k / block_stride) +
                ": a column moves a prescribed component");
  }

  bool fits(const S& system, const State<T>& q, ReducedReport& report) {
    x_.resize(basis_.rows());
    if (system.number() != number_ || q.size() != basis_.rows())
      report.reason = "reduced Newton: the basis is that of another system";
    else if (system.prescribed.increment(q, x_) >
             1e-9 * static_cast<double>(q.displacement.cwiseAbs().maxCoeff()))
      report.reason = "reduced Newton: prescribed components are not in place";
    else
      return true;
    return false;
  }

  // Residual at q: the gradient g_, its free part's norm in `full`, its projection r. Returns the reference.
  double evaluate(const State<T>& q, Eigen::VectorXd& r, double& full) {
    const double reference = potential_.gradient(q, g_);
    potential_.system().prescribed.mask(g_);
    wide_ = g_.template cast<double>();
    r.noalias() = basis_.transpose() * wide_;
    full = norm(g_);
    return reference;
  }

  void minimise(State<T>& q, ReducedReport& report) {
    double full = 0, reference = evaluate(q, r_, full);
    for (;; ++report.newton_iterations) {
      const double residual = r_.norm();
      report.residual = residual == 0 ? 0 : residual / reference;
      report.full_residual = full == 0 ? 0 : full / reference;
      if (!std::isfinite(residual)) return end(report, Status::not_finite, "the residual is not finite");
      if (residual <= options_.tolerance * reference) return end(report, Status::converged, "");
      if (report.newton_iterations == options_.max_iterations)
        return end(report, Status::not_converged, "reduced Newton: too many iterations");
      if (!direction(q)) return end(report, Status::not_finite, "the reduced tangent is not finite or zero");
      if (!line_search(q, residual, reference, full))
        return end(report, Status::not_converged, "reduced Newton: the line search found no decrease");
    }
  }

  static void end(ReducedReport& report, Status status, std::string_view reason) {
    report.status = status;
    report.reason = reason;
  }

  // a_ = -H^-1 r with H = Phi^T K Phi. Where H is not safely positive definite its eigenvalues are replaced
  // by their absolute values: a raised diagonal can come to lie next to a singular matrix.
  bool direction(const State<T>& q) {
    potential_.linearise(q, tangent_);
    H_.resize(basis_.cols(), basis_.cols());
    product_.resize(basis_.rows());
    for (std::ptrdiff_t j = 0; j < basis_.cols(); ++j) {
      x_ = basis_.col(j).template cast<T>();
      tangent_.apply(x_, product_);
      wide_ = product_.template cast<double>();
      H_.col(j).noalias() = basis_.transpose() * wide_;
    }
    if (!H_.allFinite()) return false;
    factor_.compute(H_);
    if (factor_.info() == Eigen::Success && factor_.rcond() > smallest_ratio)
      a_ = factor_.solve(-r_);
    else {
      eigen_.compute(H_);
      if (eigen_.info() != Eigen::Success) return false;
      const Eigen::ArrayXd lambda = eigen_.eigenvalues().cwiseAbs();
      const double largest = lambda.maxCoeff();
      if (!(largest > 0)) return false;
      a_ = -(
          eigen_.eigenvectors() *
          ((eigen_.eigenvectors().transpose() * r_).array() / lambda.max(smallest_ratio * largest)).matrix());
    }
    x_ = (basis_ * a_).template cast<T>();
    return a_.allFinite();
  }

  // Moves q along x_ and leaves the residual there in r_. False if no decrease was found; q is unchanged
  // then.
  bool line_search(State<T>& q, double residual, double& reference, double& full) {
    const double slope = r_.dot(a_);
    double before = 0;
    if constexpr (S::conservative) before = potential_.value(q);
    T step = T(1);
    for (int k = 0; k <= options_.max_halvings; ++k, step /= 2) {
      trial_ = q;
      retract(trial_, x_, step);
      bool accepted = false;
      if constexpr (S::conservative) {
        const double after = potential_.value(trial_);
        if (!std::isfinite(after)) continue;
        accepted = after <= before + 1e-4 * static_cast<double>(step) * slope;
        // as in `Newton`: a decrease below the rounding of the values is left to the gradient
        if (!accepted && static_cast<double>(step) * std::abs(slope) >
                             std::sqrt(static_cast<double>(std::numeric_limits<T>::epsilon())) *
                                 std::max(std::abs(before), std::abs(after)))
          continue;
      }
      double full_there = 0;
      const double reference_there = evaluate(trial_, trial_r_, full_there);
      if (!trial_r_.allFinite()) continue;
      accepted = accepted || trial_r_.norm() <= (1 - 1e-4 * static_cast<double>(step)) * residual;
      if constexpr (S::conservative)
        accepted = accepted || std::abs(trial_r_.dot(a_)) <= 0.9 * std::abs(slope);
      if (!accepted) continue;
      std::swap(q.displacement, trial_.displacement);
      r_.swap(trial_r_);
      reference = reference_there;
      full = full_there;
      return true;
    }
    return false;
  }

  ReducedNewtonOptions options_;
  std::uint64_t number_;
  Eigen::MatrixXd basis_, H_;
  Eigen::LLT<Eigen::MatrixXd> factor_;
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen_;
  IncrementalPotential<S> potential_;
  StepTerms<T> terms_;
  typename Operator::template Tangent<S> tangent_;
  State<T> start_, next_, trial_;
  Vector<T> g_, x_, product_;
  Eigen::VectorXd wide_, r_, trial_r_, a_;
};

}  // namespace softsim
