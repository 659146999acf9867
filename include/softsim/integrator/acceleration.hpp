// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <tuple>
#include <type_traits>

#include "softsim/core/error.hpp"
#include "softsim/core/state.hpp"
#include "softsim/solver/conjugate_gradient.hpp"
#include "softsim/solver/mass_solve.hpp"
#include "softsim/solver/report.hpp"
#include "softsim/system/system.hpp"

namespace softsim {

namespace detail {
inline void check_dt(double dt) {
  if (!(dt > 0) || !(dt <= 1e300))
    invalid(std::string("dt ") + to_text(dt) + " s: must be positive and finite");
}
inline constexpr std::string_view too_large =
    "the velocity is not finite: the step is too large, or a free point has no mass";
inline constexpr std::string_view mass_ran_out =
    "conjugate gradients on the mass matrix: too many iterations";

// Takes one mass solve into the report of its step: the worst status and residual, all iterations.
inline void take_in(const LinearReport& solved, StepReport& report) {
  report.linear_iterations += solved.iterations;
  report.residual = std::max(report.residual, solved.residual);
  if (solved.status == Status::converged || report.status == Status::not_finite) return;
  report.status = solved.status;
  report.reason = solved.status == Status::not_finite ? too_large : mass_ran_out;
}

// Tells the terms that remember that forces are asked for a time `ahead` after (q, v), where a step starts,
// as the stages of one do. Damping forces are taken at the velocity instead, which is what ahead = 0 means to
// their terms.
template <class S>
void begin_stage(Stepped<S> system, const State<typename S::Scalar>& q, const Vector<typename S::Scalar>& v,
                 double ahead) {
  if constexpr (S::has_memory) {
    const auto begin = [&](auto& term) {
      if constexpr (requires { term.begin_step(q, v, ahead); })
        term.begin_step(q, v, is_viscous<std::decay_t<decltype(term)>> ? 0 : std::max(0.0, ahead));
    };
    std::apply([&](auto&... term) { (begin(term), ...); }, system.terms);
  }
}
}  // namespace detail

/// The right-hand side that explicit integrators share: accelerations of the free components,
///   a(q, v) = M^-1 (-dE/dq - D(q, v)),  D = alpha M v + beta K(q) v + damping forces of the terms, and the
/// gyroscopic forces of frames, whose velocities and accelerations are those in the axes of the body.
/// A prescribed component moves with constant velocity during a step, (target - q_0)/h, and arrives at its
/// end; its acceleration, and the entry of a, is 0.
template <class S>
class Acceleration {
 public:
  using T = typename S::Scalar;

  /// @param linear for a consistent mass only
  explicit Acceleration(const ConjugateGradient& linear) : mass_(linear) {}

  /// p = (target - q)/h on prescribed components, 0 on free ones, m/s.
  static void prescribed_velocity(const S& system, const State<T>& q, T h, Vector<T>& p) {
    p.resize(system.size());
    system.prescribed.increment(q, p);
    p /= h;
  }
  /// Velocities a step starts with, m/s: v with p on prescribed components. `held` becomes (p - v)/h there
  /// and 0 elsewhere: what their change of velocity, spread over the step, pulls with on neighbours through a
  /// consistent mass.
  static void start(const S& system, const Vector<T>& v, const Vector<T>& p, T h, Vector<T>& v_0,
                    Vector<T>& held) {
    v_0 = v;
    held.setZero(v.size());
    const Vector<T>& free = system.prescribed.free();
    for (std::ptrdiff_t k = 0; k < v.size(); ++k)
      if (k % block_stride != 3 && free[k] == T(0)) {
        v_0[k] = p[k];
        held[k] = (p[k] - v[k]) / h;
      }
  }

  /// y += D(q, v) and the gyroscopic forces of frames, N.
  void add_damping(const S& system, const State<T>& q, const Vector<T>& v, Vector<T>& y) {
    system.add_damping_product(q, v, y);
    if (system.damping.beta != 0) {
      scaled_ = static_cast<T>(system.damping.beta) * v;
      system.add_elastic_hessian_product(q, scaled_, y);
    }
    if (system.damping.alpha != 0) system.mass.add_product(q, v, static_cast<T>(system.damping.alpha), y);
    system.mass.add_gyroscopic(q, v, T(1), y);
  }
  /// a = -M^-1 g for a gradient g, N, whose damping is in it already.
  LinearReport divide(const S& system, const State<T>& q, const Vector<T>& g, const Vector<T>& held,
                      Vector<T>& a) {
    force_ = -g;
    return mass_.solve(system, q, force_, held, a);
  }
  /// a(q, v), m/s^2.
  LinearReport operator()(const S& system, const State<T>& q, const Vector<T>& v, const Vector<T>& held,
                          Vector<T>& a) {
    gradient_.setZero(system.size());
    system.add_gradient(q, gradient_);
    add_damping(system, q, v, gradient_);
    return divide(system, q, gradient_, held, a);
  }

 private:
  MassSolve<S> mass_;
  Vector<T> gradient_, scaled_, force_;
};

}  // namespace softsim
