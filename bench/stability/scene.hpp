// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "any_system.hpp"
#include "softsim/mesh/generators.hpp"
#include "softsim/mesh/hexahedral_mesh.hpp"
#include "softsim/mesh/quadratic_tetrahedral_mesh.hpp"
#include "softsim/mesh/tetrahedral_mesh.hpp"
#include "softsim/system/element_fields.hpp"

namespace atlas {

using Vec = softsim::Vec3<double>;
using Mesh =
    std::variant<softsim::TetrahedralMesh, softsim::QuadraticTetrahedralMesh, softsim::HexahedralMesh>;

/// Numbers in [0, 1) from a fixed seed.
class Random {
 public:
  explicit Random(std::uint64_t seed) : bits_(seed) {}
  double number() { return static_cast<double>(bits_() >> 11) * 0x1p-53; }
  Vec vec() {
    const double x = number(), y = number(), z = number();
    return {x, y, z};
  }

 private:
  std::mt19937_64 bits_;
};

/// A mesh and three of its nodes that are far apart.
struct Body {
  std::string name;
  Mesh mesh;
  std::array<std::int32_t, 3> corners{};
  Vec low, high;  ///< bounding box, m

  Body(std::string n, Mesh m) : name(std::move(n)), mesh(std::move(m)) {
    low = high = points().front();
    for (const Vec& X : points()) {
      low = low.cwiseMin(X);
      high = high.cwiseMax(X);
    }
    corners[0] = farthest([&](const Vec& X) { return -(X - low).norm(); });
    // of equal distances the first; corners of a box come out as its axes
    corners[1] = farthest([&](const Vec& X) { return (X - point(0)).dot(Vec::UnitX()); });
    const Vec along = (point(1) - point(0)).normalized();
    corners[2] = farthest([&](const Vec& X) {
      const Vec off = X - point(0) - along.dot(X - point(0)) * along;
      return off.norm() - 2 * std::abs(X[2] - point(0)[2]);
    });
  }

  [[nodiscard]] const std::vector<Vec>& points() const {
    return std::visit([](const auto& m) -> const std::vector<Vec>& { return m.points(); }, mesh);
  }
  /// Rest position of one of the three corners.
  [[nodiscard]] const Vec& point(std::size_t corner) const {
    return points()[static_cast<std::size_t>(corners[corner])];
  }
  /// Largest extent, m.
  [[nodiscard]] double size() const { return (high - low).maxCoeff(); }
  /// The state at rest.
  [[nodiscard]] State<double> rest() const { return State<double>(points().size()); }

  /// det F at every integration point.
  [[nodiscard]] std::vector<double> volume_ratios(const State<double>& q) const {
    std::vector<double> result;
    std::visit(
        [&](const auto& m) {
          for (std::size_t e = 0; e < m.elements().size(); ++e)
            softsim::detail::for_each_integration_point(m, e, [&]<class K>(K, const auto& data) {
              softsim::Local<double, K::points> u;
              for (std::size_t i = 0; i < u.points.size(); ++i) u.points[i] = q.point(m.elements()[e][i]);
              result.push_back(softsim::determinant(K::deformation_gradient(data, u)));
            });
        },
        mesh);
    return result;
  }
  /// How many integration points are inverted or flat.
  [[nodiscard]] int inverted(const State<double>& q) const {
    const std::vector<double> j = volume_ratios(q);
    return static_cast<int>(std::count_if(j.begin(), j.end(), [](double x) { return !(x > 0); }));
  }

