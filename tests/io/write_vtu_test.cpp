// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/io/write_vtu.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <limits>
#include <locale>
#include <stdexcept>
#include <string>
#include <vector>

#include "io/temporary_folder.hpp"

namespace softsim::test {
namespace write_vtu_test {

const std::vector<Vec3<double>> points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0.1}};
const std::vector<Tetrahedron> tetrahedra{{0, 1, 2, 3}, {1, 2, 3, 4}};
const Field displacement{"displacement", 3, {0, 0, 0, 0.1, 0, 0, 0, 0.2, 0, 0, 0, 0.3, 1, 2, 3}};
const Field pressure{"p < \"0\" & more", 1, {-1e300, 5e-324}};

/// Value of `key="..."` in a piece of XML.
std::string attribute(const std::string& xml, const std::string& key) {
  const std::size_t at = xml.find(" " + key + "=\"");
  if (at == std::string::npos) return "(none)";
  const std::size_t begin = at + key.size() + 3;
  return xml.substr(begin, xml.find('"', begin) - begin);
}

/// The tag that describes the array of the (escaped) name.
std::string tag_of(const std::string& file, const std::string& name) {
  const std::size_t at = file.find("Name=\"" + name + "\"");
  EXPECT_NE(at, std::string::npos) << "no array " << name;
  if (at == std::string::npos) return {};
  const std::size_t begin = file.rfind('<', at);
  return file.substr(begin, file.find('>', at) - begin);
}

/// Decodes an array of appended raw data as the VTK documentation describes it.
template <class T>
std::vector<T> decoded(const std::string& file, const std::string& name, const std::string& type) {
  const std::string tag = tag_of(file, name), mark = "<AppendedData encoding=\"raw\">\n_";
  EXPECT_EQ(attribute(tag, "type"), type);
  EXPECT_EQ(attribute(tag, "format"), "appended");
  const std::size_t data = file.find(mark) + mark.size(), offset = std::stoul(attribute(tag, "offset"));
  std::uint64_t bytes = 0;
  std::memcpy(&bytes, file.data() + data + offset, sizeof bytes);
  EXPECT_LE(data + offset + sizeof bytes + bytes, file.size());
  std::vector<T> values(bytes / sizeof(T));
  if (!values.empty()) std::memcpy(values.data(), file.data() + data + offset + sizeof bytes, bytes);
  return values;
}

template <class Exception, class Action>
void expect_throw_saying(Action action, const std::vector<std::string>& words) {
  try {
    action();
    FAIL() << "nothing was thrown";
  } catch (const Exception& error) {
    for (const std::string& w : words)
      EXPECT_NE(std::string(error.what()).find(w), std::string::npos) << error.what();
  }
}

// All values go into the file bit by bit, so the comparisons are exact.
TEST(WriteVtu, WritesWhatADecoderReadsBack) {
  const TemporaryFolder folder;
  write_vtu(folder.path("a.vtu"), points, tetrahedra, {displacement}, {pressure});
  EXPECT_EQ(folder.number_of_files(), 1u);
  const std::string file = slurp(folder.path("a.vtu"));

  EXPECT_EQ(attribute(file, "type"), "UnstructuredGrid");
  EXPECT_EQ(attribute(file, "header_type"), "UInt64");
  const std::uint16_t one = 1;
  unsigned char first = 0;
  std::memcpy(&first, &one, 1);
  EXPECT_EQ(attribute(file, "byte_order"), first == 1 ? "LittleEndian" : "BigEndian");
  EXPECT_EQ(attribute(file, "NumberOfPoints"), "5");
  EXPECT_EQ(attribute(file, "NumberOfCells"), "2");

  std::vector<double> coordinates;
  for (const Vec3<double>& p : points) coordinates.insert(coordinates.end(), p.data(), p.data() + 3);
  EXPECT_EQ(decoded<double>(file, "Points", "Float64"), coordinates);
  EXPECT_EQ(attribute(tag_of(file, "Points"), "NumberOfComponents"), "3");
  EXPECT_EQ(decoded<std::int32_t>(file, "connectivity", "Int32"),
            (std::vector<std::int32_t>{0, 1, 2, 3, 1, 2, 3, 4}));
  EXPECT_EQ(decoded<std::int64_t>(file, "offsets", "Int64"), (std::vector<std::int64_t>{4, 8}));
  EXPECT_EQ(decoded<std::uint8_t>(file, "types", "UInt8"), (std::vector<std::uint8_t>{10, 10}));
  EXPECT_EQ(decoded<double>(file, "displacement", "Float64"), displacement.values);
  EXPECT_EQ(attribute(tag_of(file, "displacement"), "NumberOfComponents"), "3");
  EXPECT_EQ(decoded<double>(file, "p &lt; &quot;0&quot; &amp; more", "Float64"), pressure.values);

  const std::size_t point_data = file.find("<PointData>"), cell_data = file.find("<CellData>");
  EXPECT_LT(point_data, file.find("displacement"));
  EXPECT_LT(file.find("displacement"), cell_data);
  EXPECT_LT(cell_data, file.find("p &lt;"));
  EXPECT_TRUE(file.ends_with("\n  </AppendedData>\n</VTKFile>\n"));
}

