#ifndef FASCICLE_SERVER_RPC_JOB_FILTER_H_
#define FASCICLE_SERVER_RPC_JOB_FILTER_H_

#include <cstdint>
#include <string_view>

#include "core/base/problems.h"
#include "server/store/job_query.h"

namespace fascicle::server {

// The filter of ListJobsRequest (see its comment). Problems have the path `filter` and name the character, counted from
// 1. `now_us`: the time from which ages are counted [us since the Unix epoch].
JobFilter ParseJobFilter(std::string_view text, std::int64_t now_us, Problems& problems);

// The order of ListJobsRequest, set in `query`. Problems have the path `order_by`.
void ParseJobOrder(std::string_view text, JobQuery& query, Problems& problems);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_RPC_JOB_FILTER_H_
