// Jobs of every method that are steered while the server is killed again and again: every acknowledged input takes
// effect with the step that was told, no frame changes, and a replay gives the same bits.
//   FASCICLE_STEERING_INPUTS, FASCICLE_STEERING_KILLS  numbers; the release form is 1000 and 50
#include <signal.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <random>
#include <thread>

#include "fascicle/v1/steering_service.grpc.pb.h"
#include "tests/support/child_process.h"
#include "tests/support/files.h"
#include "tests/support/paths.h"
#include "tests/support/server_process.h"
#include "tests/support/service_fixture.h"
#include "tests/support/steered_scenes.h"

namespace fascicle::service_test {
namespace {

using fascicle::testing::RunProgram;
using fascicle::testing::ServerProcess;
using fascicle::testing::TemporaryFolder;

int NumberFrom(const char* variable, int usual) {
  const char* number = std::getenv(variable);
  return number != nullptr ? std::atoi(number) : usual;
}

// A job as its client knows it.
struct SteeredJob {
  SteeredScene steered;
  std::string name;
  std::map<std::int64_t, v1::SteeringInput> acknowledged;  // by sequence
  v1::SteeringInput next;                                  // not acknowledged yet
  std::map<std::int64_t, std::string> seen;                // digests of frames
};

class Client {
 public:
  explicit Client(const std::string& address)
      : stubs_(address), steering_(v1::SteeringService::NewStub(stubs_.channel)) {}

  grpc::Status Apply(const std::string& job, const v1::SteeringInput& input, v1::SteeringInput& answer) {
    grpc::ClientContext context;
    v1::ApplySteeringRequest request;
    request.set_name(job);
    *request.mutable_input() = input;
    v1::ApplySteeringResponse response;
    const grpc::Status status = steering_->ApplySteering(&context, request, &response);
    answer = response.input();
    return status;
  }
  v1::ListSteeringResponse List(const std::string& job, std::int64_t start) {
    grpc::ClientContext context;
    v1::ListSteeringRequest request;
    request.set_name(job);
    request.set_start_sequence(start);
    request.set_page_size(500);
    v1::ListSteeringResponse response;
    EXPECT_TRUE(steering_->ListSteering(&context, request, &response).ok());
    return response;
  }
  Stubs& stubs() { return stubs_; }

 private:
  Stubs stubs_;
  std::unique_ptr<v1::SteeringService::Stub> steering_;
};

// Sends random inputs to random jobs.
class Sender {
 public:
  Sender(std::vector<SteeredJob>& jobs, int inputs) : jobs_(jobs), inputs_(inputs) {}

  // Until `end` inputs are acknowledged, or the server is gone; with pauses of up to `pause`.
  void Send(Client& client, int end, std::chrono::microseconds pause) {
    while (acknowledged_ < std::min(end, inputs_)) {
      SteeredJob& job = jobs_[random_() % jobs_.size()];
      if (!job.next.has_changes()) job.next = RandomInput(client, job);
      v1::SteeringInput answer;
      const grpc::Status status = client.Apply(job.name, job.next, answer);
      if (status.error_code() == grpc::StatusCode::UNAVAILABLE) return;
      if (ReasonOfRefusal(status) == "9 STEP_PASSED") {  // never acknowledged: the number is free for another one
        job.next.Clear();
        continue;
      }
      ASSERT_TRUE(status.ok()) << job.steered.name << " " << status.error_message() << "\n"
                               << client.stubs().Get(job.name).DebugString();
      job.acknowledged[answer.sequence()] = answer;
      job.next.Clear();
      ++acknowledged_;
      if (!RepeatOne(client, job)) return;
      LookAtFrames(client, job);
      std::this_thread::sleep_for(pause * static_cast<int>(random_() % 100) / 50);
    }
  }
  int acknowledged() const { return acknowledged_; }

 private:
  static std::string ReasonOfRefusal(const grpc::Status& status) { return status.ok() ? "" : ReasonOf(status); }

