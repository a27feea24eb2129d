#include "server/jobs/active_job.h"

#include <chrono>
#include <utility>

namespace fascicle::server {
namespace {

void CopySettings(const JobRecord& from, JobRecord& to) {
  to.labels = from.labels;
  to.priority = from.priority;
  to.ttl_s = from.ttl_s;
  to.is_pinned = from.is_pinned;
}

}  // namespace

ActiveJob::ActiveJob(Store& store, JobRecord record)
    : store_(store), id_(record.id), wanted_threads_(record.threads), record_(std::move(record)) {
  record_.spec.clear();
  progress_ = ViewOf(record_).progress;
}

JobRecord ActiveJob::record() const {
  const std::lock_guard lock(mutex_);
  return record_;
}

void ActiveJob::Update(const Change& change) {
  const std::lock_guard update_lock(update_mutex_);
  JobRecord changed;
  {
    const std::lock_guard lock(mutex_);
    changed = record_;
    FillIn(changed);
  }
  if (!change(changed)) return;
  store_.UpdateJob(changed);
  const std::lock_guard lock(mutex_);
  record_ = std::move(changed);
}

void ActiveJob::SetSettings(const JobRecord& stored) {
  const std::lock_guard update_lock(update_mutex_);
  const std::lock_guard lock(mutex_);
  CopySettings(stored, record_);
}

void ActiveJob::SetProgress(const Progress& progress) {
  const auto now = std::chrono::steady_clock::now();
  const std::lock_guard lock(mutex_);
  progress_ = progress;
  eta_.Add(progress.fraction, now);
}

void ActiveJob::SetWaiting(const std::string& why) {
  const std::lock_guard lock(mutex_);
  waiting_ = why;
}

void ActiveJob::SetFrames(std::shared_ptr<FrameStore> frames) {
  const std::lock_guard lock(mutex_);
  frames_ = std::move(frames);
}

std::shared_ptr<FrameStore> ActiveJob::frames() const {
  const std::lock_guard lock(mutex_);
  return frames_;
}

void ActiveJob::SetScene(std::shared_ptr<const Scene> scene) {
  const std::lock_guard lock(mutex_);
  scene_ = std::move(scene);
}

std::shared_ptr<const Scene> ActiveJob::TakeScene() {
  const std::lock_guard lock(mutex_);
  return std::move(scene_);
}

void ActiveJob::FillIn(JobRecord& record) const {
  record.fraction = progress_.fraction;
  record.time = progress_.time;
  record.step = progress_.step;
  if (frames_ == nullptr) return;
  record.frame_count = frames_->frame_count();
  record.stored_bytes = frames_->stored_bytes();
}

JobView ActiveJob::View(JobRecord stored) const {
  const std::lock_guard lock(mutex_);
  JobRecord record = record_;
  record.spec = std::move(stored.spec);
  CopySettings(stored, record);
  record.revision = stored.revision;
  FillIn(record);
  return ViewWithProgress(std::move(record));
}

JobView ActiveJob::ViewStored(JobRecord stored) const {
  const std::lock_guard lock(mutex_);
  JobView view = ViewWithProgress(std::move(stored));
  if (frames_ == nullptr) return view;
  view.frame_count = frames_->frame_count();
  view.stored_bytes = frames_->stored_bytes();
  return view;
}

JobView ActiveJob::ViewWithProgress(JobRecord record) const {
  JobView view = ViewOf(std::move(record));
  view.progress = progress_;
  if (!IsAtRest(view.record.state)) view.waiting = waiting_;
  if (view.record.state == JobState::kRunning) view.eta_seconds = eta_.Seconds(std::chrono::steady_clock::now());
  return view;
}

JobView ViewOf(JobRecord record) {
  JobView view;
  view.progress = {.fraction = record.fraction, .time = record.time, .step = record.step};
  view.frame_count = record.frame_count;
  view.stored_bytes = record.stored_bytes;
  view.record = std::move(record);
  return view;
}

std::string_view EventOf(JobState state) {
  switch (state) {
    case JobState::kQueued:
      return "queued again";
    case JobState::kStarting:
      return "started";
    case JobState::kRunning:
      return "running";
    case JobState::kCancelling:
      return "asked to stop";
    case JobState::kSucceeded:
      return "succeeded";
    case JobState::kFailed:
      return "failed";
    case JobState::kCancelled:
      return "cancelled";
    case JobState::kPaused:
      return "paused";
    case JobState::kPausing:
      return "asked to pause";
  }
  return "changed";
}

bool IsAtRest(JobState state) { return IsFinal(state) || state == JobState::kPaused; }

std::int64_t UnixTimeUs() {
  return std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}

}  // namespace fascicle::server
