#ifndef FASCICLE_CLIENT_LIB_PATIENCE_H_
#define FASCICLE_CLIENT_LIB_PATIENCE_H_

#include <chrono>
#include <optional>
#include <stop_token>

#include <grpcpp/support/status.h>

#include "client/lib/backoff.h"
#include "client/lib/status_error.h"

namespace fascicle::client {

// When to give up after a lost connection: `patience` after the first loss since the last success. Not thread-safe.
class Patience {
 public:
  explicit Patience(std::chrono::seconds patience) : patience_(patience) {}

  void Succeeded() {
    lost_since_.reset();
    backoff_.Reset();
  }

  // Returns true for the first loss since the last success.
  bool Lost() {
    if (lost_since_) return false;
    lost_since_ = Clock::now();
    return true;
  }

  bool exhausted() const { return lost_since_ && Clock::now() - *lost_since_ >= patience_; }

  void Wait(const grpc::Status& status, const std::stop_token& stop) { backoff_.Wait(RetryDelayOf(status), stop); }

 private:
  using Clock = std::chrono::steady_clock;

  const std::chrono::seconds patience_;
  std::optional<Clock::time_point> lost_since_;
  Backoff backoff_;
};

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_LIB_PATIENCE_H_
