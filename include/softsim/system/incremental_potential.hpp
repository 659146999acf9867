// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>

#include "softsim/core/state.hpp"
#include "softsim/system/tangent.hpp"

namespace softsim {

/// What an implicit step adds to the forces at the state q that it solves for, linear in the increment d =
/// difference(q_0, q) from its start: the inertial force M (mass d - inertia), the Rayleigh damping force
/// D (damping d - drift) with D = alpha M + beta K(q_0), and a constant one. Backward Euler of size h, for
/// one: mass = 1/h^2, inertia = v_0/h, damping = 1/h, no drift, nothing constant.
template <class T>
struct StepTerms {
  double mass = 0;         ///< 1/s^2
  double damping = 0;      ///< 1/s
  double fraction = 1;     ///< of the step at whose end q is: how far prescribed components have come by then
  Vector<T> inertia = {};  ///< m/s^2
  Vector<T> drift = {};    ///< m/s; may be empty: zero
  Vector<T> constant = {};  ///< N, minus a force; may be empty: zero
  /// The velocity that forces are taken with is damping d - drift, and frames' gyroscopic forces are counted
  /// at it; else they are in `constant`.
  bool gyroscopic = true;
};

/// What an implicit step or a static solve minimises, with d = difference(q_0, q) and `StepTerms`:
///   E(q) + mass/2 |d|_M^2 - inertia . M d + damping/2 |d|_D^2 - drift . D d + constant . d
/// up to a constant; a static problem is E(q) alone, in which loads from outside may count in part. Its
/// gradient is the residual of equilibrium. A problem of this kind is all that `Newton` knows.
template <class S>
class IncrementalPotential {
 public:
  using System = S;
  using T = typename S::Scalar;
  static constexpr bool conservative = S::conservative;

  /// A static problem.
  void set_static(const S& system) { set(system, nullptr, nullptr); }
  /// A static problem with `load` times the loads from outside, and prescribed components that have come that
  /// part of their way from `start`, which must stay alive and unchanged.
  void set_static(const S& system, const State<T>& start, double load) {
    set(system, nullptr, nullptr);
    from_ = &start;
    load_ = fraction_ = load;
  }
  /// A step from q_0; it and the terms must stay alive and unchanged.
  void set_step(const S& system, const State<T>& q_0, const StepTerms<T>& terms) {
    set(system, &q_0, &terms);
  }

  /// The system of the last `set_static` or `set_step`.
  [[nodiscard]] const S& system() const { return *system_; }

  /// Whether the residual is the gradient of `value`. In a step of frames it is not: inertia in the axes of
  /// bodies that turn derives from nothing.
  [[nodiscard]] bool minimises() const {
    return conservative && (terms_ == nullptr || system_->frames() == 0);
  }
  /// Value at q, J.
  [[nodiscard]] double value(const State<T>& q) const {
    double sum = system_->energy(q);
    if (load_ != 1) sum += (load_ - 1) * system_->external_energy(q);
    if (terms_ == nullptr) return sum;
    difference(*from_, q, d_);
    if (terms_->constant.size() > 0) sum += dot(terms_->constant, d_);
    if (const double beta = system_->damping.beta; beta != 0) {
      // d . K (damping d / 2 - drift)
      product_.setZero();
      direction_ = static_cast<T>(beta * terms_->damping / 2) * d_;
      if (terms_->drift.size() > 0) direction_ -= static_cast<T>(beta) * terms_->drift;
      system_->add_elastic_hessian_product(*from_, direction_, product_);
      sum += dot(d_, product_);
    }
    d_ -= centre_;
    product_.setZero();
    system_->mass.add_product(q, d_, T(1), product_);
    return sum + mass_ / 2 * dot(d_, product_);
  }

  /// Gradient at q, prescribed components included, N. Returns the norm that residuals are measured against:
  /// of the external load on free components or, where there is none, the largest of inertial force, internal
  /// force and internal force at the first call for this problem (which does not vanish on the way to rest).
  double gradient(const State<T>& q, Vector<T>& g) const {
    g.setZero(q.size());
    system_->add_gradient(q, g);
    if (load_ != 1) {
      product_.setZero();
      system_->add_external_gradient(q, product_);
      g += static_cast<T>(load_ - 1) * product_;
    }
    return add_step(q, g);
  }

