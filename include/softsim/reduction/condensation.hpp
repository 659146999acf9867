// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "softsim/core/error.hpp"
#include "softsim/core/state.hpp"
#include "softsim/reduction/linearised.hpp"
#include "softsim/solver/report.hpp"
#include "softsim/system/free_components.hpp"

namespace softsim {

/// A force in N on chosen node number `place` (its place in the list, not its number in the mesh).
struct PlacedForce {
  std::ptrdiff_t place = 0;
  Vec3<double> force = Vec3<double>::Zero();
};

/// A demand on chosen node number `place`: its displacement along `direction` (a unit vector) is to be
/// `displacement`, m. Three of them, along x, y, z, hold it altogether; one, along the normal of a tool, lets
/// it slide.
struct PlacedContact {
  std::ptrdiff_t place = 0;
  Vec3<double> direction = Vec3<double>::UnitX();
  double displacement = 0;
};

namespace detail {
inline void check_chosen(const std::vector<std::int32_t>& nodes, std::size_t points) {
  if (nodes.empty()) invalid("condensation: no node is chosen");
  std::vector<bool> seen(points, false);
  for (const std::int32_t i : nodes) {
    if (i < 0 || static_cast<std::size_t>(i) >= points)
      invalid(std::string("condensation: node ") + std::to_string(i) + " is out of range (there are " +
              std::to_string(points) + ")");
    if (seen[static_cast<std::size_t>(i)])
      invalid(std::string("condensation: node ") + std::to_string(i) + " is chosen twice");
    seen[static_cast<std::size_t>(i)] = true;
  }
}
}  // namespace detail

/// Response of chosen nodes, as a rule the surface, of a system linearised at a state (Bro-Nielsen & Cotin
/// 1996, "Real-time volumetric deformable models for surgery simulation using finite elements and
/// condensation"): the compliance C = (K^-1)_ss is worked out once, and displacements of the chosen nodes are
/// sums of its columns. All displacements are increments from the linearisation state. Exact for a linear
/// system; a large rotation needs other means.
/// @tparam Stored scalar that C is kept in, float for half the memory
template <class Stored = double>
class Condensation {
 public:
  using Matrix = Eigen::Matrix<Stored, Eigen::Dynamic, Eigen::Dynamic>;

  /// Costs one sparse factorisation and three solves per chosen node.
  /// @param nodes numbers of the chosen nodes; prescribed components may be among them and do not move
  /// @throws std::invalid_argument naming the node: none chosen, out of range, chosen twice; or if the body
  ///   is not held or its state not stable
  template <class S>
  Condensation(const S& system, const State<typename S::Scalar>& q, std::vector<std::int32_t> nodes)
      : nodes_(std::move(nodes)), free_(system.prescribed) {
    detail::check_chosen(nodes_, system.rest().size());
    factorise_stiffness<typename S::Scalar>(stiffness_matrix(system, q, free_), "condensation", factor_);
    const auto count = 3 * static_cast<std::ptrdiff_t>(nodes_.size());
    for (const std::int32_t i : nodes_)
      for (int axis = 0; axis < 3; ++axis) number_.push_back(free_.number(i, axis));
    compliance_.setZero(count, count);
    x_.setZero(free_.size());
    for (std::ptrdiff_t c = 0; c < count; ++c) {
      if (number(c) < 0) continue;
      x_.setZero();
      x_[number(c)] = 1;
      x_ = factor_.solve(x_).eval();
      for (std::ptrdiff_t r = 0; r < count; ++r)
        if (number(r) >= 0) compliance_(r, c) = static_cast<Stored>(x_[number(r)]);
    }
  }

  /// Numbers of the chosen nodes in the mesh.
  [[nodiscard]] const std::vector<std::int32_t>& nodes() const { return nodes_; }
  /// Place of a node of the mesh among the chosen ones.
  /// @throws std::invalid_argument if it was not chosen
  [[nodiscard]] std::ptrdiff_t place(std::int32_t node) const {
    const auto found = std::find(nodes_.begin(), nodes_.end(), node);
    if (found == nodes_.end())
      invalid(std::string("condensation: node ") + std::to_string(node) + " was not chosen");
    return found - nodes_.begin();
  }
  /// C, 3 rows and columns per chosen node, m/N; zero where a component is prescribed.
  [[nodiscard]] const Matrix& compliance() const { return compliance_; }

