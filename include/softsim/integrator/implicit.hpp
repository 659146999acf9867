// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <string_view>

#include "softsim/integrator/acceleration.hpp"
#include "softsim/integrator/schemes.hpp"
#include "softsim/integrator/stability.hpp"
#include "softsim/solver/newton.hpp"
#include "softsim/system/system.hpp"

namespace softsim {

/// Options of an implicit integrator with the given scheme and linear method.
template <class Scheme, class Method = ConjugateGradient>
struct ImplicitOptions {
  double dt = 0;  ///< step, s
  Scheme scheme = Scheme();
  bool newton = false;  ///< false: one linearised solve a step; true: Newton's method to tolerance
  double tolerance =
      1e-6;  ///< Newton: residual over external load; linearised: relative residual of the linear solve
  int max_newton_iterations = 50;
  Method linear = {};
  bool warm_start = true;  ///< the linearised solve starts from h v_0, else from zero
  int update_every = 1;    ///< Newton iterations with one tangent; 0: one a step
  bool frozen = false;     ///< one tangent for all steps, until `newton().refresh()` (Desbrun et al. 1999)
};

/// Implicit integration by a scheme (`Theta`, `Trapezoidal`, `Bdf2`, `NewmarkScheme`, `HhtScheme`,
/// `GeneralisedAlphaScheme`), either with one linearised solve a step (Baraff & Witkin 1998, "Large steps in
/// cloth simulation"), which keeps the order of the scheme, or with Newton's method to convergence. The
/// linearised step is its first iteration. One preconditioning with frozen diagonal blocks and no warm start
/// (`MatrixFree`, `BlockJacobi`, `Stationary{.max_iterations = 1, .fixed = true}`) is the decoupled method of
/// Debunne et al. 2001.
///
/// Frames have velocities and accelerations in the axes of their bodies, and increments of rotation for
/// displacements (Bruls & Cardona 2010), with the order of the scheme under Newton's method. Its tangent
/// leaves out what makes it unsymmetric, so that it converges the slower the more a frame turns in a step. A
/// linearised step takes gyroscopic forces at its start, and is of first order.
///
/// Prescribed components move with constant velocity to their target; their velocity at the end of the step
/// is that one. Terms with a history are told the time at which the scheme takes forces; viscous ones take
/// part in `Theta` schemes only.
template <class Scheme, class S, class Operator = Assembled,
          template <class> class Preconditioner = DefaultPreconditioner<Operator>::template type,
          class Method = ConjugateGradient>
class Implicit {
 public:
  using T = typename S::Scalar;
  using Options = ImplicitOptions<Scheme, Method>;
  static_assert(!S::viscous || Scheme::takes_viscous,
                "viscous elements (Kelvin-Voigt) take part in the generalised midpoint rule only");

  /// @throws std::invalid_argument unless dt and tolerance are positive and the scheme's parameters in range
  explicit Implicit(const Options& options)
      : options_(options),
        newton_({.max_iterations = options.max_newton_iterations,
                 .tolerance = options.tolerance,
                 .linear = linear_of(options),
                 .update_every = options.update_every,
                 .frozen = options.frozen}) {
    detail::check_dt(options.dt);
    options.scheme.check();
  }

  /// The step in s; may be changed between steps. Schemes with a memory begin anew then.
  [[nodiscard]] double dt() const { return options_.dt; }
  /// @throws std::invalid_argument unless it is positive
  void set_dt(double dt) {
    detail::check_dt(dt);
    if (dt != options_.dt) history_.valid = false;
    options_.dt = dt;
  }
  /// Growth of an oscillator's amplitude over one step.
  [[nodiscard]] double spectral_radius(double Omega, double xi) const {
    return stability::spectral_radius(options_.scheme.roots(Omega, xi));
  }
  /// Newton's method, for its preconditioner's options and its callback.
  [[nodiscard]] auto& newton() { return newton_; }

