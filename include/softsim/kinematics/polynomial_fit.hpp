// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/QR>
#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "softsim/core/error.hpp"
#include "softsim/core/tensor.hpp"
#include "softsim/kinematics/neighbourhood.hpp"
#include "softsim/kinematics/point_text.hpp"

namespace softsim {

/// Number of coefficients of a polynomial of order 0, 1 or 2 in space: 1, 4 or 10.
[[nodiscard]] constexpr Eigen::Index polynomial_terms(int order) {
  return order == 0 ? 1 : order == 1 ? 4 : 10;
}

/// The complete basis of that order at y: 1, x, y, z, x^2, y^2, z^2, yz, zx, xy.
[[nodiscard]] inline Eigen::VectorXd polynomial_basis(int order, const Vec3<double>& y) {
  Eigen::VectorXd p(10);
  p << 1, y, y.cwiseAbs2(), y[1] * y[2], y[2] * y[0], y[0] * y[1];
  return p.head(polynomial_terms(order));
}

/// Its gradients at y, one row a term.
[[nodiscard]] inline Eigen::MatrixX3d polynomial_gradients(int order, const Vec3<double>& y) {
  Eigen::MatrixX3d dp = Eigen::MatrixX3d::Zero(10, 3);
  dp.middleRows<3>(1).setIdentity();
  dp.middleRows<3>(4).diagonal() = 2 * y;
  dp.bottomRows<3>() << 0, y[2], y[1], y[2], 0, y[0], y[1], y[0], 0;
  return dp.topRows(polynomial_terms(order));
}

namespace detail {

/// Weighted least squares at one place. Row i of A is sqrt(w_i) p(x_i), so that the moment matrix is
/// M = A^T A (Bosman 2015, Eq. 4.6, with p(x_i) for its p(x)) and shape functions are, with
/// f = A M^-1 p(x), phi_i = sqrt(w_i) f_i. M itself is never formed: its condition is the square of A's.
class WeightedFit {
 public:
  /// Pivots of A below this share of the largest count as zero, of M its square. Shape functions keep about
  /// ten digits above it.
  static constexpr double tolerance = 1e-6;

  explicit WeightedFit(const Eigen::MatrixXd& A, double smallest = tolerance)
      : A_(A), inverse_(A.cols(), A.rows()), determined_(A.rows() >= A.cols()) {
    if (!determined_ || A.cols() == 0) return;
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> factors(A.rows(), A.cols());
    factors.setThreshold(smallest);
    factors.compute(A);
    determined_ = factors.rank() == A.cols();
    if (determined_) inverse_ = factors.pseudoInverse();
  }

  /// Whether the data determine all coefficients; without that the rest is not defined.
  [[nodiscard]] bool determined() const { return determined_; }
  /// A M^-1 p; several p side by side.
  [[nodiscard]] Eigen::MatrixXd functionals(const Eigen::MatrixXd& p) const {
    return inverse_.transpose() * p;
  }
  /// What remains of the columns of v after the best fit: v - A M^-1 A^T v.
  [[nodiscard]] Eigen::MatrixXd residual(const Eigen::MatrixXd& v) const { return v - A_ * (inverse_ * v); }
  /// Derivatives of phi_i / sqrt(w_i), all of them: with g = grad log w and G = diag(g_k) along axis k,
  /// (M^-1)_,k = -M^-1 A^T G A M^-1 gives A M^-1 p_,k + (1 - A M^-1 A^T) G f.
  [[nodiscard]] Eigen::MatrixX3d gradients(const Eigen::MatrixX3d& dp, const Eigen::MatrixX3d& g,
                                           const Eigen::VectorXd& f) const {
    return functionals(dp) + residual(f.asDiagonal() * g);
  }

 private:
  Eigen::MatrixXd A_, inverse_;  // the latter M^-1 A^T
  bool determined_;
};

/// "coincident", "collinear", "coplanar", or a phrase for points in space that fail all the same.
inline std::string arrangement(const std::vector<Vec3<double>>& points, int order, double tolerance) {
  Eigen::MatrixX3d offsets(points.size(), 3);
  for (std::size_t i = 0; i < points.size(); ++i)
    offsets.row(static_cast<Eigen::Index>(i)) = points[i] - points[0];
  if (offsets.isZero(0)) return "coincident";
  Eigen::ColPivHouseholderQR<Eigen::MatrixX3d> factors(offsets.rows(), 3);
  factors.setThreshold(tolerance);
  factors.compute(offsets);
  if (factors.rank() == 1) return "collinear";
  if (factors.rank() == 2) return "coplanar";
  return "too few or too badly placed for " + std::to_string(polynomial_terms(order)) + " coefficients";
}

/// Refuses nodes which, all together, do not determine a polynomial: `rows(y)` are the rows of A of a node at
/// y with weight 1.
template <class Rows>
void check_nodes(const std::string& what, const std::string& instead, int order,
                 const std::vector<Vec3<double>>& nodes, const Rows& rows) {
  constexpr double rounding = 1e-10;  // only what is degenerate as a whole, whatever the weights
  Vec3<double> centre = Vec3<double>::Zero();
  for (const Vec3<double>& X : nodes) centre += X / static_cast<double>(nodes.size());
  double reach = 0;
  for (const Vec3<double>& X : nodes) reach = std::max(reach, (X - centre).norm());
  if (!(reach > 0)) reach = 1;
  const Eigen::Index each = rows(centre).rows();
  Eigen::MatrixXd A(each * static_cast<Eigen::Index>(nodes.size()), polynomial_terms(order));
  for (std::size_t i = 0; i < nodes.size(); ++i)
    A.middleRows(each * static_cast<Eigen::Index>(i), each) = rows((nodes[i] - centre) / reach);
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factors(A.rows(), A.cols());
  factors.setThreshold(rounding);
  factors.compute(A);
  if (factors.rank() < A.cols())
    invalid(what + ": the nodes (" + std::to_string(nodes.size()) + " in all) are " +
            arrangement(nodes, order, rounding) + "; use " + instead);
}

/// Refuses the neighbours of x for the same reason.
[[noreturn]] inline void refuse_neighbours(const std::string& what, const std::string& instead, int order,
                                           const std::vector<Vec3<double>>& nodes,
                                           const std::vector<Neighbour>& near, const Vec3<double>& x) {
  std::vector<Vec3<double>> points;
  for (const Neighbour& n : near) points.push_back(nodes[static_cast<std::size_t>(n.node)]);
  invalid(what + " at " + point_text(x) + ": the nodes near it (" + std::to_string(near.size()) + ") are " +
          arrangement(points, order, WeightedFit::tolerance) + "; use a larger neighbourhood, " + instead);
}

}  // namespace detail

}  // namespace softsim
