// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "softsim/core/error.hpp"
#include "softsim/core/tensor.hpp"

namespace softsim::detail {

// "(0.1, 2, -3)", as messages write a place.
inline std::string point_text(const Vec3<double>& x) {
  return std::string("(") + to_text(x[0]) + ", " + to_text(x[1]) + ", " + to_text(x[2]) + ")";
}

}  // namespace softsim::detail
