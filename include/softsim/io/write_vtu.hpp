// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <bit>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "softsim/core/error.hpp"
#include "softsim/core/tensor.hpp"
#include "softsim/mesh/tetrahedral_mesh.hpp"

namespace softsim {

/// Values at the points or in the cells of a mesh, for display.
struct Field {
  std::string name;  ///< not empty, no control characters
  int components;    ///< 1 for scalars, 3 for vectors, 9 for tensors (row by row, as VTK shows them)
  std::vector<double> values;  ///< components times number of points or cells, component fastest
};

namespace detail {

/// A file that appears under its name complete or not at all: it is written under another name, then renamed.
class AtomicFile {
 public:
  explicit AtomicFile(const std::string& path)
      : path_(path), temporary_(path + ".part"), file_(std::fopen(temporary_.c_str(), "wb")) {
    if (file_ == nullptr) fail(errno);
  }
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;
  ~AtomicFile() { discard(); }

  void write(const void* data, std::size_t bytes) {
    if (bytes != 0 && std::fwrite(data, 1, bytes, file_) != bytes) fail(errno);
  }
  void write(std::string_view text) { write(text.data(), text.size()); }

  /// Gives the file its name.
  void commit() {
    std::FILE* file = std::exchange(file_, nullptr);
    if (std::fclose(file) != 0) fail(errno, true);
    if (std::rename(temporary_.c_str(), path_.c_str()) != 0) fail(errno, true);
  }

 private:
  [[noreturn]] void fail(int error, bool remains = false) {
    if (remains) std::remove(temporary_.c_str());
    discard();
    throw std::runtime_error(path_ + ": cannot be written (" + std::generic_category().message(error) + ")");
  }
  void discard() {
    if (file_ == nullptr) return;
    std::fclose(std::exchange(file_, nullptr));
    std::remove(temporary_.c_str());
  }

  std::string path_, temporary_;
  std::FILE* file_;
};

[[nodiscard]] inline std::string xml_escaped(std::string_view text) {
  std::string escaped;
  for (const char c : text) switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      default:
        escaped += c;
    }
  return escaped;
}

/// XML cannot hold control characters, escaped or not.
inline void check_xml_name(const std::string& what, const std::string& name) {
  if (name.empty()) invalid(what + ": its name is empty");
  for (const char c : name)
    if (c >= 0 && c < ' ')
      invalid(what + ": its name holds the control character " + std::to_string(static_cast<int>(c)));
}

inline constexpr const char* vtk_byte_order =
    std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian";

/// Collects the arrays of a .vtu file: first their descriptions, whose offsets count from the start of the
/// appended data, then the data, each block led by its length in bytes.
class AppendedArrays {
 public:
  template <class T>
  [[nodiscard]] std::string describe(const char* type, std::string_view name, int components, const T* data,
                                     std::size_t bytes) {
    std::string text = std::string("        <DataArray type=\"") + type + "\" Name=\"" + xml_escaped(name) +
                       "\" NumberOfComponents=\"" + std::to_string(components) +
                       "\" format=\"appended\" offset=\"" + std::to_string(offset_) + "\"/>\n";
    blocks_.emplace_back(data, bytes);
    offset_ += sizeof(std::uint64_t) + bytes;
    return text;
  }
  void write(AtomicFile& file) const {
    for (const auto& [data, bytes] : blocks_) {
      const std::uint64_t length = bytes;
      file.write(&length, sizeof length);
      file.write(data, bytes);
    }
  }

 private:
  std::vector<std::pair<const void*, std::size_t>> blocks_;
  std::size_t offset_ = 0;
};

inline std::string describe_fields(AppendedArrays& arrays, const std::vector<Field>& fields) {
  std::string text;
  for (const Field& field : fields)
    text += arrays.describe("Float64", field.name, field.components, field.values.data(),
                            field.values.size() * sizeof(double));
  return text;
}

inline void check_fields(const std::string& path, const char* where, const std::vector<Field>& fields,
                         std::size_t n) {
  for (std::size_t f = 0; f < fields.size(); ++f) {
    const Field& field = fields[f];
    check_xml_name(path + ": " + where + " field " + std::to_string(f), field.name);
    const std::string what = path + ": " + where + " field '" + field.name + "'";
    for (std::size_t g = 0; g < f; ++g)
      if (fields[g].name == field.name) invalid(what + ": the name is repeated");
    if (field.components < 1) invalid(what + ": " + std::to_string(field.components) + " components");
    if (field.values.size() != n * static_cast<std::size_t>(field.components))
      invalid(what + ": " + std::to_string(field.values.size()) + " values, expected " +
              std::to_string(field.components) + " for each of " + std::to_string(n) + " " + where + "s");
  }
}

}  // namespace detail

