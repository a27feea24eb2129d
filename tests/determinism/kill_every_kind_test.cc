// Jobs of every method, stepping, element and treatment of volume whose process is killed at random times: the same
// frames, none of them ever replaced. FASCICLE_KILLS_OF_EACH is the number of kills of each; without it, some are
// killed once.
#include <signal.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <random>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "killed_scenes.h"
#include "server/store/store.h"
#include "tests/support/child_process.h"
#include "tests/support/files.h"
#include "tests/support/paths.h"

namespace fascicle {
namespace {

using std::chrono::steady_clock;
using testing::ChildProcess;
using testing::Finished;
using testing::NamedScene;
using testing::TemporaryFolder;

int KillsOfEach() {
  const char* number = std::getenv("FASCICLE_KILLS_OF_EACH");
  return number != nullptr ? std::atoi(number) : 1;
}

// In a short run, every seventh: each method, each element, most steppings.
std::vector<NamedScene> Scenes() {
  std::vector<NamedScene> all = testing::KilledScenes();
  if (std::getenv("FASCICLE_KILLS_OF_EACH") != nullptr) return all;
  std::vector<NamedScene> some;
  for (std::size_t k = 0; k < all.size(); k += 7) some.push_back(std::move(all[k]));
  return some;
}

class KillEveryKindTest : public ::testing::TestWithParam<NamedScene> {
 protected:
  // Starts the run of a folder, or goes on with it, and waits until its job is stored.
  std::unique_ptr<ChildProcess> Begin(const TemporaryFolder& folder) {
    const std::vector<std::string> command = {testing::Program("killed_run"), folder.path().string(), GetParam().name};
    auto process = std::make_unique<ChildProcess>(command);
    EXPECT_EQ(process->ReadLine(), "submitted");
    return process;
  }
  // The same to its end: what it prints.
  std::string Finish(const TemporaryFolder& folder) {
    const Finished finished = Begin(folder)->Wait();
    EXPECT_EQ(finished.exit_code, 0) << finished.err;
    return finished.out;
  }
};

TEST_P(KillEveryKindTest, TheSameFrames) {
  const TemporaryFolder undisturbed;
  const auto start = steady_clock::now();
  const std::string expected = Finish(undisturbed);
  const auto longest = std::chrono::duration_cast<std::chrono::microseconds>(steady_clock::now() - start).count();
  ASSERT_TRUE(expected.starts_with("state " + std::to_string(static_cast<int>(server::JobState::kSucceeded)) +
                                   " generation 1\n"))
      << expected;
  std::mt19937 random(static_cast<unsigned>(GetParam().name.size()));
  auto folder = std::make_unique<TemporaryFolder>();
  int kills = 0, ends = 0;
  while (kills < KillsOfEach()) {
    const std::unique_ptr<ChildProcess> process = Begin(*folder);
    if (!process->Wait(std::chrono::milliseconds(random() % longest / 1500)).has_value()) process->Signal(SIGKILL);
    const int code = process->Wait().exit_code;
    if (code == -SIGKILL) {
      ++kills;
      continue;
    }
    ASSERT_EQ(code, 0) << "ended before it was killed";
    EXPECT_EQ(Finish(*folder), expected) << "after " << kills << " kills";
    folder = std::make_unique<TemporaryFolder>();
    ++ends;
  }
  EXPECT_EQ(Finish(*folder), expected);
  std::printf("%s: %d kills of %d jobs, the same frames\n", GetParam().name.c_str(), kills, ends + 1);
}

INSTANTIATE_TEST_SUITE_P(Kinds, KillEveryKindTest, ::testing::ValuesIn(Scenes()),
                         [](const auto& kind) { return kind.param.name; });

}  // namespace
}  // namespace fascicle
