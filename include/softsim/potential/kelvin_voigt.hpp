// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>

#include "softsim/concepts.hpp"
#include "softsim/core/error.hpp"
#include "softsim/potential/elastic.hpp"
#include "softsim/potential/memory_elements.hpp"

namespace softsim {

/// Kelvin-Voigt damping of one integration point: beside any elastic stress the viscous second
/// Piola-Kirchhoff stress S_v = phi tr(E') I + 2 psi E' of the Green strain rate E' = (F'^T F + F^T F')/2
/// (d'Aulignac 2001, Eqs. 2.11, 2.13 and 2.15; Eq. 2.10 lacks the factor 1/2). Objective, and S_v : E' >= 0.
/// Goes into `MemoryElements`, beside the elastic term of the system.
///
/// With forces at (q, v) it is the damping product D(q) v with D symmetric and positive semidefinite. An
/// implicit step of h has the potential V h/2 (phi tr(R)^2 + 2 psi R : R) with R = (E - E_0)/h and E_0 the
/// strain at the start of the step: the force at its end with E' = R. Rotations, finite ones too, cost
/// nothing there, and a step cannot gain energy from it.
struct KelvinVoigtParameters {
  double phi;  ///< bulk-like viscosity, Pa s
  double psi;  ///< shear viscosity, Pa s
};

/// See `KelvinVoigtParameters`.
template <class K>
requires Kinematics<K>
class KelvinVoigt {
 public:
  static constexpr int points = K::points;
  static constexpr bool viscous = true;
  static constexpr bool translation_invariant = requires { requires K::translation_invariant; };
  /// That of the kinematics, and six numbers: the strain at the start of the step.
  template <class T>
  using Data = Remembered<typename K::template Data<T>, T>;

  /// @throws std::invalid_argument unless both are finite, psi >= 0 and 3 phi + 2 psi >= 0: else some motion
  /// would gain energy
  explicit KelvinVoigt(const KelvinVoigtParameters& p) : p_(p) {
    if (!(p.psi >= 0) || !(p.psi <= 1e300))
      invalid(std::string("Kelvin-Voigt: psi ") + to_text(p.psi) + " Pa s must be at least 0 and finite");
    if (!(3 * p.phi + 2 * p.psi >= 0) || !(p.phi <= 1e300))
      invalid(std::string("Kelvin-Voigt: phi ") + to_text(p.phi) +
              " Pa s must be at least -2/3 psi = " + to_text(-2 * p.psi / 3) + " Pa s and finite");
  }

  /// See `Remembered`.
  [[nodiscard]] std::size_t memory_size() const { return 6; }
  /// See `MemoryElements`.
  void set_step(double dt) { per_dt_ = dt > 0 ? 1 / dt : 0; }
  /// Nothing moves in a static problem.
  void set_static() { per_dt_ = 0; }
  /// Takes the strain.
  template <class T>
  void remember(const Data<T>& data, const Local<T, points>& u) const {
    const Mat3<T> E = strain<T>(K::deformation_gradient(data.rest, u));
    for (int i = 0; i < 3; ++i) {
      data.memory[i] = E(i, i);
      data.memory[3 + i] = E(i, (i + 1) % 3);
    }
  }

