// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/potential/elements.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

#include "potential/bodies.hpp"
#include "softsim/material/neo_hookean.hpp"
#include "softsim/potential/elastic.hpp"

namespace elements_test {

using bodies::gradient, bodies::hessian_product, bodies::refusal, bodies::relative_error;
using softsim::NeoHookean, softsim::State, softsim::TetrahedralMesh, softsim::Vector;
using Model = softsim::Elastic<softsim::LinearTetrahedron, NeoHookean>;

static_assert(softsim::LocalPotential<Model> && softsim::LocalPotential<Model, softsim::Batch<float, 16>>);
static_assert(!softsim::LocalForce<softsim::LinearTetrahedron> && !softsim::LocalPotential<NeoHookean>);
static_assert(softsim::Potential<softsim::ElasticTetrahedra<NeoHookean>>);
static_assert(!softsim::ForceTerm<Model>);
static_assert(softsim::Elements<Model>::conservative && !softsim::Elements<Model>::external);

template <class T_, int N_>
struct Width {
  using T = T_;
  static constexpr int N = N_;
  // Rounding of sums of some ten terms of both signs, a few hundred operations deep.
  static constexpr double tolerance = sizeof(T) == sizeof(double) ? 1e-13 : 2e-5;
};
struct WidthName {
  template <class W>
  static std::string GetName(int) {
    return (sizeof(typename W::T) == sizeof(double) ? "double" : "float") + std::to_string(W::N);
  }
};
template <class W>
class ElementsOf : public ::testing::Test {};
using Widths = ::testing::Types<Width<double, 4>, Width<double, 8>, Width<float, 1>, Width<float, 16>>;
TYPED_TEST_SUITE(ElementsOf, Widths, WidthName);

const NeoHookean law = NeoHookean::from_young_poisson(10, 0.3);
// 27 nodes, 48 tetrahedra
const TetrahedralMesh cube = bodies::distorted_cube(2, 7);

// Counts around the multiples of 4, 8 and 16; the unused lanes repeat a tetrahedron and must not count.
TYPED_TEST(ElementsOf, AgreeWithOneAtATimeForEveryCount) {
  using T = typename TypeParam::T;
  for (const std::size_t count : {1u, 2u, 3u, 4u, 7u, 8u, 9u, 15u, 16u, 17u, 48u}) {
    const TetrahedralMesh mesh = bodies::first_tetrahedra(cube, count);
    const std::size_t nodes = mesh.points().size();
    const State<T> q = bodies::random_state<T>(nodes, 0.05, count);
    const Vector<T> d = bodies::random_vector<T>(nodes, 1, count + 100);
    State<double> q_double;
    q_double.displacement = q.displacement.template cast<double>();
    const Vector<double> d_double = d.template cast<double>();

    const auto one = softsim::elastic<double, 1>(mesh, law);
    const auto many = softsim::elastic<T, TypeParam::N>(mesh, law);
    EXPECT_EQ(many.size(), count);
    EXPECT_NEAR(many.energy(q) / one.energy(q_double), 1, TypeParam::tolerance) << count;
    EXPECT_LT(relative_error(gradient(many, q), gradient(one, q_double)), TypeParam::tolerance) << count;
    EXPECT_LT(relative_error(hessian_product(many, q, d), hessian_product(one, q_double, d_double)),
              TypeParam::tolerance)
        << count;
  }
}

TYPED_TEST(ElementsOf, AddToWhatIsThere) {
  using T = typename TypeParam::T;
  const TetrahedralMesh mesh = bodies::first_tetrahedra(cube, 9);
  const std::size_t nodes = mesh.points().size();
  const auto elements = softsim::elastic<T, TypeParam::N>(mesh, law);
  const State<T> q = bodies::random_state<T>(nodes, 0.05, 1);
  const Vector<T> d = bodies::random_vector<T>(nodes, 1, 2), start = bodies::random_vector<T>(nodes, 1, 3);
  Vector<T> y = start;
  elements.add_gradient(q, y);
  elements.add_hessian_product(q, d, y);
  const Vector<T> sum = start + gradient(elements, q) + hessian_product(elements, q, d);
  EXPECT_LT(relative_error(y, sum), TypeParam::tolerance);
  for (std::ptrdiff_t i = 3; i < y.size(); i += softsim::block_stride)
    EXPECT_EQ(y[i], T(0)) << "padding of a block";
}

TEST(Elements, RefusesAStencilThatHasABlockTwice) {
  using Set = softsim::Elements<Model>;
  std::vector<Set::RestData> data;
  const TetrahedralMesh mesh = softsim::box_mesh({1, 1, 1}, {1, 1, 1});
  std::array<bodies::Vec, 4> X;
  for (std::size_t i = 0; i < 4; ++i) X[i] = mesh.points()[static_cast<std::size_t>(mesh.tetrahedra()[0][i])];
  data.assign(2, softsim::LinearTetrahedron::make(X));
  const std::vector<softsim::Tetrahedron> stencils{{0, 1, 2, 3}, {4, 5, 6, 4}};
  EXPECT_EQ(refusal([&] { Set({{law}}, data, stencils); }), "element 1: node 4 occurs twice");
}

TYPED_TEST(ElementsOf, VisitEveryStencilOnce) {
  using T = typename TypeParam::T;
  const TetrahedralMesh mesh = bodies::first_tetrahedra(cube, 19);
  std::vector<std::int32_t> index;
  for (int t = 0; t < 19; ++t) index.push_back(t % 2);
  const auto elements = softsim::elastic<T, TypeParam::N>(mesh, std::vector{law, law}, index);
  std::vector<softsim::Tetrahedron> seen, expected = mesh.tetrahedra();
  elements.for_each_stencil([&](const softsim::Tetrahedron& v) { seen.push_back(v); });
  std::sort(seen.begin(), seen.end());
  std::sort(expected.begin(), expected.end());
  EXPECT_EQ(seen, expected);
}

TYPED_TEST(ElementsOf, BlocksAreTheColumnsOfTheHessianProduct) {
  using T = typename TypeParam::T;
  const TetrahedralMesh mesh = bodies::first_tetrahedra(cube, 9);
  const std::size_t nodes = mesh.points().size();
  const auto elements = softsim::elastic<T, TypeParam::N>(mesh, law);
  const State<T> q = bodies::random_state<T>(nodes, 0.05, 4);
  const auto n = static_cast<std::int32_t>(nodes);
  // the upper triangle of a dense matrix of blocks; those of node 0 are left out
  std::vector<std::int32_t> places;
  elements.for_each_stencil([&](const softsim::Tetrahedron& v) {
    for (std::size_t a = 0; a < 4; ++a)
      for (std::size_t b = a; b < 4; ++b) {
        const auto [i, j] = std::minmax(v[a], v[b]);
        places.push_back(i == 0 ? -1 : 2 * (i * n + j) + (v[a] > v[b] ? 1 : 0));
      }
  });
  std::vector<T> values(9 * nodes * nodes, T(0));
  elements.add_blocks(q, T(2), places, values.data());
  double largest = 0;
  for (std::int32_t j = 0; j < n; ++j)
    for (int a = 0; a < 3; ++a) {
      Vector<T> unit = Vector<T>::Zero(q.size());
      softsim::block(unit, j)[a] = T(1);
      const Vector<T> column = hessian_product(elements, q, unit);
      largest = std::max(largest, static_cast<double>(column.cwiseAbs().maxCoeff()));
      for (std::int32_t i = 0; i < n; ++i)
        for (int b = 0; b < 3; ++b) {
          const T entry =
              values[9 * static_cast<std::size_t>(i * n + j) + static_cast<std::size_t>(3 * a + b)];
          const T expected = i == 0 || i > j ? T(0) : 2 * softsim::block(column, i)[b];
          ASSERT_NEAR(entry, expected, TypeParam::tolerance * 2 * largest) << i << " " << j;
        }
    }
}

TYPED_TEST(ElementsOf, EachMaterialActsOnItsOwnTetrahedra) {
  using T = typename TypeParam::T;
  using Elements = softsim::Elements<Model, T, TypeParam::N>;
  const std::size_t nodes = cube.points().size();
  const std::vector<NeoHookean> laws{NeoHookean::from_young_poisson(10, 0.3),
                                     NeoHookean::from_young_poisson(1000, 0.1),
                                     NeoHookean::from_young_poisson(100, 0.45)};
  const std::vector<Model> models{{laws[0]}, {laws[1]}, {laws[2]}};
  std::vector<std::int32_t> index;
  std::array<std::vector<Model>, 3> own_model{{{models[0]}, {models[1]}, {models[2]}}};
  std::array<std::vector<typename Elements::RestData>, 3> data;
  std::array<std::vector<softsim::Tetrahedron>, 3> stencils;
  bodies::Random random(8);
  for (const softsim::Tetrahedron& v : cube.tetrahedra()) {
    const auto m = static_cast<std::size_t>(1.5 * (random.number() + 1));
    index.push_back(static_cast<std::int32_t>(m));
    std::array<bodies::Vec, 4> X;
    for (std::size_t i = 0; i < 4; ++i) X[i] = cube.points()[static_cast<std::size_t>(v[i])];
    data[m].push_back(softsim::LinearTetrahedron::make(X));
    stencils[m].push_back(v);
  }
  const auto together = softsim::elastic<T, TypeParam::N>(cube, laws, index);
  const State<T> q = bodies::random_state<T>(nodes, 0.05, 9);
  const Vector<T> d = bodies::random_vector<T>(nodes, 1, 10);
  double energy = 0;
  Vector<T> g = Vector<T>::Zero(q.size()), Kd = g;
  for (std::size_t m = 0; m < 3; ++m) {
    ASSERT_GT(stencils[m].size(), 9u);
    const Elements alone(own_model[m], data[m], stencils[m]);
    energy += alone.energy(q);
    alone.add_gradient(q, g);
    alone.add_hessian_product(q, d, Kd);
  }
  EXPECT_NEAR(together.energy(q) / energy, 1, TypeParam::tolerance);
  EXPECT_LT(relative_error(gradient(together, q), g), TypeParam::tolerance);
  EXPECT_LT(relative_error(hessian_product(together, q, d), Kd), TypeParam::tolerance);
}

// Displacements, not positions, are what single precision holds: a body a kilometre away is as exact as one
// here.
TEST(ElementsInSinglePrecision, AreAsExactFarFromTheOrigin) {
  std::vector<bodies::Vec> points = cube.points();
  for (bodies::Vec& x : points) x += bodies::Vec(1024, -512, 2048);
  const TetrahedralMesh far(points, cube.tetrahedra());
  const State<float> q = bodies::random_state<float>(points.size(), 0.05, 11);
  State<double> q_double;
  q_double.displacement = q.displacement.cast<double>();
  EXPECT_LT(relative_error(gradient(softsim::elastic<float>(far, law), q),
                           gradient(softsim::elastic(far, law), q_double)),
            2e-6);
}

TEST(Elements, AnEmptyListOfOneMaterialIsNoRun) {
  std::vector<std::int32_t> index(cube.tetrahedra().size(), 2);
  const auto stiff = NeoHookean::from_young_poisson(1e6, 0.3);
  const State<double> q = bodies::random_state(cube.points().size(), 0.05, 12);
  const auto elements = softsim::elastic(cube, std::vector{stiff, stiff, law}, index);
  EXPECT_EQ(elements.size(), 48u);
  EXPECT_NEAR(elements.energy(q) / softsim::elastic(cube, law).energy(q), 1, 1e-14);
}

// 750 tetrahedra are three stretches, most of which share nodes.
TEST(Elements, LongListsAreWorkedOffStretchByStretch) {
  const TetrahedralMesh mesh = bodies::distorted_cube(5, 7);
  const auto many = softsim::elastic(mesh, law);
  const auto one = softsim::elastic<double, 1>(mesh, law);
  EXPECT_EQ(many.size(), 750u);
  const State<double> q = bodies::random_state(mesh.points().size(), 0.02, 1);
  const Vector<double> d = bodies::random_vector(mesh.points().size(), 1, 2);
  EXPECT_NEAR(many.energy(q) / one.energy(q), 1, 1e-13);
  EXPECT_LT(relative_error(gradient(many, q), gradient(one, q)), 1e-13);
  EXPECT_LT(relative_error(hessian_product(many, q, d), hessian_product(one, q, d)), 1e-13);
}

TEST(Elements, StretchesOfOneColourShareNoBlock) {
  const std::vector<std::vector<std::int32_t>> touched{{0, 1}, {1, 2}, {3}, {2, 3}, {0, 5}, {1, 0}};
  EXPECT_EQ(softsim::detail::colours(touched), (std::vector<int>{0, 1, 0, 2, 1, 2}));
  // every one shares a block with every other: more colours than fit into the mask
  const std::vector<std::vector<std::int32_t>> all(70, {4});
  const std::vector<int> colour = softsim::detail::colours(all);
  for (int c = 0; c < 70; ++c) EXPECT_EQ(colour[static_cast<std::size_t>(c)], c);
}

// Removing tetrahedra at run time leaves the body of the others, whatever lanes and stretches they were in.
TYPED_TEST(ElementsOf, RemovedStencilsNoLongerCount) {
  using T = typename TypeParam::T;
  const TetrahedralMesh mesh = bodies::distorted_cube(4, 7);  // 384
  const std::size_t nodes = mesh.points().size();
  auto elements = softsim::elastic<T, TypeParam::N>(mesh, law);
  const State<T> q = bodies::random_state<T>(nodes, 0.02, 3);
  const Vector<T> d = bodies::random_vector<T>(nodes, 1, 4);
  std::vector<bool> gone(mesh.tetrahedra().size());
  bodies::Random random(5);
  for (const int target : {1, 40, 300, 384}) {
    for (int count = static_cast<int>(std::count(gone.begin(), gone.end(), true)); count < target;) {
      std::size_t t = static_cast<std::size_t>(192 * (1 + random.number()));
      while (gone[t]) t = (t + 1) % gone.size();
      elements.remove(t);
      elements.remove(t);
      gone[t] = true;
      ++count;
    }
    std::vector<softsim::Tetrahedron> left, seen;
    for (std::size_t t = 0; t < gone.size(); ++t)
      if (!gone[t]) left.push_back(mesh.tetrahedra()[t]);
    EXPECT_EQ(elements.size(), left.size());
    elements.for_each_stencil([&](const softsim::Tetrahedron& v) { seen.push_back(v); });
    std::sort(seen.begin(), seen.end());
    std::sort(left.begin(), left.end());
    ASSERT_EQ(seen, left);
    if (left.empty()) {
      EXPECT_EQ(elements.energy(q), 0);
      EXPECT_EQ(gradient(elements, q).norm(), 0);
      continue;
    }
    std::vector<softsim::LinearTetrahedron::Data<double>> data;
    for (const softsim::Tetrahedron& v : left) {
      std::array<bodies::Vec, 4> X;
      for (std::size_t i = 0; i < 4; ++i) X[i] = mesh.points()[static_cast<std::size_t>(v[i])];
      data.push_back(softsim::LinearTetrahedron::make(X));
    }
    const softsim::Elements<Model, T, TypeParam::N> fresh({Model{law}}, data, left);
    EXPECT_NEAR(elements.energy(q) / fresh.energy(q), 1, TypeParam::tolerance);
    EXPECT_LT(relative_error(gradient(elements, q), gradient(fresh, q)), TypeParam::tolerance);
    EXPECT_LT(relative_error(hessian_product(elements, q, d), hessian_product(fresh, q, d)),
              TypeParam::tolerance);
  }
  EXPECT_EQ(refusal([&] {
              elements.remove(384);
              return 0;
            }),
            "elements: no element 384 to remove (there were 384)");
}

TEST(Elements, RefuseWhatDoesNotFitByNumberAndValue) {
  const TetrahedralMesh mesh = bodies::first_tetrahedra(cube, 5);
  EXPECT_EQ(refusal([&] {
              return softsim::elastic(mesh, std::vector{law, law}, {0, 1, 0, 2, 0});
            }),
            "element 3: material index 2 is out of range (there are 2 materials)");
  EXPECT_EQ(refusal([&] {
              return softsim::elastic(mesh, std::vector{law, law}, {0, 1, -1, 1, 0});
            }),
            "element 2: material index -1 is out of range (there are 2 materials)");
  EXPECT_EQ(refusal([&] {
              return softsim::elastic(mesh, std::vector{law, law}, {0, 1, 0});
            }),
            "elements: 3 material indices for 5 elements");
  EXPECT_EQ(refusal([&] {
              return softsim::elastic(mesh, std::vector{law, law});
            }),
            "elastic: 2 materials need an index per tetrahedron");
  EXPECT_EQ(refusal([&] { return softsim::elastic(mesh, std::vector<NeoHookean>{}); }),
            "elastic: no material");
  EXPECT_EQ(refusal([&] { return softsim::Elements<Model>({Model{law}}, {}, mesh.tetrahedra()); }),
            "elements: 0 rest data for 5 stencils");
}

}  // namespace elements_test
