#include "server/jobs/job_run.h"

#include <chrono>
#include <exception>
#include <memory>
#include <optional>
#include <stdexcept>
#include <stop_token>
#include <string>
#include <thread>

#include "core/base/stop.h"
#include "server/jobs/frame_writer.h"
#include "server/jobs/wait_for_room.h"

namespace fascicle::server {
namespace {

// False if the job was cancelled or paused at the last moment, while still in the queue.
bool Start(ActiveJob& job, Profile& profile) {
  const StageTimer timer(&profile, "start");
  bool has_started = false;
  job.Update([&](JobRecord& record) {
    if (record.state != JobState::kQueued) return false;
    record.state = JobState::kStarting;
    ++record.attempt;
    if (record.start_time_us == 0) record.start_time_us = UnixTimeUs();
    has_started = true;
    return true;
  });
  return has_started;
}

void SetRunning(ActiveJob& job) {
  job.Update([](JobRecord& record) {
    if (record.state != JobState::kStarting) return false;  // asked to stop
    record.state = JobState::kRunning;
    return true;
  });
}

// At the newest stored checkpoint that is intact and fits the scene and the stored frames, otherwise at rest.
std::unique_ptr<Simulation> MakeSimulation(std::shared_ptr<const Scene> scene, int threads, FrameStore& frames,
                                           Profile& profile, const std::stop_token& stop) {
  const StageTimer timer(&profile, "model");
  for (auto checkpoint = frames.GetCheckpoint(frames.frame_count()); checkpoint;
       checkpoint = frames.GetCheckpoint(checkpoint->frame)) {
    auto simulation = std::make_unique<Simulation>(scene, threads, &profile, stop);
    if (simulation->Restore(checkpoint->bytes) && simulation->next_frame() <= frames.frame_count()) return simulation;
  }
  return std::make_unique<Simulation>(std::move(scene), threads, &profile, stop);
}

// The scene passed at submission, or built from the specification.
std::shared_ptr<const Scene> SceneOf(const RunContext& context, ActiveJob& job, const std::string& spec,
                                     Profile& profile) {
  const StageTimer timer(&profile, "scene");
  std::shared_ptr<const Scene> scene = job.TakeScene();
  if (scene == nullptr) scene = context.codec.decode_scene(spec, context.store, &profile, job.stop_token());
  if (scene == nullptr) throw std::runtime_error("the scene can't be built");
  return scene;
}

void StoreGeometry(const RunContext& context, ActiveJob& job, const Scene& scene, const FrameLayout& layout,
                   Profile& profile) {
  const StageTimer timer(&profile, "geometry");
  const std::string geometry = context.codec.encode_geometry(scene, layout);
  ThrowIfStopped(job.stop_token());
  WriteWhenRoom(context.store, job, [&] { job.frames()->PutGeometry(geometry); });
}

// Everything before the first step. Throws Stopped if the job is asked to stop.
std::unique_ptr<Simulation> SetUp(const RunContext& context, ActiveJob& job, Profile& profile) {
  const StageTimer timer(&profile, "set-up");
  const std::optional<JobRecord> record = context.store.GetJob(job.id());
  if (!record) throw StoreError("job " + job.id() + " has gone");
  const std::shared_ptr<const Scene> scene = SceneOf(context, job, record->spec, profile);
  ThrowIfStopped(job.stop_token());
  std::shared_ptr<FrameStore> frames;
  WriteWhenRoom(context.store, job, [&] { frames = context.store.OpenFrames(job.id()); });
  if (frames == nullptr) throw StoreError("job " + job.id() + " has gone");
  job.SetFrames(frames);

  std::unique_ptr<Simulation> simulation = MakeSimulation(scene, context.threads, *frames, profile, job.stop_token());
  const auto write = [&context, &job](const std::function<void()>& store) { WriteWhenRoom(context.store, job, store); };
  write([&] { job.steering().Open(frames, record->spec, context.codec); });
  job.steering().BeginRun(simulation->step(), record->spec, context.codec, write);
  StoreGeometry(context, job, *scene, simulation->layout(), profile);
  SetRunning(job);
  return simulation;
}

Outcome Simulate(const RunContext& context, ActiveJob& job, RunProfile& profile, const std::function<void()>& notify) {
  const std::unique_ptr<Simulation> simulation = SetUp(context, job, profile.working);
  notify();
  FrameWriter writer(context.store, job, context.codec, profile, notify);
  const Outcome outcome =
      simulation->Run(writer, job.stop_token(), context.options.checkpoint_interval, &job.steering());
  const StageTimer timer(&profile.working, "waiting for storage");
  writer.Finish();
  return outcome;
}

Outcome Failed(std::string reason, const char* message, std::string advice, const ActiveJob& job) {
  const Progress progress = job.View({}).progress;
  Failure failure;
  failure.reason = std::move(reason);
  failure.message = message;
  failure.step = progress.step;
  failure.time = progress.time;
  failure.advice = std::move(advice);
  return {Outcome::Kind::kFailed, failure};
}

// Like Simulate, with failures in place of exceptions.
Outcome SimulateSafely(const RunContext& context, ActiveJob& job, RunProfile& profile,
                       const std::function<void()>& notify) {
  try {
    return Simulate(context, job, profile, notify);
  } catch (const Stopped&) {
    return {Outcome::Kind::kCancelled, {}};
  } catch (const StoreError& error) {
    return Failed("STORAGE", error.what(), "check the free space and the health of the server's disk", job);
  } catch (const std::exception& error) {
    return Failed("INTERNAL", error.what(), "", job);
  } catch (...) {
    return Failed("INTERNAL", "unknown exception", "", job);
  }
}

std::string Encode(const JobCodec& codec, const Failure& failure) {
  try {
    return codec.encode_failure(failure);
  } catch (...) {
    return {};  // recording the failure matters more than its description
  }
}

std::string Encode(const JobCodec& codec, const std::vector<Warning>& warnings, const std::string& earlier) {
  try {
    return codec.encode_warnings(warnings, earlier);
  } catch (...) {
    return earlier;
  }
}

std::string Encode(const JobCodec& codec, const RunProfile& profile) {
  try {
    return codec.encode_profile(profile);
  } catch (...) {
    return profile.earlier;
  }
}

// Warns of inputs that were accepted for a step that the run has not reached.
void TellUnreached(ActiveJob& job, std::vector<Warning>& warnings) {
  const std::vector<std::int64_t> inputs = job.steering().Unreached();
  if (inputs.empty()) return;
  Warning warning;
  warning.reason = "INPUT_NOT_REACHED";
  warning.message = (inputs.size() == 1 ? "input " : std::to_string(inputs.size()) + " inputs, the first of them ") +
                    std::to_string(inputs.front()) + ", had no effect: the run ended before that step or time";
  warning.advice = "give an earlier step or time, or a longer duration";
  warning.time = job.View({}).progress.time;
  warnings.push_back(std::move(warning));
}

// The final change of the record.
ActiveJob::Change EndOf(const JobCodec& codec, const RunProfile& profile, const Outcome& outcome) {
  return [&](JobRecord& record) {
    record.profile = Encode(codec, profile);
    record.warnings = Encode(codec, outcome.warnings, record.warnings);
    const JobState before = record.state;
    switch (outcome.kind) {
      case Outcome::Kind::kSucceeded:
        record.state = JobState::kSucceeded;
        break;
      case Outcome::Kind::kFailed:
        record.state = JobState::kFailed;
        record.failure = Encode(codec, outcome.failure);
        break;
      case Outcome::Kind::kCancelled:
        record.state = before == JobState::kCancelling ? JobState::kCancelled
                       : before == JobState::kPausing  ? JobState::kPaused
                                                       : JobState::kQueued;  // drained
        break;
    }
    if (IsFinal(record.state)) record.end_time_us = UnixTimeUs();
    return true;
  };
}

void End(const RunContext& context, ActiveJob& job, const RunProfile& profile, const Outcome& outcome) {
  if (outcome.kind == Outcome::Kind::kSucceeded) {
    Progress progress = job.View({}).progress;
    progress.fraction = 1;  // 1 even if the run settled early
    job.SetProgress(progress);
  }
  constexpr std::chrono::milliseconds kInterval(100);
  while (true) {
    try {
      job.Update(EndOf(context.codec, profile, outcome));
      context.options.on_event(job.record(), EventOf(job.record().state));
      return;
    } catch (const std::exception& error) {
      job.SetWaiting(std::string("the end of the job can't be stored: ") + error.what());
    }
    if (context.drain.stop_requested()) return;
    std::this_thread::sleep_for(kInterval);
  }
}

}  // namespace

void RunJob(const RunContext& context, ActiveJob& job, const std::function<void()>& notify) {
  RunProfile profile;
  profile.earlier = job.record().profile;
  Outcome outcome;
  try {
    if (!Start(job, profile.working)) return;
    context.options.on_event(job.record(), EventOf(JobState::kStarting));
    notify();
    outcome = SimulateSafely(context, job, profile, notify);
  } catch (const std::exception& error) {
    outcome = Failed("STORAGE", error.what(), "check the free space and the health of the server's disk", job);
  }
  if (outcome.kind != Outcome::Kind::kCancelled) {
    job.steering().Close();
    TellUnreached(job, outcome.warnings);
  }
  End(context, job, profile, outcome);
  notify();
}

}  // namespace fascicle::server
