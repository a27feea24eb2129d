#include "core/geometry/isosurface_stuffing.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>

#include "core/geometry/mesh_checks.h"
#include "core/geometry/mesh_quality.h"
#include "surface_samples.h"

namespace fascicle {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

double Uniform(std::mt19937& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

TriangleMesh Turned(TriangleMesh surface, std::mt19937& random) {
  const double angle = Uniform(random, 0, 6);
  const double x = Uniform(random, -1, 1), y = Uniform(random, -1, 1), z = Uniform(random, -1, 1);
  const Mat3 turn = Eigen::AngleAxisd(angle, Vec3(x, y, z).normalized()).toRotationMatrix();
  for (Vec3& node : surface.nodes) node = turn * node;
  return surface;
}

// The bound holds for any surface, size and grading, sharp edges and thin parts included
// [Labelle and Shewchuk 2007, theorem 1].
TEST(IsosurfaceStuffingTest, AnglesAreBoundedForManyShapesAndSizes) {
  std::mt19937 random(5);
  ThreadTeam team(1);
  const TriangleMesh shapes[] = {SurfaceOf(MakeSphere(1, 12)), SurfaceOf(MakeTorus({1, 0.4, 36, 8})),
                                 SurfaceOf(MakeBox({0, 0, 0}, {1, 0.7, 1.8}, {1, 1, 1})),
                                 SurfaceOf(MakeBox({0, 0, 0}, {0.15, 1, 2}, {1, 1, 1})),
                                 SurfaceOf(MakeFusiform({4, 0.6, 0.1, 6, 24}))};
  double smallest = std::numbers::pi, largest = 0;
  int meshes = 0;
  for (const TriangleMesh& shape : shapes) {
    for (int round = 0; round < 8; ++round) {
      const TriangleMesh surface = Turned(shape, random);
      const TriangleTree tree(surface);
      const double size = Uniform(random, 0.12, 0.3), grading = round % 2 == 0 ? 0 : Uniform(random, 0, 1);
      const TetMesh mesh = StuffLattice(MakeLattice(surface, tree, size, grading, team), tree, team);
      if (mesh.tetrahedra.empty()) continue;  // all nodes beside the thin plate
      ++meshes;
      const AngleFigures angles = MeasureAngles(mesh);
      smallest = std::min(smallest, angles.smallest);
      largest = std::max(largest, angles.largest);
      for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) ASSERT_GT(SignedVolume(mesh, t), 0);
      for (const Triangle& triangle : BoundaryTriangles(mesh)) {
        for (const std::int32_t n : triangle) ASSERT_LT(tree.Distance(mesh.nodes[n]), 2e-4 * size);
      }
    }
  }
  EXPECT_GT(meshes, 35);
  EXPECT_GT(smallest, 10.7 * kDegree);
  EXPECT_LT(largest, 164.8 * kDegree);
}

// Tetrahedra conform: at most two share a face, and the boundary is closed.
TEST(IsosurfaceStuffingTest, GradedMeshesAreConforming) {
  ThreadTeam team(1);
  const TriangleMesh surface = SurfaceOf(MakeSphere(0.05, 12));
  const TriangleTree tree(surface);
  std::size_t uniform = 0;
  for (const double grading : {0.0, 0.4, 1.0}) {
    const TetMesh mesh = StuffLattice(MakeLattice(surface, tree, 0.006, grading, team), tree, team);
    Problems problems;
    const MeshReport report = CheckMesh(mesh, problems);
    EXPECT_TRUE(problems.empty()) << grading << ": " << problems.ToString();
    EXPECT_EQ(report.components, 1);
    // Chords of a sphere: the error is of second order in the size.
    EXPECT_NEAR(report.volume / EnclosedVolume(surface), 1, 0.02);
    EXPECT_NEAR(EnclosedVolume(SurfaceOf(mesh)), report.volume, 1e-11 * report.volume) << "no hole inside";
    if (grading == 0) uniform = mesh.tetrahedra.size();
  }
  const TetMesh graded = StuffLattice(MakeLattice(surface, tree, 0.006, 1, team), tree, team);
  EXPECT_LT(graded.tetrahedra.size(), 4 * uniform / 5);
}

}  // namespace
}  // namespace fascicle
