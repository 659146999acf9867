// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "softsim/core/error.hpp"
#include "softsim/core/tensor.hpp"
#include "softsim/mesh/element_mesh.hpp"

// The order of nodes and elements in memory. What is close in the body should be close in memory, so that
// gathered blocks come from the cache. (Elements that are evaluated side by side should share no node either,
// because two additions to one node in a row wait for each other; `Elements` sees to that by itself.)
//
//   const TetrahedralMesh compact = renumbered(mesh, reverse_cuthill_mckee(mesh));
//   const TetrahedralMesh fast = reordered(compact, element_order(compact));

namespace softsim {

/// Permutation as a list of old numbers in their new order: what becomes k was order[k] before.
using Order = std::vector<std::int32_t>;

/// Node numbers whose greatest distance within an element is small (Cuthill & McKee 1969, reversed after
/// George 1971): breadth first from the end of the body, neighbours with few neighbours first.
template <PointMesh Mesh>
[[nodiscard]] Order reverse_cuthill_mckee(const Mesh& mesh) {
  const std::size_t n = mesh.points().size();
  std::vector<std::vector<std::int32_t>> neighbours(n);
  for (const auto& element : mesh.elements())
    for (const std::int32_t i : element)
      for (const std::int32_t j : element)
        if (i != j) neighbours[static_cast<std::size_t>(i)].push_back(j);
  for (auto& list : neighbours) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
  const auto degree = [&](std::int32_t i) { return neighbours[static_cast<std::size_t>(i)].size(); };
  const auto fewer = [&](std::int32_t i, std::int32_t j) {
    return std::pair(degree(i), i) < std::pair(degree(j), j);
  };
  for (auto& list : neighbours) std::sort(list.begin(), list.end(), fewer);

  // Appends the connected piece of `start`, breadth first.
  const auto walk = [&](std::int32_t start, std::vector<bool>& seen, Order& order) {
    std::size_t next = order.size();
    order.push_back(start);
    seen[static_cast<std::size_t>(start)] = true;
    for (; next < order.size(); ++next)
      for (const std::int32_t j : neighbours[static_cast<std::size_t>(order[next])])
        if (!seen[static_cast<std::size_t>(j)]) {
          seen[static_cast<std::size_t>(j)] = true;
          order.push_back(j);
        }
  };
  Order by_degree(n), order;
  std::iota(by_degree.begin(), by_degree.end(), 0);
  std::sort(by_degree.begin(), by_degree.end(), fewer);
  order.reserve(n);
  std::vector<bool> done(n, false);
  for (std::int32_t start : by_degree) {
    if (done[static_cast<std::size_t>(start)]) continue;
    // The last node of a walk lies at an end of the piece, whatever node it started from.
    for (int k = 0; k < 2; ++k) {
      std::vector<bool> seen = done;
      Order piece;
      walk(start, seen, piece);
      start = piece.back();
    }
    walk(start, done, order);
  }
  std::reverse(order.begin(), order.end());
  return order;
}

/// Node numbers along Morton's curve: points in the order of the interleaved bits of their coordinates, 21
/// bits an axis over the bounding cube. Cheaper than `reverse_cuthill_mckee`, needs no elements; better at
/// keeping neighbours in the cache, worse in bandwidth.
[[nodiscard]] inline Order morton_order(const std::vector<Vec3<double>>& points) {
  if (points.empty()) return {};
  Vec3<double> low = points.front(), high = points.front();
  for (const Vec3<double>& x : points) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  constexpr int bits = 21;
  constexpr double last = (1 << bits) - 1;
  const double side = (high - low).maxCoeff(), scale = side > 0 ? last / side : 0;
  std::vector<std::pair<std::uint64_t, std::int32_t>> keyed;
  keyed.reserve(points.size());
  for (const Vec3<double>& x : points) {
    std::uint64_t key = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const int a = static_cast<int>(axis);
      const auto cell = static_cast<std::uint64_t>((x[a] - low[a]) * scale);
      for (std::size_t bit = 0; bit < bits; ++bit) key |= (cell >> bit & 1U) << (3 * bit + axis);
    }
    keyed.emplace_back(key, static_cast<std::int32_t>(keyed.size()));
  }
  std::sort(keyed.begin(), keyed.end());
  Order order;
  order.reserve(keyed.size());
  for (const auto& [key, i] : keyed) order.push_back(i);
  return order;
}

/// The inverse permutation: where each old number went.
/// @param what the thing that is ordered, for messages
/// @throws std::invalid_argument unless every number from 0 to count - 1 occurs once
[[nodiscard]] inline Order inverse_order(const Order& order, std::size_t count, const std::string& what) {
  if (order.size() != count)
    invalid(std::string("order: ") + std::to_string(order.size()) + " numbers for " + std::to_string(count) +
            " " + what);
  Order inverse(count, -1);
  for (std::size_t k = 0; k < count; ++k) {
    const std::int32_t i = order[k];
    if (i < 0 || static_cast<std::size_t>(i) >= count)
      invalid(std::string("order: ") + std::to_string(i) + " is out of range (there are " +
              std::to_string(count) + " " + what + ")");
    if (inverse[static_cast<std::size_t>(i)] >= 0)
      invalid(std::string("order: ") + std::to_string(i) + " is repeated");
    inverse[static_cast<std::size_t>(i)] = static_cast<std::int32_t>(k);
  }
  return inverse;
}

