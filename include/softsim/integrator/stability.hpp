// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <concepts>
#include <cstddef>
#include <functional>
#include <limits>

/// What one step of a method does to an oscillator u'' + 2 xi omega u' + omega^2 u = 0, as numbers: Omega =
/// omega h is the step in units of the oscillator, xi >= 0 the damping ratio. Methods for first-order
/// equations have a stability function R(z): y' = lambda y goes to R(h lambda) y. Methods for second-order
/// equations have an amplification matrix for (u, h u', h^2 u'').
namespace softsim::stability {

using Complex = std::complex<double>;

// ---------------------------------------------------------------- stability functions

/// R(z) of some method: a function of complex z.
template <class R>
concept StabilityFunction = requires(const R& r, Complex z) {
  { std::invoke(r, z) } -> std::convertible_to<Complex>;
};

/// Backward Euler, 1/(1 - z).
[[nodiscard]] inline Complex backward_euler(Complex z) { return 1.0 / (1.0 - z); }
/// Theta method with weight beta on the end of the step, (1 + (1 - beta) z)/(1 - beta z): 0 explicit Euler,
/// 1/2 trapezoidal, 1 backward Euler (d'Aulignac 2001, Eq. 3.33).
[[nodiscard]] inline Complex theta(double beta, Complex z) {
  return (1.0 + (1 - beta) * z) / (1.0 - beta * z);
}
/// Trapezoidal rule and implicit midpoint, which differ on nonlinear problems only.
[[nodiscard]] inline Complex trapezoidal(Complex z) { return theta(0.5, z); }
/// BDF2: the root of (3/2 - z) r^2 - 2 r + 1/2 = 0 that is larger in absolute value.
[[nodiscard]] inline Complex bdf2(Complex z) {
  // r = (2 +- s)/(3 - 2 z) and 3 - 2 z = (2 - s)(2 + s)
  const Complex s = std::sqrt(1.0 + 2.0 * z);
  const Complex a = 2.0 - s, b = 2.0 + s;
  return 1.0 / (std::abs(a) < std::abs(b) ? a : b);
}

// ---------------------------------------------------------------- roots

/// Eigenvalues of one step, those beyond `count` unused. The first two are the principal ones: the pair that
/// tends to exp(z).
struct Roots {
  std::array<Complex, 3> value{};
  std::size_t count = 2;
};

/// h lambda of the oscillator: Omega (-xi +- i sqrt(1 - xi^2)), both real if xi > 1.
[[nodiscard]] inline std::array<Complex, 2> oscillator(double Omega, double xi) {
  if (xi <= 1) {
    const Complex z(-xi * Omega, Omega * std::sqrt((1 - xi) * (1 + xi)));
    return {z, std::conj(z)};
  }
  const double fast = -Omega * (xi + std::sqrt((xi - 1) * (xi + 1)));
  return {Complex(Omega / fast * Omega), Complex(fast)};  // the product of the two is Omega^2
}

/// Roots of a method with stability function R.
template <StabilityFunction R>
[[nodiscard]] Roots roots(const R& R_of, double Omega, double xi) {
  const auto z = oscillator(Omega, xi);
  return {{std::invoke(R_of, z[0]), std::invoke(R_of, z[1])}, 2};
}

namespace detail {

// Roots r = 1 + m of m^2 + p m + s: small steps have roots close to 1, whose distance from it is what counts.
// A pair has the modulus sqrt(1 - p + s) to the last digit, so that a method that conserves, p = s, is seen
// to.
inline Roots quadratic(double p, double s) {
  const double radicand = p * p / 4 - s;
  if (radicand < 0) {
    const Complex r(1 - p / 2, std::sqrt(-radicand));
    const Complex exact = r * (std::sqrt(1 - p + s) / std::abs(r));
    return {{exact, std::conj(exact)}, 2};
  }
  const double large = -(p / 2 + std::copysign(std::sqrt(radicand), p));
  return {{Complex(1 + (large == 0 ? 0 : s / large)), Complex(1 + large)}, 2};
}

using Matrix = std::array<std::array<double, 3>, 3>;

// Eigenvalues of I + A: one real eigenvalue of A by Newton's method with bisection, then the other two.
inline Roots eigenvalues_of_identity_plus(const Matrix& A) {
  const auto minor = [&](std::size_t i, std::size_t j) { return A[i][i] * A[j][j] - A[i][j] * A[j][i]; };
  const double a = A[0][0] + A[1][1] + A[2][2], b = minor(0, 1) + minor(0, 2) + minor(1, 2);
  const double c = A[0][0] * minor(1, 2) - A[0][1] * (A[1][0] * A[2][2] - A[1][2] * A[2][0]) +
                   A[0][2] * (A[1][0] * A[2][1] - A[1][1] * A[2][0]);
  double low = -1 - std::max({std::abs(a), std::abs(b), std::abs(c)}), high = -low, m = low / 2;
  for (int k = 0; k < 200; ++k) {
    const double value = ((m - a) * m + b) * m - c, slope = (3 * m - 2 * a) * m + b;
    if (value == 0) break;
    (value < 0 ? low : high) = m;
    double next = m - value / slope;
    if (!(next > low && next < high)) next = low + (high - low) / 2;
    if (!(next > low && next < high)) break;
    const bool still = std::abs(next - m) <= std::numeric_limits<double>::epsilon() * std::abs(next);
    m = next;
    if (still) break;
  }
  // Two forms of the same number; the first cancels where m is the smallest of the three.
  const double product = std::abs(m) > 0.1 ? c / m : b - m * (a - m);
  Roots both = quadratic(m - a, product);
  both.value[2] = 1 + m;
  both.count = 3;
  return both;
}

}  // namespace detail

// ---------------------------------------------------------------- methods for second-order equations

/// Semi-explicit (symplectic) Euler with the damping force at the start of the step, as `SemiExplicitEuler`:
/// stable up to Omega = 2 (sqrt(1 + xi^2) - xi).
[[nodiscard]] inline Roots semi_explicit_euler(double Omega, double xi) {
  const double d = 2 * xi * Omega, o = Omega * Omega;
  return detail::quadratic(d + o, o);
}

/// Velocity Verlet as `VelocityVerlet`: both kicks half the acceleration, at the end with the velocity
/// v_0 + h a_0 in the damping force. Without damping stable up to Omega = 2.
[[nodiscard]] inline Roots velocity_verlet(double Omega, double xi) {
  const double d = 2 * xi * Omega, o = Omega * Omega;
  // (u_1, w_1) = A (u_0, w_0) with w = h v
  const double uw = 1 - d / 2, less_uu = o / 2, less_ww = (d + o * uw + d * (1 - d)) / 2;
  if (d == 0) return detail::quadratic(o, o);
  return detail::quadratic(less_uu + less_ww, less_uu * less_ww + uw * o * (1 - o / 4 - d / 2));
}

/// Generalised-alpha of Chung & Hulbert 1993 with any of its four parameters: inertia at 1 - alpha_m, other
/// forces at 1 - alpha_f. alpha_m = 0: HHT; both 0: Newmark.
[[nodiscard]] inline Roots generalised_alpha(double alpha_m, double alpha_f, double beta, double gamma,
                                             double Omega, double xi) {
  const double d = 2 * xi * Omega, o = Omega * Omega, f = 1 - alpha_f;
  const double inertia = 1 - alpha_m + f * (gamma * d + beta * o);
  // The new acceleration from (u, w, a), w = h u', a = h^2 u''; then u and w by Newmark's formulas.
  const std::array<double, 3> next{-o / inertia, -(d + f * o) / inertia,
                                   -(alpha_m + f * ((1 - gamma) * d + (0.5 - beta) * o)) / inertia};
  detail::Matrix A{{{0, 1, 0.5 - beta}, {0, 0, 1 - gamma}, {0, 0, -1}}};  // less the identity
  for (std::size_t j = 0; j < 3; ++j) {
    A[0][j] += beta * next[j];
    A[1][j] += gamma * next[j];
    A[2][j] += next[j];
  }
  return detail::eigenvalues_of_identity_plus(A);
}
/// Generalised-alpha with the spectral radius rho_inf in [0, 1] that it has for Omega -> infinity: alpha_m =
/// (2 rho - 1)/(rho + 1), alpha_f = rho/(rho + 1), gamma = 1/2 - alpha_m + alpha_f, beta = (1 - alpha_m +
/// alpha_f)^2/4.
[[nodiscard]] inline Roots generalised_alpha(double rho_inf, double Omega, double xi) {
  const double alpha_m = (2 * rho_inf - 1) / (rho_inf + 1), alpha_f = rho_inf / (rho_inf + 1);
  const double shift = alpha_f - alpha_m;
  return generalised_alpha(alpha_m, alpha_f, (1 + shift) * (1 + shift) / 4, 0.5 + shift, Omega, xi);
}
/// Hilber, Hughes & Taylor 1977 with alpha in [-1/3, 0]: forces at 1 + alpha, gamma = 1/2 - alpha, beta =
/// (1 - alpha)^2/4.
[[nodiscard]] inline Roots hht(double alpha, double Omega, double xi) {
  return generalised_alpha(0, -alpha, (1 - alpha) * (1 - alpha) / 4, 0.5 - alpha, Omega, xi);
}
/// Newmark 1959. (1/4, 1/2) is the trapezoidal rule, (0, 1/2) central differences with the damping force at
/// the end implicit.
[[nodiscard]] inline Roots newmark(double beta, double gamma, double Omega, double xi) {
  const double d = 2 * xi * Omega, o = Omega * Omega, D = 1 + gamma * d + beta * o;
  // the acceleration is a function of (u, w) at both ends: two roots
  return detail::quadratic((d + (gamma + 0.5) * o) / D, o / D);
}

// ---------------------------------------------------------------- what to make of them

/// Largest absolute value of the roots: at most 1 where the method is stable (and then growth over many steps
/// is possible only at a double root on the unit circle).
[[nodiscard]] inline double spectral_radius(const Roots& roots) {
  double largest = 0;
  for (std::size_t k = 0; k < roots.count; ++k) largest = std::max(largest, std::abs(roots.value[k]));
  return largest;
}
/// The same of a method with stability function R.
template <StabilityFunction R>
[[nodiscard]] double spectral_radius(const R& R_of, double Omega, double xi) {
  return spectral_radius(roots(R_of, Omega, xi));
}

/// Period of the discrete oscillation over the exact one, less 1, from the principal root (its angle must be
/// less than pi a step); xi < 1. Positive: the method is slow. NaN if the root does not oscillate.
[[nodiscard]] inline double period_error(const Roots& roots, double Omega, double xi = 0) {
  const double angle = std::abs(std::arg(roots.value[0]));
  if (roots.value[0].imag() == 0) return std::numeric_limits<double>::quiet_NaN();
  return Omega * std::sqrt((1 - xi) * (1 + xi)) / angle - 1;
}
/// Damping ratio of the discrete oscillation, -ln|r|/angle of the principal root r (Hughes 1987): all of it
/// numerical if xi = 0; the exact solution's is xi/sqrt(1 - xi^2). NaN if the root does not oscillate.
[[nodiscard]] inline double damping_ratio(const Roots& roots) {
  if (roots.value[0].imag() == 0) return std::numeric_limits<double>::quiet_NaN();
  return -std::log(std::abs(roots.value[0])) / std::abs(std::arg(roots.value[0]));
}

}  // namespace softsim::stability
