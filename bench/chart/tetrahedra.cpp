// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "discretise.hpp"
#include "softsim/material/corotational.hpp"
#include "softsim/material/lame.hpp"
#include "softsim/material/linear_elastic.hpp"
#include "softsim/potential/elastic.hpp"
#include "softsim/potential/heml.hpp"
#include "softsim/potential/mass_tensor.hpp"
#include "softsim/potential/nodal_volume.hpp"
#include "softsim/potential/spring.hpp"

// Models on linear tetrahedra.

namespace chart {
namespace {

using softsim::TetrahedralMesh;

// A model that takes the mesh and makes one term of it.
template <class F>
Model on_mesh(const std::string& name, const std::string& family, F f) {
  return Model(name, family, [f]<class T>(std::type_identity<T>, const Scene& scene, int resolution) {
    const TetrahedralMesh mesh = scene.tetrahedra(resolution);
    return discrete<T>(scene, mesh, f(std::type_identity<T>(), scene, mesh));
  });
}

template <class T>
using Term = bench::AnyTerm<T>;

}  // namespace

std::vector<Model> tetrahedra() {
  using namespace softsim;
  return {
      on_mesh("springs", "mass-spring",
              []<class T>(std::type_identity<T>, const Scene& s, const TetrahedralMesh& mesh) -> Term<T> {
                return van_gelder_springs<Spring, T>(mesh, s.young);
              }),
      on_mesh("mass_tensor", "mass-tensor",
              []<class T>(std::type_identity<T>, const Scene& s, const TetrahedralMesh& mesh) -> Term<T> {
                return mass_tensors<LinearMassTensor, T>(mesh, Lame::from_young_poisson(s.young, s.poisson));
              }),
      on_mesh("mass_tensor_svk", "mass-tensor",
              []<class T>(std::type_identity<T>, const Scene& s, const TetrahedralMesh& mesh) -> Term<T> {
                if (!std::holds_alternative<StVenantKirchhoff>(s.law))
                  throw NotApplicable(
                      "tensors of third and fourth order are those of St. Venant and Kirchhoff's law");
                return mass_tensors<MassTensor, T>(mesh, Lame::from_young_poisson(s.young, s.poisson));
              }),
      on_mesh("tet4_linear", "linear tetrahedra",
              []<class T>(std::type_identity<T>, const Scene& s, const TetrahedralMesh& mesh) -> Term<T> {
                return elastic<T>(mesh, LinearElastic::from_young_poisson(s.young, s.poisson));
              }),
      on_mesh("tet4_corotational", "corotational",
              []<class T>(std::type_identity<T>, const Scene& s, const TetrahedralMesh& mesh) -> Term<T> {
                return elastic<T>(mesh, Corotational::from_young_poisson(s.young, s.poisson));
              }),
      on_mesh("tet4", "linear tetrahedra",
              []<class T>(std::type_identity<T>, const Scene& s, const TetrahedralMesh& mesh) -> Term<T> {
                return std::visit([&](const auto& law) -> Term<T> { return elastic<T>(mesh, law); }, s.law);
              }),
      on_mesh("heml", "HEML",
              []<class T>(std::type_identity<T>, const Scene& s, const TetrahedralMesh& mesh) -> Term<T> {
                return std::visit(
                    [&](const auto& law) -> Term<T> { return heml<T>(mesh, law, [](const std::string&) {}); },
                    s.law);
              }),
      // what changes volume is taken from averages around the nodes, the rest from the tetrahedra
      Model("tet4_nodal_volume", "locking-free",
            []<class T>(std::type_identity<T>, const Scene& s, int resolution) {
              const auto* law = std::get_if<NeoHookean>(&s.law);
              if (law == nullptr) throw NotApplicable("averaged volumes need a law that splits them off");
              const TetrahedralMesh mesh = s.tetrahedra(resolution);
              const Lame lame = Lame::from_young_poisson(s.young, s.poisson);
              return discrete<T>(s, mesh, elastic<T>(mesh, NeoHookean::from_lame(0, lame.mu)),
                                 nodal_volume<T>(mesh, LogarithmicVolume(lame.lambda)));
            }),
  };
}

}  // namespace chart
