// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <string>
#include <vector>

#include "softsim/core/error.hpp"
#include "softsim/core/state.hpp"

namespace softsim {

/// Checks that no piece of the system can move as a rigid body: the six rigid motions of every connected piece must be
/// stopped by its prescribed components (three nodes that are not in line, or as many rollers).
/// @throws std::invalid_argument naming the first piece that is free to move and how many of its nodes are held
template <class S>
void require_supports(const S& system) {
  const std::size_t n = system.rest().size();
  std::vector<std::size_t> parent(n);
  std::iota(parent.begin(), parent.end(), std::size_t{0});
  const auto root = [&](std::size_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  system.for_each_term([&](const auto& term) {
    if constexpr (std::decay_t<decltype(term)>::has_hessian)
      term.for_each_stencil([&](const auto& stencil) {
        for (const std::int32_t i : stencil) parent[root(static_cast<std::size_t>(i))] = root(static_cast<std::size_t>(stencil[0]));
      });
  });
  struct Piece {
    std::size_t nodes = 0, held = 0;
    Vec3<double> centre = Vec3<double>::Zero();
    double radius = 0;
    Eigen::Matrix<double, 6, 6> gram = Eigen::Matrix<double, 6, 6>::Zero();
  };
  std::vector<Piece> pieces(n);
  for (std::size_t i = 0; i < n; ++i) {
    Piece& piece = pieces[root(i)];
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
        Eigen::Matrix<double, 6, 1> motion;  // this component of three translations and three rotations
        motion << Vec3<double>::Unit(axis), x.cross(Vec3<double>::Unit(axis));
        piece.gram += motion * motion.transpose();
      }
    piece.held += held ? 1 : 0;
  }
  for (std::size_t i = 0, number = 0; i < n; ++i) {
    if (root(i) != i) continue;
    const Piece& piece = pieces[i];
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> eigen(piece.gram, Eigen::EigenvaluesOnly);
    const auto coordinate = [&](int axis) {
      const double x = piece.centre[axis];
      return to_text(std::abs(x) < 1e-9 * piece.radius ? 0 : x);
    };
    // Nodes a thousandth of the piece's size out of line count as in line.
    if (!(eigen.eigenvalues()[0] > 1e-8))
      invalid("static solve: piece " + std::to_string(number) + " (" + std::to_string(piece.nodes) + " nodes, around " +
              coordinate(0) + ", " + coordinate(1) + ", " + coordinate(2) +
              ") is free to move: " + std::to_string(piece.held) + " of its nodes " + (piece.held == 1 ? "is" : "are") +
              " held, and at least three that are not in line are needed");
    ++number;
  }
}

}  // namespace softsim
