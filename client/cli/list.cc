#include <cstdio>
#include <map>
#include <memory>
#include <vector>

#include <CLI/App.hpp>
#include <nlohmann/json.hpp>

#include "client/cli/command.h"
#include "client/cli/progress_bar.h"
#include "client/cli/summary.h"

namespace fascicle::client {
namespace {

constexpr const char* kListExamples = R"(  fascicle list                       the newest 50 jobs
  fascicle list --state running       running jobs
  fascicle list --limit 500 --json    one object per line
)";

struct ListOptions {
  int limit = 50;
  std::vector<std::string> states;
};

std::map<std::string, v1::Job::State> KnownStates() {
  std::map<std::string, v1::Job::State> states;
  for (int i = v1::Job::STATE_QUEUED; i <= v1::Job::State_MAX; ++i) {
    const auto state = static_cast<v1::Job::State>(i);
    states[StateName(state)] = state;
  }
  return states;
}

int List(const ListOptions& options, const Context& context) {
  std::vector<v1::Job::State> states;
  for (const std::string& name : options.states) states.push_back(KnownStates().at(name));
  Client client = Connect(context);
  const std::vector<v1::Job> jobs = Take(client.ListJobs(options.limit, states));
  if (context.json) {
    for (const v1::Job& job : jobs) PrintJson(JobJson(job));
    return kDone;
  }
  int width = 3;
  for (const v1::Job& job : jobs) width = std::max(width, static_cast<int>(job.name().size()));
  std::printf("%-*s  %-10s %5s %7s  %s\n", width, "job", "state", "done", "frames", "scene");
  for (const v1::Job& job : jobs) {
    std::printf("%-*s  %-10s %3.0f %% %7lld  %s\n", width, job.name().c_str(), StateName(job.state()).c_str(),
                100 * job.progress().fraction(), static_cast<long long>(job.frame_count()), job.scene_name().c_str());
  }
  return kDone;
}

}  // namespace

void AddList(CLI::App& app, Context& context) {
  CLI::App* command = AddCommand(app, "list", "List the jobs of a server, newest first", kListExamples);
  const auto options = std::make_shared<ListOptions>();
  command->add_option("--limit", options->limit, "Largest number of jobs to list")->check(CLI::Range(1, 1000000));
  std::vector<std::string> names;
  for (const auto& [name, state] : KnownStates()) names.push_back(name);
  command->add_option("--state", options->states, "Only jobs in this state; may be repeated")
      ->check(CLI::IsMember(names));
  command->callback([options, &context] { context.action = [options, &context] { return List(*options, context); }; });
}

}  // namespace fascicle::client
