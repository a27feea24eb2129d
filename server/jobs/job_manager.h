#ifndef FASCICLE_SERVER_JOBS_JOB_MANAGER_H_
#define FASCICLE_SERVER_JOBS_JOB_MANAGER_H_

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/profile.h"
#include "core/scene/scene.h"
#include "core/sim/simulation.h"
#include "server/store/store.h"

namespace fascicle::server {

// Where the time of a run goes.
struct RunProfile {
  Profile working;               // of the worker
  Profile storing = Profile(0);  // of the thread that stores frames meanwhile
  std::string earlier;           // profile of the job's runs before this one, encoded; empty when there was none
};

// How jobs become bytes and back; made by server/translate, so that this room knows no wire format. Called from several
// threads at once; what they throw fails the job with reason INTERNAL (StoreError: STORAGE).
struct JobCodec {
  // Scene of a job's spec; assets are read from `assets`, and stages timed in `profile`. Throws std::runtime_error when
  // it can't be built any more (an asset was lost).
  std::function<std::shared_ptr<const Scene>(const std::string& spec, AssetStore& assets, Profile* profile)>
      decode_scene;
  std::function<std::string(const Scene&, const FrameLayout&)> encode_geometry;
  std::function<std::string(const Frame&)> encode_frame;
  std::function<std::string(const Failure&)> encode_failure;
  // The sum of this run and the earlier ones.
  std::function<std::string(const RunProfile&)> encode_profile;
};

struct JobManagerOptions {
  int workers = 2;          // jobs that run at once
  int default_threads = 1;  // for jobs that ask for 0
  std::chrono::milliseconds checkpoint_interval = std::chrono::seconds(2);
};

// A job as it is now: the stored record, with what only the running process knows.
struct JobView {
  JobRecord record;
  Progress progress;
  double eta_seconds = -1;  // negative: unknown
  int queue_position = 0;   // jobs before it; kQueued only
  std::int64_t frame_count = 0;
  std::int64_t stored_bytes = 0;
};

// The queue and its workers. Takes up what was queued or running when the last process ended. Thread-safe; all
// functions may block on disk and throw StoreError. What a job meets in its worker ends that job alone.
class JobManager {
 public:
  // `store` outlives this. Throws StoreError when what is stored can't be taken up.
  JobManager(Store& store, JobCodec codec, JobManagerOptions options);
  // Drains; unfinished jobs go on with the next process.
  ~JobManager();

  // `record` with spec, scene_name, threads, request_id and request_digest set. Returns the job, or the earlier one
  // with the same request id (`*repeated` true; the caller compares request_digest).
  // Durable when it returns.
  JobView Submit(JobRecord record, bool* repeated);
  std::optional<JobView> Get(std::string_view id);
  std::vector<JobView> List(int limit, std::string_view before_id, const std::vector<JobState>& states);
  // Asks the job to stop; a final job is left as it is. Nothing when there is no such job.
  std::optional<JobView> Cancel(std::string_view id);
  enum class DeleteResult { kDeleted, kNotFound, kActive };
  DeleteResult Delete(std::string_view id);
  // Frames of a job; nullptr when there is no such job.
  std::shared_ptr<FrameStore> Frames(std::string_view id);

  // Calls `listener` (on an internal thread, quickly returning, never under a lock of the caller) whenever the job got
  // its geometry, a frame or another state, or was deleted: after the store has it. Changes that follow each other fast
  // may be told once. The listener is not called any more once the returned handle is gone; destroying it waits for a
  // call that is under way (unless done by that call), so don't do it under a lock that the listener takes.
  using Subscription = std::shared_ptr<void>;
  Subscription Subscribe(std::string_view id, std::function<void()> listener);

  // Takes up no more jobs and stops the running ones after their current step. They are queued again, for the next
  // process to go on from the checkpoint that was stored with one of their last frames. Jobs can still be submitted,
  // they wait too. Idempotent.
  void Drain();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_JOBS_JOB_MANAGER_H_
