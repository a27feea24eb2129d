#include "client/cli/follow.h"

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <utility>

#include "client/cli/progress_bar.h"

namespace fascicle::client {
namespace {

// Sleeps for `time`, or until a stop is requested.
void Sleep(std::chrono::milliseconds time, const std::stop_token& stop) {
  std::mutex mutex;
  std::condition_variable_any wake;
  std::unique_lock lock(mutex);
  wake.wait_for(lock, stop, time, [] { return false; });
}

void Show(const v1::Job& job, ProgressBar& bar) {
  bar.SetFrames(job.frame_count());
  bar.Show(job.state(), job.progress(), job.queue_position());
}

bool HasStarted(const v1::Job& job) {
  if (job.state() == v1::Job::STATE_PAUSED || job.state() == v1::Job::STATE_PAUSING) return job.has_start_time();
  return job.state() != v1::Job::STATE_QUEUED && job.state() != v1::Job::STATE_STARTING;
}

// Waits until the job has been started or is final, or until a stop is requested; returns its current state.
v1::Job AwaitStart(Client& client, const std::string& name, ProgressBar& bar, const std::stop_token& stop) {
  std::chrono::milliseconds pause(20);
  for (;;) {
    v1::Job job = Take(client.GetJob(name));
    Show(job, bar);
    if (HasStarted(job) || stop.stop_requested()) return job;
    Sleep(pause, stop);
    pause = std::min(pause * 2, std::chrono::milliseconds(500));
  }
}

// Polls the job's progress, so that the bar moves between frames.
std::jthread PollProgress(Client& client, const std::string& name, ProgressBar& bar) {
  return std::jthread([&client, &bar, name](const std::stop_token& stop) {
    for (; !stop.stop_requested(); Sleep(std::chrono::milliseconds(400), stop)) {
      const Result<v1::Job> job = client.GetJob(name);
      if (job.ok()) Show(job.value(), bar);
    }
  });
}

// The geometry, unless the job ended before it had one; `job` is then the final one.
std::optional<v1::Geometry> FetchGeometry(Client& client, v1::Job& job) {
  Result<v1::Geometry> geometry = client.GetGeometry(job.name());
  if (geometry.ok()) return std::move(geometry.value());
  job = Take(client.GetJob(job.name()));
  if (IsFinal(job.state()) && job.frame_count() == 0) return std::nullopt;
  throw CommandError(geometry.error());
}

Followed Nothing(v1::Job job, bool stopped) {
  return {std::move(job), {}, SeriesTable(v1::Geometry()), std::nullopt, stopped};
}

}  // namespace

bool IsFinal(v1::Job::State state) {
  return state == v1::Job::STATE_SUCCEEDED || state == v1::Job::STATE_FAILED || state == v1::Job::STATE_CANCELLED;
}

WatchOptions FramesFrom(std::int64_t start_index) {
  WatchOptions options;
  options.start_index = start_index;
  return options;
}

WatchOptions OnlySeries() {
  WatchOptions options;
  options.fields = {"series"};
  return options;
}

Followed Follow(Client& client, const std::string& name, const WatchOptions& options, const FrameHook& on_frame,
                const std::stop_token& stop) {
  ProgressBar bar;
  v1::Job job = AwaitStart(client, name, bar, stop);
  if (!HasStarted(job)) return Nothing(std::move(job), true);
  std::optional<v1::Geometry> geometry = FetchGeometry(client, job);
  if (!geometry) return Nothing(std::move(job), false);
  Followed followed{{}, std::move(*geometry), SeriesTable({}), std::nullopt, false};
  followed.table = SeriesTable(followed.geometry);
  WatchEvents events;
  events.frame = [&](const v1::Frame& frame) {
    followed.table.Add(frame);
    bar.SetFrames(frame.index() + 1);
    if (on_frame) on_frame(followed.geometry, frame);
    followed.last_frame = frame;
  };
  events.progress = [&](v1::Job::State state, const v1::Progress& progress) { bar.Show(state, progress); };
  events.reconnecting = [&](const std::string& message) { bar.Say("connection lost (" + message + "); reconnecting"); };
  std::jthread poll;
  if (bar.on_terminal()) poll = PollProgress(client, name, bar);
  Result<v1::Job> end = client.Watch(name, options, events, stop);
  if (!end.ok() && end.error().kind == Error::Kind::kStopped) {
    followed.stopped = true;
    followed.job = Take(client.GetJob(name));
    return followed;
  }
  followed.job = Take(std::move(end));
  return followed;
}

Followed ReadStored(Client& client, const std::string& name, WatchOptions options,
                    const std::function<bool(const v1::Geometry&, const v1::Frame&)>& on_frame) {
  v1::Job job = Take(client.GetJob(name));
  if (job.frame_count() == 0) {
    throw CommandError::Invalid(name + " has no frames yet; it is " + StateName(job.state()));
  }
  Followed followed{std::move(job), Take(client.GetGeometry(name)), SeriesTable({}), std::nullopt, false};
  followed.table = SeriesTable(followed.geometry);
  std::stop_source enough;
  options.follow = false;
  WatchEvents events;
  events.frame = [&](const v1::Frame& frame) {
    if (enough.stop_requested()) return;
    followed.table.Add(frame);
    followed.last_frame = frame;
    if (!on_frame(followed.geometry, frame)) enough.request_stop();
  };
  const Result<v1::Job> end = client.Watch(name, options, events, enough.get_token());
  if (!end.ok() && !enough.stop_requested()) throw CommandError(end.error());
  return followed;
}

}  // namespace fascicle::client
