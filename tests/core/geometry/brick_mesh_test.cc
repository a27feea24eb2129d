#include "core/geometry/brick_mesh.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <set>

#include "core/geometry/region.h"

namespace fascicle {
namespace {

// Three voxels in an L with labels 1, 1 and 2, of a grid that is rotated about z and displaced.
BrickMesh Corner() {
  VoxelGrid grid = MakeVoxelGrid({3, 2, 1}, Vec3(0.1, 0.2, 0.3));
  grid.material = {1, 1, 0, 2, 0, 0};
  grid.origin = Vec3(1, 2, 3);
  grid.direction = Eigen::AngleAxisd(0.5, Vec3::UnitZ()).toRotationMatrix();
  return MakeBrickMesh(std::move(grid));
}

double VolumeOf(const BrickMesh& mesh, const Brick& brick) {
  const auto edge = [&](int c) { return Vec3(mesh.nodes[brick[c]] - mesh.nodes[brick[0]]); };
  return edge(1).cross(edge(2)).dot(edge(4));
}

TEST(BrickMeshTest, CornersAreWhereTheGridHasThem) {
  const BrickMesh mesh = Corner();
  ASSERT_EQ(mesh.bricks.size(), 3u);
  EXPECT_EQ(mesh.nodes.size(), 16u);
  EXPECT_EQ(mesh.labels, (std::vector<std::int32_t>{1, 1, 2}));
  for (const Brick& brick : mesh.bricks) EXPECT_NEAR(VolumeOf(mesh, brick), 0.006, 1e-15);
  EXPECT_LT((mesh.nodes[mesh.bricks[2][0]] - mesh.grid.CornerAt({0, 1, 0})).norm(), 1e-15);
  EXPECT_LT((mesh.nodes[mesh.bricks[1][7]] - mesh.grid.CornerAt({2, 1, 1})).norm(), 1e-15);
}

// Outward: the area vectors add up to zero, and x . n dA / 3 to the volume.
TEST(BrickMeshTest, BoundaryIsClosedAndTurnedOutward) {
  const BrickMesh mesh = Corner();
  const std::vector<Quad> quads = BoundaryQuads(mesh);
  EXPECT_EQ(quads.size(), 18u - 4u);
  Vec3 area = Vec3::Zero();
  double volume = 0;
  for (const Quad& q : quads) {
    const Vec3 of_quad = (mesh.nodes[q[1]] - mesh.nodes[q[0]]).cross(mesh.nodes[q[3]] - mesh.nodes[q[0]]);
    area += of_quad;
    volume += (mesh.nodes[q[0]] + mesh.nodes[q[2]]).dot(of_quad) / 6;
  }
  EXPECT_LT(area.norm(), 1e-15);
  EXPECT_NEAR(volume, 3 * 0.006, 1e-14);
}

TEST(BrickMeshTest, RegionsSelectBricksAndTheirSides) {
  const BrickMesh mesh = Corner();
  const std::vector<Quad> surface = BoundaryQuads(mesh);
  const Region labelled = SelectRegion(mesh, surface, "two", TagSelector{2});
  EXPECT_EQ(labelled.elements, (std::vector<std::int32_t>{2}));
  EXPECT_EQ(labelled.nodes.size(), 8u);
  EXPECT_EQ(labelled.quads.size(), 5u);  // the sixth is inside
  EXPECT_TRUE(labelled.triangles.empty());

  const Vec3 along_i = mesh.grid.direction.col(0);
  const Region side = SelectRegion(mesh, surface, "end", SideSelector{along_i, 0.1, 0.051});
  EXPECT_EQ(side.quads.size(), 2u);  // of the second voxel, and of the third
  EXPECT_EQ(side.elements, (std::vector<std::int32_t>{1, 2}));

  const Region beyond = SelectRegion(mesh, surface, "beyond", PlaneSelector{mesh.grid.CornerAt({1, 0, 0}), along_i});
  EXPECT_EQ(beyond.elements, (std::vector<std::int32_t>{1}));
  EXPECT_EQ(beyond.nodes.size(), 4u + 4u + 2u);
  const Region both = Intersection(beyond, side);
  EXPECT_EQ(both.quads.size(), 2u);
  EXPECT_EQ(both.elements, (std::vector<std::int32_t>{1}));
  EXPECT_TRUE(SelectRegion(mesh, surface, "none", TagSelector{3}).nodes.empty());
}

}  // namespace
}  // namespace fascicle
