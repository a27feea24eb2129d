#include "server/rpc/job_batch.h"

#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/problems.h"
#include "core/base/profile.h"
#include "core/base/stop.h"
#include "server/rpc/errors.h"
#include "server/rpc/job_messages.h"
#include "server/rpc/new_job.h"

namespace fascicle::server {
namespace {

constexpr int kMostJobs = 1000;
// A batch keeps one thread from the start of its checks to their end, and a small message can be dear to check.
constexpr double kLongestChecks = 1;  // [s]

// What is wrong with the requests as parts of a batch.
void CheckParts(const v1::BatchCreateJobsRequest& batch, Problems& problems) {
  std::set<std::string_view> ids;
  for (int i = 0; i < batch.requests_size(); ++i) {
    const v1::CreateJobRequest& request = batch.requests(i);
    const std::string path = IndexPath("requests", static_cast<std::size_t>(i));
    if (request.validate_only()) {
      problems.Add(JoinPath(path, "validate_only"), "is not possible in a batch", "check the job with CreateJob");
    }
    if (!request.request_id().empty() && !ids.insert(request.request_id()).second) {
      problems.Add(JoinPath(path, "request_id"), "is that of another request of the batch", "give each its own");
    }
  }
}

grpc::Status TooLarge(int checked, int count) {
  return ResourceExhausted("BATCH_TOO_LARGE", "requests",
                           "checking " + std::to_string(checked) + " of " + std::to_string(count) +
                               " jobs took more than a second: send fewer at once");
}

}  // namespace

grpc::Status CreateBatch(RpcContext& context, const v1::BatchCreateJobsRequest& request, std::size_t details_limit,
                         const std::stop_token& stop, v1::BatchCreateJobsResponse& response) {
  const int count = request.requests_size();
  if (count < 1 || count > kMostJobs) {
    return InvalidArgument("requests", "must be 1 to " + std::to_string(kMostJobs) + ": send more in several batches");
  }
  JobFaults faults;
  std::set<std::string> missing_assets;  // jobs may share them
  CheckParts(request, faults.problems);
  std::vector<JobRecord> records;
  std::shared_ptr<const Scene> first_scene;  // the others may need much memory together
  Profile profile;
  for (int i = 0; i < count; ++i) {
    JobFaults found;
    NewJob job = CheckNewJob(context, request.requests(i), stop, found);
    faults.problems.Append(IndexPath("requests", static_cast<std::size_t>(i)), found.problems);
    missing_assets.insert(found.missing_assets.begin(), found.missing_assets.end());
    records.push_back(std::move(job.record));
    if (i == 0) first_scene = std::move(job.scene);
    profile.NoteCpu();
    if (profile.cpu_seconds() > kLongestChecks && i + 1 < count) return TooLarge(i + 1, count);
  }
  faults.missing_assets.assign(missing_assets.begin(), missing_assets.end());
  if (!faults.empty()) return StatusOf(faults, details_limit);
  ThrowIfStopped(stop);
  for (const SubmittedJob& job : context.jobs.Submit(std::move(records), std::move(first_scene))) {
    *response.add_jobs() = ToMessage(job.view);
  }
  return grpc::Status::OK;
}

}  // namespace fascicle::server
