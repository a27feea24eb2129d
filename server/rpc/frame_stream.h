#ifndef FASCICLE_SERVER_RPC_FRAME_STREAM_H_
#define FASCICLE_SERVER_RPC_FRAME_STREAM_H_

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "fascicle/v1/simulation_service.pb.h"
#include "proto/frames/derived_frame.h"
#include "server/rpc/chunk_message.h"
#include "server/rpc/frame_deriver.h"
#include "server/rpc/out_stream.h"

namespace fascicle::server {

// One call of StreamFrames. Everything is read from the store. The same code serves a live job, a late joiner, a
// reconnect and a finished job: it reads from the requested index on and then waits for more.
class FrameStream : public OutStream {
 public:
  FrameStream(RpcContext& context, FrameDeriver& deriver, v1::StreamFramesRequest request)
      : OutStream(context, "StreamFrames"),
        deriver_(deriver),
        request_(std::move(request)),
        derives_(AsksForDerived(request_)) {}

 protected:
  void Fill() override;
  Executor& executor() override { return derives_ ? deriver_.executor() : OutStream::executor(); }

 private:
  using Clock = std::chrono::steady_clock;

  // Checks the request and sends the header. False if the stream was completed with an error.
  bool Open();
  // Reads the current state of the job and its store. False if the stream was completed with an error.
  bool Refresh();
  // Chooses the next frame, if one is stored; otherwise ends, or waits for more.
  void Advance();
  // The next frame to send if `request_` asks for the newest only.
  std::int64_t NewestIndex() const;
  void BeginFrame(std::int64_t index);
  void PushChunk();
  // The chunk of the current frame that begins at `offset` [byte], as stored or derived.
  ChunkSource StoredChunk(std::int64_t offset);
  ChunkSource DerivedChunk(std::int64_t offset);
  // The derived form of the current frame.
  std::string Derive();
  // Whether the current frame is still the stored one.
  bool IsUnchanged();
  // Sends a heartbeat if the progress has changed, or if nothing was sent for long.
  void Beat();
  void PushEnd();

  FrameDeriver& deriver_;
  const v1::StreamFramesRequest request_;
  const bool derives_;
  bool open_ = false;
  std::string job_id_;
  std::shared_ptr<FrameStore> frames_;
  JobView view_;  // as of the last Refresh
  std::int64_t generation_ = 0;
  std::int64_t next_index_ = 0;  // index of the next frame to send
  std::int64_t stride_ = 1;
  std::int64_t known_count_ = 0;        // number of stored frames as of the last Refresh
  std::int64_t wanted_end_ = 0;         // end of the range to send
  std::vector<FrameRecord> listed_;     // records read in advance
  std::optional<FrameRecord> current_;  // the frame being sent
  std::int64_t offset_ = 0;             // of its next chunk [byte]

  Clock::time_point last_look_;  // time of the last Refresh
  Clock::time_point last_message_;
  Clock::time_point last_beat_;
  Clock::time_point last_frame_;  // when it was started
  std::string last_progress_;     // as in the last heartbeat
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_RPC_FRAME_STREAM_H_
