#include <iostream>
#include <memory>
#include <vector>

#include <CLI/App.hpp>
#include <nlohmann/json.hpp>

#include "client/cli/command.h"
#include "client/cli/job_source.h"

namespace fascicle::client {
namespace {

constexpr const char* kDeleteExamples =
    R"(  fascicle delete jobs/3f2a           a finished job with all its frames; cancel it first if it runs
  fascicle delete 3f2a 77b0           several
)";

int Delete(const std::vector<std::string>& names, const Context& context) {
  Client client = Connect(context);
  int exit_code = kDone;
  // One that can't be deleted does not keep the others.
  for (const std::string& name : names) {
    try {
      const std::string job = FindJob(client, name);
      Check(client.DeleteJob(job));
      if (context.json) {
        PrintJson({{"job", job}, {"deleted", true}});
      } else {
        std::cout << "deleted " << job << '\n';
      }
    } catch (const CommandError& error) {
      if (error.error().kind == Error::Kind::kNoServer) throw;
      PrintError(error.error(), context.json);
      exit_code = ExitCodeOf(error.error().kind);
    }
  }
  return exit_code;
}

}  // namespace

void AddDelete(CLI::App& app, Context& context) {
  CLI::App* command = AddCommand(app, "delete", "Delete finished jobs with all of their data", kDeleteExamples);
  const auto jobs = std::make_shared<std::vector<std::string>>();
  command->add_option("JOB", *jobs, "The jobs")->required();
  command->callback([jobs, &context] { context.action = [jobs, &context] { return Delete(*jobs, context); }; });
}

}  // namespace fascicle::client
