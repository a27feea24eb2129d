// Damaged data as clients see them: told, and computed again on request.
#include "server/store/database.h"
#include "tests/support/files.h"
#include "tests/support/service_fixture.h"

namespace fascicle::service_test {
namespace {

using fascicle::testing::TemporaryFolder;
using server::EmbeddedServer;

class DamageServiceTest : public ::testing::Test {
 protected:
  void Start() {
    stubs_.reset();
    server_.reset();
    server::ServerOptions options;
    options.data_directory = data_.path();
    server_ = EmbeddedServer::Start(options);
    stubs_.emplace(server_->address());
  }
  // Changes the file of a job while no server runs.
  void Change(const std::string& job, const char* sql) {
    stubs_.reset();
    server_.reset();
    server::Database(data_ / ("jobs/" + job.substr(5) + ".db"), server::Database::Mode::kReadWrite).Execute(sql);
    Start();
  }
  grpc::Status StreamAll(const std::string& job, int& chunks) {
    grpc::ClientContext context;
    v1::StreamFramesRequest request;
    request.set_name(job);
    const auto reader = stubs_->frames->StreamFrames(&context, request);
    v1::StreamFramesResponse message;
    while (reader->Read(&message)) chunks += message.has_chunk();
    return reader->Finish();
  }
  v1::VerifyJobResponse Verify(const std::string& job) {
    grpc::ClientContext context;
    v1::VerifyJobRequest request;
    request.set_name(job);
    v1::VerifyJobResponse response;
    EXPECT_TRUE(stubs_->jobs->VerifyJob(&context, request, &response).ok());
    return response;
  }
  grpc::Status Restart(const std::string& job, bool from_start) {
    grpc::ClientContext context;
    v1::RestartJobRequest request;
    request.set_name(job);
    request.set_from_start(from_start);
    v1::Job response;
    return stubs_->jobs->RestartJob(&context, request, &response);
  }

  TemporaryFolder data_;
  std::unique_ptr<EmbeddedServer> server_;
  std::optional<Stubs> stubs_;
};

TEST_F(DamageServiceTest, ADamagedFrameIsToldAndComputedAgain) {
  Start();
  const std::string job = stubs_->Submit(SwingingBox(0.1, 0.01));
  ASSERT_TRUE(stubs_->AwaitState(job, v1::Job::STATE_SUCCEEDED));
  const std::vector<v1::FrameInfo> before = stubs_->List(job);
  EXPECT_EQ(Verify(job).damages_size(), 0);
  EXPECT_EQ(Verify(job).frames(), 11);

  Change(job, "UPDATE chunks SET bytes = zeroblob(length(bytes)) WHERE frame = 4");
  int chunks = 0;
  EXPECT_EQ(ReasonOf(StreamAll(job, chunks)), "15 DAMAGED");
  EXPECT_EQ(chunks, 4) << "those before it";
  ASSERT_EQ(Verify(job).damages_size(), 1);
  EXPECT_NE(Verify(job).damages(0).find("frame 4"), std::string::npos);

  EXPECT_TRUE(Restart(job, true).ok());
  ASSERT_TRUE(stubs_->AwaitState(job, v1::Job::STATE_SUCCEEDED));
  EXPECT_EQ(Verify(job).damages_size(), 0);
  EXPECT_EQ(stubs_->Get(job).generation(), 1);
  EXPECT_EQ(stubs_->Get(job).attempt(), 2);
  const std::vector<v1::FrameInfo> after = stubs_->List(job);
  ASSERT_EQ(after.size(), before.size());
  for (std::size_t i = 0; i < after.size(); ++i) EXPECT_EQ(after[i].digest(), before[i].digest()) << i;
  chunks = 0;
  EXPECT_TRUE(StreamAll(job, chunks).ok());
}

TEST_F(DamageServiceTest, LostFramesAreTold) {
  Start();
  const std::string job = stubs_->Submit(SwingingBox(0.1, 0.01));
  ASSERT_TRUE(stubs_->AwaitState(job, v1::Job::STATE_SUCCEEDED));
  Change(job, "DELETE FROM frames WHERE idx > 7");
  int chunks = 0;
  EXPECT_EQ(ReasonOf(StreamAll(job, chunks)), "15 DAMAGED");
  EXPECT_EQ(Verify(job).damages_size(), 3);
}

TEST_F(DamageServiceTest, ACancelledJobGoesOnFromItsCheckpoint) {
  Start();
  const std::string job = stubs_->Submit(LongScene());
  ASSERT_TRUE(stubs_->AwaitFrames(job, 20));
  EXPECT_EQ(ReasonOf(Restart(job, false)), "9 JOB_ACTIVE");
  EXPECT_TRUE(stubs_->Cancel(job).ok());
  ASSERT_TRUE(stubs_->AwaitState(job, v1::Job::STATE_CANCELLED));
  const std::int64_t frames = stubs_->Get(job).frame_count();
  EXPECT_TRUE(Restart(job, false).ok());
  EXPECT_TRUE(stubs_->AwaitFrames(job, frames + 5));
  EXPECT_EQ(stubs_->Get(job).generation(), 1);
  EXPECT_TRUE(stubs_->Cancel(job).ok());
  EXPECT_EQ(ReasonOf(Restart("jobs/none", false)), "5 NOT_FOUND");
}

}  // namespace
}  // namespace fascicle::service_test
