#include "server/rpc/log_stream.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "server/rpc/chunk_message.h"
#include "server/rpc/job_messages.h"
#include "server/rpc/names.h"

namespace fascicle::server {
namespace {

constexpr int kLinesOfMessage = 500;
constexpr int kLongestTail = 100'000;

}  // namespace

bool LogStream::Open() {
  Problems problems;
  const std::optional<std::string> id = ParseJobName(request_.name());
  if (!id) problems.Add("name", "must be jobs/{id}");
  if (request_.start_number() < 0) problems.Add("start_number", "must not be negative");
  if (request_.tail() < 0 || request_.tail() > kLongestTail) {
    problems.Add("tail", "must be in [0, " + std::to_string(kLongestTail) + "]");
  }
  if (!problems.empty()) {
    Complete(InvalidArgument(problems));
    return false;
  }
  frames_ = context_.jobs.Frames(*id);
  if (!frames_) {
    Complete(NotFound("job", request_.name()));
    return false;
  }
  Follow(*id);  // before the first look, so that no change is missed
  next_number_ = request_.start_number();
  if (request_.tail() > 0) next_number_ = std::max(next_number_, frames_->log_end() - request_.tail());
  job_id_ = *id;
  return true;
}

bool LogStream::PushLines() {
  const std::vector<LogRow> rows = frames_->ReadLog(next_number_, kLinesOfMessage);
  if (rows.empty()) return false;
  v1::StreamLogResponse message;
  for (const LogRow& row : rows) {
    v1::LogLine& line = *message.add_lines();
    if (!line.ParseFromString(row.bytes)) {
      throw DamageError("line " + std::to_string(row.number) + " of the log of " + request_.name());
    }
    line.set_number(row.number);
  }
  next_number_ = rows.back().number + 1;
  Push(Serialize(message));
  last_message_ = Clock::now();
  return true;
}

void LogStream::PushEnd(const JobView& view) {
  v1::StreamLogResponse message;
  *message.mutable_job() = ToMessage(view);
  Push(Serialize(message));
  Complete(grpc::Status::OK);
}

void LogStream::Fill() {
  if (job_id_.empty() && !Open()) return;
  while (HasRoom()) {
    // The state is read before the lines: a job in a final state has stored all of them.
    const std::optional<JobView> view = context_.jobs.Get(job_id_);
    if (!view) return Complete(NotFound("job", request_.name()));
    if (PushLines()) continue;
    if (!request_.follow() || IsFinal(view->record.state)) return PushEnd(*view);
    if (Clock::now() - last_message_ >= context_.settings.heartbeat_interval) {
      Push(Serialize(v1::StreamLogResponse()));
      last_message_ = Clock::now();
    }
    return WakeAfter(std::min(context_.settings.progress_interval, context_.settings.heartbeat_interval));
  }
}

}  // namespace fascicle::server
