// Inputs change the controls of a scene; runs tell what they do.
#include "core/sim/steering.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/sim/control_source.h"
#include "tests/support/tet_scenes.h"

namespace fascicle {
namespace {

using namespace fascicle::testing;

constexpr ControlKind kLoadControl = ControlKind::kLoad;

double FactorAt(const SteeringTable& table, double time) { return table.At(kLoadControl, 0, time, {1, 0}).value; }

TEST(SteeringTest, ControlsGoToTheirNewValuesInProportionToTheTime) {
  SteeringTable table;
  table.Add({1, {{kLoadControl, 0, 3}}, 0.5}, 1);
  EXPECT_EQ(FactorAt(table, 1), 1);
  EXPECT_EQ(FactorAt(table, 1.25), 2);
  EXPECT_EQ(table.At(kLoadControl, 0, 1.25, {1, 0}).rate, 4);
  EXPECT_EQ(FactorAt(table, 1.5), 3);
  EXPECT_EQ(table.At(kLoadControl, 0, 1.5, {1, 0}).rate, 0);
  EXPECT_EQ(table.At(kLoadControl, 1, 1.5, {1, 0}).value, 1) << "another load";
  EXPECT_FALSE(table.RestsAt(1.4));
  EXPECT_TRUE(table.RestsAt(1.5));
}

TEST(SteeringTest, AnInputMayComeBeforeTheLastOneIsComplete) {
  SteeringTable table;
  table.Add({1, {{kLoadControl, 0, 3}}, 1}, 0);
  table.Add({2, {{kLoadControl, 0, 0}}, 1}, 0.5);
  EXPECT_EQ(FactorAt(table, 0.5), 2);
  EXPECT_EQ(FactorAt(table, 0.75), 0.75 * 2.5);
  const double rate = table.At(kLoadControl, 0, 0.75, {1, 0}).rate;
  EXPECT_NEAR(rate, (FactorAt(table, 0.7501) - FactorAt(table, 0.7499)) / 2e-4, 1e-6);
  EXPECT_EQ(FactorAt(table, 1.5), 0);
  table.Add({3, {{kLoadControl, 0, 5}}, 0}, 0.6);
  EXPECT_EQ(FactorAt(table, 0.6), 5) << "at once";
}

TEST(SteeringTest, WhatIsOverIsForgottenAndTheRestIsSaved) {
  SteeringTable table, kept;
  for (int k = 0; k < 100; ++k) {
    table.Add({k + 1, {{kLoadControl, 0, 0.1 * k}, {ControlKind::kMotion, 2, 0.2 * k}}, 0.05}, 0.02 * k);
    table.DiscardBefore(0.02 * k);
    kept.Add({k + 1, {{kLoadControl, 0, 0.1 * k}, {ControlKind::kMotion, 2, 0.2 * k}}, 0.05}, 0.02 * k);
  }
  ArchiveWriter writer("table", 1);
  table.Save(writer);
  const std::string bytes = writer.Finish();
  EXPECT_LT(bytes.size(), 600u) << "it has not kept all";
  SteeringTable loaded;
  ArchiveReader reader(bytes, "table", 1);
  loaded.Load(reader);
  EXPECT_TRUE(reader.AtEnd());
  for (double time = 0.02 * 99; time < 2.2; time += 0.001) {
    EXPECT_EQ(FactorAt(loaded, time), FactorAt(kept, time)) << time;
    EXPECT_EQ(loaded.At(ControlKind::kMotion, 2, time, {1, 0}).rate,
              kept.At(ControlKind::kMotion, 2, time, {1, 0}).rate);
  }
}

Scene SteeredScene() {
  Body body = BoxBody(Vec3(0.03, 0.02, 0.02), {3, 2, 2}, Muscle(std::array{5e2, 5e2, 1e5, 3e4, 1.2, 0.05, 6.6, 1.4}));
  body.tet().fibres = ConstantFibres(body.tet().mesh, Vec3::UnitX());
  body.constraints = {Fix(kX0), Fix(kX1)};
  body.constraints[1].motion.translation[1] = Curve{{0, 1}, {0, 0.02}};
  body.constraints[1].motion.rotation = Rotation{Vec3::Zero(), Vec3::UnitX(), Curve{{0, 1}, {0, 0.6}}};
  body.loads = {{kY1, NodalForce{Vec3(0, 0, -0.01)}, Curve::Constant(4), {}}};
  body.activation = Curve::Constant(0.25);
  Scene scene = OneBody(body);
  scene.gravity = {Vec3(0, 0, -9), Curve{{0, 1}, {0, 1}}};
  return scene;
}

TEST(SteeringTest, EveryControlOfASceneCanBeChanged) {
  const Scene scene = SteeredScene();
  ControlSource source(scene);
  source.Steer({1,
                {{ControlKind::kActivation, 0, 0.75},
                 {kLoadControl, 0, 0.5},
                 {ControlKind::kGravity, 0, 2},
                 {ControlKind::kMotion, 1, 3}},
                0.5},
               0);
  const Controls half = source.At(0.25), all = source.At(0.5);
  EXPECT_EQ(half.activations[0], 0.5);
  EXPECT_EQ(all.activations[0], 0.75);
  EXPECT_EQ(all.load_scales[0], 2);
  EXPECT_EQ(all.gravity_scale, 1);
  EXPECT_EQ(all.motions[1].translation[1], 0.03);
  EXPECT_NEAR(all.motions[1].angular_velocity[0], 1.8, 1e-15);
  EXPECT_NEAR(Eigen::AngleAxisd(all.motions[1].rotation).angle(), 0.9, 1e-12);
  EXPECT_EQ(half.motions[1].translation[1], 0.01);
  EXPECT_EQ(half.motions[1].velocity[1], 2 * 0.02 + 4 * 0.005) << "the factor grows, too";
  EXPECT_FALSE(source.RestsAt(0.4));
}

// Inputs at steps 1 and 40.
struct TwoInputs final : SteeringSource {
  std::vector<SteeringInput> Take(std::int64_t step, double) override {
    if (step == 1) return {{1, {{ControlKind::kGravity, 0, 2}}, 0}};
    if (step == 40) return {{2, {{ControlKind::kGravity, 0, 0}}, 0}};
    return {};
  }
  bool TryClose() override { return true; }
};

TEST(RunLogTest, TellsStepsFramesAndInputsInFewLines) {
  Scene scene = SteeredScene();
  scene.tet.time_step = 1e-5;
  scene.duration = 0.02;
  scene.output.frame_interval = 0.01;
  struct Sink : CollectingSink {
    void PutLine(std::int64_t number, LogLine line) override {
      EXPECT_EQ(number, static_cast<std::int64_t>(lines.size()));
      lines.push_back(std::move(line));
    }
    std::vector<LogLine> lines;
  } sink;
  TwoInputs inputs;
  Simulation simulation(std::make_shared<Scene>(scene), 1);
  ASSERT_EQ(simulation.Run(sink, {}, std::chrono::seconds(2), &inputs).kind, Outcome::Kind::kSucceeded);
  std::int64_t steps = 0, steps_of_frames = 0;
  std::vector<std::int64_t> taken;
  for (const LogLine& line : sink.lines) {
    if (line.kind == LogLine::Kind::kStep) steps += line.steps;
    if (line.kind == LogLine::Kind::kFrame) steps_of_frames += line.steps;
    if (line.kind == LogLine::Kind::kInput) taken.push_back(line.step);
  }
  EXPECT_EQ(taken, (std::vector<std::int64_t>{1, 40}));
  EXPECT_EQ(steps_of_frames, sink.progress.step);
  EXPECT_GE(steps_of_frames, 2000);
  EXPECT_EQ(steps, steps_of_frames) << "1,000 has a line";
  EXPECT_LT(sink.lines.size(), 90u);
  EXPECT_EQ(sink.lines.back().kind, LogLine::Kind::kFrame);
  EXPECT_EQ(sink.lines.back().frame, 2);
}

TEST(RunLogTest, TellsCutsResidualsAndTheFailure) {
  Scene scene = SteeredScene();
  scene.bodies[0].constraints[1].motion.translation[0] = Curve{{0, 1}, {0, -0.04}};  // beyond the other end
  scene.tet.stepping = Stepping::kQuasiStatic;
  scene.duration = 1;
  scene.output.frame_interval = 0.5;
  struct Sink : CollectingSink {
    void PutLine(std::int64_t, LogLine line) override { lines.push_back(std::move(line)); }
    std::vector<LogLine> lines;
  } sink;
  ASSERT_EQ(Simulation(std::make_shared<Scene>(scene), 1).Run(sink, {}).kind, Outcome::Kind::kFailed);
  int cuts = 0, residuals = 0;
  for (const LogLine& line : sink.lines) {
    cuts += line.kind == LogLine::Kind::kCut;
    residuals += line.kind == LogLine::Kind::kStep && line.residual >= 0 && line.residual < 1e-6 && line.iterations > 0;
  }
  EXPECT_GT(cuts, 0);
  EXPECT_GT(residuals, 0);
  EXPECT_EQ(sink.lines.back().kind, LogLine::Kind::kFailure);
}

}  // namespace
}  // namespace fascicle