  /// Advances the motion by dt. If the result is not finite the motion stays as it was; if it did not
  /// converge the motion takes the last iterate.
  StepReport step(Stepped<S> system, Motion<T>& motion) {
    using detail::ended;
    const double h = options_.dt;
    const Scheme& scheme = options_.scheme;
    StepReport report;
    start_ = motion.q;
    if constexpr (S::has_memory) system.begin_step(motion.q, motion.v, 0);
    if (history_.valid &&
        !(motion.time == time_ && motion.v == v_ && motion.q.displacement == q_.displacement))
      history_.valid = false;
    if constexpr (Scheme::starts_with_acceleration) {
      if (!history_.valid) {
        none_.setZero(system.size());
        const LinearReport solved = acceleration_(system, motion.q, motion.v, none_, history_.acceleration);
        if (solved.status != Status::converged) return ended(report, solved.status, solved.reason);
        history_.algorithmic = history_.acceleration;
      }
    }
    if constexpr (Scheme::starts_with_force) {
      terms_.constant.setZero(system.size());
      system.add_gradient(start_, terms_.constant);
    }
    if constexpr (S::has_memory) system.begin_step(motion.q, motion.v, scheme.force_time(h));
    scheme.begin(h, motion.v, history_, terms_);
    if (system.frames() > 0) {
      if constexpr (!Scheme::takes_frames)
        return ended(report, Status::not_converged,
                     "the trapezoidal rule does not take frames: Newmark's method does");
      terms_.gyroscopic = options_.newton;
      if (!options_.newton) {
        terms_.constant.setZero(system.size());
        system.mass.add_gyroscopic(motion.q, motion.v, T(1), terms_.constant);
      }
    }
    potential_.set_step(system, start_, terms_);
    next_ = start_;
    if (options_.newton) {
      report = newton_.minimise(potential_, next_);
      difference(start_, next_, d_);
    } else {
      if (options_.warm_start)
        d_ = static_cast<T>(h * terms_.fraction) * motion.v;  // the velocity changes little
      else
        d_.setZero(system.size());
      const LinearReport linear = newton_.linear_step(potential_, start_, d_);
      report.newton_iterations = 1;
      report.linear_iterations = linear.iterations;
      report.residual = linear.residual;
      report = ended(report, linear.status, linear.reason);
    }
    if (report.status == Status::not_finite) return report;
    // From here on the history changes: it is good again only if the step is.
    scheme.end(h, motion.v, d_, history_, v_);
    next_ = start_;
    retract(next_, d_);
    steady_prescribed(system.prescribed, motion.v, h);
    history_.valid = false;
    if (!std::isfinite(norm(next_.displacement)) || !std::isfinite(norm(v_)))
      return ended(report, Status::not_finite, "the state is not finite");
    motion.q.displacement.swap(next_.displacement);
    motion.v = v_;
    motion.time += h;
    q_ = motion.q;
    time_ = motion.time;
    history_.valid = true;
    if constexpr (S::has_memory) system.end_step(motion.q, motion.v, h);
    return report;
  }

 private:
  static Method linear_of(const Options& options) {
    Method linear = options.linear;
    linear.tolerance = options.tolerance;
    return linear;
  }

  // Velocity and acceleration of prescribed components: those of a steady motion to the target.
  void steady_prescribed(const Prescribed<T>& prescribed, const Vector<T>& v_0, double h) {
    const Vector<T>& free = prescribed.free();
    for (std::ptrdiff_t k = 0; k < v_.size(); ++k) {
      if (free[k] != T(0) || k % block_stride == 3) continue;
      v_[k] = d_[k] / static_cast<T>(h);
      if constexpr (Scheme::starts_with_acceleration)
        history_.acceleration[k] = history_.algorithmic[k] = (v_[k] - v_0[k]) / static_cast<T>(h);
    }
  }

  Options options_;
  Newton<S, Operator, Preconditioner, Method> newton_;
  IncrementalPotential<S> potential_;
  Acceleration<S> acceleration_{ConjugateGradient{.max_iterations = 500, .tolerance = 1e-12}};
  StepTerms<T> terms_;
  SchemeHistory<T> history_;
  State<T> start_, next_, q_;
  Vector<T> d_, v_, none_;
  double time_ = 0;
};

/// Backward Euler, q_1 = q_0 + h v_1, M (v_1 - v_0)/h = forces at (q_1, v_1): first order, unconditionally
/// stable, damping. With another `scheme.beta` the generalised midpoint rule, see `Theta`.
template <class S, class Operator = Assembled,
          template <class> class Preconditioner = DefaultPreconditioner<Operator>::template type,
          class Method = ConjugateGradient>
using BackwardEuler = Implicit<Theta, S, Operator, Preconditioner, Method>;

/// Implicit midpoint rule: `Theta` at 1/2.
template <class S, class Operator = Assembled,
          template <class> class Preconditioner = DefaultPreconditioner<Operator>::template type,
          class Method = ConjugateGradient>
using ImplicitMidpoint = Implicit<Midpoint, S, Operator, Preconditioner, Method>;

/// Newmark's method: `ImplicitOptions::scheme` is a `NewmarkScheme(beta, gamma)`.
template <class S, class Operator = Assembled,
          template <class> class Preconditioner = DefaultPreconditioner<Operator>::template type,
          class Method = ConjugateGradient>
using Newmark = Implicit<NewmarkScheme, S, Operator, Preconditioner, Method>;

/// HHT: `ImplicitOptions::scheme` is an `HhtScheme(alpha)`.
template <class S, class Operator = Assembled,
          template <class> class Preconditioner = DefaultPreconditioner<Operator>::template type,
          class Method = ConjugateGradient>
using Hht = Implicit<HhtScheme, S, Operator, Preconditioner, Method>;

/// Generalised-alpha: `ImplicitOptions::scheme` is a `GeneralisedAlphaScheme(rho_inf)`.
template <class S, class Operator = Assembled,
          template <class> class Preconditioner = DefaultPreconditioner<Operator>::template type,
          class Method = ConjugateGradient>
using GeneralisedAlpha = Implicit<GeneralisedAlphaScheme, S, Operator, Preconditioner, Method>;

}  // namespace softsim
