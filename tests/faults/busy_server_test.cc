// A server whose workers all solve, with many readers: everybody is answered, and nobody slows down the others. With
// FASCICLE_BUSY_SECONDS the measurements take so long and are held against the release's figures.
#include <cstdio>
#include <cstdlib>

#include "stream_clients.h"
#include "tests/support/call_times.h"
#include "tests/support/files.h"
#include "tests/support/server_process.h"

namespace fascicle::service_test {
namespace {

using fascicle::testing::CallTimes;
using fascicle::testing::ServerProcess;
using fascicle::testing::TemporaryFolder;

bool IsRelease() { return std::getenv("FASCICLE_BUSY_SECONDS") != nullptr; }
std::chrono::milliseconds Span() {
  return IsRelease() ? std::chrono::seconds(std::atoi(std::getenv("FASCICLE_BUSY_SECONDS"))) : 2500ms;
}
// Other programs may use the machine of a short run.
double Allowance() { return IsRelease() ? 1 : 4; }

class BusyServerTest : public ::testing::Test {
 protected:
  static constexpr int kWorkers = 2;

  void SetUp() override {
    address_ = server_.AwaitAddress();
    ASSERT_NE(address_, "");
    stubs_.emplace(address_);
    stored_ = stubs_->Submit(LargeFrames(6));  // 16 MiB
    ASSERT_TRUE(stubs_->AwaitState(stored_, v1::Job::STATE_SUCCEEDED, 120s));
  }
  // Jobs that keep all workers busy.
  void Solve() {
    for (int i = 0; i < kWorkers; ++i) solving_.push_back(stubs_->Submit(LargeSteps(100'000)));
    for (const std::string& job : solving_) ASSERT_TRUE(stubs_->AwaitFrames(job, 1));
  }
  // Steps made by all solving jobs so far.
  std::int64_t Steps() {
    std::int64_t steps = 0;
    for (const std::string& job : solving_) steps += stubs_->Get(job).progress().step();
    return steps;
  }

  TemporaryFolder data_;
  ServerProcess server_{{"--listen", "127.0.0.1:0", "--data", data_.path(), "--workers", std::to_string(kWorkers)}};
  std::string address_;
  std::optional<Stubs> stubs_;
  std::string stored_;
  std::vector<std::string> solving_;
};

TEST_F(BusyServerTest, EverybodyIsAnswered) {
  Solve();
  const StreamClients streams(address_, AllFramesOf(stored_), 64);
  std::this_thread::sleep_for(500ms);
  const std::int64_t steps = Steps(), bytes = streams.bytes();
  CallTimes health(HealthCall(address_)), get(GetJobCall(address_, stored_));
  std::this_thread::sleep_for(Span());
  health.Stop();
  get.Stop();
  const double seconds = std::chrono::duration<double>(Span()).count();
  std::printf("health: %s\nGetJob: %s\n%.0f MB/s to 64 streams, %.0f steps/s\n", health.Summary().c_str(),
              get.Summary().c_str(), 1e-6 * static_cast<double>(streams.bytes() - bytes) / seconds,
              static_cast<double>(Steps() - steps) / seconds);
  EXPECT_EQ(health.failures() + get.failures() + streams.failures(), 0);
  EXPECT_GT(streams.bytes(), bytes);
  EXPECT_LE(health.Quantile(0.99), 0.05 * Allowance());
  EXPECT_LE(get.Quantile(0.99), 0.1 * Allowance());
}

}  // namespace
}  // namespace fascicle::service_test
