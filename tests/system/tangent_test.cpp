// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/system/tangent.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "potential/bodies.hpp"
#include "softsim/material/neo_hookean.hpp"
#include "softsim/mesh/generators.hpp"
#include "softsim/mesh/selection.hpp"
#include "softsim/potential/dead_load.hpp"
#include "softsim/potential/elastic.hpp"
#include "softsim/potential/pressure.hpp"
#include "softsim/system/system.hpp"

namespace tangent_test {

using bodies::relative_error;
using softsim::AssembledTangent, softsim::Mass, softsim::MatrixFreeTangent, softsim::State,
    softsim::TangentWeights, softsim::Vector;
using Elastic = softsim::ElasticTetrahedra<softsim::NeoHookean>;
using Pressure = softsim::Elements<softsim::FollowerPressure>;
using System = softsim::System<Elastic, Pressure, softsim::DeadLoad<double>>;

static_assert(softsim::LinearOperator<AssembledTangent<System>> &&
              softsim::LinearOperator<MatrixFreeTangent<System>>);
static_assert(!softsim::LinearOperator<System> && !softsim::LinearOperator<Mass<double>>);
static_assert(softsim::ForceTerm<System> && !System::conservative);
static_assert(softsim::Potential<softsim::System<Elastic, softsim::DeadLoad<double>>>);
static_assert(!softsim::Potential<Pressure>);

class Tangent : public ::testing::Test {
 protected:
  // two materials, 48 tetrahedra and 8 triangles, neither a multiple of 16
  softsim::TetrahedralMesh mesh = bodies::distorted_cube(2, 1);
  std::size_t nodes = mesh.points().size();
  std::vector<softsim::NeoHookean> laws{softsim::NeoHookean::from_young_poisson(10, 0.3),
                                        softsim::NeoHookean::from_young_poisson(100, 0.4)};
  System system{mesh, softsim::elastic(mesh, laws, materials()), softsim::pressure(mesh, patch(), 3),
                softsim::gravity(mesh, 1, {0, 0, -1})};
  State<double> q = bodies::random_state(nodes, 0.05, 2), q_0 = bodies::random_state(nodes, 0.05, 3);

