#include <cmath>
#include <cstdio>
#include <ctime>
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

// "2026-11-30 09:40" in local time; empty for an absent one.
std::string TimeText(bool is_set, const google::protobuf::Timestamp& time) {
  if (!is_set) return "";
  const std::time_t seconds = time.seconds();
  std::tm local = {};
  localtime_r(&seconds, &local);
  char text[32];
  return std::strftime(text, sizeof text, "%Y-%m-%d %H:%M", &local) > 0 ? text : "";
}

// From the start to the end, or until now; empty before the start.
std::string WallText(const v1::Job& job) {
  if (!job.has_start_time()) return "";
  const double start = static_cast<double>(job.start_time().seconds()) + 1e-9 * job.start_time().nanos();
  const double end = job.has_end_time() ? static_cast<double>(job.end_time().seconds()) + 1e-9 * job.end_time().nanos()
                                        : static_cast<double>(std::time(nullptr));
  return DurationText(end - start);
}

// "950 kB"; powers of 1000.
std::string SizeText(std::int64_t bytes) {
  double size = static_cast<double>(bytes);
  const char* unit = "B";
  for (const char* larger : {"kB", "MB", "GB", "TB"}) {
    if (size < 999.5) break;
    size /= 1000;
    unit = larger;
  }
  char text[32];
  std::snprintf(text, sizeof text, size < 9.95 && *unit != 'B' ? "%.1f %s" : "%.0f %s", size, unit);
  return text;
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
  std::printf("%-*s  %-10s %5s %7s %7s  %-16s %8s  %s\n", width, "job", "state", "done", "frames", "size", "created",
              "wall", "scene");
  for (const v1::Job& job : jobs) {
    std::printf("%-*s  %-10s %3.0f %% %7lld %7s  %-16s %8s  %s\n", width, job.name().c_str(),
                StateName(job.state()).c_str(), 100 * job.progress().fraction(),
                static_cast<long long>(job.frame_count()), SizeText(job.stored_bytes()).c_str(),
                TimeText(job.has_create_time(), job.create_time()).c_str(), WallText(job).c_str(),
                (job.scene_name() + (job.has_imported() ? " (imported)" : "")).c_str());
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
