#include "server/rpc/job_watch_stream.h"

#include <algorithm>
#include <optional>

#include "server/rpc/chunk_message.h"
#include "server/rpc/job_filter.h"
#include "server/rpc/job_messages.h"
#include "server/rpc/names.h"

namespace fascicle::server {
namespace {

constexpr int kBatch = 200;  // jobs of a response
// Least time between looks at the store, so that many changes share a response.
constexpr std::chrono::milliseconds kShortestInterval(50);

}  // namespace

void JobWatchStream::Fill() {
  if (!is_open_ && !Open()) return;
  while (HasRoom() && PushChanges()) {
  }
}

bool JobWatchStream::Open() {
  Problems problems;
  filter_ = ParseJobFilter(request_.filter(), UnixTimeUs(), problems);
  if (request_.revision() < 0) problems.Add("revision", "must not be negative");
  if (!problems.empty()) {
    Complete(InvalidArgument(problems));
    return false;
  }
  Follow("");  // before the first look, so that no change is missed
  revision_ = request_.revision();
  first_complete_ = revision_ == 0 ? context_.jobs.Revision() : revision_;
  is_open_ = true;
  return true;
}

bool JobWatchStream::PushChanges() {
  const auto now = Clock::now();
  const auto heartbeat = context_.settings.heartbeat_interval;
  const bool is_first = last_message_ == Clock::time_point();
  if (!is_first && context_.jobs.Revision() == revision_) {
    const auto silence = now - last_message_;
    if (silence >= heartbeat) {
      v1::WatchJobsResponse nothing;
      nothing.set_revision(revision_);
      PushResponse(nothing);
    }
    // Progress is stored without a notification.
    WakeAfter(std::min(context_.settings.progress_interval, heartbeat));
    return false;
  }
  if (const auto rest = kShortestInterval - (now - last_look_); revision_ >= first_complete_ && rest > rest.zero()) {
    WakeAfter(std::chrono::ceil<std::chrono::milliseconds>(rest));
    return false;
  }
  last_look_ = now;
  const auto changes = context_.jobs.ChangesAfter(revision_, first_complete_, kBatch);
  if (!changes) {
    Complete(OutOfRange("REVISION", "which jobs were deleted since revision " + std::to_string(revision_) +
                                        " is not known any more: watch from revision 0"));
    return false;
  }
  const v1::WatchJobsResponse response = ResponseOf(*changes);
  revision_ = changes->revision;
  if (is_first || response.jobs_size() > 0 || response.removed_size() > 0) PushResponse(response);
  return true;
}

v1::WatchJobsResponse JobWatchStream::ResponseOf(const JobChangeViews& changes) const {
  v1::WatchJobsResponse response;
  response.set_revision(changes.revision);
  for (const JobView& view : changes.changed) {
    if (filter_.Passes(view.record)) {
      *response.add_jobs() = ToListedMessage(view);
    } else if (view.record.revision > first_complete_) {
      response.add_removed(JobName(view.record.id));
    }
  }
  for (const std::string& id : changes.deleted) response.add_removed(JobName(id));
  return response;
}

void JobWatchStream::PushResponse(const v1::WatchJobsResponse& response) {
  Push(Serialize(response));
  last_message_ = Clock::now();
}

}  // namespace fascicle::server
