#include "core/geometry/mesh_checks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <limits>
#include <numbers>

#include "core/base/stop.h"
#include "core/geometry/shapes.h"

namespace fascicle {
namespace {

using ::testing::HasSubstr;

TetMesh GoodMesh() { return MakeBox({0, 0, 0}, {0.2, 0.1, 0.1}, {4, 2, 2}); }

std::string Problems1(const TetMesh& mesh) {
  Problems problems;
  CheckMesh(mesh, problems);
  EXPECT_EQ(problems.count(), 1u) << problems.ToString();
  return problems.ToString();
}

TEST(CheckMeshTest, ReportsAGoodMesh) {
  Problems problems;
  const MeshReport report = CheckMesh(GoodMesh(), problems);
  EXPECT_TRUE(problems.empty()) << problems.ToString();
  EXPECT_NEAR(report.volume, 2e-3, 1e-17);
  EXPECT_EQ(report.highest, Vec3(0.2, 0.1, 0.1));
  EXPECT_EQ(report.components, 1);
  // The Kuhn split of a cube has 45, 60 and 90 degrees.
  EXPECT_NEAR(report.smallest_dihedral_angle, std::numbers::pi / 4, 1e-12);
}

TEST(CheckMeshTest, HeedsStopRequests) {
  std::stop_source source;
  source.request_stop();
  Problems problems;
  EXPECT_THROW(CheckMesh(GoodMesh(), problems, source.get_token()), Stopped);
  EXPECT_THROW(BoundaryTriangles(GoodMesh(), source.get_token()), Stopped);
}

TEST(CheckMeshTest, DihedralAngleOfTheRegularTetrahedron) {
  TetMesh mesh;
  mesh.nodes = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  mesh.tetrahedra = {{0, 1, 2, 3}};
  OrientConsistently(mesh);
  Problems problems;
  EXPECT_NEAR(CheckMesh(mesh, problems).smallest_dihedral_angle, std::acos(1.0 / 3), 1e-15);
}

TEST(CheckMeshTest, Empty) { EXPECT_THAT(Problems1({}), HasSubstr("the mesh has no tetrahedra")); }

TEST(CheckMeshTest, IndicesOutOfRange) {
  TetMesh mesh = GoodMesh();
  mesh.tetrahedra[3][2] = 45;
  mesh.tetrahedra[9][0] = -1;
  EXPECT_THAT(
      Problems1(mesh),
      HasSubstr("2 tetrahedra refer to nodes that do not exist: 3, 9 (counted from 0) (the mesh has 45 nodes)"));
}

TEST(CheckMeshTest, TriangleIndicesOutOfRange) {
  TetMesh mesh = GoodMesh();
  mesh.tagged_triangles = {{0, 1, 45}};
  mesh.triangle_tags = {1};
  EXPECT_THAT(Problems1(mesh), HasSubstr("1 triangle refers to a node that does not exist: 0"));
}

TEST(CheckMeshTest, NotFinite) {
  TetMesh mesh = GoodMesh();
  mesh.nodes[7].y() = std::numeric_limits<double>::quiet_NaN();
  mesh.nodes[8].x() = -std::numeric_limits<double>::infinity();
  EXPECT_THAT(Problems1(mesh), HasSubstr("2 nodes have coordinates that are not finite numbers: 7, 8"));
}

TEST(CheckMeshTest, InvertedGiveCountAndFirstExamples) {
  TetMesh mesh = GoodMesh();
  for (int t = 10; t < 17; ++t) std::swap(mesh.tetrahedra[t][0], mesh.tetrahedra[t][1]);
  EXPECT_THAT(Problems1(mesh),
              HasSubstr("7 tetrahedra are inverted (negative volume): 10, 11, 12, 13, 14, ... (counted from 0)"));
}

TEST(CheckMeshTest, Degenerate) {
  TetMesh mesh;
  mesh.nodes = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 1e-7}, {0, 0, 1}};
  mesh.tetrahedra = {{0, 1, 2, 3}, {0, 1, 2, 4}};
  EXPECT_THAT(Problems1(mesh), HasSubstr("1 tetrahedron is degenerate (flat): 0"));
  mesh.nodes[3].z() = -1e-3;  // thin, but not flat
  Problems problems;
  CheckMesh(mesh, problems);
  EXPECT_THAT(problems.ToString(), ::testing::Not(HasSubstr("degenerate")));
}

