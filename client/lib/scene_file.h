#ifndef FASCICLE_CLIENT_LIB_SCENE_FILE_H_
#define FASCICLE_CLIENT_LIB_SCENE_FILE_H_

#include <optional>
#include <string>
#include <vector>

#include "client/lib/client.h"
#include "core/base/problems.h"

namespace fascicle::client {

// Reads a scene file: JSON with // and /* */ comments, fields named as in scene.proto, enum values short and lower-case
// ("mm", "mixed", "cauchy_stress") or in full, `repeated double` as [x, y, z]. Adds every problem with its field path:
// syntax (with line and column), unknown fields (with the nearest known name), wrong types, duplicate keys, two members
// of a oneof.
std::optional<v1::Scene> ParseScene(const std::string& json, Problems& problems);

// Reads the scene file, modified by `settings` (see ApplySettings), and the files that it refers to (paths relative to
// its folder and inside of it, links followed), and sets their digests. Finds the .ele beside a .node. Limits: scene 16
// MiB, each file 4 GiB.
std::optional<ScenePackage> LoadScene(const std::string& path, Problems& problems,
                                      const std::vector<std::string>& settings = {});

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_LIB_SCENE_FILE_H_
