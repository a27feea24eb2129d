#ifndef FASCICLE_SERVER_JOBS_JOB_RUN_H_
#define FASCICLE_SERVER_JOBS_JOB_RUN_H_

#include <functional>

#include "server/jobs/active_job.h"
#include "server/jobs/job_manager.h"

namespace fascicle::server {

// The objects shared by all runs.
struct RunContext {
  Store& store;
  const JobCodec& codec;
  const JobManagerOptions& options;
  std::stop_token drain;  // requested when the process is about to end
  int threads = 1;        // of this run
};

// Runs a queued job, from its checkpoint if it has one, until its end or until it is asked to stop. Then updates its
// record: final, paused, or queued again. Every frame is stored before that. Waits until the record can be stored: an
// end that clients have seen must not change; if the process ends before, the next one resumes the job. Never throws.
void RunJob(const RunContext& context, ActiveJob& job, const std::function<void()>& notify);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_JOBS_JOB_RUN_H_
