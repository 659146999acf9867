// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "softsim/core/error.hpp"
#include "softsim/core/tensor.hpp"
#include "softsim/kinematics/node_shapes.hpp"
#include "softsim/kinematics/point_text.hpp"
#include "softsim/kinematics/reference_domain.hpp"
#include "softsim/mesh/box_grid.hpp"
#include "softsim/mesh/isoparametric_mesh.hpp"
#include "softsim/mesh/selection.hpp"
#include "softsim/mesh/shape_functions.hpp"
#include "softsim/mesh/tetrahedral_mesh.hpp"

namespace softsim {

/// The shape functions with which a mesh interpolates, as a type: see `ReferenceDomain`.
template <class Mesh>
struct ShapeOfMesh {
  using type = typename Mesh::Shape;
};
template <>
struct ShapeOfMesh<TetrahedralMesh> {
  using type = LinearTetrahedronShape;
};

/// Shape functions of the nodes of a mesh (Bosman 2015, Sec. 4.1): linear tetrahedra, trilinear hexahedra or
/// quadratic tetrahedra, at any point of it. x = sum X_i N_i(xi) is solved for xi by Newton's method, which
/// also serves bricks at any angle, where the linear system of Bosman's Eq. 4.4 is singular.
/// Values are continuous, gradients jump between elements.
template <class Mesh>
class MeshShapes {
 public:
  using Shape = typename ShapeOfMesh<Mesh>::type;
  using Domain = ReferenceDomain<Shape>;

  /// A point of an element, by its reference coordinates.
  struct Place {
    std::size_t element;
    std::array<double, 3> xi;
  };

  explicit MeshShapes(Mesh mesh) : mesh_(std::move(mesh)), grid_(boxes()) {
    for (std::size_t e = 0; e < mesh_.elements().size(); ++e) {
      nearly_affine_.push_back(is_nearly_affine(e));
      degree_ = std::min(degree_, Domain::degree(mesh_.element_points(e)));
    }
  }

  /// The mesh, a copy of the one given.
  [[nodiscard]] const Mesh& mesh() const { return mesh_; }
  /// Rest positions in m.
  [[nodiscard]] const std::vector<Vec3<double>>& nodes() const { return mesh_.points(); }
  /// 1; 2 for quadratic tetrahedra if all edges are straight with their nodes in the middle. One curved edge
  /// makes it 1: polynomials in xi are then not polynomials in x.
  [[nodiscard]] int consistency() const { return degree_; }
  /// They have the Kronecker property.
  [[nodiscard]] bool interpolates() const { return true; }
  /// Infinite: it depends on the elements.
  [[nodiscard]] double support() const { return std::numeric_limits<double>::infinity(); }

  /// The shape functions at x (m).
  /// @throws std::invalid_argument where `place(x)` does
  [[nodiscard]] ShapeValues at(const Vec3<double>& x) const {
    const Place p = place(x);
    return at(p.element, p.xi);
  }

  /// The shape functions at the reference point xi of an element (its integration points need no search).
  /// @throws std::invalid_argument if there is no such element, or its Jacobian determinant is not positive
  ///   at xi
  [[nodiscard]] ShapeValues at(std::size_t element, const std::array<double, 3>& xi) const {
    if (element >= mesh_.elements().size())
      invalid(std::string(Mesh::name.singular) + " " + std::to_string(element) + ": the mesh has " +
              std::to_string(mesh_.elements().size()));
    const Mat3<double> J = jacobian<Shape>(mesh_.element_points(element), xi);
    if (!(determinant(J) > 0))
      invalid(std::string(Mesh::name.singular) + " " + std::to_string(element) + ": Jacobian determinant " +
              to_text(determinant(J)) + " m^3 at (xi, eta, zeta) = " +
              detail::point_text(Vec3<double>(xi[0], xi[1], xi[2])) + " is not positive");
    const auto N = Shape::values(xi);
    const Eigen::Matrix<double, Shape::nodes, 3> g = Shape::gradients(xi) * J.inverse();
    std::array<std::pair<std::int32_t, int>, static_cast<std::size_t>(Shape::nodes)> order;
    for (std::size_t i = 0; i < order.size(); ++i)
      order[i] = {mesh_.elements()[element][i], static_cast<int>(i)};
    std::sort(order.begin(), order.end());
    ShapeValues result;
    for (const auto& [node, i] : order) {
      result.nodes.push_back(node);
      result.values.push_back(N[i]);
      result.gradients.push_back(g.row(i).transpose());
    }
    return result;
  }

  /// The element that holds x (m), of several that touch there the one of the lowest number, and where in it.
  /// Points that are outside by less than 1e-9 of the element's size (the diagonal of its box) count as
  /// inside.
  /// @throws std::invalid_argument if no element holds x
  [[nodiscard]] Place place(const Vec3<double>& x) const {
    for (const std::size_t e : grid_.holding(x))
      if (const auto xi = find_in(e, x)) return {e, *xi};
    invalid(std::string("point ") + detail::point_text(x) + " m: is in none of the " +
            std::to_string(mesh_.elements().size()) + " " + Mesh::name.plural + " of the mesh");
  }

