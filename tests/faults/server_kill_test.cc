// The server under kill -9 at random times: what was acknowledged is there, done once, with the frames of an
// undisturbed run; what was received of a frame stays true.
#include <signal.h>

#include <atomic>
#include <cstdlib>
#include <map>
#include <mutex>
#include <random>
#include <set>
#include <thread>

#include "tests/support/files.h"
#include "tests/support/server_process.h"
#include "tests/support/service_fixture.h"

namespace fascicle::service_test {
namespace {

using fascicle::testing::ServerProcess;
using fascicle::testing::TemporaryFolder;

int Kills() {
  const char* number = std::getenv("FASCICLE_KILLS");
  return number != nullptr ? std::atoi(number) : 50;
}

constexpr int kJobsPerRound = 3;

v1::Scene SceneOf(int kind) {
  v1::Scene scene = SwingingBox(0.1, 0.01);
  if (kind == 1) scene.mutable_tet()->set_stepping(v1::STEPPING_NEWMARK);
  if (kind == 2) scene.mutable_tet()->set_stepping(v1::STEPPING_BACKWARD_EULER);
  return scene;
}
constexpr int kKinds = 3;

std::vector<std::string> DigestsOf(Stubs& stubs, const std::string& job) {
  std::vector<std::string> digests;
  for (const v1::FrameInfo& frame : stubs.List(job)) digests.push_back(frame.digest());
  return digests;
}

// What clients know. Thread-safe.
class Ledger {
 public:
  void Acknowledge(int request, const std::string& job) {
    const std::lock_guard lock(mutex_);
    const auto [known, is_new] = jobs_.try_emplace(request, job);
    EXPECT_EQ(known->second, job) << "request " << request << " became two jobs";
  }
  bool IsAcknowledged(int request) {
    const std::lock_guard lock(mutex_);
    return jobs_.contains(request);
  }
  void Receive(const std::string& job, std::int64_t index, const std::string& digest) {
    const std::lock_guard lock(mutex_);
    const auto [known, is_new] = frames_.try_emplace({job, index}, digest);
    EXPECT_EQ(known->second, digest) << job << " frame " << index << " was replaced";
  }
  std::map<int, std::string> jobs() {
    const std::lock_guard lock(mutex_);
    return jobs_;
  }
  const std::map<std::pair<std::string, std::int64_t>, std::string>& frames() const { return frames_; }

