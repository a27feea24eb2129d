#include <algorithm>
#include <string>

#include "server/translate/files.h"

namespace fascicle::server {
namespace {

constexpr std::string_view kPrefix = "assets/";

bool IsLowerHex(char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); }

}  // namespace

std::string DigestOfAsset(const std::string& asset) {
  if (asset.size() != kPrefix.size() + 64 || !asset.starts_with(kPrefix)) return {};
  if (!std::all_of(asset.begin() + static_cast<std::ptrdiff_t>(kPrefix.size()), asset.end(), IsLowerHex)) return {};
  return asset.substr(kPrefix.size());
}

std::optional<std::string> ReadFile(const v1::FileRef& file, const std::string& path, const AssetReader& assets,
                                    Problems& problems) {
  if (file.path().empty()) {
    problems.Add(JoinPath(path, "path"), "is missing", "the file's extension gives its format");
  }
  if (file.asset().empty()) {
    problems.Add(JoinPath(path, "asset"), "is missing: the file was not read or uploaded",
                 "the client sets it when it submits a scene file");
    return std::nullopt;
  }
  const std::string digest = DigestOfAsset(file.asset());
  if (digest.empty()) {
    problems.Add(JoinPath(path, "asset"), "is not the name of an asset",
                 "`assets/` and 64 lower-case hexadecimal digits");
    return std::nullopt;
  }
  auto bytes = assets(digest);
  if (!bytes) problems.Add(path, "its bytes are not on the server", "upload " + file.asset() + " first");
  return bytes;
}

}  // namespace fascicle::server
