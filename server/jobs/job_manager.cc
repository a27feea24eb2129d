#include "server/jobs/job_manager.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <map>
#include <mutex>
#include <set>
#include <thread>
#include <utility>

#include "server/jobs/active_job.h"
#include "server/jobs/crash_marks.h"
#include "server/jobs/job_id.h"
#include "server/jobs/job_queue.h"
#include "server/jobs/job_run.h"
#include "server/jobs/lower_priority.h"
#include "server/jobs/notifier.h"
#include "server/jobs/retention.h"
#include "server/jobs/verify_job.h"

namespace fascicle::server {
namespace {

const std::vector<JobState>& UnfinishedStates() {
  static const std::vector<JobState> states = {JobState::kQueued, JobState::kStarting, JobState::kRunning,
                                               JobState::kCancelling, JobState::kPausing};
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

// Takes over a job that another process left unfinished: queues it again, pauses it or ends it.
void TakeUp(Store& store, const JobManagerOptions& options, const JobCodec& codec, JobRecord& record) {
  if (record.state == JobState::kQueued) return;
  const JobState left = record.state;
  try {
    if (const std::shared_ptr<FrameStore> frames = store.OpenFrames(record.id)) {
      record.frame_count = frames->frame_count();
      record.stored_bytes = frames->stored_bytes();
    }
  } catch (const StoreError&) {
    // A damaged file makes its own job fail, when that is started, and nothing else.
  }
  record.state = left == JobState::kCancelling ? JobState::kCancelled
                 : left == JobState::kPausing  ? JobState::kPaused
                                               : JobState::kQueued;
  if (IsFinal(record.state)) record.end_time_us = UnixTimeUs();
  if (record.state == JobState::kQueued) NoteCrash(options, codec, record);
  store.UpdateJob(record);
}

std::vector<std::string> OwnersOf(const std::vector<JobRecord>& jobs) {
  std::vector<std::string> owners;
  for (const JobRecord& job : jobs) owners.push_back(job.owner);
  return owners;
}

// Waits for another thread that has stored something and is about to do the rest.
void WaitBriefly() { std::this_thread::sleep_for(std::chrono::milliseconds(1)); }

int Cores() { return std::max(1, static_cast<int>(std::thread::hardware_concurrency())); }

}  // namespace

struct JobManager::Impl {
  Impl(Store& the_store, JobCodec the_codec, JobManagerOptions the_options)
      : store(the_store),
        codec(std::move(the_codec)),
        options(the_options),
        ids(NewestId(the_store)),
        queue(the_options.max_running_per_owner) {
    TakeUpUnfinished();
    for (int i = 0; i < options.workers; ++i) workers.emplace_back([this] { Work(); });
    if (options.workers == 0) return;
    retention.emplace(store, codec, options,
                      Retention::Actions{[this](const JobRecord& job) { DeleteExpired(job.id); },
                                         [this](const JobRecord& job) { return RemoveFrames(job.id); }});
  }

  ~Impl() {
    retention.reset();
    Drain();
  }

  void TakeUpUnfinished() {
    constexpr int kPage = 500;
    std::string before;
    while (true) {
      std::vector<JobRecord> page = store.ListJobs(kPage, before, UnfinishedStates());
      if (page.empty()) return;
      before = page.back().id;
      for (JobRecord& record : page) {
        TakeUp(store, options, codec, record);
        options.on_event(record, EventOf(record.state));
        if (record.state == JobState::kQueued) Enqueue(std::move(record), nullptr);
      }
    }
  }

  // While it exists, owners have more jobs in the queue. Throws OwnerLimitError if those are too many.
  class QueuePlaces {
   public:
    QueuePlaces(Impl& impl, const std::vector<std::string>& owners_of_jobs) : impl_(impl) {
      for (const std::string& owner : owners_of_jobs) ++counts_[owner];
      const std::lock_guard lock(impl_.mutex);
      for (const auto& [owner, count] : counts_) CheckRoom(owner, count);
      for (const auto& [owner, count] : counts_) impl_.coming[owner] += count;
    }
    ~QueuePlaces() {
      const std::lock_guard lock(impl_.mutex);
      for (const auto& [owner, count] : counts_) Subtract(impl_.coming, owner, count);
    }
    // When a job of an owner is in the queue itself; needs mutex.
    void GiveUpOne(const std::string& owner) {
      Subtract(impl_.coming, owner, 1);
      Subtract(counts_, owner, 1);
    }
    QueuePlaces(const QueuePlaces&) = delete;
    QueuePlaces& operator=(const QueuePlaces&) = delete;

