// Solids in material space.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/solids.h"

namespace fascicle::testing {
namespace {

TEST(SolidShape, KnowsHowFarItsSurfaceIs) {
  ThreadTeam team(2);
  const SolidShape cube(CubeSurface(0.1, 4), 0.002, team);
  EXPECT_NEAR(cube.Distance(Vec3::Zero()), -0.05, 1e-3);
  EXPECT_NEAR(cube.Distance(Vec3(0.04, 0, 0.01)), -0.01, 1e-12);
  EXPECT_NEAR(cube.Distance(Vec3(0.051, 0.01, 0)), 0.001, 1e-12);
  EXPECT_GT(cube.Distance(Vec3(0.5, 0, 0)), 0.44);
  EXPECT_NEAR(cube.volume(), 1e-3, 1e-15);
  const SolidShape ball(CubeSurface(0.1, 24, true), 0.002, team);
  EXPECT_NEAR(ball.Distance(Vec3(0.01, 0.02, 0.02)), 0.03 - 0.05, 3e-4);
}

std::string Refusal(const TriangleMesh& surface, double spacing) {
  Problems problems;
  CheckSolidSurface(surface, spacing, problems);
  return problems.ToString();
}

TEST(SolidShape, RefusesWhatBoundsNoSolid) {
  const TriangleMesh good = CubeSurface(0.1, 4);
  EXPECT_EQ(Refusal(good, 0.01), "");
  TriangleMesh open = good, turned = good, both = good;
  open.triangles.pop_back();
  EXPECT_THAT(Refusal(open, 0.01), ::testing::HasSubstr("3 edges of the surface lack a triangle"));
  for (auto& triangle : turned.triangles) std::swap(triangle[0], triangle[1]);
  EXPECT_THAT(Refusal(turned, 0.01), ::testing::HasSubstr("is inverted"));
  for (const Vec3& node : good.nodes) both.nodes.push_back(node + Vec3(0.031, 0.017, 0.023));
  const auto count = static_cast<std::int32_t>(good.nodes.size());
  for (const auto& [a, b, c] : good.triangles) both.triangles.push_back({a + count, b + count, c + count});
  EXPECT_THAT(Refusal(both, 0.01), ::testing::HasSubstr("intersects itself"));
  // A cavity.
  TriangleMesh hollow = good;
  for (const Vec3& node : good.nodes) hollow.nodes.push_back(0.3 * node);
  for (const auto& [a, b, c] : good.triangles) hollow.triangles.push_back({a + count, c + count, b + count});
  EXPECT_EQ(Refusal(hollow, 0.01), "");
  for (std::size_t t = good.triangles.size(); t < hollow.triangles.size(); ++t) {
    std::swap(hollow.triangles[t][0], hollow.triangles[t][1]);
  }
  EXPECT_THAT(Refusal(hollow, 0.01), ::testing::HasSubstr("a part of the surface has the wrong orientation"));
  EXPECT_THAT(Refusal(good, 0.05), ::testing::HasSubstr("cells across"));
  EXPECT_THAT(Refusal({}, 0.05), ::testing::HasSubstr("no triangles"));
}

}  // namespace
}  // namespace fascicle::testing
