// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>
#include <omp.h>

#include <cstring>
#include <utility>

#include "potential/bodies.hpp"
#include "softsim/integrator/implicit.hpp"
#include "softsim/material/neo_hookean.hpp"
#include "softsim/potential/elastic.hpp"
#include "softsim/potential/heml.hpp"
#include "softsim/potential/prony.hpp"
#include "softsim/potential/spring.hpp"
#include "softsim/system/system.hpp"
#include "softsim/system/tangent.hpp"

// Compiled with OpenMP: whatever the number of threads, every result has the same bits.

namespace same_bits_test {

using bodies::gradient, bodies::hessian_product;
using softsim::NeoHookean, softsim::State, softsim::TetrahedralMesh, softsim::Vector;

template <class T>
bool same(const Vector<T>& a, const Vector<T>& b) {
  return a.size() == b.size() &&
         std::memcmp(a.data(), b.data(), static_cast<std::size_t>(a.size()) * sizeof(T)) == 0;
}

const NeoHookean law = NeoHookean::from_young_poisson(1e4, 0.4);
const TetrahedralMesh cube = softsim::box_mesh({11, 11, 11}, {1, 1, 1});  // 7,986 tetrahedra, 1,728 nodes

template <class Term>
void expect_the_same_bits(const Term& term) {
  using T = typename Term::Scalar;
  const std::size_t nodes = cube.points().size();
  const State<T> q = bodies::random_state<T>(nodes, 0.01, 1);
  const Vector<T> d = bodies::random_vector<T>(nodes, 1, 2);
  softsim::System system(cube, term);
  softsim::AssembledTangent<decltype(system)> assembled;
  softsim::MatrixFreeTangent<decltype(system)> matrix_free;
  omp_set_num_threads(1);
  const double energy = term.energy(q), product = softsim::dot(q.displacement, d);
  const Vector<T> g = gradient(term, q), Kd = hessian_product(term, q, d);
  assembled.set(system, q, {});
  matrix_free.set(system, q, {});
  Vector<T> a = d, f = d, y = d;
  assembled.apply(d, a);
  matrix_free.apply(d, f);
  for (const int threads : {2, 3, 4, 7}) {
    omp_set_num_threads(threads);
    for (int again = 0; again < 5; ++again) {
      EXPECT_EQ(term.energy(q), energy) << threads;
      EXPECT_EQ(softsim::dot(q.displacement, d), product) << threads;
      EXPECT_TRUE(same(gradient(term, q), g)) << threads;
      EXPECT_TRUE(same(hessian_product(term, q, d), Kd)) << threads;
      assembled.set(system, q, {});
      assembled.apply(d, y);
      EXPECT_TRUE(same(y, a)) << threads;
      matrix_free.set(system, q, {});
      matrix_free.apply(d, y);
      EXPECT_TRUE(same(y, f)) << threads;
    }
  }
}

TEST(Threads, FiniteElementForcesHaveTheSameBits) { expect_the_same_bits(softsim::elastic(cube, law)); }
TEST(Threads, EdgeLengthForcesHaveTheSameBits) { expect_the_same_bits(softsim::heml(cube, law)); }
TEST(Threads, SinglePrecisionHasTheSameBits) { expect_the_same_bits(softsim::elastic<float>(cube, law)); }

// Long enough to be summed in pieces.
template <class T>
void expect_the_same_dot_product() {
  const Vector<T> a = bodies::random_vector<T>(20000, 1, 6), b = bodies::random_vector<T>(20000, 1, 7);
  omp_set_num_threads(1);
  const double one = softsim::dot(a, b);
  EXPECT_NEAR(one, a.template cast<double>().dot(b.template cast<double>()), 1e-10);
  for (const int threads : {2, 3, 4, 7}) {
    omp_set_num_threads(threads);
    for (int again = 0; again < 20; ++again) EXPECT_EQ(softsim::dot(a, b), one) << threads;
  }
}
TEST(Threads, LongDotProductsHaveTheSameBits) {
  expect_the_same_dot_product<double>();
  expect_the_same_dot_product<float>();
}

TEST(Threads, SpringsAndElementsThatRememberHaveTheSameBits) {
  const std::size_t nodes = cube.points().size();
  const State<double> q = bodies::random_state(nodes, 0.01, 1);
  const Vector<double> v = bodies::random_vector(nodes, 1, 2);
  const auto springs = softsim::springs(cube, 50.0);
  const auto after_a_step = [&](int threads) {
    omp_set_num_threads(threads);
    auto viscous = softsim::prony_elements(cube, law, softsim::PronySeries({{0.3, 0.1}}));
    viscous.begin_step(State<double>(nodes), v, 0.01);
    viscous.end_step(q, v, 0.01);
    Vector<double> y = gradient(viscous, q);
    y += gradient(springs, q);
    return std::pair(y, viscous.energy(q) + springs.energy(q));
  };
  const auto one = after_a_step(1);
  for (const int threads : {2, 3, 7}) {
    const auto many = after_a_step(threads);
    EXPECT_TRUE(same(many.first, one.first)) << threads;
    EXPECT_EQ(many.second, one.second) << threads;
  }
}

// Its vectors are long enough to be cut into pieces.
TEST(Threads, PronySeriesAtNodesHasTheSameBits) {
  const softsim::TetrahedralMesh large = softsim::box_mesh({14, 14, 14}, {1, 1, 1});
  const std::size_t nodes = large.points().size();
  const Vector<double> v = bodies::random_vector(nodes, 1, 2);
  const auto after_two_steps = [&](int threads) {
    omp_set_num_threads(threads);
    auto viscous = softsim::prony_nodes(softsim::elastic(large, law), nodes,
                                        softsim::PronySeries({{0.3, 0.1}, {0.2, 1}}));
    for (const unsigned k : {1U, 2U}) {
      const State<double> q = bodies::random_state(nodes, 0.005, k);
      viscous.begin_step(q, v, 0.01);
      viscous.end_step(q, v, 0.01);
    }
    return gradient(viscous, bodies::random_state(nodes, 0.005, 3));
  };
  const Vector<double> one = after_two_steps(1);
  for (const int threads : {2, 3, 7}) EXPECT_TRUE(same(after_two_steps(threads), one)) << threads;
}

TEST(Threads, AnImplicitStepHasTheSameBits) {
  const auto after_three_steps = [](int threads) {
    omp_set_num_threads(threads);
    softsim::System system(cube, softsim::heml(cube, law));
    system.mass = softsim::Mass<double>::lumped(cube, 1000);
    softsim::Motion<double> motion(cube.points().size());
    motion.q = bodies::random_state(cube.points().size(), 0.01, 3);
    softsim::BackwardEuler<decltype(system)> integrator({.dt = 0.01});
    for (int k = 0; k < 3; ++k)
      EXPECT_NE(integrator.step(system, motion).status, softsim::Status::not_finite);
    return motion.v;
  };
  const Vector<double> one = after_three_steps(1);
  EXPECT_TRUE(same(after_three_steps(2), one));
  EXPECT_TRUE(same(after_three_steps(5), one));
}

}  // namespace same_bits_test
