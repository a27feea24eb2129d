#include "server/rpc/turnstile.h"

#include <utility>

namespace fascicle::server {
namespace {

// A write of 1 MiB takes about a millisecond if its reader reads.
constexpr std::chrono::milliseconds kPatience(10);

}  // namespace

void Turnstile::Enter(const void* who, std::function<void()> go) {
  {
    const std::lock_guard lock(mutex_);
    DropSlow();
    if (inside_.size() >= places_ || !waiting_.empty()) {
      waiting_.push_back({who, std::move(go)});
      Admit();
      WatchSlow();
      return;
    }
    inside_[who] = Clock::now();
  }
  go();
}

void Turnstile::Leave(const void* who) {
  const std::lock_guard lock(mutex_);
  inside_.erase(who);
  Admit();
}

void Turnstile::DropSlow() {
  const Clock::time_point latest = Clock::now() - kPatience;
  std::erase_if(inside_, [latest](const auto& entry) { return entry.second < latest; });
}

void Turnstile::Admit() {
  for (; !waiting_.empty() && inside_.size() < places_; waiting_.pop_front()) {
    inside_[waiting_.front().who] = Clock::now();
    executor_.Post(std::move(waiting_.front().go));
  }
}

void Turnstile::WatchSlow() {
  if (watching_ || waiting_.empty()) return;
  watching_ = true;
  executor_.PostAfter(kPatience, [this] {
    const std::lock_guard lock(mutex_);
    watching_ = false;
    DropSlow();
    Admit();
    WatchSlow();
  });
}

}  // namespace fascicle::server
