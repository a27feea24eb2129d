#ifndef FASCICLE_SERVER_STORE_ASSET_DIRECTORY_H_
#define FASCICLE_SERVER_STORE_ASSET_DIRECTORY_H_

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/store/store.h"

namespace fascicle::server {

// Whether the text is 64 digits 0-9a-f; nothing else may become part of a path.
bool IsSha256Hex(std::string_view text);

// Assets as files: assets/ab/{sha256}, first written as assets/uploads/{number}. The time of a file's modification is
// that of its last use. Thread-safe; an upload belongs to one thread.
class AssetDirectory final : public AssetStore {
 public:
  // Creates the directory and removes the files of interrupted uploads.
  explicit AssetDirectory(const std::string& directory);

  bool HasAsset(std::string_view sha256_hex) override;
  std::unique_ptr<Upload> BeginUpload(std::string_view sha256_hex, std::int64_t size) override;
  std::optional<std::string> ReadAsset(std::string_view sha256_hex) override;
  std::vector<AssetRecord> ListUnusedAssets() override;
  bool RemoveUnusedAsset(std::string_view sha256_hex) override;

 private:
  class FileUpload;

  std::string PathOf(std::string_view sha256_hex) const;

  const std::string directory_;
  std::atomic<std::int64_t> next_upload_ = 0;
  std::mutex use_mutex_;  // no asset is removed while its use is noted
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_STORE_ASSET_DIRECTORY_H_
