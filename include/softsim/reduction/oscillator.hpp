// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <string>

#include "softsim/core/error.hpp"

namespace softsim {

/// One step of h of the oscillator a'' + c a' + omega^2 a = p under a constant p, exact to rounding whatever
/// omega, c >= 0: underdamped, critical, overdamped, and free (omega = 0). With G(t) the velocity after a
/// unit step of p at rest, the solution is made of G(h), its integral, and nothing else:
///   a_1 = (1 - omega^2 I) a + G v + I p,   v_1 = -omega^2 G a + (1 - omega^2 I - c G) v + G p,  I = int G
///   dt.
struct OscillatorStep {
  double omega_squared = 0, damping = 0;  ///< (rad/s)^2, 1/s
  double G = 0, integral = 0;             ///< s, s^2

  OscillatorStep() = default;
  /// @param omega rad/s
  /// @param c twice the damping ratio times omega, 1/s
  /// @param h step, s
  /// @throws std::invalid_argument for omega or c < 0, h <= 0, or one that is not finite
  OscillatorStep(double omega, double c, double h) : omega_squared(omega * omega), damping(c) {
    if (!(omega >= 0) || !std::isfinite(omega_squared))
      invalid(std::string("omega ") + to_text(omega) + " rad/s: must not be negative, and finite");
    if (!(c >= 0) || !std::isfinite(c))
      invalid(std::string("damping ") + to_text(c) + " 1/s: must not be negative, and finite");
    if (!(h > 0) || !std::isfinite(h))
      invalid(std::string("dt ") + to_text(h) + " s: must be positive and finite");
    if (omega * h < 0.5 && c * h < 1)
      series(h);
    else if (const double s = c / 2; omega > s)
      underdamped(omega, s, h);
    else
      overdamped(omega, s, h);
  }

  /// Moves (a, v) on by one step under p.
  void advance(double& a, double& v, double p) const {
    const double response = p - omega_squared * a;  // what accelerates at rest: no digits lost at equilibrium
    a += G * v + integral * response;
    v += G * response - (omega_squared * integral + damping * G) * v;
  }

 private:
  // Taylor series of G: G'' = -c G' - omega^2 G, G(0) = 0, G'(0) = 1. Its terms fall like 1.5^k / k!.
  void series(double h) {
    double before = 0, term = h;  // G^(k-1) h^(k-1) / (k-1)! and the next
    for (int k = 1; k < 30; ++k) {
      G += term;
      integral += term * h / (k + 1);
      const double next = -(damping * h * term + omega_squared * h * h / k * before) / (k + 1);
      before = term;
      term = next;
    }
  }
  void underdamped(double omega, double s, double h) {
    const double w = std::sqrt((omega - s) * (omega + s)), decay = std::exp(-s * h);
    const double sine = w * h < 1e-8 ? h : std::sin(w * h) / w;
    G = decay * sine;
    integral = (1 - decay * (std::cos(w * h) + s * sine)) / omega_squared;
  }
  // G = (exp(-r t) - exp(-f t)) / (2 m) with the roots r, f = s -+ m.
  void overdamped(double omega, double s, double h) {
    const double m = std::sqrt((s - omega) * (s + omega)), fast = s + m, slow = omega_squared / fast;
    if (m * h < 0.1) {  // nearly critical: the roots' difference would lose its digits
      const double decay = std::exp(-s * h), sine = m * h < 1e-8 ? h : std::sinh(m * h) / m;
      G = decay * sine;
      integral = (1 - decay * (std::cosh(m * h) + s * sine)) / omega_squared;
      return;
    }
    G = std::exp(-slow * h) * -std::expm1(-2 * m * h) / (2 * m);
    const auto area = [h](double rate) { return rate * h < 1e-300 ? h : -std::expm1(-rate * h) / rate; };
    integral = (area(slow) - area(fast)) / (2 * m);
  }
};

}  // namespace softsim
