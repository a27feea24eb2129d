#ifndef FASCICLE_SERVER_STORE_READER_POOL_H_
#define FASCICLE_SERVER_STORE_READER_POOL_H_

#include <cstddef>
#include <functional>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace fascicle::server {

// Read connections, each used by one thread at a time and then reused. Thread-safe.
template <class Reader>
class ReaderPool {
 public:
  explicit ReaderPool(std::function<std::unique_ptr<Reader>()> open) : open_(std::move(open)) {}

  // Calls use(reader) and returns its result. The reader is closed if `use` throws.
  template <class Use>
  auto With(const Use& use) {
    std::unique_ptr<Reader> reader = Take();
    auto result = use(*reader);
    const std::lock_guard lock(mutex_);
    if (idle_.size() < kMaxIdle) idle_.push_back(std::move(reader));
    return result;
  }

 private:
  static constexpr std::size_t kMaxIdle = 4;

  std::unique_ptr<Reader> Take() {
    {
      const std::lock_guard lock(mutex_);
      if (!idle_.empty()) {
        std::unique_ptr<Reader> reader = std::move(idle_.back());
        idle_.pop_back();
        return reader;
      }
    }
    return open_();
  }

  std::function<std::unique_ptr<Reader>()> open_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<Reader>> idle_;
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_STORE_READER_POOL_H_
