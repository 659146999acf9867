// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "softsim/core/error.hpp"
#include "softsim/core/tensor.hpp"
#include "softsim/kinematics/affine_hull.hpp"
#include "softsim/kinematics/exponential_weights.hpp"
#include "softsim/kinematics/node_shapes.hpp"
#include "softsim/kinematics/point_text.hpp"
#include "softsim/mesh/point_grid.hpp"

namespace softsim {

/// Options of `MaximumEntropy`.
struct MaximumEntropyOptions {
  double spacing;        ///< h in m: about the distance between nodes
  double gamma = 1.8;    ///< beta h^2; 0.6 is wide and smooth, 4 nearly linear interpolation
  double cutoff = 1e-6;  ///< value of the prior at the support radius, in (0, 1)
};

/// Local maximum-entropy shape functions (Sukumar 2004; Arroyo & Ortiz 2006; Bosman 2015, Sec. 4.1 and Table
/// 4.1): the weights w_i >= 0 that commit themselves least, relative to the prior exp(-beta |x - x_i|^2),
/// among those with sum w_i = 1 and sum w_i x_i = x,
///   w_i = exp(-beta |x - x_i|^2 + lambda . (x - x_i)) / Z(lambda),
/// with the lambda that minimises log Z; beta = gamma / h^2.
///   grad w_i = -w_i C^-1 (x - x_i),  C = sum w_i (x - x_i) (x - x_i)^T,
/// since the derivatives of the prior and of lambda, 2 beta I - C^-1, add up to that.
/// The prior is cut off at the support radius h sqrt(log(1 / cutoff) / gamma) (2.8 h by default), where
/// weights jump by about `cutoff`.
/// Coplanar and collinear nodes are taken within their plane or line: x is projected onto it, and gradients
/// lie in it.
/// Do they interpolate, as Table 4.1 says? On a face of the convex hull only the nodes of that face count
/// (weak Kronecker property), at a node that is a corner of the hull only that node. A node that is not a
/// corner shares its place with others, less and less as gamma grows (the limit is linear interpolation on a
/// Delaunay mesh). So the table holds for Sukumar's polygons, whose nodes are all corners, not in general;
/// `interpolates()` tells the two apart.
template <NeighbourSearch Search = PointGrid>
class MaximumEntropy {
 public:
  /// @param nodes rest positions in m
  /// @throws std::invalid_argument if there are no nodes, a coordinate is not finite, spacing or gamma is not
  ///   positive and finite, cutoff is not in (0, 1)
  MaximumEntropy(std::vector<Vec3<double>> nodes, const MaximumEntropyOptions& options)
      : nodes_(std::move(nodes)), hull_(nodes_), search_(hull_.local(nodes_)), options_(options) {
    if (!(options.spacing > 0 && std::isfinite(options.spacing)))
      invalid(std::string("spacing ") + to_text(options.spacing) + " m: must be positive and finite");
    if (!(options.gamma > 0 && std::isfinite(options.gamma)))
      invalid(std::string("gamma ") + to_text(options.gamma) + ": must be positive and finite");
    if (!(options.cutoff > 0 && options.cutoff < 1))
      invalid(std::string("cutoff ") + to_text(options.cutoff) + ": must lie in (0, 1)");
    for (std::size_t i = 0; i < nodes_.size() && interpolates_; ++i) interpolates_ = is_alone_at(i);
  }

  /// Rest positions in m.
  [[nodiscard]] const std::vector<Vec3<double>>& nodes() const { return nodes_; }
  /// Linear fields are reproduced.
  [[nodiscard]] int consistency() const { return 1; }
  /// True if every node is a corner of the convex hull of the nodes within its support.
  [[nodiscard]] bool interpolates() const { return interpolates_; }
  /// In m.
  [[nodiscard]] double support() const {
    return options_.spacing * std::sqrt(-std::log(options_.cutoff) / options_.gamma);
  }

  /// The shape functions at x (m). On the surface of the hull C is singular: gradients are then those about
  /// 1e-8 of the spacing further inside. Outside by 1e-10 of the spacing counts as on it.
  /// @throws std::invalid_argument if x is not finite, no node is within the support radius, x is not in the
  ///   convex hull of those that are, or these lie in a plane while the others do not (no gradient)
  [[nodiscard]] ShapeValues at(const Vec3<double>& x) const {
    const Solution s = solve(x);
    if (!s.inside.spread())
      invalid(where(x) + ": the " + std::to_string(s.nodes.size()) + " nodes within the support radius " +
              to_text(support()) + " m lie in a plane, across which there is no gradient");
    ShapeValues result{s.nodes, s.weights.values(), {}, {}, {}};
    for (std::size_t k = 0; k < s.nodes.size(); ++k)
      result.gradients.push_back(hull_.direction(s.inside.over_covariance(s.offsets[k] - s.inside.mean())) *
                                 (-s.inside.values()[k] / options_.spacing));
    return result;
  }

