// Runs of scenes of the eulerian method.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/eulerian/scene_body.h"
#include "core/eulerian/world.h"
#include "core/scene/rigid_motion.h"
#include "tests/support/eulerian_scenes.h"
#include "tests/support/tet_scenes.h"

namespace fascicle {
namespace {

using namespace fascicle::testing;

// Supported below, pressed from above, pulled sideways by gravity.
Scene Held() {
  Body body = EulerianCube();
  body.constraints = {{0, {true, true, true}, {}}};
  body.loads.push_back({1, Traction{Vec3(0, 0, -100)}, Curve{{0, 0.01}, {0, 1}}, {}});
  Scene scene = EulerianScene({std::move(body)});
  scene.gravity.acceleration = Vec3(5, 0, 0);
  scene.output.fields = {OutputField::kVelocity, OutputField::kCauchyStress, OutputField::kVonMisesStress,
                         OutputField::kPressure, OutputField::kVolumeRatio};
  scene.output.probes = {{"corner", 0, 0}};
  return scene;
}

void ExpectSound(const Scene& scene) {
  Problems problems;
  CheckScene(scene, problems);
  const std::vector<std::string> sources(scene.bodies.size(), "mesh");
  CheckEulerianBodies(scene, sources, 1'000'000, problems);
  EXPECT_TRUE(problems.empty()) << problems.ToString();
}

TEST(EulerianSimulationTest, FramesCarryTheSurfaceAndFieldsAtItsNodes) {
  const Scene scene = Held();
  ExpectSound(scene);
  const RunResult run = RunScene(scene);
  ASSERT_EQ(run.outcome.kind, Outcome::Kind::kSucceeded) << run.outcome.failure.message;
  ASSERT_EQ(run.frames.size(), 5u);
  const std::size_t nodes = scene.bodies[0].surface().mesh.nodes.size();
  EXPECT_EQ(run.frames[0].bodies[0].positions, scene.bodies[0].surface().mesh.nodes);
  for (std::size_t f = 0; f < run.frames.size(); ++f) {
    const BodyFrame& body = run.frames[f].bodies[0];
    EXPECT_DOUBLE_EQ(run.frames[f].time, 0.005 * static_cast<double>(f));
    ASSERT_EQ(body.positions.size(), nodes);
    ASSERT_EQ(body.fields.size(), 5u);
    for (const FieldValues& field : body.fields) {
      EXPECT_EQ(field.location, FieldLocation::kNode) << field.name;
      EXPECT_EQ(field.values.size(), nodes * static_cast<std::size_t>(field.components)) << field.name;
      for (const double value : field.values) ASSERT_TRUE(std::isfinite(value)) << field.name;
    }
    for (const double J : body.fields[4].values) EXPECT_NEAR(J, 1, 0.05);
    EXPECT_NEAR(run.At(f, "cube/volume_ratio"), 1, 1e-3);
    EXPECT_LE(run.At(f, "cube/min_volume_ratio"), run.At(f, "cube/max_volume_ratio"));
  }
  // Stress and the fields derived from it agree.
  const std::vector<FieldValues>& fields = run.frames.back().bodies[0].fields;
  for (std::size_t n = 0; n < nodes; ++n) {
    const double* s = &fields[1].values[6 * n];
    EXPECT_NEAR(fields[3].values[n], (s[0] + s[1] + s[2]) / 3, 1e-9 * (1 + std::abs(fields[3].values[n])));
  }
  EXPECT_GT(run.Last("solver/iterations"), 0);
  EXPECT_GT(run.Last("solver/step"), 0);
}

// The weight of a body on its grid approaches the exact one with the number of cells across.
double MassOnGrid(const Scene& scene) {
  ThreadTeam team(1);
  const EulerianBody body = MakeEulerianBody(scene, scene.bodies[0], team);
  EulerianCells cells;
  UpdateCells(body, BodyStepper(body, team, nullptr).InitialState(), team, cells);
  return scene.bodies[0].density * SolidVolume(body, cells);
}

// After the body has come to rest, the support bears the weight and the traction.
TEST(EulerianSimulationTest, SupportsBearTheLoads) {
  Scene scene = Held();
  scene.gravity.acceleration = Vec3(1, 0, -2);
  scene.bodies[0].damping.mass_proportional = 60;
  scene.duration = 0.4;
  scene.output.frame_interval = 0.1;
  scene.output.fields.clear();
  const RunResult run = RunScene(scene);
  ASSERT_EQ(run.outcome.kind, Outcome::Kind::kSucceeded) << run.outcome.failure.message;
  const double mass = MassOnGrid(scene), press = 100 * 0.05 * 0.05;
  EXPECT_NEAR(mass, 1000 * std::pow(0.05, 3), 0.1 * mass);
  EXPECT_NEAR(run.Last("cube/reaction/low/x"), -mass, 0.01 * mass);
  EXPECT_NEAR(run.Last("cube/reaction/low/y"), 0, 0.01 * mass);
  EXPECT_NEAR(run.Last("cube/reaction/low/z"), 2 * mass + press, 0.01 * press);
}

// A rotating support moves the material in it, and the rest follows.
TEST(EulerianSimulationTest, SupportsMove) {
  Body body = EulerianCube();
  Constraint low = {0, {true, true, true}, {}};
  low.motion.translation[0] = Curve{{0, 0.1}, {0, 0.01}};
  low.motion.rotation = Rotation{Vec3(0.028, 0.028, 0), Vec3::UnitZ(), Curve{{0, 0.1}, {0, 0.3}}};
  body.constraints = {low};
  body.damping.mass_proportional = 100;
  Scene scene = EulerianScene({body});
  scene.duration = 0.3;
  scene.output.frame_interval = 0.1;
  const RunResult run = RunScene(scene);
  ASSERT_EQ(run.outcome.kind, Outcome::Kind::kSucceeded) << run.outcome.failure.message;
  const RigidMotion end = MotionAt(low.motion, 0.1);
  for (std::size_t n = 0; n < body.surface().mesh.nodes.size(); ++n) {
    const Vec3& X = body.surface().mesh.nodes[n];
    const double off = (run.frames.back().bodies[0].positions[n] - end.PositionOf(X)).norm();
    EXPECT_LT(off, (X[2] < 0.01 ? 0.05 : 0.15) * kCell) << n;
  }
}

TEST(EulerianSimulationTest, CheckpointsFitTheirSceneOnly) {
  Scene scene = Held();
  scene.duration = scene.output.frame_interval;
  const RunResult run = RunScene(scene);
  const auto takes = [&](const Scene& other) {
    return Simulation(std::make_shared<Scene>(other), 1).Restore(run.checkpoints.back());
  };
  EXPECT_TRUE(takes(scene));
  std::vector<Scene> others(6, scene);
  others[0].eulerian.cell_size *= 1.01;
  others[1].eulerian.volume = VolumeTreatment::kNone;
  others[2].bodies[0].surface().plasticity = Plasticity{1e3, 0};
  others[3].squeezes.push_back({});
  others[4].bodies[0].surface().mesh.nodes[0][0] += 1e-6;
  others[5].eulerian.maccormack = true;
  for (std::size_t k = 0; k < others.size(); ++k) EXPECT_FALSE(takes(others[k])) << k;
}

// A body that reaches the boundary of its grid ends the run, with advice.
TEST(EulerianSimulationTest, LeavingTheGridIsAFailureWithAdvice) {
  Scene scene = EulerianScene({EulerianCube()});
  scene.gravity.acceleration = Vec3(0, 0, -50);
  scene.duration = 0.2;
  const RunResult run = RunScene(scene);
  ASSERT_EQ(run.outcome.kind, Outcome::Kind::kFailed);
  EXPECT_EQ(run.outcome.failure.reason, "LEFT_GRID");
  EXPECT_EQ(run.outcome.failure.object, "cube");
  EXPECT_THAT(run.outcome.failure.advice, ::testing::HasSubstr("margin"));
  EXPECT_GT(run.outcome.failure.time, 0.01);
  EXPECT_GE(run.frames.size(), 3u);
}

// Compressed beyond its yield stress, a plastic cube keeps another shape with the same volume; an elastic cube
// recovers.
TEST(EulerianSimulationTest, PlasticFlowStays) {
  // The mean distance between opposite nodes: such a cube may rotate onto an edge, where it is thinner.
  const auto width = [](bool plastic) {
    Body body = EulerianCube();
    if (plastic) body.surface().plasticity = Plasticity{300, 0};
    body.damping.mass_proportional = 30;
    Scene scene = EulerianScene({std::move(body)});
    scene.squeezes.push_back({Vec3::Constant(0.028), Vec3::UnitX(), 6e4, 0.01, Curve{{0.08, 0.09}, {1, 0}}});
    scene.duration = 0.3;
    scene.output.frame_interval = 0.1;
    const RunResult run = RunScene(scene);
    EXPECT_EQ(run.outcome.kind, Outcome::Kind::kSucceeded) << run.outcome.failure.message;
    EXPECT_NEAR(run.Last("cube/volume_ratio"), 1, 0.01);
    const std::vector<Vec3>& X = scene.bodies[0].surface().mesh.nodes;
    const std::vector<Vec3>& x = run.frames.back().bodies[0].positions;
    double sum = 0;
    int count = 0;
    for (std::size_t a = 0; a < X.size(); ++a) {
      for (std::size_t b = 0; b < X.size(); ++b) {
        if ((X[b] - X[a] - Vec3(0.05, 0, 0)).norm() > 1e-9) continue;
        sum += (x[b] - x[a]).norm();
        ++count;
      }
    }
    return sum / count;
  };
  EXPECT_NEAR(width(false), 0.05, 0.002);
  EXPECT_LT(width(true), 0.045);
}

// The same equilibrium in fewer steps.
TEST(EulerianSimulationTest, StiffBodiesTakeLongStepsImplicitly) {
  Scene scene = Held();
  scene.bodies[0].material = NeoHookean(std::array{1e5, 0.3});
  scene.bodies[0].damping.mass_proportional = 200;
  scene.output.fields.clear();
  scene.duration = 0.1;
  scene.output.frame_interval = 0.05;
  const RunResult explicitly = RunScene(scene);
  scene.eulerian.implicit_elasticity = true;
  const RunResult implicitly = RunScene(scene);
  ASSERT_EQ(explicitly.outcome.kind, Outcome::Kind::kSucceeded) << explicitly.outcome.failure.message;
  ASSERT_EQ(implicitly.outcome.kind, Outcome::Kind::kSucceeded) << implicitly.outcome.failure.message;
  EXPECT_LT(4 * implicitly.frames.back().step, explicitly.frames.back().step);
  const std::vector<Vec3>& rest = scene.bodies[0].surface().mesh.nodes;
  double most = 0, off = 0;
  for (std::size_t n = 0; n < rest.size(); ++n) {
    const Vec3& x = explicitly.frames.back().bodies[0].positions[n];
    most = std::max(most, (x - rest[n]).norm());
    off = std::max(off, (implicitly.frames.back().bodies[0].positions[n] - x).norm());
  }
  EXPECT_LT(off, 0.03 * most);
}

TEST(EulerianSimulationTest, TheRunEndsWhereNothingMoves) {
  Scene scene = EulerianScene({EulerianCube()});
  scene.output.settle_speed = 1e-6;
  const RunResult run = RunScene(scene);
  ASSERT_EQ(run.outcome.kind, Outcome::Kind::kSucceeded);
  EXPECT_LT(run.frames.size(), 5u);
}

}  // namespace
}  // namespace fascicle
