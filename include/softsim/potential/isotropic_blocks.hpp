// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>

#include "softsim/concepts.hpp"
#include "softsim/core/tensor.hpp"

namespace softsim {

/// Blocks of the Hessian of V w(I1, I2, J) on a linear tetrahedron in closed form, the same for every route
/// to it. With g_i the rest gradient of shape function i, i = 1..3:
///   a_i = F g_i, c_i = cof(F) g_i, m_i = I1 a_i - F C g_i, B = F F^T, G_ij = g_i . g_j, s_ij = F (g_i x
///   g_j), K_ij / V = 2 w1 G_ij I + 2 w2 ((I1 G_ij - a_i . a_j) I + 2 a_i a_j^T - a_j a_i^T - G_ij B) - wJ
///   [s_ij]x
///            + 4 w11 a_i a_j^T + 4 w12 (a_i m_j^T + m_i a_j^T) + 4 w22 m_i m_j^T
///            + 2 w1J (a_i c_j^T + c_i a_j^T) + 2 w2J (m_i c_j^T + c_i m_j^T) + wJJ c_i c_j^T.
template <class Law, class T>
struct IsotropicBlocks {
  std::array<Vec3<T>, 3> a, c, m;
  std::array<Vec3<T>, 3> s;  ///< s_23, s_31, s_12, 1/m
  std::array<T, 6> G;        ///< 11, 22, 33, 12, 13, 23, 1/m^2
  Mat3<T> B;
  T i1, volume;
  First<T> w;
  Second<T> d;

  /// Fills in the law's part. @param j det F
  void set(const Law& law, const T& j) {
    T k2(0);
    i1 = T(0);
    if constexpr (Law::depends_on_i2 || !Law::linear_in_i1) {
      i1 = trace(B);
      if constexpr (Law::depends_on_i2) {
        k2 = T(0.5) * (i1 * i1 - double_dot(B, B));
        for (std::size_t i = 0; i < 3; ++i) m[i] = i1 * a[i] - B * a[i];
      }
    }
    const Invariants<T> i{i1, k2, j};
    w = law.first(i);
    d = law.second(i);
  }

  /// K_ij, N/m, for 1 <= i <= j <= 3.
  template <int i, int j>
  [[nodiscard]] Mat3<T> block() const {
    constexpr std::size_t p = i - 1, q = j - 1;
    const T& g = G[p == q ? p : p + q + 2];
    Mat3<T> K;
    const T along = T(2) * volume * w.w1 * g;
    // One row factor for every column vector: K = a_i (..)^T + c_i (..)^T + m_i (..)^T.
    if constexpr (Law::depends_on_i2) {
      const T two = T(2) * volume * w.w2;
      const T diagonal = along + two * (i1 * g - a[p].dot(a[q]));
      const Vec3<T> ra =
          volume * (T(4) * w.w2 * a[q] + T(4) * (d.w11 * a[q] + d.w12 * m[q]) + j_part(T(2) * d.w1j, c[q]));
      const Vec3<T> rm = volume * (T(4) * (d.w12 * a[q] + d.w22 * m[q]) + j_part(T(2) * d.w2j, c[q]));
      const Vec3<T> sa = two * a[p];
      const T gB = two * g;
      K = a[p] * ra.transpose() + m[p] * rm.transpose() - a[q] * sa.transpose() - gB * B;
      K.diagonal().array() += diagonal;
      if constexpr (Law::depends_on_j) {
        const Vec3<T> rc = volume * (T(2) * d.w1j * a[q] + T(2) * d.w2j * m[q] + d.wjj * c[q]);
        K += c[p] * rc.transpose();
      }
    } else {
      if constexpr (Law::linear_in_i1) {
        const Vec3<T> rc = (volume * d.wjj) * c[q];
        K = c[p] * rc.transpose();
      } else {
        const Vec3<T> ra = volume * (T(4) * d.w11 * a[q] + j_part(T(2) * d.w1j, c[q]));
        K = a[p] * ra.transpose();
        if constexpr (Law::depends_on_j) {
          const Vec3<T> rc = volume * (T(2) * d.w1j * a[q] + d.wjj * c[q]);
          K += c[p] * rc.transpose();
        }
      }
      K.diagonal().array() += along;
    }
    if constexpr (Law::depends_on_j && p != q) {
      constexpr std::size_t third = 3 - p - q;
      constexpr bool cyclic = (p + 1) % 3 == q;  // else s_ij = -s_ji
      const T v = cyclic ? T(volume * w.wj) : T(-(volume * w.wj));
      const Vec3<T> t = v * s[third];
      K(0, 1) += t[2];
      K(1, 0) -= t[2];
      K(1, 2) += t[0];
      K(2, 1) -= t[0];
      K(2, 0) += t[1];
      K(0, 2) -= t[1];
    }
    return K;
  }

 private:
  static Vec3<T> j_part(const T& factor, const Vec3<T>& v) {
    if constexpr (Law::depends_on_j)
      return factor * v;
    else
      return Vec3<T>(T(0), T(0), T(0));
  }
};

}  // namespace softsim
