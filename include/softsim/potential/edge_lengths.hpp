// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>

#include "softsim/concepts.hpp"
#include "softsim/core/tensor.hpp"
#include "softsim/kinematics/linear_tetrahedron.hpp"

namespace softsim {

/// Hyper-elastic mass links in the paper's own variables: the six squared edge lengths l of a tetrahedron, of
/// which C = sum_k l_k C_k is a linear function (Goulette & Chen 2015, Appendices A to C):
///   I1 = vtr . l, I2 = ((vtr . l)^2 - l . Mtr l) / 2, s = dw/dl = w1 vtr + w2 (I1 vtr - Mtr l),
/// and the force on a corner is the sum of 2 V s_k v_k over its edges v_k, with the volume's share (Table 3
/// and Eq. 29, corrected: the factor 2 of Saint Venant-Kirchhoff and of dI2/dl, the force on corner 0). It is
/// here to be read, checked and counted; `Heml` computes the same with fewer operations and a quarter of the
/// data.
///   v_1 = x_1 - x_0, v_2 = x_2 - x_0, v_3 = x_3 - x_0, v_4 = x_2 - x_1, v_5 = x_3 - x_2, v_6 = x_1 - x_3.
template <class Law>
requires InvariantLaw<Law>
struct EdgeLengths {
  static constexpr int points = 4;
  static constexpr bool translation_invariant = true, from_positions = true;

  /// vtr_k = tr C_k and Mtr_kl = tr(C_k C_l) (upper triangle, row by row), 1/m^2 and 1/m^4; volume V in m^3
  /// and 1/(6 V).
  template <class T>
  struct Data {
    std::array<T, 6> vtr;
    std::array<T, 21> Mtr;
    T volume, inverse_det;
  };

  Law law;

  /// C_k = V^-T D_k V^-1, k = 0..5, with V the matrix of rest edges (Eqs. A.5, A.6).
  [[nodiscard]] static std::array<Mat3<double>, 6> strain_of_length(
      const LinearTetrahedron::Data<double>& rest) {
    const auto& g = rest.gradient;  // rows of V^-1
    const auto twice = [&](std::size_t i, std::size_t j) {
      return Mat3<double>(g[i] * g[j].transpose() + g[j] * g[i].transpose());
    };
    std::array<Mat3<double>, 6> C;
    C[3] = -0.5 * twice(0, 1);
    C[4] = -0.5 * twice(1, 2);
    C[5] = -0.5 * twice(2, 0);
    C[0] = g[0] * g[0].transpose() - C[3] - C[5];
    C[1] = g[1] * g[1].transpose() - C[3] - C[4];
    C[2] = g[2] * g[2].transpose() - C[4] - C[5];
    return C;
  }

  /// From the rest shape.
  [[nodiscard]] static Data<double> make(const LinearTetrahedron::Data<double>& rest) {
    const std::array<Mat3<double>, 6> C = strain_of_length(rest);
    Data<double> data;
    std::size_t n = 0;
    for (std::size_t k = 0; k < 6; ++k) {
      data.vtr[k] = C[k].trace();
      for (std::size_t l = k; l < 6; ++l) data.Mtr[n++] = double_dot(C[k], C[l]);
    }
    data.volume = rest.volume;
    data.inverse_det = 1 / (6 * rest.volume);
    return data;
  }

  /// V w, J.
  template <class T>
  [[nodiscard]] T energy(const Data<T>& data, const Local<T, 4>& x) const {
    return data.volume * law.density(Shape<T>(data, x).i);
  }

  /// dW/dx, N.
  template <class T>
  [[nodiscard]] Eigen::Matrix<T, 12, 1> gradient(const Data<T>& data, const Local<T, 4>& x) const {
    const Shape<T> shape(data, x);
    const First<T> w = law.first(shape.i);
    std::array<T, 6> s;
    for (std::size_t k = 0; k < 6; ++k) {
      s[k] = w.w1 * data.vtr[k];
      if constexpr (Law::depends_on_i2) s[k] += w.w2 * shape.r[k];
    }
    Eigen::Matrix<T, 12, 1> f = T(2) * data.volume * along_edges(s, shape.v);
    if constexpr (Law::depends_on_j) {
      const T p = w.wj * T(1.0 / 6);
      f += p * shape.cofactors();
    }
    return f;
  }

