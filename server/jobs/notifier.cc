#include "server/jobs/notifier.h"

#include <utility>

namespace fascicle::server {

struct Notifier::Listener {
  std::recursive_mutex mutex;  // held during a call; recursive, because the call may destroy its own handle
  bool is_active = true;
  std::function<void()> call;
};

struct Notifier::Registry {
  std::mutex mutex;
  std::multimap<std::string, std::shared_ptr<Listener>, std::less<>> listeners;

  std::vector<std::shared_ptr<Listener>> Of(std::string_view id) {
    const std::lock_guard lock(mutex);
    std::vector<std::shared_ptr<Listener>> found;
    const auto [begin, end] = listeners.equal_range(id);
    for (auto entry = begin; entry != end; ++entry) found.push_back(entry->second);
    return found;
  }

  void Remove(std::string_view id, const std::shared_ptr<Listener>& listener) {
    const std::lock_guard lock(mutex);
    const auto [begin, end] = listeners.equal_range(id);
    for (auto entry = begin; entry != end; ++entry) {
      if (entry->second != listener) continue;
      listeners.erase(entry);
      return;
    }
  }
};

Notifier::Notifier()
    : registry_(std::make_shared<Registry>()), thread_([this](const std::stop_token& stop) { Loop(stop); }) {}

Notifier::~Notifier() {
  thread_.request_stop();
  thread_.join();
}

Notifier::Handle Notifier::Subscribe(std::string_view id, std::function<void()> listener) {
  auto entry = std::make_shared<Listener>();
  entry->call = std::move(listener);
  {
    const std::lock_guard lock(registry_->mutex);
    registry_->listeners.emplace(id, entry);
  }
  return Handle(nullptr, [registry = registry_, id = std::string(id), entry](void*) {
    registry->Remove(id, entry);
    const std::lock_guard lock(entry->mutex);
    entry->is_active = false;
  });
}

void Notifier::Notify(std::string_view id) {
  {
    const std::lock_guard lock(mutex_);
    if (!pending_.contains(id)) pending_.emplace(id);
  }
  changed_.notify_one();
}

void Notifier::Loop(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (changed_.wait(lock, stop, [this] { return !pending_.empty(); })) {
    const std::set<std::string, std::less<>> ids = std::exchange(pending_, {});
    lock.unlock();
    for (const std::string& id : ids) {
      for (const std::shared_ptr<Listener>& listener : registry_->Of(id)) {
        const std::lock_guard call_lock(listener->mutex);
        if (listener->is_active) listener->call();
      }
    }
    lock.lock();
  }
}

}  // namespace fascicle::server
