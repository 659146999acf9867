// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "softsim/core/rotation.hpp"
#include "softsim/core/tensor.hpp"
#include "softsim/mesh/samples.hpp"

// Exact torque-free rotations of rigid bodies from the orientation I.

namespace free_rotation {

using V = softsim::Vec3<double>;
using M = softsim::Mat3<double>;

struct Attitude {
  M orientation;
  V velocity;  // angular, in the axes of the body
};

/// Moments J_1 = J_2: the axis of the body goes around the angular momentum L at |L|/J_1, while the body
/// turns about it at (1 - J_3/J_1) omega_3 (Landau & Lifshitz, Mechanics, Sec. 36).
inline Attitude axisymmetric(const V& J, const V& omega, double t) {
  const double rate = (J[2] / J[0] - 1) * omega[2];
  const V L = J.cwiseProduct(omega), axis(0, 0, 1);
  const M back = softsim::rotation_exponential(V(rate * t * axis));
  return {softsim::rotation_exponential(V(t / J[0] * L)) * back.transpose(), back * omega};
}

/// Moments J_1 < J_2 < J_3 (Landau & Lifshitz, Sec. 37) from omega = (a, 0, c), with L^2 > 2 T J_2.
class Jacobi {
 public:
  Jacobi(const V& J, double a, double c) : J_(J), start_(a, 0, c) {
    const double energy = J.dot(start_.cwiseAbs2());  // 2 T
    L2_ = J.cwiseProduct(start_).squaredNorm();
    const double above = energy * J[2] - L2_, below = L2_ - energy * J[0];
    b_ = std::sqrt(above / (J[1] * (J[2] - J[1])));
    rate_ = std::sqrt((J[2] - J[1]) * below / J.prod());
    m_ = (J[1] - J[0]) * above / ((J[2] - J[1]) * below);
  }

  /// After which the velocity is the same again: 4 K/rate by the arithmetic-geometric mean.
  [[nodiscard]] double period() const { return 2 * std::numbers::pi / (means().back()[0] * rate_); }
  [[nodiscard]] Attitude at(double t) const {
    // Of the angles that take the body to axes along L, the precession is an integral.
    double precession = 0;
    constexpr int pieces = 40;
    static const auto rule = softsim::gauss_legendre(10);
    for (int k = 0; k < pieces; ++k)
      for (const softsim::GaussPoint& point : rule) {
        const V w = velocity(t * (k + (1 + point.x) / 2) / pieces);
        const double x = J_[0] * w[0] * w[0] + J_[1] * w[1] * w[1];
        const double y = J_[0] * J_[0] * w[0] * w[0] + J_[1] * J_[1] * w[1] * w[1];
        precession += t / pieces * point.weight / 2 * std::sqrt(L2_) * x / y;
      }
    return {along(0, 0).transpose() * along(t, precession), velocity(t)};
  }

 private:
  // a, c of the arithmetic-geometric mean of 1 and sqrt(1 - m).
  [[nodiscard]] std::array<std::array<double, 2>, 8> means() const {
    std::array<std::array<double, 2>, 8> result;
    double a = 1, b = std::sqrt(1 - m_);
    result[0] = {a, std::sqrt(m_)};
    for (std::size_t k = 1; k < result.size(); ++k) {
      const double c = (a - b) / 2, g = std::sqrt(a * b);
      a = (a + b) / 2;
      b = g;
      result[k] = {a, c};
    }
    return result;
  }
  // Jacobi's functions by Landen's transformation (Abramowitz & Stegun 16.4).
  [[nodiscard]] V velocity(double t) const {
    const auto mean = means();
    const std::size_t n = mean.size() - 1;
    double phi = std::ldexp(mean[n][0] * rate_ * t, static_cast<int>(n));
    for (std::size_t k = n; k > 0; --k) phi = (phi + std::asin(mean[k][1] / mean[k][0] * std::sin(phi))) / 2;
    const double sn = std::sin(phi);
    return {start_[0] * std::cos(phi), b_ * sn, start_[2] * std::sqrt(1 - m_ * sn * sn)};
  }
  // From the body's axes to those with L along the third.
  [[nodiscard]] M along(double t, double precession) const {
    const V L = J_.cwiseProduct(velocity(t));
    const double nutation = std::atan2(std::hypot(L[0], L[1]), L[2]), spin = std::atan2(L[0], L[1]);
    return softsim::rotation_exponential(V(0, 0, precession)) *
           softsim::rotation_exponential(V(nutation, 0, 0)) * softsim::rotation_exponential(V(0, 0, spin));
  }

  V J_, start_;
  double L2_, b_, rate_, m_;
};

}  // namespace free_rotation
