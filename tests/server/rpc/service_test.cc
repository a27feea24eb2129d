// Correct calls.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <google/protobuf/text_format.h>

#include "tests/support/files.h"
#include "tests/support/service_fixture.h"

namespace fascicle::service_test {
namespace {

using JobsTest = ServiceTest;

TEST_F(JobsTest, AJobIsCreatedRunsAndCanBeLookedAt) {
  v1::CreateJobRequest request;
  *request.mutable_job()->mutable_scene() = SwingingBox(0.1, 0.01);
  request.mutable_job()->set_threads(2);
  v1::Job created;
  ASSERT_TRUE(stubs_->Create(request, created).ok());
  EXPECT_TRUE(created.name().starts_with("jobs/"));
  EXPECT_EQ(created.scene_name(), "swinging box");
  EXPECT_FALSE(created.has_scene());
  EXPECT_GT(created.create_time().seconds(), 1'600'000'000);

  ASSERT_TRUE(stubs_->AwaitState(created.name(), v1::Job::STATE_SUCCEEDED));
  const v1::Job job = stubs_->Get(created.name());
  EXPECT_EQ(job.scene().SerializeAsString(), request.job().scene().SerializeAsString());
  EXPECT_EQ(job.threads(), 2);
  EXPECT_EQ(job.attempt(), 1);
  EXPECT_EQ(job.frame_count(), 11);
  EXPECT_GT(job.stored_bytes(), 11 * 45 * 24);
  EXPECT_NEAR(job.progress().fraction(), 1, 1e-9);
  EXPECT_GE(job.end_time().seconds(), job.start_time().seconds());
  EXPECT_FALSE(job.has_failure());
}

// A part of the phantom around the anconeus. The pieces that its image takes long for:
//   filters  text of an ImageShape
v1::Scene PhantomScene(const std::string& filters) {
  v1::Scene scene;
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(R"(
    name: "anconeus" duration: 0.1 voxel {} output { frame_interval: 0.1 }
    bodies {
      name: "anconeus" unit: LENGTH_UNIT_MM
      mesh {
        image {
          phantom {} )" + filters + R"( classes {} seeds { point: [49, 60, 17.75] } cleaning { opening: 0.6 } level: 2
        }
      }
      material { linear_elastic { young_modulus: 1e4 } }
      regions { name: "lower" plane { point: [0, 0, 12] normal: [0, 0, -1] } }
      constraints { region: "lower" }
    })",
                                                            &scene));
  return scene;
}

// How often the job's image was segmented, from its check to its last frame.
std::int64_t Segmentations(const v1::Job& job) {
  std::int64_t calls = 0;
  for (const v1::Profile::Stage& stage : job.profile().stages()) {
    if (stage.name().ends_with("/segmentation")) calls += stage.calls();
  }
  return calls;
}

TEST(PreparedScenes, AnImageIsSegmentedOnce) {
  const testing::TemporaryFolder directory;
  server::ServerOptions options;
  options.data_directory = directory.path().string();
  const v1::Scene scene = PhantomScene("region { first: [70, 90, 20] size: [60, 60, 30] } filters { wavelet {} }");
  std::vector<std::string> digests;
  std::vector<std::int64_t> segmentations;
  const auto run = [&](const std::string& address) {
    Stubs stubs(address);
    const std::string name = stubs.Submit(scene);
    ASSERT_TRUE(stubs.AwaitState(name, v1::Job::STATE_SUCCEEDED, 60s));
    segmentations.push_back(Segmentations(stubs.Get(name)));
    digests.push_back(stubs.List(name).back().digest());
  };
  for (const std::int64_t cache_size : {std::int64_t{1} << 30, std::int64_t{1} << 30, std::int64_t{0}}) {
    options.cache_size = cache_size;
    const auto server = server::EmbeddedServer::Start(options);
    run(server->address());
    run(server->address());
  }
  // Of the first job, and where nothing is kept.
  EXPECT_EQ(segmentations, (std::vector<std::int64_t>{1, 0, 0, 0, 1, 1}));
  EXPECT_EQ(std::set<std::string>(digests.begin(), digests.end()).size(), 1u);
}

// Each takes minutes to be checked, and there are two threads for that.
TEST_F(JobsTest, TheCheckOfASceneEndsWithItsCall) {
  std::string filters;
  for (int i = 0; i < 8; ++i) filters += "filters { curvature { iterations: 100 } } ";
  v1::CreateJobRequest request;
  *request.mutable_job()->mutable_scene() = PhantomScene(filters);
  std::vector<std::thread> calls;
  grpc::ClientContext contexts[4];
  for (grpc::ClientContext& context : contexts) {
    calls.emplace_back([&] {
      v1::Job job;
      EXPECT_EQ(stubs_->jobs->CreateJob(&context, request, &job).error_code(), grpc::StatusCode::CANCELLED);
    });
  }
  std::this_thread::sleep_for(300ms);
  for (grpc::ClientContext& context : contexts) context.TryCancel();
  for (std::thread& call : calls) call.join();
  EXPECT_FALSE(stubs_->Submit(SwingingBox(0.01, 0.01)).empty());
}

grpc::Status CreateBatch(Stubs& stubs, const v1::BatchCreateJobsRequest& request,
                         v1::BatchCreateJobsResponse& response) {
  grpc::ClientContext context;
  return stubs.jobs->BatchCreateJobs(&context, request, &response);
}

v1::BatchCreateJobsRequest BatchOf(int count) {
  v1::BatchCreateJobsRequest batch;
  for (int i = 0; i < count; ++i) {
    v1::CreateJobRequest& request = *batch.add_requests();
    *request.mutable_job()->mutable_scene() = SwingingBox(0.01, 0.01);
    request.mutable_job()->mutable_scene()->set_name("job " + std::to_string(i));
    request.set_request_id("request " + std::to_string(i));
  }
  return batch;
}

TEST_F(JobsTest, ABatchIsCreatedOnce) {
  const v1::BatchCreateJobsRequest batch = BatchOf(100);
  v1::BatchCreateJobsResponse first, again;
  ASSERT_TRUE(CreateBatch(*stubs_, batch, first).ok());
  ASSERT_EQ(first.jobs_size(), 100);
  EXPECT_EQ(first.jobs(7).scene_name(), "job 7");
  ASSERT_TRUE(CreateBatch(*stubs_, batch, again).ok());
  for (int i = 0; i < 100; ++i) EXPECT_EQ(again.jobs(i).name(), first.jobs(i).name());
  for (const int i : {0, 99}) {
    EXPECT_TRUE(stubs_->AwaitState(first.jobs(i).name(), v1::Job::STATE_SUCCEEDED, 60s));
  }
  // As one of them alone.
  v1::Job job;
  EXPECT_TRUE(stubs_->Create(batch.requests(3), job).ok());
  EXPECT_EQ(job.name(), first.jobs(3).name());
}

TEST_F(JobsTest, ABatchWithAFaultyJobCreatesNone) {
  v1::BatchCreateJobsRequest batch = BatchOf(6), reused = BatchOf(2);
  v1::BatchCreateJobsResponse response;
  batch.mutable_requests(1)->mutable_job()->mutable_scene()->set_duration(-1);
  batch.mutable_requests(3)->mutable_job()->clear_scene();
  batch.mutable_requests(4)->set_validate_only(true);
  batch.mutable_requests(5)->set_request_id("request 0");
  const grpc::Status status = CreateBatch(*stubs_, batch, response);
  EXPECT_EQ(ReasonOf(status), "3 INVALID_ARGUMENT");
  std::set<std::string> fields;
  const google::rpc::BadRequest bad = DetailOf<google::rpc::BadRequest>(status).value();
  for (const auto& violation : bad.field_violations()) fields.insert(violation.field());
  EXPECT_EQ(fields, (std::set<std::string>{"requests[1].job.scene.duration", "requests[3].job.scene",
                                           "requests[4].validate_only", "requests[5].request_id"}));
  v1::Job job;
  ASSERT_TRUE(stubs_->Create(reused.requests(1), job).ok());
  reused.mutable_requests(1)->mutable_job()->set_threads(3);
  EXPECT_EQ(ReasonOf(CreateBatch(*stubs_, reused, response)), "6 REQUEST_ID_REUSED");
  EXPECT_EQ(ReasonOf(CreateBatch(*stubs_, {}, response)), "3 INVALID_ARGUMENT");
  EXPECT_EQ(ReasonOf(CreateBatch(*stubs_, BatchOf(1001), response)), "3 INVALID_ARGUMENT");
  v1::Body& body = *reused.mutable_requests(0)->mutable_job()->mutable_scene()->mutable_bodies(0);
  v1::FileRef& mesh = *body.mutable_mesh()->mutable_file();
  mesh.set_path("missing.msh");
  mesh.set_asset("assets/" + std::string(64, 'a'));
  EXPECT_EQ(ReasonOf(CreateBatch(*stubs_, reused, response)), "9 MISSING_ASSET");
  grpc::ClientContext context;
  v1::ListJobsResponse listed;
  EXPECT_TRUE(stubs_->jobs->ListJobs(&context, {}, &listed).ok());
  EXPECT_EQ(listed.jobs_size(), 1);
}

TEST_F(JobsTest, ABatchThatIsDearToCheckIsRefused) {
  v1::BatchCreateJobsRequest batch = BatchOf(200);
  for (v1::CreateJobRequest& request : *batch.mutable_requests()) {
    for (int axis = 0; axis < 3; ++axis) {
      request.mutable_job()->mutable_scene()->mutable_bodies(0)->mutable_mesh()->mutable_box()->set_divisions(axis, 40);
    }
  }
  v1::BatchCreateJobsResponse response;
  EXPECT_EQ(ReasonOf(CreateBatch(*stubs_, batch, response)), "8 BATCH_TOO_LARGE");
}

TEST_F(JobsTest, AJobsProfileSaysWhereItsTimeWent) {
  const std::string name = stubs_->Submit(LargeSteps(400));
  ASSERT_TRUE(stubs_->AwaitState(name, v1::Job::STATE_SUCCEEDED, 60s));
  const v1::Job job = stubs_->Get(name);
  ASSERT_TRUE(job.has_profile());
  const v1::Profile& profile = job.profile();
  std::map<std::string, v1::Profile::Stage> stages;
  double whole = 0, step = 0;
  for (const v1::Profile::Stage& stage : profile.stages()) {
    stages[stage.name()] = stage;
    const bool is_part = stage.name().find('/') != std::string::npos;
    if (!is_part && !stage.concurrent()) whole += stage.seconds();
    if (stage.name().starts_with("step/")) step += stage.seconds();
  }
  const auto micros = [](const google::protobuf::Timestamp& t) {
    return 1e6 * static_cast<double>(t.seconds()) + 1e-3 * t.nanos();
  };
  EXPECT_GT(profile.wall_seconds(), 0);
  // The scene was checked before there was a job.
  EXPECT_GT(stages["check"].seconds(), 0);
  EXPECT_LE(profile.wall_seconds() - stages["check"].seconds(),
            1e-6 * (micros(job.end_time()) - micros(job.start_time())) + 0.01);
  // All states except those that may pass between two polls; a busy machine may delay the worker by some milliseconds.
  constexpr double kBetween = 0.03;
  EXPECT_GT(whole, 0.97 * profile.wall_seconds() - kBetween) << profile.DebugString();
  EXPECT_LE(whole, profile.wall_seconds());
  EXPECT_GT(step, 0.97 * stages["step"].seconds() - kBetween) << profile.DebugString();
  EXPECT_GT(stages["step/elastic force"].seconds(), 0.3 * stages["step"].seconds());
  EXPECT_EQ(stages["step"].calls(), job.progress().step());
  EXPECT_EQ(stages["commit"].calls(), 400);
  EXPECT_TRUE(stages["commit"].concurrent());
  EXPECT_GT(profile.cpu_seconds(), 0.3 * step);
  EXPECT_EQ(profile.runs(), 1);
  // It is sent at the end of a stream, and not in a list.
  EXPECT_EQ(ReadStream(*stubs_, AllFramesOf(name)).end->job().profile().SerializeAsString(),
            profile.SerializeAsString());
  grpc::ClientContext context;
  v1::ListJobsResponse list;
  ASSERT_TRUE(stubs_->jobs->ListJobs(&context, {}, &list).ok());
  EXPECT_FALSE(list.jobs(0).has_profile());
}

TEST_F(JobsTest, ValidateOnlyCreatesNothing) {
  v1::CreateJobRequest request;
  *request.mutable_job()->mutable_scene() = SwingingBox(1, 0.1);
  request.set_validate_only(true);
  v1::Job job;
  ASSERT_TRUE(stubs_->Create(request, job).ok());
  EXPECT_EQ(job.name(), "");
  grpc::ClientContext context;
  v1::ListJobsResponse list;
  ASSERT_TRUE(stubs_->jobs->ListJobs(&context, {}, &list).ok());
  EXPECT_EQ(list.jobs_size(), 0);
}

// A static job, and one with inertia that starts as its last frame: nothing moves, although the first job is deleted at
// once. The state is the job's own asset.
TEST_F(JobsTest, AJobStartsAsAFrameOfAnother) {
  v1::Scene scene = SwingingBox(0.05, 0.01);
  scene.mutable_gravity()->mutable_scale()->add_times(0);
  scene.mutable_gravity()->mutable_scale()->add_values(1);
  scene.mutable_output()->add_fields(v1::FIELD_VELOCITY);
  scene.mutable_tet()->set_stepping(v1::STEPPING_QUASI_STATIC);
  const std::string source = stubs_->Submit(scene);
  ASSERT_TRUE(stubs_->AwaitState(source, v1::Job::STATE_SUCCEEDED));
  const v1::Frame last = ReadStream(*stubs_, AllFramesOf(source)).frames.back();
  ASSERT_FALSE(last.bodies(0).higher_order_positions().empty());

  scene.mutable_tet()->set_stepping(v1::STEPPING_BDF2);
  scene.mutable_start()->mutable_frame()->set_job(source);
  const std::string name = stubs_->Submit(scene);
  grpc::ClientContext context;
  v1::DeleteJobRequest request;
  request.set_name(source);
  google::protobuf::Empty nothing;
  ASSERT_TRUE(stubs_->jobs->DeleteJob(&context, request, &nothing).ok());
  ASSERT_TRUE(stubs_->AwaitState(name, v1::Job::STATE_SUCCEEDED));
  EXPECT_TRUE(stubs_->Get(name).scene().start().frame().state().asset().starts_with("assets/"));
  const StreamRecord record = ReadStream(*stubs_, AllFramesOf(name));
  ASSERT_EQ(record.frames.size(), 6u);
  const auto largest_difference = [&](const std::string& a, const std::string& b) {
    EXPECT_EQ(a.size(), b.size());
    double largest = 0;
    for (std::size_t i = 0; i + 8 <= a.size(); i += 8) {
      double x, y;
      std::memcpy(&x, &a[i], 8);
      std::memcpy(&y, &b[i], 8);
      largest = std::max(largest, std::abs(x - y));
    }
    return largest;
  };
  for (const v1::Frame& frame : record.frames) {
    const v1::BodyFrame &now = frame.bodies(0), &then = last.bodies(0);
    EXPECT_LT(largest_difference(now.positions(), then.positions()), 1e-9) << "frame " << frame.index();
    EXPECT_LT(largest_difference(now.higher_order_positions(), then.higher_order_positions()), 1e-9);
  }

  v1::CreateJobRequest create;
  *create.mutable_job()->mutable_scene() = scene;  // from the job that is no more
  create.mutable_job()->mutable_scene()->mutable_bodies(0)->set_density(-1);
  v1::Job job;
  const grpc::Status status = stubs_->Create(create, job);
  EXPECT_EQ(ReasonOf(status), "3 INVALID_ARGUMENT");
  const auto bad = DetailOf<google::rpc::BadRequest>(status);
  ASSERT_TRUE(bad);
  std::set<std::string> fields;
  for (const auto& violation : bad->field_violations()) fields.insert(violation.field());
  EXPECT_EQ(fields, (std::set<std::string>{"job.scene.bodies[0].density", "job.scene.start.frame.job"}));
  create.mutable_job()->mutable_scene()->mutable_bodies(0)->clear_density();
  create.mutable_job()->mutable_scene()->mutable_start()->mutable_frame()->set_job(name);
  create.mutable_job()->mutable_scene()->mutable_start()->mutable_frame()->set_frame(6);
  EXPECT_EQ(ReasonOf(stubs_->Create(create, job)), "3 INVALID_ARGUMENT") << "it has the frames 0 to 5";
}

TEST_F(JobsTest, PagesListEveryJobOnceNewestFirst) {
  std::vector<std::string> names;
  for (int i = 0; i < 7; ++i) names.push_back(stubs_->Submit(SwingingBox(0.01, 0.01)));
  for (const int page_size : {1, 3, 7, 100}) {
    std::vector<std::string> listed;
    v1::ListJobsRequest request;
    request.set_page_size(page_size);
    do {
      grpc::ClientContext context;
      v1::ListJobsResponse page;
      ASSERT_TRUE(stubs_->jobs->ListJobs(&context, request, &page).ok());
      EXPECT_LE(page.jobs_size(), page_size);
      for (const v1::Job& job : page.jobs()) {
        listed.push_back(job.name());
        EXPECT_FALSE(job.has_scene());
      }
      request.set_page_token(page.next_page_token());
    } while (!request.page_token().empty());
    EXPECT_EQ(listed, std::vector<std::string>(names.rbegin(), names.rend())) << page_size;
  }
}

TEST_F(JobsTest, ListsByState) {
  const std::string done = stubs_->Submit(SwingingBox(0.01, 0.01));
  ASSERT_TRUE(stubs_->AwaitState(done, v1::Job::STATE_SUCCEEDED));
  const std::string running = stubs_->Submit(LongScene());
  ASSERT_TRUE(stubs_->AwaitState(running, v1::Job::STATE_RUNNING));
  grpc::ClientContext context;
  v1::ListJobsRequest request;
  request.add_states(v1::Job::STATE_RUNNING);
  v1::ListJobsResponse response;
  ASSERT_TRUE(stubs_->jobs->ListJobs(&context, request, &response).ok());
  ASSERT_EQ(response.jobs_size(), 1);
  EXPECT_EQ(response.jobs(0).name(), running);
}

TEST_F(JobsTest, TwoJobsRunAtOnceAndAThirdWaits) {
  const std::string a = stubs_->Submit(LongScene());
  const std::string b = stubs_->Submit(LongScene());
  const std::string c = stubs_->Submit(LongScene());
  ASSERT_TRUE(stubs_->AwaitState(a, v1::Job::STATE_RUNNING));
  ASSERT_TRUE(stubs_->AwaitState(b, v1::Job::STATE_RUNNING));
  // Both produce frames while the other runs.
  const std::int64_t count_a = stubs_->Get(a).frame_count(), count_b = stubs_->Get(b).frame_count();
  EXPECT_TRUE(stubs_->AwaitFrames(a, count_a + 5));
  EXPECT_TRUE(stubs_->AwaitFrames(b, count_b + 5));
  EXPECT_EQ(stubs_->Get(a).state(), v1::Job::STATE_RUNNING);
  EXPECT_EQ(stubs_->Get(b).state(), v1::Job::STATE_RUNNING);
  EXPECT_EQ(stubs_->Get(c).state(), v1::Job::STATE_QUEUED);
}

TEST_F(JobsTest, CancelStopsWithinASecondAndKeepsTheFrames) {
  const std::string name = stubs_->Submit(LongScene());
  ASSERT_TRUE(stubs_->AwaitFrames(name, 10));
  const auto start = std::chrono::steady_clock::now();
  ASSERT_TRUE(stubs_->Cancel(name).ok());
  ASSERT_TRUE(stubs_->AwaitState(name, v1::Job::STATE_CANCELLED));
  EXPECT_LT(std::chrono::steady_clock::now() - start, 1s);
  const v1::Job job = stubs_->Get(name);
  EXPECT_GE(job.frame_count(), 10);
  EXPECT_EQ(static_cast<std::int64_t>(stubs_->List(name).size()), std::min<std::int64_t>(job.frame_count(), 10'000));
  EXPECT_TRUE(stubs_->Cancel(name).ok()) << "a job in a final state is returned as it is";
  EXPECT_EQ(stubs_->Get(name).state(), v1::Job::STATE_CANCELLED);
}

TEST_F(JobsTest, GeometryComesInChunksAndMatchesTheScene) {
  const std::string name = stubs_->Submit(LargeFrames(2));
  grpc::ClientContext context;
  v1::GetGeometryRequest request;
  request.set_name(name);
  const auto reader = stubs_->frames->GetGeometry(&context, request);  // at once: it waits for the job to start
  v1::GetGeometryResponse message;
  std::string bytes;
  int chunks = 0;
  bool last = false;
  while (reader->Read(&message)) {
    EXPECT_EQ(message.chunk().offset(), static_cast<std::int64_t>(bytes.size()));
    EXPECT_EQ(message.chunk().crc32c(), Crc32c(message.chunk().data()));
    EXPECT_FALSE(last);
    bytes += message.chunk().data();
    last = message.chunk().last();
    ++chunks;
  }
  ASSERT_TRUE(reader->Finish().ok());
  EXPECT_TRUE(last);
  EXPECT_EQ(chunks, static_cast<int>((bytes.size() + (1 << 20) - 1) >> 20));
  v1::Geometry geometry;
  ASSERT_TRUE(geometry.ParseFromString(bytes));
  ASSERT_EQ(geometry.bodies_size(), 1);
  EXPECT_EQ(geometry.bodies(0).positions().size(), 21u * 21 * 21 * 24);
  EXPECT_EQ(geometry.bodies(0).tetrahedra().size(), 48'000u * 16);
  EXPECT_GT(geometry.series_size(), 0);
}

TEST_F(JobsTest, AJobThatIsCancelledInTheQueueHasNoGeometry) {
  const std::string a = stubs_->Submit(LongScene());
  const std::string b = stubs_->Submit(LongScene());
  const std::string waiting = stubs_->Submit(SwingingBox(1, 0.1));
  grpc::ClientContext context;
  v1::GetGeometryRequest request;
  request.set_name(waiting);
  const auto reader = stubs_->frames->GetGeometry(&context, request);
  ASSERT_TRUE(stubs_->Cancel(waiting).ok());
  v1::GetGeometryResponse message;
  EXPECT_FALSE(reader->Read(&message));
  EXPECT_EQ(ReasonOf(reader->Finish()), "9 NO_GEOMETRY");
}

TEST_F(JobsTest, TheServerTellsAboutItself) {
  grpc::ClientContext context;
  v1::ServerInfo info;
  ASSERT_TRUE(stubs_->server->GetServerInfo(&context, {}, &info).ok());
  EXPECT_FALSE(info.version().empty());
  ASSERT_EQ(info.methods_size(), 3);
  EXPECT_EQ(info.methods(0), "tet");
  EXPECT_EQ(info.methods(1), "voxel");
  EXPECT_EQ(info.methods(2), "eulerian");
  EXPECT_EQ(info.workers(), 2);
  EXPECT_EQ(info.max_asset_size(), std::int64_t{4} << 30);
}

TEST_F(JobsTest, ASecondServerDoesNotTakeTheSamePort) {
  server::ServerOptions options;
  options.listen = server_->address();
  EXPECT_THROW(server::EmbeddedServer::Start(options), std::runtime_error);
  EXPECT_FALSE(stubs_->Submit(SwingingBox(0.01, 0.01)).empty());
}

TEST_F(JobsTest, OtherAddressesThanLoopbackAreRefused) {
  for (const char* listen : {"0.0.0.0:0", "[::]:0", "example.org:0", "127.0.0.1", "127.0.0.1:99999", ":80", ""}) {
    server::ServerOptions options;
    options.listen = listen;
    EXPECT_THROW(server::EmbeddedServer::Start(options), std::runtime_error) << listen;
  }
}

class AssetsTest : public ServiceTest {
 protected:
  server::ServerOptions Options() override {
    server::ServerOptions options;
    options.max_asset_size = 8 << 20;
    return options;
  }

  static std::string NameOf(const std::string& bytes) { return "assets/" + Hex(Sha256Of(bytes)); }

  grpc::Status Upload(const std::string& name, std::int64_t size, const std::string& bytes,
                      std::size_t chunk = 1 << 20) {
    grpc::ClientContext context;
    v1::UploadAssetResponse response;
    const auto writer = stubs_->assets->UploadAsset(&context, &response);
    v1::UploadAssetRequest request;
    request.set_name(name);
    request.set_size(size);
    std::size_t sent = 0;
    do {
      request.set_data(bytes.substr(sent, chunk));
      sent += chunk;
      if (!writer->Write(request)) break;
      request.clear_name();
      request.clear_size();
    } while (sent < bytes.size());
    writer->WritesDone();
    const grpc::Status status = writer->Finish();
    if (status.ok()) {
      EXPECT_EQ(response.name(), name);
      EXPECT_EQ(response.size(), size);
    }
    return status;
  }

  bool IsMissing(const std::string& name) {
    grpc::ClientContext context;
    v1::FindMissingAssetsRequest request;
    request.add_names(name);
    v1::FindMissingAssetsResponse response;
    EXPECT_TRUE(stubs_->assets->FindMissingAssets(&context, request, &response).ok());
    return response.missing_size() == 1;
  }
};

TEST_F(AssetsTest, UploadsAreKeptByDigest) {
  for (const std::size_t size : {std::size_t{0}, std::size_t{1}, std::size_t{1} << 20, (std::size_t{3} << 20) + 17}) {
    const std::string bytes(size, 'x');
    const std::string name = NameOf(bytes);
    EXPECT_TRUE(IsMissing(name));
    EXPECT_TRUE(Upload(name, static_cast<std::int64_t>(size), bytes).ok());
    EXPECT_FALSE(IsMissing(name));
    EXPECT_TRUE(Upload(name, static_cast<std::int64_t>(size), bytes).ok()) << "again";
  }
}

TEST_F(AssetsTest, WrongUploadsLeaveNothing) {
  const std::string bytes(3'000'000, 'y');
  const std::string name = NameOf(bytes);
  const auto size = static_cast<std::int64_t>(bytes.size());
  std::string changed = bytes;
  changed[1'234'567] = 'z';
  EXPECT_EQ(ReasonOf(Upload(name, size, changed)), "3 DIGEST_MISMATCH");
  EXPECT_EQ(ReasonOf(Upload(name, size, bytes.substr(1))), "3 SIZE_MISMATCH");
  EXPECT_EQ(ReasonOf(Upload(name, size, bytes + "y")), "3 SIZE_MISMATCH");
  EXPECT_EQ(ReasonOf(Upload(name, -1, bytes)), "3 INVALID_ARGUMENT");
  EXPECT_EQ(ReasonOf(Upload(name, size, bytes, (1 << 20) + 1)), "3 INVALID_ARGUMENT");
  EXPECT_EQ(ReasonOf(Upload("assets/../../etc/passwd", size, bytes)), "3 INVALID_ARGUMENT");
  const grpc::Status large = Upload(name, 9 << 20, bytes);
  EXPECT_EQ(ReasonOf(large), "8 ASSET_TOO_LARGE");
  EXPECT_TRUE(DetailOf<google::rpc::QuotaFailure>(large));
  {
    grpc::ClientContext context;
    v1::UploadAssetResponse response;
    const auto writer = stubs_->assets->UploadAsset(&context, &response);
    writer->WritesDone();
    EXPECT_EQ(ReasonOf(writer->Finish()), "3 INVALID_ARGUMENT") << "without any message";
  }
  EXPECT_TRUE(IsMissing(name));
  EXPECT_TRUE(Upload(name, size, bytes).ok());
}

TEST_F(AssetsTest, ABrokenUploadLeavesNothing) {
  const std::string bytes(2 << 20, 'b');
  for (int i = 0; i < 10; ++i) {
    grpc::ClientContext context;
    v1::UploadAssetResponse response;
    const auto writer = stubs_->assets->UploadAsset(&context, &response);
    v1::UploadAssetRequest request;
    request.set_name(NameOf(bytes));
    request.set_size(static_cast<std::int64_t>(bytes.size()));
    request.set_data(bytes.substr(0, 1 << 20));
    writer->Write(request);
    context.TryCancel();
    EXPECT_EQ(writer->Finish().error_code(), grpc::StatusCode::CANCELLED);
  }
  EXPECT_TRUE(IsMissing(NameOf(bytes)));
  EXPECT_TRUE(Upload(NameOf(bytes), static_cast<std::int64_t>(bytes.size()), bytes).ok());
}

TEST_F(AssetsTest, FindMissingChecksNames) {
  grpc::ClientContext context;
  v1::FindMissingAssetsRequest request;
  request.add_names("assets/" + std::string(64, 'A'));
  v1::FindMissingAssetsResponse response;
  EXPECT_EQ(ReasonOf(stubs_->assets->FindMissingAssets(&context, request, &response)), "3 INVALID_ARGUMENT");
  grpc::ClientContext another;
  request.clear_names();
  for (int i = 0; i < 1001; ++i) request.add_names("assets/" + std::string(64, 'a'));
  EXPECT_EQ(ReasonOf(stubs_->assets->FindMissingAssets(&another, request, &response)), "3 INVALID_ARGUMENT");
}

}  // namespace
}  // namespace fascicle::service_test
