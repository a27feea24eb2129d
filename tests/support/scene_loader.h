#ifndef FASCICLE_TESTS_SUPPORT_SCENE_LOADER_H_
#define FASCICLE_TESTS_SUPPORT_SCENE_LOADER_H_

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "client/lib/scene_file.h"
#include "server/translate/translate.h"

namespace fascicle::testing {

// Reads a scene file and its files with the client, and translates them with the server; nullptr and `problems` if that
// fails.
inline std::shared_ptr<const Scene> ReadScene(const std::filesystem::path& path, Problems& problems) {
  const auto package = client::LoadScene(path.string(), problems);
  if (!package) return nullptr;
  const auto asset = [&](const std::string& digest) -> std::optional<std::string> {
    for (const client::AssetFile& file : package->assets) {
      if (file.sha256_hex == digest) return file.bytes;
    }
    return std::nullopt;
  };
  return server::TranslateScene(package->scene, asset, problems);
}

}  // namespace fascicle::testing

#endif  // FASCICLE_TESTS_SUPPORT_SCENE_LOADER_H_
