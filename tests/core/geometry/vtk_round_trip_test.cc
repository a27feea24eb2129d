// Files written by VTK itself, in all its variants.
#include <gtest/gtest.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkDataWriter.h>
#include <vtkDoubleArray.h>
#include <vtkFloatArray.h>
#include <vtkIntArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkUnstructuredGrid.h>
#include <vtkUnstructuredGridWriter.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include "core/geometry/mesh_io.h"
#include "core/geometry/shapes.h"

namespace fascicle {
namespace {

constexpr int kTriangle = 17, kFirst = 100, kSecond = 200;

// A fusiform muscle with two tags, one tagged triangle, and other data that must be skipped.
TetMesh Original() {
  TetMesh mesh = MakeFusiform({0.1, 0.014, 0.006, 4, 10});
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) mesh.tetrahedron_tags.push_back(t % 3 ? kFirst : kSecond);
  mesh.tagged_triangles = {BoundaryTriangles(mesh)[5]};
  mesh.triangle_tags = {kTriangle};
  return mesh;
}

vtkNew<vtkUnstructuredGrid> Grid(const TetMesh& mesh, bool single_precision) {
  vtkNew<vtkUnstructuredGrid> grid;
  vtkNew<vtkPoints> points;
  points->SetDataType(single_precision ? VTK_FLOAT : VTK_DOUBLE);
  vtkNew<vtkFloatArray> velocity;
  velocity->SetName("velocity");
  velocity->SetNumberOfComponents(3);
  velocity->SetComponentName(0, "along");  // makes VTK write metadata
  for (const Vec3& node : mesh.nodes) {
    points->InsertNextPoint(node.data());
    velocity->InsertNextTuple3(1.5, 10.0, 9.25);
  }
  grid->SetPoints(points);
  grid->GetPointData()->AddArray(velocity);
  grid->GetPointData()->SetVectors(velocity);

  vtkNew<vtkDoubleArray> energy;
  energy->SetName("energy");
  vtkNew<vtkIntArray> tags;
  tags->SetName("gmsh:physical");
  const auto add = [&](int type, const auto& cell, int tag) {
    const std::vector<vtkIdType> nodes(cell.begin(), cell.end());
    grid->InsertNextCell(type, static_cast<vtkIdType>(nodes.size()), nodes.data());
    tags->InsertNextValue(tag);
    energy->InsertNextValue(0.1 * tag);
  };
  add(VTK_VERTEX, std::array{3}, 0);
  add(VTK_TRIANGLE, mesh.tagged_triangles[0], kTriangle);
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
    add(VTK_TETRA, mesh.tetrahedra[t], mesh.tetrahedron_tags[t]);
  }
  add(VTK_LINE, std::array{3, 4}, 0);
  grid->GetCellData()->SetScalars(energy);
  grid->GetCellData()->AddArray(tags);
  return grid;
}

void ExpectSame(const std::string& name, const std::string& bytes, double tolerance, const TetMesh& expected) {
  Problems problems;
  const std::optional<TetMesh> mesh = ReadMesh({name, bytes, ""}, problems);
  ASSERT_TRUE(mesh) << problems.ToString();
  ASSERT_EQ(mesh->nodes.size(), expected.nodes.size());
  for (std::size_t n = 0; n < expected.nodes.size(); ++n) {
    ASSERT_LE((mesh->nodes[n] - expected.nodes[n]).norm(), tolerance) << n;
  }
  EXPECT_EQ(mesh->tetrahedra, expected.tetrahedra);
  EXPECT_EQ(mesh->tetrahedron_tags, expected.tetrahedron_tags);
  EXPECT_EQ(mesh->tagged_triangles, expected.tagged_triangles);
  EXPECT_EQ(mesh->triangle_tags, expected.triangle_tags);
}

// [m]. Single precision has 24 bits; VTK prints numbers of ascii files with 6 (legacy) or 11 digits.
double Tolerance(bool single_precision, bool ascii_digits) { return single_precision || ascii_digits ? 1e-6 : 0; }

class Legacy : public ::testing::TestWithParam<std::tuple<int, int, bool>> {};

TEST_P(Legacy, IsReadBack) {
  const auto [version, file_type, single_precision] = GetParam();
  const TetMesh original = Original();
  vtkNew<vtkUnstructuredGridWriter> writer;
  const auto grid = Grid(original, single_precision);
  writer->SetInputData(grid);
  writer->SetFileVersion(version);
  writer->SetFileType(file_type);
  writer->WriteToOutputStringOn();
  ASSERT_TRUE(writer->Write());
  ExpectSame("m.vtk", writer->GetOutputStdString(), Tolerance(single_precision, file_type == VTK_ASCII), original);
}

INSTANTIATE_TEST_SUITE_P(Ways, Legacy,
                         ::testing::Combine(::testing::Values(vtkDataWriter::VTK_LEGACY_READER_VERSION_4_2,
                                                              vtkDataWriter::VTK_LEGACY_READER_VERSION_5_1),
                                            ::testing::Values(VTK_ASCII, VTK_BINARY), ::testing::Bool()));

// data mode, base64 in the appended part, compressor, header type, byte order, single precision
using XmlWay = std::tuple<int, bool, int, int, int, bool>;
class Xml : public ::testing::TestWithParam<XmlWay> {};

TEST_P(Xml, IsReadBack) {
  const auto [mode, encode, compressor, header, order, single_precision] = GetParam();
  const TetMesh original = Original();
  vtkNew<vtkXMLUnstructuredGridWriter> writer;
  const auto grid = Grid(original, single_precision);
  writer->SetInputData(grid);
  writer->SetDataMode(mode);
  writer->SetEncodeAppendedData(encode);
  writer->SetCompressorType(compressor);
  writer->SetHeaderType(header);
  writer->SetByteOrder(order);
  writer->SetBlockSize(1024);  // many blocks for one array
  writer->WriteToOutputStringOn();
  ASSERT_TRUE(writer->Write());
  ExpectSame("m.vtu", writer->GetOutputString(), Tolerance(single_precision, mode == vtkXMLWriter::Ascii), original);
}

INSTANTIATE_TEST_SUITE_P(
    Ways, Xml,
    ::testing::Combine(::testing::Values(vtkXMLWriter::Ascii, vtkXMLWriter::Binary, vtkXMLWriter::Appended),
                       ::testing::Bool(), ::testing::Values(vtkXMLWriter::NONE, vtkXMLWriter::ZLIB),
                       ::testing::Values(vtkXMLWriter::UInt32, vtkXMLWriter::UInt64),
                       ::testing::Values(vtkXMLWriter::LittleEndian, vtkXMLWriter::BigEndian), ::testing::Bool()));

TEST(XmlTest, OtherCompressorsAreNamed) {
  vtkNew<vtkXMLUnstructuredGridWriter> writer;
  const auto grid = Grid(Original(), false);
  writer->SetInputData(grid);
  writer->SetCompressorType(vtkXMLWriter::LZ4);
  writer->WriteToOutputStringOn();
  ASSERT_TRUE(writer->Write());
  Problems problems;
  EXPECT_FALSE(ReadMesh({"m.vtu", writer->GetOutputString(), ""}, problems));
  EXPECT_NE(problems.ToString().find("vtkLZ4DataCompressor"), std::string::npos) << problems.ToString();
}

}  // namespace
}  // namespace fascicle