  /// What prescribed components still have to move from q: see `Prescribed::increment`.
  double increment(const State<T>& q, Vector<T>& d) const {
    return fraction_ == 1 ? system_->prescribed.increment(q, d)
                          : system_->prescribed.increment(q, d, *from_, fraction_);
  }

  /// Linearises at q.
  template <class Tangent>
  void linearise(const State<T>& q, Tangent& tangent) const {
    linearise(q, tangent, 1);
  }

 protected:
  /// The state that the step starts from.
  [[nodiscard]] const State<T>& start() const { return *from_; }

  /// g += the terms of the step, g being the gradient of the energy at q. Returns what `gradient` does.
  double add_step(const State<T>& q, Vector<T>& g) const {
    if (!(external_ > 0) && initial_ < 0) initial_ = norm(g);
    const double internal = external_ > 0 ? 0 : std::max(initial_, norm(g));
    if (terms_ == nullptr) return external_ > 0 ? external_ : internal;
    if (terms_->constant.size() > 0) g += terms_->constant;
    difference(*from_, q, d_);
    if (terms_->gyroscopic && system_->frames() > 0) {
      direction_ = static_cast<T>(terms_->damping) * d_;
      if (terms_->drift.size() > 0) direction_ -= terms_->drift;
      system_->mass.add_gyroscopic(q, direction_, T(1), g);
    }
    if (const double beta = system_->damping.beta; beta != 0) {
      direction_ = static_cast<T>(beta * terms_->damping) * d_;
      if (terms_->drift.size() > 0) direction_ -= static_cast<T>(beta) * terms_->drift;
      system_->add_elastic_hessian_product(*from_, direction_, g);
    }
    d_ -= centre_;
    system_->mass.add_product(q, d_, static_cast<T>(mass_), g);
    return external_ > 0 ? external_ : std::max(internal, inertia_);
  }

  /// Linearises with `stiffness` times the Hessian of the energy at q.
  template <class Tangent>
  void linearise(const State<T>& q, Tangent& tangent, double stiffness) const {
    TangentWeights weights{.mass = mass_, .stiffness = stiffness, .external = load_};
    if (terms_ != nullptr) weights.lagged = system_->damping.beta * terms_->damping;
    if (!S::viscous && weights.lagged != 0 && q.displacement == from_->displacement) {
      weights.stiffness += weights.lagged;
      weights.lagged = 0;
    }
    tangent.set(*system_, q, weights, from_);
  }

 private:
  void set(const S& system, const State<T>* q_0, const StepTerms<T>* terms) {
    system_ = &system;
    from_ = q_0;
    terms_ = terms;
    initial_ = -1;
    mass_ = 0;
    load_ = fraction_ = 1;
    d_.setZero(system.size());
    direction_.setZero(system.size());
    product_.setZero(system.size());
    if (q_0 != nullptr)
      system.add_external_gradient(*q_0, product_);
    else
      system.add_external_gradient(system.rest_state(), product_);
    system.prescribed.mask(product_);
    external_ = norm(product_);
    if (terms == nullptr) return;
    // mass d - inertia + alpha (damping d - drift) = mass_ (d - centre_)
    const double alpha = system.damping.alpha;
    fraction_ = terms->fraction;
    mass_ = terms->mass + alpha * terms->damping;
    centre_ = terms->inertia;
    product_.setZero();
    system.mass.add_product(*q_0, centre_, T(1), product_);
    inertia_ = norm(product_);
    if (alpha != 0 && terms->drift.size() > 0) centre_ += static_cast<T>(alpha) * terms->drift;
    centre_ /= static_cast<T>(mass_);
  }

  const S* system_ = nullptr;
  const State<T>* from_ = nullptr;
  const StepTerms<T>* terms_ = nullptr;
  double mass_ = 0, load_ = 1, fraction_ = 1, external_ = 0, inertia_ = 0;
  Vector<T> centre_;
  mutable double initial_ = -1;                // internal force at the first call, negative before
  mutable Vector<T> d_, direction_, product_;  // work vectors
};

}  // namespace softsim
