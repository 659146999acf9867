// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "softsim/core/error.hpp"
#include "softsim/core/tensor.hpp"
#include "softsim/kinematics/neighbourhood.hpp"
#include "softsim/kinematics/node_shapes.hpp"
#include "softsim/kinematics/radial_weights.hpp"
#include "softsim/mesh/point_grid.hpp"

namespace softsim {

/// Options of `Shepard`.
struct ShepardOptions {
  double power = 2;                                         ///< p > 0
  double radius = std::numeric_limits<double>::infinity();  ///< of the support, m
  std::size_t nearest = 0;                                  ///< only so many nearest nodes; 0: no limit
};

/// Shepard's inverse distance weighting (Bosman 2015, Eqs. 4.8-4.9): phi_i = w_i / sum w, w = 1/d^p, or
/// ((R - d)/(R d))^p with a support radius R (Franke & Little). It takes nodes in any arrangement,
/// interpolates (though Table 4.1 says not), and reproduces constants only; for p > 1 the gradients vanish at
/// all nodes (flat spots). With `nearest`, functions jump where the neighbours change; gradients are those
/// with the neighbours fixed.
template <NeighbourSearch Search = PointGrid>
class Shepard {
 public:
  /// @param nodes rest positions in m, no two at the same place
  /// @throws std::invalid_argument if there are no nodes, a coordinate is not finite, two nodes coincide, the
  ///   power or the radius is not positive
  explicit Shepard(std::vector<Vec3<double>> nodes, const ShepardOptions& options = {})
      : neighbours_(std::move(nodes), options.radius, options.nearest),
        weight_{options.power, options.radius} {
    weight_.check(0);
    neighbours_.require_distinct_nodes();
  }

  /// Rest positions in m.
  [[nodiscard]] const std::vector<Vec3<double>>& nodes() const { return neighbours_.nodes(); }
  /// Constants are reproduced.
  /// Constants are reproduced.
  [[nodiscard]] int consistency() const { return 0; }
  /// They have the Kronecker property.
  /// They have the Kronecker property.
  [[nodiscard]] bool interpolates() const { return true; }
  /// The radius in m.
  [[nodiscard]] double support() const { return weight_.radius; }

  /// The shape functions at x (m); at a node only its own, with value 1 and gradient 0.
  /// @throws std::invalid_argument if x is not finite, no node is within the radius, or x is a node and
  ///   p <= 1 (there is a kink)
  [[nodiscard]] ShapeValues at(const Vec3<double>& x) const {
    const std::vector<Neighbour> near = neighbours_.at(x);
    const std::size_t top = detail::nearest_of(near);
    const double shortest = near[top].distance;
    if (shortest == 0) return at_node(near[top].node);
    std::vector<RadialWeight> weights;
    for (const Neighbour& n : near)
      weights.push_back({weight_.ratio(n.distance, shortest), weight_.log_gradient(n)});
    return detail::partition_of_unity(near, weights, top);
  }

 private:
  [[nodiscard]] ShapeValues at_node(std::int32_t node) const {
    if (weight_.power <= 1)
      invalid(std::string("power ") + to_text(weight_.power) + ": no gradient at node " +
              std::to_string(node) + ", where only a power above 1 has one");
    return {{node}, {1}, {Vec3<double>::Zero()}, {}, {}};
  }

  Neighbourhood<Search> neighbours_;
  InverseDistance weight_;
};

}  // namespace softsim