TEST(WriteVtu, WritesHexahedraAndTenNodeTetrahedra) {
  const TemporaryFolder folder;
  const std::vector<Vec3<double>> ten(10, Vec3<double>::Zero());
  const std::vector<std::array<std::int32_t, 8>> hexahedra{{0, 1, 2, 3, 4, 5, 6, 7},
                                                           {2, 3, 4, 5, 6, 7, 8, 9}};
  write_vtu(folder.path("hexahedra.vtu"), ten, hexahedra, {}, {pressure});
  std::string file = slurp(folder.path("hexahedra.vtu"));
  EXPECT_EQ(decoded<std::int32_t>(file, "connectivity", "Int32"),
            (std::vector<std::int32_t>{0, 1, 2, 3, 4, 5, 6, 7, 2, 3, 4, 5, 6, 7, 8, 9}));
  EXPECT_EQ(decoded<std::int64_t>(file, "offsets", "Int64"), (std::vector<std::int64_t>{8, 16}));
  EXPECT_EQ(decoded<std::uint8_t>(file, "types", "UInt8"), (std::vector<std::uint8_t>{12, 12}));

  std::vector<std::array<std::int32_t, 10>> tetrahedra_10{{0, 1, 2, 3, 4, 5, 6, 7, 8, 9}};
  VtuSeries series(folder.path(), "ten");
  series.add(0, ten, tetrahedra_10);
  file = slurp(folder.path("ten_000000.vtu"));
  EXPECT_EQ(decoded<std::int64_t>(file, "offsets", "Int64"), std::vector<std::int64_t>{10});
  EXPECT_EQ(decoded<std::uint8_t>(file, "types", "UInt8"), std::vector<std::uint8_t>{24});
  tetrahedra_10[0][9] = 10;
  expect_throw_saying<std::invalid_argument>([&] { series.add(1, ten, tetrahedra_10); },
                                             {"ten-node tetrahedron 0", "node 10", "10 points"});
}

TEST(WriteVtu, WritesVertices) {
  const TemporaryFolder folder;
  const std::vector<std::array<std::int32_t, 1>> vertices{{0}, {4}};
  write_vtu(folder.path("vertices.vtu"), points, vertices, {displacement}, {pressure});
  const std::string file = slurp(folder.path("vertices.vtu"));
  EXPECT_EQ(decoded<std::int32_t>(file, "connectivity", "Int32"), (std::vector<std::int32_t>{0, 4}));
  EXPECT_EQ(decoded<std::int64_t>(file, "offsets", "Int64"), (std::vector<std::int64_t>{1, 2}));
  EXPECT_EQ(decoded<std::uint8_t>(file, "types", "UInt8"), (std::vector<std::uint8_t>{1, 1}));
}

