// Runs of scenes of the voxel method.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "core/voxel/dynamic_solver.h"
#include "core/voxel/scene_body.h"
#include "tests/support/brick_bodies.h"
#include "tests/support/tet_scenes.h"

namespace fascicle {
namespace {

using namespace fascicle::testing;

constexpr double kYoung = 2e5, kPull = 1000;  // [Pa]
const Vec3 kSize(0.04, 0.01, 0.02);

// A bar on rollers at x = 0, fixed there along its middle line, and pulled at the other end by an increasing traction.
Scene Bar(Material material) {
  Body body = VoxelBox(kSize, {8, 2, 4}, std::move(material));
  const std::vector<Quad> surface = BoundaryQuads(body.voxel().mesh);
  const Vec3 middle(0, 0.005, 0.01);
  body.regions.push_back(SelectRegion(body.voxel().mesh, surface, "middle", SphereSelector{middle, 1e-6}));
  body.regions.push_back(
      SelectRegion(body.voxel().mesh, surface, "line", BoxSelector{Vec3(0, 0.005, 0), Vec3(0, 0.005, 0.02)}));
  body.constraints = {{0, {true, false, false}, {}}, {2, {true, true, true}, {}}, {3, {false, true, false}, {}}};
  body.loads.push_back({1, Traction{Vec3(kPull, 0, 0)}, Curve{{0, 1}, {0, 1}}, {}});
  Scene scene = VoxelScene(std::move(body));
  scene.output.frame_interval = 0.5;
  scene.output.fields = {OutputField::kCauchyStress, OutputField::kVonMisesStress, OutputField::kPressure,
                         OutputField::kVolumeRatio};
  scene.output.probes = {{"corner", 0, static_cast<std::int32_t>(scene.bodies[0].voxel().mesh.nodes.size()) - 1}};
  scene.voxel.tolerance = 1e-12;
  return scene;
}

TEST(VoxelSimulationTest, ABarStretchesAsHookeSays) {
  const Scene scene = Bar(LinearElastic(std::array{kYoung, 0.25}));
  Problems problems;
  CheckScene(scene, problems);
  CheckVoxelSupports(scene, problems);
  ASSERT_TRUE(problems.empty()) << problems.ToString();
  const RunResult run = RunScene(scene);
  ASSERT_EQ(run.outcome.kind, Outcome::Kind::kSucceeded) << run.outcome.failure.message;
  ASSERT_EQ(run.frames.size(), 3u);
  const double strain = kPull / kYoung;
  for (std::size_t f = 0; f < 3; ++f) {
    const double scale = 0.5 * static_cast<double>(f);
    EXPECT_EQ(run.frames[f].time, scale);
    EXPECT_NEAR(run.At(f, "probe/corner/x"), scale * strain * kSize[0], 1e-10 * kSize[0]);
    EXPECT_NEAR(run.At(f, "probe/corner/y"), -scale * 0.25 * strain * kSize[1] / 2, 1e-10 * kSize[0]);
    EXPECT_NEAR(run.At(f, "box/reaction/x0/x") + run.At(f, "box/reaction/middle/x"),
                -scale * kPull * kSize[1] * kSize[2], 1e-8);
    EXPECT_NEAR(run.At(f, "energy/elastic"), 0.5 * scale * scale * kPull * strain * kSize.prod(), 1e-13);
    const std::vector<FieldValues>& fields = run.frames[f].bodies[0].fields;
    for (std::size_t e = 0; e < scene.bodies[0].voxel().mesh.bricks.size(); ++e) {
      EXPECT_NEAR(fields[0].values[6 * e], scale * kPull, 1e-6 * kPull);
      EXPECT_NEAR(fields[0].values[6 * e + 3], 0, 1e-6 * kPull);
      EXPECT_NEAR(fields[1].values[e], scale * kPull, 1e-6 * kPull);
      EXPECT_NEAR(fields[2].values[e], scale * kPull / 3, 1e-6 * kPull);
      EXPECT_NEAR(fields[3].values[e], (1 + scale * strain) * std::pow(1 - 0.25 * scale * strain, 2), 1e-9);
    }
  }
}

// The image is oblique: results rotate with it.
TEST(VoxelSimulationTest, ATurnedGridGivesTheTurnedAnswer) {
  Body body = VoxelBox(kSize, {8, 2, 4}, LinearElastic(std::array{kYoung, 0.25}));
  body.constraints = {{0, {true, true, true}, {}}};
  body.loads.push_back({1, NodalForce{Vec3(0.01, 0.02, -0.03)}, Curve::Constant(1), {}});
  Scene scene = VoxelScene(body);
  scene.output.fields = {OutputField::kCauchyStress};
  scene.voxel.tolerance = 1e-12;
  scene.gravity.acceleration = Vec3(1, 2, 3);
  const RunResult straight = RunScene(scene);

  const Mat3 turn = Eigen::AngleAxisd(0.7, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();
  VoxelGrid grid = body.voxel().mesh.grid;
  grid.direction = turn;
  body.voxel().mesh = MakeBrickMesh(std::move(grid));  // regions keep their numbers
  body.loads[0].kind = NodalForce{turn * Vec3(0.01, 0.02, -0.03)};
  Scene turned_scene = scene;
  turned_scene.bodies = {body};
  turned_scene.gravity.acceleration = turn * scene.gravity.acceleration;
  const RunResult turned = RunScene(turned_scene);

  const BodyFrame& a = straight.frames.back().bodies[0];
  const BodyFrame& b = turned.frames.back().bodies[0];
  for (std::size_t n = 0; n < a.positions.size(); ++n) {
    EXPECT_LT((turn * a.positions[n] - b.positions[n]).norm(), 1e-12);
  }
  const auto stress = [](const BodyFrame& frame, std::size_t e) {
    const double* s = &frame.fields[0].values[6 * e];
    Mat3 sigma;
    sigma << s[0], s[3], s[5], s[3], s[1], s[4], s[5], s[4], s[2];
    return sigma;
  };
  for (std::size_t e = 0; e < body.voxel().mesh.bricks.size(); ++e) {
    EXPECT_LT((turn * stress(a, e) * turn.transpose() - stress(b, e)).norm(), 1e-7 * stress(a, 0).norm());
  }
}

TEST(VoxelSimulationTest, TheGroundBearsTheWeight) {
  Body body = VoxelBox(kSize, {8, 2, 4}, LinearElastic(std::array{kYoung, 0.25}));
  body.constraints = {{0, {true, true, true}, {}}};
  Scene scene = VoxelScene(body);
  scene.gravity.acceleration = Vec3(0, 0, -9.81);
  const RunResult run = RunScene(scene);
  EXPECT_NEAR(run.Last("box/reaction/x0/z"), body.density * kSize.prod() * 9.81, 1e-8);
}

// Both ends rotated by a right angle together: corotated bricks are only rotated, without stress.
TEST(VoxelSimulationTest, CorotatedBricksTurnFreely) {
  Body body = VoxelBox(kSize, {8, 2, 4}, CorotatedLinear(std::array{kYoung, 0.3}));
  Constraint turn = {0, {true, true, true}, {}};
  turn.motion.rotation = Rotation{Vec3(0, 0, 0), Vec3::UnitZ(), Curve{{0, 1}, {0, 1.5}}};
  body.constraints = {turn, turn};
  body.constraints[1].region = 1;
  Scene scene = VoxelScene(body);
  scene.output.frame_interval = 0.1;
  scene.output.fields = {OutputField::kVonMisesStress};
  const RunResult run = RunScene(scene);
  ASSERT_EQ(run.outcome.kind, Outcome::Kind::kSucceeded) << run.outcome.failure.message;
  const Mat3 R = Eigen::AngleAxisd(1.5, Vec3::UnitZ()).toRotationMatrix();
  const BodyFrame& last = run.frames.back().bodies[0];
  for (std::size_t n = 0; n < last.positions.size(); ++n) {
    EXPECT_LT((last.positions[n] - R * body.voxel().mesh.nodes[n]).norm(), 1e-7);
  }
  for (const double stress : last.fields[0].values) EXPECT_LT(stress, 1e-5 * kYoung);
}

Scene Release() {
  Body body = VoxelBox(kSize, {8, 2, 4}, LinearElastic(std::array{kYoung, 0.3}));
  body.constraints = {{0, {true, true, true}, {}}};
  body.loads.push_back({1, NodalForce{Vec3(0, 0.01, 0)}, Curve{{0, 1e-9}, {1, 0}}, {}});
  body.damping.mass_proportional = 10;
  Scene scene = VoxelScene(body);
  scene.voxel.stepping = VoxelStepping::kDynamic;
  scene.voxel.start_loaded = true;
  scene.output.probes = {{"tip", 0, static_cast<std::int32_t>(body.voxel().mesh.nodes.size()) - 1}};
  scene.output.fields = {OutputField::kVelocity};
  return scene;
}

// Released, it vibrates with the lowest natural frequency of its mesh, with decreasing amplitude.
TEST(VoxelSimulationTest, LetGoItSwingsWithItsLowestMode) {
  Scene scene = Release();
  const VoxelSceneBody body(scene, scene.bodies[0]);
  ThreadTeam team(1);
  const VoxelMode mode = LowestMode(body.model(), body.supports(), scene.bodies[0].density, team);
  ASSERT_TRUE(mode.converged);
  const double period = 1 / mode.frequency;
  scene.duration = 3.25 * period;
  scene.output.frame_interval = period / 400;
  const RunResult run = RunScene(scene);
  ASSERT_EQ(run.outcome.kind, Outcome::Kind::kSucceeded) << run.outcome.failure.message;
  // Times at which the tip crosses its rest position downwards.
  std::vector<double> crossings;
  std::vector<double> peaks = {run.At(0, "probe/tip/y")};
  for (std::size_t f = 1; f + 1 < run.frames.size(); ++f) {
    const double before = run.At(f - 1, "probe/tip/y"), now = run.At(f, "probe/tip/y"),
                 after = run.At(f + 1, "probe/tip/y");
    if (before > 0 && now <= 0) {
      crossings.push_back(run.frames[f - 1].time + scene.output.frame_interval * before / (before - now));
    }
    if (now > before && now >= after && now > 0) peaks.push_back(now);
  }
  ASSERT_GE(crossings.size(), 3u);
  // Other modes decay slowly, so the mean period is used; w dt = 2 pi / 400 lengthens it by 1e-4.
  EXPECT_NEAR((crossings.back() - crossings.front()) / static_cast<double>(crossings.size() - 1), period,
              0.01 * period);
  ASSERT_GE(peaks.size(), 3u);
  for (std::size_t k = 1; k < peaks.size(); ++k) EXPECT_LT(peaks[k], peaks[k - 1]);
}

TEST(VoxelSimulationTest, StepsAreThePartsOfFrames) {
  Scene scene = Release();
  scene.duration = 0.01;
  scene.output.frame_interval = 0.005;
  scene.voxel.time_step = 0.0021;
  const RunResult run = RunScene(scene);
  ASSERT_EQ(run.frames.size(), 3u);
  EXPECT_EQ(run.frames.back().step, 6);
  EXPECT_EQ(run.frames.back().time, 0.01);
  EXPECT_DOUBLE_EQ(run.Last("solver/step"), 0.005 / 3);
}

TEST(VoxelSimulationTest, WhatNothingHoldsIsNamed) {
  Scene scene = Bar(LinearElastic(std::array{kYoung, 0.3}));
  scene.bodies[0].constraints.pop_back();
  Problems problems;
  CheckVoxelSupports(scene, problems);
  ASSERT_EQ(problems.count(), 1u) << problems.ToString();
  EXPECT_EQ(problems.kept()[0].path, "bodies[0].constraints");
  EXPECT_THAT(problems.kept()[0].message, ::testing::HasSubstr("turns about i"));
  scene.voxel.stepping = VoxelStepping::kDynamic;
  Problems none;
  CheckVoxelSupports(scene, none);
  EXPECT_TRUE(none.empty());
}

// More parameter sets than a grid has materials: those of one Poisson's ratio are one material.
TEST(VoxelSimulationTest, EveryVoxelMayHaveAStiffnessOfItsOwn) {
  Scene scene = Bar(LinearElastic(std::array{kYoung, 0.25}));
  Body& body = scene.bodies[0];
  // Layers of different stiffness in series along x, each four times.
  double compliance = 0;
  for (std::size_t e = 0; e < body.voxel().mesh.bricks.size(); ++e) {
    const auto layer =
        static_cast<std::int64_t>(std::floor(body.voxel().mesh.nodes[body.voxel().mesh.bricks[e][0]][0] / 0.005 + 0.5));
    body.voxel().materials.more.push_back(LinearElastic(std::array{kYoung * static_cast<double>(1 + layer), 0.0}));
    body.voxel().materials.of.push_back(static_cast<std::int32_t>(body.voxel().materials.more.size()));
  }
  for (int layer = 0; layer < 8; ++layer) compliance += 0.005 / (kYoung * (1 + layer));
  while (body.voxel().materials.more.size() <= 300)
    body.voxel().materials.more.push_back(LinearElastic(std::array{kYoung, 0.1}));
  const RunResult run = RunScene(scene);
  ASSERT_EQ(run.outcome.kind, Outcome::Kind::kSucceeded) << run.outcome.failure.message;
  EXPECT_NEAR(run.Last("probe/corner/x"), kPull * compliance, 1e-7 * kPull * compliance);
}

}  // namespace
}  // namespace fascicle
