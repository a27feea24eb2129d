#include "core/geometry/shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

#include "core/geometry/mesh_checks.h"

namespace fascicle {
namespace {

constexpr double kDegreeOfShapes = std::numbers::pi / 180;

MeshReport ExpectGood(const TetMesh& mesh) {
  Problems problems;
  const MeshReport report = CheckMesh(mesh, problems);
  EXPECT_TRUE(problems.empty()) << problems.ToString();
  EXPECT_EQ(report.components, 1);
  return report;
}

// Every edge of a closed surface without self-intersections is shared by two triangles, in opposite directions. V - E +
// F is its Euler characteristic: 2 for a sphere, 0 for a torus.
int EulerCharacteristic(const TetMesh& mesh) {
  std::map<std::pair<int, int>, int> edges;
  std::map<int, int> nodes;
  const std::vector<Triangle> boundary = BoundaryTriangles(mesh);
  for (const Triangle& triangle : boundary) {
    for (int i = 0; i < 3; ++i) {
      ++edges[{triangle[i], triangle[(i + 1) % 3]}];
      ++nodes[triangle[i]];
    }
  }
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1);
    EXPECT_TRUE(edges.contains({edge.second, edge.first}));
  }
  return int(nodes.size()) - int(edges.size() / 2) + int(boundary.size());
}

// Nodes and tetrahedra of the rule of the reference meshes: 20 x 2 x 2 hexahedra, the first and the second of them.
TEST(BoxTest, NumbersNodesAndTetrahedraByRule) {
  const TetMesh mesh = MakeBox({0, 0, 0}, {10, 1, 1}, {20, 2, 2});
  ASSERT_EQ(mesh.nodes.size(), 189u);
  ASSERT_EQ(mesh.tetrahedra.size(), 480u);
  for (int k = 0; k <= 2; ++k) {
    for (int j = 0; j <= 2; ++j) {
      for (int i = 0; i <= 20; ++i) EXPECT_EQ(mesh.nodes[i + 21 * (j + 3 * k)], Vec3(0.5 * i, 0.5 * j, 0.5 * k));
    }
  }
  const std::vector<Tetrahedron> first(mesh.tetrahedra.begin(), mesh.tetrahedra.begin() + 7);
  EXPECT_EQ(first, (std::vector<Tetrahedron>{{0, 1, 22, 85},
                                             {0, 22, 21, 85},
                                             {0, 21, 84, 85},
                                             {0, 84, 63, 85},
                                             {0, 63, 64, 85},
                                             {0, 64, 1, 85},
                                             {1, 2, 23, 86}}));
}

TEST(BoxTest, FillsItsBounds) {
  const TetMesh mesh = MakeBox({-1, 2, 0.1}, {0.3, 0.7, 1.1}, {3, 4, 5});
  const MeshReport report = ExpectGood(mesh);
  EXPECT_NEAR(report.volume, 0.3 * 0.7 * 1.1, 1e-14);
  EXPECT_EQ(report.lowest, Vec3(-1, 2, 0.1));
  EXPECT_EQ(report.highest, Vec3(-1 + 0.3, 2 + 0.7, 0.1 + 1.1));
  EXPECT_EQ(EulerCharacteristic(mesh), 2);
}

// The angles of round shapes do not get worse with refinement.
constexpr double kSmallestAngle = 16 * kDegreeOfShapes;

class RoundShapes : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Divisions, RoundShapes, ::testing::Values(2, 4, 6, 12));

// Nodes lie on the surface and chords inside of it: a polygon of 4n corners in a unit circle has the area 2 n sin(pi /
// (2n)), and the volume follows exactly where the radius is constant.
TEST_P(RoundShapes, Cylinder) {
  const int n = GetParam();
  const TetMesh mesh = MakeFusiform({0.2, 0.01, 0.01, n, 10});
  const MeshReport report = ExpectGood(mesh);
  EXPECT_NEAR(report.volume, 2 * n * std::sin(std::numbers::pi / (2 * n)) * 1e-4 * 0.2, 1e-18);
  EXPECT_EQ(EulerCharacteristic(mesh), 2);
}

// Closed form: pi L (re^2 + re (rb - re) + 3/8 (rb - re)^2), because the mean of sin^2 is 1/2 and of sin^4 3/8. The
// error is of second order in the mesh width.
TEST_P(RoundShapes, Fusiform) {
  const int n = GetParam();
  const TetMesh mesh = MakeFusiform({0.1, 0.014, 0.006, n, 4 * n});
  const MeshReport report = ExpectGood(mesh);
  const double end = 0.006, more = 0.008;
  const double volume = std::numbers::pi * 0.1 * (end * end + end * more + 0.375 * more * more);
  EXPECT_LT(report.volume, volume);
  EXPECT_NEAR(report.volume / volume, 1, 0.45 / (n * n));
  EXPECT_GT(report.smallest_dihedral_angle, kSmallestAngle);
  EXPECT_EQ(report.lowest.z(), 0);
  EXPECT_EQ(report.highest.z(), 0.1);
  EXPECT_NEAR(report.highest.x(), 0.014, 1e-16);
  EXPECT_EQ(EulerCharacteristic(mesh), 2);
}

// 2 pi^2 R r^2 [Pappus].
TEST_P(RoundShapes, Torus) {
  const int n = GetParam();
  const TetMesh mesh = MakeTorus({1, 0.3, 6 * n, n});
  const MeshReport report = ExpectGood(mesh);
  EXPECT_NEAR(report.volume / (2 * std::numbers::pi * std::numbers::pi * 0.09), 1, 0.6 / (n * n));
  EXPECT_GT(report.smallest_dihedral_angle, kSmallestAngle);
  EXPECT_NEAR(report.highest.z(), 0.3, 1e-15);
  EXPECT_NEAR(report.highest.x(), 1.3, 1e-15);
  EXPECT_EQ(EulerCharacteristic(mesh), 0);
}

TEST_P(RoundShapes, Sphere) {
  const int n = GetParam();
  const TetMesh mesh = MakeSphere(2, n);
  const MeshReport report = ExpectGood(mesh);
  EXPECT_NEAR(report.volume / (4 * std::numbers::pi / 3 * 8), 1, 1.1 / (n * n));
  EXPECT_GT(report.smallest_dihedral_angle, 29 * kDegreeOfShapes);
  for (const Triangle& triangle : BoundaryTriangles(mesh)) {
    for (const std::int32_t node : triangle) EXPECT_NEAR(mesh.nodes[node].norm(), 2, 1e-15);
  }
  EXPECT_EQ(EulerCharacteristic(mesh), 2);
}

// All tetrahedra of a slab of a disc have about the same volume, because the map of the square preserves ratios of
// area.
TEST(FusiformTest, TetrahedraAreEven) {
  const TetMesh mesh = MakeFusiform({1, 1, 1, 12, 6});
  double smallest = 1, largest = 0;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
    smallest = std::min(smallest, SignedVolume(mesh, t));
    largest = std::max(largest, SignedVolume(mesh, t));
  }
  EXPECT_LT(largest / smallest, 1.6);
}

}  // namespace
}  // namespace fascicle
