#include "server/store/asset_directory.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <utility>

#include "core/base/digest.h"
#include "server/store/file_system.h"

namespace fascicle::server {
namespace {

namespace fs = std::filesystem;

// Creates a folder within an existing one, durably.
void CreateFolder(const std::string& path) {
  std::error_code error;
  if (fs::create_directory(path, error)) SyncParent(path);
  if (error) throw StoreError(path + ": " + error.message());
}

bool IsUnused(const fs::path& asset) {
  std::error_code error;
  const fs::file_time_type used = fs::last_write_time(asset, error);
  return !error && used < fs::file_time_type::clock::now() - std::chrono::hours(1);
}

void Rename(const std::string& from, const std::string& to) {
  std::error_code error;
  fs::rename(from, to, error);
  if (error) throw StoreError(to + ": " + error.message());
}

}  // namespace

bool IsSha256Hex(std::string_view text) {
  return text.size() == 64 &&
         std::all_of(text.begin(), text.end(), [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); });
}

class AssetDirectory::FileUpload final : public Upload {
 public:
  FileUpload(std::string written_path, std::string final_path, std::string_view sha256_hex, std::int64_t size)
      : written_path_(std::move(written_path)),
        final_path_(std::move(final_path)),
        announced_digest_(sha256_hex),
        announced_size_(size),
        file_(written_path_) {}

  ~FileUpload() override {
    std::error_code ignored;
    fs::remove(written_path_, ignored);
  }

  void Write(std::string_view bytes) override {
    size_ += static_cast<std::int64_t>(bytes.size());
    if (size_ > announced_size_) return;  // it will be refused; do not fill the disk with it
    sha256_.Update(bytes);
    file_.Write(bytes.data(), bytes.size());
  }

  bool Commit() override {
    if (size_ != announced_size_ || Hex(sha256_.Finish()) != announced_digest_) return false;
    file_.Finish();
    CreateFolder(fs::path(final_path_).parent_path().string());
    Rename(written_path_, final_path_);
    SyncParent(final_path_);
    return true;
  }

 private:
  const std::string written_path_;
  const std::string final_path_;
  const std::string announced_digest_;
  const std::int64_t announced_size_;
  FileWriter file_;
  Sha256 sha256_;
  std::int64_t size_ = 0;
};

AssetDirectory::AssetDirectory(const std::string& directory) : directory_(directory) {
  CreateFolder(directory_);
  std::error_code error;
  fs::remove_all(directory_ + "/uploads", error);
  if (error) throw StoreError(directory_ + "/uploads: " + error.message());
  CreateFolder(directory_ + "/uploads");
}

std::string AssetDirectory::PathOf(std::string_view sha256_hex) const {
  return directory_ + "/" + std::string(sha256_hex.substr(0, 2)) + "/" + std::string(sha256_hex);
}

bool AssetDirectory::HasAsset(std::string_view sha256_hex) {
  const std::lock_guard lock(use_mutex_);
  std::error_code error;
  if (!IsSha256Hex(sha256_hex) || !fs::is_regular_file(PathOf(sha256_hex), error)) return false;
  fs::last_write_time(PathOf(sha256_hex), fs::file_time_type::clock::now(), error);
  return true;
}

std::vector<AssetRecord> AssetDirectory::ListUnusedAssets() {
  std::vector<AssetRecord> unused;
  std::error_code error;
  for (auto entry = fs::recursive_directory_iterator(directory_, error); entry != fs::recursive_directory_iterator();
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (!IsSha256Hex(name) || !IsUnused(entry->path())) continue;
    unused.push_back({name, static_cast<std::int64_t>(entry->file_size(error))});
  }
  return unused;
}

bool AssetDirectory::RemoveUnusedAsset(std::string_view sha256_hex) {
  const std::lock_guard lock(use_mutex_);
  std::error_code ignored;
  return IsSha256Hex(sha256_hex) && IsUnused(PathOf(sha256_hex)) && fs::remove(PathOf(sha256_hex), ignored);
}

std::unique_ptr<AssetStore::Upload> AssetDirectory::BeginUpload(std::string_view sha256_hex, std::int64_t size) {
  // An invalid digest is handled like a wrong one: the upload proceeds and fails at its end.
  std::string written = directory_ + "/uploads/" + std::to_string(next_upload_++);
  return std::make_unique<FileUpload>(std::move(written), IsSha256Hex(sha256_hex) ? PathOf(sha256_hex) : std::string(),
                                      sha256_hex, size);
}

std::optional<std::string> AssetDirectory::ReadAsset(std::string_view sha256_hex) {
  if (!HasAsset(sha256_hex)) return std::nullopt;
  const std::string path = PathOf(sha256_hex);
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  std::string bytes(file ? static_cast<std::size_t>(file.tellg()) : 0, '\0');
  file.seekg(0);
  if (!file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()))) throw StoreError(path + ": cannot be read");
  if (Hex(Sha256Of(bytes)) == sha256_hex) return bytes;
  std::error_code ignored;
  fs::remove(path, ignored);  // so that the next client that needs it uploads it again
  throw DamageError(path + ": was damaged and has been removed; submit the scene again to upload it anew");
}

}  // namespace fascicle::server
