#ifndef FASCICLE_SERVER_JOBS_VERIFY_JOB_H_
#define FASCICLE_SERVER_JOBS_VERIFY_JOB_H_

#include <stop_token>
#include <string_view>

#include "server/jobs/job_manager.h"
#include "server/store/store.h"

namespace fascicle::server {

// Reads all frames, the geometry, the inputs and the log of a job, and describes what is damaged, at most kMostDamages
// of it. `expected_frames`: the number of frames that must be there. Throws Stopped, and StoreError for failures other
// than damage.
inline constexpr std::size_t kMostDamages = 100;
JobCheck VerifyFrames(Store& store, std::string_view id, std::int64_t expected_frames, const std::stop_token& stop);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_JOBS_VERIFY_JOB_H_
