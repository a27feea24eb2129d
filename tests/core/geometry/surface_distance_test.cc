#include "core/geometry/surface_distance.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/geometry/obstacle.h"

namespace fascicle {
namespace {

TEST(SurfaceDistanceTest, KnowsItsInsideAtFacesEdgesAndCorners) {
  const TriangleMesh surface = SurfaceOf(Cuboid{Vec3(2, 2, 2)}, 1);
  const SurfaceDistance cube(surface);
  struct Case {
    Vec3 point;
    double distance;
    Vec3 normal;
  };
  const double d = std::sqrt(0.5), c = std::sqrt(1 / 3.0);
  for (const Case& known : {Case{{0.1, 0.2, 1.3}, 0.3, {0, 0, 1}},
                            {{0.1, 0.2, 0.9}, -0.1, {0, 0, 1}},
                            {{0.1, 1.2, 1.2}, 0.2 / d, {0, d, d}},
                            {{-1.1, -1.1, -1.1}, 0.1 / c, {-c, -c, -c}},
                            {{0.99, 0.2, -0.3}, -0.01, {1, 0, 0}}}) {
    const std::optional<SurfaceDistance::Place> found = cube.At(known.point, 0.5);
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->distance, known.distance, 1e-12);
    EXPECT_LT((found->normal - known.normal).norm(), 1e-9);
    EXPECT_LT((known.point - found->distance * found->normal - found->nearest).norm(), 1e-9);
  }
  EXPECT_FALSE(cube.At(Vec3::Zero(), 0.5));
}

}  // namespace
}  // namespace fascicle
