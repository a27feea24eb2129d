#ifndef FASCICLE_SERVER_RPC_JOB_WATCH_STREAM_H_
#define FASCICLE_SERVER_RPC_JOB_WATCH_STREAM_H_

#include <chrono>
#include <cstdint>
#include <memory>
#include <utility>

#include "fascicle/v1/simulation_service.pb.h"
#include "server/rpc/out_stream.h"
#include "server/store/job_query.h"

namespace fascicle::server {

// One call of WatchJobs: reads what has changed from the store since the last revision sent, then waits for the next
// change. A job that changes faster than the reader reads is sent as it is when the reader is ready.
class JobWatchStream : public OutStream {
 public:
  JobWatchStream(RpcContext& context, v1::WatchJobsRequest request)
      : OutStream(context, "WatchJobs"), request_(std::move(request)) {}

 protected:
  void Fill() override;

 private:
  using Clock = std::chrono::steady_clock;

  // False if the stream was completed with an error.
  bool Open();
  // Sends the next changes. False if there is nothing to do until the next wake.
  bool PushChanges();
  v1::WatchJobsResponse ResponseOf(const JobChangeViews& changes) const;
  void PushResponse(const v1::WatchJobsResponse& response);

  const v1::WatchJobsRequest request_;
  JobFilter filter_;
  bool is_open_ = false;
  std::int64_t revision_ = 0;        // of the last change sent
  std::int64_t first_complete_ = 0;  // until then the reader learns which jobs there are
  Clock::time_point last_look_;
  Clock::time_point last_message_;
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_RPC_JOB_WATCH_STREAM_H_
