// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <string>

#include "softsim/concepts.hpp"
#include "softsim/core/error.hpp"
#include "softsim/core/tensor.hpp"

namespace softsim {

/// What one family of fibres with unit direction a at rest sees of C = F^T F: I1 = tr C, the squared stretch
/// I4 = a . C a of the fibres (I6 for a second family), J = det F, and their distances from rest (see
/// `Invariants`).
template <class T>
struct FibreInvariants {
  T i1, i4, j;
  T k1 = i1 - T(3);  ///< I1 - 3
  T k4 = i4 - T(1);  ///< I4 - 1
  T kj = j - T(1);   ///< J - 1
};
/// First derivatives of w(I1, I4, J).
template <class T>
struct FibreFirst {
  T w1, w4, wj;
};
/// Second derivatives of w(I1, I4, J).
template <class T>
struct FibreSecond {
  T w11, w14, w44, w1j, w4j, wjj;
};

/// Energy w(I1, I4, J) of one family of fibres with w(3, 1, 1) = 0, J/m^3. Families add: two of them make
/// w(I1, I4, J) + w(I1, I6, J). Not a `Material` before it is told its directions, see `FibreTerm`.
template <class L, class T = double>
concept FibreLaw = requires(const L& law, const FibreInvariants<T>& i) {
  { law.density(i) } -> std::convertible_to<T>;
  { law.first(i) } -> std::same_as<FibreFirst<T>>;
  { law.second(i) } -> std::same_as<FibreSecond<T>>;
  { L::depends_on_j } -> std::convertible_to<bool>;
};

/// Unit directions of n fibre families in the rest shape.
template <class T, std::size_t n>
struct FibreDirections {
  std::array<Vec3<T>, n> a;
};

/// The directions, with their last digits normalised; their sign does not matter.
/// @param entity what the message of an error begins with, as "tetrahedron 17: "
/// @throws std::invalid_argument for a length that is off 1 by more than 1e-6
template <std::size_t n>
[[nodiscard]] FibreDirections<double, n> unit_directions(const std::array<Vec3<double>, n>& a,
                                                         const std::string& entity = {}) {
  FibreDirections<double, n> unit;
  for (std::size_t i = 0; i < n; ++i) {
    const double length = a[i].norm();
    if (!(std::abs(length - 1) <= 1e-6))
      invalid(entity + "fibre direction (" + to_text(a[i][0]) + ", " + to_text(a[i][1]) + ", " +
              to_text(a[i][2]) + "): length " + to_text(length) + " must be 1");
    unit.a[i] = a[i] / length;
  }
  return unit;
}

/// A law that becomes a `Material` when `at` gives it the directions of its fibres.
template <class M>
concept TakesFibreDirections = requires(const M& law, const FibreDirections<double, 1>& directions) {
  law.at(directions);
};

/// A law with n fibre families whose directions differ from element to element: they are its data there.
template <TakesFibreDirections M, std::size_t n>
struct FibreField {
  template <class T>
  using Data = FibreDirections<T, n>;

  M law;

  /// The material of an element.
  template <class T>
  [[nodiscard]] auto at(const FibreDirections<T, n>& directions) const {
    return law.at(directions);
  }
};

/// n families of fibres that follow one law each along its own direction: a `Material` that resists along
/// them, to be added to a matrix. D is the scalar of the directions: double if they are the same everywhere,
/// the scalar of F if they come with the element.
template <FibreLaw Law, class D, std::size_t n>
class Fibres {
  // Directions in lanes leave no scalar F to be asked about: the concept has to see that, not fail inside.
  template <class T>
  static constexpr bool takes = std::convertible_to<D, T>;

 public:
  /// @param directions of length 1, see unit_directions
  Fibres(const Law& law, const FibreDirections<D, n>& directions) : law_(law), directions_(directions) {}

  /// The law of each family.
  [[nodiscard]] const Law& law() const { return law_; }
  /// The families' directions.
  [[nodiscard]] const FibreDirections<D, n>& directions() const { return directions_; }

  /// Sum of w, J/m^3.
  template <class Derived>
  [[nodiscard]] auto energy_density(
      const Eigen::MatrixBase<Derived>& F) const requires takes<typename Derived::Scalar> {
    using T = typename Derived::Scalar;
    const Shared<T> shared{Mat3<T>(F)};
    T sum(0);
    for (std::size_t k = 0; k < n; ++k) sum += law_.density(shared.seen_along(direction<T>(k)));
    return sum;
  }

  /// P = sum of 2 w1 F + 2 w4 (F a) a^T + wJ cof F, Pa.
  template <class Derived>
  [[nodiscard]] auto first_piola(
      const Eigen::MatrixBase<Derived>& F_) const requires takes<typename Derived::Scalar> {
    using T = typename Derived::Scalar;
    const Mat3<T>& F = F_.derived();
    const Shared<T> shared(F);
    Mat3<T> P = Mat3<T>::Zero();
    T w1(0), wj(0);
    for (std::size_t k = 0; k < n; ++k) {
      const Vec3<T> a = direction<T>(k), Fa = F * a;
      const FibreFirst<T> w = law_.first(shared.seen_along(a));
      const T w4 = T(2) * w.w4;
      const Vec3<T> t = w4 * Fa;
      P += t * a.transpose();
      w1 += w.w1;
      wj += w.wj;
    }
    w1 *= T(2);
    P += w1 * F;
    if constexpr (Law::depends_on_j) P += wj * cofactor(F);
    return P;
  }

