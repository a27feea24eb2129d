#include <cstdio>
#include <iostream>
#include <memory>

#include <CLI/App.hpp>
#include <nlohmann/json.hpp>

#include <google/protobuf/util/json_util.h>

#include "client/cli/command.h"
#include "client/cli/job_source.h"
#include "client/cli/profile_table.h"
#include "client/cli/progress_bar.h"
#include "client/cli/summary.h"

namespace fascicle::client {
namespace {

constexpr const char* kShowExamples = R"(  fascicle show jobs/3f2a             where a job stands, and why it failed
  fascicle show 3f2a --scene          its scene, as a scene file
  fascicle show 3f2a --profile        the time spent in each stage
)";

struct ShowOptions {
  std::string job;
  bool scene = false;
  bool profile = false;
};

std::string SceneText(const v1::Scene& scene) {
  google::protobuf::util::JsonPrintOptions print;
  print.add_whitespace = true;
  print.preserve_proto_field_names = true;
  std::string text;
  const auto status = google::protobuf::util::MessageToJsonString(scene, &text, print);
  if (!status.ok()) throw std::runtime_error("the job's scene can't be printed: " + status.ToString());
  return text;
}

int Show(const ShowOptions& options, const Context& context) {
  JobSource source = OpenJob(context, options.job);
  const v1::Job job = Take(source.client.GetJob(source.job));
  if (options.scene) {
    if (context.json) {
      PrintJson(Json::parse(SceneText(job.scene())));
    } else {
      std::cout << SceneText(job.scene());
    }
    return kDone;
  }
  if (options.profile) {
    if (context.json) {
      PrintJson(ProfileJson(job));
    } else {
      PrintProfile(job);
    }
    return kDone;
  }
  const Json json = JobJson(job);
  if (context.json) {
    PrintJson(json);
    return kDone;
  }
  for (const auto& [key, value] : json.items()) {
    if (key == "failure") continue;
    std::printf("%-14s %s\n", key.c_str(), value.is_string() ? value.get<std::string>().c_str() : value.dump().c_str());
  }
  if (!job.progress().waiting().empty()) std::printf("%-14s %s\n", "waits", job.progress().waiting().c_str());
  if (job.progress().has_eta()) {
    std::printf("%-14s %s\n", "eta", DurationText(static_cast<double>(job.progress().eta().seconds())).c_str());
  }
  if (job.has_failure()) PrintFailure(job.failure());
  PrintWarnings(job);
  return kDone;
}

}  // namespace

void AddShow(CLI::App& app, Context& context) {
  CLI::App* command = AddCommand(app, "show", "Show one job", kShowExamples);
  const auto options = std::make_shared<ShowOptions>();
  command->add_option("JOB", options->job, "The job")->required();
  CLI::Option* scene = command->add_flag("--scene", options->scene, "Print the job's scene instead");
  command->add_flag("--profile", options->profile, "Print the time spent in each stage instead")->excludes(scene);
  command->callback([options, &context] { context.action = [options, &context] { return Show(*options, context); }; });
}

}  // namespace fascicle::client
