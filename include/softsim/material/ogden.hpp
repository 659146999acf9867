// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "softsim/core/batch.hpp"
#include "softsim/core/error.hpp"
#include "softsim/core/tensor.hpp"
#include "softsim/material/lame.hpp"
#include "softsim/material/stretch_law.hpp"

namespace softsim {

namespace detail {

/// e^y - 1 - y without cancellation.
template <class T>
[[nodiscard]] T exp_remainder(const T& y) {
  using std::abs, std::exp;
  T series = T(1);
  for (int n = 19; n > 2; --n) series = T(1) + series * y * T(1.0 / n);
  return select(abs(y) < T(1), T(T(0.5) * y * y * series), T(exp(y) - T(1) - y));
}

/// sinh(y)/y for |y| <= 1, from z = y^2.
template <class T>
[[nodiscard]] T sinh_quotient(const T& z) {
  T series = T(1);
  for (int n = 8; n > 0; --n) series = T(1) + series * z * T(1.0 / (2 * n * (2 * n + 1)));
  return series;
}

}  // namespace detail

/// One term of `Ogden`: mu in Pa, alpha without unit and not zero, of any sign.
struct OgdenTerm {
  double mu;
  double alpha;
};

/// Ogden's law on isochoric stretches lb_i = J^(-1/3) l_i with a quadratic volumetric energy:
///   w = sum_p mu_p/alpha_p (lb_1^alpha_p + lb_2^alpha_p + lb_3^alpha_p - 3) + K/2 (J - 1)^2
/// (Ogden 1972; Holzapfel 2000, Chapter 6). Where a program or paper writes 2 mu_p/alpha_p^2, its mu_p is
/// mu_p alpha_p / 2 of these. Small strain: shear modulus sum_p mu_p alpha_p / 2, bulk modulus K. One term
/// with alpha = 2 is the isochoric Neo-Hookean law. Defined for J > 0 only; for J < 0, and for J = 0 as far
/// as rounding shows it, no function returns a finite number, which the line search of Newton's method steps
/// back from and every solver reports.
class Ogden : public FromStretches<Ogden> {
 public:
  /// @param terms at least one
  /// @param bulk K, Pa
  /// @throws std::invalid_argument for no term, an alpha of zero, or a small-strain shear or bulk modulus
  /// that is not positive and finite
  Ogden(std::vector<OgdenTerm> terms, double bulk) : terms_(std::move(terms)), bulk_(bulk) {
    if (terms_.empty()) invalid("Ogden: at least one term (mu, alpha) is needed");
    for (std::size_t p = 0; p < terms_.size(); ++p)
      if (!(std::abs(terms_[p].alpha) > 0) || !(std::abs(terms_[p].alpha) <= 1e300))
        invalid(std::string("Ogden: alpha ") + to_text(terms_[p].alpha) + " of term " + std::to_string(p) +
                " must be finite and not zero");
    const double shear = shear_modulus();
    if (!(shear > 0) || !(shear <= 1e300) || !(bulk > 0) || !(bulk <= 1e300))
      invalid(std::string("Ogden: shear modulus ") + to_text(shear) +
              " Pa (half the sum of mu alpha) and bulk modulus " + to_text(bulk) +
              " Pa must be positive and finite");
  }

  /// One term of exponent alpha with the given Young's modulus in Pa and Poisson's ratio at small strain.
  /// @throws std::invalid_argument, see Lame::from_young_poisson and the constructor
  [[nodiscard]] static Ogden from_young_poisson(double E, double nu, double alpha = 2) {
    const Lame lame = Lame::from_young_poisson(E, nu);
    return Ogden({{2 * lame.mu / alpha, alpha}}, lame.lambda + 2 * lame.mu / 3);
  }

  /// The terms as given.
  [[nodiscard]] const std::vector<OgdenTerm>& terms() const { return terms_; }
  /// Shear modulus at small strain, Pa.
  [[nodiscard]] double shear_modulus() const {
    double sum = 0;
    for (const OgdenTerm& term : terms_) sum += 0.5 * term.mu * term.alpha;
    return sum;
  }
  /// Bulk modulus at small strain, Pa.
  [[nodiscard]] double bulk_modulus() const { return bulk_; }

  /// w, J/m^3.
  template <class T>
  [[nodiscard]] T density(const Stretches<T>& s) const {
    const Vec3<T> x = isochoric_logarithms(s);
    const T k = volume_change(s);
    T w = T(bulk_ / 2) * k * k;
    // The logarithms sum to zero, so that the linear parts of the three powers cancel and may be left out.
    for (const OgdenTerm& term : terms_) {
      T sum(0);
      for (int i = 0; i < 3; ++i) sum += detail::exp_remainder(T(T(term.alpha) * x[i]));
      w += T(term.mu / term.alpha) * sum;
    }
    return w;
  }

  /// dw/dl_i = tau_i / l_i with the principal Kirchhoff stresses tau_i, Pa.
  template <class T>
  [[nodiscard]] Vec3<T> first(const Stretches<T>& s) const {
    const Vec3<T> tau = kirchhoff(s, isochoric_logarithms(s));
    return Vec3<T>(tau[0] / s.l[0], tau[1] / s.l[1], tau[2] / s.l[2]);
  }

