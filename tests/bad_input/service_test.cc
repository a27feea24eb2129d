// The same wrong scenes with the real programs: exit code 2, every problem printed, no files left behind, and a server
// that continues to work.
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <google/rpc/error_details.pb.h>
#include <google/rpc/status.pb.h>
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include "cases.h"
#include "client/lib/client.h"
#include "fascicle/v1/simulation_service.grpc.pb.h"
#include "tests/support/files.h"
#include "tests/support/paths.h"
#include "tests/support/server_process.h"

namespace fascicle {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using testing::Finished;
using ::testing::HasSubstr;
using testing::Program;
using testing::RunProgram;
using testing::ServerProcess;
using testing::TemporaryFolder;

class BadInputService : public ::testing::Test {
 protected:
  void SetUp() override {
    address_ = server_.AwaitAddress();
    ASSERT_NE(address_, "") << server_.ErrorOutput();
  }

  static void ExpectRefused(const BadCase& bad, std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), Program("fascicle"));
    const Finished answer = RunProgram(arguments);
    const std::string output = answer.out + answer.err;
    EXPECT_EQ(answer.exit_code, 2) << bad.name << ": " << arguments[1] << "\n" << output;
    for (const Expectation& expected : bad.expected) {
      EXPECT_THAT(output, AllOf(HasSubstr(expected.path), HasSubstr(expected.text)))
          << bad.name << ": " << arguments[1];
    }
  }

  void ExpectServes() {
    client::Client client(address_);
    EXPECT_TRUE(client.GetServerInfo().ok());
    const auto jobs = client.ListJobs(10, {});
    ASSERT_TRUE(jobs.ok());
    EXPECT_TRUE(jobs.value().empty()) << "a job was made of a wrong scene";
    EXPECT_FALSE(server_.Wait(std::chrono::milliseconds(0)).has_value()) << server_.ErrorOutput();
  }

  const TemporaryFolder data_;
  const TemporaryFolder scratch_;
  ServerProcess server_{{"--listen", "127.0.0.1:0", "--data", data_.path()}};
  std::string address_;
};

TEST_F(BadInputService, ProgramsRefuseEveryCase) {
  int number = 0;
  for (const BadCase& bad : AllCases()) {
    const auto before = Listing(bad.folder);
    ExpectRefused(bad, {"--server", address_, "submit", bad.scene()});
    // The other commands share all but their first lines with this one.
    if (++number % 5 == 0) {
      ExpectRefused(bad, {"--server", address_, "validate", bad.scene()});
      ExpectRefused(bad, {"run", bad.scene(), "--out", scratch_ / "results"});
    }
    EXPECT_EQ(Listing(bad.folder), before) << bad.name;
    EXPECT_FALSE(fs::exists(scratch_ / "results")) << bad.name;
  }
  ExpectServes();
  // Complete assets are kept for later jobs; jobs and incomplete uploads are not.
  for (const fs::path& path : Listing(data_.path())) {
    // The server's own files are at the top.
    if (!fs::is_regular_file(path) || path.parent_path() == data_.path()) continue;
    EXPECT_EQ(path.parent_path().parent_path().filename(), "assets") << path;
    EXPECT_EQ(path.filename().string().size(), 64u) << path;
  }
}

TEST_F(BadInputService, TheWireIsCheckedToo) {
  const auto stub = v1::JobService::NewStub(grpc::CreateChannel(address_, grpc::InsecureChannelCredentials()));
  v1::CreateJobRequest request;
  request.mutable_job()->set_threads(-1);
  v1::Scene& scene = *request.mutable_job()->mutable_scene();
  scene.set_duration(std::numeric_limits<double>::quiet_NaN());
  scene.mutable_output()->set_frame_interval(0.1);
  v1::Body& body = *scene.add_bodies();
  body.set_name("b");
  body.set_unit(static_cast<v1::LengthUnit>(77));
  body.mutable_mesh()->mutable_box();
  body.mutable_mesh()->mutable_box()->add_size(std::numeric_limits<double>::infinity());
  body.mutable_fibres()->mutable_file()->set_path("../../etc/passwd");
  body.mutable_fibres()->mutable_file()->set_asset("assets/../../../etc/passwd");
  grpc::ClientContext context;
  context.set_wait_for_ready(true);  // see Stubs in tests/support/service_fixture.h
  v1::Job job;
  const grpc::Status status = stub->CreateJob(&context, request, &job);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT) << status.error_message();
  google::rpc::Status details;
  ASSERT_TRUE(details.ParseFromString(status.error_details()));
  google::rpc::BadRequest bad;
  bool found = false;
  for (const auto& any : details.details()) found = any.UnpackTo(&bad) || found;
  ASSERT_TRUE(found) << details.ShortDebugString();
  std::string paths;
  for (const auto& violation : bad.field_violations()) {
    paths += violation.field() + "\n";
    EXPECT_FALSE(violation.description().empty()) << violation.field();
  }
  for (const char* path : {"duration", "method", "threads", "bodies[0].unit", "bodies[0].mesh.box.size",
                           "bodies[0].material", "bodies[0].fibres.file.asset"}) {
    EXPECT_NE(paths.find(path), std::string::npos) << path << " is missing in\n" << paths;
  }
  ExpectServes();
}

}  // namespace
}  // namespace fascicle
