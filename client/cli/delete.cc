#include <iostream>
#include <memory>
#include <vector>

#include <CLI/App.hpp>
#include <nlohmann/json.hpp>

#include "client/cli/command.h"

namespace fascicle::client {
namespace {

constexpr const char* kDeleteExamples =
    R"(  fascicle delete jobs/3f2a           a finished job with all its frames; cancel it first if it runs
  fascicle delete 3f2a 77b0           several
)";

int Delete(const std::vector<std::string>& names, const Context& context) {
  Client client = Connect(context);
  for (const std::string& name : names) {
    Check(client.DeleteJob(JobName(name)));
    if (context.json) {
      PrintJson({{"job", JobName(name)}, {"deleted", true}});
    } else {
      std::cout << "deleted " << JobName(name) << '\n';
    }
  }
  return kDone;
}

}  // namespace

void AddDelete(CLI::App& app, Context& context) {
  CLI::App* command = AddCommand(app, "delete", "Delete finished jobs with all of their data", kDeleteExamples);
  const auto jobs = std::make_shared<std::vector<std::string>>();
  command->add_option("JOB", *jobs, "The jobs")->required();
  command->callback([jobs, &context] { context.action = [jobs, &context] { return Delete(*jobs, context); }; });
}

}  // namespace fascicle::client
