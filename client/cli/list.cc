#include <cstdio>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <CLI/App.hpp>
#include <nlohmann/json.hpp>

#include "client/cli/command.h"
#include "client/cli/interrupts.h"
#include "client/cli/job_table.h"
#include "client/cli/progress_bar.h"
#include "client/cli/summary.h"

namespace fascicle::client {
namespace {

constexpr const char* kListExamples = R"(  fascicle list                       the newest 50 jobs
  fascicle list --state running       running jobs
  fascicle list --limit 500 --json    one object per line
  fascicle list --filter 'state=FAILED AND age<7d' --order-by 'size desc'
  fascicle list --filter 'owner=ann AND (labels.study=knee OR name:knee)'
  fascicle list --watch               all jobs, then each change, until Ctrl-C
Filters compare state, owner, name, labels.KEY, created, started, ended, age, priority, size, frames and pinned
by = != < <= > >= and : (a part of a text), and join comparisons by AND, OR (which binds more strongly) and NOT.
)";

struct ListOptions {
  JobsToList which;
  std::vector<std::string> states;
  bool watch = false;
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
  JobsToList which = options.which;
  for (const std::string& name : options.states) which.states.push_back(KnownStates().at(name));
  Client client = Connect(context);
  const std::vector<v1::Job> jobs = Take(client.ListJobs(which));
  if (context.json) {
    for (const v1::Job& job : jobs) PrintJson(JobJson(job));
    return kDone;
  }
  const JobTable table(jobs);
  table.PrintHead();
  for (const v1::Job& job : jobs) table.Print(job);
  return kDone;
}

// Prints changes: all with --json, otherwise those other than progress.
class ChangePrinter {
 public:
  explicit ChangePrinter(bool json) : json_(json) {}

  void Print(const v1::WatchJobsResponse& changes) {
    for (const v1::Job& job : changes.jobs()) {
      const std::string before = std::exchange(told_[job.name()], WithoutProgress(job));
      if (json_) PrintJson(JobJson(job));
      if (!json_ && before != told_[job.name()]) Print(job);
    }
    for (const std::string& name : changes.removed()) {
      const bool was_told = told_.erase(name) > 0;
      if (json_) PrintJson({{"removed", name}});
      if (!json_ && was_told) std::printf("%s  is not in the list any more\n", name.c_str());
    }
    std::fflush(stdout);
  }

 private:
  static std::string WithoutProgress(const v1::Job& job) {
    Json json = JobJson(job);
    for (const char* key :
         {"frames", "fraction", "time", "steps", "stored_bytes", "queue_position", "revision", "threads_in_use"}) {
      json.erase(key);
    }
    return json.dump();
  }

  void Print(const v1::Job& job) {
    if (!table_) {
      table_.emplace(std::vector<v1::Job>{job});
      table_->PrintHead();
    }
    table_->Print(job);
  }

  const bool json_;
  std::optional<JobTable> table_;
  std::map<std::string, std::string> told_;
};

int Watch(const ListOptions& options, const Context& context) {
  const StopOnInterrupt interrupt;
  Client client = Connect(context);
  ChangePrinter printer(context.json);
  JobsWatch watch;
  watch.filter = options.which.filter;
  watch.changes = [&](const v1::WatchJobsResponse& changes) { printer.Print(changes); };
  watch.reconnecting = [](const std::string& message) {
    std::fprintf(stderr, "connection lost (%s), trying again\n", message.c_str());
  };
  const Error error = client.WatchJobs(watch, interrupt.token());
  if (error.kind == Error::Kind::kStopped) return kCancelled;
  throw CommandError(error);
}

}  // namespace

void AddList(CLI::App& app, Context& context) {
  CLI::App* command = AddCommand(app, "list", "List the jobs of a server, newest first", kListExamples);
  const auto options = std::make_shared<ListOptions>();
  CLI::Option* limit = command->add_option("--limit", options->which.limit, "Largest number of jobs to list")
                           ->check(CLI::Range(1, 1000000));
  std::vector<std::string> names;
  for (const auto& [name, state] : KnownStates()) names.push_back(name);
  CLI::Option* states = command->add_option("--state", options->states, "Only jobs in this state; may be repeated")
                            ->check(CLI::IsMember(names));
  command->add_option("--filter", options->which.filter, "Only jobs that pass; see below")->type_name("FILTER");
  CLI::Option* order =
      command
          ->add_option("--order-by", options->which.order_by,
                       "created, started, ended, priority, size, frames, owner, name or state, and ` desc`")
          ->type_name("ORDER");
  command->add_flag("--watch", options->watch, "Print all jobs, then each change, until Ctrl-C")
      ->excludes(limit)
      ->excludes(states)
      ->excludes(order);
  command->callback([options, &context] {
    context.action = [options, &context] {
      return options->watch ? Watch(*options, context) : List(*options, context);
    };
  });
}

}  // namespace fascicle::client
