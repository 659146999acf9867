// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "softsim/integrator/static_solver.hpp"
#include "softsim/reduction/modal_dynamics.hpp"
#include "softsim/reduction/pod.hpp"
#include "softsim/reduction/reduced_newton.hpp"
#include "softsim/solver/direct.hpp"
#include "softsim/solver/stationary.hpp"
#include "solve.hpp"
#ifdef SOFTSIM_CHART_MODES
#include "softsim/ext/spectra.hpp"
#endif

// Few unknowns instead of those of a mesh: any model of points or frames can be reduced, so these are
// solvers.

namespace chart {
namespace {

using namespace softsim;

StepReport done(Status status, std::string_view reason = "") {
  return detail::ended(StepReport(), status, reason);
}

template <class T>
bool displaced(const AnySystem<T>& system) {
  Vector<T> d = Vector<T>::Zero(system.size());
  return system.prescribed.increment(system.rest_state(), d) > 0;
}

#ifdef SOFTSIM_CHART_MODES
// The lowest modes at rest, or fewer where a system has fewer.
template <class T>
Modes modes_of(const AnySystem<T>& system, std::ptrdiff_t count) {
  const std::ptrdiff_t free = FreeComponents(system.prescribed).size();
  Modes modes;
  const LinearReport report = lowest_modes(system, system.rest_state(), std::min(count, free - 1), modes,
                                           {.tolerance = std::is_same_v<T, double> ? 1e-10 : 1e-6});
  if (report.status != Status::converged) throw NotApplicable("its modes were not found", "modes");
  return modes;
}

/// Linear statics in the span of a few modes, a = Omega^-2 Phi^T f; warped into large rotations or not.
template <class T>
class ModalStatics {
 public:
  ModalStatics(std::ptrdiff_t count, bool warped) : count_(count), warped_(warped) {}

  StepReport operator()(const Discrete<T>& d, State<T>& q) {
    if (d.system.number() != number_) set_up(d);
    g_.setZero(d.system.size());
    d.system.add_gradient(q, g_);
    const Eigen::VectorXd a = -(modes_.shapes.transpose() * g_.template cast<double>()).array() /
                              modes_.frequencies.array().square();
    if (warp_) {
      const LinearReport report = warp_->rotation_strain(a, u_);
      if (report.status != Status::converged) return done(report.status, report.reason);
    } else {
      u_.noalias() = modes_.shapes * a;
    }
    if (!u_.allFinite()) return done(Status::not_finite, "modal: the displacement is not finite");
    retract(q, Vector<T>(u_.template cast<T>()));
    return done(Status::converged);
  }

 private:
  void set_up(const Discrete<T>& d) {
    if (displaced(d.system)) throw NotApplicable("modes cannot move what is prescribed", "modes");
    if (warped_ && !d.warped) throw NotApplicable("modes of frames are not warped", "warped modes");
    modes_ = modes_of(d.system, count_);
    if (warped_) warp_ = d.warped(modes_.shapes);
    number_ = d.system.number();
  }

  std::ptrdiff_t count_;
  bool warped_;
  std::uint64_t number_ = 0;
  Modes modes_;
  std::shared_ptr<WarpedModes> warp_;
  Vector<T> g_;
  Eigen::VectorXd u_;
};
#endif

/// Newton's method in the span of what the body did on its way to half of the load; that training is part of
/// the set-up.
template <class T>
class PodStatics {
 public:
  StepReport operator()(const Discrete<T>& d, State<T>& q) {
    const AnySystem<T>& system = d.system;
    if (system.number() != number_) {
      if (system.frames() > 0) throw NotApplicable("what frames do does not add up to a basis", "pod");
      if (const StepReport report = train(system); report.status != Status::converged) return report;
      number_ = system.number();
    }
    q = start_;
    return reduced_->solve(system, q);
  }

 private:
  static constexpr double tolerance = std::is_same_v<T, double> ? 1e-7 : 1e-4;

