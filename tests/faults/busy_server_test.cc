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
  return IsRelease() ? std::chrono::seconds(std::atoi(std::getenv("FASCICLE_BUSY_SECONDS"))) : 1000ms;
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
    stored_ = stubs_->Submit(LargeFrames(4));  // 11 MiB
    ASSERT_TRUE(stubs_->AwaitState(stored_, v1::Job::STATE_SUCCEEDED, 120s));
  }
  // Jobs that keep all workers busy; the first stores a frame now and then, the others many.
  void Solve() {
    solving_.push_back(stubs_->Submit(SwingingBox(1000, 1)));
    while (solving_.size() < kWorkers) solving_.push_back(stubs_->Submit(LargeSteps(100'000)));
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

// [byte/s] and [steps/s], over `span`.
struct Rates {
  double bytes = 0, steps = 0;
};

class ReadersTest : public BusyServerTest {
 protected:
  // The speed of ten readers and of the solving jobs at present.
  Rates Measure(const StreamClients& fast) {
    const std::int64_t bytes = fast.bytes(), steps = Steps();
    std::this_thread::sleep_for(Span());
    const double seconds = std::chrono::duration<double>(Span()).count();
    return {static_cast<double>(fast.bytes() - bytes) / seconds, static_cast<double>(Steps() - steps) / seconds};
  }
  // Ten fast readers beside `count` others, and without them.
  void Compare(const v1::StreamFramesRequest& request, int count, bool stalled, const char* what) {
    const StreamClients fast(address_, AllFramesOf(stored_), 10);
    std::this_thread::sleep_for(500ms);
    const Rates alone = Measure(fast);
    const std::int64_t before = server_.ResidentBytes();
    Rates beside;
    double each = 0;
    {
      const StreamClients others(address_, request, count, stalled);
      std::this_thread::sleep_for(1s);
      beside = Measure(fast);
      each = static_cast<double>(server_.ResidentBytes() - before) / count / (1 << 20);
      EXPECT_EQ(others.failures(), 0);
    }
    const Rates after = Measure(fast);  // the machine may have become slower or faster meanwhile
    const double bytes = beside.bytes / (0.5 * (alone.bytes + after.bytes));
    const double steps = beside.steps / (0.5 * (alone.steps + after.steps));
    std::printf("beside %d %s: fast readers at %.0f %% of %.0f MB/s alone, solving at %.0f %%, %.2f MiB for each\n",
                count, what, 100 * bytes, 1e-6 * alone.bytes, 100 * steps, each);
    EXPECT_EQ(fast.failures(), 0);
    EXPECT_LE(each, 8);
    EXPECT_GE(bytes, 0.8 / Allowance());
    EXPECT_GE(steps, 0.95 / Allowance());
  }
};

TEST_F(ReadersTest, StalledOnesCostLittle) {
  Solve();
  Compare(AllFramesOf(stored_), IsRelease() ? 100 : 20, true, "stalled readers");
}

TEST_F(ReadersTest, WatchersOfOneJobCostLittle) {
  Solve();
  Compare(AllFramesOf(solving_[0]), IsRelease() ? 500 : 100, false, "watchers of a job");
}

}  // namespace
}  // namespace fascicle::service_test
