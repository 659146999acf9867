// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "softsim/concepts.hpp"
#include "softsim/kinematics/linear_tetrahedron.hpp"
#include "softsim/material/fibre.hpp"
#include "softsim/material/principal_tangent.hpp"
#include "softsim/mesh/tetrahedral_mesh.hpp"
#include "softsim/potential/discrete_gradient.hpp"
#include "softsim/potential/elements.hpp"
#include "softsim/potential/frame_blocks.hpp"
#include "softsim/potential/isotropic_blocks.hpp"

namespace softsim {

/// A law that differs from element to element: `Data<T>` holds what differs, as scalars of type T only, and
/// `at(data)` is the `Material` of one element.
template <class M, class T = double>
concept MaterialField = requires(const M& law, const typename M::template Data<T>& data) {
  requires Material<std::remove_cvref_t<decltype(law.at(data))>, T>;
};

namespace detail {
template <class K, class M, class T>
struct ElasticData {
  using type = typename K::template Data<T>;
};
template <class K, MaterialField M, class T>
struct ElasticData<K, M, T> {
  struct type {
    typename K::template Data<T> shape;
    typename M::template Data<T> material;
  };
};

// Either the closed form of the unfiltered law, or the filtered tangent in principal axes with the gradients
// of shape functions 1 to 3 in the same axes.
template <class Law, class T>
struct FilteredBlocks {
  std::conditional_t<InvariantLaw<Law>, IsotropicBlocks<Law, T>, char> plain;
  PrincipalTangent<T> tangent;
  std::array<Vec3<T>, 3> gradient;
  T volume;
  bool filtered;
};
}  // namespace detail

/// Elastic energy of one integration point: V psi(F), with any kinematics and any material.
template <class K, class M>
requires Kinematics<K> &&(Material<M> || MaterialField<M>)struct Elastic {
  static constexpr int points = K::points, frames = frames_of<K>;
  static constexpr bool translation_invariant = requires { requires K::translation_invariant; };
  /// That of the kinematics, and with it that of a material field.
  template <class T>
  using Data = typename detail::ElasticData<K, M, T>::type;

  M material;

  /// V psi(F), J.
  template <class T>
  [[nodiscard]] T energy(const Data<T>& data, const Unknowns<K, T>& u) const {
    return K::volume(shape(data)) * law(data).energy_density(K::deformation_gradient(shape(data), u));
  }

  /// det F, the ratio of the volumes.
  template <class T>
  [[nodiscard]] T volume_ratio(const Data<T>& data, const Unknowns<K, T>& u) const {
    return determinant(Mat3<T>(K::deformation_gradient(shape(data), u)));
  }

  /// V B^T P(F), N.
  template <class T>
  [[nodiscard]] Tangent<K, T> gradient(const Data<T>& data, const Unknowns<K, T>& u) const {
    Mat3<T> P = law(data).first_piola(K::deformation_gradient(shape(data), u));
    P *= K::volume(shape(data));
    return K::pullback(shape(data), u, P);
  }

  /// V B^T dP(F; B du), and the geometric product where F is not linear in the unknowns.
  template <class T>
  [[nodiscard]] Tangent<K, T> hessian_product(const Data<T>& data, const Unknowns<K, T>& u,
                                              const Tangent<K, T>& du) const {
    const auto& rest = shape(data);
    const Mat3<T> F = K::deformation_gradient(rest, u);
    Mat3<T> dP = law(data).first_piola_differential(F, K::deformation_gradient_differential(rest, u, du));
    dP *= K::volume(rest);
    Tangent<K, T> df = K::pullback(rest, u, dP);
    if constexpr (NonlinearKinematics<K, T>) {
      Mat3<T> P = law(data).first_piola(F);
      P *= K::volume(rest);
      df += K::geometric_product(rest, u, P, du);
    }
    return df;
  }

  /// V B^T P with the `discrete_stress` between two states, N.
  template <class T>
  [[nodiscard]] Tangent<K, T> discrete_gradient(const Data<T>& data, const Unknowns<K, T>& u_0,
                                                const Unknowns<K, T>& u_1) const
      requires(!NonlinearKinematics<K, T>) {
    const auto& rest = shape(data);
    Mat3<T> P = discrete_stress(law(data), Mat3<T>(K::deformation_gradient(rest, u_0)),
                                Mat3<T>(K::deformation_gradient(rest, u_1)));
    P *= K::volume(rest);
    return K::pullback(rest, u_1, P);
  }

  /// The law's own linearisation at F, for a law that has one worth keeping.
  template <class T>
  [[nodiscard]] auto linearise(const Data<T>& data, const Unknowns<K, T>& u) const
      requires(!NonlinearKinematics<K, T> && requires(const Mat3<T>& F) { material.linearise(F); }) {
    return material.linearise(K::deformation_gradient(shape(data), u));
  }
  /// V B^T dP(B du) with dP from that linearisation.
  template <class T, class Linearisation>
  [[nodiscard]] Tangent<K, T> linearised_product(const Data<T>& data, const Linearisation& at,
                                                 const Tangent<K, T>& du) const {
    const auto& rest = shape(data);
    Unknowns<K, T> any;  // linear kinematics do not look at it
    for (auto& p : any.points) p.setZero();
    Mat3<T> dP = at(K::deformation_gradient_differential(rest, any, du));
    dP *= K::volume(rest);
    return K::pullback(rest, any, dP);
  }

  /// What the blocks of the Hessian are made of, for an isotropic law on linear tetrahedra.
  template <class T>
  [[nodiscard]] IsotropicBlocks<M, T> block_form(const Data<T>& data, const Unknowns<K, T>& u) const
      requires(std::is_same_v<K, LinearTetrahedron>&& InvariantLaw<M>) {
    const Mat3<T> F = K::deformation_gradient(data, u), c = cofactor(F);
    const auto& g = data.gradient;
    IsotropicBlocks<M, T> form;
    form.volume = data.volume;
    for (std::size_t i = 0; i < 3; ++i) {
      form.a[i] = F * g[i];
      form.c[i] = c * g[i];
      form.s[i] = F * g[(i + 1) % 3].cross(g[(i + 2) % 3]);
      form.G[i] = g[i].dot(g[i]);
    }
    form.G[3] = g[0].dot(g[1]);
    form.G[4] = g[0].dot(g[2]);
    form.G[5] = g[1].dot(g[2]);
    if constexpr (M::depends_on_i2 || !M::linear_in_i1) form.B = F * F.transpose();
    form.set(material, F.col(0).dot(c.col(0)));
    return form;
  }
  /// The same for a filtered isotropic law: in principal axes where the filter may have something to do.
  template <class T>
  [[nodiscard]] auto block_form(const Data<T>& data, const Unknowns<K, T>& u) const
      requires(std::is_same_v<K, LinearTetrahedron>&& requires(const Mat3<T>& F, const Vec3<T>& p) {
        { material.surely_unfiltered(F) } -> std::same_as<bool>;
        material.linearise(F).block_of_turned(p, p);
      }) {
    using Law = std::remove_cvref_t<decltype(material.law())>;
    detail::FilteredBlocks<Law, T> form;
    const Mat3<T> F = K::deformation_gradient(data, u);
    form.filtered = !(InvariantLaw<Law> && material.surely_unfiltered(F));
    if (form.filtered) {
      form.tangent = material.linearise(F);
      for (std::size_t i = 0; i < 3; ++i) form.gradient[i] = form.tangent.V.transpose() * data.gradient[i];
      form.volume = data.volume;
    } else if constexpr (InvariantLaw<Law>) {
      form.plain = Elastic<K, Law>{material.law()}.template block_form<T>(data, u);
    }
    return form;
  }

  /// Block (i, j) of the Hessian, 1 <= i <= j, N/m.
  template <int i, int j, class T>
  [[nodiscard]] Mat3<T> hessian_block(const IsotropicBlocks<M, T>& form) const {
    return form.template block<i, j>();
  }
  template <int i, int j, class Law, class T>
  [[nodiscard]] Mat3<T> hessian_block(const detail::FilteredBlocks<Law, T>& form) const {
    if constexpr (InvariantLaw<Law>)
      if (!form.filtered) return form.plain.template block<i, j>();
    Mat3<T> block = form.tangent.block_of_turned(form.gradient[i - 1], form.gradient[j - 1]);
    block *= form.volume;
    return block;
  }

  /// Calls add(i, j, block) for the blocks i <= j of `scale` times the Hessian of a sample between frames.
  template <class T, class Add>
  void add_blocks(const Data<T>& data, const Unknowns<K, T>& u, const T& scale, Add add) const
      requires(std::is_same_v<K, FrameSample<frames>>) {
    add_frame_blocks<frames>(shape(data), u, law(data), scale, add);
  }

 private:
  template <class D>
  static const auto& shape(const D& data) {
    if constexpr (MaterialField<M>)
      return data.shape;
    else
      return data;
  }
  template <class D>
  [[nodiscard]] decltype(auto) law(const D& data) const {
    if constexpr (MaterialField<M>)
      return material.at(data.material);
    else
      return (material);
  }
};

/// Elastic energy of a tetrahedral mesh with linear tetrahedra.
template <class M, class T = double, int N = default_lanes<T>>
using ElasticTetrahedra = Elements<Elastic<LinearTetrahedron, M>, T, N>;

namespace detail {
inline std::vector<LinearTetrahedron::Data<double>> tetrahedron_data(const TetrahedralMesh& mesh) {
  std::vector<LinearTetrahedron::Data<double>> data;
  data.reserve(mesh.tetrahedra().size());
  for (const Tetrahedron& v : mesh.tetrahedra()) {
    std::array<Vec3<double>, 4> X;
    for (std::size_t i = 0; i < 4; ++i) X[i] = mesh.points()[static_cast<std::size_t>(v[i])];
    data.push_back(LinearTetrahedron::make(X));
  }
  return data;
}
}  // namespace detail

/// Elastic energy of `mesh` with one of `materials` per tetrahedron; `material_index` chooses it and may be
/// empty if there is one material only.
/// @throws std::invalid_argument for an index out of range or a list of the wrong length
template <class T = double, int N = default_lanes<T>, class M>
[[nodiscard]] ElasticTetrahedra<M, T, N> elastic(const TetrahedralMesh& mesh, const std::vector<M>& materials,
                                                 const std::vector<std::int32_t>& material_index = {}) {
  if (materials.empty()) invalid("elastic: no material");
  if (material_index.empty() && materials.size() > 1)
    invalid(std::string("elastic: ") + std::to_string(materials.size()) +
            " materials need an index per tetrahedron");
  std::vector<Elastic<LinearTetrahedron, M>> models;
  for (const M& material : materials) models.push_back({material});
  return {std::move(models), detail::tetrahedron_data(mesh), mesh.tetrahedra(), material_index};
}

/// Elastic energy of `mesh` made of one material.
template <class T = double, int N = default_lanes<T>, class M>
requires Material<M>
[[nodiscard]] ElasticTetrahedra<M, T, N> elastic(const TetrahedralMesh& mesh, const M& material) {
  return elastic<T, N>(mesh, std::vector<M>{material});
}

/// Elastic energy of `mesh` made of a law that differs from tetrahedron to tetrahedron.
/// @param data what differs, per tetrahedron
/// @throws std::invalid_argument for a list of the wrong length
template <class T = double, int N = default_lanes<T>, MaterialField M>
[[nodiscard]] ElasticTetrahedra<M, T, N> elastic(const TetrahedralMesh& mesh, const M& law,
                                                 const std::vector<typename M::template Data<double>>& data) {
  using Local = Elastic<LinearTetrahedron, M>;
  if (data.size() != mesh.tetrahedra().size())
    invalid(std::string("elastic: ") + std::to_string(data.size()) + " material data for " +
            std::to_string(mesh.tetrahedra().size()) + " tetrahedra");
  const std::vector<LinearTetrahedron::Data<double>> shapes = detail::tetrahedron_data(mesh);
  std::vector<typename Local::template Data<double>> all;
  all.reserve(data.size());
  for (std::size_t e = 0; e < data.size(); ++e) all.push_back({shapes[e], data[e]});
  return {std::vector<Local>{{law}}, all, mesh.tetrahedra()};
}

/// Elastic energy of `mesh` made of a law with n families of fibres, alone or in a sum with others, whose
/// directions differ from tetrahedron to tetrahedron.
/// @param directions n unit vectors per tetrahedron, in the rest shape
/// @throws std::invalid_argument for a list of the wrong length or a length that is off 1 by more than 1e-6
template <class T = double, int N = default_lanes<T>, TakesFibreDirections M, std::size_t n>
[[nodiscard]] ElasticTetrahedra<FibreField<M, n>, T, N> elastic(
    const TetrahedralMesh& mesh, const M& law, const std::vector<std::array<Vec3<double>, n>>& directions) {
  if (directions.size() != mesh.tetrahedra().size())
    invalid(std::string("elastic: ") + std::to_string(directions.size()) + " fibre directions for " +
            std::to_string(mesh.tetrahedra().size()) + " tetrahedra");
  std::vector<FibreDirections<double, n>> data;
  data.reserve(directions.size());
  for (const std::array<Vec3<double>, n>& a : directions)
    data.push_back(unit_directions(a, std::string("tetrahedron ") + std::to_string(data.size()) + ": "));
  return elastic<T, N>(mesh, FibreField<M, n>{law}, data);
}

/// The same for one family.
template <class T = double, int N = default_lanes<T>, TakesFibreDirections M>
[[nodiscard]] ElasticTetrahedra<FibreField<M, 1>, T, N> elastic(const TetrahedralMesh& mesh, const M& law,
                                                                const std::vector<Vec3<double>>& directions) {
  std::vector<std::array<Vec3<double>, 1>> one;
  one.reserve(directions.size());
  for (const Vec3<double>& a : directions) one.push_back({a});
  return elastic<T, N>(mesh, law, one);
}

}  // namespace softsim
