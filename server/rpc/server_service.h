#ifndef FASCICLE_SERVER_RPC_SERVER_SERVICE_H_
#define FASCICLE_SERVER_RPC_SERVER_SERVICE_H_

#include <chrono>

#include "fascicle/v1/simulation_service.grpc.pb.h"
#include "server/rpc/rpc_context.h"

namespace fascicle::server {

// Information about the server itself.
class ServerServiceImpl : public v1::ServerService::CallbackService {
 public:
  explicit ServerServiceImpl(RpcContext& context) : context_(context) {}

  grpc::ServerUnaryReactor* GetServerInfo(grpc::CallbackServerContext* call, const v1::GetServerInfoRequest* request,
                                          v1::ServerInfo* response) override;

 private:
  RpcContext& context_;
  const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_RPC_SERVER_SERVICE_H_
