// Places of probes in elements of each kind.
#include "core/scene/probe_place.h"

#include <gtest/gtest.h>

#include "core/geometry/shapes.h"
#include "tests/support/full_scenes.h"

namespace fascicle {
namespace {

Vec3 PointAt(const ProbePlace& place, const Shape& shape) {
  Vec3 x = Vec3::Zero();
  double sum = 0;
  const std::vector<Vec3>& X =
      std::visit([](const auto& s) -> const std::vector<Vec3>& { return s.mesh.nodes; }, shape);
  for (const auto& [node, weight] : WeightsAt(place, shape)) {
    x += weight * X[static_cast<std::size_t>(node)];
    sum += weight;
  }
  EXPECT_NEAR(sum, 1, 1e-15);
  return x;
}

std::vector<Shape> Shapes() {
  TetShape tets;
  tets.mesh = MakeBox(Vec3(-0.01, 0, 0), Vec3(0.03, 0.02, 0.02), {3, 2, 2});
  VoxelGrid grid = MakeVoxelGrid({3, 2, 2}, Vec3(0.01, 0.02, 0.01));
  grid.material.assign(12, 1);
  return {tets, VoxelShape{MakeBrickMesh(std::move(grid)), {}}};
}

TEST(ProbePlaceTest, APointInsideIsInterpolated) {
  for (const Shape& shape : Shapes()) {
    for (const Vec3& point : {Vec3(0.0011, 0.0123, 0.0177), Vec3(0.0199, 0.001, 0.0003), Vec3(0.005, 0.01, 0.01)}) {
      const LocatedProbe located = LocateProbe("probe", 0, shape, point);
      ASSERT_TRUE(located.probe.inside.has_value());
      EXPECT_LT(located.outside, 1e-16);
      EXPECT_LT((PointAt(*located.probe.inside, shape) - point).norm(), 1e-16);
    }
  }
}

TEST(ProbePlaceTest, ANodeIsTheNode) {
  for (const Shape& shape : Shapes()) {
    const LocatedProbe located = LocateProbe("probe", 0, shape, Vec3(0.01, 0.02, 0.01 + 1e-13));
    EXPECT_FALSE(located.probe.inside.has_value());
    // Its fields are those of an element that has it.
    EXPECT_LT((PointAt(PlaceOf(located.probe, shape), shape) - Vec3(0.01, 0.02, 0.01)).norm(), 1e-16);
  }
}

TEST(ProbePlaceTest, OutsideItIsTheNearestNode) {
  for (const Shape& shape : Shapes()) {
    const LocatedProbe located = LocateProbe("probe", 0, shape, Vec3(0.0101, 0.0201, -0.003));
    EXPECT_FALSE(located.probe.inside.has_value());
    EXPECT_NEAR(located.outside, std::hypot(0.0001, 0.0001, 0.003), 1e-15);
  }
}

TEST(ProbePlaceTest, OnASurfaceItIsTheNearestPoint) {
  const TetMesh box = MakeBox(Vec3::Zero(), Vec3::Ones(), {2, 2, 2});
  const Shape shape = SurfaceShape{{box.nodes, BoundaryTriangles(box)}, {}, {}, {}};
  const LocatedProbe located = LocateProbe("probe", 0, shape, Vec3(0.3, 0.45, 0.9));
  ASSERT_TRUE(located.probe.inside.has_value());
  EXPECT_LT((PointAt(*located.probe.inside, shape) - Vec3(0.3, 0.45, 1)).norm(), 1e-14);
  EXPECT_NEAR(located.outside, 0.1, 1e-14);
}

}  // namespace
}  // namespace fascicle
