// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common.hpp"

// What a careful programmer writes in an afternoon: Eigen's 3x3 matrices, textbook formulas, one tetrahedron
// at a time. It shares nothing with the library but the mesh; every benchmark's result is held against it.

namespace bench {

template <class Law>
struct ReferenceLaw;

template <>
struct ReferenceLaw<StVenantKirchhoff> {
  template <class T>
  static T energy(const Mat3<T>& F, T lambda, T mu) {
    const Mat3<T> E = T(0.5) * (F.transpose() * F - Mat3<T>::Identity());
    return mu * E.squaredNorm() + lambda / 2 * E.trace() * E.trace();
  }
  template <class T>
  static Mat3<T> stress(const Mat3<T>& F, T lambda, T mu) {
    const Mat3<T> E = T(0.5) * (F.transpose() * F - Mat3<T>::Identity());
    return F * (2 * mu * E + lambda * E.trace() * Mat3<T>::Identity());
  }
  template <class T>
  static Mat3<T> differential(const Mat3<T>& F, const Mat3<T>& dF, T lambda, T mu) {
    const Mat3<T> E = T(0.5) * (F.transpose() * F - Mat3<T>::Identity());
    const Mat3<T> dE = T(0.5) * (dF.transpose() * F + F.transpose() * dF);
    return dF * (2 * mu * E + lambda * E.trace() * Mat3<T>::Identity()) +
           F * (2 * mu * dE + lambda * dE.trace() * Mat3<T>::Identity());
  }
};

template <>
struct ReferenceLaw<NeoHookean> {
  template <class T>
  static T energy(const Mat3<T>& F, T lambda, T mu) {
    const T l = std::log(F.determinant());
    return mu / 2 * (F.squaredNorm() - 3) - mu * l + lambda / 2 * l * l;
  }
  template <class T>
  static Mat3<T> stress(const Mat3<T>& F, T lambda, T mu) {
    const Mat3<T> R = F.inverse().transpose();
    return mu * (F - R) + lambda * std::log(F.determinant()) * R;
  }
  template <class T>
  static Mat3<T> differential(const Mat3<T>& F, const Mat3<T>& dF, T lambda, T mu) {
    const Mat3<T> inverse = F.inverse(), R = inverse.transpose();
    return mu * dF + (mu - lambda * std::log(F.determinant())) * R * dF.transpose() * R +
           lambda * (inverse * dF).trace() * R;
  }
};

template <>
struct ReferenceLaw<StableNeoHookean> {
  template <class T>
  static T energy(const Mat3<T>& F, T lambda, T mu) {
    const T k = F.determinant() - 1;
    return mu / 2 * (F.squaredNorm() - 3) - mu * k + (lambda + mu) / 2 * k * k;
  }
  template <class T>
  static Mat3<T> stress(const Mat3<T>& F, T lambda, T mu) {
    const T J = F.determinant();
    const Mat3<T> R = F.inverse().transpose();
    return mu * F + ((lambda + mu) * (J - 1) - mu) * J * R;
  }
  template <class T>
  static Mat3<T> differential(const Mat3<T>& F, const Mat3<T>& dF, T lambda, T mu) {
    const T J = F.determinant();
    const Mat3<T> inverse = F.inverse(), R = inverse.transpose();
    const T t = (inverse * dF).trace();
    return mu * dF + (lambda + mu) * J * t * J * R +
           ((lambda + mu) * (J - 1) - mu) * J * (t * R - R * dF.transpose() * R);
  }
};

template <>
struct ReferenceLaw<MooneyRivlin> {
  template <class T>
  static T energy(const Mat3<T>& F, T lambda, T mu) {
    const auto [c1, c2, bulk] = parameters(lambda, mu);
    const Mat3<T> C = F.transpose() * F;
    const T J = F.determinant(), i1 = C.trace(), i2 = (i1 * i1 - C.squaredNorm()) / 2;
    return c1 * (i1 * std::pow(J, T(-2) / 3) - 3) + c2 * (i2 * std::pow(J, T(-4) / 3) - 3) +
           bulk / 2 * (J - 1) * (J - 1);
  }
  template <class T>
  static Mat3<T> stress(const Mat3<T>& F, T lambda, T mu) {
    const auto [c1, c2, bulk] = parameters(lambda, mu);
    const Mat3<T> C = F.transpose() * F, R = F.inverse().transpose();
    const T J = F.determinant(), i1 = C.trace(), i2 = (i1 * i1 - C.squaredNorm()) / 2;
    return 2 * c1 * std::pow(J, T(-2) / 3) * (F - i1 / 3 * R) +
           2 * c2 * std::pow(J, T(-4) / 3) * (i1 * F - F * C - 2 * i2 / 3 * R) + bulk * (J - 1) * J * R;
  }
  template <class T>
  static Mat3<T> differential(const Mat3<T>& F, const Mat3<T>& dF, T lambda, T mu) {
    const auto [c1, c2, bulk] = parameters(lambda, mu);
    const Mat3<T> C = F.transpose() * F, dC = F.transpose() * dF + dF.transpose() * F;
    const Mat3<T> inverse = F.inverse(), R = inverse.transpose(), dR = -R * dF.transpose() * R;
    const T J = F.determinant(), t = (inverse * dF).trace();  // dJ = J t
    const T i1 = C.trace(), i2 = (i1 * i1 - C.squaredNorm()) / 2;
    const T d1 = dC.trace(), d2 = i1 * d1 - (C * dC).trace();
    const T p = 2 * c1 * std::pow(J, T(-2) / 3), q = 2 * c2 * std::pow(J, T(-4) / 3);
    return p * (-2 * t / 3 * (F - i1 / 3 * R) + dF - d1 / 3 * R - i1 / 3 * dR) +
           q * (-4 * t / 3 * (i1 * F - F * C - 2 * i2 / 3 * R) + d1 * F + i1 * dF - dF * C - F * dC -
                2 * d2 / 3 * R - 2 * i2 / 3 * dR) +
           bulk * ((2 * J - 1) * J * t * R + (J - 1) * J * dR);
  }

