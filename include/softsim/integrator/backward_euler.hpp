// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>

#include "softsim/integrator/stability.hpp"
#include "softsim/solver/newton.hpp"
#include "softsim/system/system.hpp"

namespace softsim {

/// Options of `BackwardEuler`.
struct BackwardEulerOptions {
  double dt = 0;        ///< step, s
  bool newton = false;  ///< false: one linearised solve a step; true: Newton's method to tolerance
  double tolerance =
      1e-6;  ///< Newton: residual over external load; linearised: relative residual of the linear solve
  int max_newton_iterations = 50;
  ConjugateGradient linear = {};
};

/// Backward Euler, q_1 = q_0 + h v_1, M (v_1 - v_0)/h = forces at (q_1, v_1): first order, unconditionally
/// stable, damping. Either as one linearised solve a step (Baraff & Witkin 1998, "Large steps in cloth
/// simulation") or with Newton's method to convergence, which minimises `IncrementalPotential`. The
/// linearised step is its first iteration.
template <class S, class Operator = Assembled, template <class> class Preconditioner = BlockJacobi>
class BackwardEuler {
 public:
  using T = typename S::Scalar;

  /// @throws std::invalid_argument unless dt and tolerance are positive
  explicit BackwardEuler(const BackwardEulerOptions& options)
      : options_(options),
        newton_(NewtonOptions{.max_iterations = options.max_newton_iterations,
                              .tolerance = options.tolerance,
                              .linear = {options.linear.max_iterations, options.tolerance}}) {
    set_dt(options.dt);
  }

  /// The step, s.
  [[nodiscard]] double dt() const { return options_.dt; }
  /// Changes the step. @throws std::invalid_argument unless it is positive
  void set_dt(double dt) {
    if (!(dt > 0) || !(dt <= 1e300))
      invalid(std::string("dt ") + to_text(dt) + " s: must be positive and finite");
    options_.dt = dt;
  }
  /// Growth of an oscillator's amplitude over one step.
  [[nodiscard]] double spectral_radius(double Omega, double xi) const {
    return stability::spectral_radius(stability::backward_euler, Omega, xi);
  }

  /// Advances the motion by dt. If the result is not finite the motion stays as it was; if it did not
  /// converge the motion takes the last iterate.
  StepReport step(Stepped<S> system, Motion<T>& motion) {
    const double h = options_.dt;
    if constexpr (S::has_memory) system.begin_step(motion.q, motion.v, h);
    start_ = motion.q;
    potential_.set_step(system, start_, motion.v, h);
    StepReport report;
    if (options_.newton) {
      next_ = motion.q;
      report = newton_.minimise(potential_, next_);
      difference(start_, next_, d_);
    } else {
      d_ = static_cast<T>(h) * motion.v;  // warm start: the velocity changes little
      const LinearReport linear = newton_.linear_step(potential_, start_, d_);
      report.status = linear.status;
      report.newton_iterations = 1;
      report.linear_iterations = linear.iterations;
      report.residual = linear.residual;
      if (linear.status != Status::converged)
        report.reason = linear.status == Status::not_finite ? "the linear solve is not finite"
                        : linear.indefinite                 ? "the tangent is not positive definite"
                                                            : "conjugate gradients: too many iterations";
      next_ = start_;
      retract(next_, d_);
    }
    if (report.status == Status::not_finite) return report;
    if (!std::isfinite(norm(next_.displacement))) {
      report.status = Status::not_finite;
      report.reason = "the state is not finite";
      return report;
    }
    motion.q.displacement.swap(next_.displacement);
    motion.v = d_ / static_cast<T>(h);
    motion.time += h;
    if constexpr (S::has_memory) system.end_step(motion.q, motion.v, h);
    return report;
  }

 private:
  BackwardEulerOptions options_;
  Newton<S, Operator, Preconditioner> newton_;
  IncrementalPotential<S> potential_;
  State<T> start_, next_;
  Vector<T> d_;
};

}  // namespace softsim
