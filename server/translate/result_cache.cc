#include "server/translate/result_cache.h"

#include "core/base/digest.h"
#include "core/base/stop.h"

namespace fascicle::server {

std::string ResultCache::KeyOf(ArchiveWriter inputs) {
  inputs.PutString("program version", FASCICLE_VERSION);
  return Hex(Sha256Of(inputs.Finish()));
}

std::shared_ptr<void> ResultCache::Claim(const std::string& key, const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  if (!released_.wait(lock, stop, [&] { return !claimed_.contains(key); })) throw Stopped();
  claimed_.insert(key);
  return {nullptr, [this, key](void*) {
            {
              const std::lock_guard release(mutex_);
              claimed_.erase(key);
            }
            released_.notify_all();
          }};
}

}  // namespace fascicle::server
