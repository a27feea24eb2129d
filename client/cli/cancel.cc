#include <memory>

#include <CLI/App.hpp>

#include "client/cli/command.h"
#include "client/cli/job_source.h"
#include "client/cli/summary.h"

namespace fascicle::client {
namespace {

constexpr const char* kCancelExamples =
    R"(  fascicle cancel jobs/3f2a           stops after the current step; frames until then are kept
)";

int Cancel(const std::string& name, const Context& context) {
  Client client = Connect(context);
  const v1::Job job = Take(client.CancelJob(FindJob(client, name)));
  PrintState(job, context.json);
  return kDone;
}

}  // namespace

void AddCancel(CLI::App& app, Context& context) {
  CLI::App* command = AddCommand(app, "cancel", "Ask a job to stop", kCancelExamples);
  const auto job = std::make_shared<std::string>();
  command->add_option("JOB", *job, "The job")->required();
  command->callback([job, &context] { context.action = [job, &context] { return Cancel(*job, context); }; });
}

}  // namespace fascicle::client
