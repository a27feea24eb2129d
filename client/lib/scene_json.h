#ifndef FASCICLE_CLIENT_LIB_SCENE_JSON_H_
#define FASCICLE_CLIENT_LIB_SCENE_JSON_H_

#include <cstddef>
#include <string>
#include <string_view>

#include <google/protobuf/message.h>
#include <nlohmann/json.hpp>

#include "core/base/problems.h"

namespace fascicle::client {

// Largest scene file [byte].
inline constexpr std::size_t kMaxSceneBytes = std::size_t{16} << 20;

// Parses JSON with comments. Adds a syntax error (with line and column), every duplicate key and nesting deeper than 64
// levels to `problems`. The value is `discarded` after a syntax error.
nlohmann::json ParseJson(std::string_view text, Problems& problems);

// Sets the fields of `message` from a JSON object and continues after problems: unknown fields (with the nearest known
// name), wrong types, integers out of range, unknown enum values, two members of a oneof. Problems have the field's
// path below `path`.
void ReadMessage(const nlohmann::json& value, google::protobuf::Message& message, const std::string& path,
                 Problems& problems);

// The scene file of a message: every field that is set, in the order of the proto, enum values by their short names,
// lists of numbers on one line. Reading it gives the same message.
std::string JsonText(const google::protobuf::Message& message);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_LIB_SCENE_JSON_H_
