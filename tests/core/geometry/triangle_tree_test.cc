#include "core/geometry/triangle_tree.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/geometry/triangle_distance.h"
#include "surface_samples.h"

namespace fascicle {
namespace {

Vec3 RandomPoint(std::mt19937& random, double reach) {
  std::uniform_real_distribution<double> uniform(-reach, reach);
  const double x = uniform(random), y = uniform(random), z = uniform(random);
  return {x, y, z};
}

TEST(TriangleTreeTest, NearestPointsAreThoseOfAllTriangles) {
  const TriangleMesh surface = SurfaceOf(MakeTorus({1, 0.4, 24, 4}));
  const TriangleTree tree(surface);
  std::mt19937 random(1);
  for (int i = 0; i < 300; ++i) {
    const Vec3 point = RandomPoint(random, 2);
    double least = 1e300;
    for (const auto& [a, b, c] : surface.triangles) {
      least = std::min(least, SquaredDistance(point, surface.nodes[a], surface.nodes[b], surface.nodes[c]));
    }
    const TriangleTree::Nearest nearest = tree.FindNearest(point);
    EXPECT_NEAR(nearest.squared_distance, least, 1e-12);
    EXPECT_NEAR((nearest.point - point).squaredNorm(), least, 1e-12);
    const auto& [a, b, c] = surface.triangles[nearest.triangle];
    EXPECT_NEAR(SquaredDistance(nearest.point, surface.nodes[a], surface.nodes[b], surface.nodes[c]), 0, 1e-20);
  }
}

// 1 inside of a torus, 0 outside and in its hole; the dipole approximation of far triangles has little error.
TEST(TriangleTreeTest, WindingNumberTellsInsideFromOutside) {
  const TriangleMesh surface = SurfaceOf(MakeTorus({1, 0.4, 48, 8}));
  const TriangleTree tree(surface);
  std::mt19937 random(2);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 point = RandomPoint(random, 1.5);
    const double around = std::hypot(std::hypot(point.x(), point.y()) - 1, point.z());
    if (std::abs(around - 0.4) < 0.02) continue;
    EXPECT_NEAR(tree.WindingNumber(point), around < 0.4 ? 1 : 0, 0.05);
    EXPECT_NEAR(tree.SignedDistance(point), around - 0.4, 0.02);
  }
}

// Half of a sphere subtends half the solid angle at its centre.
TEST(TriangleTreeTest, OpenSurfacesHaveWindingNumbersBetween) {
  TriangleMesh surface = SurfaceOf(MakeSphere(1, 16));
  std::erase_if(surface.triangles, [&](const Triangle& t) {
    return surface.nodes[t[0]].z() + surface.nodes[t[1]].z() + surface.nodes[t[2]].z() < 0;
  });
  EXPECT_NEAR(TriangleTree(surface).WindingNumber(Vec3::Zero()), 0.5, 0.02);
}

TEST(TriangleTreeTest, FindsTrianglesThatCutEachOther) {
  const TriangleMesh sphere = SurfaceOf(MakeSphere(1, 8));
  EXPECT_TRUE(TriangleTree(sphere).CuttingPairs().empty());
  const TriangleMesh apart = Joined(sphere, Moved(sphere, {2.1, 0, 0}));
  EXPECT_TRUE(TriangleTree(apart).CuttingPairs().empty());
  const TriangleMesh both = Joined(sphere, Moved(sphere, {1.03, 0.02, 0.01}));
  const auto pairs = TriangleTree(both).CuttingPairs();
  EXPECT_GT(pairs.size(), 20u);
  // All near the circle in which the spheres intersect.
  for (const auto& [s, t] : pairs) EXPECT_NEAR(both.nodes[both.triangles[s][0]].x(), 0.515, 0.5);
}

// Two triangles with a common node that intersect.
TEST(TriangleTreeTest, FindsCutsBetweenNeighbours) {
  const TriangleMesh surface{{{0, 0, 0}, {2, 1, 0}, {2, -1, 0}, {1, 0, 1}, {1, 0, -1}}, {{0, 1, 2}, {0, 3, 4}}};
  EXPECT_THAT(TriangleTree(surface).CuttingPairs(), ::testing::ElementsAre(std::pair(0, 1)));
}

}  // namespace
}  // namespace fascicle