 private:
  template <class T>
  static std::array<T, 3> parameters(T lambda, T mu) {
    const T c1 = mu / (2 * (1 + T(c2_over_c1)));
    return {c1, T(c2_over_c1) * c1, lambda + 2 * mu / 3};
  }
};

template <>
struct ReferenceLaw<LinearElastic> {
  template <class T>
  static T energy(const Mat3<T>& F, T lambda, T mu) {
    const Mat3<T> eps = T(0.5) * (F + F.transpose()) - Mat3<T>::Identity();
    return mu * eps.squaredNorm() + lambda / 2 * eps.trace() * eps.trace();
  }
  template <class T>
  static Mat3<T> stress(const Mat3<T>& F, T lambda, T mu) {
    const Mat3<T> eps = T(0.5) * (F + F.transpose()) - Mat3<T>::Identity();
    return 2 * mu * eps + lambda * eps.trace() * Mat3<T>::Identity();
  }
  template <class T>
  static Mat3<T> differential(const Mat3<T>&, const Mat3<T>& dF, T lambda, T mu) {
    return mu * (dF + dF.transpose()) + lambda * dF.trace() * Mat3<T>::Identity();
  }
};

/// A mesh of one material. Vectors hold three scalars a node; x are deformed positions.
template <class Law, class T>
class ReferenceBody {
 public:
  ReferenceBody(const TetrahedralMesh& mesh, const Law& law)
      : lambda_(static_cast<T>(law.lambda())), mu_(static_cast<T>(law.mu())) {
    for (const Tetrahedron& v : mesh.tetrahedra()) {
      Mat3<double> edges;
      for (int i = 0; i < 3; ++i)
        edges.col(i) = mesh.points()[static_cast<std::size_t>(v[static_cast<std::size_t>(i) + 1])] -
                       mesh.points()[static_cast<std::size_t>(v[0])];
      elements_.push_back({v, edges.inverse().cast<T>(), static_cast<T>(edges.determinant() / 6)});
    }
  }

