// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include "softsim/core/error.hpp"
#include "softsim/core/elementary.hpp"
#include "softsim/material/fibre.hpp"

namespace softsim {

/// Parameters of `HolzapfelGasserOgden` and `SplitHolzapfelGasserOgden`.
struct HolzapfelGasserOgdenParameters {
  double k1;         ///< Pa, > 0; without dispersion 4 k1 is what a family adds to Young's modulus along it
  double k2;         ///< > 0; how soon the fibres stiffen
  double kappa = 0;  ///< dispersion in [0, 1/3]: 0 all along the direction, 1/3 alike in all directions
};

namespace detail {

// k1/(2 k2) (exp(k2 <E>^2) - 1) of the mean strain E with Macaulay's bracket, and its derivatives by E.
class TensionExponential {
 public:
  explicit TensionExponential(const HolzapfelGasserOgdenParameters& p) : p_(p) {
    if (!(p.k1 > 0) || !(p.k1 <= 1e300))
      invalid(std::string("fibres: k1 ") + to_text(p.k1) + " Pa must be positive and finite");
    if (!(p.k2 > 0) || !(p.k2 <= 1e300))
      invalid(std::string("fibres: k2 ") + to_text(p.k2) + " must be positive and finite");
    if (!(p.kappa >= 0) || !(p.kappa <= 1.0 / 3))
      invalid(std::string("fibres: dispersion kappa ") + to_text(p.kappa) + " must lie in [0, 1/3]");
  }

  [[nodiscard]] const HolzapfelGasserOgdenParameters& parameters() const { return p_; }
  // Share of I4 in the mean strain.
  [[nodiscard]] double aligned() const { return 1 - 3 * p_.kappa; }
  // kappa (I1 - 3) + (1 - 3 kappa) (I4 - 1)
  template <class T>
  [[nodiscard]] T strain(const FibreInvariants<T>& i) const {
    return T(p_.kappa) * i.k1 + T(aligned()) * i.k4;
  }

  template <class T>
  [[nodiscard]] T density(const T& E) const {
    using std::expm1, std::max;
    const T e = max(E, T(0));
    return T(p_.k1 / (2 * p_.k2)) * expm1(T(p_.k2) * e * e);
  }
  template <class T>
  [[nodiscard]] T first(const T& E) const {
    using std::exp, std::max;
    const T e = max(E, T(0));
    return T(p_.k1) * e * exp(T(p_.k2) * e * e);
  }
  template <class T>
  [[nodiscard]] T second(const T& E) const {
    using std::exp, std::max;
    const T e = max(E, T(0)), x = T(p_.k2) * e * e;
    return select(E > T(0), T(p_.k1) * (T(1) + T(2) * x) * exp(x), T(0));
  }

 private:
  HolzapfelGasserOgdenParameters p_;
};

}  // namespace detail

/// Collagen fibres with dispersion (Gasser, Ogden & Holzapfel 2006; kappa = 0: Holzapfel, Gasser & Ogden
/// 2000): w = k1/(2 k2) (exp(k2 <E>^2) - 1) per family, E = kappa (I1 - 3) + (1 - 3 kappa)(I4 - 1).
/// Macaulay's bracket <E> = max(E, 0) lets fibres act in tension only: stress is continuous there, its
/// differential jumps by terms of size 4 k1. Defined for every F. I1 and I4 are the full invariants, not
/// those of the isochoric part: a fibre that is stretched is under stress whatever the volume does, whereas
/// split, compressible tissue swells when pulled along its fibres and an isotropic dilation leaves them slack
/// (Sansour 2008; Helfenstein et al. 2010; Nolan et al. 2014). `HolzapfelGasserOgden({.k1 = 2e3, .k2 =
/// 5}).along(a)` is a `Material`; add it to a matrix.
class HolzapfelGasserOgden : public FibreTerm<HolzapfelGasserOgden> {
 public:
  static constexpr bool depends_on_j = false;

