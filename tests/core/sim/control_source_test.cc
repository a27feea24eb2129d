// Controls: evaluated from the curves of a scene, or set by the caller.
#include "core/sim/control_source.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>

#include "core/sim/method_run.h"
#include "same_bits.h"
#include "tests/support/brick_bodies.h"
#include "tests/support/eulerian_scenes.h"
#include "tests/support/tet_scenes.h"

namespace fascicle {
namespace {

using namespace fascicle::testing;

Body MuscleBox() {
  Body body = BoxBody(Vec3(0.03, 0.02, 0.02), {3, 2, 2}, Muscle(std::array{5e2, 5e2, 1e5, 3e4, 1.2, 0.05, 6.6, 1.4}));
  body.tet().fibres = ConstantFibres(body.tet().mesh, Vec3::UnitX());
  body.constraints = {Fix(kX0)};
  body.loads = {{kX1, NodalForce{Vec3(0, 0, -0.01)}, Curve::Constant(0), {}}};
  return body;
}

// Two bodies, with two activations in the first.
Scene TwoBodies() {
  Body first = MuscleBox(), second = MuscleBox();
  first.activation = Curve{{0, 1}, {0, 0.4}};
  first.tet().activations.more = {Curve::Constant(0.7)};
  first.tet().activations.of.assign(first.tet().mesh.tetrahedra.size(), 1);
  first.loads.push_back({kX1, Traction{Vec3(1, 0, 0)}, Curve{{0, 1}, {0, 3}}, {}});
  second.name = "second";
  second.activation = Curve::Constant(0.9);
  second.loads[0].scale = Curve{{0, 1}, {1, 5}};
  second.constraints.push_back(Fix(kX1));
  second.constraints[1].motion.translation[1] = Curve{{0, 1}, {0, 0.02}};
  Scene scene = OneBody(first);
  scene.bodies.push_back(second);
  scene.gravity = {Vec3(0, 0, -9), Curve{{0, 1}, {0, 1}}};
  return scene;
}

TEST(ControlSourceTest, EvaluatesAllCurvesInTheOrderOfTheScene) {
  const Scene scene = TwoBodies();
  ControlSource source(scene);
  const Controls half = source.At(0.5);
  EXPECT_EQ(half.time, 0.5);
  EXPECT_EQ(half.activations, (std::vector{0.2, 0.7, 0.9}));
  EXPECT_EQ(half.load_scales, (std::vector{0.0, 1.5, 3.0}));
  EXPECT_EQ(half.gravity_scale, 0.5);
  ASSERT_EQ(half.motions.size(), 3u);
  EXPECT_EQ(half.motions[2].translation, Vec3(0, 0.01, 0));
  EXPECT_EQ(half.motions[2].velocity, Vec3(0, 0.02, 0));

  const BodyControls of_second = ControlsOf(scene, 1, half);
  ASSERT_EQ(of_second.activations.size(), 1u);
  EXPECT_EQ(of_second.activations[0], 0.9);
  ASSERT_EQ(of_second.load_scales.size(), 1u);
  EXPECT_EQ(of_second.load_scales[0], 3);
  ASSERT_EQ(of_second.motions.size(), 2u);
  EXPECT_EQ(of_second.motions[1].translation, Vec3(0, 0.01, 0));
}

TEST(ControlSourceTest, RestsOnceNoCurveChanges) {
  const auto ends_at = [](const Scene& scene, double end) {
    ControlSource source(scene);
    return source.RestsAt(end) && !source.RestsAt(std::nexttoward(end, 0));
  };
  EXPECT_TRUE(ends_at(TwoBodies(), 1));
  const Curve late{{0, 7}, {0, 0.5}};
  for (int k = 0; k < 5; ++k) {
    Scene scene = TwoBodies();
    Body& body = scene.bodies[1];
    if (k == 0) scene.gravity.scale = late;
    if (k == 1) body.activation = late;
    if (k == 2) body.loads[0].scale = late;
    if (k == 3) body.constraints[1].motion.rotation = Rotation{Vec3::Zero(), Vec3::UnitX(), late};
    if (k == 4) scene.bodies[0].tet().activations.more[0] = late;
    EXPECT_TRUE(ends_at(scene, 7)) << k;
  }
  // A curve of one point is constant, wherever the point is.
  Scene constant = TwoBodies();
  constant.gravity.scale = {{5}, {1}, Curve::Interpolation::kLinear};
  EXPECT_TRUE(ends_at(constant, 1));
}

// A muscle's activation follows from its excitation, and its force across a joint from the joint's motion.
Scene Driven() {
  Scene scene = TwoBodies();
  scene.bodies[1].excitation = Excitation{Curve{{0, 0.01, 0.3, 0.31}, {0, 1, 1, 0}}, {}};
  scene.bodies[1].loads[0].stern =
      SternPull{{0.25, 0.04, 800, 1.7, 0.6}, {Curve{{0, 0.5}, {2.4, 1.6}}, Curve::Constant(0.5)}};
  scene.duration = 2;
  return scene;
}

TEST(ControlSourceTest, IntegratesTheDynamicsOfMuscles) {
  const Scene scene = Driven();
  ControlSource source(scene);
  const SternPull& pull = *scene.bodies[1].loads[0].stern;
  for (const double time : {0.0, 0.05, 0.2, 0.4}) {
    const Controls controls = source.At(time);
    IntegratedActivation activation(scene.bodies[1].excitation->curve, {}, 2);
    EXPECT_EQ(controls.activations[2], activation.At(time));
    EXPECT_NEAR(controls.load_scales[2],
                ForceOf(pull.muscle, pull.drive.angle.At(time), pull.drive.angle.RateAt(time), 0.5), 2e-4 * 800);
  }
  EXPECT_GT(source.At(0.2).activations[2], 0.9);
  EXPECT_FALSE(source.RestsAt(1));
}

TEST(ControlSourceTest, GoesOnWhereItWasSaved) {
  const Scene scene = Driven();
  ControlSource whole(scene), first(scene), second(scene);
  first.At(0.12);
  first.DiscardBefore(0.1);
  ArchiveWriter writer("controls", 1);
  first.Save(writer);
  const std::string bytes = writer.Finish();
  ArchiveReader archive(bytes, "controls", 1);
  second.Load(archive);
  ASSERT_TRUE(archive.AtEnd());
  for (double time = 0.1; time < 1; time += 0.013) {
    EXPECT_EQ(second.At(time).activations, whole.At(time).activations) << time;
    EXPECT_EQ(second.At(time).load_scales, whole.At(time).load_scales) << time;
  }
}

// Frames of a run with muscle dynamics, for any number of threads and through a checkpoint.
TEST(ControlSourceTest, ARunWithDynamicsHasTheSameBits) {
  Scene scene = Driven();
  scene.duration = 0.05;
  scene.output.frame_interval = 0.01;
  ExpectAnyThreadsAndRestartsGiveTheSameBits(scene, 6);
}

// The frame after some steps with the controls of the scene's curves, as `steer` leaves them.
std::vector<BodyFrame> Stepped(const Scene& scene, const std::function<void(Controls&)>& steer) {
  ThreadTeam team(1);
  const auto method = MakeMethodRun(scene, team, nullptr);
  ControlSource source(scene);
  const auto controls_at = [&](double time) {
    Controls controls = source.At(time);
    steer(controls);
    return controls;
  };
  Controls now = controls_at(0);
  method->Start(now);
  EXPECT_EQ(method->SolveStart(now).problem, StepProblem::kNone);
  const double end = 2 * scene.output.frame_interval;
  while (method->clock().time < end) {
    const StepProposal step = method->ProposeStep(now, end);
    Controls next = controls_at(step.time);
    const StepOutcome outcome = method->Step(now, next, step.dt);
    if (outcome.try_shorter) continue;
    EXPECT_EQ(outcome.problem, StepProblem::kNone);
    if (outcome.problem != StepProblem::kNone) break;
    now = next;
  }
  return method->MeasureBodies(now, now);
}

struct Steered {
  const char* name;
  Scene (*scene)();
  std::function<void(Scene&)> by_curves;
  std::function<void(Controls&)> by_hand;
};

class SteeredTest : public ::testing::TestWithParam<Steered> {};

// A control set by the caller has the same effect as a curve of that value, with the same bits, and it has an effect.
TEST_P(SteeredTest, ControlsComeFromAnywhere) {
  const Scene rests = GetParam().scene();
  Scene curves = rests;
  GetParam().by_curves(curves);
  const std::vector<BodyFrame> by_curves = Stepped(curves, [](Controls&) {});
  const std::vector<BodyFrame> by_hand = Stepped(rests, GetParam().by_hand);
  const std::vector<BodyFrame> neither = Stepped(rests, [](Controls&) {});
  EXPECT_EQ(by_hand[0].positions, by_curves[0].positions);
  EXPECT_NE(by_hand[0].positions, neither[0].positions);
}

Scene TetScene(Stepping stepping) {
  Scene scene = OneBody(MuscleBox());
  scene.tet.stepping = stepping;
  scene.output.frame_interval = 0.01;
  return scene;
}

Scene VoxelBar() {
  Body body = VoxelBox(Vec3(0.04, 0.01, 0.02), {8, 2, 4}, LinearElastic(std::array{2e5, 0.25}));
  body.constraints = {{0, {true, true, true}, {}}};
  body.loads.push_back({1, Traction{Vec3(0, 0, 100)}, Curve::Constant(0), {}});
  return VoxelScene(std::move(body));
}

Scene EulerianMuscle() {
  Body body = EulerianCube();
  body.material = Muscle(std::array{1e3, 0.0, 1e5, 1e4, 1.0, 0.05, 6.6, 1.4, 0.0, 0.25, 1.4});
  body.surface().fibres = {Vec3::UnitX()};
  body.constraints = {{0, {true, true, true}, {}}};
  Scene scene = EulerianScene({std::move(body)});
  scene.squeezes.push_back({Vec3::Constant(0.03), Vec3::UnitX(), 1e4, 0.01, Curve::Constant(0)});
  return scene;
}

const auto kActivate = [](Scene& scene) { scene.bodies[0].activation = Curve::Constant(0.5); };
const auto kActivateByHand = [](Controls& controls) { controls.activations[0] = 0.5; };
const auto kLoad = [](Scene& scene) { scene.bodies[0].loads[0].scale = Curve::Constant(2); };
const auto kLoadByHand = [](Controls& controls) { controls.load_scales[0] = 2; };
const auto kMove = [](Scene& scene) { scene.bodies[0].constraints[0].motion.translation[1] = Curve{{0, 1}, {0, 0.1}}; };
const auto kMoveByHand = [](Controls& controls) {
  controls.motions[0].translation = Vec3(0, Curve{{0, 1}, {0, 0.1}}.At(controls.time), 0);
  controls.motions[0].velocity = Vec3(0, Curve{{0, 1}, {0, 0.1}}.RateAt(controls.time), 0);
};

INSTANTIATE_TEST_SUITE_P(
    Methods, SteeredTest,
    ::testing::Values(
        Steered{"explicit_activation", [] { return TetScene(Stepping::kExplicit); }, kActivate, kActivateByHand},
        Steered{"explicit_motion", [] { return TetScene(Stepping::kExplicit); }, kMove, kMoveByHand},
        Steered{"newton_activation", [] { return TetScene(Stepping::kQuasiStatic); }, kActivate, kActivateByHand},
        Steered{"newton_load", [] { return TetScene(Stepping::kBackwardEuler); }, kLoad, kLoadByHand},
        Steered{"voxel_load", VoxelBar, kLoad, kLoadByHand}, Steered{"voxel_motion", VoxelBar, kMove, kMoveByHand},
        Steered{"eulerian_activation", EulerianMuscle, kActivate, kActivateByHand},
        Steered{"eulerian_motion", EulerianMuscle, kMove, kMoveByHand},
        Steered{"eulerian_field", EulerianMuscle, [](Scene& scene) { scene.squeezes[0].scale = Curve::Constant(0.5); },
                [](Controls& controls) { controls.force_field_scales[0] = 0.5; }}),
    [](const auto& tested) { return std::string(tested.param.name); });

}  // namespace
}  // namespace fascicle
