#include "client/cli/job_source.h"

#include <stdexcept>
#include <utility>
#include <vector>

namespace fascicle::client {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kIdLength = 26;
constexpr const char* kJobs = "jobs/";
constexpr int kMostListed = 1'000'000;

bool IsDataFolder(const fs::path& folder) { return fs::is_regular_file(folder / "control.db"); }

// The data folder that a folder is or has; empty if neither.
fs::path DataFolderOf(const fs::path& folder) {
  if (IsDataFolder(folder)) return folder;
  if (IsDataFolder(DataFolderIn(folder))) return DataFolderIn(folder);
  return {};
}

// A folder, and what follows `jobs/` in FOLDER/jobs/ID.
struct FolderAndId {
  fs::path data;
  std::string id;  // empty: the newest job
};

FolderAndId Split(const std::string& given) {
  if (const fs::path data = DataFolderOf(given); !data.empty()) return {data, {}};
  const fs::path path = given;
  if (path.parent_path().filename() != "jobs") return {};
  return {DataFolderOf(path.parent_path().parent_path()), path.filename().string()};
}

JobSource OpenFolder(const FolderAndId& place) {
  server::ServerOptions options;
  options.data_directory = place.data.string();
  options.workers = 0;  // reads only; interrupted jobs stay as they are
  std::unique_ptr<server::EmbeddedServer> server;
  try {
    server = server::EmbeddedServer::Start(options);
  } catch (const std::runtime_error& error) {
    throw CommandError::Invalid(std::string(error.what()) + "; if a server uses it, ask that server: --server");
  }
  Client client(server->address());
  std::string job;
  if (place.id.empty()) {
    const std::vector<v1::Job> newest = Take(client.ListJobs(1, {}));
    if (newest.empty()) throw CommandError::Invalid(place.data.string() + " has no jobs");
    job = newest[0].name();
  } else {
    job = FindJob(client, place.id);
  }
  return {std::move(server), std::move(client), std::move(job)};
}

}  // namespace

fs::path DataFolderIn(const fs::path& results) { return results / "data"; }

bool IsJobFolder(const std::string& given) { return !Split(given).data.empty(); }

JobSource OpenJob(const Context& context, const std::string& given) {
  if (const FolderAndId place = Split(given); !place.data.empty()) return OpenFolder(place);
  if (fs::is_directory(given)) {
    throw CommandError::Invalid(
        given + " keeps no job: give a folder that `fascicle run --out` wrote, or a server's data folder");
  }
  Client client = Connect(context);
  std::string job = FindJob(client, given);
  return {nullptr, std::move(client), std::move(job)};
}

std::string FindJob(Client& client, const std::string& given) {
  const std::string wanted = given.starts_with(kJobs) ? given : kJobs + given;
  if (wanted.size() >= kIdLength + std::string_view(kJobs).size()) return wanted;
  std::vector<std::string> found;
  for (const v1::Job& job : Take(client.ListJobs(kMostListed, {}))) {
    if (job.name().starts_with(wanted) || job.name().ends_with(given)) found.push_back(job.name());
  }
  if (found.size() == 1) return found[0];
  if (found.empty())
    throw CommandError::Invalid("no job's name begins or ends with " + given + "; see `fascicle list`");
  std::string names;
  for (std::size_t k = 0; k < found.size() && k < 5; ++k) names += "\n  " + found[k];
  if (found.size() > 5) names += "\n  ...";
  throw CommandError::Invalid(std::to_string(found.size()) + " jobs' names begin or end with " + given + ":" + names);
}

}  // namespace fascicle::client