TEST(WriteVtu, WritesNoElementsAndNumbersThatAreNotFinite) {
  const TemporaryFolder folder;
  write_vtu(folder.path("empty.vtu"), {}, {});
  EXPECT_TRUE(decoded<double>(slurp(folder.path("empty.vtu")), "Points", "Float64").empty());
  write_vtu(folder.path("nan.vtu"), points, tetrahedra, {}, {{"e", 1, {std::nan(""), -INFINITY}}});
  const auto values = decoded<double>(slurp(folder.path("nan.vtu")), "e", "Float64");
  ASSERT_EQ(values.size(), 2u);
  EXPECT_TRUE(std::isnan(values[0]));
  EXPECT_EQ(values[1], -std::numeric_limits<double>::infinity());
}

TEST(WriteVtu, RefusesFieldsThatDoNotFitBeforeItTouchesTheFile) {
  const TemporaryFolder folder;
  const std::string path = folder.path("a.vtu");
  const auto with = [&](const std::vector<Field>& point_fields, const std::vector<Field>& cell_fields) {
    return [=] { write_vtu(path, points, tetrahedra, point_fields, cell_fields); };
  };
  using Error = std::invalid_argument;
  expect_throw_saying<Error>(with({{"u", 3, {1, 2, 3}}}, {}),
                             {path, "point field 'u'", "3 values", "5 points"});
  expect_throw_saying<Error>(with({}, {{"e", 1, {1, 2, 3}}}),
                             {path, "cell field 'e'", "3 values", "2 cells"});
  expect_throw_saying<Error>(with({}, {{"e", 0, {}}}), {path, "cell field 'e'", "0 components"});
  expect_throw_saying<Error>(with({}, {{"e", -1, {1, 2}}}), {path, "cell field 'e'", "-1 components"});
  expect_throw_saying<Error>(with({}, {{"", 1, {1, 2}}}), {path, "cell field 0", "empty"});
  expect_throw_saying<Error>(with({}, {{"a\nb", 1, {1, 2}}}), {path, "cell field 0", "control character 10"});
  expect_throw_saying<Error>(with({}, {{"e", 1, {1, 2}}, {"e", 1, {1, 2}}}), {path, "'e'", "repeated"});
  for (const std::int32_t node : {-1, 5})
    expect_throw_saying<Error>(
        [&] {
          write_vtu(path, points, {{0, 1, 2, 3}, {0, 1, 2, node}});
        },
        {path, "tetrahedron 1", "node " + std::to_string(node), "5 points"});
  EXPECT_EQ(folder.number_of_files(), 0u);
}

TEST(WriteVtu, SaysWhyAFileCannotBeWritten) {
  const TemporaryFolder folder;
  folder.write("file", "");
  for (const std::string name : {"missing/a.vtu", "file/a.vtu"})
    expect_throw_saying<std::runtime_error>([&] { write_vtu(folder.path(name), points, tetrahedra); },
                                            {folder.path(name), "cannot be written ("});
  EXPECT_EQ(folder.number_of_files(), 1u);
}

TEST(WriteVtu, LeavesNothingBehindIfTheNameBelongsToAFolder) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.path("a.vtu"));
  expect_throw_saying<std::runtime_error>([&] { write_vtu(folder.path("a.vtu"), points, tetrahedra); },
                                          {folder.path("a.vtu"), "cannot be written ("});
  EXPECT_EQ(folder.number_of_files(), 1u);
}

// Writing through a link to /dev/full fails as on a full disk. Both a small file, which only meets the error
// when it is closed, and one that is larger than the buffers of stdio.
TEST(WriteVtu, KeepsTheOldFileIfTheDiskIsFull) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "needs /dev/full";
  const TemporaryFolder folder;
  const std::string path = folder.write("a.vtu", "the old file");
  for (const std::size_t n : {std::size_t{5}, std::size_t{100000}}) {
    std::filesystem::create_symlink("/dev/full", path + ".part");
    const std::vector<Vec3<double>> many(n, Vec3<double>::Zero());
    expect_throw_saying<std::runtime_error>([&] { write_vtu(path, many, tetrahedra); },
                                            {path, "cannot be written (", "space"});
    EXPECT_EQ(folder.number_of_files(), 1u);
    EXPECT_EQ(slurp(path), "the old file");
  }
}

