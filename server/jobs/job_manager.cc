#include "server/jobs/job_manager.h"

#include <algorithm>
#include <condition_variable>
#include <map>
#include <mutex>
#include <set>
#include <thread>
#include <utility>

#include "server/jobs/active_job.h"
#include "server/jobs/crash_marks.h"
#include "server/jobs/job_id.h"
#include "server/jobs/job_run.h"
#include "server/jobs/lower_priority.h"
#include "server/jobs/notifier.h"
#include "server/jobs/verify_job.h"

namespace fascicle::server {
namespace {

const std::vector<JobState>& UnfinishedStates() {
  static const std::vector<JobState> states = {JobState::kQueued, JobState::kStarting, JobState::kRunning,
                                               JobState::kCancelling};
  return states;
}

std::string NewestId(Store& store) {
  const std::vector<JobRecord> newest = store.ListJobs(1, "", {});
  return newest.empty() ? std::string() : newest.front().id;
}

// A job whose thread crashed the process is its cause; one that merely ran when the process was killed may be. A job
// ends when it was the cause twice at the same place, or ran at twenty such ends without any progress in between.
constexpr std::int64_t kScoreOfCrash = 10, kScoreOfKill = 1, kMostScore = 20;

// Ends the job if it seems to crash the process whenever it is run.
void NoteCrash(const JobManagerOptions& options, const JobCodec& codec, JobRecord& record) {
  const auto& crashes = options.crashes;
  const bool is_cause = std::find(crashes.begin(), crashes.end(), record.id) != crashes.end();
  // Frames are counted when they are stored, steps about once a second.
  const std::int64_t place = record.step + record.frame_count;
  if (place > record.crash_place) record.crash_score = 0;
  record.crash_place = place;
  record.crash_score += is_cause ? kScoreOfCrash : kScoreOfKill;
  if (record.crash_score < kMostScore) return;
  Failure failure;
  failure.reason = "CRASHED";
  failure.message = "the server ended again and again while it ran this job";
  failure.step = record.step;
  failure.time = record.time;
  failure.advice = "a smaller model, or another linear solver, may need less memory; the server's log may say more";
  record.state = JobState::kFailed;
  record.failure = codec.encode_failure(failure);
  record.end_time_us = UnixTimeUs();
}

// Takes over a job that another process left unfinished: queues it again, or ends it.
void Resume(Store& store, const JobManagerOptions& options, const JobCodec& codec, JobRecord& record) {
  if (record.state == JobState::kQueued) return;
  const bool is_cancelled = record.state == JobState::kCancelling;
  try {
    if (const std::shared_ptr<FrameStore> frames = store.OpenFrames(record.id)) {
      record.frame_count = frames->frame_count();
      record.stored_bytes = frames->stored_bytes();
    }
  } catch (const StoreError&) {
    // A damaged file makes its own job fail, when that is started, and nothing else.
  }
  record.state = is_cancelled ? JobState::kCancelled : JobState::kQueued;
  if (is_cancelled) record.end_time_us = UnixTimeUs();
  if (!is_cancelled) NoteCrash(options, codec, record);
  store.UpdateJob(record);
}

}  // namespace

struct JobManager::Impl {
  Impl(Store& the_store, JobCodec the_codec, JobManagerOptions the_options)
      : store(the_store), codec(std::move(the_codec)), options(the_options), ids(NewestId(the_store)) {
    TakeUpUnfinished();
    for (int i = 0; i < options.workers; ++i) workers.emplace_back([this] { Work(); });
  }

  ~Impl() { Drain(); }

  void TakeUpUnfinished() {
    constexpr int kPage = 500;
    std::string before;
    while (true) {
      std::vector<JobRecord> page = store.ListJobs(kPage, before, UnfinishedStates());
      if (page.empty()) return;
      before = page.back().id;
      for (JobRecord& record : page) {
        Resume(store, options, codec, record);
        options.on_event(record, EventOf(record.state));
        if (!IsFinal(record.state)) Enqueue(std::move(record), nullptr);
      }
    }
  }

  void Enqueue(JobRecord record, std::shared_ptr<const Scene> scene) {
    auto job = std::make_shared<ActiveJob>(store, std::move(record));
    {
      const std::lock_guard lock(mutex);
      if (scene != nullptr && with_scene.size() < static_cast<std::size_t>(std::max(1, options.workers))) {
        job->SetScene(std::move(scene));
        with_scene.insert(job->id());
      }
      queue.insert(job->id());
      active[job->id()] = job;
    }
    queue_changed.notify_one();
  }

