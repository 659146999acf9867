// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <string>

#include "softsim/integrator/acceleration.hpp"
#include "softsim/integrator/stability.hpp"
#include "softsim/solver/newton.hpp"
#include "softsim/system/incremental_potential.hpp"
#include "softsim/system/system.hpp"

namespace softsim {

/// A step whose forces are the discrete gradients between its start and q.
template <class S>
class DiscreteGradientProblem : public IncrementalPotential<S> {
 public:
  using T = typename S::Scalar;
  static constexpr bool conservative = false;  // the residual is the gradient of nothing

  /// Residual at q, prescribed components included, N; returns what residuals are measured against.
  double gradient(const State<T>& q, Vector<T>& g) const {
    g.setZero(q.size());
    this->system().add_discrete_gradient(this->start(), q, g);
    return this->add_step(q, g);
  }
  /// Linearises with half of the Hessian at q, from which the derivative of a discrete gradient differs by
  /// what the Hessian changes within a step.
  template <class Tangent>
  void linearise(const State<T>& q, Tangent& tangent) const {
    IncrementalPotential<S>::linearise(q, tangent, 0.5);
  }
};

/// Options of `EnergyMomentum` with the given linear method.
template <class Method = ConjugateGradient>
struct EnergyMomentumOptions {
  double dt = 0;  ///< step, s
  double tolerance =
      1e-10;  ///< residual over external load; what it leaves is what energy and momenta drift by
  int max_newton_iterations = 50;
  Method linear = {};
};

/// The energy-momentum conserving scheme of Gonzalez (2000): M (v_1 - v_0)/h + discrete gradient of E = 0,
/// q_1 = q_0 + h (v_0 + v_1)/2. Second order. Without damping the energy stays what it is, to the tolerance
/// of Newton's method, and so do linear and angular momentum of a body that is free, for any step. All terms
/// have to offer a discrete gradient: elastic solids, springs and dead loads do.
template <class S, class Operator = Assembled,
          template <class> class Preconditioner = DefaultPreconditioner<Operator>::template type,
          class Method = ConjugateGradient>
class EnergyMomentum {
 public:
  using T = typename S::Scalar;
  using Options = EnergyMomentumOptions<Method>;
  static_assert(S::has_discrete_gradient, "a term of the system has no discrete gradient");

  /// @throws std::invalid_argument unless dt and tolerance are positive
  explicit EnergyMomentum(const Options& options)
      : dt_(options.dt),
        newton_({.max_iterations = options.max_newton_iterations,
                 .tolerance = options.tolerance,
                 .linear = options.linear}) {
    detail::check_dt(dt_);
  }

  /// The step, s.
  [[nodiscard]] double dt() const { return dt_; }
  /// Changes the step. @throws std::invalid_argument unless it is positive
  void set_dt(double dt) {
    detail::check_dt(dt);
    dt_ = dt;
  }
  /// Growth of an oscillator's amplitude over one step: that of the midpoint rule.
  [[nodiscard]] double spectral_radius(double Omega, double xi) const {
    return stability::spectral_radius(stability::trapezoidal, Omega, xi);
  }

  /// Advances the motion by dt. If the result is not finite the motion stays as it was; if it did not
  /// converge the motion takes the last iterate.
  StepReport step(const S& system, Motion<T>& motion) {
    start_ = motion.q;
    terms_.mass = 2 / (dt_ * dt_);
    terms_.damping = 1 / dt_;
    terms_.inertia = static_cast<T>(2 / dt_) * motion.v;
    problem_.set_step(system, start_, terms_);
    StepReport report;
    // From where the old velocity leads to, or from the start if the energy is not defined there.
    for (const T step : {static_cast<T>(dt_), T(0)}) {
      next_ = start_;
      retract(next_, motion.v, step);
      restore_prescribed(system.prescribed);
      report = newton_.minimise(problem_, next_);
      if (report.status != Status::not_finite) break;
    }
    if (report.status == Status::not_finite) return report;
    difference(start_, next_, d_);
    v_ = static_cast<T>(2 / dt_) * d_ - motion.v;
    const Vector<T>& free = system.prescribed.free();
    for (std::ptrdiff_t k = 0; k < v_.size(); ++k)
      if (free[k] == T(0) && k % block_stride != 3) v_[k] = d_[k] / static_cast<T>(dt_);
    if (!std::isfinite(norm(next_.displacement)) || !std::isfinite(norm(v_)))
      return detail::ended(report, Status::not_finite, "the state is not finite");
    motion.q.displacement.swap(next_.displacement);
    motion.v.swap(v_);
    motion.time += dt_;
    return report;
  }

 private:
  // Newton's method moves prescribed components itself, together with what is near them.
  void restore_prescribed(const Prescribed<T>& prescribed) {
    const Vector<T>& free = prescribed.free();
    for (std::ptrdiff_t k = 0; k < free.size(); ++k)
      if (free[k] == T(0)) next_.displacement[k] = start_.displacement[k];
  }

  double dt_;
  Newton<S, Operator, Preconditioner, Method> newton_;
  DiscreteGradientProblem<S> problem_;
  StepTerms<T> terms_;
  State<T> start_, next_;
  Vector<T> d_, v_;
};

}  // namespace softsim
