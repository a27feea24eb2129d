#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "core/geometry/bounds.h"
#include "core/sim/control_source.h"
#include "core/sim/rigid_bodies.h"
#include "tests/support/tet_scenes.h"

namespace fascicle {
namespace {

using namespace fascicle::testing;

// A box of 6 x 2 x 2 cm above floors.
Scene BoxAbove(const std::vector<Floor>& floors) {
  Scene scene = OneBody(BoxBody(Vec3(0.06, 0.02, 0.02), {3, 1, 1}, NeoHookean(std::array{1e4, 0.3})));
  scene.gravity.acceleration = Vec3(0, 0, -9.81);
  scene.floors = floors;
  scene.duration = 0.002;
  scene.output.frame_interval = 0.001;
  return scene;
}

std::vector<RigidBodyInfo> ShownRigidBodies(const Scene& scene) {
  return Simulation(std::make_shared<Scene>(scene), 1).layout().rigid_bodies;
}

TEST(FloorBodies, AreSquaresOfTheSurfacesBelowTheBodies) {
  const Vec3 middle(0.03, 0.01, 0.01);
  for (const Vec3& normal : {Vec3(0, 0, 1), Vec3(0, 0, -1), Vec3(0, 1, 0), Vec3(1, -2, 3)}) {
    const Vec3 n = normal.normalized(), point = middle - 0.04 * n + n.unitOrthogonal() * 0.3;
    const std::vector<RigidBodyInfo> bodies = ShownRigidBodies(BoxAbove({{"ground", point, n}}));
    ASSERT_EQ(bodies.size(), 1u);
    const RigidBodyInfo& floor = bodies[0];
    EXPECT_EQ(floor.name, "ground");
    EXPECT_FALSE(floor.moves);
    EXPECT_TRUE(floor.unbounded);
    const Mat3 R = RotationOf(floor.pose);
    EXPECT_NEAR((R.transpose() * R - Mat3::Identity()).norm(), 0, 1e-14);
    EXPECT_NEAR((R * Vec3::UnitZ() - n).norm(), 0, 1e-14);
    std::vector<Vec3> corners;
    for (const Vec3& X : floor.shape.nodes) {
      corners.push_back(floor.pose.position + R * X);
      EXPECT_NEAR((corners.back() - point).dot(n), 0, 1e-15);
    }
    double area = 0;
    for (const Triangle& t : floor.shape.triangles) {
      const Vec3 normal_of_t = (corners[t[1]] - corners[t[0]]).cross(corners[t[2]] - corners[t[0]]);
      EXPECT_NEAR(normal_of_t.normalized().dot(n), 1, 1e-14) << "is seen from where bodies are";
      area += normal_of_t.norm() / 2;
    }
    const double side = 2 * Vec3(0.06, 0.02, 0.02).norm();
    EXPECT_NEAR(area, side * side, 1e-12);
    // Below the middle of the box.
    EXPECT_NEAR(((corners[0] + corners[2]) / 2 - middle).cross(n).norm(), 0, 1e-15);
  }
}

TEST(FloorBodies, OneForEachFloorAndNoneInFrames) {
  const Scene scene =
      BoxAbove({{"ground", Vec3(0, 0, -0.01), Vec3(0, 0, 1)}, {"wall", Vec3(-0.01, 0, 0), Vec3(1, 0, 0)}});
  EXPECT_EQ(ShownRigidBodies(scene).size(), 2u);
  EXPECT_TRUE(ShownRigidBodies(BoxAbove({})).empty());
  for (const Frame& frame : RunScene(scene).frames) EXPECT_TRUE(frame.poses.empty());
}

// Shapes with their poses; those that move have theirs in every frame.
TEST(RigidBodies, ShapesAndPoses) {
  Scene scene = BoxAbove({{"ground", Vec3(0, 0, -0.01), Vec3(0, 0, 1)}});
  RigidBody bone{"bone", Cylinder{0.005, 0.1}, {Vec3(0.1, 0, 0), {1, 0, 0, 0}}, Motion(), {}, "", 0, {}};
  bone.motion->translation[2] = Curve{{0, 0.002}, {0, 0.01}};
  bone.motion->rotation = Rotation{Vec3::Zero(), Vec3::UnitZ(), Curve{{0, 0.002}, {0, 0.5}}};
  scene.rigid_bodies = {{"ball", Ball{0.01}, {Vec3(0.2, 0, 0), {1, 0, 0, 0}}, {}, {}, "", 0, {}}, bone};
  const std::vector<RigidBodyInfo> infos = RigidBodiesOf(scene);
  ASSERT_EQ(infos.size(), 3u);
  EXPECT_EQ(infos[0].name, "ground");
  EXPECT_EQ(infos[1].name, "ball");
  EXPECT_FALSE(infos[1].moves);
  EXPECT_TRUE(infos[2].moves);
  EXPECT_EQ(infos[2].pose.position, Vec3(0.1, 0, 0));
  ControlSource source(scene);
  const std::vector<Pose> poses = PosesOf(scene, source.At(0.001));
  ASSERT_EQ(poses.size(), 1u);
  EXPECT_LT((poses[0].position - Vec3(0.1 * std::cos(0.25), 0.1 * std::sin(0.25), 0.005)).norm(), 1e-15);
  EXPECT_LT((RotationOf(poses[0]) * Vec3::UnitX() - Vec3(std::cos(0.25), std::sin(0.25), 0)).norm(), 1e-15);
}

}  // namespace
}  // namespace fascicle
