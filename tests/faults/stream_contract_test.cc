// What clients saw of streams that were cut at random while the server was killed and started again: every clause of
// the contract (server/rpc/README.md) on the recorded histories, and every frame as the store has it.
#include <signal.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <map>
#include <mutex>
#include <random>
#include <set>
#include <thread>

#include "listed_jobs.h"
#include "tests/support/files.h"
#include "tests/support/server_process.h"
#include "tests/support/service_fixture.h"

namespace fascicle::service_test {
namespace {

using fascicle::testing::ServerProcess;
using fascicle::testing::TemporaryFolder;

constexpr int kClients = 20;
constexpr int kJobs = 4;

int Disconnects() {
  const char* number = std::getenv("FASCICLE_DISCONNECTS");
  return number != nullptr ? std::atoi(number) : 100;
}

// One stream as a client saw it.
struct Seen {
  std::int64_t requested = 0;  // the start index
  std::int64_t generation = 0;
  StreamRecord record;
};
using History = std::vector<Seen>;

// The address of the server that runs now. Thread-safe.
class Address {
 public:
  void Set(const std::string& address) {
    const std::lock_guard lock(mutex_);
    address_ = address;
  }
  std::string Get() const {
    const std::lock_guard lock(mutex_);
    return address_;
  }

 private:
  mutable std::mutex mutex_;
  std::string address_;
};

// Follows a job to its end; cuts its streams after a few frames, as long as there are cuts left.
History Follow(const Address& address, const std::string& job, unsigned seed, std::atomic<int>& cuts) {
  std::mt19937 random(seed);
  History history;
  std::int64_t next = 0, generation = 0;
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::minutes(10);
  while (std::chrono::steady_clock::now() < deadline) {
    grpc::ChannelArguments own;
    own.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
    const auto channel = grpc::CreateCustomChannel(address.Get(), grpc::InsecureChannelCredentials(), own);
    if (!channel->WaitForConnected(std::chrono::system_clock::now() + 1s)) continue;
    Stubs stubs(address.Get());
    v1::StreamFramesRequest request = AllFramesOf(job);
    request.set_start_index(next);
    request.set_generation(generation);
    const std::size_t most = 1 + random() % 12;
    Seen seen = {next, generation, ReadStream(stubs, request, [&](const StreamRecord& record) {
                   return record.frames.size() < most || cuts.fetch_sub(1) <= 0;
                 })};
    next += static_cast<std::int64_t>(seen.record.frames.size());
    if (seen.record.header) generation = seen.record.header->generation();
    const bool ended = seen.record.end.has_value();
    history.push_back(std::move(seen));
    if (ended) break;
  }
  return history;
}

// The first clause that a history breaks; empty if none. `stored` are the bytes of the frames.
std::string BrokenClause(const History& history, const std::vector<std::string>& stored) {
  if (history.empty()) return "nothing was seen";
  std::int64_t next = 0, generation = 0;
  for (const Seen& seen : history) {
    if (seen.requested != next) return "resumed elsewhere";
    if (seen.record.header) {
      if (seen.record.header->next_index() != seen.requested) return "the header tells another index";
      const std::int64_t now = seen.record.header->generation();
      if (generation != 0 && now != generation) return "what was seen was replaced";
      generation = now;
    }
    std::int64_t told = seen.requested;
    for (const auto& beat : seen.record.heartbeats) {
      if (beat.next_index() < told) return "a heartbeat went back";
      told = beat.next_index();
    }
    for (const v1::Frame& frame : seen.record.frames) {
      if (frame.index() != next) return "frames come each once and in order";
      if (static_cast<std::size_t>(next) >= stored.size()) return "more frames than stored";
      if (frame.SerializeAsString() != stored[static_cast<std::size_t>(next)]) return "another frame than stored";
      ++next;
    }
    if (seen.record.end.has_value() != seen.record.status.ok()) return "an end and another status";
    if (seen.record.end.has_value() != (&seen == &history.back())) return "an end that is none";
    if (!seen.record.end) continue;
    if (seen.record.end->next_index() != next) return "the end tells another index";
    if (seen.record.end->job().state() != v1::Job::STATE_SUCCEEDED) return "the end tells another state";
  }
  return static_cast<std::size_t>(next) == stored.size() ? "" : "frames are missing at the end";
}

// Histories with a fault put in are told from the one they were made of.
void ExpectFaultsSeen(const History& history, const std::vector<std::string>& stored) {
  const auto with = [&](const std::function<void(History&)>& fault) {
    History changed = history;
    fault(changed);
    return BrokenClause(changed, stored);
  };
  // A stream with several frames, and the last.
  const auto several =
      std::find_if(history.begin(), history.end(), [](const Seen& s) { return s.record.frames.size() > 2; });
  ASSERT_NE(several, history.end());
  const auto at = several - history.begin();
  const auto frames_of = [at](History& h) -> std::vector<v1::Frame>& {
    return h[static_cast<std::size_t>(at)].record.frames;
  };
  EXPECT_NE(with([&](History& h) { frames_of(h).erase(frames_of(h).begin() + 1); }), "") << "lost";
  EXPECT_NE(with([&](History& h) { frames_of(h).insert(frames_of(h).begin() + 1, frames_of(h)[0]); }), "")
      << "repeated";
  EXPECT_NE(with([&](History& h) { std::swap(frames_of(h)[0], frames_of(h)[1]); }), "") << "out of order";
  EXPECT_NE(with([&](History& h) { frames_of(h)[1].set_time(frames_of(h)[1].time() + 1e-9); }), "") << "another frame";
  EXPECT_NE(with([&](History& h) { frames_of(h).pop_back(); }), "") << "lost between two streams";
  EXPECT_NE(with([](History& h) { h.pop_back(); }), "") << "no end";
  EXPECT_NE(with([](History& h) { h.insert(h.begin(), h.back()); }), "") << "an end too early";
  EXPECT_NE(with([](History& h) { h.back().record.end->set_next_index(0); }), "") << "a wrong end";
  EXPECT_NE(with([](History& h) { h.back().record.header->set_generation(77); }), "") << "replaced";
  EXPECT_NE(with([](History& h) {
              auto& beats = h.back().record.heartbeats;
              beats.resize(beats.size() + 2);
              beats[beats.size() - 2].set_next_index(1'000'000);
            }),
            "")
      << "a heartbeat that goes back";
}

TEST(StreamContract, HoldsForEveryHistory) {
  TemporaryFolder data;
  Address address;
  std::string listen = "127.0.0.1:0";
  std::unique_ptr<ServerProcess> server;
  const auto start = [&] {
    server = std::make_unique<ServerProcess>(
        std::vector<std::string>{"--listen", listen, "--data", data.path(), "--checkpoint", "0.05"});
    listen = server->AwaitAddress();
    ASSERT_NE(listen, "") << server->ErrorOutput();
    address.Set(listen);
  };
  start();
  std::vector<std::string> jobs;
  {
    Stubs stubs(listen);
    const int frames = 100 + Disconnects() / 2;
    for (int i = 0; i < kJobs; ++i) jobs.push_back(stubs.Submit(LargeSteps(frames)));
  }
  std::atomic<int> cuts = Disconnects();
  std::atomic<int> left = kClients;
  std::vector<History> histories(kClients);
  std::vector<std::thread> clients;
  for (unsigned i = 0; i < kClients; ++i) {
    clients.emplace_back([&, i] {
      histories[i] = Follow(address, jobs[i % kJobs], i, cuts);
      --left;
    });
  }
  std::mt19937 random(11);
  int restarts = 0;
  while (left > 0) {
    std::this_thread::sleep_for(std::chrono::milliseconds(700 + random() % 1500));
    if (left == 0 || restarts >= 2 + Disconnects() / 50) continue;
    ++restarts;
    server->Signal(restarts % 2 == 0 ? SIGTERM : SIGKILL);
    ASSERT_TRUE(server->Wait(10s).has_value());
    start();
  }
  for (std::thread& client : clients) client.join();
  Stubs stubs(listen);
  std::map<std::string, std::vector<std::string>> stored;
  for (const std::string& job : jobs) {
    const StreamRecord record = ReadStream(stubs, AllFramesOf(job));
    for (const v1::Frame& frame : record.frames) stored[job].push_back(frame.SerializeAsString());
    ASSERT_EQ(stored[job].size(), stubs.List(job).size());
  }
  std::size_t streams = 0;
  for (std::size_t i = 0; i < kClients; ++i) {
    EXPECT_EQ(BrokenClause(histories[i], stored[jobs[i % kJobs]]), "") << "client " << i;
    streams += histories[i].size();
  }
  ExpectFaultsSeen(histories[0], stored[jobs[0]]);
  EXPECT_LE(cuts, 0) << "not all disconnects took place";
  std::printf("%d disconnects and %d restarts: %zu streams of %d clients, all as the store has it\n", Disconnects(),
              restarts, streams, kClients);
}

// Requests are sent again and again, because their answers were lost: each becomes one job.
TEST(LostReplies, ARequestBecomesOneJob) {
  const char* number = std::getenv("FASCICLE_LOST_REPLIES");
  const int requests = number != nullptr ? std::atoi(number) : 500;
  constexpr int kThreads = 8;
  TemporaryFolder data;
  server::ServerOptions options;
  options.workers = 0;
  options.data_directory = data.path();
  const auto server = server::EmbeddedServer::Start(options);
  std::atomic<int> next = 0, lost = 0;
  std::mutex mutex;
  std::map<std::string, std::string> jobs;  // by request
  std::vector<std::thread> threads;
  for (unsigned t = 0; t < kThreads; ++t) {
    threads.emplace_back([&, t] {
      std::mt19937 random(t);
      Stubs stubs(server->address());
      for (int i = next++; i < requests; i = next++) {
        v1::CreateJobRequest request;
        *request.mutable_job()->mutable_scene() = SwingingBox(0.01, 0.01);
        request.set_request_id("request " + std::to_string(i));
        while (true) {
          grpc::ClientContext context;
          const bool cut = random() % 2 == 0;
          if (cut) context.set_deadline(std::chrono::system_clock::now() + std::chrono::microseconds(random() % 8000));
          v1::Job job;
          if (!stubs.jobs->CreateJob(&context, request, &job).ok()) {
            ++lost;
            continue;
          }
          const std::lock_guard lock(mutex);
          const auto [known, is_new] = jobs.try_emplace(request.request_id(), job.name());
          EXPECT_EQ(known->second, job.name());
          if (random() % 4 != 0) break;  // and once more, to get the same job
        }
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  std::set<std::string> distinct;
  for (const auto& [request, job] : jobs) distinct.insert(job);
  Stubs stubs(server->address());
  const std::vector<std::string> names = ListedJobs(stubs);
  const std::set<std::string> listed(names.begin(), names.end());
  EXPECT_EQ(distinct.size(), static_cast<std::size_t>(requests));
  EXPECT_EQ(listed, distinct) << "jobs that nobody asked for";
  EXPECT_GT(lost, requests / 10);
  std::printf("%d requests, %d lost replies: %zu jobs\n", requests, lost.load(), listed.size());
}

}  // namespace
}  // namespace fascicle::service_test
