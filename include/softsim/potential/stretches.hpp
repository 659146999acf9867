// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "softsim/mesh/ordering.hpp"

// How `Elements` lines up its stencils.

namespace softsim::detail {

/// Order in which stretches of stencils are worked off: stretches of one colour share no block of the state,
/// so that several threads may scatter at once; the order, and with it every rounding, does not depend on how
/// many there are. `stretch[s]` lists the blocks that stretch s touches. Returns the colour of each.
[[nodiscard]] inline std::vector<int> colours(const std::vector<std::vector<std::int32_t>>& stretches) {
  std::int32_t largest = -1;
  for (const auto& s : stretches)
    for (const std::int32_t b : s) largest = std::max(largest, b);
  constexpr int limit = 64;
  std::vector<std::uint64_t> taken(static_cast<std::size_t>(largest + 1));
  std::vector<int> colour;
  int beyond = limit;
  for (const auto& s : stretches) {
    std::uint64_t used = 0;
    for (const std::int32_t b : s) used |= taken[static_cast<std::size_t>(b)];
    int c = 0;
    while (c < limit && (used >> c & 1U) != 0) ++c;
    if (c == limit) {
      colour.push_back(beyond++);  // a colour of its own
      continue;
    }
    for (const std::int32_t b : s) taken[static_cast<std::size_t>(b)] |= std::uint64_t{1} << c;
    colour.push_back(c);
  }
  return colour;
}

/// Puts stencils side by side that share no block, as far as there are such: a lane that adds to what the
/// lane before it has just written waits for it, which costs a force on tetrahedra a tenth of its time.
/// `part` lists some of the stencils.
template <std::size_t n>
void spread(std::vector<std::size_t>& part, const std::vector<std::array<std::int32_t, n>>& stencils) {
  std::vector<std::int32_t> touched;  // numbered by their places here, the list of users stays short
  for (const std::size_t e : part) touched.insert(touched.end(), stencils[e].begin(), stencils[e].end());
  std::sort(touched.begin(), touched.end());
  touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
  std::vector<std::array<std::int32_t, n>> own;
  for (const std::size_t e : part) {
    own.push_back(stencils[e]);
    for (std::int32_t& b : own.back())
      b = static_cast<std::int32_t>(std::lower_bound(touched.begin(), touched.end(), b) - touched.begin());
  }
  const std::vector<std::size_t> before = part;
  std::size_t k = 0;
  for (const std::int32_t i : stencil_order(own)) part[k++] = before[static_cast<std::size_t>(i)];
}

/// Stencils of one model that are worked off together, in order.
struct StretchPlan {
  std::size_t model;
  int colour;
  std::vector<std::size_t> stencils;
};

/// All stretches in the order of their colours, and whether these were made: false if this was compiled
/// without OpenMP, where all are of one colour. The linker may pick either version for a program that has
/// both.
struct StretchPlans {
  std::vector<StretchPlan> stretches;
  bool coloured = false;
};

/// Cuts the stencils of every model (`members`) into stretches of the given length, for N lanes, and puts
/// these into the order of their colours. Without OpenMP all have one colour: neighbours follow each other,
/// which a mesh that does not fit into the cache likes better.
template <int N, std::size_t n>
[[nodiscard]] StretchPlans plan_stretches(const std::vector<std::vector<std::size_t>>& members,
                                          const std::vector<std::array<std::int32_t, n>>& stencils,
                                          std::size_t length) {
  StretchPlans result;
  std::vector<StretchPlan>& plans = result.stretches;
  for (std::size_t m = 0; m < members.size(); ++m)
    for (std::size_t k = 0; k < members[m].size(); k += length) {
      const auto begin = members[m].begin() + static_cast<std::ptrdiff_t>(k);
      const auto end = begin + static_cast<std::ptrdiff_t>(std::min(length, members[m].size() - k));
      plans.push_back({m, 0, {begin, end}});
      if constexpr (N > 1) spread(plans.back().stencils, stencils);
    }
#ifdef _OPENMP
  result.coloured = true;
  std::vector<std::vector<std::int32_t>> touched(plans.size());
  for (std::size_t p = 0; p < plans.size(); ++p)
    for (const std::size_t e : plans[p].stencils)
      touched[p].insert(touched[p].end(), stencils[e].begin(), stencils[e].end());
  const std::vector<int> colour = colours(touched);
  for (std::size_t p = 0; p < plans.size(); ++p) plans[p].colour = colour[p];
  std::stable_sort(plans.begin(), plans.end(),
                   [](const StretchPlan& a, const StretchPlan& b) { return a.colour < b.colour; });
#endif
  return result;
}

}  // namespace softsim::detail
