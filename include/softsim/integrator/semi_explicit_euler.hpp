// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <cstddef>

#include "softsim/core/state.hpp"
#include "softsim/integrator/acceleration.hpp"
#include "softsim/integrator/stability.hpp"
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
  explicit SemiExplicitEuler(const SemiExplicitEulerOptions& options)
      : options_(options), acceleration_(options.linear) {
    detail::check_dt(options.dt);
  }

  /// The step, s.
  [[nodiscard]] double dt() const { return options_.dt; }
  /// Changes the step. @throws std::invalid_argument unless it is positive
  void set_dt(double dt) {
    detail::check_dt(dt);
    options_.dt = dt;
  }
  /// Growth of an oscillator's amplitude over one step; see `stability::semi_explicit_euler`.
  [[nodiscard]] double spectral_radius(double Omega, double xi) const {
    return stability::spectral_radius(stability::semi_explicit_euler(Omega, xi));
  }

  /// Advances the motion by dt. If the result is not finite the motion stays as it was.
  StepReport step(Stepped<S> system, Motion<T>& motion) {
    StepReport report;
    if constexpr (S::has_memory) system.begin_step(motion.q, motion.v, 0);
    const T h = static_cast<T>(options_.dt);
    report.status = Status::converged;
    if (system.mass.is_lumped()) {
      kick(system, motion, h);
    } else {
      // Prescribed components first: they reach their target at the end of the step, and their acceleration
      // is known.
      acceleration_.prescribed_velocity(system, motion.q, h, p_);
      acceleration_.start(system, motion.v, p_, h, v_, held_);
      detail::take_in(acceleration_(system, motion.q, motion.v, held_, a_), report);
      v_ += h * a_;
    }
    next_ = motion.q;
    retract(next_, v_, h);
    if (report.status == Status::not_finite || !std::isfinite(norm(v_)) ||
        !std::isfinite(norm(next_.displacement)))
      return detail::ended(report, Status::not_finite, detail::too_large);
    motion.q.displacement.swap(next_.displacement);
    motion.v.swap(v_);
    motion.time += options_.dt;
    if constexpr (S::has_memory) system.end_step(motion.q, motion.v, options_.dt);
    return report;
  }

 private:
  // v_1 with a lumped mass, in one pass after the forces: the vectors together take as long as half a force.
  void kick(const S& system, const Motion<T>& motion, T h) {
    a_.setZero(system.size());
    system.add_gradient(motion.q, a_);
    acceleration_.add_damping(system, motion.q, motion.v, a_);
    v_.resize(system.size());
    const T *gradient = a_.data(), *mass = system.mass.diagonal().data(),
            *free = system.prescribed.free().data(), *target = system.prescribed.target().data(),
            *q = motion.q.displacement.data(), *v_0 = motion.v.data();
    T* v = v_.data();
    for (std::ptrdiff_t k = 0; k < v_.size(); ++k) {
      const T held = (target[k] - q[k]) / h, moved = v_0[k] - h * gradient[k] / mass[k];
      v[k] = free[k] == T(0) ? held : moved;
    }
  }

  SemiExplicitEulerOptions options_;
  Acceleration<S> acceleration_;
  Vector<T> p_, held_, v_, a_;
  State<T> next_;
};

}  // namespace softsim
