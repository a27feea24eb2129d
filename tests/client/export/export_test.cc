#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <vtkCell.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkDataArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLPolyDataReader.h>
#include <vtkXMLUnstructuredGridReader.h>

#include <cmath>
#include <filesystem>
#include <limits>

#include "client/export/csv.h"
#include "client/export/vtk_series.h"
#include "client/lib/decode.h"
#include "client/lib/replace_file.h"
#include "client/lib/series_table.h"
#include "tests/support/curved_ball.h"
#include "tests/support/files.h"
#include "tests/support/sample_job.h"
#include "tests/support/sample_objects.h"

namespace fascicle::client {
namespace {

namespace fs = std::filesystem;
using ::fascicle::testing::Bytes;
using ::fascicle::testing::CurvedBall;
using ::fascicle::testing::ReadFile;
using ::fascicle::testing::SampleJob;
using ::fascicle::testing::SampleObjects;
using ::fascicle::testing::SampleObjectsFrame;
using ::fascicle::testing::TemporaryFolder;
using ::testing::HasSubstr;

TEST(VtkSeriesWriter, WritesWhatVtkReadsBack) {
  const SampleJob job;
  const TemporaryFolder folder;
  VtkSeriesWriter writer(job.geometry(), folder.path());
  writer.Add(job.frame(0));
  writer.Add(job.frame(7));
  writer.Finish();
  const std::string pvd = ReadFile(folder / "frames.pvd");
  EXPECT_THAT(pvd, HasSubstr(R"(timestep="0.35000000000000003" part="0" name="belly" file="frames/belly_000007.vtu")"));

  vtkNew<vtkXMLUnstructuredGridReader> reader;
  reader->SetFileName((folder / "frames/belly_000007.vtu").c_str());
  reader->Update();
  vtkUnstructuredGrid& grid = *reader->GetOutput();
  ASSERT_EQ(static_cast<std::size_t>(grid.GetNumberOfPoints()), job.nodes());
  ASSERT_EQ(static_cast<std::size_t>(grid.GetNumberOfCells()), job.tetrahedra());
  const v1::Frame frame = job.frame(7);
  const auto shape = DecodeGeometry(job.geometry())[0];
  const auto positions = DecodePositions(frame.bodies(0), shape.positions.size());
  vtkDataArray* displacement = grid.GetPointData()->GetArray("displacement");
  vtkDataArray* stress = grid.GetCellData()->GetArray("von_mises_stress");
  vtkDataArray* velocity = grid.GetPointData()->GetArray("velocity");
  vtkDataArray* region = grid.GetPointData()->GetArray("region/origin");
  vtkDataArray* fibre = grid.GetCellData()->GetArray("rest_fibre");
  ASSERT_TRUE(displacement && stress && velocity && region && fibre);
  const auto values = DecodeField(frame.bodies(0).fields(1), shape);
  for (std::size_t i = 0; i < job.nodes(); ++i) {
    const auto id = static_cast<vtkIdType>(i);
    const Vec3 x(grid.GetPoint(id)), u(displacement->GetTuple(id));
    EXPECT_EQ(x, positions[i]);
    EXPECT_EQ(u, positions[i] - shape.positions[i]);
    EXPECT_EQ(region->GetTuple1(id), shape.positions[i].z() == 0 ? 1 : 0);
    EXPECT_EQ(velocity->GetComponent(id, 2), 0.5);
  }
  for (std::size_t e = 0; e < job.tetrahedra(); ++e) {
    const auto id = static_cast<vtkIdType>(e);
    EXPECT_EQ(stress->GetTuple1(id), values[e]);
    EXPECT_EQ(fibre->GetComponent(id, 2), 1);
    vtkIdType count;
    const vtkIdType* nodes;
    grid.GetCellPoints(id, count, nodes);
    ASSERT_EQ(count, 4);
    for (std::size_t n = 0; n < 4; ++n) EXPECT_EQ(nodes[n], shape.tetrahedra[e][n]);
  }
}

// Hexahedra: cells in VTK's order, with a fibre and a value each.
// VTK finds the volume of the curved cells, so its order of nodes is that of the file.
TEST(VtkSeriesWriter, WritesQuadraticCells) {
  const CurvedBall ball;
  const TemporaryFolder folder;
  VtkSeriesWriter writer(ball.geometry(), folder.path());
  writer.Add(ball.frame(5));
  writer.Finish();
  vtkNew<vtkXMLUnstructuredGridReader> reader;
  reader->SetFileName((folder / "frames/ball_000005.vtu").c_str());
  reader->Update();
  vtkUnstructuredGrid& grid = *reader->GetOutput();
  const BodyShape shape = DecodeGeometry(ball.geometry())[0];
  ASSERT_EQ(static_cast<std::size_t>(grid.GetNumberOfPoints()), ball.nodes());
  ASSERT_EQ(static_cast<std::size_t>(grid.GetNumberOfCells()), shape.tetrahedra.size());
  vtkDataArray* displacement = grid.GetPointData()->GetArray("displacement");
  vtkDataArray* velocity = grid.GetPointData()->GetArray("velocity");
  vtkDataArray* region = grid.GetPointData()->GetArray("region/surface");
  ASSERT_TRUE(displacement && velocity && region);
  for (vtkIdType i = 0; i < grid.GetNumberOfPoints(); ++i) {
    const Vec3& X = shape.positions[static_cast<std::size_t>(i)];
    EXPECT_NEAR(displacement->GetComponent(i, 0), 0.5 * X.x(), 1e-16);
    EXPECT_DOUBLE_EQ(velocity->GetComponent(i, 0), X.x() * X.x());
    EXPECT_EQ(region->GetTuple1(i) != 0, X.norm() > 0.999 * CurvedBall::kRadius);
  }
  for (vtkIdType e = 0; e < grid.GetNumberOfCells(); ++e) {
    ASSERT_EQ(grid.GetCellType(e), VTK_QUADRATIC_TETRA);
    // VTK's shape functions put each mid-edge node between the corners of its edge.
    vtkCell* const cell = grid.GetCell(e);
    ASSERT_EQ(cell->GetNumberOfEdges(), 6);
    for (int k = 0; k < 6; ++k) {
      vtkCell* const edge = cell->GetEdge(k);
      const Vec3 a(edge->GetPoints()->GetPoint(0)), b(edge->GetPoints()->GetPoint(1)),
          m(edge->GetPoints()->GetPoint(2));
      EXPECT_LT((m - 0.5 * (a + b)).norm(), 0.3 * (b - a).norm());
    }
  }
}

TEST(VtkSeriesWriter, WritesHexahedraWithTheirFibres) {
  v1::Geometry geometry;
  v1::BodyGeometry& body = *geometry.add_bodies();
  body.set_name("bar");
  std::vector<double> positions;
  for (int n = 0; n < 12; ++n) {
    positions.insert(positions.end(), {1.0 * (n % 3), 1.0 * (n / 3 % 2) + 0.1 * n, 1.0 * (n / 6)});
  }
  const std::vector<std::uint32_t> bricks = {0, 1, 3, 4, 6, 7, 9, 10, 1, 2, 4, 5, 7, 8, 10, 11};
  body.set_positions(Bytes(positions));
  body.set_bricks(Bytes(bricks));
  body.set_fibres(Bytes(std::vector<double>{1, 0, 0, 0, 0.6, 0.8}));
  v1::Frame frame;
  v1::BodyFrame& of_body = *frame.add_bodies();
  of_body.set_positions(Bytes(positions));
  v1::FieldValues& field = *of_body.add_fields();
  field.set_name("volume_ratio");
  field.set_location(v1::FieldValues::LOCATION_BRICK);
  field.set_components(1);
  field.set_values(Bytes(std::vector<double>{1.5, 0.5}));
  const TemporaryFolder folder;
  VtkSeriesWriter writer(geometry, folder.path());
  writer.Add(frame);
  vtkNew<vtkXMLUnstructuredGridReader> reader;
  reader->SetFileName((folder / "frames/bar_000000.vtu").c_str());
  reader->Update();
  vtkUnstructuredGrid& grid = *reader->GetOutput();
  ASSERT_EQ(grid.GetNumberOfCells(), 2);
  const std::vector<std::vector<vtkIdType>> expected = {{0, 1, 4, 3, 6, 7, 10, 9}, {1, 2, 5, 4, 7, 8, 11, 10}};
  for (vtkIdType c = 0; c < 2; ++c) {
    EXPECT_EQ(grid.GetCellType(c), 12);  // VTK_HEXAHEDRON
    vtkIdType count;
    const vtkIdType* nodes;
    grid.GetCellPoints(c, count, nodes);
    EXPECT_EQ(std::vector<vtkIdType>(nodes, nodes + count), expected[static_cast<std::size_t>(c)]);
  }
  vtkDataArray* fibre = grid.GetCellData()->GetArray("rest_fibre");
  vtkDataArray* ratio = grid.GetCellData()->GetArray("volume_ratio");
  ASSERT_TRUE(fibre && ratio);
  EXPECT_EQ(fibre->GetComponent(1, 2), 0.8);
  EXPECT_EQ(ratio->GetTuple1(1), 0.5);
  body.set_fibres(Bytes(std::vector<double>{1, 0, 0}));
  EXPECT_THROW(DecodeGeometry(geometry), std::runtime_error);
}

// Bodies of the eulerian method: triangles, and every field at the nodes.
TEST(VtkSeriesWriter, WritesSurfacesAsTriangles) {
  v1::Geometry geometry;
  v1::BodyGeometry& body = *geometry.add_bodies();
  body.set_name("skin");
  const std::vector<double> positions = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  const std::vector<std::uint32_t> triangles = {0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2};
  body.set_positions(Bytes(positions));
  body.set_triangles(Bytes(triangles));
  v1::Frame frame;
  v1::BodyFrame& of_body = *frame.add_bodies();
  of_body.set_positions(Bytes(positions));
  v1::FieldValues& field = *of_body.add_fields();
  field.set_name("cauchy_stress");
  field.set_location(v1::FieldValues::LOCATION_NODE);
  field.set_components(6);
  field.set_values(Bytes(std::vector<double>(24, 2.5)));
  const TemporaryFolder folder;
  VtkSeriesWriter writer(geometry, folder.path());
  writer.Add(frame);
  vtkNew<vtkXMLUnstructuredGridReader> reader;
  reader->SetFileName((folder / "frames/skin_000000.vtu").c_str());
  reader->Update();
  vtkUnstructuredGrid& grid = *reader->GetOutput();
  EXPECT_EQ(grid.GetNumberOfPoints(), 4);
  ASSERT_EQ(grid.GetNumberOfCells(), 4);
  for (vtkIdType c = 0; c < 4; ++c) {
    ASSERT_EQ(grid.GetCellType(c), 5);  // VTK_TRIANGLE
    vtkIdType count;
    const vtkIdType* nodes;
    grid.GetCellPoints(c, count, nodes);
    ASSERT_EQ(count, 3);
    for (int n = 0; n < 3; ++n) EXPECT_EQ(nodes[n], triangles[static_cast<std::size_t>(3 * c + n)]);
  }
  ASSERT_NE(grid.GetPointData()->GetArray("cauchy_stress"), nullptr);
  EXPECT_EQ(grid.GetPointData()->GetArray("cauchy_stress")->GetComponent(3, 5), 2.5);
}

vtkSmartPointer<vtkPolyData> ReadPolyData(const std::string& path) {
  vtkNew<vtkXMLPolyDataReader> reader;
  reader->SetFileName(path.c_str());
  reader->Update();
  return reader->GetOutput();
}

TEST(VtkSeriesWriter, WritesRigidBodiesWhereTheyAre) {
  const TemporaryFolder folder;
  const v1::Geometry geometry = SampleObjects();
  VtkSeriesWriter writer(geometry, folder.path());
  for (const int index : {0, 1}) writer.Add(SampleObjectsFrame(index));
  writer.Finish();
  const std::string pvd = ReadFile(folder / "frames.pvd");
  for (const char* entry : {R"(timestep="0" part="0" name="bone" file="frames/rigid_bone_000000.vtp")",
                            R"(timestep="0.05" part="0" name="bone" file="frames/rigid_bone_000001.vtp")",
                            R"(timestep="0" part="1" name="ground" file="frames/fixed_ground.vtp")",
                            R"(timestep="0.05" part="1" name="ground" file="frames/fixed_ground.vtp")",
                            R"(timestep="0.05" part="3" name="flexor" file="frames/line_flexor_000001.vtp")"}) {
    EXPECT_THAT(pvd, HasSubstr(entry));
  }
  EXPECT_THAT(pvd, ::testing::Not(HasSubstr("joint"))) << "it has no shape";
  const std::vector<RigidShape> bodies = DecodeRigidBodies(geometry);
  // Rotated by 90 degrees about z: (x, y, z) goes to (-y, x, z).
  const auto at = [](const Vec3& X, const Vec3& place) { return Vec3(place + Vec3(-X.y(), X.x(), X.z())); };
  const auto bone = ReadPolyData(folder / "frames/rigid_bone_000001.vtp");
  const auto ground = ReadPolyData(folder / "frames/fixed_ground.vtp");
  for (vtkIdType n = 0; n < 8; ++n) {
    const auto i = static_cast<std::size_t>(n);
    EXPECT_NEAR((Vec3(bone->GetPoint(n)) - at(bodies[0].positions[i], Vec3(0.04, 0.02, 0))).norm(), 0, 1e-15);
    EXPECT_NEAR((Vec3(ground->GetPoint(n)) - at(bodies[1].positions[i], Vec3(0, 0, -0.1))).norm(), 0, 1e-15);
  }
  ASSERT_EQ(bone->GetNumberOfPolys(), 12);
  vtkIdType count;
  const vtkIdType* corners;
  for (vtkIdType t = 0; t < 12; ++t) {
    bone->GetCellPoints(t, count, corners);
    ASSERT_EQ(count, 3);
    for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(corners[c], bodies[0].triangles[static_cast<std::size_t>(t)][c]);
  }
}

TEST(VtkSeriesWriter, WritesLinesAsPolylinesWithTheirValues) {
  const TemporaryFolder folder;
  VtkSeriesWriter writer(SampleObjects(), folder.path());
  for (const int index : {0, 1}) writer.Add(SampleObjectsFrame(index));
  const auto flexor = ReadPolyData(folder / "frames/line_flexor_000001.vtp");
  ASSERT_EQ(flexor->GetNumberOfPoints(), 4);
  ASSERT_EQ(flexor->GetNumberOfLines(), 1);
  EXPECT_EQ(Vec3(flexor->GetPoint(1)), Vec3(0, -0.1, 0));
  EXPECT_EQ(Vec3(flexor->GetPoint(3)), Vec3(0.1, 0.1, 0));
  vtkIdType count;
  const vtkIdType* points;
  flexor->GetCellPoints(0, count, points);
  ASSERT_EQ(count, 4);
  for (vtkIdType i = 0; i < 4; ++i) EXPECT_EQ(points[i], i);
  ASSERT_NE(flexor->GetCellData()->GetArray("activation"), nullptr);
  EXPECT_EQ(flexor->GetCellData()->GetArray("activation")->GetTuple1(0), 0.1);
  EXPECT_EQ(flexor->GetCellData()->GetArray("length")->GetTuple1(0), 0.4);
  EXPECT_EQ(ReadPolyData(folder / "frames/line_flexor_000000.vtp")->GetNumberOfPoints(), 3);
  // A line without points has an empty file, so that every frame has the same parts.
  const auto slack = ReadPolyData(folder / "frames/line_slack_000000.vtp");
  EXPECT_EQ(slack->GetNumberOfPoints(), 0);
  EXPECT_EQ(slack->GetNumberOfLines(), 0);
}

TEST(VtkSeriesWriter, RefusesFramesThatDoNotFit) {
  const TemporaryFolder folder;
  VtkSeriesWriter writer(SampleObjects(), folder.path());
  v1::Frame frame = SampleObjectsFrame(1);
  frame.mutable_lines(0)->add_values(1);
  EXPECT_THROW(writer.Add(frame), std::runtime_error);
  frame = SampleObjectsFrame(1);
  frame.clear_poses();
  EXPECT_THROW(writer.Add(frame), std::runtime_error);
}

TEST(VtkSeriesWriter, LeavesNoOtherFiles) {
  const SampleJob job;
  const TemporaryFolder folder;
  VtkSeriesWriter writer(job.geometry(), folder.path());
  writer.Add(job.frame(0));
  writer.Finish();
  std::vector<std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder.path())) files.push_back(entry.path().filename());
  EXPECT_THAT(files, ::testing::UnorderedElementsAre("frames", "frames.pvd", "belly_000000.vtu"));
}