  std::vector<std::int32_t> materials() const {
    std::vector<std::int32_t> index;
    for (std::size_t t = 0; t < mesh.tetrahedra().size(); ++t) index.push_back(t % 3 == 0);
    return index;
  }
  std::vector<softsim::Triangle> patch() const {
    std::vector<softsim::Triangle> triangles = softsim::boundary_triangles(mesh);
    triangles.resize(13);
    return triangles;
  }
  // What A x is by definition.
  Vector<double> expected(const TangentWeights& weights, const Vector<double>& x) const {
    Vector<double> y = weights.stiffness * bodies::hessian_product(system, q, x) +
                       weights.lagged * bodies::hessian_product(system, q_0, x);
    system.mass.add_product(x, weights.mass, y);
    system.prescribed.mask(y);
    return y;
  }
};

// Mass alone, stiffness alone, lagged with and without a mass, all of them, and the weights of a step of 1
// ms.
constexpr TangentWeights all_weights[] = {{1, 0, 0}, {0, 1, 0}, {0, 2.5, 0},  {3, 1, 0},
                                          {0, 1, 7}, {2, 0, 5}, {3, 0.25, 4}, {1e6, 1, 0.1}};

TEST_F(Tangent, BothFormsAgreeForAllWeights) {
  system.prescribed.fix(softsim::nodes_near(mesh, softsim::Side::xmin, 0));
  system.prescribed.set(26, 1, 0.5);
  AssembledTangent<System> assembled;
  MatrixFreeTangent<System> matrix_free;
  for (const bool lumped : {true, false}) {
    system.mass = lumped ? Mass<double>::lumped(mesh, 5) : Mass<double>::consistent(mesh, 5);
    for (const TangentWeights& weights : all_weights) {
      assembled.set(system, q, weights, &q_0);
      matrix_free.set(system, q, weights, &q_0);
      for (std::uint64_t n = 0; n < 3; ++n) {
        const Vector<double> x = bodies::random_vector(nodes, 1, 10 + n), y = expected(weights, x);
        Vector<double> y_assembled(x.size()), y_free(x.size());
        assembled.apply(x, y_assembled);
        matrix_free.apply(x, y_free);
        EXPECT_LT(relative_error(y_assembled, y), 1e-13)
            << weights.mass << " " << weights.stiffness << " " << weights.lagged;
        EXPECT_LT(relative_error(y_free, y), 1e-13)
            << weights.mass << " " << weights.stiffness << " " << weights.lagged;
        EXPECT_LT(relative_error(y_assembled, y_free), 1e-12);
      }
    }
  }
}

TEST_F(Tangent, ProductsAreZeroOnPrescribedComponents) {
  system.prescribed.set(4, 2, 0);
  system.prescribed.set(11, 0, 0.1);
  AssembledTangent<System> assembled;
  MatrixFreeTangent<System> matrix_free;
  assembled.set(system, q, {});
  matrix_free.set(system, q, {});
  const Vector<double> x = bodies::random_vector(nodes, 1, 20);
  Vector<double> a(x.size()), b(x.size());
  assembled.apply(x, a);
  matrix_free.apply(x, b);
  for (const Vector<double>& y : {a, b}) {
    EXPECT_EQ(softsim::block(y, 4)[2], 0);
    EXPECT_EQ(softsim::block(y, 11)[0], 0);
    EXPECT_NE(softsim::block(y, 4)[1], 0);
    EXPECT_NE(softsim::block(y, 11)[2], 0);
    for (std::ptrdiff_t k = 3; k < y.size(); k += 4) EXPECT_EQ(y[k], 0);
  }
}

TEST_F(Tangent, DiagonalBlocksAreThoseOfTheOperator) {
  system.mass = Mass<double>::consistent(mesh, 5);
  for (const TangentWeights& weights : all_weights) {
    AssembledTangent<System> assembled;
    MatrixFreeTangent<System> matrix_free;
    assembled.set(system, q, weights, &q_0);
    matrix_free.set(system, q, weights, &q_0);
    std::vector<softsim::Mat3<double>> a, b;
    assembled.diagonal_blocks(a);
    matrix_free.diagonal_blocks(b);
    ASSERT_EQ(a.size(), nodes);
    ASSERT_EQ(b.size(), nodes);
    for (std::size_t i = 0; i < nodes; ++i) {
      softsim::Mat3<double> D;
      for (int c = 0; c < 3; ++c) {
        const auto k = static_cast<std::ptrdiff_t>(i);
        D.col(c) =
            softsim::block(expected(weights, Vector<double>(Vector<double>::Unit(q.size(), 4 * k + c))), k);
      }
      EXPECT_LT((a[i] - D).norm(), 1e-12 * D.norm()) << i;
      EXPECT_LT((b[i] - D).norm(), 1e-12 * D.norm()) << i;
    }
  }
}

TEST_F(Tangent, FollowsTheStateItIsSetTo) {
  AssembledTangent<System> assembled;
  MatrixFreeTangent<System> matrix_free;
  const Vector<double> x = bodies::random_vector(nodes, 1, 30);
  Vector<double> y(x.size());
  for (const State<double>& state : {q_0, q}) {
    assembled.set(system, state, {});
    matrix_free.set(system, state, {});
    assembled.apply(x, y);
    EXPECT_LT(relative_error(y, bodies::hessian_product(system, state, x)), 1e-13);
    matrix_free.apply(x, y);
    EXPECT_LT(relative_error(y, bodies::hessian_product(system, state, x)), 1e-13);
  }
}

// One operator outlives a change of the mass matrix and of the system.
TEST_F(Tangent, NoticesAnotherMassAndAnotherSystem) {
  AssembledTangent<System> assembled;
  const Vector<double> x = bodies::random_vector(nodes, 1, 40);
  Vector<double> y(x.size());
  const TangentWeights weights{.mass = 100};
  system.mass = Mass<double>::lumped(mesh, 5);
  assembled.set(system, q, weights);
  system.mass = Mass<double>::consistent(mesh, 5);
  assembled.set(system, q, weights);
  assembled.apply(x, y);
  EXPECT_LT(relative_error(y, expected(weights, x)), 1e-13);
  system.mass = Mass<double>::lumped(mesh, 5);
  assembled.set(system, q, weights);
  assembled.apply(x, y);
  EXPECT_LT(relative_error(y, expected(weights, x)), 1e-13);
  System copy = system;
  copy.mass = Mass<double>::lumped(mesh, 50);
  assembled.set(copy, q, weights);
  assembled.apply(x, y);
  EXPECT_LT(relative_error(Vector<double>(y - expected(weights, x)),
                           [&] {
                             Vector<double> m = Vector<double>::Zero(x.size());
                             copy.mass.add_product(x, 90, m);
                             return m;
                           }()),
            1e-12);
}

// Two boxes of 6 cells along different axes have the same counts and different neighbours.
TEST(TangentOfAnotherSystem, AtTheSameAddressGetsItsOwnPattern) {
  using Body = softsim::System<Elastic>;
  const auto law = softsim::NeoHookean::from_young_poisson(10, 0.3);
  std::optional<Body> body;
  AssembledTangent<Body> assembled;
  MatrixFreeTangent<Body> free;
  for (const std::array<int, 3> cells : {std::array{6, 1, 1}, std::array{1, 6, 1}}) {
    const auto mesh = softsim::box_mesh(cells, {1, 1, 1});
    body.emplace(mesh, softsim::elastic(mesh, law));
    const State<double> q = bodies::random_state<double>(mesh.points().size(), 0.01, 8);
    const Vector<double> x = bodies::random_vector<double>(mesh.points().size(), 1, 9);
    assembled.set(*body, q, {});
    free.set(*body, q, {});
    Vector<double> y(x.size()), expected = Vector<double>::Zero(x.size());
    body->add_hessian_product(q, x, expected);
    assembled.apply(x, y);
    EXPECT_LT(relative_error(y, expected), 1e-12);
    free.apply(x, y);
    EXPECT_LT(relative_error(y, expected), 1e-12);
  }
}

TEST(TangentInSinglePrecision, AgreesWithDoubles) {
  const auto mesh = bodies::distorted_cube(2, 5);
  const auto law = softsim::NeoHookean::from_young_poisson(10, 0.3);
  softsim::System single(mesh, softsim::elastic<float>(mesh, law));
  single.mass = Mass<float>::lumped(mesh, 5);
  softsim::System twice(mesh, softsim::elastic(mesh, law));
  twice.mass = Mass<double>::lumped(mesh, 5);
  const State<float> q = bodies::random_state<float>(mesh.points().size(), 0.05, 6);
  State<double> q_double;
  q_double.displacement = q.displacement.cast<double>();
  const Vector<float> x = bodies::random_vector<float>(mesh.points().size(), 1, 7);
  AssembledTangent<decltype(single)> a;
  MatrixFreeTangent<decltype(single)> b;
  AssembledTangent<decltype(twice)> c;
  a.set(single, q, {.mass = 100});
  b.set(single, q, {.mass = 100});
  c.set(twice, q_double, {.mass = 100});
  Vector<float> y_a(x.size()), y_b(x.size());
  Vector<double> y(x.size());
  a.apply(x, y_a);
  b.apply(x, y_b);
  c.apply(x.cast<double>(), y);
  EXPECT_LT(relative_error(y_a, y), 2e-6);
  EXPECT_LT(relative_error(y_b, y), 2e-6);
}

}  // namespace tangent_test