// A long needle is not a sliver: its smallest height is in proportion to its thickness.
TEST(CheckMeshTest, NeedlesAreNotDegenerate) {
  TetMesh mesh;
  mesh.nodes = {{0, 0, 0}, {1e-4, 0, 0}, {0, 1e-4, 0}, {0, 0, 1}};
  mesh.tetrahedra = {{0, 1, 2, 3}};
  Problems problems;
  CheckMesh(mesh, problems);
  EXPECT_TRUE(problems.empty()) << problems.ToString();
}

TEST(CheckMeshTest, Duplicates) {
  TetMesh mesh = GoodMesh();
  const auto [a, b, c, d] = mesh.tetrahedra[5];
  mesh.tetrahedra.push_back({b, c, a, d});  // the same nodes in another order
  Problems problems;
  CheckMesh(mesh, problems);
  EXPECT_THAT(problems.ToString(), HasSubstr("1 tetrahedron has the same nodes as another: 96"));
}

TEST(CheckMeshTest, OverlappingTetrahedra) {
  TetMesh mesh;
  mesh.nodes = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 2}, {0, 0, -1}};
  mesh.tetrahedra = {{0, 1, 2, 3}, {0, 1, 2, 4}, {0, 2, 1, 5}};
  EXPECT_THAT(Problems1(mesh), HasSubstr("1 tetrahedron has a face that two others already share"));
}

TEST(CheckMeshTest, UnusedNodes) {
  TetMesh mesh = GoodMesh();
  mesh.nodes.push_back({0.05, 0.03, 0.02});
  EXPECT_THAT(Problems1(mesh), HasSubstr("1 node belongs to no tetrahedron: 45"));
}

TEST(CheckMeshTest, CoincidentNodesAndComponents) {
  TetMesh mesh = GoodMesh();
  TetMesh second = MakeBox({0.2, 0, 0}, {0.2, 0.1, 0.1}, {4, 2, 2});
  for (Vec3& node : second.nodes) node.x() += 1e-12;  // smaller than any intended size
  for (Tetrahedron tetrahedron : second.tetrahedra) {
    for (std::int32_t& node : tetrahedron) node += 45;
    mesh.tetrahedra.push_back(tetrahedron);
  }
  mesh.nodes.insert(mesh.nodes.end(), second.nodes.begin(), second.nodes.end());
  Problems problems;
  EXPECT_EQ(CheckMesh(mesh, problems).components, 2);
  EXPECT_THAT(problems.ToString(), HasSubstr("9 nodes coincide with others: 4 and 45, 9 and 50"));
  EXPECT_THAT(problems.ToString(),
              HasSubstr("2 separate parts without a common face, beginning at: tetrahedron 0, tetrahedron 96"));
}

// Pairs across the boundary of two cells of the search grid are found: pairs all over a body of odd size.
TEST(CheckMeshTest, CoincidentNodesAreFoundAnywhere) {
  TetMesh mesh = MakeBox({0.1234567, 0.7, -0.3}, {0.777, 0.333, 0.111}, {6, 6, 6});
  const std::size_t count = mesh.nodes.size();
  for (std::size_t n = 0; n < count; ++n) mesh.nodes.push_back(mesh.nodes[n] + Vec3(3e-11, -3e-11, 3e-11));
  Problems problems;
  CheckMesh(mesh, problems);
  EXPECT_THAT(problems.ToString(), HasSubstr(std::to_string(count) + " nodes coincide with others: 0 and 343"));
}

TEST(CheckMeshTest, TouchingInAnEdgeIsNotConnected) {
  TetMesh mesh;
  mesh.nodes = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};
  mesh.tetrahedra = {{0, 2, 3, 1}, {0, 4, 5, 1}};
  EXPECT_THAT(Problems1(mesh), HasSubstr("2 separate parts without a common face"));
}

