#include <iostream>
#include <memory>
#include <string>

#include <CLI/App.hpp>
#include <nlohmann/json.hpp>

#include "client/cli/command.h"
#include "client/cli/interrupts.h"
#include "client/cli/progress_bar.h"
#include "client/cli/summary.h"

namespace fascicle::client {
namespace {

constexpr const char* kImportJobExamples =
    R"(  fascicle export 3f2a --database muscle.fascicle  on another server: the whole job as one file
  fascicle import-job muscle.fascicle              as a job of this server
  fascicle import-job muscle.fascicle --new-name   as a second job, beside the one of that name

It is pinned: the server keeps it until somebody deletes it, or `fascicle update` unpins it.
)";

struct ImportJobOptions {
  std::string file;
  bool new_name = false;
};

int ImportJob(const ImportJobOptions& options, const Context& context) {
  const StopOnInterrupt interrupts;
  Client client = Connect(context);
  const v1::Job job = Take(client.ImportJob(options.file, options.new_name, interrupts.token()));
  if (context.json) {
    PrintJson(JobJson(job));
    return kDone;
  }
  std::cout << job.name() << '\n';
  const v1::Import& from = job.imported();
  if (!options.new_name && from.original_name() != job.name()) {
    std::cerr << "fascicle: it was " << from.original_name() << "; this name can't be used here\n";
  }
  if (from.original_state() != job.state()) {
    std::cerr << "fascicle: it was " << StateName(from.original_state())
              << " when the file was written; here it has ended, with the frames it had\n";
  }
  return kDone;
}

}  // namespace

void AddImportJob(CLI::App& app, Context& context) {
  CLI::App* command = AddCommand(app, "import-job", "Give a server a job that another one ran", kImportJobExamples);
  const auto options = std::make_shared<ImportJobOptions>();
  command->add_option("FILE", options->file, "A file of `fascicle export JOB --database`")->required();
  command->add_flag("--new-name", options->new_name, "Give it a new name, even if its own is free");
  command->callback(
      [options, &context] { context.action = [options, &context] { return ImportJob(*options, context); }; });
}

}  // namespace fascicle::client
