#ifndef FASCICLE_SERVER_STORE_USE_ORDER_H_
#define FASCICLE_SERVER_STORE_USE_ORDER_H_

#include <cstdint>
#include <list>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace fascicle::server {

// The entries of a cache, their sizes, and the order in which they were used. Not thread-safe.
class UseOrder {
 public:
  // Marks an entry as used last. No effect if it does not exist.
  void Use(std::string_view key);
  // Adds or replaces an entry, which counts as ResultStore::kLeastSize at least, and marks it as used last.
  void Add(std::string_view key, std::int64_t bytes);
  void Remove(std::string_view key);
  // Removes the least recently used entries until the rest has at most that many bytes; returns their keys.
  std::vector<std::string> Shrink(std::int64_t most_bytes);

 private:
  struct Entry {
    std::int64_t bytes;
    std::list<std::string>::iterator place;
  };

  std::list<std::string> keys_;  // least recently used first
  std::map<std::string, Entry, std::less<>> entries_;
  std::int64_t bytes_ = 0;  // of all entries
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_STORE_USE_ORDER_H_
