#ifndef FASCICLE_SERVER_CONFIG_H_
#define FASCICLE_SERVER_CONFIG_H_

#include <iosfwd>
#include <variant>

#include <spdlog/common.h>

#include "server/embedded_server.h"

namespace fascicle::server {

// What the command line of `fascicled` says.
struct Config {
  ServerOptions server;
  spdlog::level::level_enum log_level = spdlog::level::info;
};

// The configuration, or the exit code with which to end at once: 0 after --help and --version, 2 for bad options.
// Writes what the user asked for to `out` and what is wrong to `err`.
std::variant<Config, int> ParseArguments(int argc, const char* const* argv, std::ostream& out, std::ostream& err);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_CONFIG_H_
