#include "core/geometry/obstacle.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "core/geometry/triangle_tree.h"

namespace fascicle {
namespace {

// An L of unit thickness: a surface with a concave edge.
TriangleMesh Bracket() {
  const std::vector<Vec3> outline = {{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}};
  TriangleMesh mesh;
  for (const double z : {0.0, 1.0}) {
    for (const Vec3& x : outline) mesh.nodes.emplace_back(x[0], x[1], z);
  }
  const std::vector<Triangle> lid = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}};
  for (const auto& [a, b, c] : lid) {
    mesh.triangles.push_back({a, c, b});
    mesh.triangles.push_back({a + 6, b + 6, c + 6});
  }
  for (std::int32_t k = 0; k < 6; ++k) {
    const std::int32_t next = (k + 1) % 6;
    mesh.triangles.push_back({k, next, next + 6});
    mesh.triangles.push_back({k, next + 6, k + 6});
  }
  return mesh;
}

std::vector<ObstacleShape> EachShape() {
  return {HalfSpace(), Ball{0.8}, Cuboid{Vec3(1, 2, 0.5)}, Cylinder{0.6, 1.5}, Bracket()};
}

// The normal is the gradient of the distance, and the curvature that of the normal, inside and outside.
TEST(ObstacleTest, NormalAndCurvatureAreDerivatives) {
  const std::vector<ObstacleShape> shapes = EachShape();
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1.5, 2.5);
  for (std::size_t k = 0; k < shapes.size(); ++k) {
    const ObstacleDistance distance(shapes[k]);
    int checked = 0;
    for (int i = 0; i < 400; ++i) {
      const double x = uniform(random), y = uniform(random), z = uniform(random);
      const Vec3 X(x, y, z);
      const SignedDistance at = distance.At(X);
      EXPECT_NEAR(at.normal.norm(), 1, 1e-12);
      constexpr double kH = 1e-6;
      Vec3 slope;
      Mat3 bend;
      bool smooth = std::abs(at.distance) > 0.02;
      for (int c = 0; c < 3; ++c) {
        const SignedDistance ahead = distance.At(X + kH * Vec3::Unit(c)), behind = distance.At(X - kH * Vec3::Unit(c));
        slope[c] = (ahead.distance - behind.distance) / (2 * kH);
        bend.col(c) = (ahead.normal - behind.normal) / (2 * kH);
        // Where the nearest place jumps there is no derivative.
        smooth &= (ahead.normal - behind.normal).norm() < 1e-3 && ahead.curvature.isApprox(at.curvature, 1e-3);
      }
      if (!smooth) continue;
      ++checked;
      EXPECT_LT((slope - at.normal).norm(), 1e-7) << k << " at " << X.transpose();
      EXPECT_LT((bend - at.curvature).norm(), 1e-6) << k << " at " << X.transpose();
    }
    EXPECT_GT(checked, 250) << k;
  }
}

// At the edges and nodes of a surface of triangles, and beside its concave edge, the sign is right.
TEST(ObstacleTest, SignsOfASurfaceOfTriangles) {
  const ObstacleShape shape = Bracket();
  const ObstacleDistance distance(shape);
  const TriangleTree tree(std::get<TriangleMesh>(shape));
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(-0.5, 2.5);
  for (int i = 0; i < 3000; ++i) {
    const double x = uniform(random), y = uniform(random), z = uniform(random);
    const bool inside = z > 0 && z < 1 && x > 0 && y > 0 && ((x < 2 && y < 1) || (x < 1 && y < 2));
    const double found = distance.At(Vec3(x, y, z)).distance;
    EXPECT_EQ(found < 0, inside) << x << " " << y << " " << z;
    EXPECT_NEAR(std::abs(found), tree.Distance(Vec3(x, y, z)), 1e-12);
  }
  // Beyond a corner, and in the angle of the L.
  EXPECT_NEAR(distance.At(Vec3(-1, -1, -1)).distance, std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(distance.At(Vec3(1.2, 1.3, 0.5)).distance, 0.2, 1e-12);
  EXPECT_NEAR(distance.At(Vec3(0.9, 0.9, 0.5)).distance, -std::hypot(0.1, 0.1), 1e-12);
}

// Pictures show the shapes: closed surfaces with their volumes, outward.
TEST(ObstacleTest, SurfacesEncloseTheShapes) {
  EXPECT_NEAR(EnclosedVolume(SurfaceOf(Cuboid{Vec3(1, 2, 3)}, 1)), 6, 1e-12);
  const double ball = 4 * std::numbers::pi / 3, cylinder = 2 * std::numbers::pi;
  EXPECT_NEAR(EnclosedVolume(SurfaceOf(Ball{1}, 1)), ball, 0.01 * ball);
  EXPECT_NEAR(EnclosedVolume(SurfaceOf(Cylinder{1, 2}, 1)), cylinder, 0.01 * cylinder);
  EXPECT_NEAR(EnclosedVolume(SurfaceOf(Bracket(), 1)), 3, 1e-12);
  EXPECT_NEAR(Area(SurfaceOf(HalfSpace(), 3)), 9, 1e-12);
}

}  // namespace
}  // namespace fascicle