  /// d^2w/dl_i dl_j, Pa.
  template <class T>
  [[nodiscard]] Mat3<T> second(const Stretches<T>& s) const {
    const Vec3<T> x = isochoric_logarithms(s), tau = kirchhoff(s, x);
    const T k = volume_change(s), J = T(1) + k;
    const T volumetric = T(bulk_) * J * (J + k);  // d(tau_i)/d(ln l_j) of K (J^2 - J)
    Mat3<T> w = Mat3<T>::Constant(volumetric);
    for (const OgdenTerm& term : terms_) {
      const Vec3<T> E = powers(x, term.alpha);
      const T mean = (E[0] + E[1] + E[2]) * T(1.0 / 3), c = T(term.mu * term.alpha);
      for (int i = 0; i < 3; ++i) {
        w(i, i) += c * E[i];
        for (int j = 0; j < 3; ++j) w(i, j) += c * T(1.0 / 3) * (mean - E[i] - E[j]);
      }
    }
    for (int i = 0; i < 3; ++i) {
      w(i, i) -= tau[i];
      for (int j = 0; j < 3; ++j) w(i, j) /= s.l[i] * s.l[j];
    }
    return w;
  }

  /// (w_i - w_j)/(l_i - l_j), to a few machine epsilons of the largest second derivative for any distance of
  /// the stretches: with z = ln(l_i/l_j)/2, differences of powers are products with sinh(alpha z), and z
  /// cancels from the quotient.
  template <class T>
  [[nodiscard]] Vec3<T> difference_quotients(const Stretches<T>& s) const {
    using std::abs, std::sqrt;
    const Vec3<T> x = isochoric_logarithms(s), tau = kirchhoff(s, x);
    Vec3<T> slope = Vec3<T>::Zero(), z, twice_z;  // slope: (tau_i - tau_j)/(2 z)
    for (int k = 0; k < 3; ++k) {
      z[k] = T(0.5) * (x[(k + 1) % 3] - x[(k + 2) % 3]);
      twice_z[k] = T(2) * select(abs(z[k]) > T(0), z[k], T(1));
    }
    for (const OgdenTerm& term : terms_) {
      const Vec3<T> E = powers(x, term.alpha);
      for (int k = 0; k < 3; ++k) {
        const T& E_i = E[(k + 1) % 3];
        const T& E_j = E[(k + 2) % 3];
        const T y = T(term.alpha) * z[k];
        const T near = T(term.alpha) * sqrt(E_i * E_j) * detail::sinh_quotient(T(y * y));
        slope[k] += T(term.mu) * select(abs(y) < T(1), near, T((E_i - E_j) / twice_z[k]));
      }
    }
    Vec3<T> quotients;
    for (int k = 0; k < 3; ++k) {
      const int i = (k + 1) % 3, j = (k + 2) % 3;
      const T product = s.l[i] * s.l[j], near = sqrt(product) * detail::sinh_quotient(T(z[k] * z[k]));
      const T width = select(abs(z[k]) < T(1), near, T((s.l[i] - s.l[j]) / twice_z[k]));
      quotients[k] = T(0.5) * ((s.l[i] + s.l[j]) * slope[k] / width - tau[i] - tau[j]) / product;
    }
    return quotients;
  }

 private:
  // ln(J^(-1/3) l_i); not finite unless all stretches are positive.
  template <class T>
  static Vec3<T> isochoric_logarithms(const Stretches<T>& s) {
    using std::log1p;
    Vec3<T> x;
    for (int i = 0; i < 3; ++i) x[i] = log1p(s.e[i]);
    const T mean = (x[0] + x[1] + x[2]) * T(1.0 / 3);
    for (int i = 0; i < 3; ++i) x[i] -= mean;
    return x;
  }

  // J - 1 with its digits.
  template <class T>
  static T volume_change(const Stretches<T>& s) {
    const T e01 = s.e[0] + s.e[1] + s.e[0] * s.e[1];
    return e01 + s.e[2] + e01 * s.e[2];
  }

  // (e^(alpha x_i)); 1 + y keeps a NaN that a batched exponential might swallow.
  template <class T>
  static Vec3<T> powers(const Vec3<T>& x, double alpha) {
    Vec3<T> E;
    for (int i = 0; i < 3; ++i) {
      const T y = T(alpha) * x[i];
      E[i] = T(1) + (y + detail::exp_remainder(y));
    }
    return E;
  }

  // Principal Kirchhoff stresses.
  template <class T>
  [[nodiscard]] Vec3<T> kirchhoff(const Stretches<T>& s, const Vec3<T>& x) const {
    const T k = volume_change(s);
    Vec3<T> tau = Vec3<T>::Constant(T(T(bulk_) * k * (T(1) + k)));
    for (const OgdenTerm& term : terms_) {
      Vec3<T> m;
      for (int i = 0; i < 3; ++i) {
        const T y = T(term.alpha) * x[i];
        m[i] = y + detail::exp_remainder(y);
      }
      const T mean = (m[0] + m[1] + m[2]) * T(1.0 / 3);
      for (int i = 0; i < 3; ++i) tau[i] += T(term.mu) * (m[i] - mean);
    }
    return tau;
  }

  std::vector<OgdenTerm> terms_;
  double bulk_;
};

}  // namespace softsim
