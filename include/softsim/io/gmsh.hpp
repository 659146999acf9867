// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "softsim/io/element_list.hpp"
#include "softsim/io/text.hpp"
#include "softsim/mesh/tetrahedral_mesh.hpp"

namespace softsim {
namespace detail {

/// An element type of Gmsh: its number of nodes, and for a volume its name. Points, lines and surfaces have
/// none.
struct GmshType {
  int number, nodes;
  std::string_view volume;
};
inline constexpr int gmsh_tetrahedron = 4;
// clang-format off
inline constexpr GmshType gmsh_types[] = {
    {15, 1, {}}, {1, 2, {}}, {8, 3, {}}, {26, 4, {}}, {27, 5, {}}, {28, 6, {}},  // points and lines
    {2, 3, {}}, {9, 6, {}}, {20, 9, {}}, {21, 10, {}}, {22, 12, {}}, {23, 15, {}}, {24, 15, {}}, {25, 21, {}},
    {3, 4, {}}, {10, 9, {}}, {16, 8, {}}, {36, 16, {}}, {37, 25, {}}, {38, 36, {}},  // quadrilaterals
    {4, 4, "tetrahedron"}, {11, 10, "ten-node tetrahedron"}, {29, 20, "20-node tetrahedron"},
    {30, 35, "35-node tetrahedron"}, {31, 56, "56-node tetrahedron"},
    {5, 8, "hexahedron"}, {12, 27, "27-node hexahedron"}, {17, 20, "20-node hexahedron"},
    {6, 6, "prism"}, {13, 18, "18-node prism"}, {18, 15, "15-node prism"},
    {7, 5, "pyramid"}, {14, 14, "14-node pyramid"}, {19, 13, "13-node pyramid"}};
// clang-format on

/// Reads the sections of a Gmsh file in the order in which they come.
class GmshReader {
 public:
  GmshReader(const std::string& path, std::string_view text) : file_(path, text) {}

  [[nodiscard]] ElementList read() {
    while (!file_.at_end()) {
      Scanner header = file_.line("a section");
      const std::string name(header.word("section name"));
      if (name[0] != '$')
        header.fail(in_quotes(name) + " stands outside of a section such as $Nodes ... $EndNodes");
      header.finish();
      section(name, header);
    }
    if (!have_nodes_) file_.fail("the file has no $Nodes section");
    if (!have_elements_) file_.fail("the file has no $Elements section");
    return std::move(list_);
  }

 private:
  void section(const std::string& name, const Scanner& header) {
    const bool old = name == "$NOD" || name == "$ELM";
    if (old || name == "$Nodes" || name == "$Elements") {
      if (old && version_ != 0) header.fail(name + " belongs to format 1, but $MeshFormat names another");
      if (!old && version_ == 0) header.fail(name + " needs a $MeshFormat section before it");
      bool& seen = name == "$NOD" || name == "$Nodes" ? have_nodes_ : have_elements_;
      if (seen) header.fail(std::string("a second ") + name + " section");
      seen = true;
      if (!have_nodes_) header.fail(name + " stands before the nodes");
      if (&seen == &have_nodes_)
        version_ == 4 ? nodes_4() : nodes();
      else
        version_ == 4 ? elements_4() : elements();
      end((old ? "$END" : "$End") + name.substr(1));
    } else if (name == "$MeshFormat") {
      if (version_ != 0 || have_nodes_) header.fail("a late or second $MeshFormat section");
      format();
      end("$EndMeshFormat");
    } else if (name == "$Entities" && version_ == 4) {
      entities();
      end("$EndEntities");
    } else if (name == "$PartitionedEntities") {
      header.fail("a partitioned mesh, whose regions are not known; save it unpartitioned");
    } else {
      skip(std::string("$End") + name.substr(1), std::string("$END") + name.substr(1), header);
    }
  }

  void format() {
    Scanner record = file_.line("the format version");
    const std::string_view version = record.word("format version");
    if (version == "4.1")
      version_ = 4;
    else if (version == "2" || version == "2.0" || version == "2.1" || version == "2.2")
      version_ = 2;
    else
      record.fail(std::string("format version ") + in_quotes(version) +
                  " is not read; save the mesh as version 4.1 or 2.2");
    if (record.integer("file type", 0, 1) == 1)
      record.fail("the file is binary; write it as ASCII or convert it with meshio");
    record.integer("data size", 1, 16);
    record.finish();
  }

