// Jobs that go from one server to another as files.
#include <chrono>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>

#include "fascicle/v1/steering_service.grpc.pb.h"
#include "fascicle/v1/transfer_service.grpc.pb.h"
#include "proto/frames/frame_digest.h"
#include "server/store/database.h"
#include "tests/support/files.h"
#include "tests/support/service_fixture.h"
#include "tests/support/steered_scenes.h"

namespace fascicle::service_test {
namespace {

using testing::ReadFile;
using testing::TemporaryFolder;

// The bytes of an export.
grpc::Status Export(Stubs& stubs, const std::string& job, std::string& bytes) {
  const auto transfers = v1::TransferService::NewStub(stubs.channel);
  grpc::ClientContext context;
  v1::ExportJobRequest request;
  request.set_name(job);
  const auto reader = transfers->ExportJob(&context, request);
  v1::ExportJobResponse message;
  bytes.clear();
  while (reader->Read(&message)) {
    EXPECT_EQ(message.chunk().offset(), static_cast<std::int64_t>(bytes.size()));
    EXPECT_EQ(message.chunk().crc32c(), Crc32c(message.chunk().data()));
    bytes += message.chunk().data();
  }
  return reader->Finish();
}

struct ImportWish {
  std::string request_id = {};
  bool new_name = false;
  std::int64_t size = -1;  // announced; negative: that of the bytes
};

grpc::Status Import(Stubs& stubs, const std::string& bytes, const ImportWish& wish, v1::Job& job) {
  const auto transfers = v1::TransferService::NewStub(stubs.channel);
  grpc::ClientContext context;
  const auto writer = transfers->ImportJob(&context, &job);
  v1::ImportJobRequest request;
  request.set_size(wish.size < 0 ? static_cast<std::int64_t>(bytes.size()) : wish.size);
  request.set_request_id(wish.request_id);
  request.set_new_name(wish.new_name);
  bool open = true;
  for (std::size_t at = 0; open && (at == 0 || at < bytes.size()); at += 1 << 20) {
    request.set_data(bytes.substr(at, 1 << 20));
    open = writer->Write(request);
    request.Clear();
  }
  writer->WritesDone();
  return writer->Finish();
}

class TransferTest : public ::testing::Test {
 protected:
  struct Place {
    explicit Place(std::chrono::milliseconds idle = 60s, std::int64_t max_stored_per_owner = 0) {
      server::ServerOptions options;
      options.data_directory = data.path();
      options.transfer_idle = idle;
      options.max_stored_per_owner = max_stored_per_owner;
      server = server::EmbeddedServer::Start(options);
      stubs.emplace(server->address());
    }
    std::size_t Transfers() const {
      const auto entries = std::filesystem::directory_iterator(data.path() / "transfers");
      return static_cast<std::size_t>(std::distance(begin(entries), end(entries)));
    }
    std::size_t JobFiles() const {
      std::size_t count = 0;
      for (const auto& entry : std::filesystem::directory_iterator(data.path() / "jobs")) {
        count += entry.path().extension() == ".db";
      }
      return count;
    }
    TemporaryFolder data;
    std::unique_ptr<server::EmbeddedServer> server;
    std::optional<Stubs> stubs;
  };

