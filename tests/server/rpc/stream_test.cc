// The contract of StreamFrames, for running and finished jobs.
#include <algorithm>
#include <string>
#include <thread>
#include <vector>

#include <grpcpp/generic/generic_stub.h>

#include "tests/support/service_fixture.h"

namespace fascicle::service_test {
namespace {

std::vector<std::string> DigestsOf(const std::vector<v1::Frame>& frames) {
  std::vector<std::string> digests;
  for (const v1::Frame& frame : frames) digests.push_back(std::to_string(frame.index()) + frame.digest());
  return digests;
}

std::vector<std::int64_t> IndicesOf(const std::vector<v1::Frame>& frames) {
  std::vector<std::int64_t> indices;
  for (const v1::Frame& frame : frames) indices.push_back(frame.index());
  return indices;
}

class StreamTest : public ServiceTest {
 protected:
  server::ServerOptions Options() override {
    server::ServerOptions options;
    options.heartbeat_interval = 200ms;
    options.progress_interval = 50ms;
    return options;
  }
};

TEST_F(StreamTest, AJobIsFollowedFromItsFirstFrameToItsEnd) {
  const std::string name = stubs_->Submit(SwingingBox(1, 0.01));
  const StreamRecord record = ReadStream(*stubs_, AllFramesOf(name));
  ASSERT_TRUE(record.status.ok()) << record.status.error_message();
  ASSERT_TRUE(record.header && record.end);
  EXPECT_EQ(record.header->next_index(), 0);
  EXPECT_GE(record.header->generation(), 1);
  EXPECT_EQ(record.end->job().state(), v1::Job::STATE_SUCCEEDED);
  EXPECT_EQ(record.end->job().name(), name);
  EXPECT_EQ(record.end->next_index(), 101);
  ASSERT_EQ(record.frames.size(), 101u);
  // Every frame equals the stored one.
  const std::vector<v1::FrameInfo> stored = stubs_->List(name);
  ASSERT_EQ(stored.size(), 101u);
  for (std::size_t i = 0; i < stored.size(); ++i) {
    EXPECT_EQ(stored[i].index(), static_cast<std::int64_t>(i));
    EXPECT_EQ(stored[i].digest(), record.frames[i].digest());
    EXPECT_EQ(stored[i].time(), record.frames[i].time());
    EXPECT_EQ(stored[i].size(), static_cast<std::int64_t>(record.frames[i].ByteSizeLong()));
  }
  // A late joiner gets the same.
  EXPECT_EQ(DigestsOf(ReadStream(*stubs_, AllFramesOf(name)).frames), DigestsOf(record.frames));
}

TEST_F(StreamTest, FramesOfSeveralChunks) {
  const std::string name = stubs_->Submit(LargeFrames(4));
  const StreamRecord record = ReadStream(*stubs_, AllFramesOf(name));
  ASSERT_TRUE(record.status.ok()) << record.status.error_message();
  ASSERT_EQ(record.frames.size(), 4u);
  for (const v1::Frame& frame : record.frames) EXPECT_GT(frame.ByteSizeLong(), std::size_t{2} << 20);
}

TEST_F(StreamTest, AWatcherThatIsCutAndResumesSeesWhatOneNeverCutSees) {
  const std::string name = stubs_->Submit(SwingingBox(2, 0.01));
  StreamRecord whole;
  std::thread never_cut([&] {
    Stubs stubs(server_->address());
    whole = ReadStream(stubs, AllFramesOf(name));
  });
  std::vector<v1::Frame> pieces;
  for (std::size_t cut = 1;; ++cut) {  // after 1, 2, 3, ... frames
    v1::StreamFramesRequest request = AllFramesOf(name);
    request.set_start_index(static_cast<std::int64_t>(pieces.size()));
    StreamRecord piece = ReadStream(*stubs_, request, [cut](const StreamRecord& r) { return r.frames.size() < cut; });
    pieces.insert(pieces.end(), piece.frames.begin(), piece.frames.end());
    if (piece.end) break;
    ASSERT_EQ(piece.frames.size(), cut);
    ASSERT_EQ(piece.status.error_code(), grpc::StatusCode::CANCELLED);
  }
  never_cut.join();
  ASSERT_TRUE(whole.status.ok());
  ASSERT_EQ(whole.frames.size(), 201u);
  EXPECT_EQ(DigestsOf(pieces), DigestsOf(whole.frames));
  EXPECT_EQ(stubs_->Get(name).state(), v1::Job::STATE_SUCCEEDED);
}

TEST_F(StreamTest, ADisconnectDoesNotCancelTheJob) {
  const std::string name = stubs_->Submit(LongScene());
  const auto cut = [](const StreamRecord& record) { return record.frames.size() < 3; };
  for (int i = 0; i < 5; ++i) {
    Stubs stubs(server_->address());  // with its connection
    EXPECT_EQ(ReadStream(stubs, AllFramesOf(name), cut).frames.size(), 3u);
  }
  const std::int64_t count = stubs_->Get(name).frame_count();
  EXPECT_TRUE(stubs_->AwaitFrames(name, count + 10));
  EXPECT_EQ(stubs_->Get(name).state(), v1::Job::STATE_RUNNING);
}

TEST_F(StreamTest, RangesAndStrides) {
  const std::string name = stubs_->Submit(SwingingBox(0.2, 0.01));
  ASSERT_TRUE(stubs_->AwaitState(name, v1::Job::STATE_SUCCEEDED));
  const auto indices = [&](std::int64_t start, std::int64_t end, std::int64_t stride) {
    v1::StreamFramesRequest request = AllFramesOf(name);
    request.set_start_index(start);
    request.set_end_index(end);
    request.set_stride(stride);
    const StreamRecord record = ReadStream(*stubs_, request);
    EXPECT_TRUE(record.status.ok() && record.end);
    return IndicesOf(record.frames);
  };
  EXPECT_EQ(indices(3, 6, 0), (std::vector<std::int64_t>{3, 4, 5}));
  EXPECT_EQ(indices(2, 0, 7), (std::vector<std::int64_t>{2, 9, 16}));
  EXPECT_EQ(indices(0, 12, 5), (std::vector<std::int64_t>{0, 5, 10}));
  EXPECT_EQ(indices(20, 0, 1), (std::vector<std::int64_t>{20}));
  EXPECT_EQ(indices(21, 0, 1), (std::vector<std::int64_t>{})) << "complete already: the end at once";
  EXPECT_EQ(indices(23, 0, 7), (std::vector<std::int64_t>{})) << "the next index after 2, 9, 16";
  EXPECT_EQ(indices(5, 5, 1), (std::vector<std::int64_t>{}));
}

TEST_F(StreamTest, WithoutFollowItEndsWithWhatIsStored) {
  const std::string name = stubs_->Submit(LongScene());
  ASSERT_TRUE(stubs_->AwaitFrames(name, 5));
  v1::StreamFramesRequest request = AllFramesOf(name);
  request.set_follow(false);
  const StreamRecord record = ReadStream(*stubs_, request);
  ASSERT_TRUE(record.status.ok() && record.end);
  EXPECT_GE(record.frames.size(), 5u);
  EXPECT_EQ(record.end->next_index(), static_cast<std::int64_t>(record.frames.size()));
  EXPECT_EQ(record.end->job().state(), v1::Job::STATE_RUNNING);
}

TEST_F(StreamTest, AnEndIndexEndsTheStreamOfALiveJob) {
  const std::string name = stubs_->Submit(LongScene());
  v1::StreamFramesRequest request = AllFramesOf(name);
  request.set_end_index(20);
  const StreamRecord record = ReadStream(*stubs_, request);
  ASSERT_TRUE(record.status.ok() && record.end);
  EXPECT_EQ(record.frames.size(), 20u);
  EXPECT_EQ(record.end->next_index(), 20);
}

TEST_F(StreamTest, LatestSkipsWhatASlowReaderMissed) {
  const std::string name = stubs_->Submit(LongScene(3000));
  v1::StreamFramesRequest request = AllFramesOf(name);
  request.set_mode(v1::StreamFramesRequest::MODE_LATEST);
  const StreamRecord record = ReadStream(*stubs_, request, [](const StreamRecord&) {
    std::this_thread::sleep_for(20ms);
    return true;
  });
  ASSERT_TRUE(record.status.ok() && record.end);
  const std::vector<std::int64_t> indices = IndicesOf(record.frames);
  EXPECT_TRUE(std::is_sorted(indices.begin(), indices.end()));
  EXPECT_EQ(std::adjacent_find(indices.begin(), indices.end()), indices.end());
  EXPECT_LT(indices.size(), 1500u);
  ASSERT_FALSE(indices.empty());
  EXPECT_EQ(indices.back(), 3000) << "the last frame is always delivered";
}

TEST_F(StreamTest, LatestOfADoneJobIsItsLastFrame) {
  const std::string name = stubs_->Submit(SwingingBox(0.2, 0.01));
  ASSERT_TRUE(stubs_->AwaitState(name, v1::Job::STATE_SUCCEEDED));
  v1::StreamFramesRequest request = AllFramesOf(name);
  request.set_mode(v1::StreamFramesRequest::MODE_LATEST);
  EXPECT_EQ(IndicesOf(ReadStream(*stubs_, request).frames), std::vector<std::int64_t>{20});
  request.set_stride(7);
  EXPECT_EQ(IndicesOf(ReadStream(*stubs_, request).frames), std::vector<std::int64_t>{14});
  request.set_end_index(9);
  EXPECT_EQ(IndicesOf(ReadStream(*stubs_, request).frames), std::vector<std::int64_t>{7});
}

TEST_F(StreamTest, HeartbeatsTellOfAJobThatWaitsAndOfOneThatIsSlow) {
  // Two jobs with rare frames keep the workers busy; a third waits.
  v1::Scene slow = SwingingBox(1000, 500);
  for (int i = 0; i < 3; ++i) slow.mutable_bodies(0)->mutable_mesh()->mutable_box()->set_divisions(i, 8);
  const std::string running = stubs_->Submit(slow);
  stubs_->Submit(slow);
  const std::string waiting = stubs_->Submit(slow);
  const auto beats_of = [&](const std::string& name) {
    std::vector<v1::StreamFramesResponse::Heartbeat> beats;
    std::vector<std::chrono::steady_clock::time_point> times;
    grpc::ClientContext context;
    const auto reader = stubs_->frames->StreamFrames(&context, AllFramesOf(name));
    v1::StreamFramesResponse message;
    while (beats.size() < 6 && reader->Read(&message)) {
      if (!message.has_heartbeat()) continue;
      beats.push_back(message.heartbeat());
      times.push_back(std::chrono::steady_clock::now());
    }
    context.TryCancel();
    reader->Finish();
    for (std::size_t i = 1; i < times.size(); ++i) EXPECT_LT(times[i] - times[i - 1], 2s);
    return beats;
  };
  for (const auto& beat : beats_of(waiting)) {
    EXPECT_EQ(beat.state(), v1::Job::STATE_QUEUED);
    EXPECT_EQ(beat.next_index(), 0);
  }
  ASSERT_TRUE(stubs_->AwaitFrames(running, 1));
  const auto beats = beats_of(running);
  ASSERT_EQ(beats.size(), 6u);
  EXPECT_EQ(beats.back().state(), v1::Job::STATE_RUNNING);
  EXPECT_EQ(beats.back().next_index(), 1);
  EXPECT_GT(beats.back().progress().step(), beats[1].progress().step());
  EXPECT_GT(beats.back().progress().time_step(), 0);
}

// Timers that come too late to help.
class StreamWakeTest : public ServiceTest {
 protected:
  server::ServerOptions Options() override {
    server::ServerOptions options;
    options.heartbeat_interval = 60s;
    options.progress_interval = 20s;
    return options;
  }
  StreamRecord ReadSoon(const v1::StreamFramesRequest& request) {
    const auto start = std::chrono::steady_clock::now();
    StreamRecord record = ReadStream(*stubs_, request);
    EXPECT_LT(std::chrono::steady_clock::now() - start, 10s);
    EXPECT_TRUE(record.end.has_value());
    return record;
  }
};

TEST_F(StreamWakeTest, WhatIsStoredIsSentAtOnce) {
  EXPECT_EQ(ReadSoon(AllFramesOf(stubs_->Submit(SwingingBox(1, 0.01)))).frames.size(), 101u);
  v1::StreamFramesRequest latest = AllFramesOf(stubs_->Submit(SwingingBox(1, 0.01)));
  latest.set_mode(v1::StreamFramesRequest::MODE_LATEST);
  const StreamRecord record = ReadSoon(latest);
  ASSERT_FALSE(record.frames.empty());
  EXPECT_EQ(record.frames.back().index(), 100);
}

TEST_F(StreamWakeTest, AReaderGetsMoreWhenItHasRoom) {
  const std::string large = stubs_->Submit(LargeFrames(4)), small = stubs_->Submit(SwingingBox(2, 0.01));
  for (const std::string& name : {large, small}) {
    ASSERT_TRUE(stubs_->AwaitState(name, v1::Job::STATE_SUCCEEDED, 60s));
  }
  EXPECT_EQ(ReadSoon(AllFramesOf(large)).frames.size(), 4u);
  EXPECT_EQ(ReadSoon(AllFramesOf(small)).frames.size(), 201u);
}

class StreamProgressTest : public ServiceTest {
 protected:
  server::ServerOptions Options() override {
    server::ServerOptions options;
    options.heartbeat_interval = 60s;
    options.progress_interval = 50ms;
    return options;
  }
};

TEST_F(StreamProgressTest, IsToldBetweenFrames) {
  v1::Scene slow = SwingingBox(1000, 500);
  for (int i = 0; i < 3; ++i) slow.mutable_bodies(0)->mutable_mesh()->mutable_box()->set_divisions(i, 8);
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + 20s);
  const auto reader = stubs_->frames->StreamFrames(&context, AllFramesOf(stubs_->Submit(slow)));
  v1::StreamFramesResponse message;
  int beats = 0;
  while (beats < 6 && reader->Read(&message)) beats += message.has_heartbeat();
  EXPECT_EQ(beats, 6);
  context.TryCancel();
  reader->Finish();
}

TEST_F(StreamTest, AStreamOfADeletedJobEnds) {
  const std::string name = stubs_->Submit(LongScene());
  ASSERT_TRUE(stubs_->AwaitFrames(name, 1));
  StreamRecord record;
  std::thread watcher([&] {
    Stubs stubs(server_->address());
    record = ReadStream(stubs, AllFramesOf(name));
  });
  ASSERT_TRUE(stubs_->Cancel(name).ok());
  ASSERT_TRUE(Eventually([&] {
    grpc::ClientContext context;
    v1::DeleteJobRequest request;
    request.set_name(name);
    google::protobuf::Empty empty;
    return stubs_->jobs->DeleteJob(&context, request, &empty).ok();
  }));
  watcher.join();
  // It saw the end of the cancelled job, or that the job was deleted.
  if (record.end) {
    EXPECT_EQ(record.end->job().state(), v1::Job::STATE_CANCELLED);
  } else {
    EXPECT_EQ(ReasonOf(record.status), "5 NOT_FOUND");
  }
}

TEST_F(StreamTest, StoppingEndsEveryStreamWithUnavailable) {
  const std::string name = stubs_->Submit(LongScene());
  const std::string waiting = stubs_->Submit(SwingingBox(1000, 500));
  constexpr int kStreams = 20;
  std::vector<StreamRecord> records(kStreams);
  std::vector<std::thread> watchers;
  std::atomic<int> started = 0;
  for (int i = 0; i < kStreams; ++i) {
    watchers.emplace_back([&, i] {
      Stubs stubs(server_->address());
      bool first = true;
      records[static_cast<std::size_t>(i)] =
          ReadStream(stubs, AllFramesOf(i % 2 == 0 ? name : waiting), [&](const StreamRecord&) {
            if (std::exchange(first, false)) ++started;
            return true;
          });
    });
  }
  EXPECT_TRUE(Eventually([&] { return started == kStreams; })) << started << " streams have begun";
  const auto begin = std::chrono::steady_clock::now();
  server_->Stop();
  EXPECT_LT(std::chrono::steady_clock::now() - begin, 10s);
  for (std::thread& watcher : watchers) watcher.join();
  for (const StreamRecord& record : records) {
    EXPECT_FALSE(record.end);
    EXPECT_EQ(ReasonOf(record.status), "14 SHUTTING_DOWN") << record.status.error_message();
    const auto retry = DetailOf<google::rpc::RetryInfo>(record.status);
    ASSERT_TRUE(retry);
    EXPECT_GE(retry->retry_delay().seconds(), 1);
  }
  server_->Stop();  // again: nothing happens
}

TEST_F(StreamTest, StoppingEndsUploadsAndReadersThatStandStill) {
  const std::string name = stubs_->Submit(LargeFrames(8));
  ASSERT_TRUE(stubs_->AwaitState(name, v1::Job::STATE_SUCCEEDED, 60s));
  grpc::ClientContext reading;
  const auto reader = stubs_->frames->StreamFrames(&reading, AllFramesOf(name));  // never reads
  grpc::ClientContext uploading;
  v1::UploadAssetResponse response;
  const auto writer = stubs_->assets->UploadAsset(&uploading, &response);
  v1::UploadAssetRequest request;
  request.set_name("assets/" + std::string(64, 'a'));
  request.set_size(1000);
  writer->Write(request);
  grpc::ClientContext asking;
  v1::GetGeometryRequest geometry_request;
  geometry_request.set_name(name);
  const auto geometry = stubs_->frames->GetGeometry(&asking, geometry_request);
  std::this_thread::sleep_for(200ms);
  const auto begin = std::chrono::steady_clock::now();
  server_->Stop();
  EXPECT_LT(std::chrono::steady_clock::now() - begin, 8s);
  EXPECT_FALSE(writer->Finish().ok());
}

}  // namespace
}  // namespace fascicle::service_test
