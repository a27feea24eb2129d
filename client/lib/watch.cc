#include "client/lib/watch.h"

#include <chrono>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <utility>

#include "client/lib/message_assembler.h"
#include "client/lib/message_stream.h"
#include "client/lib/patience.h"
#include "client/lib/status_error.h"
#include "proto/frames/derived_frame.h"

namespace fascicle::client {
namespace {

using Steady = std::chrono::steady_clock;
using Response = v1::StreamFramesResponse;
using Outcome = MessageStream<Response>::Outcome;

const Error kStoppedError = {.kind = Error::Kind::kStopped, .message = "stopped", .reason = "", .problems = {}};

grpc::Status Damaged(const std::string& what) { return grpc::Status(grpc::StatusCode::UNAVAILABLE, what); }

// One watch: a sequence of streams, each of which continues where the previous one broke.
class Watcher {
 public:
  Watcher(Connection& connection, const std::string& name, const WatchOptions& options, const WatchEvents& events,
          const std::stop_token& stop)
      : connection_(connection), options_(options), events_(events), stop_(stop), patience_(options.patience) {
    request_.set_name(name);
    request_.set_start_index(options.start_index);
    request_.set_mode(options.mode);
    request_.set_follow(options.follow);
    request_.set_end_index(options.end_index);
    request_.set_stride(options.stride);
    for (const std::string& field : options.fields) request_.add_fields(field);
    request_.set_encoding(options.encoding);
    if (options.compress) request_.set_compression(v1::DerivedFrame::COMPRESSION_ZSTD);
  }

  Result<v1::Job> Run() {
    if (grpc::Status status = connection_.Connect(); !status.ok()) return ErrorOf(status, connection_.address());
    while (true) {
      const Steady::time_point begin = Steady::now();
      const grpc::Status status = ReadStream();
      if (job_) return std::move(*job_);
      if (stop_.stop_requested()) return kStoppedError;
      if (!IsLostStream(status)) return ErrorOf(status, connection_.address());
      if (Steady::now() - begin > kHealthy) patience_.Succeeded();  // it was healthy for a while: this is a new loss
      if (patience_.Lost() && events_.reconnecting) {
        events_.reconnecting(status.error_message().empty() ? "the stream was interrupted" : status.error_message());
      }
      if (patience_.exhausted()) return GivenUp(status);
      patience_.Wait(status, stop_);
    }
  }

 private:
  static constexpr std::chrono::seconds kHealthy{5};

  Error GivenUp(const grpc::Status& status) const {
    Error error = ErrorOf(status, connection_.address());
    error.kind = Error::Kind::kNoServer;
    return error;
  }

  // Reads one stream to its end. Sets `job_` if it was complete.
  grpc::Status ReadStream() {
    assembler_ = {};
    MessageStream<Response> stream([this](grpc::ClientContext* call, grpc::ClientReadReactor<Response>* reactor) {
      PrepareCall(*call);
      connection_.frames().async()->StreamFrames(call, &request_, reactor);
    });
    Response message;
    while (!job_) {
      switch (stream.Next(message, kLongestSilence, stop_)) {
        case Outcome::kMessage:
          if (grpc::Status status = Take(message); !status.ok()) return status;
          break;
        case Outcome::kEnd:
          return stream.status();
        case Outcome::kSilence:
          return Damaged("the server does not respond");
        case Outcome::kStopped:
          return grpc::Status::CANCELLED;
      }
    }
    return grpc::Status::OK;
  }

  grpc::Status Take(Response& message) {
    switch (message.part_case()) {
      case Response::kHeader:
        request_.set_generation(message.header().generation());
        derived_ = message.header().derived();
        return grpc::Status::OK;
      case Response::kChunk:
        return TakeChunk(*message.mutable_chunk());
      case Response::kHeartbeat:
        if (events_.progress) events_.progress(message.heartbeat().state(), message.heartbeat().progress());
        return grpc::Status::OK;
      case Response::kEnd:
        if (message.end().next_index() > request_.start_index()) return Damaged("frames are missing from the stream");
        job_ = std::move(*message.mutable_end()->mutable_job());
        return grpc::Status::OK;
      case Response::PART_NOT_SET:
        break;  // from a newer server
    }
    return grpc::Status::OK;
  }

