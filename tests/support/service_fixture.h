#ifndef FASCICLE_TESTS_SUPPORT_SERVICE_FIXTURE_H_
#define FASCICLE_TESTS_SUPPORT_SERVICE_FIXTURE_H_

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include "core/base/digest.h"
#include "fascicle/v1/frame.pb.h"
#include "fascicle/v1/simulation_service.grpc.pb.h"
#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"
#include "server/embedded_server.h"
#include "tests/support/eventually.h"

namespace fascicle::service_test {

using namespace std::chrono_literals;

// A box of soft tissue that hangs from its upper end and vibrates: about a hundred tetrahedra.
//   duration, frame_interval  [s]
inline v1::Scene SwingingBox(double duration, double frame_interval) {
  v1::Scene scene;
  scene.set_name("swinging box");
  scene.set_duration(duration);
  scene.mutable_output()->set_frame_interval(frame_interval);
  scene.mutable_tet();
  scene.mutable_gravity()->add_acceleration(1);
  scene.mutable_gravity()->add_acceleration(0);
  scene.mutable_gravity()->add_acceleration(-9.81);
  v1::Body& body = *scene.add_bodies();
  body.set_name("box");
  body.set_unit(v1::LENGTH_UNIT_CM);
  for (const double size : {4.0, 4.0, 8.0}) body.mutable_mesh()->mutable_box()->add_size(size);
  for (const int divisions : {2, 2, 4}) body.mutable_mesh()->mutable_box()->add_divisions(divisions);
  body.mutable_material()->mutable_neo_hookean()->set_young_modulus(2e4);
  v1::Region& top = *body.add_regions();
  top.set_name("top");
  for (const double x : {0.0, 0.0, 8.0}) top.mutable_plane()->add_point(x);
  for (const double x : {0.0, 0.0, 1.0}) top.mutable_plane()->add_normal(x);
  body.add_constraints()->set_region("top");
  return scene;
}

// A job of `frames` + 1 frames that takes some seconds, at about ten thousand steps per second.
inline v1::Scene LongScene(int frames = 90'000) { return SwingingBox(0.01 * frames, 0.01); }

// A job of small frames that take a few milliseconds each: 3,000 tetrahedra.
inline v1::Scene LargeSteps(int frames) {
  v1::Scene scene = SwingingBox(0.01 * (frames - 1), 0.01);
  for (const int i : {0, 1, 2})
    scene.mutable_bodies(0)->mutable_mesh()->mutable_box()->set_divisions(i, i < 2 ? 6 : 14);
  return scene;
}

// A job whose frames have several chunks: 2.6 MiB each, of 48,000 tetrahedra.
inline v1::Scene LargeFrames(int frames) {
  v1::Scene scene = SwingingBox(0.004 * (frames - 1), 0.004);
  for (int i = 0; i < 3; ++i) scene.mutable_bodies(0)->mutable_mesh()->mutable_box()->set_divisions(i, 20);
  scene.mutable_output()->add_fields(v1::FIELD_CAUCHY_STRESS);
  return scene;
}

template <class Detail>
std::optional<Detail> DetailOf(const grpc::Status& status) {
  google::rpc::Status packed;
  if (!packed.ParseFromString(status.error_details())) return std::nullopt;
  Detail detail;
  for (const auto& any : packed.details()) {
    if (any.UnpackTo(&detail)) return detail;
  }
  return std::nullopt;
}

// Code and ErrorInfo of an error, such as "5 NOT_FOUND". Every error must have an ErrorInfo with the domain `fascicle`.
inline std::string ReasonOf(const grpc::Status& status) {
  const auto info = DetailOf<google::rpc::ErrorInfo>(status);
  if (!info) return std::to_string(status.error_code()) + " without ErrorInfo: " + status.error_message();
  EXPECT_EQ(info->domain(), "fascicle");
  return std::to_string(status.error_code()) + " " + info->reason();
}

using testing::Eventually;

// The stubs of a server, without the client library. They connect on construction: gRPC 1.51 reads the errno of
// connect() after other calls that may have changed it (grpc/grpc pull request 35064), so that one attempt in thousands
// fails with an unrelated error, together with any call made meanwhile. A server that may be gone already (not
// `is_there`) is connected to by the first call.
struct Stubs {
  explicit Stubs(const std::string& address, const grpc::ChannelArguments& arguments = {}, bool is_there = true)
      : channel(grpc::CreateCustomChannel(address, grpc::InsecureChannelCredentials(), Own(arguments))),
        jobs(v1::JobService::NewStub(channel)),
        assets(v1::AssetService::NewStub(channel)),
        frames(v1::FrameService::NewStub(channel)),
        server(v1::ServerService::NewStub(channel)) {
    if (!is_there) return;
    EXPECT_TRUE(channel->WaitForConnected(std::chrono::system_clock::now() + 20s)) << address;
  }

  static grpc::ChannelArguments Own(grpc::ChannelArguments arguments) {
    arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
    arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, 50);
    return arguments;
  }

  grpc::Status Create(const v1::CreateJobRequest& request, v1::Job& job) {
    grpc::ClientContext context;
    return jobs->CreateJob(&context, request, &job);
  }

  // The name of a new job.
  std::string Submit(const v1::Scene& scene) {
    v1::CreateJobRequest request;
    *request.mutable_job()->mutable_scene() = scene;
    v1::Job job;
    const grpc::Status status = Create(request, job);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return job.name();
  }

  v1::Job Get(const std::string& name) {
    grpc::ClientContext context;
    v1::GetJobRequest request;
    request.set_name(name);
    v1::Job job;
    jobs->GetJob(&context, request, &job);
    return job;
  }

  grpc::Status Cancel(const std::string& name) {
    grpc::ClientContext context;
    v1::CancelJobRequest request;
    request.set_name(name);
    v1::Job job;
    return jobs->CancelJob(&context, request, &job);
  }

  bool AwaitState(const std::string& name, v1::Job::State state, std::chrono::milliseconds timeout = 20s) {
    return Eventually([&] { return Get(name).state() == state; }, timeout);
  }

  bool AwaitFrames(const std::string& name, std::int64_t count) {
    return Eventually([&] { return Get(name).frame_count() >= count; });
  }

  std::vector<v1::FrameInfo> List(const std::string& name) {
    grpc::ClientContext context;
    v1::ListFramesRequest request;
    request.set_name(name);
    request.set_page_size(10'000);
    v1::ListFramesResponse response;
    EXPECT_TRUE(frames->ListFrames(&context, request, &response).ok());
    return {response.frames().begin(), response.frames().end()};
  }

  std::shared_ptr<grpc::Channel> channel;
  std::unique_ptr<v1::JobService::Stub> jobs;
  std::unique_ptr<v1::AssetService::Stub> assets;
  std::unique_ptr<v1::FrameService::Stub> frames;
  std::unique_ptr<v1::ServerService::Stub> server;
};

// Everything delivered by one StreamFrames call. Checks the contract of the stream: a header first, chunks in order
// with correct offsets and checksums, heartbeats between frames only, nothing after the end.
struct StreamRecord {
  std::optional<v1::StreamFramesResponse::Header> header;
  std::vector<v1::Frame> frames;
  std::vector<v1::StreamFramesResponse::Heartbeat> heartbeats;
  std::optional<v1::StreamFramesResponse::End> end;
  grpc::Status status;
};

// Reads a stream; `keep_going` is called after each complete frame and stops the stream if it returns false.
inline StreamRecord ReadStream(Stubs& stubs, const v1::StreamFramesRequest& request,
                               const std::function<bool(const StreamRecord&)>& keep_going = {}) {
  StreamRecord record;
  grpc::ClientContext context;
  const auto reader = stubs.frames->StreamFrames(&context, request);
  v1::StreamFramesResponse message;
  std::string bytes;
  bool cut = false;
  while (!cut && reader->Read(&message)) {
    EXPECT_FALSE(record.end.has_value()) << "a message after the end";
    if (message.has_header()) {
      EXPECT_FALSE(record.header.has_value());
      record.header = message.header();
      continue;
    }
    EXPECT_TRUE(record.header.has_value()) << "the header comes first";
    if (message.has_heartbeat()) {
      EXPECT_TRUE(bytes.empty()) << "a heartbeat within a frame";
      record.heartbeats.push_back(message.heartbeat());
    } else if (message.has_end()) {
      EXPECT_TRUE(bytes.empty()) << "the end within a frame";
      record.end = message.end();
    } else {
      const v1::Chunk& chunk = message.chunk();
      EXPECT_EQ(chunk.offset(), static_cast<std::int64_t>(bytes.size()));
      EXPECT_LE(chunk.data().size(), std::size_t{1} << 20);
      EXPECT_EQ(chunk.crc32c(), Crc32c(chunk.data()));
      bytes += chunk.data();
      if (!chunk.last()) continue;
      EXPECT_TRUE(record.frames.emplace_back().ParseFromString(bytes));
      EXPECT_EQ(record.frames.back().index(), chunk.frame_index());
      bytes.clear();
      cut = keep_going && !keep_going(record);
    }
  }
  if (cut) context.TryCancel();
  record.status = reader->Finish();
  return record;
}

inline v1::StreamFramesRequest AllFramesOf(const std::string& name) {
  v1::StreamFramesRequest request;
  request.set_name(name);
  request.set_follow(true);
  return request;
}

// A server in this process with its data in memory, and stubs.
class ServiceTest : public ::testing::Test {
 protected:
  virtual server::ServerOptions Options() { return {}; }

  void SetUp() override {
    server_ = server::EmbeddedServer::Start(Options());
    stubs_ = std::make_unique<Stubs>(server_->address());
  }

  std::unique_ptr<server::EmbeddedServer> server_;
  std::unique_ptr<Stubs> stubs_;
};

}  // namespace fascicle::service_test

#endif  // FASCICLE_TESTS_SUPPORT_SERVICE_FIXTURE_H_
