#ifndef FASCICLE_SERVER_RPC_JOB_BATCH_H_
#define FASCICLE_SERVER_RPC_JOB_BATCH_H_

#include <cstddef>
#include <stop_token>

#include "fascicle/v1/simulation_service.pb.h"
#include "server/rpc/rpc_context.h"

namespace fascicle::server {

// Checks the jobs of a batch and creates all of them, or none. RESOURCE_EXHAUSTED (BATCH_TOO_LARGE) if all checks but
// the last take this thread more than a second of processor time.
grpc::Status CreateBatch(RpcContext& context, const v1::BatchCreateJobsRequest& request, std::size_t details_limit,
                         const std::stop_token& stop, v1::BatchCreateJobsResponse& response);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_RPC_JOB_BATCH_H_
