#ifndef FASCICLE_SERVER_RPC_NEW_JOB_H_
#define FASCICLE_SERVER_RPC_NEW_JOB_H_

#include <cstddef>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include "core/base/problems.h"
#include "fascicle/v1/simulation_service.pb.h"
#include "server/rpc/rpc_context.h"

namespace fascicle {
struct Scene;
}

namespace fascicle::server {

// A job that can be stored.
struct NewJob {
  JobRecord record;
  std::shared_ptr<const Scene> scene;
};

// Why a job, or some of many, cannot be created.
struct JobFaults {
  Problems problems;                        // with fields of the request
  std::vector<std::string> missing_assets;  // `assets/{sha256}`

  bool empty() const { return problems.empty() && missing_assets.empty(); }
};

// `assets/{sha256}` of the scene's assets that the store lacks.
std::vector<std::string> MissingAssets(Store& store, const v1::Scene& scene);

// Checks a job that a client wants. What is wrong is added to `faults`, and the result is then of no use. Throws
// Stopped after a stop request.
NewJob CheckNewJob(RpcContext& context, const v1::CreateJobRequest& request, const std::stop_token& stop,
                   JobFaults& faults);

// FAILED_PRECONDITION (MISSING_ASSET) if assets are missing, INVALID_ARGUMENT if anything else is wrong, otherwise OK.
grpc::Status StatusOf(const JobFaults& faults, std::size_t details_limit);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_RPC_NEW_JOB_H_
