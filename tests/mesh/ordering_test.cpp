// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/mesh/ordering.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <numeric>
#include <random>
#include <set>
#include <vector>

#include "potential/bodies.hpp"
#include "softsim/material/neo_hookean.hpp"
#include "softsim/mesh/edges.hpp"
#include "softsim/mesh/generators.hpp"
#include "softsim/potential/elastic.hpp"

namespace ordering_test {

using bodies::refusal;
using softsim::Order, softsim::TetrahedralMesh, softsim::Tetrahedron;

Order random_order(std::size_t n, unsigned seed) {
  Order order(n);
  std::iota(order.begin(), order.end(), 0);
  std::mt19937 bits(seed);
  for (std::size_t i = n; i > 1; --i) std::swap(order[i - 1], order[bits() % i]);
  return order;
}

TetrahedralMesh shuffled(const TetrahedralMesh& mesh, unsigned seed) {
  const TetrahedralMesh mixed = renumbered(mesh, random_order(mesh.points().size(), seed));
  return reordered(mixed, random_order(mesh.tetrahedra().size(), seed + 1));
}

bool is_permutation_of(const Order& order, std::size_t n) {
  Order sorted = order, all(n);
  std::sort(sorted.begin(), sorted.end());
  std::iota(all.begin(), all.end(), 0);
  return sorted == all;
}

/// Mean distance in memory of the nodes of one element.
double mean_spread(const TetrahedralMesh& mesh) {
  double sum = 0;
  for (const Tetrahedron& v : mesh.tetrahedra())
    for (std::size_t a = 1; a < 4; ++a) sum += std::abs(v[a] - v[0]);
  return sum / (3 * static_cast<double>(mesh.tetrahedra().size()));
}

/// Mean distance between the lowest nodes of one element and the next.
double mean_jump(const TetrahedralMesh& mesh) {
  double sum = 0;
  std::int32_t last = 0;
  for (const Tetrahedron& v : mesh.tetrahedra()) {
    const std::int32_t low = *std::min_element(v.begin(), v.end());
    sum += std::abs(low - last);
    last = low;
  }
  return sum / static_cast<double>(mesh.tetrahedra().size());
}

/// Share of the elements that share a node with another of their group.
template <class Stencils>
double share_of_conflicts(const Stencils& stencils, std::size_t group) {
  std::size_t conflicts = 0;
  for (std::size_t first = 0; first < stencils.size(); first += group) {
    std::set<std::int32_t> used;
    for (std::size_t e = first; e < std::min(first + group, stencils.size()); ++e) {
      bool shares = false;
      for (const std::int32_t i : stencils[e]) shares |= !used.insert(i).second;
      conflicts += shares;
    }
  }
  return static_cast<double>(conflicts) / static_cast<double>(stencils.size());
}

// 12 x 8 x 8 cells: 1,053 nodes in layers of 81 along the length.
const TetrahedralMesh box = softsim::box_mesh({12, 8, 8}, {1.2, 0.8, 0.8});
const TetrahedralMesh mixed = shuffled(box, 1);

TEST(Ordering, CuthillMcKeeNarrowsTheBand) {
  const Order order = reverse_cuthill_mckee(mixed);
  ASSERT_TRUE(is_permutation_of(order, mixed.points().size()));
  const TetrahedralMesh compact = renumbered(mixed, order);
  EXPECT_GT(bandwidth(mixed), 1000);
  // A layer and its neighbours; numbering along the rows of the shortest faces gives 9 * 9 + 9 + 1.
  EXPECT_LE(bandwidth(compact), 2.5 * 91);
  EXPECT_LT(mean_spread(compact), 0.3 * mean_spread(mixed));
}

TEST(Ordering, MortonsCurveKeepsNeighboursTogether) {
  const Order order = softsim::morton_order(mixed.points());
  ASSERT_TRUE(is_permutation_of(order, mixed.points().size()));
  EXPECT_LT(mean_spread(renumbered(mixed, order)), 0.3 * mean_spread(mixed));
  // the corners of a cube come x fastest
  EXPECT_EQ(softsim::morton_order(softsim::box_mesh({1, 1, 1}, {1, 1, 1}).points()),
            (Order{0, 1, 2, 3, 4, 5, 6, 7}));
  EXPECT_TRUE(softsim::morton_order({}).empty());
  EXPECT_EQ(softsim::morton_order({{1, 2, 3}, {1, 2, 3}}), (Order{0, 1})) << "points that coincide";
}

TEST(Ordering, ElementsFollowTheNodesAndGroupsShareNone) {
  const TetrahedralMesh compact = renumbered(mixed, reverse_cuthill_mckee(mixed));
  const Order order = element_order(compact);
  ASSERT_TRUE(is_permutation_of(order, compact.tetrahedra().size()));
  const TetrahedralMesh fast = reordered(compact, order);
  EXPECT_LT(mean_jump(fast), 0.1 * mean_jump(compact));
  EXPECT_GT(share_of_conflicts(box.tetrahedra(), 16), 0.8) << "cell by cell";
  for (const std::size_t lanes : {4u, 8u, 16u})
    EXPECT_LT(share_of_conflicts(fast.tetrahedra(), lanes), 0.05) << lanes;

  const auto edges = softsim::mesh_edges(compact).edges;
  std::vector<softsim::Edge> apart;
  for (const std::int32_t e : softsim::stencil_order(edges))
    apart.push_back(edges[static_cast<std::size_t>(e)]);
  EXPECT_LT(share_of_conflicts(apart, 16), 0.05);
}

TEST(Ordering, TheBodyStaysTheSame) {
  std::vector<int> region(box.tetrahedra().size());
  for (std::size_t t = 0; t < region.size(); ++t) region[t] = static_cast<int>(t);
  const TetrahedralMesh marked(box.points(), box.tetrahedra(), region);
  const Order nodes = reverse_cuthill_mckee(marked);
  const TetrahedralMesh numbered = renumbered(marked, nodes);
  const TetrahedralMesh fast = reordered(numbered, element_order(numbered));
  EXPECT_NEAR(fast.volume(), box.volume(), 1e-12);
  for (std::size_t t = 0; t < fast.tetrahedra().size(); ++t) {
    const auto source = static_cast<std::size_t>(fast.region()[t]);
    for (std::size_t a = 0; a < 4; ++a)
      ASSERT_EQ(nodes[static_cast<std::size_t>(fast.tetrahedra()[t][a])], box.tetrahedra()[source][a]);
  }

  const auto law = softsim::NeoHookean::from_young_poisson(10, 0.3);
  const softsim::State<double> q = bodies::random_state(box.points().size(), 0.01, 2);
  softsim::State<double> moved(box.points().size());
  for (std::size_t k = 0; k < nodes.size(); ++k)
    moved.point(static_cast<std::ptrdiff_t>(k)) = q.point(nodes[k]);
  const auto f = bodies::gradient(softsim::elastic(box, law), q);
  const auto g = bodies::gradient(softsim::elastic(fast, law), moved);
  for (std::size_t k = 0; k < nodes.size(); ++k)
    ASSERT_LE((softsim::block(g, static_cast<std::ptrdiff_t>(k)) - softsim::block(f, nodes[k])).norm(),
              1e-13 * f.norm());
}

TEST(Ordering, SeparatePiecesAreOrderedOneAfterTheOther) {
  std::vector<bodies::Vec> points;
  std::vector<Tetrahedron> tetrahedra;
  const TetrahedralMesh piece = softsim::box_mesh({3, 1, 1}, {3, 1, 1});
  for (int copy = 0; copy < 3; ++copy) {
    const auto first = static_cast<std::int32_t>(points.size());
    for (const bodies::Vec& x : piece.points()) points.push_back(x + bodies::Vec(0, 5 * copy, 0));
    for (Tetrahedron v : piece.tetrahedra()) {
      for (std::int32_t& i : v) i += first;
      tetrahedra.push_back(v);
    }
  }
  const TetrahedralMesh all = shuffled(TetrahedralMesh(points, tetrahedra), 5);
  const Order order = reverse_cuthill_mckee(all);
  ASSERT_TRUE(is_permutation_of(order, all.points().size()));
  EXPECT_LT(bandwidth(renumbered(all, order)), 16) << "a piece has 16 nodes";
}

TEST(Ordering, SmallAndEmptyLists) {
  EXPECT_TRUE(softsim::stencil_order(std::vector<Tetrahedron>{}).empty());
  // All share node 0: no group can be free of conflicts, and none is lost.
  EXPECT_EQ(softsim::stencil_order(std::vector<softsim::Edge>{{0, 3}, {0, 1}, {0, 2}}, 2), (Order{1, 2, 0}));
}

TEST(Ordering, RefusesWhatIsNoPermutation) {
  const TetrahedralMesh mesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2, 3}});
  EXPECT_EQ(refusal([&] { return renumbered(mesh, {0, 1, 2}); }), "order: 3 numbers for 4 nodes");
  EXPECT_EQ(refusal([&] {
              return renumbered(mesh, {0, 1, 2, 4});
            }),
            "order: 4 is out of range (there are 4 nodes)");
  EXPECT_EQ(refusal([&] { return renumbered(mesh, {0, 1, 1, 3}); }), "order: 1 is repeated");
  EXPECT_EQ(refusal([&] { return reordered(mesh, {1}); }), "order: 1 is out of range (there are 1 elements)");
  EXPECT_EQ(refusal([&] { return element_order(mesh, 0); }), "group 0: must be at least 1");
}

// V - E + F - T = 1 for a ball; and every tetrahedron counts for its six edges.
TEST(MeshEdges, AreCountedOnceWithTheVolumeAroundThem) {
  const softsim::MeshEdges all = softsim::mesh_edges(mixed);
  const auto nodes = mixed.points().size(), tetrahedra = mixed.tetrahedra().size();
  const auto triangles = (4 * tetrahedra + softsim::boundary_triangles(mixed).size()) / 2;
  EXPECT_EQ(all.edges.size(), nodes + triangles - tetrahedra - 1);
  EXPECT_TRUE(std::is_sorted(all.edges.begin(), all.edges.end()));
  for (const softsim::Edge& e : all.edges) EXPECT_LT(e[0], e[1]);
  EXPECT_NEAR(std::accumulate(all.volume.begin(), all.volume.end(), 0.0), 6 * mixed.volume(), 1e-12);
}

}  // namespace ordering_test
