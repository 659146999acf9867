// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "scenes/beams.hpp"
#include "scenes/blocks.hpp"
#include "scenes/cubes.hpp"
#include "scenes/organ.hpp"
#include "scenes/sheet.hpp"
#include "scenes/thick_sphere.hpp"
#include "scenes/vibrating_bar.hpp"

namespace chart {

/// All scenes. A new one is a function in a header of scenes/, and a line here.
/// @param organ_mesh file of tetrahedra
/// @throws std::invalid_argument if it cannot be read
inline std::vector<Scene> scenes(const std::string& organ_mesh = SOFTSIM_ORGAN) {
  return {steel_cantilever(),
          soft_cantilever(),
          compressed_block(),
          twisted_bar(),
          cooks_membrane("cook_30", 0.3),
          cooks_membrane("cook_49", 0.49),
          cooks_membrane("cook_4999", 0.4999),
          thick_sphere(),
          organ(organ_mesh),
          sheet(),
          turning_block(),
          pulled_cube(),
          vibrating_bar()};
}

}  // namespace chart
