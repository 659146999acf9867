// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <string>

/// The same two tetrahedra, of regions 7 and 9, in every accepted format. Beside them stand surface and line
/// elements.
/// Node positions: (0 0 0), (1 0 0), (0 1 0), (0 0 1), (1 1 1.5).
namespace softsim::test {

// Gaps in the node numbers, an exponent with three digits.
inline const std::string gmsh_1 = R"($NOD
5
2 0 0 0
11 1 0 0.e+000
12 0. 1 0
30 0 0 1000e-003
31 1 1 1.5
$ENDNOD
$ELM
4
1 15 1 1 1 2
2 2 3 1 3 2 11 12
5 4 7 1 4 2 11 12 30
6 4 9 2 4 11 12 30 31
$ENDELM
)";

inline const std::string gmsh_2 = R"($MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
2
3 7 "soft tissue"
3 9 "$vessel"
$EndPhysicalNames
$Nodes
5
1 0 0 0
2 1 0 0
3 0 1 0
4 0 0 1
5 +1 1 1.5
$EndNodes
$Elements
5
1 1 0 1 2
2 2 2 1 1 1 2 3
3 3 1 1 1 2 5 3
4 4 2 7 1 1 2 3 4
5 4 4 9 2 1 -2 2 3 4 5
$EndElements
$NodeData
1
"u"
0
3
0
1
0
$EndNodeData
)";

inline const std::string gmsh_4 = R"($MeshFormat
4.1 0 8
$EndMeshFormat
$Comments
written by hand
$EndComments
$Entities
1 0 1 2
1 0 0 0 0
1 0 0 0 1 1 1 1 3 0
1 0 0 0 1 1 1 2 7 8 1 1
2 0 0 0 1 1 1.5 0 0
$EndEntities
$Nodes
2 5 1 5
2 1 1 3
1
2
3
0 0 0 0 0
1 0 0 1 0
0 1 0 0 1
3 9 0 2
5
4
1 1 1.5
0 0 1
$EndNodes
$Elements
3 4 1 9
2 1 2 2
1 1 2 3
2 1 2 4
3 1 4 1
3 1 2 3 4
3 9 4 1
9 2 3 4 5
$EndElements
)";

inline const std::string vtk_3 = R"(# vtk DataFile Version 3.0

ASCII
DATASET UNSTRUCTURED_GRID
FIELD FieldData 1
TIME 1 1 double
0.5
POINTS 5 float
0 0 0 1 0 0 0 1 0
0 0 1 1 1 1.5

CELLS 4 17
3 0 1 2
4 0 1 2 3
2 0 1
4 1 2 3 4
CELL_TYPES 4
5
10
3
10
POINT_DATA 5
SCALARS u double 1
LOOKUP_TABLE default
0 1 2 3 4
VECTORS v float
0 0 0 1 1 1 2 2 2 3 3 3 4 4 4
LOOKUP_TABLE table 2
0 0 0 1 1 1 1 1
CELL_DATA 4
SCALARS tissue int
LOOKUP_TABLE default
1 7 2 9
)";

inline const std::string vtk_5 = R"(# vtk DataFile Version 5.1
vtk output
ASCII
DATASET UNSTRUCTURED_GRID
POINTS 5 double
0 0 0 1 0 0 0 1 0 
0 0 1 1 1 1.5 
METADATA
INFORMATION 0

CELLS 4 8
OFFSETS vtktypeint64
0 4 4 8 
CONNECTIVITY vtktypeint64
0 1 2 3 
1 2 3 4 
CELL_TYPES 3
10
0
10

CELL_DATA 3
FIELD FieldData 3
pressure 1 3 double
0.5 1e-3 -2 
METADATA
INFORMATION 0

the%20name 1 3 string
soft%20tissue

vessel
tissue 1 3 double
7 1e0 9 
METADATA
INFORMATION 0

)";

inline const std::string vtu_one_piece = R"(<?xml version="1.0"?>
<!-- written by hand -->
<VTKFile byte_order="LittleEndian" type='UnstructuredGrid' version="0.1">
  <UnstructuredGrid>
    <FieldData><DataArray type="String" Name="note" format="ascii">65 0</DataArray></FieldData>
    <Piece NumberOfCells="3" NumberOfPoints="5">
      <PointData Scalars="u">
        <DataArray type="Float32" Name="u" format="ascii">0 1 2 3 4</DataArray>
      </PointData>
      <CellData>
        <DataArray Name="a &lt; b" type="Float64" format="ascii">0.5 0 1</DataArray>
        <DataArray format="ascii" Name="tissue" type="Int64">1 7
          9</DataArray>
      </CellData>
      <Points>
        <DataArray type="Float32" format="ascii" NumberOfComponents="3">
          0 0 0  1 0 0  0 1 0 <!-- a comment -->
          0 0 1  1 1 1.5
          <InformationKey name="L2_NORM_RANGE" location="vtkDataArray" length="2">
            <Value index="0">0</Value>
          </InformationKey>
        </DataArray>
      </Points>
      <Cells>
        <DataArray type="UInt8" Name="types" format="ascii">5 10 10</DataArray>
        <DataArray type="Int32" Name="offsets" format="ascii">3 7 11</DataArray>
        <DataArray type="Int64" Name="connectivity" format="ascii">
          0 1 2
          0 1 2 3
          1 2 3 4
        </DataArray>
      </Cells>
    </Piece>
  </UnstructuredGrid>
</VTKFile>
)";

// The second piece brings all of its four points along.
inline const std::string vtu_two_pieces = R"(<VTKFile type="UnstructuredGrid">
<UnstructuredGrid>
<Piece NumberOfPoints="4" NumberOfCells="1">
<Points><DataArray type="Float64" NumberOfComponents="3">0 0 0 1 0 0 0 1 0 0 0 1</DataArray></Points>
<Cells>
<DataArray type="Int32" Name="connectivity">0 1 2 3</DataArray>
<DataArray type="Int32" Name="offsets">4</DataArray>
<DataArray type="UInt8" Name="types">10</DataArray>
</Cells>
<CellData><DataArray type="UInt8" Name="tissue">7</DataArray></CellData>
</Piece>
<Piece NumberOfPoints="0" NumberOfCells="0">
<Points/><Cells/><CellData><DataArray type="UInt8" Name="tissue"/></CellData>
</Piece>
<Piece NumberOfPoints="4" NumberOfCells="1">
<Points><DataArray type="Float64" NumberOfComponents="3">1 0 0 0 1 0 0 0 1 1 1 1.5</DataArray></Points>
<Cells>
<DataArray type="Int32" Name="connectivity">0 1 2 3</DataArray>
<DataArray type="Int32" Name="offsets">4</DataArray>
<DataArray type="UInt8" Name="types">10</DataArray>
</Cells>
<CellData><DataArray type="UInt8" Name="tissue">9</DataArray></CellData>
</Piece>
</UnstructuredGrid>
</VTKFile>
)";

}  // namespace softsim::test
