// Files that are wrong in different ways: each is refused with a helpful message.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/geometry/mesh_io.h"
#include "tests/support/mesh_samples.h"

namespace fascicle {
namespace {

struct Malformed {
  std::string title;  // letters only
  std::string name;
  std::string bytes;
  std::string element_bytes;
  std::string message;  // part of the message
};

std::vector<Malformed> MalformedFiles() {
  const std::string appended = VtuAppended(), binary = VtkBinary();
  std::vector<Malformed> files = {
      {"UnknownExtension", "m.xyz", kGmsh2, "", "`.xyz` is not that of a mesh"},
      {"NoExtension", "mesh", kGmsh2, "", "is not that of a mesh"},
      {"Surface", "m.stl", "solid", "", "fill it with tetrahedra"},
      {"EleAsMesh", "m.ele", kTetgenElements, "", "give the .node file"},
      // Gmsh
      {"GmshEmpty", "m.msh", "", "", "the file is empty"},
      {"GmshOther", "m.msh", "hello", "", "expected $MeshFormat but found `hello`"},
      {"GmshUnprintable", "m.msh", std::string("\x01\x02\0\xff", 4), "", "found `????`"},
      {"GmshBinary", "m.msh", Replaced(kGmsh2, "2.2 0 8", "2.2 1 8"), "",
       "line 3: the file is binary (write it as ASCII"},
      {"GmshVersion", "m.msh", Replaced(kGmsh2, "2.2 0 8", "4.0 0 8"), "", "version is 4 (write version 2.2 or 4.1)"},
      {"GmshNegativeNodes", "m.msh", Replaced(kGmsh2, "$Nodes\n5", "$Nodes\n-5"), "",
       "line 10: the number of nodes is -5"},
      {"GmshFiveBillionNodes", "m.msh", Replaced(kGmsh2, "$Nodes\n5", "$Nodes\n5000000000"), "",
       "5000000000 nodes are announced, but the file ends"},
      {"GmshTooLargeForAnyInteger", "m.msh", Replaced(kGmsh2, "$Nodes\n5", "$Nodes\n99999999999999999999"), "",
       "expected the number of nodes but found"},
      {"GmshTooFewNodes", "m.msh", Replaced(kGmsh2, "$Nodes\n5", "$Nodes\n6"), "",
       "line 16: expected a node number but found `$EndNodes`"},
      {"GmshTooManyNodes", "m.msh", Replaced(kGmsh2, "$Nodes\n5", "$Nodes\n4"), "",
       "line 15: expected $EndNodes but found `5`"},
      {"GmshWordAsCoordinate", "m.msh", Replaced(kGmsh2, "2 1 0 0", "2 1 zero 0"), "",
       "line 12: expected a coordinate but found `zero`"},
      {"GmshHalfNumber", "m.msh", Replaced(kGmsh2, "2 1 0 0", "2 1.5.3 0 0"), "", "found `1.5.3`"},
      {"GmshNodeTwice", "m.msh", Replaced(kGmsh2, "5 1 1 1\n$End", "4 1 1 1\n$End"), "", "node 4 is given twice"},
      {"GmshNoSuchNode", "m.msh", Replaced(kGmsh2, "2 3 4 5", "2 3 4 6"), "",
       "1 tetrahedra refer to nodes that do not exist: the first is number 1 (counted from 0), which refers to node 6"},
      {"GmshNegativeTags", "m.msh", Replaced(kGmsh2, "3 4 2 10", "3 4 -2 10"), "", "the number of tags is -2"},
      {"GmshHugeTag", "m.msh", Replaced(kGmsh2, "2 10 1", "2 9999999999 1"), "", "tag 9999999999 does not fit"},
      {"GmshThirdOrder", "m.msh", Replaced(Replaced(kGmsh2, "3 4 2 10", "3 29 2 10"), "4 4 2 20", "4 29 2 20"), "",
       "2 of higher order and 2 cells of other kinds (write the mesh with element order 1, or 2"},
      {"GmshMixedOrders", "m.msh", Replaced(kGmsh2, "3 4 2 10 1 1 2 3 4", "3 11 2 10 1 1 2 3 4 5 5 5 5 5 5"), "",
       "mixes tetrahedra of four and of ten nodes"},
      {"GmshCornerInTheMiddle", "m.msh",
       Replaced(Replaced(kGmsh2, "3 4 2 10 1 1 2 3 4", "3 11 2 10 1 1 2 3 4 5 5 5 5 5 5"), "4 4 2 20 1 2 3 4 5",
                "4 11 2 20 1 2 3 4 5 1 1 1 1 1 1"),
       "", "edges have different mid-edge nodes"},
      {"GmshNoElements", "m.msh", std::string(kGmsh2).substr(0, std::string(kGmsh2).find("$Elements")), "",
       "no section $Elements (is the file complete?)"},
      {"GmshTwoNodeSections", "m.msh", std::string(kGmsh2) + "$Nodes\n0\n$EndNodes\n", "", "a second section $Nodes"},
      {"Gmsh4Binary", "m.msh", Replaced(kGmsh4, "4.1 0 8", "4.1 1 8"), "", "the file is binary"},
      {"Gmsh4HugeBlock", "m.msh", Replaced(kGmsh4, "3 1 0 3\n", "3 1 0 300000000000\n"), "",
       "300000000000 nodes are announced"},
      {"Gmsh4WrongTotal", "m.msh", Replaced(kGmsh4, "2 5 1 5", "2 4 1 5"), "",
       "4 nodes are announced, but the blocks have 5"},
      {"Gmsh4Dimension", "m.msh", Replaced(kGmsh4, "3 1 0 3\n", "1000000000 1 1 3\n"), "",
       "an entity of dimension 1000000000"},
      {"Gmsh4HugeEntities", "m.msh", Replaced(kGmsh4, "1 0 1 2\n", "1 0 1 4000000000\n"), "",
       "4000000000 entities are announced"},
      {"GmshPyramidBesideTetrahedra", "m.msh", Replaced(kGmsh2, "1 15 2 0 1 1", "1 7 2 10 1 1 2 3 4 5"), "",
       "the file has 1 pyramids"},
      {"GmshThirdOrderBesideOthers", "m.msh", Replaced(kGmsh2, "4 4 2 20 1 2 3 4 5", "4 29 2 20 1 2 3 4 5"), "",
       "1 volume elements of the file are of kinds that are not supported"},
      // MEDIT
      {"MeditOther", "m.mesh", "$MeshFormat", "", "expected MeshVersionFormatted"},
      {"MeditTwoDimensions", "m.mesh", Replaced(kMedit, "Dimension 3", "Dimension 2"), "", "the mesh has dimension 2"},
      {"MeditHuge", "m.mesh", Replaced(kMedit, "Vertices\n5", "Vertices\n500000000"), "",
       "500000000 vertices are announced"},
      {"MeditNegative", "m.mesh", Replaced(kMedit, "Tetrahedra\n2", "Tetrahedra\n-2"), "",
       "the number of tetrahedra is -2"},
      {"MeditCountsFromZero", "m.mesh", Replaced(kMedit, "1 2 3 4 10", "0 1 2 3 10"), "", "which refers to node 0"},
      {"MeditCutNumber", "m.mesh", Replaced(kMedit, "20\nEnd\n", "2"), "", "ends without the keyword End"},
      {"MeditTwoSections", "m.mesh", Replaced(kMedit, "End\n", "Tetrahedra 0\nEnd\n"), "", "a second section Tetra"},
      {"MeditHexahedra", "m.mesh", Replaced(kMedit, "End\n", "Hexahedra 1\n1 2 3 4 5 1 2 3 0\nEnd\n"), "",
       "the file has 1 hexahedra and 2 tetrahedra; a mesh must have tetrahedra only, or none (`fascicle "
       "mesh FILE --convert --split-hexahedra"},
      // TetGen
      {"TetgenNoElements", "m.node", kTetgenNodes, "", "the .ele file with the tetrahedra is missing"},
      {"TetgenTwoDimensions", "m.node", Replaced(kTetgenNodes, "5 3 1 1", "5 2 1 1"), kTetgenElements, "dimension 2"},
      {"TetgenHuge", "m.node", kTetgenNodes, Replaced(kTetgenElements, "2 4 1\n", "2000000000 4 1\n"),
       ".ele file, line 1: 2000000000 tetrahedra are announced"},
      {"TetgenSecondOrder", "m.node", kTetgenNodes, Replaced(kTetgenElements, "2 4 1", "2 10 1"), "2 of higher order"},
      {"TetgenWrongStart", "m.node", Replaced(kTetgenNodes, "\n1 0 0 0", "\n7 0 0 0"), kTetgenElements,
       "counts from 0 or from 1"},
      {"TetgenTooManyNodes", "m.node", Replaced(kTetgenNodes, "5 3 1 1", "4 3 1 1"), kTetgenElements,
       "more values than announced"},
      {"TetgenRegion", "m.node", kTetgenNodes, Replaced(kTetgenElements, " 10\n", " 0.5\n"), "not a whole number"},
      {"TetgenManyAttributes", "m.node", Replaced(kTetgenNodes, "5 3 1 1", "5 3 1000000000000 1"), kTetgenElements,
       "1000000000000 as"},
      // VTK legacy
      {"VtkOther", "m.vtk", "vtk", "", "does not begin with `# vtk DataFile Version`"},
      {"VtkSurface", "m.vtk", Replaced(kVtkAscii, "UNSTRUCTURED_GRID", "POLYDATA"), "", "the data set is `POLYDATA`"},
      {"VtkHuge", "m.vtk", Replaced(kVtkAscii, "POINTS 5", "POINTS 5000000000"), "", "5000000000 points are announced"},
      {"VtkNegative", "m.vtk", Replaced(kVtkAscii, "CELLS 3", "CELLS -3"), "", "the number of cells is -3"},
      {"VtkType", "m.vtk", Replaced(kVtkAscii, "5 double", "5 quaternion"), "", "unknown type of numbers `quaternion`"},
      {"VtkCellTooLong", "m.vtk", Replaced(kVtkAscii, "4 1 2 3 4", "9 1 2 3 4"), "", "cell 2 reaches beyond the list"},
      {"VtkNodeOutside", "m.vtk", Replaced(kVtkAscii, "4 1 2 3 4", "4 1 2 3 5"), "", "cell 2 refers to node 5 of 5"},
      {"VtkTypesMissing", "m.vtk", Replaced(kVtkAscii, "CELL_TYPES 3\n5 10 10", "CELL_TYPES 2\n5 10"), "",
       "data of 3 cells, where there are 2"},
      {"VtkOffsets", "m.vtk", Replaced(kVtkAscii5, "0 3 7 11", "0 3 70 11"), "",
       "cell 1 refers beyond the connectivity array"},
      {"VtkOffsetsFall", "m.vtk", Replaced(kVtkAscii5, "0 3 7 11", "0 7 3 11"), "", "cell 0 of type 5 has 7 nodes"},
      {"VtkBinaryHuge", "m.vtk", Replaced(binary, "POINTS 5 float", "POINTS 50 float"), "",
       "announced, but the file ends"},
      // VTK XML
      {"VtuNotXml", "m.vtu", "hello", "", "line 1: No document element found"},
      {"VtuBrokenXml", "m.vtu", Replaced(kVtu, "</Cells>", "</Cell>"), "", "line 14: Start-end tags mismatch"},
      {"VtuOtherType", "m.vtu", Replaced(kVtu, "\"UnstructuredGrid\"", "\"PolyData\""), "",
       "not a VTKFile of type UnstructuredGrid"},
      {"VtuHuge", "m.vtu", Replaced(kVtu, "Points=\"5\"", "Points=\"5000000000\""), "",
       "15000000000 numbers are announced"},
      {"VtuNegative", "m.vtu", Replaced(kVtu, "Cells=\"3\"", "Cells=\"-3\""), "", "NumberOfCells is `-3`"},
      {"VtuTooFewPoints", "m.vtu", Replaced(kVtu, "0 0 1  1 1 1", "0 0 1  1 1"), "",
       "the file ends where a number should follow"},
      {"VtuTooManyPoints", "m.vtu", Replaced(kVtu, "0 0 1  1 1 1", "0 0 1  1 1 1 1"), "", "more than 15 numbers"},
      {"VtuMissingArray", "m.vtu", Replaced(kVtu, "Name=\"types\"", "Name=\"kinds\""), "",
       "the array `types` is missing"},
      {"VtuFormat", "m.vtu", Replaced(kVtu, "Name=\"types\" format=\"ascii\"", "Name=\"types\" format=\"hex\""), "",
       "the format `hex`"},
      {"VtuBadBase", "m.vtu", Replaced(kVtu, "Name=\"types\" format=\"ascii\"", "Name=\"types\" format=\"binary\""), "",
       "the array `types`"},
      {"VtuCompressor", "m.vtu", Replaced(kVtu, "byte_order=", "compressor=\"vtkLZ4DataCompressor\" byte_order="), "",
       "write it with vtkZLibDataCompressor"},
      {"VtuByteOrder", "m.vtu", Replaced(kVtu, "LittleEndian", "MiddleEndian"), "",
       "unknown byte_order `MiddleEndian`"},
      {"VtuOffset", "m.vtu", Replaced(appended, "offset=\"0\"", "offset=\"999999\""), "",
       "begins beyond the appended data"},
      {"VtuWrongBlock", "m.vtu", Replaced(appended, "offset=\"0\"", "offset=\"20\""), "", "bytes, but has fewer"},
      {"VtuWrongSize", "m.vtu", Replaced(appended, "Cells=\"3\"", "Cells=\"2\""), "",
       "bytes where 2 numbers should be"},
  };
  return files;
}

class MalformedMesh : public ::testing::TestWithParam<Malformed> {};

TEST_P(MalformedMesh, IsRefusedInWords) {
  const Malformed& file = GetParam();
  ASSERT_TRUE(!file.bytes.empty() || file.title == "GmshEmpty") << "the sample has changed";
  Problems problems;
  const auto mesh = ReadMesh({file.name, file.bytes, file.element_bytes}, problems);
  EXPECT_FALSE(mesh);
  EXPECT_THAT(problems.ToString(), ::testing::HasSubstr(file.message));
}

INSTANTIATE_TEST_SUITE_P(Files, MalformedMesh, ::testing::ValuesIn(MalformedFiles()),
                         [](const auto& test) { return test.param.title; });

// A header that announces 5 GB in the compressed blocks of a small file allocates almost nothing.
TEST(MalformedMeshTest, ClaimsOfHugeCompressedBlocks) {
  const auto words = [](std::vector<std::uint64_t> values) {
    return std::string(reinterpret_cast<const char*>(values.data()), 8 * values.size());
  };
  const std::string plain = VtuAppended();
  const std::size_t data = plain.find('_', plain.find("<AppendedData")) + 1;
  const std::string head =
      Replaced(plain.substr(0, data), "byte_order", "compressor=\"vtkZLibDataCompressor\" byte_order");
  const std::string tail = std::string(100, 'x') + "</AppendedData></VTKFile>";
  const std::vector<std::vector<std::uint64_t>> headers = {
      {1, 5000000000, 0, 50},   // one block of 5 GB
      {5000000000, 1, 0, 50},   // 5e9 blocks
      {1, ~0ull, ~0ull, 50},    // sizes that overflow
      {2, 8, 8, ~0ull, 2},      // compressed sizes that overflow in sum
      {1ull << 61, 8, 8, 8},    // a header whose size overflows
      {1, 60, 0, 5000000000}};  // more compressed bytes than there are
  for (const auto& header : headers) {
    Problems problems;
    const std::string bytes = head + words(header) + tail;
    EXPECT_FALSE(ReadMesh({"m.vtu", bytes, ""}, problems));
    EXPECT_EQ(problems.count(), 1u) << problems.ToString();
    EXPECT_THAT(problems.ToString(), ::testing::HasSubstr("the array `Points` "));
  }
}

}  // namespace
}  // namespace fascicle
