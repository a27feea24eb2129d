#ifndef FASCICLE_SERVER_JOBS_RETENTION_H_
#define FASCICLE_SERVER_JOBS_RETENTION_H_

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "server/jobs/job_manager.h"
#include "server/store/store.h"

namespace fascicle::server {

// Removes what need not be kept any longer, from a thread of its own: finished jobs that are not pinned, after their
// ttl; frames of the finished jobs that ended first, while more than the disk budget is stored; assets that no job
// names. What can't be removed because the storage fails is tried again.
class Retention {
 public:
  // Both are called for a job that was final and not pinned a moment ago, and look at that again. `remove_frames`
  // returns false if it did nothing.
  struct Actions {
    std::function<void(const JobRecord&)> delete_job;
    std::function<bool(const JobRecord&)> remove_frames;
  };

  // All arguments must outlive this object.
  Retention(Store& store, const JobCodec& codec, const JobManagerOptions& options, Actions actions);
  ~Retention();

 private:
  void Work(const std::stop_token& stop);
  // A failure of the storage is told once, and is not the end.
  template <class Action>
  void Try(const Action& action);
  void DeleteExpired(const std::stop_token& stop);
  void KeepBudget(const std::stop_token& stop);
  void RemoveUnusedAssets(const std::stop_token& stop);
  // At most some hundred of the finished jobs that are not pinned and pass a condition, the one that ended first first.
  std::vector<JobRecord> Finished(const std::vector<JobCondition>& conditions);

  Store& store_;
  const JobCodec& codec_;
  const JobManagerOptions& options_;
  const Actions actions_;
  std::chrono::steady_clock::time_point next_assets_;  // used by the thread only
  std::string last_error_;                             // used by the thread only
  std::mutex mutex_;
  std::condition_variable_any stopped_;
  std::jthread thread_;
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_JOBS_RETENTION_H_
