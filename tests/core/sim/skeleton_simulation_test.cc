// Scenes with a skeleton: bodies follow its bones, and pull at them.
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <cmath>

#include "core/geometry/capsule_surface.h"
#include "core/skeleton/skeleton_mechanics.h"
#include "same_bits.h"
#include "tests/support/two_bone_arm.h"

namespace fascicle {
namespace {

using namespace fascicle::testing;

// The arm; its elbow flexes from 1 to 1.1 rad in 0.2 s, and the flexor is active.
DrivenSkeleton FlexedArm() {
  DrivenSkeleton driven;
  driven.skeleton = TwoBoneArm();
  driven.shapes.assign(2, CapsuleSurface(Vec3::Zero(), 0.02, Vec3(0, -0.3, 0), 0.01));
  driven.motion.coordinates = {CoordinateMotion::Constant(0.3),
                               {ScalarFunction::LeastJerk({0, 0.2}, {1, 1.1}), 0, 0.2}};
  driven.activations = {Curve{{0, 0.2}, {0.1, 0.5}}, Curve::Constant(0)};
  return driven;
}

// A soft block between the ground and the forearm, without inertia.
Scene BlockOnForearm() {
  Body block = BoxBody(Vec3(0.06, 0.02, 0.02), {4, 2, 2}, NeoHookean(std::array{1e5, 0.3}));
  block.constraints = {Fix(kX0), Fix(kX1)};
  block.constraints[1].motion.bone = 1;
  Scene scene = OneBody(block);
  scene.skeleton = FlexedArm();
  scene.tet.stepping = Stepping::kQuasiStatic;
  scene.tet.element = ElementOrder::kLinear;
  scene.duration = 0.2;
  scene.output.frame_interval = 0.05;
  scene.output.moments = {{0, kX1, Vec3(0.1, 0.2, 0.3), std::nullopt}};
  return scene;
}

TEST(SkeletonSimulation, ABodyFollowsItsBone) {
  const Scene scene = BlockOnForearm();
  const RunResult run = RunScene(scene);
  ASSERT_EQ(run.outcome.kind, Outcome::Kind::kSucceeded) << run.outcome.failure.message;
  ASSERT_EQ(run.frames.size(), 5u);
  const Pose start = run.frames[0].poses.at(1);
  const std::vector<Vec3>& rest = scene.bodies[0].tet().mesh.nodes;
  for (const Frame& frame : run.frames) {
    const Pose now = frame.poses.at(1);
    for (const std::int32_t node : scene.bodies[0].regions[kX1].nodes) {
      const Vec3 in_bone = RotationOf(start).transpose() * (rest[node] - start.position);
      EXPECT_LT((frame.bodies[0].positions[node] - (now.position + RotationOf(now) * in_bone)).norm(), 1e-14);
    }
    for (const std::int32_t node : scene.bodies[0].regions[kX0].nodes) {
      EXPECT_EQ(frame.bodies[0].positions[node], rest[node]);
    }
  }
  EXPECT_NEAR(run.Last("skeleton/elbow/angle"), 1.1, 1e-14);
}

// The torque about a coordinate is that of the support's opposite force and moment about the joint's axis.
TEST(SkeletonSimulation, TorquesAreThoseOfTheSupports) {
  const RunResult run = RunScene(BlockOnForearm());
  const auto vector = [&](std::size_t frame, const std::string& name) {
    return Vec3(run.At(frame, name + "/x"), run.At(frame, name + "/y"), run.At(frame, name + "/z"));
  };
  double largest = 0;
  for (std::size_t f = 1; f < run.frames.size(); ++f) {
    const Vec3 force = -vector(f, "box/reaction/x1"), about_point = -vector(f, "box/moment/x1");
    const Vec3 elbow = run.frames[f].poses[1].position;
    const Vec3 about_elbow = about_point + (Vec3(0.1, 0.2, 0.3) - elbow).cross(force);
    const Vec3 about_shoulder = about_point + Vec3(0.1, 0.2, 0.3).cross(force);
    const double size = force.norm() * 0.3;
    EXPECT_NEAR(run.At(f, "skeleton/elbow/torque/box"), about_elbow.z(), 1e-10 * size);
    EXPECT_NEAR(run.At(f, "skeleton/shoulder/torque/box"), about_shoulder.z(), 1e-10 * size);
    EXPECT_LT((vector(f, "skeleton/forearm/pull") - force).norm(), 1e-12 * force.norm());
    EXPECT_LT((vector(f, "skeleton/forearm/moment") - about_elbow).norm(), 1e-10 * size);
    largest = std::max(largest, std::abs(about_elbow.z()));
  }
  EXPECT_GT(largest, 0.05) << "there should be something to compare [N m]";
}

TEST(SkeletonSimulation, FramesHaveBonesAndMuscles) {
  const Scene scene = BlockOnForearm();
  const Simulation simulation(std::make_shared<Scene>(scene), 1);
  const FrameLayout& layout = simulation.layout();
  ASSERT_EQ(layout.rigid_bodies.size(), 2u);
  EXPECT_EQ(layout.rigid_bodies[1].name, "forearm");
  EXPECT_TRUE(layout.rigid_bodies[1].moves);
  EXPECT_FALSE(layout.rigid_bodies[1].shape.triangles.empty());
  ASSERT_EQ(layout.lines.size(), 2u);
  const RunResult run = RunScene(scene);
  const LineFrame& flexor = run.frames[2].lines.at(0);
  ASSERT_EQ(flexor.points.size(), 2u);
  EXPECT_NEAR(flexor.values.at(0), 0.3, 1e-14);
  EXPECT_NEAR(flexor.values.at(1), (flexor.points[1] - flexor.points[0]).norm(), 1e-14);
  EXPECT_NEAR(flexor.values.at(2), 0.3 * 800, 1e-10);
  EXPECT_NEAR(run.At(2, "skeleton/elbow/muscle_torque"), 240 * run.At(2, "skeleton/flexor/moment_arm/elbow"), 1e-10);
  for (const SeriesInfo& series : run.series) EXPECT_NE(series.name, "skeleton/flexor/moment_arm/shoulder");
}

// Moving supports of the other steppings, which use velocities, too.
TEST(SkeletonSimulation, ExplicitBodiesFollowAtTheBonesVelocity) {
  Scene scene = BlockOnForearm();
  scene.tet.stepping = Stepping::kExplicit;
  scene.output.fields = {OutputField::kVelocity};
  scene.duration = 0.1;
  const RunResult run = RunScene(scene);
  ASSERT_EQ(run.outcome.kind, Outcome::Kind::kSucceeded) << run.outcome.failure.message;
  SkeletonMechanics mechanics(scene.skeleton->skeleton);
  const BoneMotion forearm = mechanics.Motions(scene.skeleton->motion.At(0.1), scene.skeleton->motion.At(0.1, 1))[1];
  const std::int32_t node = scene.bodies[0].regions[kX1].nodes[0];
  const BodyFrame& body = run.frames.back().bodies[0];
  const Vec3 expected = forearm.velocity + forearm.angular_velocity.cross(body.positions[node] - forearm.pose.position);
  const double* v = &body.fields[0].values[3 * static_cast<std::size_t>(node)];
  EXPECT_LT((Vec3(v[0], v[1], v[2]) - expected).norm(), 0.02 * expected.norm());
}

TEST(SkeletonSimulation, AnyThreadsAndRestartsGiveTheSameBits) {
  ExpectAnyThreadsAndRestartsGiveTheSameBits(BlockOnForearm(), 5);
}

TEST(SkeletonSimulation, RunsWithoutBodies) {
  Scene scene = BlockOnForearm();
  scene.bodies.clear();
  scene.output.moments.clear();
  Problems problems;
  CheckScene(scene, problems);
  EXPECT_TRUE(problems.empty()) << problems.ToString();
  const RunResult run = RunScene(scene);
  ASSERT_EQ(run.outcome.kind, Outcome::Kind::kSucceeded);
  EXPECT_EQ(run.frames.back().step, 4);
  EXPECT_NEAR(run.Last("skeleton/elbow/angle"), 1.1, 1e-14);
  ExpectAnyThreadsAndRestartsGiveTheSameBits(scene, 5);
}

TEST(SkeletonSimulation, ARestIsOnlyWhenTheMotionHasEnded) {
  Scene scene = BlockOnForearm();
  scene.duration = 1;
  scene.skeleton->activations[0] = Curve::Constant(0);
  scene.output.settle_speed = 1000;
  const RunResult run = RunScene(scene);
  EXPECT_NEAR(run.frames.back().time, 0.2, 1e-12);
}

TEST(SkeletonSimulation, ChecksRelateBonesAndBodies) {
  Scene scene = BlockOnForearm();
  scene.bodies[0].constraints[1].motion.bone = 2;
  scene.skeleton->activations.pop_back();
  scene.skeleton->motion.coordinates.pop_back();
  scene.skeleton->shapes.pop_back();
  scene.floors.push_back({"forearm", Vec3(0, -5, 0), Vec3::UnitY()});
  scene.gravity.scale = Curve{{0, 1}, {0, 1}};
  Problems problems;
  CheckScene(scene, problems);
  std::string paths;
  for (const Problem& problem : problems.kept()) paths += problem.path + "\n";
  for (const char* path : {"bodies[0].constraints[1].motion.bone", "skeleton.drive", "skeleton.motion",
                           "skeleton.bones", "skeleton.bones[1].name", "gravity.scale"}) {
    EXPECT_NE(paths.find(std::string(path) + "\n"), std::string::npos) << path << " in\n" << paths;
  }
}

}  // namespace
}  // namespace fascicle
