#ifndef FASCICLE_SERVER_RPC_JOB_SETTINGS_H_
#define FASCICLE_SERVER_RPC_JOB_SETTINGS_H_

#include "core/base/problems.h"
#include "fascicle/v1/job.pb.h"
#include "fascicle/v1/simulation_service.pb.h"
#include "server/store/store.h"

namespace fascicle::server {

// Owner, labels, priority, ttl and pin of jobs, checked against the rules in job.proto. Paths of problems are those of
// fields of a request with the field `job`.

// Of a new job.
void CheckSettings(const v1::Job& job, Problems& problems);
void CopySettings(const v1::Job& job, JobRecord& record);

// Only what the mask names.
void CheckUpdate(const v1::UpdateJobRequest& request, Problems& problems);
// The request must have passed CheckUpdate. Problems: a label too many for this job; `record` then stays as it is.
void ApplyUpdate(const v1::UpdateJobRequest& request, JobRecord& record, Problems& problems);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_RPC_JOB_SETTINGS_H_
