// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "softsim/core/error.hpp"
#include "softsim/core/tensor.hpp"

namespace softsim {

/// Anything with node positions at rest: what supports, selections and a `System` need of a mesh.
template <class M>
concept PointMesh = requires(const M& mesh) {
  { mesh.points() } -> std::same_as<const std::vector<Vec3<double>>&>;
};

/// A mesh of like solid elements that knows the integrals of its shape functions at rest: what mass and
/// weight need. `shape_integrals(e)` are int N_i dV in m^3, `shape_products(e)` int N_i N_j dV in m^3,
/// `lumped_volumes(e)` the positive parts of the volume that a lumped mass puts on the nodes.
template <class M>
concept SolidMesh = PointMesh<M> && requires(const M& mesh, std::size_t e) {
  { mesh.elements()[e][0] } -> std::convertible_to<std::int32_t>;
  { mesh.volume(e) } -> std::convertible_to<double>;
  { mesh.shape_integrals(e)[0] } -> std::convertible_to<double>;
  { mesh.lumped_volumes(e)[0] } -> std::convertible_to<double>;
  { mesh.shape_products(e)(0, 0) } -> std::convertible_to<double>;
  { M::name.plural } -> std::convertible_to<const char*>;
};

/// What messages call an element.
struct ElementName {
  const char *singular, *plural;
};

/// Nodes and elements of n nodes each, checked: all node numbers exist, every element has different nodes,
/// and every node belongs to an element. The base of the meshes, which add the checks of their geometry.
template <std::size_t n>
class ElementMesh {
 public:
  /// Node numbers of one element.
  using Element = std::array<std::int32_t, n>;

  /// Node positions at rest in m.
  [[nodiscard]] const std::vector<Vec3<double>>& points() const { return points_; }
  /// Node numbers of each element.
  [[nodiscard]] const std::vector<Element>& elements() const { return elements_; }
  /// Rest positions in m of the nodes of element e.
  [[nodiscard]] std::array<Vec3<double>, n> element_points(std::size_t e) const {
    std::array<Vec3<double>, n> X;
    for (std::size_t i = 0; i < n; ++i) X[i] = points_[static_cast<std::size_t>(elements_[e][i])];
    return X;
  }
  /// Region number of each element.
  [[nodiscard]] const std::vector<int>& region() const { return region_; }
  /// Number in the input of each node that was kept.
  [[nodiscard]] const std::vector<std::int32_t>& source_node() const { return source_node_; }
  /// What was put right on the way in, one sentence each; empty for a clean mesh.
  [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }

 protected:
  /// Nodes that no element uses are dropped, the rest keep their order.
  /// @throws std::invalid_argument naming the node or element: no elements, coordinates that are not finite,
  ///   node numbers out of range or repeated, a region list of another length
  ElementMesh(const ElementName& name, std::vector<Vec3<double>> points, std::vector<Element> elements,
              std::vector<int> region)
      : points_(std::move(points)), elements_(std::move(elements)), region_(std::move(region)) {
    if (elements_.empty()) invalid(std::string("mesh: no ") + name.plural);
    if (region_.empty()) region_.assign(elements_.size(), 0);
    if (region_.size() != elements_.size())
      invalid(std::string("mesh: ") + std::to_string(region_.size()) + " region numbers for " +
              std::to_string(elements_.size()) + " " + name.plural);
    for (std::size_t i = 0; i < points_.size(); ++i)
      if (!points_[i].allFinite())
        invalid(std::string("node ") + std::to_string(i) + ": a coordinate is not a finite number");
    for (std::size_t e = 0; e < elements_.size(); ++e) check_numbers(name, e);
    drop_unused_nodes(name);
  }

 private:
  void check_numbers(const ElementName& name, std::size_t e) const {
    const Element& v = elements_[e];
    const auto fail = [&](std::int32_t node, const std::string& what) {
      invalid(std::string(name.singular) + " " + std::to_string(e) + ": node " + std::to_string(node) + what);
    };
    for (std::size_t a = 0; a < n; ++a) {
      if (v[a] < 0 || static_cast<std::size_t>(v[a]) >= points_.size())
        fail(v[a],
             std::string(" is out of range (the mesh has ") + std::to_string(points_.size()) + " nodes)");
      for (std::size_t b = 0; b < a; ++b)
        if (v[a] == v[b]) fail(v[a], " is repeated");
    }
  }

  void drop_unused_nodes(const ElementName& name) {
    std::vector<std::int32_t> number(points_.size(), -1);
    for (const Element& v : elements_)
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
    for (Element& v : elements_)
      for (std::int32_t& i : v) i = number[static_cast<std::size_t>(i)];
    warnings_.push_back(std::to_string(unused) + " node" + (unused == 1 ? "" : "s") + " dropped that no " +
                        name.singular + " uses");
  }

  std::vector<Vec3<double>> points_;
  std::vector<Element> elements_;
  std::vector<int> region_;
  std::vector<std::int32_t> source_node_;
  std::vector<std::string> warnings_;
};

}  // namespace softsim
