#ifndef FASCICLE_TESTS_SUPPORT_MESH_SAMPLES_H_
#define FASCICLE_TESTS_SUPPORT_MESH_SAMPLES_H_

#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "core/geometry/mesh_io.h"

namespace fascicle {

// One small mesh as a file of every format: the unit corner tetrahedron and its mirror image above the slanted side,
// physical tags 10 and 20, a triangle in x = 0 with tag 7.
struct MeshSample {
  std::string name;
  std::string bytes;
  std::string element_bytes;
  // `bytes` (for TetGen `element_bytes`) truncated to at most this length has lost data.
  std::size_t incomplete_below = 0;
};

inline std::string Replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  return at == std::string::npos ? std::string() : text.replace(at, from.size(), to);
}

inline const char* const kGmsh2 = R"($MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
2
2 7 "side"
3 10 "muscle"
$EndPhysicalNames
$Nodes
5
1 0 0 0
2 1 0 0
3 0 1 0
4 0 0 1
5 1 1 1
$EndNodes
$Elements
4
1 15 2 0 1 1
2 2 2 7 1 1 3 4
3 4 2 10 1 1 2 3 4
4 4 2 20 1 2 3 4 5
$EndElements
)";

// Nodes in two blocks, out of order, one of them parametric.
inline const char* const kGmsh4 = R"($MeshFormat
4.1 0 8
$EndMeshFormat
$Entities
1 0 1 2
1 0 0 0 0
3 0 0 0 0 1 1 1 7 0
1 0 0 0 1 1 1 1 10 1 3
2 0 0 0 1 1 1 1 20 1 3
$EndEntities
$Nodes
2 5 1 5
2 3 1 2
5
4
1 1 1 0.5 0.5
0 0 1 0.25 0.75
3 1 0 3
1
2
3
0 0 0
1 0 0
0 1 0
$EndNodes
$Elements
4 4 1 4
0 1 15 1
1 1
2 3 2 1
2 1 3 4
3 1 4 1
3 1 2 3 4
3 2 4 1
4 2 3 4 5
$EndElements
)";

inline const char* const kMedit = R"(MeshVersionFormatted 2
# a comment
Dimension 3
Vertices
5
0 0 0 0
1 0 0 0
0 1 0 0
0 0 1 0
1 1 1 0
Corners 2
1
2
Triangles 1
1 3 4 7
Tetrahedra
2
1 2 3 4 10
2 3 4 5 20
End
)";

inline const char* const kTetgenNodes = R"(# from 1
5 3 1 1
1 0 0 0 0.5 0
2 1 0 0 0.5 0
3 0 1 0 0.5 0
4 0 0 1 0.5 0  # comment
5 1 1 1 0.5 0
)";
inline const char* const kTetgenElements = "2 4 1\n1 1 2 3 4 10\n2 2 3 4 5 20\n# end\n";

inline const char* const kVtkAscii = R"(# vtk DataFile Version 3.0
two tetrahedra
ASCII
DATASET UNSTRUCTURED_GRID
POINTS 5 double
0 0 0 1 0 0 0 1 0 0 0 1 1 1 1
CELLS 3 14
3 0 2 3
4 0 1 2 3
4 1 2 3 4
CELL_TYPES 3
5 10 10
POINT_DATA 5
VECTORS velocity float
0 0 0 0 0 0 0 0 0 0 0 0 0 0 0
CELL_DATA 3
SCALARS other float 1
LOOKUP_TABLE default
0.5 0.5 0.5
FIELD FieldData 1
physical 1 3 int
7 10 20
)";

inline const char* const kVtkAscii5 = R"(# vtk DataFile Version 5.1
two tetrahedra
ASCII
DATASET UNSTRUCTURED_GRID
POINTS 5 float
0 0 0 1 0 0 0 1 0 0 0 1 1 1 1
METADATA
INFORMATION 0

CELLS 4 11
OFFSETS vtktypeint64
0 3 7 11
CONNECTIVITY vtktypeint64
0 2 3 0 1 2 3 1 2 3 4
CELL_TYPES 3
5 10 10
CELL_DATA 3
SCALARS medit:ref int
LOOKUP_TABLE default
7 10 20
)";

