#include <algorithm>
#include <atomic>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <system_error>
#include <tuple>
#include <utility>
#include <vector>

#include "core/base/digest.h"
#include "server/store/asset_directory.h"
#include "server/store/file_system.h"
#include "server/store/result_store.h"
#include "server/store/store.h"
#include "server/store/use_order.h"

namespace fascicle::server {
namespace {

namespace fs = std::filesystem;

// A file starts with the CRC-32C of its remaining bytes.
constexpr std::size_t kHead = sizeof(std::uint32_t);

std::optional<std::string> ReadChecked(const std::string& path) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file || file.tellg() < static_cast<std::streamoff>(kHead)) return std::nullopt;
  std::string bytes(static_cast<std::size_t>(file.tellg()) - kHead, '\0');
  std::uint32_t crc = 0;
  file.seekg(0);
  file.read(reinterpret_cast<char*>(&crc), kHead);
  if (!file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()))) return std::nullopt;
  if (Crc32c(bytes) != crc) return std::nullopt;
  return bytes;
}

// An entry left by the previous process.
struct Found {
  fs::file_time_type used;
  std::string key;
  std::int64_t bytes;
};

class ResultDirectory final : public ResultStore {
 public:
  ResultDirectory(std::string directory, std::int64_t most_bytes)
      : directory_(std::move(directory)), most_bytes_(most_bytes) {
    std::error_code error;
    fs::create_directories(directory_, error);
    if (error) throw StoreError(directory_ + ": " + error.message());
    for (const Found& entry : Entries()) order_.Add(entry.key, entry.bytes);
    Shrink();
  }

  std::optional<std::string> GetResult(std::string_view key) override {
    if (!IsSha256Hex(key)) return std::nullopt;
    std::optional<std::string> bytes = ReadChecked(PathOf(key));
    const std::lock_guard lock(mutex_);
    if (bytes) {
      order_.Use(key);
      Touch(key);
    } else {
      order_.Remove(key);
      std::error_code ignored;
      fs::remove(PathOf(key), ignored);
    }
    return bytes;
  }

  void PutResult(std::string_view key, std::string_view bytes) override {
    const auto size = static_cast<std::int64_t>(bytes.size() + kHead);
    if (!IsSha256Hex(key) || size > most_bytes_) return;
    const std::string written = directory_ + "/new-" + std::to_string(next_file_++);
    std::error_code error;
    if (Write(written, bytes)) {
      const std::lock_guard lock(mutex_);
      fs::rename(written, PathOf(key), error);
      if (!error) {
        order_.Add(key, size);
        Touch(key);
        Shrink();
        return;
      }
    }
    fs::remove(written, error);
  }

 private:
  std::string PathOf(std::string_view key) const { return directory_ + "/" + std::string(key); }

  // Reads the existing entries, least recently used first; removes incomplete files.
  std::vector<Found> Entries() const {
    std::vector<Found> entries;
    std::error_code error;
    for (const fs::directory_entry& entry : fs::directory_iterator(directory_, error)) {
      const std::string name = entry.path().filename().string();
      std::error_code ignored;
      if (IsSha256Hex(name)) {
        entries.push_back({entry.last_write_time(ignored), name, static_cast<std::int64_t>(entry.file_size(ignored))});
      } else if (name.starts_with("new-")) {
        fs::remove(entry.path(), ignored);
      }
    }
    if (error) throw StoreError(directory_ + ": " + error.message());
    std::sort(entries.begin(), entries.end(),
              [](const Found& a, const Found& b) { return std::tie(a.used, a.key) < std::tie(b.used, b.key); });
    return entries;
  }

  // Does not wait for the disk: the checksum detects files damaged by a power cut.
  static bool Write(const std::string& path, std::string_view bytes) {
    try {
      FileWriter file(path);
      const std::uint32_t crc = Crc32c(bytes);
      file.Write(reinterpret_cast<const char*>(&crc), kHead);
      file.Write(bytes.data(), bytes.size());
      return true;
    } catch (const StoreError&) {
      return false;
    }
  }

  // File times preserve the order of use for the next process.
  void Touch(std::string_view key) const {
    std::error_code ignored;
    fs::last_write_time(PathOf(key), fs::file_time_type::clock::now(), ignored);
  }

  // Call with mutex_ locked.
  void Shrink() {
    std::error_code ignored;
    for (const std::string& key : order_.Shrink(most_bytes_)) fs::remove(PathOf(key), ignored);
  }

  const std::string directory_;
  const std::int64_t most_bytes_;
  std::atomic<std::int64_t> next_file_ = 0;
  std::mutex mutex_;  // guards order_ and the creation and removal of files
  UseOrder order_;
};

}  // namespace

std::unique_ptr<ResultStore> OpenResultDirectory(const std::string& directory, std::int64_t most_bytes) {
  return std::make_unique<ResultDirectory>(directory, most_bytes);
}

}  // namespace fascicle::server
