// Runs whose activations, loads and motions are changed on the way: the same bits after any interruption, in every
// method and stepping.
#include <gtest/gtest.h>

#include <map>
#include <random>

#include "small_scenes.h"

namespace fascicle {
namespace {

using namespace fascicle::testing;

// Gives the inputs of a table.
class Script final : public SteeringSource {
 public:
  explicit Script(std::map<std::int64_t, SteeringInput> inputs, std::int64_t begin = 0) : inputs_(std::move(inputs)) {
    inputs_.erase(inputs_.begin(), inputs_.upper_bound(begin));
  }
  std::vector<SteeringInput> Take(std::int64_t step, double) override {
    std::vector<SteeringInput> due;
    while (!inputs_.empty() && inputs_.begin()->first <= step) {
      due.push_back(inputs_.extract(inputs_.begin()).mapped());
    }
    return due;
  }
  bool TryClose() override { return inputs_.empty(); }

 private:
  std::map<std::int64_t, SteeringInput> inputs_;  // by step
};

struct SteeredRun {
  Outcome outcome;
  std::vector<Frame> frames;
  std::vector<std::string> checkpoints;
  std::map<std::int64_t, std::string> log;  // by number
};

std::string TextOf(const LogLine& line) {
  char numbers[160];
  std::snprintf(numbers, sizeof numbers, "%d %lld %a %lld %a %lld %lld %a %lld %lld ", static_cast<int>(line.kind),
                static_cast<long long>(line.step), line.time, static_cast<long long>(line.steps), line.time_step,
                static_cast<long long>(line.iterations), static_cast<long long>(line.cuts), line.residual,
                static_cast<long long>(line.frame), static_cast<long long>(line.sequence));
  return numbers + line.text;
}

struct LoggingSink : CollectingSink {
  void PutLine(std::int64_t number, LogLine line) override { log[number] = TextOf(line); }
  std::map<std::int64_t, std::string> log;
};

SteeredRun RunSteered(const Scene& scene, const std::map<std::int64_t, SteeringInput>& inputs,
                      const std::string& checkpoint = {}) {
  Simulation simulation(std::make_shared<Scene>(scene), 2);
  if (!checkpoint.empty()) {
    EXPECT_TRUE(simulation.Restore(checkpoint));
  }
  Script script(inputs, simulation.step());
  LoggingSink sink;
  SteeredRun run;
  run.outcome = simulation.Run(sink, {}, std::chrono::milliseconds(0), &script);
  run.frames = std::move(sink.frames);
  run.checkpoints = std::move(sink.checkpoints);
  run.log = std::move(sink.log);
  return run;
}

// Every control of the scene is changed, some of them twice; mild enough for every method.
std::map<std::int64_t, SteeringInput> InputsFor(const Scene& scene, std::int64_t steps, std::mt19937& random) {
  std::int32_t loads = 0, motions = 0;
  for (const Body& body : scene.bodies) {
    loads += static_cast<std::int32_t>(body.loads.size());
    motions += static_cast<std::int32_t>(body.constraints.size());
  }
  std::map<std::int64_t, SteeringInput> inputs;
  for (int k = 1; k <= 6; ++k) {
    std::uniform_real_distribution<double> part(0, 1);
    SteeringInput input;
    input.sequence = k;
    input.ramp = k % 3 == 0 ? 0 : scene.output.frame_interval;
    input.controls.push_back({ControlKind::kGravity, 0, 1 + part(random)});
    if (scene.method != Method::kVoxel) {
      input.controls.push_back(
          {ControlKind::kActivation, scene.bodies.size() > 1 && scene.method == Method::kEulerian, 0.3 * part(random)});
    }
    if (loads > 0) input.controls.push_back({ControlKind::kLoad, 0, 1 - part(random)});
    if (motions > 0) input.controls.push_back({ControlKind::kMotion, motions - 1, 1 + 0.1 * part(random)});
    if (!scene.squeezes.empty()) input.controls.push_back({ControlKind::kForceField, 0, 1 - 0.5 * part(random)});
    inputs[1 + static_cast<std::int64_t>(random() % static_cast<unsigned>(steps))] = input;
  }
  return inputs;
}

bool IsTried(const NamedScene& named) {
  for (const char* name : {"tet_explicit_linear", "tet_mixed_linear", "tet_backward_euler_linear", "tet_newmark_linear",
                           "tet_bdf2_linear", "tet_quasi_static_quadratic", "voxel_static", "voxel_corotated_dynamic",
                           "eulerian_preserved", "eulerian_implicit"}) {
    if (named.name == name) return true;
  }
  return false;
}

std::vector<NamedScene> TriedScenes() {
  std::vector<NamedScene> scenes = SmallScenes();
  std::erase_if(scenes, [](const NamedScene& named) { return !IsTried(named); });
  for (NamedScene& named : scenes) named.scene.duration /= 2;
  return scenes;
}

class SteeredRunsTest : public ::testing::TestWithParam<NamedScene> {};

TEST_P(SteeredRunsTest, TheSameBitsAfterAnyInterruption) {
  const Scene& scene = GetParam().scene;
  const SteeredRun plain = RunSteered(scene, {});
  ASSERT_EQ(plain.outcome.kind, Outcome::Kind::kSucceeded) << plain.outcome.failure.message;
  std::mt19937 random(7);
  const std::map<std::int64_t, SteeringInput> inputs = InputsFor(scene, plain.frames[3].step, random);
  const SteeredRun steered = RunSteered(scene, inputs);
  ASSERT_EQ(steered.outcome.kind, Outcome::Kind::kSucceeded) << steered.outcome.failure.message;
  ASSERT_EQ(steered.frames.size(), plain.frames.size());
  EXPECT_NE(steered.frames.back().digest, plain.frames.back().digest);
  for (const std::size_t frame : {1, 3}) {
    const SteeredRun again = RunSteered(scene, inputs, steered.checkpoints[frame]);
    ASSERT_EQ(again.frames.size(), steered.frames.size() - frame - 1);
    for (std::size_t k = 0; k < again.frames.size(); ++k) {
      ASSERT_EQ(again.frames[k].digest, steered.frames[frame + 1 + k].digest) << "frame " << frame + 1 + k;
    }
    ASSERT_FALSE(again.log.empty());
    for (const auto& [number, text] : again.log) {
      ASSERT_TRUE(steered.log.contains(number)) << number;
      EXPECT_EQ(text, steered.log.at(number)) << number;
    }
    EXPECT_EQ(again.log.rbegin()->first, steered.log.rbegin()->first) << "no line is lost";
  }
  // Every frame before the first input is that of the plain run.
  for (std::size_t k = 0; plain.frames[k].step < inputs.begin()->first; ++k) {
    EXPECT_EQ(plain.frames[k].digest, steered.frames[k].digest) << k;
  }
  // An input that takes effect a step late would be seen.
  std::map<std::int64_t, SteeringInput> late = inputs;
  late[inputs.begin()->first + 1] = late.extract(late.begin()).mapped();
  EXPECT_NE(RunSteered(scene, late).frames.back().digest, steered.frames.back().digest);
}

INSTANTIATE_TEST_SUITE_P(Methods, SteeredRunsTest, ::testing::ValuesIn(TriedScenes()),
                         [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace fascicle
