// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <iostream>
#include <string>
#include <utility>
#include <vector>

#include "softsim/concepts.hpp"
#include "softsim/core/error.hpp"
#include "softsim/kinematics/linear_tetrahedron.hpp"
#include "softsim/mesh/tetrahedral_mesh.hpp"
#include "softsim/potential/elastic.hpp"
#include "softsim/potential/elements.hpp"
#include "softsim/potential/isotropic_blocks.hpp"

namespace softsim {

/// Hyper-elastic mass links (Goulette & Chen 2015): elastic energy V w(I1, I2, J) of a linear tetrahedron
/// straight from its deformed edges e_i = x_i - x_0, without a deformation gradient. The squared lengths of
/// the six edges are the entries of E = e^T e and their sums with them; C enters through E alone:
///   I1 = tr(E G), tr C^2 = tr(E G E G), J = det(e) / (6 V), with the rest metric G_ij = g_i . g_j,
/// which carries vtr and Mtr of the paper in six numbers instead of 6 + 21. Forces on corners 1 to 3 (Table 3
/// and Eq. 29, corrected) are the columns of
///   V e (2 (w1 + w2 I1) G - 2 w2 G E G) + wJ cof(e) / 6.
/// Equal to the finite-element force of `Elastic<LinearTetrahedron, Law>` in exact arithmetic; faster, but it
/// loses digits on slivers and at very small strain (see `edge_condition`), where that route stays, and in
/// single precision on fine meshes, since it works from positions (a force to 1e-4 at 200,000 tetrahedra).
template <class Law>
requires InvariantLaw<Law>
struct Heml {
  static constexpr int points = 4;
  static constexpr bool translation_invariant = true, from_positions = true;
  /// w = a I1 + b(J): but for cof(e) the edges enter the force linearly.
  static constexpr bool simple = !Law::depends_on_i2 && Law::linear_in_i1;

  /// Rest metric g_i . g_j in 1/m^2 (11, 22, 33, 12, 13, 23), volume V in m^3, 1 / (6 V).
  template <class T>
  struct Data {
    std::array<T, 6> metric;
    T volume, inverse_det;
  };

  Law law;

  /// From the rest shape.
  [[nodiscard]] static Data<double> make(const LinearTetrahedron::Data<double>& rest) {
    const auto& g = rest.gradient;
    return {{g[0].dot(g[0]), g[1].dot(g[1]), g[2].dot(g[2]), g[0].dot(g[1]), g[0].dot(g[2]), g[1].dot(g[2])},
            rest.volume,
            1 / (6 * rest.volume)};
  }

  /// V w, J.
  template <class T>
  [[nodiscard]] T energy(const Data<T>& data, const Local<T, 4>& x) const {
    return data.volume * law.density(Shape<T>(data, edges(x)).i);
  }

  /// det F = det(e) / (6 V), the ratio of the volumes.
  template <class T>
  [[nodiscard]] T volume_ratio(const Data<T>& data, const Local<T, 4>& x) const {
    return data.inverse_det * determinant(edges(x));
  }

  /// dW/dx, N.
  template <class T>
  [[nodiscard]] Eigen::Matrix<T, 12, 1> gradient(const Data<T>& data, const Local<T, 4>& x) const {
    const Shape<T> s(data, edges(x));
    const First<T> w = law.first(s.i);
    Mat3<T> f = s.e * s.stress_metric(data, w);
    if constexpr (Law::depends_on_j) {
      const T p = w.wj * T(1.0 / 6);
      f += p * s.c;
    }
    return balanced(f);
  }

  /// What products with one tangent share: the edges, and for w = a I1 + b(J) the factors of cof(e) / 6 and
  /// of its derivative (88 bytes a tetrahedron in double).
  template <class T>
  struct Linearisation {
    Mat3<T> e;
    std::array<T, simple ? 2 : 0> wj;
  };
  template <class T>
  [[nodiscard]] Linearisation<T> linearise(const Data<T>& data, const Local<T, 4>& x) const {
    Linearisation<T> at;
    at.e = edges(x);
    if constexpr (simple) {
      const Shape<T> s(data, at.e);
      at.wj[0] = T(1.0 / 6) * law.first(s.i).wj;
      at.wj[1] = T(1.0 / 6) * law.second(s.i).wjj * data.inverse_det;
    }
    return at;
  }