  // An earlier input again has the same answer. False if the server is gone.
  bool RepeatOne(Client& client, SteeredJob& job) {
    auto earlier = job.acknowledged.begin();
    std::advance(earlier, random_() % job.acknowledged.size());
    v1::SteeringInput asked = earlier->second, answer;
    asked.clear_step();
    asked.clear_applied();
    asked.clear_accept_time();
    const grpc::Status status = client.Apply(job.name, asked, answer);
    if (!status.ok()) return false;
    if (earlier->second.has_step()) {
      EXPECT_EQ(answer.step(), earlier->second.step());
    }
    EXPECT_EQ(answer.accept_time().nanos(), earlier->second.accept_time().nanos());
    return true;
  }

  static void LookAtFrames(Client& client, SteeredJob& job) {
    grpc::ClientContext context;
    v1::ListFramesRequest request;
    request.set_name(job.name);
    request.set_start_index(job.seen.empty() ? 0 : job.seen.rbegin()->first + 1);
    v1::ListFramesResponse response;
    if (!client.stubs().frames->ListFrames(&context, request, &response).ok()) return;
    for (const v1::FrameInfo& frame : response.frames()) job.seen[frame.index()] = frame.digest();
  }

  double Random(double least, double most) { return std::uniform_real_distribution<double>(least, most)(random_); }

  v1::SteeringInput RandomInput(Client& client, const SteeredJob& job) {
    v1::SteeringInput input;
    input.set_sequence(static_cast<std::int64_t>(job.acknowledged.size()) + 1);
    v1::SteeringChanges& changes = *input.mutable_changes();
    const auto add = [](auto& list, const char* name, double value) {
      v1::SteeredControl& control = *list.Add();
      control.set_name(name);
      control.set_value(value);
    };
    const v1::Scene& scene = job.steered.scene;
    const bool activates = !scene.has_voxel() && random_() % 2 == 0;
    if (activates) add(*changes.mutable_activations(), "muscle", Random(0, 0.1));
    if (!activates || random_() % 2 == 0) add(*changes.mutable_loads(), "muscle/side", Random(0, 2));
    if (random_() % 2 == 0) add(*changes.mutable_loads(), "gravity", Random(0, 2));
    if (random_() % 3 == 0 && !scene.has_eulerian())
      add(*changes.mutable_motions(), "muscle/insertion", Random(0.5, 2));
    changes.set_ramp(random_() % 4 == 0 ? 0.0 : Random(0, 0.05));
    const unsigned when = random_() % 10;
    if (when > 1) return input;
    const v1::Progress progress = client.stubs().Get(job.name).progress();
    if (when == 0) input.set_at_step(progress.step() + 1 + random_() % 50);
    if (when == 1) input.set_at_time(progress.time() + Random(0, 0.05));
    return input;
  }

