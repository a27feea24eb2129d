#ifndef FASCICLE_SERVER_JOBS_JOB_MANAGER_H_
#define FASCICLE_SERVER_JOBS_JOB_MANAGER_H_

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/profile.h"
#include "core/scene/scene.h"
#include "core/sim/simulation.h"
#include "server/store/store.h"

namespace fascicle::server {

// Profiles of a run.
struct RunProfile {
  Profile working;               // of the worker
  Profile storing = Profile(0);  // of the thread that stores frames
  std::string earlier;           // encoded profile of the job's earlier runs; empty if there were none
};

// Conversions between jobs and bytes. Provided by server/translate, so that this room knows no wire format. Called from
// several threads at once. Exceptions make the job fail with reason INTERNAL (StoreError: STORAGE).
struct JobCodec {
  // Builds the scene of a job's spec. Assets are read from `assets`; stages are timed in `profile`. Throws
  // std::runtime_error if the scene can't be built any more (an asset was lost), and Stopped after a stop request.
  std::function<std::shared_ptr<const Scene>(const std::string& spec, AssetStore& assets, Profile* profile,
                                             const std::stop_token& stop)>
      decode_scene;
  std::function<std::string(const Scene&, const FrameLayout&)> encode_geometry;
  std::function<std::string(const Frame&)> encode_frame;
  std::function<std::string(const Failure&)> encode_failure;
  std::function<std::string(const std::vector<Warning>&)> encode_warnings;  // empty if there are none
  // The sum of this run and the earlier ones.
  std::function<std::string(const RunProfile&)> encode_profile;
};

struct JobManagerOptions {
  int workers = 2;          // number of jobs that run at once; 0: jobs stay in the queue
  int default_threads = 1;  // for jobs that ask for 0
  std::chrono::milliseconds checkpoint_interval = std::chrono::seconds(2);
  // Told of the life of each job: "accepted", "started", "succeeded" and so on. Called from several threads at once,
  // after the change was stored.
  std::function<void(const JobRecord& job, std::string_view event)> on_event = [](const JobRecord&, std::string_view) {
  };
  int niceness = 0;                       // of the threads that run jobs, beyond that of the others
  std::vector<std::string> crashes = {};  // ids of the jobs whose threads crashed the last process; see crash_marks.h
};

// The current state of a job: the stored record, completed by data that only this process has.
struct JobView {
  JobRecord record;
  Progress progress;
  double eta_seconds = -1;  // negative: unknown
  std::string waiting;      // why the run does not go on at present, for users; empty if it does
  int queue_position = 0;   // number of jobs before it; for kQueued only
  std::int64_t frame_count = 0;
  std::int64_t stored_bytes = 0;
};

// What Verify found.
struct JobCheck {
  std::int64_t frames = 0;
  std::int64_t bytes = 0;  // of frames and geometry
  std::vector<std::string> damages;
};

// The queue and its workers. Resumes jobs that were queued or running when the last process ended. Thread-safe; all
// functions may block on disk and throw StoreError. An error within a job ends that job only.
class JobManager {
 public:
  // `store` must outlive this object. Throws StoreError if stored jobs can't be read.
  JobManager(Store& store, JobCodec codec, JobManagerOptions options);
  // Drains; the next process continues unfinished jobs.
  ~JobManager();

  // `record` has spec, scene_name, threads, request_id, request_digest and the profile so far set. Returns the new job,
  // or the earlier one with the same request id (then `*repeated` is true; the caller compares request_digest). The job
  // is durable on return. `scene` is the scene of the spec, so that the worker need not decode it. Scenes are kept for
  // at most as many waiting jobs as there are workers.
  JobView Submit(JobRecord record, bool* repeated, std::shared_ptr<const Scene> scene = nullptr);
  std::optional<JobView> Get(std::string_view id);
  std::vector<JobView> List(int limit, std::string_view before_id, const std::vector<JobState>& states);
  // Asks the job to stop; a final job stays as it is. Returns nothing if there is no such job.
  std::optional<JobView> Cancel(std::string_view id);
  enum class DeleteResult { kDeleted, kNotFound, kActive };
  DeleteResult Delete(std::string_view id);
  // Queues a job in a final state again, from its last checkpoint or from the start. Frames that come out the same stay
  // as they are; damaged ones are replaced.
  enum class RestartResult { kRestarted, kNotFound, kActive };
  RestartResult Restart(std::string_view id, bool from_start);
  // Reads everything that is stored of a job, and describes what is damaged. Throws Stopped. Nothing if there is no
  // such job.
  std::optional<JobCheck> Verify(std::string_view id, const std::stop_token& stop);
  // The frames of a job; null if there is no such job.
  std::shared_ptr<FrameStore> Frames(std::string_view id);

  // Calls `listener` whenever the job has a new geometry, frame or state, or has been deleted, after that was stored.
  // Calls come from an internal thread and without any lock; the listener must return quickly. Changes in quick
  // succession may be combined into one call. The listener is not called after the returned handle is destroyed.
  // Destroying it waits for a call in progress (unless the call itself does it), so do not destroy it while holding a
  // lock that the listener takes.
  using Subscription = std::shared_ptr<void>;
  Subscription Subscribe(std::string_view id, std::function<void()> listener);

  // Starts no more jobs and stops the running ones after their current step. They are queued again, so that the next
  // process continues from the checkpoint stored with one of their last frames. Jobs can still be submitted; they wait,
  // too. Idempotent.
  void Drain();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_JOBS_JOB_MANAGER_H_
