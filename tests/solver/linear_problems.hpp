// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "potential/bodies.hpp"
#include "softsim/material/neo_hookean.hpp"
#include "softsim/mesh/selection.hpp"
#include "softsim/potential/elastic.hpp"
#include "softsim/system/block_matrix.hpp"
#include "softsim/system/system.hpp"
#include "softsim/system/tangent.hpp"

// Linear systems for the tests of methods and preconditioners.

namespace linear_problems {

using softsim::Vector;

/// A symmetric 3n x 3n matrix as an operator like an assembled tangent without prescribed components. Blocks
/// off the diagonal that are zero are not in its pattern.
template <class T = double>
class BlockOperator {
 public:
  explicit BlockOperator(const Eigen::MatrixXd& K) {
    const auto n = static_cast<std::int32_t>(K.rows() / 3);
    std::vector<std::pair<std::int32_t, std::int32_t>> blocks;
    for (std::int32_t i = 0; i < n; ++i)
      for (std::int32_t j = i; j < n; ++j)
        if (i == j || !K.block<3, 3>(3 * i, 3 * j).isZero(0)) blocks.emplace_back(i, j);
    matrix_ = softsim::SymmetricBlockMatrix<T>(static_cast<std::size_t>(n), blocks);
    for (const auto& [i, j] : blocks)
      matrix_.block(matrix_.place(i, j) / 2) = K.block<3, 3>(3 * i, 3 * j).template cast<T>();
  }
  void apply(const Vector<T>& x, Vector<T>& y) const { matrix_.apply(x, y); }
  void diagonal_blocks(std::vector<softsim::Mat3<T>>& out) const {
    out.clear();
    for (std::int32_t i = 0; i < static_cast<std::int32_t>(matrix_.rows()); ++i)
      out.push_back(matrix_.block(matrix_.place(i, i) / 2));
  }
  const softsim::SymmetricBlockMatrix<T>& matrix() const { return matrix_; }
  softsim::SymmetricBlockMatrix<T>& matrix() { return matrix_; }

 private:
  softsim::SymmetricBlockMatrix<T> matrix_;
};

/// All components free.
template <class T = double>
Vector<T> all_free(std::ptrdiff_t nodes) {
  Vector<T> free = Vector<T>::Ones(4 * nodes);
  for (std::ptrdiff_t i = 0; i < nodes; ++i) free[4 * i + 3] = 0;
  return free;
}

/// Q diag(eigenvalues) Q^T with a random rotation Q.
inline Eigen::MatrixXd with_eigenvalues(const Eigen::VectorXd& eigenvalues, std::uint64_t seed) {
  const std::ptrdiff_t n = eigenvalues.size();
  bodies::Random random(seed);
  Eigen::MatrixXd R(n, n);
  for (std::ptrdiff_t i = 0; i < R.size(); ++i) R(i) = random.number();
  const Eigen::MatrixXd Q = Eigen::HouseholderQR<Eigen::MatrixXd>(R).householderQ();
  const Eigen::MatrixXd K = Q * eigenvalues.asDiagonal() * Q.transpose();
  return (K + K.transpose()) / 2;
}

/// tridiag(-1, 2, -1) with n rows, three times side by side: blocks that are multiples of the identity, so
/// that a method of blocks is the method of points.
inline Eigen::MatrixXd three_chains(std::ptrdiff_t n) {
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(3 * n, 3 * n);
  for (std::ptrdiff_t i = 0; i < 3 * n; ++i) {
    K(i, i) = 2;
    if (i + 3 < 3 * n) K(i, i + 3) = K(i + 3, i) = -1;
  }
  return K;
}

/// |b - K x| / |b| in double precision, of packed vectors.
inline double residual(const Eigen::MatrixXd& K, const Vector<double>& b, const Vector<double>& x) {
  return (softsim::pack(b) - K * softsim::pack(x)).norm() / b.norm();
}

/// A Neo-Hookean cube held at one side and by a roller that leaves a block half free, some way from rest.
template <class T = double>
struct Cube {
  using System = softsim::System<decltype(softsim::elastic<T>(std::declval<const softsim::TetrahedralMesh&>(),
                                                              std::declval<softsim::NeoHookean>()))>;
  softsim::TetrahedralMesh mesh = bodies::distorted_cube(3, 1);
  System system{mesh, softsim::elastic<T>(mesh, softsim::NeoHookean::from_young_poisson(10, 0.4))};
  softsim::State<T> q = bodies::random_state<T>(mesh.points().size(), 0.01, 2);
  softsim::AssembledTangent<System> A;
  Vector<T> free, b;

  Cube() {
    system.prescribed.fix(softsim::nodes_near(mesh, softsim::Side::zmin, 0));
    system.prescribed.set(63, 1, 0);
    free = system.prescribed.free();
    A.set(system, q, {});
    b = bodies::random_vector<T>(mesh.points().size(), 1, 3);
    system.prescribed.mask(b);
  }
  Cube(const Cube&) = delete;
  Cube& operator=(const Cube&) = delete;

  /// The matrix with identity rows for prescribed components.
  [[nodiscard]] Eigen::MatrixXd dense() const {
    const Eigen::VectorXd open = softsim::pack(free).template cast<double>();
    Eigen::MatrixXd K = A.matrix().to_eigen().toDense().template cast<double>();
    K = open.asDiagonal() * K * open.asDiagonal();
    K.diagonal() += Eigen::VectorXd::Ones(open.size()) - open;
    return K;
  }
  /// The solution of A x = b by a dense factorisation.
  [[nodiscard]] Eigen::VectorXd exact() const {
    return dense().ldlt().solve(Eigen::VectorXd(softsim::pack(b).template cast<double>()));
  }
};

}  // namespace linear_problems
