// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "refusal.hpp"
#include "softsim/core/state.hpp"
#include "softsim/mesh/generators.hpp"
#include "softsim/mesh/tetrahedral_mesh.hpp"

/// Bodies, states and measures that the tests of everything above the mesh share.
namespace bodies {

using Vec = softsim::Vec3<double>;
using Matrix = softsim::Mat3<double>;

/// Numbers from a fixed seed.
class Random {
 public:
  explicit Random(std::uint64_t seed) : bits_(seed) {}
  /// A number in [-1, 1).
  double number() { return static_cast<double>(bits_() >> 11) * 0x1p-52 - 1; }
  /// Components in [-1, 1).
  Vec vec() {
    const double x = number(), y = number(), z = number();
    return {x, y, z};
  }
  /// Entries in [-1, 1).
  Matrix matrix() {
    Matrix A;
    for (int i = 0; i < 9; ++i) A(i) = number();
    return A;
  }
  /// A proper rotation.
  Matrix rotation() {
    const Vec v = vec();
    return Eigen::Quaterniond(number(), v[0], v[1], v[2]).normalized().toRotationMatrix();
  }

 private:
  std::mt19937_64 bits_;
};

/// True for nodes that lie on the mesh's surface.
inline std::vector<bool> on_surface(const softsim::TetrahedralMesh& mesh) {
  std::vector<bool> outer(mesh.points().size(), false);
  for (const softsim::Triangle& f : softsim::boundary_triangles(mesh))
    for (const std::int32_t i : f) outer[static_cast<std::size_t>(i)] = true;
  return outer;
}

/// A unit cube of n^3 cells whose inner nodes are moved by up to 0.2 of a cell along each axis.
inline softsim::TetrahedralMesh distorted_cube(int n, std::uint64_t seed) {
  const softsim::TetrahedralMesh regular = softsim::box_mesh({n, n, n}, {1, 1, 1});
  const std::vector<bool> outer = on_surface(regular);
  std::vector<Vec> points = regular.points();
  Random random(seed);
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!outer[i]) points[i] += 0.2 / n * random.vec();
  return {std::move(points), regular.tetrahedra()};
}

/// The first `count` tetrahedra of a mesh.
inline softsim::TetrahedralMesh first_tetrahedra(const softsim::TetrahedralMesh& mesh, std::size_t count) {
  return {mesh.points(),
          {mesh.tetrahedra().begin(), mesh.tetrahedra().begin() + static_cast<std::ptrdiff_t>(count)}};
}

/// A flat vector with entries in [-scale, scale).
template <class T = double>
softsim::Vector<T> random_vector(std::size_t points, double scale, std::uint64_t seed) {
  softsim::State<T> q(points);
  Random random(seed);
  for (std::size_t i = 0; i < points; ++i)
    q.point(static_cast<std::ptrdiff_t>(i)) = (scale * random.vec()).template cast<T>();
  return q.displacement;
}

/// A state with displacements in [-scale, scale) along each axis.
template <class T = double>
softsim::State<T> random_state(std::size_t points, double scale, std::uint64_t seed) {
  softsim::State<T> q;
  q.displacement = random_vector<T>(points, scale, seed);
  return q;
}

/// The state x = A X + b.
inline softsim::State<double> affine_state(const softsim::TetrahedralMesh& mesh, const Matrix& A,
                                           const Vec& b) {
  softsim::State<double> q(mesh.points().size());
  for (std::size_t i = 0; i < mesh.points().size(); ++i)
    q.point(static_cast<std::ptrdiff_t>(i)) = A * mesh.points()[i] + b - mesh.points()[i];
  return q;
}

/// Position of node i in m.
inline Vec position(const softsim::TetrahedralMesh& mesh, const softsim::State<double>& q, std::size_t i) {
  return mesh.points()[i] + q.point(static_cast<std::ptrdiff_t>(i));
}

/// dE/dq of a term or a system as a new vector.
template <class S, class T>
softsim::Vector<T> gradient(const S& term, const softsim::State<T>& q) {
  softsim::Vector<T> y = softsim::Vector<T>::Zero(q.size());
  term.add_gradient(q, y);
  return y;
}
/// The Hessian product of a term or a system as a new vector.
template <class S, class T>
softsim::Vector<T> hessian_product(const S& term, const softsim::State<T>& q, const softsim::Vector<T>& d) {
  softsim::Vector<T> y = softsim::Vector<T>::Zero(q.size());
  term.add_hessian_product(q, d, y);
  return y;
}

/// |a - b| / |b|.
template <class A, class B>
double relative_error(const A& a, const B& b) {
  return (a.template cast<double>() - b.template cast<double>()).norm() / b.template cast<double>().norm();
}

using refusals::refusal;

}  // namespace bodies
