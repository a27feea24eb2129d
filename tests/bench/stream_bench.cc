// StreamFrames of a stored job compared with a plain gRPC stream of the same messages from memory; GetJob with a plain
// response; and StreamFrames beside stalled readers with the same alone. All servers run in this process, each with its
// own connection, and the same client reads from them.
#include <stdlib.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <grpcpp/grpcpp.h>
#include <spdlog/logger.h>

#include "core/base/digest.h"
#include "fascicle/v1/simulation_service.grpc.pb.h"
#include "ratio.h"
#include "server/jobs/job_manager.h"
#include "server/rpc/rpc_server.h"
#include "server/store/result_store.h"
#include "server/store/store.h"
#include "server/translate/job_codec.h"
#include "server/translate/result_cache.h"
#include "tests/support/files.h"

namespace fascicle::server {
namespace {

constexpr int kFrames = 100;
constexpr std::int64_t kFrameSize = 3 * FrameStore::kChunkSize + FrameStore::kChunkSize / 2;
constexpr int kCalls = 1000;
constexpr int kStalled = 20;

std::string RandomBytes(std::size_t size) {
  std::string bytes(size, '\0');
  std::mt19937_64 random(7);
  for (std::size_t i = 0; i + 8 <= size; i += 8) {
    const std::uint64_t value = random();
    for (std::size_t j = 0; j < 8; ++j) bytes[i + j] = static_cast<char>(value >> (8 * j));
  }
  return bytes;
}

// The frames of a finished job.
std::string PutJob(Store& store, const std::string& frame) {
  JobRecord job;
  job.id = "01AAAAAAAAAAAAAAAAAAAAAAAA";
  JobRecord existing;
  store.CreateJob(job, &existing);
  job.state = JobState::kSucceeded;
  store.UpdateJob(job);
  const auto frames = store.OpenFrames(job.id);
  for (int i = 0; i < kFrames; ++i) {
    FrameRecord record;
    record.index = i;
    record.size = static_cast<std::int64_t>(frame.size());
    record.digest = std::string(32, static_cast<char>(i));
    frames->PutFrame(record, frame, "");
  }
  return job.id;
}

// The same messages, serialized by gRPC from memory.
class RawStream : public grpc::ServerWriteReactor<v1::StreamFramesResponse> {
 public:
  explicit RawStream(const std::string& frame) : frame_(frame) { Next(); }

  void OnWriteDone(bool ok) override { ok ? Next() : Finish(grpc::Status::CANCELLED); }
  void OnDone() override { delete this; }

 private:
  void Next() {
    if (index_ == kFrames) {
      Finish(grpc::Status::OK);
      return;
    }
    v1::Chunk& chunk = *message_.mutable_chunk();
    const std::int64_t size = std::min(FrameStore::kChunkSize, kFrameSize - offset_);
    chunk.set_frame_index(index_);
    chunk.set_offset(offset_);
    chunk.set_data(frame_.data() + offset_, static_cast<std::size_t>(size));
    offset_ += size;
    chunk.set_last(offset_ == kFrameSize);
    if (chunk.last()) {
      ++index_;
      offset_ = 0;
    }
    StartWrite(&message_);
  }

  const std::string& frame_;
  std::int64_t index_ = 0;
  std::int64_t offset_ = 0;
  v1::StreamFramesResponse message_;
};

class RawFrames : public v1::FrameService::CallbackService {
 public:
  explicit RawFrames(const std::string& frame) : frame_(frame) {}
  grpc::ServerWriteReactor<v1::StreamFramesResponse>* StreamFrames(grpc::CallbackServerContext*,
                                                                   const v1::StreamFramesRequest*) override {
    return new RawStream(frame_);
  }

 private:
  const std::string& frame_;
};

class RawJobs : public v1::JobService::CallbackService {
 public:
  explicit RawJobs(v1::Job job) : job_(std::move(job)) {}
  grpc::ServerUnaryReactor* GetJob(grpc::CallbackServerContext* call, const v1::GetJobRequest*,
                                   v1::Job* response) override {
    *response = job_;
    grpc::ServerUnaryReactor* reactor = call->DefaultReactor();
    reactor->Finish(grpc::Status::OK);
    return reactor;
  }

