// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "softsim/core/error.hpp"
#include "softsim/core/tensor.hpp"

namespace softsim {

/// A rod of rigid sections along the unit vector a: psi = E/2 e^2 + G/2 (g_1^2 + g_2^2), with the Green
/// strain e = (|F a|^2 - 1)/2 of the fibres and the shears g = a . C b against the two axes b of the section
/// (C = F^T F). What is left of St. Venant-Kirchhoff where sections cannot strain. For a single row of frames
/// (`sample_curve`), whose blend shrinks the sections between two frames by cos(theta/2) as they turn by
/// theta: an isotropic law takes that for strain and makes a rod of height t, with frames at a distance h,
/// stiffer in bending by about 3/8 (h/t)^2 theta^2. a differs from sample to sample: models `MaterialField`.
class Rod {
 public:
  /// Direction of the rod in the rest shape, of length 1.
  template <class T>
  struct Data {
    Vec3<T> a;
  };

  /// @param E Young's modulus, Pa
  /// @param G shear modulus, Pa
  /// @throws std::invalid_argument unless both are positive and finite
  Rod(double E, double G) : E_(E), G_(G) {
    for (const double modulus : {E, G})
      if (!(modulus > 0) || !(modulus <= 1e300))
        invalid(std::string("rod: modulus ") + to_text(modulus) + " Pa: must be positive and finite");
  }

  /// The law at one sample: a `Material`.
  template <class T>
  class Bound {
   public:
    Bound(double E, double G, const Vec3<T>& a) : E_(T(E)), G_(T(G)), a_(a) {}

    /// psi(F), J/m^3.
    [[nodiscard]] T energy_density(const Mat3<T>& F) const {
      const Stretch s(F, a_);
      return T(0.5) * (E_ * s.e * s.e + G_ * (s.c.dot(s.c) - s.caa * s.caa));
    }
    /// P = (E e f + G (F c - 2 (a . c) f)) a^T + G f c^T with f = F a, c = F^T f, Pa.
    [[nodiscard]] Mat3<T> first_piola(const Mat3<T>& F) const {
      const Stretch s(F, a_);
      const Vec3<T> along = (E_ * s.e - T(2) * G_ * s.caa) * s.f + G_ * (F * s.c), across = G_ * s.f;
      return along * a_.transpose() + across * s.c.transpose();
    }
    /// dP(F; dF), Pa.
    [[nodiscard]] Mat3<T> first_piola_differential(const Mat3<T>& F, const Mat3<T>& dF) const {
      const Stretch s(F, a_);
      const Vec3<T> df = dF * a_, dc = dF.transpose() * s.f + F.transpose() * df;
      const T de = s.f.dot(df);
      const Vec3<T> along =
          (E_ * de - T(4) * G_ * de) * s.f + (E_ * s.e - T(2) * G_ * s.caa) * df + G_ * (dF * s.c + F * dc);
      const Vec3<T> across = G_ * df, as_before = G_ * s.f;
      return along * a_.transpose() + across * s.c.transpose() + as_before * dc.transpose();
    }

   private:
    struct Stretch {
      Vec3<T> f, c;
      T caa, e;
      Stretch(const Mat3<T>& F, const Vec3<T>& a)
          : f(F * a), c(F.transpose() * f), caa(f.dot(f)), e(T(0.5) * (caa - T(1))) {}
    };

    T E_, G_;
    Vec3<T> a_;
  };
  /// The law of a rod along data.a.
  template <class T>
  [[nodiscard]] Bound<T> at(const Data<T>& data) const {
    return {E_, G_, data.a};
  }

 private:
  double E_, G_;
};

}  // namespace softsim