  /// V h/2 (phi tr(R)^2 + 2 psi R : R), J.
  template <class T>
  [[nodiscard]] T energy(const Data<T>& data, const Local<T, points>& u) const {
    const Mat3<T> R = since<T>(data.memory, K::deformation_gradient(data.rest, u));
    return T(per_dt_ / 2) * K::volume(data.rest) * double_dot(R, viscous_stress(R));
  }
  /// V B^T F S_v, N.
  template <class T>
  [[nodiscard]] Eigen::Matrix<T, 3 * points, 1> gradient(const Data<T>& data,
                                                         const Local<T, points>& u) const {
    return K::pullback(data.rest, u, scaled_piola(data, K::deformation_gradient(data.rest, u)));
  }
  /// V B^T (dF S_v + F dS_v), and the geometric product where F is not linear in the unknowns.
  template <class T>
  [[nodiscard]] Eigen::Matrix<T, 3 * points, 1> hessian_product(
      const Data<T>& data, const Local<T, points>& u, const Eigen::Matrix<T, 3 * points, 1>& du) const {
    const Mat3<T> F = K::deformation_gradient(data.rest, u);
    const Mat3<T> dF = K::deformation_gradient_differential(data.rest, u, du);
    const Mat3<T> S = viscous_stress<T>(since<T>(data.memory, F)),
                  dS = viscous_stress<T>(strain_rate<T>(F, dF));
    Mat3<T> dP = dF * S;
    dP += F * dS;
    const T scale = T(per_dt_) * K::volume(data.rest);
    dP *= scale;
    Eigen::Matrix<T, 3 * points, 1> df = K::pullback(data.rest, u, dP);
    if constexpr (NonlinearKinematics<K, T>)
      df += K::geometric_product(data.rest, u, scaled_piola(data, F), du);
    return df;
  }
  /// D(u) v = V B^T F S_v at the velocities v, N.
  template <class T>
  [[nodiscard]] Eigen::Matrix<T, 3 * points, 1> damping_product(
      const Data<T>& data, const Local<T, points>& u, const Eigen::Matrix<T, 3 * points, 1>& v) const {
    const Mat3<T> F = K::deformation_gradient(data.rest, u);
    const Mat3<T> S =
        viscous_stress<T>(strain_rate<T>(F, K::deformation_gradient_differential(data.rest, u, v)));
    Mat3<T> P = F * S;
    P *= K::volume(data.rest);
    return K::pullback(data.rest, u, P);
  }

 private:
  template <class T>
  static Mat3<T> strain(const Mat3<T>& F) {
    const Mat3<T> H = F - Mat3<T>::Identity(), HtH = H.transpose() * H;
    const Mat3<T> twice = H + H.transpose() + HtH;
    return T(0.5) * twice;
  }
  template <class T>
  static Mat3<T> strain_rate(const Mat3<T>& F, const Mat3<T>& rate) {
    const Mat3<T> A = F.transpose() * rate;
    return symmetric_part<T>(A);
  }
  // E - E_0, the rate times h.
  template <class T>
  static Mat3<T> since(const T* memory, const Mat3<T>& F) {
    Mat3<T> E = strain<T>(F);
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3;
      E(i, i) -= memory[i];
      E(i, j) -= memory[3 + i];
      E(j, i) = E(i, j);
    }
    return E;
  }
  template <class T>
  Mat3<T> viscous_stress(const Mat3<T>& rate) const {
    const T two_psi(2 * p_.psi), pressure = T(p_.phi) * trace(rate);
    Mat3<T> S = two_psi * rate;
    for (int i = 0; i < 3; ++i) S(i, i) += pressure;
    return S;
  }
  template <class T>
  Mat3<T> scaled_piola(const Data<T>& data, const Mat3<T>& F) const {
    const T scale = T(per_dt_) * K::volume(data.rest);
    const Mat3<T> S = viscous_stress<T>(since<T>(data.memory, F));
    Mat3<T> P = F * S;
    P *= scale;
    return P;
  }

  KelvinVoigtParameters p_;
  double per_dt_ = 0;  // 1/h in an implicit step, 0 else
};

/// A mesh of linear tetrahedra with Kelvin-Voigt damping, see `KelvinVoigtParameters`.
template <class T = double, int N = default_lanes<T>>
using KelvinVoigtTetrahedra = MemoryElements<KelvinVoigt<LinearTetrahedron>, T, N>;

/// Kelvin-Voigt damping of `mesh`, to be put into a system beside the elastic term.
/// @throws std::invalid_argument as `KelvinVoigt`
template <class T = double, int N = default_lanes<T>>
[[nodiscard]] KelvinVoigtTetrahedra<T, N> kelvin_voigt(const TetrahedralMesh& mesh,
                                                       const KelvinVoigtParameters& parameters) {
  return {{KelvinVoigt<LinearTetrahedron>(parameters)}, detail::tetrahedron_data(mesh), mesh.tetrahedra()};
}

}  // namespace softsim
