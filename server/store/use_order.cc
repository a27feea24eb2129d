#include "server/store/use_order.h"

#include <algorithm>

#include "server/store/result_store.h"

namespace fascicle::server {

void UseOrder::Use(std::string_view key) {
  const auto found = entries_.find(key);
  if (found != entries_.end()) keys_.splice(keys_.end(), keys_, found->second.place);
}

void UseOrder::Add(std::string_view key, std::int64_t bytes) {
  Remove(key);
  bytes = std::max(bytes, ResultStore::kLeastSize);
  keys_.emplace_back(key);
  entries_.emplace(key, Entry{bytes, std::prev(keys_.end())});
  bytes_ += bytes;
}

void UseOrder::Remove(std::string_view key) {
  const auto found = entries_.find(key);
  if (found == entries_.end()) return;
  bytes_ -= found->second.bytes;
  keys_.erase(found->second.place);
  entries_.erase(found);
}

std::vector<std::string> UseOrder::Shrink(std::int64_t most_bytes) {
  std::vector<std::string> removed;
  while (bytes_ > most_bytes && !keys_.empty()) {
    removed.push_back(keys_.front());
    Remove(removed.back());
  }
  return removed;
}

}  // namespace fascicle::server
