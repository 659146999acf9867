// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "scenes/beams.hpp"
#include "scenes/blocks.hpp"
#include "scenes/vibrating_bar.hpp"

namespace chart {

/// All scenes. A new one is a function in a header of scenes/, and a line here.
inline std::vector<Scene> scenes() {
  return {steel_cantilever(),
          soft_cantilever(),
          compressed_block(),
          twisted_bar(),
          cooks_membrane("cook_30", 0.3),
          cooks_membrane("cook_49", 0.49),
          cooks_membrane("cook_4999", 0.4999),
          vibrating_bar()};
}

}  // namespace chart