  /// Derivative of the gradient along dx, N.
  template <class T>
  [[nodiscard]] Eigen::Matrix<T, 12, 1> linearised_product(const Data<T>& data, const Linearisation<T>& at,
                                                           const Eigen::Matrix<T, 12, 1>& dx) const {
    const Mat3<T>& e = at.e;
    Mat3<T> de;
    for (int i = 0; i < 3; ++i) de.col(i) = dx.template segment<3>(3 * i + 3) - dx.template head<3>();
    if constexpr (simple) {
      const T a = T(2) * data.volume * law.first(Invariants<T>{T(3), T(3), T(1)}).w1;
      Mat3<T> df = de * scaled_metric(data, a);
      const Mat3<T> c = cofactor(e);
      const T dp = at.wj[1] * double_dot(c, de);
      df += dp * c;
      df += at.wj[0] * cofactor_differential(e, de);
      return balanced(df);
    } else {
      const Shape<T> s(data, e);
      const First<T> w = law.first(s.i);
      const Second<T> d = law.second(s.i);
      const Mat3<T> ede = e.transpose() * de, dE = ede + ede.transpose();
      const Mat3<T> G = scaled_metric(data, T(1));
      const T d1 = double_dot(G, dE);
      T d2(0), dj(0);
      Mat3<T> Y;
      if constexpr (Law::depends_on_i2) {
        Y = G * s.X;
        d2 = s.i.i1 * d1 - double_dot(Y, dE);
      }
      if constexpr (Law::depends_on_j) dj = data.inverse_det * double_dot(s.c, de);
      const T dw1 = d.w11 * d1 + d.w12 * d2 + d.w1j * dj;
      Mat3<T> df = de * s.stress_metric(data, w);
      if constexpr (Law::depends_on_i2) {
        const T dw2 = d.w12 * d1 + d.w22 * d2 + d.w2j * dj;
        const T da = T(2) * data.volume * (dw1 + dw2 * s.i.i1 + w.w2 * d1), db = T(2) * data.volume * dw2;
        const T b = T(2) * data.volume * w.w2;
        const Mat3<T> GdE = G * dE, dY = GdE * G;
        const Mat3<T> dM = da * G - db * Y - b * dY;
        df += e * dM;
      } else {
        const T da = T(2) * data.volume * dw1;
        const Mat3<T> dM = da * G;
        df += e * dM;
      }
      if constexpr (Law::depends_on_j) {
        const T dp = T(1.0 / 6) * (d.w1j * d1 + d.w2j * d2 + d.wjj * dj), p = T(1.0 / 6) * w.wj;
        df += dp * s.c;
        df += p * cofactor_differential(e, de);
      }
      return balanced(df);
    }
  }
  /// Derivative of the gradient along dx at x, N.
  template <class T>
  [[nodiscard]] Eigen::Matrix<T, 12, 1> hessian_product(const Data<T>& data, const Local<T, 4>& x,
                                                        const Eigen::Matrix<T, 12, 1>& dx) const {
    return linearised_product(data, linearise(data, x), dx);
  }

  /// What the blocks of the Hessian are made of.
  template <class T>
  [[nodiscard]] IsotropicBlocks<Law, T> block_form(const Data<T>& data, const Local<T, 4>& x) const {
    const Mat3<T> e = edges(x), G = scaled_metric(data, T(1)), a = e * G, c = cofactor(e);
    IsotropicBlocks<Law, T> form;
    form.G = data.metric;
    form.volume = data.volume;
    for (int i = 0; i < 3; ++i) {
      const auto k = static_cast<std::size_t>(i);
      form.a[k] = a.col(i);
      form.c[k] = data.inverse_det * c.col(i);
      form.s[k] = data.inverse_det * e.col(i);
    }
    if constexpr (!simple) form.B = a * e.transpose();
    form.set(law, data.inverse_det * e.col(0).dot(c.col(0)));
    return form;
  }
  /// Block (i, j) of the Hessian, N/m.
  template <int i, int j, class T>
  [[nodiscard]] Mat3<T> hessian_block(const IsotropicBlocks<Law, T>& form) const {
    return form.template block<i, j>();
  }