inline const char* const kVtu = R"(<?xml version="1.0"?>
<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian">
  <UnstructuredGrid>
    <Piece NumberOfPoints="5" NumberOfCells="3">
      <Points>
        <DataArray type="Float64" NumberOfComponents="3" format="ascii">
          0 0 0  1 0 0  0 1 0  0 0 1  1 1 1
        </DataArray>
      </Points>
      <Cells>
        <DataArray type="Int64" Name="connectivity" format="ascii">0 2 3  0 1 2 3  1 2 3 4</DataArray>
        <DataArray type="Int64" Name="offsets" format="ascii">3 7 11</DataArray>
        <DataArray type="UInt8" Name="types" format="ascii">5 10 10</DataArray>
      </Cells>
      <CellData>
        <DataArray type="Int32" Name="gmsh:physical" format="ascii">7 10 20</DataArray>
      </CellData>
    </Piece>
  </UnstructuredGrid>
</VTKFile>
)";

// Big-endian bytes of numbers.
template <class Number>
std::string BigEndian(const std::vector<Number>& values) {
  std::string bytes;
  for (const Number& value : values) {
    const char* begin = reinterpret_cast<const char*>(&value);
    bytes.append(std::make_reverse_iterator(begin + sizeof(value)), std::make_reverse_iterator(begin));
  }
  return bytes;
}

inline std::string VtkBinary() {
  using Ints = std::vector<std::int32_t>;
  return "# vtk DataFile Version 2.0\ntwo tetrahedra\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 float\n" +
         BigEndian<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1}) + "\nCELLS 3 14\n" +
         BigEndian(Ints{3, 0, 2, 3, 4, 0, 1, 2, 3, 4, 1, 2, 3, 4}) + "\nCELL_TYPES 3\n" + BigEndian(Ints{5, 10, 10}) +
         "\nCELL_DATA 3\nSCALARS tag int 1\nLOOKUP_TABLE default\n" + BigEndian(Ints{7, 10, 20}) + "\n";
}

// Raw appended data with a header of 64 bits.
inline std::string VtuAppended() {
  const auto block = [](std::string bytes) {
    const std::uint64_t size = bytes.size();
    return std::string(reinterpret_cast<const char*>(&size), 8) + bytes;
  };
  const auto bytes = [](const auto& values) {
    return std::string(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(values[0]));
  };
  using Ints = std::vector<std::int32_t>;
  std::string data,
      xml =
          "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">"
          "<UnstructuredGrid><Piece NumberOfPoints=\"5\" NumberOfCells=\"3\">";
  const auto array = [&](const std::string& head, const std::string& content) {
    xml += "<DataArray " + head + " format=\"appended\" offset=\"" + std::to_string(data.size()) + "\"/>";
    data += block(content);
  };
  xml += "<Points>";
  array("type=\"Float32\" NumberOfComponents=\"3\"",
        bytes(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1}));
  xml += "</Points><Cells>";
  array("type=\"Int32\" Name=\"connectivity\"", bytes(Ints{0, 2, 3, 0, 1, 2, 3, 1, 2, 3, 4}));
  array("type=\"Int32\" Name=\"offsets\"", bytes(Ints{3, 7, 11}));
  array("type=\"UInt8\" Name=\"types\"", std::string("\5\n\n"));
  xml += "</Cells><CellData>";
  array("type=\"Int32\" Name=\"tag\"", bytes(Ints{7, 10, 20}));
  return xml + "</CellData></Piece></UnstructuredGrid><AppendedData encoding=\"raw\">_" + data +
         "</AppendedData></VTKFile>";
}

inline std::vector<MeshSample> MeshSamples() {
  const auto sample = [](std::string name, std::string bytes, std::size_t spare) {
    return MeshSample{std::move(name), bytes, "", bytes.size() - spare};
  };
  // The end of the last line may be missing, and the end of the XML after raw data. A legacy VTK file is complete
  // without its attributes, so it may be truncated before the section `last`.
  const auto legacy = [](std::string name, std::string bytes, const std::string& last) {
    return MeshSample{std::move(name), bytes, "", bytes.rfind(last) - 1};
  };
  std::vector<MeshSample> samples = {sample("gmsh2.msh", kGmsh2, 1),
                                     sample("gmsh4.msh", kGmsh4, 1),
                                     legacy("medit.mesh", kMedit, "End"),
                                     sample("ascii.vtu", kVtu, 1),
                                     sample("appended.vtu", VtuAppended(), std::string("</VTKFile>").size()),
                                     legacy("binary.vtk", VtkBinary(), "CELL_DATA"),
                                     legacy("ascii.vtk", kVtkAscii, "POINT_DATA"),
                                     legacy("ascii5.vtk", kVtkAscii5, "CELL_DATA")};
  const std::string elements = kTetgenElements;
  samples.push_back({"tetgen.node", kTetgenNodes, elements, elements.size() - std::string("20\n# end\n").size() + 1});
  return samples;
}

}  // namespace fascicle

#endif  // FASCICLE_TESTS_SUPPORT_MESH_SAMPLES_H_
