// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "softsim/io/element_list.hpp"
#include "softsim/io/text.hpp"
#include "softsim/io/vtk_cells.hpp"
#include "softsim/io/xml.hpp"
#include "softsim/mesh/tetrahedral_mesh.hpp"

namespace softsim {
namespace detail {

/// Reads the pieces of a parsed .vtu file.
class VtuReader {
 public:
  VtuReader(const std::string& path, std::string_view text, const std::string& cell_array)
      : path_(path), text_(text), wanted_(cell_array) {}

  [[nodiscard]] ElementList read() {
    const XmlElement root = XmlParser(path_, text_).parse();
    if (root.name != "VTKFile")
      root.at.fail(std::string("<") + root.name + "> stands where <VTKFile> was expected");
    if (root.required("type") != "UnstructuredGrid")
      root.at.fail(std::string("file type ") + in_quotes(root.required("type")) +
                   " is not read, only UnstructuredGrid");
    const XmlElement& grid = root.required_child("UnstructuredGrid");
    bool any = false;
    for (const XmlElement& element : grid.children)
      if (element.name == "Piece") {
        piece(element);
        any = true;
      }
    if (!any) grid.at.fail("<UnstructuredGrid> holds no <Piece>");
    return std::move(list_);
  }

 private:
  std::size_t size(const XmlElement& element, const char* key) const {
    Scanner value(path_, element.required(key), element.at.line_number());
    const std::size_t n = value.count(key, text_.size() / 2);
    value.finish();
    return n;
  }

  /// The array of that name; with an empty name the only one.
  static const XmlElement* array(const XmlElement& parent, std::string_view name) {
    const XmlElement* found = nullptr;
    for (const XmlElement& element : parent.children) {
      if (element.name != "DataArray") continue;
      const std::string* its_name = element.attribute("Name");
      if (!name.empty() && (its_name == nullptr || *its_name != name)) continue;
      if (found != nullptr)
        element.at.fail(std::string("a second <DataArray> ") + std::string(name) + " in <" + parent.name +
                        ">");
      found = &element;
    }
    return found;
  }
  static const XmlElement& required_array(const XmlElement& parent, std::string_view name) {
    const XmlElement* found = array(parent, name);
    if (found == nullptr)
      parent.at.fail(std::string("<") + parent.name + "> holds no <DataArray> " + std::string(name));
    return *found;
  }

  /// Checks that a data array is ASCII, of a numeric type and has the given number of components.
  static void check(const XmlElement& data, std::string_view components) {
    const std::string* format = data.attribute("format");
    if (format != nullptr && *format != "ascii")
      data.at.fail(std::string("the data are binary (format ") + in_quotes(*format) +
                   "); write the file as ASCII or convert it with meshio");
    const std::string& type = data.required("type");
    constexpr std::string_view types[] = {"Float32", "Float64", "Int8",   "Int16",  "Int32",
                                          "Int64",   "UInt8",   "UInt16", "UInt32", "UInt64"};
    if (std::find(std::begin(types), std::end(types), type) == std::end(types))
      data.at.fail(std::string("data type ") + in_quotes(type) + " is not numeric");
    const std::string* found = data.attribute("NumberOfComponents");
    if (found != nullptr && *found != components)
      data.at.fail(std::string("NumberOfComponents ") + in_quotes(*found) + " stands where " +
                   std::string(components) + " was expected");
  }

  /// Calls read(scanner) `n` times, each of which takes one value, and refuses another number of values.
  template <class Read>
  static void values(const XmlElement& data, std::size_t n, Read read) {
    std::size_t found = 0;
    for (Scanner stretch : data.text)
      while (!stretch.at_end()) {
        if (found++ == n)
          stretch.fail(in_quotes(stretch.peek()) + " is one value more than the expected " +
                       std::to_string(n));
        read(stretch);
      }
    if (found < n)
      data.at.fail(std::string("<DataArray> holds ") + std::to_string(found) + " values, not the expected " +
                   std::to_string(n));
  }

