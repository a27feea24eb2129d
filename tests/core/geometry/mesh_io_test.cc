#include "core/geometry/mesh_io.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/base/stop.h"
#include "core/geometry/mesh_checks.h"
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

// CheckMesh reports NaNs, together with everything else.
TEST(MeshIoTest, PassesOnNumbersThatAreNotFinite) {
  const auto mesh = Read("m.msh", Replaced(kGmsh2, "5 1 1 1\n$End", "5 nan -inf 1\n$End"));
  ASSERT_TRUE(mesh);
  EXPECT_FALSE(mesh->nodes[4].allFinite());
}

}  // namespace
}  // namespace fascicle
