// Every way in which a call can be wrong, and the error that clients get.
#include <algorithm>
#include <string>
#include <vector>

#include <grpcpp/generic/generic_stub.h>

#include "tests/support/service_fixture.h"

namespace fascicle::service_test {
namespace {

using ErrorsTest = ServiceTest;

std::vector<std::string> FieldsOf(const grpc::Status& status) {
  std::vector<std::string> fields;
  if (const auto bad = DetailOf<google::rpc::BadRequest>(status)) {
    for (const auto& violation : bad->field_violations()) fields.push_back(violation.field());
  }
  return fields;
}

bool Contains(const std::vector<std::string>& list, const std::string& wanted) {
  return std::find(list.begin(), list.end(), wanted) != list.end();
}

TEST_F(ErrorsTest, AWrongSceneIsRefusedWithEveryProblemAndNothingIsLeft) {
  v1::CreateJobRequest request;
  *request.mutable_job()->mutable_scene() = SwingingBox(1, 0.1);
  request.mutable_job()->mutable_scene()->set_duration(-1);
  request.mutable_job()->mutable_scene()->mutable_bodies(0)->set_density(-5);
  request.mutable_job()->mutable_scene()->mutable_bodies(0)->mutable_constraints(0)->set_region("nowhere");
  v1::Job job;
  const grpc::Status status = stubs_->Create(request, job);
  EXPECT_EQ(ReasonOf(status), "3 INVALID_ARGUMENT");
  const auto fields = FieldsOf(status);
  EXPECT_TRUE(Contains(fields, "job.scene.duration")) << status.error_message();
  EXPECT_TRUE(Contains(fields, "job.scene.bodies[0].density"));
  EXPECT_TRUE(Contains(fields, "job.scene.bodies[0].constraints[0].region"));

  grpc::ClientContext context;
  v1::ListJobsResponse list;
  ASSERT_TRUE(stubs_->jobs->ListJobs(&context, {}, &list).ok());
  EXPECT_EQ(list.jobs_size(), 0);
}

TEST_F(ErrorsTest, RequestsWithoutAJobOrOutOfRange) {
  v1::CreateJobRequest request;
  v1::Job job;
  grpc::Status status = stubs_->Create(request, job);
  EXPECT_EQ(FieldsOf(status), std::vector<std::string>{"job.scene"});
  *request.mutable_job()->mutable_scene() = SwingingBox(1, 0.1);
  request.mutable_job()->set_threads(-1);
  request.set_request_id(std::string(65, 'x'));
  status = stubs_->Create(request, job);
  EXPECT_EQ(FieldsOf(status), (std::vector<std::string>{"job.threads", "request_id"}));
}

// Most clients limit the trailer of a status to 8 KiB: a longer list would be lost with the whole response.
TEST_F(ErrorsTest, ManyProblemsReachEveryClient) {
  v1::CreateJobRequest request;
  v1::Scene& scene = *request.mutable_job()->mutable_scene() = SwingingBox(1, 0.1);
  const v1::Body body = scene.bodies(0);
  for (int i = 0; i < 150; ++i) {
    *scene.add_bodies() = body;
    scene.mutable_bodies(i)->set_name("body" + std::to_string(i));
    scene.mutable_bodies(i)->set_density(-1);
  }
  v1::Job job;
  const grpc::Status few = stubs_->Create(request, job);
  EXPECT_EQ(ReasonOf(few), "3 INVALID_ARGUMENT") << few.error_message();
  const auto listed = DetailOf<google::rpc::BadRequest>(few);
  ASSERT_TRUE(listed);
  EXPECT_GT(listed->field_violations_size(), 10);
  const auto& last = listed->field_violations(listed->field_violations_size() - 1);
  EXPECT_NE(last.description().find("more problems"), std::string::npos) << last.description();

  grpc::ChannelArguments arguments;
  arguments.SetInt(GRPC_ARG_MAX_METADATA_SIZE, 1 << 20);
  Stubs stubs(server_->address(), arguments);
  grpc::ClientContext context;
  context.AddMetadata("fascicle-details-limit", "200000");
  const grpc::Status all = stubs.jobs->CreateJob(&context, request, &job);
  EXPECT_EQ(ReasonOf(all), "3 INVALID_ARGUMENT") << all.error_message();
  EXPECT_GE(FieldsOf(all).size(), 150u);
}

TEST_F(ErrorsTest, MissingAssetsAreAllNamed) {
  v1::CreateJobRequest request;
  v1::Scene& scene = *request.mutable_job()->mutable_scene() = SwingingBox(1, 0.1);
  *scene.add_bodies() = scene.bodies(0);
  scene.mutable_bodies(1)->set_name("other");
  for (int i = 0; i < 2; ++i) {
    scene.mutable_bodies(i)->mutable_mesh()->mutable_file()->set_path("muscle.msh");
    scene.mutable_bodies(i)->mutable_mesh()->mutable_file()->set_asset("assets/" + std::string(64, i == 0 ? 'a' : 'b'));
  }
  v1::Job job;
  const grpc::Status status = stubs_->Create(request, job);
  EXPECT_EQ(ReasonOf(status), "9 MISSING_ASSET");
  const auto failure = DetailOf<google::rpc::PreconditionFailure>(status);
  ASSERT_TRUE(failure);
  ASSERT_EQ(failure->violations_size(), 2);
  EXPECT_EQ(failure->violations(0).type(), "MISSING_ASSET");
  EXPECT_EQ(failure->violations(0).subject(), "assets/" + std::string(64, 'a'));
  EXPECT_EQ(failure->violations(1).subject(), "assets/" + std::string(64, 'b'));
}

TEST_F(ErrorsTest, UnknownJobsAreNotFoundAndOddNamesAreInvalid) {
  const auto call_all = [this](const std::string& name) {
    std::vector<grpc::Status> statuses;
    {
      grpc::ClientContext context;
      v1::GetJobRequest request;
      request.set_name(name);
      v1::Job job;
      statuses.push_back(stubs_->jobs->GetJob(&context, request, &job));
    }
    statuses.push_back(stubs_->Cancel(name));
    {
      grpc::ClientContext context;
      v1::DeleteJobRequest request;
      request.set_name(name);
      google::protobuf::Empty empty;
      statuses.push_back(stubs_->jobs->DeleteJob(&context, request, &empty));
    }
    {
      grpc::ClientContext context;
      v1::ListFramesRequest request;
      request.set_name(name);
      v1::ListFramesResponse response;
      statuses.push_back(stubs_->frames->ListFrames(&context, request, &response));
    }
    {
      grpc::ClientContext context;
      v1::GetGeometryRequest request;
      request.set_name(name);
      const auto reader = stubs_->frames->GetGeometry(&context, request);
      v1::GetGeometryResponse response;
      EXPECT_FALSE(reader->Read(&response));
      statuses.push_back(reader->Finish());
    }
    statuses.push_back(ReadStream(*stubs_, AllFramesOf(name)).status);
    return statuses;
  };
  for (const grpc::Status& status : call_all("jobs/01AAAAAAAAAAAAAAAAAAAAAAAA")) {
    EXPECT_EQ(ReasonOf(status), "5 NOT_FOUND");
    const auto resource = DetailOf<google::rpc::ResourceInfo>(status);
    ASSERT_TRUE(resource);
    EXPECT_EQ(resource->resource_name(), "jobs/01AAAAAAAAAAAAAAAAAAAAAAAA");
  }
  for (const std::string name : {"", "jobs/", "job/1", "jobs/../control", "jobs/a b", "jobs/a\nb"}) {
    for (const grpc::Status& status : call_all(name)) EXPECT_EQ(ReasonOf(status), "3 INVALID_ARGUMENT") << name;
  }
}

TEST_F(ErrorsTest, AnActiveJobIsNotDeleted) {
  const std::string name = stubs_->Submit(LongScene());
  ASSERT_TRUE(stubs_->AwaitState(name, v1::Job::STATE_RUNNING));
  const auto try_delete = [&] {
    grpc::ClientContext context;
    v1::DeleteJobRequest request;
    request.set_name(name);
    google::protobuf::Empty empty;
    return stubs_->jobs->DeleteJob(&context, request, &empty);
  };
  const grpc::Status active = try_delete();
  EXPECT_EQ(ReasonOf(active), "9 JOB_ACTIVE");
  ASSERT_TRUE(DetailOf<google::rpc::PreconditionFailure>(active));
  EXPECT_EQ(DetailOf<google::rpc::PreconditionFailure>(active)->violations(0).subject(), name);
  ASSERT_TRUE(stubs_->Cancel(name).ok());
  ASSERT_TRUE(stubs_->AwaitState(name, v1::Job::STATE_CANCELLED));
  EXPECT_TRUE(try_delete().ok());
  EXPECT_EQ(ReasonOf(try_delete()), "5 NOT_FOUND");
}

TEST_F(ErrorsTest, ARequestIdNamesOneJobForEver) {
  v1::CreateJobRequest request;
  *request.mutable_job()->mutable_scene() = SwingingBox(0.1, 0.1);
  request.set_request_id("once");
  v1::Job first, again;
  ASSERT_TRUE(stubs_->Create(request, first).ok());
  ASSERT_TRUE(stubs_->Create(request, again).ok());
  EXPECT_EQ(first.name(), again.name());

  request.mutable_job()->mutable_scene()->set_duration(0.2);
  const grpc::Status reused = stubs_->Create(request, again);
  EXPECT_EQ(ReasonOf(reused), "6 REQUEST_ID_REUSED");
  ASSERT_TRUE(DetailOf<google::rpc::ResourceInfo>(reused));
  EXPECT_EQ(DetailOf<google::rpc::ResourceInfo>(reused)->resource_name(), first.name());
}

TEST_F(ErrorsTest, PageTokensOfNobody) {
  for (int i = 0; i < 5; ++i) stubs_->Submit(SwingingBox(0.01, 0.01));
  const auto list = [this](int page_size, const std::string& token, v1::ListJobsResponse& response) {
    grpc::ClientContext context;
    v1::ListJobsRequest request;
    request.set_page_size(page_size);
    request.set_page_token(token);
    return stubs_->jobs->ListJobs(&context, request, &response);
  };
  v1::ListJobsResponse page;
  ASSERT_TRUE(list(2, "", page).ok());
  const std::string token = page.next_page_token();
  ASSERT_FALSE(token.empty());
  std::string tampered = token;
  tampered.back() = tampered.back() == 'A' ? 'B' : 'A';
  for (const std::string& garbage : {std::string("x"), std::string(10'000, 'A'), std::string("\x01\x7f\n"), tampered,
                                     token.substr(1), "' OR 1=1 --" + token}) {
    v1::ListJobsResponse response;
    EXPECT_EQ(ReasonOf(list(2, garbage, response)), "3 INVALID_ARGUMENT") << garbage;
  }
  for (const int size : {-1, 1001}) EXPECT_EQ(ReasonOf(list(size, "", page)), "3 INVALID_ARGUMENT");

  // A token is valid only with its filter.
  grpc::ClientContext context;
  v1::ListJobsRequest other;
  other.set_page_token(token);
  other.add_states(v1::Job::STATE_QUEUED);
  EXPECT_EQ(ReasonOf(stubs_->jobs->ListJobs(&context, other, &page)), "3 INVALID_ARGUMENT");
}

TEST_F(ErrorsTest, StreamRequestsOutOfRange) {
  const std::string name = stubs_->Submit(SwingingBox(0.05, 0.01));
  ASSERT_TRUE(stubs_->AwaitState(name, v1::Job::STATE_SUCCEEDED));
  v1::StreamFramesRequest request = AllFramesOf(name);
  request.set_start_index(-1);
  request.set_end_index(-2);
  request.set_stride(-3);
  request.set_mode(static_cast<v1::StreamFramesRequest::Mode>(17));
  EXPECT_EQ(FieldsOf(ReadStream(*stubs_, request).status),
            (std::vector<std::string>{"start_index", "end_index", "stride", "mode"}));

  request = AllFramesOf(name);
  request.set_start_index(7);  // one beyond the end
  EXPECT_EQ(ReasonOf(ReadStream(*stubs_, request).status), "11 START_INDEX");

  request = AllFramesOf(name);
  request.set_generation(99);
  EXPECT_EQ(ReasonOf(ReadStream(*stubs_, request).status), "10 GENERATION_CHANGED");
}

TEST_F(ErrorsTest, AMessageOverFourMiBIsRefusedAndTheServerGoesOn) {
  v1::CreateJobRequest request;
  *request.mutable_job()->mutable_scene() = SwingingBox(1, 0.1);
  request.mutable_job()->mutable_scene()->set_description(std::string(5 << 20, 'x'));
  v1::Job job;
  EXPECT_EQ(stubs_->Create(request, job).error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_FALSE(stubs_->Submit(SwingingBox(0.01, 0.01)).empty());
}

TEST_F(ErrorsTest, BytesThatAreNoMessage) {
  const grpc::Slice garbage(std::string("\xff\xff\xff\xff not a message"));
  for (const char* method :
       {"JobService/CreateJob", "JobService/GetJob", "JobService/ListJobs", "JobService/CancelJob",
        "JobService/DeleteJob", "AssetService/FindMissingAssets", "AssetService/UploadAsset", "FrameService/ListFrames",
        "FrameService/GetGeometry", "FrameService/StreamFrames", "FrameService/NoSuchMethod"}) {
    grpc::GenericStub stub(stubs_->channel);
    grpc::ByteBuffer request(&garbage, 1);
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + 10s);
    grpc::CompletionQueue queue;
    auto call = stub.PrepareUnaryCall(&context, std::string("/fascicle.v1.") + method, request, &queue);
    call->StartCall();
    grpc::ByteBuffer response;
    grpc::Status status;
    call->Finish(&response, &status, &response);
    void* tag = nullptr;
    bool ok = false;
    ASSERT_TRUE(queue.Next(&tag, &ok));
    const bool is_known = method != std::string_view("FrameService/NoSuchMethod");
    EXPECT_EQ(ReasonOf(status), is_known ? "3 INVALID_ARGUMENT" : "12 UNKNOWN_METHOD") << method;
  }
  EXPECT_FALSE(stubs_->Submit(SwingingBox(0.01, 0.01)).empty());
}

}  // namespace
}  // namespace fascicle::service_test
