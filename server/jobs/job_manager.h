#ifndef FASCICLE_SERVER_JOBS_JOB_MANAGER_H_
#define FASCICLE_SERVER_JOBS_JOB_MANAGER_H_

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <stdexcept>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/problems.h"
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
  // Keeps what `earlier` ones tell beside warnings: where the job was imported from. Empty if there is nothing to tell.
  std::function<std::string(const std::vector<Warning>&, const std::string& earlier)> encode_warnings;
  // The sum of this run and the earlier ones.
  std::function<std::string(const RunProfile&)> encode_profile;
  std::function<std::string(const LogLine&)> encode_line;
  // The inputs that a job's spec has already, with the sequence numbers 1, 2, ...
  std::function<std::vector<SteeringRecord>(const std::string& spec)> inputs_of_spec;
  // What the inputs of a job change in its scene.
  std::function<std::vector<SteeringInput>(const std::string& spec, const std::vector<SteeringRecord>& inputs)>
      decode_inputs;
  // Digests of the assets that a spec names. Throws std::runtime_error if it can't be read. May be empty: assets are
  // then never removed.
  std::function<std::set<std::string>(const std::string& spec)> assets_of = nullptr;
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
  // Whether jobs get as many threads as they ask for, up to the number of cores, whatever else runs.
  bool oversubscribe = false;
  int max_queued_per_owner = 0;           // 0: no limit, here and below
  int max_running_per_owner = 0;          // more of them wait
  std::int64_t max_stored_per_owner = 0;  // new jobs are refused beyond it [byte]
  std::int64_t default_ttl_s = 0;         // after its end, a job without a ttl is kept so long [s]; 0: for ever
  std::int64_t disk_budget = 0;           // for frames and geometry [byte]
  std::chrono::milliseconds retention_interval = std::chrono::seconds(10);  // between looks for what can be removed
  // Told what belongs to no single job: assets that were removed, failures to remove something. From another thread.
  std::function<void(const std::string& note)> on_note = [](const std::string&) {};
};

// A limit of an owner does not allow another job. what() says what to do.
class OwnerLimitError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
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
  int threads = 0;  // with which it is run now; 0 if it is not
};

// A job that a client asked for.
struct SubmittedJob {
  JobView view;
  bool is_repeated = false;  // there was one for the same request already
};

// As JobChanges.
struct JobChangeViews {
  std::vector<JobView> changed;
  std::vector<std::string> deleted;
  std::int64_t revision = 0;
};

// What the workers do now.
struct WorkLoad {
  int running = 0;  // jobs
  int threads = 0;  // of these
  int queued = 0;   // jobs
};

// What Verify found.
struct JobCheck {
  std::int64_t frames = 0;
  std::int64_t bytes = 0;  // of frames and geometry
  std::vector<std::string> damages;
};

// An input of a client. Without a step and a time it takes effect with the next step.
struct SteeringRequest {
  std::int64_t sequence = 0;
  std::string input;                     // serialized contents, opaque here
  std::vector<SteeredControl> controls;  // the same for the run
  double ramp = 0;                       // [s]
  std::optional<std::int64_t> at_step;
  std::optional<double> at_time;  // [s]
};

// What became of it.
struct SteeringAnswer {
  std::optional<SteeringRecord> record;  // as it is stored; nothing if it was refused, or only checked
  // Why it was refused: each with its field, and the reason of the first, for programs.
  Problems problems;
  std::string reason;  // SEQUENCE_REUSED, SEQUENCE_GAP, STEP_PASSED, JOB_ENDED, TOO_MANY_INPUTS
};

// The inputs of a job.
struct SteeringList {
  std::vector<SteeringRecord> inputs;
  std::int64_t next_sequence = 1;
  std::int64_t reached_step = 0;  // the last step that the run has begun or made
};

// The queue and its workers. With workers, also removes what need not be kept (retention.h). Resumes jobs that were
// queued or running when the last process ended. Thread-safe; all functions may block on disk and throw StoreError. An
// error within a job ends that job only.
class JobManager {
 public:
  // `store` must outlive this object. Throws StoreError if stored jobs can't be read.
  JobManager(Store& store, JobCodec codec, JobManagerOptions options);
  // Drains; the next process continues unfinished jobs.
  ~JobManager();

