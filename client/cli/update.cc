#include <memory>
#include <string>
#include <vector>

#include <CLI/App.hpp>

#include "client/cli/command.h"
#include "client/cli/job_options.h"
#include "client/cli/job_source.h"
#include "client/cli/summary.h"

namespace fascicle::client {
namespace {

constexpr const char* kUpdateExamples =
    R"(  fascicle update jobs/3f2a --priority 10          started before jobs of lower priority, whoever owns them
  fascicle update 3f2a --label study=knee --remove-label draft
  fascicle update 3f2a --ttl 7d                    deleted by the server seven days after its end
  fascicle update 3f2a --pin                       kept, with its frames, until somebody deletes it
)";

struct UpdateOptions {
  std::string job;
  JobOptions settings;
  std::vector<std::string> removed;
  bool pin = false;
  bool unpin = false;
};

v1::UpdateJobRequest RequestOf(const UpdateOptions& options) {
  v1::UpdateJobRequest request;
  google::protobuf::FieldMask& mask = *request.mutable_update_mask();
  SetOptions(options.settings, *request.mutable_job());
  if (options.settings.priority) mask.add_paths("priority");
  if (options.settings.ttl) mask.add_paths("ttl");
  for (const auto& [key, value] : request.job().labels()) mask.add_paths("labels." + key);
  for (const std::string& key : options.removed) mask.add_paths("labels." + key);
  if (options.pin || options.unpin) mask.add_paths("pinned");
  request.mutable_job()->set_pinned(options.pin);
  if (mask.paths().empty()) {
    throw CommandError::Invalid("say what to change: --priority, --label, --remove-label, --ttl, --pin or --unpin");
  }
  return request;
}

int Update(const UpdateOptions& options, const Context& context) {
  v1::UpdateJobRequest request = RequestOf(options);
  Client client = Connect(context);
  request.mutable_job()->set_name(FindJob(client, options.job));
  PrintState(Take(client.UpdateJob(request)), context.json);
  return kDone;
}

}  // namespace

void AddUpdate(CLI::App& app, Context& context) {
  CLI::App* command = AddCommand(app, "update", "Change priority, labels, ttl or pin of a job", kUpdateExamples);
  const auto options = std::make_shared<UpdateOptions>();
  command->add_option("JOB", options->job, "The job")->required();
  AddJobOptions(*command, options->settings);
  command->add_option("--remove-label", options->removed, "A label to remove; may be repeated")->type_name("KEY");
  CLI::Option* pin = command->add_flag("--pin", options->pin, "Keep it until somebody deletes it");
  command->add_flag("--unpin", options->unpin, "Keep it no longer than others")->excludes(pin);
  command->callback(
      [options, &context] { context.action = [options, &context] { return Update(*options, context); }; });
}

}  // namespace fascicle::client
