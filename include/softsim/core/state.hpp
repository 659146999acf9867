// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "softsim/core/rotation.hpp"
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

/// Values of all unknowns, as displacements from rest, which keep single precision accurate far from the
/// origin. A point has one block, its displacement in m. A frame, a node in R^3 x SO(3), has two: the
/// displacement of its origin, and its rotation from rest as a unit quaternion (x, y, z, w), which takes all
/// four scalars. Frames come after all points. In flat vectors of increments, velocities and forces a frame's
/// two blocks hold a vector in the axes of space and one, of rotation or torque, in the axes of the body: R
/// becomes R exp([dr]x). The body's axes are those that were parallel to the axes of space at rest.
///
/// Everything above the potentials moves a state only through `retract` and `difference`.
template <class T>
struct State {
  Vector<T> displacement;

  State() = default;
  /// Points and frames at rest.
  explicit State(std::size_t points, std::size_t frames = 0)
      : displacement(Vector<T>::Zero(block_stride * static_cast<std::ptrdiff_t>(points + 2 * frames))),
        frames_(static_cast<std::ptrdiff_t>(frames)) {
    for (std::ptrdiff_t j = 0; j < frames_; ++j) quaternion(j)[3] = T(1);
  }

  /// Number of scalars in a flat vector of this state.
  [[nodiscard]] std::ptrdiff_t size() const { return displacement.size(); }
  /// Number of frames.
  [[nodiscard]] std::ptrdiff_t frames() const { return frames_; }
  /// Number of points.
  [[nodiscard]] std::ptrdiff_t points() const { return size() / block_stride - 2 * frames_; }
  /// Number of the first block of frame j, its translation; its rotation is the next.
  [[nodiscard]] std::ptrdiff_t frame_block(std::ptrdiff_t j) const { return points() + 2 * j; }

  /// Displacement of point i in m, writable.
  [[nodiscard]] auto point(std::ptrdiff_t i) { return block(displacement, i); }
  /// Displacement of point i in m.
  [[nodiscard]] auto point(std::ptrdiff_t i) const { return block(displacement, i); }
  /// Displacement of the origin of frame j in m, writable.
  [[nodiscard]] auto translation(std::ptrdiff_t j) { return block(displacement, frame_block(j)); }
  /// Displacement of the origin of frame j in m.
  [[nodiscard]] auto translation(std::ptrdiff_t j) const { return block(displacement, frame_block(j)); }
  /// Rotation of frame j from rest, writable; has to stay a unit quaternion.
  [[nodiscard]] auto quaternion(std::ptrdiff_t j) {
    return displacement.template segment<4>(block_stride * (frame_block(j) + 1));
  }
  /// Rotation of frame j from rest as a unit quaternion (x, y, z, w).
  [[nodiscard]] auto quaternion(std::ptrdiff_t j) const {
    return displacement.template segment<4>(block_stride * (frame_block(j) + 1));
  }
  /// Rotation of frame j from rest.
  [[nodiscard]] Mat3<T> rotation(std::ptrdiff_t j) const {
    Mat3<T> R = rotation_less_identity<T>(quaternion(j));
    R.diagonal().array() += T(1);
    return R;
  }
  /// The rotational block of frame j of the flat vector v, a torque or an angular velocity, in the axes of
  /// space: what to report.
  [[nodiscard]] Vec3<T> in_space(const Vector<T>& v, std::ptrdiff_t j) const {
    return rotation(j) * block(v, frame_block(j) + 1);
  }

 private:
  std::ptrdiff_t frames_ = 0;
};

namespace detail {
// The rotational block of frame j of an increment at a state.
template <class T, class V>
[[nodiscard]] auto rotational(const State<T>& q, V& d, std::ptrdiff_t j) {
  return block(d, q.frame_block(j) + 1);
}
}  // namespace detail

