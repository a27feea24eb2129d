#include "server/rpc/job_feed.h"

#include <algorithm>
#include <utility>

#include "server/rpc/job_messages.h"
#include "server/rpc/names.h"
#include "server/rpc/out_stream.h"

namespace fascicle::server {
namespace {

// The pause after a filling: for each stream, several times what a small message costs sender and reader.
constexpr std::chrono::microseconds kPauseOfStream(500);
constexpr std::chrono::milliseconds kLongestPause(250);

}  // namespace

void JobFeed::Join(std::weak_ptr<OutStream> stream) {
  {
    const std::lock_guard lock(streams_mutex_);
    streams_.push_back(std::move(stream));
    if (joined_++ == 0) {
      subscription_ = context_.jobs.Subscribe(job_id_, [weak = weak_from_this()] {
        const std::shared_ptr<JobFeed> feed = weak.lock();
        if (!feed) return;
        feed->is_stale_ = true;
        feed->FillAfter({});
      });
      is_stale_ = true;  // changes were not told before
    }
  }
  FillLater();
}

void JobFeed::Leave() {
  const std::lock_guard lock(streams_mutex_);
  // Waits for a call of the listener, so that none comes after the last stream has gone.
  if (--joined_ == 0) subscription_.reset();
}

std::chrono::milliseconds JobFeed::Interval() const {
  return std::min(context_.settings.progress_interval, context_.settings.heartbeat_interval);
}

void JobFeed::FillAfter(std::chrono::milliseconds delay) {
  if (is_fill_due_.exchange(true)) return;
  const auto pause = std::chrono::ceil<std::chrono::milliseconds>(next_fill_.load() - Clock::now());
  delay = std::max(delay, pause);
  const auto fill = [weak = weak_from_this()] {
    const std::shared_ptr<JobFeed> feed = weak.lock();
    if (!feed) return;
    feed->is_fill_due_ = false;  // changes from here on need another task
    if (Clock::now() < feed->next_fill_.load()) return feed->FillAfter({});
    feed->FillAll();
  };
  if (delay.count() <= 0) return context_.streaming.Post(fill);
  context_.streaming.PostAfter(delay, fill);
}

void JobFeed::FillLater() {
  if (is_timer_set_.exchange(true)) return;
  context_.streaming.PostAfter(Interval(), [weak = weak_from_this()] {
    const std::shared_ptr<JobFeed> feed = weak.lock();
    if (!feed) return;
    feed->is_timer_set_ = false;
    feed->is_stale_ = true;  // progress comes without a notification
    feed->FillAll();
  });
}

void JobFeed::FillAll() {
  std::vector<std::shared_ptr<OutStream>> streams;
  {
    const std::lock_guard lock(streams_mutex_);
    std::erase_if(streams_, [](const std::weak_ptr<OutStream>& stream) { return stream.expired(); });
    streams.reserve(streams_.size());
    for (const std::weak_ptr<OutStream>& weak : streams_) {
      if (std::shared_ptr<OutStream> stream = weak.lock()) streams.push_back(std::move(stream));
    }
  }
  for (const std::shared_ptr<OutStream>& stream : streams) stream->WakeHere(context_.streaming);
  const auto count = static_cast<std::int64_t>(streams.size());
  next_fill_ = Clock::now() + std::min<Clock::duration>(count * kPauseOfStream, kLongestPause);
  if (!streams.empty()) FillLater();
}

std::shared_ptr<const JobFeed::State> JobFeed::Look() {
  const std::lock_guard lock(state_mutex_);
  if (!is_stale_.exchange(false)) return state_;
  try {
    state_ = Read();
  } catch (...) {
    is_stale_ = true;
    throw;
  }
  return state_;
}

std::shared_ptr<const JobFeed::State> JobFeed::LookAgain() {
  is_stale_ = true;
  return Look();
}

std::shared_ptr<const JobFeed::State> JobFeed::Read() {
  // The state is read before the frames: a job in a final state has stored all of them.
  std::optional<JobView> view = context_.jobs.Get(job_id_);
  if (!view) return nullptr;
  auto state = std::make_shared<State>();
  state->frame_count = frames_->frame_count();
  const JobRecord& record = view->record;
  if (record.first_frame > 0) {
    state->frame_count = record.frame_count;
  } else if (IsFinal(record.state) && state->frame_count < record.frame_count) {
    throw DamageError("of the " + std::to_string(record.frame_count) + " frames of " + JobName(job_id_) + " only " +
                      std::to_string(state->frame_count) + " are there");
  }
  state->progress = ProgressOf(*view);
  state->beat = state_ ? state_->beat : 0;
  // A frame that comes a little earlier takes the beat along.
  const Clock::time_point now = Clock::now();
  std::string told = std::to_string(StateOf(*view)) + state->progress.SerializeAsString();
  if (told != told_ && !IsFinal(record.state) && now - last_beat_ >= context_.settings.progress_interval * 3 / 4) {
    ++state->beat;
    told_ = std::move(told);
    last_beat_ = now;
  }
  state->view = *std::move(view);
  return state;
}

FrameRecord JobFeed::Record(std::int64_t index, int ahead) {
  constexpr std::size_t kMostRecords = 4096;
  const std::lock_guard lock(state_mutex_);
  if (const std::int64_t now = frames_->replacements(); now != replacements_) {
    records_.clear();
    replacements_ = now;
  }
  auto found = records_.find(index);
  if (found == records_.end()) {
    if (records_.size() >= kMostRecords) records_.clear();
    for (FrameRecord& record : frames_->ListFrames(index, ahead)) {
      const std::int64_t number = record.index;
      records_.insert_or_assign(number, std::move(record));
    }
    found = records_.find(index);
  }
  if (found == records_.end()) {
    throw DamageError("frame " + std::to_string(index) + " of " + JobName(job_id_) + " is missing");
  }
  return found->second;
}

std::shared_ptr<JobFeed> JobFeeds::Of(const std::string& job_id) {
  std::shared_ptr<FrameStore> frames = context_.jobs.Frames(job_id);
  if (!frames) return nullptr;
  const std::lock_guard lock(mutex_);
  std::erase_if(feeds_, [](const auto& entry) { return entry.second.expired(); });
  std::weak_ptr<JobFeed>& known = feeds_[job_id];
  std::shared_ptr<JobFeed> feed = known.lock();
  // Another store belongs to another job: the earlier one of this name was deleted.
  if (!feed || feed->shared_frames() != frames) {
    feed = std::make_shared<JobFeed>(context_, job_id, std::move(frames));
    known = feed;
  }
  return feed;
}

}  // namespace fascicle::server
