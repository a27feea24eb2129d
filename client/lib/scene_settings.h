#ifndef FASCICLE_CLIENT_LIB_SCENE_SETTINGS_H_
#define FASCICLE_CLIENT_LIB_SCENE_SETTINGS_H_

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/base/problems.h"

namespace fascicle::client {

// Modifies a scene before it is read. Each setting is PATH=VALUE with a field path as in problems, such as
// `bodies[0].activation.values[1]=0.5`, and a value in JSON (or plain text, for names). Missing fields are added; list
// entries must exist. Adds settings that cannot be applied to `problems`.
void ApplySettings(const std::vector<std::string>& settings, nlohmann::json& scene, Problems& problems);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_LIB_SCENE_SETTINGS_H_