  std::shared_ptr<ActiveJob> FindActive(std::string_view id) {
    const std::lock_guard lock(mutex);
    const auto found = active.find(id);
    return found == active.end() ? nullptr : found->second;
  }

  void Forget(std::string_view id) {
    const std::lock_guard lock(mutex);
    if (const auto found = queue.find(id); found != queue.end()) queue.erase(found);
    if (const auto found = with_scene.find(id); found != with_scene.end()) with_scene.erase(found);
    if (const auto found = active.find(id); found != active.end()) active.erase(found);
  }

  // The current record, where `stored` was read after `job` was looked up.
  JobView View(const std::shared_ptr<ActiveJob>& job, JobRecord stored) {
    if (job == nullptr) return ViewOf(std::move(stored));
    JobView view = job->View(std::move(stored));
    const std::lock_guard lock(mutex);
    const auto place = queue.find(view.record.id);
    if (place != queue.end()) view.queue_position = static_cast<int>(std::distance(queue.begin(), place));
    return view;
  }

  // Waits for the next job; null when there will be none.
  std::shared_ptr<ActiveJob> TakeNext() {
    std::unique_lock lock(mutex);
    queue_changed.wait(lock, [this] { return is_draining || !queue.empty(); });
    if (is_draining) return nullptr;
    const std::string id = *queue.begin();
    queue.erase(queue.begin());
    with_scene.erase(id);
    return *running.insert(active.at(id)).first;
  }

  void Work() {
    LowerPriority(options.niceness);
    while (const std::shared_ptr<ActiveJob> job = TakeNext()) {
      const JobOnThisThread mark(job->id());
      RunJob({store, codec, options, drain.get_token()}, *job, [this, &job] { notifier.Notify(job->id()); });
      const bool is_final = IsFinal(job->record().state);
      const std::lock_guard lock(mutex);
      running.erase(job);
      if (is_final) active.erase(job->id());
    }
  }

  void Drain() {
    const std::lock_guard drain_lock(drain_mutex);
    {
      const std::lock_guard lock(mutex);
      is_draining = true;
      drain.request_stop();
      for (const std::shared_ptr<ActiveJob>& job : running) job->RequestStop();
    }
    queue_changed.notify_all();
    for (std::thread& worker : workers) worker.join();
    workers.clear();
  }

  Store& store;
  const JobCodec codec;
  const JobManagerOptions options;
  JobIdGenerator ids;
  Notifier notifier;

  std::mutex mutex;  // guards the members below; never held during disk access
  std::condition_variable queue_changed;
  std::map<std::string, std::shared_ptr<ActiveJob>, std::less<>> active;
  std::set<std::string, std::less<>> queue;       // in the order of creation; all of them active
  std::set<std::string, std::less<>> with_scene;  // those of the queue that have their scene
  std::set<std::shared_ptr<ActiveJob>> running;   // with a worker
  bool is_draining = false;

  std::stop_source drain;
  std::mutex restart_mutex;  // serializes restarts

