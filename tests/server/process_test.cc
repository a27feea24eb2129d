// The real program as a child process: command line, signals, and what survives a kill.
#include <atomic>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "client/lib/client.h"
#include "tests/support/files.h"
#include "tests/support/server_process.h"
#include "tests/support/service_fixture.h"

namespace fascicle::service_test {
namespace {

using testing::ServerProcess;
using testing::TemporaryFolder;

TEST(CommandLine, HelpAndVersion) {
  for (const char* option : {"--help", "--version"}) {
    ServerProcess process({option});
    EXPECT_EQ(process.Wait(10s), 0) << option;
    EXPECT_NE(process.Output().find("fascicled"), std::string::npos) << option;
  }
}

TEST(CommandLine, BadOptionsEndWith2) {
  using Arguments = std::vector<std::string>;
  for (const Arguments& arguments :
       {Arguments{"--nonsense"}, Arguments{"--workers", "0"}, Arguments{"--workers", "many"},
        Arguments{"--log-level", "loud"}, Arguments{"--listen"}, Arguments{"stray"}}) {
    ServerProcess process(arguments);
    EXPECT_EQ(process.Wait(10s), 2) << arguments.front();
    EXPECT_EQ(process.Output(), "");
    EXPECT_NE(process.ErrorOutput(), "");
  }
}

TEST(CommandLine, WhatCannotStartEndsWith1AndSaysWhy) {
  TemporaryFolder data, other;
  ServerProcess first({"--listen", "127.0.0.1:0", "--data", data.path()});
  const std::string address = first.AwaitAddress();
  ASSERT_NE(address, "");
  const auto expect_refused = [](std::vector<std::string> arguments, const std::string& reason) {
    ServerProcess process(std::move(arguments));
    EXPECT_EQ(process.Wait(10s), 1) << reason;
    EXPECT_NE(process.ErrorOutput().find(reason), std::string::npos) << process.ErrorOutput();
  };
  expect_refused({"--listen", address, "--data", other.path()}, "in use");
  expect_refused({"--listen", "127.0.0.1:0", "--data", data.path()}, data.path().string());
  expect_refused({"--listen", "0.0.0.0:0", "--data", other.path()}, "refusing to listen");
  expect_refused({"--listen", "nonsense", "--data", other.path()}, "HOST:PORT");
  expect_refused({"--listen", "127.0.0.1:0", "--data", "/proc/fascicle"}, "/proc/fascicle");
}

TEST(CommandLine, SignalsStopIt) {
  for (const int signal : {SIGTERM, SIGINT}) {
    TemporaryFolder data;
    ServerProcess process({"--listen", "127.0.0.1:0", "--data", data.path()});
    ASSERT_NE(process.AwaitAddress(), "");
    process.Signal(signal);
    EXPECT_EQ(process.Wait(10s), 0);
  }
}

class ProcessTest : public ::testing::Test {
 protected:
  // Starts a server on this test's data, on the same port each time.
  void Start() {
    process_ = std::make_unique<ServerProcess>(
        std::vector<std::string>{"--listen", address_, "--data", data_.path(), "--checkpoint", "0.05"});
    address_ = process_->AwaitAddress();
    ASSERT_NE(address_, "") << process_->ErrorOutput();
  }