   private:
    using Counts = std::map<std::string, int>;

    void CheckRoom(const std::string& owner, int count) const {
      const int most = impl_.options.max_queued_per_owner;
      const auto entry = impl_.coming.find(owner);
      const int others = impl_.queue.CountOf(owner) + (entry == impl_.coming.end() ? 0 : entry->second);
      if (most <= 0 || others + count <= most) return;
      throw OwnerLimitError("an owner may have " + std::to_string(most) + " jobs in the queue, " +
                            std::to_string(others) + " are there, and " + std::to_string(count) +
                            " more would come: wait until some have started, cancel some, or submit fewer at once");
    }
    static void Subtract(Counts& counts, const std::string& owner, int count) {
      const auto entry = counts.find(owner);
      if ((entry->second -= count) == 0) counts.erase(entry);
    }

    Impl& impl_;
    Counts counts_;  // of jobs that are not in the queue yet
  };

  // `places`: one of them is for this job; may be null.
  void Enqueue(JobRecord record, std::shared_ptr<const Scene> scene, QueuePlaces* places = nullptr) {
    const std::string owner = record.owner;
    const int priority = record.priority;
    auto job = std::make_shared<ActiveJob>(store, std::move(record));
    {
      const std::lock_guard lock(mutex);
      if (scene != nullptr && with_scene.size() < static_cast<std::size_t>(std::max(1, options.workers))) {
        job->SetScene(std::move(scene));
        with_scene.insert(job->id());
      }
      queue.Add(job->id(), owner, priority);
      if (places != nullptr) places->GiveUpOne(owner);
      active[job->id()] = job;
    }
    queue_changed.notify_one();
  }

  // Wakes those who listen to a job and, if its record has changed, those who listen to all jobs.
  void Tell(std::string_view id) {
    notifier.Notify(id);
    const std::int64_t revision = store.Revision();
    if (told_revision.exchange(revision) != revision) notifier.Notify("");
  }

  std::shared_ptr<ActiveJob> FindActive(std::string_view id) {
    const std::lock_guard lock(mutex);
    const auto found = active.find(id);
    return found == active.end() ? nullptr : found->second;
  }

  // Of a job that needs no worker any more.
  void Forget(const std::shared_ptr<ActiveJob>& job) {
    const std::lock_guard lock(mutex);
    queue.Remove(job->id());
    with_scene.erase(job->id());
    const auto found = active.find(job->id());
    if (found != active.end() && found->second == job) active.erase(found);
  }

  // The current record, where `stored` was read after `job` was looked up.
  JobView View(const std::shared_ptr<ActiveJob>& job, JobRecord stored) {
    if (job == nullptr) return ViewOf(std::move(stored));
    return WithPlace(job->View(std::move(stored)));
  }

  // Records as they are stored.
  std::vector<JobView> ViewsOf(std::vector<JobRecord> stored) {
    std::shared_ptr<const JobQueue::Places> places;
    {
      const std::lock_guard lock(mutex);
      places = queue.PlacesOfAll(JobQueue::Clock::now());
    }
    std::vector<JobView> views;
    for (JobRecord& record : stored) {
      const std::shared_ptr<ActiveJob> job = FindActive(record.id);
      views.push_back(job == nullptr ? ViewOf(std::move(record)) : job->ViewStored(std::move(record)));
      if (job == nullptr) continue;
      const auto place = places->find(job->id());
      if (place != places->end()) views.back().queue_position = place->second;
      const std::lock_guard lock(mutex);
      views.back().threads = queue.ThreadsOf(job->id());
    }
    return views;
  }

