// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <limits>

#include "softsim/core/symmetric_eigen.hpp"
#include "softsim/core/tensor.hpp"

namespace softsim {

namespace detail {

// The part of a discrete gradient along the increment dx of its variable that makes the work equal to the
// change of energy: (change - work)/|dx|^2, work being that of the gradient at the middle. It is of the order
// |dx|^2 beside that gradient; where this is less than the rounding of `change` makes of it, it is left out.
template <class T>
T energy_correction(const T& change, const T& work, const T& square) {
  using Real = decltype(lane(T{}, 0));
  const T least = T(std::pow(std::numeric_limits<Real>::epsilon(), Real(2) / 3));
  return select(square > least, (change - work) / select(square > least, square, T(1)), T(0));
}

}  // namespace detail

/// First Piola-Kirchhoff stress P, Pa, that does the work P : (F_1 - F_0) = psi(F_1) - psi(F_0) to rounding
/// and turns with the body: P = F_m S, F_m = (F_0 + F_1)/2, with the symmetric
///   S = S(C_m) + (psi_1 - psi_0 - S(C_m) : dE)/|dE|^2 dE,  C_m = (C_0 + C_1)/2,  dE = (C_1 - C_0)/2
/// (Gonzalez 2000, "Exact energy and momentum conserving algorithms for general models in nonlinear
/// elasticity"). S(C_m) is U^-1 P(U) at the stretch U = sqrt(C_m): meant for elements that are not inverted.
/// A law that is not objective, and says so by `objective = false`, gets the same in F itself.
template <class M, class T>
[[nodiscard]] Mat3<T> discrete_stress(const M& law, const Mat3<T>& F_0, const Mat3<T>& F_1) {
  using std::max, std::sqrt;
  const T change = law.energy_density(F_1) - law.energy_density(F_0);
  const Mat3<T> dF = F_1 - F_0, F_m = T(0.5) * (F_0 + F_1);
  if constexpr (requires { requires !M::objective; }) {
    Mat3<T> P = law.first_piola(F_m);
    const T scale = detail::energy_correction<T>(change, double_dot(P, dF), double_dot(dF, dF));
    P += scale * dF;
    return P;
  } else {
    const Mat3<T> half = F_m.transpose() * dF, dE = symmetric_part<T>(half);
    // C_m = F_m^T F_m + dF^T dF/4
    const Mat3<T> spread = dF.transpose() * dF;
    Mat3<T> C_m = F_m.transpose() * F_m;
    C_m += T(0.25) * spread;
    const SymmetricEigen<T> eigen = symmetric_eigen(C_m);
    Mat3<T> VU = eigen.V, VU_inverse = eigen.V;
    for (int i = 0; i < 3; ++i) {
      using Real = decltype(lane(T{}, 0));
      const T u = sqrt(max(eigen.values[i], T(std::numeric_limits<Real>::min())));
      VU.col(i) *= u;
      VU_inverse.col(i) /= u;
    }
    const Mat3<T> U = VU * eigen.V.transpose(), P = law.first_piola(U);
    const Mat3<T> turned = eigen.V.transpose() * P, S_m = VU_inverse * turned;
    Mat3<T> S = symmetric_part<T>(S_m);
    const T scale = detail::energy_correction<T>(change, double_dot(S, dE), double_dot(dE, dE));
    S += scale * dE;
    return F_m * S;
  }
}

}  // namespace softsim
