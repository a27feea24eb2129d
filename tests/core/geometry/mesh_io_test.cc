#include "core/geometry/mesh_io.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <iomanip>
#include <map>
#include <sstream>

#include "core/base/stop.h"
#include "core/geometry/mesh_checks.h"
#include "core/geometry/mesh_writer.h"
#include "core/geometry/quadratic_hexahedron.h"
#include "core/geometry/shapes.h"
#include "core/geometry/triangle_mesh.h"
#include "tests/support/mesh_samples.h"

namespace fascicle {
namespace {

std::optional<TetMesh> Read(const std::string& name, const std::string& bytes, const std::string& elements = "") {
  Problems problems;
  std::optional<TetMesh> mesh = ReadMesh({name, bytes, elements}, problems);
  EXPECT_TRUE(problems.empty()) << name << ": " << problems.ToString();
  return mesh;
}

void ExpectSampleMesh(const TetMesh& mesh, bool with_triangles) {
  EXPECT_EQ(mesh.nodes, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}}));
  EXPECT_EQ(mesh.tetrahedra, (std::vector<Tetrahedron>{{0, 1, 2, 3}, {1, 2, 3, 4}}));
  EXPECT_EQ(mesh.tetrahedron_tags, (std::vector<std::int32_t>{10, 20}));
  if (!with_triangles) return;
  EXPECT_EQ(mesh.tagged_triangles, (std::vector<Triangle>{{0, 2, 3}}));
  EXPECT_EQ(mesh.triangle_tags, (std::vector<std::int32_t>{7}));
}

class EverySample : public ::testing::TestWithParam<MeshSample> {};

TEST_P(EverySample, IsRead) {
  const MeshSample& sample = GetParam();
  const std::optional<TetMesh> mesh = Read(sample.name, sample.bytes, sample.element_bytes);
  ASSERT_TRUE(mesh);
  ExpectSampleMesh(*mesh, !sample.name.ends_with(".node"));
  Problems problems;
  EXPECT_EQ(CheckMesh(*mesh, problems).components, 1);
  EXPECT_TRUE(problems.empty()) << problems.ToString();
}

TEST_P(EverySample, HeedsStopRequests) {
  const MeshSample& sample = GetParam();
  std::stop_source source;
  source.request_stop();
  Problems problems;
  EXPECT_THROW(ReadMesh({sample.name, sample.bytes, sample.element_bytes}, problems, source.get_token()), Stopped);
  EXPECT_TRUE(problems.empty()) << problems.ToString();
}

// A truncated file gives either a mesh or a problem, and never a mesh if data is missing.
TEST_P(EverySample, CutAnywhere) {
  const MeshSample& sample = GetParam();
  const bool cut_elements = !sample.element_bytes.empty();
  const std::string& whole = cut_elements ? sample.element_bytes : sample.bytes;
  for (std::size_t size = 0; size < whole.size(); ++size) {
    // A separate allocation for each, so that the address sanitizer detects reads beyond the end.
    std::vector<char> cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
    cut.shrink_to_fit();
    const std::string_view bytes(cut.data(), cut.size());
    Problems problems;
    const auto mesh = ReadMesh(
        {sample.name, cut_elements ? std::string_view(sample.bytes) : bytes, cut_elements ? bytes : std::string_view()},
        problems);
    EXPECT_EQ(mesh.has_value(), problems.empty()) << size;
    if (size < sample.incomplete_below) {
      EXPECT_FALSE(problems.empty()) << "cut at " << size << " of " << whole.size();
    }
    for (const Problem& problem : problems.kept()) EXPECT_TRUE(problem.path.empty());
  }
}

