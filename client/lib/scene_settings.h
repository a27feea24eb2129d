#ifndef FASCICLE_CLIENT_LIB_SCENE_SETTINGS_H_
#define FASCICLE_CLIENT_LIB_SCENE_SETTINGS_H_

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/base/problems.h"

namespace fascicle::client {

// Changes a scene before it is read: each setting is PATH=VALUE with a field path as problems have it, such as
// `bodies[0].activation.values[1]=0.5`, and a value in JSON (or plain text, for names). Fields that are not there are
// added, list entries must be there. Adds what can't be set to `problems`.
void ApplySettings(const std::vector<std::string>& settings, nlohmann::json& scene, Problems& problems);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_LIB_SCENE_SETTINGS_H_
