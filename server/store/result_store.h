#ifndef FASCICLE_SERVER_STORE_RESULT_STORE_H_
#define FASCICLE_SERVER_STORE_RESULT_STORE_H_

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace fascicle::server {

// A cache of the bytes of results that took long to compute. The key of a result is the SHA-256 digest of everything
// that it depends on. Entries may vanish at any time, so a storage failure is not an error; the entry is lost.
// Thread-safe.
class ResultStore {
 public:
  // What an entry counts at least [byte], so that there are not too many.
  static constexpr std::int64_t kLeastSize = 16 << 10;

  virtual ~ResultStore() = default;
  // The bytes stored under `key` (64 digits 0-9a-f), unchanged; nothing if they do not exist or are damaged.
  virtual std::optional<std::string> GetResult(std::string_view key) = 0;
  // Stores the bytes, then removes the least recently used entries until the total does not exceed the store's limit.
  // Bytes that exceed it alone are not stored.
  virtual void PutResult(std::string_view key, std::string_view bytes) = 0;
};

// As files in a folder, which is created. Entries persist when it is closed. For one process at a time. Throws
// StoreError if the folder cannot be created or read.
std::unique_ptr<ResultStore> OpenResultDirectory(const std::string& directory, std::int64_t most_bytes);
std::unique_ptr<ResultStore> MakeMemoryResults(std::int64_t most_bytes);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_STORE_RESULT_STORE_H_
