#ifndef FASCICLE_TESTS_FAULTS_KILLED_SERVER_H_
#define FASCICLE_TESTS_FAULTS_KILLED_SERVER_H_

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "core/base/digest.h"
#include "listed_jobs.h"
#include "tests/support/files.h"
#include "tests/support/server_process.h"
#include "tests/support/service_fixture.h"

namespace fascicle::service_test {

using fascicle::testing::ServerProcess;
using fascicle::testing::TemporaryFolder;

constexpr int kJobsPerRound = 3;

// The scene of a request: one of each stepping in turn.
constexpr int kKinds = 3;
inline v1::Scene SceneOf(int request) {
  v1::Scene scene = SwingingBox(0.1, 0.01);
  if (request % kKinds == 1) scene.mutable_tet()->set_stepping(v1::STEPPING_NEWMARK);
  if (request % kKinds == 2) scene.mutable_tet()->set_stepping(v1::STEPPING_BACKWARD_EULER);
  return scene;
}
// Whether its job is deleted once it has ended.
inline bool IsShortLived(int request) { return request % 5 == 4; }

inline std::vector<std::string> DigestsOf(Stubs& stubs, const std::string& job) {
  std::vector<std::string> digests;
  for (const v1::FrameInfo& frame : stubs.List(job)) digests.push_back(frame.digest());
  return digests;
}

using Digests = std::array<std::vector<std::string>, kKinds>;

// Those of the frames of each kind on a server that nobody disturbs.
inline Digests UndisturbedDigests() {
  Digests digests;
  TemporaryFolder data;
  ServerProcess server({"--listen", "127.0.0.1:0", "--data", data.path()});
  Stubs stubs(server.AwaitAddress());
  for (int kind = 0; kind < kKinds; ++kind) {
    const std::string job = stubs.Submit(SceneOf(kind));
    EXPECT_TRUE(stubs.AwaitState(job, v1::Job::STATE_SUCCEEDED));
    digests[static_cast<std::size_t>(kind)] = DigestsOf(stubs, job);
  }
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
  // A deletion that was acknowledged, or one whose answer was lost.
  void Delete(const std::string& job, bool is_acknowledged) {
    const std::lock_guard lock(mutex_);
    (is_acknowledged ? deleted_ : perhaps_deleted_).insert(job);
  }
  void Upload(const std::string& asset) {
    const std::lock_guard lock(mutex_);
    assets_.push_back(asset);
  }
  std::map<int, std::string> jobs() {
    const std::lock_guard lock(mutex_);
    return jobs_;
  }
  bool IsDeleted(const std::string& job) {
    const std::lock_guard lock(mutex_);
    return deleted_.contains(job);
  }
  // The others are read when all is over.
  const std::map<std::pair<std::string, std::int64_t>, std::string>& frames() const { return frames_; }
  const std::set<std::string>& deleted() const { return deleted_; }
  const std::set<std::string>& perhaps_deleted() const { return perhaps_deleted_; }
  const std::vector<std::string>& assets() const { return assets_; }

 private:
  std::mutex mutex_;
  std::map<int, std::string> jobs_;
  std::map<std::pair<std::string, std::int64_t>, std::string> frames_;
  std::set<std::string> deleted_, perhaps_deleted_;
  std::vector<std::string> assets_;
};

// Submits the requests [0, end) that are not acknowledged yet, until the server is gone.
inline void SubmitUntilGone(Stubs& stubs, int end, Ledger& ledger) {
  for (int request = 0; request < end; ++request) {
    if (ledger.IsAcknowledged(request)) continue;
    v1::CreateJobRequest message;
    *message.mutable_job()->mutable_scene() = SceneOf(request);
    message.set_request_id("request-" + std::to_string(request));
    v1::Job job;
    if (!stubs.Create(message, job).ok()) return;
    ledger.Acknowledge(request, job.name());
  }
}

// Lists the frames of jobs that run or have ended again and again, until the server is gone.
inline void WatchUntilGone(Stubs& stubs, Ledger& ledger, const std::atomic<bool>& gone) {
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
      const grpc::StatusCode code = stubs.frames->ListFrames(&listing, request, &response).error_code();
      if (code == grpc::StatusCode::NOT_FOUND) continue;  // deleted meanwhile
      if (code != grpc::StatusCode::OK) return;
      for (const v1::FrameInfo& frame : response.frames()) ledger.Receive(job.name(), frame.index(), frame.digest());
    }
  }
}

