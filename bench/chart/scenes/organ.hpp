// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "../quantities.hpp"
#include "../scene.hpp"
#include "softsim/core/error.hpp"
#include "softsim/io/read_mesh.hpp"
#include "softsim/mesh/refinement.hpp"

namespace chart {

/// An organ out of a file and its refinements, which keep its shape, held in what lies between some nodes.
class HeldOrgan {
 public:
  /// @param is_held whether a node of the file is held
  HeldOrgan(const std::string& path, const std::function<bool(const Vec&)>& is_held)
      : meshes_{softsim::read_mesh(path)} {
    for (const Vec& X : meshes_[0].points())
      if (is_held(X)) held_.insert(key(X));
    if (held_.empty()) softsim::invalid("mesh '" + path + "': no node is held");
    hold_middles();
  }
  /// Each tetrahedron cut into r^3; r is a power of two.
  const softsim::TetrahedralMesh& at(int r) {
    std::size_t times = 0;
    for (; r > 1; r /= 2) ++times;
    while (meshes_.size() <= times) {
      meshes_.push_back(softsim::refined(meshes_.back()));
      hold_middles();
    }
    return meshes_[times];
  }
  /// Of a node of the meshes asked for so far, or in the middle of an edge of theirs.
  [[nodiscard]] bool holds(const Vec& X) const { return held_.contains(key(X)); }

 private:
  static std::array<std::int64_t, 3> key(const Vec& X) {
    return {std::llround(1e9 * X[0]), std::llround(1e9 * X[1]), std::llround(1e9 * X[2])};
  }
  // of edges that are held at both ends; before a finer mesh has them as nodes
  void hold_middles() {
    const softsim::TetrahedralMesh& mesh = meshes_.back();
    std::vector<bool> held;
    for (const Vec& X : mesh.points()) held.push_back(holds(X));
    for (const softsim::Tetrahedron& t : mesh.tetrahedra())
      for (std::size_t a = 0; a < 4; ++a)
        for (std::size_t b = 0; b < a; ++b) {
          const auto i = static_cast<std::size_t>(t[a]), j = static_cast<std::size_t>(t[b]);
          if (held[i] && held[j]) held_.insert(key(0.5 * (mesh.points()[i] + mesh.points()[j])));
        }
  }

  std::vector<softsim::TetrahedralMesh> meshes_;
  std::set<std::array<std::int64_t, 3>> held_;
};

/// An organ out of a file that is held at one end of its x axis and pulled up at the tip of the other lobe.
/// @param path of a mesh of tetrahedra
/// @throws std::invalid_argument if it cannot be read
inline Scene organ(const std::string& path) {
  Scene s{.name = "organ",
          .title = "Organ held on the right, pulled up at its left lobe, Neo-Hookean, nu = 0.45"};
  s.young = 3000;
  s.poisson = 0.45;
  s.law = softsim::NeoHookean::from_young_poisson(s.young, s.poisson);
  s.density = 1000;
  s.resolutions = {1, 2, 4};
  const softsim::TetrahedralMesh mesh = softsim::read_mesh(path);
  const auto by_x = [](const Vec& X, const Vec& Y) { return X[0] < Y[0]; };
  const auto [first, last] = std::minmax_element(mesh.points().begin(), mesh.points().end(), by_x);
  const Vec tip = *last;
  const double length = tip[0] - (*first)[0], left = (*first)[0];
  const auto organ =
      std::make_shared<HeldOrgan>(path, [=](const Vec& X) { return X[0] < left + 0.15 * length; });
  s.tetrahedra = [organ](int r) { return organ->at(r); };
  s.support = [organ](const Vec& X) { return organ->holds(X) ? held() : all_free(); };
  // most at the tip, nothing from a fifth of the length on; smooth, so that finer meshes have the same load
  s.traction = [=, most = 0.03 * s.young](const Vec& X) {
    const double r = (X - tip).norm() / (0.2 * length);
    return Vec(0, 0, r < 1 ? most * (1 - r * r) * (1 - r * r) : 0);
  };
  s.load_steps = 2;
  s.reference_resolution = 4;
  const std::size_t every = std::max<std::size_t>(1, mesh.points().size() / 60);
  for (std::size_t i = 0; i < mesh.points().size(); i += every)
    if (!organ->holds(mesh.points()[i])) s.probes.push_back(mesh.points()[i]);
  s.quantities = {displacement(), largest_displacement()};
  return s;
}

}  // namespace chart
