// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <concepts>
#include <type_traits>

#include "softsim/core/state.hpp"
#include "softsim/core/tensor.hpp"

// The whole contract:
//   local energy -> gather / scatter -> operator -> solver -> step
// T is a plain scalar or a Batch of them; whatever is templated on T has to take both.

namespace softsim {

// ---------------------------------------------------------------- materials

/// Invariants of C = F^T F, and J = det F: I1 = tr C, I2 = (I1^2 - tr C^2)/2. An energy is best written in
/// their distances from rest, which come to it with the digits that a subtraction would lose at small strain.
template <class T>
struct Invariants {
  T i1, i2, j;
  T k1 = i1 - T(3);  ///< I1 - 3
  T k2 = i2 - T(3);  ///< I2 - 3
  T kj = j - T(1);   ///< J - 1
};
/// First derivatives of w(I1, I2, J).
template <class T>
struct First {
  T w1, w2, wj;
};
/// Second derivatives of w(I1, I2, J).
template <class T>
struct Second {
  T w11, w12, w22, w1j, w2j, wjj;
};

/// Isotropic law written once, as w(I1, I2, J) with w(3, 3, 1) = 0, J/m^3. The flags let the compiler drop
/// what is identically zero, which it may not do for 0 * x by itself.
template <class L, class T = double>
concept InvariantLaw = requires(const L& law, const Invariants<T>& i) {
  { law.density(i) } -> std::convertible_to<T>;
  { law.first(i) } -> std::same_as<First<T>>;
  { law.second(i) } -> std::same_as<Second<T>>;
  { L::depends_on_i2 } -> std::convertible_to<bool>;
  { L::depends_on_j } -> std::convertible_to<bool>;
  { L::linear_in_i1 } -> std::convertible_to<bool>;
};

/// Stored energy per reference volume psi(F) in J/m^3 with psi(I) = 0, first Piola-Kirchhoff stress P =
/// dpsi/dF in Pa, and its differential dP(F; dF).
template <class M, class T = double>
concept Material = requires(const M& m, const Mat3<T>& F, const Mat3<T>& dF) {
  { m.energy_density(F) } -> std::convertible_to<T>;
  { m.first_piola(F) } -> std::convertible_to<Mat3<T>>;
  { m.first_piola_differential(F, dF) } -> std::convertible_to<Mat3<T>>;
  // Eigen lets any matrix claim to convert to any other: the scalar has to be asked for.
  requires std::same_as<typename std::remove_cvref_t<decltype(m.first_piola(F))>::Scalar, T>;
  requires std::same_as<typename std::remove_cvref_t<decltype(m.first_piola_differential(F, dF))>::Scalar, T>;
};

// ---------------------------------------------------------------- stencils

/// A frame as a stencil sees it: displacement of its origin in m, and rotation from rest.
template <class T>
struct FrameValue {
  Vec3<T> displacement;
  Mat3<T> turn;  ///< R - I

