// What clients may use at once, and what ends by itself.
#include <thread>

#include "tests/support/raw_http2.h"
#include "tests/support/service_fixture.h"

namespace fascicle::service_test {
namespace {

using fascicle::testing::RawHttp2;

class LimitsTest : public ServiceTest {
 protected:
  server::ServerOptions Options() override {
    server::ServerOptions options;
    options.workers = 1;
    options.connections = 2;
    options.streams = 3;
    options.uploads = 2;
    options.idle_upload = 400ms;
    options.silent_connection = 500ms;
    return options;
  }

  struct Stream {
    grpc::ClientContext context;
    std::unique_ptr<grpc::ClientReader<v1::StreamFramesResponse>> reader;
    v1::StreamFramesResponse message;
  };
  // A stream that has begun, or has been refused.
  std::unique_ptr<Stream> Open(Stubs& stubs, const std::string& name) {
    auto stream = std::make_unique<Stream>();
    stream->reader = stubs.frames->StreamFrames(&stream->context, AllFramesOf(name));
    stream->reader->Read(&stream->message);
    return stream;
  }
  void Close(Stream& stream) {
    stream.context.TryCancel();
    stream.reader->Finish();
  }
};

void ExpectRefused(const grpc::Status& status, const std::string& reason) {
  EXPECT_EQ(ReasonOf(status), "14 " + reason) << status.error_message();
  const auto retry = DetailOf<google::rpc::RetryInfo>(status);
  ASSERT_TRUE(retry);
  EXPECT_GT(retry->retry_delay().seconds(), 0);
}

TEST_F(LimitsTest, TheServerTellsThem) {
  grpc::ClientContext context;
  v1::ServerInfo info;
  ASSERT_TRUE(stubs_->server->GetServerInfo(&context, {}, &info).ok());
  EXPECT_EQ(info.limits().connections(), 2);
  EXPECT_EQ(info.limits().streams(), 3);
  EXPECT_EQ(info.limits().uploads(), 2);
  EXPECT_GT(info.limits().submissions_of_connection(), 0);
  EXPECT_EQ(info.limits().idle_upload().nanos(), 400'000'000);
}

TEST_F(LimitsTest, StreamsInAllAndPlacesForTheRest) {
  const std::string job = stubs_->Submit(LongScene());
  std::vector<std::unique_ptr<Stream>> streams;
  for (int i = 0; i < 3; ++i) {
    streams.push_back(Open(*stubs_, job));
    EXPECT_TRUE(streams.back()->message.has_header());
  }
  const auto refused = Open(*stubs_, job);
  ExpectRefused(refused->reader->Finish(), "TOO_MANY_CALLS");
  Stubs another(server_->address());
  ExpectRefused(Open(another, job)->reader->Finish(), "OVERLOADED");
  EXPECT_EQ(another.Get(job).name(), job);
  Close(*streams[0]);
  std::unique_ptr<Stream> again;
  EXPECT_TRUE(Eventually([&] {
    again = Open(*stubs_, job);
    return again->message.has_header();
  })) << "a place that was given back";
  Close(*again);
  for (std::size_t i = 1; i < streams.size(); ++i) Close(*streams[i]);
  EXPECT_TRUE(another.Cancel(job).ok());
}

TEST_F(LimitsTest, ConnectionsBeyondTheLimitShowAndCancelJobs) {
  const std::string job = stubs_->Submit(LongScene());
  const auto first = Open(*stubs_, job);  // which keeps its connection from being idle
  Stubs second(server_->address());
  const auto other = Open(second, job);
  Stubs third(server_->address());
  v1::CreateJobRequest request;
  *request.mutable_job()->mutable_scene() = SwingingBox(0.01, 0.01);
  v1::Job answer;
  ExpectRefused(third.Create(request, answer), "TOO_MANY_CONNECTIONS");
  ExpectRefused(Open(third, job)->reader->Finish(), "TOO_MANY_CONNECTIONS");
  EXPECT_EQ(third.Get(job).name(), job);
  EXPECT_TRUE(third.Cancel(job).ok());
  Close(*first);
  Close(*other);
}

TEST_F(LimitsTest, AnIdleUploadEnds) {
  grpc::ClientContext context;
  v1::UploadAssetResponse response;
  const auto writer = stubs_->assets->UploadAsset(&context, &response);
  v1::UploadAssetRequest request;
  request.set_name("assets/" + std::string(64, 'a'));
  request.set_size(1000);
  const auto start = std::chrono::steady_clock::now();
  for (int i = 0; i < 4; ++i) {  // slow, but not idle
    EXPECT_TRUE(writer->Write(request));
    std::this_thread::sleep_for(200ms);
  }
  EXPECT_EQ(ReasonOf(writer->Finish()), "4 IDLE_UPLOAD");
  EXPECT_GE(std::chrono::steady_clock::now() - start, 900ms);
}

TEST_F(LimitsTest, ASilentConnectionEnds) {
  RawHttp2 nothing(server_->address());
  EXPECT_TRUE(nothing.AwaitEnd(4s));
  RawHttp2 polite(server_->address());
  polite.Send(RawHttp2::Hello());
  EXPECT_TRUE(polite.AwaitEnd(4s)) << "without a call";
  EXPECT_TRUE(stubs_->jobs != nullptr);
}

TEST_F(LimitsTest, AConnectionThatResetsAllItsCallsEnds) {
  RawHttp2 connection(server_->address());
  ASSERT_TRUE(connection.Send(RawHttp2::Hello()));
  bool open = true;
  std::uint32_t stream = 1;
  for (int i = 0; i < 1000 && open; ++i) {
    std::string calls, resets;
    for (int k = 0; k < 100; ++k, stream += 2) {
      calls += RawHttp2::Call(stream, "/grpc.health.v1.Health/Check", "");
      resets += RawHttp2::Reset(stream);
    }
    open = connection.Send(calls + resets);
  }
  EXPECT_FALSE(open);
  EXPECT_FALSE(stubs_->Submit(SwingingBox(0.01, 0.01)).empty());
}

}  // namespace
}  // namespace fascicle::service_test
