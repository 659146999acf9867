// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>

#include "../any_term.hpp"
#include "softsim/potential/dead_load.hpp"
#include "softsim/system/system.hpp"

/// What the programs of the stability atlas share.
namespace atlas {

using softsim::State, softsim::Vector;

using AnyTerm = bench::AnyTerm<double>;
/// Elastic terms of one body, the second for volumes averaged at nodes.
using Elasticity = std::array<AnyTerm, 2>;
/// A system of them under dead loads.
using AnySystem = softsim::System<AnyTerm, AnyTerm, softsim::DeadLoad<double>>;

}  // namespace atlas