  std::mutex drain_mutex;  // serializes drains; guards workers
  std::vector<std::thread> workers;
};

JobManager::JobManager(Store& store, JobCodec codec, JobManagerOptions options)
    : impl_(std::make_unique<Impl>(store, std::move(codec), options)) {}

JobManager::~JobManager() = default;

JobView JobManager::Submit(JobRecord record, bool* repeated, std::shared_ptr<const Scene> scene) {
  record.create_time_us = UnixTimeUs();
  record.id = impl_->ids.Next(record.create_time_us / 1000);
  record.state = JobState::kQueued;
  JobRecord existing;
  const bool is_new = impl_->store.CreateJob(record, &existing);
  if (repeated != nullptr) *repeated = !is_new;
  if (!is_new) return impl_->View(impl_->FindActive(existing.id), std::move(existing));
  impl_->options.on_event(record, "accepted");
  impl_->Enqueue(record, std::move(scene));
  impl_->notifier.Notify(record.id);
  return impl_->View(impl_->FindActive(record.id), std::move(record));
}

std::optional<JobView> JobManager::Get(std::string_view id) {
  const std::shared_ptr<ActiveJob> job = impl_->FindActive(id);
  std::optional<JobRecord> record = impl_->store.GetJob(id);
  if (!record) return std::nullopt;
  return impl_->View(job, *std::move(record));
}

std::vector<JobView> JobManager::List(int limit, std::string_view before_id, const std::vector<JobState>& states) {
  std::map<std::string, std::shared_ptr<ActiveJob>, std::less<>> active;
  {
    const std::lock_guard lock(impl_->mutex);
    active = impl_->active;
  }
  std::vector<JobView> views;
  for (JobRecord& record : impl_->store.ListJobs(limit, before_id, states)) {
    const auto found = active.find(record.id);
    views.push_back(impl_->View(found == active.end() ? nullptr : found->second, std::move(record)));
  }
  return views;
}

std::optional<JobView> JobManager::Cancel(std::string_view id) {
  std::shared_ptr<ActiveJob> job;
  while ((job = impl_->FindActive(id)) == nullptr) {
    std::optional<JobView> view = Get(id);
    if (!view || IsFinal(view->record.state)) return view;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));  // stored, and about to be queued by Submit
  }
  job->Update([](JobRecord& record) {
    if (IsFinal(record.state) || record.state == JobState::kCancelling) return false;
    const bool is_queued = record.state == JobState::kQueued;
    record.state = is_queued ? JobState::kCancelled : JobState::kCancelling;
    if (is_queued) record.end_time_us = UnixTimeUs();
    return true;
  });
  job->RequestStop();
  std::optional<JobView> view = Get(id);
  impl_->options.on_event(job->record(), EventOf(job->record().state));
  if (job->record().state == JobState::kCancelled) impl_->Forget(id);
  impl_->notifier.Notify(id);
  return view;
}

JobManager::DeleteResult JobManager::Delete(std::string_view id) {
  JobRecord record;
  if (const std::shared_ptr<ActiveJob> job = impl_->FindActive(id)) {
    record = job->record();
  } else {
    std::optional<JobRecord> stored = impl_->store.GetJob(id);
    if (!stored) return DeleteResult::kNotFound;
    record = *std::move(stored);
  }
  if (!IsFinal(record.state)) return DeleteResult::kActive;  // perhaps accepted a moment ago
  const bool is_deleted = impl_->store.DeleteJob(id);
  if (is_deleted) impl_->options.on_event(record, "deleted");
  impl_->Forget(id);
  impl_->notifier.Notify(id);
  return is_deleted ? DeleteResult::kDeleted : DeleteResult::kNotFound;
}

JobManager::RestartResult JobManager::Restart(std::string_view id, bool from_start) {
  const std::lock_guard lock(impl_->restart_mutex);
  if (impl_->FindActive(id) != nullptr) return RestartResult::kActive;
  std::optional<JobRecord> record = impl_->store.GetJob(id);
  if (!record) return RestartResult::kNotFound;
  if (!IsFinal(record->state)) return RestartResult::kActive;
  if (from_start) {
    if (const std::shared_ptr<FrameStore> frames = impl_->store.OpenFrames(id)) frames->DropCheckpoints();
  }
  record->state = JobState::kQueued;
  record->failure.clear();
  record->warnings.clear();
  record->end_time_us = 0;
  record->crash_score = 0;
  impl_->store.UpdateJob(*record);
  impl_->options.on_event(*record, EventOf(record->state));
  impl_->Enqueue(*std::move(record), nullptr);
  impl_->notifier.Notify(id);
  return RestartResult::kRestarted;
}

std::optional<JobCheck> JobManager::Verify(std::string_view id, const std::stop_token& stop) {
  std::int64_t frames = 0;
  std::vector<std::string> damages;
  try {
    const std::optional<JobRecord> record = impl_->store.GetJob(id);
    if (!record) return std::nullopt;
    if (IsFinal(record->state)) frames = record->frame_count;
  } catch (const DamageError& error) {
    damages.emplace_back(error.what());
  }
  JobCheck check = VerifyFrames(impl_->store, id, frames, stop);
  check.damages.insert(check.damages.begin(), damages.begin(), damages.end());
  return check;
}

std::shared_ptr<FrameStore> JobManager::Frames(std::string_view id) {
  if (const std::shared_ptr<ActiveJob> job = impl_->FindActive(id)) {
    if (std::shared_ptr<FrameStore> frames = job->frames()) return frames;
  }
  return impl_->store.OpenFrames(id);
}

JobManager::Subscription JobManager::Subscribe(std::string_view id, std::function<void()> listener) {
  return impl_->notifier.Subscribe(id, std::move(listener));
}

void JobManager::Drain() { impl_->Drain(); }

}  // namespace fascicle::server
