// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <charconv>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "softsim/io/element_list.hpp"
#include "softsim/io/text.hpp"
#include "softsim/io/vtk_cells.hpp"
#include "softsim/mesh/tetrahedral_mesh.hpp"

namespace softsim {
namespace detail {

/// Reads the keywords of a legacy VTK file in the order in which they come.
class VtkLegacyReader {
 public:
  VtkLegacyReader(const std::string& path, std::string_view text, const std::string& cell_array)
      : path_(path), wanted_(cell_array), file_(path, text) {}

  [[nodiscard]] ElementList read() {
    header();
    while (!file_.at_end()) {
      const Scanner at = file_;
      const std::string keyword = lower(file_.word("keyword"));
      if (keyword == "points")
        points();
      else if (keyword == "cells")
        cells(at);
      else if (keyword == "cell_types")
        cell_types(at);
      else if (keyword == "cell_data")
        begin_data(Data::cells, cells_.end.size(), have_cells_, at);
      else if (keyword == "point_data")
        begin_data(Data::points, list_.points.size(), have_points_, at);
      else if (keyword == "field")
        field();
      else if (keyword == "metadata")
        metadata();
      else if (data_ == Data::none || !attribute(keyword))
        at.fail(std::string("keyword ") + in_quotes(keyword) + " is not known");
    }
    if (!have_points_) file_.fail("the file has no POINTS");
    if (!have_cells_) file_.fail("the file has no CELLS");
    if (types_.empty()) file_.fail("the file has no CELL_TYPES");
    if (!wanted_.empty() && !found_) refuse_cell_array(path_, wanted_, present_);
    for (std::size_t c = 0; c < types_.size(); ++c)
      cells_.take(c, types_[c].first, 0, types_[c].second, list_);
    return std::move(list_);
  }

 private:
  enum class Data { none, points, cells };

  static std::string lower(std::string_view word) {
    std::string text(word);
    for (char& c : text)
      if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return text;
  }

  /// VTK writes blanks and other odd characters of a name as %20 and the like.
  static std::string decoded(std::string_view name) {
    std::string text;
    for (std::size_t i = 0; i < name.size(); ++i) {
      unsigned char code = 0;
      const char* digits = name.data() + i + 1;
      if (name[i] == '%' && i + 2 < name.size() &&
          std::from_chars(digits, digits + 2, code, 16).ptr == digits + 2) {
        text += static_cast<char>(code);
        i += 2;
      } else {
        text += name[i];
      }
    }
    return text;
  }

  void header() {
    Scanner magic = file_.rest_of_line();
    if (magic.peek() != "#" || magic.word("#") != "#" || lower(magic.peek()) != "vtk")
      magic.fail(in_quotes(magic.peek()) + " stands where '# vtk DataFile Version' was expected");
    file_.rest_of_line();
    Scanner encoding = file_.line("ASCII");
    const std::string kind = lower(encoding.word("ASCII"));
    if (kind == "binary") encoding.fail("the file is binary; write it as ASCII or convert it with meshio");
    if (kind != "ascii") encoding.fail(in_quotes(kind) + " stands where ASCII was expected");
    encoding.finish();
    Scanner dataset = file_.line("DATASET UNSTRUCTURED_GRID");
    const std::string_view keyword = dataset.word("DATASET");
    if (lower(keyword) != "dataset") dataset.fail(in_quotes(keyword) + " stands where DATASET was expected");
    const std::string_view type = dataset.word("dataset type");
    if (lower(type) != "unstructured_grid")
      dataset.fail(std::string("dataset type ") + in_quotes(type) + " is not read, only UNSTRUCTURED_GRID");
    dataset.finish();
  }

  /// A last number that the end of the file cuts short would pass for another number.
  void refuse_open_end() const {
    if (file_.exhausted())
      file_.fail("the file ends right after a number, without a line end, and may be truncated");
  }

  void points() {
    if (have_points_) file_.fail("a second POINTS");
    have_points_ = true;
    const std::size_t n = file_.count("number of points", file_.room(3));
    file_.word("point type");
    list_.points.reserve(n);
    for (std::size_t i = 0; i < n; ++i) {
      const double x = file_.real("x coordinate"), y = file_.real("y coordinate"),
                   z = file_.real("z coordinate");
      list_.points.emplace_back(x, y, z);
    }
    refuse_open_end();
  }

