#ifndef FASCICLE_CLIENT_CLI_START_FRAME_H_
#define FASCICLE_CLIENT_CLI_START_FRAME_H_

#include <string>

#include "client/cli/command.h"

namespace fascicle::client {

// Adds --start to a sub-command that takes a scene. `scene` must outlive parsing.
void AddStartOption(CLI::App& command, SceneArgument& scene);

// Fetches the frame in which a scene begins, from the job that --start (JOB[:FRAME]) or the scene names, and adds it to
// the package's files. Does nothing for other scenes, and for those that have the state already. CommandError if there
// is no such job or frame.
void PackStart(const Context& context, const std::string& start, ScenePackage& package);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_CLI_START_FRAME_H_
