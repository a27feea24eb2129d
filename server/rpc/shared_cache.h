#ifndef FASCICLE_SERVER_RPC_SHARED_CACHE_H_
#define FASCICLE_SERVER_RPC_SHARED_CACHE_H_

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <list>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <unordered_map>
#include <utility>

namespace fascicle::server {

// Values that cost time to make, made once for all who want the same. They are kept while there is room; what was used
// least recently is dropped first, and made again for whoever wants it later. `Value` has size() [byte]. Thread-safe.
template <class Value>
class SharedCache {
 public:
  // `most_kept`: size of all values kept [byte]; the last one is kept in any case.
  explicit SharedCache(std::size_t most_kept) : most_kept_(most_kept) {}

  // The value of `key`, which make() makes unless it is kept. Equal keys must have equal values. Waits if another
  // thread makes it. Rethrows what `make` throws.
  template <class Make>
  std::shared_ptr<const Value> Get(const std::string& key, const Make& make) {
    {
      std::unique_lock lock(mutex_);
      made_.wait(lock, [&] { return !making_.contains(key); });
      if (std::shared_ptr<const Value> value = Find(key)) return value;
      making_.insert(key);
    }
    std::shared_ptr<const Value> value;
    std::exception_ptr error;
    try {
      value = std::make_shared<const Value>(make());
    } catch (...) {
      error = std::current_exception();
    }
    {
      const std::lock_guard lock(mutex_);
      making_.erase(key);
      if (!error) Keep(key, value);
    }
    made_.notify_all();
    if (error) std::rethrow_exception(error);
    return value;
  }

  // Drops what was not used for so long.
  void DropUnused(std::chrono::seconds time) {
    const std::lock_guard lock(mutex_);
    const Clock::time_point latest = Clock::now() - time;
    while (!kept_.empty() && kept_.back().used < latest) DropLast();
  }

 private:
  using Clock = std::chrono::steady_clock;

  struct Entry {
    std::string key;
    std::shared_ptr<const Value> value;
    Clock::time_point used;
  };

  // The functions below need the lock.
  std::shared_ptr<const Value> Find(const std::string& key) {
    const auto found = places_.find(key);
    if (found == places_.end()) return nullptr;
    kept_.splice(kept_.begin(), kept_, found->second);
    found->second->used = Clock::now();
    return found->second->value;
  }
  void Keep(const std::string& key, std::shared_ptr<const Value> value) {
    constexpr std::size_t kMostEntries = 4096;
    size_ += value->size();
    kept_.push_front({key, std::move(value), Clock::now()});
    places_[key] = kept_.begin();
    while (kept_.size() > 1 && (size_ > most_kept_ || kept_.size() > kMostEntries)) DropLast();
  }
  void DropLast() {
    size_ -= kept_.back().value->size();
    places_.erase(kept_.back().key);
    kept_.pop_back();
  }

  const std::size_t most_kept_;
  std::mutex mutex_;
  std::condition_variable made_;
  std::set<std::string> making_;
  std::list<Entry> kept_;  // the most recently used one first
  std::unordered_map<std::string, typename std::list<Entry>::iterator> places_;
  std::size_t size_ = 0;  // of all kept [byte]
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_RPC_SHARED_CACHE_H_
