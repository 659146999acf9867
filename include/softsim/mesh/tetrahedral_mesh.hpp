// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "softsim/core/error.hpp"
#include "softsim/core/tensor.hpp"

namespace softsim {

/// Four node numbers; the fourth lies on the side that the right-hand rule over the first three points to.
using Tetrahedron = std::array<std::int32_t, 4>;
/// Three node numbers, counter-clockwise seen from outside the body.
using Triangle = std::array<std::int32_t, 3>;

/// Signed volume in m^3 of the tetrahedron with corners a, b, c, d in m.
[[nodiscard]] inline double tetrahedron_volume(const Vec3<double>& a, const Vec3<double>& b,
                                               const Vec3<double>& c, const Vec3<double>& d) {
  return (b - a).dot((c - a).cross(d - a)) / 6;
}

/// A tetrahedral mesh that has been checked: all node numbers exist, every tetrahedron has four different
/// nodes and a positive volume, and every node belongs to a tetrahedron.
class TetrahedralMesh {
 public:
  /// @param points node positions in m
  /// @param tetrahedra node numbers, positively oriented
  /// @param region one number per tetrahedron (a file's physical group, an organ's tissue); empty means all 0
  /// Nodes that no tetrahedron uses are dropped, the rest keep their order; `warnings()` says how many.
  /// @throws std::invalid_argument naming the node or tetrahedron: no tetrahedra, coordinates that are not
  /// finite,
  ///   node numbers out of range or repeated, inverted or degenerate tetrahedra, a region list of another
  ///   length
  TetrahedralMesh(std::vector<Vec3<double>> points, std::vector<Tetrahedron> tetrahedra,
                  std::vector<int> region = {})
      : points_(std::move(points)), tetrahedra_(std::move(tetrahedra)), region_(std::move(region)) {
    if (tetrahedra_.empty()) invalid("mesh: no tetrahedra");
    if (region_.empty()) region_.assign(tetrahedra_.size(), 0);
    if (region_.size() != tetrahedra_.size())
      invalid(std::string("mesh: ") + std::to_string(region_.size()) + " region numbers for " +
              std::to_string(tetrahedra_.size()) + " tetrahedra");
    for (std::size_t i = 0; i < points_.size(); ++i)
      if (!points_[i].allFinite())
        invalid(std::string("node ") + std::to_string(i) + ": a coordinate is not a finite number");
    for (std::size_t t = 0; t < tetrahedra_.size(); ++t) check(t);
    drop_unused_nodes();
  }

  /// Node positions at rest in m.
  [[nodiscard]] const std::vector<Vec3<double>>& points() const { return points_; }
  /// Node numbers of each tetrahedron.
  [[nodiscard]] const std::vector<Tetrahedron>& tetrahedra() const { return tetrahedra_; }
  /// Region number of each tetrahedron.
  [[nodiscard]] const std::vector<int>& region() const { return region_; }
  /// Number in the input of each node that was kept.
  [[nodiscard]] const std::vector<std::int32_t>& source_node() const { return source_node_; }
  /// What was put right on the way in, one sentence each; empty for a clean mesh.
  [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }

  /// Rest volume of tetrahedron t in m^3.
  [[nodiscard]] double volume(std::size_t t) const {
    const Tetrahedron& v = tetrahedra_[t];
    return tetrahedron_volume(point(v[0]), point(v[1]), point(v[2]), point(v[3]));
  }
  /// Rest volume of the body in m^3.
  [[nodiscard]] double volume() const {
    double sum = 0;
    for (std::size_t t = 0; t < tetrahedra_.size(); ++t) sum += volume(t);
    return sum;
  }

 private:
  const Vec3<double>& point(std::int32_t i) const { return points_[static_cast<std::size_t>(i)]; }

  void check(std::size_t t) const {
    const std::string name = std::string("tetrahedron ") + std::to_string(t);
    const Tetrahedron& v = tetrahedra_[t];
    for (std::size_t a = 0; a < 4; ++a) {
      if (v[a] < 0 || static_cast<std::size_t>(v[a]) >= points_.size())
        invalid(name + ": node " + std::to_string(v[a]) + " is out of range (the mesh has " +
                std::to_string(points_.size()) + " nodes)");
      for (std::size_t b = 0; b < a; ++b)
        if (v[a] == v[b]) invalid(name + ": node " + std::to_string(v[a]) + " is repeated");
    }
    double longest = 0;
    for (std::size_t a = 0; a < 4; ++a)
      for (std::size_t b = 0; b < a; ++b) longest = std::max(longest, (point(v[a]) - point(v[b])).norm());
    const double V = volume(t);
    // Rounding of the coordinates alone moves the volume by about 1e-16 longest^3; four digits above that no
    // shape function gradient could be trusted.
    if (std::abs(V) <= 1e-12 * longest * longest * longest)
      invalid(name + ": degenerate, volume " + to_text(V) + " m^3 at longest edge " + to_text(longest) +
              " m");
    if (V < 0) invalid(name + ": inverted, volume " + to_text(V) + " m^3 is not positive");
  }

  void drop_unused_nodes() {
    std::vector<std::int32_t> number(points_.size(), -1);
    for (const Tetrahedron& v : tetrahedra_)
      for (const std::int32_t i : v) number[static_cast<std::size_t>(i)] = 0;
    for (std::size_t i = 0; i < points_.size(); ++i)
      if (number[i] == 0) {
        number[i] = static_cast<std::int32_t>(source_node_.size());
        points_[source_node_.size()] = points_[i];
        source_node_.push_back(static_cast<std::int32_t>(i));
      }
    const std::size_t unused = points_.size() - source_node_.size();
    if (unused == 0) return;
    points_.resize(source_node_.size());
    for (Tetrahedron& v : tetrahedra_)
      for (std::int32_t& i : v) i = number[static_cast<std::size_t>(i)];
    warnings_.push_back(std::to_string(unused) + " node" + (unused == 1 ? "" : "s") +
                        " dropped that no tetrahedron uses");
  }

  std::vector<Vec3<double>> points_;
  std::vector<Tetrahedron> tetrahedra_;
  std::vector<int> region_;
  std::vector<std::int32_t> source_node_;
  std::vector<std::string> warnings_;
};

/// Faces that belong to one tetrahedron only, seen counter-clockwise from outside.
[[nodiscard]] inline std::vector<Triangle> boundary_triangles(const TetrahedralMesh& mesh) {
  constexpr std::array<std::array<std::size_t, 3>, 4> faces{{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};
  std::map<Triangle, std::pair<Triangle, int>> count;
  for (const Tetrahedron& v : mesh.tetrahedra())
    for (const auto& f : faces) {
      const Triangle face{v[f[0]], v[f[1]], v[f[2]]};
      Triangle key = face;
      std::sort(key.begin(), key.end());
      auto& entry = count[key];
      entry.first = face;
      ++entry.second;
    }
  std::vector<Triangle> result;
  for (const auto& [key, entry] : count)
    if (entry.second == 1) result.push_back(entry.first);
  return result;
}

}  // namespace softsim
