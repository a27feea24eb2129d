#ifndef FASCICLE_SERVER_RPC_TAKE_OVER_H_
#define FASCICLE_SERVER_RPC_TAKE_OVER_H_

#include <functional>

#include "fascicle/v1/transfer_service.pb.h"
#include "server/rpc/rpc_context.h"
#include "server/store/job_file.h"

namespace fascicle::server {

// Makes the job in a file a job of this server. Everything is checked: the job's description, and of each frame that it
// can be read, fits the geometry and has its digest. Nothing remains unless all of it is right. `go_on` is asked before
// each frame; Stopped is thrown if it says no. Throws JobFileError and StoreError.
grpc::Status TakeOver(RpcContext& context, JobFileReader& file, const v1::ImportJobRequest& request,
                      const std::function<bool()>& go_on, v1::Job& imported);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_RPC_TAKE_OVER_H_
