// Jobs of every method, stepping, element and treatment of volume, and larger ones of each stepping of tetrahedra, that
// are cancelled at random moments of their preparation, their first steps and later: the time until they have ended.
// FASCICLE_CANCELS_OF_EACH is the number for each; without it, some are cancelled once, and only need to end.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "killed_scenes.h"
#include "server/jobs/job_manager.h"
#include "server/store/store.h"
#include "tests/support/box_jobs.h"

namespace fascicle::server {
namespace {

using Clock = std::chrono::steady_clock;
using Scenes = std::map<std::string, std::shared_ptr<const Scene>>;

constexpr std::chrono::seconds kLongest(60);

bool IsRelease() { return std::getenv("FASCICLE_CANCELS_OF_EACH") != nullptr; }
int CancelsOfEach() { return IsRelease() ? std::atoi(std::getenv("FASCICLE_CANCELS_OF_EACH")) : 1; }

std::vector<testing::NamedScene> LargerScenes() {
  const std::vector<std::pair<std::string, Stepping>> steppings = {
      {"explicit", Stepping::kExplicit}, {"mixed", Stepping::kMixed}, {"backward_euler", Stepping::kBackwardEuler},
      {"newmark", Stepping::kNewmark},   {"bdf2", Stepping::kBdf2},   {"quasi_static", Stepping::kQuasiStatic}};
  std::vector<testing::NamedScene> scenes;
  for (const auto& [name, stepping] : steppings) {
    scenes.push_back({"larger_" + name, testing::BusyScene(stepping, ElementOrder::kQuadratic, 10)});
  }
  return scenes;
}

// Those to cancel; in a short run, every seventh.
Scenes ScenesToCancel() {
  std::vector<testing::NamedScene> all = testing::KilledScenes();
  for (testing::NamedScene& larger : LargerScenes()) all.push_back(std::move(larger));
  Scenes scenes;
  for (std::size_t i = 0; i < all.size(); i += IsRelease() ? 1 : 7) {
    all[i].scene.duration *= 1000;
    scenes[all[i].name] = std::make_shared<const Scene>(std::move(all[i].scene));
  }
  return scenes;
}

JobCodec CodecOf(const Scenes& scenes) {
  JobCodec codec = BoxCodec();
  codec.decode_scene = [&scenes](const std::string& name, AssetStore&, Profile*, const std::stop_token&) {
    return scenes.at(name);
  };
  return codec;
}

// From the request to the end [s]; nothing if the job ended before the request, as bodies that leave their grid make
// it.
std::optional<double> SecondsToCancel(JobManager& jobs, const std::string& name, std::chrono::milliseconds delay) {
  JobRecord record;
  record.spec = record.scene_name = name;
  const std::string id = jobs.Submit(record, nullptr).record.id;
  std::this_thread::sleep_for(delay);
  const Clock::time_point request = Clock::now();
  const JobState state = jobs.Cancel(id)->record.state;
  if (IsFinal(state) && state != JobState::kCancelled) return std::nullopt;
  const auto is_cancelled = [&] { return jobs.Get(id)->record.state == JobState::kCancelled; };
  while (!is_cancelled() && Clock::now() - request < kLongest)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  const double seconds = std::chrono::duration<double>(Clock::now() - request).count();
  EXPECT_TRUE(is_cancelled()) << name;
  return seconds;
}

TEST(CancelEveryKindTest, JobsEndSoon) {
  const Scenes scenes = ScenesToCancel();
  const std::unique_ptr<Store> store = MakeMemoryStore();
  JobManagerOptions options;
  options.workers = 1;
  options.default_threads = 2;
  JobManager jobs(*store, CodecOf(scenes), options);
  std::mt19937 random(7);
  std::vector<std::pair<double, std::string>> times;
  for (const auto& [name, scene] : scenes) {
    for (int i = 0; i < CancelsOfEach(); ++i) {
      // Moments of all magnitudes: preparations of small scenes take milliseconds, steps of large ones seconds.
      const double magnitude = std::uniform_real_distribution<double>(0, 3.3)(random);
      const std::chrono::milliseconds delay(static_cast<int>(std::pow(10, magnitude)));
      const std::optional<double> seconds = SecondsToCancel(jobs, name, delay);
      if (seconds) times.emplace_back(*seconds, name);
    }
  }
  ASSERT_GT(times.size(), scenes.size() * static_cast<std::size_t>(CancelsOfEach()) / 2);
  std::sort(times.begin(), times.end());
  const auto& [p99, kind] = times[times.size() * 99 / 100];
  const auto& [longest, slowest] = times.back();
  std::printf("%zu cancellations of %zu kinds: p50 %.4f s, p99 %.4f s (%s), longest %.4f s (%s)\n", times.size(),
              scenes.size(), times[times.size() / 2].first, p99, kind.c_str(), longest, slowest.c_str());
  if (IsRelease()) {
    EXPECT_LE(p99, 1);
  }
}

}  // namespace
}  // namespace fascicle::server
