// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <cstdint>

#include "softsim/core/state.hpp"
#include "softsim/integrator/acceleration.hpp"
#include "softsim/integrator/stability.hpp"
#include "softsim/solver/conjugate_gradient.hpp"
#include "softsim/solver/report.hpp"
#include "softsim/system/system.hpp"

namespace softsim {

/// Options of `VelocityVerlet`.
struct VelocityVerletOptions {
  double dt = 0;                                                        ///< step, s
  ConjugateGradient linear{.max_iterations = 500, .tolerance = 1e-12};  ///< for a consistent mass matrix only
};

/// Velocity Verlet, kick - drift - kick: v = v_0 + h/2 a(q_0, v_0), q_1 = q_0 + h v, v_1 = v + h/2 a(q_1, v_0
/// + h a(q_0, v_0)); without damping the same positions as central differences. Second order, damping
/// included: the velocity that damping sees at the end is predicted from the start, with an error of h^2.
/// Symplectic without damping, and then stable while h < 2/omega_max.
///
/// The gradient of the energy, the costly part, is evaluated once a step: that at the end of a step serves
/// the next one if q, v, time and system are exactly what the step left, else it is evaluated anew. Loads
/// that were changed between steps are not seen by that: call `forget`, or the next step's first kick is
/// still with the old ones. Damping forces are evaluated twice.
template <class S>
class VelocityVerlet {
 public:
  using T = typename S::Scalar;

  /// @throws std::invalid_argument unless dt is positive
  explicit VelocityVerlet(const VelocityVerletOptions& options)
      : dt_(options.dt), acceleration_(options.linear) {
    detail::check_dt(options.dt);
  }

  /// The step, s.
  [[nodiscard]] double dt() const { return dt_; }
  /// Changes the step. @throws std::invalid_argument unless it is positive
  void set_dt(double dt) {
    detail::check_dt(dt);
    dt_ = dt;
  }
  /// Growth of an oscillator's amplitude over one step; see `stability::velocity_verlet`.
  [[nodiscard]] double spectral_radius(double Omega, double xi) const {
    return stability::spectral_radius(stability::velocity_verlet(Omega, xi));
  }
  /// Has the next step evaluate the forces at its start: after a change of the system's terms.
  void forget() { number_ = 0; }

  /// Advances the motion by dt. If the result is not finite the motion stays as it was.
  StepReport step(Stepped<S> system, Motion<T>& motion) {
    StepReport report;
    report.status = Status::converged;
    const T h = static_cast<T>(dt_), half = h / 2;
    Acceleration<S>::prescribed_velocity(system, motion.q, h, p_);
    Acceleration<S>::start(system, motion.v, p_, h, v_, held_);
    const bool known = number_ == system.number() && motion.time == left_.time &&
                       motion.q.displacement == left_.q.displacement && motion.v == left_.v;
    number_ = 0;
    if (!known) {
      detail::begin_stage<S>(system, motion.q, motion.v, 0);
      gradient_.setZero(system.size());
      system.add_gradient(motion.q, gradient_);
    } else if constexpr (S::has_memory) {
      system.begin_step(motion.q, motion.v, 0);
    }
    kick(system, motion.q, v_, report);
    predicted_ = v_ + h * a_;
    v_ += half * a_;
    left_.q = motion.q;
    retract(left_.q, v_, h);
    detail::begin_stage<S>(system, motion.q, motion.v, dt_);
    gradient_.setZero(system.size());
    system.add_gradient(left_.q, gradient_);
    kick(system, left_.q, predicted_, report);
    v_ += half * a_;
    if (report.status == Status::not_finite || !std::isfinite(norm(v_)) ||
        !std::isfinite(norm(left_.q.displacement)))
      return detail::ended(report, Status::not_finite, detail::too_large);
    left_.v = v_;
    motion.q.displacement = left_.q.displacement;
    motion.v.swap(v_);
    left_.time = motion.time += dt_;
    number_ = system.number();
    if constexpr (S::has_memory) system.end_step(motion.q, motion.v, dt_);
    return report;
  }

 private:
  // The acceleration at (q, v) from the gradient there.
  void kick(const S& system, const State<T>& q, const Vector<T>& v, StepReport& report) {
    total_ = gradient_;
    acceleration_.add_damping(system, q, v, total_);
    detail::take_in(acceleration_.divide(system, q, total_, held_, a_), report);
  }

  double dt_;
  Acceleration<S> acceleration_;
  Motion<T> left_;            // what the last step left
  std::uint64_t number_ = 0;  // of the system that gradient_, at left_, is of; 0: of none
  Vector<T> gradient_, total_, p_, held_, v_, predicted_, a_;
};

}  // namespace softsim
