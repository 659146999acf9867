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
#include "softsim/kinematics/point_text.hpp"
#include "softsim/kinematics/polynomial_fit.hpp"
#include "softsim/kinematics/radial_weights.hpp"
#include "softsim/mesh/point_grid.hpp"

namespace softsim {

/// Options of `GeneralisedMovingLeastSquares`.
struct GeneralisedMovingLeastSquaresOptions {
  int order = 1;                                            ///< 1 or 2
  double radius = std::numeric_limits<double>::infinity();  ///< of the support, m; infinite: weights are 1
  double length = 0;        ///< h in m, what a misfit in gradient weighs against one in value; 0: the radius
  std::size_t nearest = 0;  ///< only so many nearest nodes; 0: no limit
};

/// Moving least squares from the values and the gradients of the field at the nodes (Martin et al. 2010,
/// Unified Simulation of Elastic Rods, Shells, and Solids; Bosman 2015, Sec. 4.1): the polynomial p.c with
/// the least sum_i w_i (|p(x_i).c - u_i|^2 + h^2 |grad p(x_i).c - grad u_i|^2), taken at x. `slopes` are what
/// the nodal gradients are multiplied with. Order 1 takes nodes in any arrangement, collinear, coplanar, a
/// single one; order 2 needs nodes that are not all in a plane. Weights are Wendland's C2 function; shape
/// functions approximate, and reproduce polynomials up to the order if the nodes hold both their values and
/// their gradients.
/// With `nearest`, functions jump where the neighbours change; gradients are those with the neighbours fixed.
template <NeighbourSearch Search = PointGrid>
class GeneralisedMovingLeastSquares {
 public:
  /// @param nodes rest positions in m
  /// @throws std::invalid_argument if there are no nodes, a coordinate is not finite, the order is not
  ///   1 or 2, the radius is not positive, the length is not positive and finite, or the order is 2 and the
  ///   nodes as a whole are coincident, collinear, coplanar or too few
  explicit GeneralisedMovingLeastSquares(std::vector<Vec3<double>> nodes,
                                         const GeneralisedMovingLeastSquaresOptions& options)
      : neighbours_(std::move(nodes), options.radius, options.nearest),
        order_(options.order),
        length_(options.length == 0 ? options.radius : options.length) {
    if (order_ < 1 || order_ > 2) invalid("order " + std::to_string(order_) + ": must be 1 or 2");
    if (!(length_ > 0 && std::isfinite(length_)))
      invalid(std::string("length ") + to_text(length_) + " m: must be positive and finite");
    if (order_ > 1)
      detail::check_nodes(name(), instead, order_, this->nodes(),
                          [&](const Vec3<double>& y) { return data(y, 1); });
  }

  /// Rest positions in m.
  [[nodiscard]] const std::vector<Vec3<double>>& nodes() const { return neighbours_.nodes(); }
  /// The order, if the nodes hold the gradients of the field too; 0 if these are left out.
  [[nodiscard]] int consistency() const { return order_; }
  /// They lack the Kronecker property.
  [[nodiscard]] bool interpolates() const { return false; }
  /// The radius in m.
  [[nodiscard]] double support() const { return neighbours_.radius(); }

  /// The shape functions at x (m), with slopes.
  /// @throws std::invalid_argument if x is not finite, no node is within the radius, the length is below a
  ///   millionth of a neighbour's distance, or the order is 2 and the nodes near x do not determine a
  ///   polynomial
  [[nodiscard]] ShapeValues at(const Vec3<double>& x) const {
    const std::vector<Neighbour> near = neighbours_.at(x);
    // The basis is that of (x_i - x) / unit. Not smaller than h: a gradient then weighs no more than a value.
    const double unit = std::max(length_, detail::reach_of(near)), h = length_ / unit;
    if (h < smallest)
      invalid(std::string("length ") + to_text(length_) + " m: below a millionth of " + to_text(unit) +
              " m, the distance of a neighbour of " + detail::point_text(x));
    const auto count = static_cast<Eigen::Index>(near.size());
    Eigen::MatrixXd A(4 * count, polynomial_terms(order_));
    Eigen::MatrixX3d g(4 * count, 3);
    Eigen::VectorXd root(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const Neighbour& n = near[static_cast<std::size_t>(i)];
      const RadialWeight w = wendland_weight(n, neighbours_.radius());
      root[i] = std::sqrt(w.value);
      g.middleRows<4>(4 * i).rowwise() = w.log_gradient.transpose();
      A.middleRows<4>(4 * i) = root[i] * data(-n.offset / unit, h);
    }
    // In order 1 any one node determines all, so that nothing needs to be refused.
    const detail::WeightedFit fit(A, order_ == 1 ? 0 : detail::WeightedFit::tolerance);
    if (!fit.determined()) detail::refuse_neighbours(name(), instead, order_, nodes(), near, x);
    const Vec3<double> here = Vec3<double>::Zero();
    const Eigen::VectorXd f = fit.functionals(polynomial_basis(order_, here));
    const Eigen::MatrixX3d df = fit.gradients(polynomial_gradients(order_, here) / unit, g, f);
    ShapeValues result;
    for (Eigen::Index i = 0; i < count; ++i) {
      result.nodes.push_back(near[static_cast<std::size_t>(i)].node);
      result.values.push_back(root[i] * f[4 * i]);
      result.gradients.push_back(root[i] * df.row(4 * i).transpose());
      result.slopes.push_back(root[i] * length_ * f.segment<3>(4 * i + 1));
      result.slope_gradients.push_back(root[i] * length_ * df.middleRows<3>(4 * i + 1));
    }
    return result;
  }

 private:
  static constexpr double smallest = 1e-6;  // of a length: what its gradients tell is lost in rounding below
  static constexpr const char* instead = "order 1 or Shepard";
  // What a node at y holds of each term: its value, and h times its gradient.
  [[nodiscard]] Eigen::MatrixXd data(const Vec3<double>& y, double h) const {
    Eigen::MatrixXd rows(4, polynomial_terms(order_));
    rows.row(0) = polynomial_basis(order_, y);
    rows.bottomRows<3>() = h * polynomial_gradients(order_, y).transpose();
    return rows;
  }
  [[nodiscard]] std::string name() const {
    return "generalised moving least squares of order " + std::to_string(order_);
  }

  Neighbourhood<Search> neighbours_;
  int order_;
  double length_;
};

}  // namespace softsim
