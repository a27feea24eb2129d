// Skeletons: from messages to the core, and every problem with its path.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/skeleton/muscle_path.h"
#include "scenes.h"

namespace fascicle::server {
namespace {

using ::testing::HasSubstr;

// An upper arm and a forearm with hinges about z, and two muscles of the elbow.
v1::Scene ArmScene() {
  return ParseText(R"(
    name: "arm" duration: 1 tet {} output { frame_interval: 0.1 }
    gravity { acceleration: [0, -9.81, 0] }
    skeleton {
      bones { name: "humerus" mass: 1.5 mass_centre: [0, -0.15, 0] inertia: [0.01, 0.002, 0.01, 0, 0, 0]
              shapes { capsule { to: [0, -0.3, 0] radius: 0.01 } } }
      bones { name: "forearm" mass: 2 mass_centre: [0, -0.15, 0] inertia: [0.02, 0.002, 0.02, 0, 0, 0] }
      joints { name: "elbow" parent: "humerus" child: "forearm" in_parent { position: [0, -0.3, 0] }
               rotations { axis: [0, 0, 2] coordinate: "elbow" } }
      joints { name: "shoulder" child: "humerus" rotations { axis: [0, 0, 1] coordinate: "shoulder" } }
      coordinates { name: "shoulder" }
      coordinates { name: "elbow" value: 0.5 range: [0, 2.3] }
      muscles { name: "flexor" max_isometric_force: 800
                points { bone: "humerus" place: [0.02, -0.05, 0] } points { bone: "forearm" place: [0.01, -0.05, 0] } }
      muscles { name: "extensor" max_isometric_force: 800
                points { bone: "humerus" place: [-0.02, -0.05, 0] } points { bone: "forearm" place: [-0.025, 0.01, 0] } }
    })");
}

Problems WithSkeleton(const std::string& text, const Files& files = {}) {
  v1::Scene scene = ArmScene();
  EXPECT_TRUE(google::protobuf::TextFormat::MergeFromString(text, scene.mutable_skeleton())) << text;
  return ProblemsOf(scene, files);
}

std::shared_ptr<const Scene> Merged(const std::string& text, const Files& files = {}) {
  v1::Scene scene = ArmScene();
  EXPECT_TRUE(google::protobuf::TextFormat::MergeFromString(text, &scene)) << text;
  return Translate(scene, files);
}

TEST(SkeletonTranslation, JointsAreSortedAndCoordinatesMoveThem) {
  const auto scene = Translate(ArmScene());
  ASSERT_TRUE(scene && scene->skeleton);
  const Skeleton& arm = scene->skeleton->skeleton;
  ASSERT_EQ(arm.joints.size(), 2u);
  EXPECT_EQ(arm.joints[0].name, "shoulder");
  EXPECT_EQ(arm.gravity, Vec3(0, -9.81, 0));
  EXPECT_NEAR(arm.joints[1].rotations[0].axis.norm(), 1, 1e-15);
  EXPECT_GT(EnclosedVolume(scene->skeleton->shapes[0]), 0) << "triangles face outwards";
  SkeletonMechanics mechanics(arm);
  const Eigen::Vector2d q(0.3, 0.5);
  const Pose forearm = mechanics.Poses(q)[1];
  EXPECT_LT((forearm.position - 0.3 * Vec3(std::sin(0.3), -std::cos(0.3), 0)).norm(), 1e-14);
  EXPECT_LT((RotationOf(forearm) * Vec3::UnitX() - Vec3(std::cos(0.8), std::sin(0.8), 0)).norm(), 1e-14);
}

TEST(SkeletonTranslation, BodiesFollowBonesAndMuscles) {
  const auto scene = Merged(R"(
    skeleton { drive { curves { curves { muscle: "flexor" curve { times: [0, 1] values: [0, 0.7] } }
                                curves { muscle: "extensor" curve { times: 0 values: 0.2 } } } } }
    bodies {
      name: "box" unit: LENGTH_UNIT_CM mesh { box { size: [2, 3, 4] divisions: [2, 3, 4] } }
      material { muscle {} } fibres { constant { direction: [0, 0, 1] } }
      regions { name: "bottom" plane { point: [0, 0, 0] normal: [0, 0, -1] } }
      regions { name: "top" plane { point: [0, 0, 4] normal: [0, 0, 1] } }
      regions { name: "half" plane { point: [0, 0, 2] normal: [0, 0, 1] } }
      constraints { region: "bottom" motion { bone: "humerus" } } constraints { region: "top" motion { bone: "forearm" } }
      activation_muscle: "flexor"
      region_activations { region: "half" muscle: "extensor" }
    })");
  ASSERT_TRUE(scene);
  const Body& box = scene->bodies[0];
  EXPECT_EQ(box.constraints[0].motion.bone, 0);
  EXPECT_EQ(box.constraints[1].motion.bone, 1);
  EXPECT_EQ(box.activation.values, (std::vector<double>{0, 0.7}));
  ASSERT_EQ(box.tet().activations.more.size(), 1u);
  EXPECT_EQ(box.tet().activations.more[0].values, std::vector<double>{0.2});
}

TEST(SkeletonTranslation, MotionsOfFilesAreInRadiansFromTheirStart) {
  Files files;
  v1::Scene scene = ArmScene();
  v1::SkeletonMotion& motion = *scene.mutable_skeleton()->mutable_motion();
  motion.mutable_file()->set_path("flexion.mot");
  motion.mutable_file()->set_asset(
      files.Add("flexion\nnRows=3\ninDegrees=yes\nendheader\n"
                "time /jointset/elbow/elbow/value other\n2 0 7\n2.5 45 7\n3 90 7\n"));
  const auto translated = Translate(scene, files);
  ASSERT_TRUE(translated);
  const SkeletonMotion& moved = translated->skeleton->motion;
  EXPECT_NEAR(moved.At(0.5)[1], std::numbers::pi / 4, 1e-14);
  EXPECT_NEAR(moved.At(7)[1], std::numbers::pi / 2, 1e-14);
  EXPECT_EQ(moved.At(0.5)[0], 0);
  ASSERT_EQ(translated->skeleton->notes.size(), 1u);
  EXPECT_THAT(translated->skeleton->notes[0], HasSubstr("`other`"));
}

TEST(SkeletonTranslation, DistributionHoldsTheForearm) {
  const auto scene = Merged("skeleton { drive { distribution { at_rest: true } } }");
  ASSERT_TRUE(scene);
  const DrivenSkeleton& driven = *scene->skeleton;
  ASSERT_EQ(driven.activations[0].times.size(), 11u);
  SkeletonMechanics mechanics(driven.skeleton);
  const double arm = GeometryOf(mechanics, driven.motion.At(0)).moment_arms(1, 0);
  EXPECT_NEAR(driven.activations[0].At(0.5) * 800 * arm, 2 * 9.81 * 0.15 * std::sin(0.5), 1e-9);
  EXPECT_NEAR(driven.activations[1].At(0.5), 0, 1e-12);
}

TEST(SkeletonTranslation, WeakMusclesAreTold) {
  v1::Scene scene = ArmScene();
  for (v1::LineMuscle& muscle : *scene.mutable_skeleton()->mutable_muscles()) muscle.set_max_isometric_force(5);
  scene.mutable_skeleton()->mutable_drive()->mutable_distribution();
  const auto translated = Translate(scene);
  ASSERT_TRUE(translated);
  ASSERT_EQ(translated->skeleton->notes.size(), 1u);
  EXPECT_THAT(translated->skeleton->notes[0], HasSubstr("N m about `elbow`"));
}

TEST(SkeletonTranslation, FieldsWithoutEffectAreTold) {
  const std::string fibres =
      "skeleton { muscles { name: 'x' max_isometric_force: 1 optimal_fibre_length: 0.1 "
      "points {} points { bone: 'forearm' } } }";
  const auto scene = Merged(fibres + " tet { time_step: 1e-3 }");
  ASSERT_TRUE(scene);
  EXPECT_THAT(scene->skeleton->notes,
              ::testing::UnorderedElementsAre(HasSubstr("skeleton.muscles[2].optimal_fibre_length: has no effect"),
                                              HasSubstr("tet.time_step: has no effect")));
}

TEST(SkeletonProblems, JointsAndNames) {
  EXPECT_THAT(At(WithSkeleton("bones { name: 'hand' }"), "skeleton.bones[2]"), HasSubstr("no joints connect `hand`"));
  EXPECT_THAT(At(WithSkeleton("bones { name: 'ground' }"), "skeleton.bones[2].name"), HasSubstr("does not move"));
  EXPECT_THAT(At(WithSkeleton("joints { name: 'loop' child: 'forearm' }"), "skeleton.joints[2].child"),
              HasSubstr("joints[0]"));
  EXPECT_THAT(At(WithSkeleton("bones { name: 'a' } bones { name: 'b' } joints { name: 'a' parent: 'b' child: 'a' } "
                              "joints { name: 'b' parent: 'a' child: 'b' }"),
                 "skeleton.bones[2]"),
              HasSubstr("form a loop"));
  EXPECT_THAT(At(WithSkeleton("joints { name: 'x' child: 'humerous' }"), "skeleton.joints[2].child"),
              HasSubstr("did you mean 'humerus'"));
  EXPECT_THAT(At(WithSkeleton("coordinates { name: 'unused' }"), "skeleton.coordinates[2]"),
              HasSubstr("moves no joint"));
  EXPECT_THAT(At(WithSkeleton("bones { name: 'x' } joints { name: 'x' child: 'x' "
                              "rotations { axis: [0,0,1] coordinate: 'elbow' } }"),
                 "skeleton.joints[2].rotations[0].coordinate"),
              HasSubstr("another joint"));
  EXPECT_THAT(At(WithSkeleton("bones { name: 'x' } coordinates { name: 'c' } joints { name: 'x' child: 'x' "
                              "rotations { axis: [0,0,1] coordinate: 'c' } rotations { axis: [0,0,-3] "
                              "coordinate: 'c' } }"),
                 "skeleton.joints[2].rotations[1].axis"),
              HasSubstr("same as the axis"));
}

TEST(SkeletonProblems, BodiesThatCannotBe) {
  EXPECT_THAT(
      At(WithSkeleton("bones { name: 'x' mass: 1 inertia: [1, 1, 5, 0, 0, 0] } joints { name: 'x' child: 'x' }"),
         "skeleton.bones[2].inertia"),
      HasSubstr("exceeds the sum"));
  EXPECT_THAT(At(WithSkeleton("bones { name: 'x' inertia: [1, 1, 1, 0, 0, 0] } joints { name: 'x' child: 'x' }"),
                 "skeleton.bones[2].mass"),
              HasSubstr("missing"));
  EXPECT_THAT(
      At(WithSkeleton("bones { name: 'x' mass: nan } joints { name: 'x' child: 'x' }"), "skeleton.bones[2].mass"),
      HasSubstr("finite"));
}

TEST(SkeletonProblems, MusclesAndFunctions) {
  EXPECT_THAT(At(WithSkeleton("muscles { name: 'x' max_isometric_force: 1 points { bone: 'hand' } }"),
                 "skeleton.muscles[2].points[0].bone"),
              HasSubstr("no bone 'hand'"));
  const Problems problems = WithSkeleton(
      "strength: MUSCLE_STRENGTH_FORCE_LENGTH muscles { name: 'x' max_isometric_force: 1 points { condition: 'elbow' } "
      "points { moved { axis: AXIS_X coordinate: 'elbow' function { x: [0, 0] y: [1, 2] } } } "
      "wraps { surface: 'none' } }");
  EXPECT_THAT(At(problems, "skeleton.muscles[2].points[0].range"), HasSubstr("missing"));
  EXPECT_THAT(At(problems, "skeleton.muscles[2].points[1].moved[0].function.x[1]"), HasSubstr("increase"));
  EXPECT_THAT(At(problems, "skeleton.muscles[2].wraps[0].surface"), HasSubstr("no wrap surface"));
  EXPECT_THAT(At(problems, "skeleton.muscles[0].optimal_fibre_length"), HasSubstr("missing"));
  EXPECT_THAT(
      At(WithSkeleton("muscles { name: 'x' max_isometric_force: 1 points { condition: 'elbow' range: [1, 0] } }"),
         "skeleton.muscles[2].points[0].range"),
      HasSubstr("descends"));
  EXPECT_THAT(At(WithSkeleton("bones { name: 'x' shapes { capsule { to: [0, 1, 0] radius: 1 } scale: [1, 1, 2] } } "
                              "joints { name: 'x' child: 'x' }"),
                 "skeleton.bones[2].shapes[0].scale"),
              HasSubstr("belongs to a file"));
}

TEST(SkeletonProblems, Motions) {
  EXPECT_THAT(At(WithSkeleton("motion { coordinates { coordinate: 'elbow' times: [0, 1, 1] values: [0, 1, 2] } }"),
                 "skeleton.motion.coordinates[0].times[2]"),
              HasSubstr("after 1 s"));
  EXPECT_THAT(At(WithSkeleton("motion { low_pass: 6 }"), "skeleton.motion.low_pass"), HasSubstr("without a file"));
  Files files;
  const auto with_file = [&](const std::string& table, const std::string& more = "") {
    return WithSkeleton("motion { file { path: 'a.mot' asset: '" + files.Add(table) + "' } " + more + " }", files);
  };
  const std::string head = "a\ninDegrees=no\nendheader\ntime elbow\n";
  EXPECT_THAT(At(with_file(head + "0 0\n1 130\n"), "skeleton.motion.file"), HasSubstr("inDegrees=yes"));
  EXPECT_THAT(At(with_file("a\nendheader\ntime knee\n0 0\n"), "skeleton.motion.file"), HasSubstr("`knee`"));
  EXPECT_THAT(At(with_file(head + "0 0\n1 1\n1 2\n"), "skeleton.motion.file: a.mot:7"), HasSubstr("does not advance"));
  EXPECT_THAT(At(with_file(head + "0 0\n1 1\n3 2\n", "low_pass: 0.1"), "skeleton.motion.low_pass"), HasSubstr("equal"));
  EXPECT_THAT(At(with_file(head + "0 0\n1 1\n2 2\n", "low_pass: 6"), "skeleton.motion.low_pass"),
              HasSubstr("less than 0.5 Hz"));
}

TEST(SkeletonProblems, DrivesAndBodies) {
  EXPECT_THAT(At(WithSkeleton("drive { distribution { times: [0, 0] } }"), "skeleton.drive.distribution.times[1]"),
              HasSubstr("increase"));
  EXPECT_THAT(At(WithSkeleton("drive { distribution { interval: 1e-6 } }"), "skeleton.drive.distribution.interval"),
              HasSubstr("200,000"));
  EXPECT_THAT(At(WithSkeleton("drive { curves { curves { muscle: 'flexer' curve { times: 0 values: 0 } } } }"),
                 "skeleton.drive.curves.curves[0].muscle"),
              HasSubstr("did you mean 'flexor'"));
  v1::Scene box = BoxScene();
  box.mutable_bodies(0)->mutable_constraints(0)->mutable_motion()->set_bone("humerus");
  box.mutable_bodies(0)->set_activation_muscle("flexor");
  EXPECT_THAT(At(ProblemsOf(box), "bodies[0].constraints[0].motion.bone"), HasSubstr("no bone at all"));
  EXPECT_THAT(At(ProblemsOf(box), "bodies[0].activation_muscle"), HasSubstr("there is no muscle"));
  v1::Scene both = ArmScene();
  both.mutable_bodies()->Add()->CopyFrom(box.bodies(0));
  both.mutable_bodies(0)->mutable_activation()->add_times(0);
  both.mutable_bodies(0)->mutable_activation()->add_values(0);
  EXPECT_THAT(At(ProblemsOf(both), "bodies[0].activation_muscle"), HasSubstr("beside an activation"));
  both.mutable_bodies(0)->clear_activation();
  both.mutable_bodies(0)->set_name("flexor");
  EXPECT_THAT(At(ProblemsOf(both), "skeleton.muscles[0].name"), HasSubstr("a body is called `flexor`"));
}

TEST(SkeletonProblems, ManyEntriesAreRefusedAtOnce) {
  v1::Scene scene = ArmScene();
  for (int k = 0; k < 600; ++k) {
    v1::LineMuscle& muscle = *scene.mutable_skeleton()->add_muscles();
    muscle = scene.skeleton().muscles(0);
    muscle.set_name("m" + std::to_string(k));
  }
  EXPECT_THAT(At(ProblemsOf(scene), "skeleton.muscles"), HasSubstr("at most 500"));
}

}  // namespace
}  // namespace fascicle::server