// Every byte replaced by some others: the indices of any resulting mesh are in range.
TEST_P(EverySample, DamagedAnywhere) {
  const MeshSample& sample = GetParam();
  for (std::size_t at = 0; at < sample.bytes.size(); ++at) {
    for (const char byte : {'9', '-', ' ', '\n', '\0', '\xff'}) {
      std::string damaged = sample.bytes;
      damaged[at] = byte;
      Problems problems;
      const auto mesh = ReadMesh({sample.name, damaged, sample.element_bytes}, problems);
      ASSERT_EQ(mesh.has_value(), problems.empty()) << at;
      if (!mesh) continue;
      const auto in_range = [&](std::int32_t n) { return n >= 0 && std::size_t(n) < mesh->nodes.size(); };
      for (const Tetrahedron& t : mesh->tetrahedra) ASSERT_TRUE(std::all_of(t.begin(), t.end(), in_range));
      for (const Triangle& t : mesh->tagged_triangles) ASSERT_TRUE(std::all_of(t.begin(), t.end(), in_range));
      ASSERT_TRUE(mesh->tetrahedron_tags.empty() || mesh->tetrahedron_tags.size() == mesh->tetrahedra.size());
      ASSERT_EQ(mesh->triangle_tags.size(), mesh->tagged_triangles.size());
    }
  }
}

TEST_P(EverySample, WindowsLineEnds) {
  const MeshSample& sample = GetParam();
  if (sample.name == "binary.vtk" || sample.name == "appended.vtu") return;  // not text
  const auto windows = [](const std::string& text) {
    std::string result;
    for (const char c : text) result += c == '\n' ? std::string("\r\n") : std::string(1, c);
    return result;
  };
  const auto mesh = Read(sample.name, windows(sample.bytes), windows(sample.element_bytes));
  ASSERT_TRUE(mesh);
  ExpectSampleMesh(*mesh, !sample.name.ends_with(".node"));
}

INSTANTIATE_TEST_SUITE_P(Formats, EverySample, ::testing::ValuesIn(MeshSamples()), [](const auto& test) {
  std::string name = test.param.name;
  std::replace(name.begin(), name.end(), '.', '_');
  return name;
});

TEST(MeshIoTest, ExtensionIsTakenInAnyCase) { EXPECT_TRUE(Read("a/b.c/MUSCLE.MSH", kGmsh2)); }

TEST(MeshIoTest, GapsInNumberingAreClosed) {
  std::string text = kGmsh2;
  text = Replaced(text, "\n5 1 1 1\n", "\n4000000000 1 1 1\n");
  text = Replaced(text, "2 3 4 5\n", "2 3 4 4000000000\n");
  const auto mesh = Read("m.msh", text);
  ASSERT_TRUE(mesh);
  ExpectSampleMesh(*mesh, true);
}

TEST(MeshIoTest, FilesWithoutTagsHaveNone) {
  const std::string text =
      Replaced(Replaced(Replaced(kGmsh2, "2 7 1 1 3 4", "0 1 3 4"), "2 10 1 1", "0 1"), "2 20 1 2", "0 2");
  const auto mesh = Read("m.msh", text);
  ASSERT_TRUE(mesh);
  EXPECT_TRUE(mesh->tetrahedron_tags.empty());
  EXPECT_TRUE(mesh->tagged_triangles.empty());
}

TEST(MeshIoTest, TetgenCountsFromZeroToo) {
  const auto mesh = Read("m.node", "4 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n", "1 4 0\n0 0 1 2 3\n");
  ASSERT_TRUE(mesh);
  EXPECT_EQ(mesh->tetrahedra, (std::vector<Tetrahedron>{{0, 1, 2, 3}}));
  EXPECT_TRUE(mesh->tetrahedron_tags.empty());
}

TEST(MeshIoTest, VtuPiecesFollowEachOther) {
  const std::string text = kVtu;
  const std::size_t begin = text.find("<Piece"), end = text.find("</Piece>") + 8;
  const std::string piece = text.substr(begin, end - begin);
  const auto mesh = Read("m.vtu", text.substr(0, begin) + piece + piece + text.substr(end));
  ASSERT_TRUE(mesh);
  EXPECT_EQ(mesh->nodes.size(), 10u);
  EXPECT_EQ(mesh->tetrahedra[2], (Tetrahedron{5, 6, 7, 8}));
  EXPECT_EQ(mesh->tagged_triangles[1], (Triangle{5, 7, 8}));
}

