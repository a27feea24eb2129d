// Clients that mean harm, against the real server: what they can cost, and that others are served meanwhile. With
// FASCICLE_HOSTILE=N there is N times as much of it, and the release's figures hold; the default is 1.
#include <cstdio>
#include <cstdlib>
#include <random>

#include "stream_clients.h"
#include "tests/support/call_times.h"
#include "tests/support/files.h"
#include "tests/support/raw_http2.h"
#include "tests/support/server_process.h"

namespace fascicle::service_test {
namespace {

using fascicle::testing::CallTimes;
using fascicle::testing::ChildProcess;
using fascicle::testing::Program;
using fascicle::testing::RawHttp2;
using fascicle::testing::TemporaryFolder;

constexpr std::int64_t kMiB = 1 << 20;

int Times() {
  const char* number = std::getenv("FASCICLE_HOSTILE");
  return number != nullptr ? std::max(1, std::atoi(number)) : 1;
}
// Other programs may use the machine of a short run.
double Allowance() { return std::getenv("FASCICLE_HOSTILE") != nullptr ? 1 : 5; }

class HostileTest : public ::testing::Test {
 protected:
  // At most `files` file descriptors, if that is not 0.
  void Start(int files = 0) {
    const std::string limit = files > 0 ? "ulimit -n " + std::to_string(files) + " && " : "";
    server_.emplace(std::vector<std::string>{
        "/bin/sh", "-c",
        limit + "exec " + Program("fascicled") + " --listen 127.0.0.1:0 --data " + data_.path().string()});
    const std::string prefix = "listening on ";
    const std::string line = server_->ReadLine();
    ASSERT_TRUE(line.starts_with(prefix)) << server_->ErrorOutput();
    address_ = line.substr(prefix.size());
    stubs_.emplace(address_);
    stubs_->Submit(SwingingBox(0.01, 0.01));
    before_ = server_->ResidentBytes();
    health_.emplace(HealthCall(address_));
  }
  // Others were served, and memory comes back.
  void ExpectUnharmed() {
    health_->Stop();
    std::printf("  health: %s\n", health_->Summary().c_str());
    EXPECT_EQ(health_->failures(), 0);
    EXPECT_LE(health_->Quantile(0.99), 0.1 * Allowance());
#ifndef __SANITIZE_ADDRESS__  // which keeps freed memory for a while
    EXPECT_TRUE(testing::Eventually([&] { return server_->ResidentBytes() <= before_ + 64 * kMiB; }, 20s))
        << server_->ResidentBytes() / kMiB << " MiB after " << before_ / kMiB;
#endif
    const std::string job = stubs_->Submit(SwingingBox(0.01, 0.01));
    EXPECT_TRUE(stubs_->AwaitState(job, v1::Job::STATE_SUCCEEDED));
  }

  // Makes calls and resets each at once, or all of a hundred together.
  void ResetCalls(const std::string& method, const std::string& message, int count, bool together) {
    std::optional<RawHttp2> connection;
    std::uint32_t stream = 1;
    for (int done = 0; done < count; done += 100) {
      if (!connection) {
        connection.emplace(address_);
        ASSERT_TRUE(connection->Send(RawHttp2::Hello()));
        stream = 1;
      }
      std::string calls, resets;
      for (int i = 0; i < 100; ++i, stream += 2) {
        calls += RawHttp2::Call(stream, method, message);
        (together ? resets : calls) += RawHttp2::Reset(stream);
      }
      if (!connection->Send(calls) || !connection->Send(resets)) {
        connection.reset();  // the server has had enough of this connection
        ++ended_;
      }
    }
  }

