#include <memory>
#include <string>

#include <CLI/App.hpp>

#include "client/cli/command.h"
#include "client/cli/job_source.h"
#include "client/cli/summary.h"

namespace fascicle::client {
namespace {

constexpr const char* kPauseExamples =
    R"(  fascicle pause jobs/3f2a            stops after the current step and leaves its worker to other jobs
  fascicle resume 3f2a                goes on from the last checkpoint, to the same frames
)";

constexpr const char* kResumeExamples =
    R"(  fascicle resume jobs/3f2a           queues a paused job again; it goes on from its last checkpoint
)";

// Adds `pause` or `resume`: a call of one job.
using Call = Result<v1::Job> (Client::*)(const std::string&);

void AddCall(CLI::App* command, Call call, Context& context) {
  const auto job = std::make_shared<std::string>();
  command->add_option("JOB", *job, "The job")->required();
  command->callback([job, call, &context] {
    context.action = [job, call, &context] {
      Client client = Connect(context);
      PrintState(Take((client.*call)(FindJob(client, *job))), context.json);
      return static_cast<int>(kDone);
    };
  });
}

}  // namespace

void AddPause(CLI::App& app, Context& context) {
  AddCall(AddCommand(app, "pause", "Stop a job until it is resumed", kPauseExamples), &Client::PauseJob, context);
}

void AddResume(CLI::App& app, Context& context) {
  AddCall(AddCommand(app, "resume", "Let a paused job go on", kResumeExamples), &Client::ResumeJob, context);
}

}  // namespace fascicle::client