/// Moves q by the increment scale * d.
template <class T>
void retract(State<T>& q, const Vector<T>& d, T scale = T(1)) {
  if (q.frames() == 0) {
    q.displacement += scale * d;
    return;
  }
  const std::ptrdiff_t first = block_stride * q.points();
  q.displacement.head(first) += scale * d.head(first);
  for (std::ptrdiff_t j = 0; j < q.frames(); ++j) {
    q.translation(j) += scale * block(d, q.frame_block(j));
    const Vec3<T> r = scale * detail::rotational(q, d, j);
    q.quaternion(j) = quaternion_product<T>(q.quaternion(j), quaternion_exponential(r)).normalized();
  }
}

/// The increment d with retract(from, d) = to; rotations of at most half a turn.
template <class T>
void difference(const State<T>& from, const State<T>& to, Vector<T>& d) {
  d = to.displacement - from.displacement;
  for (std::ptrdiff_t j = 0; j < from.frames(); ++j) {
    detail::rotational(from, d, j) = rotation_between<T>(from.quaternion(j), to.quaternion(j));
    d[block_stride * (from.frame_block(j) + 1) + 3] = T(0);
  }
}

/// Size of the displacements of q from rest, as the norm of a flat vector, frames' rotations in rad: what an
/// increment of q has to be compared with.
template <class T>
[[nodiscard]] double norm(const State<T>& q) {
  double squares = dot(q.displacement, q.displacement);
  for (std::ptrdiff_t j = 0; j < q.frames(); ++j) {
    squares += static_cast<double>(quaternion_logarithm<T>(q.quaternion(j)).squaredNorm()) -
               static_cast<double>(q.quaternion(j).squaredNorm());
  }
  return std::sqrt(std::max(squares, 0.0));
}

/// Right Jacobian of the increment: w becomes the change of state, as an increment at retract(q, u), that a
/// change w of u makes. The identity for points.
template <class T>
void dexp(const State<T>& q, const Vector<T>& u, Vector<T>& w) {
  for (std::ptrdiff_t j = 0; j < q.frames(); ++j)
    detail::rotational(q, w, j) =
        (rotation_jacobian<T>(detail::rotational(q, u, j)) * detail::rotational(q, w, j)).eval();
}

/// The inverse of `dexp`: w, an increment (or velocity) at retract(q, u), becomes the change of u that makes
/// it.
template <class T>
void dexp_inv(const State<T>& q, const Vector<T>& u, Vector<T>& w) {
  for (std::ptrdiff_t j = 0; j < q.frames(); ++j)
    detail::rotational(q, w, j) =
        (rotation_jacobian_inverse<T>(detail::rotational(q, u, j)) * detail::rotational(q, w, j)).eval();
}

/// The transpose of `dexp`: w, a force at retract(q, u), becomes the force on u.
template <class T>
void dexp_transposed(const State<T>& q, const Vector<T>& u, Vector<T>& w) {
  for (std::ptrdiff_t j = 0; j < q.frames(); ++j)
    detail::rotational(q, w, j) =
        (rotation_jacobian<T>(-detail::rotational(q, u, j)) * detail::rotational(q, w, j)).eval();
}

/// The transpose of `dexp_inv`: w, a force on u, becomes the force at retract(q, u).
template <class T>
void dexp_inv_transposed(const State<T>& q, const Vector<T>& u, Vector<T>& w) {
  for (std::ptrdiff_t j = 0; j < q.frames(); ++j)
    detail::rotational(q, w, j) =
        (rotation_jacobian_inverse<T>(-detail::rotational(q, u, j)) * detail::rotational(q, w, j)).eval();
}

/// A state in motion.
template <class T>
struct Motion {
  State<T> q;
  Vector<T> v;      ///< velocity, m/s; of rotation in the axes of the body, rad/s
  double time = 0;  ///< s

  Motion() = default;
  /// Points and frames at rest.
  explicit Motion(std::size_t points, std::size_t frames = 0)
      : q(points, frames), v(Vector<T>::Zero(q.size())) {}
};

}  // namespace softsim
