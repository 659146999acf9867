// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include "softsim/material/isochoric.hpp"
#include "softsim/material/volume_law.hpp"

namespace softsim {

/// W = C1 (I1 - 3) + C2 (I1 - 3)^2 + C3 (I1 - 3)^3.
struct YeohEnergy {
  static constexpr const char* name = "Yeoh";
  static constexpr bool depends_on_i2 = false, depends_on_j = false, linear_in_i1 = false;

  double c1, c2, c3;  ///< Pa

  /// W, J/m^3.
  template <class T>
  [[nodiscard]] T density(const Invariants<T>& i) const {
    return ((T(c3) * i.k1 + T(c2)) * i.k1 + T(c1)) * i.k1;
  }
  /// First derivatives of W, Pa.
  template <class T>
  [[nodiscard]] First<T> first(const Invariants<T>& i) const {
    return {(T(3 * c3) * i.k1 + T(2 * c2)) * i.k1 + T(c1), T(0), T(0)};
  }
  /// Second derivatives of W, Pa.
  template <class T>
  [[nodiscard]] Second<T> second(const Invariants<T>& i) const {
    return {T(6 * c3) * i.k1 + T(2 * c2), T(0), T(0), T(0), T(0), T(0)};
  }
};

/// Yeoh's law of three terms (Yeoh 1993): w = sum_n Cn (I1 J^-2/3 - 3)^n + bulk/2 (J - 1)^2. Defined for J >
/// 0; see `Continued`. Admissible are C1 > 0 and bulk > 0. W' = C1 + 2 C2 x + 3 C3 x^2 with x = I1 J^-2/3 - 3
/// is the resistance to distortion: positive for every strain if C3 > 0 and C2 > -sqrt(3 C1 C3), or if C3 = 0
/// and C2 >= 0. Else (C3 < 0 above all) the law gives way where W' changes sign.
class Yeoh : public Isochoric<YeohEnergy, QuadraticVolume> {
 public:
  /// @param c1,c2,c3,bulk Pa
  /// @throws std::invalid_argument unless all are finite and the small-strain shear modulus 2 C1 and bulk
  /// positive
  Yeoh(double c1, double c2, double c3, double bulk) : Isochoric({c1, c2, c3}, QuadraticVolume(bulk)) {}
};

}  // namespace softsim
