// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <memory>

#include "softsim/integrator/implicit.hpp"
#include "softsim/integrator/semi_explicit_euler.hpp"
#include "softsim/integrator/velocity_verlet.hpp"
#include "softsim/solver/direct.hpp"
#include "softsim/solver/stationary.hpp"
#include "solve.hpp"

namespace chart {
namespace {

using namespace softsim;

template <class T, class I, class Options>
Advance<T> advance_with(const Options& options) {
  const auto integrator = std::make_shared<I>(options);
  return [integrator](const AnySystem<T>& system, Motion<T>& motion) {
    return integrator->step(system, motion);
  };
}

// One linearised solve a step, by a preconditioned method; frozen: with the tangent of the first step for
// ever.
template <class T, class Scheme, template <class> class Preconditioner, class Method>
Advance<T> implicit_with(double dt, const Scheme& scheme, bool frozen) {
  using I = Implicit<Scheme, AnySystem<T>, Assembled, Preconditioner, Method>;
  typename I::Options options{.dt = dt};
  options.scheme = scheme;
  options.tolerance = std::is_same_v<T, double> ? 1e-6 : 1e-4;
  options.frozen = frozen;
  return advance_with<T, I>(options);
}
template <class Scheme>
void add(std::vector<Integrator>& all, const std::string& name, const Scheme& scheme, bool frozen = false) {
  const auto one = [&]<template <class> class Preconditioner, class Method>(
                       const std::string& solver, const std::string& preconditioner) {
    all.push_back(
        {name, solver, preconditioner,
         [=](double dt) { return implicit_with<double, Scheme, Preconditioner, Method>(dt, scheme, frozen); },
         [=](double dt) {
           return implicit_with<float, Scheme, Preconditioner, Method>(dt, scheme, frozen);
         }});
  };
  one.template operator()<BlockJacobi, ConjugateGradient>("cg", "block_jacobi");
  one.template operator()<Ldlt, Stationary>("ldlt", "-");
}

}  // namespace

std::vector<Integrator> integrators() {
  std::vector<Integrator> all;
  all.push_back({"semi_explicit_euler", "-", "-",
                 [](double dt) {
                   return advance_with<double, SemiExplicitEuler<AnySystem<double>>>(
                       SemiExplicitEulerOptions{.dt = dt});
                 },
                 [](double dt) {
                   return advance_with<float, SemiExplicitEuler<AnySystem<float>>>(
                       SemiExplicitEulerOptions{.dt = dt});
                 }});
  all.push_back(
      {"velocity_verlet", "-", "-",
       [](double dt) {
         return advance_with<double, VelocityVerlet<AnySystem<double>>>(VelocityVerletOptions{.dt = dt});
       },
       [](double dt) {
         return advance_with<float, VelocityVerlet<AnySystem<float>>>(VelocityVerletOptions{.dt = dt});
       }});
  add(all, "backward_euler", Theta());
  add(all, "bdf2", Bdf2());
  add(all, "implicit_midpoint", Midpoint());
  add(all, "implicit_midpoint_frozen", Midpoint(), true);
  add(all, "generalised_alpha_0.8", GeneralisedAlphaScheme(0.8));
  return all;
}

}  // namespace chart
