// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/io/read_mesh.hpp"

#include <gtest/gtest.h>

#include <clocale>
#include <filesystem>
#include <locale>
#include <ostream>
#include <stdexcept>
#include <string>
#include <vector>

#include "io/sample_meshes.hpp"
#include "io/temporary_folder.hpp"

namespace softsim::test {
namespace read_mesh_test {

struct Sample {
  std::string name, file;
  const std::string& text;
  std::string cell_array;

  friend std::ostream& operator<<(std::ostream& out, const Sample& s) { return out << s.name; }
};

const std::vector<Sample> samples{{"Gmsh1", "mesh.msh", gmsh_1, ""},
                                  {"Gmsh2", "mesh.msh", gmsh_2, ""},
                                  {"Gmsh4", "mesh.msh", gmsh_4, ""},
                                  {"Vtk3", "mesh.vtk", vtk_3, "tissue"},
                                  {"Vtk5", "mesh.VTK", vtk_5, "tissue"},
                                  {"VtuOnePiece", "mesh.vtu", vtu_one_piece, "tissue"},
                                  {"VtuTwoPieces", "mesh.vtu", vtu_two_pieces, "tissue"}};

std::string name_of(const ::testing::TestParamInfo<Sample>& info) { return info.param.name; }

std::vector<Vec3<double>> corners(const TetrahedralMesh& mesh) {
  std::vector<Vec3<double>> all;
  for (const Tetrahedron& t : mesh.tetrahedra())
    for (const std::int32_t i : t) all.push_back(mesh.points()[static_cast<std::size_t>(i)]);
  return all;
}

/// Exact: all coordinates of the samples are binary fractions.
void expect_the_sample(const TetrahedralMesh& mesh) {
  const Vec3<double> o(0, 0, 0), x(1, 0, 0), y(0, 1, 0), z(0, 0, 1), far(1, 1, 1.5);
  EXPECT_EQ(corners(mesh), (std::vector<Vec3<double>>{o, x, y, z, x, y, z, far}));
}

class EveryFormat : public ::testing::TestWithParam<Sample> {
 protected:
  TetrahedralMesh read(const std::string& text) const {
    const TemporaryFolder folder;
    return read_mesh(folder.write(GetParam().file, text), {.cell_array = GetParam().cell_array});
  }
  /// The same without a file, for tests that parse thousands of texts.
  TetrahedralMesh parse(const std::string& text) const {
    const std::string& file = GetParam().file;
    const std::string& cell_array = GetParam().cell_array;
    if (file.ends_with(".msh")) return detail::GmshReader(file, text).read().mesh(file);
    if (file.ends_with(".vtu")) return detail::VtuReader(file, text, cell_array).read().mesh(file);
    return detail::VtkLegacyReader(file, text, cell_array).read().mesh(file);
  }
};
INSTANTIATE_TEST_SUITE_P(ReadMesh, EveryFormat, ::testing::ValuesIn(samples), name_of);

TEST_P(EveryFormat, GivesTheSameMeshAndRegions) {
  const TetrahedralMesh mesh = read(GetParam().text);
  expect_the_sample(mesh);
  EXPECT_EQ(mesh.region(), (std::vector<int>{7, 9}));
  EXPECT_TRUE(mesh.warnings().empty());
}

TEST_P(EveryFormat, ReadsCarriageReturnsTabsAndAByteOrderMark) {
  std::string text = "\xEF\xBB\xBF";
  for (const char c : GetParam().text) text += c == '\n' ? "\r\n" : std::string(1, c);
  expect_the_sample(read(text));
}

struct DecimalComma : std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
};

TEST_P(EveryFormat, DoesNotDependOnTheLocale) {
  const std::string c_before = std::setlocale(LC_ALL, nullptr);
  for (const char* name : {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "fr_FR.utf8"})
    if (std::setlocale(LC_ALL, name) != nullptr) break;  // the C++ locale below is always there
  const std::locale before = std::locale::global(std::locale(std::locale(), new DecimalComma));
  EXPECT_NO_THROW(expect_the_sample(read(GetParam().text)));
  std::locale::global(before);
  std::setlocale(LC_ALL, c_before.c_str());
}

// Wherever the file breaks off, the reader refuses it, unless only what does not belong to the mesh is gone.
TEST_P(EveryFormat, NeverGivesAnotherMeshForATruncatedFile) {
  const std::string& text = GetParam().text;
  std::size_t refused = 0;
  for (std::size_t n = 0; n < text.size(); ++n) {
    try {
      const TetrahedralMesh mesh = parse(text.substr(0, n));
      expect_the_sample(mesh);
      EXPECT_EQ(mesh.region(), (std::vector<int>{7, 9})) << "cut to " << n << " bytes";
    } catch (const std::invalid_argument& error) {
      ++refused;
      EXPECT_EQ(std::string(error.what()).find(GetParam().file), 0u) << error.what();
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    }
  }
  EXPECT_GT(refused, text.size() / 2);
}

// One byte wrong: either the reader notices, or it still is a mesh that passes all checks.
TEST_P(EveryFormat, SurvivesAnyWrongByte) {
  for (const char wrong : {'9', '-', ' ', '\n', '<', '$', '\xff'})
    for (std::size_t n = 0; n < GetParam().text.size(); ++n) {
      std::string text = GetParam().text;
      text[n] = wrong;
      try {
        const TetrahedralMesh mesh = parse(text);
        EXPECT_LE(mesh.tetrahedra().size(), 2u);
      } catch (const std::invalid_argument& error) {
        EXPECT_EQ(std::string(error.what()).find(GetParam().file), 0u) << error.what();
      }
    }
}

struct Bad {
  std::string name, file, text;
  std::vector<std::string> says;  ///< what the message must contain, beside the path
  std::string cell_array = {};

