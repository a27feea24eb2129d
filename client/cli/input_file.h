#ifndef FASCICLE_CLIENT_CLI_INPUT_FILE_H_
#define FASCICLE_CLIENT_CLI_INPUT_FILE_H_

#include <optional>
#include <string>

#include "core/base/problems.h"

namespace fascicle::client {

// The bytes of a file. If it can't be read, adds a problem with an empty path and returns nothing.
std::optional<std::string> ReadInputFile(const std::string& path, Problems& problems);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_CLI_INPUT_FILE_H_
