#ifndef FASCICLE_SERVER_JOBS_ACTIVE_JOB_H_
#define FASCICLE_SERVER_JOBS_ACTIVE_JOB_H_

#include <functional>
#include <memory>
#include <mutex>
#include <stop_token>
#include <string>
#include <string_view>

#include "core/scene/scene.h"
#include "core/sim/simulation.h"
#include "server/jobs/eta.h"
#include "server/jobs/job_manager.h"
#include "server/jobs/job_steering.h"
#include "server/store/store.h"

namespace fascicle::server {

// A job that has not ended: its record, and data that changes too often to be stored every time. Thread-safe.
class ActiveJob {
 public:
  // `record` is kept without its spec.
  ActiveJob(Store& store, JobRecord record);

  const std::string& id() const { return id_; }
  // That it asks for; 0: the default.
  int wanted_threads() const { return wanted_threads_; }
  JobRecord record() const;

  // Applies `change` to the record with its current progress and counts. The record is stored before others can see it.
  // If `change` returns false, nothing happens. Throws StoreError; the record is then unchanged.
  using Change = std::function<bool(JobRecord&)>;
  void Update(const Change& change);

  // Takes labels, priority, ttl and pin of a record that is stored.
  void SetSettings(const JobRecord& stored);

  // Called in every step; cheap.
  void SetProgress(const Progress& progress);
  // Why the run does not go on at present, for users; empty if it does.
  void SetWaiting(const std::string& why);
  void SetFrames(std::shared_ptr<FrameStore> frames);
  std::shared_ptr<FrameStore> frames() const;
  // The job's scene if it exists already; can be taken once.
  void SetScene(std::shared_ptr<const Scene> scene);
  std::shared_ptr<const Scene> TakeScene();

  // The inputs of the job.
  JobSteering& steering() { return steering_; }

  // The record of this object, with spec, settings and revision of `stored`, completed by the data in memory;
  // queue_position stays 0.
  JobView View(JobRecord stored) const;
  // The same for `stored` as it is.
  JobView ViewStored(JobRecord stored) const;

  void RequestStop() { stop_.request_stop(); }
  std::stop_token stop_token() const { return stop_.get_token(); }

 private:
  void FillIn(JobRecord& record) const;       // progress and counts; needs mutex_
  JobView ViewWithProgress(JobRecord) const;  // needs mutex_

  Store& store_;
  const std::string id_;
  const int wanted_threads_;
  std::stop_source stop_;
  std::mutex update_mutex_;   // one update at a time; taken before mutex_
  mutable std::mutex mutex_;  // guards the members below; never held during disk access
  JobRecord record_;
  Progress progress_;
  EtaEstimator eta_;
  std::string waiting_;
  std::shared_ptr<FrameStore> frames_;
  std::shared_ptr<const Scene> scene_;
  JobSteering steering_;
};

// The view of a record whose job is not active.
JobView ViewOf(JobRecord record);

// What has happened to a job that is in this state now, for a log.
std::string_view EventOf(JobState state);

// Whether a job stays in this state until somebody asks for something else: final, or paused.
bool IsAtRest(JobState state);

// Time since the Unix epoch [us].
std::int64_t UnixTimeUs();

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_JOBS_ACTIVE_JOB_H_
