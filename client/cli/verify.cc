#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include <CLI/App.hpp>
#include <nlohmann/json.hpp>

#include "client/cli/command.h"
#include "client/cli/job_source.h"

namespace fascicle::client {
namespace {

constexpr const char* kVerifyExamples =
    R"(  fascicle verify jobs/3f2a           whether all frames are as they were stored
  fascicle verify --all               those of every job
)";

struct VerifyArguments {
  std::vector<std::string> jobs;
  bool all = false;
};

void Print(const std::string& job, const v1::VerifyJobResponse& found, bool json) {
  const std::vector<std::string> damages(found.damages().begin(), found.damages().end());
  if (json) {
    PrintJson({{"job", job}, {"frames", found.frames()}, {"bytes", found.bytes()}, {"damages", damages}});
    return;
  }
  std::cout << job << "  " << found.frames() << " frames, " << found.bytes()
            << " bytes: " << (damages.empty() ? "intact" : "DAMAGED") << '\n';
  for (const std::string& damage : damages) std::cout << "  " << damage << '\n';
  if (!damages.empty()) std::cout << "  `fascicle restart " << job << " --from-start` computes damaged frames again\n";
}

std::vector<std::string> JobsOf(const VerifyArguments& arguments, Client& client) {
  std::vector<std::string> names;
  if (arguments.all) {
    constexpr int kAll = 1 << 30;
    for (const v1::Job& job : Take(client.ListJobs(kAll, {}))) names.push_back(job.name());
  } else {
    for (const std::string& name : arguments.jobs) names.push_back(FindJob(client, name));
  }
  return names;
}

int Verify(const VerifyArguments& arguments, const Context& context) {
  Client client = Connect(context);
  bool damaged = false;
  for (const std::string& job : JobsOf(arguments, client)) {
    const v1::VerifyJobResponse found = Take(client.VerifyJob(job));
    damaged = damaged || found.damages_size() > 0;
    Print(job, found, context.json);
  }
  return damaged ? kJobFailed : kDone;
}

}  // namespace

void AddVerify(CLI::App& app, Context& context) {
  CLI::App* command = AddCommand(app, "verify", "Check that stored frames are undamaged", kVerifyExamples);
  const auto arguments = std::make_shared<VerifyArguments>();
  CLI::Option* jobs = command->add_option("JOB", arguments->jobs, "The jobs");
  CLI::Option* all = command->add_flag("--all", arguments->all, "Every job of the server");
  jobs->excludes(all);
  command->callback([arguments, &context] {
    if (arguments->jobs.empty() && !arguments->all) throw CLI::RequiredError("JOB or --all");
    context.action = [arguments, &context] { return Verify(*arguments, context); };
  });
}

}  // namespace fascicle::client
