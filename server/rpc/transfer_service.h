#ifndef FASCICLE_SERVER_RPC_TRANSFER_SERVICE_H_
#define FASCICLE_SERVER_RPC_TRANSFER_SERVICE_H_

#include <grpcpp/support/byte_buffer.h>

#include "fascicle/v1/transfer_service.grpc.pb.h"
#include "server/rpc/open_transfers.h"
#include "server/rpc/rpc_context.h"

namespace fascicle::server {

using TransferServiceBase = v1::TransferService::WithRawCallbackMethod_ExportJob<
    v1::TransferService::WithCallbackMethod_ImportJob<v1::TransferService::Service>>;

// Jobs as files. Everything runs on threads of its own: files may be large.
class TransferServiceImpl : public TransferServiceBase {
 public:
  explicit TransferServiceImpl(RpcContext& context) : context_(context), transfers_(context.log) {}

  grpc::ServerWriteReactor<grpc::ByteBuffer>* ExportJob(grpc::CallbackServerContext* call,
                                                        const grpc::ByteBuffer* request) override;
  grpc::ServerReadReactor<v1::ImportJobRequest>* ImportJob(grpc::CallbackServerContext* call,
                                                           v1::Job* response) override;

 private:
  RpcContext& context_;
  OpenTransfers transfers_;
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_RPC_TRANSFER_SERVICE_H_
