// Inputs between clients and a run.
#include "server/jobs/job_steering.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <semaphore>
#include <thread>

#include "tests/support/box_jobs.h"
#include "tests/support/store_samples.h"

namespace fascicle::server {
namespace {

using ::testing::ElementsAre;

SteeringRequest Asap(std::int64_t sequence, const std::string& factor = "2") {
  return {sequence, factor, {{ControlKind::kGravity, 0, std::stod(factor)}}, 0, std::nullopt, std::nullopt};
}

SteeringRequest AtStep(std::int64_t sequence, std::int64_t step) {
  SteeringRequest request = Asap(sequence);
  request.at_step = step;
  return request;
}

SteeringRequest AtTime(std::int64_t sequence, double time) {
  SteeringRequest request = Asap(sequence);
  request.at_time = time;
  return request;
}

std::vector<std::int64_t> SequencesOf(const std::vector<SteeringInput>& inputs) {
  std::vector<std::int64_t> sequences;
  for (const SteeringInput& input : inputs) sequences.push_back(input.sequence);
  return sequences;
}

class JobSteeringTest : public ::testing::Test {
 protected:
  void SetUp() override {
    store_->CreateJob(SampleJob(1), nullptr);
    frames_ = store_->OpenFrames(SampleJob(1).id);
  }
  // As for a run that has made `step` steps.
  void Begin(JobSteering& steering, std::int64_t step) {
    steering.Open(frames_, "", codec_);
    steering.BeginRun(step, "", codec_, [](const std::function<void()>& write) { write(); });
  }

  const std::unique_ptr<Store> store_ = MakeMemoryStore();
  std::shared_ptr<FrameStore> frames_;
  const JobCodec codec_ = BoxCodec();
};

TEST_F(JobSteeringTest, InputsComeWithTheirStepsInTheOrderOfTheirNumbers) {
  JobSteering steering;
  Begin(steering, 0);
  EXPECT_EQ(steering.Apply(Asap(1), false).record->step, 1);
  EXPECT_EQ(steering.Apply(AtTime(2, 0.25), false).record->step, std::nullopt);
  EXPECT_EQ(steering.Apply(AtStep(3, 4), false).record->step, 4);
  EXPECT_EQ(steering.Apply(AtStep(4, 1), false).record->step, 1);
  EXPECT_THAT(SequencesOf(steering.Take(1, 0)), ElementsAre(1, 4));
  EXPECT_EQ(steering.Apply(AtStep(5, 1), false).reason, "STEP_PASSED");
  EXPECT_EQ(steering.Apply(Asap(5), false).record->step, 2);
  EXPECT_THAT(SequencesOf(steering.Take(2, 0.1)), ElementsAre(5));
  EXPECT_THAT(SequencesOf(steering.Take(3, 0.2)), ElementsAre());
  EXPECT_FALSE(steering.TryClose());
  EXPECT_THAT(SequencesOf(steering.Take(4, 0.3)), ElementsAre(2, 3));
  EXPECT_EQ(frames_->ListSteering(2, 1)[0].step, 4) << "now it is known";
  EXPECT_TRUE(steering.TryClose());
  EXPECT_EQ(steering.Apply(Asap(6), false).reason, "JOB_ENDED");
}

TEST_F(JobSteeringTest, InputsThatNoStepHasTakenAreKnown) {
  JobSteering steering;
  Begin(steering, 0);
  steering.Apply(AtTime(1, 9), false);
  steering.Apply(Asap(2), false);
  steering.Apply(AtStep(3, 100), false);
  steering.Take(1, 0);
  steering.Close();
  EXPECT_THAT(steering.Unreached(), ElementsAre(1, 3));
}

TEST_F(JobSteeringTest, ARestartedRunGetsTheInputsAfterItsCheckpoint) {
  {
    JobSteering steering;
    Begin(steering, 0);
    for (const std::int64_t step : {3, 5, 9}) steering.Apply(AtStep(1 + (step > 3) + (step > 5), step), false);
  }
  frames_->PutFrame({0, 0, 0, 0, "digest"}, "x", "");
  frames_->PutFrame({1, 0.7, 7, 0, "digest"}, "x", "");
  JobSteering steering;
  Begin(steering, 4);
  EXPECT_EQ(steering.Apply(AtStep(4, 7), true).reason, "STEP_PASSED") << "a frame of that step is stored";
  EXPECT_EQ(steering.Apply(AtTime(4, 0.65), true).reason, "STEP_PASSED");
  EXPECT_EQ(steering.Apply(Asap(4), false).record->step, 8);
  EXPECT_THAT(SequencesOf(steering.Take(5, 0.4)), ElementsAre(2));
  EXPECT_EQ(steering.Apply(Asap(5), false).record->step, 8);
  EXPECT_THAT(SequencesOf(steering.Take(8, 0.7)), ElementsAre(4, 5));
  EXPECT_THAT(SequencesOf(steering.Take(9, 0.8)), ElementsAre(3));
}

// Holds up or fails PutSteering; forwards nothing else that the test needs.
class SlowFrames final : public FrameStore {
 public:
  explicit SlowFrames(std::shared_ptr<FrameStore> behind) : behind_(std::move(behind)) {}
  void PutSteering(const SteeringRecord& record) override {
    entered.release();
    go_on.acquire();
    if (fails) throw NoSpaceError("full, so the test wants it");
    behind_->PutSteering(record);
  }
  std::vector<SteeringRecord> ListSteering(std::int64_t start, int limit) override {
    return behind_->ListSteering(start, limit);
  }
  void PutGeometry(std::string_view) override {}
  std::optional<std::int64_t> GeometrySize() override { return {}; }
  std::optional<std::string> ReadGeometryChunk(std::int64_t) override { return {}; }
  bool PutFrame(const FrameRecord&, std::string_view, std::string_view, std::span<const LogRow>) override {
    return false;
  }
  void DropCheckpoints() override {}
  std::optional<CheckpointRecord> GetCheckpoint(std::int64_t) override { return {}; }
  std::vector<FrameRecord> ListFrames(std::int64_t, int) override { return {}; }
  std::int64_t replacements() override { return 0; }
  std::int64_t frame_count() override { return 0; }
  std::int64_t stored_bytes() override { return 0; }
  std::optional<std::string> ReadChunk(std::int64_t, std::int64_t) override { return {}; }
  void PutLog(std::span<const LogRow>) override {}
  std::vector<LogRow> ReadLog(std::int64_t, int) override { return {}; }
  std::int64_t log_end() override { return 0; }