namespace detail {

struct VtuCell {
  std::uint8_t type;  ///< VTK's number
  const char* name;
};
/// The cell type of n nodes that this library writes.
template <std::size_t n>
inline constexpr VtuCell vtu_cell{};
template <>
inline constexpr VtuCell vtu_cell<1>{1, "vertex"};
template <>
inline constexpr VtuCell vtu_cell<4>{10, "tetrahedron"};
template <>
inline constexpr VtuCell vtu_cell<8>{12, "hexahedron"};
template <>
inline constexpr VtuCell vtu_cell<10>{24, "ten-node tetrahedron"};

template <std::size_t n>
void write_vtu_cells(const std::string& path, const std::vector<Vec3<double>>& points,
                     const std::vector<std::array<std::int32_t, n>>& cells,
                     const std::vector<Field>& point_fields, const std::vector<Field>& cell_fields) {
  check_fields(path, "point", point_fields, points.size());
  check_fields(path, "cell", cell_fields, cells.size());
  for (std::size_t c = 0; c < cells.size(); ++c)
    for (const std::int32_t node : cells[c])
      if (node < 0 || static_cast<std::size_t>(node) >= points.size())
        invalid(path + ": " + vtu_cell<n>.name + " " + std::to_string(c) + ": node " + std::to_string(node) +
                " is out of range (there are " + std::to_string(points.size()) + " points)");
  static_assert(sizeof(Vec3<double>) == 3 * sizeof(double) && sizeof(cells[0]) == n * sizeof(std::int32_t));

  std::vector<std::int64_t> offsets(cells.size());
  for (std::size_t c = 0; c < offsets.size(); ++c) offsets[c] = static_cast<std::int64_t>(n * (c + 1));
  const std::vector<std::uint8_t> types(cells.size(), vtu_cell<n>.type);

  AppendedArrays arrays;
  std::string head =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"";
  head += std::string(vtk_byte_order) + "\" header_type=\"UInt64\">\n  <UnstructuredGrid>\n";
  head += std::string("    <Piece NumberOfPoints=\"") + std::to_string(points.size()) +
          "\" NumberOfCells=\"" + std::to_string(cells.size()) + "\">\n      <PointData>\n";
  head += describe_fields(arrays, point_fields);
  head += "      </PointData>\n      <CellData>\n";
  head += describe_fields(arrays, cell_fields);
  head += "      </CellData>\n      <Points>\n";
  head += arrays.describe("Float64", "Points", 3, points.data(), points.size() * sizeof(Vec3<double>));
  head += "      </Points>\n      <Cells>\n";
  head += arrays.describe("Int32", "connectivity", 1, cells.data(), cells.size() * sizeof(cells[0]));
  head += arrays.describe("Int64", "offsets", 1, offsets.data(), offsets.size() * sizeof(std::int64_t));
  head += arrays.describe("UInt8", "types", 1, types.data(), types.size());
  head += "      </Cells>\n    </Piece>\n  </UnstructuredGrid>\n  <AppendedData encoding=\"raw\">\n_";

  AtomicFile file(path);
  file.write(head);
  arrays.write(file);
  file.write("\n  </AppendedData>\n</VTKFile>\n");
  file.commit();
}

}  // namespace detail

/// Writes tetrahedra with their fields as a .vtu file for ParaView: XML with appended raw data in double
/// precision. The file is written under the name `path` + ".part" and renamed when complete; an older file of
/// the name survives a failure. Values that are not finite are written as they are, so that a failed
/// simulation can be looked at.
/// @param points node positions in m
/// @param tetrahedra node numbers into points
/// @throws std::invalid_argument naming the field or tetrahedron: wrong lengths, empty or repeated names,
///   node numbers out of range
/// @throws std::runtime_error with the path and the reason if the file cannot be written; no partial file is
///   left
/// Format: "VTK XML Formats", VTK documentation.
inline void write_vtu(const std::string& path, const std::vector<Vec3<double>>& points,
                      const std::vector<Tetrahedron>& tetrahedra, const std::vector<Field>& point_fields = {},
                      const std::vector<Field>& cell_fields = {}) {
  detail::write_vtu_cells(path, points, tetrahedra, point_fields, cell_fields);
}