  JobView WithPlace(JobView view) {
    const std::lock_guard lock(mutex);
    view.queue_position = queue.PlaceOf(view.record.id, JobQueue::Clock::now());
    view.threads = queue.ThreadsOf(view.record.id);
    return view;
  }

  struct Task {
    std::shared_ptr<ActiveJob> job;  // null when there will be none
    int threads = 1;
  };

  // Waits for the next job.
  Task TakeNext() {
    std::unique_lock lock(mutex);
    std::optional<std::string> id;
    queue_changed.wait(lock, [&] {
      if (!is_draining) id = queue.Take(JobQueue::Clock::now());
      return is_draining || id;
    });
    if (!id) return {};
    with_scene.erase(*id);
    Task task = {active.at(*id)};
    task.threads = ThreadsFor(*task.job);
    queue.Started(*id, task.threads);
    running.insert(task.job);
    return task;
  }

  // Of a job that was just taken; needs mutex. All jobs together have no more threads than there are cores, one of
  // which is kept for each worker that waits, so that no job waits for the end of another.
  int ThreadsFor(const ActiveJob& job) const {
    const int wanted = std::min(job.wanted_threads() > 0 ? job.wanted_threads() : options.default_threads, Cores());
    if (options.oversubscribe) return wanted;
    const int waiting_workers = options.workers - queue.running();
    const int others = queue.threads_in_use() - 1;  // this one counts as one until it is started
    return std::clamp(Cores() - others - waiting_workers, 1, std::max(1, wanted));
  }

  void Work() {
    LowerPriority(options.niceness);
    while (true) {
      const Task task = TakeNext();
      if (task.job == nullptr) return;
      const JobOnThisThread mark(task.job->id());
      RunJob({store, codec, options, drain.get_token(), task.threads}, *task.job,
             [this, &task] { Tell(task.job->id()); });
      Leave(task.job);
    }
  }

  // A worker has done with a job, which has ended, is paused, was resumed while it was about to be paused, or is left
  // to the next process.
  void Leave(const std::shared_ptr<ActiveJob>& job) {
    JobRecord record = job->record();
    bool is_queued_again = false;
    {
      const std::lock_guard lock(mutex);
      queue.Stopped(job->id(), JobQueue::Clock::now());
      running.erase(job);
      is_queued_again = record.state == JobState::kQueued && !is_draining;
      const auto found = active.find(job->id());
      const bool is_over = is_queued_again || IsAtRest(record.state);
      if (is_over && found != active.end() && found->second == job) active.erase(found);
    }
    if (is_queued_again) Enqueue(std::move(record), nullptr);
  }

  bool IsWithWorker(std::string_view id) {
    const std::lock_guard lock(mutex);
    return active.find(id) != active.end() || queue.ThreadsOf(id) > 0;
  }

  bool IsHeld(std::string_view id) {
    const std::lock_guard lock(mutex);
    return held.contains(id);
  }

  // Makes a change of a job that is at rest: change(record), where the record is empty if there is no such job. Returns
  // false as long as the job is active or about to be, a worker has not left it yet, or its inputs are being stored.
  template <class Change>
  bool WhenInactive(std::string_view id, const Change& change) {
    const std::lock_guard lock(change_mutex);
    if (IsWithWorker(id) || IsHeld(id)) return false;
    std::optional<JobRecord> record = store.GetJob(id);
    if (record && !IsAtRest(record->state)) return false;
    change(std::move(record));
    return true;
  }

  // Stores a record and tells it.
  void Put(const JobRecord& record) {
    store.UpdateJob(record);
    options.on_event(record, EventOf(record.state));
  }

  void DeleteExpired(const std::string& id) {
    WhenInactive(id, [&](std::optional<JobRecord> record) {
      if (!record || !IsFinal(record->state) || record->is_pinned || !store.DeleteJob(id)) return;
      options.on_event(*record, "deleted, because it ended longer ago than jobs are kept");
      Tell(id);
    });
  }