  /// Elastic energy, J.
  double energy(const Vector<T>& x) const {
    double sum = 0;
    for (const Element& e : elements_)
      sum +=
          static_cast<double>(e.volume * ReferenceLaw<Law>::template energy<T>(gradient(e, x), lambda_, mu_));
    return sum;
  }
  /// y = its gradient: minus the force, N.
  void force(const Vector<T>& x, Vector<T>& y) const {
    y.setZero();
    for (const Element& e : elements_)
      add(e, ReferenceLaw<Law>::template stress<T>(gradient(e, x), lambda_, mu_), y);
  }
  /// y = K(x) d.
  void product(const Vector<T>& x, const Vector<T>& d, Vector<T>& y) const {
    y.setZero();
    for (const Element& e : elements_)
      add(e, ReferenceLaw<Law>::template differential<T>(gradient(e, x), gradient(e, d), lambda_, mu_), y);
  }
  /// Diagonal 3x3 blocks of K(x).
  std::vector<Mat3<T>> diagonal_blocks(const Vector<T>& x) const {
    std::vector<Mat3<T>> blocks(static_cast<std::size_t>(x.size() / 3), Mat3<T>::Zero());
    for (const Element& e : elements_) {
      const Mat3<T> F = gradient(e, x);
      for (int i = 0; i < 4; ++i) {
        const Vec3<T> g = i == 0 ? Vec3<T>(-e.inverse.colwise().sum()) : Vec3<T>(e.inverse.row(i - 1));
        for (int a = 0; a < 3; ++a) {
          const Mat3<T> dF = Vec3<T>::Unit(a) * g.transpose();
          blocks[static_cast<std::size_t>(e.nodes[static_cast<std::size_t>(i)])].col(a) +=
              e.volume * ReferenceLaw<Law>::template differential<T>(F, dF, lambda_, mu_) * g;
        }
      }
    }
    return blocks;
  }

 private:
  struct Element {
    std::array<std::int32_t, 4> nodes;
    Mat3<T> inverse;  // of the matrix of rest edges
    T volume;
  };

  static Mat3<T> gradient(const Element& e, const Vector<T>& x) {
    const Vec3<T> a = x.template segment<3>(3 * e.nodes[0]);
    Mat3<T> edges;
    edges.col(0) = x.template segment<3>(3 * e.nodes[1]) - a;
    edges.col(1) = x.template segment<3>(3 * e.nodes[2]) - a;
    edges.col(2) = x.template segment<3>(3 * e.nodes[3]) - a;
    return edges * e.inverse;
  }
  static void add(const Element& e, const Mat3<T>& P, Vector<T>& y) {
    const Mat3<T> H = e.volume * P * e.inverse.transpose();
    y.template segment<3>(3 * e.nodes[1]) += H.col(0);
    y.template segment<3>(3 * e.nodes[2]) += H.col(1);
    y.template segment<3>(3 * e.nodes[3]) += H.col(2);
    y.template segment<3>(3 * e.nodes[0]) -= H.col(0) + H.col(1) + H.col(2);
  }

  T lambda_, mu_;
  std::vector<Element> elements_;
};

/// The unit cube in its deformed state, and the reference in double to hold results against.
template <class Law>
struct ReferenceState {
  ReferenceBody<Law, double> body;
  Vector<double> x, d;  // positions and a direction, packed

  explicit ReferenceState(int n) : body(cube(n), Kind<Law, double>::law()) {
    x = packed(field<double>(cube(n), position));
    d = packed(field<double>(cube(n), direction));
  }
  static Vec3<double> position(const Vec3<double>& X) { return X + deformation(X); }
  static Vec3<double> direction(const Vec3<double>& X) {
    return {std::sin(3 * X[1] + 1), std::cos(4 * X[2]), std::sin(5 * X[0] + 2 * X[1])};
  }
  [[nodiscard]] Vector<double> force() const {
    Vector<double> y(x.size());
    body.force(x, y);
    return y;
  }
  [[nodiscard]] Vector<double> product() const {
    Vector<double> y(x.size());
    body.product(x, d, y);
    return y;
  }
};

}  // namespace bench
