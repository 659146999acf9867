// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <gtest/gtest.h>

#include <Eigen/SparseCholesky>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "potential/bodies.hpp"
#include "softsim/material/neo_hookean.hpp"
#include "softsim/mesh/generators.hpp"
#include "softsim/mesh/selection.hpp"
#include "softsim/potential/elastic.hpp"
#include "softsim/solver/conjugate_gradient.hpp"
#include "softsim/solver/preconditioner.hpp"
#include "softsim/system/system.hpp"
#include "softsim/system/tangent.hpp"

/// What the tests of preconditioners of assembled tangents share.
namespace preconditioned {

using softsim::Vector;

/// A matrix with what preconditioners ask a tangent for.
template <class T>
struct Operator {
  softsim::SymmetricBlockMatrix<T> blocks;
  std::vector<softsim::Vec3<double>> points;
  Vector<T> free;

  [[nodiscard]] const auto& matrix() const { return blocks; }
  [[nodiscard]] const auto& rest() const { return points; }
  void diagonal_blocks(std::vector<softsim::Mat3<T>>& diagonal) const {
    diagonal.resize(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto n = static_cast<std::int32_t>(i);
      diagonal[i] = blocks.block(blocks.place(n, n) / 2);
    }
  }
  void apply(const Vector<T>& x, Vector<T>& y) const {
    blocks.apply(x, y);
    y.array() *= free.array();
  }
};

/// The tangent of a mesh at q: mass per node times the unit matrix, plus stiffness.
template <class T = double>
Operator<T> tangent(const softsim::TetrahedralMesh& mesh, const std::vector<softsim::NeoHookean>& laws,
                    const std::vector<std::int32_t>& law_of, const softsim::State<T>& q,
                    const std::vector<std::int32_t>& fixed, double mass = 0) {
  using System = softsim::System<softsim::ElasticTetrahedra<softsim::NeoHookean, T>>;
  System system(mesh, softsim::elastic<T>(mesh, laws, law_of));
  system.prescribed.fix(fixed);
  softsim::AssembledTangent<System> A;
  A.set(system, q, {});
  Operator<T> result{A.matrix(), mesh.points(), system.prescribed.free()};
  for (std::size_t i = 0; i < mesh.points().size() && mass > 0; ++i) {
    const auto n = static_cast<std::int32_t>(i);
    result.blocks.block(result.blocks.place(n, n) / 2).diagonal().array() += static_cast<T>(mass);
  }
  return result;
}
/// The same of one law, at rest, held at x = min.
template <class T = double>
Operator<T> tangent(const softsim::TetrahedralMesh& mesh, double mass = 0) {
  return tangent<T>(mesh, {softsim::NeoHookean::from_young_poisson(1000, 0.4)},
                    std::vector<std::int32_t>(mesh.tetrahedra().size(), 0),
                    softsim::State<T>(mesh.points().size()),
                    softsim::nodes_near(mesh, softsim::Side::xmin, 0), mass);
}

/// A right-hand side without prescribed components.
template <class T>
Vector<T> right_hand_side(const Operator<T>& A, std::uint64_t seed) {
  Vector<T> b = bodies::random_vector<T>(A.points.size(), 1, seed);
  b.array() *= A.free.array();
  return b;
}

/// x . B y = y . B x and x . B x > 0 for some vectors, and nothing where it does not belong.
template <class T, class B>
void expect_symmetric_positive(const Operator<T>& A, const B& preconditioner, double tolerance) {
  Vector<T> Bx(A.free.size()), By(A.free.size());
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Vector<T> x = right_hand_side(A, 2 * seed), y = right_hand_side(A, 2 * seed + 1);
    preconditioner.apply(x, Bx);
    preconditioner.apply(y, By);
    const double xx = softsim::dot(x, Bx), yy = softsim::dot(y, By);
    EXPECT_GT(xx, 0);
    EXPECT_GT(yy, 0);
    EXPECT_NEAR(softsim::dot(x, By), softsim::dot(y, Bx), tolerance * std::sqrt(xx * yy));
    for (std::ptrdiff_t i = 0; i < Bx.size(); ++i)
      if (A.free[i] == T(0)) {
        EXPECT_EQ(Bx[i], T(0)) << i;
      }
  }
}

/// Solves for a random right-hand side; the report and x.
template <class T, class B>
std::pair<softsim::LinearReport, Vector<T>> solve(const Operator<T>& A, const B& preconditioner,
                                                  double tolerance = 1e-8) {
  const Vector<T> b = right_hand_side(A, 77);
  Vector<T> x = Vector<T>::Zero(b.size());
  softsim::ConjugateGradient::Workspace<T> workspace;
  const auto report = softsim::ConjugateGradient{.max_iterations = 5000, .tolerance = tolerance}.solve(
      A, preconditioner, b, x, workspace);
  return {report, x};
}

/// The same by Eigen's LDL^T.
inline Vector<double> solve_directly(const Operator<double>& A) {
  const Vector<double> free = softsim::pack(A.free);
  Eigen::SparseMatrix<double> K = A.blocks.to_eigen();
  K.prune([&](Eigen::Index i, Eigen::Index j, double) { return free[i] * free[j] == 1; });
  for (Eigen::Index i = 0; i < free.size(); ++i)
    if (free[i] == 0) K.coeffRef(i, i) = 1;
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> direct(K);
  return softsim::unpack(Vector<double>(direct.solve(softsim::pack(right_hand_side(A, 77)))));
}

/// Two meshes side by side, not connected.
inline softsim::TetrahedralMesh side_by_side(const softsim::TetrahedralMesh& a,
                                             const softsim::TetrahedralMesh& b) {
  auto points = a.points();
  points.insert(points.end(), b.points().begin(), b.points().end());
  auto tetrahedra = a.tetrahedra();
  for (auto t : b.tetrahedra()) {
    for (auto& i : t) i += static_cast<std::int32_t>(a.points().size());
    tetrahedra.push_back(t);
  }
  return {std::move(points), std::move(tetrahedra)};
}

/// n points without a mesh; every block of the matrix is zero but those on the diagonal, which are `value`.
inline Operator<double> points_alone(std::size_t n, double value) {
  std::vector<std::pair<std::int32_t, std::int32_t>> pattern;
  Operator<double> A;
  A.free = Vector<double>::Zero(4 * static_cast<std::ptrdiff_t>(n));
  for (std::size_t i = 0; i < n; ++i) {
    pattern.emplace_back(static_cast<std::int32_t>(i), static_cast<std::int32_t>(i));
    A.points.push_back({static_cast<double>(i), 0, 0});
    softsim::block(A.free, static_cast<std::ptrdiff_t>(i)).setOnes();
  }
  A.blocks = softsim::SymmetricBlockMatrix<double>(n, pattern);
  for (std::size_t i = 0; i < n; ++i)
    A.blocks.block(static_cast<std::int32_t>(i)).diagonal().setConstant(value);
  return A;
}

}  // namespace preconditioned