  TemporaryFolder data_;
  std::string address_ = "127.0.0.1:0";
  std::unique_ptr<ServerProcess> process_;
};

// Frames as a client received them: bytes by index.
struct Received {
  std::vector<std::string> frames;
  int reconnections = 0;
};

client::WatchEvents Into(Received& received) {
  client::WatchEvents events;
  events.frame = [&received](const v1::Frame& frame) {
    ASSERT_EQ(frame.index(), static_cast<std::int64_t>(received.frames.size())) << "each once and in order";
    received.frames.push_back(frame.SerializeAsString());
  };
  events.reconnecting = [&received](const std::string&) { ++received.reconnections; };
  return events;
}

client::ScenePackage PackageOf(const v1::Scene& scene) { return {scene, {}}; }

// Some seconds of work in frames of a few KiB.
v1::Scene KillScene() { return LargeSteps(1000); }

std::vector<std::string> Undisturbed(const v1::Scene& scene) {
  const auto server = server::EmbeddedServer::Start({});
  client::Client client(server->address());
  const auto job = client.Submit(PackageOf(scene), 1);
  Received received;
  const auto end = client.Watch(job.value().name(), {}, Into(received));
  EXPECT_TRUE(end.ok() && end.value().state() == v1::Job::STATE_SUCCEEDED);
  return received.frames;
}

TEST_F(ProcessTest, KilledInMidJobItGoesOnAndNoWatcherNotices) {
  const v1::Scene scene = KillScene();
  const std::vector<std::string> expected = Undisturbed(scene);
  ASSERT_GT(expected.size(), 50u);
  Start();
  client::Client client(address_);
  const auto submitted = client.Submit(PackageOf(scene), 1);
  ASSERT_TRUE(submitted.ok()) << submitted.error().message;
  const std::string name = submitted.value().name();

  Received received;
  std::atomic<bool> done = false;
  std::thread watcher([&] {
    const auto job = client.Watch(name, {}, Into(received));
    EXPECT_TRUE(job.ok()) << job.error().message;
    if (job.ok()) {
      EXPECT_EQ(job.value().state(), v1::Job::STATE_SUCCEEDED);
      EXPECT_GT(job.value().attempt(), 1);
    }
    done = true;
  });
  std::minstd_rand random(20240607);
  std::uniform_int_distribution<int> pause(20, 400);
  int kills = 0;
  for (; kills < 6 && !done; ++kills) {
    std::this_thread::sleep_for(std::chrono::milliseconds(pause(random)));
    process_->Signal(SIGKILL);
    ASSERT_EQ(process_->Wait(10s), -SIGKILL);
    const auto begin = std::chrono::steady_clock::now();
    Start();
    EXPECT_LT(std::chrono::steady_clock::now() - begin, 2s) << "ready again";
    // Every frame that a client has received still exists, with the same bits.
    Received again;
    client::WatchOptions stored;
    stored.follow = false;
    ASSERT_TRUE(client::Client(address_).Watch(name, stored, Into(again)).ok());
    for (std::size_t i = 0; i < again.frames.size(); ++i) EXPECT_EQ(again.frames[i], expected[i]) << i;
  }
  watcher.join();
  EXPECT_GE(kills, 3) << "the job was too short for this test";
  EXPECT_GE(received.reconnections, 1) << "kills that follow each other without a frame between are one loss";
  EXPECT_EQ(received.frames, expected);
}

// Of a stage; 0 without it.
std::int64_t CallsOf(const v1::Profile& profile, const std::string& stage) {
  for (const auto& each : profile.stages()) {
    if (each.name() == stage) return each.calls();
  }
  return 0;
}

TEST_F(ProcessTest, AProfileSurvivesAKillAndTheNextRunAddsToIt) {
  Start();
  std::string name;
  v1::Profile first;
  {
    Stubs stubs(address_);
    name = stubs.Submit(LongScene());
    // The check of the scene has a profile before the first run.
    ASSERT_TRUE(Eventually([&] { return stubs.Get(name).profile().runs() == 1; })) << "stored while the job runs";
    first = stubs.Get(name).profile();
    EXPECT_GT(first.wall_seconds(), 0.5);
  }
  process_->Signal(SIGKILL);
  ASSERT_EQ(process_->Wait(10s), -SIGKILL);
  Start();
  v1::Job last;
  {
    Stubs stubs(address_);
    EXPECT_GE(stubs.Get(name).profile().wall_seconds(), first.wall_seconds());
    ASSERT_TRUE(stubs.AwaitFrames(name, stubs.Get(name).frame_count() + 10));
    ASSERT_TRUE(stubs.Cancel(name).ok());
    ASSERT_TRUE(stubs.AwaitState(name, v1::Job::STATE_CANCELLED));
    last = stubs.Get(name);
    EXPECT_EQ(last.attempt(), 2);
    EXPECT_EQ(last.profile().runs(), 2);
    EXPECT_GT(last.profile().wall_seconds(), first.wall_seconds());
    EXPECT_EQ(CallsOf(first, "start"), 1);
    EXPECT_EQ(CallsOf(last.profile(), "start"), 2);
  }
  process_->Signal(SIGTERM);
  EXPECT_EQ(process_->Wait(10s), 0);
  Start();
  EXPECT_EQ(Stubs(address_).Get(name).profile().SerializeAsString(), last.profile().SerializeAsString());
}

TEST_F(ProcessTest, DrainsWithOpenStreamsAndTheClientsResume) {
  const v1::Scene scene = LargeSteps(200);
  const std::vector<std::string> expected = Undisturbed(scene);
  Start();
  constexpr int kJobs = 4, kWatchers = 50;
  std::vector<std::string> names;
  {
    client::Client client(address_);
    for (int i = 0; i < kJobs; ++i) names.push_back(client.Submit(PackageOf(scene), 1).value().name());
  }
  std::vector<Received> received(kWatchers);
  std::vector<std::thread> watchers;
  for (int i = 0; i < kWatchers; ++i) {
    watchers.emplace_back([&, i] {
      client::Client client(address_);
      const auto job =
          client.Watch(names[static_cast<std::size_t>(i % kJobs)], {}, Into(received[static_cast<std::size_t>(i)]));
      EXPECT_TRUE(job.ok()) << job.error().message;
    });
  }
  {
    Stubs stubs(address_);
    EXPECT_TRUE(stubs.AwaitFrames(names[0], 5));
  }
  process_->Signal(SIGTERM);
  EXPECT_EQ(process_->Wait(10s), 0);
  Start();
  for (std::thread& watcher : watchers) watcher.join();
  for (const Received& each : received) EXPECT_EQ(each.frames, expected);
}

TEST_F(ProcessTest, ASecondSignalEndsItAtOnce) {
  Start();
  Stubs stubs(address_);
  // A stalled reader keeps the first phase of stopping busy for seconds.
  const std::string name = stubs.Submit(LargeFrames(12));
  ASSERT_TRUE(stubs.AwaitState(name, v1::Job::STATE_SUCCEEDED));
  grpc::ClientContext context;
  const auto reader = stubs.frames->StreamFrames(&context, AllFramesOf(name));
  std::this_thread::sleep_for(300ms);
  process_->Signal(SIGTERM);
  std::this_thread::sleep_for(100ms);
  process_->Signal(SIGTERM);
  EXPECT_EQ(process_->Wait(1s), 1);
}

// [SERVICE.md, slow consumers]: at most 8 MiB for each stalled reader, without effect on others. tests/bench
// (stream_beside_stalled) measures how much they slow down others.
TEST_F(ProcessTest, ReadersThatStandStillCostLittleAndHoldUpNobody) {
  Start();
  Stubs stubs(address_);
  const std::string name = stubs.Submit(LargeFrames(16));
  ASSERT_TRUE(stubs.AwaitState(name, v1::Job::STATE_SUCCEEDED, 60s));
  const auto read_all = [&] {
    Stubs fast(address_);
    EXPECT_EQ(ReadStream(fast, AllFramesOf(name)).frames.size(), 16u);
  };
  read_all();

  const std::int64_t before = process_->ResidentBytes();
  ASSERT_GT(before, 0);
  constexpr int kStalled = 20;
  struct Stalled {
    explicit Stalled(const std::string& address) : stubs(address) {}
    Stubs stubs;
    grpc::ClientContext context;
    std::unique_ptr<grpc::ClientReader<v1::StreamFramesResponse>> reader;
  };
  std::vector<std::unique_ptr<Stalled>> stalled;
  for (int i = 0; i < kStalled; ++i) {
    auto& one = *stalled.emplace_back(std::make_unique<Stalled>(address_));
    one.reader = one.stubs.frames->StreamFrames(&one.context, AllFramesOf(name));
    v1::StreamFramesResponse message;
    ASSERT_TRUE(one.reader->Read(&message));  // the header, then nothing more
  }
  std::this_thread::sleep_for(1s);
#ifndef __SANITIZE_ADDRESS__  // which keeps freed memory for a while
  EXPECT_LE(process_->ResidentBytes() - before, kStalled * (std::int64_t{8} << 20));
#endif
  for (int i = 0; i < 5; ++i) read_all();
  // Another job runs as usual.
  const std::string other = stubs.Submit(SwingingBox(0.1, 0.01));
  EXPECT_TRUE(stubs.AwaitState(other, v1::Job::STATE_SUCCEEDED));
  for (auto& one : stalled) {
    one->context.TryCancel();
    one->reader->Finish();
  }
}

}  // namespace
}  // namespace fascicle::service_test
