// A server whose workers all solve, with many readers: everybody is answered, and nobody slows down the others. With
// FASCICLE_BUSY_SECONDS the measurements take so long and are held against the release's figures.
#include <algorithm>
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
  // Jobs that keep all workers busy, with steps of the same size. The first stores a frame each `interval` [s], the
  // others as many as they can.
  void Solve(double interval = 0.01) {
    while (solving_.size() < kWorkers) {
      v1::Scene scene = LargeSteps(90'000);
      if (solving_.empty()) scene.mutable_output()->set_frame_interval(interval);
      solving_.push_back(stubs_->Submit(scene));
    }
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

// Of ten readers [byte/s], and the processor time of a step [s].
struct Rates {
  double bytes = 0, step = 0;
};

double MedianOf(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

class ReadersTest : public BusyServerTest {
 protected:
  static constexpr int kNicenessOfJobs = 10;

  Rates Measure(const StreamClients& fast) {
    const std::int64_t bytes = fast.bytes(), steps = Steps();
    const double time = server_.CpuSeconds(kNicenessOfJobs);
    std::this_thread::sleep_for(Span());
    const double seconds = std::chrono::duration<double>(Span()).count();
    return {
        static_cast<double>(fast.bytes() - bytes) / seconds,
        (server_.CpuSeconds(kNicenessOfJobs) - time) / static_cast<double>(std::max<std::int64_t>(1, Steps() - steps))};
  }
  // Ten fast readers beside `count` others, and without them before and after, because the machine may have become
  // slower or faster meanwhile. Watchers see what comes, not what has been.
  void Compare(v1::StreamFramesRequest request, int count, bool stalled, const char* what) {
    const StreamClients fast(address_, AllFramesOf(stored_), 10);
    std::this_thread::sleep_for(500ms);
    std::vector<double> bytes, steps;
    double most = 0;
    Rates before = Measure(fast);
    for (int round = 0; round < (IsRelease() ? 3 : 1); ++round) {
      const std::int64_t resident = server_.ResidentBytes();
      Rates beside;
      {
        if (!stalled) request.set_start_index(stubs_->Get(solving_[0]).frame_count());
        const StreamClients others(address_, request, count, stalled);
        std::this_thread::sleep_for(IsRelease() ? 3s : 1s);
        const std::int64_t messages = others.messages();
        beside = Measure(fast);
        most = std::max(most, static_cast<double>(server_.ResidentBytes() - resident) / count / (1 << 20));
        EXPECT_EQ(others.failures(), 0);
        std::printf("%lld messages; ", static_cast<long long>(others.messages() - messages));
      }
      const Rates after = Measure(fast);
      bytes.push_back(beside.bytes / (0.5 * (before.bytes + after.bytes)));
      steps.push_back(beside.step / (0.5 * (before.step + after.step)));
      std::printf("fast readers at %.0f %% of %.0f MB/s alone, a step at %.0f %% of %.3f ms\n", 100 * bytes.back(),
                  0.5e-6 * (before.bytes + after.bytes), 100 * steps.back(), 500 * (before.step + after.step));
      before = after;
    }
    std::printf("beside %d %s: fast readers at %.0f %%, a step at %.0f %%, at most %.2f MiB for each\n", count, what,
                100 * MedianOf(bytes), 100 * MedianOf(steps), most);
    EXPECT_EQ(fast.failures(), 0);
    EXPECT_LE(most, 8);
    EXPECT_GE(MedianOf(bytes), 0.8 / Allowance());
    EXPECT_LE(MedianOf(steps), IsRelease() ? 1.05 : 2) << "processor time: other programs hardly change it";
  }
};

TEST_F(ReadersTest, StalledOnesCostLittle) {
  Solve();
  Compare(AllFramesOf(stored_), IsRelease() ? 100 : 20, true, "stalled readers");
}

// A frame several times a second is as much as anybody can look at.
TEST_F(ReadersTest, WatchersOfOneJobCostLittle) {
  Solve(0.5);
  Compare(AllFramesOf(solving_[0]), IsRelease() ? 500 : 100, false, "watchers of a job");
}

TEST_F(ReadersTest, WatchersOfTheNewestFrameCostLittle) {
  Solve();
  v1::StreamFramesRequest request = AllFramesOf(solving_[0]);
  request.set_mode(v1::StreamFramesRequest::MODE_LATEST);
  Compare(request, IsRelease() ? 500 : 100, false, "watchers of the newest frame");
}

}  // namespace
}  // namespace fascicle::service_test