 private:
  template <class Measure>
  std::int32_t farthest(Measure measure) const {
    std::size_t best = 0;
    for (std::size_t i = 1; i < points().size(); ++i)
      if (measure(points()[i]) > measure(points()[best]) + 1e-9 * (high - low).norm()) best = i;
    return static_cast<std::int32_t>(best);
  }
};

/// A unit cube of n^3 cells of six tetrahedra; its inner nodes moved by up to `by` of a cell.
inline softsim::TetrahedralMesh cube(int n, double by = 0, std::uint64_t seed = 1) {
  const softsim::TetrahedralMesh regular = softsim::box_mesh({n, n, n}, {1, 1, 1});
  std::vector<Vec> points = regular.points();
  Random random(seed);
  for (Vec& X : points)
    if (X.minCoeff() > 1e-9 && X.maxCoeff() < 1 - 1e-9) X += by / n * (2 * random.vec() - Vec::Ones());
  return {std::move(points), regular.tetrahedra()};
}

/// How a body starts: all but its held nodes are moved there.
enum class Start { random, plane, line, point, scaled, reflected, inflated };
inline constexpr std::array<Start, 7> all_starts{
    Start::random, Start::plane, Start::line, Start::point, Start::scaled, Start::reflected, Start::inflated};
inline std::string_view to_string(Start start) {
  constexpr std::array<std::string_view, 7> names{"random", "plane",     "line",    "point",
                                                  "scaled", "reflected", "inflated"};
  return names[static_cast<std::size_t>(start)];
}

/// What holds a body: its three corners (nodes), or six components of them and no more, which leaves a start
/// in a line or a point, too, without forces.
enum class Support { nodes, components };
inline std::string_view to_string(Support support) {
  return support == Support::nodes ? "nodes" : "components";
}

/// The state a body starts from: uniformly random positions in its bounding box; or its rest shape in the
/// frame of its corners times one factor an axis (plane: through the corners, line: through the first two).
/// Every free component is moved by up to `noise` of the body's size on top.
inline State<double> start_state(const Body& body, const softsim::Prescribed<double>& prescribed, Start start,
                                 std::uint64_t seed, double noise = 0) {
  Vec factors = Vec::Ones();
  switch (start) {
    case Start::plane:
      factors = {1, 1, 0};
      break;
    case Start::line:
      factors = {1, 0, 0};
      break;
    case Start::point:
      factors = {0, 0, 0};
      break;
    case Start::scaled:
      factors.setConstant(0.01);
      break;
    case Start::reflected:
      factors = {1, 1, -1};
      break;
    case Start::inflated:
      factors.setConstant(2);
      break;
    case Start::random:
      break;
  }
  softsim::Mat3<double> axes;
  axes.col(0) = (body.point(1) - body.point(0)).normalized();
  axes.col(2) = axes.col(0).cross(body.point(2) - body.point(0)).normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  const softsim::Mat3<double> A = axes * factors.asDiagonal() * axes.transpose();
  Random random(1000 * seed + 7);
  State<double> q = body.rest();
  for (std::size_t i = 0; i < body.points().size(); ++i) {
    const Vec& X = body.points()[i];
    Vec x = body.point(0) + A * (X - body.point(0));
    if (start == Start::random) x = body.low + (body.high - body.low).cwiseProduct(random.vec());
    x += noise * body.size() * (2 * random.vec() - Vec::Ones());
    q.point(static_cast<std::ptrdiff_t>(i)) = x - X;
  }
  prescribed.mask(q.displacement);
  return q;
}

/// Holds a body.
inline void hold(AnySystem& system, const Body& body, Support support) {
  if (support == Support::nodes) {
    system.prescribed.fix({body.corners.begin(), body.corners.end()});
  } else {
    system.prescribed.fix({body.corners[0]});
    for (const int axis : {1, 2}) system.prescribed.set(body.corners[1], axis, 0);
    system.prescribed.set(body.corners[2], 2, 0);
  }
}

/// Largest distance of a node to where it is at rest; with six components held, to the closest of the four
/// rest positions that they leave (half a turn around the axes of the corners).
inline double distance_to_rest(const Body& body, const State<double>& q, Support support) {
  double best = std::numeric_limits<double>::infinity();
  for (const Vec& turn : {Vec(1, 1, 1), Vec(1, -1, -1), Vec(-1, 1, -1), Vec(-1, -1, 1)}) {
    double largest = 0;
    for (std::size_t i = 0; i < body.points().size(); ++i) {
      const Vec& X = body.points()[i];
      const Vec turned = body.point(0) + turn.cwiseProduct(X - body.point(0));
      largest = std::max(largest, (X + q.point(static_cast<std::ptrdiff_t>(i)) - turned).norm());
    }
    best = std::min(best, largest);
    if (support == Support::nodes) break;
  }
  return best;
}

}  // namespace atlas
