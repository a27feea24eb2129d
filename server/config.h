#ifndef FASCICLE_SERVER_CONFIG_H_
#define FASCICLE_SERVER_CONFIG_H_

#include <iosfwd>
#include <variant>

#include <spdlog/common.h>

#include "server/embedded_server.h"

namespace fascicle::server {

// The options of `fascicled`'s command line.
struct Config {
  ServerOptions server;
  spdlog::level::level_enum log_level = spdlog::level::info;
};

// Returns the configuration, or the exit code with which to end at once: 0 after --help and --version, 2 for bad
// options. Writes the requested text to `out` and errors to `err`.
std::variant<Config, int> ParseArguments(int argc, const char* const* argv, std::ostream& out, std::ostream& err);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_CONFIG_H_
