// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <concepts>
#include <cstdint>
#include <vector>

#include "softsim/core/tensor.hpp"

namespace softsim {

/// The shape functions that do not vanish at one point x, in ascending order of their nodes. A field with the
/// nodal values u_i is sum_i values_i u_i there, and its gradient sum_i u_i gradients_i^T. Where shape
/// functions take the gradients of the field at the nodes too (generalised moving least squares),
/// sum_i grad u_i slopes_i is added to the value, and slope_gradients_i(k, j) is the derivative of
/// slopes_i[k] along axis j; else these two are empty.
struct ShapeValues {
  std::vector<std::int32_t> nodes;
  std::vector<double> values;
  std::vector<Vec3<double>> gradients;  ///< 1/m
  std::vector<Vec3<double>> slopes;     ///< m
  std::vector<Mat3<double>> slope_gradients;
};

/// Shape functions of nodes in space, of a mesh or without one (Bosman 2015, Sec. 4.1): what frames need to
/// know of them.
///  - `nodes()`: rest positions in m;
///  - `at(x)`: those that do not vanish at x; throws `std::invalid_argument` where there are none;
///  - `consistency()`: degree up to which polynomials are reproduced. 0, a partition of unity, is enough for
///    frames to reproduce rigid motions;
///  - `interpolates()`: whether they have the Kronecker property, value 1 at their own node and 0 at others;
///  - `support()`: distance in m beyond which a node's function vanishes; infinite if there is none, or if it
///    depends on the other nodes.
template <class S>
concept NodeShapes = requires(const S& shapes, const Vec3<double>& x) {
  { shapes.nodes() } -> std::convertible_to<const std::vector<Vec3<double>>&>;
  { shapes.at(x) } -> std::same_as<ShapeValues>;
  { shapes.consistency() } -> std::convertible_to<int>;
  { shapes.interpolates() } -> std::convertible_to<bool>;
  { shapes.support() } -> std::convertible_to<double>;
};

}  // namespace softsim