  void skip(const std::string& end_name, const std::string& other_end_name, const Scanner& header) {
    while (!file_.at_end()) {
      const std::string_view w = file_.rest_of_line().peek();
      if (w == end_name || w == other_end_name) return;
    }
    header.fail(end_name + " is missing");
  }

  void end(const std::string& name) {
    Scanner record = file_.line(name);
    const std::string_view w = record.word(name);
    if (w != name) record.fail(in_quotes(w) + " stands where " + name + " was expected");
    record.finish();
  }

  /// The line of entry i of n.
  Scanner record(const char* what, std::size_t i, std::size_t n) {
    const auto which = [&] {
      return what + (std::string(" ") + std::to_string(i + 1)) + " of " + std::to_string(n);
    };
    if (file_.at_end()) file_.fail(std::string("the file ends where ") + which() + " was expected");
    Scanner line = file_.rest_of_line();
    if (line.peek().front() == '$')
      line.fail(in_quotes(line.peek()) + " stands where " + which() + " was expected");
    return line;
  }

  long long number(Scanner& from, const char* what) {
    return from.integer(what, 0, std::numeric_limits<long long>::max());
  }
  int region(Scanner& from) {
    using Limits = std::numeric_limits<int>;
    return static_cast<int>(from.integer("region number", Limits::min(), Limits::max()));
  }

  void add_node(const Scanner& at, long long id) {
    if (!index_.emplace(id, static_cast<std::int32_t>(index_.size())).second)
      at.fail(std::string("node number ") + std::to_string(id) + " is repeated");
  }
  void add_point(Scanner& from) {
    const double x = from.real("x coordinate"), y = from.real("y coordinate"), z = from.real("z coordinate");
    list_.points.emplace_back(x, y, z);
  }

  void nodes() {
    Scanner head = file_.line("the number of nodes");
    const std::size_t n = head.count("number of nodes", file_.room(4));
    head.finish();
    index_.reserve(n);
    list_.points.reserve(n);
    for (std::size_t i = 0; i < n; ++i) {
      Scanner line = record("node", i, n);
      add_node(line, number(line, "node number"));
      add_point(line);
      line.finish();
    }
  }

  void nodes_4() {
    const auto [blocks, n] = block_totals("number of nodes", 4);
    index_.reserve(n);
    list_.points.reserve(n);
    for (std::size_t b = 0; b < blocks; ++b) {
      Scanner head = record("node block", b, blocks);
      const long long dimension = head.integer("entity dimension", 0, 3);
      region(head);
      const long long parameters = head.integer("parametric flag", 0, 1) * dimension;
      const std::size_t in_block = head.count("number of nodes in the block", n - list_.points.size());
      head.finish();
      for (std::size_t i = 0; i < in_block; ++i) {
        Scanner line = record("node number", i, in_block);
        add_node(line, number(line, "node number"));
        line.finish();
      }
      for (std::size_t i = 0; i < in_block; ++i) {
        Scanner line = record("node", i, in_block);
        add_point(line);
        for (long long p = 0; p < parameters; ++p) line.real("parametric coordinate");
        line.finish();
      }
    }
    if (list_.points.size() != n)
      file_.fail(std::string("the node blocks hold ") + std::to_string(list_.points.size()) +
                 " nodes, not the announced " + std::to_string(n));
  }

  void elements() {
    Scanner head = file_.line("the number of elements");
    const std::size_t n = head.count("number of elements", file_.room(version_ == 0 ? 6 : 4));
    head.finish();
    for (std::size_t i = 0; i < n; ++i) {
      Scanner line = record("element", i, n);
      const long long id = number(line, "element number");
      const GmshType& type = element_type(line);
      int first_tag = 0;
      if (version_ == 0) {
        first_tag = region(line);
        region(line);
        line.integer("number of nodes", type.nodes, type.nodes);
      } else {
        const std::size_t tags = line.count("number of tags", line.room(1));
        for (std::size_t t = 0; t < tags; ++t) {
          const int tag = region(line);
          if (t == 0) first_tag = tag;
        }
      }
      element(line, id, type, first_tag);
    }
  }

  void elements_4() {
    const auto [blocks, n] = block_totals("number of elements", 2);
    std::size_t found = 0;
    for (std::size_t b = 0; b < blocks; ++b) {
      Scanner head = record("element block", b, blocks);
      head.integer("entity dimension", 0, 3);
      const int entity = region(head);
      const GmshType& type = element_type(head);
      const std::size_t in_block = head.count("number of elements in the block", n - found);
      head.finish();
      const auto physical = physical_group_.find(entity);
      const int group = physical == physical_group_.end() ? entity : physical->second;
      for (std::size_t i = 0; i < in_block; ++i) {
        Scanner line = record("element", i, in_block);
        const long long id = number(line, "element number");
        element(line, id, type, group);
      }
      found += in_block;
    }
    if (found != n)
      file_.fail(std::string("the element blocks hold ") + std::to_string(found) +
                 " elements, not the announced " + std::to_string(n));
  }

