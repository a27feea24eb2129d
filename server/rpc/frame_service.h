#ifndef FASCICLE_SERVER_RPC_FRAME_SERVICE_H_
#define FASCICLE_SERVER_RPC_FRAME_SERVICE_H_

#include <grpcpp/support/byte_buffer.h>

#include "fascicle/v1/simulation_service.grpc.pb.h"
#include "server/rpc/rpc_context.h"
#include "server/rpc/shared_frames.h"

namespace fascicle::server {

using FrameServiceBase =
    v1::FrameService::WithRawCallbackMethod_GetGeometry<v1::FrameService::WithRawCallbackMethod_StreamFrames<
        v1::FrameService::WithCallbackMethod_ListFrames<v1::FrameService::Service>>>;

// The results of jobs. The streams are raw, so that frames are sent from the store without a copy.
class FrameServiceImpl : public FrameServiceBase {
 public:
  explicit FrameServiceImpl(RpcContext& context) : context_(context), shared_(context) {}

  // Drops copies of frames that nobody has read for a while.
  void DropUnused();

  grpc::ServerWriteReactor<grpc::ByteBuffer>* GetGeometry(grpc::CallbackServerContext* call,
                                                          const grpc::ByteBuffer* request) override;
  grpc::ServerWriteReactor<grpc::ByteBuffer>* StreamFrames(grpc::CallbackServerContext* call,
                                                           const grpc::ByteBuffer* request) override;
  grpc::ServerUnaryReactor* ListFrames(grpc::CallbackServerContext* call, const v1::ListFramesRequest* request,
                                       v1::ListFramesResponse* response) override;

 private:
  grpc::Status List(const v1::ListFramesRequest& request, v1::ListFramesResponse& response);

  RpcContext& context_;
  SharedFrames shared_;
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_RPC_FRAME_SERVICE_H_