struct DecimalComma : std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
};

TEST(VtuSeries, ListsEveryStateAfterEveryStep) {
  const TemporaryFolder folder;
  const std::locale before = std::locale::global(std::locale(std::locale(), new DecimalComma));
  VtuSeries series(folder.path(), "beam & co");
  const std::vector<double> times{-1, 0.1, 1.0 / 3};
  const std::vector<std::string> written_times{"-1", "0.1", "0.3333333333333333"};
  for (std::size_t step = 0; step < times.size(); ++step) {
    std::vector<Vec3<double>> moved = points;
    moved[0][0] = -static_cast<double>(step);
    series.add(times[step], moved, tetrahedra, {displacement}, {pressure});
    EXPECT_EQ(series.size(), step + 1);
    EXPECT_EQ(folder.number_of_files(), step + 2);

    const std::string pvd = slurp(folder.path("beam & co.pvd"));
    EXPECT_EQ(attribute(pvd, "type"), "Collection");
    EXPECT_TRUE(pvd.ends_with("</VTKFile>\n"));
    std::size_t at = 0;
    for (std::size_t i = 0; i <= step; ++i) {
      at = pvd.find("<DataSet ", at + 1);
      ASSERT_NE(at, std::string::npos);
      const std::string entry = pvd.substr(at);
      EXPECT_EQ(attribute(entry, "timestep"), written_times[i]);
      EXPECT_EQ(attribute(entry, "file"), "beam &amp; co_00000" + std::to_string(i) + ".vtu");
      const std::string state = slurp(folder.path("beam & co_00000" + std::to_string(i) + ".vtu"));
      EXPECT_EQ(decoded<double>(state, "Points", "Float64")[0], -static_cast<double>(i));
    }
    EXPECT_EQ(pvd.find("<DataSet ", at + 1), std::string::npos);
  }
  std::locale::global(before);
  EXPECT_EQ(series.path(), folder.path("beam & co.pvd"));
}

TEST(VtuSeries, RefusesTimesThatDoNotIncrease) {
  const TemporaryFolder folder;
  VtuSeries series(folder.path(), "beam");
  series.add(0.5, points, tetrahedra);
  for (const double time : {0.5, 0.25, std::nan(""), std::numeric_limits<double>::infinity()})
    expect_throw_saying<std::invalid_argument>([&] { series.add(time, points, tetrahedra); },
                                               {"'beam'", "time " + to_text(time)});
  EXPECT_EQ(series.size(), 1u);
  EXPECT_EQ(folder.number_of_files(), 2u);
}

TEST(VtuSeries, RefusesNamesThatAreNoFileNames) {
  for (const std::string name : {"", "a/b", "a\nb"}) EXPECT_THROW(VtuSeries("", name), std::invalid_argument);
}

TEST(VtuSeries, GoesOnAfterAFailedStep) {
  const TemporaryFolder folder;
  VtuSeries missing(folder.path("missing"), "beam");
  EXPECT_THROW(missing.add(0, points, tetrahedra), std::runtime_error);
  std::filesystem::create_directory(folder.path("missing"));
  EXPECT_NO_THROW(missing.add(0, points, tetrahedra));

  VtuSeries series(folder.path(), "beam");
  series.add(0, points, tetrahedra);
  const std::string good = slurp(series.path());
  EXPECT_THROW(series.add(1, points, tetrahedra, {{"u", 3, {}}}), std::invalid_argument);
  std::filesystem::create_directory(series.path() + ".part");
  EXPECT_THROW(series.add(1, points, tetrahedra), std::runtime_error);
  EXPECT_EQ(slurp(series.path()), good);
  EXPECT_EQ(series.size(), 1u);
  std::filesystem::remove(series.path() + ".part");
  series.add(2, points, tetrahedra);
  const std::string pvd = slurp(series.path());
  EXPECT_NE(pvd.find("timestep=\"2\" part=\"0\" file=\"beam_000001.vtu\""), std::string::npos);
}

}  // namespace write_vtu_test
}  // namespace softsim::test