TEST(VtkSeriesWriter, RefusesNamesThatLeadOutOfTheFolder) {
  v1::Geometry geometry = SampleJob().geometry();
  geometry.mutable_bodies(0)->set_name("../evil");
  EXPECT_THROW(VtkSeriesWriter(geometry, "somewhere"), std::runtime_error);
  geometry = SampleObjects();
  geometry.mutable_rigid_bodies(1)->set_name("a/b");
  EXPECT_THROW(VtkSeriesWriter(geometry, "somewhere"), std::runtime_error);
  geometry = SampleObjects();
  geometry.mutable_lines(1)->set_name("");
  EXPECT_THROW(VtkSeriesWriter(geometry, "somewhere"), std::runtime_error);
}

TEST(Decode, RefusesBytesThatDoNotFit) {
  const SampleJob job;
  v1::Geometry geometry = job.geometry();
  geometry.mutable_bodies(0)->mutable_positions()->pop_back();
  EXPECT_THROW(DecodeGeometry(geometry), std::runtime_error);
  geometry = job.geometry();
  geometry.mutable_bodies(0)->mutable_tetrahedra()->back() = '\x7f';  // a node far beyond the last
  EXPECT_THROW(DecodeGeometry(geometry), std::runtime_error);
  geometry = job.geometry();
  geometry.mutable_bodies(0)->mutable_fibres()->resize(24);
  EXPECT_THROW(DecodeGeometry(geometry), std::runtime_error);
  geometry = job.geometry();
  geometry.mutable_bodies(0)->set_triangles(Bytes(std::vector<std::uint32_t>{0, 1, 100000}));
  EXPECT_THROW(DecodeGeometry(geometry), std::runtime_error);
  const BodyShape shape = DecodeGeometry(job.geometry())[0];
  v1::Frame frame = job.frame(1);
  frame.mutable_bodies(0)->mutable_fields(1)->set_components(2);
  EXPECT_THROW(DecodeField(frame.bodies(0).fields(1), shape), std::runtime_error);
  frame.mutable_bodies(0)->mutable_positions()->resize(48);
  EXPECT_THROW(DecodePositions(frame.bodies(0), shape.positions.size()), std::runtime_error);
  frame.add_bodies();
  EXPECT_THROW(CheckFits(frame, job.geometry()), std::runtime_error);
}