TEST(CheckMeshTest, SizesThatNoMuscleHasNameTheUnit) {
  TetMesh mesh = MakeBox({0, 0, 0}, {300, 50, 50}, {2, 2, 2});
  EXPECT_THAT(Problems1(mesh), HasSubstr("the body is 300 m long; no muscle is longer than 10 m (it is in millimetres: "
                                         "set \"unit\": \"mm\")"));
  mesh = MakeBox({0, 0, 0}, {30, 5, 5}, {2, 2, 2});
  EXPECT_THAT(Problems1(mesh), HasSubstr("set \"unit\": \"cm\" or \"mm\""));
  mesh = MakeBox({0, 0, 0}, {3e-7, 5e-8, 5e-8}, {2, 2, 2});
  EXPECT_THAT(Problems1(mesh), HasSubstr("set \"unit\": \"m\""));
  mesh = MakeBox({1000, 0, 0}, {9.9, 5, 5}, {2, 2, 2});
  Problems problems;
  CheckMesh(mesh, problems);
  EXPECT_TRUE(problems.empty()) << problems.ToString();
}

TEST(CheckMeshTest, EveryKindAtOnce) {
  TetMesh mesh = MakeBox({0, 0, 0}, {300, 100, 100}, {4, 2, 2});
  std::swap(mesh.tetrahedra[0][0], mesh.tetrahedra[0][1]);
  mesh.tetrahedra.push_back(mesh.tetrahedra[7]);
  mesh.nodes.push_back({1, 2, std::nan("")});
  mesh.nodes.push_back(mesh.nodes[3]);
  mesh.tetrahedra.push_back({1, 1, 2, 3});
  Problems problems;
  CheckMesh(mesh, problems);
  for (const char* kind :
       {"not a finite number", "300 m long", "coincides", "inverted", "degenerate", "same nodes as another",
        "belong to no tetrahedron", "separate parts without a common face"}) {
    EXPECT_THAT(problems.ToString(), HasSubstr(kind));
  }
}

// Many nodes at one point; a pairwise comparison would take quadratic time.
TEST(CheckMeshTest, StaysFastOnBadMeshes) {
  TetMesh mesh = MakeBox({0, 0, 0}, {1, 1, 1}, {1, 1, 1});
  mesh.nodes.resize(200000, Vec3(0.5, 0.5, 0.5));
  const auto start = std::chrono::steady_clock::now();
  Problems problems;
  CheckMesh(mesh, problems);
  EXPECT_THAT(problems.ToString(), HasSubstr("199991 nodes coincide with others"));
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(10));
}

TEST(OrientConsistentlyTest, TurnsAllOrNone) {
  TetMesh mesh = GoodMesh();
  EXPECT_FALSE(OrientConsistently(mesh));
  for (Tetrahedron& tetrahedron : mesh.tetrahedra) std::swap(tetrahedron[0], tetrahedron[1]);
  EXPECT_TRUE(OrientConsistently(mesh));
  Problems problems;
  EXPECT_GT(CheckMesh(mesh, problems).volume, 0);
  EXPECT_TRUE(problems.empty()) << problems.ToString();
  std::swap(mesh.tetrahedra[0][0], mesh.tetrahedra[0][1]);
  EXPECT_FALSE(OrientConsistently(mesh));
  EXPECT_THAT(Problems1(mesh), HasSubstr("1 tetrahedron is inverted"));
  TetMesh empty;
  EXPECT_FALSE(OrientConsistently(empty));
}

TEST(CheckMeshTest, CurvedEdges) {
  TetMesh mesh = MakeBox({0, 0, 0}, {1, 1, 1}, {1, 1, 1});
  const Tetrahedron& tet = mesh.tetrahedra[0];
  const Vec3 middle = 0.5 * (mesh.nodes[tet[0]] + mesh.nodes[tet[1]]);
  const auto check = [&](const std::vector<CurvedEdge>& edges) {
    mesh.curved_edges = edges;
    Problems problems;
    CheckMesh(mesh, problems);
    return problems.ToString();
  };
  EXPECT_EQ(check({{{tet[0], tet[1]}, middle + Vec3(0.02, 0.03, 0.05)}}), "");
  EXPECT_THAT(check({{{tet[0], tet[1]}, middle + Vec3(0.5, 0.6, 0.7)}}), ::testing::HasSubstr("folded"));
  EXPECT_THAT(check({{{tet[0], tet[0]}, middle}}), ::testing::HasSubstr("not an edge of the mesh"));
  EXPECT_THAT(check({{{tet[0], tet[1]}, middle}, {{tet[1], tet[0]}, middle}}), ::testing::HasSubstr("twice"));
  EXPECT_THAT(check({{{tet[0], tet[1]}, Vec3(NAN, 0, 0)}}), ::testing::HasSubstr("no finite midpoint"));
}

}  // namespace
}  // namespace fascicle
