// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "softsim/core/error.hpp"
#include "softsim/core/state.hpp"
#include "softsim/integrator/stability.hpp"
#include "softsim/system/incremental_potential.hpp"

namespace softsim {

/// What a scheme keeps of the step before, and of the start of this one.
template <class T>
struct SchemeHistory {
  bool valid = false;      ///< false before the first step, and where the motion was changed in between
  Vector<T> acceleration;  ///< at q_0, m/s^2
  Vector<T> algorithmic;   ///< the auxiliary acceleration of generalised-alpha, m/s^2
  Vector<T> increment;     ///< difference(q_-1, q_0), m
  Vector<T> velocity;      ///< v_-1, m/s
};

// A scheme of an implicit step says what has to be solved and what follows from the solution:
//  - check(): throws for parameters out of range;
//  - starts_with_force / starts_with_acceleration: what it needs at the start of a step, the second where its
//    history is not valid;
//  - takes_viscous / takes_frames: whether it copes with terms that are damping forces, and with frames;
//  - force_time(h): how long after the start forces are taken;
//  - roots(Omega, xi): what a step does to an oscillator, see stability.hpp;
//  - begin(h, v_0, history, terms): the terms of the step, in terms of d = difference(q_0, q);
//  - end(h, v_0, d, history, v_1): the velocity at the end and the history, after which d is the increment of
//    the whole step.

/// Generalised midpoint rule: forces at q_0 + beta (q_1 - q_0) and v_0 + beta (v_1 - v_0). beta = 1 is
/// backward Euler (first order, damping, L-stable), 1/2 the implicit midpoint rule (second order, keeps the
/// momenta, B-stable), beta < 1/2 is not unconditionally stable. Linearised once a step it is the
/// semi-implicit Euler method of implicitness beta (d'Aulignac 2001, Eq. 3.33), second order for beta = 1/2.
struct Theta {
  double beta = 1;  ///< in (0, 1]

  static constexpr bool starts_with_force = false, starts_with_acceleration = false, takes_viscous = true,
                        takes_frames = true;
  /// @throws std::invalid_argument for beta outside (0, 1]
  void check() const {
    if (!(beta > 0 && beta <= 1))
      invalid(std::string("beta ") + to_text(beta) +
              ": must be in (0, 1]; the method of implicitness 0 is explicit Euler");
  }
  [[nodiscard]] double force_time(double h) const { return beta * h; }
  [[nodiscard]] stability::Roots roots(double Omega, double xi) const {
    return stability::roots([this](stability::Complex z) { return stability::theta(beta, z); }, Omega, xi);
  }

  template <class T>
  void begin(double h, const Vector<T>& v_0, const SchemeHistory<T>&, StepTerms<T>& terms) const {
    const double g = beta * h;
    terms.mass = 1 / (g * g);
    terms.damping = 1 / g;
    terms.fraction = beta;
    terms.inertia = v_0 / static_cast<T>(g);
  }
  template <class T>
  void end(double h, const Vector<T>& v_0, Vector<T>& d, SchemeHistory<T>&, Vector<T>& v_1) const {
    d /= static_cast<T>(beta);
    // v_0 + (d_beta/(beta h) - v_0)/beta
    v_1 = static_cast<T>(1 / (beta * h)) * d;
    if (beta != 1) v_1 -= static_cast<T>((1 - beta) / beta) * v_0;
  }
};

/// The generalised midpoint rule at beta = 1/2.
struct Midpoint : Theta {
  Midpoint() : Theta{0.5} {}
};

/// Trapezoidal rule: the mean of the forces at both ends. Second order, A-stable, neither L- nor B-stable;
/// the same as Newmark's method with beta = 1/4, gamma = 1/2, but needs no acceleration at the start.
struct Trapezoidal {
  static constexpr bool starts_with_force = true, starts_with_acceleration = false, takes_viscous = false,
                        takes_frames = false;  // forces at both ends are in axes that have turned in between
  void check() const {}
  [[nodiscard]] double force_time(double h) const { return h; }
  [[nodiscard]] stability::Roots roots(double Omega, double xi) const {
    return stability::roots(stability::trapezoidal, Omega, xi);
  }

