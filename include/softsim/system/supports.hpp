// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <string>
#include <vector>

#include "softsim/core/error.hpp"
#include "softsim/core/state.hpp"

namespace softsim {

namespace detail {

using Matrix6 = std::array<std::array<double, 6>, 6>;

// Smallest pivot of the symmetric positive semidefinite A under elimination with diagonal pivoting: 0 if A is
// singular. (Eigen's eigenvalues of a 6x6 matrix would double the compile time of a small program.)
inline double smallest_pivot(Matrix6 A) {
  std::array<bool, 6> done{};
  double smallest = A[0][0];
  for (int step = 0; step < 6; ++step) {
    std::size_t k = 6;
    for (std::size_t i = 0; i < 6; ++i)
      if (!done[i] && (k == 6 || A[i][i] > A[k][k])) k = i;
    smallest = step == 0 ? A[k][k] : std::min(smallest, A[k][k]);
    if (!(A[k][k] > 0)) return 0;
    done[k] = true;
    for (std::size_t i = 0; i < 6; ++i)
      for (std::size_t j = 0; j < 6; ++j)
        if (!done[i] && !done[j]) A[i][j] -= A[i][k] * A[k][j] / A[k][k];
  }
  return smallest;
}

}  // namespace detail

/// Checks that no piece of the system can move as a rigid body: the six rigid motions of every connected
/// piece must be stopped by its prescribed components (three nodes that are not in line, as many rollers, or
/// a frame that is held in displacement and rotation). Frames through shape functions that reproduce linear
/// fields turn without the body (see `RotationTie`): there the places of three frames have to be held, which
/// this check cannot see.
/// @throws std::invalid_argument naming the first piece that is free to move and how many of its nodes are
/// held
template <class S>
void require_supports(const S& system) {
  const std::size_t n = system.rest().size(), points = system.points();
  const auto rotational = [&](std::size_t i) { return i >= points && (i - points) % 2 == 1; };
  std::vector<std::size_t> parent(n);
  std::iota(parent.begin(), parent.end(), std::size_t{0});
  const auto root = [&](std::size_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  system.for_each_term([&](const auto& term) {
    if constexpr (std::decay_t<decltype(term)>::has_hessian)
      term.for_each_stencil([&](const auto& stencil) {
        for (const std::int32_t i : stencil)
          parent[root(static_cast<std::size_t>(i))] = root(static_cast<std::size_t>(stencil[0]));
      });
  });
  for (std::size_t i = points; i < n; i += 2) parent[root(i + 1)] = root(i);
  struct Piece {
    std::size_t blocks = 0, nodes = 0, held = 0, components = 0;
    Vec3<double> centre = Vec3<double>::Zero();
    double radius = 0;
    detail::Matrix6 gram{};
  };
  std::vector<Piece> pieces(n);
  for (std::size_t i = 0; i < n; ++i) {
    Piece& piece = pieces[root(i)];
    ++piece.blocks;
    if (rotational(i)) continue;
    ++piece.nodes;
    piece.centre += (system.rest()[i] - piece.centre) / static_cast<double>(piece.nodes);
  }
  for (std::size_t i = 0; i < n; ++i) {
    Piece& piece = pieces[root(i)];
    piece.radius = std::max(piece.radius, (system.rest()[i] - piece.centre).norm());
  }
  for (std::size_t i = 0; i < n; ++i) {
    Piece& piece = pieces[root(i)];
    const Vec3<double> x = (system.rest()[i] - piece.centre) / (piece.radius > 0 ? piece.radius : 1);
    bool held = false;
    for (int axis = 0; axis < 3; ++axis)
      if (system.prescribed.contains(static_cast<std::int32_t>(i), axis)) {
        held = true;
        ++piece.components;
        // this component of three translations and three rotations
        // and of a frame's rotation by the piece's own size
        const Vec3<double> e = Vec3<double>::Unit(axis), r = rotational(i) ? e : x.cross(e);
        const double d = rotational(i) ? 0 : 1;
        const std::array<double, 6> motion{d * e[0], d * e[1], d * e[2], r[0], r[1], r[2]};
        for (std::size_t a = 0; a < 6; ++a)
          for (std::size_t b = 0; b < 6; ++b) piece.gram[a][b] += motion[a] * motion[b];
      }
    piece.held += held && !rotational(i) ? 1 : 0;
  }
  for (std::size_t i = 0, number = 0; i < n; ++i) {
    if (root(i) != i) continue;
    const Piece& piece = pieces[i];
    const auto coordinate = [&](int axis) {
      const double x = piece.centre[axis];
      return to_text(std::abs(x) < 1e-9 * piece.radius ? 0 : x);
    };
    // Nodes a ten-thousandth of the piece's size out of line count as in line. What is held altogether cannot
    // move, however few nodes it has.
    if (piece.components < 3 * piece.blocks && detail::smallest_pivot(piece.gram) <= 1e-8)
      invalid(std::string("static solve: piece ") + std::to_string(number) + " (" +
              std::to_string(piece.nodes) + " nodes, around " + coordinate(0) + ", " + coordinate(1) + ", " +
              coordinate(2) + ") is free to move: " + std::to_string(piece.held) + " of its nodes " +
              (piece.held == 1 ? "is" : "are") + " held, and at least three that are not in line are needed" +
              (points < n ? ", or one frame, in its rotation too" : ""));
    ++number;
  }
}

}  // namespace softsim
