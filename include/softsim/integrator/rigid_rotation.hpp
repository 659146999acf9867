// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <string>

#include "softsim/core/error.hpp"
#include "softsim/core/rotation.hpp"
#include "softsim/core/tensor.hpp"
#include "softsim/integrator/acceleration.hpp"
#include "softsim/solver/report.hpp"

namespace softsim {

/// A rigid body that turns about its centre of mass or a fixed point.
struct RigidRotation {
  Mat3<double> orientation = Mat3<double>::Identity();  ///< from the body's axes to those of space
  Vec3<double> velocity = Vec3<double>::Zero();         ///< angular velocity in the body's axes, rad/s
  double time = 0;                                      ///< s
};

/// Options of `EnergyMomentumRotation`.
struct EnergyMomentumRotationOptions {
  double dt = 0;             ///< step, s
  double tolerance = 1e-14;  ///< on the residual over the angular momentum; a step at rounding is as good
  int max_newton_iterations = 20;
};

/// Energy-momentum conserving rotation of a rigid body (Simo & Wong 1991, "Unconditionally stable algorithms
/// for rigid body dynamics that exactly preserve energy and momentum"): R_1 = R_0 exp([t]x) with t = h (w_0 +
/// w_1)/2 and the angular momentum R J w changed by the torque times h, exactly. Because exp([t]x) leaves t
/// alone, the kinetic energy changes by torque . R_0 t, its work, and not at all without a torque. Second
/// order; steps should turn the body by less than half a turn.
class EnergyMomentumRotation {
 public:
  /// @param inertia in the body's axes, kg m^2
  /// @throws std::invalid_argument unless dt and tolerance are positive and the inertia is finite, symmetric
  ///   and positive definite
  EnergyMomentumRotation(const Mat3<double>& inertia, const EnergyMomentumRotationOptions& options)
      : J_(inertia), options_(options) {
    detail::check_dt(options.dt);
    if (!(options.tolerance > 0))
      invalid(std::string("tolerance ") + to_text(options.tolerance) + ": must be positive");
    if (!J_.allFinite() || (J_ - J_.transpose()).norm() > 1e-12 * J_.norm() ||
        Eigen::LLT<Mat3<double>>(J_).info() != Eigen::Success)
      invalid(std::string("inertia with the trace ") + to_text(J_.trace()) +
              " kg m^2: must be finite, symmetric and positive definite");
  }

  /// Kinetic energy, J.
  [[nodiscard]] double energy(const RigidRotation& body) const {
    return 0.5 * body.velocity.dot(J_ * body.velocity);
  }
  /// Angular momentum in the axes of space, N m s.
  [[nodiscard]] Vec3<double> momentum(const RigidRotation& body) const {
    return body.orientation * (J_ * body.velocity);
  }

  /// Advances the body by dt under a torque in N m, in the axes of space. A step that does not converge
  /// leaves it as it was.
  StepReport step(RigidRotation& body, const Vec3<double>& torque = Vec3<double>::Zero()) const {
    StepReport report;
    const double h = options_.dt;
    const Vec3<double>& w = body.velocity;
    // The momentum at the end, in the axes of the start.
    const Vec3<double> p = J_ * w + h * (body.orientation.transpose() * torque);
    const double scale = p.norm() + (J_ * w).norm();
    Vec3<double> t = h * w;
    double last = HUGE_VAL;
    for (;; ++report.newton_iterations) {
      const Mat3<double> back = rotation_exponential(Vec3<double>(-t));
      const Vec3<double> residual = J_ * (2 / h * t - w) - back * p;
      const double size = residual.norm();
      report.residual = size == 0 ? 0 : size / scale;
      if (!std::isfinite(size))
        return detail::ended(report, Status::not_finite, "rigid rotation: the residual is not finite");
      // Below 1e-12 it is at rounding once it stops falling.
      if (report.residual <= options_.tolerance || (report.residual < 1e-12 && size >= last)) break;
      if (report.newton_iterations == options_.max_newton_iterations)
        return detail::ended(report, Status::not_converged, "rigid rotation: too many iterations");
      last = size;
      // The left Jacobian of t: exp([t + dt]x) = exp([J dt]x) exp([t]x) to first order.
      const Mat3<double> slope = 2 / h * J_ - back * skew(p) * rotation_jacobian(Vec3<double>(-t));
      t -= slope.fullPivLu().solve(residual);
    }
    body.orientation = body.orientation * rotation_exponential(t);
    body.velocity = 2 / h * t - w;
    body.time += h;
    return detail::ended(report, Status::converged, "");
  }

 private:
  Mat3<double> J_;
  EnergyMomentumRotationOptions options_;
};

}  // namespace softsim