  /// Derivative of the gradient along dx, N.
  template <class T>
  [[nodiscard]] Eigen::Matrix<T, 12, 1> hessian_product(const Data<T>& data, const Local<T, 4>& x,
                                                        const Eigen::Matrix<T, 12, 1>& dx) const {
    const Shape<T> shape(data, x);
    Local<T, 4> d;
    for (std::size_t i = 0; i < 4; ++i) d.points[i] = dx.template segment<3>(3 * static_cast<int>(i));
    const std::array<Vec3<T>, 6> dv = edges(d);
    const First<T> w = law.first(shape.i);
    const Second<T> h = law.second(shape.i);
    std::array<T, 6> dl;
    T d1(0), d2(0), dj(0);
    for (std::size_t k = 0; k < 6; ++k) {
      dl[k] = T(2) * shape.v[k].dot(dv[k]);
      d1 += data.vtr[k] * dl[k];
      if constexpr (Law::depends_on_i2) d2 += shape.r[k] * dl[k];
    }
    if constexpr (Law::depends_on_j) dj = data.inverse_det * shape.cofactors().dot(dx);
    const T dw1 = h.w11 * d1 + h.w12 * d2 + h.w1j * dj, dw2 = h.w12 * d1 + h.w22 * d2 + h.w2j * dj;
    const std::array<T, 6> Mdl = Law::depends_on_i2 ? times_mtr(data, dl) : dl;
    std::array<T, 6> s, ds;
    for (std::size_t k = 0; k < 6; ++k) {
      s[k] = w.w1 * data.vtr[k];
      ds[k] = dw1 * data.vtr[k];
      if constexpr (Law::depends_on_i2) {
        s[k] += w.w2 * shape.r[k];
        ds[k] += dw2 * shape.r[k] + w.w2 * (d1 * data.vtr[k] - Mdl[k]);
      }
    }
    Eigen::Matrix<T, 12, 1> df = along_edges(ds, shape.v) + along_edges(s, dv);
    df *= T(2) * data.volume;
    if constexpr (Law::depends_on_j) {
      const T dp = (h.w1j * d1 + h.w2j * d2 + h.wjj * dj) * T(1.0 / 6), p = w.wj * T(1.0 / 6);
      df += dp * shape.cofactors();
      Mat3<T> e, de;
      for (int i = 0; i < 3; ++i) {
        e.col(i) = shape.v[static_cast<std::size_t>(i)];
        de.col(i) = dv[static_cast<std::size_t>(i)];
      }
      df += p * on_corners(cofactor_differential(e, de));
    }
    return df;
  }

 private:
  template <class T>
  static std::array<Vec3<T>, 6> edges(const Local<T, 4>& x) {
    const auto& p = x.points;
    return {p[1] - p[0], p[2] - p[0], p[3] - p[0], p[2] - p[1], p[3] - p[2], p[1] - p[3]};
  }
  // sum_k s_k dl_k/dx / 2 (Appendix B).
  template <class T>
  static Eigen::Matrix<T, 12, 1> along_edges(const std::array<T, 6>& s, const std::array<Vec3<T>, 6>& v) {
    Eigen::Matrix<T, 12, 1> f;
    f.template segment<3>(0) = -(s[0] * v[0] + s[1] * v[1] + s[2] * v[2]);
    f.template segment<3>(3) = s[0] * v[0] - s[3] * v[3] + s[5] * v[5];
    f.template segment<3>(6) = s[1] * v[1] + s[3] * v[3] - s[4] * v[4];
    f.template segment<3>(9) = s[2] * v[2] + s[4] * v[4] - s[5] * v[5];
    return f;
  }
  template <class T>
  static Eigen::Matrix<T, 12, 1> on_corners(const Mat3<T>& c) {
    Eigen::Matrix<T, 12, 1> f;
    for (int i = 0; i < 3; ++i) f.template segment<3>(3 * i + 3) = c.col(i);
    f.template head<3>() = -(c.col(0) + c.col(1) + c.col(2));
    return f;
  }
  template <class T>
  static std::array<T, 6> times_mtr(const Data<T>& data, const std::array<T, 6>& l) {
    std::array<T, 6> y{T(0), T(0), T(0), T(0), T(0), T(0)};
    std::size_t n = 0;
    for (std::size_t k = 0; k < 6; ++k) {
      y[k] += data.Mtr[n++] * l[k];
      for (std::size_t m = k + 1; m < 6; ++m, ++n) {
        y[k] += data.Mtr[n] * l[m];
        y[m] += data.Mtr[n] * l[k];
      }
    }
    return y;
  }

  template <class T>
  struct Shape {
    std::array<Vec3<T>, 6> v;
    std::array<T, 6> r;  // dI2/dl
    Invariants<T> i;

    Shape(const Data<T>& data, const Local<T, 4>& x) : v(edges(x)), i{T(3), T(3), T(1)} {
      std::array<T, 6> l;
      T i1(0), i2(3), j(1);
      for (std::size_t k = 0; k < 6; ++k) {
        l[k] = v[k].dot(v[k]);
        i1 += data.vtr[k] * l[k];
      }
      if constexpr (Law::depends_on_i2) {
        const std::array<T, 6> Ml = times_mtr(data, l);
        i2 = T(0);
        for (std::size_t k = 0; k < 6; ++k) {
          r[k] = i1 * data.vtr[k] - Ml[k];
          i2 += r[k] * l[k];
        }
        i2 *= T(0.5);
      }
      if constexpr (Law::depends_on_j) j = data.inverse_det * v[0].dot(v[1].cross(v[2]));
      i = Invariants<T>{i1, i2, j};
    }
    // 6 dV/dx (Eq. C.4).
    [[nodiscard]] Eigen::Matrix<T, 12, 1> cofactors() const {
      Mat3<T> c;
      c.col(0) = v[1].cross(v[2]);
      c.col(1) = v[2].cross(v[0]);
      c.col(2) = v[0].cross(v[1]);
      return on_corners(c);
    }
  };
};

}  // namespace softsim
