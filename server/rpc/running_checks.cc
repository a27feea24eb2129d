#include "server/rpc/running_checks.h"

#include <string>

#include "server/rpc/errors.h"

namespace fascicle::server {

RunningChecks::Watch::Watch(RunningChecks& checks, const std::stop_source& stop, std::chrono::milliseconds longest)
    : checks_(checks), stop_(stop), end_(std::chrono::steady_clock::now() + longest) {
  const std::lock_guard lock(checks_.mutex_);
  checks_.running_.insert(this);
}

RunningChecks::Watch::~Watch() {
  const std::lock_guard lock(checks_.mutex_);
  checks_.running_.erase(this);
}

void RunningChecks::StopExpired() {
  const std::lock_guard lock(mutex_);
  const auto now = std::chrono::steady_clock::now();
  for (Watch* watch : running_) {
    if (now < watch->end_) continue;
    watch->expired_ = true;
    watch->stop_.request_stop();
  }
}

grpc::Status TookTooLong(std::chrono::milliseconds longest) {
  return DeadlineExceeded("TOOK_TOO_LONG", "the check took longer than " + std::to_string(longest.count() / 1000) +
                                               " s: lower the size of the scene");
}

}  // namespace fascicle::server