  std::pair<std::size_t, std::size_t> block_totals(const char* what, std::size_t words) {
    Scanner head = file_.line(what);
    const std::size_t blocks = head.count("number of blocks", file_.room(4));
    const std::size_t n = head.count(what, file_.room(words));
    number(head, "smallest number");
    number(head, "largest number");
    head.finish();
    return {blocks, n};
  }

  /// Only the volumes matter: their physical groups are the regions.
  void entities() {
    Scanner head = file_.line("the numbers of entities");
    std::array<std::size_t, 4> count{};
    for (std::size_t& c : count) c = head.count("number of entities", file_.room(5));
    head.finish();
    for (std::size_t d = 0; d < 4; ++d)
      for (std::size_t i = 0; i < count[d]; ++i) {
        Scanner line = record("entity", i, count[d]);
        if (d < 3) continue;
        const int entity = region(line);
        for (int b = 0; b < 6; ++b) line.word("bounding box");
        const std::size_t groups = line.count("number of physical groups", line.room(1));
        for (std::size_t g = 0; g < groups; ++g) {
          const int group = region(line);
          if (g == 0) physical_group_.emplace(entity, group);
        }
      }
  }

  const GmshType& element_type(Scanner& from) {
    const long long wanted = from.integer("element type", 0, std::numeric_limits<int>::max());
    for (const GmshType& type : gmsh_types) {
      if (type.number != wanted) continue;
      if (!type.volume.empty() && wanted != gmsh_tetrahedron)
        from.fail(std::string("a ") + std::string(type.volume) + " (element type " + std::to_string(wanted) +
                  "), but only four-node tetrahedra are read; mesh the volume with those");
      return type;
    }
    from.fail(std::string("element type '") + std::to_string(wanted) + "' is not known");
  }

  void element(Scanner& line, long long id, const GmshType& type, int group) {
    if (!element_ids_.insert(id).second)
      line.fail(std::string("element number ") + std::to_string(id) + " is repeated");
    Tetrahedron nodes{};
    for (std::size_t a = 0; a < static_cast<std::size_t>(type.nodes); ++a) {
      const long long node = number(line, "node number");
      const auto found = index_.find(node);
      if (found == index_.end())
        line.fail(std::string("node number '") + std::to_string(node) + "' is not among the nodes");
      if (type.number != gmsh_tetrahedron) continue;
      for (std::size_t b = 0; b < a; ++b)
        if (nodes[b] == found->second)
          line.fail(std::string("node number '") + std::to_string(node) + "' is repeated");
      nodes[a] = found->second;
    }
    line.finish();
    if (type.number == gmsh_tetrahedron)
      list_.add(nodes, group, line.line_number());
    else
      ++list_.skipped;
  }

  Scanner file_;
  ElementList list_;
  int version_ = 0;  ///< major version that $MeshFormat names; 0 without it, which is format 1
  bool have_nodes_ = false, have_elements_ = false;
  std::unordered_map<long long, std::int32_t> index_;
  std::unordered_set<long long> element_ids_;
  std::unordered_map<int, int> physical_group_;
};

}  // namespace detail

/// Reads the tetrahedra of a Gmsh ASCII file: format 1 ($NOD, $ELM), 2.0 to 2.2 or 4.1. The region is the
/// element's physical group: reg-phys in format 1, the first tag in format 2, the first group of the volume
/// in format 4.1, or the volume's own number if it has none. Points, lines and surface elements are passed
/// over, as are sections that are not needed ($PhysicalNames, $NodeData, ...). Lengths are taken as m.
/// @throws std::invalid_argument "path, line n: ..." for anything else, volume elements of another kind among
///   it; tetrahedra in messages count from 0 in the order of the file
/// Formats: Gmsh reference manual, "MSH file format" and "MSH file format version 1 / 2 (Legacy)".
[[nodiscard]] inline TetrahedralMesh read_gmsh(const std::string& path) {
  const std::string text = detail::read_text(path);
  return detail::GmshReader(path, text).read().mesh(path);
}

}  // namespace softsim
