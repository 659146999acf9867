// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <stdexcept>
#include <utility>
#include <vector>

#include "any_system.hpp"
#include "recovery.hpp"
#include "scene.hpp"
#include "softsim/mesh/selection.hpp"

namespace atlas {

/// Smallest dihedral angle of all tetrahedra, degrees.
inline double smallest_dihedral(const std::vector<Vec>& points,
                                const std::vector<softsim::Tetrahedron>& tetrahedra) {
  double smallest = 180;
  for (const softsim::Tetrahedron& v : tetrahedra) {
    std::array<Vec, 4> x;
    for (std::size_t i = 0; i < 4; ++i) x[i] = points[static_cast<std::size_t>(v[i])];
    for (std::size_t a = 0; a < 4; ++a)
      for (std::size_t b = a + 1; b < 4; ++b) {
        std::array<std::size_t, 2> other{};
        for (std::size_t c = 0, k = 0; c < 4; ++c)
          if (c != a && c != b) other[k++] = c;
        const Vec edge = (x[b] - x[a]).normalized();
        const auto across = [&](std::size_t c) {
          const Vec d = x[c] - x[a];
          return Vec(d - edge.dot(d) * edge);
        };
        const Vec p = across(other[0]), q = across(other[1]);
        smallest = std::min(smallest, std::atan2(p.cross(q).norm(), p.dot(q)) * 180 / std::numbers::pi);
      }
  }
  return smallest;
}

/// A cube of n^3 cells whose node in the middle has been moved towards the opposite side of one of its
/// tetrahedra, until the smallest dihedral angle of the mesh is `degrees`.
inline softsim::TetrahedralMesh cube_with_sliver(int n, double degrees) {
  const softsim::TetrahedralMesh good = cube(n);
  std::vector<Vec> points = good.points();
  std::size_t middle = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
    if ((points[i] - Vec::Constant(0.5)).norm() < (points[middle] - Vec::Constant(0.5)).norm()) middle = i;
  Vec goal = Vec::Zero();
  for (const softsim::Tetrahedron& v : good.tetrahedra()) {
    if (std::find(v.begin(), v.end(), static_cast<std::int32_t>(middle)) == v.end()) continue;
    for (const std::int32_t i : v)
      if (static_cast<std::size_t>(i) != middle) goal += points[static_cast<std::size_t>(i)] / 3;
    break;
  }
  const Vec from = points[middle];
  double low = 0, high = 1;  // of the way
  for (int k = 0; k < 200; ++k) {
    const double t = (low + high) / 2;
    points[middle] = from + t * (goal - from);
    (smallest_dihedral(points, good.tetrahedra()) > degrees ? low : high) = t;
  }
  points[middle] = from + low * (goal - from);
  return {std::move(points), good.tetrahedra()};
}

/// Gradient of the elastic energy of linear tetrahedra in long double, from the same rest and displacements:
/// what errors of forces are measured against.
template <class Law>
std::vector<softsim::Vec3<long double>> exact_gradient(const softsim::TetrahedralMesh& mesh, const Law& law,
                                                       const State<double>& q) {
  using Real = long double;
  using V = softsim::Vec3<Real>;
  std::vector<V> g(mesh.points().size(), V::Zero());
  for (const softsim::Tetrahedron& v : mesh.tetrahedra()) {
    softsim::Mat3<Real> D, H;
    const auto at = [&](std::size_t i) { return mesh.points()[static_cast<std::size_t>(v[i])].cast<Real>(); };
    for (std::size_t i = 0; i < 3; ++i) {
      D.col(static_cast<int>(i)) = at(i + 1) - at(0);
      H.col(static_cast<int>(i)) = q.point(v[i + 1]).cast<Real>() - q.point(v[0]).cast<Real>();
    }
    const softsim::Mat3<Real> inverse = D.inverse();
    const softsim::Mat3<Real> F = softsim::Mat3<Real>::Identity() + H * inverse;
    const softsim::Mat3<Real> f = D.determinant() / 6 * law.first_piola(F) * inverse.transpose();
    for (std::size_t i = 0; i < 3; ++i) {
      g[static_cast<std::size_t>(v[i + 1])] += f.col(static_cast<int>(i));
      g[static_cast<std::size_t>(v[0])] -= f.col(static_cast<int>(i));
    }
  }
  return g;
}

/// Largest error of a nodal force over the largest nodal force.
template <class Law>
double force_error(const softsim::TetrahedralMesh& mesh, const Law& law, const AnyTerm& term,
                   const State<double>& q) {
  const auto exact = exact_gradient(mesh, law, q);
  Vector<double> g = Vector<double>::Zero(q.size());
  term.add_gradient(q, g);
  double error = 0, scale = 0;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    const softsim::Vec3<long double> f =
        softsim::block(g, static_cast<std::ptrdiff_t>(i)).cast<long double>();
    error = std::max(error, static_cast<double>((f - exact[i]).norm()));
    scale = std::max(scale, static_cast<double>(exact[i].norm()));
  }
  return error / scale;
}

/// A static solve of a cube that is held at the bottom and pushed down and sideways at the top.
struct LoadedCube {
  softsim::StepReport report;
  Vec top = Vec::Zero();  ///< mean displacement of the upper side, m
  int inverted = 0;
  State<double> q;
};
inline LoadedCube load_cube(const Body& body, const Elasticity& elastic, const Vec& load,
                            double tolerance = 1e-8) {
  const std::vector<std::int32_t> upper = softsim::nodes_near(body, softsim::Side::zmax, 1e-9);
  softsim::DeadLoad<double> dead(body.points().size());
  for (const std::int32_t i : upper) dead.add(i, load / static_cast<double>(upper.size()));
  AnySystem system(body, elastic[0], elastic[1], dead);
  system.prescribed.fix(softsim::nodes_near(body, softsim::Side::zmin, 1e-9));
  LoadedCube result;
  result.q = body.rest();
  result.report = Solver({.tolerance = tolerance, .verify_minimum = true}).solve(system, result.q);
  for (const std::int32_t i : upper) result.top += result.q.point(i) / static_cast<double>(upper.size());
  result.inverted = body.inverted(result.q);
  return result;
}

}  // namespace atlas
