#include "core/geometry/refinement.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/geometry/mesh_checks.h"
#include "core/geometry/shapes.h"

namespace fascicle {
namespace {

double Surface(const TetMesh& mesh) {
  double area = 0;
  for (const Triangle& t : BoundaryTriangles(mesh)) {
    area += 0.5 * (mesh.nodes[t[1]] - mesh.nodes[t[0]]).cross(mesh.nodes[t[2]] - mesh.nodes[t[0]]).norm();
  }
  return area;
}

double SmallestVolume(const TetMesh& mesh) {
  double smallest = INFINITY;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) smallest = std::min(smallest, SignedVolume(mesh, t));
  return smallest;
}

TEST(RefinementTest, EightPartsFillEachTetrahedron) {
  const TetMesh coarse = MakeFusiform({0.1, 0.02, 0.008, 4, 10});
  const TetMesh fine = Refined(coarse).mesh;
  Problems problems;
  CheckMesh(fine, problems);
  EXPECT_TRUE(problems.empty()) << problems.ToString();
  ASSERT_EQ(fine.tetrahedra.size(), 8 * coarse.tetrahedra.size());
  EXPECT_NEAR(Surface(fine), Surface(coarse), 1e-12 * Surface(coarse));
  EXPECT_GT(SmallestVolume(fine), 0);
  for (std::size_t t = 0; t < coarse.tetrahedra.size(); ++t) {
    double sum = 0;
    for (std::size_t k = 0; k < 8; ++k) {
      EXPECT_NEAR(SignedVolume(fine, 8 * t + k), SignedVolume(coarse, t) / 8, 1e-12 * SignedVolume(coarse, t));
      sum += SignedVolume(fine, 8 * t + k);
    }
    EXPECT_NEAR(sum, SignedVolume(coarse, t), 1e-12 * SignedVolume(coarse, t));
  }
}

// Dividing octahedra along their longest diagonal would flatten tetrahedra without bound.
TEST(RefinementTest, ShapesDoNotDegenerate) {
  TetMesh mesh;
  mesh.nodes = {Vec3(0, 0, 0), Vec3(1, 0.1, 0), Vec3(0.2, 0.9, 0.1), Vec3(0.3, 0.2, 0.4)};
  mesh.tetrahedra = {{0, 1, 2, 3}};
  const auto worst = [](const TetMesh& m) {
    double least = INFINITY;
    for (std::size_t t = 0; t < m.tetrahedra.size(); ++t) {
      double longest = 0;
      for (const auto& [i, j] : kTetEdges) {
        longest = std::max(longest, (m.nodes[m.tetrahedra[t][i]] - m.nodes[m.tetrahedra[t][j]]).norm());
      }
      least = std::min(least, SignedVolume(m, t) / (longest * longest * longest));
    }
    return least;
  };
  const double once = worst(Refined(mesh).mesh);
  for (int k = 0; k < 4; ++k) mesh = Refined(mesh).mesh;
  EXPECT_GT(worst(mesh), 0.5 * once);
}

TEST(RefinementTest, TagsGoToTheParts) {
  TetMesh mesh = MakeBox(Vec3::Zero(), Vec3::Ones(), {1, 1, 1});
  mesh.tetrahedron_tags = {1, 2, 3, 4, 5, 6};
  mesh.further_tags = {{2, 9}};
  mesh.tagged_triangles = {BoundaryTriangles(mesh)[0]};
  mesh.triangle_tags = {7};
  const Triangle tagged = mesh.tagged_triangles[0];
  mesh.tagged_nodes = {tagged[0], tagged[1]};
  mesh.node_tags = {8, 8};
  const RefinedTetrahedra refined = Refined(mesh);
  const TetMesh& fine = refined.mesh;
  for (std::size_t t = 0; t < 48; ++t) EXPECT_EQ(fine.tetrahedron_tags[t], static_cast<int>(t / 8 + 1));
  ASSERT_EQ(fine.further_tags.size(), 8u);
  for (int k = 0; k < 8; ++k) EXPECT_EQ(fine.further_tags[k], (std::array<std::int32_t, 2>{16 + k, 9}));
  ASSERT_EQ(fine.tagged_triangles.size(), 4u);
  EXPECT_EQ(fine.triangle_tags, (std::vector<std::int32_t>{7, 7, 7, 7}));
  const std::vector<Triangle> surface = BoundaryTriangles(fine);
  for (Triangle triangle : fine.tagged_triangles) {
    int found = 0;
    for (int turn = 0; turn < 3; ++turn) {
      found += static_cast<int>(std::count(surface.begin(), surface.end(), triangle));
      std::rotate(triangle.begin(), triangle.begin() + 1, triangle.end());
    }
    EXPECT_EQ(found, 1) << "on the surface, with the same orientation";
  }
  ASSERT_EQ(fine.tagged_nodes.size(), 3u);
  const Vec3 middle = fine.nodes[fine.tagged_nodes[2]];
  EXPECT_LT((middle - 0.5 * (mesh.nodes[tagged[0]] + mesh.nodes[tagged[1]])).norm(), 1e-15);
}

TEST(RefinementTest, NewNodesAreBetweenTheirEnds) {
  const TetMesh coarse = MakeBox(Vec3::Zero(), Vec3::Ones(), {2, 1, 1});
  const RefinedTetrahedra refined = Refined(coarse);
  ASSERT_EQ(refined.ends.size(), refined.mesh.nodes.size() - coarse.nodes.size());
  for (std::size_t i = 0; i < refined.ends.size(); ++i) {
    const auto& [a, b] = refined.ends[i];
    const Vec3 middle = 0.5 * (coarse.nodes[a] + coarse.nodes[b]);
    EXPECT_EQ(refined.mesh.nodes[coarse.nodes.size() + i], middle);
  }
}

// The point at barycentric coordinates L of a quadratic tetrahedron with some curved edges.
Vec3 PointIn(const TetMesh& mesh, std::size_t tet, const std::array<double, 4>& L) {
  Vec3 x = Vec3::Zero();
  for (int c = 0; c < 4; ++c) x += L[c] * (2 * L[c] - 1) * mesh.nodes[mesh.tetrahedra[tet][c]];
  for (const auto& [i, j] : kTetEdges) {
    const std::int32_t a = mesh.tetrahedra[tet][i], b = mesh.tetrahedra[tet][j];
    Vec3 middle = 0.5 * (mesh.nodes[a] + mesh.nodes[b]);
    for (const CurvedEdge& edge : mesh.curved_edges) {
      if (std::minmax(edge.ends[0], edge.ends[1]) == std::minmax(a, b)) middle = edge.middle;
    }
    x += 4 * L[i] * L[j] * middle;
  }
  return x;
}

// Every part of a curved element maps onto the points of the element: both are quadratic maps.
TEST(RefinementTest, CurvedElementsKeepTheirShape) {
  TetMesh coarse;
  coarse.nodes = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
  coarse.tetrahedra = {{0, 1, 2, 3}};
  coarse.curved_edges = {{{1, 2}, Vec3(0.58, 0.56, 0.03)}, {{3, 1}, Vec3(0.55, 0.02, 0.54)}};
  TetMesh straight = coarse;
  straight.curved_edges.clear();
  const TetMesh fine = Refined(coarse).mesh, fine_straight = Refined(straight).mesh;
  ASSERT_EQ(fine.tetrahedra, fine_straight.tetrahedra) << "the same diagonal is the shortest";
  for (std::size_t t = 0; t < 8; ++t) {
    const std::array<double, 4> L = {0.1, 0.2, 0.3, 0.4};
    // In the straight element, barycentric coordinates are coordinates.
    const Vec3 place = PointIn(fine_straight, t, L);
    EXPECT_LT((PointIn(fine, t, L) - PointIn(coarse, 0, {1 - place.sum(), place[0], place[1], place[2]})).norm(),
              1e-14);
  }
}

TEST(RefinementTest, VoxelsBecomeEight) {
  VoxelGrid grid = MakeVoxelGrid({2, 1, 1}, Vec3(0.002, 0.004, 0.006));
  grid.origin = Vec3(1, 2, 3);
  grid.material = {3, 0};
  grid.stiffness = {2.5f, 0};
  const VoxelGrid fine = Refined(grid);
  EXPECT_EQ(fine.size, (GridIndex{4, 2, 2}));
  EXPECT_EQ(fine.spacing, Vec3(0.001, 0.002, 0.003));
  EXPECT_EQ(fine.origin, grid.origin);
  EXPECT_EQ(std::count(fine.material.begin(), fine.material.end(), 3), 8);
  EXPECT_EQ(std::count(fine.stiffness.begin(), fine.stiffness.end(), 2.5f), 8);
  EXPECT_EQ(fine.MaterialAt({1, 1, 1}), 3);
  EXPECT_EQ(fine.MaterialAt({2, 1, 1}), 0);
}

}  // namespace
}  // namespace fascicle
