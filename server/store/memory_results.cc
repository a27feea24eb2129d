#include <map>
#include <mutex>

#include "server/store/asset_directory.h"
#include "server/store/result_store.h"
#include "server/store/use_order.h"

namespace fascicle::server {
namespace {

class MemoryResults final : public ResultStore {
 public:
  explicit MemoryResults(std::int64_t most_bytes) : most_bytes_(most_bytes) {}

  std::optional<std::string> GetResult(std::string_view key) override {
    const std::lock_guard lock(mutex_);
    const auto found = results_.find(key);
    if (found == results_.end()) return std::nullopt;
    order_.Use(key);
    return found->second;
  }

  void PutResult(std::string_view key, std::string_view bytes) override {
    const auto size = static_cast<std::int64_t>(bytes.size());
    if (!IsSha256Hex(key) || size > most_bytes_) return;
    const std::lock_guard lock(mutex_);
    results_.insert_or_assign(std::string(key), std::string(bytes));
    order_.Add(key, size);
    for (const std::string& removed : order_.Shrink(most_bytes_)) results_.erase(removed);
  }

 private:
  const std::int64_t most_bytes_;
  std::mutex mutex_;
  std::map<std::string, std::string, std::less<>> results_;
  UseOrder order_;
};

}  // namespace

std::unique_ptr<ResultStore> MakeMemoryResults(std::int64_t most_bytes) {
  return std::make_unique<MemoryResults>(most_bytes);
}

}  // namespace fascicle::server