  std::binary_semaphore entered{0}, go_on{0};
  std::atomic<bool> fails = false;

 private:
  const std::shared_ptr<FrameStore> behind_;
};

TEST_F(JobSteeringTest, AStepWaitsForAnInputThatIsBeingStored) {
  for (const bool fails : {false, true}) {
    const auto slow = std::make_shared<SlowFrames>(frames_);
    slow->fails = fails;
    frames_ = slow;
    JobSteering steering;
    Begin(steering, 10);
    const std::int64_t sequence = fails ? 2 : 1;
    std::atomic<bool> taken = false;
    std::thread client([&] {
      try {
        EXPECT_EQ(steering.Apply(Asap(sequence), false).record->step, 11);
        EXPECT_FALSE(fails);
      } catch (const NoSpaceError&) {
        EXPECT_TRUE(fails);
      }
    });
    slow->entered.acquire();
    std::vector<SteeringInput> inputs;
    std::thread run([&] {
      inputs = steering.Take(11, 1);
      taken = true;
    });
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    EXPECT_FALSE(taken) << "it may still be stored";
    slow->go_on.release();
    client.join();
    run.join();
    EXPECT_THAT(SequencesOf(inputs), ElementsAre(1)) << "the one that is stored";
    EXPECT_EQ(frames_->ListSteering(1, 10).size(), 1u);
  }
}

// The run has ended, but the input that is being stored will be acknowledged: it is told as not reached.
TEST_F(JobSteeringTest, TheEndWaitsForAnInputThatIsBeingStored) {
  const auto slow = std::make_shared<SlowFrames>(frames_);
  frames_ = slow;
  JobSteering steering;
  Begin(steering, 10);
  std::thread client([&] { EXPECT_TRUE(steering.Apply(Asap(1), false).record.has_value()); });
  slow->entered.acquire();
  std::vector<std::int64_t> unreached;
  std::thread run([&] {
    steering.Close();
    unreached = steering.Unreached();
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  slow->go_on.release();
  client.join();
  run.join();
  EXPECT_THAT(unreached, ElementsAre(1));
}

// A real job: replayed with other step boundaries it would differ.
TEST_F(JobSteeringTest, ASteeredJobIsTheSameAfterADrain) {
  const BoxSpec spec = {.duration = 4, .frame_interval = 0.02};
  std::vector<std::string> digests[2];
  for (const bool interrupted : {false, true}) {
    const std::unique_ptr<Store> store = MakeMemoryStore();
    auto manager = std::make_unique<JobManager>(*store, BoxCodec(), Workers(0));
    const std::string id = manager->Submit(BoxJob(spec), nullptr).record.id;
    for (int k = 1; k <= 20; ++k) {
      SteeringRequest request = AtStep(k, 400 + 1700 * k);
      request.input = std::to_string(1 + 0.1 * k);
      request.controls[0].value = std::stod(request.input);
      ASSERT_TRUE(manager->Steer(id, request, false)->record.has_value()) << k;
    }
    manager.reset();
    manager = std::make_unique<JobManager>(*store, BoxCodec(), Workers(1));
    for (std::int64_t frames = 20; interrupted && frames < 180; frames += 40) {
      ASSERT_TRUE(WaitForFrames(*manager, id, frames));
      manager.reset();
      manager = std::make_unique<JobManager>(*store, BoxCodec(), Workers(1));
    }
    EXPECT_EQ(WaitForEnd(*manager, id).record.state, JobState::kSucceeded);
    EXPECT_EQ(manager->Get(id)->record.generation, 1);
    digests[interrupted] = StoredDigests(*manager->Frames(id));
    // The log has each input once, with its step.
    int inputs = 0;
    for (const LogRow& row : manager->Frames(id)->ReadLog(0, 1 << 20)) {
      if (!row.bytes.starts_with("3 ")) continue;
      EXPECT_EQ(row.bytes, "3 step " + std::to_string(400 + 1700 * ++inputs) + " ");
    }
    EXPECT_EQ(inputs, 20);
  }
  EXPECT_EQ(digests[0].size(), 201u);
  EXPECT_EQ(digests[0], digests[1]);
  EXPECT_NE(digests[0], DigestsByCore(spec));
}

}  // namespace
}  // namespace fascicle::server
