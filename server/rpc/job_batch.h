#ifndef FASCICLE_SERVER_RPC_JOB_BATCH_H_
#define FASCICLE_SERVER_RPC_JOB_BATCH_H_

#include <cstddef>
#include <stop_token>

#include "fascicle/v1/simulation_service.pb.h"
#include "server/rpc/rpc_context.h"

namespace fascicle::server {

// Checks the jobs of a batch and creates all of them, or none. RESOURCE_EXHAUSTED (BATCH_TOO_LARGE) if the checks take
// more processor time than a second.
grpc::Status CreateBatch(RpcContext& context, const v1::BatchCreateJobsRequest& request, std::size_t details_limit,
                         const std::stop_token& stop, v1::BatchCreateJobsResponse& response);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_RPC_JOB_BATCH_H_
