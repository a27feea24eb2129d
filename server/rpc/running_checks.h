#ifndef FASCICLE_SERVER_RPC_RUNNING_CHECKS_H_
#define FASCICLE_SERVER_RPC_RUNNING_CHECKS_H_

#include <atomic>
#include <chrono>
#include <mutex>
#include <set>
#include <stop_token>

#include <grpcpp/support/status.h>

namespace fascicle::server {

// Long calls in progress, each with the time by which it must end. Thread-safe.
class RunningChecks {
 public:
  // One call, from its start to its end.
  class Watch {
   public:
    Watch(RunningChecks& checks, const std::stop_source& stop, std::chrono::milliseconds longest);
    ~Watch();
    Watch(const Watch&) = delete;
    Watch& operator=(const Watch&) = delete;

    // Whether it was stopped because of its time.
    bool expired() const { return expired_; }

   private:
    friend RunningChecks;

    RunningChecks& checks_;
    std::stop_source stop_;
    const std::chrono::steady_clock::time_point end_;
    std::atomic<bool> expired_ = false;
  };

  // Stops those whose time is over. Call every second.
  void StopExpired();

 private:
  std::mutex mutex_;
  std::set<Watch*> running_;
};

// DEADLINE_EXCEEDED for a call that was stopped.
grpc::Status TookTooLong(std::chrono::milliseconds longest);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_RPC_RUNNING_CHECKS_H_
