// The same bits for any number of threads, and after any interruption.
#include <gtest/gtest.h>

#include <random>
#include <set>

#include "small_scenes.h"

namespace fascicle {
namespace {

using namespace fascicle::testing;

// Sanitized programs are at least ten times slower.
#ifdef FASCICLE_SANITIZED
constexpr bool kSlow = true;
#else
constexpr bool kSlow = false;
#endif

std::vector<Digest> DigestsOf(const std::vector<Frame>& frames) {
  std::vector<Digest> digests;
  for (const Frame& frame : frames) digests.push_back(frame.digest);
  return digests;
}

class DeterminismTest : public ::testing::TestWithParam<NamedScene> {};

TEST_P(DeterminismTest, AnyNumberOfThreads) {
  const Scene& scene = GetParam().scene;
  const RunResult reference = RunScene(scene, 1);
  ASSERT_EQ(reference.outcome.kind, Outcome::Kind::kSucceeded) << reference.outcome.failure.message;
  ASSERT_EQ(reference.frames.size(), 9u);
  EXPECT_NE(reference.frames[0].digest, reference.frames[8].digest);
  for (const int threads : {2, 4}) {
    EXPECT_EQ(DigestsOf(RunScene(scene, threads).frames), DigestsOf(reference.frames)) << threads << " threads";
  }
}

// Restored at random frames, each time with a different number of threads and from the checkpoint of a restored run.
TEST_P(DeterminismTest, CheckpointAndRestart) {
  const Scene& scene = GetParam().scene;
  const RunResult reference = RunScene(scene, 2);
  std::mt19937 random(static_cast<unsigned>(GetParam().name.size()) + 1);
  std::string checkpoint = reference.checkpoints[random() % 3];
  for (int restart = 0; restart < 3; ++restart) {
    Simulation simulation(std::make_shared<Scene>(scene), 1 + restart);
    ASSERT_TRUE(simulation.Restore(checkpoint));
    const auto first = static_cast<std::size_t>(simulation.next_frame());
    CollectingSink sink;
    EXPECT_EQ(simulation.Run(sink, {}, std::chrono::milliseconds(0)).kind, Outcome::Kind::kSucceeded);
    ASSERT_EQ(sink.frames.size(), reference.frames.size() - first);
    for (std::size_t i = 0; i < sink.frames.size(); ++i) {
      EXPECT_EQ(sink.frames[i].index, static_cast<std::int64_t>(first + i));
      EXPECT_EQ(sink.frames[i].digest, reference.frames[first + i].digest) << "frame " << first + i;
    }
    checkpoint = sink.checkpoints[random() % 2];
  }
}

// The digest depends on every bit of a frame.
TEST(DigestTest, ChangesWithAnyPart) {
  const Frame frame = RunScene(BusyScene(Stepping::kExplicit, ElementOrder::kLinear, 8), 2).frames[1];
  EXPECT_EQ(DigestOf(frame), frame.digest);
  const auto changed = [&](const auto& change) {
    Frame copy = frame;
    change(copy);
    return DigestOf(copy) != frame.digest;
  };
  EXPECT_TRUE(changed([](Frame& f) { ++f.index; }));
  EXPECT_TRUE(changed([](Frame& f) { f.time = std::nextafter(f.time, 1); }));
  EXPECT_TRUE(changed([](Frame& f) { ++f.step; }));
  EXPECT_TRUE(changed([](Frame& f) { f.bodies[1].positions[7][2] = std::nextafter(f.bodies[1].positions[7][2], 1); }));
  EXPECT_TRUE(changed([](Frame& f) { f.bodies[0].fields[1].name += "_"; }));
  EXPECT_TRUE(changed([](Frame& f) { f.bodies[0].fields[2].values[0] += 1e-12; }));
  EXPECT_TRUE(changed([](Frame& f) { f.series.back() = std::nextafter(f.series.back(), 1e300); }));
}

// Under a sanitizer, one scene for each kind of loop, with a quarter of the time.
std::vector<NamedScene> Scenes() {
  std::vector<NamedScene> scenes = SmallScenes();
  if (!kSlow) return scenes;
  const std::set<std::string> kept = {"tet_explicit_linear", "tet_mixed_linear",        "tet_quasi_static_linear",
                                      "voxel_dynamic",       "voxel_corotated_dynamic", "eulerian_preserved",
                                      "eulerian_implicit"};
  std::erase_if(scenes, [&](const NamedScene& scene) { return !kept.contains(scene.name); });
  for (NamedScene& scene : scenes) {
    scene.scene.duration /= 4;
    scene.scene.output.frame_interval /= 4;
  }
  return scenes;
}

INSTANTIATE_TEST_SUITE_P(Every, DeterminismTest, ::testing::ValuesIn(Scenes()),
                         [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace fascicle