  bool RemoveFrames(const std::string& id) {
    bool is_removed = false;
    WhenInactive(id, [&](std::optional<JobRecord> record) {
      if (!record || !IsFinal(record->state) || record->is_pinned) return;
      record->first_frame = record->frame_count;
      record->stored_bytes = 0;
      is_removed = store.RemoveFrames(*record);
      if (!is_removed) return;
      options.on_event(*record, "lost its frames, which were removed to make room");
      Tell(id);
    });
    return is_removed;
  }

  // Submit, when the owners' limits allow it.
  std::vector<SubmittedJob> Create(std::vector<JobRecord> records, std::shared_ptr<const Scene> first_scene,
                                   QueuePlaces& places) {
    for (JobRecord& record : records) {
      record.create_time_us = UnixTimeUs();
      record.id = ids.Next(record.create_time_us / 1000);
      record.state = JobState::kQueued;
    }
    std::vector<std::optional<JobRecord>> earlier = store.CreateJobs(records);
    for (std::size_t i = 0; i < records.size(); ++i) {
      if (earlier[i]) continue;
      options.on_event(records[i], "accepted");
      Enqueue(records[i], i == 0 ? std::move(first_scene) : nullptr, &places);
      Tell(records[i].id);
    }
    std::vector<SubmittedJob> submitted;
    for (std::size_t i = 0; i < records.size(); ++i) {
      JobRecord& record = earlier[i] ? *earlier[i] : records[i];
      const std::shared_ptr<ActiveJob> job = FindActive(record.id);
      submitted.push_back({View(job, std::move(record)), earlier[i].has_value()});
    }
    return submitted;
  }

  // The jobs that were created earlier for the requests of these; nothing unless all were.
  std::optional<std::vector<SubmittedJob>> FindRepeated(const std::vector<JobRecord>& wanted) {
    std::vector<SubmittedJob> jobs;
    for (const JobRecord& job : wanted) {
      std::optional<JobRecord> earlier = store.FindRequest(job.request_id);
      if (!earlier) return std::nullopt;
      if (earlier->request_digest != job.request_digest) throw RequestReusedError(job.request_id, earlier->id);
      const std::shared_ptr<ActiveJob> active_job = FindActive(earlier->id);
      jobs.push_back({View(active_job, *std::move(earlier)), true});
    }
    return jobs;
  }

  // Throws OwnerLimitError.
  void CheckStored(const std::string& owner) {
    const std::int64_t most = options.max_stored_per_owner;
    if (most <= 0) return;
    const std::int64_t stored = store.StoredBytesOf(owner);
    if (stored < most) return;
    throw OwnerLimitError("the owner's jobs have stored " + std::to_string(stored) + " bytes, the most are " +
                          std::to_string(most) + ": delete some of them");
  }

  // Keeps a job at rest where it is while its inputs are read or stored, without `change_mutex`.
  class Hold {
   public:
    Hold() = default;
    ~Hold() {
      if (impl_ == nullptr) return;
      const std::lock_guard lock(impl_->mutex);
      impl_->held.erase(id_);
    }
    Hold(const Hold&) = delete;
    Hold& operator=(const Hold&) = delete;

    // False if another one holds it; needs `change_mutex`.
    bool Take(Impl& impl, std::string_view id) {
      const std::lock_guard lock(impl.mutex);
      if (!impl.held.insert(std::string(id)).second) return false;
      impl_ = &impl;
      id_ = id;
      return true;
    }

   private:
    Impl* impl_ = nullptr;
    std::string id_;
  };