  /// u = C f for forces on a few chosen nodes, 3 components per chosen node, m: costs the columns of those
  /// nodes alone. u stays as it was if a place does not exist or a force is not finite.
  LinearReport displacements(const std::vector<PlacedForce>& forces, Eigen::VectorXd& u) {
    for (const PlacedForce& f : forces) {
      if (f.place < 0 || f.place >= static_cast<std::ptrdiff_t>(nodes_.size()))
        return detail::ended(LinearReport{}, Status::not_converged, "condensation: no such place");
      if (!f.force.allFinite())
        return detail::ended(LinearReport{}, Status::not_finite, "condensation: a force is not finite");
    }
    u.setZero(compliance_.rows());
    for (const PlacedForce& f : forces)
      for (int axis = 0; axis < 3; ++axis)
        u += f.force[axis] * compliance_.col(3 * f.place + axis).template cast<double>();
    return detail::ended(LinearReport{}, Status::converged, "");
  }

  /// Contact forces, along the directions given, that bring chosen nodes to the displacements given while
  /// `others` act too: one dense symmetric system of the size of the contacts, G f = d - N^T C f_others with
  /// G = N^T C N. `forces` has one entry per contact (N, acting on the body along `direction`); `u` the
  /// displacements of all chosen nodes. Both stay as they were on failure: a place that does not exist, a
  /// direction that is no unit vector, demands that contradict or repeat each other, or one on a prescribed
  /// component.
  LinearReport contact(const std::vector<PlacedContact>& contacts, Eigen::VectorXd& forces,
                       Eigen::VectorXd& u, const std::vector<PlacedForce>& others = {}) {
    const auto k = static_cast<std::ptrdiff_t>(contacts.size());
    if (const LinearReport free_response = displacements(others, u_);
        free_response.status != Status::converged)
      return free_response;
    for (const PlacedContact& c : contacts) {
      if (c.place < 0 || c.place >= static_cast<std::ptrdiff_t>(nodes_.size()))
        return detail::ended(LinearReport{}, Status::not_converged, "condensation: no such place");
      if (!std::isfinite(c.displacement) || !c.direction.allFinite())
        return detail::ended(LinearReport{}, Status::not_finite, "condensation: a demand is not finite");
      if (std::abs(c.direction.norm() - 1) > 1e-6)
        return detail::ended(LinearReport{}, Status::not_converged,
                             "condensation: a direction is not a unit vector");
    }
    gram_.resize(k, k);
    demand_.resize(k);
    for (std::ptrdiff_t a = 0; a < k; ++a) {
      const PlacedContact& one = contacts[static_cast<std::size_t>(a)];
      demand_[a] = one.displacement - one.direction.dot(u_.segment<3>(3 * one.place));
      for (std::ptrdiff_t b = 0; b <= a; ++b) {
        const PlacedContact& other = contacts[static_cast<std::size_t>(b)];
        gram_(a, b) = gram_(b, a) = one.direction.dot(
            compliance_.template block<3, 3>(3 * one.place, 3 * other.place).template cast<double>() *
            other.direction);
      }
    }
    // Unit diagonal, so that a pivot says how far a demand is from the others.
    scale_ = gram_.diagonal();
    for (std::ptrdiff_t a = 0; a < k; ++a) {
      if (!(scale_[a] > 0))
        return detail::ended(LinearReport{}, Status::not_converged,
                             "condensation: a demand on a prescribed component");
      scale_[a] = 1 / std::sqrt(scale_[a]);
    }
    gram_ = (scale_.asDiagonal() * gram_ * scale_.asDiagonal()).eval();
    small_.compute(gram_);
    const double smallest = k == 0 ? 1 : small_.vectorD().minCoeff();
    if (!(smallest > 100 * static_cast<double>(std::numeric_limits<Stored>::epsilon())))
      return detail::ended(LinearReport{}, Status::not_converged,
                           "condensation: demands that depend on each other");
    demand_.array() *= scale_.array();
    if (k > 0) demand_ = small_.solve(demand_).eval();
    demand_.array() *= scale_.array();
    for (std::ptrdiff_t a = 0; a < k; ++a) {
      const PlacedContact& one = contacts[static_cast<std::size_t>(a)];
      for (int axis = 0; axis < 3; ++axis)
        u_ +=
            demand_[a] * one.direction[axis] * compliance_.col(3 * one.place + axis).template cast<double>();
    }
    if (!u_.allFinite())
      return detail::ended(LinearReport{}, Status::not_finite, "condensation: the result is not finite");
    forces = demand_;
    u = u_;
    return detail::ended(LinearReport{}, Status::converged, "");
  }