  // What one call of CreateJob cost the server.
  struct Cost {
    grpc::Status status;
    std::size_t size = 0;   // of the message [byte]
    double cpu = 0;         // [s]
    std::int64_t peak = 0;  // memory beyond that before [byte]
  };
  Cost Create(const v1::CreateJobRequest& request) {
    Cost cost;
    cost.size = request.ByteSizeLong();
    server_->ForgetPeak();
    const std::int64_t peak = server_->PeakBytes();
    const double cpu = server_->CpuSeconds();
    v1::Job job;
    cost.status = stubs_->Create(request, job);
    cost.cpu = server_->CpuSeconds() - cpu;
    cost.peak = server_->PeakBytes() - peak;
    return cost;
  }

  TemporaryFolder data_;
  std::optional<ChildProcess> server_;
  std::string address_;
  std::optional<Stubs> stubs_;
  std::int64_t before_ = 0;
  std::optional<CallTimes> health_;
  int ended_ = 0;  // connections
};

TEST_F(HostileTest, CallsThatAreResetCostNothing) {
  Start();
  v1::StreamFramesRequest nowhere;
  nowhere.set_name("jobs/nowhere");
  const std::string name = nowhere.SerializeAsString();
  v1::CreateJobRequest create;
  *create.mutable_job()->mutable_scene() = SwingingBox(0.01, 0.01);
  create.set_validate_only(true);
  const int count = 3000 * Times();
  server_->ForgetPeak();
  for (const bool together : {false, true}) {
    ResetCalls("/fascicle.v1.FrameService/StreamFrames", name, count, together);
    ResetCalls("/fascicle.v1.JobService/GetJob", name, count, together);
    ResetCalls("/fascicle.v1.JobService/CreateJob", create.SerializeAsString(), count, together);
    ResetCalls("/fascicle.v1.AssetService/UploadAsset", "", count, together);
    ResetCalls("/grpc.health.v1.Health/Check", "", count, together);
    ResetCalls("/no.such.Service/Method", "", count, together);
    ResetCalls("/grpc.reflection.v1alpha.ServerReflection/ServerReflectionInfo", "", count / 10, together);
  }
  std::printf("  %d calls reset: peak %lld MiB, %d connections ended\n", 12 * count + count / 5,
              static_cast<long long>(server_->PeakBytes() / kMiB), ended_);
  EXPECT_LE(server_->PeakBytes(), 512 * kMiB);
  ExpectUnharmed();
}

TEST_F(HostileTest, ManyConnectionsLeaveRoomForOthers) {
  Start(256);
  std::vector<std::unique_ptr<RawHttp2>> idle;
  for (int i = 0; i < 600; ++i) idle.push_back(std::make_unique<RawHttp2>(address_));
  // They are silent; after some seconds without a call the longest idle one ends.
  std::this_thread::sleep_for(5500ms);
  for (int i = 0; i < 5; ++i) {
    Stubs another(address_);
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + 10s);
    v1::ListJobsResponse jobs;
    EXPECT_TRUE(another.jobs->ListJobs(&context, {}, &jobs).ok()) << "beside 600 idle connections";
  }
  idle.clear();
  Stubs another(address_);
  EXPECT_FALSE(another.Submit(SwingingBox(0.01, 0.01)).empty()) << "after 600 idle connections";
  ExpectUnharmed();
}

TEST_F(HostileTest, UploadsThatStandStillAreFew) {
  Start();
  struct Idle {
    explicit Idle(const std::string& address) : stubs(address) {}
    Stubs stubs;
    struct Call {
      grpc::ClientContext context;
      v1::UploadAssetResponse response;
      std::unique_ptr<grpc::ClientWriter<v1::UploadAssetRequest>> writer;
    };
    std::vector<std::unique_ptr<Call>> calls;
  };
  std::vector<std::unique_ptr<Idle>> clients;
  v1::UploadAssetRequest first;
  first.set_name("assets/" + std::string(64, 'a'));
  first.set_size(1 << 30);
  for (int c = 0; c < 10; ++c) {
    auto& client = *clients.emplace_back(std::make_unique<Idle>(address_));
    for (int i = 0; i < 20; ++i) {
      auto& call = *client.calls.emplace_back(std::make_unique<Idle::Call>());
      call.writer = client.stubs.assets->UploadAsset(&call.context, &call.response);
      call.writer->Write(first);
    }
  }
  std::this_thread::sleep_for(300ms);
  std::map<std::string, int> answers;
  for (auto& client : clients) {
    for (auto& call : client->calls) {
      if (call->writer->Write(first)) {
        ++answers["open"];
        call->context.TryCancel();
        call->writer->Finish();
        continue;
      }
      const grpc::Status status = call->writer->Finish();
      ++answers[ReasonOf(status)];
      EXPECT_TRUE(DetailOf<google::rpc::RetryInfo>(status)) << status.error_message();
    }
  }
  EXPECT_LE(answers["open"], 64);
  EXPECT_GT(answers["14 TOO_MANY_CALLS"] + answers["14 OVERLOADED"], 0);
  ExpectUnharmed();
}

TEST_F(HostileTest, HalfOpenConnectionsAndHalfMessages) {
  Start();
  std::vector<std::unique_ptr<RawHttp2>> open;
  std::mt19937 random(7);
  const std::string whole =
      RawHttp2::Hello() + RawHttp2::Call(1, "/fascicle.v1.JobService/ListJobs", std::string(60, 'x'));
  for (int i = 0; i < 300; ++i) {
    open.push_back(std::make_unique<RawHttp2>(address_));
    std::string bytes = whole.substr(0, random() % whole.size());
    if (i % 3 == 0 && !bytes.empty()) bytes[random() % bytes.size()] ^= static_cast<char>(1 + random() % 255);
    open.back()->Send(bytes);
  }
  Stubs another(address_);
  EXPECT_FALSE(another.Submit(SwingingBox(0.01, 0.01)).empty());
  open.clear();
  ExpectUnharmed();
}

TEST_F(HostileTest, JunkNamesAndMessages) {
  Start();
  std::mt19937 random(8);
  const std::vector<std::string> methods = {
      "JobService/CreateJob",     "JobService/GetJob",          "JobService/ListJobs",
      "JobService/CancelJob",     "JobService/DeleteJob",       "JobService/RestartJob",
      "JobService/VerifyJob",     "FrameService/ListFrames",    "FrameService/StreamFrames",
      "FrameService/GetGeometry", "JobService/BatchCreateJobs", "AssetService/FindMissingAssets"};
  std::string nested;  // a thousand groups within each other, and fields of fields
  for (int i = 0; i < 1000; ++i) nested = "\x0b" + nested + "\x0c";
  std::string fields = "x";
  while (fields.size() < 100'000) {
    std::string length;
    std::size_t size = fields.size();
    for (; size >= 0x80; size >>= 7) length += static_cast<char>(size | 0x80);
    fields = "\x0a" + (length + static_cast<char>(size)) + fields;
    if (fields.size() > 5000) fields += std::string(20'000, '\x0a');
  }
  grpc::GenericStub stub(stubs_->channel);
  for (int i = 0; i < 600 * Times(); ++i) {
    std::string message = i % 10 == 0 ? nested : i % 10 == 1 ? fields : "";
    const std::size_t size = i % 50 == 2 ? 900'000 : random() % 100;
    if (message.empty()) message = "\x0a";
    for (std::size_t k = 0; k < size; ++k) message += static_cast<char>(random());
    const grpc::Slice slice(message);
    const grpc::ByteBuffer request(&slice, 1);
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + 20s);
    grpc::CompletionQueue queue;
    const std::string& method = methods[static_cast<std::size_t>(i) % methods.size()];
    auto call = stub.PrepareUnaryCall(&context, "/fascicle.v1." + method, request, &queue);
    call->StartCall();
    grpc::ByteBuffer response;
    grpc::Status status;
    call->Finish(&response, &status, &response);
    void* tag = nullptr;
    bool ok = false;
    ASSERT_TRUE(queue.Next(&tag, &ok));
    ASSERT_FALSE(status.ok() && !method.ends_with("ListJobs")) << method;
    const std::string reason = status.ok() ? "" : ReasonOf(status);
    EXPECT_EQ(reason.find("without ErrorInfo"), std::string::npos) << method << " " << reason;
  }
  ExpectUnharmed();
}

// Scenes that are cheap to send and dear to check.
std::vector<std::pair<std::string, v1::CreateJobRequest>> DearScenes() {
  std::vector<std::pair<std::string, v1::CreateJobRequest>> requests;
  const auto add = [&requests](const std::string& what) -> v1::Scene& {
    v1::CreateJobRequest& request = requests.emplace_back(what, v1::CreateJobRequest()).second;
    request.set_validate_only(true);
    *request.mutable_job()->mutable_scene() = SwingingBox(0.01, 0.01);
    return *request.mutable_job()->mutable_scene();
  };
  const auto add_region = [](v1::Body& body, const std::string& name) {
    v1::Region& region = *body.add_regions();
    region.set_name(name);
    for (const double x : {0.0, 0.0, -1e6}) region.mutable_plane()->add_point(x);
    for (const double x : {0.0, 0.0, 1.0}) region.mutable_plane()->add_normal(x);
  };
  v1::Body& unknown = *add("unknown references").mutable_bodies(0);
  for (int i = 0; i < 5000; ++i) {
    add_region(unknown, "a_region_with_a_name_" + std::to_string(i));
    unknown.add_constraints()->set_region("a_region_without_name_" + std::to_string(i));
  }
  v1::Body& regions = *add("regions that hold everything").mutable_bodies(0);
  for (int i = 0; i < 3; ++i) regions.mutable_mesh()->mutable_box()->set_divisions(i, 24);
  for (int i = 0; i < 6000; ++i) add_region(regions, "all_" + std::to_string(i));
  v1::Scene& bodies = add("many bodies");
  const v1::Body body = bodies.bodies(0);
  for (int i = 0; i < 1500; ++i) {
    *bodies.add_bodies() = body;
    bodies.mutable_bodies(i + 1)->set_name("body_" + std::to_string(i));
  }
  v1::Scene& same = add("bodies of one name");
  for (int i = 0; i < 1500; ++i) *same.add_bodies() = body;
  v1::Body& curve = *add("a long curve").mutable_bodies(0);
  for (int i = 0; i < 40'000; ++i) {
    curve.mutable_activation()->add_times(1e-6 * i);
    curve.mutable_activation()->add_values(0.5);
  }
  v1::Body& box = *add("a box of 1000^3").mutable_bodies(0);
  for (int i = 0; i < 3; ++i) box.mutable_mesh()->mutable_box()->set_divisions(i, 1000);
  add("frames without number").mutable_output()->set_frame_interval(1e-15);
  v1::Scene& probes = add("probes everywhere");
  for (int i = 0; i < 10'000; ++i) {
    v1::Probe& probe = *probes.mutable_output()->add_probes();
    probe.set_name("probe_" + std::to_string(i));
    probe.set_body("box");
    for (const double x : {1.0, 1.0, 1.0}) probe.add_point(x);
  }
  return requests;
}

TEST_F(HostileTest, ScenesThatAreDearToCheck) {
  Start();
  for (const auto& [what, request] : DearScenes()) {
    const Cost cost = Create(request);
    std::printf("  %s: %zu bytes, %.2f s of CPU, %lld MiB; %s\n", what.c_str(), cost.size, cost.cpu,
                static_cast<long long>(cost.peak / kMiB), cost.status.error_message().substr(0, 100).c_str());
    EXPECT_LE(cost.cpu, 1) << what;
    EXPECT_LE(cost.peak, 50 * static_cast<std::int64_t>(cost.size) + 64 * kMiB) << what;
  }
  ExpectUnharmed();
}

}  // namespace
}  // namespace fascicle::service_test
