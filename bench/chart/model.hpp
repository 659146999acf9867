// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "../any_term.hpp"
#include "scene.hpp"
#include "softsim/reduction/warped_modes.hpp"
#include "softsim/system/system.hpp"

namespace chart {

/// Up to two elastic terms and the loads.
template <class T>
using AnySystem = softsim::System<bench::AnyTerm<T>, bench::AnyTerm<T>, bench::AnyTerm<T, true>>;

/// A scene made discrete.
template <class T>
struct Discrete {
  AnySystem<T> system;
  /// Displacements at the probes of the scene.
  std::function<std::vector<Vec>(const softsim::State<T>&)> at_probes;
  /// Makes modal coordinates large displacements, with shapes at rest; empty where the model has no mesh.
  std::function<std::shared_ptr<softsim::WarpedModes>(const Eigen::MatrixXd& shapes)> warped = nullptr;
};

/// Why a method cannot make anything of a scene.
struct NotApplicable : std::runtime_error {
  /// @param part what does not fit, if it is not the model
  explicit NotApplicable(const std::string& why, std::string part = "")
      : std::runtime_error(why), of(std::move(part)) {}
  std::string of;
};

/// A way to make a scene discrete, in double and in single precision.
struct Model {
  std::string name, family;
  std::function<Discrete<double>(const Scene&, int resolution)> in_double;
  std::function<Discrete<float>(const Scene&, int resolution)> in_float;

  /// @param f generic: f(std::type_identity<T>, scene, resolution)
  template <class F>
  Model(std::string n, std::string of, F f)
      : name(std::move(n)),
        family(std::move(of)),
        in_double([f](const Scene& s, int r) { return f(std::type_identity<double>(), s, r); }),
        in_float([f](const Scene& s, int r) { return f(std::type_identity<float>(), s, r); }) {}

  template <class T>
  [[nodiscard]] Discrete<T> make(const Scene& scene, int resolution) const {
    if constexpr (std::is_same_v<T, double>)
      return in_double(scene, resolution);
    else
      return in_float(scene, resolution);
  }
};

/// The models, a family of them a file.
std::vector<Model> tetrahedra(), solids(), frames();

/// All of them. A new model goes into one of these, or into a file of its own.
inline std::vector<Model> models() {
  std::vector<Model> all;
  for (const auto& family : {tetrahedra(), solids(), frames()})
    all.insert(all.end(), family.begin(), family.end());
  return all;
}

}  // namespace chart