  friend std::ostream& operator<<(std::ostream& out, const Bad& b) { return out << b.name; }
};

class BadInput : public ::testing::TestWithParam<Bad> {};

TEST_P(BadInput, IsRefusedWithPathLineAndValue) {
  const TemporaryFolder folder;
  const std::string path = folder.write(GetParam().file, GetParam().text);
  try {
    static_cast<void>(read_mesh(path, {.cell_array = GetParam().cell_array}));
    FAIL() << "was accepted";
  } catch (const std::invalid_argument& error) {
    const std::string message = error.what();
    EXPECT_EQ(message.find(path), 0u) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    for (const std::string& words : GetParam().says) {
      const bool is_line = &words == &GetParam().says.front() && words.starts_with("line ");
      EXPECT_NE(message.find(is_line ? ", " + words + ": " : words), std::string::npos) << message;
    }
  }
}

Bad msh1(std::string name, std::string_view from, std::string_view to, std::vector<std::string> says) {
  return {"Gmsh1" + name, "mesh.msh", replaced(gmsh_1, from, to), std::move(says)};
}
Bad msh2(std::string name, std::string_view from, std::string_view to, std::vector<std::string> says) {
  return {"Gmsh2" + name, "mesh.msh", replaced(gmsh_2, from, to), std::move(says)};
}
Bad msh4(std::string name, std::string_view from, std::string_view to, std::vector<std::string> says) {
  return {"Gmsh4" + name, "mesh.msh", replaced(gmsh_4, from, to), std::move(says)};
}
Bad vtk3(std::string name, std::string_view from, std::string_view to, std::vector<std::string> says,
         std::string cell_array = "tissue") {
  return {"Vtk3" + name, "mesh.vtk", replaced(vtk_3, from, to), std::move(says), std::move(cell_array)};
}
Bad vtk5(std::string name, std::string_view from, std::string_view to, std::vector<std::string> says,
         std::string cell_array = "tissue") {
  return {"Vtk5" + name, "mesh.vtk", replaced(vtk_5, from, to), std::move(says), std::move(cell_array)};
}
Bad vtu(std::string name, std::string_view from, std::string_view to, std::vector<std::string> says,
        std::string cell_array = "tissue") {
  return {"Vtu" + name, "mesh.vtu", replaced(vtu_one_piece, from, to), std::move(says),
          std::move(cell_array)};
}

std::vector<Bad> any_file() {
  return {
      {"EmptyMsh", "mesh.msh", "", {"empty"}},
      {"EmptyVtk", "mesh.vtk", "", {"empty"}},
      {"EmptyVtu", "mesh.vtu", "", {"empty"}},
      {"BlankMsh", "mesh.msh", " \n\n", {"line 3", "$Nodes"}},
      {"BlankVtk", "mesh.vtk", " \n\n", {"line 1", "vtk DataFile"}},
      {"BlankVtu", "mesh.vtu", " \n\n", {"line 3", "XML"}},
      {"OtherExtension", "mesh.stl", "solid", {"'.stl'"}},
      {"NoExtension", "mesh", "solid", {"''"}},
      {"CellArrayForMsh", "mesh.msh", gmsh_1, {"cell_array 'tissue'"}, "tissue"},
      {"ZeroByte", "mesh.msh", gmsh_1 + std::string(1, '\0'), {"line 16", "binary", "ASCII", "meshio"}},
      {"LongWord", "mesh.msh", std::string(1000, 'x'), {"line 1", std::string(60, 'x') + "...'"}},
  };
}

std::vector<Bad> gmsh_files() {
  return {
      msh1("TrailingGarbage", "12 0. 1", "12 1.2x 1", {"line 5", "'1.2x'"}),
      msh1("NotANumber", "12 0. 1", "12 nan 1", {"line 5", "'nan'", "finite"}),
      msh1("Infinite", "12 0. 1", "12 -inf 1", {"line 5", "'-inf'", "finite"}),
      msh1("Overflow", "12 0. 1", "12 1e999 1", {"line 5", "'1e999'", "range"}),
      msh1("Hexadecimal", "12 0. 1", "12 0x1 1", {"line 5", "'0x1'"}),
      msh1("DoubleSign", "12 0. 1", "12 +-1 1", {"line 5", "'+-1'"}),
      msh1("DecimalComma", "12 0. 1", "12 0,5 1", {"line 5", "'0,5'"}),
      msh1("MissingCoordinate", "12 0. 1 0", "12 0. 1", {"line 5", "z coordinate"}),
      msh1("TooManyCoordinates", "12 0. 1 0", "12 0. 1 0 4", {"line 5", "'4'"}),
      msh1("FractionalNodeNumber", "12 0. 1 0", "12.5 0. 1 0", {"line 5", "'12.5'"}),
      msh1("NegativeNodeNumber", "12 0. 1 0", "-12 0. 1 0", {"line 5", "'-12'"}),
      msh1("HugeNodeNumber", "12 0. 1 0", "99999999999999999999 0. 1 0", {"line 5", "'9999999999"}),
      msh1("RepeatedNode", "12 0. 1 0", "11 0. 1 0", {"line 5", "11", "repeated"}),
      msh1("TooFewNodes", "5\n2 0", "6\n2 0", {"line 8", "'$ENDNOD'", "node 6 of 6"}),
      msh1("TooManyNodes", "5\n2 0", "4\n2 0", {"line 7", "'31'", "$ENDNOD"}),
      msh1("NegativeCount", "5\n2 0", "-5\n2 0", {"line 2", "'-5'", "negative"}),
      msh1("AbsurdCount", "5\n2 0", "2000000000\n2 0", {"line 2", "'2000000000'", "file can hold"}),
      msh1("OverflowingCount", "5\n2 0", "99999999999999999999\n2 0", {"line 2", "'99999999999999999999'"}),
      msh1("AbsurdElementCount", "4\n1 15", "1000000\n1 15", {"line 10", "'1000000'", "file can hold"}),
      msh1("MissingEnd", "$ENDNOD\n", "", {"line 8", "'$ELM'", "$ENDNOD"}),
      msh1("MissingLastEnd", "$ENDELM\n", "", {"line 15", "$ENDELM"}),
      msh1("NoNodes", "$NOD", "$Other", {"line 1", "$EndOther"}),
      msh1("SecondNodes", "$ELM", "$NOD\n0\n$ENDNOD\n$ELM", {"line 9", "second"}),
      msh1("TextOutside", "$ELM", "hello\n$ELM", {"line 9", "'hello'"}),
      msh1("TextAfter", "$ENDELM", "$ENDELM\n7", {"line 16", "'7'"}),
      msh1("UnknownNode", "5 4 7 1 4 2", "5 4 7 1 4 3", {"line 13", "'3'", "not among"}),
      msh1("UnknownNodeOfATriangle", "3 2 11 12", "3 2 11 99", {"line 12", "'99'", "not among"}),
      msh1("RepeatedNodeInTetrahedron", "4 2 11 12 30", "4 2 11 12 11", {"line 13", "'11'", "repeated"}),
      msh1("RepeatedElement", "6 4 9", "5 4 9", {"line 14", "5", "repeated"}),
      msh1("SameTetrahedronTwice", "11 12 30 31", "12 11 30 2", {"line 14", "same nodes", "line 13"}),
      msh1("WrongNodeCount", "5 4 7 1 4", "5 4 7 1 5", {"line 13", "'5'"}),
      msh1("TooManyNodesInElement", "2 11 12 30", "2 11 12 30 31", {"line 13", "'31'"}),
      msh1("MissingNodeInElement", "2 11 12 30", "2 11 12", {"line 13", "missing"}),
      msh1("HugeRegion", "5 4 7", "5 4 3000000000", {"line 13", "'3000000000'"}),
      msh1("Inverted", "2 11 12 30", "11 2 12 30", {"line 13", "tetrahedron 0", "inverted"}),
      msh1("Degenerate", "31 1 1 1.5", "31 0.5 0.5 0", {"line 14", "tetrahedron 1", "degenerate"}),
      msh1("Hexahedron", "6 4 9 2 4 11 12 30 31", "6 5 9 2 8 2 11 12 30 31 2 2 2", {"line 14", "hexahedron"}),
      msh1("Prism", "6 4 9", "6 6 9", {"line 14", "prism"}),
      msh1("Pyramid", "6 4 9", "6 7 9", {"line 14", "pyramid"}),
      msh1("TenNodes", "6 4 9", "6 11 9", {"line 14", "ten-node tetrahedron"}),
      msh1("UnknownType", "6 4 9", "6 777 9", {"line 14", "'777'"}),
      {"Gmsh1NoTetrahedra", "mesh.msh", "$NOD\n1\n1 0 0 0\n$ENDNOD\n$ELM\n1\n1 15 1 1 1 1\n$ENDELM\n",
       {"no tetrahedra", "1 point"}},
      {"Gmsh1NoElements", "mesh.msh", "$NOD\n1\n1 0 0 0\n$ENDNOD\n", {"$Elements"}},
      msh2("Binary", "2.2 0 8", "2.2 1 8", {"line 2", "binary", "ASCII", "meshio"}),
      msh2("Version", "2.2 0 8", "3.0 0 8", {"line 2", "'3.0'"}),
      msh2("Version40", "2.2 0 8", "4.0 0 8", {"line 2", "'4.0'"}),
      msh2("FileType", "2.2 0 8", "2.2 7 8", {"line 2", "'7'"}),
      msh2("OldSections", "$Nodes", "$NOD", {"line 9", "$NOD", "format 1"}),
      msh2("NoFormat", "$MeshFormat", "$Other", {"line 1", "$EndOther"}),
      msh2("ElementsBeforeNodes", "$Nodes", "$Elements", {"line 9", "before the nodes"}),
      msh2("UnclosedNames", "$EndPhysicalNames", "", {"line 4", "$EndPhysicalNames"}),
      msh2("NegativeTags", "4 4 2 7", "4 4 -2 7", {"line 22", "'-2'", "negative"}),
      msh2("AbsurdTags", "4 4 2 7", "4 4 2000000000 7", {"line 22", "'2000000000'"}),
      msh2("TooFewTags", "4 4 2 7 1", "4 4 3 7 1", {"line 22", "missing"}),
      msh4("WrongTotal", "2 5 1 5", "2 6 1 6", {"line 28", "5 nodes", "announced 6"}),
      msh4("TooSmallTotal", "2 5 1 5", "2 4 1 5", {"line 23", "'2'"}),
      msh4("ElementTotal", "3 4 1 9", "3 5 1 9", {"line 38", "4 elements", "announced 5"}),
      msh4("NoSuchBlock", "3 4 1 9", "4 4 1 9", {"line 38", "'$EndElements'", "element block 4 of 4"}),
      msh4("AbsurdBlock", "3 9 0 2", "3 9 0 2000000000", {"line 23", "'2000000000'"}),
      msh4("RepeatedNode", "5\n4\n", "5\n1\n", {"line 25", "1", "repeated"}),
      msh4("NoParameters", "1 0 0 1 0", "1 0 0", {"line 21", "parametric"}),
      msh4("Dimension", "3 9 0 2", "4 9 0 2", {"line 23", "'4'"}),
      msh4("Prism", "3 9 4 1", "3 9 6 1", {"line 36", "prism"}),
      msh4("EntityCount", "1 0 1 2", "1 0 1 9", {"line 13", "'$EndEntities'", "entity 3 of 9"}),
      msh4("Partitioned", "$Comments", "$PartitionedEntities", {"line 4", "partitioned"}),
  };
}

std::vector<Bad> vtk_files() {
  return {
      vtk3("Magic", "# vtk", "# VTX", {"line 1", "'VTX'"}),
      vtk3("Binary", "ASCII", "BINARY", {"line 3", "binary", "ASCII", "meshio"}),
      vtk3("Encoding", "ASCII", "EBCDIC", {"line 3", "'ebcdic'"}),
      vtk3("PolyData", "UNSTRUCTURED_GRID", "POLYDATA", {"line 4", "'POLYDATA'"}),
      vtk3("TrailingGarbage", "1 1 1.5", "1 1 1.5x", {"line 10", "'1.5x'"}),
      vtk3("NotANumber", "1 1 1.5", "1 1 NaN", {"line 10", "'NaN'", "finite"}),
      vtk3("TooFewCoordinates", "1 1 1.5", "1 1", {"line 12", "'CELLS'"}),
      vtk3("TooManyCoordinates", "1 1 1.5", "1 1 1.5 2", {"line 10", "'2'"}),
      vtk3("NegativePoints", "POINTS 5", "POINTS -5", {"line 8", "'-5'", "negative"}),
      vtk3("AbsurdPoints", "POINTS 5", "POINTS 1000000000", {"line 8", "'1000000000'", "file can hold"}),
      vtk3("AbsurdCells", "CELLS 4 17", "CELLS 1000000000 17", {"line 12", "'1000000000'"}),
      vtk3("AbsurdSize", "CELLS 4 17", "CELLS 4 1000000000", {"line 12", "'1000000000'"}),
      vtk3("SizeTooSmall", "CELLS 4 17", "CELLS 4 16", {"line 16", "'4'"}),
      vtk3("SizeTooLarge", "CELLS 4 17", "CELLS 4 18", {"line 16", "1 entries"}),
      vtk3("PointOutOfRange", "4 1 2 3 4", "4 1 2 3 5", {"line 16", "'5'", "range"}),
      vtk3("NegativePoint", "4 1 2 3 4", "4 1 2 3 -4", {"line 16", "'-4'", "range"}),
      vtk3("RepeatedPoint", "4 1 2 3 4", "4 1 2 3 3", {"line 16", "repeated"}),
      vtk3("Inverted", "4 1 2 3 4", "4 2 1 3 4", {"line 16", "tetrahedron 1", "inverted"}),
      vtk3("Hexahedron", "3\n10\nPOINT", "3\n12\nPOINT", {"line 21", "hexahedron"}),
      vtk3("Voxel", "3\n10\nPOINT", "3\n11\nPOINT", {"line 21", "voxel"}),
      vtk3("QuadraticTetrahedron", "3\n10\nPOINT", "3\n24\nPOINT", {"line 21", "ten-node"}),
      vtk3("UnknownType", "3\n10\nPOINT", "3\n99\nPOINT", {"line 21", "99"}),
      vtk3("TypeOfAnotherSize", "3\n10\nPOINT", "10\n10\nPOINT", {"line 20", "2 points, not 4"}),
      vtk3("TypeCount", "CELL_TYPES 4", "CELL_TYPES 3", {"line 17", "3", "4 cells"}),
      vtk3("DataCount", "CELL_DATA 4", "CELL_DATA 3", {"line 30", "3", "4"}),
      vtk3("AbsurdDataCount", "CELL_DATA 4", "CELL_DATA 4000000", {"line 30", "'4000000'"}),
      vtk3("FractionalRegion", "1 7 2 9", "1 7.5 2 9", {"line 33", "'7.5'"}),
      vtk3("HugeRegion", "1 7 2 9", "1 3e9 2 9", {"line 33", "'3e9'"}),
      vtk3("TooFewRegions", "1 7 2 9", "1 7 2", {"line 34", "missing"}),
      vtk3("TooManyRegions", "1 7 2 9", "1 7 2 9 9", {"line 33", "'9'"}),
      vtk3("OpenEnd", "1 7 2 9\n", "1 7 2 9", {"line 33", "truncated"}),
      vtk3("RegionComponents", "SCALARS tissue int", "SCALARS tissue int 2", {"'tissue'", "2 components"}),
      vtk3("Keyword", "VECTORS", "VECTOR", {"line 26", "'vector'"}),
      vtk3("NoSuchArray", "1 7 2 9", "1 7 2 9", {"'region'", "'tissue'"}, "region"),
      vtk3("PointArrayIsNoCellArray", "1 7 2 9", "1 7 2 9", {"'u'", "'tissue'"}, "u"),
      vtk3("CellsFirst", "POINTS 5 float", "CELLS 0 0\nPOINTS 5 float", {"line 8", "before POINTS"}),
      vtk3("SecondPoints", "CELLS 4 17", "POINTS 0 float\nCELLS 4 17", {"line 12", "second"}),
      vtk5("OffsetDecreases", "0 4 4 8", "0 4 3 8", {"line 13", "'3'"}),
      vtk5("OffsetBeyond", "0 4 4 8", "0 4 4 9", {"line 13", "'9'"}),
      vtk5("OffsetStart", "0 4 4 8", "1 4 4 8", {"line 13", "'1'"}),
      vtk5("OffsetEnd", "0 4 4 8", "0 4 4 7", {"line 13", "7", "8"}),
      vtk5("NoSuchArray", "vtk output", "", {"'region'", "'pressure'", "'the name'", "'tissue'"}, "region"),
      vtk5("RegionIsNotInteger", "vtk output", "", {"line 25", "'0.5'"}, "pressure"),
  };
}

std::vector<Bad> vtu_files() {
  return {
      vtu("NotXml", "<?xml version=\"1.0\"?>", "hello", {"line 1", "'hello'"}),
      vtu("NotVtk", "VTKFile byte_order", "html byte_order", {"line 35", "</VTKFile>", "html"}),
      vtu("PolyData", "'UnstructuredGrid'", "'PolyData'", {"line 3", "'PolyData'"}),
      vtu("NoType", "type='UnstructuredGrid'", "", {"line 3", "type"}),
      vtu("Binary", "format=\"ascii\" NumberOfComponents", "format=\"binary\" NumberOfComponents",
          {"line 16", "binary", "ASCII", "meshio"}),
      vtu("Appended", "Name=\"types\" format=\"ascii\"", "Name=\"types\" format=\"appended\" offset=\"0\"",
          {"line 25", "binary", "ASCII", "meshio"}),
      vtu("TrailingGarbage", "1 1 1.5", "1 1 1.5x", {"line 18", "'1.5x'"}),
      vtu("Infinite", "1 1 1.5", "1 1 inf", {"line 18", "'inf'", "finite"}),
      vtu("TooFewCoordinates", "1 1 1.5", "1 1", {"line 16", "14", "15"}),
      vtu("TooManyCoordinates", "1 1 1.5", "1 1 1.5 7", {"line 18", "'7'", "15"}),
      vtu("NegativePoints", "NumberOfPoints=\"5\"", "NumberOfPoints=\"-5\"", {"line 6", "'-5'", "negative"}),
      vtu("AbsurdPoints", "NumberOfPoints=\"5\"", "NumberOfPoints=\"2000000000\"",
          {"line 6", "'2000000000'"}),
      vtu("AbsurdCells", "NumberOfCells=\"3\"", "NumberOfCells=\"99999999999999999999\"",
          {"line 6", "'9999999999"}),
      vtu("CountGarbage", "NumberOfCells=\"3\"", "NumberOfCells=\"3x\"", {"line 6", "'3x'"}),
      vtu("CountMissing", "NumberOfCells=\"3\"", "", {"line 6", "NumberOfCells"}),
      vtu("Components", "NumberOfComponents=\"3\"", "NumberOfComponents=\"2\"", {"line 16", "'2'"}),
      vtu("TypeCount", "5 10 10<", "5 10<", {"line 25", "2", "3"}),
      vtu("Wedge", "5 10 10<", "5 13 10<", {"line 25", "wedge"}),
      vtu("PointOutOfRange", "1 2 3 4\n", "1 2 3 5\n", {"line 30", "'5'", "range"}),
      vtu("TooManyConnections", "1 2 3 4\n", "1 2 3 4 0\n", {"line 30", "'0'", "11"}),
      vtu("OffsetDecreases", "3 7 11", "7 3 11", {"line 26", "'3'"}),
      vtu("OffsetAbsurd", "3 7 11", "3 7 2000000000", {"line 27", "2000000000"}),
      vtu("OffsetShifted", "3 7 11", "4 7 11", {"line 25", "type 5", "4 points, not 3"}),
      vtu("Inverted", "1 2 3 4\n", "2 1 3 4\n", {"line 30", "tetrahedron 1", "inverted"}),
      vtu("NoConnectivity", "Name=\"connectivity\"", "Name=\"links\"", {"line 24", "connectivity"}),
      vtu("SecondOffsets", "Name=\"types\"", "Name=\"offsets\"", {"line 26", "second"}),
      vtu("NotNumeric", "type=\"UInt8\"", "type=\"String\"", {"line 25", "'String'"}),
      vtu("NoSuchArray", "hand", "hand", {"'region'", "'a < b'", "'tissue'"}, "region"),
      vtu("RegionIsNotInteger", "hand", "hand", {"line 11", "'0.5'"}, "a < b"),
      vtu("WrongTag", "</Points>", "</Point>", {"line 23", "</Point>"}),
      vtu("Unclosed", "</VTKFile>", "", {"line 3", "<VTKFile>", "not closed"}),
      vtu("SecondRoot", "</VTKFile>", "</VTKFile><a/>", {"line 35", "second"}),
      vtu("RepeatedAttribute", "version=\"0.1\"", "type='x'", {"line 3", "type", "repeated"}),
      vtu("NoQuotes", "NumberOfCells=\"3\"", "NumberOfCells=3", {"line 6", "quotation"}),
      vtu("UnknownEntity", "&lt;", "&lessthan;", {"line 11", "entity"}),
      vtu("UnclosedComment", "a comment -->", "a comment", {"line 17", "comment"}),
      {"VtuDeep", "mesh.vtu", [] {
         std::string text;
         for (int i = 0; i < 100000; ++i) text += "<a>";
         return text;
       }(), {"line 1", "deep"}},
      {"VtuNoPieces", "mesh.vtu", "<VTKFile type='UnstructuredGrid'><UnstructuredGrid/></VTKFile>",
       {"line 1", "Piece"}},
      {"VtuNoGrid", "mesh.vtu", "<VTKFile type='UnstructuredGrid'>\n</VTKFile>",
       {"line 1", "UnstructuredGrid"}},
  };
}

std::string name_of_bad(const ::testing::TestParamInfo<Bad>& info) { return info.param.name; }
INSTANTIATE_TEST_SUITE_P(AnyFile, BadInput, ::testing::ValuesIn(any_file()), name_of_bad);
INSTANTIATE_TEST_SUITE_P(Gmsh, BadInput, ::testing::ValuesIn(gmsh_files()), name_of_bad);
INSTANTIATE_TEST_SUITE_P(VtkLegacy, BadInput, ::testing::ValuesIn(vtk_files()), name_of_bad);
INSTANTIATE_TEST_SUITE_P(Vtu, BadInput, ::testing::ValuesIn(vtu_files()), name_of_bad);

void expect_refusal(const std::string& path, const std::string& words) {
  try {
    static_cast<void>(read_mesh(path));
    FAIL() << path << " was accepted";
  } catch (const std::invalid_argument& error) {
    EXPECT_EQ(std::string(error.what()).find(path), 0u) << error.what();
    EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
  }
}

TEST(ReadMesh, RefusesAMissingFileAndAFolder) {
  const TemporaryFolder folder;
  for (const std::string extension : {".msh", ".vtk", ".vtu"}) {
    expect_refusal(folder.path("missing" + extension), "cannot be opened");
    std::filesystem::create_directory(folder.path("folder" + extension));
    expect_refusal(folder.path("folder" + extension), "cannot be read");
  }
}

TEST(ReadMesh, TakesRegionZeroWithoutACellArray) {
  const TemporaryFolder folder;
  EXPECT_EQ(read_mesh(folder.write("mesh.vtk", vtk_3)).region(), (std::vector<int>{0, 0}));
  EXPECT_EQ(read_mesh(folder.write("mesh.vtu", vtu_one_piece)).region(), (std::vector<int>{0, 0}));
}

TEST(ReadMesh, TakesRegionZeroFromGmshElementsWithoutTags) {
  const TemporaryFolder folder;
  const std::string text = replaced(gmsh_2, "4 4 2 7 1 1 2 3 4", "4 4 0 1 2 3 4");
  EXPECT_EQ(read_mesh(folder.write("mesh.msh", text)).region(), (std::vector<int>{0, 9}));
}

TEST(ReadMesh, TakesTheEntityAsRegionOfAGmsh4MeshWithoutEntities) {
  const TemporaryFolder folder;
  const std::size_t begin = gmsh_4.find("$Entities"), end = gmsh_4.find("$Nodes");
  const std::string text = gmsh_4.substr(0, begin) + gmsh_4.substr(end);
  EXPECT_EQ(read_mesh(folder.write("mesh.msh", text)).region(), (std::vector<int>{1, 9}));
}

TEST(ReadMesh, PassesTheWarningsOfTheMeshOn) {
  const TemporaryFolder folder;
  const std::string text = replaced(replaced(gmsh_1, "5\n2 0", "6\n2 0"), "31 1 1", "32 9 9 9\n31 1 1");
  const TetrahedralMesh mesh = read_mesh(folder.write("mesh.msh", text));
  EXPECT_EQ(mesh.points().size(), 5u);
  EXPECT_EQ(mesh.warnings().size(), 1u);
}

TEST(ReadMesh, ReadsAVtkFileWithoutLineEndAfterTheLastCellType) {
  const TemporaryFolder folder;
  const std::string text = vtk_3.substr(0, vtk_3.find("\nPOINT_DATA"));
  EXPECT_NO_THROW(expect_the_sample(read_mesh(folder.write("mesh.vtk", text))));
}

}  // namespace read_mesh_test
}  // namespace softsim::test