  void cells(const Scanner& at) {
    if (!have_points_) at.fail("CELLS stands before POINTS");
    if (have_cells_) at.fail("a second CELLS");
    have_cells_ = true;
    const std::size_t n = file_.count("number of cells", file_.room(1));
    const std::size_t size = file_.count("size of the cell list", file_.room(1));
    cells_.connectivity.reserve(size);
    cells_.end.reserve(n);
    cells_.line.reserve(n);
    lower(file_.peek()) == "offsets" ? cells_5(n, size) : cells_list(n, size);
    refuse_open_end();
  }

  void point_number() {
    const auto last = static_cast<long long>(list_.points.size()) - 1;
    cells_.connectivity.push_back(static_cast<std::int32_t>(file_.integer("point number", 0, last)));
  }

  /// n times: number of points, points.
  void cells_list(std::size_t n, std::size_t size) {
    std::size_t left = size;
    for (std::size_t c = 0; c < n; ++c) {
      if (left == 0)
        file_.fail(std::string("the cell list is full after ") + std::to_string(c) + " of " +
                   std::to_string(n) + " cells");
      const std::size_t nodes = file_.count("number of points of a cell", left - 1);
      cells_.line.push_back(file_.line_number());
      for (std::size_t a = 0; a < nodes; ++a) point_number();
      cells_.end.push_back(cells_.connectivity.size());
      left -= nodes + 1;
    }
    if (left != 0)
      file_.fail(std::string("the cell list is ") + std::to_string(left) +
                 " entries shorter than its size says");
  }

  /// VTK 5.1: n - 1 cells, of which the first entry of OFFSETS is 0 and the following say where each ends.
  void cells_5(std::size_t n, std::size_t size) {
    file_.word("OFFSETS");
    file_.word("type of OFFSETS");
    std::size_t before = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const auto lowest = static_cast<long long>(before);
      const auto highest = static_cast<long long>(i == 0 ? 0 : size);
      before = static_cast<std::size_t>(file_.integer("offset", lowest, highest));
      if (i > 0) cells_.end.push_back(before);
    }
    if (before != size)
      file_.fail(std::string("the last offset is ") + std::to_string(before) + ", but CELLS announces " +
                 std::to_string(size));
    const std::string_view keyword = file_.word("CONNECTIVITY");
    if (lower(keyword) != "connectivity")
      file_.fail(in_quotes(keyword) + " stands where CONNECTIVITY was expected");
    file_.word("type of CONNECTIVITY");
    for (const std::size_t end : cells_.end) {
      cells_.line.push_back(file_.next_line_number());
      while (cells_.connectivity.size() < end) point_number();
    }
  }

  void cell_types(const Scanner& at) {
    if (!have_cells_) at.fail("CELL_TYPES stands before CELLS");
    if (!types_.empty()) at.fail("a second CELL_TYPES");
    const std::size_t n = file_.count("number of cell types", file_.room(1));
    if (n != cells_.end.size())
      file_.fail(std::string("CELL_TYPES has ") + std::to_string(n) + " entries for " +
                 std::to_string(cells_.end.size()) + " cells");
    types_.reserve(n);
    for (std::size_t c = 0; c < n; ++c) {
      const int type = static_cast<int>(file_.integer("cell type", 0, 255));
      types_.emplace_back(type, file_);
    }
  }

  void begin_data(Data data, std::size_t expected, bool known, const Scanner& at) {
    if (!known) at.fail("data stand before the points or cells they belong to");
    const std::size_t n = file_.count("number of data", expected);
    if (n != expected)
      file_.fail(std::string("data for ") + std::to_string(n) + " entries, but there are " +
                 std::to_string(expected));
    data_ = data;
    data_size_ = n;
  }

