// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdlib>
#include <memory>
#include <tuple>
#include <utility>
#include <vector>

#include "potential/bodies.hpp"
#include "softsim/integrator/adaptive_runge_kutta.hpp"
#include "softsim/integrator/energy_controlled.hpp"
#include "softsim/integrator/energy_momentum.hpp"
#include "softsim/integrator/implicit.hpp"
#include "softsim/integrator/runge_kutta.hpp"
#include "softsim/integrator/semi_explicit_euler.hpp"
#include "softsim/integrator/velocity_verlet.hpp"
#include "softsim/material/neo_hookean.hpp"
#include "softsim/mesh/selection.hpp"
#include "softsim/potential/dead_load.hpp"
#include "softsim/potential/elastic.hpp"
#include "softsim/potential/kelvin_voigt.hpp"
#include "softsim/potential/prony.hpp"
#include "softsim/system/system.hpp"

// Every allocation of the program goes through the functions below, operator new and Eigen's included; they
// count while asked to. The sanitizers bring their own, and only the GNU C library lets itself be wrapped
// like this.
#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || __has_feature(memory_sanitizer)
#define ALLOCATION_TEST_SKIPPED
#endif
#endif
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || !defined(__GLIBC__)
#define ALLOCATION_TEST_SKIPPED
#endif

namespace {
bool counting = false;
long allocations = 0;
[[maybe_unused]] void count() { allocations += counting ? 1 : 0; }
}  // namespace

