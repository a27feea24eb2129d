#ifndef FASCICLE_SERVER_RPC_FRAME_STREAM_H_
#define FASCICLE_SERVER_RPC_FRAME_STREAM_H_

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "fascicle/v1/simulation_service.pb.h"
#include "proto/frames/derived_frame.h"
#include "server/rpc/out_stream.h"
#include "server/rpc/shared_frames.h"

namespace fascicle::server {

// One call of StreamFrames. Everything is read from the store, once for all streams of the job. The same code serves a
// live job, a late joiner, a reconnect and a finished job: it reads from the requested index on and then waits for
// more.
class FrameStream : public OutStream {
 public:
  FrameStream(RpcContext& context, SharedFrames& shared, v1::StreamFramesRequest request)
      : OutStream(context, "StreamFrames"),
        shared_(shared),
        request_(std::move(request)),
        derives_(AsksForDerived(request_)) {}

 protected:
  void Fill() override;
  Executor& executor() override { return derives_ ? shared_.deriving : OutStream::executor(); }

 private:
  using Clock = std::chrono::steady_clock;

  // Checks the request and sends the header. False if the stream was completed with an error.
  bool Open();
  // Takes the state of the job. False if the stream was completed with an error.
  bool Take(std::shared_ptr<const JobFeed::State> state);
  // Chooses the next frame, if one is stored; otherwise ends, or waits for more.
  void Advance();
  // The next frame to send if `request_` asks for the newest only.
  std::int64_t NewestIndex() const;
  void BeginFrame(std::int64_t index);
  void PushChunk();
  // The chunk of the current frame that begins at `offset_`, as it is stored or derived. Throws FrameReplaced.
  FrameChunk MakeChunk();
  std::string StoredChunk(std::int64_t offset);
  // The derived form of the current frame.
  std::string Derive();
  // The form that the request asks for, the same for equal ones.
  std::string KeyOfFrame() const;
  // Sends a heartbeat if there is progress to tell, or if nothing was sent for long.
  void Beat();
  void PushEnd();

  SharedFrames& shared_;
  const v1::StreamFramesRequest request_;
  const bool derives_;
  bool open_ = false;
  std::shared_ptr<JobFeed> feed_;
  std::shared_ptr<const JobFeed::State> state_;  // as of the last look
  std::int64_t generation_ = 0;
  std::int64_t next_index_ = 0;  // index of the next frame to send
  std::int64_t stride_ = 1;
  std::int64_t wanted_end_ = 0;         // end of the range to send
  std::optional<FrameRecord> current_;  // the frame being sent
  std::int64_t offset_ = 0;             // of its next chunk [byte]
  std::int64_t told_beat_ = 0;          // the last one that was sent

  Clock::time_point last_message_;
  Clock::time_point last_frame_;  // when it was started
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_RPC_FRAME_STREAM_H_
