#ifndef FASCICLE_CLIENT_CLI_FRAME_OPTIONS_H_
#define FASCICLE_CLIENT_CLI_FRAME_OPTIONS_H_

#include <string>
#include <vector>

#include "client/lib/client.h"

namespace CLI {  // NOLINT(readability-identifier-naming): of CLI11
class App;
}

namespace fascicle::client {

// What to receive of each frame, as given on the command line.
struct FrameOptions {
  std::vector<std::string> fields;
  std::string encoding = "stored";
  bool compress = false;
};

// Adds --fields, --encoding and --compress. `options` must outlive parsing.
void AddFrameOptions(CLI::App& command, FrameOptions& options);

// Sets what to receive. If fields are selected, `needed` are received, too.
void SetFrameOptions(const FrameOptions& options, const std::vector<std::string>& needed, WatchOptions& watch);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_CLI_FRAME_OPTIONS_H_
