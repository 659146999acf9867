// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

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

/// Options of `MovingLeastSquares`.
struct MovingLeastSquaresOptions {
  int order = 1;                                            ///< 0, 1 or 2
  double radius = std::numeric_limits<double>::infinity();  ///< of the support, m; infinite: weights are 1
  std::size_t nearest = 0;                                  ///< only so many nearest nodes; 0: no limit
};

/// Moving least squares (Lancaster & Salkauskas 1981; Bosman 2015, Eqs. 4.5-4.7, with p(x_i) p(x_i)^T in
/// Eq. 4.6): the polynomial that fits the nodal values best around x, taken at x. Weights are Wendland's C2
/// function, polynomials are reproduced up to the order, gradients are those of the whole expression (not the
/// diffuse ones). Shape functions approximate: phi_i(x_i) is not 1. For order 1 and 2 each place needs nodes
/// that determine the polynomial: 4 and 10 at least, not all in a plane; where they almost do not (a pivot
/// of the weighted basis below 1e-6 of the largest), that is refused too.
/// With `nearest`, functions jump where the neighbours change; gradients are those with the neighbours fixed.
template <NeighbourSearch Search = PointGrid>
class MovingLeastSquares {
 public:
  /// @param nodes rest positions in m
  /// @throws std::invalid_argument if there are no nodes, a coordinate is not finite, the order is not
  ///   0, 1 or 2, the radius is not positive, or the nodes as a whole are coincident, collinear, coplanar or
  ///   too few for the order
  explicit MovingLeastSquares(std::vector<Vec3<double>> nodes, const MovingLeastSquaresOptions& options = {})
      : neighbours_(std::move(nodes), options.radius, options.nearest), order_(options.order) {
    if (order_ < 0 || order_ > 2) invalid("order " + std::to_string(order_) + ": must be 0, 1 or 2");
    detail::check_nodes(name(), instead, order_, this->nodes(), [&](const Vec3<double>& y) {
      return Eigen::MatrixXd(polynomial_basis(order_, y).transpose());
    });
  }

  /// Rest positions in m.
  [[nodiscard]] const std::vector<Vec3<double>>& nodes() const { return neighbours_.nodes(); }
  /// The order: polynomials up to it are reproduced.
  [[nodiscard]] int consistency() const { return order_; }
  /// They lack the Kronecker property.
  [[nodiscard]] bool interpolates() const { return false; }
  /// The radius in m.
  [[nodiscard]] double support() const { return neighbours_.radius(); }

  /// The shape functions at x (m).
  /// @throws std::invalid_argument if x is not finite, no node is within the radius, or the nodes near x do
  ///   not determine a polynomial (they are coincident, collinear, coplanar or too few)
  [[nodiscard]] ShapeValues at(const Vec3<double>& x) const {
    const std::vector<Neighbour> near = neighbours_.at(x);
    const auto count = static_cast<Eigen::Index>(near.size());
    const double unit = detail::reach_of(near);  // the basis is that of (x_i - x) / unit
    Eigen::MatrixXd A(count, polynomial_terms(order_));
    Eigen::MatrixX3d g(count, 3);
    Eigen::VectorXd root(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const Neighbour& n = near[static_cast<std::size_t>(i)];
      const RadialWeight w = wendland_weight(n, neighbours_.radius());
      root[i] = std::sqrt(w.value);
      g.row(i) = w.log_gradient;
      A.row(i) = root[i] * polynomial_basis(order_, -n.offset / unit);
    }
    const detail::WeightedFit fit(A);
    if (!fit.determined()) detail::refuse_neighbours(name(), instead, order_, nodes(), near, x);
    const Vec3<double> here = Vec3<double>::Zero();
    const Eigen::VectorXd f = fit.functionals(polynomial_basis(order_, here));
    const Eigen::MatrixX3d df = fit.gradients(polynomial_gradients(order_, here) / unit, g, f);
    ShapeValues result;
    for (Eigen::Index i = 0; i < count; ++i) {
      result.nodes.push_back(near[static_cast<std::size_t>(i)].node);
      result.values.push_back(root[i] * f[i]);
      result.gradients.push_back(root[i] * df.row(i).transpose());
    }
    return result;
  }

 private:
  static constexpr const char* instead = "Shepard or GeneralisedMovingLeastSquares";
  [[nodiscard]] std::string name() const { return "moving least squares of order " + std::to_string(order_); }

  Neighbourhood<Search> neighbours_;
  int order_;
};

}  // namespace softsim
