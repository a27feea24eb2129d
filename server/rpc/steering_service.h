#ifndef FASCICLE_SERVER_RPC_STEERING_SERVICE_H_
#define FASCICLE_SERVER_RPC_STEERING_SERVICE_H_

#include "fascicle/v1/steering_service.grpc.pb.h"
#include "server/rpc/rpc_context.h"

namespace fascicle::server {

// Changes what acts on jobs while they run.
class SteeringServiceImpl : public v1::SteeringService::CallbackService {
 public:
  explicit SteeringServiceImpl(RpcContext& context) : context_(context) {}

  grpc::ServerUnaryReactor* ApplySteering(grpc::CallbackServerContext* call, const v1::ApplySteeringRequest* request,
                                          v1::ApplySteeringResponse* response) override;
  grpc::ServerUnaryReactor* ListSteering(grpc::CallbackServerContext* call, const v1::ListSteeringRequest* request,
                                         v1::ListSteeringResponse* response) override;

 private:
  grpc::Status Apply(const v1::ApplySteeringRequest& request, v1::ApplySteeringResponse& response,
                     std::size_t details_limit);
  grpc::Status List(const v1::ListSteeringRequest& request, v1::ListSteeringResponse& response);

  RpcContext& context_;
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_RPC_STEERING_SERVICE_H_
