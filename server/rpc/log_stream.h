#ifndef FASCICLE_SERVER_RPC_LOG_STREAM_H_
#define FASCICLE_SERVER_RPC_LOG_STREAM_H_

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include "fascicle/v1/log_service.pb.h"
#include "server/rpc/out_stream.h"

namespace fascicle::server {

// One call of StreamLog. Lines are read from the store, whether the job runs or has ended.
class LogStream : public OutStream {
 public:
  LogStream(RpcContext& context, v1::StreamLogRequest request)
      : OutStream(context, "StreamLog"), request_(std::move(request)) {}

 protected:
  void Fill() override;

 private:
  using Clock = std::chrono::steady_clock;

  // Checks the request. False if the stream was completed with an error.
  bool Open();
  // Sends the next lines; false if none are stored at present.
  bool PushLines();
  void PushEnd(const JobView& view);

  const v1::StreamLogRequest request_;
  std::string job_id_;  // empty until the stream is open
  std::shared_ptr<FrameStore> frames_;
  std::int64_t next_number_ = 0;
  Clock::time_point last_message_ = Clock::now();
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_RPC_LOG_STREAM_H_
