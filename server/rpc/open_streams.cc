#include "server/rpc/open_streams.h"

#include <utility>
#include <vector>

#include "server/rpc/errors.h"

namespace fascicle::server {

bool OpenStreams::Add(const void* stream, std::function<void(const grpc::Status&)> abort) {
  std::lock_guard lock(mutex_);
  if (draining_) return false;
  streams_.emplace(stream, std::move(abort));
  return true;
}

void OpenStreams::Remove(const void* stream) {
  std::lock_guard lock(mutex_);
  streams_.erase(stream);
  if (streams_.empty()) empty_.notify_all();
}

void OpenStreams::Drain() {
  std::vector<std::function<void(const grpc::Status&)>> aborts;
  {
    std::lock_guard lock(mutex_);
    draining_ = true;
    for (const auto& [stream, abort] : streams_) aborts.push_back(abort);
  }
  for (const auto& abort : aborts) abort(ShuttingDown());
}

bool OpenStreams::draining() const {
  std::lock_guard lock(mutex_);
  return draining_;
}

bool OpenStreams::WaitUntilEmpty(std::chrono::milliseconds timeout) {
  std::unique_lock lock(mutex_);
  return empty_.wait_for(lock, timeout, [this] { return streams_.empty(); });
}

}  // namespace fascicle::server
