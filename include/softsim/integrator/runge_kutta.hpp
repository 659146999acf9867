// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "softsim/core/state.hpp"
#include "softsim/integrator/acceleration.hpp"
#include "softsim/integrator/butcher_tableau.hpp"
#include "softsim/integrator/stability.hpp"
#include "softsim/solver/conjugate_gradient.hpp"
#include "softsim/solver/report.hpp"
#include "softsim/system/system.hpp"

namespace softsim {

/// The stages of one explicit Runge-Kutta step in Munthe-Kaas form: the increment u of q_0, rather than q, is
/// what is summed, u_i = h sum_j a_ij k_j with q_i = retract(q_0, u_i) and k_i = dexp_inv(u_i) v_i, beside
/// v_i = v_0 + h sum_j a_ij a(q_j, v_j): the order is then the same on curved manifolds (Munthe-Kaas 1999).
/// Integrators hold one; it changes nothing but what it is given to write.
template <class S>
class RungeKuttaStages {
 public:
  using T = typename S::Scalar;

  /// @param linear for a consistent mass only
  RungeKuttaStages(ButcherTableau tableau, const ConjugateGradient& linear)
      : tableau_(std::move(tableau)), acceleration_(linear), k_(tableau_.stages()), a_(tableau_.stages()) {}

  /// The method.
  [[nodiscard]] const ButcherTableau& tableau() const { return tableau_; }

  /// A step of h in s from `motion`, whose prescribed components move at p in m/s, into q_1 and v_1. The
  /// status is `not_finite` if a number in them is not; they are then of no use.
  StepReport advance(Stepped<S> system, const Motion<T>& motion, double h, const Vector<T>& p, State<T>& q_1,
                     Vector<T>& v_1) {
    StepReport report;
    report.status = Status::converged;
    acceleration_.start(system, motion.v, p, static_cast<T>(h), v_0_, held_);
    for (std::size_t i = 0; i < tableau_.stages(); ++i) {
      detail::begin_stage<S>(system, motion.q, motion.v, h * tableau_.c(i));
      const auto row = [&](std::size_t j) { return h * tableau_.a(i, j); };
      sum(k_, i, row, u_);
      v_1 = v_0_;
      add(a_, i, row, v_1);
      q_1 = motion.q;
      retract(q_1, u_);
      k_[i] = v_1;
      dexp_inv(motion.q, u_, k_[i]);
      detail::take_in(acceleration_(system, q_1, v_1, held_, a_[i]), report);
      if (report.status == Status::not_finite) return report;
    }
    const auto weight = [&](std::size_t i) { return h * tableau_.b(i); };
    sum(k_, tableau_.stages(), weight, u_);
    v_1 = v_0_;
    add(a_, tableau_.stages(), weight, v_1);
    q_1 = motion.q;
    retract(q_1, u_);
    if (!std::isfinite(norm(v_1)) || !std::isfinite(norm(q_1.displacement)))
      return detail::ended(report, Status::not_finite, detail::too_large);
    return report;
  }

  /// Increment of the last `advance`, m.
  [[nodiscard]] const Vector<T>& increment() const { return u_; }
  /// What the last `advance`, of h, differs by from the embedded method: its increment, m, and velocity, m/s.
  void error(double h, Vector<T>& of_u, Vector<T>& of_v) const {
    const auto weight = [&](std::size_t i) { return h * (tableau_.b(i) - tableau_.b_hat(i)); };
    sum(k_, tableau_.stages(), weight, of_u);
    sum(a_, tableau_.stages(), weight, of_v);
  }

 private:
  template <class Weight>
  static void add(const std::vector<Vector<T>>& x, std::size_t count, Weight weight, Vector<T>& y) {
    for (std::size_t j = 0; j < count; ++j)
      if (const T w = static_cast<T>(weight(j)); w != T(0)) y += w * x[j];
  }
  template <class Weight>
  void sum(const std::vector<Vector<T>>& x, std::size_t count, Weight weight, Vector<T>& y) const {
    y.setZero(v_0_.size());
    add(x, count, weight, y);
  }

  ButcherTableau tableau_;
  Acceleration<S> acceleration_;
  std::vector<Vector<T>> k_, a_;
  Vector<T> v_0_, held_, u_;
};

/// Options of `RungeKutta`.
struct RungeKuttaOptions {
  double dt = 0;                                                        ///< step, s
  ButcherTableau tableau = ButcherTableau::rk4();                       ///< the method
  ConjugateGradient linear{.max_iterations = 500, .tolerance = 1e-12};  ///< for a consistent mass matrix only
};

/// Explicit Runge-Kutta methods with one step size; see `RungeKuttaStages` and `Acceleration`. Of the order
/// of the tableau where forces are as smooth as that. With terms that remember: of order 2 at most, which is
/// what their histories are; stages ask for forces at their own time. Reports carry the iterations of all
/// mass solves and the largest residual.
template <class S>
class RungeKutta {
 public:
  using T = typename S::Scalar;

  /// @throws std::invalid_argument unless dt is positive
  explicit RungeKutta(const RungeKuttaOptions& options)
      : dt_(options.dt), stages_(options.tableau, options.linear) {
    detail::check_dt(options.dt);
  }

  /// The step, s.
  [[nodiscard]] double dt() const { return dt_; }
  /// Changes the step. @throws std::invalid_argument unless it is positive
  void set_dt(double dt) {
    detail::check_dt(dt);
    dt_ = dt;
  }
  /// The method.
  [[nodiscard]] const ButcherTableau& tableau() const { return stages_.tableau(); }
  /// Growth of an oscillator's amplitude over one step.
  [[nodiscard]] double spectral_radius(double Omega, double xi) const {
    const auto R = [&](stability::Complex z) { return tableau().stability_function(z); };
    return stability::spectral_radius(R, Omega, xi);
  }

  /// Advances the motion by dt. If the result is not finite the motion stays as it was.
  StepReport step(Stepped<S> system, Motion<T>& motion) {
    Acceleration<S>::prescribed_velocity(system, motion.q, static_cast<T>(dt_), p_);
    const StepReport report = stages_.advance(system, motion, dt_, p_, next_, v_);
    if (report.status == Status::not_finite) return report;
    motion.q.displacement.swap(next_.displacement);
    motion.v.swap(v_);
    motion.time += dt_;
    if constexpr (S::has_memory) system.end_step(motion.q, motion.v, dt_);
    return report;
  }

 private:
  double dt_;
  RungeKuttaStages<S> stages_;
  Vector<T> p_, v_;
  State<T> next_;
};

/// Options of `ExplicitEuler`.
struct ExplicitEulerOptions {
  double dt = 0;                                                        ///< step, s
  ConjugateGradient linear{.max_iterations = 500, .tolerance = 1e-12};  ///< for a consistent mass matrix only
};

/// Explicit (forward) Euler, q_1 = q_0 + h v_0, v_1 = v_0 + h a(q_0, v_0): first order, and never stable
/// without damping. For comparison; `SemiExplicitEuler` costs the same.
template <class S>
class ExplicitEuler : public RungeKutta<S> {
 public:
  /// @throws std::invalid_argument unless dt is positive
  explicit ExplicitEuler(const ExplicitEulerOptions& options)
      : RungeKutta<S>({options.dt, ButcherTableau::explicit_euler(), options.linear}) {}
};

}  // namespace softsim