 private:
  const v1::Job job_;
};

std::shared_ptr<grpc::Channel> ChannelTo(int port) {
  grpc::ChannelArguments arguments;
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  return grpc::CreateCustomChannel("127.0.0.1:" + std::to_string(port), grpc::InsecureChannelCredentials(), arguments);
}

void ReadAll(v1::FrameService::Stub& stub, const std::string& name) {
  grpc::ClientContext context;
  v1::StreamFramesRequest request;
  request.set_name(name);
  request.set_follow(true);
  const auto reader = stub.StreamFrames(&context, request);
  v1::StreamFramesResponse message;
  std::int64_t bytes = 0;
  while (reader->Read(&message)) bytes += static_cast<std::int64_t>(message.chunk().data().size());
  if (!reader->Finish().ok() || bytes != kFrames * kFrameSize) throw std::runtime_error("the stream was interrupted");
}

// Readers that take the header of a stream and nothing more, each with its own connection, until destroyed.
class StalledReaders {
 public:
  StalledReaders(int port, const std::string& name) {
    v1::StreamFramesRequest request;
    request.set_name(name);
    for (int i = 0; i < kStalled; ++i) {
      Reader& one = *readers_.emplace_back(std::make_unique<Reader>());
      one.stub = v1::FrameService::NewStub(ChannelTo(port));
      one.stream = one.stub->StreamFrames(&one.context, request);
      v1::StreamFramesResponse header;
      if (!one.stream->Read(&header)) throw std::runtime_error("the stream was interrupted");
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(300));  // until the buffers between are full
  }
  ~StalledReaders() {
    for (auto& one : readers_) {
      one->context.TryCancel();
      one->stream->Finish();
    }
  }

 private:
  struct Reader {
    std::unique_ptr<v1::FrameService::Stub> stub;
    grpc::ClientContext context;
    std::unique_ptr<grpc::ClientReader<v1::StreamFramesResponse>> stream;
  };
  std::vector<std::unique_ptr<Reader>> readers_;
};

// The speed of one reader beside stalled readers, relative to alone. The stalled readers start and stop between the
// rounds, untimed.
void CompareBesideStalled(v1::FrameService::Stub& stub, int port, const std::string& name) {
  std::vector<double> beside, alone, ratios;
  for (int round = 0; round < bench::kRounds; ++round) {
    alone.push_back(bench::SecondsOf([&] { ReadAll(stub, name); }));
    const StalledReaders stalled(port, name);
    beside.push_back(bench::SecondsOf([&] { ReadAll(stub, name); }));
    ratios.push_back(alone.back() / beside.back());
  }
  std::printf("stream_beside_stalled: A %.6g s beside %d, B %.6g s alone (medians of %zu rounds)\n",
              bench::Median(beside), kStalled, bench::Median(alone), ratios.size());
  std::printf("ratio stream_beside_stalled %.3f\n", bench::Median(ratios));
}

v1::Job GetMany(v1::JobService::Stub& stub, const std::string& name, int calls) {
  v1::GetJobRequest request;
  request.set_name(name);
  v1::Job job;
  for (int i = 0; i < calls; ++i) {
    grpc::ClientContext context;
    if (!stub.GetJob(&context, request, &job).ok()) throw std::runtime_error("GetJob failed");
  }
  return job;
}

void Run() {
  const std::string frame = RandomBytes(static_cast<std::size_t>(kFrameSize));
  testing::TemporaryFolder folder;
  const auto store = OpenSqliteStore(folder.path());
  const std::string name = "jobs/" + PutJob(*store, frame);
  JobManager jobs(*store, MakeJobCodec(nullptr), {});
  const auto results = MakeMemoryResults(0);
  ResultCache cache(*results);
  RpcServer ours("127.0.0.1:0", *store, jobs, cache, std::make_shared<spdlog::logger>("bench"), {});
  const auto our_channel = ChannelTo(ours.port());
  const auto our_frames = v1::FrameService::NewStub(our_channel);
  const auto our_jobs = v1::JobService::NewStub(our_channel);

  RawFrames raw_frames(frame);
  RawJobs raw_jobs(GetMany(*our_jobs, name, 1));
  int port = 0;
  grpc::ServerBuilder builder;
  builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
  builder.RegisterService(&raw_frames);
  builder.RegisterService(&raw_jobs);
  const auto raw = builder.BuildAndStart();
  const auto raw_channel = ChannelTo(port);
  const auto raw_frames_stub = v1::FrameService::NewStub(raw_channel);
  const auto raw_jobs_stub = v1::JobService::NewStub(raw_channel);

  std::printf("%d frames of %.1f MiB a round\n", kFrames, static_cast<double>(kFrameSize) / (1 << 20));
  bench::MedianRatio(
      "stream_vs_grpc", 11, [&] { ReadAll(*our_frames, name); }, [&] { ReadAll(*raw_frames_stub, name); });
  std::printf("%d calls of GetJob a round\n", kCalls);
  bench::MedianRatio(
      "unary_vs_echo", 11, [&] { GetMany(*our_jobs, name, kCalls); }, [&] { GetMany(*raw_jobs_stub, name, kCalls); });
  raw->Shutdown();
  CompareBesideStalled(*our_frames, ours.port(), name);
}

}  // namespace
}  // namespace fascicle::server

int main() { fascicle::server::Run(); }
