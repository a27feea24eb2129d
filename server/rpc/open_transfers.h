#ifndef FASCICLE_SERVER_RPC_OPEN_TRANSFERS_H_
#define FASCICLE_SERVER_RPC_OPEN_TRANSFERS_H_

#include <atomic>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>

#include <spdlog/logger.h>

#include "server/rpc/executor.h"

namespace fascicle::server {

// The exports and imports of a server: their threads and their number. Thread-safe.
class OpenTransfers {
 public:
  static constexpr int kMost = 8;
  static constexpr int kThreads = 2;

  explicit OpenTransfers(spdlog::logger& log)
      : executor_(kThreads, [&log](const std::string& what) { log.error("transfers: {}", what); }) {}

  Executor& executor() { return executor_; }

  // A place, given back with the last reference; null if there is none. This object must outlive it.
  std::shared_ptr<void> Enter() {
    if (++open_ > kMost) {
      --open_;
      return nullptr;
    }
    return {this, [this](void*) { --open_; }};
  }

 private:
  std::atomic<int> open_ = 0;
  Executor executor_;  // destroyed first
};

// Removes a file when it is no longer needed.
class TransferFile {
 public:
  explicit TransferFile(std::string path) : path_(std::move(path)) {}
  ~TransferFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  TransferFile(const TransferFile&) = delete;
  TransferFile& operator=(const TransferFile&) = delete;
  const std::string& path() const { return path_; }

 private:
  const std::string path_;
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_RPC_OPEN_TRANSFERS_H_