// Two tetrahedra of ten nodes; one common edge and one outer edge are curved. Gmsh orders the last two mid-edge nodes
// differently from VTK.
TEST(MeshIoTest, TenNodesBecomeCurvedEdges) {
  const char* const nodes =
      "1 0 0 0\n2 2 0 0\n3 0 2 0\n4 0 0 2\n5 2 2 2\n"
      // mid-edge nodes of 12, 23, 13, 14, 24, 34, and of 25, 35, 45
      "6 1 0 0\n7 1 1 0.25\n8 0 1 0\n9 0 0 1\n10 1 0 1\n11 0 1 1\n12 2 1 1\n13 1 2 1\n14 1 1 2.5\n";
  const std::string gmsh = std::string("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n14\n") + nodes +
                           "$EndNodes\n$Elements\n3\n1 9 2 7 1 1 3 4 8 11 9\n"
                           "2 11 2 10 1 1 2 3 4 6 7 8 9 11 10\n3 11 2 20 1 2 3 4 5 7 11 10 12 14 13\n$EndElements\n";
  std::string points;
  for (std::istringstream in(nodes); in;) {
    std::string number, x, y, z;
    if (in >> number >> x >> y >> z) points += x + " " + y + " " + z + "\n";
  }
  const std::string vtk = "# vtk DataFile Version 3.0\nm\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 14 double\n" +
                          points +
                          "CELLS 3 29\n6 0 2 3 7 10 8\n10 0 1 2 3 5 6 7 8 9 10\n10 1 2 3 4 6 10 9 11 12 13\n"
                          "CELL_TYPES 3\n22\n24\n24\nCELL_DATA 3\nSCALARS tag int 1\nLOOKUP_TABLE default\n7\n10\n20\n";
  for (const auto& [name, text] : {std::pair<std::string, std::string>{"m.msh", gmsh}, {"m.vtk", vtk}}) {
    const auto mesh = Read(name, text);
    ASSERT_TRUE(mesh) << name;
    EXPECT_EQ(mesh->nodes.size(), 5u);
    EXPECT_EQ(mesh->tetrahedra, (std::vector<Tetrahedron>{{0, 1, 2, 3}, {1, 2, 3, 4}}));
    EXPECT_EQ(mesh->tetrahedron_tags, (std::vector<std::int32_t>{10, 20}));
    EXPECT_EQ(mesh->tagged_triangles, (std::vector<Triangle>{{0, 2, 3}}));
    ASSERT_EQ(mesh->curved_edges.size(), 2u) << name;
    EXPECT_EQ(mesh->curved_edges[0].ends, (std::array<std::int32_t, 2>{1, 2}));
    EXPECT_EQ(mesh->curved_edges[0].middle, Vec3(1, 1, 0.25));
    EXPECT_EQ(mesh->curved_edges[1].ends, (std::array<std::int32_t, 2>{3, 4}));
    EXPECT_EQ(mesh->curved_edges[1].middle, Vec3(1, 1, 2.5));
    Problems problems;
    CheckMesh(*mesh, problems);
    EXPECT_TRUE(problems.empty()) << problems.ToString();
  }
}

