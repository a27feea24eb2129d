// Nodal forces of loads.
#include <gtest/gtest.h>

#include <vector>

#include "core/scene/nodal_forces.h"

namespace fascicle {
namespace {

// Two unit right triangles and a 2 x 3 quad side by side in the plane z = 0.
const std::vector<Vec3> kNodes = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0),
                                  Vec3(3, 0, 0), Vec3(3, 3, 0), Vec3(1, 3, 0)};

Region Surface() {
  Region region;
  region.nodes = {0, 1, 2, 3, 4, 5, 6};
  region.triangles = {{0, 1, 2}, {0, 2, 3}};
  region.quads = {{1, 4, 5, 6}};
  return region;
}

Load LoadOf(decltype(Load::kind) kind) {
  Load load;
  load.kind = kind;
  return load;
}

TEST(NodalForcesTest, TractionIsSharedByTheCornersOfFaces) {
  const LoadedRegion region = LoadedRegionOf(Surface(), kNodes);
  ASSERT_EQ(region.faces.size(), 3u);
  EXPECT_EQ(region.faces[0].area, Vec3(0, 0, 0.5));
  EXPECT_EQ(region.faces[2].area, Vec3(0, 0, 6));
  const Load load = LoadOf(Traction{Vec3(0, 0, 12)});
  EXPECT_EQ(LoadedPartOf(load), LoadedPart::kFaces);
  const auto forces = NodalForcesOf(load, region);
  ASSERT_EQ(forces.size(), 7u);
  const std::vector<double> expected = {4, 2 + 18, 4, 2, 18, 18, 18};
  for (const auto& [node, force] : forces) {
    EXPECT_NEAR(force.z(), expected[static_cast<std::size_t>(node)], 1e-14) << node;
    EXPECT_EQ(force.x(), 0);
  }
}

TEST(NodalForcesTest, AForceIsSharedByTheNodes) {
  const Load load = LoadOf(NodalForce{Vec3(7, 0, -14)});
  EXPECT_EQ(LoadedPartOf(load), LoadedPart::kNodes);
  const auto forces = NodalForcesOf(load, LoadedRegionOf(Surface(), kNodes));
  ASSERT_EQ(forces.size(), 7u);
  for (const auto& [node, force] : forces) EXPECT_EQ(force, Vec3(1, 0, -2)) << node;
}

TEST(NodalForcesTest, PressureAtRestPushesAgainstTheNormals) {
  const Load load = LoadOf(Pressure{12});
  EXPECT_TRUE(DependsOnPositions(load));
  double sum = 0;
  for (const auto& [node, force] : NodalForcesOf(load, LoadedRegionOf(Surface(), kNodes))) sum += force.z();
  EXPECT_NEAR(sum, -12 * 7, 1e-12);
}

TEST(NodalForcesTest, ABodyForceIsSharedByTheCornersOfElements) {
  Body body;
  body.tet().mesh.nodes = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(0, 0, -2)};
  body.tet().mesh.tetrahedra = {{0, 1, 2, 3}, {0, 2, 1, 4}};
  Region region;
  region.elements = {0, 1};
  const Load load = LoadOf(BodyForce{Vec3(24, 0, 0)});
  EXPECT_EQ(LoadedPartOf(load), LoadedPart::kElements);
  const auto forces = NodalForcesOf(load, LoadedRegionOf(region, body));
  const std::vector<double> expected = {3, 3, 3, 1, 2};
  ASSERT_EQ(forces.size(), 5u);
  for (const auto& [node, force] : forces) {
    EXPECT_NEAR(force.x(), expected[static_cast<std::size_t>(node)], 1e-14) << node;
  }
}

}  // namespace
}  // namespace fascicle