 private:
  std::mutex mutex_;
  std::map<int, std::string> jobs_;
  std::map<std::pair<std::string, std::int64_t>, std::string> frames_;
};

// Submits the requests [0, end) that are not acknowledged yet, until the server is gone.
void SubmitUntilGone(Stubs& stubs, int end, Ledger& ledger) {
  for (int request = 0; request < end; ++request) {
    if (ledger.IsAcknowledged(request)) continue;
    v1::CreateJobRequest message;
    *message.mutable_job()->mutable_scene() = SceneOf(request % kKinds);
    message.set_request_id("request-" + std::to_string(request));
    v1::Job job;
    if (!stubs.Create(message, job).ok()) return;
    ledger.Acknowledge(request, job.name());
  }
}

// Lists the frames of jobs that run or have ended again and again, until the server is gone.
void WatchUntilGone(Stubs& stubs, Ledger& ledger, const std::atomic<bool>& gone) {
  while (!gone) {
    grpc::ClientContext context;
    v1::ListJobsRequest begun;
    begun.set_filter("state != queued");
    begun.set_page_size(4);
    v1::ListJobsResponse jobs;
    if (!stubs.jobs->ListJobs(&context, begun, &jobs).ok()) return;
    for (const v1::Job& job : jobs.jobs()) {
      grpc::ClientContext listing;
      v1::ListFramesRequest request;
      request.set_name(job.name());
      v1::ListFramesResponse response;
      if (!stubs.frames->ListFrames(&listing, request, &response).ok()) return;
      for (const v1::FrameInfo& frame : response.frames()) ledger.Receive(job.name(), frame.index(), frame.digest());
    }
  }
}

TEST(ServerKillTest, NothingAcknowledgedIsLostOrDoubled) {
  std::vector<std::string> expected[kKinds];
  TemporaryFolder undisturbed, data;
  {
    ServerProcess server({"--listen", "127.0.0.1:0", "--data", undisturbed.path()});
    Stubs stubs(server.AwaitAddress());
    for (int kind = 0; kind < kKinds; ++kind) {
      const std::string job = stubs.Submit(SceneOf(kind));
      ASSERT_TRUE(stubs.AwaitState(job, v1::Job::STATE_SUCCEEDED));
      expected[kind] = DigestsOf(stubs, job);
    }
  }
  std::mt19937 random(2026);
  Ledger ledger;
  double slowest_start = 0;
  for (int round = 0; round < Kills() && !::testing::Test::HasFailure(); ++round) {
    const auto start = std::chrono::steady_clock::now();
    ServerProcess server({"--listen", "127.0.0.1:0", "--data", data.path(), "--checkpoint", "0.01"});
    const std::string address = server.AwaitAddress();
    ASSERT_FALSE(address.empty()) << "round " << round;
    slowest_start =
        std::max(slowest_start, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    std::atomic<bool> gone = false;
    Stubs submitting(address), watching(address);  // connected before the kill
    std::thread submitter([&] { SubmitUntilGone(submitting, (round + 1) * kJobsPerRound, ledger); });
    std::thread watcher([&] { WatchUntilGone(watching, ledger, gone); });
    std::this_thread::sleep_for(std::chrono::milliseconds(50 + random() % 400));
    server.Signal(SIGKILL);
    gone = true;
    submitter.join();
    watcher.join();
    server.Wait();
  }

  ServerProcess server({"--listen", "127.0.0.1:0", "--data", data.path()});
  const std::string address = server.AwaitAddress();
  const int requests = Kills() * kJobsPerRound;
  Stubs stubs(address);
  SubmitUntilGone(stubs, requests, ledger);  // those whose answer was lost: the same jobs again
  std::set<std::string> distinct;
  for (const auto& [request, job] : ledger.jobs()) {
    distinct.insert(job);
    ASSERT_TRUE(stubs.AwaitState(job, v1::Job::STATE_SUCCEEDED, 120s)) << job << " " << stubs.Get(job).DebugString();
    EXPECT_EQ(stubs.Get(job).generation(), 1) << job;
    EXPECT_TRUE(DigestsOf(stubs, job) == expected[request % kKinds]) << job << " has other frames";
  }
  EXPECT_EQ(distinct.size(), static_cast<std::size_t>(requests));
  std::map<std::string, std::vector<std::string>> stored_of;
  for (const auto& [where, digest] : ledger.frames()) {
    std::vector<std::string>& stored = stored_of[where.first];
    if (stored.empty()) stored = DigestsOf(stubs, where.first);
    ASSERT_LT(where.second, static_cast<std::int64_t>(stored.size()));
    EXPECT_EQ(stored[static_cast<std::size_t>(where.second)], digest);
  }
  EXPECT_GT(ledger.frames().size(), static_cast<std::size_t>(Kills())) << "hardly any frame was received";
  grpc::ClientContext context;
  v1::ListJobsRequest all;
  all.set_page_size(1000);
  v1::ListJobsResponse listed;
  EXPECT_TRUE(stubs.jobs->ListJobs(&context, all, &listed).ok());
  EXPECT_EQ(listed.jobs_size(), std::min(requests, 1000)) << "a job was doubled";
  std::cout << Kills() << " kills, " << requests << " jobs and " << ledger.frames().size()
            << " received frames: 0 lost, different or doubled; slowest start " << slowest_start << " s\n";
}

}  // namespace
}  // namespace fascicle::service_test
