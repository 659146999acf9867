// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include "softsim/material/isotropic.hpp"
#include "softsim/material/lame.hpp"

namespace softsim {

/// St. Venant-Kirchhoff: psi = lambda/2 tr(E)^2 + mu tr(E^2), E = (C - I)/2, that is
/// w = mu/4 (I1^2 - 2 I2 - 2 I1 + 3) + lambda/8 (I1 - 3)^2 (Goulette & Chen 2015, Table 1; below in I1 - 3
/// and I2 - 3). Defined for every F. It softens in compression (below a uniaxial stretch of 1/sqrt(3) at free
/// sides) and does not resist inversion: use it for large rotations at moderate strain.
class StVenantKirchhoff : public Isotropic<StVenantKirchhoff>, public LameLaw<StVenantKirchhoff> {
 public:
  static constexpr bool depends_on_j = false;

  /// w, J/m^3.
  template <class T>
  [[nodiscard]] T density(const Invariants<T>& i) const {
    return T(mu() / 4) * (i.k1 * i.k1 + T(2) * (T(2) * i.k1 - i.k2)) + T(lambda() / 8) * i.k1 * i.k1;
  }
  /// First derivatives of w, Pa.
  template <class T>
  [[nodiscard]] First<T> first(const Invariants<T>& i) const {
    return {T(mu() / 2) * (i.i1 - T(1)) + T(lambda() / 4) * (i.i1 - T(3)), T(-mu() / 2), T(0)};
  }
  /// Second derivatives of w, Pa.
  template <class T>
  [[nodiscard]] Second<T> second(const Invariants<T>&) const {
    return {T(mu() / 2 + lambda() / 4), T(0), T(0), T(0), T(0), T(0)};
  }

 private:
  friend LameLaw<StVenantKirchhoff>;
  explicit StVenantKirchhoff(Lame lame) : LameLaw(lame) {}
};

}  // namespace softsim