  void piece(const XmlElement& element) {
    const std::size_t n_points = size(element, "NumberOfPoints"), n_cells = size(element, "NumberOfCells");
    const std::size_t first = list_.points.size();
    points(element, n_points);
    if (list_.points.size() > 2147483647) element.at.fail("the file has more points than fit 32-bit numbers");

    const XmlElement empty{"CellData", element.at, {}, {}, {}};
    const XmlElement* cell_data = element.child("CellData");
    VtkCells cells;
    regions(cell_data == nullptr ? empty : *cell_data, n_cells, cells);
    if (n_cells == 0) return;
    const XmlElement& parent = element.required_child("Cells");
    connectivity(parent, n_points, n_cells, cells);
    const XmlElement& types = required_array(parent, "types");
    check(types, "1");
    std::size_t c = 0;
    values(types, n_cells, [&](Scanner& from) {
      const int type = static_cast<int>(from.integer("cell type", 0, 255));
      cells.take(c++, type, static_cast<std::int32_t>(first), from, list_);
    });
  }

  void points(const XmlElement& element, std::size_t n) {
    if (n == 0) return;
    const XmlElement& data = required_array(element.required_child("Points"), "");
    check(data, "3");
    Vec3<double> x;
    Eigen::Index axis = 0;
    values(data, 3 * n, [&](Scanner& from) {
      x[axis] = from.real("coordinate");
      axis = (axis + 1) % 3;
      if (axis == 0) list_.points.push_back(x);
    });
  }

  static void connectivity(const XmlElement& parent, std::size_t n_points, std::size_t n_cells,
                           VtkCells& cells) {
    const XmlElement& offsets = required_array(parent, "offsets");
    check(offsets, "1");
    values(offsets, n_cells, [&](Scanner& from) {
      const auto before = static_cast<long long>(cells.end.empty() ? 0 : cells.end.back());
      cells.end.push_back(static_cast<std::size_t>(from.integer("offset", before, 2147483647)));
    });
    const XmlElement& data = required_array(parent, "connectivity");
    check(data, "1");
    values(data, cells.end.back(), [&](Scanner& from) {
      const auto id = from.integer("point number", 0, static_cast<long long>(n_points) - 1);
      // Cells without points share the line of the next cell that has some.
      while (cells.line.size() < n_cells &&
             (cells.line.empty() ? 0 : cells.end[cells.line.size() - 1]) <= cells.connectivity.size())
        cells.line.push_back(from.line_number());
      cells.connectivity.push_back(static_cast<std::int32_t>(id));
    });
    cells.line.resize(n_cells, data.at.line_number());
  }

  void regions(const XmlElement& cell_data, std::size_t n, VtkCells& cells) const {
    if (wanted_.empty()) return;
    const XmlElement* data = array(cell_data, wanted_);
    if (data == nullptr) {
      std::vector<std::string> present;
      for (const XmlElement& other : cell_data.children)
        if (const std::string* name = other.attribute("Name")) present.push_back(*name);
      refuse_cell_array(path_, wanted_, present);
    }
    check(*data, "1");
    values(*data, n, [&](Scanner& from) { cells.region.push_back(from.integer_valued("region number")); });
  }

  const std::string& path_;
  std::string_view text_;
  const std::string& wanted_;
  ElementList list_;
};

}  // namespace detail

/// Reads the tetrahedra (type 10) of an ASCII .vtu file. The points of several pieces follow each other and
/// are not merged: pieces that touch stay unconnected. Points, lines and surface cells and all data but
/// `cell_array` are passed over. Lengths are taken as m.
/// @param cell_array name of the integer-valued cell array that holds the regions; empty means region 0
///   everywhere
/// @throws std::invalid_argument "path, line n: ..." for anything else, volume cells of another kind among it
/// Format: "VTK XML Formats", VTK documentation.
[[nodiscard]] inline TetrahedralMesh read_vtu(const std::string& path, const std::string& cell_array = {}) {
  const std::string text = detail::read_text(path);
  return detail::VtuReader(path, text, cell_array).read().mesh(path);
}

}  // namespace softsim