/// The same body with node order[k] as node k; the elements keep their order.
/// @throws std::invalid_argument unless `order` is a permutation of the nodes
template <PointMesh Mesh>
[[nodiscard]] Mesh renumbered(const Mesh& mesh, const Order& order) {
  const Order number = inverse_order(order, mesh.points().size(), "nodes");
  std::vector<Vec3<double>> points;
  points.reserve(order.size());
  for (const std::int32_t i : order) points.push_back(mesh.points()[static_cast<std::size_t>(i)]);
  auto elements = mesh.elements();
  for (auto& element : elements)
    for (std::int32_t& i : element) i = number[static_cast<std::size_t>(i)];
  return Mesh(std::move(points), std::move(elements), mesh.region());
}

/// The same body with element order[k] as element k; the nodes keep their numbers.
/// @throws std::invalid_argument unless `order` is a permutation of the elements
template <PointMesh Mesh>
[[nodiscard]] Mesh reordered(const Mesh& mesh, const Order& order) {
  (void)inverse_order(order, mesh.elements().size(), "elements");
  auto elements = mesh.elements();
  auto region = mesh.region();
  for (std::size_t k = 0; k < order.size(); ++k) {
    elements[k] = mesh.elements()[static_cast<std::size_t>(order[k])];
    region[k] = mesh.region()[static_cast<std::size_t>(order[k])];
  }
  return Mesh(mesh.points(), std::move(elements), std::move(region));
}

/// Order of stencils (elements, edges) along their node numbers, lowest node first, in which groups of
/// `group` share no node where that is possible by taking from the next few groups.
/// @param group stencils evaluated side by side; 16 serves batches of 4, 8 and 16 lanes
/// @throws std::invalid_argument for a group below 1
template <std::size_t n>
[[nodiscard]] Order stencil_order(const std::vector<std::array<std::int32_t, n>>& stencils, int group = 16) {
  if (group < 1) invalid(std::string("group ") + std::to_string(group) + ": must be at least 1");
  Order sorted(stencils.size()), order;
  std::iota(sorted.begin(), sorted.end(), 0);
  std::vector<std::array<std::int32_t, n>> keys = stencils;
  std::int32_t last = -1;
  for (auto& key : keys) {
    std::sort(key.begin(), key.end());
    last = std::max(last, key.back());
  }
  std::sort(sorted.begin(), sorted.end(), [&](std::int32_t a, std::int32_t b) {
    return std::pair(keys[static_cast<std::size_t>(a)], a) < std::pair(keys[static_cast<std::size_t>(b)], b);
  });

  // Waiting stencils are offered to one group after the other, the longest waiting first.
  const std::size_t size = static_cast<std::size_t>(group), window = 12 * size;
  std::vector<std::size_t> user(static_cast<std::size_t>(last + 1), 0);  // group that used a node last
  std::vector<std::int32_t> waiting, left;
  std::size_t next = 0, groups = 0;
  order.reserve(sorted.size());
  while (order.size() < sorted.size()) {
    while (waiting.size() < window && next < sorted.size()) waiting.push_back(sorted[next++]);
    ++groups;
    left.clear();
    std::size_t taken = 0;
    for (const std::int32_t s : waiting) {
      const auto& nodes = stencils[static_cast<std::size_t>(s)];
      const bool free = taken < size && std::none_of(nodes.begin(), nodes.end(), [&](std::int32_t i) {
                          return user[static_cast<std::size_t>(i)] == groups;
                        });
      if (!free) {
        left.push_back(s);
        continue;
      }
      for (const std::int32_t i : nodes) user[static_cast<std::size_t>(i)] = groups;
      order.push_back(s);
      ++taken;
    }
    const auto filled = left.begin() + static_cast<std::ptrdiff_t>(std::min(size - taken, left.size()));
    order.insert(order.end(), left.begin(), filled);
    waiting.assign(filled, left.end());
  }
  return order;
}

/// `stencil_order` of the elements of a mesh.
template <PointMesh Mesh>
[[nodiscard]] Order element_order(const Mesh& mesh, int group = 16) {
  return stencil_order(mesh.elements(), group);
}

/// Greatest difference of two node numbers within an element.
template <PointMesh Mesh>
[[nodiscard]] std::int32_t bandwidth(const Mesh& mesh) {
  std::int32_t largest = 0;
  for (const auto& element : mesh.elements()) {
    const auto [low, high] = std::minmax_element(element.begin(), element.end());
    largest = std::max(largest, *high - *low);
  }
  return largest;
}

}  // namespace softsim
