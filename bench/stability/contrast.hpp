// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <variant>
#include <vector>

#include "discretise.hpp"
#include "scene.hpp"
#include "slivers.hpp"
#include "softsim/material/neo_hookean.hpp"
#include "softsim/material/stable_neo_hookean.hpp"
#include "softsim/potential/elastic.hpp"
#include "softsim/potential/nodal_volume.hpp"

namespace atlas {

/// Where a cube is stiffer: in its lower half, in its upper half, or in the middle (an eighth of it).
enum class Stiff { below, above, inclusion };
inline std::string_view to_string(Stiff where) {
  constexpr std::array<std::string_view, 3> names{"below", "above", "inclusion"};
  return names[static_cast<std::size_t>(where)];
}

/// A unit cube of two stiffnesses, 1 Pa and `ratio`, nu = 0.3.
inline Elasticity two_stiffnesses(const Body& body, Stiff where, double ratio) {
  const auto& mesh = std::get<softsim::TetrahedralMesh>(body.mesh);
  std::vector<std::int32_t> index;
  for (std::size_t e = 0; e < mesh.elements().size(); ++e) {
    Vec c = Vec::Zero();
    for (const Vec& X : mesh.element_points(e)) c += X / 4;
    const bool stiff = where == Stiff::below   ? c[2] < 0.5
                       : where == Stiff::above ? c[2] > 0.5
                                               : (c - Vec::Constant(0.5)).cwiseAbs().maxCoeff() < 0.25;
    index.push_back(stiff ? 1 : 0);
  }
  const std::vector laws{softsim::StableNeoHookean::from_young_poisson(1, 0.3),
                         softsim::StableNeoHookean::from_young_poisson(ratio, 0.3)};
  return {softsim::elastic(mesh, laws, index), AnyTerm()};
}

/// Stable Neo-Hookean or one with the logarithm at a Poisson's ratio, plain or with volumes averaged at
/// nodes.
inline Elasticity nearly_incompressible(const Body& body, bool stable, bool averaged, double nu) {
  using namespace softsim;
  const auto& mesh = std::get<TetrahedralMesh>(body.mesh);
  const Lame lame = Lame::from_young_poisson(1, nu);
  if (!averaged)
    return stable ? Elasticity{elastic(mesh, StableNeoHookean::from_lame(lame.lambda, lame.mu)), AnyTerm()}
                  : Elasticity{elastic(mesh, NeoHookean::from_lame(lame.lambda, lame.mu)), AnyTerm()};
  return stable ? averaged_stable_neo_hookean(body.mesh, lame)
                : Elasticity{elastic(mesh, NeoHookean::from_lame(0, lame.mu)),
                             nodal_volume(mesh, LogarithmicVolume(lame.lambda))};
}

}  // namespace atlas