 private:
  template <class T>
  static Mat3<T> edges(const Local<T, 4>& x) {
    Mat3<T> e;
    for (int i = 0; i < 3; ++i) e.col(i) = x.points[static_cast<std::size_t>(i) + 1] - x.points[0];
    return e;
  }
  template <class T>
  static Mat3<T> scaled_metric(const Data<T>& data, const T& a) {
    const auto& g = data.metric;
    const T g00 = a * g[0], g11 = a * g[1], g22 = a * g[2], g01 = a * g[3], g02 = a * g[4], g12 = a * g[5];
    Mat3<T> G;
    G << g00, g01, g02, g01, g11, g12, g02, g12, g22;
    return G;
  }
  template <class T>
  static Eigen::Matrix<T, 12, 1> balanced(const Mat3<T>& f) {
    Eigen::Matrix<T, 12, 1> all;
    for (int i = 0; i < 3; ++i) all.template segment<3>(3 * i + 3) = f.col(i);
    all.template head<3>() = -(f.col(0) + f.col(1) + f.col(2));
    return all;
  }

  // What the law needs to know of the deformed edges. What it does not use is not computed.
  template <class T>
  struct Shape {
    Mat3<T> e, c, X;  // edges, their cofactors, X = E G
    Invariants<T> i;

    Shape(const Data<T>& data, const Mat3<T>& edges_) : e(edges_), i{T(3), T(3), T(1)} {
      T i1(3), i2(3), j(1);
      if constexpr (Law::depends_on_i2) {
        const Mat3<T> E = e.transpose() * e;
        X = E * scaled_metric(data, T(1));
        i1 = trace(X);
        const T square = X(0, 0) * X(0, 0) + X(1, 1) * X(1, 1) + X(2, 2) * X(2, 2) +
                         T(2) * (X(0, 1) * X(1, 0) + X(0, 2) * X(2, 0) + X(1, 2) * X(2, 1));
        i2 = T(0.5) * (i1 * i1 - square);
      } else {
        const auto& g = data.metric;
        i1 = g[0] * e.col(0).dot(e.col(0)) + g[1] * e.col(1).dot(e.col(1)) + g[2] * e.col(2).dot(e.col(2)) +
             T(2) * (g[3] * e.col(0).dot(e.col(1)) + g[4] * e.col(0).dot(e.col(2)) +
                     g[5] * e.col(1).dot(e.col(2)));
      }
      if constexpr (Law::depends_on_j) {
        c = cofactor(e);
        j = data.inverse_det * e.col(0).dot(c.col(0));
      }
      i = Invariants<T>{i1, i2, j};
    }

    // V (2 (w1 + w2 I1) G - 2 w2 G E G)
    [[nodiscard]] Mat3<T> stress_metric(const Data<T>& data, const First<T>& w) const {
      if constexpr (Law::depends_on_i2) {
        const T a = T(2) * data.volume * (w.w1 + w.w2 * i.i1), b = T(2) * data.volume * w.w2;
        const auto& g = data.metric;
        const auto entry = [&](int q, std::size_t k, const T& x, const T& y, const T& z) {
          return a * g[k] - b * (x * X(0, q) + y * X(1, q) + z * X(2, q));
        };
        Mat3<T> M;
        M(0, 0) = entry(0, 0, g[0], g[3], g[4]);
        M(1, 1) = entry(1, 1, g[3], g[1], g[5]);
        M(2, 2) = entry(2, 2, g[4], g[5], g[2]);
        M(0, 1) = M(1, 0) = entry(1, 3, g[0], g[3], g[4]);
        M(0, 2) = M(2, 0) = entry(2, 4, g[0], g[3], g[4]);
        M(1, 2) = M(2, 1) = entry(2, 5, g[3], g[1], g[5]);
        return M;
      } else {
        return scaled_metric(data, T(T(2) * data.volume * w.w1));
      }
    }
  };
};

/// Condition kappa of the edge form on one tetrahedron: longest edge times largest gradient of a shape
/// function, about the ratio of its longest edge to its smallest height. The error of a force in it is at
/// most about 1e-15 kappa^2 V (lambda + 2 mu) max|g_i|.
[[nodiscard]] inline double edge_condition(const std::array<Vec3<double>, 4>& X) {
  const auto rest = LinearTetrahedron::make(X);
  double edge = 0;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < i; ++j) edge = std::max(edge, (X[i] - X[j]).norm());
  double gradient = (rest.gradient[0] + rest.gradient[1] + rest.gradient[2]).norm();
  for (const Vec3<double>& g : rest.gradient) gradient = std::max(gradient, g.norm());
  return edge * gradient;
}

