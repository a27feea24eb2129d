// Steering and logs of jobs, over the service.
#include <algorithm>
#include <map>
#include <set>

#include "fascicle/v1/log_service.grpc.pb.h"
#include "fascicle/v1/steering_service.grpc.pb.h"
#include "tests/support/files.h"
#include "tests/support/service_fixture.h"
#include "tests/support/steered_scenes.h"

namespace fascicle::service_test {
namespace {

v1::SteeringInput Input(std::int64_t sequence, double activation) {
  v1::SteeringInput input;
  input.set_sequence(sequence);
  v1::SteeredControl& control = *input.mutable_changes()->add_activations();
  control.set_name("muscle");
  control.set_value(activation);
  return input;
}

class SteeringServiceTest : public ServiceTest {
 protected:
  void SetUp() override {
    ServiceTest::SetUp();
    steering_ = v1::SteeringService::NewStub(stubs_->channel);
    logs_ = v1::LogService::NewStub(stubs_->channel);
  }
  std::string Start(const std::string& method = "tet {}") {
    const std::string job = stubs_->Submit(SteeredBlock(method, kSoftMuscle));
    EXPECT_TRUE(stubs_->AwaitFrames(job, 2));
    return job;
  }
  grpc::Status Apply(const std::string& job, const v1::SteeringInput& input, v1::SteeringInput* answer = nullptr) {
    grpc::ClientContext context;
    v1::ApplySteeringRequest request;
    request.set_name(job);
    *request.mutable_input() = input;
    v1::ApplySteeringResponse response;
    const grpc::Status status = steering_->ApplySteering(&context, request, &response);
    if (answer != nullptr) *answer = response.input();
    return status;
  }
  v1::ListSteeringResponse List(const std::string& job) {
    grpc::ClientContext context;
    v1::ListSteeringRequest request;
    request.set_name(job);
    v1::ListSteeringResponse response;
    EXPECT_TRUE(steering_->ListSteering(&context, request, &response).ok());
    return response;
  }
  std::vector<v1::LogLine> Log(const std::string& job, int tail = 0, bool follow = false) {
    grpc::ClientContext context;
    v1::StreamLogRequest request;
    request.set_name(job);
    request.set_tail(tail);
    request.set_follow(follow);
    const auto reader = logs_->StreamLog(&context, request);
    v1::StreamLogResponse message;
    std::vector<v1::LogLine> lines;
    bool ended = false;
    while (reader->Read(&message)) {
      EXPECT_FALSE(ended);
      lines.insert(lines.end(), message.lines().begin(), message.lines().end());
      ended = message.has_job();
    }
    EXPECT_TRUE(reader->Finish().ok());
    EXPECT_TRUE(ended);
    return lines;
  }