  template <class T>
  void begin(double h, const Vector<T>& v_0, const SchemeHistory<T>&, StepTerms<T>& terms) const {
    terms.mass = 4 / (h * h);
    terms.damping = 2 / h;  // the drift v_0 and the damping force at the start cancel
    terms.inertia = static_cast<T>(4 / h) * v_0;
  }
  template <class T>
  void end(double h, const Vector<T>& v_0, Vector<T>& d, SchemeHistory<T>&, Vector<T>& v_1) const {
    v_1 = static_cast<T>(2 / h) * d - v_0;
  }
};

/// Backward differentiation of second order: v_1 = (3 q_1 - 4 q_0 + q_-1)/(2 h), and the same for v.
/// L-stable, little damping of what is resolved; starts with a step of backward Euler.
struct Bdf2 {
  static constexpr bool starts_with_force = false, starts_with_acceleration = false, takes_viscous = false,
                        takes_frames = true;
  void check() const {}
  [[nodiscard]] double force_time(double h) const { return h; }
  [[nodiscard]] stability::Roots roots(double Omega, double xi) const {
    return stability::roots(stability::bdf2, Omega, xi);
  }

  template <class T>
  void begin(double h, const Vector<T>& v_0, const SchemeHistory<T>& history, StepTerms<T>& terms) const {
    if (!history.valid) {
      terms.drift.setZero(v_0.size());
      return Theta().begin(h, v_0, history, terms);
    }
    terms.mass = 2.25 / (h * h);
    terms.damping = 1.5 / h;
    terms.drift = static_cast<T>(0.5 / h) * history.increment;
    terms.inertia = static_cast<T>(2 / h) * v_0 - static_cast<T>(0.5 / h) * history.velocity +
                    static_cast<T>(0.75 / (h * h)) * history.increment;
  }
  template <class T>
  void end(double h, const Vector<T>& v_0, Vector<T>& d, SchemeHistory<T>& history, Vector<T>& v_1) const {
    if (history.valid)
      v_1 = static_cast<T>(1.5 / h) * d - static_cast<T>(0.5 / h) * history.increment;
    else
      v_1 = d / static_cast<T>(h);
    history.velocity = v_0;
    history.increment = d;
  }
};

/// Newmark's family with the generalised-alpha weights, in the form that fits any manifold of states (Bruls &
/// Cardona 2010): equilibrium holds at the end of the step with the acceleration a_1, and
///   (1 - alpha_m) A_1 + alpha_m A_0 = (1 - alpha_f) a_1 + alpha_f a_0,
///   q_1 = q_0 + h v_0 + h^2 ((1/2 - beta) A_0 + beta A_1),  v_1 = v_0 + h ((1 - gamma) A_0 + gamma A_1).
struct GeneralisedAlphaParameters {
  double alpha_m = 0, alpha_f = 0, beta = 0.25, gamma = 0.5;

  static constexpr bool starts_with_force = false, starts_with_acceleration = true, takes_viscous = false,
                        takes_frames = true;
  /// @throws std::invalid_argument for parameters that make no method
  void check() const {
    if (!(beta > 0 && beta <= 1e3))
      invalid(std::string("Newmark beta ") + to_text(beta) +
              ": must be positive; the method of beta 0 is velocity Verlet");
    if (!(gamma >= 0.5 && gamma <= 1e3))
      invalid(std::string("Newmark gamma ") + to_text(gamma) +
              ": must be at least 1/2, below it motions grow");
    if (!(alpha_m < 1 && alpha_m >= -1e3))
      invalid(std::string("alpha_m ") + to_text(alpha_m) + ": must be below 1");
    if (!(alpha_f < 1 && alpha_f >= -1e3))
      invalid(std::string("alpha_f ") + to_text(alpha_f) + ": must be below 1");
  }
  [[nodiscard]] double force_time(double h) const { return h; }
  [[nodiscard]] stability::Roots roots(double Omega, double xi) const {
    return stability::generalised_alpha(alpha_m, alpha_f, beta, gamma, Omega, xi);
  }

