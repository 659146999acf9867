// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "softsim/core/error.hpp"
#include "softsim/core/tensor.hpp"
#include "softsim/kinematics/neighbourhood.hpp"
#include "softsim/kinematics/node_shapes.hpp"
#include "softsim/kinematics/polynomial_fit.hpp"
#include "softsim/kinematics/radial_weights.hpp"
#include "softsim/mesh/point_grid.hpp"

namespace softsim {

/// Options of `InterpolatingMovingLeastSquares`.
struct InterpolatingMovingLeastSquaresOptions {
  int order = 1;                                            ///< 0, 1 or 2
  double power = 2;                                         ///< p > 1 of the weights
  double radius = std::numeric_limits<double>::infinity();  ///< of the support, m
  std::size_t nearest = 0;                                  ///< only so many nearest nodes; 0: no limit
};

/// Moving least squares with weights that have a pole at their node, ((R - d)/(R d))^p, so that the fit
/// passes through the nodes (Lancaster & Salkauskas 1981; Netuzhylov & Zilian 2009; Bosman 2015, Table 4.1):
/// phi_i(x_j) = delta_ij. Values and gradients are right at the nodes too: the pole is eliminated before
/// anything is computed. Order 0 is `Shepard`. Otherwise as `MovingLeastSquares`, with the same demands on
/// the nodes. With `nearest`, functions jump where the neighbours change; gradients are those with the
/// neighbours fixed.
template <NeighbourSearch Search = PointGrid>
class InterpolatingMovingLeastSquares {
 public:
  /// @param nodes rest positions in m, no two at the same place
  /// @throws std::invalid_argument if there are no nodes, a coordinate is not finite, two nodes coincide, the
  ///   order is not 0, 1 or 2, the power not above 1, the radius not positive, or the nodes as a whole are
  ///   collinear, coplanar or too few for the order
  explicit InterpolatingMovingLeastSquares(std::vector<Vec3<double>> nodes,
                                           const InterpolatingMovingLeastSquaresOptions& options = {})
      : neighbours_(std::move(nodes), options.radius, options.nearest),
        weight_{options.power, options.radius},
        order_(options.order) {
    if (order_ < 0 || order_ > 2) invalid("order " + std::to_string(order_) + ": must be 0, 1 or 2");
    weight_.check(1);
    neighbours_.require_distinct_nodes();
    detail::check_nodes(name(), instead, order_, this->nodes(), [&](const Vec3<double>& y) {
      return Eigen::MatrixXd(polynomial_basis(order_, y).transpose());
    });
  }

  /// Rest positions in m.
  [[nodiscard]] const std::vector<Vec3<double>>& nodes() const { return neighbours_.nodes(); }
  /// The order: polynomials up to it are reproduced.
  [[nodiscard]] int consistency() const { return order_; }
  /// They have the Kronecker property.
  [[nodiscard]] bool interpolates() const { return true; }
  /// The radius in m.
  [[nodiscard]] double support() const { return weight_.radius; }

  /// The shape functions at x (m). At a node those of the neighbours are there with value 0, for the sake of
  /// their gradients.
  /// @throws std::invalid_argument if x is not finite, no node is within the radius, or the nodes near x do
  ///   not determine a polynomial (they are collinear, coplanar or too few)
  [[nodiscard]] ShapeValues at(const Vec3<double>& x) const {
    std::vector<Neighbour> near = neighbours_.at(x);
    const std::size_t top = detail::nearest_of(near);
    std::vector<Neighbour> others = near;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(top));
    const Others rest = fit_of(others, near[top], x);
    ShapeValues result;
    double sum = 0;
    Vec3<double> gradient_sum = Vec3<double>::Zero();
    for (std::size_t i = 0; i < others.size(); ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      result.nodes.push_back(others[i].node);
      result.values.push_back(rest.values[row]);
      result.gradients.push_back(rest.gradients.row(row));
      sum += result.values[i];
      gradient_sum += result.gradients[i];
    }
    const auto place = static_cast<std::ptrdiff_t>(top);
    result.nodes.insert(result.nodes.begin() + place, near[top].node);
    result.values.insert(result.values.begin() + place, 1 - sum);
    result.gradients.insert(result.gradients.begin() + place, -gradient_sum);
    return result;
  }

