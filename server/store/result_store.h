#ifndef FASCICLE_SERVER_STORE_RESULT_STORE_H_
#define FASCICLE_SERVER_STORE_RESULT_STORE_H_

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace fascicle::server {

// A cache of results that took long to compute, as bytes, each under the SHA-256 digest of all that it depends on. An
// entry may be gone at any time, so storage that fails is not an error: there is one entry less. Thread-safe.
class ResultStore {
 public:
  virtual ~ResultStore() = default;
  // The bytes that were put under `key` (64 digits 0-9a-f), to the last bit; nothing when they are not there or were
  // damaged.
  virtual std::optional<std::string> GetResult(std::string_view key) = 0;
  // Keeps the bytes, and removes the entries that have not been put or got for the longest time until all together have
  // no more bytes than the store may. More bytes than that are not kept.
  virtual void PutResult(std::string_view key, std::string_view bytes) = 0;
};

// As files in a folder, which is created: they are there again when it is opened the next time. To be used by one
// process at a time. Throws StoreError when the folder can't be made or read.
std::unique_ptr<ResultStore> OpenResultDirectory(const std::string& directory, std::int64_t most_bytes);
std::unique_ptr<ResultStore> MakeMemoryResults(std::int64_t most_bytes);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_STORE_RESULT_STORE_H_
