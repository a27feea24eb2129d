#include "client/lib/scene_file.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <string_view>
#include <system_error>
#include <vector>

#include "client/lib/scene_json.h"
#include "client/lib/scene_settings.h"
#include "core/base/digest.h"
#include "core/base/letters.h"
#include "proto/rules/field_rules.h"
#include "proto/rules/find_messages.h"

namespace fascicle::client {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMaxAssetBytes = std::uintmax_t{4} << 30;

bool IsInside(const fs::path& folder, const fs::path& path) {
  const auto [end, ignored] = std::mismatch(folder.begin(), folder.end(), path.begin(), path.end());
  return end == folder.end();
}

// The file that a name in the scene refers to; nothing, with a problem, if it is not a file in the scene's folder.
std::optional<fs::path> Resolve(const fs::path& folder, const std::string& name, const std::string& field,
                                Problems& problems) {
  const auto refuse = [&](const std::string& message, const std::string& hint) {
    problems.Add(field, message, hint);
    return std::nullopt;
  };
  const fs::path relative(name);
  if (name.empty()) return refuse("names no file", "give a path relative to the scene's folder");
  if (name.find('\0') != std::string::npos || name.size() > 4096) return refuse("is not a usable path", "");
  const bool climbs = std::find(relative.begin(), relative.end(), fs::path("..")) != relative.end();
  if (relative.is_absolute() || climbs) {
    return refuse("\"" + name + "\" leads out of the scene's folder",
                  "put the file beside the scene or in a folder below it");
  }
  std::error_code error;
  const fs::path resolved = fs::weakly_canonical(folder / relative, error);
  if (error) return refuse("\"" + name + "\" can't be resolved: " + error.message(), "");
  if (!IsInside(folder, resolved)) {
    return refuse("\"" + name + "\" is a link that leads out of the scene's folder",
                  "copy the file to the scene's folder");
  }
  const fs::file_status status = fs::status(resolved, error);
  if (!fs::exists(status)) {
    return refuse("there is no file \"" + name + "\"", "paths are relative to the scene's folder " + folder.string());
  }
  if (!fs::is_regular_file(status)) return refuse("\"" + name + "\" is not a regular file", "");
  if (fs::file_size(resolved, error) > kMaxAssetBytes || error) {
    return refuse("\"" + name + "\" is larger than 4 GiB", "use a coarser mesh");
  }
  return resolved;
}

std::optional<std::string> ReadFile(const fs::path& path) {
  std::ifstream in(path, std::ios::binary | std::ios::ate);
  if (!in) return std::nullopt;
  const std::streamoff size = in.tellg();
  if (size < 0) return std::nullopt;
  std::string bytes(static_cast<std::size_t>(size), '\0');
  in.seekg(0);
  in.read(bytes.data(), size);
  if (in.gcount() != size) return std::nullopt;
  return bytes;
}

// A TetGen mesh has two files; the second is found beside the first.
void NameElementFiles(v1::Scene& scene) {
  for (v1::Body& body : *scene.mutable_bodies()) {
    if (!body.has_mesh() || !body.mesh().has_file() || body.mesh().has_elements()) continue;
    const std::string& path = body.mesh().file().path();
    if (LowerExtension(path) != ".node") continue;
    const bool upper_case = fs::path(path).extension() == ".NODE";
    body.mutable_mesh()->mutable_elements()->set_path(
        fs::path(path).replace_extension(upper_case ? ".ELE" : ".ele").string());
  }
}

// Reads each file once, however often it is used.
class AssetReader {
 public:
  AssetReader(fs::path folder, ScenePackage& package, Problems& problems)
      : folder_(std::move(folder)), package_(package), problems_(problems) {}

  // Packs the file that `ref`, at `ref_path` in the scene, names, and sets the asset there.
  void Read(v1::FileRef& ref, const std::string& ref_path) {
    // A reference by digest only refers to an asset that the server already has.
    if (ref.path().empty() && !ref.asset().empty()) return;
    const std::string field = JoinPath(ref_path, "path");
    const std::optional<fs::path> path = Resolve(folder_, ref.path(), field, problems_);
    if (!path) return;
    std::string& digest = digests_[*path];
    if (digest.empty()) {
      std::optional<std::string> bytes = ReadFile(*path);
      if (!bytes) {
        problems_.Add(field, "\"" + ref.path() + "\" can't be read", "check its permissions");
        return;
      }
      digest = Hex(Sha256Of(*bytes));
      if (packed_.insert(digest).second) package_.assets.push_back({digest, path->string(), std::move(*bytes)});
    }
    ref.set_asset("assets/" + digest);
  }

 private:
  fs::path folder_;
  ScenePackage& package_;
  Problems& problems_;
  std::map<fs::path, std::string> digests_;
  std::set<std::string> packed_;
};

// The scene as far as it could be read; nothing after a syntax error.
std::optional<v1::Scene> ReadScene(const std::string& text, const std::vector<std::string>& settings,
                                   Problems& problems) {
  nlohmann::json value = ParseJson(text, problems);
  if (value.is_discarded()) return std::nullopt;
  ApplySettings(settings, value, problems);
  v1::Scene scene;
  ReadMessage(value, scene, "", problems);
  return scene;
}

// A scene that can't be read completely never reaches the server, which checks everything. Reports what can be checked
// of the rest without the server, so that a user sees all mistakes together.
void CheckRest(const v1::Scene& scene, Problems& problems) {
  Problems rest;
  CheckRules(scene, rest);
  std::set<std::string> known;
  for (const Problem& problem : problems.kept()) known.insert(problem.path);
  for (const Problem& problem : rest.kept()) {
    if (known.count(problem.path) == 0) problems.Add(problem.path, problem.message, problem.hint);
  }
}

}  // namespace

std::optional<v1::Scene> ParseScene(const std::string& json, Problems& problems) {
  Problems own;
  std::optional<v1::Scene> scene = ReadScene(json, {}, own);
  problems.Append("", own);
  return own.empty() ? scene : std::nullopt;
}

std::optional<ScenePackage> LoadScene(const std::string& path, Problems& problems,
                                      const std::vector<std::string>& settings) {
  std::error_code error;
  const fs::path file = fs::canonical(path, error);
  if (error) {
    problems.Add("", "the scene file can't be opened: " + error.message());
    return std::nullopt;
  }
  if (!fs::is_regular_file(file, error)) {
    problems.Add("", "the scene is not a file");
    return std::nullopt;
  }
  if (fs::file_size(file, error) > kMaxSceneBytes || error) {
    problems.Add("", "the scene is larger than 16 MiB", "put meshes and fibres into files of their own");
    return std::nullopt;
  }
  const std::optional<std::string> text = ReadFile(file);
  if (!text) {
    problems.Add("", "the scene file can't be read", "check its permissions");
    return std::nullopt;
  }
  // Problems of the scene and of its files are reported together.
  Problems own;
  ScenePackage package;
  if (std::optional<v1::Scene> scene = ReadScene(*text, settings, own)) {
    package.scene = std::move(*scene);
    NameElementFiles(package.scene);
    AssetReader reader(file.parent_path(), package, own);
    ForEachMessage<v1::FileRef>(package.scene, "",
                                [&](v1::FileRef& ref, const std::string& at) { reader.Read(ref, at); });
    if (!own.empty()) CheckRest(package.scene, own);
  }
  problems.Append("", own);
  if (!own.empty()) return std::nullopt;
  return package;
}

}  // namespace fascicle::client