TEST(Csv, WritesSeriesThatReadBackExactly) {
  const SampleJob job;
  SeriesTable table(job.geometry());
  for (int i = 0; i < 3; ++i) table.Add(job.frame(i));
  EXPECT_EQ(CsvOf(table),
            "frame,time [s],step,energy/elastic [J],belly/reaction/origin/z [N]\n"
            "0,0,0,0,-0\n1,0.05,10,0.001,-2.5\n2,0.1,20,0.004,-5\n");
}

TEST(Csv, QuotesHeadingsAndLeavesOutWhatIsNoNumber) {
  EXPECT_EQ(CsvOf({{"a, \"b\"", {1, std::numeric_limits<double>::quiet_NaN()}}, {"c", {0.1, 2}}}),
            "\"a, \"\"b\"\"\",c\n1,0.1\n,2\n");
}

TEST(SeriesTable, RefusesFramesWithOtherSeries) {
  SeriesTable table(SampleJob().geometry());
  v1::Frame frame = SampleJob().frame(0);
  frame.add_series(1);
  EXPECT_THROW(table.Add(frame), std::runtime_error);
}

TEST(MatchesGlob, StarsAndQuestionMarks) {
  EXPECT_TRUE(MatchesGlob("*", ""));
  EXPECT_TRUE(MatchesGlob("*/reaction/*", "muscle/reaction/origin/z"));
  EXPECT_TRUE(MatchesGlob("*volume_ratio", "muscle/volume_ratio"));
  EXPECT_TRUE(MatchesGlob("a*b*c", "aXbbYc"));
  EXPECT_TRUE(MatchesGlob("probe/?", "probe/x"));
  EXPECT_FALSE(MatchesGlob("probe/?", "probe/xy"));
  EXPECT_FALSE(MatchesGlob("energy", "energy/elastic"));
  EXPECT_FALSE(MatchesGlob("*z", "muscle/x"));
}

TEST(ReplaceFile, KeepsTheOldFileWhenWritingFails) {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "deep/er/file.txt";
  ReplaceFile(path, "old");
  EXPECT_EQ(ReadFile(path), "old");
  EXPECT_THROW(ReplaceFile(path,
                           [](const fs::path& beside) {
                             ::fascicle::testing::WriteFile(beside, "half");
                             throw std::runtime_error("disk full");
                           }),
               std::runtime_error);
  EXPECT_EQ(ReadFile(path), "old");
  EXPECT_EQ(std::distance(fs::directory_iterator(path.parent_path()), {}), 1);
  ReplaceFile(path, "new");
  EXPECT_EQ(ReadFile(path), "new");
  EXPECT_THROW(ReplaceFile(folder.path() / "deep", "x"), std::runtime_error);
  EXPECT_THROW(ReplaceFile("/proc/none/file", "x"), std::runtime_error);
}

}  // namespace
}  // namespace fascicle::client