  /// Displacements of all nodes, a flat vector in m, under forces on chosen nodes: one sparse solve, in
  /// double. `all` stays as it was on failure.
  template <class T>
  LinearReport recover(const std::vector<PlacedForce>& forces, Vector<T>& all) {
    x_.setZero(free_.size());
    for (const PlacedForce& f : forces) {
      if (f.place < 0 || f.place >= static_cast<std::ptrdiff_t>(nodes_.size()))
        return detail::ended(LinearReport{}, Status::not_converged, "condensation: no such place");
      for (int axis = 0; axis < 3; ++axis)
        if (const std::int32_t k = number(3 * f.place + axis); k >= 0) x_[k] += f.force[axis];
    }
    x_ = factor_.solve(x_).eval();
    if (!x_.allFinite())
      return detail::ended(LinearReport{}, Status::not_finite, "condensation: the result is not finite");
    all.resize(free_.flat_size());
    free_.scatter(x_, all);
    return detail::ended(LinearReport{}, Status::converged, "");
  }

 private:
  [[nodiscard]] std::int32_t number(std::ptrdiff_t k) const { return number_[static_cast<std::size_t>(k)]; }

  std::vector<std::int32_t> nodes_;
  FreeComponents free_;
  StiffnessFactor factor_;
  std::vector<std::int32_t> number_;  // free component of each chosen component, -1 if prescribed
  Matrix compliance_;
  Eigen::VectorXd x_, u_, demand_, scale_;
  Eigen::MatrixXd gram_;
  Eigen::LDLT<Eigen::MatrixXd> small_;
};

/// Condensed stiffness K_ss - K_si K_ii^-1 K_is of a system linearised at q, N/m, 3 rows per chosen node:
/// the forces on the chosen nodes that hold them at given displacements while all others are free. Only the
/// others have to be held, by the chosen ones or by supports: a free body keeps its rigid motions. Rows and
/// columns of prescribed components are zero.
/// @throws std::invalid_argument as `Condensation`
template <class S>
[[nodiscard]] Eigen::MatrixXd condensed_stiffness(const S& system, const State<typename S::Scalar>& q,
                                                  const std::vector<std::int32_t>& nodes) {
  detail::check_chosen(nodes, system.rest().size());
  const FreeComponents free(system.prescribed);
  const Eigen::SparseMatrix<double> K = stiffness_matrix(system, q, free);
  // Number of each free component among the chosen ones (s >= 0) or among the others (-1 - i).
  std::vector<std::ptrdiff_t> role(static_cast<std::size_t>(free.size()), -1);
  for (std::size_t k = 0; k < nodes.size(); ++k)
    for (int axis = 0; axis < 3; ++axis)
      if (const std::int32_t n = free.number(nodes[k], axis); n >= 0)
        role[static_cast<std::size_t>(n)] = 3 * static_cast<std::ptrdiff_t>(k) + axis;
  std::ptrdiff_t others = 0;
  for (std::ptrdiff_t& r : role)
    if (r < 0) r = -1 - others++;
  const auto count = 3 * static_cast<std::ptrdiff_t>(nodes.size());
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(count, count);
  std::vector<Eigen::Triplet<double>> inner, coupling;
  for (int column = 0; column < K.outerSize(); ++column)
    for (Eigen::SparseMatrix<double>::InnerIterator k(K, column); k; ++k) {
      const std::ptrdiff_t r = role[static_cast<std::size_t>(k.row())],
                           c = role[static_cast<std::size_t>(k.col())];
      if (r >= 0 && c >= 0) result(r, c) += k.value();
      if (r < 0 && c < 0) inner.emplace_back(static_cast<int>(-1 - r), static_cast<int>(-1 - c), k.value());
      if (r < 0 && c >= 0) coupling.emplace_back(static_cast<int>(-1 - r), static_cast<int>(c), k.value());
    }
  if (others == 0) return result;
  Eigen::SparseMatrix<double> K_ii(others, others), K_is(others, count);
  K_ii.setFromTriplets(inner.begin(), inner.end());
  K_is.setFromTriplets(coupling.begin(), coupling.end());
  StiffnessFactor factor;
  factorise_stiffness<typename S::Scalar>(K_ii, "condensation", factor);
  const Eigen::MatrixXd response = factor.solve(Eigen::MatrixXd(K_is));
  result -= K_is.transpose() * response;
  return 0.5 * (result + result.transpose());
}

}  // namespace softsim
