#include "core/geometry/tet_mesh.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "core/geometry/shapes.h"

namespace fascicle {
namespace {

TetMesh CornerMesh() {
  TetMesh mesh;
  mesh.nodes = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3}};
  mesh.tetrahedra = {{0, 1, 2, 3}};
  return mesh;
}

TEST(TetMeshTest, SignedVolumeFollowsOrientation) {
  TetMesh mesh = CornerMesh();
  EXPECT_DOUBLE_EQ(SignedVolume(mesh, 0), 1.0);
  std::swap(mesh.tetrahedra[0][0], mesh.tetrahedra[0][1]);
  EXPECT_DOUBLE_EQ(SignedVolume(mesh, 0), -1.0);
}

TEST(TetMeshTest, BoundaryOfOneIsItsFourSides) {
  const TetMesh mesh = CornerMesh();
  const std::vector<Triangle> boundary = BoundaryTriangles(mesh);
  ASSERT_EQ(boundary.size(), 4u);
  const Vec3 middle = (mesh.nodes[0] + mesh.nodes[1] + mesh.nodes[2] + mesh.nodes[3]) / 4;
  for (const auto& [a, b, c] : boundary) {
    const Vec3 normal = (mesh.nodes[b] - mesh.nodes[a]).cross(mesh.nodes[c] - mesh.nodes[a]);
    EXPECT_GT(normal.dot(mesh.nodes[a] - middle), 0);
  }
}

// Divergence theorem: the surface integral of x . n / 3 is the volume; the area vectors of a closed surface add to
// zero.
TEST(TetMeshTest, BoundaryIsClosedAndEnclosesTheVolume) {
  for (const TetMesh& mesh : {MakeBox({1, 2, 3}, {1, 2, 0.5}, {3, 2, 4}), MakeSphere(0.7, 6)}) {
    double volume = 0;
    Vec3 area = Vec3::Zero();
    for (const auto& [a, b, c] : BoundaryTriangles(mesh)) {
      volume += mesh.nodes[a].dot(mesh.nodes[b].cross(mesh.nodes[c])) / 6;
      area += (mesh.nodes[b] - mesh.nodes[a]).cross(mesh.nodes[c] - mesh.nodes[a]) / 2;
    }
    EXPECT_NEAR(volume, TotalVolume(mesh), 1e-13);
    EXPECT_LT(area.norm(), 1e-13);
  }
}

}  // namespace
}  // namespace fascicle
