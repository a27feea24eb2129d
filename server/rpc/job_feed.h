#ifndef FASCICLE_SERVER_RPC_JOB_FEED_H_
#define FASCICLE_SERVER_RPC_JOB_FEED_H_

#include <atomic>
#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "fascicle/v1/simulation_service.pb.h"
#include "server/jobs/job_manager.h"
#include "server/rpc/rpc_context.h"

namespace fascicle::server {

class OutStream;

// What the streams of one job share: its state, read once for every change and not once by each stream, the records of
// its frames, and one task that fills all of them after a change, and about every second. So that many streams do not
// take the machine, changes wait for half a millisecond for each stream, at most a quarter of a second, and what has
// come meanwhile is sent together. Thread-safe.
class JobFeed : public std::enable_shared_from_this<JobFeed> {
 public:
  struct State {
    JobView view;
    v1::Progress progress;
    std::int64_t frame_count = 0;  // stored ones, or those of a job whose frames were removed
    std::int64_t beat = 0;         // 1 more whenever there is progress to tell: not much more often than every second
  };

  JobFeed(RpcContext& context, std::string job_id, std::shared_ptr<FrameStore> frames)
      : context_(context), job_id_(std::move(job_id)), frames_(std::move(frames)) {}

  // From now on `stream` is filled after each change of the job, until as many streams have left.
  void Join(std::weak_ptr<OutStream> stream);
  void Leave();

  FrameStore& frames() { return *frames_; }
  const std::shared_ptr<FrameStore>& shared_frames() const { return frames_; }
  // The state with all changes of which streams have been told; null if the job was deleted. Throws DamageError.
  std::shared_ptr<const State> Look();
  // The state at present.
  std::shared_ptr<const State> LookAgain();
  // The record of a stored frame. Reads up to `ahead` ones at once.
  FrameRecord Record(std::int64_t index, int ahead);

  // Fills all streams after `delay`, or earlier.
  void FillAfter(std::chrono::milliseconds delay);
  // The longest time between two fillings.
  std::chrono::milliseconds Interval() const;

 private:
  using Clock = std::chrono::steady_clock;

  void FillAll();
  void FillLater();
  std::shared_ptr<const State> Read();  // needs state_mutex_

  RpcContext& context_;
  const std::string job_id_;
  const std::shared_ptr<FrameStore> frames_;
  std::atomic<bool> is_stale_ = true;      // the state has changed since it was read
  std::atomic<bool> is_fill_due_ = false;  // a task that fills is on its way, here and below
  std::atomic<bool> is_timer_set_ = false;
  std::atomic<Clock::time_point> next_fill_ = Clock::time_point();  // the earliest time

  std::mutex state_mutex_;  // guards the members below; held while they are read from the store
  std::shared_ptr<const State> state_;
  std::string told_;  // what the last beat told
  Clock::time_point last_beat_;
  std::map<std::int64_t, FrameRecord> records_;
  std::int64_t replacements_ = 0;  // of frames, when records_ were read

  std::mutex streams_mutex_;  // guards the members below
  int joined_ = 0;
  std::vector<std::weak_ptr<OutStream>> streams_;
  JobManager::Subscription subscription_;  // while there are streams
};

// The feeds that are in use. Thread-safe.
class JobFeeds {
 public:
  explicit JobFeeds(RpcContext& context) : context_(context) {}

  // Null if there is no such job.
  std::shared_ptr<JobFeed> Of(const std::string& job_id);

 private:
  RpcContext& context_;
  std::mutex mutex_;
  std::map<std::string, std::weak_ptr<JobFeed>> feeds_;
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_RPC_JOB_FEED_H_