// Uploads files, and deletes short-lived jobs that have ended, until the server is gone.
inline void TidyUntilGone(Stubs& stubs, Ledger& ledger, int round, const std::atomic<bool>& gone) {
  for (int number = 0; !gone; ++number) {
    const std::string bytes = std::to_string(round) + " " + std::to_string(number);
    grpc::ClientContext uploading;
    v1::UploadAssetResponse uploaded;
    v1::UploadAssetRequest part;
    part.set_name("assets/" + Hex(Sha256Of(bytes)));
    part.set_size(static_cast<std::int64_t>(bytes.size()));
    part.set_data(bytes);
    const auto writer = stubs.assets->UploadAsset(&uploading, &uploaded);
    writer->Write(part);
    writer->WritesDone();
    if (!writer->Finish().ok()) return;
    ledger.Upload(uploaded.name());
    for (const auto& [request, job] : ledger.jobs()) {
      if (!IsShortLived(request) || ledger.IsDeleted(job)) continue;
      grpc::ClientContext deleting;
      v1::DeleteJobRequest message;
      message.set_name(job);
      google::protobuf::Empty nothing;
      const grpc::StatusCode code = stubs.jobs->DeleteJob(&deleting, message, &nothing).error_code();
      if (code == grpc::StatusCode::FAILED_PRECONDITION) continue;  // it has not ended
      // An earlier deletion whose answer was lost may have been done.
      const bool is_done = code == grpc::StatusCode::OK || code == grpc::StatusCode::NOT_FOUND;
      ledger.Delete(job, is_done);
      if (!is_done) return;
    }
  }
}

// The clients of one life of a server, which may be gone already.
class Clients {
 public:
  Clients(const std::string& address, int round, bool is_there, Ledger& ledger)
      : submitting_(address, {}, is_there),
        watching_(address, {}, is_there),
        tidying_(address, {}, is_there),
        ledger_(ledger) {
    threads_.emplace_back([this, round] { SubmitUntilGone(submitting_, (round + 1) * kJobsPerRound, ledger_); });
    threads_.emplace_back([this] { WatchUntilGone(watching_, ledger_, gone_); });
    threads_.emplace_back([this, round] { TidyUntilGone(tidying_, ledger_, round, gone_); });
  }
  // Once the server is gone.
  void Stop() {
    gone_ = true;
    for (std::thread& thread : threads_) thread.join();
    threads_.clear();
  }

 private:
  Stubs submitting_, watching_, tidying_;
  Ledger& ledger_;
  std::atomic<bool> gone_ = false;
  std::vector<std::thread> threads_;
};

inline void ExpectAssets(Stubs& stubs, const Ledger& ledger) {
  constexpr std::size_t kMost = 1000;
  for (std::size_t begin = 0; begin < ledger.assets().size(); begin += kMost) {
    grpc::ClientContext context;
    v1::FindMissingAssetsRequest request;
    for (std::size_t i = begin; i < std::min(begin + kMost, ledger.assets().size()); ++i) {
      request.add_names(ledger.assets()[i]);
    }
    v1::FindMissingAssetsResponse response;
    EXPECT_TRUE(stubs.assets->FindMissingAssets(&context, request, &response).ok());
    EXPECT_EQ(response.missing_size(), 0) << "uploads were lost";
  }
}

// Looks at what is there after `rounds` lives of a server with this data: everything that was acknowledged, once, with
// the frames of an undisturbed run; what was received of a frame stays true.
inline void ExpectNothingLost(const std::filesystem::path& data, int rounds, const Digests& expected, Ledger& ledger) {
  ServerProcess server({"--listen", "127.0.0.1:0", "--data", data});
  Stubs stubs(server.AwaitAddress());
  const int requests = rounds * kJobsPerRound;
  SubmitUntilGone(stubs, requests, ledger);  // those whose answer was lost: the same jobs again
  std::set<std::string> distinct;
  int there = 0;
  for (const auto& [request, job] : ledger.jobs()) {
    distinct.insert(job);
    const bool is_there = !stubs.Get(job).name().empty();
    there += is_there;
    EXPECT_FALSE(is_there && ledger.IsDeleted(job)) << job << " is there again";
    if (!is_there) {
      EXPECT_TRUE(ledger.IsDeleted(job) || ledger.perhaps_deleted().contains(job)) << job << " was lost";
      continue;
    }
    ASSERT_TRUE(stubs.AwaitState(job, v1::Job::STATE_SUCCEEDED, 120s)) << job << " " << stubs.Get(job).DebugString();
    EXPECT_EQ(stubs.Get(job).generation(), 1) << job;
    EXPECT_TRUE(DigestsOf(stubs, job) == expected[static_cast<std::size_t>(request % kKinds)])
        << job << " has other frames";
  }
  EXPECT_EQ(distinct.size(), static_cast<std::size_t>(requests));
  std::map<std::string, std::vector<std::string>> stored_of;
  for (const auto& [where, digest] : ledger.frames()) {
    if (ledger.IsDeleted(where.first) || ledger.perhaps_deleted().contains(where.first)) continue;
    std::vector<std::string>& stored = stored_of[where.first];
    if (stored.empty()) stored = DigestsOf(stubs, where.first);
    ASSERT_LT(where.second, static_cast<std::int64_t>(stored.size()));
    EXPECT_EQ(stored[static_cast<std::size_t>(where.second)], digest);
  }
  ExpectAssets(stubs, ledger);
  EXPECT_EQ(ListedJobs(stubs).size(), static_cast<std::size_t>(there)) << "a job was doubled";
}

}  // namespace fascicle::service_test

#endif  // FASCICLE_TESTS_FAULTS_KILLED_SERVER_H_
