// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include "softsim/core/tensor.hpp"

namespace softsim {

/// Symmetric 3x3 tensor as six components in the order 00, 11, 22, 12, 02, 01 (Bosman 2015, Eq. A.1).
template <class T>
using Vec6 = Eigen::Matrix<T, 6, 1>;

/// Components of a stress; of S only the upper triangle is read. With `strain_to_voigt` the work is a dot
/// product: stress_to_voigt(S) . strain_to_voigt(E) = S : E.
template <class T>
[[nodiscard]] Vec6<T> stress_to_voigt(const Mat3<T>& S) {
  Vec6<T> s;
  s << S(0, 0), S(1, 1), S(2, 2), S(1, 2), S(0, 2), S(0, 1);
  return s;
}

/// Symmetric stress tensor of the components s.
template <class T>
[[nodiscard]] Mat3<T> voigt_to_stress(const Vec6<T>& s) {
  Mat3<T> S;
  S << s[0], s[5], s[4], s[5], s[1], s[3], s[4], s[3], s[2];
  return S;
}

/// Components of a strain; the last three are engineering shears 2 E_12, 2 E_02, 2 E_01. Of E only the upper
/// triangle is read.
template <class T>
[[nodiscard]] Vec6<T> strain_to_voigt(const Mat3<T>& E) {
  Vec6<T> e;
  e << E(0, 0), E(1, 1), E(2, 2), T(2) * E(1, 2), T(2) * E(0, 2), T(2) * E(0, 1);
  return e;
}

/// Symmetric strain tensor of the components e, whose last three are engineering shears.
template <class T>
[[nodiscard]] Mat3<T> voigt_to_strain(const Vec6<T>& e) {
  const T yz = T(0.5) * e[3], xz = T(0.5) * e[4], xy = T(0.5) * e[5];
  Mat3<T> E;
  E << e[0], xy, xz, xy, e[1], yz, xz, yz, e[2];
  return E;
}

}  // namespace softsim
