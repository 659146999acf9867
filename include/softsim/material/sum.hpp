// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <type_traits>

#include "softsim/concepts.hpp"
#include "softsim/core/tensor.hpp"
#include "softsim/material/fibre.hpp"

namespace softsim {

/// Two laws in parallel: energies, stresses and differentials add. A `Material` if both are; a sum with a
/// `FibreLaw` becomes one `along` its directions.
template <class A, class B>
class Sum {
  static constexpr bool has_fibres = TakesFibreDirections<A> || TakesFibreDirections<B>;
  template <class T>
  static constexpr bool takes = Material<A, T>&& Material<B, T>;

 public:
  Sum(const A& first, const B& second) : first_(first), second_(second) {}

  /// The first law.
  [[nodiscard]] const A& first() const { return first_; }
  /// The second law.
  [[nodiscard]] const B& second() const { return second_; }

  /// Sum of psi(F), J/m^3.
  template <class Derived>
  [[nodiscard]] auto energy_density(
      const Eigen::MatrixBase<Derived>& F_) const requires takes<typename Derived::Scalar> {
    const Mat3<typename Derived::Scalar>& F = F_.derived();
    return first_.energy_density(F) + second_.energy_density(F);
  }
  /// Sum of P, Pa.
  template <class Derived>
  [[nodiscard]] auto first_piola(
      const Eigen::MatrixBase<Derived>& F_) const requires takes<typename Derived::Scalar> {
    const Mat3<typename Derived::Scalar>& F = F_.derived();
    Mat3<typename Derived::Scalar> P = first_.first_piola(F);
    P += second_.first_piola(F);
    return P;
  }
  /// Sum of S, Pa, of laws that have it.
  template <class Derived>
  [[nodiscard]] auto second_piola(
      const Eigen::MatrixBase<Derived>& F_) const requires takes<typename Derived::Scalar> {
    const Mat3<typename Derived::Scalar>& F = F_.derived();
    Mat3<typename Derived::Scalar> S = first_.second_piola(F);
    S += second_.second_piola(F);
    return S;
  }
  /// Sum of dP(F; dF), Pa.
  template <class Derived, class Other>
  [[nodiscard]] auto first_piola_differential(
      const Eigen::MatrixBase<Derived>& F_,
      const Eigen::MatrixBase<Other>& dF_) const requires takes<typename Derived::Scalar> {
    const Mat3<typename Derived::Scalar>&F = F_.derived(), &dF = dF_.derived();
    Mat3<typename Derived::Scalar> dP = first_.first_piola_differential(F, dF);
    dP += second_.first_piola_differential(F, dF);
    return dP;
  }

  /// The fibre laws in the sum along a, or along a and b: unit vectors, the same everywhere.
  /// @throws std::invalid_argument for a length that is off 1 by more than 1e-6
  [[nodiscard]] auto along(const Vec3<double>& a) const requires has_fibres {
    return at(unit_directions<1>({a}));
  }
  [[nodiscard]] auto along(const Vec3<double>& a, const Vec3<double>& b) const requires has_fibres {
    return at(unit_directions<2>({a, b}));
  }
  /// The fibre laws in the sum along each of the directions of one element.
  template <class T, std::size_t n>
  [[nodiscard]] auto at(const FibreDirections<T, n>& directions) const requires has_fibres {
    const auto first = oriented(first_, directions);
    const auto second = oriented(second_, directions);
    return Sum<std::remove_const_t<decltype(first)>, std::remove_const_t<decltype(second)>>(first, second);
  }

 private:
  template <class M, class Directions>
  static auto oriented(const M& law, const Directions& directions) {
    if constexpr (TakesFibreDirections<M>)
      return law.at(directions);
    else
      return law;
  }

  A first_;
  B second_;
};

namespace detail {
template <class M>
inline constexpr bool is_sum = false;
template <class A, class B>
inline constexpr bool is_sum<Sum<A, B>> = true;
template <class M>
concept Summand = Material<M> || FibreLaw<M> || is_sum<M>;
}  // namespace detail

/// Two laws in parallel, see `Sum`: `NeoHookean::from_young_poisson(E, nu) +
/// HolzapfelGasserOgden(p).along(a)`.
template <detail::Summand A, detail::Summand B>
[[nodiscard]] Sum<A, B> operator+(const A& first, const B& second) {
  return {first, second};
}

}  // namespace softsim
