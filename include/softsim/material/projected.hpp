// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <concepts>
#include <utility>

#include "softsim/concepts.hpp"
#include "softsim/core/tensor.hpp"
#include "softsim/material/principal_tangent.hpp"
#include "softsim/material/stretch_law.hpp"

namespace softsim {

/// An isotropic law whose tangent is known in principal axes: an `InvariantLaw`, a `StretchLaw`, or one with
/// a `principal_tangent` of its own, as `Corotational`.
template <class Law>
concept HasPrincipalTangent = requires(const Law& law, const Mat3<double>& F) {
  { principal_tangent(law, F) } -> std::same_as<PrincipalTangent<double>>;
};

/// An isotropic law whose tangent has no negative eigenvalue: energy and stress are the law's own, the
/// derivative of the stress is filtered (see `SpdFilter`). With it Newton's method always has a descent
/// direction, also from states where the energy is not convex; where the tangent is positive semidefinite it
/// stays what it is, but for the rounding of principal axes. The Hessian of every element with a constant B
/// is then positive semidefinite, and so is their sum. `HolzapfelGasserOgden`, a convex function of F, needs
/// no filter beside it: `projected(matrix) + fibres` is positive semidefinite, which the split form of the
/// fibres is not. A `Material`, but deliberately no `InvariantLaw` or `StretchLaw`: routes that take those
/// apart would lose the filter.
template <class Law>
requires HasPrincipalTangent<Law>
class Projected {
 public:
  explicit Projected(Law law, SpdFilter filter = SpdFilter::clamp) : law_(std::move(law)), filter_(filter) {}

  /// psi(F), J/m^3.
  template <class Derived>
  [[nodiscard]] auto energy_density(const Eigen::MatrixBase<Derived>& F) const {
    return law_.energy_density(F);
  }
  /// P = dpsi/dF, Pa.
  template <class Derived>
  [[nodiscard]] auto first_piola(const Eigen::MatrixBase<Derived>& F) const {
    return law_.first_piola(F);
  }
  /// S = F^-1 P, Pa.
  template <class Derived>
  [[nodiscard]] auto second_piola(const Eigen::MatrixBase<Derived>& F) const {
    return law_.second_piola(F);
  }
  /// The filtered tangent at F, ready for products; a product costs a small part of making it.
  template <class Derived>
  [[nodiscard]] auto linearise(const Eigen::MatrixBase<Derived>& F) const {
    using T = typename Derived::Scalar;
    return principal_tangent(law_, Mat3<T>(F)).filtered(filter_);
  }
  /// True if in no lane the filter has anything to do at F, by a cheap test that may miss such states.
  template <class T>
  [[nodiscard]] bool surely_unfiltered(const Mat3<T>& F) const {
    if (filter_ == SpdFilter::none) return true;
    if constexpr (requires { surely_positive(law_, F); })
      return detail::everywhere(surely_positive(law_, F));
    else
      return false;
  }
  /// `linearise(F)` applied to dF, Pa.
  template <class Derived, class Other>
  [[nodiscard]] auto first_piola_differential(const Eigen::MatrixBase<Derived>& F,
                                              const Eigen::MatrixBase<Other>& dF) const {
    return linearise(F)(dF);
  }

  /// The law inside.
  [[nodiscard]] const Law& law() const { return law_; }
  /// The filter in use.
  [[nodiscard]] SpdFilter filter() const { return filter_; }

 private:
  Law law_;
  SpdFilter filter_;
};

/// `law` with a filtered tangent: `elastic(mesh, projected(law))` gives Newton projected Hessians.
template <class Law>
requires HasPrincipalTangent<Law>
[[nodiscard]] Projected<Law> projected(const Law& law, SpdFilter filter = SpdFilter::clamp) {
  return Projected<Law>(law, filter);
}

}  // namespace softsim
