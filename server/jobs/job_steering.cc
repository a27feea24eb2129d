#include "server/jobs/job_steering.h"

#include <algorithm>
#include <limits>

#include "server/jobs/active_job.h"

namespace fascicle::server {
namespace {

constexpr int kAll = std::numeric_limits<int>::max();

void Refuse(SteeringAnswer& answer, const char* field, const char* reason, std::string message, std::string hint = {}) {
  if (answer.reason.empty()) answer.reason = reason;
  answer.problems.Add(field, std::move(message), std::move(hint));
}

}  // namespace

void JobSteering::Open(std::shared_ptr<FrameStore> frames, const std::string& spec, const JobCodec& codec) {
  const std::lock_guard apply_lock(apply_mutex_);
  if (frames_ != nullptr) return;
  count_ = static_cast<std::int64_t>(frames->ListSteering(1, kAll).size());
  for (const SteeringRecord& record : codec.inputs_of_spec(spec)) {
    if (record.sequence <= count_) continue;
    frames->PutSteering(record);
    count_ = record.sequence;
  }
  if (const std::int64_t stored = frames->frame_count(); stored > 0) {
    const std::vector<FrameRecord> last = frames->ListFrames(stored - 1, 1);
    if (last.empty()) throw DamageError("the last frame is missing");
    const std::lock_guard lock(mutex_);
    begun_step_ = last.front().step;
    begun_time_ = last.front().time;
  }
  frames_ = std::move(frames);
}

void JobSteering::CheckSequence(const SteeringRequest& request, SteeringAnswer& answer) {
  const std::string next = std::to_string(count_ + 1);
  if (request.sequence < 1) {
    Refuse(answer, "input.sequence", "SEQUENCE_GAP", "must be at least 1", "the next input is number " + next);
  } else if (request.sequence <= count_) {
    const std::vector<SteeringRecord> stored = frames_->ListSteering(request.sequence, 1);
    if (stored.empty()) throw DamageError("input " + std::to_string(request.sequence) + " is missing");
    if (stored.front().input == request.input) {
      answer.record = stored.front();
    } else {
      Refuse(answer, "input.sequence", "SEQUENCE_REUSED",
             "number " + std::to_string(request.sequence) + " belongs to another input",
             "the next input is number " + next);
    }
  } else if (request.sequence > count_ + 1) {
    Refuse(answer, "input.sequence", "SEQUENCE_GAP",
           "the inputs " + next + " to " + std::to_string(request.sequence - 1) + " are missing",
           "the next input is number " + next);
  } else if (count_ >= kMostInputs) {
    Refuse(answer, "input", "TOO_MANY_INPUTS", "a job has at most " + std::to_string(kMostInputs) + " inputs");
  }
}

void JobSteering::CheckTime(const SteeringRequest& request, SteeringAnswer& answer) const {
  if (is_closed_) Refuse(answer, "name", "JOB_ENDED", "the job has ended");
  if (request.at_step && *request.at_step <= begun_step_) {
    Refuse(answer, "input.at_step", "STEP_PASSED", "step " + std::to_string(*request.at_step) + " has passed",
           "the next step is " + std::to_string(begun_step_ + 1));
  }
  if (request.at_time && !(*request.at_time > begun_time_)) {
    Refuse(answer, "input.at_time", "STEP_PASSED", "this time has passed",
           "the job is at t = " + std::to_string(begun_time_) + " s");
  }
}

SteeringAnswer JobSteering::Apply(const SteeringRequest& request, bool check_only) {
  const std::lock_guard apply_lock(apply_mutex_);
  SteeringAnswer answer;
  CheckSequence(request, answer);
  if (answer.record) return answer;  // again
  SteeringRecord record = {request.sequence, request.at_step, request.at_time, UnixTimeUs(), request.input};
  {
    const std::lock_guard lock(mutex_);
    CheckTime(request, answer);
    if (check_only || !answer.problems.empty()) return answer;
    if (!request.at_step && !request.at_time) record.step = begun_step_ + 1;
    reserved_ = record;
  }
  Store(record);
  answer.record = record;
  count_ = record.sequence;
  if (is_running_) Add({std::move(record), {request.sequence, request.controls, request.ramp}});
  {
    const std::lock_guard lock(mutex_);
    reserved_.reset();
  }
  changed_.notify_all();
  return answer;
}

// Gives up the reservation if the input can't be stored.
void JobSteering::Store(const SteeringRecord& record) {
  try {
    frames_->PutSteering(record);
  } catch (...) {
    {
      const std::lock_guard lock(mutex_);
      reserved_.reset();
    }
    changed_.notify_all();
    throw;
  }
}

void JobSteering::Add(Waiting waiting) {
  const std::lock_guard lock(mutex_);
  const std::int64_t sequence = waiting.record.sequence;
  if (waiting.record.step) {
    by_step_[{*waiting.record.step, sequence}] = std::move(waiting);
  } else {
    by_time_[{waiting.record.time.value_or(0), sequence}] = std::move(waiting);
  }
}

SteeringList JobSteering::List(std::int64_t start, int limit) {
  const std::lock_guard apply_lock(apply_mutex_);
  SteeringList list = {frames_->ListSteering(start, limit), count_ + 1, 0};
  const std::lock_guard lock(mutex_);
  list.reached_step = begun_step_;
  return list;
}

void JobSteering::BeginRun(std::int64_t step, const std::string& spec, const JobCodec& codec, Write write) {
  const std::lock_guard apply_lock(apply_mutex_);
  {
    const std::lock_guard lock(mutex_);
    by_step_.clear();
    by_time_.clear();
    begun_step_ = std::max(begun_step_, step);
    is_closed_ = false;
  }
  write_ = std::move(write);
  is_running_ = true;
  if (count_ == 0) return;
  std::vector<SteeringRecord> records = frames_->ListSteering(1, kAll);
  if (static_cast<std::int64_t>(records.size()) != count_) throw DamageError("inputs of the job are missing");
  // Those of earlier steps are part of the checkpoint.
  std::erase_if(records, [step](const SteeringRecord& record) { return record.step && *record.step <= step; });
  std::vector<SteeringInput> inputs = codec.decode_inputs(spec, records);
  for (std::size_t k = 0; k < records.size(); ++k) Add({std::move(records[k]), std::move(inputs.at(k))});
}

bool JobSteering::IsDue(const SteeringRecord& record, std::int64_t step, double time) const {
  return record.step ? *record.step <= step : record.time.value_or(0) <= time;
}

std::vector<SteeringInput> JobSteering::Take(std::int64_t step, double time) {
  std::unique_lock lock(mutex_);
  if (step > begun_step_) {
    begun_step_ = step;
    begun_time_ = std::max(begun_time_, time);
  }
  changed_.wait(lock, [&] { return !reserved_ || !IsDue(*reserved_, step, time); });
  std::vector<Waiting> due;
  while (!by_step_.empty() && IsDue(by_step_.begin()->second.record, step, time)) {
    due.push_back(std::move(by_step_.extract(by_step_.begin()).mapped()));
  }
  while (!by_time_.empty() && IsDue(by_time_.begin()->second.record, step, time)) {
    due.push_back(std::move(by_time_.extract(by_time_.begin()).mapped()));
  }
  lock.unlock();
  std::vector<SteeringInput> inputs;
  for (Waiting& waiting : due) {
    if (!waiting.record.step) {
      waiting.record.step = step;  // now it is known
      write_([&] { frames_->PutSteering(waiting.record); });
    }
    inputs.push_back(std::move(waiting.input));
  }
  std::sort(inputs.begin(), inputs.end(), [](const auto& a, const auto& b) { return a.sequence < b.sequence; });
  return inputs;
}

bool JobSteering::TryClose() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return !reserved_; });
  if (by_step_.empty() && by_time_.empty()) is_closed_ = true;
  return is_closed_;
}

void JobSteering::Close() {
  std::unique_lock lock(mutex_);
  is_closed_ = true;
  // What is being stored is told as not reached.
  changed_.wait(lock, [this] { return !reserved_; });
}

std::vector<std::int64_t> JobSteering::Unreached() {
  const std::lock_guard lock(mutex_);
  std::vector<std::int64_t> sequences;
  for (const auto& [place, waiting] : by_step_) sequences.push_back(waiting.record.sequence);
  for (const auto& [place, waiting] : by_time_) sequences.push_back(waiting.record.sequence);
  std::sort(sequences.begin(), sequences.end());
  return sequences;
}

}  // namespace fascicle::server