/// Elastic energy of a tetrahedral mesh from edge lengths.
template <class Law, class T = double, int N = default_lanes<T>>
using HemlTetrahedra = Elements<Heml<Law>, T, N>;

/// Takes the one sentence of a warning at set-up.
using Warn = std::function<void(const std::string&)>;
/// Writes a warning to the standard error stream.
inline void warn_on_stderr(const std::string& sentence) { std::cerr << sentence << '\n'; }

/// Elastic energy of `mesh` from edge lengths, with one of `laws` per tetrahedron; `law_index` chooses it and
/// may be empty if there is one law only. A law that is not one of the invariants (principal stretches,
/// fibres, psi(F) alone) has no edge form here: it gets `elastic`, with the same result.
/// @param warn hears of tetrahedra whose `edge_condition` is above 100, for which `elastic` keeps more digits
/// @throws std::invalid_argument for an index out of range or a list of the wrong length
template <class T = double, int N = default_lanes<T>, class Law>
[[nodiscard]] auto heml(const TetrahedralMesh& mesh, const std::vector<Law>& laws,
                        const std::vector<std::int32_t>& law_index = {}, const Warn& warn = warn_on_stderr) {
  if constexpr (!InvariantLaw<Law> || !InvariantLaw<Law, Lanes<T, N>>) {
    return elastic<T, N>(mesh, laws, law_index);
  } else {
    if (laws.empty()) invalid("heml: no law");
    if (law_index.empty() && laws.size() > 1)
      invalid(std::string("heml: ") + std::to_string(laws.size()) + " laws need an index per tetrahedron");
    std::vector<typename Heml<Law>::template Data<double>> data;
    data.reserve(mesh.tetrahedra().size());
    double worst = 0;
    std::size_t worst_at = 0, above = 0;
    for (const Tetrahedron& v : mesh.tetrahedra()) {
      std::array<Vec3<double>, 4> X;
      for (std::size_t i = 0; i < 4; ++i) X[i] = mesh.points()[static_cast<std::size_t>(v[i])];
      const double kappa = edge_condition(X);
      if (kappa > 100) ++above;
      if (kappa > worst) {
        worst = kappa;
        worst_at = data.size();
      }
      data.push_back(Heml<Law>::make(LinearTetrahedron::make(X)));
    }
    if (above > 0 && warn)
      warn(std::string("heml: ") + std::to_string(above) + " of " + std::to_string(data.size()) +
           " tetrahedra are slivers (worst: " + std::to_string(worst_at) + ", longest edge over height " +
           to_text(worst) + " > 100) and lose digits in edge lengths; elastic() keeps them");
    std::vector<Heml<Law>> models;
    for (const Law& law : laws) models.push_back({law});
    return HemlTetrahedra<Law, T, N>(std::move(models), data, mesh.tetrahedra(), law_index, mesh.points());
  }
}

/// Elastic energy of `mesh` made of one law, from edge lengths.
template <class T = double, int N = default_lanes<T>, class Law>
requires Material<Law>
[[nodiscard]] auto heml(const TetrahedralMesh& mesh, const Law& law, const Warn& warn = warn_on_stderr) {
  return heml<T, N>(mesh, std::vector<Law>{law}, {}, warn);
}

}  // namespace softsim
