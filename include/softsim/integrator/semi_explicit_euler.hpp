// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>

#include "softsim/core/state.hpp"
#include "softsim/solver/conjugate_gradient.hpp"
#include "softsim/solver/report.hpp"
#include "softsim/system/system.hpp"

namespace softsim {

/// Options of `SemiExplicitEuler`.
struct SemiExplicitEulerOptions {
  double dt = 0;                                                        ///< step, s
  ConjugateGradient linear{.max_iterations = 500, .tolerance = 1e-12};  ///< for a consistent mass matrix only
};

/// Semi-explicit (symplectic) Euler: v_1 = v_0 + h M^-1 f(q_0, v_0), q_1 = q_0 + h v_1 (Goulette & Chen 2015,
/// Eq. 32). First order, symplectic without damping, stable while h < 2/omega_max. With a consistent mass
/// matrix every step solves for the acceleration.
template <class S>
class SemiExplicitEuler {
 public:
  using T = typename S::Scalar;

  /// @throws std::invalid_argument unless dt is positive
  explicit SemiExplicitEuler(const SemiExplicitEulerOptions& options) : options_(options) {
    if (!(options.dt > 0) || !(options.dt <= 1e300))
      invalid(std::string("dt ") + to_text(options.dt) + " s: must be positive and finite");
  }

  /// Advances the motion by dt. If the result is not finite the motion stays as it was.
  StepReport step(Stepped<S> system, Motion<T>& motion) {
    StepReport report;
    if constexpr (S::has_memory) system.begin_step(motion.q, motion.v, 0);
    const T h = static_cast<T>(options_.dt);
    f_.setZero(system.size());
    system.add_gradient(motion.q, f_);
    system.add_damping_product(motion.q, motion.v, f_);
    if (system.damping.beta != 0) {
      p_ = static_cast<T>(system.damping.beta) * motion.v;
      system.add_hessian_product(motion.q, p_, f_);
    }
    if (system.damping.alpha != 0)
      system.mass.add_product(motion.v, static_cast<T>(system.damping.alpha), f_);
    f_ = -f_;
    // Prescribed components first: they reach their target at the end of the step, and their acceleration is
    // known.
    p_.resize(system.size());
    system.prescribed.increment(motion.q, p_);
    p_ /= h;
    report.status = Status::converged;
    if (system.mass.is_lumped()) {
      v_ = motion.v;
      const Vector<T>&m = system.mass.diagonal(), &free = system.prescribed.free();
      for (std::ptrdiff_t k = 0; k < v_.size(); ++k)
        v_[k] = free[k] == T(0) ? p_[k] : v_[k] + h * f_[k] / m[k];
    } else {
      solve_consistent(system, motion, h, report);
    }
    next_ = motion.q;
    retract(next_, v_, h);
    if (report.status == Status::not_finite || !std::isfinite(norm(v_)) ||
        !std::isfinite(norm(next_.displacement))) {
      report.status = Status::not_finite;
      report.reason = "the velocity is not finite: the step is too large, or a free point has no mass";
      return report;
    }
    motion.q.displacement.swap(next_.displacement);
    motion.v.swap(v_);
    motion.time += options_.dt;
    if constexpr (S::has_memory) system.end_step(motion.q, motion.v, options_.dt);
    return report;
  }

 private:
  struct MassOperator {
    const S* system;
    void apply(const Vector<T>& x, Vector<T>& y) const {
      y.setZero();
      system->mass.add_product(x, T(1), y);
      system->prescribed.mask(y);
    }
  };
  struct MassJacobi {
    const S* system;
    void apply(const Vector<T>& r, Vector<T>& z) const {
      const Vector<T>& m = system->mass.diagonal();
      for (std::ptrdiff_t k = 0; k < r.size(); ++k) z[k] = r[k] == T(0) ? T(0) : r[k] / m[k];
    }
  };

  // M_ff a_f = f_f - M_fp a_p, with the acceleration a_p of the prescribed components known.
  void solve_consistent(const S& system, const Motion<T>& motion, T h, StepReport& report) {
    const Vector<T>& free = system.prescribed.free();
    a_.setZero(system.size());
    for (std::ptrdiff_t k = 0; k < a_.size(); ++k)
      if (k % block_stride != 3 && free[k] == T(0)) a_[k] = (p_[k] - motion.v[k]) / h;
    MassOperator{&system}.apply(a_, b_.setZero(system.size()));
    b_ = f_ - b_;
    system.prescribed.mask(b_);
    x_.setZero(system.size());
    const LinearReport solved =
        options_.linear.solve(MassOperator{&system}, MassJacobi{&system}, b_, x_, cg_);
    report.status = solved.status;
    report.linear_iterations = solved.iterations;
    report.residual = solved.residual;
    if (solved.status == Status::not_converged)
      report.reason = "conjugate gradients on the mass matrix: too many iterations";
    v_ = motion.v + h * (a_ + x_);
  }

  SemiExplicitEulerOptions options_;
  Vector<T> f_, p_, v_, a_, b_, x_;
  State<T> next_;
  ConjugateGradient::Workspace<T> cg_;
};

}  // namespace softsim