 private:
  static constexpr double tolerance = 1e-9;  // in sizes of the element

  [[nodiscard]] BoundingBox box(std::size_t e) const {
    const auto P = Domain::around(mesh_.element_points(e));
    BoundingBox result{P[0], P[0]};
    for (const Vec3<double>& p : P) {
      result.lower = result.lower.cwiseMin(p);
      result.upper = result.upper.cwiseMax(p);
    }
    return result;
  }
  [[nodiscard]] std::vector<BoundingBox> boxes() const {
    std::vector<BoundingBox> result;
    for (std::size_t e = 0; e < mesh_.elements().size(); ++e) {
      BoundingBox b = box(e);
      const Vec3<double> margin = Vec3<double>::Constant(2 * tolerance * (b.upper - b.lower).norm());
      result.push_back({b.lower - margin, b.upper + margin});
    }
    return result;
  }

  // Whether no Jacobian differs from that in the centre by more than 1/4. Then |J^-1 J' - I| < 2/3 for any
  // two, and Newton's method comes nearer to a point of the element with every step, wherever it starts.
  [[nodiscard]] bool is_nearly_affine(std::size_t e) const {
    const auto X = mesh_.element_points(e);
    const Mat3<double> inverse = jacobian<Shape>(X, Domain::centre).inverse();
    return std::all_of(Domain::corners.begin(), Domain::corners.end(), [&](const auto& xi) {
      return (inverse * jacobian<Shape>(X, xi) - Mat3<double>::Identity()).norm() <= 0.25;
    });
  }

  // Else starts next to each corner are tried too.
  [[nodiscard]] std::optional<std::array<double, 3>> find_in(std::size_t e, const Vec3<double>& x) const {
    auto xi = find_from(Domain::centre, e, x);
    if (xi || nearly_affine_[e]) return xi;
    for (const auto& corner : Domain::corners) {
      std::array<double, 3> start;
      for (std::size_t a = 0; a < 3; ++a) start[a] = 0.7 * corner[a] + 0.3 * Domain::centre[a];
      if ((xi = find_from(start, e, x))) return xi;
    }
    return std::nullopt;
  }

  // Newton's method, kept within the element, outside of which the Jacobian may be singular.
  [[nodiscard]] std::optional<std::array<double, 3>> find_from(const std::array<double, 3>& start,
                                                               std::size_t e, const Vec3<double>& x) const {
    auto X = mesh_.element_points(e);
    const Vec3<double> origin = X[0], diagonal = box(e).upper - box(e).lower;
    for (Vec3<double>& p : X) p -= origin;
    const double size = diagonal.norm();
    std::array<double, 3> xi = start;
    Mat3<double> inverse = Mat3<double>::Zero();
    Vec3<double> residual = Vec3<double>::Zero();
    double step = 1;
    for (int iteration = 0; iteration < 50 && step > 1e-13; ++iteration) {
      inverse = jacobian<Shape>(X, xi).inverse();
      const auto N = Shape::values(xi);
      residual = origin - x;
      for (int i = 0; i < Shape::nodes; ++i) residual += N[i] * X[static_cast<std::size_t>(i)];
      const Vec3<double> before(xi[0], xi[1], xi[2]), after = confined(before - inverse * residual);
      xi = {after[0], after[1], after[2]};
      step = (after - before).norm();
    }
    // Rounding may keep the steps in a sliver from getting small: it is the residual that decides.
    const bool solved = residual.norm() <= 1e-12 * size;
    if (solved && distance_outside({xi[0], xi[1], xi[2]}, inverse) <= tolerance * size) return xi;
    return std::nullopt;
  }

  // Onto the sides that are overstepped; a little beyond them is left for points next to the surface.
  static Vec3<double> confined(Vec3<double> xi) {
    constexpr double margin = 1e-3;
    for (int sweep = 0; sweep < 3; ++sweep)
      for (const ReferenceSide& side : Domain::sides)
        if (const double h = side.height(xi) + margin; h < 0)
          xi -= h / side.direction().squaredNorm() * side.direction();
    return xi;
  }

  // How far x(xi) is beyond the sides, in m; `inverse` is dxi/dx.
  static double distance_outside(const Vec3<double>& xi, const Mat3<double>& inverse) {
    double distance = 0;
    for (const ReferenceSide& side : Domain::sides)
      distance = std::max(distance, -side.height(xi) / (inverse.transpose() * side.direction()).norm());
    return distance;
  }

  Mesh mesh_;
  BoxGrid grid_;
  std::vector<bool> nearly_affine_;
  int degree_ = std::numeric_limits<int>::max();
};

}  // namespace softsim
