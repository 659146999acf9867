// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "softsim/core/error.hpp"
#include "softsim/core/state.hpp"
#include "softsim/reduction/linearised.hpp"
#include "softsim/reduction/modes.hpp"
#include "softsim/reduction/oscillator.hpp"
#include "softsim/solver/report.hpp"
#include "softsim/system/system.hpp"

namespace softsim {

/// Options of `ModalDynamics`.
struct ModalOptions {
  double dt = 0;             ///< step, s
  double damping_ratio = 0;  ///< of every mode, beside the Rayleigh damping of the system
  /// Adds what the modes that were left out do at once, their static response to the load:
  /// (K^-1 - Phi Omega^-2 Phi^T) f. Costs a sparse solve (which allocates) whenever the load changes.
  bool static_correction = false;
};

/// Motion of a system linearised at q_0 as a superposition of its modes (d'Aulignac 2001, section 3.3.4;
/// (3.35) there should read phi^T K phi): every mode is an oscillator with damping alpha + beta omega^2,
/// stepped exactly for a load that is constant during the step. Unconditionally stable, no numerical damping;
/// a step costs two products with the shapes. The load is that of the external terms at q_0, read anew at
/// every step, less the internal force at q_0. What of a motion is not in the span of the modes is lost at
/// the first step. Prescribed components stay where they are at q_0.
template <class S>
class ModalDynamics {
 public:
  using T = typename S::Scalar;

  /// @param modes of `system` linearised at q_0
  /// @throws std::invalid_argument unless dt is positive, the damping ratio not negative, and the modes have
  ///   the size of the system, are M-orthonormal to 1e-4 and zero where it is prescribed; or if a static
  ///   correction is asked for a body that is not held
  ModalDynamics(const S& system, const State<T>& q_0, Modes modes, const ModalOptions& options)
      : options_(options), number_(system.number()), q_0_(q_0), modes_(std::move(modes)) {
    check(system);
    for (std::ptrdiff_t k = 0; k < modes_.count(); ++k) {
      const double w = modes_.frequencies[k];
      oscillators_.emplace_back(
          w, system.damping.alpha + system.damping.beta * w * w + 2 * options.damping_ratio * w, options.dt);
    }
    internal_ = Vector<T>::Zero(system.size());
    system.add_external_gradient(q_0_, internal_);
    internal_ = -internal_.eval();
    system.add_gradient(q_0_, internal_);
    if (options.static_correction) {
      free_ = FreeComponents(system.prescribed);
      factorise_stiffness<T>(stiffness_matrix(system, q_0_, free_), "static correction", factor_);
      if (!(modes_.frequencies.minCoeff() > 0)) invalid("static correction: a mode is rigid, must be held");
    }
    work_ = d_ = Vector<T>::Zero(system.size());
    a_ = v_ = p_ = Eigen::VectorXd::Zero(modes_.count());
  }

  /// The modes.
  [[nodiscard]] const Modes& modes() const { return modes_; }
  /// Modal coordinates and velocities after the last step, sqrt(kg) m and sqrt(kg) m/s.
  [[nodiscard]] const Eigen::VectorXd& coordinates() const { return a_; }
  [[nodiscard]] const Eigen::VectorXd& velocities() const { return v_; }

  /// Advances the motion by dt. It stays as it was unless the status is `converged`.
  StepReport step(const S& system, Motion<T>& motion) {
    StepReport report;
    if (system.number() != number_ || motion.q.size() != q_0_.size() || motion.v.size() != q_0_.size())
      return detail::ended(report, Status::not_converged, "modal: the modes are those of another system");
    if (system.prescribed.increment(q_0_, d_) > 1e-9 * largest(q_0_))
      return detail::ended(report, Status::not_converged,
                           "modal: prescribed components must stay where the modes were computed");
    work_ = internal_;
    system.add_external_gradient(q_0_, work_);
    p_.noalias() = -(modes_.shapes.transpose() * work_.template cast<double>());
    if (options_.static_correction) correct();
    difference(q_0_, motion.q, d_);
    to_modes(system, d_, a_);
    to_modes(system, motion.v, v_);
    for (std::ptrdiff_t k = 0; k < modes_.count(); ++k)
      oscillators_[static_cast<std::size_t>(k)].advance(a_[k], v_[k], p_[k]);
    full_.noalias() = modes_.shapes * a_;
    if (options_.static_correction) full_ += correction_;
    if (!full_.allFinite() || !v_.allFinite())
      return detail::ended(report, Status::not_finite, "modal: the motion is not finite");
    d_ = full_.template cast<T>();
    full_.noalias() = modes_.shapes * v_;
    motion.q = q_0_;
    retract(motion.q, d_);
    motion.v = full_.template cast<T>();
    motion.time += options_.dt;
    return detail::ended(report, Status::converged, "");
  }

 private:
  static double largest(const State<T>& q) {
    return q.size() == 0 ? 0 : static_cast<double>(q.displacement.cwiseAbs().maxCoeff());
  }

  void check(const S& system) const {
    if (!(options_.damping_ratio >= 0))
      invalid(std::string("damping_ratio ") + to_text(options_.damping_ratio) + ": must not be negative");
    if (modes_.count() == 0 || modes_.shapes.rows() != system.size() ||
        modes_.shapes.cols() != modes_.count() || q_0_.size() != system.size())
      invalid(std::string("modes: shapes are ") + std::to_string(modes_.shapes.rows()) + " x " +
              std::to_string(modes_.shapes.cols()) + ", must be " + std::to_string(system.size()) + " x " +
              std::to_string(modes_.count()) + " and at least one");
    if (!(system.mass.total() > 0)) invalid("system: has no mass");
    const double error = orthonormality_error(system.mass, modes_);
    if (!(error < 1e-4))
      invalid(std::string("modes: Phi^T M Phi differs from the identity by ") + to_text(error) +
              ", must not by 1e-4");
    for (std::ptrdiff_t k = 0; k < system.size(); ++k)
      if (system.prescribed.free()[k] == T(0) && !modes_.shapes.row(k).isZero(0))
        invalid(std::string("modes: node ") + std::to_string(k / block_stride) +
                ": a shape moves a prescribed component");
  }

  // x = Phi^T M d.
  void to_modes(const S& system, const Vector<T>& d, Eigen::VectorXd& x) {
    work_.setZero();
    system.mass.add_product(d, T(1), work_);
    x.noalias() = modes_.shapes.transpose() * work_.template cast<double>();
  }

  // correction_ = (K^-1 - Phi Omega^-2 Phi^T) f of the load -work_.
  void correct() {
    if (last_load_.size() == work_.size() && last_load_ == work_) return;
    last_load_ = work_;
    Eigen::VectorXd f(free_.size());
    free_.gather(work_, f);
    const Eigen::VectorXd x = factor_.solve(-f);
    correction_.resize(work_.size());
    free_.scatter(x, correction_);
    correction_.noalias() -= modes_.shapes * (p_.array() / modes_.frequencies.array().square()).matrix();
  }

  ModalOptions options_;
  std::uint64_t number_;
  State<T> q_0_;
  Modes modes_;
  std::vector<OscillatorStep> oscillators_;
  Vector<T> internal_, work_, d_, last_load_;
  Eigen::VectorXd a_, v_, p_, full_, correction_;
  FreeComponents free_;
  StiffnessFactor factor_;
};

}  // namespace softsim
