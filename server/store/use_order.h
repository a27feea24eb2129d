#ifndef FASCICLE_SERVER_STORE_USE_ORDER_H_
#define FASCICLE_SERVER_STORE_USE_ORDER_H_

#include <cstdint>
#include <list>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace fascicle::server {

// Which entries of a cache there are, how large each is, and in which order they were used. Not thread-safe.
class UseOrder {
 public:
  // Makes an entry the one used last. Without effect when there is none.
  void Use(std::string_view key);
  // Adds or replaces an entry, which is then the one used last.
  void Add(std::string_view key, std::int64_t bytes);
  void Remove(std::string_view key);
  // Removes the entries used longest ago until the rest has at most so many bytes, and returns their keys.
  std::vector<std::string> Shrink(std::int64_t most_bytes);

 private:
  struct Entry {
    std::int64_t bytes;
    std::list<std::string>::iterator place;
  };

  std::list<std::string> keys_;  // from the one used longest ago
  std::map<std::string, Entry, std::less<>> entries_;
  std::int64_t bytes_ = 0;  // of all entries
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_STORE_USE_ORDER_H_