  std::vector<SteeredJob>& jobs_;
  const int inputs_;
  int acknowledged_ = 0;
  std::mt19937 random_{2026};
};

std::vector<std::string> ServerOptions(const TemporaryFolder& data) {
  return {"--listen", "127.0.0.1:0", "--data", data.path(),   "--checkpoint",
          "0.05",     "--workers",   "6",      "--log-level", "error"};
}

void ExpectAsAcknowledged(Client& client, const SteeredJob& job) {
  std::int64_t next = 1;
  while (next <= static_cast<std::int64_t>(job.acknowledged.size())) {
    const v1::ListSteeringResponse list = client.List(job.name, next);
    ASSERT_GT(list.inputs_size(), 0) << job.steered.name << ": input " << next << " is lost";
    for (const v1::SteeringInput& input : list.inputs()) {
      ASSERT_EQ(input.sequence(), next) << job.steered.name;
      ASSERT_TRUE(job.acknowledged.contains(next)) << "an input that was never sent";
      const v1::SteeringInput& told = job.acknowledged.at(next++);
      if (told.has_step()) {
        EXPECT_EQ(input.step(), told.step()) << job.steered.name;
      }
      EXPECT_EQ(input.changes().SerializeAsString(), told.changes().SerializeAsString());
    }
    EXPECT_EQ(list.next_sequence(), static_cast<std::int64_t>(job.acknowledged.size()) + 1) << job.steered.name;
  }
}

void ExpectFramesAsSeen(Client& client, const SteeredJob& job) {
  EXPECT_EQ(client.stubs().Get(job.name).generation(), 1) << job.steered.name << ": frames were replaced";
  for (const v1::FrameInfo& frame : client.stubs().List(job.name)) {
    const auto seen = job.seen.find(frame.index());
    if (seen == job.seen.end()) continue;
    EXPECT_EQ(seen->second, frame.digest()) << job.steered.name << " " << frame.index();
  }
}

TEST(SteeringKillTest, SteeredJobsAreReplayedToTheLastBit) {
  const int inputs = NumberFrom("FASCICLE_STEERING_INPUTS", 40), kills = NumberFrom("FASCICLE_STEERING_KILLS", 3);
  TemporaryFolder data;
  std::vector<SteeredJob> jobs;
  for (SteeredScene& steered : SteeredScenes()) jobs.push_back({std::move(steered), "", {}, {}, {}});
  Sender sender(jobs, inputs);
  std::mt19937 random(7);
  for (int round = 0; round < kills && !::testing::Test::HasFailure(); ++round) {
    ServerProcess server(ServerOptions(data));
    const std::string address = server.AwaitAddress();
    ASSERT_FALSE(address.empty()) << "round " << round;
    if (round == 0) {
      Stubs stubs(address);
      for (SteeredJob& job : jobs) job.name = stubs.Submit(job.steered.scene);
      for (const SteeredJob& job : jobs) ASSERT_TRUE(stubs.AwaitFrames(job.name, 2)) << job.steered.name;
    }
    Client client(address);
    // A job that makes no progress between twenty kills is taken for their cause.
    for (const SteeredJob& job : jobs) {
      if (round % 8 != 7) break;
      const std::int64_t frames = client.stubs().Get(job.name).frame_count();
      ASSERT_TRUE(client.stubs().AwaitFrames(job.name, frames + 1)) << job.steered.name;
    }
    std::thread steering([&] { sender.Send(client, inputs * (round + 1) / (kills + 1), 10ms); });
    std::this_thread::sleep_for(std::chrono::milliseconds(50 + random() % 500));
    server.Signal(SIGKILL);
    steering.join();
    server.Wait();
  }
  ASSERT_FALSE(::testing::Test::HasFailure());

  ServerProcess server(ServerOptions(data));
  const std::string address = server.AwaitAddress();
  ASSERT_FALSE(address.empty());
  Client client(address);
  sender.Send(client, inputs, 2ms);
  for (const SteeredJob& job : jobs) {
    const auto count = static_cast<std::int64_t>(job.acknowledged.size());
    // Until the last ones have taken effect.
    EXPECT_TRUE(testing::Eventually(
        [&] {
          const v1::ListSteeringResponse list = client.List(job.name, std::max<std::int64_t>(1, count - 400));
          return std::all_of(list.inputs().begin(), list.inputs().end(),
                             [](const auto& input) { return input.applied(); });
        },
        120s))
        << job.steered.name;
  }
  for (const SteeredJob& job : jobs) EXPECT_TRUE(client.stubs().Cancel(job.name).ok());
  std::int64_t frames = 0;
  for (const SteeredJob& job : jobs) {
    ASSERT_TRUE(client.stubs().AwaitState(job.name, v1::Job::STATE_CANCELLED))
        << job.steered.name << client.stubs().Get(job.name).failure().DebugString();
    ExpectAsAcknowledged(client, job);
    ExpectFramesAsSeen(client, job);
    const auto replay = RunProgram({fascicle::testing::Program("fascicle"), "replay", job.name, "--server", address});
    EXPECT_EQ(replay.exit_code, 0) << job.steered.name << ": " << replay.out << replay.err;
    frames += client.stubs().Get(job.name).frame_count();
  }
  if (::testing::Test::HasFailure()) return;
  std::cout << sender.acknowledged() << " inputs to " << jobs.size() << " jobs, " << kills << " kills: 0 lost, "
            << frames << " frames replayed to the last bit\n";
}

}  // namespace
}  // namespace fascicle::service_test