// A cube whose edges are all curved, each by another amount; formats have different orders of edges.
TEST(MeshIoTest, HexahedraOfTwentyNodesHaveCurvedEdges) {
  constexpr int kCorners[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                  {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  // The ends of the edges in the order of Gmsh; the others have that of kHexEdges.
  constexpr int kGmshEdges[12][2] = {{0, 1}, {0, 3}, {0, 4}, {1, 2}, {1, 5}, {2, 3},
                                     {2, 6}, {3, 7}, {4, 5}, {4, 7}, {5, 6}, {6, 7}};
  const auto middle_of = [&](int a, int b) {
    Vec3 middle;
    for (int d = 0; d < 3; ++d) middle[d] = 0.5 * (kCorners[a][d] + kCorners[b][d]);
    return Vec3(middle + (0.01 * a + 0.001 * b) * (middle - Vec3::Constant(0.5)));
  };
  const auto text_of = [](const Vec3& x) {
    std::ostringstream out;
    out << std::setprecision(17) << x[0] << " " << x[1] << " " << x[2];
    return out.str();
  };
  const auto points_of = [&](const int(&edges)[12][2], int count, const std::function<std::string(int)>& before) {
    std::string points;
    for (int n = 0; n < count; ++n) {
      const Vec3 x =
          n < 8    ? Vec3(kCorners[n][0], kCorners[n][1], kCorners[n][2])
          : n < 20 ? middle_of(std::min(edges[n - 8][0], edges[n - 8][1]), std::max(edges[n - 8][0], edges[n - 8][1]))
                   : Vec3(Vec3::Constant(0.01 * n));
      points += before(n) + text_of(x) + "\n";
    }
    return points;
  };
  for (const int count : {20, 27}) {
    std::string from_0, from_1;
    for (int n = 0; n < count; ++n) {
      from_0 += " " + std::to_string(n);
      from_1 += (n == 0 ? "" : ", ") + std::to_string(n + 1);
    }
    std::string gmsh_nodes = from_1;
    std::erase(gmsh_nodes, ',');
    const std::string size = std::to_string(count);
    const std::string gmsh = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n" + size + "\n" +
                             points_of(kGmshEdges, count, [](int n) { return std::to_string(n + 1) + " "; }) +
                             "$EndNodes\n$Elements\n1\n1 " + (count == 20 ? "17" : "12") + " 2 3 1 " + gmsh_nodes +
                             "\n$EndElements\n";
    const std::string vtk = "# vtk DataFile Version 3.0\nm\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS " + size +
                            " double\n" + points_of(kHexEdges, count, [](int) { return ""; }) + "CELLS 1 " +
                            std::to_string(count + 1) + "\n" + size + from_0 + "\nCELL_TYPES 1\n" +
                            (count == 20 ? "25" : "29") + "\n";
    std::string abaqus_points = points_of(kHexEdges, count, [](int n) { return std::to_string(n + 1) + " "; });
    std::replace(abaqus_points.begin(), abaqus_points.end(), ' ', ',');
    const std::string abaqus = "*NODE\n" + abaqus_points + "*ELEMENT, TYPE=C3D" + size + "\n1, " + from_1 + "\n";
    for (const auto& [name, text] :
         {std::pair<std::string, std::string>{"m.msh", gmsh}, {"m.vtk", vtk}, {"m.inp", abaqus}}) {
      Problems problems;
      MeshRemarks remarks;
      const auto mesh = ReadMesh({.name = name, .bytes = text, .solids = Solids::kKeep}, problems, {}, &remarks);
      ASSERT_TRUE(mesh) << name << problems.ToString();
      EXPECT_EQ(mesh->nodes.size(), 8u);
      ASSERT_EQ(mesh->hexahedra.size(), 1u);
      ASSERT_EQ(mesh->curved_edges.size(), 12u) << name;
      for (const CurvedEdge& edge : mesh->curved_edges) {
        EXPECT_LT((edge.middle - middle_of(edge.ends[0], edge.ends[1])).norm(), 1e-15) << name;
      }
      CheckMesh(*mesh, problems);
      EXPECT_TRUE(problems.empty()) << problems.ToString();
      EXPECT_EQ(remarks.notes.empty(), count == 20) << name;
    }
  }
}

TEST(MeshIoTest, ByteOrderMarks) {
  const auto mesh = Read("m.msh", std::string("\xEF\xBB\xBF") + kGmsh2);
  ASSERT_TRUE(mesh);
  ExpectSampleMesh(*mesh, true);
}

struct WithRemarks {
  std::optional<TetMesh> mesh;
  MeshRemarks remarks;
};

WithRemarks ReadAll(const std::string& name, const std::string& bytes, bool split = false) {
  WithRemarks result;
  Problems problems;
  result.mesh = ReadMesh({.name = name, .bytes = bytes, .solids = split ? Solids::kSplit : Solids::kKeep}, problems, {},
                         &result.remarks);
  EXPECT_TRUE(problems.empty()) << name << ": " << problems.ToString();
  return result;
}

using FurtherTags = std::vector<std::array<std::int32_t, 2>>;

TEST(MeshIoTest, SeveralGroupsOfOneEntity) {
  // The first volume has three groups, one twice; the surface has two.
  std::string text = Replaced(kGmsh4, "1 0 0 0 1 1 1 1 10 1 3", "1 0 0 0 1 1 1 4 10 -30 40 10 1 3");
  text = Replaced(text, "3 0 0 0 0 1 1 1 7 0", "3 0 0 0 0 1 1 2 7 8 0");
  const auto [mesh, remarks] = ReadAll("m.msh", text);
  ASSERT_TRUE(mesh);
  EXPECT_EQ(mesh->tetrahedron_tags, (std::vector<std::int32_t>{10, 20}));
  EXPECT_EQ(mesh->further_tags, (FurtherTags{{0, 30}, {0, 40}}));
  EXPECT_EQ(mesh->tagged_triangles, (std::vector<Triangle>{{0, 2, 3}, {0, 2, 3}}));
  EXPECT_EQ(mesh->triangle_tags, (std::vector<std::int32_t>{7, 8}));
  EXPECT_TRUE(remarks.notes.empty());
}

TEST(MeshIoTest, ElementsWrittenOnceForEachOfTheirGroups) {
  // The second tetrahedron again in another order of its nodes, in between, and in a third group.
  std::string text = Replaced(kGmsh2, "$Elements\n4", "$Elements\n6");
  text = Replaced(text, "3 4 2 10 1 1 2 3 4", "9 4 2 30 1 3 2 4 5\n3 4 2 10 1 1 2 3 4");
  text = Replaced(text, "$EndElements", "10 4 2 40 1 2 3 4 5\n$EndElements");
  const auto [mesh, remarks] = ReadAll("m.msh", text);
  ASSERT_TRUE(mesh);
  EXPECT_EQ(mesh->tetrahedra, (std::vector<Tetrahedron>{{2, 1, 3, 4}, {0, 1, 2, 3}}));
  EXPECT_EQ(mesh->tetrahedron_tags, (std::vector<std::int32_t>{30, 10}));
  EXPECT_EQ(mesh->further_tags, (FurtherTags{{0, 20}, {0, 40}}));
  ASSERT_EQ(remarks.notes.size(), 1u);
  ASSERT_EQ(remarks.names.size(), 2u);
  EXPECT_EQ(remarks.names[1].name, "muscle");
  // A repetition in the same group is a mistake of the mesh.
  const auto doubled = Read("m.msh", Replaced(text, "10 4 2 40", "10 4 2 20"));
  ASSERT_TRUE(doubled);
  EXPECT_EQ(doubled->tetrahedra.size(), 3u);
}

TEST(MeshIoTest, GroupsOfPartitionedMeshes) {
  // The volumes become 11 and 12: the first inherits the groups of its parent, the second has its own.
  std::string text = Replaced(kGmsh4, "$EndEntities\n",
                              "$EndEntities\n$PartitionedEntities\n2\n1\n9 1\n0 0 0 2\n"
                              "11 3 1 1 1 0 0 0 1 1 1 0 0\n12 3 2 2 1 2 0 0 0 1 1 1 1 50 1 3\n"
                              "$EndPartitionedEntities\n");
  text = Replaced(Replaced(text, "3 1 4 1\n3 1 2 3 4", "3 11 4 1\n3 1 2 3 4"), "3 2 4 1\n4 2", "3 12 4 1\n4 2");
  const auto [mesh, remarks] = ReadAll("m.msh", text);
  ASSERT_TRUE(mesh);
  EXPECT_EQ(mesh->tetrahedron_tags, (std::vector<std::int32_t>{10, 50}));
}

TEST(MeshIoTest, UnusedNodesAreLeftOut) {
  // Two nodes of nothing, a triangle and a point on them; in the middle of the numbering.
  std::string text = Replaced(kGmsh2, "$Nodes\n5\n1 0 0 0\n", "$Nodes\n7\n1 0 0 0\n8 7 7 7\n-3 9 9 9\n");
  text = Replaced(text, "$Elements\n4\n", "$Elements\n6\n5 2 2 7 1 1 8 4\n6 15 2 9 1 8\n");
  const auto [mesh, remarks] = ReadAll("m.msh", text);
  ASSERT_TRUE(mesh);
  ExpectSampleMesh(*mesh, true);
  EXPECT_TRUE(std::find(mesh->node_tags.begin(), mesh->node_tags.end(), 9) == mesh->node_tags.end());
  ASSERT_EQ(remarks.notes.size(), 1u);
  EXPECT_EQ(remarks.notes[0], "2 nodes belong to no tetrahedron and are left out: -3, 8; so are 1 triangles on them");
}

// Two cubes, a wedge on the side of the second and a pyramid on top of it.
std::string GmshSolids() {
  return "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n15\n"
         "1 0 0 0\n2 1 0 0\n3 2 0 0\n4 0 1 0\n5 1 1 0\n6 2 1 0\n7 0 0 1\n8 1 0 1\n9 2 0 1\n10 0 1 1\n11 1 1 1\n"
         "12 2 1 1\n13 3 0 0\n14 3 0 1\n15 1.5 0.5 2\n$EndNodes\n$Elements\n6\n"
         "1 3 2 5 1 1 7 10 4\n"
         "2 5 2 1 1 1 2 5 4 7 8 11 10\n3 5 2 2 1 2 3 6 5 8 9 12 11\n4 5 2 3 1 2 3 6 5 8 9 12 11\n"
         "5 6 2 2 1 3 13 6 9 14 12\n6 7 2 4 1 8 9 12 11 15\n$EndElements\n";
}

TEST(MeshIoTest, SolidsAreSplitSoThatNeighboursMatch) {
  const auto [mesh, remarks] = ReadAll("m.msh", GmshSolids(), true);
  ASSERT_TRUE(mesh);
  const double volume = 1 + 1 + 0.5 + 1.0 / 3;
  EXPECT_DOUBLE_EQ(TotalVolume(*mesh), volume);
  Problems problems;
  EXPECT_EQ(CheckMesh(*mesh, problems).components, 1);
  EXPECT_TRUE(problems.empty()) << problems.ToString();
  EXPECT_DOUBLE_EQ(EnclosedVolume({mesh->nodes, BoundaryTriangles(*mesh)}), volume);
  std::map<std::int32_t, double> of_tag;
  for (std::size_t t = 0; t < mesh->tetrahedra.size(); ++t) of_tag[mesh->tetrahedron_tags[t]] += SignedVolume(*mesh, t);
  for (const auto& [t, tag] : mesh->further_tags) of_tag[tag] += SignedVolume(*mesh, static_cast<std::size_t>(t));
  EXPECT_DOUBLE_EQ(of_tag[1], 1);
  EXPECT_DOUBLE_EQ(of_tag[2], 1.5);
  EXPECT_DOUBLE_EQ(of_tag[3], 1);
  EXPECT_DOUBLE_EQ(of_tag[4], 1.0 / 3);
  EXPECT_EQ(mesh->triangle_tags, (std::vector<std::int32_t>{5, 5}));
  EXPECT_EQ(remarks.notes.size(), 2u);
}

// The order of VTK's wedges is seen from the other side, and that of voxels goes along the axes.
TEST(MeshIoTest, SolidsOfVtk) {
  const std::string points = "0 0 0 1 0 0 0 1 0 1 1 0 0 0 1 1 0 1 0 1 1 1 1 1 0.5 0.5 2";
  const auto file = [&](const std::string& cell, int type) {
    const auto size = std::count(cell.begin(), cell.end(), ' ') + 1;
    return "# vtk DataFile Version 3.0\nm\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 9 double\n" + points +
           "\nCELLS 1 " + std::to_string(size + 1) + "\n" + std::to_string(size) + " " + cell + "\nCELL_TYPES 1\n" +
           std::to_string(type) + "\n";
  };
  for (const auto& [cell, type, volume] :
       {std::tuple("0 1 2 3 4 5 6 7", 11, 1.0), std::tuple("0 1 3 2 4 5 7 6", 12, 1.0),
        std::tuple("0 2 1 4 6 5", 13, 0.5), std::tuple("0 1 2 4 5 6", 13, 0.5), std::tuple("4 5 7 6 8", 14, 1.0 / 3)}) {
    const auto [mesh, remarks] = ReadAll("m.vtk", file(cell, type), true);
    ASSERT_TRUE(mesh) << cell;
    EXPECT_DOUBLE_EQ(TotalVolume(*mesh), volume) << cell;
    for (std::size_t t = 0; t < mesh->tetrahedra.size(); ++t) EXPECT_GT(SignedVolume(*mesh, t), 0) << cell;
  }
  Problems problems;
  EXPECT_FALSE(ReadMesh({.name = "m.vtk", .bytes = file("0 1 2 3 4 5 6 7", 42), .solids = Solids::kSplit}, problems));
}

TEST(MeshIoTest, SolidsOfMedit) {
  const std::string text =
      "MeshVersionFormatted 1\nDimension 3\nVertices 9\n0 0 0 0\n1 0 0 0\n1 1 0 0\n0 1 0 0\n0 0 1 0\n1 0 1 0\n"
      "1 1 1 0\n0 1 1 0\n0.5 0.5 2 0\nQuadrilaterals 1\n1 2 6 5 3\nHexahedra 1\n1 2 3 4 5 6 7 8 1\n"
      "Pyramids 1\n5 6 7 8 9 2\n";
  const auto [mesh, remarks] = ReadAll("m.mesh", text, true);
  ASSERT_TRUE(mesh);
  EXPECT_DOUBLE_EQ(TotalVolume(*mesh), 4.0 / 3);
  EXPECT_EQ(mesh->triangle_tags, (std::vector<std::int32_t>{3, 3}));
}

TEST(MeshIoTest, MeditWithoutItsLastKeyword) {
  const auto mesh = Read("m.mesh", Replaced(kMedit, "End\n", ""));
  ASSERT_TRUE(mesh);
  ExpectSampleMesh(*mesh, true);
}

// Everything that a mesh can hold comes back.
TEST(MeshIoTest, WhatIsWrittenIsReadBack) {
  TetMesh mesh = MakeSphere(1, 4);
  mesh.tetrahedron_tags.assign(mesh.tetrahedra.size(), 1);
  mesh.tetrahedron_tags[3] = 2;
  mesh.further_tags = {{2, 5}, {3, 5}, {3, 6}};
  mesh.tagged_triangles = {BoundaryTriangles(mesh)[1], BoundaryTriangles(mesh)[1], BoundaryTriangles(mesh)[4]};
  mesh.triangle_tags = {7, 8, 7};
  mesh.tagged_nodes = {4, 4, 2};
  mesh.node_tags = {9, 10, 9};
  for (const bool curved : {false, true}) {
    for (const auto& [i, j, k] : BoundaryTriangles(mesh)) {
      for (const auto& [a, b] : {std::pair(i, j), std::pair(j, k), std::pair(k, i)}) {
        if (curved && a < b) mesh.curved_edges.push_back({{a, b}, (mesh.nodes[a] + mesh.nodes[b]).normalized()});
      }
    }
    const std::vector<TagName> names = {{0, 9, "two nodes"}, {2, 7, "side"}, {3, 1, "all (\u00e4)"}};
    const auto [read, remarks] = ReadAll("m.msh", GmshText(mesh, names));
    ASSERT_TRUE(read);
    EXPECT_EQ(read->nodes, mesh.nodes);
    EXPECT_EQ(read->tetrahedra, mesh.tetrahedra);
    EXPECT_EQ(read->tetrahedron_tags, mesh.tetrahedron_tags);
    EXPECT_EQ(read->further_tags, mesh.further_tags);
    EXPECT_EQ(read->tagged_triangles, mesh.tagged_triangles);
    EXPECT_EQ(read->triangle_tags, mesh.triangle_tags);
    EXPECT_EQ(read->tagged_nodes, mesh.tagged_nodes);
    EXPECT_EQ(read->node_tags, mesh.node_tags);
    std::map<std::array<std::int32_t, 2>, Vec3> middles;
    for (const CurvedEdge& edge : read->curved_edges) middles[edge.ends] = edge.middle;
    EXPECT_EQ(middles.size(), mesh.curved_edges.size());
    for (const CurvedEdge& edge : mesh.curved_edges) EXPECT_EQ(middles[edge.ends], edge.middle);
    ASSERT_EQ(remarks.names.size(), 3u);
    for (std::size_t n = 0; n < 3; ++n) {
      EXPECT_EQ(remarks.names[n].name, names[n].name);
      EXPECT_EQ(remarks.names[n].dimension, names[n].dimension);
      EXPECT_EQ(remarks.names[n].tag, names[n].tag);
    }
  }
}

// CheckMesh reports NaNs, together with everything else.
TEST(MeshIoTest, PassesOnNumbersThatAreNotFinite) {
  const auto mesh = Read("m.msh", Replaced(kGmsh2, "5 1 1 1\n$End", "5 nan -inf 1\n$End"));
  ASSERT_TRUE(mesh);
  EXPECT_FALSE(mesh->nodes[4].allFinite());
}

}  // namespace
}  // namespace fascicle
