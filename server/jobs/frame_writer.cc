#include "server/jobs/frame_writer.h"

#include <utility>
#include <vector>

#include "server/jobs/wait_for_room.h"

namespace fascicle::server {
namespace {

constexpr std::chrono::seconds kProgressInterval{1};

}  // namespace

FrameWriter::FrameWriter(class Store& store, ActiveJob& job, const JobCodec& codec, RunProfile& profile,
                         std::function<void()> notify)
    : store_(store),
      job_(job),
      frames_(job.frames()),
      codec_(codec),
      profile_(profile),
      notify_(std::move(notify)),
      next_progress_(std::chrono::steady_clock::now() + kProgressInterval),
      thread_([this] { Loop(); }) {}

FrameWriter::~FrameWriter() { Close(); }

bool FrameWriter::PutFrame(Frame frame, std::string checkpoint) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return waiting_.size() < kMaxWaiting || error_; });
  if (error_) return false;
  waiting_.push_back({std::move(frame), std::move(checkpoint), std::exchange(lines_, {})});
  changed_.notify_all();
  return true;
}

void FrameWriter::PutLine(std::int64_t number, LogLine line) {
  const std::lock_guard lock(mutex_);
  lines_.push_back({number, std::move(line)});
}

void FrameWriter::Finish() {
  Close();
  if (error_) std::rethrow_exception(error_);
}

void FrameWriter::Close() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    is_closed_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void FrameWriter::Loop() {
  std::unique_lock lock(mutex_);
  while (!error_) {
    changed_.wait_until(lock, next_progress_, [this] { return !waiting_.empty() || is_closed_; });
    if (waiting_.empty() && is_closed_) {
      lock.unlock();
      StoreLines();  // those of the run's end
      return;
    }
    std::exception_ptr error;
    if (!waiting_.empty()) {
      const Item item = std::move(waiting_.front());
      waiting_.pop_front();
      changed_.notify_all();
      lock.unlock();
      try {
        StoreFrame(item);
      } catch (...) {
        error = std::current_exception();
      }
    } else {
      lock.unlock();
    }
    if (!error) StoreProgressRarely();
    lock.lock();
    error_ = error;
  }
  waiting_.clear();
  changed_.notify_all();
}

void FrameWriter::StoreFrame(const Item& item) {
  const Frame& frame = item.frame;
  const std::string bytes = Encode(frame);
  const FrameRecord record{frame.index, frame.time, frame.step, static_cast<std::int64_t>(bytes.size()),
                           std::string(frame.digest.begin(), frame.digest.end())};
  // A replaced frame must never be read under the old generation, so the generation is updated first. If this process
  // ends in between, the next one replaces the frame and increments the generation again.
  if (IsStoredDifferently(record)) job_.Update([](JobRecord& job) { return ++job.generation > 0; });
  {
    const StageTimer timer(&profile_.storing, "commit");
    Encode(item.lines);
    WriteWhenRoom(store_, job_, [&] { frames_->PutFrame(record, bytes, item.checkpoint, rows_); });
    rows_.clear();
  }
  profile_.storing.NoteCpu();
  notify_();
}

// Whether another frame is stored in the place of this one. A damaged one is not another one: it is written anew.
bool FrameWriter::IsStoredDifferently(const FrameRecord& record) {
  if (record.index >= frames_->frame_count()) return false;
  try {
    const std::vector<FrameRecord> stored = frames_->ListFrames(record.index, 1);
    return stored.empty() || stored.front().digest != record.digest;
  } catch (const DamageError&) {
    return false;
  }
}

std::string FrameWriter::Encode(const Frame& frame) {
  const StageTimer timer(&profile_.storing, "encode");
  return codec_.encode_frame(frame);
}

void FrameWriter::Encode(const std::vector<NumberedLine>& lines) {
  for (const NumberedLine& line : lines) rows_.push_back({line.number, codec_.encode_line(line.line)});
}

// Stores the lines since the last frame, unless frames are waiting, with which earlier lines are stored.
void FrameWriter::StoreLines() {
  std::vector<NumberedLine> lines;
  {
    const std::lock_guard lock(mutex_);
    if (!waiting_.empty() || lines_.empty()) return;
    lines.swap(lines_);
  }
  try {
    Encode(lines);
    frames_->PutLog(rows_);
    rows_.clear();
    notify_();
  } catch (const std::exception&) {
    // They are stored with the next frame; if the storage has failed, that reports it.
  }
}

void FrameWriter::StoreProgressRarely() {
  const auto now = std::chrono::steady_clock::now();
  if (now < next_progress_) return;
  next_progress_ = now + kProgressInterval;
  StoreLines();
  const StageTimer timer(&profile_.storing, "progress");
  try {
    job_.Update([this](JobRecord& record) {
      record.profile = codec_.encode_profile(profile_);
      return true;
    });
  } catch (const std::exception&) {
    // Progress is not essential; if the storage has failed, the next frame or the end of the job reports it.
  }
}

}  // namespace fascicle::server
