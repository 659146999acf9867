// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

#include "softsim/core/error.hpp"
#include "softsim/core/state.hpp"
#include "softsim/system/system.hpp"

namespace softsim {

namespace detail {

// The upper triangles of blocks of all stencils of a system's terms, each for itself.
template <class T>
struct StencilBlocks {
  struct Stencil {
    std::size_t first_node, nodes, first_block;
  };
  std::vector<Stencil> stencils;
  std::vector<std::int32_t> nodes;
  std::vector<std::vector<T>> values;  // of each term, nine scalars a block
  std::vector<std::size_t> term;       // of each stencil

  // Block (i, j), i <= j, of stencil e.
  [[nodiscard]] Mat3<double> block(std::size_t e, std::size_t i, std::size_t j) const {
    const Stencil& s = stencils[e];
    const std::size_t k = s.first_block + i * s.nodes - i * (i + 1) / 2 + j;
    return Eigen::Map<const Mat3<T>>(values[term[e]].data() + 9 * k).template cast<double>();
  }

  template <class S>
  StencilBlocks(const S& system, const State<T>& q) {
    system.for_each_term([&](const auto& t) {
      using Term = std::decay_t<decltype(t)>;
      if constexpr (Term::has_hessian && !is_viscous<Term>) {
        std::vector<std::int32_t> places;
        t.for_each_stencil([&](const auto& stencil) {
          stencils.push_back({nodes.size(), stencil.size(), places.size()});
          term.push_back(values.size());
          for (const std::int32_t i : stencil) nodes.push_back(i);
          for (std::size_t k = stencil.size() * (stencil.size() + 1) / 2; k > 0; --k) {
            if (places.size() >= (std::size_t{1} << 30))
              invalid("element bound: the term has 2^30 blocks or more");
            places.push_back(2 * static_cast<std::int32_t>(places.size()));
          }
        });
        values.emplace_back(9 * places.size() + 1, T(0));
        t.add_blocks(q, T(1), places, values.back().data());
      }
    });
  }
};

}  // namespace detail

/// An upper bound of the largest eigenvalue of K x = lambda M x on the free components, 1/s^2: the largest of
/// the eigenvalues of all stencils with shares of the lumped mass (Irons & Treharne 1971; for linear
/// tetrahedra the element eigenvalue that sets explicit steps). Holds at any q for every lumped mass and
/// every term whose Hessian is the sum of the blocks it adds (those of `Elements`, and all others of the
/// library), because any partition of the mass among the stencils gives a bound: here that in proportion to
/// the norms of a node's rows in the stencils' stiffness. Prescribed components are left out of the stencils.
/// Where K is not positive semidefinite it bounds the largest eigenvalue, not the absolute values. For
/// set-up: it allocates, 0.7 kB per tetrahedron; the cost is about that of an assembly and an eigenvalue
/// problem of 12 unknowns per tetrahedron.
/// @throws std::invalid_argument if the mass is not lumped, there are frames, or a free component has no mass
/// but stiffness
template <class S>
[[nodiscard]] double element_eigenvalue_bound(const S& system, const State<typename S::Scalar>& q) {
  using T = typename S::Scalar;
  if (!system.mass.is_lumped()) invalid("element bound: the mass must be lumped");
  if (system.frames() > 0) invalid("element bound: the system must not have frames");
  const detail::StencilBlocks<T> blocks(system, q);
  const Vector<T>&free = system.prescribed.free(), &m = system.mass.diagonal();
  // K of stencil e over its free components, zero rows and columns elsewhere.
  Eigen::MatrixXd K;
  const auto component = [&](std::size_t e, std::size_t i) {
    return block_stride * static_cast<std::ptrdiff_t>(blocks.nodes[blocks.stencils[e].first_node + i]);
  };
  const auto fill = [&](std::size_t e) {
    const std::size_t n = blocks.stencils[e].nodes;
    K.setZero(3 * static_cast<std::ptrdiff_t>(n), 3 * static_cast<std::ptrdiff_t>(n));
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = i; j < n; ++j) {
        const Mat3<double> b = blocks.block(e, i, j);
        const auto row = 3 * static_cast<std::ptrdiff_t>(i), column = 3 * static_cast<std::ptrdiff_t>(j);
        for (std::ptrdiff_t c = 0; c < 3; ++c)
          for (std::ptrdiff_t a = 0; a < 3; ++a)
            if (free[component(e, i) + a] != T(0) && free[component(e, j) + c] != T(0))
              K(row + a, column + c) = K(column + c, row + a) = b(a, c);
      }
  };
  // Weights of the shares: sums of the norms over the stencils of every component.
  Vector<double> total = Vector<double>::Zero(system.size());
  for (std::size_t e = 0; e < blocks.stencils.size(); ++e) {
    fill(e);
    for (std::ptrdiff_t k = 0; k < K.rows(); ++k)
      total[component(e, static_cast<std::size_t>(k / 3)) + k % 3] += K.row(k).norm();
  }
  double bound = 0;
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
  Eigen::VectorXd scale;
  for (std::size_t e = 0; e < blocks.stencils.size(); ++e) {
    fill(e);
    scale.setZero(K.rows());
    for (std::ptrdiff_t k = 0; k < K.rows(); ++k) {
      const std::ptrdiff_t at = component(e, static_cast<std::size_t>(k / 3)) + k % 3;
      const double weight = K.row(k).norm();
      if (weight == 0) continue;
      const double mass = static_cast<double>(m[at]) * weight / total[at];
      if (!(mass > 0))
        invalid(std::string("element bound: node ") + std::to_string(at / block_stride) + " has mass " +
                to_text(static_cast<double>(m[at])) + " kg, which must be positive where it is free");
      scale[k] = 1 / std::sqrt(mass);
    }
    K = scale.asDiagonal() * K * scale.asDiagonal();
    if (!K.allFinite()) return std::numeric_limits<double>::infinity();
    solver.compute(K, Eigen::EigenvaluesOnly);
    bound = std::max(bound, solver.eigenvalues().maxCoeff());
  }
  return bound;
}

}  // namespace softsim
