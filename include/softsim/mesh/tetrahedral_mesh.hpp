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
#include "softsim/mesh/element_mesh.hpp"

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
class TetrahedralMesh : public ElementMesh<4> {
 public:
  static constexpr ElementName name{"tetrahedron", "tetrahedra"};

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
      : ElementMesh(name, std::move(points), std::move(tetrahedra), std::move(region)) {
    for (std::size_t t = 0; t < elements().size(); ++t) check(t);
  }

  /// Node numbers of each tetrahedron.
  [[nodiscard]] const std::vector<Tetrahedron>& tetrahedra() const { return elements(); }

  /// Rest volume of tetrahedron t in m^3.
  [[nodiscard]] double volume(std::size_t t) const {
    const std::array<Vec3<double>, 4> X = element_points(t);
    return tetrahedron_volume(X[0], X[1], X[2], X[3]);
  }
  /// Rest volume of the body in m^3.
  [[nodiscard]] double volume() const {
    double sum = 0;
    for (std::size_t t = 0; t < elements().size(); ++t) sum += volume(t);
    return sum;
  }

  /// int N_i dV of the linear shape functions of tetrahedron t: a quarter of its volume each, m^3.
  [[nodiscard]] std::array<double, 4> shape_integrals(std::size_t t) const {
    const double quarter = volume(t) / 4;
    return {quarter, quarter, quarter, quarter};
  }
  /// Volume per node that a lumped mass uses: the same quarters, m^3.
  [[nodiscard]] std::array<double, 4> lumped_volumes(std::size_t t) const { return shape_integrals(t); }
  /// int N_i N_j dV: V/10 on the diagonal, V/20 beside it, m^3.
  [[nodiscard]] Eigen::Matrix4d shape_products(std::size_t t) const {
    Eigen::Matrix4d products = Eigen::Matrix4d::Constant(volume(t) / 20);
    products.diagonal() *= 2;
    return products;
  }

 private:
  void check(std::size_t t) const {
    const std::string which = std::string(name.singular) + " " + std::to_string(t);
    const std::array<Vec3<double>, 4> X = element_points(t);
    double longest = 0;
    for (std::size_t a = 0; a < 4; ++a)
      for (std::size_t b = 0; b < a; ++b) longest = std::max(longest, (X[a] - X[b]).norm());
    const double V = volume(t);
    // Rounding of the coordinates alone moves the volume by about 1e-16 longest^3; four digits above that no
    // shape function gradient could be trusted.
    if (std::abs(V) <= 1e-12 * longest * longest * longest)
      invalid(which + ": degenerate, volume " + to_text(V) + " m^3 at longest edge " + to_text(longest) +
              " m");
    if (V < 0) invalid(which + ": inverted, volume " + to_text(V) + " m^3 is not positive");
  }
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