/// The same for hexahedra (n = 8), ten-node tetrahedra (n = 10), nodes in VTK's order, and vertices (n = 1),
/// which show points without a mesh: samples, frames.
template <std::size_t n>
requires(n == 1 || n == 8 || n == 10) void write_vtu(const std::string& path,
                                                     const std::vector<Vec3<double>>& points,
                                                     const std::vector<std::array<std::int32_t, n>>& cells,
                                                     const std::vector<Field>& point_fields = {},
                                                     const std::vector<Field>& cell_fields = {}) {
  detail::write_vtu_cells(path, points, cells, point_fields, cell_fields);
}

/// A simulation's states over time as folder/name_000000.vtu, folder/name_000001.vtu, ... and
/// folder/name.pvd, which ParaView opens as one animation. The .pvd is brought up to date after every state,
/// so that what has been written stays readable if the program ends in the next step.
class VtuSeries {
 public:
  /// @param folder must exist; empty means the working folder
  /// @throws std::invalid_argument if the name is empty or holds a slash or a control character
  VtuSeries(std::string folder, std::string name) : name_(std::move(name)) {
    detail::check_xml_name(std::string("VTU series '") + name_ + "'", name_);
    if (name_.find('/') != std::string::npos)
      invalid(std::string("VTU series '") + name_ + "': its name holds a slash");
    path_ = std::move(folder);
    if (!path_.empty() && path_.back() != '/') path_ += '/';
  }

  /// Writes the state at `time` in s; see `write_vtu` for the rest. A call that throws leaves the series as
  /// it was.
  /// @throws std::invalid_argument also if the time is not finite or not later than the last one
  void add(double time, const std::vector<Vec3<double>>& points, const std::vector<Tetrahedron>& tetrahedra,
           const std::vector<Field>& point_fields = {}, const std::vector<Field>& cell_fields = {}) {
    append(time, points, tetrahedra, point_fields, cell_fields);
  }
  /// The same for hexahedra (n = 8), ten-node tetrahedra (n = 10) and vertices (n = 1).
  template <std::size_t n>
  requires(n == 1 || n == 8 || n == 10) void add(double time, const std::vector<Vec3<double>>& points,
                                                 const std::vector<std::array<std::int32_t, n>>& cells,
                                                 const std::vector<Field>& point_fields = {},
                                                 const std::vector<Field>& cell_fields = {}) {
    append(time, points, cells, point_fields, cell_fields);
  }

  /// Number of states that have been written.
  [[nodiscard]] std::size_t size() const { return size_; }
  /// Name of the .pvd file.
  [[nodiscard]] std::string path() const { return path_ + name_ + ".pvd"; }

 private:
  template <class Cell>
  void append(double time, const std::vector<Vec3<double>>& points, const std::vector<Cell>& cells,
              const std::vector<Field>& point_fields, const std::vector<Field>& cell_fields) {
    const std::string what = std::string("VTU series '") + name_ + "': time " + to_text(time) + " s";
    if (!std::isfinite(time)) invalid(what + ": is not a finite number");
    if (size_ != 0 && !(time > last_time_))
      invalid(what + ": is not later than the last, " + to_text(last_time_) + " s");
    char number[32];
    std::snprintf(number, sizeof number, "_%06zu.vtu", size_);
    write_vtu(path_ + name_ + number, points, cells, point_fields, cell_fields);

    char digits[32];  // the shortest text that gives the same number back, in whatever locale
    const char* end = std::to_chars(digits, digits + sizeof digits, time).ptr;
    std::string entry = std::string("    <DataSet timestep=\"") +
                        std::string(static_cast<const char*>(digits), end) + "\" part=\"0\" file=\"" +
                        detail::xml_escaped(name_ + number) + "\"/>\n";
    detail::AtomicFile file(path());
    file.write("<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"");
    file.write(detail::vtk_byte_order);
    file.write("\">\n  <Collection>\n");
    file.write(entries_);
    file.write(entry);
    file.write("  </Collection>\n</VTKFile>\n");
    file.commit();
    entries_ += entry;
    last_time_ = time;
    ++size_;
  }

  std::string path_, name_, entries_;
  std::size_t size_ = 0;
  double last_time_ = 0;
};

}  // namespace softsim
