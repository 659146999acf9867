// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

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

/// Dot product, accumulated in double whatever the scalar.
template <class T>
[[nodiscard]] double dot(const Vector<T>& a, const Vector<T>& b) {
  if constexpr (sizeof(T) == sizeof(double)) {
    return a.dot(b);
  } else {
    return a.template cast<double>().dot(b.template cast<double>());
  }
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
