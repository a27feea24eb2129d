#include <iostream>
#include <memory>

#include <CLI/App.hpp>
#include <nlohmann/json.hpp>

#include "client/cli/command.h"
#include "client/cli/digests.h"
#include "client/cli/follow.h"
#include "client/cli/interrupts.h"
#include "client/cli/job_source.h"
#include "client/cli/profile_table.h"
#include "client/cli/summary.h"

namespace fascicle::client {
namespace {

constexpr const char* kWatchExamples =
    R"(  fascicle watch jobs/3f2a             follow a job to its end, then print what came out
  fascicle watch 3f2a --digests        also a line for each frame: index, time, SHA-256 of its numbers
  fascicle watch 3f2a --from 12        start with frame 12: frames do not depend on when one joins

Ctrl-C leaves (exit code 4); the job continues.
)";

struct WatchArguments {
  std::string job;
  std::int64_t from = 0;
  bool digests = false;
  bool profile = false;
};

int Watch(const WatchArguments& options, const Context& context) {
  std::stop_source interrupted;
  const Interrupts interrupts([&] { interrupted.request_stop(); });
  Client client = Connect(context);
  FrameHook on_frame;
  WatchOptions watch = options.digests ? WatchOptions() : OnlySeries();
  watch.start_index = options.from;
  if (options.digests) {
    on_frame = [&](const v1::Geometry&, const v1::Frame& frame) { PrintDigest(frame, context.json); };
  }
  const Followed followed = Follow(client, FindJob(client, options.job), watch, on_frame, interrupted.get_token());
  if (context.json) {
    Json summary = SummaryJson(followed);
    if (options.profile) summary["profile"] = ProfileJson(followed.job);
    PrintJson(summary);
  } else {
    PrintSummary(followed);
    if (options.profile) PrintProfile(followed.job);
  }
  if (followed.stopped) {
    std::cerr << "fascicle: left " << followed.job.name() << "; it continues. To stop it: fascicle cancel "
              << followed.job.name() << '\n';
    return kCancelled;
  }
  return ExitCodeOf(followed.job);
}

}  // namespace

void AddWatch(CLI::App& app, Context& context) {
  CLI::App* command = AddCommand(app, "watch", "Follow a job to its end", kWatchExamples);
  const auto options = std::make_shared<WatchArguments>();
  command->add_option("JOB", options->job, "The job, as `submit` and `list` print it")->required();
  command->add_option("--from", options->from, "First frame to read")->check(CLI::NonNegativeNumber);
  command->add_flag("--digests", options->digests, "Print a line with the digest of each frame");
  command->add_flag("--profile", options->profile, "Print the time spent in each stage");
  command->callback([options, &context] { context.action = [options, &context] { return Watch(*options, context); }; });
}

}  // namespace fascicle::client