  /// S = F^-1 P = sum of 2 w1 I + 2 w4 a a^T + wJ J C^-1, Pa. Needs J != 0 if w depends on J.
  template <class Derived>
  [[nodiscard]] auto second_piola(
      const Eigen::MatrixBase<Derived>& F_) const requires takes<typename Derived::Scalar> {
    using T = typename Derived::Scalar;
    const Mat3<T>& F = F_.derived();
    const Shared<T> shared(F);
    Mat3<T> S = Mat3<T>::Zero();
    for (std::size_t k = 0; k < n; ++k) {
      const Vec3<T> a = direction<T>(k);
      const FibreInvariants<T> i = shared.seen_along(a);
      const FibreFirst<T> w = law_.first(i);
      const T w1 = T(2) * w.w1, w4 = T(2) * w.w4;
      const Vec3<T> t = w4 * a;
      S += t * a.transpose();
      S += w1 * Mat3<T>::Identity();
      if constexpr (Law::depends_on_j) {
        const Mat3<T> C = F.transpose() * F;
        const T c = w.wj / i.j;
        S += c * cofactor(C);
      }
    }
    return S;
  }

  /// dP(F; dF), the directional derivative of the first Piola-Kirchhoff stress, Pa.
  template <class Derived, class Other>
  [[nodiscard]] auto first_piola_differential(
      const Eigen::MatrixBase<Derived>& F_,
      const Eigen::MatrixBase<Other>& dF_) const requires takes<typename Derived::Scalar> {
    using T = typename Derived::Scalar;
    const Mat3<T>& F = F_.derived();
    const Mat3<T>& dF = dF_.derived();
    const Shared<T> shared(F);
    const T d1 = T(2) * double_dot(F, dF);
    T dj(0);
    Mat3<T> c;
    if constexpr (Law::depends_on_j) {
      c = cofactor(F);
      dj = double_dot(c, dF);
    }
    Mat3<T> dP = Mat3<T>::Zero();
    T w1(0), wj(0), e1(0), ej(0);
    for (std::size_t k = 0; k < n; ++k) {
      const Vec3<T> a = direction<T>(k), Fa = F * a, dFa = dF * a;
      const FibreInvariants<T> i = shared.seen_along(a);
      const FibreFirst<T> w = law_.first(i);
      const FibreSecond<T> s = law_.second(i);
      const T d4 = T(2) * Fa.dot(dFa);
      T e4 = s.w14 * d1 + s.w44 * d4;
      e1 += s.w11 * d1 + s.w14 * d4;
      if constexpr (Law::depends_on_j) {
        e4 += s.w4j * dj;
        e1 += s.w1j * dj;
        ej += s.w1j * d1 + s.w4j * d4 + s.wjj * dj;
      }
      e4 *= T(2);
      const T w4 = T(2) * w.w4;
      const Vec3<T> t = w4 * dFa + e4 * Fa;
      dP += t * a.transpose();
      w1 += w.w1;
      wj += w.wj;
    }
    w1 *= T(2);
    e1 *= T(2);
    dP += w1 * dF + e1 * F;
    if constexpr (Law::depends_on_j) dP += wj * cofactor_differential(F, dF) + ej * c;
    return dP;
  }

 private:
  // What all families see alike. From H = F - I, so that small strains keep their digits.
  template <class T>
  struct Shared {
    Mat3<T> H;
    T k1, kj = T(0);

    explicit Shared(const Mat3<T>& F) : H(F - Mat3<T>::Identity()) {
      const T t = trace(H);
      k1 = T(2) * t + double_dot(H, H);
      if constexpr (Law::depends_on_j) {
        const Mat3<T> c = cofactor(H);
        kj = t + trace(c) + H.col(0).dot(c.col(0));
      }
    }
    [[nodiscard]] FibreInvariants<T> seen_along(const Vec3<T>& a) const {
      const Vec3<T> Ha = H * a;
      const T k4 = T(2) * a.dot(Ha) + Ha.dot(Ha);
      return {T(3) + k1, T(1) + k4, T(1) + kj, k1, k4, kj};
    }
  };

  template <class T>
  [[nodiscard]] Vec3<T> direction(std::size_t k) const {
    return directions_.a[k].template cast<T>();
  }

  Law law_;
  FibreDirections<D, n> directions_;
};

/// Gives a law w(I1, I4, J) its ways to take directions. Derive `struct MyFibres : FibreTerm<MyFibres>` and
/// give it `density`, `first` and `second`; see `FibreLaw`.
template <class Law>
class FibreTerm {
 public:
  // What a law may sharpen by declaring the same name.
  static constexpr bool depends_on_j = true;  ///< false: wJ and all its derivatives are zero

  /// One family along the unit vector a, the same everywhere.
  /// @throws std::invalid_argument for a length that is off 1 by more than 1e-6
  [[nodiscard]] auto along(const Vec3<double>& a) const { return at(unit_directions<1>({a})); }
  /// Two families, along the unit vectors a and b.
  /// @throws std::invalid_argument for a length that is off 1 by more than 1e-6
  [[nodiscard]] auto along(const Vec3<double>& a, const Vec3<double>& b) const {
    return at(unit_directions<2>({a, b}));
  }
  /// A family along each of the directions of one element, which are taken as they are.
  template <class T, std::size_t n>
  [[nodiscard]] auto at(const FibreDirections<T, n>& directions) const {
    return Fibres<Law, T, n>(static_cast<const Law&>(*this), directions);
  }
};

}  // namespace softsim