  /// @throws std::invalid_argument unless k1 > 0, k2 > 0 and 0 <= kappa <= 1/3
  explicit HolzapfelGasserOgden(const HolzapfelGasserOgdenParameters& parameters) : energy_(parameters) {}

  /// The parameters.
  [[nodiscard]] const HolzapfelGasserOgdenParameters& parameters() const { return energy_.parameters(); }

  /// w, J/m^3.
  template <class T>
  [[nodiscard]] T density(const FibreInvariants<T>& i) const {
    return energy_.density(energy_.strain(i));
  }
  /// First derivatives of w, Pa.
  template <class T>
  [[nodiscard]] FibreFirst<T> first(const FibreInvariants<T>& i) const {
    const T w = energy_.first(energy_.strain(i));
    return {T(parameters().kappa) * w, T(energy_.aligned()) * w, T(0)};
  }
  /// Second derivatives of w, Pa.
  template <class T>
  [[nodiscard]] FibreSecond<T> second(const FibreInvariants<T>& i) const {
    const T w = energy_.second(energy_.strain(i)), k = T(parameters().kappa), a = T(energy_.aligned());
    return {k * k * w, k * a * w, a * a * w, T(0), T(0), T(0)};
  }

 private:
  detail::TensionExponential energy_;
};

/// As `HolzapfelGasserOgden` with the isochoric invariants J^(-2/3) I1 and J^(-2/3) I4, as first published
/// and as many codes have it: E = J^(-2/3) (kappa I1 + (1 - 3 kappa) I4) - 1. For comparison, and for nearly
/// incompressible tissue, where both agree. Defined for J > 0; for J <= 0 no function returns a finite
/// number.
class SplitHolzapfelGasserOgden : public FibreTerm<SplitHolzapfelGasserOgden> {
 public:
  /// @throws std::invalid_argument unless k1 > 0, k2 > 0 and 0 <= kappa <= 1/3
  explicit SplitHolzapfelGasserOgden(const HolzapfelGasserOgdenParameters& parameters)
      : energy_(parameters) {}

  /// The parameters.
  [[nodiscard]] const HolzapfelGasserOgdenParameters& parameters() const { return energy_.parameters(); }

  /// w, J/m^3.
  template <class T>
  [[nodiscard]] T density(const FibreInvariants<T>& i) const {
    return energy_.density(strain(i).e);
  }
  /// First derivatives of w, Pa.
  template <class T>
  [[nodiscard]] FibreFirst<T> first(const FibreInvariants<T>& i) const {
    const Strain<T> E = strain(i);
    const T w = energy_.first(E.e);
    return {w * E.e1, w * E.e4, w * E.ej};
  }
  /// Second derivatives of w, Pa.
  template <class T>
  [[nodiscard]] FibreSecond<T> second(const FibreInvariants<T>& i) const {
    const Strain<T> E = strain(i);
    const T w = energy_.second(E.e), f = energy_.first(E.e) / i.j;
    // E1 and E4 go with J^(-2/3), EJ with J^(-5/3)
    return {w * E.e1 * E.e1,
            w * E.e1 * E.e4,
            w * E.e4 * E.e4,
            w * E.e1 * E.ej - T(2.0 / 3) * f * E.e1,
            w * E.e4 * E.ej - T(2.0 / 3) * f * E.e4,
            w * E.ej * E.ej - T(5.0 / 3) * f * E.ej};
  }

 private:
  template <class T>
  struct Strain {
    T e, e1, e4, ej;
  };
  template <class T>
  [[nodiscard]] Strain<T> strain(const FibreInvariants<T>& i) const {
    using std::expm1, std::log1p;
    const T g1 = expm1(T(-2.0 / 3) * log1p(i.kj)), g = T(1) + g1;  // J^(-2/3) - 1
    const T full = energy_.strain(i);
    return {g * full + g1, T(parameters().kappa) * g, T(energy_.aligned()) * g,
            T(-2.0 / 3) * g * (T(1) + full) / i.j};
  }

  detail::TensionExponential energy_;
};

}  // namespace softsim