  // Creates jobs: all of them, durably, or none. `records` have spec, scene_name, threads, owner, settings, request_id,
  // request_digest and the profile so far set. Returns the new jobs, or the earlier ones for the same requests, in the
  // same order. Throws OwnerLimitError, and RequestReusedError as JobStore::CreateJobs. `first_scene` is the scene of
  // the first spec, so that the worker need not decode it. Scenes are kept for at most as many waiting jobs as there
  // are workers.
  std::vector<SubmittedJob> Submit(std::vector<JobRecord> records, std::shared_ptr<const Scene> first_scene = nullptr);
  // The same for one job. `repeated` may be null.
  JobView Submit(JobRecord record, bool* repeated, std::shared_ptr<const Scene> scene = nullptr);
  // Takes over a job that another server ran: an id and its empty frame store, which is filled before AddFinished makes
  // it a job. The id is `wanted` if that could be one of this server's own and is free, otherwise a new one. Of the
  // record, owner and request id are read. Throws OwnerLimitError.
  struct Staged {
    std::string id;
    std::shared_ptr<FrameStore> frames;
  };
  Staged Stage(const std::string& wanted, const JobRecord& record);
  // Adds the job of a staged id. `record` is complete and in a final state. Returns it, or the earlier job with the
  // same request id. Throws RequestReusedError.
  JobView AddFinished(const JobRecord& record);
  std::optional<JobView> Get(std::string_view id);
  // Jobs newest first: ids below `before_id` (empty: from the newest), states in `states` (empty: all).
  std::vector<JobView> List(int limit, std::string_view before_id, const std::vector<JobState>& states);
  // Records are as stored, so that they pass the filter.
  std::vector<JobView> Find(const JobQuery& query);
  // As JobStore::ChangesAfter.
  std::optional<JobChangeViews> ChangesAfter(std::int64_t revision, std::int64_t deletions_after, int limit);
  std::int64_t Revision();
  WorkLoad Load();
  // Applies `change` to labels, priority, ttl and pin. Returns nothing if there is no such job.
  std::optional<JobView> ChangeSettings(std::string_view id, const std::function<void(JobRecord&)>& change);
  // Takes a job from the queue, or asks it to stop, until Resume; one that is final, being cancelled or paused stays as
  // it is. A paused job needs no worker, and goes on from its last checkpoint. Returns nothing if there is no such job.
  std::optional<JobView> Pause(std::string_view id);
  // Queues a paused job again; any other stays as it is. Returns nothing if there is no such job.
  std::optional<JobView> Resume(std::string_view id);
  // Asks the job to stop; a final job stays as it is. Returns nothing if there is no such job.
  std::optional<JobView> Cancel(std::string_view id);
  enum class DeleteResult { kDeleted, kNotFound, kActive };
  DeleteResult Delete(std::string_view id);
  // Queues a job in a final state again, from its last checkpoint or from the start. Frames that come out the same stay
  // as they are; damaged and removed ones are replaced. Throws OwnerLimitError.
  enum class RestartResult { kRestarted, kNotFound, kActive };
  RestartResult Restart(std::string_view id, bool from_start);
  // Reads everything that is stored of a job, and describes what is damaged. Throws Stopped. Nothing if there is no
  // such job.
  std::optional<JobCheck> Verify(std::string_view id, const std::stop_token& stop);
  // Adds an input to a job that has not ended; `check_only`: only says what is wrong with it. Durable on return.
  // Nothing if there is no such job.
  std::optional<SteeringAnswer> Steer(std::string_view id, const SteeringRequest& request, bool check_only);
  // Inputs with sequence >= start, at most `limit`. Nothing if there is no such job.
  std::optional<SteeringList> ListSteering(std::string_view id, std::int64_t start, int limit);
  // The frames of a job; null if there is no such job.
  std::shared_ptr<FrameStore> Frames(std::string_view id);

  // Calls `listener` whenever the job has a new geometry, frame, state or settings, or has been deleted, after that was
  // stored; with an empty id, whenever any job has a new state or settings, or has been added or deleted.
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