  /// R A: columns in the axes of the body into those of space.
  template <int columns>
  [[nodiscard]] Eigen::Matrix<T, 3, columns> to_space(const Eigen::Matrix<T, 3, columns>& A) const {
    return A + turn * A;
  }
  /// R^T A: columns in the axes of space into those of the body.
  template <int columns>
  [[nodiscard]] Eigen::Matrix<T, 3, columns> to_body(const Eigen::Matrix<T, 3, columns>& A) const {
    return A + turn.transpose() * A;
  }
};
/// Values of the unknowns of one stencil: displacements of its P points in m, and its Q frames.
template <class T, int P, int Q = 0>
struct Local {
  std::array<Vec3<T>, P> points;
  std::array<FrameValue<T>, Q> frames;
};
template <class T, int P>
struct Local<T, P, 0> {
  std::array<Vec3<T>, P> points;
};
/// Number of frames that E works on, which it declares as `frames` if there are any.
template <class E>
inline constexpr int frames_of = [] {
  if constexpr (requires { E::frames; })
    return E::frames;
  else
    return 0;
}();
/// Values of the unknowns that E (a kinematics or a local potential) works on.
template <class E, class T>
using Unknowns = Local<T, E::points, frames_of<E>>;
/// Increments of those unknowns, or forces on them: three for a point; three in space and three in the axes
/// of the body for a frame.
template <class E, class T>
using Tangent = Eigen::Matrix<T, 3 * E::points + 6 * frames_of<E>, 1>;

/// One integration point: unknowns -> deformation gradient, and the pull-back of a stress to forces, B^T P.
/// `Data<T>` holds what the rest shape determines, as scalars of type T only.
template <class K, class T = double>
concept Kinematics = requires(const typename K::template Data<T>& data, const Unknowns<K, T>& u,
                              const Tangent<K, T>& du, const Mat3<T>& P) {
  { K::volume(data) } -> std::convertible_to<T>;
  { K::deformation_gradient(data, u) } -> std::convertible_to<Mat3<T>>;
  { K::deformation_gradient_differential(data, u, du) } -> std::convertible_to<Mat3<T>>;
  { K::pullback(data, u, P) } -> std::convertible_to<Tangent<K, T>>;
};

/// Kinematics whose deformation gradient is not linear in the unknowns: adds the derivative of the pull-back
/// at fixed P.
template <class K, class T = double>
concept NonlinearKinematics = Kinematics<K, T> &&
    requires(const typename K::template Data<T>& data, const Unknowns<K, T>& u, const Tangent<K, T>& du,
             const Mat3<T>& P) {
  { K::geometric_product(data, u, P, du) } -> std::convertible_to<Tangent<K, T>>;
};

/// Pure functions on one stencil: gradient (minus the force, N) and its derivative in a direction, or the
/// symmetric part of that where it is not symmetric: an assembled tangent keeps one triangle.
template <class E, class T = double>
concept LocalForce = requires(const E& e, const typename E::template Data<T>& data, const Unknowns<E, T>& u,
                              const Tangent<E, T>& du) {
  { e.gradient(data, u) } -> std::convertible_to<Tangent<E, T>>;
  { e.hessian_product(data, u, du) } -> std::convertible_to<Tangent<E, T>>;
};

/// A local force that derives from an energy in J.
template <class E, class T = double>
concept LocalPotential = LocalForce<E, T> &&
    requires(const E& e, const typename E::template Data<T>& data, const Unknowns<E, T>& u) {
  { e.energy(data, u) } -> std::convertible_to<T>;
};

// ---------------------------------------------------------------- terms of a system

/// Anything that adds to the gradient (minus the force) and to its derivative over all unknowns.
template <class S>
concept ForceTerm = requires(const S& s, const State<typename S::Scalar>& q,
                             const Vector<typename S::Scalar>& d, Vector<typename S::Scalar>& y) {
  s.add_gradient(q, y);
  s.add_hessian_product(q, d, y);
};

/// A force term that derives from an energy.
template <class S>
concept Potential = ForceTerm<S> && requires(const S& s, const State<typename S::Scalar>& q) {
  { s.energy(q) } -> std::convertible_to<double>;
};

// ---------------------------------------------------------------- solvers and steps

/// y = A x.
template <class A, class T = double>
concept LinearOperator = requires(const A& a, const Vector<T>& x, Vector<T>& y) {
  a.apply(x, y);
};

/// z = B r with B close to the inverse of an operator and positive definite.
template <class B, class T = double>
concept Preconditioner = requires(const B& b, const Vector<T>& r, Vector<T>& z) {
  b.apply(r, z);
};

/// Advances a motion by one step over a system and says how it went.
template <class I, class S>
concept Integrator = requires(I& integrator, S& system, Motion<typename S::Scalar>& motion) {
  {integrator.step(system, motion).status};
};

}  // namespace softsim
