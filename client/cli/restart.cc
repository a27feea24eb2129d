#include <memory>
#include <string>

#include <CLI/App.hpp>

#include "client/cli/command.h"
#include "client/cli/job_source.h"
#include "client/cli/summary.h"

namespace fascicle::client {
namespace {

constexpr const char* kRestartExamples =
    R"(  fascicle restart jobs/3f2a          continues a job that failed or was cancelled, from its last checkpoint
  fascicle restart 3f2a --from-start  computes all frames again; those that were damaged are replaced
)";

struct RestartArguments {
  std::string job;
  bool from_start = false;
};

int Restart(const RestartArguments& arguments, const Context& context) {
  Client client = Connect(context);
  const v1::Job job = Take(client.RestartJob(FindJob(client, arguments.job), arguments.from_start));
  PrintState(job, context.json);
  return kDone;
}

}  // namespace

void AddRestart(CLI::App& app, Context& context) {
  CLI::App* command = AddCommand(app, "restart", "Run a finished job again", kRestartExamples);
  const auto arguments = std::make_shared<RestartArguments>();
  command->add_option("JOB", arguments->job, "The job")->required();
  command->add_flag("--from-start", arguments->from_start, "Start at time 0 instead of the last checkpoint");
  command->callback(
      [arguments, &context] { context.action = [arguments, &context] { return Restart(*arguments, context); }; });
}

}  // namespace fascicle::client
