#ifndef FASCICLE_SERVER_RPC_JOB_MESSAGES_H_
#define FASCICLE_SERVER_RPC_JOB_MESSAGES_H_

#include <string>

#include "fascicle/v1/job.pb.h"
#include "server/jobs/job_manager.h"

namespace fascicle::server {

// The spec of a job as it is stored: a v1::Job with scene, threads and inputs only. Equal jobs have equal bytes.
std::string SpecOf(const v1::Job& requested);
// SHA-256 of everything that a client asks for; that of the spec for a job with neither owner nor settings.
std::string DigestOf(const v1::Job& requested);

// The message of a job, without its scene.
v1::Job ToMessage(const JobView& view);
// The same as in a list: without profile and warnings, which are as large as everything else.
v1::Job ToListedMessage(const JobView& view);
// The message of a job with its scene, as GetJob gives it.
v1::Job ToMessageWithScene(const JobView& view);

// From the time since the Unix epoch [us].
google::protobuf::Timestamp TimestampOf(std::int64_t microseconds);

v1::Progress ProgressOf(const JobView& view);
v1::Job::State StateOf(const JobView& view);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_RPC_JOB_MESSAGES_H_
