#include <cstdio>
#include <memory>
#include <string>

#include <CLI/App.hpp>
#include <nlohmann/json.hpp>

#include "client/cli/command.h"
#include "client/cli/job_table.h"

namespace fascicle::client {
namespace {

constexpr const char* kInfoExamples = R"(  fascicle info                       version, load and limits of the server
  fascicle info --json
)";

std::string LimitText(std::int64_t limit) { return limit == 0 ? "no limit" : std::to_string(limit); }
std::string SizeLimitText(std::int64_t bytes) { return bytes == 0 ? "no limit" : SizeText(bytes); }

int Info(const Context& context) {
  Client client = Connect(context);
  const v1::ServerInfo info = Take(client.GetServerInfo());
  if (context.json) {
    PrintJson({{"version", info.version()},
               {"uptime_seconds", info.uptime().seconds()},
               {"cores", info.cores()},
               {"workers", info.workers()},
               {"default_threads", info.default_threads()},
               {"oversubscribe", info.oversubscribe()},
               {"running_jobs", info.running_jobs()},
               {"threads_in_use", info.threads_in_use()},
               {"queued_jobs", info.queued_jobs()},
               {"max_queued_jobs_per_owner", info.max_queued_jobs_per_owner()},
               {"max_running_jobs_per_owner", info.max_running_jobs_per_owner()},
               {"max_stored_bytes_per_owner", info.max_stored_bytes_per_owner()},
               {"default_ttl_seconds", info.default_ttl().seconds()},
               {"disk_budget", info.disk_budget()},
               {"max_asset_size", info.max_asset_size()}});
    return kDone;
  }
  std::printf("version             %s\n", info.version().c_str());
  std::printf("workers             %d on %d cores, %d threads for a job that does not ask for a number\n",
              info.workers(), info.cores(), info.default_threads());
  std::printf("running             %d jobs with %d threads%s\n", info.running_jobs(), info.threads_in_use(),
              info.oversubscribe() ? "; jobs get all threads that they ask for"
                                   : "; all together get no more threads than cores, but one for each worker");
  std::printf("queued              %d jobs\n", info.queued_jobs());
  std::printf("of each owner       queued: %s, running: %s, stored: %s\n",
              LimitText(info.max_queued_jobs_per_owner()).c_str(), LimitText(info.max_running_jobs_per_owner()).c_str(),
              SizeLimitText(info.max_stored_bytes_per_owner()).c_str());
  const std::int64_t ttl = info.default_ttl().seconds();
  std::printf("kept after the end  %s\n", ttl == 0 ? "until deleted" : (std::to_string(ttl) + " s").c_str());
  std::printf("disk for frames     %s\n", SizeLimitText(info.disk_budget()).c_str());
  return kDone;
}

}  // namespace

void AddInfo(CLI::App& app, Context& context) {
  CLI::App* command = AddCommand(app, "info", "Show version, load and limits of a server", kInfoExamples);
  command->callback([&context] { context.action = [&context] { return Info(context); }; });
}

}  // namespace fascicle::client
