// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <optional>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>

#include "softsim/concepts.hpp"
#include "softsim/core/error.hpp"
#include "softsim/core/state.hpp"
#include "softsim/solver/report.hpp"
#include "softsim/system/system.hpp"

namespace softsim {

/// An integrator whose step may be changed.
template <class I, class S>
concept AdjustableIntegrator = Integrator<I, S> && requires(I& integrator, const I& constant) {
  { constant.dt() } -> std::convertible_to<double>;
  integrator.set_dt(1.0);
};

/// Options of `EnergyControlled`.
struct EnergyControlledOptions {
  double tolerance = 0;           ///< growth of the total energy that a step may have, J
  double relative_tolerance = 0;  ///< added: times |potential| + kinetic energy at its start
  double quiet = 0.1;             ///< the step grows after a change of less than this part of the tolerance
  double shrink = 0.5;            ///< factor of a step that is made again
  double grow = 1.2;              ///< factor of the step after a quiet one
  double dt_min = 1e-12;          ///< s
  double dt_max = 1e300;          ///< s
};

/// How a step of `EnergyControlled` ended: the report of the integrator, and
struct [[nodiscard]] EnergyStepReport : StepReport {
  double dt = 0;             ///< step taken, s; 0 if none was
  double energy_change = 0;  ///< of the last attempt, J
  int rejected = 0;          ///< attempts before it
};

namespace detail {
// Copies of the terms that remember, to undo a step that ended but is not wanted.
template <class Terms>
struct MemoryOf;
template <class... Terms>
struct MemoryOf<std::tuple<Terms...>> {
  template <class Term>
  using Copy = std::conditional_t<remembers<Term>, std::optional<Term>, char>;
  std::tuple<Copy<Terms>...> copies;

  void save(const std::tuple<Terms...>& terms) {
    each(terms, [](const auto& term, auto& copy) { copy = term; });
  }
  void restore(std::tuple<Terms...>& terms) {
    each(terms, [](auto& term, const auto& copy) { term = *copy; });
  }

 private:
  template <class All, class Function>
  void each(All& terms, Function f) {
    [&]<std::size_t... i>(std::index_sequence<i...>) {
      const auto one = [&](auto& term, auto& copy) {
        if constexpr (remembers<std::remove_cvref_t<decltype(term)>>) f(term, copy);
      };
      (one(std::get<i>(terms), std::get<i>(copies)), ...);
    }
    (std::make_index_sequence<sizeof...(Terms)>());
  }
};
}  // namespace detail

/// Chooses the step of any integrator by the total energy (Joukhadar 1996, as told in d'Aulignac 2001, Sec.
/// 3.4.1): where System::energy + kinetic energy grows in a step by more than the tolerance, the step is made
/// again with a smaller dt; where it hardly changes, dt grows. It keeps a run from blowing up; it does not
/// bound its error, and whether a growth of energy is a fault is the user's to say: moving prescribed
/// components and loads that are not in System::energy do work, so their work in a step must stay below the
/// tolerance. Energy that falls, by damping, is always accepted.
///
/// Prescribed components reach their targets at the end of the step that is taken, however short. Terms that
/// remember are copied before every step and put back after one that is not accepted.
template <class S, class I>
requires AdjustableIntegrator<I, S>
class EnergyControlled {
 public:
  using T = typename S::Scalar;

  /// @throws std::invalid_argument unless tolerance and dt_min are positive, dt_min <= dt <= dt_max with dt
  /// that of the integrator, 0 < quiet <= 1, 0 < shrink < 1 < grow
  EnergyControlled(I integrator, const EnergyControlledOptions& options)
      : integrator_(std::move(integrator)), options_(options) {
    const auto require = [](bool holds, const char* name, double value, const char* what) {
      if (!holds) invalid(std::string(name) + " " + to_text(value) + ": must be " + what);
    };
    require(options.tolerance > 0 && options.tolerance <= 1e300, "tolerance", options.tolerance,
            "positive and finite");
    require(options.relative_tolerance >= 0 && options.relative_tolerance <= 1e300, "relative_tolerance",
            options.relative_tolerance, "at least 0 and finite");
    require(options.quiet > 0 && options.quiet <= 1, "quiet", options.quiet, "in (0, 1]");
    require(options.shrink > 0 && options.shrink < 1, "shrink", options.shrink, "in (0, 1)");
    require(options.grow > 1 && options.grow <= 1e300, "grow", options.grow, "above 1 and finite");
    require(options.dt_min > 0 && options.dt_min <= integrator_.dt(), "dt_min", options.dt_min,
            "positive and at most dt");
    require(options.dt_max >= integrator_.dt(), "dt_max", options.dt_max, "at least dt");
  }

  /// The step that is tried next, s.
  [[nodiscard]] double dt() const { return integrator_.dt(); }
  /// Changes it. @throws as the integrator
  void set_dt(double dt) { integrator_.set_dt(dt); }
  /// The integrator.
  [[nodiscard]] const I& integrator() const { return integrator_; }

  /// Advances the motion by one accepted step of at most dt(), and sets dt() for the next. Where one of
  /// dt_min does not do either, motion and dt() stay as they were, and the status is that of the integrator
  /// or, if only the energy was at fault, `not_converged` (too large) or `not_finite`.
  EnergyStepReport step(Stepped<S> system, Motion<T>& motion) {
    EnergyStepReport report;
    const double potential = system.energy(motion.q), kinetic = kinetic_energy(system, motion);
    const double allowed = options_.tolerance + options_.relative_tolerance * (std::abs(potential) + kinetic);
    const double first = integrator_.dt();
    start_ = motion;
    if constexpr (S::has_memory) memory_.save(system.terms);
    for (;; ++report.rejected) {
      const double h = integrator_.dt();
      static_cast<StepReport&>(report) = integrator_.step(system, motion);
      if (report.status == Status::converged) {
        report.energy_change =
            system.energy(motion.q) - potential + (kinetic_energy(system, motion) - kinetic);
        if (report.energy_change <= allowed) {
          report.dt = h;
          if (report.rejected == 0 && std::abs(report.energy_change) <= options_.quiet * allowed)
            integrator_.set_dt(std::min(options_.dt_max, h * options_.grow));
          return report;
        }
        const bool finite = std::isfinite(report.energy_change);
        report.status = finite ? Status::not_converged : Status::not_finite;
        report.reason = finite ? "the energy grows by more than the tolerance with the smallest step"
                               : "the energy is not finite";
      }
      motion = start_;
      if constexpr (S::has_memory) memory_.restore(system.terms);
      if (!(h > options_.dt_min)) {
        integrator_.set_dt(first);
        return report;
      }
      integrator_.set_dt(std::max(options_.dt_min, h * options_.shrink));
    }
  }

 private:
  // That of the system, without its new vector.
  double kinetic_energy(const S& system, const Motion<T>& motion) {
    momentum_.setZero(motion.v.size());
    system.mass.add_product(motion.q, motion.v, T(1), momentum_);
    return dot(motion.v, momentum_) / 2;
  }

  I integrator_;
  EnergyControlledOptions options_;
  Motion<T> start_;
  Vector<T> momentum_;
  std::conditional_t<detail::has_memory<S>, detail::MemoryOf<decltype(S::terms)>, char> memory_{};
};

}  // namespace softsim