#ifndef ALLOCATION_TEST_SKIPPED
extern "C" {
void* __libc_malloc(std::size_t size) noexcept;
void* __libc_calloc(std::size_t number, std::size_t size) noexcept;
void* __libc_realloc(void* p, std::size_t size) noexcept;
void* __libc_memalign(std::size_t alignment, std::size_t size) noexcept;

void* malloc(std::size_t size) noexcept {
  count();
  return __libc_malloc(size);
}
void* calloc(std::size_t number, std::size_t size) noexcept {
  count();
  return __libc_calloc(number, size);
}
void* realloc(void* p, std::size_t size) noexcept {
  count();
  return __libc_realloc(p, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  count();
  return __libc_memalign(alignment, size);
}
void* memalign(std::size_t alignment, std::size_t size) noexcept {
  count();
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** p, std::size_t alignment, std::size_t size) noexcept {
  count();
  *p = __libc_memalign(alignment, size);
  return *p == nullptr ? 12 : 0;  // ENOMEM
}
}
#endif

namespace {

using softsim::BackwardEuler, softsim::Motion, softsim::Status;
using System = softsim::System<softsim::ElasticTetrahedra<softsim::NeoHookean>, softsim::DeadLoad<double>>;

template <class Function>
long allocations_of(Function&& f) {
  allocations = 0;
  counting = true;
  f();
  counting = false;
  return allocations;
}

class Allocations : public ::testing::Test {
 protected:
  softsim::TetrahedralMesh mesh = softsim::box_mesh({3, 3, 3}, {0.1, 0.1, 0.1});
  System system{mesh, softsim::elastic(mesh, softsim::NeoHookean::from_young_poisson(1e4, 0.3)),
                softsim::gravity(mesh, 1000, {0, 0, -9.81})};

  void SetUp() override {
#ifdef ALLOCATION_TEST_SKIPPED
    GTEST_SKIP() << "allocations cannot be counted in this build";
#endif
    system.prescribed.fix(softsim::nodes_near(mesh, softsim::Side::xmin, 0));
    system.mass = softsim::Mass<double>::lumped(mesh, 1000);
    system.damping = {0.1, 1e-4};
  }

  // Allocations of ten steps after the first; one prescribed node keeps moving.
  template <class Integrator>
  void expect_none(Integrator integrator) {
    expect_none_of(system, integrator);
  }
  template <class S, class Integrator>
  void expect_none_of(S& moving, Integrator integrator) {
    Motion<double> motion(mesh.points().size());
    ASSERT_EQ(integrator.step(moving, motion).status, Status::converged);
    const long counted = allocations_of([&] {
      for (int k = 1; k <= 10; ++k) {
        moving.prescribed.set(3, 2, -1e-5 * k);
        if (integrator.step(moving, motion).status != Status::converged) std::abort();
      }
    });
    EXPECT_EQ(counted, 0);
  }
  // Explicit and implicit steps of a system of these terms and the load.
  template <class... Terms>
  void expect_none_with(Terms... terms) {
    softsim::System own(mesh, std::move(terms)..., softsim::gravity(mesh, 1000, {0, 0, -9.81}));
    own.prescribed = system.prescribed;
    own.mass = system.mass;
    expect_none_of(own, softsim::SemiExplicitEuler<decltype(own)>({.dt = 1e-4}));
    using Own = decltype(own);
    using Verlet = softsim::VelocityVerlet<Own>;
    expect_none_of(own, softsim::EnergyControlled<Own, Verlet>(Verlet({.dt = 1e-4}), {.tolerance = 1}));
    expect_none_of(own, BackwardEuler<decltype(own)>({.dt = 0.01, .newton = true}));
  }
  template <class Operator, template <class> class Preconditioner>
  void expect_none_of_backward_euler() {
    for (const bool newton : {false, true})
      expect_none(BackwardEuler<System, Operator, Preconditioner>({.dt = 0.01, .newton = newton}));
  }
};

TEST_F(Allocations, AreCounted) {
  std::unique_ptr<int> one;
  std::vector<double> many;
  softsim::Vector<double> eigen;
  std::vector<softsim::Batch<double, 8>, Eigen::aligned_allocator<softsim::Batch<double, 8>>> aligned;
  EXPECT_EQ(
      allocations_of([&] {
        one = std::make_unique<int>(1);
        asm volatile("" : : "r"(one.get()) : "memory");  // a compiler may leave out a new that nobody sees
      }),
      1);
  EXPECT_EQ(allocations_of([&] { many.resize(1000); }), 1);
  EXPECT_EQ(allocations_of([&] { eigen.resize(1000); }), 1);
  EXPECT_EQ(allocations_of([&] { aligned.reserve(3); }), 1);
  EXPECT_EQ(allocations_of([&] { *one = 2; }), 0);
}

TEST_F(Allocations, NoneInStepsOfSemiExplicitEulerWithLumpedMass) {
  expect_none(softsim::SemiExplicitEuler<System>({.dt = 1e-4}));
}

TEST_F(Allocations, NoneInStepsOfSemiExplicitEulerWithConsistentMass) {
  system.mass = softsim::Mass<double>::consistent(mesh, 1000);
  expect_none(softsim::SemiExplicitEuler<System>({.dt = 1e-4}));
}

TEST_F(Allocations, NoneInStepsOfOtherExplicitIntegrators) {
  for (const bool lumped : {true, false}) {
    system.mass =
        lumped ? softsim::Mass<double>::lumped(mesh, 1000) : softsim::Mass<double>::consistent(mesh, 1000);
    expect_none(softsim::RungeKutta<System>({.dt = 1e-4}));
    expect_none(softsim::VelocityVerlet<System>({.dt = 1e-4}));
    expect_none(softsim::AdaptiveRungeKutta<System>({.dt = 1e-4, .position_tolerance = 1e-9}));
    using Verlet = softsim::VelocityVerlet<System>;
    expect_none(softsim::EnergyControlled<System, Verlet>(Verlet({.dt = 1e-4}), {.tolerance = 1}));
  }
}

TEST_F(Allocations, NoneInStepsOfOtherImplicitIntegrators) {
  using softsim::Implicit;
  for (const bool newton : {false, true}) {
    expect_none(softsim::ImplicitMidpoint<System>({.dt = 0.01, .newton = newton}));
    expect_none(Implicit<softsim::Trapezoidal, System>({.dt = 0.01, .newton = newton}));
    expect_none(Implicit<softsim::Bdf2, System>({.dt = 0.01, .newton = newton}));
    expect_none(softsim::GeneralisedAlpha<System>({.dt = 0.01, .newton = newton}));
  }
  expect_none(softsim::EnergyMomentum<System>({.dt = 0.01, .tolerance = 1e-6}));
}

TEST_F(Allocations, NoneInStepsWithAssembledIncompleteCholesky) {
  expect_none_of_backward_euler<softsim::Assembled, softsim::IncompleteCholesky>();
}

TEST_F(Allocations, NoneInStepsWithAssembledBlockJacobi) {
  expect_none_of_backward_euler<softsim::Assembled, softsim::BlockJacobi>();
}

TEST_F(Allocations, NoneInStepsWithAssembledJacobi) {
  expect_none_of_backward_euler<softsim::Assembled, softsim::Jacobi>();
}

TEST_F(Allocations, NoneInStepsWithAssembledAlone) {
  expect_none_of_backward_euler<softsim::Assembled, softsim::NoPreconditioner>();
}

TEST_F(Allocations, NoneInStepsWithMatrixFreeBlockJacobi) {
  expect_none_of_backward_euler<softsim::MatrixFree, softsim::BlockJacobi>();
}

TEST_F(Allocations, NoneInStepsWithMatrixFreeJacobi) {
  expect_none_of_backward_euler<softsim::MatrixFree, softsim::Jacobi>();
}

TEST_F(Allocations, NoneInStepsWithMatrixFreeAlone) {
  expect_none_of_backward_euler<softsim::MatrixFree, softsim::NoPreconditioner>();
}

TEST_F(Allocations, NoneInStepsWithAConsistentMass) {
  system.mass = softsim::Mass<double>::consistent(mesh, 1000);
  expect_none_of_backward_euler<softsim::Assembled, softsim::BlockJacobi>();
}

TEST_F(Allocations, NoneInStepsWithAPronySeries) {
  const softsim::PronySeries series({{0.3, 0.02}, {0.2, 0.3}});
  const auto law = softsim::NeoHookean::from_young_poisson(1e4, 0.3);
  expect_none_with(softsim::prony_nodes(softsim::elastic(mesh, law), mesh.points().size(), series));
  expect_none_with(softsim::prony_elements(mesh, law, series));
}

TEST_F(Allocations, NoneInStepsWithKelvinVoigtDamping) {
  expect_none_with(std::get<0>(system.terms), softsim::kelvin_voigt(mesh, {10, 10}));
}

}  // namespace
