// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <cstddef>

#include "softsim/core/batch.hpp"
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
    bool finite = true;
    if (system.mass.is_lumped() && system.frames() == 0) {
      finite = kick_and_drift(system, motion, h);
    } else {
      // Prescribed components first: they reach their target at the end of the step, and their acceleration
      // is known.
      acceleration_.prescribed_velocity(system, motion.q, h, p_);
      acceleration_.start(system, motion.v, p_, h, v_, held_);
      detail::take_in(acceleration_(system, motion.q, motion.v, held_, a_), report);
      v_ += h * a_;
      next_ = motion.q;
      retract(next_, v_, h);
      finite = report.status != Status::not_finite && std::isfinite(norm(next_.displacement));
    }
    if (!finite) return detail::ended(report, Status::not_finite, detail::too_large);
    motion.q.displacement.swap(next_.displacement);
    motion.v.swap(v_);
    motion.time += options_.dt;
    if constexpr (S::has_memory) system.end_step(motion.q, motion.v, options_.dt);
    return report;
  }

 private:
  // v_1 and q_1 with a lumped mass, in one pass after the forces: the vectors together take as long as a
  // quarter of a force. False if q_1 is not finite.
  bool kick_and_drift(const S& system, const Motion<T>& motion, T h) {
    a_.setZero(system.size());
    system.add_gradient(motion.q, a_);
    acceleration_.add_damping(system, motion.q, motion.v, a_);
    v_.resize(system.size());
    next_.displacement.resize(system.size());
    using Block = Batch<T, block_stride>;
    const auto at = [](const Vector<T>& x, std::ptrdiff_t k) { return Block::load(x.data() + k); };
    const Block step(h), zero(T(0));
    Block sum = zero;
    for (std::ptrdiff_t k = 0; k < v_.size(); k += block_stride) {
      const Block q = at(motion.q.displacement, k), held = (at(system.prescribed.target(), k) - q) / step,
                  moved = at(motion.v, k) - step * at(a_, k) / at(system.mass.diagonal(), k),
                  v = select(at(system.prescribed.free(), k) == zero, held, moved), next = q + step * v;
      v.store(v_.data() + k);
      next.store(next_.displacement.data() + k);
      sum += next - next;  // 0, or not a number
    }
    return all(sum == zero);
  }

  SemiExplicitEulerOptions options_;
  Acceleration<S> acceleration_;
  Vector<T> p_, held_, v_, a_;
  State<T> next_;
};

}  // namespace softsim
