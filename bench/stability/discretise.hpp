// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <variant>

#include "any_system.hpp"
#include "scene.hpp"
#include "softsim/material/lame.hpp"
#include "softsim/material/stable_neo_hookean.hpp"
#include "softsim/potential/elastic.hpp"
#include "softsim/potential/heml.hpp"
#include "softsim/potential/nodal_volume.hpp"
#include "softsim/potential/quadrature.hpp"

namespace atlas {

/// How a body's elastic energy is made of a law.
enum class Discretisation { elastic, heml, nodal_volume, quadratic, hexahedra };
inline std::string_view to_string(Discretisation d) {
  constexpr std::array<std::string_view, 5> names{"elastic", "heml", "nodal_volume", "quadratic",
                                                  "hexahedra"};
  return names[static_cast<std::size_t>(d)];
}

/// The elastic energy of a mesh: linear tetrahedra by `elastic` or `heml`, ten-node tetrahedra or hexahedra.
template <class Law>
Elasticity elasticity(const Mesh& mesh, const Law& law, Discretisation d = Discretisation::elastic) {
  const auto silent = [](const std::string&) {};
  if (d == Discretisation::quadratic)
    return {softsim::elastic(std::get<softsim::QuadraticTetrahedralMesh>(mesh), law), AnyTerm()};
  if (d == Discretisation::hexahedra)
    return {softsim::elastic(std::get<softsim::HexahedralMesh>(mesh), law), AnyTerm()};
  const auto& tetrahedra = std::get<softsim::TetrahedralMesh>(mesh);
  if (d == Discretisation::heml) return {softsim::heml(tetrahedra, law, silent), AnyTerm()};
  return {softsim::elastic(tetrahedra, law), AnyTerm()};
}
/// The same for linear tetrahedra by `elastic` alone, which compiles faster.
template <class Law>
Elasticity tetrahedra(const Mesh& mesh, const Law& law) {
  return {softsim::elastic(std::get<softsim::TetrahedralMesh>(mesh), law), AnyTerm()};
}

/// Stable Neo-Hookean with its volumes averaged at nodes.
inline Elasticity averaged_stable_neo_hookean(const Mesh& mesh, const softsim::Lame& lame) {
  using namespace softsim;
  const auto& m = std::get<TetrahedralMesh>(mesh);
  return {softsim::elastic(m, StableNeoHookean::from_lame(0, lame.mu)),
          softsim::nodal_volume(m, QuadraticVolume(lame.lambda))};
}

}  // namespace atlas
