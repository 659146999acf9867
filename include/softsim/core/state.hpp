// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "softsim/core/tensor.hpp"

namespace softsim {

/// Scalars per block of a flat vector: three components and one that is always zero. A block is then read,
/// written and transposed into lanes as one aligned vector; the zero leaves dot products and norms unchanged.
inline constexpr int block_stride = 4;

/// Components of block i of a flat vector, as a writable 3-vector.
template <class T>
[[nodiscard]] auto block(Vector<T>& v, std::ptrdiff_t i) {
  return v.template segment<3>(block_stride * i);
}
/// Components of block i of a flat vector.
template <class T>
[[nodiscard]] auto block(const Vector<T>& v, std::ptrdiff_t i) {
  return v.template segment<3>(block_stride * i);
}

namespace detail {
template <class A, class B>
[[nodiscard]] double plain_dot(const A& a, const B& b) {
  if constexpr (sizeof(typename A::Scalar) == sizeof(double)) {
    return a.dot(b);
  } else {
    return a.template cast<double>().dot(b.template cast<double>());
  }
}
}  // namespace detail

/// Dot product, accumulated in double whatever the scalar. Long vectors are summed in pieces whose number
/// depends on their length alone: with OpenMP in parallel, and with the same bits for any number of threads.
template <class T>
[[nodiscard]] double dot(const Vector<T>& a, const Vector<T>& b) {
  constexpr std::ptrdiff_t pieces = 32, shortest = 1024;
  const std::ptrdiff_t length = (a.size() / pieces + 16) / 16 * 16;  // pieces * length > size
  if (length < shortest) return detail::plain_dot(a, b);
  std::array<double, pieces> part{};
#ifdef _OPENMP
#pragma omp parallel for schedule(static)
#endif
  for (std::ptrdiff_t p = 0; p < pieces; ++p) {
    const std::ptrdiff_t begin = std::min(p * length, a.size()), count = std::min(length, a.size() - begin);
    part[static_cast<std::size_t>(p)] = detail::plain_dot(a.segment(begin, count), b.segment(begin, count));
  }
  double sum = 0;
  for (const double x : part) sum += x;
  return sum;
}

/// Euclidean norm, accumulated in double.
template <class T>
[[nodiscard]] double norm(const Vector<T>& a) {
  return std::sqrt(dot(a, a));
}

/// Values of all unknowns: one block per point, its displacement from rest in m. (Displacements rather than
/// positions keep single precision accurate far from the origin.) Everything above the potentials moves a
/// state only through `retract` and `difference`, so that unknowns on a curved manifold fit in the same
/// place.
template <class T>
struct State {
  Vector<T> displacement;

  State() = default;
  /// `points` points at rest.
  explicit State(std::size_t points)
      : displacement(Vector<T>::Zero(block_stride * static_cast<std::ptrdiff_t>(points))) {}

  /// Number of scalars in a flat vector of this state.
  [[nodiscard]] std::ptrdiff_t size() const { return displacement.size(); }
  /// Displacement of point i in m, writable.
  [[nodiscard]] auto point(std::ptrdiff_t i) { return block(displacement, i); }
  /// Displacement of point i in m.
  [[nodiscard]] auto point(std::ptrdiff_t i) const { return block(displacement, i); }
};

/// Moves q by the increment scale * d.
template <class T>
void retract(State<T>& q, const Vector<T>& d, T scale = T(1)) {
  q.displacement += scale * d;
}

/// The increment d with retract(from, d) = to.
template <class T>
void difference(const State<T>& from, const State<T>& to, Vector<T>& d) {
  d = to.displacement - from.displacement;
}

/// Right Jacobian of the increment: w becomes the change of state, as an increment at retract(q, u), that a
/// change w of u makes. The identity for points, which are all that there is so far; a rotation's is not.
template <class T>
void dexp(const State<T>& /*q*/, const Vector<T>& /*u*/, Vector<T>& /*w*/) {}

/// The inverse of `dexp`: w, an increment (or velocity) at retract(q, u), becomes the change of u that makes
/// it. The identity for points.
template <class T>
void dexp_inv(const State<T>& /*q*/, const Vector<T>& /*u*/, Vector<T>& /*w*/) {}

/// A state in motion.
template <class T>
struct Motion {
  State<T> q;
  Vector<T> v;      ///< velocity, m/s
  double time = 0;  ///< s

  Motion() = default;
  /// `points` points at rest.
  explicit Motion(std::size_t points) : q(points), v(Vector<T>::Zero(q.size())) {}
};

}  // namespace softsim