 private:
  static constexpr const char* instead = "Shepard or GeneralisedMovingLeastSquares";
  struct Others {
    Eigen::VectorXd values;
    Eigen::MatrixX3d gradients;
  };

  // The nearest node m may be so near that its weight overflows. With the basis (1, p), p = 0 at x_m, and all
  // weights divided by that of the second nearest node, the moment equations for (a, b) are
  //   (1/r + sum w_i) a + s.b = 1,  s a + P b = p(x),  s = sum w_i p_i,  P = sum w_i p_i p_i^T,
  // sums over the others, 1/r the weight of m. The first, times r, is regular at m, where r = 0 and
  // grad r = 0. As phi_i = w_i (a + p_i.b), with v_i = sqrt(w_i) and f_i = phi_i / v_i:
  //   f = A P^-1 p(x) + u a,  u = v - A P^-1 A^T v,  a = r (1 - v.f) = r phi_m,
  // and so for the derivatives, the common divisor of the weights held fixed.
  [[nodiscard]] Others fit_of(const std::vector<Neighbour>& others, const Neighbour& m,
                              const Vec3<double>& x) const {
    const auto count = static_cast<Eigen::Index>(others.size()), terms = polynomial_terms(order_) - 1;
    if (count == 0 && terms == 0) return {Eigen::VectorXd(0), Eigen::MatrixX3d(0, 3)};
    const double second = count == 0 ? 0 : others[detail::nearest_of(others)].distance;
    const double unit = std::max(detail::reach_of(others), m.distance);
    const auto basis = [&](const Vec3<double>& offset) {  // offset from x_m
      return Eigen::VectorXd(polynomial_basis(order_, offset / unit).tail(terms));
    };
    Eigen::MatrixXd A(count, terms);
    Eigen::MatrixX3d g(count, 3);
    Eigen::VectorXd v(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const Neighbour& n = others[static_cast<std::size_t>(i)];
      v[i] = std::sqrt(weight_.ratio(n.distance, second));
      g.row(i) = weight_.log_gradient(n);
      if (terms > 0) A.row(i) = v[i] * basis(m.offset - n.offset);  // a row of no columns is a null pointer's
    }
    const detail::WeightedFit fit(A);
    if (!fit.determined()) {
      std::vector<Neighbour> near = others;
      near.push_back(m);
      detail::refuse_neighbours(name(), instead, order_, nodes(), near, x);
    }
    const double r = weight_.ratio(second, m.distance);
    Vec3<double> dr = Vec3<double>::Zero();
    if (m.distance > 0) dr = -r * weight_.log_gradient(m);
    const Eigen::VectorXd u = fit.residual(v), start = fit.functionals(basis(m.offset));
    const double divisor = 1 + r * v.dot(u);
    const Eigen::VectorXd f = start + u * (r * (1 - v.dot(start)) / divisor);
    const Eigen::MatrixX3d dp = polynomial_gradients(order_, m.offset / unit).bottomRows(terms) / unit;
    const Eigen::MatrixX3d e = fit.gradients(dp, g, f);
    const Eigen::RowVector3d da = ((1 - v.dot(f)) * dr.transpose() - r * v.transpose() * e) / divisor;
    return {v.cwiseProduct(f), v.asDiagonal() * (e + u * da)};
  }

  [[nodiscard]] std::string name() const {
    return "interpolating moving least squares of order " + std::to_string(order_);
  }

  Neighbourhood<Search> neighbours_;
  InverseDistance weight_;
  int order_;
};

}  // namespace softsim