  template <class T>
  void begin(double h, const Vector<T>& v_0, const SchemeHistory<T>& history, StepTerms<T>& terms) const {
    const double per = 1 / (h * h * beta), share = 1 / (1 - alpha_f);
    const Vector<T>&a_0 = history.acceleration, &A_0 = history.algorithmic;
    terms.mass = (1 - alpha_m) * share * per;
    terms.damping = gamma * h * per;
    terms.inertia = static_cast<T>(terms.mass * h) * v_0 +
                    static_cast<T>(terms.mass * h * h * (0.5 - beta) - alpha_m * share) * A_0 +
                    static_cast<T>(alpha_f * share) * a_0;
    terms.drift = static_cast<T>(terms.damping * h - 1) * v_0 +
                  static_cast<T>(terms.damping * h * h * (0.5 - beta) - h * (1 - gamma)) * A_0;
  }
  template <class T>
  void end(double h, const Vector<T>& v_0, Vector<T>& d, SchemeHistory<T>& history, Vector<T>& v_1) const {
    const double per = 1 / (h * h * beta), share = 1 / (1 - alpha_f);
    Vector<T>&a = history.acceleration, &A = history.algorithmic;
    // a becomes a_1, v_1 what A_0 adds to the velocity, then A becomes A_1
    a *= static_cast<T>(-alpha_f * share);
    a += static_cast<T>(alpha_m * share) * A;
    v_1 = v_0 + static_cast<T>(h * (1 - gamma)) * A;
    A *= static_cast<T>(1 - 0.5 / beta);
    A += static_cast<T>(per) * d - static_cast<T>(per * h) * v_0;
    a += static_cast<T>((1 - alpha_m) * share) * A;
    v_1 += static_cast<T>(h * gamma) * A;
  }
};

/// Newmark's method (1959): beta = 1/4, gamma = 1/2 is the trapezoidal rule; gamma > 1/2 damps and is of
/// first order; unconditionally stable for 2 beta >= gamma >= 1/2.
struct NewmarkScheme : GeneralisedAlphaParameters {
  explicit NewmarkScheme(double beta_ = 0.25, double gamma_ = 0.5)
      : GeneralisedAlphaParameters{.beta = beta_, .gamma = gamma_} {}
};

/// Hilber, Hughes & Taylor (1977): second order, unconditionally stable, damps high frequencies.
struct HhtScheme : GeneralisedAlphaParameters {
  /// @param alpha in [-1/3, 0]; 0 is the trapezoidal rule
  /// @throws std::invalid_argument outside
  explicit HhtScheme(double alpha = -0.05)
      : GeneralisedAlphaParameters{
            .alpha_f = -alpha, .beta = (1 - alpha) * (1 - alpha) / 4, .gamma = 0.5 - alpha} {
    if (!(alpha >= -1.0 / 3 - 1e-15 && alpha <= 0))
      invalid(std::string("HHT alpha ") + to_text(alpha) + ": must be in [-1/3, 0]");
  }
};

/// Generalised-alpha (Chung & Hulbert 1993): second order, unconditionally stable, with the spectral radius
/// rho_inf at infinite frequency and the least damping below.
struct GeneralisedAlphaScheme : GeneralisedAlphaParameters {
  /// @param rho_inf in [0, 1]: 1 does not damp, 0 removes in one step what is not resolved
  /// @throws std::invalid_argument outside
  explicit GeneralisedAlphaScheme(double rho_inf = 0.8) {
    if (!(rho_inf >= 0 && rho_inf <= 1))
      invalid(std::string("rho_inf ") + to_text(rho_inf) + ": must be in [0, 1]");
    alpha_m = (2 * rho_inf - 1) / (rho_inf + 1);
    alpha_f = rho_inf / (rho_inf + 1);
    gamma = 0.5 - alpha_m + alpha_f;
    beta = (1 - alpha_m + alpha_f) * (1 - alpha_m + alpha_f) / 4;
  }
};

}  // namespace softsim