  StepReport train(const AnySystem<T>& system) {
    Newton<AnySystem<T>, Assembled, Ldlt, Stationary> newton({.max_iterations = 60, .tolerance = tolerance});
    IncrementalPotential<AnySystem<T>> potential;
    start_ = system.rest_state();
    State<T> q = start_;
    constexpr std::ptrdiff_t parts = 8;
    Eigen::MatrixXd u(system.size(), parts);
    for (std::ptrdiff_t k = 1; k <= parts; ++k) {
      potential.set_static(system, start_, 0.5 * static_cast<double>(k) / parts);
      if (const StepReport report = newton.minimise(potential, q); report.status != Status::converged)
        return report;
      u.col(k - 1) = q.displacement.template cast<double>();
    }
    if (displaced(system)) {
      // starts where the way so far leads, with what is prescribed in place, and moves what is free
      retract(start_, Vector<T>((2 * u.col(parts - 1)).template cast<T>()));
      Vector<T> d = Vector<T>::Zero(system.size());
      system.prescribed.increment(start_, d);
      retract(start_, d);
      for (std::ptrdiff_t k = 0; k < parts - 1; ++k)
        u.col(k) -= u.col(parts - 1) * static_cast<double>(k + 1) / parts;
      u.conservativeResize(Eigen::NoChange, parts - 1);
    }
    for (std::ptrdiff_t k = 0; k < u.rows(); ++k)
      if (system.prescribed.free()[k] == T(0)) u.row(k).setZero();
    if (u.isZero(0)) throw NotApplicable("nothing moves but what is prescribed", "pod");
    const PodBasis basis = pod(u, {.energy = 1});
    const std::ptrdiff_t kept =
        (basis.singular_values.array() > 0.1 * tolerance * basis.singular_values[0]).count();
    reduced_.emplace(system, basis.vectors.leftCols(std::min(kept, basis.vectors.cols())),
                     ReducedNewtonOptions{.tolerance = tolerance});
    return done(Status::converged);
  }

  std::uint64_t number_ = 0;
  State<T> start_;
  std::optional<ReducedNewton<AnySystem<T>>> reduced_;
};

template <class T, class S, class... Arguments>
std::function<Solve<T>(int)> made(Arguments... arguments) {
  return [=](int) -> Solve<T> {
    const auto statics = std::make_shared<S>(arguments...);
    return [statics](const Discrete<T>& d, State<T>& q) { return (*statics)(d, q); };
  };
}

}  // namespace

std::vector<Solver> reductions() {
  std::vector<Solver> all;
#ifdef SOFTSIM_CHART_MODES
  for (const bool warped : {false, true})
    for (const std::ptrdiff_t count : {5, 20})
      all.push_back({(warped ? "warped_modes_" : "modes_") + std::to_string(count), "-",
                     made<double, ModalStatics<double>>(count, warped),
                     made<float, ModalStatics<float>>(count, warped), true});
#endif
  all.push_back(
      {"pod", "-", made<double, PodStatics<double>>(), made<float, PodStatics<float>>(), true, true});
  return all;
}

#ifdef SOFTSIM_CHART_MODES
namespace {
template <class T>
std::function<Advance<T>(double)> modal(std::ptrdiff_t count) {
  return [count](double dt) -> Advance<T> {
    using Dynamics = ModalDynamics<AnySystem<T>>;
    const auto dynamics = std::make_shared<std::optional<Dynamics>>();
    const auto number = std::make_shared<std::uint64_t>(0);
    return [=](const AnySystem<T>& system, Motion<T>& motion) {
      if (*number != system.number()) {
        ModalOptions options;
        options.dt = dt;
        dynamics->emplace(system, system.rest_state(), modes_of(system, count), options);
        *number = system.number();
      }
      return (*dynamics)->step(system, motion);
    };
  };
}
}  // namespace
std::vector<Integrator> modal_integrators() {
  std::vector<Integrator> all;
  for (const std::ptrdiff_t count : {5, 20})
    all.push_back(
        {"modal_" + std::to_string(count), "-", "-", modal<double>(count), modal<float>(count), true});
  return all;
}
#else
std::vector<Integrator> modal_integrators() { return {}; }
#endif

}  // namespace chart