  // Calls use(inputs of the job) and returns its result; nothing if there is no such job. Those of a job that has ended
  // are closed.
  template <class Use>
  auto WithSteering(std::string_view id, const Use& use) -> std::optional<decltype(use(std::declval<JobSteering&>()))> {
    while (true) {
      const std::shared_ptr<ActiveJob> job = FindActive(id);
      Hold hold;
      std::optional<JobRecord> record;
      {
        std::unique_lock rest(change_mutex, std::defer_lock);
        if (job == nullptr) rest.lock();
        record = store.GetJob(id);
        if (!record) return std::nullopt;
        if (job == nullptr && (!IsAtRest(record->state) || IsWithWorker(id) || !hold.Take(*this, id))) {
          rest.unlock();
          WaitBriefly();
          continue;
        }
      }
      JobSteering resting;
      JobSteering& steering = job == nullptr ? resting : job->steering();
      if (job == nullptr && IsFinal(record->state)) resting.Close();
      std::shared_ptr<FrameStore> frames = job == nullptr ? nullptr : job->frames();
      if (frames == nullptr) frames = store.OpenFrames(id);
      if (frames == nullptr) return std::nullopt;
      steering.Open(std::move(frames), record->spec, codec);
      return use(steering);
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
  std::atomic<std::int64_t> told_revision = 0;

  std::mutex mutex;  // guards the members below; never held during disk access
  std::condition_variable queue_changed;
  std::map<std::string, std::shared_ptr<ActiveJob>, std::less<>> active;
  JobQueue queue;                                 // all of them active
  std::map<std::string, int> coming;              // jobs of an owner that are being stored
  std::set<std::string, std::less<>> with_scene;  // those of the queue that have their scene
  std::set<std::shared_ptr<ActiveJob>> running;   // with a worker
  std::set<std::string, std::less<>> held;        // jobs at rest that stay so; see Hold
  bool is_draining = false;

  std::stop_source drain;
  // Serializes changes of jobs that are not active, and of settings. Taken before all others.
  std::mutex change_mutex;

  std::mutex drain_mutex;  // serializes drains; guards workers
  std::vector<std::thread> workers;
  std::optional<Retention> retention;
};

JobManager::JobManager(Store& store, JobCodec codec, JobManagerOptions options)
    : impl_(std::make_unique<Impl>(store, std::move(codec), options)) {}

JobManager::~JobManager() = default;

std::vector<SubmittedJob> JobManager::Submit(std::vector<JobRecord> records, std::shared_ptr<const Scene> first_scene) {
  std::optional<Impl::QueuePlaces> places;
  try {
    const std::vector<std::string> owners = OwnersOf(records);
    for (const std::string& owner : std::set<std::string>(owners.begin(), owners.end())) impl_->CheckStored(owner);
    places.emplace(*impl_, owners);
  } catch (const OwnerLimitError&) {
    // A repeated request makes no new job.
    std::optional<std::vector<SubmittedJob>> repeated = impl_->FindRepeated(records);
    if (!repeated) throw;
    return *std::move(repeated);
  }
  return impl_->Create(std::move(records), std::move(first_scene), *places);
}

JobView JobManager::Submit(JobRecord record, bool* repeated, std::shared_ptr<const Scene> scene) {
  std::vector<JobRecord> records;
  records.push_back(std::move(record));
  SubmittedJob job = std::move(Submit(std::move(records), std::move(scene)).front());
  if (repeated != nullptr) *repeated = job.is_repeated;
  return std::move(job.view);
}

JobManager::Staged JobManager::Stage(const std::string& wanted, const JobRecord& record) {
  // A repeated request makes no new job.
  if (record.request_id.empty() || !impl_->store.FindRequest(record.request_id)) impl_->CheckStored(record.owner);
  const std::int64_t now_ms = UnixTimeUs() / 1000;
  // A later id would come before all that this server will make.
  std::string id = IsPastJobId(wanted, now_ms) ? wanted : impl_->ids.Next(now_ms);
  std::shared_ptr<FrameStore> frames = impl_->store.StageFrames(id);
  while (frames == nullptr) {
    id = impl_->ids.Next(now_ms);
    frames = impl_->store.StageFrames(id);
  }
  return {std::move(id), std::move(frames)};
}

JobView JobManager::AddFinished(const JobRecord& record) {
  JobRecord existing;
  if (!impl_->store.CreateJob(record, &existing)) {
    return impl_->View(impl_->FindActive(existing.id), std::move(existing));
  }
  impl_->options.on_event(record, "imported");
  impl_->Tell(record.id);
  return impl_->View(nullptr, record);
}

std::optional<JobView> JobManager::Get(std::string_view id) {
  const std::shared_ptr<ActiveJob> job = impl_->FindActive(id);
  std::optional<JobRecord> record = impl_->store.GetJob(id);
  if (!record) return std::nullopt;
  return impl_->View(job, *std::move(record));
}

std::vector<JobView> JobManager::List(int limit, std::string_view before_id, const std::vector<JobState>& states) {
  return impl_->ViewsOf(impl_->store.ListJobs(limit, before_id, states));
}

std::vector<JobView> JobManager::Find(const JobQuery& query) { return impl_->ViewsOf(impl_->store.FindJobs(query)); }

std::optional<JobChangeViews> JobManager::ChangesAfter(std::int64_t revision, std::int64_t deletions_after, int limit) {
  std::optional<JobChanges> changes = impl_->store.ChangesAfter(revision, deletions_after, limit);
  if (!changes) return std::nullopt;
  return JobChangeViews{impl_->ViewsOf(std::move(changes->changed)), std::move(changes->deleted), changes->revision};
}

std::int64_t JobManager::Revision() { return impl_->store.Revision(); }

WorkLoad JobManager::Load() {
  const std::lock_guard lock(impl_->mutex);
  return {impl_->queue.running(), impl_->queue.threads_in_use(), impl_->queue.size()};
}

std::optional<JobView> JobManager::ChangeSettings(std::string_view id, const std::function<void(JobRecord&)>& change) {
  {
    const std::lock_guard lock(impl_->change_mutex);
    std::optional<JobRecord> record = impl_->store.GetJob(id);
    if (!record) return std::nullopt;
    change(*record);
    if (!impl_->store.UpdateSettings(*record)) return std::nullopt;
    if (const std::shared_ptr<ActiveJob> job = impl_->FindActive(id)) job->SetSettings(*record);
    const std::lock_guard queue_lock(impl_->mutex);
    impl_->queue.SetPriority(id, record->priority);
  }
  impl_->queue_changed.notify_all();
  impl_->Tell(id);
  return Get(id);
}

std::optional<JobView> JobManager::Cancel(std::string_view id) {
  while (true) {
    if (const std::shared_ptr<ActiveJob> job = impl_->FindActive(id)) {
      bool is_paused = false;
      job->Update([&](JobRecord& record) {
        is_paused = record.state == JobState::kPaused;
        if (IsAtRest(record.state) || record.state == JobState::kCancelling) return false;
        const bool is_queued = record.state == JobState::kQueued;
        record.state = is_queued ? JobState::kCancelled : JobState::kCancelling;
        if (is_queued) record.end_time_us = UnixTimeUs();
        return true;
      });
      if (!is_paused) {
        job->RequestStop();
        job->steering().Close();
        std::optional<JobView> view = Get(id);
        impl_->options.on_event(job->record(), EventOf(job->record().state));
        if (job->record().state == JobState::kCancelled) impl_->Forget(job);
        impl_->Tell(id);
        return view;
      }
    }
    bool is_done = impl_->WhenInactive(id, [&](std::optional<JobRecord> record) {
      if (!record || record->state != JobState::kPaused) return;
      record->state = JobState::kCancelled;
      record->end_time_us = UnixTimeUs();
      impl_->Put(*record);
      impl_->Tell(id);
    });
    if (is_done) return Get(id);
    WaitBriefly();
  }
}

std::optional<JobView> JobManager::Pause(std::string_view id) {
  while (true) {
    if (const std::shared_ptr<ActiveJob> job = impl_->FindActive(id)) {
      bool has_changed = false;
      job->Update([&](JobRecord& record) {
        const bool is_queued = record.state == JobState::kQueued;
        has_changed = is_queued || record.state == JobState::kStarting || record.state == JobState::kRunning;
        if (has_changed) record.state = is_queued ? JobState::kPaused : JobState::kPausing;
        return has_changed;
      });
      if (has_changed) {
        job->RequestStop();
        impl_->options.on_event(job->record(), EventOf(job->record().state));
        if (job->record().state == JobState::kPaused) impl_->Forget(job);
        impl_->Tell(id);
      }
      return Get(id);
    }
    if (impl_->WhenInactive(id, [](const std::optional<JobRecord>&) {})) return Get(id);
    WaitBriefly();
  }
}

std::optional<JobView> JobManager::Resume(std::string_view id) {
  while (true) {
    if (const std::shared_ptr<ActiveJob> job = impl_->FindActive(id)) {
      bool is_paused = false, has_changed = false;
      job->Update([&](JobRecord& record) {
        is_paused = record.state == JobState::kPaused;
        has_changed = record.state == JobState::kPausing;
        if (has_changed) record.state = JobState::kRunning;  // its worker will queue it again
        return has_changed;
      });
      if (has_changed) impl_->Tell(id);
      if (!is_paused) return Get(id);
    }
    const bool is_done = impl_->WhenInactive(id, [&](std::optional<JobRecord> record) {
      if (!record || record->state != JobState::kPaused) return;
      record->state = JobState::kQueued;
      impl_->Put(*record);
      impl_->Enqueue(*std::move(record), nullptr);
      impl_->Tell(id);
    });
    if (is_done) return Get(id);
    WaitBriefly();
  }
}

JobManager::DeleteResult JobManager::Delete(std::string_view id) {
  const std::lock_guard lock(impl_->change_mutex);
  const std::shared_ptr<ActiveJob> job = impl_->FindActive(id);
  std::optional<JobRecord> record;
  if (job != nullptr) {
    record = job->record();
  } else {
    record = impl_->store.GetJob(id);
  }
  if (!record) return DeleteResult::kNotFound;
  if (!IsFinal(record->state)) return DeleteResult::kActive;  // perhaps accepted a moment ago
  const bool is_deleted = impl_->store.DeleteJob(id);
  if (is_deleted) impl_->options.on_event(*record, "deleted");
  if (job != nullptr) impl_->Forget(job);
  impl_->Tell(id);
  return is_deleted ? DeleteResult::kDeleted : DeleteResult::kNotFound;
}

JobManager::RestartResult JobManager::Restart(std::string_view id, bool from_start) {
  RestartResult result = RestartResult::kActive;
  const auto restart = [&](std::optional<JobRecord> record) {
    if (!record) result = RestartResult::kNotFound;
    if (!record || !IsFinal(record->state)) return;
    Impl::QueuePlaces place(*impl_, {record->owner});
    if (from_start) {
      if (const std::shared_ptr<FrameStore> frames = impl_->store.OpenFrames(id)) frames->DropCheckpoints();
    }
    if (record->first_frame > 0) record->frame_count = 0;  // they were removed
    record->first_frame = 0;
    record->state = JobState::kQueued;
    record->failure.clear();
    record->warnings = impl_->codec.encode_warnings({}, record->warnings);
    record->end_time_us = 0;
    record->crash_score = 0;
    impl_->Put(*record);
    impl_->Enqueue(*std::move(record), nullptr, &place);
    impl_->Tell(id);
    result = RestartResult::kRestarted;
  };
  while (!impl_->WhenInactive(id, restart)) {
    const std::optional<JobView> view = Get(id);
    if (view && !IsFinal(view->record.state)) return RestartResult::kActive;
    WaitBriefly();
  }
  return result;
}

std::optional<JobCheck> JobManager::Verify(std::string_view id, const std::stop_token& stop) {
  std::int64_t frames = 0;
  std::vector<std::string> damages;
  try {
    const std::optional<JobRecord> record = impl_->store.GetJob(id);
    if (!record) return std::nullopt;
    if (IsFinal(record->state) && record->first_frame == 0) frames = record->frame_count;
  } catch (const DamageError& error) {
    damages.emplace_back(error.what());
  }
  JobCheck check = VerifyFrames(impl_->store, id, frames, stop);
  check.damages.insert(check.damages.begin(), damages.begin(), damages.end());
  return check;
}

std::optional<SteeringAnswer> JobManager::Steer(std::string_view id, const SteeringRequest& request, bool check_only) {
  return impl_->WithSteering(id, [&](JobSteering& steering) { return steering.Apply(request, check_only); });
}

std::optional<SteeringList> JobManager::ListSteering(std::string_view id, std::int64_t start, int limit) {
  return impl_->WithSteering(id, [&](JobSteering& steering) { return steering.List(start, limit); });
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
