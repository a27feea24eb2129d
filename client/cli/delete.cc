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
  fascicle delete --filter 'state=FAILED AND age>7d' --dry-run    which finished jobs would be deleted
  fascicle delete --filter 'state=FAILED AND age>7d'              see `fascicle list --help` for filters
)";

struct DeleteOptions {
  std::vector<std::string> jobs;
  std::string filter;
  bool dry_run = false;
};

// Names of the finished jobs that pass a filter and are not pinned.
std::vector<std::string> Passing(Client& client, const std::string& filter) {
  constexpr int kAll = 1'000'000;
  const std::string finished = " AND (state=SUCCEEDED OR state=FAILED OR state=CANCELLED) AND pinned=false";
  Take(client.ListJobs({.limit = 1, .filter = filter}));  // so that mistakes are told at their place
  std::vector<std::string> names;
  for (const v1::Job& job : Take(client.ListJobs({.limit = kAll, .filter = filter + finished}))) {
    names.push_back(job.name());
  }
  return names;
}

void DeleteJob(Client& client, const std::string& job, bool dry_run, const Context& context) {
  if (!dry_run) Check(client.DeleteJob(job));
  if (context.json) {
    PrintJson({{"job", job}, {"deleted", !dry_run}});
  } else {
    std::cout << (dry_run ? "would delete " : "deleted ") << job << '\n';
  }
}

int Delete(const DeleteOptions& options, const Context& context) {
  if (options.jobs.empty() == options.filter.empty()) {
    throw CommandError::Invalid("name the jobs to delete, or describe them by --filter");
  }
  Client client = Connect(context);
  std::vector<std::string> names = options.jobs;
  if (!options.filter.empty()) names = Passing(client, options.filter);
  int exit_code = kDone;
  // One that can't be deleted does not keep the others.
  for (const std::string& name : names) {
    try {
      DeleteJob(client, FindJob(client, name), options.dry_run, context);
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
  const auto options = std::make_shared<DeleteOptions>();
  command->add_option("JOB", options->jobs, "The jobs");
  command->add_option("--filter", options->filter, "All finished jobs that pass and are not pinned")
      ->type_name("FILTER");
  command->add_flag("--dry-run", options->dry_run, "Only print what would be deleted");
  command->callback(
      [options, &context] { context.action = [options, &context] { return Delete(*options, context); }; });
}

}  // namespace fascicle::client
