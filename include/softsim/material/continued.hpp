// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <concepts>
#include <string>

#include "softsim/core/batch.hpp"
#include "softsim/core/error.hpp"
#include "softsim/material/isotropic.hpp"
#include "softsim/material/rest_moduli.hpp"

namespace softsim {

/// A law w = a(I1, I2) + b(J): one that is linear in I1 alone, or says `separable_in_j = true`.
template <class Law>
concept SeparableLaw = InvariantLaw<Law> && Law::depends_on_j &&
    ((!Law::depends_on_i2 && Law::linear_in_i1) || requires { requires Law::separable_in_j; });

/// A law that hands out the functions of J it is made of, as `Isochoric` does.
template <class Law>
concept LawOfExtensibleVolume = InvariantLaw<Law> && requires(const Law& law, const Invariants<double>& i) {
  { law.density(i, law.of_volume(i).extended(0.0)) } -> std::convertible_to<double>;
};

/// A law that resists being pressed flat with a finite stress, and resists inversion: below a threshold J0
/// its response to volume is continued from what it is at J0 (Goulette & Chen 2015, Sec. 4.4, tangent
/// corrected). For w = a(I1, I2) + b(J) the derivative b' goes on along its tangent; for an `Isochoric` law
/// J^-2/3, J^-4/3 and U each go on as their second-order Taylor polynomials. Either way w is twice
/// continuously differentiable: energy, stress and differential stay continuous across J0, finite at J = 0
/// and for every J < 0, and nothing changes for J >= J0. An exponential law stays finite only as long as its
/// exponent does not overflow, which by inversion comes soon.
template <class Law>
requires(SeparableLaw<Law> || LawOfExtensibleVolume<Law>) class Continued : public Isotropic<Continued<Law>> {
 public:
  static constexpr bool depends_on_i2 = Law::depends_on_i2, linear_in_i1 = Law::linear_in_i1;

  /// Continues `law` below J = j0.
  /// @throws std::invalid_argument unless 0 < j0 < 1
  explicit Continued(const Law& law, double j0 = 0.4) : law_(law), j0_(j0) {
    if (!(j0 > 0 && j0 < 1)) invalid(std::string("threshold J0 ") + to_text(j0) + ": must lie in (0, 1)");
  }

  /// w, J/m^3.
  template <class T>
  [[nodiscard]] T density(const Invariants<T>& i) const {
    const Invariants<T> at = no_further_than_threshold(i);
    const T x = i.kj - at.kj;
    if constexpr (SeparableLaw<Law>)
      return law_.density(at) + (law_.first(at).wj + T(0.5) * law_.second(at).wjj * x) * x;
    else
      return law_.density(i, law_.of_volume(at).extended(x));
  }
  /// First derivatives of w, Pa.
  template <class T>
  [[nodiscard]] First<T> first(const Invariants<T>& i) const {
    const Invariants<T> at = no_further_than_threshold(i);
    const T x = i.j - at.j;
    if constexpr (SeparableLaw<Law>) {
      First<T> w = law_.first(at);
      w.wj += law_.second(at).wjj * x;
      return w;
    } else {
      return law_.first(i, law_.of_volume(at).extended(x));
    }
  }
  /// Second derivatives of w, Pa.
  template <class T>
  [[nodiscard]] Second<T> second(const Invariants<T>& i) const {
    const Invariants<T> at = no_further_than_threshold(i);
    if constexpr (SeparableLaw<Law>)
      return law_.second(at);
    else
      return law_.second(i, law_.of_volume(at).extended(i.j - at.j));
  }

  /// The law that is continued.
  [[nodiscard]] const Law& law() const { return law_; }
  /// J0.
  [[nodiscard]] double threshold() const { return j0_; }
  /// Lame parameters of small strain, Pa.
  [[nodiscard]] double lambda() const { return rest_moduli(*this).lambda; }
  [[nodiscard]] double mu() const { return rest_moduli(*this).mu; }

 private:
  // Invariants with J raised to J0 where it is below; a J that is not a number stays one.
  template <class T>
  Invariants<T> no_further_than_threshold(const Invariants<T>& i) const {
    const T j0 = T(j0_), k0 = T(j0_ - 1);
    return {i.i1, i.i2, select(i.j < j0, j0, i.j), i.k1, i.k2, select(i.j < j0, k0, i.kj)};
  }

  Law law_;
  double j0_;
};

}  // namespace softsim