 private:
  struct Solution {
    std::vector<std::int32_t> nodes;
    std::vector<Vec3<double>> offsets;  // (x - x_i) / h, in the hull's coordinates
    ExponentialWeights weights;
    ExponentialWeights inside;  // the same, or the last on the way there that gradients can be had from
  };

  [[nodiscard]] static std::string where(const Vec3<double>& x) {
    return std::string("maximum entropy at ") + detail::point_text(x) + " m";
  }

  // Newton's method with line search on log Z, which is convex. For x on the surface of the hull its minimum
  // is at infinity; the mean then goes to 0 by a factor of about e a step.
  [[nodiscard]] Solution solve(const Vec3<double>& x) const {
    Solution s = start(x);
    ExponentialWeights now = s.weights;
    const auto miss = [](const ExponentialWeights& weights) { return weights.mean().norm(); };
    for (int iteration = 0; iteration < 100 && miss(s.weights) > 1e-13; ++iteration) {
      // Weights that meet the constraints have at most the relative entropy log(1 / prior) of the farthest
      // node, and -log Z never exceeds it (duality): beyond that there are none, x is outside.
      if (now.log_sum() < std::log(options_.cutoff) - 1) break;
      now = improved(now, s.offsets);
      if (now.spread()) s.inside = now;
      if (miss(now) < miss(s.weights)) s.weights = now;
    }
    if (miss(s.weights) <= 1e-10) return s;
    invalid(where(x) + ": the point is not in the convex hull of the " + std::to_string(s.nodes.size()) +
            " nodes within the support radius " + to_text(support()) + " m");
  }

  // All weights as the prior has them.
  [[nodiscard]] Solution start(const Vec3<double>& x) const {
    if (!x.allFinite()) invalid(where(x) + ": the point is not finite");
    const Vec3<double> y = hull_.local(x);
    const std::vector<std::int32_t> nodes = search_.within(y, support());
    if (nodes.empty())
      invalid(where(x) + ": no node is within the support radius " + to_text(support()) + " m");
    std::vector<Vec3<double>> offsets;
    std::vector<double> exponents;
    for (const std::int32_t i : nodes) {
      offsets.push_back((y - search_.points()[static_cast<std::size_t>(i)]) / options_.spacing);
      exponents.push_back(-options_.gamma * offsets.back().squaredNorm());
    }
    const ExponentialWeights prior(offsets, exponents, hull_.dimension());
    return {nodes, offsets, prior, prior};
  }

  // Steps are added to the exponents, not to lambda: next to a face of the hull that is not quite flat lambda
  // is so large that the rounding of lambda . y would keep the mean from 0.
  [[nodiscard]] ExponentialWeights improved(const ExponentialWeights& now,
                                            const std::vector<Vec3<double>>& offsets) const {
    const Vec3<double> step = -now.over_covariance(now.mean());
    const double slope = step.dot(now.mean()), rounding = 1e-14 * (1 + std::abs(now.log_sum()));
    for (double t = 1;; t /= 2) {
      std::vector<double> exponents = now.exponents();
      for (std::size_t k = 0; k < exponents.size(); ++k) exponents[k] += t * step.dot(offsets[k]);
      const ExponentialWeights next(offsets, exponents, hull_.dimension());
      if (t < 1e-12 || next.log_sum() <= now.log_sum() + 1e-4 * t * slope + rounding) return next;
    }
  }

  [[nodiscard]] bool is_alone_at(std::size_t i) const {
    const Solution s = solve(nodes_[i]);
    const auto own = std::lower_bound(s.nodes.begin(), s.nodes.end(), static_cast<std::int32_t>(i));
    return s.weights.values()[static_cast<std::size_t>(own - s.nodes.begin())] >= 1 - 1e-9;
  }

  std::vector<Vec3<double>> nodes_;
  AffineHull hull_;
  Search search_;
  MaximumEntropyOptions options_;
  bool interpolates_ = true;
};

}  // namespace softsim
