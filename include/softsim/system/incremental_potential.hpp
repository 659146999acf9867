// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>

#include "softsim/core/state.hpp"
#include "softsim/system/tangent.hpp"

namespace softsim {

/// What one backward Euler step of size h from (q_0, v_0) minimises, with d = difference(q_0, q):
///   E(q) + 1/(2 h^2) |d - h v_0|_M^2 + alpha/(2 h) |d|_M^2 + beta/(2 h) d . K(q_0) d,
/// the last two being Rayleigh damping with the elastic Hessian frozen at the start of the step. With h = 0
/// it stands for E(q) alone, a static problem. Its gradient is the residual of equilibrium.
template <class S>
class IncrementalPotential {
 public:
  using T = typename S::Scalar;
  static constexpr bool conservative = S::conservative;

  /// A static problem.
  void set_static(const S& system) { set(system, nullptr, nullptr, 0); }
  /// A step of size h > 0; q_0 and v_0 must stay alive and unchanged.
  void set_step(const S& system, const State<T>& q_0, const Vector<T>& v_0, double h) {
    set(system, &q_0, &v_0, h);
  }

  /// The system of the last `set_static` or `set_step`.
  [[nodiscard]] const S& system() const { return *system_; }

  /// Value at q, J.
  [[nodiscard]] double value(const State<T>& q) const {
    double sum = system_->energy(q);
    if (q_0_ == nullptr) return sum;
    const auto& damping = system_->damping;
    difference(*q_0_, q, d_);
    if (damping.beta != 0) {
      product_.setZero();
      system_->add_elastic_hessian_product(*q_0_, d_, product_);
      sum += damping.beta / (2 * h_) * dot(d_, product_);
    }
    if (damping.alpha != 0) {
      product_.setZero();
      system_->mass.add_product(d_, T(1), product_);
      sum += damping.alpha / (2 * h_) * dot(d_, product_);
    }
    d_ -= static_cast<T>(h_) * *v_0_;
    product_.setZero();
    system_->mass.add_product(d_, T(1), product_);
    return sum + dot(d_, product_) / (2 * h_ * h_);
  }

  /// Gradient at q, prescribed components included, N. Returns the norm that residuals are measured against:
  /// of the external load on free components or, where there is none, the largest of inertial force, internal
  /// force and internal force at the first call for this problem (which does not vanish on the way to rest).
  double gradient(const State<T>& q, Vector<T>& g) const {
    g.setZero(q.size());
    system_->add_gradient(q, g);
    if (!(external_ > 0) && initial_ < 0) initial_ = norm(g);
    double internal = external_ > 0 ? 0 : std::max(initial_, norm(g));
    if (q_0_ != nullptr) {
      const auto& damping = system_->damping;
      difference(*q_0_, q, d_);
      if (damping.beta != 0) {
        product_ = static_cast<T>(damping.beta / h_) * d_;
        system_->add_elastic_hessian_product(*q_0_, product_, g);
      }
      d_ *= static_cast<T>(1 / (h_ * h_) + damping.alpha / h_);
      d_ -= static_cast<T>(1 / h_) * *v_0_;
      product_.setZero();
      system_->mass.add_product(d_, T(1), product_);
      g += product_;
      if (!(external_ > 0)) internal = std::max(internal, inertia_);
    }
    return external_ > 0 ? external_ : internal;
  }

  /// Linearises at q.
  template <class Tangent>
  void linearise(const State<T>& q, Tangent& tangent) const {
    if (q_0_ == nullptr) return tangent.set(*system_, q, TangentWeights{});
    const auto& damping = system_->damping;
    TangentWeights weights{
        .mass = 1 / (h_ * h_) + damping.alpha / h_, .stiffness = 1, .lagged = damping.beta / h_};
    if (!S::viscous && (&q == q_0_ || q.displacement == q_0_->displacement)) {
      weights.stiffness += weights.lagged;
      weights.lagged = 0;
    }
    tangent.set(*system_, q, weights, q_0_);
  }

 private:
  void set(const S& system, const State<T>* q_0, const Vector<T>* v_0, double h) {
    system_ = &system;
    q_0_ = q_0;
    v_0_ = v_0;
    h_ = h;
    initial_ = -1;
    d_.setZero(system.size());
    product_.setZero(system.size());
    if (q_0 != nullptr)
      system.add_external_gradient(*q_0, product_);
    else
      system.add_external_gradient(State<T>(system.rest().size()), product_);
    system.prescribed.mask(product_);
    external_ = norm(product_);
    if (q_0 != nullptr) {
      product_.setZero();
      system.mass.add_product(*v_0, static_cast<T>(1 / h), product_);
      inertia_ = norm(product_);
    }
  }

  const S* system_ = nullptr;
  const State<T>* q_0_ = nullptr;
  const Vector<T>* v_0_ = nullptr;
  double h_ = 0, external_ = 0, inertia_ = 0;
  mutable double initial_ = -1;    // internal force at the first call, negative before
  mutable Vector<T> d_, product_;  // work vectors
};

}  // namespace softsim