  std::string Finished(Place& place) {
    v1::Scene scene = SwingingBox(0.1, 0.01);
    scene.mutable_output()->add_fields(v1::FIELD_VELOCITY);
    std::string name = place.stubs->Submit(scene);
    EXPECT_TRUE(place.stubs->AwaitState(name, v1::Job::STATE_SUCCEEDED));
    return name;
  }
};

TEST_F(TransferTest, AJobOfAnotherServerIsAJobOfThisOne) {
  Place here, there;
  const std::string name = Finished(here);
  std::string bytes;
  ASSERT_TRUE(Export(*here.stubs, name, bytes).ok());
  v1::Job job;
  const grpc::Status status = Import(*there.stubs, bytes, {}, job);
  ASSERT_TRUE(status.ok()) << status.error_message();
  EXPECT_EQ(job.name(), name) << "its name is free there";
  const v1::Job before = here.stubs->Get(name), after = there.stubs->Get(name);
  EXPECT_EQ(after.state(), v1::Job::STATE_SUCCEEDED);
  EXPECT_EQ(after.imported().original_name(), name);
  EXPECT_FALSE(before.has_imported());
  EXPECT_EQ(after.scene().SerializeAsString(), before.scene().SerializeAsString());
  EXPECT_EQ(after.create_time().seconds(), before.create_time().seconds());
  EXPECT_EQ(after.profile().SerializeAsString(), before.profile().SerializeAsString());
  EXPECT_EQ(after.stored_bytes(), before.stored_bytes());
  const StreamRecord original = ReadStream(*here.stubs, AllFramesOf(name));
  const StreamRecord copy = ReadStream(*there.stubs, AllFramesOf(name));
  ASSERT_EQ(copy.frames.size(), 11u);
  for (std::size_t i = 0; i < copy.frames.size(); ++i) {
    EXPECT_EQ(copy.frames[i].SerializeAsString(), original.frames[i].SerializeAsString());
  }
  EXPECT_EQ(here.Transfers() + there.Transfers(), 0u) << "no file is left";

  // Listed, verified, and selected from as its own.
  grpc::ClientContext list, verify;
  v1::ListJobsResponse jobs;
  ASSERT_TRUE(there.stubs->jobs->ListJobs(&list, {}, &jobs).ok());
  ASSERT_EQ(jobs.jobs_size(), 1);
  EXPECT_TRUE(jobs.jobs(0).has_imported());
  v1::VerifyJobRequest verified;
  verified.set_name(name);
  v1::VerifyJobResponse found;
  ASSERT_TRUE(there.stubs->jobs->VerifyJob(&verify, verified, &found).ok());
  EXPECT_EQ(found.frames(), 11);
  EXPECT_EQ(found.damages_size(), 0);
}

// The inputs of a job go with it: computed again over there, its frames are the same.
TEST_F(TransferTest, ASteeredJobTakesItsInputsAlong) {
  Place here, there;
  v1::CreateJobRequest request;
  *request.mutable_job()->mutable_scene() = SteeredBlock("tet { stepping: STEPPING_QUASI_STATIC }", kSoftMuscle);
  request.mutable_job()->mutable_scene()->set_duration(0.1);
  request.mutable_job()->set_owner("ann");
  (*request.mutable_job()->mutable_labels())["study"] = "knee";
  v1::SteeringInput& input = *request.mutable_job()->add_inputs();
  input.set_sequence(1);
  input.set_at_time(0.035);
  v1::SteeredControl& control = *input.mutable_changes()->add_activations();
  control.set_name("muscle");
  control.set_value(0.3);
  v1::Job job, imported;
  ASSERT_TRUE(here.stubs->Create(request, job).ok());
  ASSERT_TRUE(here.stubs->AwaitState(job.name(), v1::Job::STATE_SUCCEEDED));
  std::string bytes;
  ASSERT_TRUE(Export(*here.stubs, job.name(), bytes).ok());
  const grpc::Status status = Import(*there.stubs, bytes, {}, imported);
  ASSERT_TRUE(status.ok()) << status.error_message();
  EXPECT_EQ(imported.owner(), "ann");
  EXPECT_EQ(imported.labels().at("study"), "knee");
  EXPECT_TRUE(imported.pinned()) << "it may have ended longer ago than jobs are kept";

  const auto inputs_at = [&](Place& place) {
    grpc::ClientContext context;
    v1::ListSteeringRequest list;
    list.set_name(job.name());
    v1::ListSteeringResponse found;
    EXPECT_TRUE(v1::SteeringService::NewStub(place.stubs->channel)->ListSteering(&context, list, &found).ok());
    return found;
  };
  const v1::ListSteeringResponse before = inputs_at(here), after = inputs_at(there);
  ASSERT_EQ(before.inputs_size(), 1);
  ASSERT_EQ(after.inputs_size(), 1);
  EXPECT_GT(before.inputs(0).step(), 1);
  EXPECT_EQ(after.inputs(0).step(), before.inputs(0).step());

  grpc::ClientContext context;
  v1::RestartJobRequest restart;
  restart.set_name(job.name());
  restart.set_from_start(true);
  v1::Job again;
  ASSERT_TRUE(there.stubs->jobs->RestartJob(&context, restart, &again).ok());
  ASSERT_TRUE(there.stubs->AwaitState(job.name(), v1::Job::STATE_SUCCEEDED));
  EXPECT_EQ(there.stubs->Get(job.name()).generation(), imported.generation()) << "a frame was replaced";
  EXPECT_EQ(there.stubs->Get(job.name()).imported().SerializeAsString(), imported.imported().SerializeAsString());
  const auto original = here.stubs->List(job.name()), computed = there.stubs->List(job.name());
  ASSERT_EQ(computed.size(), original.size());
  for (std::size_t k = 0; k < computed.size(); ++k) EXPECT_EQ(computed[k].digest(), original[k].digest()) << k;
}

TEST_F(TransferTest, ATakenNameIsReplacedAndARequestCountsOnce) {
  Place here;
  const std::string name = Finished(here);
  std::string bytes;
  ASSERT_TRUE(Export(*here.stubs, name, bytes).ok());
  v1::Job first, again, other;
  ASSERT_TRUE(Import(*here.stubs, bytes, {.request_id = "one"}, first).ok());
  EXPECT_NE(first.name(), name);
  EXPECT_EQ(first.imported().original_name(), name);
  ASSERT_TRUE(Import(*here.stubs, bytes, {.request_id = "one"}, again).ok());
  EXPECT_EQ(again.name(), first.name());
  EXPECT_EQ(here.JobFiles(), 2u) << "what the repeated request brought is gone";
  ASSERT_TRUE(Import(*here.stubs, bytes, {.request_id = "two", .new_name = true}, other).ok());
  EXPECT_NE(other.name(), first.name());
}

// A request that is repeated, because its reply was lost, is answered although the job it made has filled the limit.
TEST_F(TransferTest, TheLimitOfAnOwnerHoldsForImports) {
  Place here, there(60s, 1);
  std::string bytes;
  ASSERT_TRUE(Export(*here.stubs, Finished(here), bytes).ok());
  v1::Job first, again, other;
  ASSERT_TRUE(Import(*there.stubs, bytes, {.request_id = "one"}, first).ok());
  ASSERT_TRUE(Import(*there.stubs, bytes, {.request_id = "one"}, again).ok());
  EXPECT_EQ(again.name(), first.name());
  EXPECT_EQ(ReasonOf(Import(*there.stubs, bytes, {.request_id = "two", .new_name = true}, other)), "8 OWNER_LIMIT");
  EXPECT_EQ(there.JobFiles(), 1u);
}

TEST_F(TransferTest, AJobThatRunsIsCancelledInTheCopy) {
  Place here, there;
  const std::string name = here.stubs->Submit(LongScene());
  ASSERT_TRUE(here.stubs->AwaitFrames(name, 10));
  std::string bytes;
  ASSERT_TRUE(Export(*here.stubs, name, bytes).ok());
  v1::Job job;
  ASSERT_TRUE(Import(*there.stubs, bytes, {}, job).ok());
  EXPECT_EQ(job.state(), v1::Job::STATE_CANCELLED);
  EXPECT_EQ(job.imported().original_state(), v1::Job::STATE_RUNNING);
  EXPECT_GE(job.frame_count(), 10);
  EXPECT_TRUE(here.stubs->Cancel(name).ok());
  // It goes on there, from the start.
  grpc::ClientContext context;
  v1::RestartJobRequest request;
  request.set_name(job.name());
  v1::Job restarted;
  ASSERT_TRUE(there.stubs->jobs->RestartJob(&context, request, &restarted).ok());
  EXPECT_TRUE(there.stubs->AwaitFrames(job.name(), job.frame_count() + 5));
  EXPECT_EQ(there.stubs->Get(job.name()).generation(), 1) << "the frames came out the same";
  EXPECT_TRUE(there.stubs->Cancel(job.name()).ok());
}

TEST_F(TransferTest, WrongUploadsLeaveNothing) {
  Place here, there;
  std::string bytes;
  ASSERT_TRUE(Export(*here.stubs, Finished(here), bytes).ok());
  v1::Job job;
  EXPECT_EQ(ReasonOf(Import(*there.stubs, bytes, {.size = 5}, job)), "3 SIZE_MISMATCH");
  EXPECT_EQ(ReasonOf(Import(*there.stubs, bytes, {.size = static_cast<std::int64_t>(bytes.size()) + 1}, job)),
            "3 SIZE_MISMATCH");
  EXPECT_EQ(ReasonOf(Import(*there.stubs, bytes, {.size = 0}, job)), "3 INVALID_ARGUMENT");
  EXPECT_EQ(ReasonOf(Import(*there.stubs, "not a job", {}, job)), "3 NOT_A_JOB");
  EXPECT_EQ(ReasonOf(Import(*there.stubs, bytes, {.size = std::int64_t{1} << 40}, job)), "8 DISK_FULL");
  EXPECT_EQ(ReasonOf(Import(*there.stubs, bytes, {.request_id = std::string(65, 'x')}, job)), "3 INVALID_ARGUMENT");
  std::string none;
  EXPECT_EQ(ReasonOf(Export(*there.stubs, "jobs/none", none)), "5 NOT_FOUND");
  EXPECT_EQ(ReasonOf(Export(*there.stubs, "none", none)), "3 INVALID_ARGUMENT");
  EXPECT_TRUE(testing::Eventually([&] { return there.Transfers() + there.JobFiles() == 0; }));
  grpc::ClientContext context;
  v1::ListJobsResponse jobs;
  ASSERT_TRUE(there.stubs->jobs->ListJobs(&context, {}, &jobs).ok());
  EXPECT_EQ(jobs.jobs_size(), 0);
}

// Rows with valid checksums whose frame is not the one that ran: SQL and a CRC are no secret.
TEST_F(TransferTest, ChangedNumbersAreRefusedByTheirDigest) {
  Place here, there;
  std::string bytes;
  ASSERT_TRUE(Export(*here.stubs, Finished(here), bytes).ok());
  const TemporaryFolder folder;
  const std::string path = folder.Write("job", bytes);
  v1::Frame frame;
  {
    server::Database database(path, server::Database::Mode::kReadWrite);
    server::Statement read = database.Prepare("SELECT bytes FROM chunks WHERE number = 4");
    {
      server::Rows rows = read.Query();
      ASSERT_TRUE(rows.Next() && frame.ParseFromString(rows.String(0)));
    }
    (*frame.mutable_bodies(0)->mutable_positions())[3] ^= 1;
    const std::string changed = frame.SerializeAsString();
    database.Prepare("UPDATE chunks SET bytes = ?1, checksum = row_checksum(number, frame, chunk, ?1) WHERE number = 4")
        .Run(server::Blob{changed});
  }
  v1::Job job;
  const grpc::Status status = Import(*there.stubs, ReadFile(path), {}, job);
  EXPECT_EQ(ReasonOf(status), "3 NOT_A_JOB");
  const auto bad = DetailOf<google::rpc::BadRequest>(status);
  ASSERT_TRUE(bad && bad->field_violations_size() == 1);
  EXPECT_NE(bad->field_violations(0).description().find("frame 4"), std::string::npos);
  EXPECT_EQ(there.JobFiles(), 0u);
}

TEST_F(TransferTest, IdleUploadsEnd) {
  Place there(300ms);
  const auto transfers = v1::TransferService::NewStub(there.stubs->channel);
  grpc::ClientContext context;
  v1::Job job;
  const auto writer = transfers->ImportJob(&context, &job);
  v1::ImportJobRequest request;
  request.set_size(1000);
  request.set_data("SQLite");
  ASSERT_TRUE(writer->Write(request));
  EXPECT_EQ(ReasonOf(writer->Finish()), "10 IDLE");
  EXPECT_TRUE(testing::Eventually([&] { return there.Transfers() == 0; }));
}

TEST_F(TransferTest, ANameFromTheFutureIsNotKept) {
  Place here, there;
  std::string bytes;
  ASSERT_TRUE(Export(*here.stubs, Finished(here), bytes).ok());
  const TemporaryFolder folder;
  const std::string path = folder.Write("job", bytes);
  for (const std::string& wrong : {std::string("jobs/zzzzzzzzzzzzzzzzzzzzzzzzzz"), std::string("jobs/../../control")}) {
    v1::Job inside;
    {
      server::Database database(path, server::Database::Mode::kReadWrite);
      server::Statement read = database.Prepare("SELECT bytes FROM job WHERE part = 0");
      {
        server::Rows rows = read.Query();
        ASSERT_TRUE(rows.Next() && inside.ParseFromString(rows.String(0)));
      }
      inside.set_name(wrong);
      const std::string changed = inside.SerializeAsString();
      database.Prepare("UPDATE job SET bytes = ?1, checksum = row_checksum(part, ?1) WHERE part = 0")
          .Run(server::Blob{changed});
    }
    v1::Job job;
    ASSERT_TRUE(Import(*there.stubs, ReadFile(path), {}, job).ok());
    EXPECT_NE(job.name(), wrong);
    EXPECT_LT(job.name(), "jobs/1");
    EXPECT_EQ(there.stubs->Get(job.name()).frame_count(), 11);
  }
}

}  // namespace
}  // namespace fascicle::service_test
