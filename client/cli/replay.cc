#include <algorithm>
#include <chrono>
#include <cstdio>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <CLI/App.hpp>
#include <nlohmann/json.hpp>

#include "client/cli/command.h"
#include "client/cli/follow.h"
#include "client/cli/interrupts.h"
#include "client/cli/job_source.h"
#include "client/cli/progress_bar.h"

namespace fascicle::client {
namespace {

constexpr const char* kReplayExamples =
    R"(  fascicle replay jobs/3f2a           runs the job again with its inputs; are all frames the same?
  fascicle replay 3f2a --keep         keeps the new job

The exit code is 0 if all frames are equal, 1 if one differs or the new job ends before. The job itself stays
as it is.
)";

struct ReplayArguments {
  std::string job;
  bool keep = false;
};

// A job with the same scene and inputs. Ends it, and deletes it unless it is kept.
class Replay {
 public:
  Replay(Client& client, const std::string& original, bool keep)
      : client_(client), job_(Take(client.SubmitAgain(original))), keep_(keep) {}

  ~Replay() {
    if (!IsFinal(job_.state())) client_.CancelJob(job_.name());
    if (keep_) return;
    for (int attempt = 0; attempt < 200; ++attempt) {
      const std::optional<Error> error = client_.DeleteJob(job_.name());
      if (!error || error->reason != "JOB_ACTIVE") return;
      std::this_thread::sleep_for(std::chrono::milliseconds(50));  // it has not stopped yet
    }
  }
  Replay(const Replay&) = delete;
  Replay& operator=(const Replay&) = delete;

  // Its frames from `start` on, after the state was read: a job in a final state has no more.
  std::vector<v1::FrameInfo> FramesFrom(std::int64_t start) {
    job_ = Take(client_.GetJob(job_.name()));
    return Take(client_.ListFrames(job_.name(), start));
  }
  const v1::Job& job() const { return job_; }

 private:
  Client& client_;
  v1::Job job_;
  const bool keep_;
};

struct Comparison {
  std::size_t equal = 0;                   // number of frames that are equal
  std::optional<v1::FrameInfo> different;  // the first that is not
  bool stopped = false;
};

bool AreEqual(const v1::FrameInfo& a, const v1::FrameInfo& b) {
  return a.index() == b.index() && a.step() == b.step() && a.digest() == b.digest();
}

// Compares frames while they are computed, until all are compared, one differs, or there are no more.
Comparison Compare(Replay& replay, const std::vector<v1::FrameInfo>& frames, const std::stop_token& stop) {
  ProgressBar bar;
  Comparison result;
  std::chrono::milliseconds pause(10);
  while (result.equal < frames.size()) {
    const std::vector<v1::FrameInfo> again = replay.FramesFrom(static_cast<std::int64_t>(result.equal));
    for (std::size_t k = 0; k < again.size() && result.equal < frames.size(); ++k) {
      const v1::FrameInfo& original = frames[result.equal];
      if (!AreEqual(again[k], original)) {
        result.different = original;
        return result;
      }
      ++result.equal;
    }
    if (result.equal == frames.size() || IsFinal(replay.job().state())) break;
    result.stopped = stop.stop_requested();
    if (result.stopped) break;
    bar.SetFrames(static_cast<std::int64_t>(result.equal));
    bar.Show(replay.job().state(), replay.job().progress(), replay.job().queue_position());
    std::this_thread::sleep_for(pause);
    pause = std::min(pause * 2, std::chrono::milliseconds(500));
  }
  return result;
}

void Print(const std::string& original, std::size_t count, const Replay& replay, const Comparison& found, bool json) {
  const bool is_equal = found.equal == count;
  if (json) {
    Json line = {{"job", original}, {"replay", replay.job().name()}, {"frames", count}, {"equal", is_equal}};
    if (found.different) line["first_different"] = found.different->index();
    if (!is_equal && !found.different) line["frames_of_replay"] = found.equal;
    return PrintJson(line);
  }
  if (is_equal) {
    std::cout << original << "  all " << count << " frames are equal\n";
  } else if (found.different) {
    std::printf("%s  frame %lld (t = %.6g s) differs; the %zu before it are equal\n", original.c_str(),
                static_cast<long long>(found.different->index()), found.different->time(), found.equal);
  } else {
    std::cout << original << "  the new job is " << StateName(replay.job().state()) << " after " << found.equal
              << " of " << count << " frames, which are equal\n";
  }
}

int RunReplay(const ReplayArguments& arguments, const Context& context) {
  const StopOnInterrupt interrupt;
  Client client = Connect(context);
  const std::string original = FindJob(client, arguments.job);
  const std::vector<v1::FrameInfo> frames = Take(client.ListFrames(original, 0));
  if (frames.empty()) throw CommandError::Invalid(original + " has no frames yet");
  Replay replay(client, original, arguments.keep);
  const Comparison found = Compare(replay, frames, interrupt.token());
  if (found.stopped) return kCancelled;
  Print(original, frames.size(), replay, found, context.json);
  return found.equal == frames.size() ? kDone : kJobFailed;
}

}  // namespace

void AddReplay(CLI::App& app, Context& context) {
  CLI::App* command =
      AddCommand(app, "replay", "Run a job again with its inputs and compare the frames", kReplayExamples);
  const auto arguments = std::make_shared<ReplayArguments>();
  command->add_option("JOB", arguments->job, "The job")->required();
  command->add_flag("--keep", arguments->keep, "Keep the new job");
  command->callback(
      [arguments, &context] { context.action = [arguments, &context] { return RunReplay(*arguments, context); }; });
}

}  // namespace fascicle::client