  grpc::Status TakeChunk(v1::Chunk& chunk) {
    const bool all = options_.mode != v1::StreamFramesRequest::MODE_LATEST;
    const std::int64_t wanted = request_.start_index();
    const std::int64_t index = chunk.frame_index();
    if (all ? index != wanted : index < wanted) return Damaged("a frame is out of order");
    switch (assembler_.Add(chunk)) {
      case MessageAssembler::State::kMore:
        return grpc::Status::OK;
      case MessageAssembler::State::kBroken:
        return Damaged("frame " + std::to_string(index) + " was damaged in transit");
      case MessageAssembler::State::kComplete:
        break;
    }
    if (!ReadFrame(assembler_.Take()) || frame_.index() != index) {
      return Damaged("frame " + std::to_string(index) + " cannot be read");
    }
    if (events_.frame) events_.frame(frame_);
    request_.set_start_index(index + options_.stride);
    patience_.Succeeded();
    return grpc::Status::OK;
  }

  bool ReadFrame(const std::string& bytes) {
    if (!derived_) return frame_.ParseFromString(bytes) && frame_.digest().size() == 32;
    v1::DerivedFrame derived;
    if (!derived.ParseFromString(bytes)) return false;
    try {
      frame_ = ReadDerivedFrame(derived);
    } catch (const std::runtime_error&) {
      return false;
    }
    const std::string& digest = frame_.has_derivation() ? frame_.derivation().stored_digest() : frame_.digest();
    return digest.size() == 32;
  }

  Connection& connection_;
  const WatchOptions& options_;
  const WatchEvents& events_;
  const std::stop_token stop_;
  Patience patience_;
  v1::StreamFramesRequest request_;  // start_index is the next frame to read
  bool derived_ = false;             // whether chunks are those of a v1::DerivedFrame
  MessageAssembler assembler_;
  v1::Frame frame_;
  std::optional<v1::Job> job_;
};

}  // namespace

Result<v1::Job> WatchJob(Connection& connection, const std::string& name, const WatchOptions& options,
                         const WatchEvents& events, const std::stop_token& stop) {
  return Watcher(connection, name, options, events, stop).Run();
}

Result<v1::Geometry> FetchGeometry(Connection& connection, const std::string& name, const std::stop_token& stop) {
  using Stream = MessageStream<v1::GetGeometryResponse>;
  if (grpc::Status status = connection.Connect(); !status.ok()) return ErrorOf(status, connection.address());
  v1::GetGeometryRequest request;
  request.set_name(name);
  Patience patience(WatchOptions().patience);
  while (true) {
    const Steady::time_point begin = Steady::now();
    Stream stream([&](grpc::ClientContext* call, grpc::ClientReadReactor<v1::GetGeometryResponse>* reactor) {
      PrepareCall(*call);
      connection.frames().async()->GetGeometry(call, &request, reactor);
    });
    MessageAssembler assembler;
    v1::GetGeometryResponse message;
    auto state = MessageAssembler::State::kMore;
    Stream::Outcome outcome = Stream::Outcome::kMessage;
    while (state == MessageAssembler::State::kMore && outcome == Stream::Outcome::kMessage) {
      do {  // a job may wait in the queue for long; the channel's keepalive detects a dead server
        outcome = stream.Next(message, kLongestSilence, stop);
      } while (outcome == Stream::Outcome::kSilence);
      if (outcome == Stream::Outcome::kMessage) state = assembler.Add(*message.mutable_chunk());
    }
    if (outcome == Stream::Outcome::kStopped) return kStoppedError;
    v1::Geometry geometry;
    if (state == MessageAssembler::State::kComplete && geometry.ParseFromString(assembler.Take())) return geometry;
    const grpc::Status status =
        outcome == Stream::Outcome::kEnd ? stream.status() : Damaged("the geometry was damaged in transit");
    if (!IsLostStream(status)) return ErrorOf(status, connection.address());
    if (Steady::now() - begin > kLongestSilence) patience.Succeeded();
    patience.Lost();
    if (patience.exhausted()) return ErrorOf(status, connection.address());
    patience.Wait(status, stop);
  }
}

}  // namespace fascicle::client