  /// One array of n times `components` values; the wanted cell array is kept, others are passed over.
  void values(std::string_view name, std::size_t n, std::size_t components, std::string_view type) {
    if (data_ == Data::cells) present_.push_back(decoded(name));
    if (data_ == Data::cells && !wanted_.empty() && present_.back() == wanted_) {
      if (found_) file_.fail(std::string("a second cell array ") + in_quotes(wanted_));
      if (n != cells_.end.size() || components != 1)
        file_.fail(std::string("cell array ") + in_quotes(wanted_) + " has " + std::to_string(components) +
                   " components and " + std::to_string(n) + " entries, not one for each of the " +
                   std::to_string(cells_.end.size()) + " cells");
      found_ = true;
      cells_.region.reserve(n);
      for (std::size_t c = 0; c < n; ++c) cells_.region.push_back(file_.integer_valued("region number"));
      refuse_open_end();
    } else {
      const bool text = lower(type) == "string" || lower(type) == "variant";
      if (text) file_.rest_of_line();
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t c = 0; c < components; ++c)
          if (text)
            file_.exhausted() ? file_.fail("a text is missing") : void(file_.rest_of_line());
          else
            file_.word("value");
    }
  }

  void field() {
    file_.word("name of the field");
    const std::size_t arrays = file_.count("number of arrays", file_.room(4));
    for (std::size_t a = 0; a < arrays; ++a) {
      if (lower(file_.peek()) == "metadata") metadata();
      const std::string_view name = file_.word("name of an array");
      if (name == "NULL_ARRAY") continue;
      const std::size_t components = file_.count("number of components", file_.room(1));
      const std::size_t n = file_.count("number of entries", file_.room(1));
      values(name, n, components, file_.word("type of the values"));
    }
  }

  /// One attribute of POINT_DATA or CELL_DATA; false if the keyword is none.
  bool attribute(const std::string& keyword) {
    std::size_t components = 1;
    if (keyword == "vectors" || keyword == "normals")
      components = 3;
    else if (keyword == "tensors")
      components = 9;
    else if (keyword == "tensors6")
      components = 6;
    else if (keyword != "scalars" && keyword != "lookup_table" && keyword != "color_scalars" &&
             keyword != "texture_coordinates" && keyword != "global_ids" && keyword != "pedigree_ids" &&
             keyword != "edge_flags")
      return false;
    Scanner line = file_.rest_of_line();
    const std::string_view name = line.word("name of an array");
    std::size_t n = data_size_;
    std::string_view type = "float";
    if (keyword == "lookup_table") {
      n = line.count("size of the lookup table", file_.room(4));
      components = 4;
    } else if (keyword == "color_scalars" || keyword == "texture_coordinates") {
      components = line.count("number of components", file_.room(1));
    }
    if (keyword != "lookup_table" && keyword != "color_scalars") type = line.word("type of the values");
    if (keyword == "scalars") {
      if (!line.at_end()) components = line.count("number of components", file_.room(1));
      if (lower(file_.peek()) == "lookup_table") {
        Scanner table = file_.rest_of_line();
        table.word("LOOKUP_TABLE");
        table.word("name of the lookup table");
        table.finish();
      }
    }
    line.finish();
    if (keyword == "lookup_table") {
      for (std::size_t i = 0; i < n * components; ++i) file_.word("value");
    } else {
      values(name, n, components, type);
    }
    return true;
  }

  /// A block of notes that ends with a blank line.
  void metadata() {
    file_.rest_of_line();
    while (!file_.exhausted() && !file_.rest_of_line().at_end()) {
    }
  }

  const std::string& path_;
  const std::string& wanted_;
  Scanner file_;
  ElementList list_;
  VtkCells cells_;
  std::vector<std::pair<int, Scanner>> types_;
  bool have_points_ = false, have_cells_ = false, found_ = false;
  std::vector<std::string> present_;
  Data data_ = Data::none;
  std::size_t data_size_ = 0;
};

}  // namespace detail

/// Reads the tetrahedra (type 10) of an ASCII legacy .vtk file of an UNSTRUCTURED_GRID, with the cell list of
/// the versions up to 4.2 or the offsets and connectivity of 5.1. Points, lines and surface cells and all
/// data but `cell_array` are passed over. Lengths are taken as m.
/// @param cell_array name of the integer-valued cell array that holds the regions; empty means region 0
///   everywhere
/// @throws std::invalid_argument "path, line n: ..." for anything else, volume cells of another kind among it
/// Format: "VTK File Formats", "Simple Legacy Formats", VTK documentation.
[[nodiscard]] inline TetrahedralMesh read_vtk_legacy(const std::string& path,
                                                     const std::string& cell_array = {}) {
  const std::string text = detail::read_text(path);
  return detail::VtkLegacyReader(path, text, cell_array).read().mesh(path);
}

}  // namespace softsim
