#include "server/rpc/frame_deriver.h"

#include <algorithm>
#include <utility>

namespace fascicle::server {
namespace {

constexpr int kThreads = 2;

}  // namespace

FrameDeriver::FrameDeriver(spdlog::logger& log, std::size_t most_kept)
    : most_kept_(most_kept),
      executor_(kThreads, [&log](const std::string& what) { log.error("derived frames: {}", what); }) {}

FrameDeriver::Bytes FrameDeriver::Get(const std::string& key, const std::function<std::string()>& make) {
  {
    std::unique_lock lock(mutex_);
    made_.wait(lock, [&] { return !making_.contains(key); });
    if (Bytes bytes = Find(key)) return bytes;
    making_.insert(key);
  }
  Bytes bytes;
  std::exception_ptr error;
  try {
    bytes = std::make_shared<const std::string>(make());
  } catch (...) {
    error = std::current_exception();
  }
  {
    const std::lock_guard lock(mutex_);
    making_.erase(key);
    if (!error) Keep(key, bytes);
  }
  made_.notify_all();
  if (error) std::rethrow_exception(error);
  return bytes;
}

FrameDeriver::Bytes FrameDeriver::Find(const std::string& key) {
  const auto found = std::find_if(kept_.begin(), kept_.end(), [&](const Entry& entry) { return entry.key == key; });
  if (found == kept_.end()) return nullptr;
  kept_.splice(kept_.begin(), kept_, found);
  return found->bytes;
}

void FrameDeriver::Keep(const std::string& key, Bytes bytes) {
  constexpr std::size_t kMostEntries = 256;  // Find looks at all of them
  size_ += bytes->size();
  kept_.push_front({key, std::move(bytes)});
  while (kept_.size() > 1 && (size_ > most_kept_ || kept_.size() > kMostEntries)) {
    size_ -= kept_.back().bytes->size();
    kept_.pop_back();
  }
}

}  // namespace fascicle::server
