#ifndef FASCICLE_SERVER_RPC_LOG_SERVICE_H_
#define FASCICLE_SERVER_RPC_LOG_SERVICE_H_

#include <grpcpp/support/byte_buffer.h>

#include "fascicle/v1/log_service.grpc.pb.h"
#include "server/rpc/rpc_context.h"

namespace fascicle::server {

using LogServiceBase = v1::LogService::WithRawCallbackMethod_StreamLog<v1::LogService::Service>;

// The logs of jobs.
class LogServiceImpl : public LogServiceBase {
 public:
  explicit LogServiceImpl(RpcContext& context) : context_(context) {}

  grpc::ServerWriteReactor<grpc::ByteBuffer>* StreamLog(grpc::CallbackServerContext* call,
                                                        const grpc::ByteBuffer* request) override;

 private:
  RpcContext& context_;
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_RPC_LOG_SERVICE_H_
