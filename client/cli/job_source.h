#ifndef FASCICLE_CLIENT_CLI_JOB_SOURCE_H_
#define FASCICLE_CLIENT_CLI_JOB_SOURCE_H_

#include <filesystem>
#include <memory>
#include <string>

#include "client/cli/command.h"
#include "server/embedded_server.h"

namespace fascicle::client {

// A job where it is kept: on a server, or in a folder, which a server in this process then reads.
struct JobSource {
  std::unique_ptr<server::EmbeddedServer> server;  // of a folder; else null
  Client client;
  std::string job;  // jobs/ID
};

// The folder of `fascicle run --out DIR` in which it keeps its job.
std::filesystem::path DataFolderIn(const std::filesystem::path& results);

// Whether a job on the command line is a folder: one that `run --out` wrote, or the data folder of a server.
bool IsJobFolder(const std::string& given);

// Finds the job that a user means: jobs/ID, ID, the first or last letters of an ID, a folder (its newest job), or
// FOLDER/jobs/ID.
// CommandError if there is none, or several.
JobSource OpenJob(const Context& context, const std::string& given);

// The same for a server to which there is a connection: "jobs/ID" for jobs/ID, ID, or its first or last letters.
std::string FindJob(Client& client, const std::string& given);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_CLI_JOB_SOURCE_H_
