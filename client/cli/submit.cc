#include <iostream>
#include <memory>
#include <string>
#include <utility>

#include <CLI/App.hpp>
#include <nlohmann/json.hpp>

#include "client/cli/command.h"
#include "client/cli/job_options.h"
#include "client/cli/start_frame.h"
#include "client/cli/summary.h"

namespace fascicle::client {
namespace {

constexpr const char* kSubmitExamples =
    R"text(  fascicle --server lab:7300 submit scene.json             prints the job's name
  fascicle submit scene.json --threads 4                   with FASCICLE_SERVER set
  fascicle submit scene.json --set duration=2 --set 'name=twice as long'
  fascicle watch "$(fascicle submit scene.json)"           submit, then follow
  fascicle submit scene.json --priority 5 --label study=knee --ttl 7d
)text";

struct SubmitOptions {
  SceneArgument scene;
  int threads = 0;
  JobOptions settings;
  std::string owner = UserName();
  bool pin = false;
};

int Submit(const SubmitOptions& options, const Context& context) {
  ScenePackage package = LoadSceneOrFail(options.scene);
  PackStart(context, options.scene.start, package);
  v1::Job wanted;
  wanted.set_threads(options.threads);
  wanted.set_owner(options.owner);
  wanted.set_pinned(options.pin);
  SetOptions(options.settings, wanted);
  Client client = Connect(context);
  const v1::Job job = Take(client.Submit(package, std::move(wanted)));
  if (context.json) {
    PrintJson(JobJson(job));
  } else {
    std::cout << job.name() << '\n';
  }
  return kDone;
}

}  // namespace

void AddSubmit(CLI::App& app, Context& context) {
  CLI::App* command = AddCommand(app, "submit", "Send a scene to a server and return at once", kSubmitExamples);
  const auto options = std::make_shared<SubmitOptions>();
  AddSceneArgument(*command, options->scene);
  AddStartOption(*command, options->scene);
  command->add_option("--threads", options->threads, "Number of threads; 0: the server's default")
      ->check(CLI::Range(0, 256));
  AddJobOptions(*command, options->settings);
  command->add_option("--owner", options->owner, "Who submits it; there is no login: servers believe it")
      ->type_name("NAME")
      ->default_str("this user");
  command->add_flag("--pin", options->pin, "Keep it until somebody deletes it");
  command->callback(
      [options, &context] { context.action = [options, &context] { return Submit(*options, context); }; });
}

}  // namespace fascicle::client