  std::unique_ptr<v1::SteeringService::Stub> steering_;
  std::unique_ptr<v1::LogService::Stub> logs_;
};

TEST_F(SteeringServiceTest, AnInputTakesEffectWithTheStepThatIsTold) {
  const std::string job = Start();
  const std::int64_t before = stubs_->Get(job).progress().step();
  v1::SteeringInput first, later, at_time;
  ASSERT_TRUE(Apply(job, Input(1, 0.5), &first).ok());
  EXPECT_GT(first.step(), before);
  EXPECT_EQ(first.changes().ramp(), 0.01) << "the frame interval";
  EXPECT_GT(first.accept_time().seconds(), 1'600'000'000);
  v1::SteeringInput input = Input(2, 0.1);
  input.set_at_step(first.step() + 1000);
  input.mutable_changes()->set_ramp(0);
  ASSERT_TRUE(Apply(job, input, &later).ok());
  EXPECT_EQ(later.step(), first.step() + 1000);
  input = Input(3, 0.2);
  input.set_at_time(stubs_->Get(job).progress().time() + 0.5);
  ASSERT_TRUE(Apply(job, input, &at_time).ok());
  EXPECT_FALSE(at_time.has_step());

  ASSERT_TRUE(testing::Eventually([&] {
    const v1::ListSteeringResponse list = List(job);
    return list.inputs_size() == 3 && list.inputs(1).applied() && list.inputs(2).applied();
  }));
  const v1::ListSteeringResponse list = List(job);
  EXPECT_EQ(list.next_sequence(), 4);
  EXPECT_EQ(list.inputs(0).step(), first.step());
  EXPECT_GT(list.inputs(2).step(), first.step()) << "now it is known";
  EXPECT_EQ(std::vector<std::string>(list.activations().begin(), list.activations().end()),
            std::vector<std::string>{"muscle"});
  EXPECT_EQ(std::vector<std::string>(list.loads().begin(), list.loads().end()),
            (std::vector<std::string>{"muscle/side", "gravity"}));
  EXPECT_EQ(std::vector<std::string>(list.motions().begin(), list.motions().end()),
            std::vector<std::string>{"muscle/insertion"});

  ASSERT_TRUE(stubs_->Cancel(job).ok());
  ASSERT_TRUE(stubs_->AwaitState(job, v1::Job::STATE_CANCELLED));
  std::map<std::int64_t, std::int64_t> taken;  // step of each input, as the log tells
  for (const v1::LogLine& line : Log(job)) {
    if (line.kind() == v1::LogLine::KIND_INPUT) taken[line.sequence()] = line.step();
  }
  EXPECT_EQ(taken,
            (std::map<std::int64_t, std::int64_t>{{1, first.step()}, {2, later.step()}, {3, list.inputs(2).step()}}));
  EXPECT_EQ(ReasonOf(Apply(job, Input(4, 0.5))), "9 JOB_ENDED");
  v1::SteeringInput again;
  EXPECT_TRUE(Apply(job, Input(1, 0.5), &again).ok()) << "an answer that was lost";
  EXPECT_EQ(again.step(), first.step());
}

TEST_F(SteeringServiceTest, ANumberIsForOneInput) {
  const std::string job = Start();
  v1::SteeringInput first, again;
  ASSERT_TRUE(Apply(job, Input(1, 0.5), &first).ok());
  EXPECT_TRUE(Apply(job, Input(1, 0.5), &again).ok());
  EXPECT_EQ(again.step(), first.step());
  EXPECT_EQ(List(job).inputs_size(), 1);
  EXPECT_EQ(ReasonOf(Apply(job, Input(1, 0.6))), "9 SEQUENCE_REUSED");
  EXPECT_EQ(ReasonOf(Apply(job, Input(3, 0.6))), "9 SEQUENCE_GAP");
  EXPECT_EQ(ReasonOf(Apply(job, Input(0, 0.6))), "9 SEQUENCE_GAP");
  v1::SteeringInput passed = Input(2, 0.5);
  passed.set_at_step(1);
  EXPECT_EQ(ReasonOf(Apply(job, passed)), "9 STEP_PASSED");
  passed.clear_at_step();
  passed.set_at_time(0.001);
  EXPECT_EQ(ReasonOf(Apply(job, passed)), "9 STEP_PASSED");
  EXPECT_EQ(ReasonOf(Apply("jobs/none", Input(1, 0.5))), "5 NOT_FOUND");
  EXPECT_EQ(List(job).inputs_size(), 1);
  EXPECT_TRUE(stubs_->Cancel(job).ok());
}

TEST_F(SteeringServiceTest, EveryProblemIsToldAtOnce) {
  const std::string job = Start();
  v1::SteeringInput input = Input(7, 1.5);
  const auto add = [](auto& list, const char* name, double value) {
    list.Add()->set_name(name);
    list.Mutable(list.size() - 1)->set_value(value);
  };
  add(*input.mutable_changes()->mutable_activations(), "biceps", 0.5);
  add(*input.mutable_changes()->mutable_loads(), "muscle/side", 1e9);
  add(*input.mutable_changes()->mutable_loads(), "muscle/side", 1);
  add(*input.mutable_changes()->mutable_motions(), "muscle/origin", 1);
  input.mutable_changes()->set_ramp(-1);
  input.set_at_step(1);
  input.set_at_time(1e4);
  const auto bad = DetailOf<google::rpc::BadRequest>(Apply(job, input));
  ASSERT_TRUE(bad.has_value());
  std::set<std::string> fields;
  for (const auto& violation : bad->field_violations()) fields.insert(violation.field());
  EXPECT_EQ(fields, (std::set<std::string>{"input.changes.activations[0].value", "input.changes.activations[1].name",
                                           "input.changes.loads[0].value", "input.changes.loads[1].name",
                                           "input.changes.motions[0].name", "input.changes.ramp", "input.at_time",
                                           "input.sequence", "input.at_step"}));
  EXPECT_EQ(List(job).inputs_size(), 0);
  v1::SteeringInput empty;
  empty.set_sequence(1);
  EXPECT_EQ(ReasonOf(Apply(job, empty)), "3 INVALID_ARGUMENT");
  EXPECT_TRUE(stubs_->Cancel(job).ok());
}

// The inputs of a job's specification are applied from the start.
TEST_F(SteeringServiceTest, AJobMayBringItsInputs) {
  v1::CreateJobRequest request;
  *request.mutable_job()->mutable_scene() = SteeredBlock("tet { stepping: STEPPING_QUASI_STATIC }", kSoftMuscle);
  request.mutable_job()->mutable_scene()->set_duration(0.1);
  v1::Job plain, steered;
  ASSERT_TRUE(stubs_->Create(request, plain).ok());
  *request.mutable_job()->add_inputs() = Input(1, 0.3);
  request.mutable_job()->mutable_inputs(0)->set_at_step(4);
  *request.mutable_job()->add_inputs() = Input(2, 0.4);
  request.mutable_job()->mutable_inputs(1)->set_at_step(1'000'000);
  ASSERT_TRUE(stubs_->Create(request, steered).ok());
  for (const v1::Job* job : {&plain, &steered}) {
    ASSERT_TRUE(stubs_->AwaitState(job->name(), v1::Job::STATE_SUCCEEDED));
  }
  const auto without = stubs_->List(plain.name()), with = stubs_->List(steered.name());
  ASSERT_EQ(without.size(), 11u);
  ASSERT_EQ(with.size(), 11u);
  for (std::size_t k = 0; k < 11; ++k) EXPECT_EQ(without[k].digest() == with[k].digest(), with[k].step() < 4) << k;
  EXPECT_TRUE(List(steered.name()).inputs(0).applied());
  EXPECT_FALSE(List(steered.name()).inputs(1).applied());
  const auto warnings_of = [&](const v1::Job& job) {
    std::string reasons;
    const v1::Job ended = stubs_->Get(job.name());
    for (const v1::Warning& warning : ended.warnings()) reasons += warning.reason() + " ";
    return reasons;
  };
  EXPECT_EQ(warnings_of(steered), warnings_of(plain) + "INPUT_NOT_REACHED ");
  request.mutable_job()->mutable_inputs(0)->set_sequence(2);
  EXPECT_EQ(ReasonOf(stubs_->Create(request, plain)), "3 INVALID_ARGUMENT");
}

TEST_F(SteeringServiceTest, ALogIsFollowedToTheEndOfItsJob) {
  for (const SteeredScene& steered : SteeredScenes()) {
    v1::Scene scene = steered.scene;
    scene.set_duration(0.05);
    const std::string job = stubs_->Submit(scene);
    const std::vector<v1::LogLine> followed = Log(job, 0, true);
    ASSERT_EQ(stubs_->Get(job).state(), v1::Job::STATE_SUCCEEDED) << steered.name << stubs_->Get(job).DebugString();
    const std::vector<v1::LogLine> read = Log(job);
    ASSERT_EQ(read.size(), followed.size()) << steered.name;
    std::int64_t frames = 0, steps = 0, iterations = 0;
    for (std::size_t k = 0; k < read.size(); ++k) {
      EXPECT_EQ(read[k].number(), static_cast<std::int64_t>(k));
      EXPECT_EQ(read[k].SerializeAsString(), followed[k].SerializeAsString());
      frames += read[k].kind() == v1::LogLine::KIND_FRAME;
      if (read[k].kind() != v1::LogLine::KIND_STEP) continue;
      steps += read[k].steps();
      iterations += read[k].iterations();
      EXPECT_GT(read[k].time_step(), 0);
      EXPECT_EQ(read[k].has_residual(), steered.name != "explicit") << steered.name;
    }
    EXPECT_EQ(frames, 6) << steered.name;
    EXPECT_GE(steps, 5) << steered.name;
    EXPECT_EQ(iterations > 0, steered.name != "explicit") << steered.name;
    EXPECT_EQ(Log(job, 3).size(), 3u);
    EXPECT_EQ(Log(job, 3)[0].SerializeAsString(), read[read.size() - 3].SerializeAsString());
  }
}

}  // namespace
}  // namespace fascicle::service_test
